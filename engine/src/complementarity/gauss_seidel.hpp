// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "iterate.hpp"

namespace statejump::complementarity {

/// Sweeps over the contacts. Each contact is solved exactly while the reactions of the others are
/// fixed (Jourdan, Alart, Jean 1998). Convergence is not proved if W is rank-deficient or friction
/// is large, but divergence is rare. Convergence is linear, and slow if forces pass through many
/// contacts.
/// @returns the iterate after `sweeps`, or earlier if the merit is within the tolerance
Iterate gauss_seidel(const ScaledProblem& problem, Iterate from, int sweeps, double tolerance,
                     int& counted);

}  // namespace statejump::complementarity
