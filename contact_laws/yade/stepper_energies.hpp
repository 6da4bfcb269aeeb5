// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion of O.energy to plain numbers, and back.
#pragma once

#include <vector>

#include "statejump/stepper/arrays.hpp"
#include "yade_api.hpp"

namespace statejump::dem {

// Cumulative energies of O.energy. The interpreter's lock is held.
stepper::Energies read_energies(const yade::Scene& scene);
void write_energies(const stepper::Energies& energies, const stepper::Energies& before,
                    const yade::Scene& scene);

// Stored energies of the last step. The interpreter's lock is held.
stepper::StoredEnergies read_stored_energies(const yade::Scene& scene);

// All energies by their names in O.energy; their values have the same order.
std::vector<const char*> energy_names();
void append(const stepper::Energies& energies, const stepper::StoredEnergies& stored,
            std::vector<yade::Real>& row);

}  // namespace statejump::dem
