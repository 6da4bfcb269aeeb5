// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "statejump/truss/joints/hinge_law.hpp"

namespace statejump::truss {

/// Hinge with a latch between two links about an axis fixed in space; HingeLaw is its law. The
/// rotation φ is that of the second link against the first. Without a second link, it is the
/// rotation of the first link against the ground. The radius is the length of the first link in the
/// reference configuration.
struct LatchHinge : HingeLaw<LatchHinge> {
  std::string name;
  int first_link = 0;
  int second_link = -1;  ///< −1: ground.

  static constexpr const char* kind = "latch_hinge";
  static std::span<const Parameter<LatchHinge>> parameters();
  static std::span<const Output> outputs();
  void validate(const Model& model) const;
  JointFrame frame(const Model& model) const;
  void evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const;
  /// Rotation of the joint from the reference configuration [rad].
  double rotation(const Trial& trial) const;
  double radius(const Trial& trial) const;
  double turning_ratio(const Trial& trial) const;
  static const MomentCurve* moment_curve() { return nullptr; }
};

}  // namespace statejump::truss
