// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "iterate.hpp"

namespace statejump::complementarity {

/// Semismooth Newton on the equations of Alart and Curnier (1991),
///
///     r_n = (r_n - rho_n u_n)+,   r_t = P_D(r_t - rho_t u_t),  D = {|t| <= mu (r_n - rho_n u_n)+}.
///
/// Linearised about (r, u) they are linear equations for the new r: r = 0 for an open contact, u =
/// 0 for a sticking contact. For a sliding contact, with t = r_t - rho_t u_t, d = t/|t| and beta =
/// mu (r_n - rho_n u_n)/|t| < 1,
///
///     u_n = 0,   (I - beta P) r_t + beta rho_t P u_t - mu d r_n = 0,   P = I - d d^T.
///
/// If W is rank-deficient, the reactions of sticking contacts are undetermined. A proximal term eps
/// (r_new - r) in the velocities selects the reactions nearest to r and vanishes at the solution.
///
/// The line search is the non-monotone one of Grippo, Lampariello and Lucidi (1986) on the merit.
/// @returns the best iterate. The method ends after `most` linear systems, when the merit is within
///        the tolerance, or when the line search fails
Iterate newton(const ScaledProblem& problem, Iterate from, int most, double tolerance,
               int& counted);

}  // namespace statejump::complementarity
