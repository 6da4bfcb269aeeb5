// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "statejump/complementarity/problem.hpp"

namespace statejump::truss {

/// Frictional contact problem of the joints of a truss in one step of a path, the truss condensed
/// to them: the one that the last Newton step solves.
///
/// A contact's block is its normal component and its friction; `problem` gives the motions of the
/// step u = W r + q [m] (u_n the gap at its end, u_t the slide of the step less what friction
/// bends) of the forces r [N]. With the tangent K of the truss without these forces, the gradients
/// G of their rows and C of their forces on the nodes, and the joints' own compliance D, W = G K⁻¹
/// C + D. It is linear about the state that the path found, which solves it therefore.
struct LocalProblem {
  double time = 0.0;                ///< End of the step [s].
  double temperature_change = 0.0;  ///< Of the first program there [K].
  complementarity::Problem problem;
  Eigen::VectorXd reactions;   ///< Of the path [N].
  Eigen::VectorXd velocities;  ///< Of the path: motions of the step [m].
  std::vector<int> joints;     ///< Of every contact.
  /// Stiffness of every displacement against leaving the found state [N/m], where the truss without
  /// the forces of its contacts is a mechanism or unstable; 0 where it is not. It changes W, and q
  /// so that the path's forces and motions stay a solution.
  double proximal_stiffness = 0.0;
};

}  // namespace statejump::truss
