// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "statejump/truss/elements/interface.hpp"

namespace statejump::truss {

/// Torsion spring with the moment K (α − α0). α is the angle from a first bar to a second one about
/// a fixed axis, measured from the reference configuration. Without a second bar, α is measured
/// from the ground.
struct TorsionSpring {
  std::string name;
  int first_link = 0;
  int second_link = -1;     ///< −1: ground; the angle is then that of the first bar.
  double stiffness = 0.0;   ///< K [N m/rad], >= 0.
  double free_angle = 0.0;  ///< α0 [rad] from the reference configuration.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();

  static constexpr const char* kind = "torsion spring";
  static constexpr const char* table = "torsion_springs";
  static constexpr int dofs_per_node = 3;
  struct Frame {
    std::array<int, 4> nodes;  ///< Ends of the first bar, then of the second.
    /// Two directions across the axis.
    Eigen::Matrix<double, 3, 2> plane;
  };
  static std::span<const Parameter<TorsionSpring>> parameters();
  static std::span<const Output> outputs() { return {}; }
  void validate(const Model& model, std::span<const TemperatureRange> ranges) const;
  Frame frame(const Model& model) const;
  ElementScale scale(const Frame& frame, const std::vector<Eigen::Vector3d>& drawn) const;
  void scale_misfit(const Model&, double fraction) { free_angle *= fraction; }
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

static_assert(Element<TorsionSpring>);

}  // namespace statejump::truss
