// SPDX-License-Identifier: GPL-3.0-or-later
#include "velocity_constraints.hpp"

#include <vector>

namespace statejump::truss::detail {

namespace {

/// Fraction of the error of a constraint that a step removes. Displacements follow the mean of the
/// velocities at both ends, so a full correction would alternate.
constexpr double removed = 0.5;

}  // namespace

VelocityConstraints::VelocityConstraints(StepForces& forces, const std::vector<Drive>& drives)
    : forces_(forces), drives_(forces.system(), drives) {}

Eigen::Index VelocityConstraints::count() const {
  return constant_count() + turning_count() + drives_.count();
}

void VelocityConstraints::begin() {
  if (turning_count() == 0) return;
  const MotionState& state = forces_.state();
  const Assembly& joints = forces_.evaluate_springs(state.q, state.time);
  std::vector<Eigen::Triplet<double>> entries;
  append_turning(joints, 0, 1.0, entries);
  start_columns_.resize(state.q.size(), turning_count());
  start_columns_.setFromTriplets(entries.begin(), entries.end());
  start_closure_ = joints.residual(forces_.contacts().turning_holds());
}

void VelocityConstraints::set(const TimeStep& step, double scale) {
  const MotionState& state = forces_.state();
  const Eigen::Index n = state.q.size();
  scale_ = scale;
  columns_.resize(n, count());
  speeds_ = VectorXd::Zero(columns_.cols());
  if (columns_.cols() == 0) return;
  const linear::SparseView jacobian = forces_.joints().jacobian();
  constant_.clear();
  const std::vector<int>& holds = forces_.contacts().holds();
  for (std::size_t k = 0; k < holds.size(); ++k) {
    for (linear::SparseView::InnerIterator it(jacobian, holds[k]); it; ++it) {
      if (it.row() >= n) continue;
      constant_.emplace_back(it.row(), static_cast<Eigen::Index>(k), scale * it.value());
    }
  }
  const Eigen::Index driven = constant_count() + turning_count();
  for (const auto& one : drives_.directions(step.q_middle, step.to)) {
    constant_.emplace_back(one.row(), driven + one.col(), scale * one.value());
  }
  speeds_.tail(drives_.count()) = scale * drives_.targets(state.q, state.time, step.to);
  if (turning_count() > 0) {
    speeds_.segment(constant_count(), turning_count()) =
        -removed * scale / step.length * start_closure_;
  }
  fill(forces_.joints());
}

void VelocityConstraints::append_turning(const Assembly& joints, Eigen::Index first, double scale,
                                         std::vector<Eigen::Triplet<double>>& entries) const {
  const linear::SparseView jacobian = joints.jacobian();
  const Eigen::Index n = forces_.state().q.size();
  for (const int column : forces_.contacts().turning_holds()) {
    for (linear::SparseView::InnerIterator it(jacobian, column); it && it.row() < n; ++it) {
      entries.emplace_back(it.row(), first, scale * it.value());
    }
    ++first;
  }
}

void VelocityConstraints::fill(const Assembly& joints) {
  std::vector<Eigen::Triplet<double>> entries = constant_;
  append_turning(joints, constant_count(), scale_, entries);
  columns_.setFromTriplets(entries.begin(), entries.end());
}

void VelocityConstraints::follow() {
  if (turning_count() > 0) fill(forces_.springs());
}

bool VelocityConstraints::met(const TimeStep& step, const VectorXd& lack, double drift) const {
  const VectorXd sizes = columns_.cwiseAbs().transpose() * step.v.cwiseAbs();
  return (lack.array().abs() <=
          allowance * (sizes.array() + speeds_.array().abs()) + scale_ * drift)
      .all();
}

VectorXd VelocityConstraints::push(const TimeStep& step) const {
  VectorXd found = columns_ * step.held;
  if (turning_count() == 0 || step.theta == 1.0) return found;
  const VectorXd held = step.held.segment(constant_count(), turning_count());
  const VectorXd at_start = scale_ * (start_columns_ * held);
  const VectorXd at_end = columns_.middleCols(constant_count(), turning_count()) * held;
  return found + (1.0 - step.theta) * (at_start - at_end);
}

VectorXd VelocityConstraints::turning_forces(const TimeStep& step) const {
  return scale_ / step.h * step.held.segment(constant_count(), turning_count());
}

}  // namespace statejump::truss::detail
