// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss {

/// Prismatic joint with dry friction and stops: the first node slides along a fixed axis relative
/// to the second and is held across it; without a second node it slides relative to the ground, and
/// its own free directions hold it across.
///
/// **Law.** With slide s and friction f the force λ along the axis is a subgradient of
/// f |s − s_k| + (0 between the stops, ∞ beyond them): the resolvent of that sum is
/// s = clamp(s_k + soft(s + λ/r − s_k; f/r); −c−, c+), and its pieces are the branches
///
///     stick   s = s_k, |λ| <= f          slip±   λ = ±f, ±(s − s_k) >= 0
///     stop±   s = ±c±, ±λ >= f; where it rested there already ±λ >= −f
///
/// One unknown does for friction and stop together: how a rigid wall and rigid friction share a
/// force is not determined. With a finite k_t what slides is p = s − λ_f/k_t, friction is
/// λ_f = clamp(k_t (s − p_k); ±f), and the stop takes what is beyond it.
///
/// With partial slip λ_f is the force of kernel::partial_slip_step() under the constant limit f,
/// one step of it from state to state: one row for stick and slip. `slip±` then says that the whole
/// contact slides.
struct Slider {
  std::string name;
  int first = 0;
  int second = -1;  ///< −1: ground.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  double friction_force = 0.0;                                       ///< f [N], >= 0.
  double clearance_minus = std::numeric_limits<double>::infinity();  ///< [m], >= 0.
  double clearance_plus = std::numeric_limits<double>::infinity();   ///< [m], >= 0.
  /// k_t of the contact while it sticks [N/m], > 0; infinity: rigid.
  double tangential_stiffness = std::numeric_limits<double>::infinity();
  /// 1: slides at the rim of its contact first. Needs friction and a finite k_t.
  int partial_slip = 0;

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
  double slide_rounding(const Trial& trial, double length, double force) const;
  bool remembers_when(JointStatus before, JointStatus after) const;
  JointStatus settled(const Trial& trial, JointStatus status) const;
  std::optional<LocalContact> contact(const Trial& trial, JointStatus status) const;
  /// Where the memory of a contact with partial slip begins in its history().
  int slip_memory_begin() const;
  bool slips_smoothly() const { return partial_slip != 0; }
  double least_slide() const { return 0.0; }
  JointStatus rest() const { return JointStatus::stick; }
  bool has_play() const { return false; }
  Seat seat(const Trial& trial, double opened, double next, double rounding) const;
  bool jumps(const Trial& trial, JointStatus status) const;
};

}  // namespace statejump::truss
