// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "statejump/truss/parameter.hpp"

namespace statejump::truss {

struct Model;
struct Inertia;
class ElementWriter;
class MatrixWriter;
namespace detail {
struct ThermalStep;
}

/// Smallest and largest ΔT of a temperature program [K].
struct TemperatureRange {
  double lowest = 0.0;
  double highest = 0.0;
};

/// Displacements and temperatures at which elements are evaluated. The arguments of the constructor
/// must outlive this object.
class ElementState {
 public:
  /// @param drawn positions of the nodes [m] in the reference configuration at ΔT = 0
  /// @param moved displacements of the nodes and, if nodes rotate, of their rotations [m]
  /// @param changes ΔT of the temperature programs [K]
  ElementState(const std::vector<Eigen::Vector3d>& drawn, const Eigen::Matrix3Xd& moved,
               const std::vector<double>& changes)
      : drawn_(&drawn), moved_(&moved), changes_(&changes) {}

  /// Vector from one node to another in the reference configuration [m].
  Eigen::Vector3d drawn_between(int from, int to) const {
    return (*drawn_)[static_cast<std::size_t>(to)] - (*drawn_)[static_cast<std::size_t>(from)];
  }
  /// Displacement of a node or, for its site rotation_site(), rotation vector times Node::arm [m].
  Eigen::Vector3d moved(int site) const { return moved_->col(site); }
  /// Displacement of a node relative to another one [m].
  Eigen::Vector3d moved_between(int from, int to) const {
    return moved_->col(to) - moved_->col(from);
  }
  /// Temperature change of a program [K].
  double temperature_change(int program) const {
    return (*changes_)[static_cast<std::size_t>(program)];
  }

 private:
  const std::vector<Eigen::Vector3d>* drawn_;
  const Eigen::Matrix3Xd* moved_;
  const std::vector<double>* changes_;
};

/// What an element contributes to the scales of the equations.
struct ElementScale {
  double stiffness = 0.0;          ///< [N/m]
  double force = 0.0;              ///< Of its misfit in the reference configuration [N].
  double strain_per_kelvin = 0.0;  ///< Free thermal strain [1/K], absolute.
  int program = -1;                ///< Its temperature program; −1: none.
  double by_rotation = 0.0;        ///< Force by the rotation of a node by 1 rad [N].
};

/// Dashpot between two nodes of an element in motion.
struct Dashpot {
  int first = 0;           ///< Node.
  int second = 0;          ///< Node.
  double axial = 0.0;      ///< c of c (L' − l_T') [N s/m].
  double turning = 0.0;    ///< c_p of the moment −c_p θ' [N m s/rad].
  double expansion = 0.0;  ///< dl_T/dT over that of its program [m/K].
  int program = -1;        ///< −1: none.
};

/// A type of element is a struct of parameters with a name. It defines a conservative law between
/// its nodes.
///
/// | member | meaning |
/// |---|---|
/// | `kind` | name in messages |
/// | `table` | name of its table in the case |
/// | `dofs_per_node` | 3: translations; 6: translations and rotations, see rotation_site() |
/// | `parameters()` | key, unit, range and source of each parameter |
///  `outputs()`, `describe()` | numbers that are output at every state |
/// | `Frame`, `frame()` | its nodes (−1: ground) with sites of rotations, and fixed directions |
/// | `validate()` | rules beyond the ranges of single parameters |
/// | `scale()` | see ElementScale |
/// | `scale_misfit()` | multiplies its stress in the reference configuration by a fraction |
/// | `evaluate()` | forces on its nodes [N] and derivatives; the same entries at every state |
/// | `thermal_rate()` | rates of these forces where nothing moves [N/s] |
/// | `energy()` | elastic energy [J]; its gradient is the force |
/// | `thermal_work()` | work of the temperature in a step [J] |
/// | `mass()` | writes its mass matrix [kg], constant in space |
/// | `dashpot()` | its dashpot in motion; coefficients of 0: none |
///
/// Optional: `beyond_edges()` returns how far the element is beyond the edge at which its stiffness
/// jumps [m]; `has_edge()` returns whether there is one. `check_state()` rejects a state beyond the
/// range of the theory.
///
/// @pre of all but validate(): the element is valid. Only scale_misfit() modifies the element. The
/// index of mass() and dashpot() is that of the element among those of its type.
template <class Type>
concept Element = requires(const Type& one, Type& other, const Model& model,
                           const typename Type::Frame& frame, const ElementState& state,
                           const std::vector<Eigen::Vector3d>& drawn,
                           const std::vector<double>& program_rates, ElementWriter& writer,
                           double* outputs, const detail::ThermalStep& step, const Inertia& inertia,
                           MatrixWriter& matrix, std::span<const TemperatureRange> ranges) {
  { Type::kind } -> std::convertible_to<const char*>;
  { Type::table } -> std::convertible_to<const char*>;
  requires Type::dofs_per_node == 3 || Type::dofs_per_node == 6;
  { Type::parameters() } -> std::same_as<std::span<const Parameter<Type>>>;
  { Type::outputs() } -> std::same_as<std::span<const Output>>;
  { one.name } -> std::convertible_to<std::string>;
  { one.frame(model) } -> std::same_as<typename Type::Frame>;
  { *frame.nodes.begin() } -> std::convertible_to<int>;
  { one.validate(model, ranges) } -> std::same_as<void>;
  { one.scale(frame, drawn) } -> std::same_as<ElementScale>;
  { other.scale_misfit(model, 0.5) } -> std::same_as<void>;
  { one.evaluate(frame, state, writer) } -> std::same_as<void>;
  { one.thermal_rate(frame, state, program_rates, writer) } -> std::same_as<void>;
  { one.energy(frame, state) } -> std::same_as<double>;
  { one.describe(frame, state, outputs) } -> std::same_as<void>;
  { one.thermal_work(frame, step) } -> std::same_as<double>;
  { one.mass(frame, inertia, std::size_t(), matrix) } -> std::same_as<void>;
  { one.dashpot(frame, inertia, std::size_t()) } -> std::same_as<Dashpot>;
};

}  // namespace statejump::truss
