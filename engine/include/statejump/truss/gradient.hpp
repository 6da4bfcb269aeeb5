// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "statejump/truss/model.hpp"
#include "statejump/truss/path.hpp"

namespace statejump::truss {

namespace detail {
struct PathRecord;
class AdjointPath;
}  // namespace detail

/// A path with all of its equilibria, for derivatives of its states.
struct RecordedPath {
  Path path;
  std::shared_ptr<const detail::PathRecord> record;
};

/// solve(), with a record of the path.
/// @pre Options::locate_events is true: otherwise derivatives lack the terms of events.
RecordedPath solve_recorded(const Model& model, const Options& options);

/// Exact derivative of an output of a path with stick and slip, for all parameters at once.
///
/// **Equations.** Every equilibrium k of the path solves R_k(z_k, h_k; p) = 0 on its statuses. z
/// are the unknowns, p the parameters, and h_k the memory of the joints at the start of the step.
/// The memory is written by the state before: h_{k+1} = c_k(z_k, h_k; p). An output o(z) is a
/// linear function of the displacements at the ends of the cycles. Its derivative is that of the
/// Lagrangian
///
///   L(p) = o − Σ_k w_kᵀ R_k(p) + Σ_k μ_kᵀ c_k(p)
///
/// at fixed states. The multipliers follow from the last state to the first:
///
///   J_kᵀ w_k = ∂o/∂z_k + (∂c_k/∂z)ᵀ μ_k,   μ_{k−1} = (∂c_k/∂h)ᵀ μ_k − (∂R_k/∂h)ᵀ w_k
///
/// A state whose memory is overwritten before it matters needs no solution, and neither does a
/// joint that sticks, as its memory does not change. There are as many solutions as instants at
/// which living memory is written.
///
/// **Events.** A joint that slips until another joint's event stops it writes its memory at the
/// time t of this event, which depends on the parameters through the event's condition g(z, t; p) =
/// 0. With the rates before the event, t' = −(g_z z' + g_p)/ġ. The Lagrangian therefore has the
/// summand −(μᵀ ċ/ġ) g(p), and its derivative by z enters the right-hand side above. A joint that
/// stops because its slip reverses has ċ = 0 and needs no such term; neither does memory written at
/// a corner of the programs, whose time is fixed. Where two joints change at once, the derivative
/// is one-sided; `kinks()` counts such events.
///
/// **Order.** Exact for joints whose memory is a function of the state. Slides of joints that roll
/// are integrals along the path; their derivatives have the second order of the trapezoidal rule in
/// the increments. Partial derivatives of single joints and elements are extrapolated differences
/// (Ridders), to about 1e-12.
///
/// Sources: the adjoint of a multi-step map, e.g. A. Griewank, A. Walther, Evaluating Derivatives,
/// SIAM 2008; derivatives of event times, W. S. Rozenvasser, Autom. Remote Control 28 (1967) 1077.
class OutputDerivative {
 public:
  /// @param recorded a complete path
  /// @param covectors of each end of a cycle, the start first: derivative of the output by the
  /// displacements of all nodes [1/m] and, if nodes rotate, by their rotation vectors [1/rad]
  /// @throws Failure the equations of a state are singular
  OutputDerivative(const RecordedPath& recorded, const std::vector<Eigen::Matrix3Xd>& covectors);

  /// The Lagrangian of a truss with changed parameters, one summand for each item: nodes, elements
  /// type by type, joints. Differences of two of them, over the change, are the derivative of the
  /// output. The summand of an item depends only on its own parameters and the positions of its
  /// nodes. Times are mapped linearly between the corners of the programs.
  /// @pre the truss has the same items, supports, unknowns and numbers of corners
  Eigen::VectorXd summands(const Model& changed) const;

  int solutions() const;  ///< Solved linear systems.
  int events() const;     ///< Events whose time affects the output.
  int kinks() const;      ///< Events at which two joints change their status at once.

 private:
  std::shared_ptr<const detail::AdjointPath> adjoint_;
};

}  // namespace statejump::truss
