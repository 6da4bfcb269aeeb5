// SPDX-License-Identifier: GPL-3.0-or-later
// One step of one contact of a clearance joint: finds the contact geometry, applies the law and
// stores the state until the next step. The plugin's functors and the stepper call the same
// functions, with YADE's objects or with plain values, whose attributes have the same names.
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
#include "statejump/stepper/checks.hpp"

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
  std::vector<Vector3> slipMemory;  ///< per point: 8 G* r [N/m], elastic displacement [m], [m]
  double slipSlope = 0.0;           ///< [m^3/N^2]
  double slipMerged = 0.0;          ///< [N]
  // PartialSlipMemory::ShiftedPrefix of slipMemory: count, shift, force and squares, bounds.
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

/// Length at the reference temperature, with the current thermal strain.
struct ThermalLength {
  double length;           ///< radius, or distance of a face [m]
  double thermal_stretch;  ///< 1 + thermal strain [-]
  double strain_rate;      ///< rate over the last step [1/s]
  double expanded() const { return length * thermal_stretch; }
};

/// Energies of one contact in one step [J]: `elastic` is the stored energy, all others are
/// increments.
struct ContactEnergy {
  double elastic;
  double friction;
  double damping;
  double thermal_work;
};

/// Result of the contact search for a pair in a step.
enum class ContactSearch {
  apart,    ///< no contact now and none in the previous step
  contact,  ///< contact; the geometry is updated to this step
  closed,   ///< error: no clearance is left, or a centre is inside the other ball
  tilted    ///< error: the axes are not parallel
};

/// Stores the contact geometry of this step in `geometry`.
/// @param motion_1, motion_2 motion of the two bodies; @param time_step [s]
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
  // The friction history rotates with the mean spin of both bodies about the normal.
  geometry.twistAngle =
      0.5 * time_step *
      (motion_1.angular_velocity + motion_2.angular_velocity).dot(geometry.normal);
}

/// Finds the contact of a journal (body 1) in a bearing (body 2).
/// @param axis unit axis of the bearing; @param keep whether the contact already exists
/// @param tilted returns whether the axes are tilted by more than the allowed angle
/// @param make returns the geometry to fill; a new geometry starts with the given normal
template <class Tilted, class CreatePhysics>
ContactSearch find_revolute(const ThermalLength& journal, const ThermalLength& bearing,
                            const kernel::BodyMotion& motion_1, const kernel::BodyMotion& motion_2,
                            const Vector3& axis, bool keep, double time_step, Tilted&& tilted,
                            CreatePhysics&& make) {
  const double journal_radius = journal.expanded();
  const double bearing_radius = bearing.expanded();
  if (!(journal_radius > 0 && bearing_radius > journal_radius)) return ContactSearch::closed;
  if (!keep && !kernel::revolute_touches(motion_1.position, journal_radius, motion_2.position,
                                         bearing_radius, axis)) {
    return ContactSearch::apart;
  }
  if (tilted()) return ContactSearch::tilted;
  const kernel::JointContact found =
      kernel::revolute_contact(motion_1, journal_radius, motion_2, bearing_radius, axis);
  auto& geometry = make(found.normal);
  geometry.journalRadius = journal_radius;
  geometry.bearingRadius = bearing_radius;
  geometry.axis = axis;
  geometry.clearanceRate =
      bearing.length * bearing.strain_rate - journal.length * journal.strain_rate;
  update(found, motion_1, motion_2, time_step, geometry);
  return ContactSearch::contact;
}

/// Ball (body 1) in a socket (body 2); otherwise as find_revolute().
template <class CreatePhysics>
ContactSearch find_ball(const ThermalLength& ball, const ThermalLength& socket,
                        const kernel::BodyMotion& motion_1, const kernel::BodyMotion& motion_2,
                        bool keep, double time_step, CreatePhysics&& make) {
  const double ball_radius = ball.expanded();
  const double socket_radius = socket.expanded();
  if (!(ball_radius > 0 && socket_radius > ball_radius)) return ContactSearch::closed;
  if (!keep &&
      !kernel::ball_touches(motion_1.position, ball_radius, motion_2.position, socket_radius)) {
    return ContactSearch::apart;
  }
  const kernel::JointContact found =
      kernel::ball_contact(motion_1, ball_radius, motion_2, socket_radius);
  auto& geometry = make(found.normal);
  geometry.journalRadius = ball_radius;
  geometry.bearingRadius = socket_radius;
  geometry.axis = Vector3::Zero();
  geometry.clearanceRate = socket.length * socket.strain_rate - ball.length * ball.strain_rate;
  update(found, motion_1, motion_2, time_step, geometry);
  return ContactSearch::contact;
}

/// Finds the external contact of two balls; parameters as in find_revolute(). The second radius is
/// stored as negative, as for a bearing turned inside out.
/// @return closed if the centre of one ball is inside the other ball, where no contact is defined
template <class CreatePhysics>
ContactSearch find_outer_balls(const ThermalLength& ball_1, const ThermalLength& ball_2,
                               const kernel::BodyMotion& motion_1,
                               const kernel::BodyMotion& motion_2, bool keep, double time_step,
                               CreatePhysics&& make) {
  const double radius_1 = ball_1.expanded();
  const double radius_2 = ball_2.expanded();
  if (!keep &&
      !kernel::outer_balls_touch(motion_1.position, radius_1, motion_2.position, radius_2)) {
    return ContactSearch::apart;
  }
  const double larger = std::max(radius_1, radius_2);
  if (!(radius_1 > 0 && radius_2 > 0 &&
        (motion_1.position - motion_2.position).squaredNorm() > larger * larger)) {
    return ContactSearch::closed;
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
  return ContactSearch::contact;
}

/// Finds the contact of a slider's pad (body 1) with a face of its slot (body 2); parameters as in
/// find_revolute().
/// @param normal unit normal from the slider into the face, world frame
template <class CreatePhysics>
ContactSearch find_plane(const ThermalLength& pad, const ThermalLength& face,
                         const kernel::BodyMotion& motion_1, const kernel::BodyMotion& motion_2,
                         const Vector3& normal, bool keep, double time_step, CreatePhysics&& make) {
  const double radius = pad.expanded();
  const kernel::JointContact found =
      kernel::plane_contact(motion_1, radius, motion_2, normal, face.expanded());
  if (found.penetration_depth <= 0 && !keep) return ContactSearch::apart;
  auto& geometry = make(found.normal);
  geometry.journalRadius = radius;
  geometry.bearingRadius = std::numeric_limits<double>::infinity();
  geometry.axis = Vector3::Zero();
  geometry.clearanceRate = face.length * face.strain_rate - pad.length * pad.strain_rate;
  update(found, motion_1, motion_2, time_step, geometry);
  return ContactSearch::contact;
}

template <class Physics>
kernel::ContactParameters contact_parameters(const Physics& physics) {
  return {{physics.effectiveYoungModulus, physics.effectiveShearModulus},
          physics.tangensOfFrictionAngle,
          physics.normalDampingRatio,
          physics.tangentialDampingRatio,
          physics.effectiveMass};
}

/// Friction history, rotated into the tangent plane of this step. YADE stores forces on body 2,
/// whereas the kernel uses forces on body 1. The memory is moved into this object, not copied, and
/// moved back on destruction.
template <class Physics>
class ScopedHistory {
 public:
  template <class Geometry>
  ScopedHistory(const Geometry& geometry, Physics& physics) : physics_(physics) {
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
    moved_in_ = true;
  }
  ScopedHistory(const ScopedHistory&) = delete;
  ScopedHistory& operator=(const ScopedHistory&) = delete;
  ~ScopedHistory() {
    kernel::PartialSlipMemory& memory = history.memory;
    if (!moved_in_ && memory.size() == 0) return;
    const kernel::PartialSlipMemory::ShiftedPrefix& prefix = memory.prefix();
    physics_.slipAxis = history.tangential_axis;
    physics_.slipSlope = memory.slope();
    physics_.slipMerged = memory.merged();
    physics_.slipHeld = prefix.count;
    physics_.slipShift = {prefix.shift.a, prefix.shift.b, 0.0};
    physics_.slipSums = {prefix.force.a, prefix.force.b, prefix.squares};
    physics_.slipLine = {prefix.at_centre, prefix.at_last, 0.0};
    physics_.slipMemory = memory.take_points();
  }
  kernel::ContactHistory history;

 private:
  Physics& physics_;
  bool moved_in_ = false;
};

/// Stores stiffnesses and forces for the next step.
template <class Physics>
void store(const kernel::ContactResponse& response, const kernel::ContactHistory& history,
           const Vector3& normal, Physics& physics) {
  physics.kn = response.normal_stiffness;
  physics.ks = history.tangential_stiffness;
  physics.slipping = history.slipping;
  physics.normalForce = response.normal_force * normal;
  physics.shearForce = -history.tangential_force;
}

/// Work of the elastic normal force when the clearance changes at fixed bodies, -F dc by the
/// trapezoidal rule [J]. @tparam A arithmetic, see kernel::Single
/// @param force, old_force [N]; @param clearance, old_clearance [m]
template <class A = kernel::Single>
[[gnu::always_inline]] inline typename A::Number work_of_clearance(
    const typename A::Number& force, const typename A::Number& old_force,
    const typename A::Number& clearance, const typename A::Number& old_clearance) {
  return -(0.5 * (force + old_force)) * (clearance - old_clearance);
}

/// Change of the energy V of a Hertz contact when only the effective radius R changes [J], from
/// dV/dR = V/(2 R) by the midpoint rule.
/// @param energy, old_energy [J]; @param radius, old_radius [m]
template <class A = kernel::Single>
[[gnu::always_inline]] inline typename A::Number work_of_radius(
    const typename A::Number& energy, const typename A::Number& old_energy,
    const typename A::Number& radius, const typename A::Number& old_radius) {
  return 0.5 * (energy + old_energy) / (2.0 * (0.5 * (radius + old_radius))) *
         (radius - old_radius);
}

/// Energies of one contact. Thermal expansion does work through the clearance c and the radii. With
/// V(delta, radii) and delta = eccentricity - c, this work is the change of V at fixed bodies: -F
/// dc plus the change of V by the radii at fixed depth. The trapezoidal rule integrates it over the
/// step, as the work of the motion.
/// @param dissipation_force force of the dissipation law [N]
/// @param radius current radius [m], which is stored as physics.previousRadius
/// @param add_radius_work adds the work of the changing radii [J] to its argument
template <class Geometry, class Physics, class AddRadiusWork>
ContactEnergy account(const kernel::ContactResponse& response, double dissipation_force,
                      double radius, const AddRadiusWork& add_radius_work, double time_step,
                      const Geometry& geometry, Physics& physics) {
  const double clearance = geometry.eccentricity - geometry.penetrationDepth;
  double thermal_work = 0;
  if (physics.previousRadius > 0) {
    thermal_work = work_of_clearance(response.elastic_normal_force, physics.previousElasticForce,
                                     clearance, physics.previousClearance) -
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

/// Functions that the laws require of the caller (Host):
///  time_step() [s], tracks_energy(), add(ContactEnergy)
///  apply(wrench)              adds forces to the two bodies
///  checks_response            true: the response is checked before its forces act;
///                             false: the caller checks the stored state afterwards
///  accepts(k, force, physics) only if checks_response: decides on a response that fails the
///                             fast check, by normal stiffness k [N/m], force on body 1 [N]
///
/// Returns whether the forces of this response may be applied.
template <class Physics, class Host>
[[gnu::always_inline]] inline bool is_usable(const kernel::ContactResponse& response,
                                             const Physics& physics, Host&& host) {
  if constexpr (std::decay_t<Host>::checks_response) {
    return (is_stable_stiffness(response.normal_stiffness, physics, host.time_step()) &&
            physics.tangensOfFrictionAngle >= 0 && is_finite_fast(response.force_on_1)) ||
           host.accepts(response.normal_stiffness, response.force_on_1, physics);
  } else {
    return true;
  }
}

/// Makes one step with the Hertz–Mindlin law.
/// @return false if the contact is open, true if it touches. After a failed check it is true, but
///     no forces are applied.
template <class Geometry, class Physics, class Host>
bool hertz_mindlin_step(const Geometry& geometry, Physics& physics, Host&& host) {
  ScopedHistory scoped(geometry, physics);
  kernel::ContactHistory& history = scoped.history;
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
        [&](double& work) {
          work += work_of_radius(response.normal_elastic_energy, physics.previousElasticEnergy,
                                 geometry.effectiveRadius, physics.previousRadius);
        },
        host.time_step(), geometry, physics));
  }
  if (!touches) return false;
  store(response, history, geometry.normal, physics);
  host.apply(kernel::contact_wrench(response.force_on_1, geometry.arm1, geometry.arm2));
  return true;
}

/// Reason why named laws are incompatible with a contact.
enum class Misfit { none, bulging_wall, no_axis };

/// Named laws. @tparam Law a JointLaw or a StaticJointLaw
template <class Law>
struct Named {
  Law law;
  bool needs_axis = false;  ///< a law needs the axis of a bearing
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

/// Begins a contact and returns its start time [s]. In the last step the bodies moved with the
/// constant half-step velocity, and the clearance changed by clearanceRate dt. The contact starts
/// when the linearly interpolated depth is 0.
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

/// Number of contacts that have begun, and the earliest start time.
struct FirstTouch {
  double first = std::numeric_limits<double>::quiet_NaN();  ///< [s]
  int count = 0;
  void add(double touched) {
    if (count == 0 || touched < first) first = touched;
    ++count;
  }
  void add(const FirstTouch& others) {
    if (others.count == 0) return;
    if (count == 0 || others.first < first) first = others.first;
    count += others.count;
  }
};

/// Makes one step with named laws. The contact must have no Misfit. If it touches, begin() must
/// have been called.
/// @return false if the contact is open, true if it touches. After a failed check it is true, but
///     no forces are applied.
/// @throws std::domain_error outside the range of a law
template <class Law, class Geometry, class Physics, class Host>
bool joint_law_step(const Law& law, const Geometry& geometry, Physics& physics,
                    const kernel::BodyMotion& motion_1, const kernel::BodyMotion& motion_2,
                    Host&& host) {
  namespace laws = kernel::laws;
  ScopedHistory scoped(geometry, physics);
  kernel::ContactHistory& history = scoped.history;
  history.memory.set_tracks_energy(host.tracks_energy());
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
        [&](double& work) {  // for a general law V(delta, R1, R2) has no closed form
          if (geometry.journalRadius == physics.previousRadius &&
              geometry.bearingRadius == physics.previousBearingRadius) {
            work += 0.0;  // adds zero, so that the result has the same bits as with the loop
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
  host.apply(response.wrench);
  // A law without memory computes a force that is not part of the history.
  if (!(physics.ks > 0)) physics.shearForce = -contact.tangential_force;
  physics.dissipationSlope = response.dissipation_slope;
  physics.frictionSlope = response.friction_slope;
  return true;
}

}  // namespace statejump::stepper
