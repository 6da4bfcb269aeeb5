// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's method for a step whose contacts are on branches.
#include <algorithm>
#include <cmath>

#include "stepper.hpp"

namespace statejump::truss::detail {

namespace {

/// Newton's method converges in three or four iterations, or a contact is on another branch.
constexpr int most_iterations = 8;
/// The same where contacts slip in part, whose tangents are taken anew every time, and where the
/// matrix leaves out compression.
constexpr int most_tangents = 50;
/// Share of an iteration that goes downhill, which is halved until what rows lack has fallen by
/// this share of it, or it is short.
constexpr double least_fall = 1e-4;
constexpr double shortest_share = 1e-3;
/// Kept factors that take more iterations than this are made again for the next step.
constexpr int few_iterations = 3;
/// With kept factors, corrections that do not fall to this share of the one before give them up.
constexpr double falls_to = 0.3;

}  // namespace

Stepper::Law Stepper::normal_law(const Trial& step, const Local& local, Eigen::Index i) const {
  if (!local.contacts[static_cast<std::size_t>(i)]->is_elastic()) return {leaving(step, local, i)};
  const Tangent law = tangent(step, local, i, local.directions.col(2 * i).dot(step.v));
  return {law.gap / step.h, law.compliance / (step.h * step.h)};
}

Stepper::Law Stepper::stick_law(const Trial& step, const Local& local, Eigen::Index i) const {
  const Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
  if (contact.slips_in_part) return rings_law(step, local, i);
  double normal = contact.given_force;
  if (contact.normal_column >= 0 && contact.is_elastic()) {
    normal = tangent(step, local, i, local.directions.col(2 * i).dot(step.v)).elastic;
  } else if (contact.normal_column >= 0) {
    normal = local.impulses[2 * i] / step.h;
  }
  const Contact::Along friction = contact.along(normal, step.h);
  return {friction.bend / step.h, friction.compliance / (step.h * step.h)};
}

double Stepper::lacks(const Law& law, const Trial& step, const Local& local, Eigen::Index i,
                      bool across) const {
  const Eigen::Index row = 2 * i + (across ? 0 : 1);
  double sum = law.by_speed * local.directions.col(row).dot(step.v) + law.offset +
               law.compliance * local.impulses[row];
  if (law.by_normal != 0.0) sum += law.by_normal * local.impulses[2 * owner(local, i)];
  if (law.by_beside != 0.0) {
    sum += law.by_beside * local.directions.col(2 * partner(local, i) + 1).dot(step.v);
  }
  return sum;
}

bool Stepper::solve_on(const std::vector<Branch>& branches, Trial& step, Local& local,
                       bool is_near) {
  VectorXd begun = local.impulses;
  for (std::size_t k = 0; k < branches.size(); ++k) {
    const Contact& contact = *local.contacts[k];
    const auto n = static_cast<Eigen::Index>(2 * k);
    if (branches[k] == Branch::open) begun.segment<2>(n).setZero();
    if (contact.normal_column < 0) begun[n] = step.h * contact.given_force;
    if (branches[k] != Branch::stick || contact.tangential_column < 0) {
      begun[n + 1] = slide(contact, branches[k]) * begun[n];
    }
  }
  OnBranches& on = factors_for(step.h, branches);
  const VectorXd near = step.v;
  const auto begin = [&](bool there, Seen seen) {
    step.v = there ? near : v_;
    local.impulses = begun;
    if (contacts_.slip_in_part()) {
      see_rings(step, local, speeds_of_rings(step, local), seen);
    }
  };
  const auto is_solved = [&](Tangents tangents) {
    const std::optional<int> iterations = iterate(on, step, local, tangents);
    const bool fresh = tangents == Tangents::anew || tangents == Tangents::downhill;
    on.outdated = !iterations || (!fresh && *iterations > few_iterations);
    return iterations.has_value();
  };
  if (!on.outdated) {
    begin(is_near, Seen::here);
    hold_directions(step, on.scale);
    if (is_solved(Tangents::kept)) return true;
  }
  on.outdated = true;
  if (contacts_.slip_in_part()) {
    if (is_near) {
      begin(true, Seen::here);
      if (is_solved(Tangents::anew)) return true;
    }
    begin(false, Seen::kinks);
    if (is_solved(Tangents::anew)) return true;
    begin(false, Seen::here);
    return is_solved(Tangents::downhill);
  }
  begin(is_near, Seen::here);
  if (!factorize(on, step, local)) return false;
  if (is_solved(Tangents::once)) return true;
  if (!is_near) return false;
  begin(false, Seen::here);
  return is_solved(Tangents::once);
}

Stepper::Lack Stepper::lack_of(const OnBranches& on, Trial& step, const Local& local,
                               double drift) {
  const Eigen::Index n = q_.size();
  const Eigen::Index held = holds_.cols();
  Lack found{VectorXd(n + held + local.impulses.size()), move(step), true};
  VectorXd& right = found.right;
  right.head(n) = local.directions * local.impulses - found.balance;
  const double before = v_.size() == 0 ? 0.0 : v_.cwiseAbs().maxCoeff();
  const double speed = std::max(step.v.cwiseAbs().maxCoeff(), before);
  const double bound = allowance * speed + drift;
  if (held > 0) {
    right.head(n) -= holds_ * step.held;
    right.segment(n, held) = held_speed_ - holds_.transpose() * step.v;
    const VectorXd sizes = holds_.cwiseAbs().transpose() * step.v.cwiseAbs();
    found.on_laws = ((right.segment(n, held).array().abs() <=
                      allowance * (sizes.array() + held_speed_.array().abs()) + on.scale * drift))
                        .all();
  }
  for (std::size_t j = 0; j < on.branches.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    const Contact& contact = *local.contacts[j];
    const double normal = local.impulses[2 * i];
    for (const bool across : {true, false}) {
      const Eigen::Index row = 2 * i + (across ? 0 : 1);
      double& to = right[n + held + row];
      to = 0.0;
      if (on.branches[j] == Branch::open ||
          (across ? contact.normal_column < 0
                  : on.branches[j] != Branch::stick || contact.tangential_column < 0)) {
        continue;
      }
      const Law law = across ? normal_law(step, local, i) : stick_law(step, local, i);
      const double off = lacks(law, step, local, i, across);
      to = -on.scale * off;
      // An elastic normal law and that of rings are for balanced() to judge.
      if (across ? contact.is_elastic() : contact.slips_in_part) continue;
      const double friction = on_law * contact.friction_coefficient * std::abs(normal);
      found.on_laws = found.on_laws && std::abs(off) <= bound + law.compliance * friction;
    }
  }
  return found;
}

std::optional<int> Stepper::iterate(OnBranches& on, Trial& step, Local& local, Tangents tangents) {
  const bool kept = tangents == Tangents::kept;
  const bool downhill = tangents == Tangents::downhill;
  const bool renews = downhill || tangents == Tangents::anew;
  if (renews && !factorize(on, step, local)) return {};
  const Eigen::Index n = q_.size();
  const Eigen::Index held = holds_.cols();
  VectorXd z = z_;
  z.head(n) = step.q_middle;
  const double drift = system_->length_rounding(z) / step.h;
  step.held = VectorXd::Zero(held);
  const int most = renews || step.is_definite ? most_tangents : most_iterations;
  double last = 0.0;
  Lack lack = lack_of(on, step, local, drift);
  for (int k = 0; k <= most; ++k) {
    if (k > 0 && lack.on_laws && balanced(step, lack.balance, step.held, local, true)) return k;
    if (renews && k > 0 && !factorize(on, step, local)) break;
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
      local.impulses += by * on.scale * found.tail(local.impulses.size());
      if (contacts_.slip_in_part()) {
        see_rings(step, local, speeds_of_rings(step, local), downhill ? Seen::here : Seen::next);
      }
      lack = lack_of(on, step, local, drift);
      if (!downhill || share < shortest_share) break;
      if (lack.right.norm() <= (1.0 - least_fall * share) * allowed) break;
      by = -0.5 * share;
    }
  }
  return {};
}

}  // namespace statejump::truss::detail
