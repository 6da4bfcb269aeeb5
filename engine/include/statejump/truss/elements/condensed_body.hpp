// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "statejump/truss/elements/interface.hpp"

namespace statejump::truss {

/// A stress-free shape of a condensed body, proportional to the temperature of a program.
struct ThermalPattern {
  int program = 0;             ///< Temperature program.
  double fraction = 1.0;       ///< ΔT of the pattern over that of its program [-].
  Eigen::VectorXd free_shape;  ///< Displacements [m/K] and rotations [rad/K] of the freedoms.
};

/// A linear structure that is condensed to its interface nodes.
///
/// A frame moves with the body. Its origin c is the mean of the positions x_i of the nodes, and its
/// rotation R maximises Σ (x_i − c)·R (X_i − C) + l² Σ tr(Rᵀ R_i), with the rotations R_i of the
/// nodes, their positions X_i and mean C in the reference configuration, and the mean square l² of
/// the distances |X_i − C|. R is thus the polar factor of Σ (x_i − c)(X_i − C)ᵀ + l² Σ R_i. In this
/// frame the deformations are
///
///   q = [Rᵀ (x_i − c) − (X_i − C), log(Rᵀ R_i)],
///
/// and the energy is E = (q − q_th)ᵀ K (q − q_th)/2 with the stress-free shape q_th = Σ p_k T_k of
/// the thermal patterns. Forces and tangent are the exact derivatives of E, with the rotation of
/// the frame as an implicit function of the displacements. Hence forces and moments balance for
/// every displacement, and a rotation of the whole structure has no effect.
///
/// Limit: deformations are small in the frame. Bending by an angle φ within the body neglects the
/// shortening φ²/24 of its length.
struct CondensedBody {
  std::string name;
  std::vector<int> nodes;      ///< The interface nodes, at least two.
  std::vector<bool> rotating;  ///< Of each node: six freedoms, otherwise three.
  /// In the axes of the structure, node by node: ux uy uz and, where it rotates, rx ry rz.
  /// Symmetric; rigid motions cause no force.
  Eigen::MatrixXd stiffness;  ///< [N/m, N/rad, N m/rad]
  Eigen::MatrixXd inertia;    ///< In the same order [kg, kg m, kg m²]; empty: none.
  std::vector<ThermalPattern> patterns;

  static constexpr const char* kind = "body";
  static constexpr const char* table = "bodies";
  static constexpr int dofs_per_node = 6;
  /// Largest rotation of a node against the frame [rad].
  static constexpr double largest_rotation = 1.0;
  struct Frame {
    std::vector<int> nodes;    ///< Sites of all nodes, then of the rotations.
    std::vector<int> rows;     ///< First freedom of each node, and the number of freedoms.
    std::vector<int> turning;  ///< Site of the rotation of each node; −1: it has none.
    std::vector<double> arms;  ///< Node::arm of each node [m].
    std::vector<Eigen::Vector3d> drawn;  ///< X_i − C [m].
    double squared_radius = 1.0;         ///< l² [m²].
  };
  static std::span<const Parameter<CondensedBody>> parameters() { return {}; }
  static std::span<const Output> outputs();
  void validate(const Model& model, std::span<const TemperatureRange> ranges) const;
  Frame frame(const Model& model) const;
  ElementScale scale(const Frame& frame, const std::vector<Eigen::Vector3d>& drawn) const;
  void scale_misfit(const Model&, double) {}
  void evaluate(const Frame& frame, const ElementState& state, ElementWriter& writer) const;
  void thermal_rate(const Frame& frame, const ElementState& state,
                    const std::vector<double>& program_rates, ElementWriter& writer) const;
  double energy(const Frame& frame, const ElementState& state) const;
  void describe(const Frame& frame, const ElementState& state, double* outputs) const;
  double thermal_work(const Frame& frame, const detail::ThermalStep& step) const;
  /// The matrix is that of the reference configuration.
  void mass(const Frame& frame, const Inertia& inertia, std::size_t i, MatrixWriter& writer) const;
  Dashpot dashpot(const Frame&, const Inertia&, std::size_t) const { return {}; }
  /// Rejects a state in which a node has rotated by more than 1 rad against the frame.
  void check_state(const Frame& frame, const ElementState& state) const;
};

static_assert(Element<CondensedBody>);

}  // namespace statejump::truss
