// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "statejump/truss/elements/interface.hpp"

namespace statejump::truss {

/// Soft spring against the component of a node's rotation vector along an axis. It selects one of
/// the positions of a beam that is free to spin about its own axis; the solver adds it, see
/// spin_springs(). Nothing else resists the spin, so its moment is zero in equilibrium.
struct SpinSpring {
  std::string name;
  int node = 0;
  double stiffness = 0.0;  ///< Force by the displacement of the rotation site [N/m], >= 0.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();

  static constexpr const char* kind = "spin spring";
  static constexpr const char* table = "spin_springs";
  static constexpr int dofs_per_node = 6;
  struct Frame {
    std::array<int, 1> nodes;  ///< The site of the rotation.
  };
  static std::span<const Parameter<SpinSpring>> parameters();
  static std::span<const Output> outputs() { return {}; }
  void validate(const Model&, std::span<const TemperatureRange>) const {}
  Frame frame(const Model& model) const;
  /// It does not scale the equations.
  ElementScale scale(const Frame&, const std::vector<Eigen::Vector3d>&) const { return {}; }
  void scale_misfit(const Model&, double) {}
  void evaluate(const Frame& frame, const ElementState& state, ElementWriter& writer) const;
  void thermal_rate(const Frame&, const ElementState&, const std::vector<double>&,
                    ElementWriter&) const {}
  double energy(const Frame& frame, const ElementState& state) const;
  void describe(const Frame&, const ElementState&, double*) const {}
  double thermal_work(const Frame&, const detail::ThermalStep&) const { return 0.0; }
  /// It has no mass.
  void mass(const Frame&, const Inertia&, std::size_t, MatrixWriter&) const {}
  Dashpot dashpot(const Frame&, const Inertia&, std::size_t) const { return {}; }
};

static_assert(Element<SpinSpring>);

}  // namespace statejump::truss
