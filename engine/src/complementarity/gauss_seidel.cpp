// SPDX-License-Identifier: GPL-3.0-or-later
#include "gauss_seidel.hpp"

#include <utility>

#include "one_contact.hpp"

namespace statejump::complementarity {

namespace {

/// Normal compliance over the mean normal compliance below which it is rounding. Such a contact
/// cannot be solved alone.
constexpr double least_compliance = 1e-15;
/// Sweeps between two evaluations of the merit. One evaluation costs as much as a sweep.
constexpr int sweeps_per_check = 5;

}  // namespace

Iterate gauss_seidel(const ScaledProblem& problem, Iterate from, int sweeps, double tolerance,
                     int& counted) {
  const int d = problem.dimension();
  Eigen::VectorXd r = std::move(from.r);
  Eigen::VectorXd u = std::move(from.u);
  for (int sweep = 1; sweep <= sweeps; ++sweep) {
    ++counted;
    for (Eigen::Index i = 0; i < problem.contacts(); ++i) {
      const BlockMatrix& w = problem.blocks()[static_cast<std::size_t>(i)];
      const Block before = block_of(r, i, d);
      const Block q = block_of(u, i, d) - w * before;
      Block after = before;
      if (!solve_one_contact(w, q, problem.mu()[i], least_compliance, after)) continue;
      if (after == before) continue;
      problem.add_columns(i, after - before, u);
      set_block(r, i, d, after);
    }
    if (sweep % sweeps_per_check == 0 || sweep == sweeps) {
      if (problem.merit(r, u) <= tolerance) break;
    }
  }
  // Recomputed, to remove the rounding of many updates.
  return Iterate(problem, std::move(r));
}

}  // namespace statejump::complementarity
