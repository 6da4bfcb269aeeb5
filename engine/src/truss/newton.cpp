// SPDX-License-Identifier: GPL-3.0-or-later
#include "newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "parts.hpp"

namespace statejump::truss::detail {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
/// Forces balance to this share of the largest one.
constexpr double force_tolerance = 1e-12;

/// How often a set of statuses may come back: once or twice while Newton's iteration is still far
/// from its end, for ever in a cycle of the active set.
constexpr int most_visits = 2;

/// Joints that change in one iteration of a front.
constexpr int a_few = 4;

/// Newton has gone astray when a step is so many times as long as the first ones, and no small part
/// of the truss.
constexpr double divergence = 30.0;
constexpr double smallest_astray = 1e-4;

/// Hash (FNV-1a) of all statuses.
std::size_t fingerprint(const Statuses& statuses) {
  std::size_t hash = 14695981039346656037ull;
  for (const auto* list : {&statuses.sliders, &statuses.revolutes}) {
    for (const JointStatus status : *list) {
      hash = (hash ^ static_cast<std::size_t>(status)) * 1099511628211ull;
    }
  }
  return hash;
}

}  // namespace

SolveReport Newton::solve(double time, const StepStart& start, JointModel joints,
                          double clearance_scale, int most_iterations, VectorXd& z,
                          Statuses& statuses) {
  SolveReport report;
  const int displacements = system_->displacements();
  const double stiffness = system_->stiffness_scale();
  double last_step = std::numeric_limits<double>::infinity();
  // A front of slips may pass through the truss joint by joint, one an iteration: iterations do not
  // count while few joints change or no more than before, unless a set of statuses comes back.
  std::unordered_map<std::size_t, int> visits;
  int since_change = 0;
  int last_changes = std::numeric_limits<int>::max();
  double early_step = 0.0;
  for (int iteration = 0; since_change < most_iterations; ++iteration, ++since_change) {
    const double largest =
        system_->evaluate(z, time, start, statuses, joints, clearance_scale, residual_, jacobian_);
    const double reach = displacements == 0 ? 0.0 : z.head(displacements).lpNorm<Eigen::Infinity>();
    const double rounding = 64.0 * epsilon * stiffness * reach;
    const double balance =
        displacements == 0 ? 0.0 : residual_.head(displacements).lpNorm<Eigen::Infinity>();
    const Eigen::Index rest = residual_.size() - displacements;
    const double closure = rest == 0 ? 0.0 : residual_.tail(rest).lpNorm<Eigen::Infinity>();
    if (!std::isfinite(balance) || !std::isfinite(closure)) return report;
    // Lines of joints are metres while they hold and newtons while they slip; both are linear or
    // nearly so, and end at rounding. Where rounding is larger than foreseen the iteration stands
    // still: that is the end as well, if forces balance at all.
    const bool balanced = balance <= force_tolerance * largest + rounding &&
                          closure <= 1e-13 * reach + 16.0 * epsilon * largest;
    const bool still = last_step <= 1e-13 * reach && balance <= 1e3 * force_tolerance * largest;
    const bool small = iteration > 0 && (balanced || still);
    if (small) {
      int changed_joint = -1;
      Statuses corrected = statuses;
      const int changed = system_->correct_statuses(z, time, start, joints, clearance_scale,
                                                    corrected, changed_joint);
      if (changed == 0) {
        report.end = SolveEnd::converged;
        report.joint = -1;
        report.force_residual = largest > 0.0 ? balance / largest : 0.0;
        report.closure_residual = closure;
        return report;
      }
    }
    ++factorizations_;
    if (!factor_.factorize(jacobian_)) {
      report.end = SolveEnd::singular;
      return report;
    }
    const VectorXd step = factor_.solve(-residual_);
    if (!step.allFinite()) {
      report.end = SolveEnd::singular;
      return report;
    }
    z += step;
    last_step = displacements == 0 ? 0.0 : step.head(displacements).lpNorm<Eigen::Infinity>();
    if (iteration < 5) early_step = std::max(early_step, last_step);
    if (last_step > std::max(divergence * early_step, smallest_astray * system_->size())) {
      return report;
    }
    int joint = -1;
    const int changes =
        system_->correct_statuses(z, time, start, joints, clearance_scale, statuses, joint);
    if (changes > 0) {
      report.joint = joint;
      const bool calms_down = changes <= a_few || changes <= last_changes;
      last_changes = changes;
      if (++visits[fingerprint(statuses)] <= most_visits && calms_down) since_change = 0;
      last_step = std::numeric_limits<double>::infinity();
    }
  }
  return report;
}

}  // namespace statejump::truss::detail
