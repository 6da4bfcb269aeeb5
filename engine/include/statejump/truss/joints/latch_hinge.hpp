// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <string>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss {

/// Hinge with a latch: free play in rotation, stiffness beyond it, dry friction, and a preload
/// moment.
///
/// **Law.** φ is the rotation of the second link against the first about a fixed axis, from the
/// reference configuration. Without a second link, it is the rotation of the first link against the
/// ground. The moment that resists the rotation φ is
///
///   M = M0 + K (φ − clamp(φ; −a, a)) + M_f
///
/// with friction M_f a subgradient of M_c |φ − φ_k|:
///
///   stick   φ = φ_k, |M_f| <= M_c      slip±   M_f = ±M_c, ±(φ − φ_k) >= 0
///
/// With a finite stiffness k_f, sticking friction acts as a spring, M_f = k_f (φ − p), and slip
/// changes the stored rotation p. Play and stiffness have a potential and no memory, so only
/// friction has statuses. The unknown is M_f divided by the length of the first link in the
/// reference configuration. Its row is a slide on that radius.
struct LatchHinge {
  std::string name;
  int first_link = 0;
  int second_link = -1;          ///< −1: ground.
  double deadband = 0.0;         ///< a [rad], >= 0: free play to either side.
  double stiffness = 0.0;        ///< K beyond the play [N m/rad], >= 0.
  double friction_moment = 0.0;  ///< M_c [N m], >= 0.
  /// Stiffness k_f of sticking friction [N m/rad], > 0; infinity: rigid.
  double friction_stiffness = std::numeric_limits<double>::infinity();
  double preload_moment = 0.0;  ///< M0 against the rotation [N m].
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();

  static constexpr const char* kind = "latch_hinge";
  static constexpr int history() { return 1; }
  static constexpr int slide_row = 0;
  static std::span<const Parameter<LatchHinge>> parameters();
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
  /// Moment of preload and stiffness at a rotation [N m].
  double elastic_moment(double rotation) const;
  std::array<double, 2> beyond_edges(const Trial& trial) const;
  void describe(const Trial& trial, double* outputs) const;
  double slide_rounding(const Trial& trial, double length, double force) const;
  bool remembers_when(JointStatus before, JointStatus after) const;
  JointStatus settled(const Trial&, JointStatus status) const { return status; }
  std::optional<LocalContact> contact(const Trial& trial, JointStatus status) const;
  bool slips_smoothly() const { return false; }
  double least_slide() const { return 0.0; }
  JointStatus rest() const { return JointStatus::stick; }
  bool has_play() const { return false; }
  Seat seat(const Trial&, double, double, double) const { return {}; }
  bool jumps(const Trial&, JointStatus) const { return false; }
};

}  // namespace statejump::truss
