// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "statejump/spring_slider/path.hpp"

namespace statejump::spring_slider {

/// A path at given times, with one array entry per time. All forces are those on the block,
/// positive towards +x. They satisfy F − P − k_p x + friction_force + stop_force = 0.
struct History {
  Eigen::VectorXd time;                ///< [s]
  Eigen::VectorXd temperature_change;  ///< ΔT [K]
  Eigen::VectorXd displacement;        ///< x [m]
  Eigen::VectorXd axial_force;         ///< F = k_T (x_T − x) [N], positive in compression
  Eigen::VectorXd friction_force;      ///< Force of the ground on the block [N]
  Eigen::VectorXd stop_force;          ///< Force of a stop on the block [N]; see SpringSlider
  Eigen::VectorXd elastic_energy;      ///< Energy F²/(2 k_T) in the link [J]
  /// Energy k_p x²/2 + P x of the preload spring [J], plus a constant: the total energy starts at
  /// 0.
  Eigen::VectorXd preload_energy;
  Eigen::VectorXd friction_dissipation;  ///< Heat of friction since the start, ∫ f |dx| [J]
  Eigen::VectorXd thermal_work;          ///< Work of the temperature since the start [J]
  std::vector<Stage> stage;
};

/// Returns the path at `times` [s], in any order; after its end the last state holds. Every entry
/// is evaluated from closed forms, so it does not depend on the other times. At an event the stage
/// after it is returned; at the end of the program, the last stage. The energies satisfy
/// thermal_work = elastic_energy + preload_energy + friction_dissipation to rounding; see
/// thermal_work(). Throws std::invalid_argument for a time that is negative, not finite or in an
/// omitted cycle.
History sample(const Path& path, const Eigen::Ref<const Eigen::VectorXd>& times);

}  // namespace statejump::spring_slider
