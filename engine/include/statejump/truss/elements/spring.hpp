// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "statejump/truss/elements/interface.hpp"

namespace statejump::truss {

/// Spring between two nodes with tension k (L − free_length). A spring marked as cable carries
/// tension only.
struct Spring {
  std::string name;
  int first = 0;             ///< Node.
  int second = 0;            ///< Node.
  double stiffness = 0.0;    ///< k [N/m], >= 0.
  double free_length = 0.0;  ///< [m]; negative: in tension at every length.
  bool cable = false;

  static constexpr const char* kind = "spring";
  static constexpr const char* table = "springs";
  static constexpr int dofs_per_node = 3;
  struct Frame {
    std::array<int, 2> nodes;
  };
  static std::span<const Parameter<Spring>> parameters();
  static std::span<const Output> outputs();
  void validate(const Model& model, std::span<const TemperatureRange> ranges) const;
  Frame frame(const Model&) const { return {{first, second}}; }
  ElementScale scale(const Frame& frame, const std::vector<Eigen::Vector3d>& drawn) const;
  void scale_misfit(const Model& model, double fraction);
  void evaluate(const Frame& frame, const ElementState& state, ElementWriter& writer) const;
  void thermal_rate(const Frame&, const ElementState&, const std::vector<double>&,
                    ElementWriter&) const {}
  double energy(const Frame& frame, const ElementState& state) const;
  void describe(const Frame& frame, const ElementState& state, double* outputs) const;
  double thermal_work(const Frame&, const detail::ThermalStep&) const { return 0.0; }
  /// It has no mass.
  void mass(const Frame&, const Inertia&, std::size_t, MatrixWriter&) const {}
  Dashpot dashpot(const Frame& frame, const Inertia& inertia, std::size_t i) const;
  /// Whether it is a cable, which becomes slack.
  bool has_edge() const { return cable; }
  double beyond_edges(const Frame& frame, const ElementState& state) const;
};

static_assert(Element<Spring>);

}  // namespace statejump::truss
