// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "statejump/joint_loop/rigid_loop.hpp"
#include "statejump/linkage/model.hpp"

namespace statejump::joint_loop {

/// Tangential compliance of the contact below Coulomb's limit.
///
/// `rigid`: no compliance; the joint rolls without slide, and equilibrium determines the tangential
/// force. `mindlin`: a spring whose stiffness k_t = 8 G* sqrt(R δ) follows the normal load. Loading
/// keeps the tangential force. Unloading keeps the elastic slide, so the force decreases with k_t.
/// This is the spring of the dynamics and of the DEM law in the limit of small increments. If the
/// model's friction law is `mindlin_deresiewicz`, that law is used instead: slip starts at the rim.
enum class TangentialCompliance : unsigned char { rigid, mindlin };

struct ElasticLoopOptions {
  int samples = 2000;  ///< steps per monotone branch of the program, >= 1
  TangentialCompliance compliance = TangentialCompliance::rigid;
};

/// Equilibrium in contact at one temperature.
struct ElasticJointPoint {
  double temperature_change;       ///< ΔT [K]
  double theta2;                   ///< [rad]
  double theta4;                   ///< [rad]
  Eigen::Vector2d bearing_centre;  ///< [m]
  Eigen::Vector2d journal_centre;  ///< [m]
  double depth;                    ///< δ [m], > 0
  double normal_force;             ///< F_N [N], > 0; pushes the bearing along n
  double tangential_force;         ///< F_t [N] on the journal along (−n_y, n_x)
  double contact_angle;            ///< φ [rad] from the joint force's axis AC to n
  double spring_moment;            ///< K_M (α − α0) [N m]
  JointMotion motion;              ///< from this point on; `roll`: no slip
  bool slipping() const { return motion == JointMotion::slip; }
};

/// Quasi-static path. It has events (first, last, changes of motion, corners of the program) and
/// samples between them.
struct ElasticLoop {
  std::vector<ElasticJointPoint> points;
  std::vector<ElasticJointPoint> events;
  /// True if the contact force vanished. The path ends there, because statics does not determine
  /// the position within the play.
  bool separated = false;
  double largest_force_residual = 0.0;    ///< of all points, over the joint force there [-]
  double largest_closure_residual = 0.0;  ///< of all points, closure and friction's slide [m]
  int most_iterations = 0;                ///< of one converged Newton solve
  double theta2_jump() const { return points.back().theta2 - points.front().theta2; }  ///< [rad]
  double theta4_jump() const { return points.back().theta4 - points.front().theta4; }  ///< [rad]
  Eigen::Vector2d bearing_jump() const {                                               ///< [m]
    return points.back().bearing_centre - points.front().bearing_centre;
  }
  Eigen::Vector2d journal_jump() const {  ///< [m]
    return points.back().journal_centre - points.front().journal_centre;
  }
};

/// Equilibrium at ΔT = 0 with the contact at φ from the joint force's axis, at rest. Start of the
/// quasi-static path and of the dynamics. The contact history holds F_t along (−n_y, n_x) and the
/// k_t of TangentialCompliance::mindlin.
/// @param contact_angle φ [rad], |φ| <= atan μ; tan φ = F_t/F_N
/// Throws as elastic_loop() does.
linkage::State loaded_state(const linkage::Linkage& model, double contact_angle = 0.0);

/// Path of the joint through the program with elastic links, Hertz's contact and Coulomb's
/// friction, from loaded_state(). rigid_loop() is its limit for E → ∞.
///
/// Unknowns are the two tips, as angle θ and elongation e = L − l_T of each link, the contact's
/// depth δ and normal n = (cos ψ, sin ψ), and F_t. Let u be the direction of a link, u' = du/dθ, F
/// = F_N n − F_t n' the force on the bearing, F_N = 4/3 E* sqrt(R) δ^1.5, and M the torsion
/// spring's moment. Both surfaces touch in one point half-way between them, so the lever arms are
/// r1 = R1 − δ/2 and r2 = R2 + δ/2:
///
///     F·u2 = k_T1 e1,      (M − r2 F_t)/L1 + F·u2' = 0          tip of AB
///     F·u4 = −k_T2 e2,     (r1 F_t − M)/L2 − F·u4' = 0          tip of BC
///     AC + L2 u4 − L1 u2 = (R2 − R1 + δ) n                      closure
///
/// and one row for friction. In slip it is F_t = ±μ F_N. Otherwise the slide of the step ∫ (R2 − R1
/// + δ) dψ + r1 dθ4 − r2 dθ2 equals the deflection of the tangential spring (0 if rigid). Its
/// integrand is the mean of both ends of the step, so the error of an increment is of third order
/// and that of the path of second order. In slip the state depends only on ΔT. Elongations and
/// depth are unknowns, because forces from differences of positions would have a rounding of 1e-16
/// E A.
///
/// Newton's method uses the analytic Jacobian. It has converged when force rows are below 1e-12 of
/// the joint force (plus the rounding of K_M θ/L) and rows in metres below 4 ε (a + l1 + l2). One
/// further iteration removes rounding. A step without convergence is halved.
///
/// With partial slip, each increment is one step of kernel::partial_slip_step(), with difference
/// quotients as derivatives. The path starts from a contact loaded at a constant force ratio. The
/// law decides stick and slip at the end of an increment, so events are samples. The path is
/// second-order accurate.
///
/// Without partial slip, slip starts when |F_t| reaches μ F_N. It ends when the slip rate, from the
/// derivative of the equations with respect to ΔT, changes sign. Both events are roots within a
/// step. With μ = 0 the contact always slips. The path ends with the contact force, at the last
/// point where F_N exceeds 4e-13 K_M/l: rounding determines the direction of smaller forces.
///
/// All other friction laws contribute only μ. Damping and masses have no influence. Radii may
/// expand. Limits: those of linkage::Linkage and of Hertz's contact.
///
/// Throws std::invalid_argument for a model, program or option out of range, a normal law other
/// than Hertz's, a tangential velocity other than `material`, radii without clearance somewhere in
/// the program, and |contact_angle| > atan μ. Also for a spring that is absent or unloaded at the
/// start, because the position is then undetermined. Throws std::runtime_error with temperature and
/// residual if equilibrium is not found.
ElasticLoop elastic_loop(const linkage::Linkage& model, const thermal::Program& program,
                         const ElasticLoopOptions& options = {}, double contact_angle = 0.0);

}  // namespace statejump::joint_loop
