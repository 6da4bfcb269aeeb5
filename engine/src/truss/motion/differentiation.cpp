// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of backward differentiation, and what they are off by.
#include <algorithm>

#include "stepper.hpp"

namespace statejump::truss::detail {

std::optional<double> Stepper::attempt(double to, bool give_up) {
  Trial step = trial(to);
  step.theta = 1.0;
  // BDF2 of unequal steps; without a step before implicit Euler.
  const double ratio = before_.length > 0.0 ? step.length / before_.length : 0.0;
  const double weight = 1.0 + 2.0 * ratio;
  step.differentiates = ratio > 0.0;
  step.h = (1.0 + ratio) / weight * step.length;
  VectorXd change = VectorXd::Zero(v_.size());  // of v in the step before, at this one's length
  if (ratio > 0.0) {
    change = ratio * (v_ - before_.v);
    step.v_from += ratio / weight * change;
    step.q_from += ratio * ratio / weight * (q_ - before_.q);
  }
  std::optional<Local> found = find(step, give_up);
  if (!found) return {};
  Local& local = *found;
  if (closes(local) && before_.length > 0.0) {
    before_.length = 0.0;
    return attempt(to, give_up);
  }
  // Leading term of what one step is off by: h²/2 v' of Euler, (1+r)²/(6r(1+2r)) h³ v'' of BDF2.
  const double share = ratio > 0.0 ? (1.0 + ratio) / (3.0 * weight) : 0.5;
  double off = deepest(step);
  if (v_.size() > 0) {
    off = std::max(off, share * step.length * (step.v - v_ - change).cwiseAbs().maxCoeff());
  }
  attempted_.emplace(std::move(step), std::move(local));
  return off;
}

void Stepper::accept() {
  const auto& [step, local] = *attempted_;
  before_ = {closes(local) ? 0.0 : step.length, q_, v_};
  book(step, local);
  attempted_.reset();
}

bool Stepper::closes(const Local& local) {
  for (std::size_t i = 0; i < local.contacts.size(); ++i) {
    const Contact& contact = *local.contacts[i];
    const double impulse = local.impulses[static_cast<Eigen::Index>(2 * i)];
    if (contact.is_rigid() && contact.normal_force == 0.0 && impulse > 0.0) {
      return true;
    }
  }
  return false;
}

double Stepper::deepest(const Trial& step) const {
  double most = 0.0;
  const VectorXd way = step.q - step.q_middle;
  for (const Contact& contact : contacts_.all()) {
    if (contact.active || contact.normal_column < 0 || contact.gap == Contact::infinite) continue;
    most = std::max(most, -gap_after(contact, way));
  }
  return most;
}

double Stepper::gap_after(const Contact& contact, const VectorXd& way) const {
  const linear::SparseView jacobian = joints_.jacobian();
  double gap = contact.gap;
  for (const auto& [column, share] : contact.normal_columns()) {
    if (column < 0) continue;
    for (linear::SparseView::InnerIterator it(jacobian, column); it; ++it) {
      if (it.row() < way.size()) gap += share * contact.normal_sign * it.value() * way[it.row()];
    }
  }
  return gap;
}

}  // namespace statejump::truss::detail
