// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "statejump/truss/joints/hinge_law.hpp"
#include "statejump/truss/joints/moment_curve.hpp"
#include "truss/joints/writer.hpp"

namespace statejump::truss {

namespace detail {

/// The parameters of a hinge: its own ones, then those of its law.
template <class Type>
std::vector<Parameter<Type>> with_hinge_law(std::vector<Parameter<Type>> own) {
  own.insert(own.end(), {
                            {"deadband_rad", "deadband", "rad", Allowed::not_negative, "the case",
                             &Type::deadband},
                            {"stiffness_N_m_per_rad", "stiffness", "N m/rad", Allowed::not_negative,
                             "the case", &Type::stiffness},
                            {"friction_moment_N_m", "friction_moment", "N m", Allowed::not_negative,
                             "the case", &Type::friction_moment},
                            {"friction_stiffness_N_m_per_rad", "friction_stiffness", "N m/rad",
                             Allowed::positive_or_infinite, "the case", &Type::friction_stiffness},
                            {"preload_moment_N_m", "preload_moment", "N m", Allowed::finite,
                             "the case", &Type::preload_moment},
                            {"axis", "axis", "-", Allowed::direction, "the case", &Type::axis},
                        });
  return own;
}

}  // namespace detail

template <class Type>
double HingeLaw<Type>::slipped(const Trial& trial) const {
  // Less the elastic rotation of sticking friction.
  const double bend = type().radius(trial) * trial.force[0] / friction_stiffness;
  return type().rotation(trial) - bend;
}

template <class Type>
double HingeLaw<Type>::beyond_play(double rotation) const {
  return rotation - std::clamp(rotation, -deadband, deadband);
}

template <class Type>
double HingeLaw<Type>::slack(const Trial& trial) const {
  if (type().moment_curve() == nullptr || !trial.damps_contact) return 0.0;
  return trial.slack_stiffness * std::pow(type().radius(trial), 2);
}

template <class Type>
Eigen::Vector3d HingeLaw<Type>::slack_motion(const Trial& trial) const {
  if (type().moment_curve() == nullptr) return Eigen::Vector3d::Zero();
  return type().radius(trial) * (type().rotation(trial) - trial.history[1]) * axis;
}

template <class Type>
typename HingeLaw<Type>::Law HingeLaw<Type>::evaluate_law(const Trial& trial, JointStatus status,
                                                          JointWriter& writer) const {
  const double rotation = type().rotation(trial);
  const double radius = type().radius(trial);
  const double force = trial.force[0];
  Law law{elastic_moment(rotation) + radius * force,
          std::abs(rotation) < deadband ? 0.0 : stiffness, 0.0, radius};
  if (const MomentCurve* curve = type().moment_curve()) law.tangent += curve->at(rotation).slope;
  if (const double held = slack(trial); held > 0.0) {
    law.moment += held * (rotation - trial.history[1]);
    law.tangent += held;
  }
  writer.carries(force);
  writer.carries(law.moment / radius);
  double corner = 0.0;
  switch (status) {
    case JointStatus::slip_plus:
    case JointStatus::slip_minus: {
      const double sense = status == JointStatus::slip_plus ? 1.0 : -1.0;
      writer.balance(0, force - sense * friction_moment / radius);
      corner = 1.0;
      break;
    }
    default:
      writer.closure(0, radius * (slipped(trial) - trial.history[0]));
      corner = -radius * radius / friction_stiffness;
      law.by_row = radius;
  }
  writer.corner(0, 0, corner);
  return law;
}

template <class Type>
JointStatus HingeLaw<Type>::decide(const Trial& trial, JointStatus status) const {
  const double force = trial.force[0];
  const double radius = type().radius(trial);
  if (status == JointStatus::stick) {
    const double bound = friction_moment / radius + trial.force_rounding;
    return force > bound    ? JointStatus::slip_plus
           : force < -bound ? JointStatus::slip_minus
                            : status;
  }
  const double sense = status == JointStatus::slip_plus ? 1.0 : -1.0;
  const double slid = radius * (slipped(trial) - trial.history[0]);
  const double rounding = slide_rounding(trial, trial.length_rounding, trial.force_rounding);
  if (sense * slid >= -rounding) return status;
  if (friction_moment > 0.0) return JointStatus::stick;
  // Without friction both directions of slip are admissible.
  return sense > 0.0 ? JointStatus::slip_minus : JointStatus::slip_plus;
}

template <class Type>
void HingeLaw<Type>::begin(const Trial& trial, JointStatus, double* now) const {
  now[0] = slipped(trial);
  now[1] = type().rotation(trial);
}

template <class Type>
void HingeLaw<Type>::commit(const Trial& trial, JointStatus status, double* after) const {
  begin(trial, status, after);
}

template <class Type>
double HingeLaw<Type>::slip(const Trial& trial, const double* after) const {
  return type().radius(trial) * (after[0] - trial.history[0]);
}

template <class Type>
double HingeLaw<Type>::dissipation(const Trial& trial, const double*, double slip) const {
  return friction_moment / type().radius(trial) * std::abs(slip);
}

template <class Type>
double HingeLaw<Type>::elastic_energy(const Trial& trial, const double* now) const {
  const double rotation = type().rotation(trial);
  const double beyond = beyond_play(rotation);
  const double bent = std::isinf(friction_stiffness)
                          ? 0.0
                          : 0.5 * friction_stiffness * std::pow(rotation - now[0], 2);
  const MomentCurve* curve = type().moment_curve();
  const double curved = curve != nullptr ? curve->at(rotation).energy : 0.0;
  return 0.5 * stiffness * beyond * beyond + preload_moment * rotation + curved + bent;
}

template <class Type>
double HingeLaw<Type>::elastic_moment(double rotation) const {
  const MomentCurve* curve = type().moment_curve();
  const double curved = curve != nullptr ? curve->at(rotation).moment : 0.0;
  return preload_moment + stiffness * beyond_play(rotation) + curved;
}

template <class Type>
std::array<double, 2> HingeLaw<Type>::beyond_edges(const Trial& trial) const {
  const double radius = type().radius(trial), rotation = type().rotation(trial);
  return {radius * (rotation - deadband), radius * (rotation + deadband)};
}

template <class Type>
void HingeLaw<Type>::describe(const Trial& trial, double* outputs) const {
  const double rotation = type().rotation(trial);
  outputs[0] = rotation;
  outputs[1] = elastic_moment(rotation) + type().radius(trial) * trial.force[0];
}

template <class Type>
double HingeLaw<Type>::slide_rounding(const Trial& trial, double length, double force) const {
  // Equal rounding errors of displacements rotate a shorter lever by a larger angle.
  return length * type().turning_ratio(trial) +
         std::pow(type().radius(trial), 2) * force / friction_stiffness;
}

template <class Type>
bool HingeLaw<Type>::remembers_when(JointStatus before, JointStatus after) const {
  return friction_moment > 0.0 && is_slip(before) &&
         (after == JointStatus::stick || is_slip(after));
}

template <class Type>
std::optional<LocalContact> HingeLaw<Type>::contact(const Trial& trial, JointStatus) const {
  return LocalContact{0, -1, 1.0, friction_moment / type().radius(trial)};
}

}  // namespace statejump::truss
