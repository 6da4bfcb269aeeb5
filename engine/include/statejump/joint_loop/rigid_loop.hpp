// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "statejump/linkage/model.hpp"

namespace statejump::joint_loop {

/// Motion of the loaded joint.
enum class JointMotion : unsigned char { roll, slip, separated };

/// "roll", "slip", "separated".
const char* to_string(JointMotion motion);

/// Equilibrium in contact at one temperature.
struct JointPoint {
  double temperature_change;       ///< ΔT [K]
  double contact_angle;            ///< φ [rad] from the joint force's axis
  double theta2;                   ///< [rad]
  double theta4;                   ///< [rad]
  Eigen::Vector2d eccentricity;    ///< d, journal minus bearing centre [m]
  Eigen::Vector2d bearing_centre;  ///< [m]
  Eigen::Vector2d journal_centre;  ///< [m]
  double spring_moment;            ///< K_M (α − α0) [N m]
  JointMotion motion;              ///< from this point on
};

/// Quasi-static path of the clearance joint. It has events (first, last, changes of motion, corners
/// of the program) and samples between them.
struct RigidLoop {
  std::vector<JointPoint> points;
  std::vector<JointPoint> events;
  /// True if the contact force vanished. The path ends there, because statics does not determine
  /// the position within the play.
  bool separated = false;
  double theta2_jump() const { return points.back().theta2 - points.front().theta2; }  ///< [rad]
  double theta4_jump() const { return points.back().theta4 - points.front().theta4; }  ///< [rad]
  Eigen::Vector2d bearing_jump() const {                                               ///< [m]
    return points.back().bearing_centre - points.front().bearing_centre;
  }
  Eigen::Vector2d journal_jump() const {  ///< [m]
    return points.back().journal_centre - points.front().journal_centre;
  }
};

/// Equilibrium with the contact at φ; motion is set to `roll`.
///
/// The links are rigid with length l_T; the journal's offset d has |d| = c. The spring's couples +M
/// on AB and −M on BC, M = K_M (α − α0), are balanced by the force (f, 0) on the bearing. Moments
/// about A and about C differ by AC × F = 0, so F is parallel to AC, with the sign σ of M. With the
/// contact normal n = σ (cos φ, sin φ) the tangential force is tan φ times the normal force. Then
///
///     w = l1 u2 − l2 u4 = AC − d = (a − σ c cos φ, −σ c sin φ),
///
/// and |w| gives the flare angle by the law of cosines; the direction of w gives the orientation.
/// The force vanishes at α = α0. For equal links and α0 of the ideal position, this occurs at
/// hypot(a + c cos φ, c sin φ) = a (1 + α ΔT), σ = −1.
/// @param side σ, +1 or −1. No argument is checked
JointPoint joint_point(const linkage::Linkage& model, double temperature_change, int side,
                       double contact_angle);

/// Side σ on which the torsion spring loads the joint at ΔT = 0 with the contact at φ. Throws
/// std::invalid_argument for |contact_angle| > atan μ, and if the spring is absent or does not load
/// the joint in this position, which is then undetermined.
int loaded_side(const linkage::Linkage& model, double contact_angle);

/// s = c φ + R1 θ4 − R2 θ2 [m], constant while the joint rolls. Rolling adds equal lengths to the
/// arcs R1 (ψ − θ4) on the journal and R2 (ψ − θ2) on the bearing; ψ is the angle of n in the
/// frame.
double rolling_arc(const linkage::Linkage& model, const JointPoint& point);

/// Path through the program from equilibrium at φ = `contact_angle`, ΔT = 0. Coulomb's law holds
/// exactly: the joint rolls while |φ| < atan μ, and slips at |φ| = atan μ while rolling would leave
/// that range. Only μ of the friction law is used. With μ = 0 the joint slips at φ = 0 throughout,
/// and no jump remains. Bisection finds the ΔT of slip and separation to rounding; corners of the
/// program are exact. `samples` points per monotone branch (>= 1) fill the path; events are sought
/// between neighbouring samples. Throws std::invalid_argument for a model or program out of range,
/// for expanding radii and for |contact_angle| > atan μ. Also for a spring that is absent or
/// unloaded at the start, because the position is then undetermined.
RigidLoop rigid_loop(const linkage::Linkage& model, const thermal::Program& program,
                     double contact_angle = 0.0, int samples = 200);

}  // namespace statejump::joint_loop
