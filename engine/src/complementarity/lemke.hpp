// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <optional>

#include "scaled_problem.hpp"

namespace statejump::complementarity {

/// Lemke's pivoting on a planar problem as a linear complementarity problem, for each contact
///
///     0 <= r_n ⟂ u_n >= 0,          0 <= p ⟂ lambda + u_t >= 0,
///     0 <= m   ⟂ lambda - u_t >= 0,  0 <= lambda ⟂ mu r_n - p - m >= 0,      r_t = p - m,
///
/// in which lambda is the slip |u_t| (Stewart and Trinkle 1996). If W is positive semidefinite, the
/// matrix is copositive and the method ends at a solution or on a ray. The lexicographic choice of
/// the leaving variable prevents cycling. The table has (4 contacts) x (8 contacts) entries and the
/// number of pivots grows with the contacts, so the method suits small problems.
/// @param problem of dimension 2
/// @returns reactions; empty if it ends on a ray or after `most` pivots
std::optional<Eigen::VectorXd> lemke(const ScaledProblem& problem, int most, int& counted);

}  // namespace statejump::complementarity
