// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <limits>

#include "statejump/kernel/laws/joint_law.hpp"
#include "statejump/kernel/mindlin.hpp"
#include "statejump/thermal/program.hpp"

namespace statejump::linkage {

/// A uniform link pinned to the frame at one end. With uniform axial strain its kinetic energy is T
/// = 1/2 (m/3)(L² θ̇² + L̇²), that of a point mass m/3 at the tip of a massless spring k_T = E
/// A/l_T (equation 4).
struct ThermalLink {
  double stress_free_length = 0.0;  ///< l0 at ΔT = 0 [m], > 0
  double mass = 0.0;                ///< m of the whole link [kg], > 0
  double young_modulus = 0.0;       ///< E [Pa], > 0; also of its half of the joint
  double cross_section_area = 0.0;  ///< A [m²], > 0
  double thermal_expansion = 0.0;   ///< α [1/K], any finite value
  double poisson_ratio = 0.3;       ///< ν [-], in (-1, 0.5]; also of its half of the joint
};

/// One deployed rib of the umbrella antenna: section 4 of the paper (Figs 10 and 11; equation
/// numbers in parentheses).
///
/// Links AB and BC are attached to the frame by ideal pins at A = (0, 0) and C = (a, 0). At B the
/// journal (radius R1) of BC moves with play in the bearing (radius R2) of AB. With d = r_journal −
/// r_bearing (11), δ = |d| − (R2 − R1) (12) and n = d/|d| (13), the normal force of the chosen law,
/// for example F_N = K δ^1.5 (6) to (8), pushes the bearing along +n. The coordinates are the
/// Cartesian positions of both tips, which need no trigonometry. With m/3 at each tip, the ODE is
/// equivalent to (5) in the paper's six coordinates.
///
/// Each link pulls its tip towards its pin with k_T (L − l_T) + c (L̇ − l̇_T), c = 2 ζ sqrt(k m/3),
/// where k is k_T at ΔT = 0. A couple M on a link acts on its tip as the transverse force M/L. The
/// couples are −c_p θ̇ of each pin, the torsion spring's ±K_M (α − α0) (17) with the flare angle α
/// = θ4 − θ2, and the friction moment arm × F. Friction acts half-way between the two contact
/// points of eq. (14), with the velocity of the material there. The tangential velocity law `paper`
/// has no friction moment, see kernel::laws::PaperVelocity.
///
/// Angles: θ2 of AB from A to B, θ4 of BC from C to B, anticlockwise from AC. Limits: planar, small
/// strain, no bending; B above AC; limits of the laws. Linkage is a plain value; call validate()
/// once.
struct Linkage {
  double frame_length = 0.0;               ///< a = |AC| [m], > 0; the frame does not expand
  ThermalLink link_ab;                     ///< has the bearing
  ThermalLink link_bc;                     ///< has the journal
  double journal_radius = 0.0;             ///< R1 at ΔT = 0 [m], > 0
  double bearing_radius = 0.0;             ///< R2 at ΔT = 0 [m], > R1
  double journal_thermal_expansion = 0.0;  ///< [1/K], any finite value; 0: R1 constant
  double bearing_thermal_expansion = 0.0;  ///< [1/K], any finite value; 0: R2 constant
  kernel::laws::JointLaw law;              ///< by default hertz_internal without friction
  double axial_damping_ratio = 0.0;        ///< ζ of both links [-], >= 0
  double pin_damping = 0.0;                ///< c_p at A and at C [N m s/rad], >= 0
  double torsion_stiffness = 0.0;          ///< K_M [N m/rad], >= 0
  /// Flare angle α0 [rad] at which the torsion spring is unloaded, in (0, π). NaN, the default,
  /// means the flare angle of the ideal position.
  double torsion_free_angle = std::numeric_limits<double>::quiet_NaN();

  /// Throws std::invalid_argument whose message names the first field out of range, its value and
  /// the range.
  void validate() const;

  double radial_clearance() const { return bearing_radius - journal_radius; }  ///< c [m]
  /// μ [-]; 0 without a friction law.
  double friction_coefficient() const;
  /// α0 with the default resolved [rad].
  double free_angle() const;
};

/// Positions and velocities of the two tips in the world frame with origin A, and the friction
/// history.
struct State {
  Eigen::Vector2d bearing_centre = Eigen::Vector2d::Zero();    ///< tip of AB [m]
  Eigen::Vector2d journal_centre = Eigen::Vector2d::Zero();    ///< tip of BC [m]
  Eigen::Vector2d bearing_velocity = Eigen::Vector2d::Zero();  ///< [m/s]
  Eigen::Vector2d journal_velocity = Eigen::Vector2d::Zero();  ///< [m/s]
  /// History of a friction law with memory. Its tangential_force is (force on the journal along
  /// (−n_y, n_x), 0, 0) [N]; as a planar force it rotates with the contact.
  kernel::ContactHistory contact;
  double impact_speed = 0.0;  ///< approach speed when the contact began [m/s]; 0: out of contact
};

/// Angles, lengths and the paper's six coordinates of one state.
struct Coordinates {
  Eigen::Vector2d centroid_ab;   ///< X_G1, Y_G1 [m]
  Eigen::Vector2d centroid_bc;   ///< X_G2, Y_G2 [m]
  double theta2;                 ///< [rad]
  double theta4;                 ///< [rad]
  double length_ab;              ///< L of AB [m]
  double length_bc;              ///< L of BC [m]
  Eigen::Vector2d eccentricity;  ///< d, journal minus bearing centre [m]
};

Coordinates coordinates(const Linkage& model, const State& state);

/// Initial motion of the links. `rest`: all velocities zero, as in the paper; the links then
/// vibrate. `matched`: L̇ = l̇_T, so that the links do not vibrate.
enum class Start : unsigned char { rest, matched };

/// Unstrained links at ΔT = 0 with the journal at `eccentricity` d [m] from the bearing's centre;
/// concentric by default. `temperature_rate` [K/s] is used by `matched`. Throws
/// std::invalid_argument if the model is out of range or |d| exceeds the clearance.
State initial_state(const Linkage& model, Start start, double temperature_rate,
                    const Eigen::Vector2d& eccentricity = Eigen::Vector2d::Zero());

/// Contact state of the joint.
struct Joint {
  double penetration_depth;  ///< δ [m]; negative: gap
  double approach_speed;     ///< δ̇ [m/s]
  double normal_force;       ///< F_N with dissipation [N], >= 0
  double tangential_force;   ///< friction on the journal along (−n_y, n_x) [N]
  bool slipping;             ///< at Coulomb's limit; false for a law without memory
};

/// State of the joint. `temperature_rate` [K/s] matters only if the radii expand and the law
/// depends on velocities. Throws std::domain_error if the depth is outside the normal law's range.
Joint joint_state(const Linkage& model, const State& state, double temperature_change,
                  double temperature_rate);

/// Stored energy by term [J].
struct Energy {
  double kinetic;
  double axial;       ///< 1/2 k_T (L − l_T)² of both links
  double contact;     ///< of the normal law
  double tangential;  ///< spring of the friction history
  double torsion;
  double sum() const { return kinetic + axial + contact + tangential + torsion; }
};

Energy energy(const Linkage& model, const State& state, double temperature_change);

/// ΔT_c = c/(α a) [K] of first contact during heating from the concentric position. Both links have
/// the expansion α and only their lengths change: l_T1 u2 − l_T2 u4 = (1 + α ΔT) AC, so the centres
/// move apart along AC by α ΔT a. If the radii expand, ΔT_c is the root of α ΔT a = R2 (1 + α2 ΔT)
/// − R1 (1 + α1 ΔT). Returns infinity if there is no contact at ΔT > 0. Throws
/// std::invalid_argument if the links expand differently.
double first_contact_temperature(const Linkage& model);

}  // namespace statejump::linkage
