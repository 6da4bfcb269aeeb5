// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <limits>
#include <string>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss {

/// Prismatic joint with dry friction and stops. The first node slides along a fixed axis relative
/// to the second and is constrained across it. Without a second node it slides relative to the
/// ground, and its supports constrain it across the axis.
///
/// **Law.** Let s be the slide, s_k its value at the start of the step, and f the friction limit.
/// The force λ along the axis is a subgradient of f |s − s_k| + (0 between the stops, ∞ beyond
/// them). The resolvent of that sum is s = clamp(s_k + soft(s + λ/r − s_k; f/r); −c−, c+). Its
/// branches are the statuses
///
///   stick   s = s_k, |λ| <= f          slip±   λ = ±f, ±(s − s_k) >= 0
///   stop±   s = ±c±, ±λ >= f; if it rested there already ±λ >= −f
///
/// One unknown represents friction and stop together, because statics does not determine how a
/// rigid wall and rigid friction share a force. With a finite stiffness k_t, friction is λ_f =
/// clamp(k_t (s − p_k); ±f) and the stop supports the remainder of λ. In the friction law, p = s −
/// λ_f/k_t replaces s.
///
/// With partial slip λ_f is the force of kernel::partial_slip_step() under the constant limit f,
/// with one step of that law per path step. One row covers stick and slip. `slip±` then means that
/// the whole contact slides.
///
/// **Soft stops.** Stops of stiffness k_s push by W(s) = k_s (s − clamp(s; −c−, c+)), in parallel
/// with friction. W has a potential and no memory, so only friction has statuses: λ is friction,
/// and W is a spring between the nodes. Friction and stop force are then both determined.
///
/// **Play.** A play of width w in series with the contact stiffness k_t moves with the slip. With
/// the deflection e = s − p the contact force is k_t dz(e), dz(e) = e − clamp(e; ±w/2). It slips at
/// ±f, where |e| = w/2 + f/k_t. Since
///
///   k_t dz(e) = k_t e − k_t clamp(e; ±w/2),
///
/// it equals a friction λ = k_t e with the limit f + k_t w/2 and a spring −k_t clamp(e; ±w/2).
/// Statuses, rows and memory are those without play. The heat of a slip is f times its length. At
/// the start the joint is in the middle of its play. A play needs friction, a finite k_t, and no
/// partial slip.
struct Slider {
  std::string name;
  int first = 0;
  int second = -1;  ///< −1: ground.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  double friction_force = 0.0;                                       ///< f [N], >= 0.
  double clearance_minus = std::numeric_limits<double>::infinity();  ///< [m], >= 0.
  double clearance_plus = std::numeric_limits<double>::infinity();   ///< [m], >= 0.
  /// Stiffness k_t of the sticking contact [N/m], > 0; infinity: rigid.
  double tangential_stiffness = std::numeric_limits<double>::infinity();
  /// 1: the contact slips partially, starting at its rim. Needs friction and a finite k_t.
  int partial_slip = 0;
  /// Stiffness k_s of the stops [N/m], > 0; infinity: rigid.
  double stop_stiffness = std::numeric_limits<double>::infinity();
  double play = 0.0;  ///< w [m], >= 0.

  static constexpr const char* kind = "slider";
  int history() const;
  static constexpr int slide_row = 0;
  static std::span<const Parameter<Slider>> parameters();
  static std::span<const Output> outputs();
  void validate(const Model& model) const;
  JointFrame frame(const Model& model) const;
  void evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const;
  void warm(const Trial&, JointStatus, double, JointWriter&) const {}
  JointStatus decide(const Trial& trial, JointStatus status) const;
  void begin(const Trial& trial, JointStatus status, double* now) const;
  void commit(const Trial& trial, JointStatus status, double* after) const;
  double slip(const Trial& trial, const double* after) const;
  double dissipation(const Trial& trial, const double* after, double slip) const;
  double elastic_energy(const Trial& trial, const double* now) const;
  void describe(const Trial& trial, double* outputs) const;
  /// Whether soft stops or a play act as springs in parallel with friction.
  bool has_springs() const { return has_soft_stops() || play > 0.0; }
  bool has_soft_stops() const {
    return stop_stiffness < std::numeric_limits<double>::infinity() &&
           (clearance_minus < std::numeric_limits<double>::infinity() ||
            clearance_plus < std::numeric_limits<double>::infinity());
  }
  /// Largest magnitude of the unknown λ [N]: the friction limit f plus the force that closes half
  /// of the play.
  double friction_limit() const {
    return play > 0.0 ? friction_force + 0.5 * play * tangential_stiffness : friction_force;
  }
  /// Force W [N] that soft stops exert against the axis at the slide s [m]; 0 if the stops are
  /// rigid.
  double soft_stop_force(double s) const;
  std::array<double, 4> beyond_edges(const Trial& trial) const;
  double slide_rounding(const Trial& trial, double length, double force) const;
  bool remembers_when(JointStatus before, JointStatus after) const;
  JointStatus settled(const Trial& trial, JointStatus status) const;
  std::optional<LocalContact> contact(const Trial& trial, JointStatus status) const;
  /// Index in history() at which the memory of a contact with partial slip begins.
  int slip_memory_begin() const;
  bool slips_smoothly() const { return partial_slip != 0; }
  double least_slide() const { return 0.0; }
  JointStatus rest() const { return JointStatus::stick; }
  bool has_play() const { return false; }
  Seat seat(const Trial& trial, double opened, double next, double rounding) const;
  bool jumps(const Trial& trial, JointStatus status) const;
};

}  // namespace statejump::truss
