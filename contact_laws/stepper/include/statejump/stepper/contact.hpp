// SPDX-License-Identifier: GPL-3.0-or-later
// One step of one contact of a clearance joint: where its two parts are, what its law answers, what
// it keeps until the next step. The plugin's functors and the stepper call the same functions, with
// YADE's objects or with plain values; the attributes have the same names.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/frame.hpp"
#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/kernel/laws/joint_response.hpp"
#include "statejump/stepper/numbers.hpp"

namespace statejump::stepper {

using kernel::Vector3;

/// Geometry of one contact; the attributes of JointGeom.
struct ContactGeometry {
  Vector3 normal = Vector3::Zero();            ///< unit, from body 1 into body 2
  double penetrationDepth = 0.0;               ///< [m]
  double effectiveRadius = 0.0;                ///< [m]
  double eccentricity = 0.0;                   ///< [m]
  Vector3 relativeVelocity = Vector3::Zero();  ///< [m/s]
  double journalRadius = 0.0;                  ///< [m]
  double bearingRadius = std::numeric_limits<double>::infinity();  ///< [m]
  Vector3 arm1 = Vector3::Zero();                                  ///< [m]
  Vector3 arm2 = Vector3::Zero();                                  ///< [m]
  Vector3 previousNormal = Vector3::Zero();
  double twistAngle = 0.0;  ///< [rad]
  Vector3 axis = Vector3::Zero();
  double clearanceRate = 0.0;  ///< [m/s]
};

/// Physics of one contact; the attributes of JointPhys.
struct ContactPhysics {
  double kn = 0.0;                        ///< [N/m]
  double ks = 0.0;                        ///< [N/m]
  Vector3 normalForce = Vector3::Zero();  ///< on body 2 [N]
  Vector3 shearForce = Vector3::Zero();   ///< on body 2 [N]
  double tangensOfFrictionAngle = 0.0;    ///< [-]
  double effectiveYoungModulus = 0.0;     ///< [Pa]
  double effectiveShearModulus = 0.0;     ///< [Pa]
  double effectiveMass = 0.0;             ///< [kg]
  double normalDampingRatio = 0.0;        ///< [-]
  double tangentialDampingRatio = 0.0;    ///< [-]
  bool slipping = false;
  Vector3 slipAxis = Vector3::Zero();
  std::vector<Vector3> slipMemory;  ///< 8 G* r [N/m], elastic displacement along both axes [m]
  double slipSlope = 0.0;           ///< [m^3/N^2]
  double slipMerged = 0.0;          ///< [N]
  // What the kernel holds of slipMemory, see PartialSlipMemory::Held.
  int slipHeld = 0;
  Vector3 slipShift = Vector3::Zero();  ///< [m]
  Vector3 slipSums = Vector3::Zero();   ///< [N], [N], [J]
  Vector3 slipLine = Vector3::Zero();   ///< [m]
  bool begun = false;
  double impactSpeed = 0.0;            ///< [m/s]
  double dissipationSlope = 0.0;       ///< [N s/m]
  double frictionSlope = 0.0;          ///< [N s/m]
  double previousElasticForce = 0.0;   ///< [N]
  double previousElasticEnergy = 0.0;  ///< [J]
  double previousClearance = 0.0;      ///< [m]
  double previousRadius = 0.0;         ///< [m]
  double previousBearingRadius = 0.0;  ///< [m]
  double previousDepth = 0.0;          ///< [m]
};

/// Length of a part at the reference temperature and what the temperature does to it.
struct Part {
  double length;       ///< radius, or distance of a face [m]
  double grown;        ///< 1 + thermal strain [-]
  double strain_rate;  ///< of the last step [1/s]
  double expanded() const { return length * grown; }
};

/// Values of one contact and one step [J]; elastic is what is stored now.
struct ContactEnergy {
  double elastic;
  double friction;
  double damping;
  double thermal_work;
};

/// What became of a pair of parts in a step.
enum class Found {
  apart,    ///< no contact, and there was none
  contact,  ///< the geometry is that of this step
  closed,   ///< the clearance is closed, or a centre inside the other ball: no contact
  tilted    ///< the axes are not parallel
};

/// Takes over a contact of this step.
/// @param motion_1, motion_2 of the two bodies; @param time_step [s]
template <class Geometry>
void update(const kernel::JointContact& contact, const kernel::BodyMotion& motion_1,
            const kernel::BodyMotion& motion_2, double time_step, Geometry& geometry) {
  geometry.previousNormal = geometry.normal;
  geometry.normal = contact.normal;
  geometry.penetrationDepth = contact.penetration_depth;
  geometry.effectiveRadius = contact.effective_radius;
  geometry.eccentricity = contact.eccentricity;
  geometry.relativeVelocity = contact.relative_velocity;
  geometry.arm1 = contact.arm_1;
  geometry.arm2 = contact.arm_2;
  // The history turns with the mean spin of both bodies about the normal.
  geometry.twistAngle =
      0.5 * time_step *
      (motion_1.angular_velocity + motion_2.angular_velocity).dot(geometry.normal);
}

/// Journal (1) in a bearing (2).
/// @param axis unit, of the bearing; @param keep whether the contact exists already
/// @param tilted says whether the axes are further from parallel than is allowed
/// @param make gives the geometry to fill; a new one begins with the normal that it is given
template <class Tilted, class Make>
Found find_revolute(const Part& journal, const Part& bearing, const kernel::BodyMotion& motion_1,
                    const kernel::BodyMotion& motion_2, const Vector3& axis, bool keep,
                    double time_step, Tilted&& tilted, Make&& make) {
  const double journal_radius = journal.expanded();
  const double bearing_radius = bearing.expanded();
  if (!(journal_radius > 0 && bearing_radius > journal_radius)) return Found::closed;
  if (!keep && !kernel::revolute_touches(motion_1.position, journal_radius, motion_2.position,
                                         bearing_radius, axis)) {
    return Found::apart;
  }
  if (tilted()) return Found::tilted;
  const kernel::JointContact found =
      kernel::revolute_contact(motion_1, journal_radius, motion_2, bearing_radius, axis);
  auto& geometry = make(found.normal);
  geometry.journalRadius = journal_radius;
  geometry.bearingRadius = bearing_radius;
  geometry.axis = axis;
  geometry.clearanceRate =
      bearing.length * bearing.strain_rate - journal.length * journal.strain_rate;
  update(found, motion_1, motion_2, time_step, geometry);
  return Found::contact;
}

/// Ball (1) in a socket (2); the rest as find_revolute().
template <class Make>
Found find_ball(const Part& ball, const Part& socket, const kernel::BodyMotion& motion_1,
                const kernel::BodyMotion& motion_2, bool keep, double time_step, Make&& make) {
  const double ball_radius = ball.expanded();
  const double socket_radius = socket.expanded();
  if (!(ball_radius > 0 && socket_radius > ball_radius)) return Found::closed;
  if (!keep &&
      !kernel::ball_touches(motion_1.position, ball_radius, motion_2.position, socket_radius)) {
    return Found::apart;
  }
  const kernel::JointContact found =
      kernel::ball_contact(motion_1, ball_radius, motion_2, socket_radius);
  auto& geometry = make(found.normal);
  geometry.journalRadius = ball_radius;
  geometry.bearingRadius = socket_radius;
  geometry.axis = Vector3::Zero();
  geometry.clearanceRate = socket.length * socket.strain_rate - ball.length * ball.strain_rate;
  update(found, motion_1, motion_2, time_step, geometry);
  return Found::contact;
}

/// Two balls, each outside the other; the rest as find_revolute(). The radius of the second counts
/// as that of a bearing turned inside out, negative. @return closed when the centre of one lies
/// inside the other, where no contact can be computed
template <class Make>
Found find_outer_balls(const Part& ball_1, const Part& ball_2, const kernel::BodyMotion& motion_1,
                       const kernel::BodyMotion& motion_2, bool keep, double time_step,
                       Make&& make) {
  const double radius_1 = ball_1.expanded();
  const double radius_2 = ball_2.expanded();
  if (!keep &&
      !kernel::outer_balls_touch(motion_1.position, radius_1, motion_2.position, radius_2)) {
    return Found::apart;
  }
  const double larger = std::max(radius_1, radius_2);
  if (!(radius_1 > 0 && radius_2 > 0 &&
        (motion_1.position - motion_2.position).squaredNorm() > larger * larger)) {
    return Found::closed;
  }
  const kernel::JointContact found =
      kernel::outer_ball_contact(motion_1, radius_1, motion_2, radius_2);
  auto& geometry = make(found.normal);
  geometry.journalRadius = radius_1;
  geometry.bearingRadius = -radius_2;
  geometry.axis = Vector3::Zero();
  geometry.clearanceRate =
      -(ball_1.length * ball_1.strain_rate + ball_2.length * ball_2.strain_rate);
  update(found, motion_1, motion_2, time_step, geometry);
  return Found::contact;
}

/// Pad of a slider (1) on a face of its slot (2); the rest as find_revolute().
/// @param normal unit, world, from the slider into the face
template <class Make>
Found find_plane(const Part& pad, const Part& face, const kernel::BodyMotion& motion_1,
                 const kernel::BodyMotion& motion_2, const Vector3& normal, bool keep,
                 double time_step, Make&& make) {
  const double radius = pad.expanded();
  const kernel::JointContact found =
      kernel::plane_contact(motion_1, radius, motion_2, normal, face.expanded());
  if (found.penetration_depth <= 0 && !keep) return Found::apart;
  auto& geometry = make(found.normal);
  geometry.journalRadius = radius;
  geometry.bearingRadius = std::numeric_limits<double>::infinity();
  geometry.axis = Vector3::Zero();
  geometry.clearanceRate = face.length * face.strain_rate - pad.length * pad.strain_rate;
  update(found, motion_1, motion_2, time_step, geometry);
  return Found::contact;
}

template <class Physics>
kernel::ContactParameters contact_parameters(const Physics& physics) {
  return {{physics.effectiveYoungModulus, physics.effectiveShearModulus},
          physics.tangensOfFrictionAngle,
          physics.normalDampingRatio,
          physics.tangentialDampingRatio,
          physics.effectiveMass};
}

/// History of friction, carried into the tangent plane of this step. Stored forces act on body 2,
/// the kernel's on body 1. Memory is not copied but borrowed, until this ends.
template <class Physics>
class BorrowedHistory {
 public:
  template <class Geometry>
  BorrowedHistory(const Geometry& geometry, Physics& physics) : physics_(physics) {
    history.tangential_force = kernel::transport(-physics.shearForce, geometry.previousNormal,
                                                 geometry.normal, geometry.twistAngle);
    history.tangential_stiffness = physics.ks;
    history.slipping = physics.slipping;
    if (physics.slipMemory.empty()) return;
    history.tangential_axis = kernel::transport(physics.slipAxis, geometry.previousNormal,
                                                geometry.normal, geometry.twistAngle);
    const Vector3 &shift = physics.slipShift, &sums = physics.slipSums, &line = physics.slipLine;
    history.memory = {
        std::move(physics.slipMemory),
        physics.slipSlope,
        physics.slipMerged,
        {physics.slipHeld, {shift[0], shift[1]}, {sums[0], sums[1]}, sums[2], line[0], line[1]}};
    borrowed_ = true;
  }
  BorrowedHistory(const BorrowedHistory&) = delete;
  BorrowedHistory& operator=(const BorrowedHistory&) = delete;
  ~BorrowedHistory() {
    kernel::PartialSlipMemory& memory = history.memory;
    if (!borrowed_ && memory.size() == 0) return;
    const kernel::PartialSlipMemory::Held& held = memory.held();
    physics_.slipAxis = history.tangential_axis;
    physics_.slipSlope = memory.slope();
    physics_.slipMerged = memory.merged();
    physics_.slipHeld = held.count;
    physics_.slipShift = {held.shift.a, held.shift.b, 0.0};
    physics_.slipSums = {held.force.a, held.force.b, held.squares};
    physics_.slipLine = {held.at_centre, held.at_last, 0.0};
    physics_.slipMemory = memory.take_points();
  }
  kernel::ContactHistory history;

 private:
  Physics& physics_;
  bool borrowed_ = false;
};

/// What the contact keeps until the next step: stiffnesses and forces.
template <class Physics>
void store(const kernel::ContactResponse& response, const kernel::ContactHistory& history,
           const Vector3& normal, Physics& physics) {
  physics.kn = response.normal_stiffness;
  physics.ks = history.tangential_stiffness;
  physics.slipping = history.slipping;
  physics.normalForce = response.normal_force * normal;
  physics.shearForce = -history.tangential_force;
}

/// The energies of one contact. Expansion works on it through the clearance c and the radii: with
/// V(delta, radii) and delta = eccentricity - c, the part of dV that no motion of the bodies
/// explains is -F dc plus what the radii change of V at fixed depth. Trapezoidal, as the motion is.
/// @param dissipation_force of the dissipation law [N], @param radius kept until the next step [m]
/// @param add_radius_work adds the work of the changing radii to a number [J]
template <class Geometry, class Physics, class AddRadiusWork>
ContactEnergy account(const kernel::ContactResponse& response, double dissipation_force,
                      double radius, const AddRadiusWork& add_radius_work, double time_step,
                      const Geometry& geometry, Physics& physics) {
  const double clearance = geometry.eccentricity - geometry.penetrationDepth;
  double thermal_work = 0;
  if (physics.previousRadius > 0) {
    const double force = 0.5 * (response.elastic_normal_force + physics.previousElasticForce);
    thermal_work = -force * (clearance - physics.previousClearance) -
                   dissipation_force * geometry.clearanceRate * time_step;
    add_radius_work(thermal_work);
  }
  physics.previousElasticForce = response.elastic_normal_force;
  physics.previousElasticEnergy = response.normal_elastic_energy;
  physics.previousClearance = clearance;
  physics.previousRadius = radius;
  physics.previousBearingRadius = geometry.bearingRadius;
  physics.previousDepth = geometry.penetrationDepth;
  return {response.normal_elastic_energy + response.tangential_elastic_energy,
          response.friction_dissipation, response.damping_dissipation, thermal_work};
}

/// What the laws ask of whoever steps them:
///   time_step() [s], tracks_energy(), add(ContactEnergy)
///   exert(wrench)              forces on the two bodies
///   judges                     whether an answer is judged before it acts; else whoever steps the
///                              contact asks afterwards what it keeps
///   accepts(k, force, physics) of one that judges: whether an answer that is not plain is good:
///                              normal stiffness k [N/m], force on body 1 [N]; else it fails
///
/// Whether the answer of a contact can be used.
template <class Physics, class Host>
[[gnu::always_inline]] inline bool is_usable(const kernel::ContactResponse& response,
                                             const Physics& physics, Host&& host) {
  if constexpr (std::decay_t<Host>::judges) {
    return (is_plain_stiffness(response.normal_stiffness, physics, host.time_step()) &&
            physics.tangensOfFrictionAngle >= 0 && is_plain(response.force_on_1)) ||
           host.accepts(response.normal_stiffness, response.force_on_1, physics);
  } else {
    return true;
  }
}

/// Hertz and Mindlin. @return false when the contact is open; true, without forces, when it failed
template <class Geometry, class Physics, class Host>
bool hertz_mindlin_step(const Geometry& geometry, Physics& physics, Host&& host) {
  BorrowedHistory borrowed(geometry, physics);
  kernel::ContactHistory& history = borrowed.history;
  const kernel::ContactKinematics kinematics{geometry.normal, geometry.penetrationDepth,
                                             geometry.effectiveRadius, geometry.relativeVelocity,
                                             host.time_step()};
  const kernel::ContactResponse response =
      kernel::hertz_mindlin(contact_parameters(physics), kinematics, history);
  const bool touches = !(geometry.penetrationDepth <= 0);
  if (touches && !is_usable(response, physics, host)) return true;
  if (host.tracks_energy()) {
    host.add(account(
        response, 0, geometry.effectiveRadius,
        [&](double& work) {  // dV/dR = V / (2 R)
          const double energy =
              0.5 * (response.normal_elastic_energy + physics.previousElasticEnergy);
          const double radius = 0.5 * (geometry.effectiveRadius + physics.previousRadius);
          work += energy / (2 * radius) * (geometry.effectiveRadius - physics.previousRadius);
        },
        host.time_step(), geometry, physics));
  }
  if (!touches) return false;
  store(response, history, geometry.normal, physics);
  host.exert(kernel::contact_wrench(response.force_on_1, geometry.arm1, geometry.arm2));
  return true;
}

/// Why a law by name does not fit a contact.
enum class Misfit { none, bulging_wall, no_axis };

/// Laws by name. @tparam Law a JointLaw or a KnownJointLaw
template <class Law>
struct Named {
  Law law;
  bool needs_axis = false;  ///< some of the laws have no meaning without a bearing's axis
};
using NamedLaw = Named<kernel::laws::JointLaw>;

template <class Law, class Geometry>
Misfit misfit(const Named<Law>& named, const Geometry& geometry) {
  if (geometry.bearingRadius < 0 &&
      !kernel::laws::has(named.law.normal, kernel::laws::Trait::accepts_bulging_wall)) {
    return Misfit::bulging_wall;
  }
  return named.needs_axis && geometry.axis.isZero() ? Misfit::no_axis : Misfit::none;
}

/// Begins a contact and says when it began [s]. The bodies have moved uniformly over the last step,
/// at the velocity of the half step, and the clearance has changed by clearanceRate dt: the
/// touching is where that straight line crosses 0.
template <class Geometry, class Physics>
double begin(const Geometry& geometry, Physics& physics, double time, double time_step) {
  physics.begun = true;
  physics.impactSpeed = geometry.relativeVelocity.dot(geometry.normal);
  const double rate = physics.impactSpeed - geometry.clearanceRate;
  const double since =
      rate * time_step > geometry.penetrationDepth ? geometry.penetrationDepth / rate : time_step;
  const bool ever_apart = rate > 0 && time >= time_step;
  return ever_apart ? time - since : time;
}

/// Contacts that have begun, and when the first of them did.
struct Begun {
  double first = std::numeric_limits<double>::quiet_NaN();  ///< [s]
  int count = 0;
  void add(double touched) {
    if (count == 0 || touched < first) first = touched;
    ++count;
  }
  void add(const Begun& others) {
    if (others.count == 0) return;
    if (count == 0 || others.first < first) first = others.first;
    count += others.count;
  }
};

/// Laws by name, for a contact without a Misfit that has begun if it touches.
/// @return false when the contact is open; true, without forces, when it failed
/// @throws std::domain_error outside the range of a law
template <class Law, class Geometry, class Physics, class Host>
bool joint_law_step(const Law& law, const Geometry& geometry, Physics& physics,
                    const kernel::BodyMotion& motion_1, const kernel::BodyMotion& motion_2,
                    Host&& host) {
  namespace laws = kernel::laws;
  BorrowedHistory borrowed(geometry, physics);
  kernel::ContactHistory& history = borrowed.history;
  history.memory.set_accounts(host.tracks_energy());
  const laws::JointKinematics kinematics{
      {geometry.penetrationDepth, geometry.normal, geometry.arm1, geometry.arm2,
       geometry.relativeVelocity, geometry.effectiveRadius, geometry.eccentricity},
      {geometry.journalRadius, geometry.bearingRadius, law.contact_length},
      motion_1,
      motion_2,
      geometry.axis,
      physics.impactSpeed,
      geometry.clearanceRate,
      host.time_step()};
  const laws::JointResponse response =
      laws::joint_response(law, contact_parameters(physics), kinematics, history);
  const kernel::ContactResponse& contact = response.contact;
  const bool touches = !(geometry.penetrationDepth <= 0);
  if (touches && !is_usable(contact, physics, host)) return true;
  if (host.tracks_energy()) {
    host.add(account(
        contact, response.dissipation_force, geometry.journalRadius,
        [&](double& work) {  // V(delta, R1, R2) of any law is known by value only
          if (geometry.journalRadius == physics.previousRadius &&
              geometry.bearingRadius == physics.previousBearingRadius) {
            work += 0.0;  // as for each depth
            return;
          }
          laws::NormalGeometry before = kinematics.geometry;
          before.journal_radius = physics.previousRadius;
          before.bearing_radius = physics.previousBearingRadius;
          for (const double depth : {geometry.penetrationDepth, physics.previousDepth}) {
            work += 0.5 * laws::radius_energy_change(law.normal, {physics.effectiveYoungModulus},
                                                     depth, before, kinematics.geometry);
          }
        },
        host.time_step(), geometry, physics));
  }
  if (!touches) return false;
  store(contact, history, geometry.normal, physics);
  host.exert(response.wrench);
  // A law that remembers nothing gives force, not history.
  if (!(physics.ks > 0)) physics.shearForce = -contact.tangential_force;
  physics.dissipationSlope = response.dissipation_slope;
  physics.frictionSlope = response.friction_slope;
  return true;
}

}  // namespace statejump::stepper
