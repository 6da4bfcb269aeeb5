// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cone.hpp"

namespace statejump::complementarity {

/// Computes the reaction r of a single contact from Coulomb's law and u = W r + q with symmetric W.
///
/// The contact is open (r = 0) if q_n >= 0. Otherwise it sticks if r = -W^-1 q is in the cone, and
/// slides if not. A sliding contact has u_n = 0 and u_t = -lambda r_t with lambda > 0. With S =
/// W_tt - W_tn W_nt/W_nn and b = q_t - W_tn q_n/W_nn this gives
///
///     r_t(lambda) = -(S + lambda I)^-1 b,   r_n(lambda) = -(q_n + W_nt r_t)/W_nn,
///
/// and lambda is the root of f(lambda) = |r_t| - mu r_n. f(0) > 0 because the contact does not
/// stick, and f(inf) = mu q_n/W_nn < 0. A root therefore exists and is always found.
/// @returns false, and leaves r unchanged, if W_nn is not larger than `least`
bool solve_one_contact(const BlockMatrix& w, const Block& q, double mu, double least, Block& r);

}  // namespace statejump::complementarity
