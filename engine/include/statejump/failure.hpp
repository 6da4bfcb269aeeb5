// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "statejump/kernel/require.hpp"

namespace statejump {

/// Reason why a model with valid input has no result.
enum class FailureKind : unsigned char {
  mechanism,           ///< Truss: free modes without any slip.
  held_mechanism,      ///< Truss: free modes in the reference configuration with every joint
                       ///< constrained.
  friction_exhausted,  ///< Truss: free modes once the friction of joints is at its limit.
  overloaded,          ///< Truss: at the start the loads exceed the friction of a joint.
  buckled,             ///< Truss: unstable for every status of the joints.
  unloaded_joint,  ///< Joint without force at the start: its position in the play is undetermined.
  jump_across_play,       ///< Revolute whose contact force vanishes along the path.
  singular,               ///< No equilibrium found: the equations are singular to rounding.
  not_converged,          ///< No equilibrium found: the iteration does not converge.
  no_continuation,        ///< Truss: no quasi-static continuation; unstable slip or snap-through.
  several_continuations,  ///< Truss: statics allows several continuations.
  too_many_steps,         ///< Truss: the path needs too many steps.
  law_left_range,         ///< Dynamics: a contact law is evaluated outside its range.
  not_finite              ///< Dynamics: the time steps are too long.
};

/// "mechanism", "held_mechanism", …: the enumerator's name.
const char* to_string(FailureKind kind);

/// A node of a mode, and the coordinate direction ('x', 'y' or 'z') in which its motion is largest.
struct ModeNode {
  std::string node;
  char along;
  bool rotates = false;  ///< Its motion is a rotation about that direction.
};

/// The nodes with the largest motion in one mode.
using FailureMode = std::vector<ModeNode>;

/// Joint of a truss.
struct FailureJoint {
  std::string kind;  ///< "slider" or "revolute"
  std::string name;
};

/// A failure as fields. Fields that do not apply are empty.
struct FailureFields {
  FailureKind kind;
  std::vector<FailureJoint> joints = {};          ///< Joints that fail.
  std::vector<FailureMode> modes = {};            ///< Of a mechanism or of buckling.
  int mode_count = 0;                             ///< May exceed the number described in `modes`.
  bool more_modes = false;                        ///< There may be more than `mode_count`.
  std::optional<double> time = {};                ///< [s]
  std::optional<double> temperature_change = {};  ///< ΔT [K]; for a truss that of its first program
  /// The result that was not found, e.g. "no equilibrium of the drawn shape". Used for the kinds
  /// singular and not_converged, and in dynamics for too_many_steps.
  std::string sought = {};
  /// Message of the law or part of the program that detected the failure.
  std::string cause = {};
  /// Further numbers: name with unit, value.
  std::vector<std::pair<std::string, double>> numbers = {};
};

/// Sentence that describes a failure, composed from its fields. Only this function contains the
/// wording.
std::string sentence(const FailureFields& fields);

/// Remedy; "" if there is no general one.
std::string remedy(const FailureFields& fields);

/// The part of a failure's sentence that explains the reason; "" if there is no such part.
std::string cause(const FailureFields& fields);

/// Thrown if a model with valid input has no result. what() returns the sentence of the failure.
class Failure : public std::runtime_error {
 public:
  explicit Failure(FailureFields fields)
      : std::runtime_error(sentence(fields)), fields_(std::move(fields)) {}
  const FailureFields& fields() const { return fields_; }

 private:
  FailureFields fields_;
};

/// Thrown if the torsion spring of a linkage does not load the joint at the start, so the journal's
/// position within the play is undetermined.
class UnloadedJoint : public kernel::OutOfRange {
 public:
  using OutOfRange::OutOfRange;
};

}  // namespace statejump
