// SPDX-License-Identifier: GPL-3.0-or-later
// Transfers O.energy to plain numbers, and back.
#pragma once

#include <vector>

#include "statejump/stepper/arrays.hpp"
#include "yade_api.hpp"

namespace statejump::dem {

// Cumulative energies of O.energy. The caller must hold the GIL.
stepper::Energies read_energies(const yade::Scene& scene);
void write_energies(const stepper::Energies& energies, const stepper::Energies& before,
                    const yade::Scene& scene);

// Stored energies of the last step. The caller must hold the GIL.
stepper::StoredEnergies read_stored_energies(const yade::Scene& scene);

// Names of all energies in O.energy, in the order of the values that append() writes.
std::vector<const char*> energy_names();
void append(const stepper::Energies& energies, const stepper::StoredEnergies& stored,
            std::vector<yade::Real>& row);

}  // namespace statejump::dem
