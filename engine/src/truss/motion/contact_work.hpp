// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "energy_account.hpp"
#include "step_contacts.hpp"

namespace statejump::truss::detail {

/// Commits the contacts of a solved step: stores their forces and adds their work to the energies.
///
/// Over the step a contact absorbs the work F h u̅ of the truss, with its mean force F and mean
/// speeds u̅. The dashpot dissipates one part, the spring stores another. The remainder is heat: of
/// impact along the normal, and of friction along the surface. It is negative only by the error of
/// the step. Thermal growth of the clearance works against the normal force.
/// @param through mean velocities of the step [m/s]
void commit_contacts(const TimeStep& step, const StepContacts& contacts, const VectorXd& through,
                     Contacts& all, EnergyAccount& account);

}  // namespace statejump::truss::detail
