// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "step_forces.hpp"

namespace statejump::truss::detail {

/// Rotates the friction of all balls to where an iterate of the step drives them.
///
/// With the pull p that friction would have if it stuck, times the compliance C, friction at the
/// end of the step is p min(1/C, μ λ_n/|p|). Along p that is Coulomb's law on a line, and its
/// tangent across p is min(1/C, μ λ_n/|p|) itself: so the contact beside gets the inverse as
/// compliance, and both together make a step of Newton's method for the direction. A rigid contact
/// that slides has the path of the step as p, one that sticks its reaction.
/// @param rotations how often that has been done in this step; 0: there is no iterate yet
/// @param statuses of all contacts, changed with the contacts beside
/// @return whether the step is to be solved (again); false once their friction is where it points
/// @throws Failure with the joint if directions are not found
bool direct_balls(const System& system, const TimeStep& step, int rotations,
                  const StepContacts& local, Contacts& contacts, ContactStatuses& statuses);

}  // namespace statejump::truss::detail
