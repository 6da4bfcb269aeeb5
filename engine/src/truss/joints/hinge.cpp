// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/joints/hinge.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "statejump/kernel/require.hpp"
#include "statejump/kernel/rotation.hpp"
#include "statejump/truss/model.hpp"
#include "truss/joints/writer.hpp"
#include "truss/parts.hpp"

namespace statejump::truss {

using detail::index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// Local sites: rotations of the nodes.
constexpr std::size_t of_first = 0, of_second = 1;

Vector3d rotation_vector(const Trial& trial, std::size_t which) {
  return trial.moved[which] / trial.frame.arms[which];
}

/// Rotation of the second node relative to the first one, in axes that rotate with the first node.
struct Relative {
  kernel::Quaternion first;
  double w;
  Vector3d v;
};

Relative relative(const Trial& trial) {
  const kernel::Quaternion first = kernel::rotation_of(rotation_vector(trial, of_first));
  const kernel::Quaternion second = kernel::rotation_of(rotation_vector(trial, of_second));
  const kernel::Quaternion both = first.conjugate() * second;
  return {first, both.w(), both.vec()};
}

double rotation_of(const Hinge& hinge, const Trial& trial) {
  const Relative at = relative(trial);
  return 2.0 * std::atan2(at.v.dot(hinge.axis), at.w);
}

/// Lever that converts a moment to a force [m].
double radius_of(const Trial& trial) {
  return trial.frame.arms[of_first];
}

/// Elastic rotation of sticking friction [rad].
double bend(const Hinge& hinge, const Trial& trial) {
  return radius_of(trial) * trial.force[0] / hinge.friction_stiffness;
}

/// Slipped part of the rotation [rad].
double slipped(const Hinge& hinge, const Trial& trial) {
  return rotation_of(hinge, trial) - bend(hinge, trial);
}

/// Rotation beyond the play [rad].
double beyond_play(const Hinge& hinge, double rotation) {
  return rotation - std::clamp(rotation, -hinge.deadband, hinge.deadband);
}

/// Gradient of a function of the relative rotation by the relative spin, in axes of the first node,
/// and its derivative by that spin.
struct Gradient {
  Vector3d value;
  Matrix3d slope;
};

/// Rates of w and v by the spin.
struct QuaternionRates {
  Eigen::RowVector3d w;
  Matrix3d v;

  explicit QuaternionRates(const Relative& at)
      : w(-0.5 * at.v.transpose()), v(0.5 * (at.w * Matrix3d::Identity() - kernel::skew(at.v))) {}
};

/// Of the rotation about the axis.
Gradient of_rotation(const Relative& at, const Vector3d& axis) {
  const QuaternionRates rates(at);
  const double s = at.v.dot(axis);
  const Eigen::RowVector3d s_rate = axis.transpose() * rates.v;
  const double size = at.w * at.w + s * s;
  const Vector3d across = at.v.cross(axis);
  const Vector3d sum = at.w * at.w * axis + at.w * across + s * at.v;
  const Matrix3d sum_rate = (2.0 * at.w * axis + across) * rates.w -
                            at.w * kernel::skew(axis) * rates.v + at.v * s_rate + s * rates.v;
  const Eigen::RowVector3d size_rate = 2.0 * (at.w * rates.w + s * s_rate);
  return {sum / size, (sum_rate - sum / size * size_rate) / size};
}

/// Of v·t, half the tilt about t.
Gradient of_tilt(const Relative& at, const Vector3d& t) {
  const QuaternionRates rates(at);
  return {0.5 * (at.w * t + at.v.cross(t)), 0.5 * (t * rates.w - kernel::skew(t) * rates.v)};
}

/// Writes the moments of a hinge on both nodes, and their derivatives.
class HingeWriter {
 public:
  HingeWriter(const Trial& trial, const Relative& at, JointWriter& writer) : writer_(&writer) {
    axes_ = at.first.toRotationMatrix();
    for (const std::size_t which : {of_first, of_second}) {
      rotation_[which] = rotation_vector(trial, which);
      arm_[which] = trial.frame.arms[which];
      spin_[which] = kernel::spin_map(rotation_[which]) / arm_[which];
    }
  }

  /// Row and column of an unknown for the gradient of a function.
  /// @param by_row factor of the function in the row; @param by_force moment over force [m]
  void row(int row, const Gradient& of, double by_row, double by_force) const {
    const Vector3d world = axes_ * of.value;
    for (const std::size_t which : {of_first, of_second}) {
      const Vector3d gradient = sign(which) * (spin_[which].transpose() * world);
      writer_->row(row, which, by_row * gradient);
      writer_->column(which, row, by_force * gradient);
    }
  }
  /// Moments of size `moment` conjugate to a function, and their derivative.
  /// @param stiffness derivative of the moment by the function
  void moment(const Gradient& of, double moment, double stiffness) {
    const Vector3d world = axes_ * of.value;
    const Matrix3d by_relative = axes_ *
                                 (moment * of.slope + stiffness * of.value * of.value.transpose()) *
                                 axes_.transpose();
    torque_ += moment * world;
    by_relative_ += by_relative;
  }
  void finish() const {
    // The torque rotates with the first node.
    const Matrix3d turning = -kernel::skew(torque_);
    for (const std::size_t on : {of_first, of_second}) {
      writer_->force(on, sign(on) * (spin_[on].transpose() * torque_));
      for (const std::size_t by : {of_first, of_second}) {
        Matrix3d block = sign(on) * sign(by) * by_relative_;
        if (by == of_first) block += sign(on) * turning;
        block = (spin_[on].transpose() * block * spin_[by]).eval();
        if (on == by) {
          block += kernel::spin_map_derivative(rotation_[on], sign(on) * torque_) /
                   (arm_[on] * arm_[on]);
        }
        writer_->block(on, by, block);
      }
    }
  }

 private:
  static double sign(std::size_t which) { return which == of_second ? 1.0 : -1.0; }

  JointWriter* writer_;
  Matrix3d axes_;
  std::array<Vector3d, 2> rotation_;
  std::array<double, 2> arm_;
  std::array<Matrix3d, 2> spin_;
  Vector3d torque_ = Vector3d::Zero();  // on the second node, world axes
  Matrix3d by_relative_ = Matrix3d::Zero();
};

}  // namespace

std::span<const Parameter<Hinge>> Hinge::parameters() {
  using H = Hinge;
  static const Parameter<H> table[] = {
      {"nodes", "first node", "-", Allowed::node, "the case's nodes", &H::first, 0, 2},
      {"nodes", "second node", "-", Allowed::node, "the case's nodes", &H::second, 1, 2},
      {"deadband_rad", "deadband", "rad", Allowed::not_negative, "the case", &H::deadband},
      {"stiffness_N_m_per_rad", "stiffness", "N m/rad", Allowed::not_negative, "the case",
       &H::stiffness},
      {"friction_moment_N_m", "friction_moment", "N m", Allowed::not_negative, "the case",
       &H::friction_moment},
      {"friction_stiffness_N_m_per_rad", "friction_stiffness", "N m/rad",
       Allowed::positive_or_infinite, "the case", &H::friction_stiffness},
      {"preload_moment_N_m", "preload_moment", "N m", Allowed::finite, "the case",
       &H::preload_moment},
      {"axis", "axis", "-", Allowed::direction, "the case", &H::axis},
  };
  return table;
}

std::span<const Output> Hinge::outputs() {
  // Rotation of the second node against the first; moment against it (preload, stiffness and
  // friction).
  static const Output table[] = {{"beam_hinge_rotation_rad", 1}, {"beam_hinge_moment_N_m", 1}};
  return table;
}

void Hinge::validate(const Model& model) const {
  const std::string item = "hinge '" + name + "'";
  if (second == first) {
    throw kernel::OutOfRange(item, "second node", second, "another than the first");
  }
  const double apart =
      (model.nodes[index(second)].position - model.nodes[index(first)].position).norm();
  if (!(apart <= 1e-9 * model.nodes[index(first)].arm)) {
    throw kernel::OutOfRange(item, "distance of its nodes", apart, "0 m");
  }
}

JointFrame Hinge::frame(const Model& model) const {
  JointFrame frame;
  frame.nodes = {rotation_site(model, first), rotation_site(model, second), -1, -1};
  frame.node_count = 2;
  frame.arms[of_first] = model.nodes[index(first)].arm;
  frame.arms[of_second] = model.nodes[index(second)].arm;
  // Rotations of the nodes across the axis. Supports may prevent some or all of them.
  const detail::Matrix32 plane = detail::plane_of(axis);
  Eigen::Matrix<double, 2, 6> tilts = Eigen::Matrix<double, 2, 6>::Zero();
  int column = 0;
  for (const int which : {first, second}) {
    const Node& node = model.nodes[index(which)];
    for (int i = 0; i < node.rotations; ++i) {
      tilts.col(column++) = plane.transpose() * node.rotation_directions.col(i);
    }
  }
  const Eigen::JacobiSVD<Eigen::Matrix<double, 2, 6>> found(tilts, Eigen::ComputeFullU);
  constexpr double least = 1e-9;
  const auto rows = static_cast<int>((found.singularValues().array() > least).count());
  const bool is_any = rows == 1;  // otherwise the plane itself will do
  detail::Matrix32 across = plane;
  if (is_any) across = plane * found.matrixU();
  frame.forces = 1 + rows;
  frame.axes << across, across.col(0).cross(across.col(1));
  return frame;
}

std::vector<Constraint> Hinge::ties(const Model&) const {
  std::vector<Constraint> made;
  for (int k = 0; k < 3; ++k) {
    const Vector3d along = Vector3d::Unit(k);
    made.push_back({name, {{second, along}, {first, -along}}});
  }
  return made;
}

void Hinge::evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const {
  const double rotation = rotation_of(*this, trial);
  const double radius = radius_of(trial);
  const double force = trial.force[0];
  const double moment = elastic_moment(rotation) + radius * force;
  const double tangent = std::abs(rotation) < deadband ? 0.0 : stiffness;
  const Relative at = relative(trial);
  const Gradient about = of_rotation(at, axis);
  HingeWriter write(trial, at, writer);
  writer.carries(force);
  writer.carries(moment / radius);
  double corner = 0.0;
  double sticks = 0.0;
  switch (status) {
    case JointStatus::slip_plus:
    case JointStatus::slip_minus: {
      const double sense = status == JointStatus::slip_plus ? 1.0 : -1.0;
      writer.balance(0, force - sense * friction_moment / radius);
      corner = 1.0;
      break;
    }
    default:
      writer.closure(0, radius * (slipped(*this, trial) - trial.history[0]));
      corner = -radius * radius / friction_stiffness;
      sticks = radius;
  }
  writer.corner(0, 0, corner);
  write.row(0, about, sticks, radius);
  write.moment(about, moment, tangent);
  for (int k = 1; k < trial.frame.forces; ++k) {
    const Vector3d t = trial.frame.axes.col(k - 1);
    const Gradient tilt = of_tilt(at, t);
    // v·t is half of a small tilt.
    writer.closure(k, 2.0 * radius * at.v.dot(t));
    writer.corner(k, k, 0.0);
    writer.carries(trial.force[index(k)]);
    write.row(k, tilt, 2.0 * radius, 2.0 * radius);
    write.moment(tilt, 2.0 * radius * trial.force[index(k)], 0.0);
  }
  write.finish();
}

JointStatus Hinge::decide(const Trial& trial, JointStatus status) const {
  const double force = trial.force[0];
  if (status == JointStatus::stick) {
    const double bound = friction_moment / radius_of(trial) + trial.force_rounding;
    return force > bound    ? JointStatus::slip_plus
           : force < -bound ? JointStatus::slip_minus
                            : status;
  }
  const double sense = status == JointStatus::slip_plus ? 1.0 : -1.0;
  const double slid = radius_of(trial) * (slipped(*this, trial) - trial.history[0]);
  const double rounding = slide_rounding(trial, trial.length_rounding, trial.force_rounding);
  if (sense * slid >= -rounding) return status;
  if (friction_moment > 0.0) return JointStatus::stick;
  // Without friction both directions of slip are admissible.
  return sense > 0.0 ? JointStatus::slip_minus : JointStatus::slip_plus;
}

void Hinge::begin(const Trial& trial, JointStatus, double* now) const {
  now[0] = slipped(*this, trial);
}

void Hinge::commit(const Trial& trial, JointStatus status, double* after) const {
  begin(trial, status, after);
}

double Hinge::slip(const Trial& trial, const double* after) const {
  return radius_of(trial) * (after[0] - trial.history[0]);
}

double Hinge::dissipation(const Trial& trial, const double*, double slip) const {
  return friction_moment / radius_of(trial) * std::abs(slip);
}

double Hinge::elastic_energy(const Trial& trial, const double* now) const {
  const double rotation = rotation_of(*this, trial);
  const double beyond = beyond_play(*this, rotation);
  const double bent = std::isinf(friction_stiffness)
                          ? 0.0
                          : 0.5 * friction_stiffness * std::pow(rotation - now[0], 2);
  return 0.5 * stiffness * beyond * beyond + preload_moment * rotation + bent;
}

double Hinge::elastic_moment(double rotation) const {
  return preload_moment + stiffness * beyond_play(*this, rotation);
}

std::array<double, 2> Hinge::beyond_edges(const Trial& trial) const {
  const double radius = radius_of(trial), rotation = rotation_of(*this, trial);
  return {radius * (rotation - deadband), radius * (rotation + deadband)};
}

void Hinge::describe(const Trial& trial, double* outputs) const {
  const double rotation = rotation_of(*this, trial);
  outputs[0] = rotation;
  outputs[1] = elastic_moment(rotation) + radius_of(trial) * trial.force[0];
}

double Hinge::slide_rounding(const Trial& trial, double length, double force) const {
  // Equal rounding errors of both rotations, each measured at its own arm.
  const double turned = length * std::max(1.0, radius_of(trial) / trial.frame.arms[of_second]);
  return turned + std::pow(radius_of(trial), 2) * force / friction_stiffness;
}

bool Hinge::remembers_when(JointStatus before, JointStatus after) const {
  return friction_moment > 0.0 && is_slip(before) &&
         (after == JointStatus::stick || is_slip(after));
}

std::optional<LocalContact> Hinge::contact(const Trial& trial, JointStatus) const {
  return LocalContact{0, -1, 1.0, friction_moment / radius_of(trial)};
}

}  // namespace statejump::truss
