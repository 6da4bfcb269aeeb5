// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss {

class MomentCurve;

/// Law of a joint that rotates about an axis, with play, stiffness, dry friction, and a preload
/// moment.
///
/// **Law.** The moment that resists the rotation φ from the reference configuration is
///
///   M = M0 + K (φ − clamp(φ; −a, a)) + M_t(φ) + M_f
///
/// with a moment curve M_t, if there is one, and friction M_f a subgradient of M_c |φ − φ_k|:
///
///   stick   φ = φ_k, |M_f| <= M_c      slip±   M_f = ±M_c, ±(φ − φ_k) >= 0
///
/// With a finite stiffness k_f, sticking friction acts as a spring, M_f = k_f (φ − p), and slip
/// changes the stored rotation p. Play, stiffness and curve have a potential and no memory, so only
/// friction has statuses. The first unknown is M_f divided by a radius. Its row is a slide on that
/// radius.
///
/// `Type` derives from HingeLaw<Type> and has rotation(trial) [rad], radius(trial) [m],
/// turning_ratio(trial), the radius over the smallest lever of its nodes, at least 1, and
/// moment_curve(), which is null without a curve.
template <class Type>
struct HingeLaw : PlainJoint {
  double deadband = 0.0;         ///< a [rad], >= 0: free play to either side.
  double stiffness = 0.0;        ///< K beyond the play [N m/rad], >= 0.
  double friction_moment = 0.0;  ///< M_c [N m], >= 0.
  /// Stiffness k_f of sticking friction [N m/rad], > 0; infinity: rigid.
  double friction_stiffness = std::numeric_limits<double>::infinity();
  double preload_moment = 0.0;  ///< M0 against the rotation [N m].
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();

  static constexpr int history() { return 2; }
  static constexpr int slide_row = 0;
  JointStatus decide(const Trial& trial, JointStatus status) const;
  void begin(const Trial& trial, JointStatus status, double* now) const;
  void commit(const Trial& trial, JointStatus status, double* after) const;
  double slip(const Trial& trial, const double* after) const;
  double dissipation(const Trial& trial, const double* after, double slip) const;
  double elastic_energy(const Trial& trial, const double* now) const;
  /// Moment of preload, stiffness and curve at a rotation [N m].
  double elastic_moment(double rotation) const;
  /// Rotation of a hinge with a moment curve since the start of the step, on its radius [m].
  Eigen::Vector3d slack_motion(const Trial& trial) const;
  std::array<double, 2> beyond_edges(const Trial& trial) const;
  /// Outputs: rotation from the reference configuration; moment against it (preload, stiffness and
  /// friction).
  void describe(const Trial& trial, double* outputs) const;
  double slide_rounding(const Trial& trial, double length, double force) const;
  bool remembers_when(JointStatus before, JointStatus after) const;
  std::optional<LocalContact> contact(const Trial& trial, JointStatus status) const;

 protected:
  /// The law at a trial.
  struct Law {
    double moment;   ///< M [N m]
    double tangent;  ///< Derivative of its elastic part [N m/rad].
    double by_row;   ///< Factor of the rotation's gradient in the row of friction [m].
    double radius;   ///< [m]
  };
  /// Writes the row of friction except for the gradient of the rotation.
  Law evaluate_law(const Trial& trial, JointStatus status, JointWriter& writer) const;

 private:
  const Type& type() const { return static_cast<const Type&>(*this); }
  /// Slipped part of the rotation [rad].
  double slipped(const Trial& trial) const;
  /// Rotation beyond the play [rad].
  double beyond_play(double rotation) const;
  /// Stiffness of the dashpot on the rotation of a hinge that snaps [N m/rad].
  double slack(const Trial& trial) const;
};

}  // namespace statejump::truss
