// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "statejump/start_friction.hpp"
#include "statejump/truss/model.hpp"

namespace statejump::truss {

/// A truss about its equilibrium without friction at ΔT = 0, with all friction joints free to
/// slide:
///
///   K q + Hᵀ μ = r + G T − Bᵀ λ,   H q = 0,   s = s0 + B q,   |λ| <= f
///
/// q: change of the dofs; T: ΔT of the elements; λ: friction against the slides s. K contains the
/// stiffness of the elements under their forces, and that of hinges. r: loads that joints carry,
/// which are friction at the start of a path, forces of stops, and forces of guides.
struct FrictionFree {
  Eigen::SparseMatrix<double> stiffness;  ///< K, symmetric [N/m].
  Eigen::SparseMatrix<double> guides;     ///< H; rows may depend on others.
  Eigen::VectorXi guide_joint;            ///< Joint of each row of H; −1: none.
  Eigen::VectorXd load;                   ///< r [N].
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
/// @param from frictionless: about the equilibrium without friction; otherwise about the start of a
///   path
/// @throws Failure if the truss has no such equilibrium
FrictionFree friction_free(const Model& model, StartFriction from = StartFriction::frictionless);

}  // namespace statejump::truss
