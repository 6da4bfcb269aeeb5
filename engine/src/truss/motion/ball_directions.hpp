// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "step_forces.hpp"

namespace statejump::truss::detail {

/// Rotates the friction of all ball joints towards the direction that an iterate of the step
/// predicts.
///
/// Let p be the trial force of a sticking contact times its compliance C. Friction at the end of
/// the step is p min(1/C, μ λ_n/|p|). Along p this is Coulomb's law in one dimension. Perpendicular
/// to p its tangent stiffness is min(1/C, μ λ_n/|p|); the inverse becomes the compliance of the
/// ball's second, transverse contact. Both contacts together form a Newton step for the direction.
/// If the contact is rigid, p is the slide of the step in slip, and the reaction in stick.
/// @param rotations number of iterations so far in this step; 0: there is no iterate yet
/// @param statuses statuses of all contacts; the function updates those of the transverse contacts
/// @return true if the step must be solved (again), false if all directions have converged
/// @throws Failure with the joint if the directions do not converge
bool direct_balls(const System& system, const TimeStep& step, int rotations,
                  const StepContacts& local, Contacts& contacts, ContactStatuses& statuses);

}  // namespace statejump::truss::detail
