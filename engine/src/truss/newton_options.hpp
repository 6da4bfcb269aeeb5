// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace statejump::truss::detail {

/// Tolerances and limits of Newton::solve(). `closure_tolerance` and force_rounding() belong to
/// System, because the path uses them too. Newton::Iteration::is_solved() combines these
/// tolerances.
struct NewtonOptions {
  /// Tolerated force residual divided by the largest force. Rounding causes 1e-15 in a row of about
  /// fifteen entries. The condition number of a large structure increases this by two to three
  /// decades.
  double force_tolerance = 1e-12;
  /// Number of earlier steps in the non-monotone line search: M = 10 of Grippo, Lampariello and
  /// Lucidi [2].
  std::size_t remembered_steps = 10;
  /// Newton's method counts as oscillating if this many steps have not halved the step length.
  std::size_t swing_steps = 4;
  /// Largest number of halvings in the line search. Ten reduce a step below a thousandth: no
  /// descent.
  int most_halvings = 10;
  /// Number of bisections for the fraction of a step at which a joint changes its status.
  int fraction_halvings = 50;
  /// Largest step along a displacement that only the regularisation resists, divided by the size of
  /// the truss. Longer steps could change lengths and directions of elements by more than a
  /// twentieth; the linearised equations would then be invalid.
  double proximal_fraction = 0.05;
  /// Interval between calls of the progress callback [s]. It is short enough for a progress bar and
  /// for Ctrl-C.
  double progress_interval_s = 0.1;
};

}  // namespace statejump::truss::detail
