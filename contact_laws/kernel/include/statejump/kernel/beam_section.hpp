// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <utility>

#include "statejump/kernel/beam.hpp"

namespace statejump::kernel {

/// Stiffnesses and releases of a beam in the axes of its section: x along the beam, y and z across.
struct BeamSection {
  double axial = 0.0;                                        ///< E A [N]
  double torsional = 0.0;                                    ///< G J [N m²]
  double bending_y = 0.0;                                    ///< E I about y [N m²]
  double bending_z = 0.0;                                    ///< E I about z [N m²]
  double shear_y = std::numeric_limits<double>::infinity();  ///< k G A for forces along y [N]
  double shear_z = std::numeric_limits<double>::infinity();
  /// Releases of the first and of the second end: axial force, moments about x, y and z.
  std::array<std::array<bool, 4>, 2> released{};
};

/// A beam with its triad in the reference configuration.
struct PlacedBeam {
  Beam beam;
  /// Whether `beam` has axis z of the section as axis 2, and −y as axis 3.
  bool swapped = false;
};

namespace detail {

/// How the rotations of the ends determine the roll of the beam.
struct Roll {
  std::array<double, 2> weights;
  bool by_axis_z;  ///< By axis z of the section, not by axis y.
};

/// Chooses as many ends as possible, and an axis that their released rotations do not tilt:
/// released moments about z tilt axis y. An end that releases the torsion is the last choice.
inline Roll roll_of(const std::array<std::array<bool, 3>, 2>& released) {
  for (const bool with_torsion : {false, true}) {
    Roll best{{{0.0, 0.0}}, false};
    double most = 0.0;
    for (const std::size_t tilting : {std::size_t(2), std::size_t(1)}) {
      std::array<double, 2> usable{};
      for (std::size_t end = 0; end < 2; ++end) {
        usable[end] = !released[end][tilting] && (with_torsion || !released[end][0]) ? 1.0 : 0.0;
      }
      const double sum = usable[0] + usable[1];
      if (sum <= most) continue;
      most = sum;
      best = {{{usable[0] / sum, usable[1] / sum}}, tilting == 1};
    }
    if (most > 0.0) return best;
  }
  return {{{0.5, 0.5}}, false};
}

}  // namespace detail

/// @param along unit vector from the first end to the second in the reference configuration
/// @param axis_y of the section, across it
inline PlacedBeam placed(const BeamSection& section, const Vector3& along, const Vector3& axis_y) {
  PlacedBeam made;
  Beam& beam = made.beam;
  const bool has_tension = !section.released[0][0] && !section.released[1][0];
  beam.axial = has_tension ? section.axial : 0.0;
  beam.torsional = section.torsional;
  beam.bending = {{section.bending_y, section.bending_z}};
  // Bending about y shears along z.
  beam.shear = {{section.shear_z, section.shear_y}};
  for (std::size_t end = 0; end < 2; ++end) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      beam.released[end][axis] = section.released[end][1 + axis];
    }
  }
  const Vector3 axis_z = along.cross(axis_y).normalized();
  beam.triad << along, axis_z.cross(along), axis_z;
  const detail::Roll roll = detail::roll_of(beam.released);
  beam.roll = roll.weights;
  made.swapped = roll.by_axis_z;
  if (!made.swapped) return made;
  std::swap(beam.bending[0], beam.bending[1]);
  std::swap(beam.shear[0], beam.shear[1]);
  for (auto& end : beam.released) std::swap(end[1], end[2]);
  beam.triad << along, axis_z, -axis_z.cross(along);
  return made;
}

/// Numbers about axes 2 and 3 of the frame, for those about axes y and z of the section.
/// @param swapped see PlacedBeam
inline std::array<double, 2> about_frame(bool swapped, double about_y, double about_z) {
  if (swapped) return {{about_z, -about_y}};
  return {{about_y, about_z}};
}

/// Section forces and moments of the first end, then of the second, in the axes of the section:
/// forces and moments that each end exerts on the beam, at the first end with the opposite sign.
/// @param swapped see PlacedBeam
/// @param in_frame the same in the axes of the frame, without the change of sign
inline BeamStep::Vector12 section_forces(bool swapped, BeamStep::Vector12 in_frame) {
  in_frame.head<6>() *= -1.0;
  if (!swapped) return in_frame;
  for (Eigen::Index block = 0; block < 4; ++block) {
    const double along_y = -in_frame[3 * block + 2];
    in_frame[3 * block + 2] = in_frame[3 * block + 1];
    in_frame[3 * block + 1] = along_y;
  }
  return in_frame;
}

}  // namespace statejump::kernel
