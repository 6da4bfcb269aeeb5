// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "statejump/kernel/beam_state.hpp"
#include "statejump/truss/elements/interface.hpp"

namespace statejump::truss {

/// Straight beam between two nodes that it bends and rotates, see kernel::BeamStep. Its temperature
/// has a mean over the section and a gradient along each axis of the section.
struct Beam {
  std::string name;
  int first = 0;                     ///< Node.
  int second = 0;                    ///< Node.
  double axial_stiffness = 0.0;      ///< E A [N], > 0.
  double torsional_stiffness = 0.0;  ///< G J [N m²], > 0.
  double bending_stiffness_y = 0.0;  ///< E I about axis y of the section [N m²], > 0.
  double bending_stiffness_z = 0.0;  ///< E I about axis z of the section [N m²], > 0.
  /// k G A for shear forces along y and z [N]; infinity: no shear deformation.
  double shear_stiffness_y = std::numeric_limits<double>::infinity();
  double shear_stiffness_z = std::numeric_limits<double>::infinity();
  double stress_free_length = 0.0;  ///< l0 at ΔT = 0 [m], > 0.
  double thermal_expansion = 0.0;   ///< α [1/K].
  int program = 0;                  ///< Temperature program of the mean.
  double temperature_fraction = 1;  ///< Mean ΔT over that of its program [-].
  int gradient_program = 0;         ///< Temperature program of the gradients.
  /// Gradients along the axes of the section over the ΔT of their program [1/m].
  double gradient_y = 0.0;
  double gradient_z = 0.0;
  Eigen::Vector3d axis_y = Eigen::Vector3d::UnitY();  ///< Of the section, across the beam.
  /// From each node to its end of the beam in the reference configuration [m]: a rigid arm that
  /// rotates with the node.
  Eigen::Vector3d offset_first = Eigen::Vector3d::Zero();
  Eigen::Vector3d offset_second = Eigen::Vector3d::Zero();
  // Forces and moments that an end does not transmit to its node, in the axes of the section.
  bool released_first_axial = false;
  bool released_first_x = false;  ///< Moment about x, the torsion.
  bool released_first_y = false;
  bool released_first_z = false;
  bool released_second_axial = false;
  bool released_second_x = false;
  bool released_second_y = false;
  bool released_second_z = false;

  static constexpr const char* kind = "beam";
  static constexpr const char* table = "beams";
  static constexpr int dofs_per_node = 6;
  struct Frame {
    /// Both nodes, then their rotations, see rotation_site(); −1: the rotation of the node has no
    /// effect, because the end is released.
    std::array<int, 4> nodes;
    std::array<double, 2> arms;              ///< Node::arm of both nodes [m].
    std::array<Eigen::Vector3d, 2> offsets;  ///< From the nodes to the ends of the beam [m].
    kernel::Beam beam;
    /// Whether `beam` has axis z of the section as axis 2, and −y as axis 3.
    bool swapped = false;
  };
  static std::span<const Parameter<Beam>> parameters();
  static std::span<const Output> outputs();
  void validate(const Model& model, std::span<const TemperatureRange> ranges) const;
  Frame frame(const Model& model) const;
  ElementScale scale(const Frame& frame, const std::vector<Eigen::Vector3d>& drawn) const;
  void scale_misfit(const Model& model, double fraction);
  void evaluate(const Frame& frame, const ElementState& state, ElementWriter& writer) const;
  void thermal_rate(const Frame& frame, const ElementState& state,
                    const std::vector<double>& program_rates, ElementWriter& writer) const;
  double energy(const Frame& frame, const ElementState& state) const;
  void describe(const Frame& frame, const ElementState& state, double* outputs) const;
  double thermal_work(const Frame& frame, const detail::ThermalStep& step) const;
  /// See beam_mass.cpp.
  void mass(const Frame& frame, const Inertia& inertia, std::size_t i, MatrixWriter& writer) const;
  Dashpot dashpot(const Frame&, const Inertia&, std::size_t) const { return {}; }
  /// Released moments about x, y and z of the ends.
  std::array<std::array<bool, 3>, 2> released_moments() const {
    return {{{released_first_x, released_first_y, released_first_z},
             {released_second_x, released_second_y, released_second_z}}};
  }
  /// Rejects a state in which an end has rotated by more than 1 rad relative to the beam, or in
  /// which a beam with released ends buckles between them.
  void check_state(const Frame& frame, const ElementState& state) const;
};

static_assert(Element<Beam>);

}  // namespace statejump::truss
