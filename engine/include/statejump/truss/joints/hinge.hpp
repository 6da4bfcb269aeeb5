// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "statejump/truss/joints/hinge_law.hpp"
#include "statejump/truss/joints/moment_curve.hpp"

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
/// **Law.** HingeLaw; the radius is Node::arm of the first node. Further unknowns are the moments
/// across the axis over the same arm. Where the nodes cannot tilt, as in a plane, these are
/// missing.
struct Hinge : HingeLaw<Hinge> {
  std::string name;
  int first = 0;                                  ///< Node.
  int second = 0;                                 ///< Node.
  std::shared_ptr<const MomentCurve> curve = {};  ///< Null: none.

  static constexpr const char* kind = "hinge";
  static std::span<const Parameter<Hinge>> parameters();
  static std::span<const Output> outputs();
  void validate(const Model& model) const;
  JointFrame frame(const Model& model) const;
  std::vector<Constraint> ties(const Model& model) const;
  void evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const;
  /// Rotation of the joint from the reference configuration [rad].
  double rotation(const Trial& trial) const;
  double radius(const Trial& trial) const;
  double turning_ratio(const Trial& trial) const;
  const MomentCurve* moment_curve() const { return curve.get(); }
};

}  // namespace statejump::truss
