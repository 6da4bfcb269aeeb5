// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "statejump/truss/motion.hpp"
#include "truss/system.hpp"

namespace statejump::truss::detail {

/// Checks a model and its options for every scheme. Throws std::invalid_argument.
void check_motion(const Model& model, const MotionOptions& options);

/// First state of the quasi-static path; empty if the caller cancelled the search.
std::optional<State> equilibrium(const Model& model, const MotionOptions& options);

/// Displacements of all sites in a state [m], see rotation_site(): of the nodes, then, if the truss
/// has rotations, their rotation vectors times Node::arm.
Eigen::Matrix3Xd sites_of(const Model& model, const State& state);
/// The same for given displacements of the nodes without rotation.
Eigen::Matrix3Xd sites_of(const System& system, const Eigen::Matrix3Xd& of_nodes);

}  // namespace statejump::truss::detail
