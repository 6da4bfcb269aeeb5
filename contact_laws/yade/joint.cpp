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

}  // namespace

[[gnu::flatten]] bool Ig2_Journal_Bearing_JointGeom::go(
    const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
    const yade::State& state1, const yade::State& state2, const Vector3r& shift2, const bool& force,
    const yade::shared_ptr<yade::Interaction>& contact) {
  const auto& journal = static_cast<const Journal&>(*shape1);
  const auto& bearing = static_cast<const Bearing&>(*shape2);
  const Real journal_radius = journal.expanded(journal.radius);
  const Real bearing_radius = bearing.expanded(bearing.radius);
  const Vector3r axis = axis_of(state2.se3.orientation);
  kernel::BodyMotion bearing_motion = motion(state2);
  bearing_motion.position += shift2;
  if (!(journal_radius > 0 && bearing_radius > journal_radius)) {
    fail_closed("journal", journal_radius, "bearing", bearing_radius, *scene, *contact);
    return false;
  }
  const bool keep = force || contact->isReal();
  if (!keep && !kernel::revolute_touches(state1.se3.position, journal_radius,
                                         bearing_motion.position, bearing_radius, axis)) {
    return false;
  }
  const Vector3r journal_axis = axis_of(state1.se3.orientation);
  if (journal_axis.cross(axis).squaredNorm() > maxTilt * maxTilt) {
    fail_tilted(*scene, *contact);
    return false;
  }
  const kernel::JointContact found = kernel::revolute_contact(motion(state1), journal_radius,
                                                              bearing_motion, bearing_radius, axis);
  JointGeom& geometry = geometry_of(contact, found.normal);
  geometry.refR1 = journal_radius;
  geometry.refR2 = bearing_radius;
  geometry.journalRadius = journal_radius;
  geometry.bearingRadius = bearing_radius;
  geometry.axis = axis;
  geometry.clearanceRate =
      bearing.radius * bearing.thermalStrainRate - journal.radius * journal.thermalStrainRate;
  geometry.update(found, state1, state2, scene->dt);
  return true;
}

[[gnu::flatten]] bool Ig2_Ball_Socket_JointGeom::go(
    const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
    const yade::State& state1, const yade::State& state2, const Vector3r& shift2, const bool& force,
    const yade::shared_ptr<yade::Interaction>& contact) {
  const auto& ball = static_cast<const Ball&>(*shape1);
  const auto& socket = static_cast<const Socket&>(*shape2);
  const Real ball_radius = ball.expanded(ball.radius);
  const Real socket_radius = socket.expanded(socket.radius);
  kernel::BodyMotion socket_motion = motion(state2);
  socket_motion.position += shift2;
  if (!(ball_radius > 0 && socket_radius > ball_radius)) {
    fail_closed("ball", ball_radius, "socket", socket_radius, *scene, *contact);
    return false;
  }
  const bool keep = force || contact->isReal();
  if (!keep && !kernel::ball_touches(state1.se3.position, ball_radius, socket_motion.position,
                                     socket_radius)) {
    return false;
  }
  const kernel::JointContact found =
      kernel::ball_contact(motion(state1), ball_radius, socket_motion, socket_radius);
  JointGeom& geometry = geometry_of(contact, found.normal);
  geometry.refR1 = ball_radius;
  geometry.refR2 = socket_radius;
  geometry.journalRadius = ball_radius;
  geometry.bearingRadius = socket_radius;
  geometry.axis = Vector3r::Zero();
  geometry.clearanceRate =
      socket.radius * socket.thermalStrainRate - ball.radius * ball.thermalStrainRate;
  geometry.update(found, state1, state2, scene->dt);
  return true;
}

[[gnu::flatten]] bool Ig2_Slider_SlotFace_JointGeom::go(
    const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
    const yade::State& state1, const yade::State& state2, const Vector3r& shift2, const bool& force,
    const yade::shared_ptr<yade::Interaction>& contact) {
  const auto& slider = static_cast<const Slider&>(*shape1);
  const auto& face = static_cast<const SlotFace&>(*shape2);
  const Real radius = slider.expanded(slider.radius);
  const Vector3r normal = state2.se3.orientation * face.normal;
  kernel::BodyMotion face_motion = motion(state2);
  face_motion.position += shift2;
  const kernel::JointContact found = kernel::plane_contact(motion(state1), radius, face_motion,
                                                           normal, face.expanded(face.distance));
  if (found.penetration_depth <= 0 && !force && !contact->isReal()) return false;
  JointGeom& geometry = geometry_of(contact, found.normal);
  geometry.refR1 = radius;
  geometry.refR2 = radius;
  geometry.journalRadius = radius;
  geometry.bearingRadius = std::numeric_limits<Real>::infinity();
  geometry.axis = Vector3r::Zero();
  geometry.clearanceRate =
      face.distance * face.thermalStrainRate - slider.radius * slider.thermalStrainRate;
  geometry.update(found, state1, state2, scene->dt);
  return true;
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
  try {
    const kernel::ElasticPair elastic =
        kernel::elastic_pair(first.young, first.poisson, second.young, second.poisson);
    physics->effectiveYoungModulus = elastic.effective_young_modulus;
    physics->effectiveShearModulus = elastic.effective_shear_modulus;
  } catch (const std::invalid_argument& error) {
    record_failure(error.what(), *scene, *contact);
  }
  physics->tangensOfFrictionAngle = std::tan(std::min(first.frictionAngle, second.frictionAngle));
  if (!(physics->tangensOfFrictionAngle >= 0)) {
    std::ostringstream text;
    text << "frictionAngle = " << std::min(first.frictionAngle, second.frictionAngle)
         << ", allowed is [0, pi/2) rad";
    record_failure(text.str(), *scene, *contact);
  }
  const Real inverse =
      inverse_mass_of(*scene, contact->id1) + inverse_mass_of(*scene, contact->id2);
  physics->effectiveMass = inverse > 0 ? 1 / inverse : 0;
  physics->normalDampingRatio = normalDampingRatio;
  physics->tangentialDampingRatio = tangentialDampingRatio;
  contact->phys = physics;
}

[[gnu::flatten]] bool Law2_JointGeom_JointPhys_HertzMindlin::go(
    yade::shared_ptr<yade::IGeom>& geometry_pointer, yade::shared_ptr<yade::IPhys>& physics_pointer,
    yade::Interaction* contact) {
  const auto& geometry = static_cast<const JointGeom&>(*geometry_pointer);
  auto& physics = static_cast<JointPhys&>(*physics_pointer);

  kernel::ContactHistory history = contact_history(geometry, physics);
  const kernel::ContactKinematics kinematics{geometry.normal, geometry.penetrationDepth,
                                             geometry.effectiveRadius, geometry.relativeVelocity,
                                             scene->dt};
  const kernel::ContactResponse response =
      kernel::hertz_mindlin(contact_parameters(physics), kinematics, history);
  if (scene->trackEnergy) {
    account(
        response, 0, geometry.effectiveRadius,
        [&](Real& work) {  // dV/dR = V / (2 R)
          const Real energy =
              0.5 * (response.normal_elastic_energy + physics.previousElasticEnergy);
          const Real radius = 0.5 * (geometry.effectiveRadius + physics.previousRadius);
          work += energy / (2 * radius) * (geometry.effectiveRadius - physics.previousRadius);
        },
        geometry, physics, *scene, energies_);
  }
  if (geometry.penetrationDepth <= 0) return false;

  exert(response, kernel::contact_wrench(response.force_on_1, geometry.arm1, geometry.arm2),
        history, geometry, physics, *scene, *contact);
  return true;
}

bool Law2_JointGeom_JointPhys_JointLaw::go(yade::shared_ptr<yade::IGeom>& geometry,
                                           yade::shared_ptr<yade::IPhys>& physics,
                                           yade::Interaction* contact) {
  return step(static_cast<const JointGeom&>(*geometry), static_cast<JointPhys&>(*physics), *contact,
              *scene);
}

}  // namespace statejump::dem
