// SPDX-License-Identifier: GPL-3.0-or-later
#include "velocity_constraints.hpp"

#include <vector>

namespace statejump::truss::detail {

VelocityConstraints::VelocityConstraints(const StepForces& forces, const std::vector<Drive>& drives)
    : forces_(forces), drives_(forces.system(), drives) {}

Eigen::Index VelocityConstraints::count() const {
  return static_cast<Eigen::Index>(forces_.contacts().holds().size()) + drives_.count();
}

void VelocityConstraints::set(const TimeStep& step, double scale) {
  const MotionState& state = forces_.state();
  const Eigen::Index n = state.q.size();
  const std::vector<int>& holds = forces_.contacts().holds();
  const auto holding = static_cast<Eigen::Index>(holds.size());
  scale_ = scale;
  columns_.resize(n, count());
  speeds_ = VectorXd::Zero(columns_.cols());
  if (columns_.cols() == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  const linear::SparseView jacobian = forces_.joints().jacobian();
  for (Eigen::Index k = 0; k < holding; ++k) {
    const int column = holds[static_cast<std::size_t>(k)];
    for (linear::SparseView::InnerIterator it(jacobian, column); it; ++it) {
      if (it.row() < n) entries.emplace_back(it.row(), k, scale * it.value());
    }
  }
  for (const auto& one : drives_.directions(step.q_middle, step.to)) {
    entries.emplace_back(one.row(), holding + one.col(), scale * one.value());
  }
  speeds_.tail(drives_.count()) = scale * drives_.targets(state.q, state.time, step.to);
  columns_.setFromTriplets(entries.begin(), entries.end());
}

}  // namespace statejump::truss::detail
