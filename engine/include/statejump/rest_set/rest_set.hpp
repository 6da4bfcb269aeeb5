// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

namespace statejump::rest_set {

/// One connected component of a rest set. Its positions are those of the moving part's centre [m].
struct RestComponent {
  double area = 0.0;      ///< of its two-dimensional pieces [m²]
  double length = 0.0;    ///< of its one-dimensional pieces [m]; an isolated point has neither
  double diameter = 0.0;  ///< largest distance between two of its positions [m]
  /// Angle of the arc of a circular clearance [rad], or largest angle between two directions of a
  /// spherical one. NaN if the clearance has no centre.
  double angle = std::numeric_limits<double>::quiet_NaN();
  /// Middle of an arc or segment; on a surface, a position well inside the friction cone.
  Eigen::Vector3d representative = Eigen::Vector3d::Zero();
  /// Positions along a one-dimensional component, from end to end. An isolated component has one
  /// point.
  std::vector<Eigen::Vector3d> points;
  /// One-dimensional pieces of a component with area: the rims of rest_in_bore().
  std::vector<std::vector<Eigen::Vector3d>> rims;
};

/// Positions at which a part I can rest on a part II.
///
/// The centre of I is at x on the configuration surface S, the set of all centres at which I
/// touches II. The force F [N] loads I, and one reaction R = −F supports it. Let N be the unit
/// normal of S towards the free positions, the direction in which II pushes I. Coulomb's law admits
/// R exactly if R·N > 0 and |R − (R·N) N| ≤ μ R·N, that is
///
///    angle(−F, N(x)) ≤ atan μ.
///
/// Only forces are balanced, not stability: at μ = 0 the set contains crests of S as well as
/// troughs. Other supports are assumed to balance moments.
struct RestSet {
  std::vector<RestComponent> parts;  ///< empty: the component rests nowhere
  double area = 0.0;                 ///< sum over the parts [m²]
  double length = 0.0;               ///< sum over the parts [m]
  /// Largest distance between two positions of the set [m]. No state jump of this joint under the
  /// same force is larger.
  double diameter = 0.0;
  std::array<Eigen::Vector3d, 2> farthest = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  /// Bound of the error of `diameter` due to the approximation of the surface [m]. 0 for closed
  /// forms and curves, which have rounding only.
  double diameter_error = 0.0;
};

/// Rest sets for several forces, for example for load cases or for the temperatures of a cycle.
struct RestStudy {
  std::vector<RestSet> each;  ///< one per force
  RestSet any;                ///< positions that at least one force allows
  RestSet all;                ///< positions that every force allows: held through all load cases
};

// Every function here takes μ >= 0 and the forces on the moving part [N]: at least one, none of
// them zero. It throws std::invalid_argument whose message names the argument out of range.

/// One-dimensional joint: a block in a slot that moves freely within −c <= s <= c along x.
///
/// The component of F across the x axis presses the block on the guide. If |F_x| <= μ |F_across|,
/// the block can rest everywhere on the segment of length 2 c. Otherwise it moves to the stop in
/// the direction of F_x. Friction on the face of the stop is ignored.
/// @param clearance c [m], > 0
RestStudy rest_in_slot(double clearance, const std::vector<Eigen::Vector3d>& forces, double mu);

/// Two-dimensional joint: a journal in a bearing, its centre on the circle of radius c (z = 0).
///
/// With the centre at c e, N = −e, so the journal rests if angle(F, e) <= φ = atan μ. The rest set
/// is an arc of half-angle φ about the direction of F, with diameter 2 c sin φ.
/// @param clearance c = R2 − R1 [m], > 0
RestStudy rest_in_bearing(double clearance, const std::vector<Eigen::Vector2d>& forces, double mu);

/// Three-dimensional joint: a ball in a socket, its centre on the sphere of radius c.
///
/// As in rest_in_bearing(), the rest set is a cap of half-angle φ = atan μ, with area 4π c²
/// sin²(φ/2). Unions and intersections of caps have areas from Gauss-Bonnet's formula on their
/// boundary arcs. Diameters are exact.
/// @param clearance c [m], > 0
RestStudy rest_in_socket(double clearance, const std::vector<Eigen::Vector3d>& forces, double mu);

/// A cylinder in a bore (axis z) between two shoulders: the centre is on a can, a closed cylinder
/// of radius c and height 2 b. The cylinder does not tilt.
///
/// Wall: let F_r be the component of F across the axis, t = F_z/F_r, and φ the angle from F_r. The
/// friction cone requires sin²φ + t² <= μ² cos²φ. The rest set is an arc of half-angle atan2(√(μ² −
/// t²), √(1 + t²)) over the whole height, or empty if |F_z| > μ F_r.
///
/// Shoulder at z = ±b: the rest set is the whole disc if F_r <= μ |F_z| and F_z points to the
/// shoulder.
///
/// Rim: wall and shoulder both push, so F must be in the sum of two friction cones with axes e and
/// ±z. A vector y is in the dual of that sum if its angles to both axes are at most π/2 − atan μ. F
/// is in the sum if F·y >= 0 for all such y. The unit vectors y form a lens, whose corners and two
/// nearest points decide. Bisection finds the arc. For μ >= 1 wall and shoulder can clamp the
/// cylinder under any force, and the whole rim is included.
/// @param clearance c [m], > 0
/// @param axial_play b, distance from the middle to either shoulder [m], > 0
RestStudy rest_in_bore(double clearance, double axial_play,
                       const std::vector<Eigen::Vector3d>& forces, double mu);

}  // namespace statejump::rest_set
