// SPDX-License-Identifier: GPL-3.0-or-later
#include "joint.hpp"

#include <boost/make_shared.hpp>
#include <cmath>
#include <limits>
#include <sstream>

#include "blocked_motion.hpp"
#include "bore.hpp"
#include "contact_parts.hpp"
#include "failure.hpp"
#include "joint_exchange.hpp"
#include "ranges.hpp"
#include "shapes.hpp"

namespace statejump::dem {
namespace {

JointGeom& geometry_of(const yade::shared_ptr<yade::Interaction>& contact,
                       const Vector3r& first_normal) {
  if (!contact->geom) {
    auto fresh = boost::make_shared<JointGeom>();
    fresh->normal = first_normal;
    contact->geom = fresh;
  }
  return static_cast<JointGeom&>(*contact->geom);
}

Real inverse_mass_of(const yade::Scene& scene, int id) {
  return inverse_mass(*body_at(scene, static_cast<std::size_t>(id))->state);
}

template <class Shape>
stepper::ThermalLength part_of(const Shape& shape, Real length) {
  return {length, shape.expanded(1), shape.thermalStrainRate};
}

kernel::BodyMotion shifted(const yade::State& state, const Vector3r& shift) {
  kernel::BodyMotion moved = motion(state);
  moved.position += shift;
  return moved;
}

// Sets the additional fields that YADE's recorders read from a contact.
bool finish(const yade::State& state1, Real radius_1, Real radius_2,
            const yade::Interaction& contact) {
  auto& geometry = static_cast<JointGeom&>(*contact.geom);
  geometry.contactPoint = state1.se3.position + geometry.arm1;
  geometry.refR1 = radius_1;
  geometry.refR2 = radius_2;
  return true;
}

}  // namespace

[[gnu::flatten]] bool Ig2_Journal_Bearing_JointGeom::go(
    const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
    const yade::State& state1, const yade::State& state2, const Vector3r& shift2, const bool& force,
    const yade::shared_ptr<yade::Interaction>& contact) {
  const auto& journal = static_cast<const Journal&>(*shape1);
  const auto& bearing = static_cast<const Bearing&>(*shape2);
  const stepper::ThermalLength part_1 = part_of(journal, journal.radius);
  const stepper::ThermalLength part_2 = part_of(bearing, bearing.radius);
  const Vector3r axis = axis_of(state2.se3.orientation);
  const auto tilted = [&] {
    return !(axis_of(state1.se3.orientation).cross(axis).squaredNorm() <= maxTilt * maxTilt);
  };
  switch (stepper::find_revolute(
      part_1, part_2, motion(state1), shifted(state2, shift2), axis, force || contact->isReal(),
      scene->dt, tilted,
      [&](const Vector3r& normal) -> JointGeom& { return geometry_of(contact, normal); })) {
    case stepper::ContactSearch::apart:
      return false;
    case stepper::ContactSearch::closed:
      fail_closed("journal", part_1.expanded(), "bearing", part_2.expanded(), *scene, *contact);
      return false;
    case stepper::ContactSearch::tilted:
      fail_tilted(*scene, *contact);
      return false;
    case stepper::ContactSearch::contact:
      break;
  }
  return finish(state1, part_1.expanded(), part_2.expanded(), *contact);
}

[[gnu::flatten]] bool Ig2_Ball_Socket_JointGeom::go(
    const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
    const yade::State& state1, const yade::State& state2, const Vector3r& shift2, const bool& force,
    const yade::shared_ptr<yade::Interaction>& contact) {
  const auto& ball = static_cast<const Ball&>(*shape1);
  const auto& socket = static_cast<const Socket&>(*shape2);
  const stepper::ThermalLength part_1 = part_of(ball, ball.radius);
  const stepper::ThermalLength part_2 = part_of(socket, socket.radius);
  switch (stepper::find_ball(
      part_1, part_2, motion(state1), shifted(state2, shift2), force || contact->isReal(),
      scene->dt,
      [&](const Vector3r& normal) -> JointGeom& { return geometry_of(contact, normal); })) {
    case stepper::ContactSearch::apart:
    case stepper::ContactSearch::tilted:
      return false;
    case stepper::ContactSearch::closed:
      fail_closed("ball", part_1.expanded(), "socket", part_2.expanded(), *scene, *contact);
      return false;
    case stepper::ContactSearch::contact:
      break;
  }
  return finish(state1, part_1.expanded(), part_2.expanded(), *contact);
}

[[gnu::flatten]] bool Ig2_Ball_Ball_JointGeom::go(
    const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
    const yade::State& state1, const yade::State& state2, const Vector3r& shift2, const bool& force,
    const yade::shared_ptr<yade::Interaction>& contact) {
  const auto& ball_1 = static_cast<const Ball&>(*shape1);
  const auto& ball_2 = static_cast<const Ball&>(*shape2);
  const stepper::ThermalLength part_1 = part_of(ball_1, ball_1.radius);
  const stepper::ThermalLength part_2 = part_of(ball_2, ball_2.radius);
  const kernel::BodyMotion motion_2 = shifted(state2, shift2);
  switch (stepper::find_outer_balls(
      part_1, part_2, motion(state1), motion_2, force || contact->isReal(), scene->dt,
      [&](const Vector3r& normal) -> JointGeom& { return geometry_of(contact, normal); })) {
    case stepper::ContactSearch::apart:
    case stepper::ContactSearch::tilted:
      return false;
    case stepper::ContactSearch::closed:
      fail_inside((state1.se3.position - motion_2.position).norm(), part_1.expanded(),
                  part_2.expanded(), *scene, *contact);
      return false;
    case stepper::ContactSearch::contact:
      break;
  }
  return finish(state1, part_1.expanded(), part_2.expanded(), *contact);
}

[[gnu::flatten]] bool Ig2_Slider_SlotFace_JointGeom::go(
    const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
    const yade::State& state1, const yade::State& state2, const Vector3r& shift2, const bool& force,
    const yade::shared_ptr<yade::Interaction>& contact) {
  const auto& slider = static_cast<const Slider&>(*shape1);
  const auto& face = static_cast<const SlotFace&>(*shape2);
  const stepper::ThermalLength pad = part_of(slider, slider.radius);
  const Vector3r normal = state2.se3.orientation * face.normal;
  const stepper::ContactSearch found = stepper::find_plane(
      pad, part_of(face, face.distance), motion(state1), shifted(state2, shift2), normal,
      force || contact->isReal(), scene->dt,
      [&](const Vector3r& first) -> JointGeom& { return geometry_of(contact, first); });
  return found == stepper::ContactSearch::contact &&
         finish(state1, pad.expanded(), pad.expanded(), *contact);
}

void JointPhys::check() const {
  require_settable(class_name, stepper::contact_quantities<JointPhys>, *this);
}

void Ig2_Journal_Bearing_JointGeom::check() const {
  require_not_negative(class_name, "maxTilt", maxTilt, "[rad]");
}

void Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys::check() const {
  require_not_negative(class_name, "normalDampingRatio", normalDampingRatio, "[-]");
  require_not_negative(class_name, "tangentialDampingRatio", tangentialDampingRatio, "[-]");
}

void Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys::go(
    const yade::shared_ptr<yade::Material>& material1,
    const yade::shared_ptr<yade::Material>& material2,
    const yade::shared_ptr<yade::Interaction>& contact) {
  if (contact->phys) return;
  const auto& first = static_cast<const ThermalFrictMat&>(*material1);
  const auto& second = static_cast<const ThermalFrictMat&>(*material2);
  const bool many = dynamic_cast<const BoreGeom*>(contact->geom.get()) != nullptr;
  auto physics = many ? yade::shared_ptr<JointPhys>(boost::make_shared<BorePhys>())
                      : boost::make_shared<JointPhys>();
  fill_physics(*this, first, second,
               inverse_mass_of(*scene, contact->id1) + inverse_mass_of(*scene, contact->id2),
               *physics, [&](const std::string& sentence) {
                 record_failure({"material_not_allowed"}, sentence, *scene, *contact);
               });
  contact->phys = physics;
}

[[gnu::flatten]] bool Law2_JointGeom_JointPhys_HertzMindlin::go(
    yade::shared_ptr<yade::IGeom>& geometry_pointer, yade::shared_ptr<yade::IPhys>& physics_pointer,
    yade::Interaction* contact) {
  const auto& geometry = static_cast<const JointGeom&>(*geometry_pointer);
  auto& physics = static_cast<JointPhys&>(*physics_pointer);

  return stepper::hertz_mindlin_step(geometry, physics, ContactHost{*scene, *contact, energies_});
}

bool Law2_JointGeom_JointPhys_JointLaw::go(yade::shared_ptr<yade::IGeom>& geometry,
                                           yade::shared_ptr<yade::IPhys>& physics,
                                           yade::Interaction* contact) {
  return step(static_cast<const JointGeom&>(*geometry), static_cast<JointPhys&>(*physics), *contact,
              *scene);
}

}  // namespace statejump::dem
