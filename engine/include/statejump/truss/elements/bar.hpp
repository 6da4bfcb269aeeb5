// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "statejump/truss/elements/interface.hpp"

namespace statejump::truss {

/// Uniform straight bar between two nodes, hinged at both ends, with the axial force N = (E A/l_T)
/// (L − l_T).
struct Bar {
  std::string name;
  int first = 0;                    ///< Node.
  int second = 0;                   ///< Node.
  double axial_stiffness = 0.0;     ///< E A [N], > 0.
  double stress_free_length = 0.0;  ///< l0 at ΔT = 0 [m], > 0.
  double thermal_expansion = 0.0;   ///< α [1/K].
  int program = 0;                  ///< Temperature program.
  double temperature_fraction = 1;  ///< The bar's ΔT over that of its program [-].

  static constexpr const char* kind = "link";
  static constexpr const char* table = "links";
  static constexpr int dofs_per_node = 3;
  struct Frame {
    std::array<int, 2> nodes;
  };
  static std::span<const Parameter<Bar>> parameters();
  static std::span<const Output> outputs();
  void validate(const Model& model, std::span<const TemperatureRange> ranges) const;
  Frame frame(const Model&) const { return {{first, second}}; }
  ElementScale scale(const Frame& frame, const std::vector<Eigen::Vector3d>& drawn) const;
  void scale_misfit(const Model& model, double fraction);
  void evaluate(const Frame& frame, const ElementState& state, ElementWriter& writer) const;
  void thermal_rate(const Frame& frame, const ElementState& state,
                    const std::vector<double>& program_rates, ElementWriter& writer) const;
  double energy(const Frame& frame, const ElementState& state) const;
  void describe(const Frame& frame, const ElementState& state, double* outputs) const;
  double thermal_work(const Frame& frame, const detail::ThermalStep& step) const;
  /// Writes its mass matrix [kg].
  void mass(const Frame& frame, const Inertia& inertia, std::size_t i, MatrixWriter& writer) const;
  Dashpot dashpot(const Frame& frame, const Inertia& inertia, std::size_t i) const;
};

static_assert(Element<Bar>);

}  // namespace statejump::truss
