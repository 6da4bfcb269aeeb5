// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss {

/// Ball joint with clearance and dry friction: a ball on the end of one link in a spherical socket
/// on the end of another. It generalises the revolute to space: the normal is a direction in space,
/// friction has two components, and its limit is a cone.
///
/// **Law.** Let e be the offset of the ball's centre from the socket's, n = e/|e| the normal, and
/// ω1, ω2 the angular velocities of the parts. r1 is the ball's radius minus half the depth, r2 the
/// socket's radius plus half the depth, so that both surfaces meet in one point. The surfaces slide
/// by
///
///   dσ = (1 − n nᵀ) de + r1 ω1 dt × n − r2 ω2 dt × n
///
/// in a tangent plane that rotates with the contact. This is the smallest rotation from the old to
/// the new normal, then one about n with the mean spin of both parts, as in a DEM. Let t be the
/// friction force, which deflects the contact with the compliance C = 1/k_t, k_t = 8 G* √(R δ)
/// (Mindlin):
///
///   open    λ_n = 0, t = 0, |e| <= c    contact   |e| = c + (λ_n/K)^(2/3), λ_n >= 0
///   stick   dσ = d(C t), |t| <= μ λ_n   slip      |t| = μ λ_n, dσ = d(C t) + t/|t| dγ, dγ >= 0
///
/// An increase of the normal load keeps t; a decrease keeps C t. Slip in any direction has the
/// status `slip_plus`.
///
/// A straight link rotates the part on its end without spin about its own axis, as in a DEM. The
/// moment of friction about that axis therefore has no effect. If several links end at a node, the
/// link named in the joint rotates the part. A node of beams rotates its part with all its spin.
///
/// **Step.** Slide and rotations of a step are evaluated at its middle. In slip, the direction of
/// friction rotates towards the slide along a tractrix, which is exact for a straight slide and a
/// constant limit. In the step in which slip begins, friction is projected onto the cone (radial
/// return [1]). The joint is second-order accurate in the increment.
///
/// With partial slip t is the force of kernel::partial_slip_plane() for the slide of the step, the
/// stiffness k_t at the depth and the limit μ λ_n. The directions of the law rotate as described
/// for friction. One equation covers stick and slip. The memory is updated by
/// kernel::partial_slip_step(), whose chords differ from t by up to 1e-4 of the limit where the
/// direction rotates. The status slip means that the whole contact slides.
///
/// **Unknowns.** The unknowns are the components of the force on the ball, λ_n n + t, along fixed
/// directions. Pinned, closed and open joints have the same unknowns.
///
/// [1] J. C. Simo, T. J. R. Hughes, Computational Inelasticity, Springer 1998, ch. 3.3.
struct BallJoint {
  std::string name;
  int ball_node = 0;
  int socket_node = 0;
  int ball_link = -1;                   ///< Rotates the ball; −1: none.
  int socket_link = -1;                 ///< Rotates the socket; −1: none.
  int ball_turns = 0;                   ///< 1: its node rotates the ball, no link.
  int socket_turns = 0;                 ///< 1: its node rotates the socket, no link.
  double ball_radius = 0.0;             ///< R1 at ΔT = 0 [m], > 0.
  double radial_clearance = 0.0;        ///< c = R2 − R1 at ΔT = 0 [m], > 0.
  double ball_thermal_expansion = 0;    ///< [1/K].
  double socket_thermal_expansion = 0;  ///< [1/K].
  double friction_coefficient = 0.0;    ///< μ, >= 0.
  /// K of Hertz's F_N = K δ^1.5 [N/m^1.5], > 0. Infinity means a rigid contact, which only dynamics
  /// supports.
  double hertz_stiffness = 0.0;
  /// 8 G* √R of Mindlin's k_t = 8 G* √(R δ) [N/m^1.5], > 0. Infinity means rigid stick, which only
  /// dynamics supports.
  double mindlin_stiffness = 0.0;
  /// 1: the contact slips partially, starting at its rim. Needs friction.
  int partial_slip = 0;
  int program = 0;
  double temperature_fraction = 1;

  static constexpr const char* kind = "ball_joint";
  int history() const;
  static constexpr int slide_row = 0;
  static std::span<const Parameter<BallJoint>> parameters();
  static std::span<const Output> outputs();
  void validate(const Model& model) const;
  JointFrame frame(const Model& model) const;
  void evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const;
  void warm(const Trial& trial, JointStatus status, double temperature_rate,
            JointWriter& writer) const;
  /// Displacement of ball against socket since the start of the step; joint open [m].
  Eigen::Vector3d slack_motion(const Trial& trial) const;
  JointStatus decide(const Trial& trial, JointStatus status) const;
  void begin(const Trial& trial, JointStatus status, double* now) const;
  void commit(const Trial& trial, JointStatus status, double* after) const;
  bool rolls() const { return friction_coefficient > 0.0 && partial_slip == 0; }
  bool softens(const Trial& trial) const;
  Eigen::Vector3d lag(const Trial& trial) const;
  double slip(const Trial& trial, const double* after) const;
  double dissipation(const Trial& trial, const double* after, double slip) const;
  double elastic_energy(const Trial& trial, const double* now) const;
  double clearance_growth() const {
    return socket_thermal_expansion * (ball_radius + radial_clearance) -
           ball_thermal_expansion * ball_radius;
  }
  double contact_force(const Trial& trial) const;
  void describe(const Trial& trial, double* outputs) const;
  double slide_rounding(const Trial& trial, double length, double force) const;
  bool remembers_when(JointStatus before, JointStatus after) const;
  JointStatus settled(const Trial& trial, JointStatus status) const;
  /// Contact problems have only one friction direction per contact, so a ball joint keeps its
  /// status in them.
  std::optional<LocalContact> contact(const Trial&, JointStatus) const { return {}; }
  /// Index in history() at which the memory of a contact with partial slip begins.
  int slip_memory_begin() const;
  bool slips_smoothly() const { return partial_slip != 0; }
  double least_slide() const { return radial_clearance; }
  JointStatus rest() const {
    return friction_coefficient > 0.0 ? JointStatus::stick : JointStatus::slip_plus;
  }
  bool has_play() const { return true; }
  Seat seat(const Trial& trial, double opened, double next, double rounding) const;
  bool jumps(const Trial& trial, JointStatus status) const;
};

}  // namespace statejump::truss
