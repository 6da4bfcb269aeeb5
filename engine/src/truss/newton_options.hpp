// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace statejump::truss::detail {

/// Tolerances and limits of Newton::solve(). `closure_tolerance` and force_rounding() belong to
/// System, because the path uses them too. `closed` and `still` in solve() combine them.
struct NewtonOptions {
  /// Tolerated force residual over the largest force. Rounding leaves 1e-15 in a row of about
  /// fifteen entries, and the condition number of a large structure costs two to three decades.
  double force_tolerance = 1e-12;
  /// Number of earlier steps in the monotonicity test: M = 10 of Grippo, Lampariello and Lucidi
  /// [2].
  std::size_t remembered_steps = 10;
  /// Newton's method counts as oscillating if the step length has not halved after this many steps.
  std::size_t swing_steps = 4;
  /// Largest number of halvings of a step. After ten the step is below a thousandth: no descent.
  int most_halvings = 10;
  /// Bisections for the fraction of a step at which a joint changes its status: accurate to 2^-50.
  int fraction_halvings = 50;
  /// Limit of a step along a displacement that only the regularisation resists, over the size of
  /// the truss. Longer steps change lengths and directions of the elements by more than a
  /// twentieth, so that the linearised equations no longer hold.
  double proximal_fraction = 0.05;
  /// Progress callback interval [s]: short enough for a progress bar and for Ctrl-C.
  double progress_interval_s = 0.1;
};

}  // namespace statejump::truss::detail
