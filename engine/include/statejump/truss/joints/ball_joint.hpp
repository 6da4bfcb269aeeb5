// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss {

/// Ball joint with clearance and dry friction: a ball on the end of one link within a spherical
/// socket on the end of another. What a revolute is in a plane, in space: the normal is a direction
/// of space, friction has two directions, and its bound is a cone.
///
/// **Law.** With the offset e of the ball's centre from the socket's, normal n = e/|e|, radii r1,
/// r2 less and plus half the depth (both surfaces meet in one point) and the rates ω1, ω2 at which
/// the parts turn, surfaces slide by
///
///     dσ = (1 − n nᵀ) de + r1 ω1 dt × n − r2 ω2 dt × n
///
/// in a tangent plane that turns with the contact: by the smallest rotation that takes n along, and
/// about n by the mean spin of both parts, as the friction of a DEM does. With the force t of the
/// contact along the slide that bends it, compliance C = 1/k_t, k_t = 8 G* √(R δ) (Mindlin):
///
///     open    λ_n = 0, t = 0, |e| <= c    contact   |e| = c + (λ_n/K)^(2/3), λ_n >= 0
///     stick   dσ = d(C t), |t| <= μ λ_n   slip      |t| = μ λ_n, dσ = d(C t) + t/|t| dγ, dγ >= 0
///
/// where load that is added to the contact keeps t, load that is taken away keeps C t. A slip has
/// no sense of its own: it is told as `slip_plus`.
///
/// A straight link turns the part on its end without spinning about its own axis, as a DEM's does;
/// the moment of friction about that axis has nothing to turn. Of several links at a node, the one
/// that is named turns the part.
///
/// **Step.** Slide and turns of a step are taken at its middle. Friction that slips turns into the
/// slide as it does where the slide is straight and the bound constant, along a tractrix; where a
/// slip begins it is projected onto the cone (radial return [1]). All of it is of second order in
/// the increment.
///
/// With partial slip t is the force of kernel::partial_slip_plane() for the slide of the step, the
/// stiffness k_t of the depth and the limit μ λ_n, along directions that are carried as friction
/// is: one row for stick and slip. What is remembered is what kernel::partial_slip_step() leaves,
/// whose chords differ from t by up to 1e-4 of the limit where the direction turns. A slip then
/// says that the whole contact slides.
///
/// **Unknowns.** The force on the ball as a vector along fixed directions, λ_n n + t. Then no
/// direction of the tangent plane is chosen anywhere, and pins, contact and open joint have the
/// same unknowns.
///
/// [1] J. C. Simo, T. J. R. Hughes, Computational Inelasticity, Springer 1998, ch. 3.3.
struct BallJoint {
  std::string name;
  int ball_node = 0;
  int socket_node = 0;
  int ball_link = -1;                   ///< Turns the ball; −1: it does not turn.
  int socket_link = -1;                 ///< Turns the socket; −1: it does not turn.
  double ball_radius = 0.0;             ///< R1 at ΔT = 0 [m], > 0.
  double radial_clearance = 0.0;        ///< c = R2 − R1 at ΔT = 0 [m], > 0.
  double ball_thermal_expansion = 0;    ///< [1/K].
  double socket_thermal_expansion = 0;  ///< [1/K].
  double friction_coefficient = 0.0;    ///< μ, >= 0.
  /// K of Hertz's F_N = K δ^1.5 [N/m^1.5], > 0; infinity: rigid, in motion only.
  double hertz_stiffness = 0.0;
  /// 8 G* √R of Mindlin's k_t = 8 G* √(R δ) [N/m^1.5], > 0; infinity: sticks rigidly, in motion
  /// only.
  double mindlin_stiffness = 0.0;
  /// 1: slides at the rim of its contact first. Needs friction.
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
  /// Motion since the start of the step of a joint that is open [m].
  Eigen::Vector3d slack_motion(const Trial& trial) const;
  JointStatus decide(const Trial& trial, JointStatus status) const;
  void begin(const Trial& trial, JointStatus status, double* now) const;
  void commit(const Trial& trial, JointStatus status, double* after) const;
  bool rolls() const { return friction_coefficient > 0.0 && partial_slip == 0; }
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
  /// Contact problems have one direction of friction: as a contact it is held.
  std::optional<LocalContact> contact(const Trial&, JointStatus) const { return {}; }
  /// Where the memory of a contact with partial slip begins in its history().
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
