// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "statejump/kernel/require.hpp"

namespace statejump {

/// What kept a model, whose input is in range, from giving a result.
enum class FailureKind : unsigned char {
  mechanism,           ///< Truss: it has free modes though no joint slips.
  held_mechanism,      ///< Truss: as drawn, with every joint held.
  friction_exhausted,  ///< Truss: free modes once the friction of joints is at its bound.
  overloaded,          ///< Truss: the loads need more friction at the start than a joint has.
  buckled,             ///< Truss: unstable whatever the joints do.
  unloaded_joint,      ///< Joint without force at the start: its place in the play is undetermined.
  jump_across_play,  ///< Revolute whose contact force vanishes on the way.
  singular,          ///< No equilibrium found: the equations are singular to rounding.
  not_converged,     ///< No equilibrium found: the iteration does not end.
  no_continuation,   ///< Truss: no slow continuation, slip runs away or the truss snaps through.
  several_continuations,  ///< Truss: statics does not choose between several.
  unsettled_joint,        ///< Truss: a joint's status changes without end.
  too_many_steps,         ///< Truss: the path is found only in steps without number.
  law_left_range,         ///< Dynamics: a contact law is asked for what it does not cover.
  not_finite              ///< Dynamics: the steps are too long.
};

/// "mechanism", "held_mechanism", …: the enumerator's name.
const char* to_string(FailureKind kind);

/// A node and the coordinate direction ('x', 'y' or 'z') in which it mostly moves in a mode.
struct ModeNode {
  std::string node;
  char along;
};

/// The nodes that move most in one mode.
using FailureMode = std::vector<ModeNode>;

/// Joint of a truss.
struct FailureJoint {
  std::string kind;  ///< "slider" or "revolute"
  std::string name;
};

/// A failure as fields. What does not apply is empty.
struct FailureFields {
  FailureKind kind;
  std::vector<FailureJoint> joints = {};          ///< Those that fail.
  std::vector<FailureMode> modes = {};            ///< Of a mechanism or of buckling.
  int mode_count = 0;                             ///< May be more than are described in `modes`.
  bool more_modes = false;                        ///< There may be more than `mode_count`.
  std::optional<double> time = {};                ///< [s]
  std::optional<double> temperature_change = {};  ///< ΔT [K]; of a truss that of its first program
  /// What was sought, as "no equilibrium of the drawn shape"; for kinds singular and not_converged,
  /// and of a motion too_many_steps.
  std::string sought = {};
  /// Why, where a part of the program says so itself: the law's own sentence.
  std::string cause = {};
  std::string before = {};  ///< Status that a joint changed from, of an unsettled joint.
  std::string after = {};   ///< Status that it changed to.
  /// Further numbers: name with unit, value.
  std::vector<std::pair<std::string, double>> numbers = {};
};

/// The sentence of a failure, rendered from its fields: the one place where it is worded.
std::string sentence(const FailureFields& fields);

/// What can be done about it; "" where nothing general can be said.
std::string remedy(const FailureFields& fields);

/// Why it happened, the part of the sentence that says so; "" where there is nothing to add.
std::string cause(const FailureFields& fields);

/// A model, whose input is in range, gave no result. what() is the sentence.
class Failure : public std::runtime_error {
 public:
  explicit Failure(FailureFields fields)
      : std::runtime_error(sentence(fields)), fields_(std::move(fields)) {}
  const FailureFields& fields() const { return fields_; }

 private:
  FailureFields fields_;
};

/// The torsion spring of a linkage does not load its joint at the start, which leaves the position
/// within the play undetermined.
class UnloadedJoint : public kernel::OutOfRange {
 public:
  using OutOfRange::OutOfRange;
};

}  // namespace statejump
