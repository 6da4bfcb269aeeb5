// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "truss/system.hpp"

namespace statejump::truss {

/// Compares the Jacobian of a truss with central differences of its residual at z, after a step
/// from `before`, for each given status of the joints and with pinned joints. Also compares the
/// time derivative of the residual at fixed unknowns.
/// @param displacement_step, force_step steps of the unknowns [m], [N]; small, so that the residual
///     is nearly linear
/// @param between state after a preceding step; empty if there is none
inline void check_gradients(const Model& model, const Eigen::VectorXd& z,
                            const Eigen::VectorXd& before, const std::vector<JointStatus>& branches,
                            double displacement_step, double force_step,
                            const Eigen::VectorXd& between = {}) {
  const detail::System system(model);
  Assembly at = system.assembly();
  Assembly moved_to = system.assembly();
  for (const JointStatus status : branches) {
    const detail::Statuses statuses(model.joints.size(), status);
    detail::StepStart start = system.begin(before, 0.0, statuses, 1.0);
    if (between.size() > 0) start = system.commit(between, 0.15, statuses, start);
    // Slip error accumulated in earlier steps, and its expected change in this step.
    const auto count = static_cast<Eigen::Index>(model.joints.size());
    start.owed = Eigen::Matrix3Xd::Constant(3, count, 1e-9);
    start.lost = Eigen::Matrix3Xd::Constant(3, count, 2e-9);
    start.last_step = 1.0;
    for (const JointModel joints :
         {JointModel::pins, JointModel::frictionless, JointModel::friction}) {
      const auto residual = [&](const Eigen::VectorXd& where) {
        system.evaluate(where, 0.3, start, statuses, joints, 1.0, moved_to);
        return moved_to.residual;
      };
      system.evaluate(z, 0.3, start, statuses, joints, 1.0, at);
      const Eigen::MatrixXd exact(at.jacobian());
      for (int j = 0; j < system.unknowns(); ++j) {
        const bool moves = j < system.displacements();
        const double step = moves ? displacement_step : force_step;
        Eigen::VectorXd moved = z;
        moved[j] += step;
        const Eigen::VectorXd plus = residual(moved);
        moved[j] -= 2 * step;
        const Eigen::VectorXd difference = (plus - residual(moved)) / (2 * step);
        for (int i = 0; i < system.unknowns(); ++i) {
          // Rounding error over the step: of the stiffest element's force at a displacement of 1e-4
          // m, of lengths of 0.1 m, or of forces of 100 N.
          const RowUnit unit = at.units[static_cast<std::size_t>(i)];
          const double rounded =
              (unit == RowUnit::balance   ? 2e-16 * (system.stiffness_scale() * 1e-4 + 100.0)
               : unit == RowUnit::closure ? 2e-17
                                          : 2e-14) /
              step;
          const double scale = std::max(std::abs(exact(i, j)), std::abs(difference[i]));
          EXPECT_NEAR(exact(i, j), difference[i], 2e-5 * scale + 4 * rounded)
              << to_string(status) << " model " << static_cast<int>(joints) << " row " << i
              << " column " << j;
        }
      }
    }
    std::vector<double> rates;
    for (const auto& program : model.programs) rates.push_back(program.temperature_rate(0.3));
    const Eigen::VectorXd heating = system.heating(z, 0.3, start, statuses, rates);
    const double step = 1e-4;
    const auto residual = [&](double time) {
      system.evaluate(z, time, start, statuses, JointModel::friction, 1.0, moved_to);
      return Eigen::VectorXd(moved_to.residual);
    };
    const Eigen::VectorXd difference = (residual(0.3 + step) - residual(0.3 - step)) / (2 * step);
    for (int i = 0; i < system.unknowns(); ++i) {
      // Truncation: the program's relative error (ω step)²/6. Rounding: that of 100 N, divided by
      // the step.
      const double rounded = i < system.displacements() ? 2e-14 / step : 2e-17 / step;
      EXPECT_NEAR(heating[i], difference[i], 1e-7 * std::abs(heating[i]) + 4 * rounded)
          << to_string(status) << " row " << i;
    }
  }
}

}  // namespace statejump::truss
