// SPDX-License-Identifier: GPL-3.0-or-later
// O.energy as plain numbers, and back.
#pragma once

#include <vector>

#include "statejump/stepper/arrays.hpp"
#include "yade_api.hpp"

namespace statejump::dem {

// Energies that grow, as O.energy has them. The interpreter's lock is held.
stepper::Energies read_energies(const yade::Scene& scene);
void write_energies(const stepper::Energies& energies, const stepper::Energies& before,
                    const yade::Scene& scene);

// Those of the last step. The interpreter's lock is held.
stepper::StoredEnergies read_stored_energies(const yade::Scene& scene);

// All of them, by the names that O.energy has for them, and their values in this order.
std::vector<const char*> energy_names();
void append(const stepper::Energies& energies, const stepper::StoredEnergies& stored,
            std::vector<yade::Real>& row);

}  // namespace statejump::dem
