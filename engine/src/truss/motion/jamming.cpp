// SPDX-License-Identifier: GPL-3.0-or-later
// Slides that Coulomb's law does not let go on (Painlevé).
#include <cmath>

#include "stepper.hpp"

namespace statejump::truss::detail {

/// While a rigid contact slides, its normal force is what keeps its gap from closing: p r_n = −b,
/// with p the acceleration at which it opens for a unit of the normal force and of the friction
/// that comes with it. Where p is not above 0 the force has no solution or is one of several, and
/// the slide ends at once, by an impulse without a collision.
void Stepper::check_slides(const Trial& step, const Local& local) {
  if (jammed_) return;
  for (std::size_t i = 0; i < local.contacts.size(); ++i) {
    const Contact& contact = *local.contacts[i];
    const auto n = static_cast<Eigen::Index>(2 * i);
    const Branch before = branches_[static_cast<std::size_t>(active_[i])];
    if (!contact.is_rigid() || contact.tangential_column < 0 || before == Branch::stick) continue;
    const double normal = local.impulses[n];
    const bool leaves = contact.normal_force > 0.0 && normal == 0.0;
    const bool stops = normal > 0.0 && contact.sticks(normal, local.impulses[n + 1]);
    const double speed = local.before[n + 1];
    if (!(leaves || stops) || speed == 0.0) continue;
    OnBranches on;
    on.branches = branches_of(local);
    on.branches[i] = Branch::open;
    if (!factorize(on, step, local)) continue;
    const Eigen::Index rows = local.impulses.size();
    VectorXd right = VectorXd::Zero(q_.size() + holds_.cols() + rows);
    const VectorXd across = local.directions.col(n);
    right.head(q_.size()) =
        across + slide(contact, speed > 0.0 ? Branch::slip_plus : Branch::slip_minus) *
                     VectorXd(local.directions.col(n + 1));
    if (across.dot(on.factor.solve(right).head(q_.size())) > 0.0) continue;
    jammed_ = Undetermined{step.to, {contact.joint}};
    return;
  }
}

std::vector<Stepper::Branch> Stepper::branches_of(const Local& local) {
  std::vector<Branch> found;
  for (std::size_t i = 0; i < local.contacts.size(); ++i) {
    const double normal = local.impulses[static_cast<Eigen::Index>(2 * i)];
    const double friction = -local.impulses[static_cast<Eigen::Index>(2 * i + 1)];
    if (local.contacts[i]->slips_in_part) {
      const bool open = !local.contacts[i]->beside && !(normal > 0.0);
      found.push_back(open ? Branch::open : Branch::stick);
      continue;
    }
    found.push_back(!(normal > 0.0)                               ? Branch::open
                    : local.contacts[i]->sticks(normal, friction) ? Branch::stick
                    : friction >= 0.0                             ? Branch::slip_plus
                                                                  : Branch::slip_minus);
  }
  return found;
}

}  // namespace statejump::truss::detail
