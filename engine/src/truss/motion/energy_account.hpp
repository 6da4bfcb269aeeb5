// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace statejump::truss::detail {

/// Energies, summed from the start of a motion, that its state does not contain [J].
struct EnergyAccount {
  double thermal_work = 0.0;
  double damping = 0.0;      ///< Heat of all dashpots.
  double impact = 0.0;       ///< Heat of all contacts along their normals.
  Eigen::VectorXd friction;  ///< Heat of every joint.
  double negative = 0.0;     ///< Sum of the negative heats of contacts in single steps.
  double drives = 0.0;       ///< Work of the drives.
};

}  // namespace statejump::truss::detail
