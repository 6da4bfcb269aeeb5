#include <cmath>
#include <limits>

#include "contact_parts.hpp"
#include "failure.hpp"
#include "joint.hpp"
#include "joint_exchange.hpp"
#include "ranges.hpp"

namespace statejump::dem {
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

[[gnu::cold, gnu::noinline]] void fail_law(const std::string& sentence, const yade::Scene& scene,
                                           const yade::Interaction& contact) {
  record_failure(sentence + where(scene, contact.id1, contact.id2));
}

}  // namespace

void NamedJointLaw::build(const char* class_name) {
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
void NamedJointLaw::begin(const JointGeom& geometry, JointPhys& physics, const yade::Scene& scene) {
  physics.impactSpeed = geometry.relativeVelocity.dot(geometry.normal);
  const Real rate = physics.impactSpeed - geometry.clearanceRate;
  const Real since =
      rate * scene.dt > geometry.penetrationDepth ? geometry.penetrationDepth / rate : scene.dt;
  const bool ever_apart = rate > 0 && scene.time >= scene.dt;
  const Real touched = ever_apart ? scene.time - since : scene.time;
  const std::lock_guard<std::mutex> lock(beginning_);
  ++contacts;
  if (firstContactTime < 0 || touched < firstContactTime) firstContactTime = touched;
}

bool NamedJointLaw::step(const JointGeom& geometry, JointPhys& physics,
                         const yade::Interaction& contact, yade::Scene& scene) {
  const bool flat = geometry.bearingRadius == 0;
  if (geometry.bearingRadius < 0 && !std::holds_alternative<laws::HertzInternal>(law_.normal)) {
    fail_law("a wall that bulges needs normalLaw 'hertz_internal', not '" + normalLaw + "'", scene,
             contact);
    return true;
  }
  if (needs_axis_ && geometry.axis.isZero()) {
    fail_law(
        std::string(flat ? "a Slider on a SlotFace" : "a Ball in a Socket") +
            " needs normalLaw 'hertz_paper' or 'hertz_internal' and tangentialVelocity 'material', "
            "not '" +
            normalLaw + "' and '" + tangentialVelocity + "'",
        scene, contact);
    return true;
  }
  const bool touching = geometry.penetrationDepth > 0;
  if (touching && physics.impactSpeed == -1) begin(geometry, physics, scene);

  kernel::ContactHistory history = contact_history(geometry, physics);
  const auto& state1 = *body_at(scene, static_cast<std::size_t>(contact.id1))->state;
  const auto& state2 = *body_at(scene, static_cast<std::size_t>(contact.id2))->state;
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
      scene.dt};
  try {
    const laws::JointResponse response =
        laws::joint_response(law_, contact_parameters(physics), kinematics, history);
    if (scene.trackEnergy) account(response, kinematics.geometry, geometry, physics, scene);
    if (!touching) return false;

    check_time_step(response.contact.normal_stiffness, physics, scene, contact);
    store(response.contact, history, geometry.normal, physics);
    // 'ambrosio' remembers nothing: what it gives is force, not history.
    if (!(physics.ks > 0)) physics.shearForce = -response.contact.tangential_force;
    physics.dissipationSlope = response.dissipation_slope;
    physics.frictionSlope = response.friction_slope;
    apply(response.wrench, scene, contact);
  } catch (const std::exception& error) {
    fail_law(error.what(), scene, contact);
  }
  return true;
}

// As Hertz and Mindlin's, but dV/dR by the law itself: V(delta, R1, R2) is known by value only.
void NamedJointLaw::account(const laws::JointResponse& joint, const laws::NormalGeometry& radii,
                            const JointGeom& geometry, JointPhys& physics, yade::Scene& scene) {
  const kernel::ContactResponse& response = joint.contact;
  const Real clearance = geometry.eccentricity - geometry.penetrationDepth;
  Real thermal_work = 0;
  if (physics.previousRadius > 0) {
    const Real force = 0.5 * (response.elastic_normal_force + physics.previousElasticForce);
    thermal_work = -force * (clearance - physics.previousClearance) -
                   joint.dissipation_force * geometry.clearanceRate * scene.dt;
    laws::NormalGeometry before = radii;
    before.journal_radius = physics.previousRadius;
    if (physics.previousBearingRadius != 0) before.bearing_radius = physics.previousBearingRadius;
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
  energies_.add(scene, {response.normal_elastic_energy + response.tangential_elastic_energy,
                        response.friction_dissipation, response.damping_dissipation, thermal_work});
}

}  // namespace statejump::dem
