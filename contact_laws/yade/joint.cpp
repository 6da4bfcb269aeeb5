#include "joint.hpp"

#include <boost/make_shared.hpp>
#include <cmath>
#include <limits>
#include <sstream>

#include "blocked_motion.hpp"
#include "failure.hpp"
#include "ranges.hpp"
#include "shapes.hpp"
#include "thermal.hpp"

namespace statejump::dem {
namespace {

kernel::BodyMotion motion(const yade::State& state) {
  return {state.se3.position, state.vel, state.angVel};
}

std::string where(const yade::Scene& scene, int id1, int id2, const std::string& more = "") {
  std::ostringstream text;
  text.precision(9);
  text << " (contact of bodies " << id1 << " and " << id2 << ", time " << scene.time << " s" << more
       << ")";
  return text.str();
}

// Failures apart from the path of every step, which stays short and free of text.
[[gnu::cold, gnu::noinline]] void fail_closed(const char* inner, Real inner_radius,
                                              const char* outer, Real outer_radius,
                                              const yade::Scene& scene,
                                              const yade::Interaction& contact) {
  std::ostringstream text;
  text.precision(9);
  text << "the clearance is closed: " << inner << " radius " << inner_radius << " m, " << outer
       << " radius " << outer_radius << " m at the current temperature"
       << where(scene, contact.id1, contact.id2);
  record_failure(text.str());
}

[[gnu::cold, gnu::noinline]] void fail_tilted(const yade::Scene& scene,
                                              const yade::Interaction& contact) {
  record_failure(
      "the axes of journal and bearing are tilted by more than maxTilt, and contact "
      "at the edges is not covered" +
      where(scene, contact.id1, contact.id2));
}

[[gnu::cold, gnu::noinline]] void fail_unstable(Real effective_mass, Real stiffness,
                                                const yade::Scene& scene,
                                                const yade::Interaction& contact) {
  std::ostringstream text;
  text.precision(6);
  text << "the time step " << scene.dt << " s is above the stable one, "
       << kernel::critical_time_step(effective_mass, stiffness) << " s"
       << where(scene, contact.id1, contact.id2);
  record_failure(text.str());
}

// Local z axis in the world: orientation * (0, 0, 1) without the products with zero.
Vector3r axis_of(const yade::Quaternionr& q) {
  return {2 * (q.x() * q.z() + q.w() * q.y()), 2 * (q.y() * q.z() - q.w() * q.x()),
          1 - 2 * (q.x() * q.x() + q.y() * q.y())};
}

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

inline void JointGeom::update(const kernel::JointContact& contact, const yade::State& state1,
                              const yade::State& state2, Real time_step) {
  previousNormal = normal;
  normal = contact.normal;
  penetrationDepth = contact.penetration_depth;
  effectiveRadius = contact.effective_radius;
  eccentricity = contact.eccentricity;
  relativeVelocity = contact.relative_velocity;
  arm1 = contact.arm_1;
  arm2 = contact.arm_2;
  contactPoint = state1.se3.position + arm1;
  // The history turns with the mean spin of both bodies about the normal.
  twistAngle = 0.5 * time_step * (state1.angVel + state2.angVel).dot(normal);
}

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
  geometry.bearingRadius = 0;
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
  auto physics = boost::make_shared<JointPhys>();
  try {
    const kernel::ElasticPair elastic =
        kernel::elastic_pair(first.young, first.poisson, second.young, second.poisson);
    physics->effectiveYoungModulus = elastic.effective_young_modulus;
    physics->effectiveShearModulus = elastic.effective_shear_modulus;
  } catch (const std::invalid_argument& error) {
    record_failure(error.what() + where(*scene, contact->id1, contact->id2));
  }
  physics->tangensOfFrictionAngle = std::tan(std::min(first.frictionAngle, second.frictionAngle));
  if (!(physics->tangensOfFrictionAngle >= 0)) {
    std::ostringstream text;
    text << "frictionAngle = " << std::min(first.frictionAngle, second.frictionAngle)
         << ", allowed is [0, pi/2) rad" << where(*scene, contact->id1, contact->id2);
    record_failure(text.str());
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
  const Real dt = scene->dt;

  const kernel::ContactParameters parameters{
      {physics.effectiveYoungModulus, physics.effectiveShearModulus},
      physics.tangensOfFrictionAngle,
      physics.normalDampingRatio,
      physics.tangentialDampingRatio,
      physics.effectiveMass};
  kernel::ContactHistory history;
  history.tangential_force = kernel::transport(-physics.shearForce, geometry.previousNormal,
                                               geometry.normal, geometry.twistAngle);
  history.tangential_stiffness = physics.ks;
  history.slipping = physics.slipping;
  const kernel::ContactKinematics kinematics{geometry.normal, geometry.penetrationDepth,
                                             geometry.effectiveRadius, geometry.relativeVelocity,
                                             dt};
  const kernel::ContactResponse response = kernel::hertz_mindlin(parameters, kinematics, history);
  if (scene->trackEnergy) account(response, geometry, physics);
  if (geometry.penetrationDepth <= 0) return false;

  // Leapfrog is unstable beyond omega dt = 2 of the stiffest contact alone, whatever else acts.
  if (dt * dt * response.normal_stiffness > 4 * physics.effectiveMass &&
      physics.effectiveMass > 0) {
    fail_unstable(physics.effectiveMass, response.normal_stiffness, *scene, *contact);
  }
  physics.kn = response.normal_stiffness;
  physics.ks = history.tangential_stiffness;
  physics.slipping = history.slipping;
  physics.normalForce = response.normal_force * geometry.normal;
  physics.shearForce = -history.tangential_force;

  const kernel::Wrench wrench =
      kernel::contact_wrench(response.force_on_1, geometry.arm1, geometry.arm2);
  scene->forces.addForce(contact->id1, wrench.force_1);
  scene->forces.addTorque(contact->id1, wrench.torque_1);
  scene->forces.addForce(contact->id2, wrench.force_2);
  scene->forces.addTorque(contact->id2, wrench.torque_2);
  return true;
}

// Expansion of journal or bearing works on the contact through the clearance c and the effective
// radius R: with V(delta, R) and delta = eccentricity - c, the part of dV that no motion of the
// bodies explains is -F dc + dV/dR dR, dV/dR = V / (2 R). Trapezoidal, as the motion is.
void Law2_JointGeom_JointPhys_HertzMindlin::account(const kernel::ContactResponse& response,
                                                    const JointGeom& geometry, JointPhys& physics) {
  Real thermal_work = 0;
  const Real clearance = geometry.eccentricity - geometry.penetrationDepth;
  if (physics.previousRadius > 0) {
    const Real force = 0.5 * (response.elastic_normal_force + physics.previousElasticForce);
    const Real energy = 0.5 * (response.normal_elastic_energy + physics.previousElasticEnergy);
    const Real radius = 0.5 * (geometry.effectiveRadius + physics.previousRadius);
    thermal_work = -force * (clearance - physics.previousClearance) +
                   energy / (2 * radius) * (geometry.effectiveRadius - physics.previousRadius);
  }
  physics.previousElasticForce = response.elastic_normal_force;
  physics.previousElasticEnergy = response.normal_elastic_energy;
  physics.previousClearance = clearance;
  physics.previousRadius = geometry.effectiveRadius;
  energies_.add(*scene,
                {response.normal_elastic_energy + response.tangential_elastic_energy,
                 response.friction_dissipation, response.damping_dissipation, thermal_work});
}

namespace {

namespace laws = kernel::laws;

// The name of a law of one kind, or a sentence that lists the known ones.
template <class Law>
Law law_by_name(Law (*find)(const std::string&), const char* class_name, const char* attribute,
                const std::string& name) {
  try {
    return find(name);
  } catch (const std::invalid_argument&) {
    std::string allowed = "one of ";
    for (const std::string& known : laws::law_names<Law>()) allowed += known + ", ";
    allowed.resize(allowed.size() - 2);
    refuse(class_name, attribute, name, allowed);
  }
}

// Temperature changes that the engines of the scene impose, for messages.
std::string temperatures(const yade::Scene& scene) {
  std::ostringstream text;
  text.precision(9);
  for (const auto& engine : scene.engines) {
    if (const auto* heater = dynamic_cast<const ThermalExpansionEngine*>(engine.get())) {
      text << ", temperature change " << heater->temperatureChange << " K";
    }
  }
  return text.str();
}

[[gnu::cold, gnu::noinline]] void fail_law(const std::string& sentence, const yade::Scene& scene,
                                           const yade::Interaction& contact) {
  record_failure(sentence + where(scene, contact.id1, contact.id2, temperatures(scene)));
}

}  // namespace

void Law2_JointGeom_JointPhys_JointLaw::check() {
  laws::JointLaw law;
  law.normal = law_by_name(laws::normal_law, class_name, "normalLaw", normalLaw);
  law.dissipation =
      law_by_name(laws::dissipation_law, class_name, "dissipationLaw", dissipationLaw);
  law.friction = law_by_name(laws::friction_law, class_name, "frictionLaw", frictionLaw);
  law.tangential_velocity = law_by_name(laws::tangential_velocity_law, class_name,
                                        "tangentialVelocity", tangentialVelocity);
  if (!(restitution > 0 && restitution <= 1)) {
    dem::refuse(class_name, "restitution", restitution, "in (0, 1] [-]");
  }
  require_positive(class_name, "smallestImpactSpeed", smallestImpactSpeed, "[m/s]");
  require_positive(class_name, "contactLength", contactLength, "[m]");
  require_not_negative(class_name, "v0", v0, "[m/s]");
  if (!(v1 > v0 && std::isfinite(v1))) dem::refuse(class_name, "v1", v1, "above v0 [m/s]");
  law.restitution = restitution;
  law.smallest_impact_speed = smallestImpactSpeed;
  law.contact_length = contactLength;
  law.friction_parameters = {0, v0, v1};  // the friction coefficient is that of each contact
  laws::validate(law);
  law_ = law;
  needs_axis_ = !(std::holds_alternative<laws::HertzPaper>(law.normal) ||
                     std::holds_alternative<laws::HertzInternal>(law.normal)) ||
                   std::holds_alternative<laws::PaperVelocity>(law.tangential_velocity);
}

// The bodies have moved uniformly over the last step, at the velocity of the half step, and the
// clearance has changed by clearanceRate dt: the touching is where that straight line crosses 0.
void Law2_JointGeom_JointPhys_JointLaw::begin(const JointGeom& geometry, JointPhys& physics) {
  physics.impactSpeed = geometry.relativeVelocity.dot(geometry.normal);
  const Real rate = physics.impactSpeed - geometry.clearanceRate;
  const Real since =
      rate * scene->dt > geometry.penetrationDepth ? geometry.penetrationDepth / rate : scene->dt;
  const bool ever_apart = rate > 0 && scene->time >= scene->dt;
  const Real touched = ever_apart ? scene->time - since : scene->time;
  const std::lock_guard<std::mutex> lock(beginning_);
  ++contacts;
  if (firstContactTime < 0 || touched < firstContactTime) firstContactTime = touched;
}

bool Law2_JointGeom_JointPhys_JointLaw::go(yade::shared_ptr<yade::IGeom>& geometry_pointer,
                                           yade::shared_ptr<yade::IPhys>& physics_pointer,
                                           yade::Interaction* contact) {
  const auto& geometry = static_cast<const JointGeom&>(*geometry_pointer);
  auto& physics = static_cast<JointPhys&>(*physics_pointer);
  const Real dt = scene->dt;
  const bool flat = !(geometry.bearingRadius > 0);
  if (needs_axis_ && geometry.axis.isZero()) {
    fail_law(
        std::string(flat ? "a Slider on a SlotFace" : "a Ball in a Socket") +
            " needs normalLaw 'hertz_paper' or 'hertz_internal' and "
        "tangentialVelocity 'material', not '" +
            normalLaw + "' and '" + tangentialVelocity + "'",
        *scene, *contact);
    return true;
  }
  const bool touching = geometry.penetrationDepth > 0;
  if (touching && physics.impactSpeed == -1) begin(geometry, physics);

  const kernel::ContactParameters parameters{
      {physics.effectiveYoungModulus, physics.effectiveShearModulus},
      physics.tangensOfFrictionAngle,
      physics.normalDampingRatio,
      physics.tangentialDampingRatio,
      physics.effectiveMass};
  kernel::ContactHistory history;
  history.tangential_force = kernel::transport(-physics.shearForce, geometry.previousNormal,
                                               geometry.normal, geometry.twistAngle);
  history.tangential_stiffness = physics.ks;
  history.slipping = physics.slipping;
  const auto& state1 = *body_at(*scene, static_cast<std::size_t>(contact->id1))->state;
  const auto& state2 = *body_at(*scene, static_cast<std::size_t>(contact->id2))->state;
  const laws::JointKinematics kinematics{
      {geometry.penetrationDepth, geometry.normal, geometry.arm1, geometry.arm2,
       geometry.relativeVelocity, geometry.effectiveRadius, geometry.eccentricity},
      {geometry.journalRadius,
       flat ? std::numeric_limits<Real>::infinity() : geometry.bearingRadius, law_.contact_length},
      motion(state1),
      motion(state2),
      geometry.axis,
      physics.impactSpeed,
      geometry.clearanceRate,
      dt};
  try {
    const laws::JointResponse response =
        laws::joint_response(law_, parameters, kinematics, history);
    if (scene->trackEnergy) account(response, kinematics.geometry, geometry, physics);
    if (!touching) return false;

    const Real normal_stiffness = response.contact.normal_stiffness;
    if (dt * dt * normal_stiffness > 4 * physics.effectiveMass && physics.effectiveMass > 0) {
      fail_unstable(physics.effectiveMass, normal_stiffness, *scene, *contact);
    }
    physics.kn = normal_stiffness;
    physics.ks = history.tangential_stiffness;
    physics.slipping = history.slipping;
    physics.normalForce = response.contact.normal_force * geometry.normal;
    // 'ambrosio' remembers nothing: what it gives is force, not history.
    physics.shearForce = physics.ks > 0 ? Vector3r(-history.tangential_force)
                                        : Vector3r(-response.contact.tangential_force);
    physics.dissipationSlope = response.dissipation_slope;
    physics.frictionSlope = response.friction_slope;
    const kernel::Wrench& wrench = response.wrench;
    scene->forces.addForce(contact->id1, wrench.force_1);
    scene->forces.addTorque(contact->id1, wrench.torque_1);
    scene->forces.addForce(contact->id2, wrench.force_2);
    scene->forces.addTorque(contact->id2, wrench.torque_2);
  } catch (const std::exception& error) {
    fail_law(error.what(), *scene, *contact);
  }
  return true;
}

// As Hertz and Mindlin's, but dV/dR by the law itself: V(delta, R1, R2) is known by value only.
void Law2_JointGeom_JointPhys_JointLaw::account(const laws::JointResponse& joint,
                                                const laws::NormalGeometry& radii,
                                                const JointGeom& geometry, JointPhys& physics) {
  const kernel::ContactResponse& response = joint.contact;
  const Real clearance = geometry.eccentricity - geometry.penetrationDepth;
  Real thermal_work = 0;
  if (physics.previousRadius > 0) {
    const Real force = 0.5 * (response.elastic_normal_force + physics.previousElasticForce);
    thermal_work = -force * (clearance - physics.previousClearance) -
                   joint.dissipation_force * geometry.clearanceRate * scene->dt;
    laws::NormalGeometry before = radii;
    before.journal_radius = physics.previousRadius;
    if (physics.previousBearingRadius > 0) before.bearing_radius = physics.previousBearingRadius;
    for (const Real depth : {geometry.penetrationDepth, physics.previousDepth}) {
      thermal_work += 0.5 * laws::radius_energy_change(law_.normal, {physics.effectiveYoungModulus},
                                                       depth, before, radii);
    }
  }
  physics.previousElasticForce = response.elastic_normal_force;
  physics.previousElasticEnergy = response.normal_elastic_energy;
  physics.previousClearance = clearance;
  physics.previousRadius = geometry.journalRadius;
  physics.previousBearingRadius = geometry.bearingRadius;
  physics.previousDepth = geometry.penetrationDepth;
  energies_.add(*scene,
                {response.normal_elastic_energy + response.tangential_elastic_energy,
                 response.friction_dissipation, response.damping_dissipation, thermal_work});
}

}  // namespace statejump::dem
