// SPDX-License-Identifier: GPL-3.0-or-later
// Functions of straight elements between two nodes.
#pragma once

#include <array>
#include <string>

#include "statejump/truss/elements/bar.hpp"
#include "truss/elements/writer.hpp"
#include "truss/parts.hpp"

namespace statejump::truss::detail {

/// Tension [N] and axial stiffness [N/m] at one length.
struct Axial {
  double tension;
  double stiffness;

  double energy() const { return stiffness > 0.0 ? 0.5 * tension * tension / stiffness : 0.0; }
};

/// Length minus stress-free length [m]. Differences of lengths avoid the force error 1e-16 E A that
/// the rounding of a length would cause.
/// @param growth from the reference configuration [m]
/// @param drawn length in the reference configuration [m]
/// @param free stress-free length at ΔT = 0 [m]; @param expansion α [1/K]; @param change ΔT [K]
inline double stretch(double growth, double drawn, double free, double expansion = 0.0,
                      double change = 0.0) {
  return growth + (drawn - free) - free * expansion * change;
}

/// Tension and stiffness of a bar.
/// @param change ΔT of the bar [K]
inline Axial axial(const Bar& bar, double elongation_from_drawn, double drawn_length,
                   double change) {
  const double l0 = bar.stress_free_length;
  const double stiffness = bar.axial_stiffness / thermal::length(l0, bar.thermal_expansion, change);
  return {
      stiffness * stretch(elongation_from_drawn, drawn_length, l0, bar.thermal_expansion, change),
      stiffness};
}

inline Lengths lengths(const std::array<int, 2>& nodes, const ElementState& state) {
  return lengths(state.drawn_between(nodes[0], nodes[1]), state.moved_between(nodes[0], nodes[1]));
}

/// Adds the forces and derivatives of an element whose only force is a tension along its direction.
inline void write_axial(const std::array<int, 2>& nodes, const Lengths& length, const Axial& axial,
                        ElementWriter& writer) {
  const int first = nodes[0];
  const int second = nodes[1];
  const Vector3d direction = length.along / length.now;
  writer.force(first, -axial.tension * direction);
  writer.force(second, axial.tension * direction);
  writer.carries(axial.tension);
  if (writer.residual_only()) return;
  // Stiffness along the element, plus the geometric stiffness across it due to its tension.
  const double across = axial.tension / length.now;
  const double more = axial.stiffness - across;
  const auto own = [&](int node, const Vector3d& along) {
    writer.block(node, node, [&](int i, int j) {
      return more * along[i] * along[j] + (i == j ? across : 0.0);
    });
  };
  const NodeDofs& one = writer.at(first);
  const NodeDofs& other = writer.at(second);
  // A fixed node has no dofs.
  if (one.freedoms == 0 || other.freedoms == 0) {
    if (one.freedoms > 0) own(first, writer.seen(first, direction));
    if (other.freedoms > 0) own(second, writer.seen(second, direction));
    return;
  }
  const Vector3d at_first = writer.seen(first, direction);
  const Vector3d at_second =
      one.directions == other.directions ? at_first : writer.seen(second, direction);
  const Matrix3d both = one.directions->transpose() * *other.directions;
  own(first, at_first);
  writer.block(first, second, [&](int i, int j) {
    return -(more * at_first[i] * at_second[j] + across * both(i, j));
  });
  writer.block(second, first, [&](int i, int j) {
    return -(more * at_second[i] * at_first[j] + across * both(j, i));
  });
  own(second, at_second);
}

/// Distance of two nodes in the reference configuration [m].
inline double drawn_length(const Model& model, int first, int second) {
  return (model.nodes[index(second)].position - model.nodes[index(first)].position).norm();
}

/// @throws kernel::OutOfRange if the two nodes of an element coincide
void check_length(const char* kind, const std::string& name, const Model& model, int first,
                  int second);

/// @param fraction ΔT of the element over that of its program
/// @throws kernel::OutOfRange if an element has no length at a temperature of its program
void check_expansion(const char* kind, const std::string& name, double thermal_expansion,
                     double fraction, const TemperatureRange& range);

}  // namespace statejump::truss::detail
