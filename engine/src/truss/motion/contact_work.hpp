// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "energy_account.hpp"
#include "step_contacts.hpp"

namespace statejump::truss::detail {

/// Commits the contacts of a solved step: stores their forces and adds their work to the energies.
///
/// Over the step a contact takes the work F h u̅ from the truss, with its mean force F and the
/// speeds u̅ by which impulses work. The dashpot takes one part, the spring stores another. The
/// remainder is heat: of impact across the surface, and of friction along it. It is not negative
/// except for the error of the step. Thermal growth of the clearance works against the normal
/// force. @param through velocities by which impulses work [m/s]
void commit_contacts(const TimeStep& step, const StepContacts& contacts, const VectorXd& through,
                     Contacts& all, EnergyAccount& account);

}  // namespace statejump::truss::detail
