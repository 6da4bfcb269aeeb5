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
#include "statejump/geometry/follow.hpp"

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
        throw std::invalid_argument("a triangle has three corners, number " + std::to_string(i) +
                                    " has another number of them");
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

void MeshBore::check() {
  require_positive(class_name, "scale", scale, "[m]");
  if (mesh_ || (file.empty() && vertices.empty() && triangles.empty())) return;
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
  for (const Vector3r& vertex : mesh_->triangles().vertices) {
    half_box_ = half_box_.cwiseMax(vertex.cwiseAbs());
  }
  // Edges of one triangle only; neighbours run along an edge in opposite directions.
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

struct BoreContacts::Probe {
  bool is_ball;
  Real radius;       // at its temperature [m]
  Real radius_rate;  // by expansion [m/s]
  Vector3r axis;     // world; zero for a ball
};

namespace {

[[gnu::cold, gnu::noinline]] void fail_curvature(const char* inner, Real radius, Real wall_radius,
                                                 const Vector3r& point, const yade::Scene& scene,
                                                 const yade::Interaction& contact) {
  std::ostringstream text;
  text.precision(9);
  text << "the wall of the MeshBore conforms too closely: its radius of curvature is "
       << wall_radius << " m, that of the " << inner << " " << radius << " m,";
  text << " at the contact at (" << point.x() << ", " << point.y() << ", " << point.z() << ") m";
  record_failure(text.str(), scene, contact);
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

bool BoreContacts::find(const Probe& probe, const MeshBore& bore, const yade::State& state1,
                        const yade::State& state2, const Vector3r& shift2, bool force,
                        const yade::shared_ptr<yade::Interaction>& contact,
                        yade::Scene& scene) const {
  // None of what this calls, the wall's geometry and the kernel, may throw out of YADE's loop.
  try {
    return find_or_throw(probe, bore, state1, state2, shift2, force, contact, scene);
  } catch (const std::exception& error) {
    record_failure(error.what(), scene, *contact);
    return false;
  }
}

bool BoreContacts::find_or_throw(const Probe& probe, const MeshBore& bore,
                                 const yade::State& state1, const yade::State& state2,
                                 const Vector3r& shift2, bool force,
                                 const yade::shared_ptr<yade::Interaction>& contact,
                                 yade::Scene& scene) const {
  if (!bore.mesh()) {
    record_failure("a MeshBore has neither a file nor triangles", scene, *contact);
    return false;
  }
  const geometry::BoreMesh& mesh = *bore.mesh();
  const bool keep = force || contact->isReal();
  const Eigen::Matrix3d turn = state2.se3.orientation.toRotationMatrix();
  const Vector3r centres = state1.se3.position - state2.se3.position - shift2;
  const Real grown = bore.expanded(1);
  const Vector3r centre = mesh.centre() + (turn.transpose() * centres - mesh.centre()) / grown;
  const Vector3r axis = turn.transpose() * probe.axis;
  const Real radius = probe.radius / grown;
  if (!stepper::is_plain(centre) || !(radius > 0)) {
    record_failure("no place of the parts against each other", scene, *contact);
    return false;
  }

  // Even without contact the pair keeps what is known of the wall; it is real only with physics.
  if (!contact->geom) contact->geom = boost::make_shared<BoreGeom>();
  auto& pair = static_cast<BoreGeom&>(*contact->geom);
  thread_local std::vector<geometry::FollowedContact> found;
  geometry::follow_contacts(mesh, {centre, axis, radius}, patchAngle, pair.known, found);

  // The list of contacts. Most steps leave it as it is.
  std::size_t touching = 0;
  bool same = true;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool touches = found[i].distance < radius;
    const int now = touches ? static_cast<int>(touching) : -1;
    same = same && found[i].label == now;
    geometry::set_label(pair.known, i, now);
    touching += touches;
  }
  same = same && touching == pair.contacts.size();
  if (same) {
    for (std::size_t i = 0; i < touching; ++i) pair.previous[i] = static_cast<int>(i);
  } else {
    const auto old = pair.contacts;
    std::vector<char> continues(old.size(), 0);
    pair.contacts.clear();
    pair.previous.clear();
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!(found[i].distance < radius)) continue;
      const int before = found[i].label;
      pair.previous.push_back(before);
      if (before >= 0) {
        pair.contacts.push_back(old[static_cast<std::size_t>(before)]);
        continues[static_cast<std::size_t>(before)] = 1;
      } else {
        auto fresh = boost::make_shared<JointGeom>();
        fresh->normal = turn * found[i].normal;
        pair.contacts.push_back(fresh);
      }
    }
    // Contacts that have just ended, for the law to close their account.
    for (std::size_t i = 0; i < old.size(); ++i) {
      if (continues[i] || !(old[i]->penetrationDepth > 0)) continue;
      old[i]->eccentricity -= old[i]->penetrationDepth;
      old[i]->penetrationDepth = 0;
      old[i]->previousNormal = old[i]->normal;
      old[i]->clearanceRate = 0;
      pair.contacts.push_back(old[i]);
      pair.previous.push_back(static_cast<int>(i));
    }
  }

  pair.refR1 = pair.refR2 = probe.radius;
  pair.strain_change = bore.thermalStrainRate * scene.dt / grown;
  const kernel::BodyMotion motion1 = motion(state1);
  const kernel::BodyMotion motion2 = motion(state2);
  const Vector3r world_axis = probe.is_ball ? Vector3r(Vector3r::Zero()) : turn * mesh.axis();
  std::size_t next = 0;
  Real deepest = 0;
  for (const geometry::FollowedContact& one : found) {
    if (!(one.distance < radius)) continue;
    const bool is_new = pair.previous[next] < 0;
    JointGeom& geometry = *pair.contacts[next++];
    const Vector3r foot = centre - mesh.centre() + one.distance * one.normal;
    const Real wall_radius = grown / one.curvature;
    if (wall_radius > 0 && !(wall_radius > probe.radius)) {
      fail_curvature(probe.is_ball ? "ball" : "journal", probe.radius, wall_radius,
                     state1.se3.position + turn * (probe.radius * one.normal), scene, *contact);
      return false;
    }
    kernel::JointContact here;
    here.normal = turn * one.normal;
    here.penetration_depth = grown * (radius - one.distance);
    here.effective_radius = kernel::internal_effective_radius(probe.radius, wall_radius);
    here.arm_1 = (probe.radius - 0.5 * here.penetration_depth) * here.normal;
    here.arm_2 = centres + here.arm_1;
    here.relative_velocity = kernel::material_velocity(motion1, here.arm_1) -
                             kernel::material_velocity(motion2, here.arm_2);
    // What expansion alone does to the depth: the foot moves away from the wall's centre. The
    // clearance is the sum of that, so that motion along an uneven wall does not count as
    // expansion.
    const Real reach = foot.dot(one.normal);
    const Real clearance_rate = bore.thermalStrainRate * reach - probe.radius_rate;
    const Real clearance =
        is_new ? grown * reach - probe.radius
               : geometry.eccentricity - geometry.penetrationDepth + clearance_rate * scene.dt;
    here.eccentricity = here.penetration_depth + clearance;
    geometry.refR1 = probe.radius;
    geometry.refR2 = std::abs(wall_radius);
    geometry.journalRadius = probe.radius;
    geometry.bearingRadius = wall_radius;
    geometry.axis = world_axis;
    geometry.clearanceRate = clearance_rate;
    stepper::update(here, motion1, motion2, scene.dt, geometry);
    geometry.contactPoint = state1.se3.position + geometry.arm1;
    if (here.penetration_depth > deepest) {
      deepest = here.penetration_depth;
      pair.normal = here.normal;
      pair.contactPoint = geometry.contactPoint;
      pair.refR2 = std::abs(wall_radius);
    }
  }
  return keep || touching > 0;
}

bool Ig2_Journal_MeshBore_BoreGeom::go(const yade::shared_ptr<yade::Shape>& shape1,
                                       const yade::shared_ptr<yade::Shape>& shape2,
                                       const yade::State& state1, const yade::State& state2,
                                       const Vector3r& shift2, const bool& force,
                                       const yade::shared_ptr<yade::Interaction>& contact) {
  const auto& journal = static_cast<const Journal&>(*shape1);
  const auto& bore = static_cast<const MeshBore&>(*shape2);
  const Probe probe{false, journal.expanded(journal.radius),
                    journal.radius * journal.thermalStrainRate, axis_of(state1.se3.orientation)};
  if (bore.mesh() &&
      !(probe.axis.cross(state2.se3.orientation * bore.mesh()->axis()).squaredNorm() <=
        maxTilt * maxTilt)) {
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
  const Probe probe{true, ball.expanded(ball.radius), ball.radius * ball.thermalStrainRate,
                    Vector3r::Zero()};
  return find(probe, static_cast<const MeshBore&>(*shape2), state1, state2, shift2, force, contact,
              *scene);
}

// ---- law

void Law2_BoreGeom_BorePhys_JointLaw::check() {
  build(class_name);
  // A measured wall has no centre that the axis would run through.
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
  auto& geometry = static_cast<BoreGeom&>(*geometry_pointer);
  auto& pair = static_cast<BorePhys&>(*physics_pointer);
  const std::size_t count = geometry.contacts.size();
  bool same = pair.contacts.size() == count;
  for (std::size_t i = 0; same && i < count; ++i) {
    same = geometry.previous[i] == static_cast<int>(i);
  }
  if (!same) {
    const auto old = pair.contacts;
    pair.contacts.clear();
    for (const int before : geometry.previous) {
      if (before >= 0 && before < static_cast<int>(old.size())) {
        pair.contacts.push_back(old[static_cast<std::size_t>(before)]);
        continue;
      }
      auto fresh = boost::make_shared<JointPhys>();
      fresh->effectiveYoungModulus = pair.effectiveYoungModulus;
      fresh->effectiveShearModulus = pair.effectiveShearModulus;
      fresh->effectiveMass = pair.effectiveMass;
      fresh->normalDampingRatio = pair.normalDampingRatio;
      fresh->tangentialDampingRatio = pair.tangentialDampingRatio;
      fresh->tangensOfFrictionAngle = pair.tangensOfFrictionAngle;
      pair.contacts.push_back(fresh);
    }
  }
  bool touching = false;
  pair.kn = pair.ks = 0;
  pair.slipping = true;
  pair.normalForce = pair.shearForce = Vector3r::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const JointGeom& here = *geometry.contacts[i];
    JointPhys& physics = *pair.contacts[i];
    // The part of the wall's radius that expansion has changed; the rest is another place.
    physics.previousBearingRadius = here.bearingRadius * (1 - geometry.strain_change);
    if (!step(here, physics, *contact, *scene)) continue;
    touching = true;
    pair.kn += physics.kn;
    pair.ks += physics.ks;
    pair.slipping = pair.slipping && physics.slipping;
    pair.normalForce += physics.normalForce;
    pair.shearForce += physics.shearForce;
  }
  return touching;
}

}  // namespace statejump::dem
