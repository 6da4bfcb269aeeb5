// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "statejump/complementarity/problem.hpp"

namespace statejump::truss {

/// Frictional contact problem of the joints of a truss in one step of a path, with the truss
/// condensed to the joints. The last Newton step of the path step solves this problem.
///
/// Each contact has a block of two components, normal and friction. `problem` gives the motions u =
/// W r + q [m] of the step for the forces r [N]: u_n is the gap at the end of the step, u_t the
/// slide of the step minus the elastic deflection. With the tangent K of the truss without contact
/// forces, the gradients G of the rows, the gradients C of the contact forces on the nodes, and the
/// compliance D of the joints, W = G K⁻¹ C + D. The problem is linearised about the state of the
/// path, which is therefore a solution.
struct LocalProblem {
  double time = 0.0;                ///< End of the step [s].
  double temperature_change = 0.0;  ///< ΔT of the first program at this time [K].
  complementarity::Problem problem;
  Eigen::VectorXd reactions;   ///< Contact forces of the path [N].
  Eigen::VectorXd velocities;  ///< Motions of the step of the path [m].
  std::vector<int> joints;     ///< Joint of every contact.
  /// Stiffness of springs that hold all displacements at the state of the path [N/m]. It is 0
  /// unless the truss without contact forces is a mechanism or unstable. The springs change W and
  /// also q, so that forces and motions of the path remain a solution.
  double proximal_stiffness = 0.0;
};

}  // namespace statejump::truss
