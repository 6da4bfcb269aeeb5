// SPDX-License-Identifier: GPL-3.0-or-later
#include "reaction_uniqueness.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace statejump::truss::detail {

namespace {

/// If a pivot of W is below this fraction of the largest pivot, the reaction depends on other
/// reactions. W results from matrices of condition 1e4 at most, because h²K is about as large as M.
constexpr double dependent = 1e-10;
/// A joint is named if its reaction in a null vector exceeds this fraction of the largest reaction.
constexpr double takes_part = 1e-3;

}  // namespace

ContactStatuses ReactionUniqueness::held_statuses(const TimeStep& step,
                                                  const StepContacts& contacts) const {
  ContactStatuses held = contacts.statuses();
  if (held.empty()) return held;
  const double fastest =
      std::max(forces_.state().v.cwiseAbs().maxCoeff(), step.v.cwiseAbs().maxCoeff());
  const double rounding = allowance * fastest + forces_.rounding_at_middle(step) / step.h;
  const auto rests = [&](Eigen::Index row, double at) {
    return std::abs(contacts.speed(step, row) + at) <= rounding;
  };
  for (std::size_t k = 0; k < held.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const Contact& contact = contacts.contact(i);
    if (held[k] == ContactStatus::open && contact.is_rigid() &&
        rests(2 * i, contacts.leaving_speed(step, i))) {
      held[k] = ContactStatus::slip_plus;
    }
    const bool slips = held[k] == ContactStatus::slip_plus || held[k] == ContactStatus::slip_minus;
    if (slips && contact.sticks_rigidly() && rests(2 * i + 1, 0.0)) held[k] = ContactStatus::stick;
  }
  return held;
}

void ReactionUniqueness::check(const TimeStep& step, const StepContacts& contacts) {
  if (found_ || !forces_.contacts().hold_rigidly()) return;
  const bool has_problem = contacts.delassus.matrix.size() > 0;
  const ContactStatuses held = held_statuses(step, contacts);
  if (held == checked_ && contacts.numbers == active_) return;
  if (!has_problem && held == contacts.statuses()) return;
  checked_ = held;
  active_ = contacts.numbers;
  if (!has_problem) {
    StatusFactors on;
    on.statuses = held;
    if (matrix_.factorize(on, step, contacts)) return;
  }
  // Constrained rows of W. Friction and stop force of a slider count as one force, because statics
  // never determines how they share it.
  std::vector<Eigen::Index> rows;
  int sticking_slider = -1;
  for (std::size_t k = 0; k < held.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const Contact& contact = contacts.contact(i);
    if (held[k] == ContactStatus::open) continue;
    const bool stops = contact.stop != JointStatus::open && contact.joint == sticking_slider;
    if (contact.is_rigid() && !stops) rows.push_back(2 * i);
    if (held[k] == ContactStatus::stick && contact.sticks_rigidly()) {
      rows.push_back(2 * i + 1);
      if (contact.normal_column < 0) sticking_slider = contact.joint;
    }
  }
  if (rows.size() < 2) return;
  const Eigen::MatrixXd delassus =
      has_problem ? contacts.delassus.matrix : matrix_.delassus(step, contacts).matrix;
  Eigen::FullPivLU<Eigen::MatrixXd> factors(Eigen::MatrixXd(delassus(rows, rows)));
  factors.setThreshold(dependent);
  if (factors.dimensionOfKernel() == 0) return;
  const VectorXd trade = factors.kernel().col(0).cwiseAbs();
  found_ = Undetermined{step.to, {}};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (trade[static_cast<Eigen::Index>(k)] < takes_part * trade.maxCoeff()) continue;
    const int joint = contacts.contact(rows[k] / 2).joint;
    std::vector<int>& joints = found_->joints;
    if (std::find(joints.begin(), joints.end(), joint) == joints.end()) joints.push_back(joint);
  }
}

}  // namespace statejump::truss::detail
