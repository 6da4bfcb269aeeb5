// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss {

struct Constraint;

/// Rigid arm from a master node to another node. The arm rotates with the master.
///
/// **Law.** With the arm r of the reference configuration, and displacement u and rotation R of the
/// master, u' = u + (R − I) r holds along every held coordinate direction. One force along each of
/// these directions enforces it; the force acts on the other node, and its reaction and moment on
/// the master. Held rotations of the other node equal those of the master. Because all rotations
/// start at zero, this is a linear constraint of the rotation vectors: exact for three held
/// rotations. The joint has no energy and always the status `stick`.
struct RigidArm : PlainJoint {
  std::string name;
  int master = 0;
  int node = 0;  ///< At the end of the arm.
  // Held displacements and rotations of the node about the coordinate directions.
  bool holds_x = true;
  bool holds_y = true;
  bool holds_z = true;
  bool holds_rotation_x = true;
  bool holds_rotation_y = true;
  bool holds_rotation_z = true;

  static constexpr const char* kind = "rigid";
  static constexpr int history() { return 0; }
  static constexpr int slide_row = 0;
  static std::span<const Parameter<RigidArm>> parameters();
  static std::span<const Output> outputs();
  void validate(const Model& model) const;
  JointFrame frame(const Model& model) const;
  std::vector<Constraint> ties(const Model& model) const;
  void evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const;
  JointStatus decide(const Trial&, JointStatus) const { return JointStatus::stick; }
  void begin(const Trial&, JointStatus, double*) const {}
  void commit(const Trial&, JointStatus, double*) const {}
  double slip(const Trial&, const double*) const { return 0.0; }
  double dissipation(const Trial&, const double*, double) const { return 0.0; }
  double elastic_energy(const Trial&, const double*) const { return 0.0; }
  void describe(const Trial& trial, double* outputs) const;
  double slide_rounding(const Trial&, double length, double) const { return length; }
  bool remembers_when(JointStatus, JointStatus) const { return false; }
  std::optional<LocalContact> contact(const Trial&, JointStatus) const { return std::nullopt; }
};

}  // namespace statejump::truss
