// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "iterate.hpp"

namespace statejump::complementarity {

/// Semismooth Newton on the equations of Alart and Curnier (1991),
///
///     r_n = (r_n - rho_n u_n)+,   r_t = P_D(r_t - rho_t u_t),  D = {|t| <= mu (r_n - rho_n u_n)+}.
///
/// Linearised about (r, u) they are linear equations for the new r: r = 0 where a contact is open;
/// u = 0 where it sticks; and where it slides, with t = r_t - rho_t u_t, d = t/|t| and
/// beta = mu (r_n - rho_n u_n)/|t| < 1,
///
///     u_n = 0,   (I - beta P) r_t + beta rho_t P u_t - mu d r_n = 0,   P = I - d d^T.
///
/// A W of less than full rank leaves the reactions of stuck contacts undetermined; a proximal term
/// eps (r_new - r) on the velocities picks the nearest ones and vanishes at the solution.
///
/// The line search is the non-monotone one of Grippo, Lampariello and Lucidi (1986) on the merit.
/// @returns best iterate, after `most` linear systems, within the tolerance, or where the line
/// search ends
Iterate newton(const ScaledProblem& problem, Iterate from, int most, double tolerance,
               int& counted);

}  // namespace statejump::complementarity
