// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/joints/hinge.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "statejump/kernel/require.hpp"
#include "statejump/kernel/rotation.hpp"
#include "statejump/truss/model.hpp"
#include "truss/joints/hinge_law.hpp"
#include "truss/joints/relative_rotation.hpp"
#include "truss/joints/writer.hpp"
#include "truss/parts.hpp"

namespace statejump::truss {

using detail::index;
using detail::QuaternionRates;
using detail::rotation_vector;
using detail::SpinGradient;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// Local sites: rotations of the nodes.
constexpr std::size_t of_first = 0, of_second = 1;

/// Rotation of the second node relative to the first one, in axes that rotate with the first node.
struct Relative : detail::RotationAt {
  kernel::Quaternion first;
};

Relative relative(const Trial& trial) {
  const kernel::Quaternion first = kernel::rotation_of(rotation_vector(trial, of_first));
  const kernel::Quaternion second = kernel::rotation_of(rotation_vector(trial, of_second));
  const kernel::Quaternion both = first.conjugate() * second;
  return {{both.w(), both.vec()}, first};
}

/// Of v·t, half the tilt about t.
SpinGradient of_tilt(const Relative& at, const Vector3d& t) {
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
  void row(int row, const SpinGradient& of, double by_row, double by_force) const {
    const Vector3d world = axes_ * of.value;
    for (const std::size_t which : {of_first, of_second}) {
      const Vector3d gradient = sign(which) * (spin_[which].transpose() * world);
      writer_->row(row, which, by_row * gradient);
      writer_->column(which, row, by_force * gradient);
    }
  }
  /// Moments of size `moment` conjugate to a function, and their derivative.
  /// @param stiffness derivative of the moment by the function
  void moment(const SpinGradient& of, double moment, double stiffness) {
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
  static const std::vector<Parameter<H>> table = detail::with_hinge_law<H>({
      {"nodes", "first node", "-", Allowed::node, "the case's nodes", &H::first, 0, 2},
      {"nodes", "second node", "-", Allowed::node, "the case's nodes", &H::second, 1, 2},
  });
  return table;
}

std::span<const Output> Hinge::outputs() {
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
  const Law law = evaluate_law(trial, status, writer);
  const double radius = law.radius;
  const Relative at = relative(trial);
  const SpinGradient about = detail::angle_gradient(at, axis);
  HingeWriter write(trial, at, writer);
  write.row(0, about, law.by_row, radius);
  write.moment(about, law.moment, law.tangent);
  for (int k = 1; k < trial.frame.forces; ++k) {
    const Vector3d t = trial.frame.axes.col(k - 1);
    const SpinGradient tilt = of_tilt(at, t);
    // v·t is half of a small tilt.
    writer.closure(k, 2.0 * radius * at.v.dot(t));
    writer.corner(k, k, 0.0);
    writer.carries(trial.force[index(k)]);
    write.row(k, tilt, 2.0 * radius, 2.0 * radius);
    write.moment(tilt, 2.0 * radius * trial.force[index(k)], 0.0);
  }
  write.finish();
}

double Hinge::rotation(const Trial& trial) const {
  return detail::angle_about(relative(trial), axis);
}

double Hinge::radius(const Trial& trial) const {
  return trial.frame.arms[of_first];
}

double Hinge::turning_ratio(const Trial& trial) const {
  return std::max(1.0, radius(trial) / trial.frame.arms[of_second]);
}

template struct HingeLaw<Hinge>;

}  // namespace statejump::truss
