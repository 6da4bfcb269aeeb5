// SPDX-License-Identifier: GPL-3.0-or-later
// Straight links between two bodies, and torsion springs between two links: one step of each. The
// plugin's engines and the stepper call the same functions.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/kernel/stable_step.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::stepper {

using kernel::Vector3;
using Quaternion = Eigen::Quaterniond;

/// A link and its state between steps; the attributes of ThermalLink.
struct Link {
  int id1 = -1;
  int id2 = -1;
  double youngModulus = 0;      ///< E [Pa]
  double crossSectionArea = 0;  ///< A [m2]
  double stressFreeLength = 0;  ///< l0 [m]
  double thermalExpansion = 0;  ///< [1/K]
  double dampingRatio = 0;      ///< [-]
  double pinDamping = 0;        ///< [N m s/rad]
  bool tipTurnsWithLink = false;
  bool tensionOnly = false;             ///< a cable: never in compression
  double axialForce = 0;                ///< [N], compression positive
  double temperatureChange = 0;         ///< [K]
  double previousTension = 0;           ///< [N]
  double previousExtension = 0;         ///< [m]
  double previousStressFreeLength = 0;  ///< [m]
  double previousTime = 0;              ///< [s]
  Vector3 tipDirection = Vector3::Zero();
};

/// Direction and length of a link.
struct Span {
  Vector3 direction;  ///< unit, from root to tip
  double length;      ///< [m]
  bool is_proper() const { return length > 0 && std::isfinite(length); }
};

inline Span span_of(const Vector3& root, const Vector3& tip) {
  Span span{tip - root, 0};
  span.length = span.direction.norm();
  span.direction /= span.length;
  return span;
}

/// Damping coefficient c = 2 zeta sqrt(k m) [N s/m] with the link's stiffness at the reference
/// temperature.
/// @param inverse_mass 1/m1 + 1/m2 [1/kg]
inline double damping_coefficient(const Link& link, double inverse_mass) {
  if (!(link.dampingRatio > 0) || !(inverse_mass > 0)) return 0;
  const double stiffness = link.youngModulus * link.crossSectionArea / link.stressFreeLength;
  return 2 * link.dampingRatio * std::sqrt(stiffness / inverse_mass);
}

/// Forces of a link in one step. With extension e = L - l_T the tension is
///  N = k_T e + c (L' - l_T'), k_T = E A / l_T, and
///  N L' = d(k_T e^2 / 2)/dt + c (L' - l_T')^2 + [N + k_T e^2 / (2 l_T)] l_T',
/// so the thermal work on the link is -integral of [N + k_T e^2 / (2 l_T)] dl_T. A cable (tension
/// only) shorter than l_T is slack, with e = 0 and no force. While a cable shortens, the dashpot
/// force is limited to the tension of the spring, so N >= 0.
struct LinkStep {
  Span span;
  Vector3 relative_velocity;  ///< tip relative to root [m/s]
  Vector3 velocity_across;    ///< relative velocity perpendicular to the link [m/s]
  double stress_free_length;  ///< l_T [m]
  double stiffness;           ///< k_T [N/m]
  double damping;             ///< c, along the link [N s/m]
  double damping_across;      ///< perpendicular to the link, from pinDamping [N s/m]
  double extension;           ///< e [m]; 0 for a slack cable
  double extension_rate;      ///< [m/s]
  double viscous_force;       ///< dashpot part of N [N]
  double tension;             ///< N [N]
};

/// l_T [m] at a temperature change [K].
inline double stress_free_length(const Link& link, double temperature_change) {
  return link.stressFreeLength * (1 + link.thermalExpansion * temperature_change);
}

/// @param temperature_rate returns the rate T' of the temperature change [K/s]; only the first step
///     calls it
/// @param damping damping_coefficient() [N s/m]; @param time [s]
template <class Rate>
LinkStep link_step(Link& link, const Span& span, const Vector3& root_velocity,
                   const Vector3& tip_velocity, double temperature_change, Rate&& temperature_rate,
                   double damping, double time) {
  LinkStep step;
  step.span = span;
  step.relative_velocity = tip_velocity - root_velocity;
  const double length_rate = step.relative_velocity.dot(span.direction);
  link.temperatureChange = temperature_change;
  step.stress_free_length = stress_free_length(link, temperature_change);
  // Mean rate of the stress-free length over the last step, consistent with the half-step
  // velocities. At a corner of the program, the instantaneous rate would damp against a speed that
  // the tip does not have yet.
  const double since = time - link.previousTime;
  const double stress_free_rate =
      link.previousStressFreeLength > 0 && since > 0
          ? (step.stress_free_length - link.previousStressFreeLength) / since
          : link.stressFreeLength * link.thermalExpansion * temperature_rate();
  step.stiffness = link.youngModulus * link.crossSectionArea / step.stress_free_length;
  step.damping = damping;
  step.extension = span.length - step.stress_free_length;
  step.extension_rate = length_rate - stress_free_rate;
  step.viscous_force = damping * step.extension_rate;
  if (link.tensionOnly && step.extension <= 0) step.extension = step.viscous_force = 0;
  step.tension = step.stiffness * step.extension + step.viscous_force;
  if (link.tensionOnly && step.tension < 0) {
    step.viscous_force -= step.tension;
    step.tension = 0;
  }
  link.axialForce = -step.tension;
  // The damping moment of the pin acts as a transverse force on the tip and the opposite force on
  // the root.
  step.damping_across = link.pinDamping / (span.length * span.length);
  step.velocity_across = step.relative_velocity - length_rate * span.direction;
  return step;
}

/// Largest stable time step [s] of a link without other forces.
/// @param inverse_mass 1/m1 + 1/m2 [1/kg], > 0
inline double stable_step(const LinkStep& step, double inverse_mass) {
  return std::min(kernel::critical_time_step(1 / inverse_mass, step.stiffness, step.damping),
                  kernel::critical_time_step(1 / inverse_mass, 0, step.damping_across));
}

/// Force [N] of the link on its tip, from tension and pin damping; the root gets the opposite
/// force.
inline Vector3 force_on_tip(const LinkStep& step) {
  return -step.tension * step.span.direction - step.damping_across * step.velocity_across;
}

/// The smallest rotation from one unit vector to another. The quaternion is not normalized.
inline Quaternion smallest_rotation(const Vector3& from, const Vector3& to) {
  Quaternion turn;
  // (1 + cos, sin axis) is the quaternion before normalization. For nearly opposite vectors, 1 +
  // cos loses more than half of its digits to the rounding error 1e-16.
  constexpr double opposite = 1e-8;
  const double scalar = 1 + from.dot(to);
  if (!(scalar > opposite)) {
    // The quaternion is (2 cos(angle/2), 2 sin(angle/2) axis); for opposite vectors any
    // perpendicular axis is valid. Eigen's FromTwoVectors would decompose a matrix, which is slow
    // to compile.
    const Vector3 sum = from + to, difference = to - from;
    Vector3 axis = sum.cross(difference);
    if (!(axis.squaredNorm() > 0)) axis = difference.unitOrthogonal();
    turn.w() = sum.norm();
    turn.vec() = (difference.norm() / axis.norm()) * axis;
    return turn;
  }
  turn.w() = scalar;
  turn.vec() = from.cross(to);
  return turn;
}

/// Returns whether the tip only rotates about z, because its orientation, its direction and the new
/// direction are in the plane.
inline bool rotates_in_plane(const Link& link, const Vector3& direction,
                             const Quaternion& orientation) {
  return orientation.x() == 0 && orientation.y() == 0 && link.tipDirection.z() == 0 &&
         direction.z() == 0;
}

/// The rotation about z from one unit vector in the plane to another. Of the equivalent quaternions
/// q and -q, it returns the one in the half space of `same_half`.
inline Quaternion rotation_in_plane(const Vector3& from, const Vector3& to,
                                    const Quaternion& same_half) {
  const double cosine = from.x() * to.x() + from.y() * to.y();
  const double sine = from.x() * to.y() - from.y() * to.x();
  // tan(a/2) = sin/(1 + cos) = (1 - cos)/sin. At least one of these fractions has no cancellation.
  const double w = cosine >= 0 ? 1 + cosine : sine;
  const double z = cosine >= 0 ? sine : 1 - cosine;
  const double length = std::sqrt(w * w + z * z);
  const double scale = (w * same_half.w() + z * same_half.z() < 0 ? -1 : 1) / length;
  return {w * scale, 0, 0, z * scale};
}

/// Rotates the tip with its link and returns the force on the tip [N] that carries its moment.
///
/// The contacts of this step load the tip with a moment M. A couple of forces +-(M x u) / L at the
/// ends of the link replaces it, except for the component along the link: u L x (M x u) / L = M -
/// (M.u) u.
/// @param moment M [N m]; @param orientation, spin of the tip, updated
inline Vector3 rotate_tip(Link& link, const LinkStep& step, const Vector3& moment,
                          Quaternion& orientation, Vector3& spin) {
  const Vector3& direction = step.span.direction;
  const double inverse_length = 1 / step.span.length;
  const Vector3 carrying = moment.cross(direction) * inverse_length;
  if (link.tipDirection.isZero()) link.tipDirection = orientation.conjugate() * direction;
  if (rotates_in_plane(link, direction, orientation)) {
    orientation = rotation_in_plane(link.tipDirection, direction, orientation);
  } else {
    orientation = smallest_rotation(orientation * link.tipDirection, direction) * orientation;
    orientation.coeffs() *= 1 / orientation.norm();
  }
  spin = direction.cross(step.relative_velocity) * inverse_length;
  return carrying;
}

/// Energies of one link in one step [J]: `elastic` is the stored energy, all others are increments.
struct LinkEnergy {
  double elastic;
  double damping;
  double pin_damping;
  double thermal_work;
  bool works;  ///< whether thermal_work is valid: false in the first step
};

/// Decrease of the spring's energy per increase of its stress-free length [N]: k_T e^2 / (2 l_T).
inline double softening(double elastic_energy, double stress_free_length) {
  return elastic_energy / stress_free_length;
}

/// Softening of the previous step [N]; 0 before the first.
inline double previous_softening(const Link& link) {
  if (!(link.previousStressFreeLength > 0)) return 0;
  const double stiffness =
      link.youngModulus * link.crossSectionArea / link.previousStressFreeLength;
  return softening(0.5 * stiffness * link.previousExtension * link.previousExtension,
                   link.previousStressFreeLength);
}

/// @param last_softening in: previous_softening() [N]; out: value of this step
inline LinkEnergy energy(const Link& link, const LinkStep& step, double time_step,
                         double& last_softening) {
  LinkEnergy energy{0.5 * step.stiffness * step.extension * step.extension,
                    step.viscous_force * step.extension_rate * time_step,
                    step.damping_across * step.velocity_across.squaredNorm() * time_step, 0, false};
  const double now = softening(energy.elastic, step.stress_free_length);
  if (link.previousStressFreeLength > 0) {
    const double mean_tension = 0.5 * (step.tension + link.previousTension);
    energy.thermal_work = -(mean_tension + 0.5 * (now + last_softening)) *
                          (step.stress_free_length - link.previousStressFreeLength);
    energy.works = true;
  }
  last_softening = now;
  return energy;
}

/// Stores the state for the next step. @param time [s]
inline void keep(Link& link, const LinkStep& step, double time) {
  link.previousTension = step.tension;
  link.previousExtension = step.extension;
  link.previousStressFreeLength = step.stress_free_length;
  link.previousTime = time;
}

/// A torsion spring. The members are the attributes of TorsionSpring. The stretch s is the angle
/// minus the free angle. The moment is M0 + K_M (s - clamp(s; -a, a)) + M_f. The friction moment
/// M_f is that of a spring k_f in series with a friction slider: M_f = clamp(k_f (s - s_f); -M_c,
/// M_c). During slip s_f changes such that |M_f| = M_c.
struct Torsion {
  double stiffness = 0;  ///< K_M [N m/rad]
  double freeAngle = 0;  ///< [rad]
  Vector3 axis = Vector3::UnitZ();
  double deadband = 0;           ///< a [rad]
  double preload = 0;            ///< M0 [N m]
  double frictionLimit = 0;      ///< M_c [N m]
  double frictionStiffness = 0;  ///< k_f [N m/rad]
  double angle = 0;              ///< [rad]
  double moment = 0;             ///< [N m]
  double frictionMoment = 0;     ///< M_f [N m]
  double slipAngle = 0;          ///< s_f [rad]
};

/// Largest component of a link's unit direction along the spring's axis with which a spring counts
/// as planar. Rounding in a rotated plane is far smaller. Neglected terms are of order of its
/// square.
constexpr double largest_tilt = 1e-6;

inline bool is_planar(const Span& span, const Vector3& axis) {
  return std::abs(span.direction.dot(axis)) <= largest_tilt;
}

/// Stiffness of the spring outside the deadband, during stick [N m/rad].
inline double largest_stiffness(const Torsion& spring) {
  return spring.frictionLimit > 0 ? spring.stiffness + spring.frictionStiffness : spring.stiffness;
}

/// Energies of one spring in one step [J]: `elastic` is the stored energy, `friction` an increment.
struct TorsionEnergy {
  double elastic;
  double friction;
};

/// Updates angle and moment to this step.
inline TorsionEnergy torsion_step(Torsion& spring, const Span& first, const Span& second) {
  const Vector3 turn = first.direction.cross(second.direction);
  spring.angle = std::atan2(turn.dot(spring.axis), first.direction.dot(second.direction));
  const double stretch = spring.angle - spring.freeAngle;
  const double beyond = stretch - std::clamp(stretch, -spring.deadband, spring.deadband);
  const double elastic_moment = spring.stiffness * beyond;
  TorsionEnergy energy{0.5 * elastic_moment * beyond, 0};
  spring.moment = elastic_moment + spring.preload;
  energy.elastic += spring.preload * stretch;
  if (!(spring.frictionLimit > 0)) return energy;

  double friction = spring.frictionStiffness * (stretch - spring.slipAngle);
  if (std::abs(friction) > spring.frictionLimit) {
    friction = std::copysign(spring.frictionLimit, friction);
    const double slid_to = stretch - friction / spring.frictionStiffness;
    // Leapfrog does work with the mean of two successive moments.
    energy.friction = 0.5 * (friction + spring.frictionMoment) * (slid_to - spring.slipAngle);
    spring.slipAngle = slid_to;
  }
  energy.elastic += 0.5 * friction * (stretch - spring.slipAngle);
  spring.frictionMoment = friction;
  spring.moment += friction;
  return energy;
}

/// Inverse moment of inertia [1/(kg m2)] of a link under a couple of forces at its ends.
/// @param inverse_mass 1/m1 + 1/m2 [1/kg]
inline double inverse_inertia(const Span& span, double inverse_mass) {
  return inverse_mass / (span.length * span.length);
}

/// Force [N] on the tip of a link loaded by a moment [N m]. The root gets the opposite force.
inline Vector3 couple(const Span& span, const Vector3& axis, double moment) {
  const Vector3 across = axis.cross(span.direction);
  return moment / span.length * across;
}

}  // namespace statejump::stepper
