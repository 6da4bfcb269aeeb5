// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "iterate.hpp"

namespace statejump::complementarity {

/// Sweeps over the contacts in turn, each solved exactly with the others held (Jourdan, Alart,
/// Jean 1998). No theory of convergence where W has less than full rank or friction is large, yet
/// it rarely diverges; the rate is linear and poor where forces pass through many contacts.
/// @returns after `sweeps`, or as soon as the merit is within the tolerance
Iterate gauss_seidel(const ScaledProblem& problem, Iterate from, int sweeps, double tolerance,
                     int& counted);

}  // namespace statejump::complementarity
