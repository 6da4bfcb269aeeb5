// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>

#include "statejump/kernel/rotation.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::kernel {

/// Straight prismatic beam: stiffnesses, and its triad in the reference configuration. Axis 1 runs
/// along the beam, axes 2 and 3 are the principal axes of the section. The shear centre is the
/// centroid, and there is no warping.
struct Beam {
  double axial = 0.0;                     ///< E A [N], > 0; 0: axial force released.
  double torsional = 0.0;                 ///< G J [N m²], > 0.
  std::array<double, 2> bending{{0, 0}};  ///< E I about axes 2 and 3 [N m²], > 0.
  /// k G A for the shear force that bends about axes 2 and 3, thus along axes 3 and 2 [N], > 0.
  /// Infinity: no shear deformation.
  std::array<double, 2> shear{
      {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()}};
  Matrix3 triad = Matrix3::Identity();  ///< Columns: axes 1, 2, 3.
  /// Released rotations of the first and of the second end about axes 1, 2 and 3. A released
  /// rotation transmits no moment.
  std::array<std::array<bool, 3>, 2> released{};
  /// Weights of axis 2 of the first and of the second end in the mean that determines how the frame
  /// rolls about the chord. Their sum is 1. An end whose released rotations tilt its axis 2 has 0.
  std::array<double, 2> roll{{0.5, 0.5}};
};

/// Configuration and stress-free shape of a beam.
struct BeamState {
  Vector3 along = Vector3::Zero();  ///< From the first end to the second [m].
  /// Length minus stress-free length [m]. It is separate, because the difference of two lengths
  /// would lose digits.
  double stretch = 0.0;
  Quaternion first = Quaternion::Identity();  ///< Rotation of the first end since the reference.
  Quaternion second = Quaternion::Identity();
  double free_length = 0.0;                     ///< Stress-free length l_T [m], > 0.
  std::array<double, 2> curvature{{0.0, 0.0}};  ///< Stress-free, about axes 2 and 3 [1/m].
};

}  // namespace statejump::kernel
