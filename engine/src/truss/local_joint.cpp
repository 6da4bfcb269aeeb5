// SPDX-License-Identifier: GPL-3.0-or-later
#include "local_joint.hpp"

#include "truss/joints/writer.hpp"

namespace statejump::truss::detail {

namespace {

std::optional<bool> softens_of(const Joint& joint, const Trial& trial) {
  return std::visit(
      [&](const auto& one) -> std::optional<bool> {
        if constexpr (requires { one.softens(trial); }) return one.softens(trial);
        return {};
      },
      joint);
}

}  // namespace

LocalJoint::LocalJoint(const System& system, int joint, const VectorXd& z, double time,
                       const StepStart& start, JointModel model, double opening,
                       const System* of_pieces)
    : system_(&system),
      joint_(&system.model().joints[index(joint)]),
      first_force_(system.force_row(joint)),
      trial_(system.trial(joint, z, time, start, model, opening)) {
  memory_size_ = std::visit([](const auto& one) { return one.history(); }, *joint_);
  if (of_pieces == nullptr) {
    trial_.softens = softens_of(*joint_, trial_);
  } else {
    trial_.softens = softens_of(of_pieces->model().joints[index(joint)],
                                of_pieces->trial(joint, z, time, start, model, opening));
  }
  for (int k = 0; k < most_joint_nodes; ++k) {
    places_[index(k)] = system.dofs().at(trial_.frame.nodes[index(k)]);
  }
}

Trial LocalJoint::moved(const VectorXd& local) const {
  Trial made = trial_;
  for (int k = 0; k < most_joint_nodes; ++k) made.moved[index(k)] += local.segment<3>(3 * k);
  for (int k = 0; k < most_joint_forces; ++k) made.force[index(k)] += local[forces_from + k];
  return made;
}

VectorXd LocalJoint::local(const VectorXd& z) const {
  VectorXd made = VectorXd::Zero(size);
  for (int k = 0; k < trial_.frame.node_count; ++k) {
    const int site = trial_.frame.nodes[index(k)];
    if (site >= 0) made.segment<3>(3 * k) = system_->displacement(site, z);
  }
  made.segment(forces_from, forces()) = z.segment(first_force_, forces());
  return made;
}

void LocalJoint::add(const VectorXd& covector, VectorXd& to) const {
  for (int k = 0; k < trial_.frame.node_count; ++k) {
    const int site = trial_.frame.nodes[index(k)];
    if (site >= 0) system_->dofs().add_force(site, covector.segment<3>(3 * k), to);
  }
  to.segment(first_force_, forces()) += covector.segment(forces_from, forces());
}

VectorXd LocalJoint::residual(const Trial& at, JointStatus status,
                              std::vector<RowUnit>* units) const {
  Assembly to = Assembly::without_jacobian(size);
  to.residual.setZero();
  AssemblyStrand strand(to, 0);
  JointWriter writer(strand);
  for (int k = 0; k < most_joint_nodes; ++k) {
    const NodeDofs& place = places_[index(k)];
    writer.places[index(k)] = {3 * k, place.freedoms, place.directions};
  }
  writer.first_force = forces_from;
  std::visit([&](const auto& one) { one.evaluate(at, status, writer); }, *joint_);
  if (units != nullptr) *units = to.units;
  // Forces along free directions become forces in space.
  for (int k = 0; k < trial_.frame.node_count; ++k) {
    const NodeDofs& place = places_[index(k)];
    Vector3d force = Vector3d::Zero();
    for (int i = 0; i < place.freedoms; ++i) {
      force += to.residual[3 * k + i] * place.directions->col(i);
    }
    to.residual.segment<3>(3 * k) = force;
  }
  return to.residual;
}

VectorXd LocalJoint::commit(const Trial& at, JointStatus status) const {
  VectorXd made = VectorXd::Zero(memory_size_);
  std::visit([&](const auto& one) { one.commit(at, status, made.data()); }, *joint_);
  return made;
}

VectorXd LocalJoint::begin(const Trial& at, JointStatus status) const {
  VectorXd made = VectorXd::Zero(memory_size_);
  std::visit([&](const auto& one) { one.begin(at, status, made.data()); }, *joint_);
  return made;
}

int LocalJoint::slide_row() const {
  return std::visit([](const auto& one) { return static_cast<int>(one.slide_row); }, *joint_);
}

}  // namespace statejump::truss::detail
