// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cone.hpp"

namespace statejump::complementarity {

/// Reaction r of one contact alone: Coulomb's law with u = W r + q, W symmetric.
///
/// Open (r = 0) if q_n >= 0; else stick if r = -W^-1 q is in the cone; else sliding. A sliding
/// contact has u_n = 0 and u_t = -lambda r_t with lambda > 0. With S = W_tt - W_tn W_nt/W_nn and b
/// = q_t - W_tn q_n/W_nn this gives
///
///     r_t(lambda) = -(S + lambda I)^-1 b,   r_n(lambda) = -(q_n + W_nt r_t)/W_nn,
///
/// and lambda is the root of f(lambda) = |r_t| - mu r_n. f(0) > 0, because the contact does not
/// stick, and f(inf) = mu q_n/W_nn < 0. So a root exists and the solution is always found.
/// @returns false, and leaves r unchanged, if W_nn is not larger than `least`
bool solve_one_contact(const BlockMatrix& w, const Block& q, double mu, double least, Block& r);

}  // namespace statejump::complementarity
