// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/joints/rigid_arm.hpp"

#include "statejump/kernel/require.hpp"
#include "statejump/kernel/rotation.hpp"
#include "statejump/truss/model.hpp"
#include "truss/joints/relative_rotation.hpp"
#include "truss/joints/writer.hpp"
#include "truss/parts.hpp"

namespace statejump::truss {

using detail::index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// Local sites of the joint.
constexpr std::size_t at_node = 0, at_master = 1, at_rotation = 2;

Vector3d drawn_arm(const Trial& trial) {
  return trial.drawn[at_node] - trial.drawn[at_master];
}

/// Force on the node, in the order of the unknowns along the columns of the frame [N].
Vector3d total_force(const Trial& trial) {
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < trial.frame.forces; ++k) {
    sum += trial.force[index(k)] * trial.frame.axes.col(k);
  }
  return sum;
}

/// Whether supports let a row depend on any dof. The row is constant if neither node moves along
/// the direction, and the master cannot rotate the arm such that its component changes.
bool is_constant(const Node& node, const Node& master, const Vector3d& along) {
  constexpr double least = 1e-9;
  for (const Node* one : {&node, &master}) {
    for (int i = 0; i < one->freedoms; ++i) {
      if (std::abs(one->free_directions.col(i).dot(along)) > least) return false;
    }
  }
  const Vector3d arm = node.position - master.position;
  if (master.rotations == 0 || arm.isZero(0.0)) return true;
  if (master.rotations > 1) return false;
  const Vector3d once = Vector3d(master.rotation_directions.col(0)).cross(arm);
  const Vector3d twice = Vector3d(master.rotation_directions.col(0)).cross(once);
  return std::abs(once.dot(along)) <= least * arm.norm() &&
         std::abs(twice.dot(along)) <= least * arm.norm();
}

}  // namespace

std::span<const Parameter<RigidArm>> RigidArm::parameters() {
  using R = RigidArm;
  static const Parameter<R> table[] = {
      {"master", "master", "-", Allowed::node, "the case's nodes", &R::master},
      {"node", "node", "-", Allowed::node, "the case's nodes", &R::node},
      {"holds", "displacement along x", "-", Allowed::flag, "the case", &R::holds_x, 0, 6},
      {"holds", "displacement along y", "-", Allowed::flag, "the case", &R::holds_y, 1, 6},
      {"holds", "displacement along z", "-", Allowed::flag, "the case", &R::holds_z, 2, 6},
      {"holds", "rotation about x", "-", Allowed::flag, "the case", &R::holds_rotation_x, 3, 6},
      {"holds", "rotation about y", "-", Allowed::flag, "the case", &R::holds_rotation_y, 4, 6},
      {"holds", "rotation about z", "-", Allowed::flag, "the case", &R::holds_rotation_z, 5, 6},
  };
  return table;
}

std::span<const Output> RigidArm::outputs() {
  // Force that the arm exerts on the node.
  static const Output table[] = {{"rigid_force_N", 3}};
  return table;
}

void RigidArm::validate(const Model&) const {
  if (node == master) {
    throw kernel::OutOfRange("rigid '" + name + "'", "node", node, "another than the master");
  }
}

JointFrame RigidArm::frame(const Model& model) const {
  JointFrame frame;
  frame.nodes = {node, master, rotation_site(model, master), -1};
  frame.node_count = 3;
  frame.arms[at_rotation] = model.nodes[index(master)].arm;
  const std::array<bool, 3> held{holds_x, holds_y, holds_z};
  Matrix3d axes;
  int last = 2;
  for (int k = 0; k < 3; ++k) {
    const Vector3d along = Vector3d::Unit(k);
    const bool has_force =
        held[index(k)] && !is_constant(model.nodes[index(node)], model.nodes[index(master)], along);
    axes.col(has_force ? frame.forces++ : last--) = along;
  }
  if (axes.determinant() < 0.0) axes.col(2) *= -1.0;
  frame.axes = axes;
  return frame;
}

std::vector<Constraint> RigidArm::ties(const Model& model) const {
  std::vector<Constraint> made;
  const std::array<bool, 3> held{holds_rotation_x, holds_rotation_y, holds_rotation_z};
  for (int k = 0; k < 3; ++k) {
    if (!held[index(k)]) continue;
    const Vector3d about = Vector3d::Unit(k);
    made.push_back(
        {name, {{rotation_site(model, node), about}, {rotation_site(model, master), -about}}});
  }
  return made;
}

void RigidArm::evaluate(const Trial& trial, JointStatus, JointWriter& writer) const {
  const double scale = 1.0 / trial.frame.arms[at_rotation];
  const Vector3d turned = detail::rotation_vector(trial, at_rotation);
  const Vector3d drawn = drawn_arm(trial);
  const kernel::Quaternion rotation = kernel::rotation_of(turned);
  const Vector3d swung = kernel::moved_by(rotation, drawn);
  const Vector3d arm = drawn + swung;
  const Vector3d apart = trial.moved[at_node] - trial.moved[at_master] - swung;
  const Matrix3d spin = scale * kernel::spin_map(turned);
  const Vector3d force = total_force(trial);
  writer.carries(force.norm());
  const Vector3d torque = -arm.cross(force);
  writer.force(at_node, force);
  writer.force(at_master, -force);
  writer.force(at_rotation, spin.transpose() * torque);
  for (int k = 0; k < trial.frame.forces; ++k) {
    const Vector3d along = trial.frame.axes.col(k);
    const Vector3d by_rotation = spin.transpose() * Vector3d(along.cross(arm));
    writer.closure(k, along.dot(apart));
    writer.corner(k, k, 0.0);
    writer.row(k, at_node, along);
    writer.row(k, at_master, -along);
    writer.row(k, at_rotation, by_rotation);
    writer.column(at_node, k, along);
    writer.column(at_master, k, -along);
    writer.column(at_rotation, k, by_rotation);
  }
  const Matrix3d by_spin = -kernel::skew(force) * kernel::skew(arm);
  const Matrix3d hessian = spin.transpose() * by_spin * spin +
                           scale * scale * kernel::spin_map_derivative(turned, torque);
  writer.block(at_rotation, at_rotation, 0.5 * (hessian + hessian.transpose()));
}

void RigidArm::describe(const Trial& trial, double* outputs) const {
  Eigen::Map<Vector3d> found(outputs);
  found = -total_force(trial);
}

}  // namespace statejump::truss
