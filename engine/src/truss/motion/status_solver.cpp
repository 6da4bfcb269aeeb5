// SPDX-License-Identifier: GPL-3.0-or-later
#include "status_solver.hpp"

#include <algorithm>
#include <cmath>

namespace statejump::truss::detail {

namespace {

/// Largest number of Newton iterations. Three or four suffice, unless a contact has a wrong status.
constexpr int most_iterations = 8;
/// Limit for slower cases: partial slip, whose tangents change, and a matrix without softening by
/// compression.
constexpr int most_tangents = 50;
/// The line search halves the step until the residual has decreased by this fraction, or the step
/// is short.
constexpr double least_fall = 1e-4;
constexpr double shortest_share = 1e-3;
/// If kept factors need more iterations than this, the next step computes new factors.
constexpr int few_iterations = 3;
/// Kept factors are abandoned if a correction exceeds this fraction of the previous correction.
constexpr double falls_to = 0.3;

using At = StepContacts::TangentAt;

}  // namespace

bool StatusSolver::solve(const ContactStatuses& statuses, TimeStep& step, StepContacts& contacts,
                         bool is_near) {
  VectorXd begun = contacts.impulses;
  for (std::size_t k = 0; k < statuses.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const Contact& contact = contacts.contact(i);
    const Eigen::Index n = 2 * i;
    if (statuses[k] == ContactStatus::open) begun.segment<2>(n).setZero();
    if (contact.normal_column < 0) begun[n] = step.h * contact.given_force;
    if (statuses[k] != ContactStatus::stick || contact.tangential_column < 0) {
      begun[n + 1] = StepContacts::friction_ratio(contact, statuses[k]) * begun[n];
    }
  }
  const bool slip_in_part = forces_.contacts().slip_in_part();
  StatusFactors& on = matrix_.factors_for(step.h, contacts, statuses);
  const VectorXd near = step.v;
  const auto begin = [&](bool there, At at) {
    step.v = there ? near : forces_.state().v;
    contacts.impulses = begun;
    if (slip_in_part) contacts.place_tangents(step, contacts.partial_slip_speeds(step), at);
  };
  const auto is_solved = [&](Tangents tangents) {
    const std::optional<int> iterations = iterate(on, step, contacts, tangents);
    const bool fresh = tangents == Tangents::anew || tangents == Tangents::downhill;
    on.outdated = !iterations || (!fresh && *iterations > few_iterations);
    return iterations.has_value();
  };
  if (!on.outdated) {
    begin(is_near, At::iterate);
    matrix_.scale_constraints(step, on.scale);
    if (is_solved(Tangents::kept)) return true;
  }
  on.outdated = true;
  if (slip_in_part) {
    if (is_near) {
      begin(true, At::iterate);
      if (is_solved(Tangents::anew)) return true;
    }
    begin(false, At::kinks);
    if (is_solved(Tangents::anew)) return true;
    begin(false, At::iterate);
    return is_solved(Tangents::downhill);
  }
  begin(is_near, At::iterate);
  if (!matrix_.factorize(on, step, contacts)) return false;
  if (is_solved(Tangents::once)) return true;
  if (!is_near) return false;
  begin(false, At::iterate);
  return is_solved(Tangents::once);
}

StatusSolver::Residual StatusSolver::residual(const StatusFactors& on, TimeStep& step,
                                              const StepContacts& contacts, double drift) {
  const VectorXd& v_before = forces_.state().v;
  const Eigen::Index n = v_before.size();
  const Eigen::Index held = matrix_.constraints().count();
  Residual found{VectorXd(n + held + contacts.impulses.size()), forces_.move(step), {}, true};
  VelocityConstraints& constraints = matrix_.constraints();
  constraints.follow();
  VectorXd& right = found.right;
  right.head(n) = contacts.directions * contacts.impulses - found.momentum;
  const double before = v_before.size() == 0 ? 0.0 : v_before.cwiseAbs().maxCoeff();
  const double speed = std::max(step.v.cwiseAbs().maxCoeff(), before);
  const double bound = allowance * speed + drift;
  if (held > 0) {
    found.held = constraints.push(step);
    right.head(n) -= found.held;
    right.segment(n, held) = constraints.lack(step);
    found.on_laws = constraints.met(step, right.segment(n, held), drift);
  }
  for (std::size_t j = 0; j < on.statuses.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    const Contact& contact = contacts.contact(i);
    const double normal = contacts.impulses[2 * i];
    for (const bool across : {true, false}) {
      const Eigen::Index row = 2 * i + (across ? 0 : 1);
      double& to = right[n + held + row];
      to = 0.0;
      if (on.statuses[j] == ContactStatus::open ||
          (across ? contact.normal_column < 0
                  : on.statuses[j] != ContactStatus::stick || contact.tangential_column < 0)) {
        continue;
      }
      const ContactRow law = across ? contacts.normal_row(step, i) : contacts.stick_row(step, i);
      const double off = contacts.residual(law, step, i, across);
      to = -on.scale * off;
      // StepForces::balanced() checks elastic normal laws and those of partial slip.
      if (across ? contact.is_elastic() : contact.slips_in_part) continue;
      const double friction = on_law * contact.friction_coefficient * std::abs(normal);
      found.on_laws = found.on_laws && std::abs(off) <= bound + law.compliance * friction;
    }
  }
  return found;
}

std::optional<int> StatusSolver::iterate(StatusFactors& on, TimeStep& step, StepContacts& contacts,
                                         Tangents tangents) {
  const bool kept = tangents == Tangents::kept;
  const bool downhill = tangents == Tangents::downhill;
  const bool renews = downhill || tangents == Tangents::anew;
  if (renews && !matrix_.factorize(on, step, contacts)) return {};
  const Eigen::Index n = forces_.state().q.size();
  const Eigen::Index held = matrix_.constraints().count();
  const double drift = forces_.rounding_at_middle(step) / step.h;
  step.held = VectorXd::Zero(held);
  const int most = renews || step.is_definite ? most_tangents : most_iterations;
  double last = 0.0;
  Residual lack = residual(on, step, contacts, drift);
  for (int k = 0; k <= most; ++k) {
    if (k > 0 && lack.on_laws && forces_.balanced(step, lack.momentum, lack.held, contacts, true)) {
      return k;
    }
    if (renews && k > 0 && !matrix_.factorize(on, step, contacts)) break;
    const VectorXd found = on.factor.solve(lack.right);
    if (!found.allFinite()) break;
    const double length = found.head(n).cwiseAbs().maxCoeff();
    if (kept && k > 1 && length > falls_to * last) break;
    last = length;
    const double allowed = downhill ? lack.right.norm() : 0.0;
    double by = 1.0;
    for (double share = 1.0;; share *= 0.5) {
      step.v += by * found.head(n);
      step.held += by * found.segment(n, held);
      contacts.impulses += by * on.scale * found.tail(contacts.impulses.size());
      if (forces_.contacts().slip_in_part()) {
        contacts.place_tangents(step, contacts.partial_slip_speeds(step),
                                downhill ? At::iterate : At::next);
      }
      lack = residual(on, step, contacts, drift);
      if (!downhill || share < shortest_share) break;
      if (lack.right.norm() <= (1.0 - least_fall * share) * allowed) break;
      by = -0.5 * share;
    }
  }
  return {};
}

}  // namespace statejump::truss::detail
