// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace statejump::truss::detail {

/// Tolerances and limits of Newton::solve(). `closure_tolerance` and force_rounding() belong to
/// System, because the path uses them too. `closed` and `still` in solve() combine them.
struct NewtonOptions {
  /// Forces balance to this fraction of the largest one. A sum of some fifteen entries in a row
  /// leaves 1e-15 by rounding, and the condition of a structure of many elements takes two to three
  /// decades.
  double force_tolerance = 1e-12;
  /// Steps that a step is compared with: M = 10 of Grippo, Lampariello and Lucidi [2].
  std::size_t remembered_steps = 10;
  /// Steps after which Newton's method goes to and fro if they have not even halved.
  std::size_t swing_steps = 4;
  /// Halvings of a step after which it is below a thousandth: Newton's direction leads nowhere.
  int most_halvings = 10;
  /// Halvings of the fraction of a step at which a joint changes its status: to rounding of the
  /// step, 2^-50.
  int fraction_halvings = 50;
  /// Length of a step along a displacement that only the regularisation resists, in the size of the
  /// truss. Beyond it the lengths and directions of the elements differ from those of the equations
  /// by more than a twentieth.
  double proximal_fraction = 0.05;
  /// Interval of progress callbacks [s]: short enough for a progress bar and for Ctrl-C.
  double progress_interval_s = 0.1;
};

}  // namespace statejump::truss::detail
