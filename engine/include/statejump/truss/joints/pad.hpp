// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss {

/// Pad: a node that rests on a plane with a normal stiffness, a clearance and Coulomb friction in
/// both directions of the plane. The plane moves with a second node, or it is fixed.
///
/// **Law.** u is the displacement of the node relative to the plane, n the normal from the plane to
/// the node, s the part of u in the plane, λ the normal force and t the friction force on the node.
///
///   open    λ = 0, t = 0, c + n·u >= 0      contact   c + n·u = −λ/k_n, λ >= 0
///   stick   ds = −dt/k_t, |t| <= μ λ        slip      |t| = μ λ, ds = −dt/k_t − t/|t| dγ, dγ >= 0
///
/// Slip in any direction has the status `slip_plus`.
///
/// **Step.** In slip, friction is the elastic trial force t₀ − k_t Δs, projected onto the cone
/// (radial return [1]). Its direction is exact for a straight slide, otherwise first-order accurate
/// in the increment.
///
/// **Unknowns.** The forces of the node on the pad: −t along two directions of the plane, and −λ.
///
/// [1] J. C. Simo, T. J. R. Hughes, Computational Inelasticity, Springer 1998, ch. 3.3.
struct Pad : PlainJoint {
  std::string name;
  int first = 0;    ///< Node.
  int second = -1;  ///< Node that carries the plane; −1: the ground.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< From the plane to the node.
  double clearance = 0.0;                             ///< c [m], >= 0.
  double normal_stiffness = 0.0;                      ///< k_n [N/m], > 0.
  double tangential_stiffness = 0.0;                  ///< k_t [N/m], > 0.
  double friction_coefficient = 0.0;                  ///< μ, >= 0.

  static constexpr const char* kind = "pad";
  static constexpr int slide_row = 0;
  static std::span<const Parameter<Pad>> parameters();
  static std::span<const Output> outputs();
  int history() const;
  void validate(const Model& model) const;
  JointFrame frame(const Model& model) const;
  void evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const;
  /// Displacement of the node relative to the plane since the start of the step; joint open [m].
  Eigen::Vector3d slack_motion(const Trial& trial) const;
  JointStatus decide(const Trial& trial, JointStatus status) const;
  void begin(const Trial& trial, JointStatus status, double* now) const;
  void commit(const Trial& trial, JointStatus status, double* after) const {
    begin(trial, status, after);
  }
  double slip(const Trial& trial, const double* after) const;
  double dissipation(const Trial& trial, const double* after, double slip) const;
  double elastic_energy(const Trial& trial, const double* now) const;
  void describe(const Trial& trial, double* outputs) const;
  double slide_rounding(const Trial&, double length, double force) const {
    return length + force / tangential_stiffness;
  }
  bool remembers_when(JointStatus before, JointStatus after) const {
    if (friction_coefficient == 0.0) return false;
    return before == JointStatus::open || (is_slip(before) && after == JointStatus::stick);
  }
  /// Contact problems have only one friction direction per contact, so a pad keeps its status.
  std::optional<LocalContact> contact(const Trial&, JointStatus) const { return {}; }
  double least_slide() const { return clearance; }
  JointStatus rest() const {
    return friction_coefficient > 0.0 ? JointStatus::stick : JointStatus::slip_plus;
  }
  bool has_play() const { return true; }
  Seat seat(const Trial& trial, double opened, double next, double rounding) const;
};

}  // namespace statejump::truss
