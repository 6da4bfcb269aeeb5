// SPDX-License-Identifier: GPL-3.0-or-later
#include "bore.hpp"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <iterator>
#include <sstream>

#include "contact_parts.hpp"
#include "failure.hpp"
#include "ranges.hpp"
#include "statejump/geometry/mesh_failure.hpp"
#include "statejump/stepper/bore.hpp"

namespace statejump::dem {
namespace {

namespace py = boost::python;

struct TrianglesConverter {
  using List = std::vector<std::array<int, 3>>;
  static PyObject* convert(const List& list) {
    py::list result;
    for (const auto& t : list) result.append(py::make_tuple(t[0], t[1], t[2]));
    return py::incref(result.ptr());
  }
  static void* accepts(PyObject* object) {
    return PySequence_Check(object) && !PyUnicode_Check(object) ? object : nullptr;
  }
  static void construct(PyObject* object, py::converter::rvalue_from_python_stage1_data* data) {
    void* storage =
        reinterpret_cast<py::converter::rvalue_from_python_storage<List>*>(data)->storage.bytes;
    const py::object sequence{py::handle<>(py::borrowed(object))};
    List list;
    for (py::ssize_t i = 0; i < py::len(sequence); ++i) {
      const py::object corners = sequence[i];
      if (py::len(corners) != 3) {
        dem::refuse({"no_triangle", "MeshBore.triangles", std::to_string(i)});
      }
      list.push_back({py::extract<int>(corners[0]), py::extract<int>(corners[1]),
                      py::extract<int>(corners[2])});
    }
    data->convertible = new (storage) List(std::move(list));
  }
};

py::dict keywords_of(const geometry::Triangles& made, bool socket) {
  py::dict result;
  result["vertices"] = std::vector<Vector3r>(made.vertices.begin(), made.vertices.end());
  result["triangles"] = made.faces;
  if (socket) result["socket"] = true;
  return result;
}

}  // namespace

void register_triangles_converter() {
  using List = TrianglesConverter::List;
  py::to_python_converter<List, TrianglesConverter>();
  py::converter::registry::push_back(&TrianglesConverter::accepts, &TrianglesConverter::construct,
                                     py::type_id<List>());
}

py::dict bore_triangles(Real radius, Real length, int around, int along, const py::object& lobes,
                        Real wear_depth, Real wear_angle, Real wear_width, Real crown,
                        Real wall_thickness) {
  geometry::BoreShape shape;
  shape.radius = radius;
  shape.length = length;
  for (py::ssize_t i = 0; i < py::len(lobes); ++i) {
    const py::object lobe = lobes[i];
    const Real phase = py::len(lobe) > 2 ? Real(py::extract<Real>(lobe[2])) : Real(0);
    shape.lobes.push_back({py::extract<int>(lobe[0]), py::extract<Real>(lobe[1]), phase});
  }
  shape.wear_depth = wear_depth;
  shape.wear_angle = wear_angle;
  shape.wear_width = wear_width;
  shape.crown = crown;
  shape.wall_thickness = wall_thickness;
  return keywords_of(geometry::bore_triangles(shape, around, along), false);
}

py::dict socket_triangles(Real radius, Real opening, int around, int along) {
  return keywords_of(geometry::socket_triangles(radius, opening, around, along), true);
}

// ---- shape

void MeshBore::make_mesh() {
  if (vertices.empty() && triangles.empty()) {
    geometry::Triangles read = geometry::read_triangles(file);
    vertices.assign(read.vertices.begin(), read.vertices.end());
    triangles = std::move(read.faces);
  }
  geometry::BoreOptions options;
  options.kind = socket ? geometry::SurfaceKind::socket : geometry::SurfaceKind::bore;
  options.scale = scale;
  options.flip = flip;
  mesh_.emplace(geometry::Triangles{vertices, triangles}, options,
                file.empty() ? std::string(class_name) : file);
}

void MeshBore::check() {
  require_positive(class_name, "scale", scale, "[m]");
  if (mesh_ || (file.empty() && vertices.empty() && triangles.empty())) return;
  try {
    make_mesh();
  } catch (const geometry::MeshFailure& failure) {
    keep({failure.reason_name(), class_name, failure.file(), "", failure.what()});
    throw;
  }
  for (const Vector3r& vertex : mesh_->triangles().vertices) {
    half_box_ = half_box_.cwiseMax(vertex.cwiseAbs());
  }
  // `edges` collects edges of only one triangle. Two neighbours contain their common edge in
  // opposite directions.
  std::vector<std::array<int, 2>> edges, opposite;
  for (const auto& face : mesh_->triangles().faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      edges.push_back({face[k], face[(k + 1) % 3]});
      opposite.push_back({face[(k + 1) % 3], face[k]});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(opposite.begin(), opposite.end());
  std::set_difference(edges.begin(), edges.end(), opposite.begin(), opposite.end(),
                      std::back_inserter(rim_));
}

const geometry::BoreMesh& MeshBore::made() const {
  if (!mesh_) throw std::logic_error("MeshBore: construct it with a file or with triangles");
  return *mesh_;
}

Real MeshBore::mean_radius() const {
  return made().mean_radius();
}

Vector3r MeshBore::wall_centre() const {
  return made().centre();
}

Real MeshBore::reconstruction_error() const {
  return made().reconstruction_error();
}

std::vector<Real> MeshBore::section_radii(Real z, int count) const {
  return made().section_radii(z, count);
}

Vector3r MeshBore::half_extents(const yade::Quaternionr& orientation) const {
  const Real grown = 1 + 2 * std::abs(thermalStrain);
  return orientation.toRotationMatrix().cwiseAbs() * (grown * half_box_);
}

// ---- geometry and physics of a pair

int BoreGeom::number_of_contacts() const {
  return static_cast<int>(std::count_if(contacts.begin(), contacts.end(),
                                        [](const auto& c) { return c->penetrationDepth > 0; }));
}

std::vector<Real> BoreGeom::penetration_depths() const {
  std::vector<Real> result;
  for (const auto& c : contacts) {
    if (c->penetrationDepth > 0) result.push_back(c->penetrationDepth);
  }
  return result;
}

std::vector<Vector3r> BoreGeom::contact_points() const {
  std::vector<Vector3r> result;
  for (const auto& c : contacts) {
    if (c->penetrationDepth > 0) result.push_back(c->contactPoint);
  }
  return result;
}

py::dict BoreGeom::pyDict() const {
  py::dict result = Registered::pyDict();
  result["numberOfContacts"] = number_of_contacts();
  result["penetrationDepths"] = penetration_depths();
  result["contactPoints"] = contact_points();
  return result;
}

std::vector<Vector3r> BorePhys::normal_forces() const {
  std::vector<Vector3r> result;
  for (const auto& c : contacts) {
    if (!c->normalForce.isZero()) result.push_back(c->normalForce);
  }
  return result;
}

py::dict BorePhys::pyDict() const {
  py::dict result = Registered::pyDict();
  result["normalForces"] = normal_forces();
  return result;
}

// ---- contacts

namespace {

[[gnu::cold, gnu::noinline]] void fail_curvature(const char* inner, Real radius, Real wall_radius,
                                                 const Vector3r& point, const yade::Scene& scene,
                                                 const yade::Interaction& contact) {
  std::ostringstream text;
  text.precision(9);
  text << "the wall of the MeshBore conforms too closely: its radius of curvature is "
       << wall_radius << " m, that of the " << inner << " " << radius << " m,";
  text << " at the contact at (" << point.x() << ", " << point.y() << ", " << point.z() << ") m";
  record_failure(
      {"wall_conforms", "radius of curvature", text_of(wall_radius), "above " + text_of(radius)},
      text.str(), scene, contact);
}

}  // namespace

void BoreContacts::check_patch_angle(const char* class_name) const {
  if (!(patchAngle >= 0 && patchAngle <= 0.01)) {
    refuse(class_name, "patchAngle", patchAngle, "in [0, 0.01] [rad]");
  }
}

void Ig2_Journal_MeshBore_BoreGeom::check() const {
  require_not_negative(class_name, "maxTilt", maxTilt, "[rad]");
  check_patch_angle(class_name);
}

bool BoreContacts::find(const stepper::BoreProbe& probe, const MeshBore& bore,
                        const yade::State& state1, const yade::State& state2,
                        const Vector3r& shift2, bool force,
                        const yade::shared_ptr<yade::Interaction>& contact,
                        yade::Scene& scene) const {
  if (!bore.mesh()) {
    record_failure({"bore_missing"}, "a MeshBore has neither a file nor triangles", scene,
                   *contact);
    return false;
  }
  stepper::BoreStep step;
  // The wall's geometry and the kernel may throw, but no exception may reach YADE's loop.
  try {
    step = stepper::find_in_bore(
        probe, {*bore.mesh(), bore.expanded(1), bore.thermalStrainRate, patchAngle}, motion(state1),
        motion(state2), state2.se3.orientation, state1.se3.position - state2.se3.position - shift2,
        force || contact->isReal(), scene.dt,
        // The interaction becomes real only when it also has physics.
        [&]() -> BoreGeom& {
          if (!contact->geom) contact->geom = boost::make_shared<BoreGeom>();
          return static_cast<BoreGeom&>(*contact->geom);
        });
  } catch (const std::exception& error) {
    record_failure({"bore_failed"}, error.what(), scene, *contact);
    return false;
  }
  switch (step.found) {
    case stepper::BoreSearch::undefined:
      record_failure({"no_position"}, "no place of the parts against each other", scene, *contact);
      return false;
    case stepper::BoreSearch::conforming:
      fail_curvature(probe.is_ball ? "ball" : "journal", probe.radius, step.wall_radius,
                     step.position, scene, *contact);
      return false;
    case stepper::BoreSearch::apart:
      return false;
    case stepper::BoreSearch::contact:
      break;
  }
  return true;
}

bool Ig2_Journal_MeshBore_BoreGeom::go(const yade::shared_ptr<yade::Shape>& shape1,
                                       const yade::shared_ptr<yade::Shape>& shape2,
                                       const yade::State& state1, const yade::State& state2,
                                       const Vector3r& shift2, const bool& force,
                                       const yade::shared_ptr<yade::Interaction>& contact) {
  const auto& journal = static_cast<const Journal&>(*shape1);
  const auto& bore = static_cast<const MeshBore&>(*shape2);
  const stepper::BoreProbe probe{false, journal.expanded(journal.radius),
                                 journal.radius * journal.thermalStrainRate,
                                 axis_of(state1.se3.orientation)};
  if (bore.mesh() &&
      stepper::tilted_in_bore(probe.axis, *bore.mesh(), state2.se3.orientation, maxTilt)) {
    fail_tilted(*scene, *contact);
    return false;
  }
  return find(probe, bore, state1, state2, shift2, force, contact, *scene);
}

bool Ig2_Ball_MeshBore_BoreGeom::go(const yade::shared_ptr<yade::Shape>& shape1,
                                    const yade::shared_ptr<yade::Shape>& shape2,
                                    const yade::State& state1, const yade::State& state2,
                                    const Vector3r& shift2, const bool& force,
                                    const yade::shared_ptr<yade::Interaction>& contact) {
  const auto& ball = static_cast<const Ball&>(*shape1);
  const stepper::BoreProbe probe{true, ball.expanded(ball.radius),
                                 ball.radius * ball.thermalStrainRate, Vector3r::Zero()};
  return find(probe, static_cast<const MeshBore&>(*shape2), state1, state2, shift2, force, contact,
              *scene);
}

// ---- law

void Law2_BoreGeom_BorePhys_JointLaw::check() {
  build(class_name);
  // A measured wall has no centre for an axis.
  using kernel::laws::TangentialVelocityLaw;
  using kernel::laws::Trait;
  if (kernel::laws::has(law().tangential_velocity, Trait::needs_axis)) {
    dem::refuse(class_name, "tangentialVelocity", tangentialVelocity,
                kernel::laws::names_with<TangentialVelocityLaw>(Trait::needs_axis, false));
  }
}

bool Law2_BoreGeom_BorePhys_JointLaw::go(yade::shared_ptr<yade::IGeom>& geometry_pointer,
                                         yade::shared_ptr<yade::IPhys>& physics_pointer,
                                         yade::Interaction* contact) {
  return stepper::bore_law_step(static_cast<const BoreGeom&>(*geometry_pointer),
                                static_cast<BorePhys&>(*physics_pointer),
                                [&](const JointGeom& here, JointPhys& physics) {
                                  return step(here, physics, *contact, *scene);
                                });
}

}  // namespace statejump::dem
