// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "statejump/truss/model.hpp"

namespace statejump::truss {

/// A truss about its equilibrium without friction at ΔT = 0, with all friction joints free to
/// slide:
///
///   K q + Hᵀ μ = G T − Bᵀ λ,   H q = 0,   s = s0 + B q,   |λ| <= f
///
/// q: change of the dofs; T: ΔT of the elements; λ: friction against the slides s. K contains the
/// stiffness of the elements under their forces, and that of hinges.
struct FrictionFree {
  Eigen::SparseMatrix<double> stiffness;  ///< K, symmetric [N/m].
  Eigen::SparseMatrix<double> guides;     ///< H; rows may depend on others.
  Eigen::SparseMatrix<double> slides;     ///< B [-], a row for every joint.
  Eigen::SparseMatrix<double> heating;    ///< G [N/K], a column for every element.
  Eigen::SparseMatrix<double> of_nodes;   ///< Displacements of nodes, see Linearised::of_nodes.
  Eigen::VectorXd friction_limit;         ///< f [N]; NaN: the normal force is not given.
  Eigen::VectorXd slide;                  ///< s0 from the reference configuration [m].
  Eigen::VectorXd sticking_stiffness;     ///< dλ/ds of a joint that begins to stick [N/m].
  Eigen::VectorXd full_slip;              ///< Slide from λ = 0 to λ = f without earlier slip [m].
  Eigen::VectorXd radius;                 ///< Slide of a rotation by 1 rad [m]; 1 for sliders.
  Eigen::Matrix3Xd displacement;          ///< Of the nodes from the reference configuration [m].
};

/// Joints appear in the order of the model, elements type by type.
/// @throws Failure if the truss has no equilibrium without friction
FrictionFree friction_free(const Model& model);

}  // namespace statejump::truss
