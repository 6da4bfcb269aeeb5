// SPDX-License-Identifier: GPL-3.0-or-later
#include "truss/joints/relative_rotation.hpp"

#include <cmath>

#include "statejump/truss/model.hpp"
#include "truss/parts.hpp"

namespace statejump::truss::detail {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double angle_about(const RotationAt& at, const Vector3d& axis) {
  return 2.0 * std::atan2(at.v.dot(axis), at.w);
}

SpinGradient angle_gradient(const RotationAt& at, const Vector3d& axis) {
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

namespace {

RotationAt rotation_at(const Vector3d& turned) {
  const kernel::Quaternion found = kernel::rotation_of(turned);
  return {found.w(), found.vec()};
}

}  // namespace

void turn_part(const Model& model, std::size_t far, int link, int with_node, int node,
               JointFrame& frame) {
  if (link >= 0) {
    const Bar& part = model.links[index(link)];
    frame.nodes[far] = part.first == node ? part.second : part.first;
  } else if (with_node != 0) {
    frame.nodes[far] = rotation_site(model, node);
    frame.rotates[far] = true;
    frame.arms[far] = model.nodes[index(node)].arm;
  }
}

double node_angle(const Trial& trial, std::size_t site, const Vector3d& axis) {
  return angle_about(rotation_at(rotation_vector(trial, site)), axis);
}

NodeTurn node_turn(const Trial& trial, std::size_t site, const Vector3d& axis) {
  const Vector3d turned = rotation_vector(trial, site);
  const RotationAt at = rotation_at(turned);
  const SpinGradient by_spin = angle_gradient(at, axis);
  const double scale = 1.0 / trial.frame.arms[site];
  const Matrix3d spin = scale * kernel::spin_map(turned);
  return {angle_about(at, axis), spin.transpose() * by_spin.value,
          spin.transpose() * by_spin.slope * spin +
              scale * scale * kernel::spin_map_derivative(turned, by_spin.value)};
}

}  // namespace statejump::truss::detail
