// SPDX-License-Identifier: GPL-3.0-or-later
// Beams between two bodies that they bend and rotate: one step of a bond.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "statejump/kernel/beam.hpp"
#include "statejump/kernel/beam_section.hpp"
#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/kernel/stable_step.hpp"
#include "statejump/stepper/link.hpp"

namespace statejump::stepper {

using kernel::BeamStep;

/// Rotation vector of a unit quaternion [rad], of the shorter way: at most π.
inline Vector3 rotation_vector(const Quaternion& turned) {
  const double sine = turned.vec().norm();
  if (sine == 0) return Vector3::Zero();
  const double half = std::atan2(sine, std::abs(turned.w()));
  return (turned.w() < 0 ? -2 : 2) * half / sine * turned.vec();
}

/// A beam and its state between steps; the attributes of BeamBond.
struct BeamBond {
  int id1 = -1;
  int id2 = -1;
  double axialStiffness = 0;                                         ///< E A [N]
  double torsionalStiffness = 0;                                     ///< G J [N m2]
  double bendingStiffnessY = 0;                                      ///< E I about y [N m2]
  double bendingStiffnessZ = 0;                                      ///< E I about z [N m2]
  double shearStiffnessY = std::numeric_limits<double>::infinity();  ///< k G A along y [N]
  double shearStiffnessZ = std::numeric_limits<double>::infinity();
  double stressFreeLength = 0;           ///< l0 [m]
  double thermalExpansion = 0;           ///< [1/K]
  double gradientY = 0;                  ///< along y, over the change of its program [1/m]
  double gradientZ = 0;                  ///< along z [1/m]
  double dampingRatio = 0;               ///< [-]
  Vector3 axisX = Vector3::Zero();       ///< in the reference configuration; zero: not yet set
  Vector3 axisY = Vector3::Zero();       ///< of the section, across axisX
  Vector3 offset1 = Vector3::Zero();     ///< from body 1 to its end, reference configuration [m]
  Vector3 offset2 = Vector3::Zero();     ///< from body 2 to its end [m]
  std::string released1 = {};            ///< letters of 'xXYZ', see releases()
  std::string released2 = {};            ///< of the second end
  double temperatureChange = 0;          ///< mean [K]
  double gradientTemperatureChange = 0;  ///< [K]
  Vector3 force1 = Vector3::Zero();      ///< section force at the first end [N]
  Vector3 moment1 = Vector3::Zero();     ///< section moment at the first end [N m]
  Vector3 force2 = Vector3::Zero();
  Vector3 moment2 = Vector3::Zero();
  double previousStressFreeLength = 0;                ///< [m]; 0 before the first step
  double previousLengthDerivative = 0;                ///< of the energy by the length [N]
  Vector3 previousCurvature = Vector3::Zero();        ///< about axes 2 and 3 of the frame [1/m]
  Vector3 previousCurvatureMoment = Vector3::Zero();  ///< of the energy by the curvatures [N m2/m]
  double previousTime = 0;                            ///< [s]
};

/// Letters of a release: x the axial force, X, Y and Z the moments about axes of the section.
constexpr const char* release_letters = "xXYZ";

inline bool are_releases(const std::string& letters) {
  return letters.find_first_not_of(release_letters) == std::string::npos;
}

inline std::array<bool, 4> releases(const std::string& letters) {
  std::array<bool, 4> made{};
  for (std::size_t i = 0; i < made.size(); ++i) {
    made[i] = letters.find(release_letters[i]) != std::string::npos;
  }
  return made;
}

/// The beam of a bond; `axisX` must be set.
inline kernel::PlacedBeam placed(const BeamBond& bond) {
  return kernel::placed({bond.axialStiffness,
                         bond.torsionalStiffness,
                         bond.bendingStiffnessY,
                         bond.bendingStiffnessZ,
                         bond.shearStiffnessY,
                         bond.shearStiffnessZ,
                         {{releases(bond.released1), releases(bond.released2)}}},
                        bond.axisX, bond.axisY);
}

/// Inverse mass and inverse moment of inertia of a body [1/kg, 1/(kg m2)]; 0: it cannot move or
/// rotate.
struct Mobility {
  double translation = 0;
  double rotation = 0;
};

/// Mobility of the end of a beam at an offset from its body, a bound: translation and rotation of
/// the end are coupled, and |a + b|² <= 2 (|a|² + |b|²).
inline Mobility at_offset(const Mobility& body, const Vector3& offset) {
  if (offset.isZero(0)) return body;
  return {body.translation + 2 * body.rotation * offset.squaredNorm(), 2 * body.rotation};
}

/// Largest eigenvalue of the modes of a beam between two free ends. Axial and torsional modes and
/// those of each plane do not share motions. In a plane, symmetric and antisymmetric bending share
/// rotations if the mobilities differ.
/// @param modes stiffness or damping of l, s₂, s₃, a₂, a₃, τ, >= 0
/// @param across stiffness or damping of the chord against rotation [N/m]
/// @param length of the chord [m]
inline double largest_rate(const BeamStep::Vector6& modes, double across, double length,
                           const Mobility& first, const Mobility& second) {
  const double translation = first.translation + second.translation;
  const double rotation = first.rotation + second.rotation;
  const double between = 0.25 * (first.rotation - second.rotation);
  double largest = std::max(modes[0] * translation, modes[5] * rotation);
  for (Eigen::Index k = 0; k < 2; ++k) {
    const double s = std::max(modes[1 + k], 0.0), a = std::max(modes[3 + k], 0.0);
    const double one = 0.25 * s * rotation;
    const double other = a * (translation / (length * length) + 0.25 * rotation);
    const double root = std::hypot(0.5 * (one - other), std::sqrt(s * a) * between);
    largest = std::max(largest, 0.5 * (one + other) + root + across * translation);
  }
  return largest;
}

/// Dashpots on the rates of the modes, c = 2 zeta sqrt(k m), with stiffness and mobility of the
/// unloaded beam.
/// @param reference BeamStep::mode_stiffness() of the unloaded beam
inline BeamStep::Vector6 mode_damping(double ratio, const BeamStep::Vector6& reference,
                                      double length, const Mobility& first,
                                      const Mobility& second) {
  const double translation = first.translation + second.translation;
  const double rotation = first.rotation + second.rotation;
  BeamStep::Vector6 made;
  for (Eigen::Index j = 0; j < 6; ++j) {
    const double mobility = j == 0   ? translation
                            : j == 5 ? rotation
                            : j < 3  ? 0.25 * rotation
                                     : translation / (length * length) + 0.25 * rotation;
    made[j] = mobility > 0 ? 2 * ratio * std::sqrt(reference[j] / mobility) : 0.0;
  }
  return made;
}

/// Stiffness of the modes without tension [N/m, N m].
inline BeamStep::Vector6 unloaded_stiffness(const kernel::Beam& beam, double length) {
  BeamStep::Vector6 made;
  made[0] = beam.axial / length;
  for (std::size_t k = 0; k < 2; ++k) {
    const double shear = 12 * beam.bending[k] / (beam.shear[k] * length * length);
    made[1 + static_cast<Eigen::Index>(k)] = 4 * beam.bending[k] / length;
    made[3 + static_cast<Eigen::Index>(k)] = 12 * beam.bending[k] / (length * (1 + shear));
  }
  made[5] = beam.torsional / length;
  return made;
}

/// A body at an end of a bond.
struct BondBody {
  const Vector3& position;
  const Vector3& velocity;
  const Vector3& spin;
  const Quaternion& orientation;
  Mobility mobility;
};

/// Forces and energies of a bond in one step.
struct BondStep {
  Vector3 force;    ///< on body 2; body 1 gets the opposite force [N]
  Vector3 moment1;  ///< on body 1 [N m]
  Vector3 moment2;  ///< on body 2
  double length;    ///< of the chord [m]
  double stress_free_length;
  double largest_rotation;  ///< see BeamStep::largest_local_rotation()
  bool buckles;             ///< see BeamStep::buckles()
  double stable_step;       ///< largest stable time step of this bond alone [s]
  double elastic;           ///< stored energy [J]; the others are increments
  double damping;
  double thermal_work;
  bool works;  ///< whether thermal_work is valid: false in the first step
};

/// Largest stable time step [s] of a bond alone, see kernel::critical_time_step().
inline double stable_step(const BeamStep& beam, const BeamStep::Vector6& damping,
                          const Mobility& first, const Mobility& second) {
  const double across = std::max(beam.tension(), 0.0) / beam.length();
  const double stiffness =
      largest_rate(beam.mode_stiffness(), across, beam.length(), first, second);
  return kernel::critical_time_step(1, stiffness,
                                    largest_rate(damping, 0, beam.length(), first, second));
}

/// One step of a bond. The forces follow from the energy W of the beam and the dashpots,
///  W' = (forces on the beam) velocities - (dashpots) rates + thermal work,
/// with the thermal work dW/dl_T dl_T + dW/dκ_T dκ_T - (dashpots) (thermal part of the rates).
/// @param temperature_change mean; @param gradient_change of the program of the gradients [K]
/// @param time [s]
inline BondStep bond_step(BeamBond& bond, const kernel::PlacedBeam& placed, const BondBody& one,
                          const BondBody& two, double temperature_change, double gradient_change,
                          double time) {
  const Vector3 arm1 = one.orientation * bond.offset1, arm2 = two.orientation * bond.offset2;
  kernel::BeamState state;
  state.along = (two.position + arm2) - (one.position + arm1);
  state.free_length = bond.stressFreeLength * (1 + bond.thermalExpansion * temperature_change);
  state.stretch = state.along.norm() - state.free_length;
  state.first = one.orientation;
  state.second = two.orientation;
  state.curvature =
      kernel::about_frame(placed.swapped, bond.thermalExpansion * bond.gradientZ * gradient_change,
                          -bond.thermalExpansion * bond.gradientY * gradient_change);
  const BeamStep beam(placed.beam, state);
  bond.temperatureChange = temperature_change;
  bond.gradientTemperatureChange = gradient_change;

  const Mobility first = at_offset(one.mobility, bond.offset1);
  const Mobility second = at_offset(two.mobility, bond.offset2);
  BeamStep::Vector6 damping =
      mode_damping(bond.dampingRatio, unloaded_stiffness(placed.beam, state.free_length),
                   state.free_length, first, second);
  for (Eigen::Index j = 0; j < 6; ++j) {
    if (!beam.has_mode(j)) damping[j] = 0;
  }
  // Thermal parts of the modes over the last step: of l by l_T, of s by -κ_T l_T/2. As in links,
  // the mean rate of the step belongs to the velocities, which are half a step old.
  BeamStep::Vector6 thermal = BeamStep::Vector6::Zero();
  const bool works = bond.previousStressFreeLength > 0;
  const double since = time - bond.previousTime;
  if (works) {
    thermal[0] = state.free_length - bond.previousStressFreeLength;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto place = static_cast<Eigen::Index>(k);
      thermal[1 + place] = 0.5 * (bond.previousCurvature[place] * bond.previousStressFreeLength -
                                  state.curvature[k] * state.free_length);
    }
  }
  BeamStep::Vector12 velocities;
  velocities << one.velocity + kernel::cross(one.spin, arm1), one.spin,
      two.velocity + kernel::cross(two.spin, arm2), two.spin;
  BeamStep::Vector6 rates = beam.mode_rates(velocities);
  if (works && since > 0) rates -= thermal / since;
  const BeamStep::Vector6 dashpots = damping.cwiseProduct(rates);

  const BeamStep::Vector12 in_frame = beam.gradient_in_frame() + beam.balance_in_frame(dashpots);
  const BeamStep::Vector12 sections = kernel::section_forces(placed.swapped, in_frame);
  bond.force1 = sections.segment<3>(0);
  bond.moment1 = sections.segment<3>(3);
  bond.force2 = sections.segment<3>(6);
  bond.moment2 = sections.segment<3>(9);
  const BeamStep::Vector12 world = beam.to_world(in_frame);

  BondStep step;
  step.force = -world.segment<3>(6);
  step.moment1 = -world.segment<3>(3) + kernel::cross(arm1, Vector3(-step.force));
  step.moment2 = -world.segment<3>(9) + kernel::cross(arm2, step.force);
  step.length = beam.length();
  step.stress_free_length = state.free_length;
  step.largest_rotation = beam.largest_local_rotation();
  step.buckles = beam.buckles();
  step.stable_step = stable_step(beam, damping, first, second);
  step.elastic = beam.energy();
  step.damping = dashpots.dot(rates) * since;
  const double by_length = beam.by_length();
  const Vector3 by_curvature(beam.by_curvature(0), beam.by_curvature(1), 0);
  const Vector3 curvature(state.curvature[0], state.curvature[1], 0);
  step.works = works;
  step.thermal_work =
      0.5 * (by_length + bond.previousLengthDerivative) * thermal[0] +
      0.5 * (by_curvature + bond.previousCurvatureMoment).dot(curvature - bond.previousCurvature) -
      dashpots.dot(thermal);
  if (!works) step.thermal_work = step.damping = 0;
  bond.previousStressFreeLength = state.free_length;
  bond.previousLengthDerivative = by_length;
  bond.previousCurvature = curvature;
  bond.previousCurvatureMoment = by_curvature;
  bond.previousTime = time;
  return step;
}

}  // namespace statejump::stepper
