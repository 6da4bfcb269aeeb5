// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the reactions of a step are the only ones.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "stepper.hpp"

namespace statejump::truss::detail {

namespace {

/// Share of the largest pivot of W below which a reaction follows from others. W comes of solves
/// whose matrix has a condition of 1e4 at most: h²K is about as large as M.
constexpr double dependent = 1e-10;
/// Share of the largest reaction in a trade of reactions from which a joint is named.
constexpr double takes_part = 1e-3;

}  // namespace

std::vector<Stepper::Branch> Stepper::held_branches(const Trial& step, const Local& local) const {
  std::vector<Branch> held = branches_of(local);
  if (held.empty()) return held;
  VectorXd z = z_;
  z.head(q_.size()) = step.q_middle;
  const double fastest = std::max(v_.cwiseAbs().maxCoeff(), step.v.cwiseAbs().maxCoeff());
  const double rounding = allowance * fastest + system_->length_rounding(z) / step.h;
  const auto rests = [&](Eigen::Index row, double at) {
    return std::abs(local.directions.col(row).dot(step.v) + at) <= rounding;
  };
  for (std::size_t k = 0; k < held.size(); ++k) {
    const Contact& contact = *local.contacts[k];
    const auto i = static_cast<Eigen::Index>(k);
    if (held[k] == Branch::open && contact.is_rigid() && rests(2 * i, leaving(step, local, i))) {
      held[k] = Branch::slip_plus;
    }
    const bool slips = held[k] == Branch::slip_plus || held[k] == Branch::slip_minus;
    if (slips && contact.sticks_rigidly() && rests(2 * i + 1, 0.0)) held[k] = Branch::stick;
  }
  return held;
}

/// Reactions on branches whose system is regular are the only ones on these. For a contact that
/// neither pushes nor parts, or rubs at its bound and does not slide, the other branch is right as
/// well: reactions are unique if those are where it holds.
void Stepper::check_determined(const Trial& step, const Local& local) {
  if (undetermined_ || !contacts_.hold_rigidly()) return;
  const bool has_problem = local.delassus.size() > 0;
  const std::vector<Branch> held = held_branches(step, local);
  if (held == holding_ && active_ == holding_of_) return;
  if (!has_problem && held == branches_of(local)) return;
  holding_ = held;
  holding_of_ = active_;
  if (!has_problem) {
    OnBranches on;
    on.branches = held;
    if (factorize(on, step, local)) return;
  }
  // Rows of W that hold. How a slider's friction and its stop share a force is never determined:
  // it is one force there.
  std::vector<Eigen::Index> rows;
  int sticking_slider = -1;
  for (std::size_t k = 0; k < held.size(); ++k) {
    const Contact& contact = *local.contacts[k];
    const auto i = static_cast<Eigen::Index>(k);
    if (held[k] == Branch::open) continue;
    const bool stops = contact.stop != JointStatus::open && contact.joint == sticking_slider;
    if (contact.is_rigid() && !stops) rows.push_back(2 * i);
    if (held[k] == Branch::stick && contact.sticks_rigidly()) {
      rows.push_back(2 * i + 1);
      if (contact.normal_column < 0) sticking_slider = contact.joint;
    }
  }
  if (rows.size() < 2) return;
  std::optional<Local> whole;
  if (!has_problem) complete(step, whole.emplace(local));
  const Eigen::MatrixXd& delassus = whole ? whole->delassus : local.delassus;
  Eigen::FullPivLU<Eigen::MatrixXd> factors(Eigen::MatrixXd(delassus(rows, rows)));
  factors.setThreshold(dependent);
  if (factors.dimensionOfKernel() == 0) return;
  const VectorXd trade = factors.kernel().col(0).cwiseAbs();
  undetermined_ = Undetermined{step.to, {}};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (trade[static_cast<Eigen::Index>(k)] < takes_part * trade.maxCoeff()) continue;
    const int joint = local.contacts[static_cast<std::size_t>(rows[k] / 2)]->joint;
    std::vector<int>& joints = undetermined_->joints;
    if (std::find(joints.begin(), joints.end(), joint) == joints.end()) joints.push_back(joint);
  }
}

}  // namespace statejump::truss::detail
