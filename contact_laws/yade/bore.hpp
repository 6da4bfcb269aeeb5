// SPDX-License-Identifier: GPL-3.0-or-later
// Bores and cups given by a triangle mesh: shape, contact search and law. The geometry is computed
// by statejump/geometry, the law at one contact is that of joint.hpp.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "joint.hpp"
#include "registered.hpp"
#include "shapes.hpp"
#include "statejump/geometry/bore_mesh.hpp"
#include "statejump/stepper/bore.hpp"

namespace statejump::dem {

struct MeshBore : RegisteredIndexable<MeshBore, ThermalShape> {
  static constexpr const char* class_name = "MeshBore";
  static constexpr const char* bound_functor_name = "Bo1_MeshBore_Aabb";
  static constexpr const char* view_functor_name = "Gl1_MeshBore";
  static constexpr const char* base_name = "ThermalShape";
  static constexpr const char* doc =
      "Inner surface of a bore for a Journal or Ball, or of a cup for a Ball, given by triangles: "
      "a "
      "file, or vertices and triangles. Contact is with a smooth wall through the vertices, not "
      "with the facets. The body's centre is the mesh's origin; the wall expands about its own "
      "centre. Fixed once it is made; bodies may share one. Saved with its triangles, so that "
      "loading needs no file.";
  std::string file;
  std::vector<Vector3r> vertices;
  std::vector<std::array<int, 3>> triangles;
  Real scale = 1;
  bool flip = false;
  bool socket = false;

  MeshBore() { createIndex(); }
  void check();
  Vector3r half_extents(const yade::Quaternionr& orientation) const;
  const std::optional<geometry::BoreMesh>& mesh() const { return mesh_; }
  Real mean_radius() const;
  Vector3r wall_centre() const;
  Real reconstruction_error() const;
  const std::vector<std::array<int, 2>>& rim() const { return rim_; }  // edges, for the view
  std::vector<Real> section_radii(Real z, int count) const;

  static auto attributes() {
    return std::make_tuple(
        read_only(
            "file", &MeshBore::file,
            "OFF, STL, PLY or OBJ file, read when there are no vertices; else only a name [-]"),
        read_only("vertices", &MeshBore::vertices, "As given or read, before scale [file's unit]"),
        read_only("triangles", &MeshBore::triangles,
                  "Three numbers of vertices each, anticlockwise seen from the free side [-]"),
        read_only("scale", &MeshBore::scale, "Unit of the vertices [m], 1e-3 for millimetres"),
        read_only("flip", &MeshBore::flip, "Whether to turn every triangle over [-]"),
        read_only("socket", &MeshBore::socket, "A cup with one open rim, not a through-hole [-]"));
  }
  template <class PythonClass>
  static void register_methods(PythonClass& entry) {
    entry.def("meanRadius", &MeshBore::mean_radius,
              "Radius of the cylinder (sphere) of least squares at the reference temperature [m]");
    entry.def("wallCentre", &MeshBore::wall_centre,
              "Point of the mesh's axes about which the wall expands [m]");
    entry.def("reconstructionError", &MeshBore::reconstruction_error,
              "Estimate of the error of the smooth wall [m]");
    entry.def(
        "sectionRadii", &MeshBore::section_radii,
        (boost::python::arg("z"), boost::python::arg("count")),
        "Radii of the smooth wall [m] around its axis in the section at z [m] from its middle "
        "along the axis, at equal angles; NaN where there is no wall");
  }

 private:
  void make_mesh();
  const geometry::BoreMesh& made() const;
  std::optional<geometry::BoreMesh> mesh_;  // made by check()
  std::vector<std::array<int, 2>> rim_;
  Vector3r half_box_ = Vector3r::Zero();
};

// Vertices and triangles of a bore or of a cup, as keyword arguments of MeshBore.
boost::python::dict bore_triangles(Real radius, Real length, int around, int along,
                                   const boost::python::object& lobes, Real wear_depth,
                                   Real wear_angle, Real wear_width, Real crown,
                                   Real wall_thickness);
boost::python::dict socket_triangles(Real radius, Real opening, int around, int along);
void register_triangles_converter();

struct BoreGeom : RegisteredIndexable<BoreGeom, yade::GenericSpheresContact> {
  static constexpr const char* class_name = "BoreGeom";
  static constexpr const char* base_name = "GenericSpheresContact";
  static constexpr const char* doc =
      "Geometry of all contacts of a Journal or Ball with a MeshBore: YADE keeps one interaction "
      "per pair of bodies. normal and contactPoint are those of the deepest contact. dict() holds "
      "besides: numberOfContacts, penetrationDepths [m], contactPoints [m], all of contacts that "
      "touch.";
  std::vector<yade::shared_ptr<JointGeom>> contacts;
  std::vector<int> previous;
  std::vector<Real> known;
  Real strain_change = 0;  // of the wall in this step [-]; set in every step, so not saved

  BoreGeom() { createIndex(); }
  boost::python::dict pyDict() const override;
  int number_of_contacts() const;
  std::vector<Real> penetration_depths() const;
  std::vector<Vector3r> contact_points() const;
  static auto attributes() {
    return std::make_tuple(
        read_only("contacts", &BoreGeom::contacts,
                  "A JointGeom for each contact, deepest at the last search first; a gap is a "
                  "contact that has just ended [-]"),
        read_only("previous", &BoreGeom::previous,
                  "Which contact of the last step each continues, -1 for a new one [-]"),
        read_only(
            "known", &BoreGeom::known,
            "What is known of the wall around the journal: where it was searched whole and the "
            "wall at the contacts, in its axes [m, 1/m, -]"));
  }
  template <class PythonClass>
  static void register_methods(PythonClass& entry) {
    entry.add_property("numberOfContacts", &BoreGeom::number_of_contacts,
                       "Number of contacts that touch [-]");
    entry.add_property("penetrationDepths", &BoreGeom::penetration_depths, "Their depths [m]");
    entry.add_property("contactPoints", &BoreGeom::contact_points, "Their places [m]");
  }
};

struct BorePhys : RegisteredIndexable<BorePhys, JointPhys> {
  static constexpr const char* class_name = "BorePhys";
  static constexpr const char* base_name = "JointPhys";
  static constexpr const char* doc =
      "Physics of all contacts of a Journal or Ball with a MeshBore. kn, ks, normalForce and "
      "shearForce are sums; slipping says whether all slip. dict() holds besides: normalForces [N] "
      "of the contacts that touch.";
  std::vector<yade::shared_ptr<JointPhys>> contacts;

  BorePhys() { createIndex(); }
  boost::python::dict pyDict() const override;
  std::vector<Vector3r> normal_forces() const;
  static auto attributes() {
    return std::make_tuple(read_only("contacts", &BorePhys::contacts,
                                     "A JointPhys for each contact of BoreGeom.contacts, with its "
                                     "history of friction [-]"));
  }
  template <class PythonClass>
  static void register_methods(PythonClass& entry) {
    entry.add_property("normalForces", &BorePhys::normal_forces,
                       "Normal force of each contact that touches, on body 2 [N]");
  }
};

// Contact search of a pair. Two functors use it, for different types of body 1.
class BoreContacts {
 public:
  Real patchAngle = 2e-4;

 protected:
  void check_patch_angle(const char* class_name) const;
  bool find(const stepper::BoreProbe& probe, const MeshBore& bore, const yade::State& state1,
            const yade::State& state2, const Vector3r& shift2, bool force,
            const yade::shared_ptr<yade::Interaction>& contact, yade::Scene& scene) const;
  static constexpr const char* patch_angle_doc =
      "Angle by which the normal of a contact may turn before the smooth wall is asked again at "
      "its new place; until then the wall around it has the curvature found there. 0: search the "
      "whole wall in every step [rad]";
};

struct Ig2_Journal_MeshBore_BoreGeom
    : Registered<Ig2_Journal_MeshBore_BoreGeom, yade::IGeomFunctor>,
      BoreContacts {
  static constexpr const char* class_name = "Ig2_Journal_MeshBore_BoreGeom";
  static constexpr const char* base_name = "IGeomFunctor";
  static constexpr const char* doc =
      "All contacts of a Journal in a MeshBore, in the section across the journal's axis through "
      "its centre. The axes must be parallel within maxTilt, as in a Bearing. Where the wall is "
      "hollow its radius of curvature must be above the journal's, otherwise the run stops; it may "
      "bulge, too.";
  Real maxTilt = 1e-3;
  using yade::IGeomFunctor::go;
  bool go(const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
          const yade::State& state1, const yade::State& state2, const Vector3r& shift2,
          const bool& force, const yade::shared_ptr<yade::Interaction>& contact) override;
  std::string checkOrder() const override { return "Journal MeshBore"; }
  std::string get2DFunctorType1() const override { return "Journal"; }
  std::string get2DFunctorType2() const override { return "MeshBore"; }
  void check() const;
  static auto attributes() {
    using Self = Ig2_Journal_MeshBore_BoreGeom;
    return std::make_tuple(
        attribute("maxTilt", &Self::maxTilt, "Largest angle between the axes [rad]"),
        attribute("patchAngle", static_cast<Real Self::*>(&Self::patchAngle), patch_angle_doc));
  }
};

struct Ig2_Ball_MeshBore_BoreGeom : Registered<Ig2_Ball_MeshBore_BoreGeom, yade::IGeomFunctor>,
                                    BoreContacts {
  static constexpr const char* class_name = "Ig2_Ball_MeshBore_BoreGeom";
  static constexpr const char* base_name = "IGeomFunctor";
  static constexpr const char* doc =
      "All contacts of a Ball with a MeshBore. The law takes the wall for a sphere whose curvature "
      "is the mean of the two principal ones there: good where they are nearly equal, as in a cup; "
      "a through-hole, whose wall is straight along its axis, is touched along an ellipse, which "
      "is not covered.";
  using yade::IGeomFunctor::go;
  bool go(const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
          const yade::State& state1, const yade::State& state2, const Vector3r& shift2,
          const bool& force, const yade::shared_ptr<yade::Interaction>& contact) override;
  std::string checkOrder() const override { return "Ball MeshBore"; }
  std::string get2DFunctorType1() const override { return "Ball"; }
  std::string get2DFunctorType2() const override { return "MeshBore"; }
  void check() const { check_patch_angle(class_name); }
  static auto attributes() {
    using Self = Ig2_Ball_MeshBore_BoreGeom;
    return std::make_tuple(
        attribute("patchAngle", static_cast<Real Self::*>(&Self::patchAngle), patch_angle_doc));
  }
};

struct Law2_BoreGeom_BorePhys_JointLaw
    : Registered<Law2_BoreGeom_BorePhys_JointLaw, yade::LawFunctor>,
      NamedJointLaw {
  static constexpr const char* class_name = "Law2_BoreGeom_BorePhys_JointLaw";
  static constexpr const char* base_name = "LawFunctor";
  static constexpr const char* doc =
      "Law2_JointGeom_JointPhys_JointLaw at every contact of a Journal or Ball with a MeshBore, "
      "with the wall's radius of curvature there as the radius of the bearing. Its attributes and "
      "entries in O.energy are the same; tangentialVelocity must be 'material'. That the curvature "
      "changes along the wall makes no force; what the elastic energy changes by it, a small part "
      "of it where journal and wall conform, is in no entry.";

  Law2_BoreGeom_BorePhys_JointLaw() { check(); }
  using yade::LawFunctor::go;
  bool go(yade::shared_ptr<yade::IGeom>& geometry, yade::shared_ptr<yade::IPhys>& physics,
          yade::Interaction* contact) override;
  std::string get2DFunctorType1() const override { return "BoreGeom"; }
  std::string get2DFunctorType2() const override { return "BorePhys"; }
  void check();
  static auto attributes() { return law_attributes<Law2_BoreGeom_BorePhys_JointLaw>(); }
};

}  // namespace statejump::dem
