// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <unsupported/Eigen/AutoDiff>

#include "statejump/kernel/rotation.hpp"
#include "statejump/truss/joints/ball_joint.hpp"
#include "truss/joints/hertz_contact.hpp"
#include "truss/joints/relative_rotation.hpp"

namespace statejump::truss::detail {

// Kinematics of a ball in its socket: the present state, and the changes since the start of the
// step. Numbers are doubles, or dual numbers with derivatives.

/// Variables: displacements of four nodes, three forces, the temperature.
constexpr int ball_variables = 3 * most_joint_nodes + most_joint_forces + 1;
using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, ball_variables, 1>>;
template <class Number>
using Vector = Eigen::Matrix<Number, 3, 1>;

inline double value_of(double number) {
  return number;
}
inline double value_of(const Dual& number) {
  return number.value();
}
/// A function of a number, given its value and derivative there.
inline double chain(double, const ByNormal& of) {
  return of.value;
}
inline Dual chain(const Dual& number, const ByNormal& of) {
  return {of.value, of.slope * number.derivatives()};
}

/// Local sites.
constexpr std::size_t ball = 0;
constexpr std::size_t socket = 1;
constexpr std::size_t ball_far = 2;    ///< What rotates the ball: far end of a link, or its node.
constexpr std::size_t socket_far = 3;  ///< What rotates the socket, likewise.

/// Memory of a ball joint in history(). With partial slip, the contact's memory follows.
struct BallMemory {
  Eigen::Vector3d offset;  ///< Ball minus socket [m].
  /// Vector from the far node of the ball's link to the ball [m], or rotation vector of its node
  /// [rad]; zero if the ball does not rotate.
  Eigen::Vector3d ball_direction;
  Eigen::Vector3d socket_direction;  ///< Likewise.
  Eigen::Vector3d friction;          ///< t [N].
  Eigen::Vector3d axis;  ///< Reference direction of the slip memory in the tangent plane; or zero.
  double ball_radius;    ///< At the contact [m].
  double socket_radius;  ///< Likewise.
  double normal_force;   ///< λ_n [N].
  double compliance;     ///< 1/k_t [m/N]; 0: open.

  static constexpr int size = 19;
  static BallMemory of(const double* from) {
    const auto vector = [from](int at) {
      return Eigen::Vector3d(from[at], from[at + 1], from[at + 2]);
    };
    return {vector(0), vector(3), vector(6), vector(9), vector(12),
            from[15],  from[16],  from[17],  from[18]};
  }
  void to(double* numbers) const {
    for (const Eigen::Vector3d* part :
         {&offset, &ball_direction, &socket_direction, &friction, &axis}) {
      numbers = std::copy(part->data(), part->data() + 3, numbers);
    }
    for (const double number : {ball_radius, socket_radius, normal_force, compliance}) {
      *numbers++ = number;
    }
  }
};

/// A ball joint at one state. If the ball is exactly in the middle of the socket, its normal is
/// zero.
template <class Number>
struct BallState {
  Vector<Number> offset;
  Vector<Number> ball_direction;    ///< As in BallMemory.
  Vector<Number> socket_direction;  ///< Likewise.
  Vector<Number> force;             ///< On the socket.
  Vector<Number> normal;
  Vector<Number> friction;  ///< t, the force across the normal.
  Number distance;
  Number clearance;
  Number ball_radius;
  Number socket_radius;
  Number normal_force;
  bool ball_turns = false;  ///< Whether ball_direction is the rotation vector of a node.
  bool socket_turns = false;
};

/// @param between returns the vector from one local site to another
/// @param rotation returns the rotation vector of a local site [rad]
template <class Number, class Between, class Rotation>
BallState<Number> ball_state(const BallJoint& joint, const Vector<Number>& force,
                             const Number& temperature_change, double opening, Between&& between,
                             Rotation&& rotation) {
  BallState<Number> s;
  s.offset = between(socket, ball);
  s.ball_direction = s.socket_direction = Vector<Number>::Zero();
  if (joint.ball_link >= 0) s.ball_direction = between(ball_far, ball);
  if (joint.socket_link >= 0) s.socket_direction = between(socket_far, socket);
  s.ball_turns = joint.ball_turns != 0;
  s.socket_turns = joint.socket_turns != 0;
  if (s.ball_turns) s.ball_direction = rotation(ball_far);
  if (s.socket_turns) s.socket_direction = rotation(socket_far);
  s.force = force;
  const double bore = joint.ball_radius + joint.radial_clearance;
  s.clearance =
      Number(opening * (joint.radial_clearance + temperature_change * joint.clearance_growth()));
  s.distance = Number(0.0);
  s.normal = Vector<Number>::Zero();
  s.normal_force = Number(0.0);
  s.friction = Vector<Number>::Zero();
  const Number squared = s.offset.squaredNorm();
  Number depth = Number(0.0);
  if (value_of(squared) > 0.0) {
    using std::sqrt;
    s.distance = sqrt(squared);
    s.normal = s.offset / s.distance;
    s.normal_force = s.normal.dot(force);
    s.friction = force - s.normal * s.normal_force;
    if (value_of(s.distance) > value_of(s.clearance)) depth = s.distance - s.clearance;
  }
  // Both surfaces meet half-way between them.
  s.ball_radius =
      joint.ball_radius * (1.0 + joint.ball_thermal_expansion * temperature_change) - 0.5 * depth;
  s.socket_radius =
      bore * (1.0 + joint.socket_thermal_expansion * temperature_change) + 0.5 * depth;
  return s;
}

inline BallState<double> ball_state_at(const BallJoint& joint, const Eigen::Vector3d& force,
                                       const Trial& at) {
  return ball_state<double>(
      joint, force, at.temperature_change, at.opening,
      [&](std::size_t from, std::size_t to) { return at.between(from, to); },
      [&](std::size_t site) { return rotation_vector(at, site); });
}

/// The ratio of an angle to its sine, as a function of the cosine of the angle.
inline ByNormal arc_over_sine(double cosine) {
  const double x = 1.0 - cosine;
  // The series with four terms is exact to rounding.
  if (x < 1e-4) {
    return {1.0 + x * (1.0 / 3.0 + x * (2.0 / 15.0 + x * (2.0 / 35.0))),
            -(1.0 / 3.0 + x * (4.0 / 15.0 + x * (6.0 / 35.0)))};
  }
  const double value = std::acos(cosine) / std::sqrt(x * (1.0 + cosine));
  return {value, (cosine * value - 1.0) / (x * (1.0 + cosine))};
}

/// Smallest rotation from one direction to another, as axis times angle [rad]. It is zero if the
/// directions are equal or undefined.
template <class Number>
Vector<Number> turned(const Eigen::Vector3d& before, const Vector<Number>& now) {
  using std::sqrt;
  Vector<Number> turn = Vector<Number>::Zero();
  if (before.isZero(0.0) || value_of(now.squaredNorm()) == 0.0) return turn;
  const Number scale = Number(1.0 / (before.norm() * sqrt(now.squaredNorm())));
  const Number cosine = before.cast<Number>().dot(now) * scale;
  // Computed from the difference, which is exact for nearly equal directions.
  const Vector<Number> change = now - before.cast<Number>();
  turn = before.cast<Number>().cross(change) *
         Number(chain(cosine, arc_over_sine(value_of(cosine))) * scale);
  return turn;
}

/// A coefficient of a rotation vector, as a function of the square of the angle.
inline ByNormal of_square(const kernel::AngleCoefficient& of) {
  return {of.value, 0.5 * of.slope};
}

/// Quaternion of a rotation vector [rad], scalar part last.
template <class Number>
Eigen::Matrix<Number, 4, 1> quaternion(const Vector<Number>& vector) {
  const Number square = vector.squaredNorm();
  const double squared = value_of(square);
  const double half = 0.5 * std::sqrt(squared);
  // sin(a/2)/a; the series with two terms is exact to rounding.
  const bool is_small = squared < 1e-4;
  const double part =
      is_small ? 0.5 - squared / 48.0 * (1.0 - squared / 80.0) : std::sin(half) / (2.0 * half);
  const double slope =
      is_small ? -1.0 / 48.0 + squared / 1920.0 : (0.5 * std::cos(half) - part) / (2.0 * squared);
  Eigen::Matrix<Number, 4, 1> made;
  made << vector * Number(chain(square, ByNormal{part, slope})),
      Number(chain(square, ByNormal{std::cos(half), -0.25 * part}));
  return made;
}

/// Rotation from one rotation vector to another, as axis times angle [rad].
template <class Number>
Vector<Number> turned_by_node(const Eigen::Vector3d& before, const Vector<Number>& now) {
  const Eigen::Matrix<Number, 4, 1> to = quaternion(now);
  const Eigen::Matrix<Number, 4, 1> from = quaternion<double>(before).cast<Number>();
  const Vector<Number> v = to.template head<3>(), u = from.template head<3>();
  const Vector<Number> part = v * from[3] - u * to[3] - v.cross(u);
  const Number cosine = to.dot(from);  // of half the angle
  return part * Number(2.0 * chain(cosine, arc_over_sine(value_of(cosine))));
}

/// Generalised force on a rotation vector [rad] that does the work of a moment.
template <class Number>
Vector<Number> moment_on(const Vector<Number>& vector, const Vector<Number>& moment) {
  const Number square = vector.squaredNorm();
  const kernel::SpinCoefficients c = kernel::spin_coefficients(std::sqrt(value_of(square)));
  const Vector<Number> once = vector.cross(moment);
  return moment - once * Number(chain(square, of_square(c.first))) +
         vector.cross(once) * Number(chain(square, of_square(c.second)));
}

/// Rotates a vector from the tangent plane of one unit normal into that of another, by the smallest
/// rotation between the normals.
template <class Number>
Vector<Number> carried(const Vector<Number>& tangential, const Vector<Number>& from,
                       const Vector<Number>& to) {
  const Vector<Number> half = from + to;
  return tangential - half * Number(2.0 * tangential.dot(to) / half.squaredNorm());
}

/// Rotates a vector in the tangent plane about its normal.
template <class Number>
Vector<Number> spun(const Vector<Number>& tangential, const Vector<Number>& normal,
                    const Number& angle) {
  using std::cos;
  using std::sin;
  return tangential * Number(cos(angle)) + normal.cross(tangential) * Number(sin(angle));
}

/// Slide and rotations of a step, and friction at its start, in the tangent plane at its end.
template <class Number>
struct BallSlide {
  Vector<Number> slide;  ///< σ [m].
  Vector<Number> kept;   ///< Friction at the start, rotated with the contact [N].
  Vector<Number> axis;   ///< Reference direction of the slip memory, rotated likewise [-].
};

template <class Number>
BallSlide<Number> ball_slide(const BallState<Number>& now, const BallMemory& start) {
  using std::sqrt;
  BallSlide<Number> found{Vector<Number>::Zero(), Vector<Number>::Zero(),
                          start.axis.cast<Number>()};
  if (start.offset.isZero(0.0) || value_of(now.distance) == 0.0) return found;
  const Vector<Number> before = start.offset.normalized().cast<Number>();
  const Vector<Number> sum = before + now.normal;
  const Vector<Number> middle = sum / Number(sqrt(sum.squaredNorm()));
  const Vector<Number> ball_turned = now.ball_turns
                                         ? turned_by_node(start.ball_direction, now.ball_direction)
                                         : turned(start.ball_direction, now.ball_direction);
  const Vector<Number> socket_turned =
      now.socket_turns ? turned_by_node(start.socket_direction, now.socket_direction)
                       : turned(start.socket_direction, now.socket_direction);
  const Number ball_radius = 0.5 * (start.ball_radius + now.ball_radius);
  const Number socket_radius = 0.5 * (start.socket_radius + now.socket_radius);
  const Number distance = 0.5 * (start.offset.norm() + now.distance);
  const Vector<Number> rolls =
      ball_turned.cross(middle) * ball_radius - socket_turned.cross(middle) * socket_radius;
  const Vector<Number> orbits = turned(start.offset, now.offset).cross(now.normal) * distance;
  const Number twist = 0.5 * (ball_turned + socket_turned).dot(middle);
  const Vector<Number> straight = orbits + carried<Number>(rolls, middle, now.normal);
  found.slide = spun<Number>(straight, now.normal, Number(0.5 * twist));
  const auto keep = [&](const Eigen::Vector3d& tangential) {
    return spun<Number>(carried<Number>(tangential.cast<Number>(), before, now.normal), now.normal,
                        twist);
  };
  found.kept = keep(start.friction);
  if (!start.axis.isZero(0.0)) found.axis = keep(start.axis);
  return found;
}

/// Elastic predictor of a step: the tangential deflection that the contact has if it sticks.
template <class Number>
struct BallBend {
  BallSlide<Number> moved;
  Vector<Number> pull;  ///< Trial deflection [m].
  Number compliance;    ///< Compliance of the sticking contact [m/N].
  Number mean;          ///< Mean compliance of the step [m/N].
};

/// @param softens see Trial::softens
template <class Number>
BallBend<Number> ball_bend(const BallJoint& joint, const BallState<Number>& now,
                           const BallMemory& start, std::optional<bool> softens = {}) {
  const HertzContact contact{joint.hertz_stiffness, joint.mindlin_stiffness,
                             joint.radial_clearance};
  BallBend<Number> bend;
  bend.moved = ball_slide(now, start);
  bend.compliance =
      chain(now.normal_force, contact.tangential_compliance(value_of(now.normal_force)));
  const double before = start.compliance;
  bend.mean = 0.5 * (before + bend.compliance);
  if (before == 0.0) {
    bend.pull = bend.moved.slide;
    bend.mean = bend.compliance;
  } else if (softens.value_or(value_of(bend.compliance) > before)) {
    bend.pull = bend.moved.slide + bend.moved.kept * Number(before);
  } else {
    // ∫ dF/k_t by the trapezoidal rule.
    bend.compliance = bend.mean;
    bend.pull = bend.moved.slide + bend.moved.kept * bend.compliance;
  }
  return bend;
}

/// Direction of friction at the end of a step in which the contact slips.
///
/// Friction t rotates towards a straight slide s by dϑ/ds = −(k_t/|t|) sin ϑ, where ϑ is the angle
/// between t and s. This is a tractrix: tan(ϑ/2) falls as E = exp(−∫ k_t ds/|t|). Let t and s be
/// unit vectors, and c = t·s and q = (1 − c)/(1 + c) = tan²(ϑ/2) at the start. Then friction ends
/// along (1 − E)(1 + q E) s + E (1 + q) t. If slip begins within the step, or if the slide nearly
/// reverses, the trial force is projected onto the cone instead.
/// @param slipped whether the contact slipped at the start of the step
/// @pre `bend.pull` is not zero
template <class Number>
Vector<Number> slip_direction(const BallJoint& joint, const BallState<Number>& now,
                              const BallMemory& start, const BallBend<Number>& bend, bool slipped) {
  using std::sqrt;
  Vector<Number> projected = bend.pull / Number(sqrt(bend.pull.squaredNorm()));
  const Number squared = bend.moved.slide.squaredNorm();
  const double kept = start.friction.norm();
  if (!slipped || !(kept > 0.0) || !(value_of(squared) > 0.0)) return projected;
  const Number mean_bound =
      0.5 * joint.friction_coefficient * (start.normal_force + now.normal_force);
  const Number slid = sqrt(squared);
  const Number turns = slid / (bend.mean * mean_bound);
  const Vector<Number> before = bend.moved.kept / Number(kept);
  const Vector<Number> along = bend.moved.slide / slid;
  const Number cosine = before.dot(along);
  // For short slides, tractrix and projection agree to rounding.
  if (!(value_of(turns) > 1e-7) || !(value_of(cosine) > -0.5)) return projected;
  const double left = std::exp(-value_of(turns));
  const Number stays = chain(turns, {left, -left});
  const Number goes = chain(turns, {-std::expm1(-value_of(turns)), left});
  const Number q = (1.0 - cosine) / (1.0 + cosine);
  const Vector<Number> sum =
      along * Number(goes * (1.0 + q * stays)) + before * Number(stays * (1.0 + q));
  return sum / Number(1.0 + q * stays * stays);
}

}  // namespace statejump::truss::detail
