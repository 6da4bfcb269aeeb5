// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies of a clearance joint: shapes, material and bounds.
#pragma once

#include <boost/make_shared.hpp>

#include "registered.hpp"

namespace statejump::dem {

struct ThermalFrictMat : RegisteredIndexable<ThermalFrictMat, yade::FrictMat> {
  static constexpr const char* class_name = "ThermalFrictMat";
  static constexpr const char* base_name = "FrictMat";
  static constexpr const char* doc =
      "Elastic frictional material that expands with temperature. YADE's defaults for young, "
      "poisson, density and frictionAngle apply.";
  Real thermalExpansion = 0;
  ThermalFrictMat() { createIndex(); }
  void check() const;
  static auto attributes() {
    return std::make_tuple(attribute("thermalExpansion", &ThermalFrictMat::thermalExpansion,
                                     "Coefficient of linear thermal expansion [1/K]"));
  }
};

struct ThermalShape : RegisteredIndexable<ThermalShape, yade::Shape> {
  static constexpr const char* class_name = "ThermalShape";
  static constexpr const char* base_name = "Shape";
  static constexpr const char* doc =
      "Shape whose lengths follow the temperature. Lengths are given at the reference temperature "
      "and never changed; the current ones are length * (1 + thermalStrain), with the strain from "
      "the total temperature change (set by ThermalExpansionEngine), so that a closed cycle leaves "
      "no "
      "residue.";
  Real thermalStrain = 0;
  // Strain rate over the last step [1/s], which gives the time within the step when an expanding
  // joint closed. It is set in every step, so it is not saved.
  Real thermalStrainRate = 0;
  ThermalShape() { createIndex(); }
  void check() const;
  Real expanded(Real length) const { return length * (1 + thermalStrain); }
  static auto attributes() {
    return std::make_tuple(attribute("thermalStrain", &ThermalShape::thermalStrain,
                                     "Linear thermal strain alpha (T - T0) [-]"));
  }
};

struct Journal : RegisteredIndexable<Journal, ThermalShape> {
  static constexpr const char* class_name = "Journal";
  static constexpr const char* bound_functor_name = "Bo1_Journal_Aabb";
  static constexpr const char* view_functor_name = "Gl1_Journal";
  static constexpr const char* base_name = "ThermalShape";
  static constexpr const char* doc =
      "Pin of a revolute joint: a cylinder about the local z axis, inside a Bearing.";
  Real radius = 0;
  Real halfLength = 0;
  Journal() { createIndex(); }
  void check() const;
  Vector3r half_extents(const yade::Quaternionr& orientation) const;
  static auto attributes() {
    return std::make_tuple(
        attribute("radius", &Journal::radius, "Radius at the reference temperature [m]"),
        attribute("halfLength", &Journal::halfLength,
                  "Half of the length along the axis [m]; 0 means as long as the radius"));
  }
};

struct Bearing : RegisteredIndexable<Bearing, ThermalShape> {
  static constexpr const char* class_name = "Bearing";
  static constexpr const char* bound_functor_name = "Bo1_Bearing_Aabb";
  static constexpr const char* view_functor_name = "Gl1_Bearing";
  static constexpr const char* base_name = "ThermalShape";
  static constexpr const char* doc =
      "Hole of a revolute joint: the inside of a cylinder about the local z axis. The radial "
      "clearance is Bearing.radius - Journal.radius, both at the current temperature.";
  Real radius = 0;
  Real halfLength = 0;
  Bearing() { createIndex(); }
  void check() const;
  Vector3r half_extents(const yade::Quaternionr& orientation) const;
  static auto attributes() {
    return std::make_tuple(
        attribute("radius", &Bearing::radius, "Inner radius at the reference temperature [m]"),
        attribute("halfLength", &Bearing::halfLength,
                  "Half of the length along the axis [m]; 0 means as long as the radius"));
  }
};

struct Ball : RegisteredIndexable<Ball, ThermalShape> {
  static constexpr const char* class_name = "Ball";
  static constexpr const char* bound_functor_name = "Bo1_Ball_Aabb";
  static constexpr const char* view_functor_name = "Gl1_Ball";
  static constexpr const char* base_name = "ThermalShape";
  static constexpr const char* doc =
      "Ball: of a spherical joint, inside a Socket, or one that hits another Ball from outside.";
  Real radius = 0;
  Ball() { createIndex(); }
  void check() const;
  Vector3r half_extents(const yade::Quaternionr& orientation) const;
  static auto attributes() {
    return std::make_tuple(
        attribute("radius", &Ball::radius, "Radius at the reference temperature [m]"));
  }
};

struct Socket : RegisteredIndexable<Socket, ThermalShape> {
  static constexpr const char* class_name = "Socket";
  static constexpr const char* bound_functor_name = "Bo1_Socket_Aabb";
  static constexpr const char* view_functor_name = "Gl1_Socket";
  static constexpr const char* base_name = "ThermalShape";
  static constexpr const char* doc =
      "Cup of a spherical joint: the inside of a sphere, all of it; the opening through which the "
      "ball's stem leaves is not modelled. The clearance is Socket.radius - Ball.radius, both at "
      "the current temperature.";
  Real radius = 0;
  Socket() { createIndex(); }
  void check() const;
  Vector3r half_extents(const yade::Quaternionr& orientation) const;
  static auto attributes() {
    return std::make_tuple(
        attribute("radius", &Socket::radius, "Inner radius at the reference temperature [m]"));
  }
};

struct Slider : RegisteredIndexable<Slider, ThermalShape> {
  static constexpr const char* class_name = "Slider";
  static constexpr const char* bound_functor_name = "Bo1_Slider_Aabb";
  static constexpr const char* view_functor_name = "Gl1_Slider";
  static constexpr const char* base_name = "ThermalShape";
  static constexpr const char* doc =
      "Block of a one-dimensional clearance joint. It touches the faces of its slot with crowned "
      "pads, all part of one sphere of the given radius, so contact is the same in any "
      "orientation.";
  Real radius = 0;
  Slider() { createIndex(); }
  void check() const;
  Vector3r half_extents(const yade::Quaternionr& orientation) const;
  static auto attributes() {
    return std::make_tuple(attribute("radius", &Slider::radius,
                                     "Radius of the pads at the reference temperature [m]"));
  }
};

struct SlotFace : RegisteredIndexable<SlotFace, ThermalShape> {
  static constexpr const char* class_name = "SlotFace";
  static constexpr const char* bound_functor_name = "Bo1_SlotFace_Aabb";
  static constexpr const char* view_functor_name = "Gl1_SlotFace";
  static constexpr const char* base_name = "ThermalShape";
  static constexpr const char* doc =
      "Plane face of a slot (floor, ceiling or end stop) that holds a Slider. A slot is a group of "
      "such bodies at the slot's centre, one per face, because YADE keeps one contact per pair of "
      "bodies; statejump_yade.slot() makes the group. When the slot expands, each face moves away "
      "from the centre.";
  Vector3r normal = Vector3r(1, 0, 0);
  Real distance = 0;
  Real halfSize = 0;
  SlotFace() { createIndex(); }
  void check() const;
  Vector3r half_extents(const yade::Quaternionr& orientation) const;
  static auto attributes() {
    return std::make_tuple(
        attribute("normal", &SlotFace::normal,
                  "Local unit vector from the slot's centre to the face: the direction in which "
                  "the slider pushes the face [-]"),
        attribute("distance", &SlotFace::distance,
                  "Distance of the face from the slot's centre at the reference temperature [m]"),
        attribute("halfSize", &SlotFace::halfSize,
                  "Half of the edge of the box that the collider uses for the face [m]; the "
                  "contact itself is with the whole plane"));
  }
};

// Bounding boxes for YADE's collider. A journal is inside its bearing, so both boxes always overlap
// and the collider never loses this pair.
template <class ShapeOfOurs>
struct Bo1 : Registered<Bo1<ShapeOfOurs>, yade::BoundFunctor> {
  static constexpr const char* class_name = ShapeOfOurs::bound_functor_name;
  static constexpr const char* base_name = "BoundFunctor";
  static constexpr const char* doc = "Axis-aligned bounding box of the shape at its temperature";
  using yade::BoundFunctor::go;
  void go(const yade::shared_ptr<yade::Shape>& shape, yade::shared_ptr<yade::Bound>& bound,
          const yade::Se3r& se3, const yade::Body*) override {
    if (!bound) bound = boost::make_shared<yade::Aabb>();
    const Vector3r half = static_cast<const ShapeOfOurs&>(*shape).half_extents(se3.orientation);
    bound->min = se3.position - half;
    bound->max = se3.position + half;
  }
  std::string get1DFunctorType1() const override { return ShapeOfOurs::class_name; }
  static auto attributes() { return std::make_tuple(); }
};

}  // namespace statejump::dem
