// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "step_forces.hpp"

namespace statejump::truss::detail {

/// Rotates the friction of all balls towards the direction that an iterate of the step predicts.
///
/// Let p be the trial force of a sticking contact times its compliance C. Friction at the end of
/// the step is p min(1/C, μ λ_n/|p|). Along p this is Coulomb's law on a line. Its tangent across p
/// is min(1/C, μ λ_n/|p|), whose inverse becomes the compliance of the transverse contact. Both
/// contacts together form a Newton step for the direction. For a rigid contact, p is the slide of
/// the step if it slides, and the reaction if it sticks.
/// @param rotations iterations so far in this step; 0: there is no iterate yet
/// @param statuses of all contacts; those of the transverse contacts are updated
/// @return whether the step must be solved (again); false if all directions have converged
/// @throws Failure with the joint if the directions do not converge
bool direct_balls(const System& system, const TimeStep& step, int rotations,
                  const StepContacts& local, Contacts& contacts, ContactStatuses& statuses);

}  // namespace statejump::truss::detail
