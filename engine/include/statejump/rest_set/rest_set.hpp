// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

namespace statejump::rest_set {

/// One connected part of a rest set. Positions [m] of the component's centre.
struct Part {
  double area = 0.0;      ///< of its two-dimensional pieces [m²]
  double length = 0.0;    ///< of its one-dimensional pieces [m]; an isolated point has neither
  double diameter = 0.0;  ///< largest distance between two of its positions [m]
  /// Arc of a circular clearance, or largest angle between two directions of a spherical one [rad];
  /// NaN where the clearance has no centre.
  double angle = std::numeric_limits<double>::quiet_NaN();
  /// Middle of an arc or segment; of a piece of a surface a position deep inside the cone.
  Eigen::Vector3d representative = Eigen::Vector3d::Zero();
  /// Along a one-dimensional part, its ends first and last (one point if it is isolated).
  std::vector<Eigen::Vector3d> points;
  /// Of a part with area: its one-dimensional pieces, the rims of rest_in_bore().
  std::vector<std::vector<Eigen::Vector3d>> rims;
};

/// Positions at which a component can rest.
///
/// Component I with centre at x on the configuration surface S (all centres at which I touches II)
/// is loaded by F [N] and carried by one reaction R = −F. With N the unit normal of S on the side
/// of the free positions, the direction in which II pushes I, Coulomb's law admits R exactly where
/// R·N > 0 and |R − (R·N) N| ≤ μ R·N, that is
///
///     angle(−F, N(x)) ≤ atan μ.
///
/// This is balance of forces: at μ = 0 a crest of S is in it as well as a trough. Moments are taken
/// to be carried elsewhere.
struct RestSet {
  std::vector<Part> parts;  ///< none: it rests nowhere
  double area = 0.0;        ///< sum over the parts [m²]
  double length = 0.0;      ///< sum over the parts [m]
  /// Largest distance between two positions [m], of different parts as well: no state jump of this
  /// joint under the same force is larger.
  double diameter = 0.0;
  std::array<Eigen::Vector3d, 2> farthest = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  /// How far the number may be from the diameter of the surface itself [m]; 0 in closed form and on
  /// curves, where it is found to rounding.
  double diameter_error = 0.0;
};

/// Rest sets of several forces, as load cases or the temperatures of a cycle.
struct Study {
  std::vector<RestSet> each;  ///< one per force
  RestSet any;                ///< positions that at least one force allows
  RestSet all;                ///< positions that every force allows: held through all load cases
};

// Every function below takes forces on the component [N], at least one and none of them zero, and
// μ >= 0, and throws std::invalid_argument that names what is out of range.

/// One-dimensional joint: a block in a slot, free by −c <= s <= c along x.
///
/// The part of F across the axis presses the block on the guide; it stays anywhere, a segment of
/// length 2 c, if |F_x| <= μ |F_across|, and goes to the stop that F_x points to otherwise.
/// Friction on the face of the stop is not needed and not counted.
/// @param clearance c [m], > 0
Study rest_in_slot(double clearance, const std::vector<Eigen::Vector3d>& forces, double mu);

/// Two-dimensional joint: a journal in a bearing, its centre on the circle of radius c (z = 0).
///
/// Where the centre is at c e the reaction has N = −e, so it rests where angle(F, e) <= φ = atan μ:
/// an arc of half-angle φ about the direction of F, diameter 2 c sin φ.
/// @param clearance c = R2 − R1 [m], > 0
Study rest_in_bearing(double clearance, const std::vector<Eigen::Vector2d>& forces, double mu);

/// Three-dimensional joint: a ball in a socket, its centre on the sphere of radius c.
///
/// As rest_in_bearing(): a cap of half-angle φ = atan μ and area 4π c² sin²(φ/2). Unions and
/// intersections of caps have areas by Gauss-Bonnet on their boundary arcs; diameters are exact.
/// @param clearance c [m], > 0
Study rest_in_socket(double clearance, const std::vector<Eigen::Vector3d>& forces, double mu);

/// A cylinder in a bore (axis z) between two shoulders: the centre is on the can of radius c and
/// height 2 b. The cylinder does not tilt.
///
/// Wall: with F_r the part of F across the axis and t = F_z/F_r, angle φ from F_r, the cone test is
/// sin²φ + t² <= μ² cos²φ, an arc of half-angle atan2(√(μ² − t²), √(1 + t²)), over the whole
/// height. None if |F_z| > μ F_r. Shoulder at z = ±b: the whole disc if F_r <= μ |F_z| (and F_z
/// points to it). Rim: wall and shoulder both push, so F must lie in the sum of two friction cones
/// with axes e and ±z. y is in the dual of that sum if its angles to both axes are at most π/2 −
/// atan μ; F is in the sum if F·y >= 0 for all of these, which is decided at the corners and at the
/// two nearest points of that lens. The arc is found by bisection. From μ = 1 on wall and shoulder
/// can grip the cylinder under any force, and the whole rim is included.
/// @param clearance c [m], > 0  @param axial_play b: from the middle to either shoulder [m], > 0
Study rest_in_bore(double clearance, double axial_play, const std::vector<Eigen::Vector3d>& forces,
                   double mu);

}  // namespace statejump::rest_set
