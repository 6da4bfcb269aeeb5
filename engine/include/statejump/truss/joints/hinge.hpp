// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss {

struct Constraint;

/// Hinge between two nodes at one position, with beams or rigid bodies that it rotates about a
/// common axis.
///
/// **Kinematics.** R₁ and R₂ are the rotations of the nodes since the reference configuration, a
/// the axis. The quaternion (w, v) of R₁ᵀR₂ satisfies v·t = 0 for the two directions t across the
/// axis, and φ = 2 atan2(v·a, w) is the rotation of the second node against the first.
/// Displacements of both nodes are equal by linear constraints.
///
/// **Law.** The moment that resists the rotation φ is
///
///   M = M0 + K (φ − clamp(φ; −b, b)) + M_f
///
/// with friction M_f as in LatchHinge. The first unknown is M_f over Node::arm of the first node.
/// The others are the moments across the axis over the same arm. Where the nodes cannot tilt, as in
/// a plane, these are missing.
struct Hinge {
  std::string name;
  int first = 0;                 ///< Node.
  int second = 0;                ///< Node.
  double deadband = 0.0;         ///< b [rad], >= 0: free play to either side.
  double stiffness = 0.0;        ///< K beyond the play [N m/rad], >= 0.
  double friction_moment = 0.0;  ///< M_c [N m], >= 0.
  /// Stiffness of sticking friction [N m/rad], > 0; infinity: rigid.
  double friction_stiffness = std::numeric_limits<double>::infinity();
  double preload_moment = 0.0;  ///< M0 against the rotation [N m].
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();

  static constexpr const char* kind = "hinge";
  static constexpr int history() { return 1; }
  static constexpr int slide_row = 0;
  static std::span<const Parameter<Hinge>> parameters();
  static std::span<const Output> outputs();
  void validate(const Model& model) const;
  JointFrame frame(const Model& model) const;
  std::vector<Constraint> ties(const Model& model) const;
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
