// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "energy_account.hpp"
#include "step_contacts.hpp"

namespace statejump::truss::detail {

/// Commits all contacts after a step is solved: stores their forces and adds their work to the
/// energies.
///
/// In the step a contact absorbs the work F h u̅ from the truss, with its mean force F and mean
/// speeds u̅. The dashpot dissipates one part, and the spring stores another. The remainder is
/// heat: along the normal from impact, along the surface from friction. The heat is negative only
/// by the error of the step. Thermal growth of the clearance works against the normal force.
/// @param through mean velocities of the dofs in the step [m/s]
void commit_contacts(const TimeStep& step, const StepContacts& contacts, const VectorXd& through,
                     Contacts& all, EnergyAccount& account);

}  // namespace statejump::truss::detail
