// SPDX-License-Identifier: GPL-3.0-or-later
// The ODE of a Linkage, for its integrators; not installed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <variant>

#include "statejump/failure.hpp"
#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/linkage/run.hpp"
#include "statejump/thermal/program.hpp"

namespace statejump::linkage::detail {

/// Indices in the state vector after the tips' positions (AB 0 and 1, BC 2 and 3) and their
/// velocities (4 to 7).
enum Component : std::size_t {
  thermal_work = 8,
  axial_heat = 9,
  pin_heat = 10,
  friction_heat = 11,  ///< of a friction law without memory
  impact_heat = 12,
  slide = 13,  ///< of journal relative to bearing in this step; for a friction law with memory
};

/// Terms of the most frequent case: links and elastic contact only, without couples on the links.
struct BasicTerms {
  static constexpr bool all_terms = false;
  using Vector = std::array<double, 10>;
};

/// All terms.
struct AllTerms {
  static constexpr bool all_terms = true;
  using Vector = std::array<double, 14>;
};

struct LinkConstants {
  double pin_x, length, expansion, rigidity, inverse_rigidity, inverse_mass, damping;
};

/// Angular frequency of the axial motion at ΔT = 0 [rad/s].
inline double angular_frequency(const LinkConstants& link) {
  return std::sqrt(link.rigidity / link.length * link.inverse_mass);
}

/// A Linkage with its constants over a run precomputed.
struct Constants {
  LinkConstants ab, bc;
  kernel::ElasticPair pair;
  double r1, r2, r1_rate, r2_rate;  // radius and its derivative by ΔT
  kernel::laws::JointLaw law;
  double pin_damping, torsion, free_angle;
  bool friction, friction_has_memory, dissipation, couples, expanding;
  bool all_terms() const { return couples || dissipation; }
};

/// Does not check the model.
Constants constants(const Linkage& model);

struct Temperature {
  double change, rate;
};

/// A branch of the temperature program with its slope precomputed.
struct Trajectory {
  const thermal::Branch& branch;
  double slope;  // [K/s], if the branch is straight

  explicit Trajectory(const thermal::Branch& b)
      : branch(b), slope((b.end - b.start) / (b.end_time - b.start_time)) {}

  Temperature operator()(double time) const {
    if (branch.angular_frequency == 0.0) {
      return {branch.start + slope * (time - branch.start_time), slope};
    }
    const double size = std::copysign(branch.amplitude, branch.end - branch.start);
    const double angle = branch.angular_frequency * (time - branch.zero_time);
    return {size * std::sin(angle), size * branch.angular_frequency * std::cos(angle)};
  }
};

/// Thrown when the state is no longer finite.
struct NotFinite : std::domain_error {
  NotFinite() : std::domain_error("the state is not finite") {}
};

struct Radii {
  double journal, bearing;
  double clearance() const { return bearing - journal; }
};

inline Radii radii_at(const Constants& k, double temperature_change) {
  return {k.r1 + k.r1_rate * temperature_change, k.r2 + k.r2_rate * temperature_change};
}

inline kernel::laws::NormalState normal_state(const Constants& k, double depth,
                                              const Radii& radii) {
  if (!std::isfinite(depth)) throw NotFinite();
  return kernel::laws::evaluate(k.law.normal, depth,
                                {radii.journal, radii.bearing, k.law.contact_length},
                                {k.pair.effective_young_modulus});
}

struct ContactPoint {
  double nx, ny, depth, approach_speed;
};

/// The difference |d|² − c², computed without a square root. It is positive in contact.
template <class Terms>
double overlap(const Constants& k, const typename Terms::Vector& y, double temperature_change) {
  const double c = radii_at(k, temperature_change).clearance();
  const double dx = y[2] - y[0];
  const double dy = y[3] - y[1];
  return dx * dx + dy * dy - c * c;
}

template <class Terms>
ContactPoint contact_point(const Constants& k, const typename Terms::Vector& y,
                           const Temperature& heat, const Radii& radii) {
  const double dx = y[2] - y[0];
  const double dy = y[3] - y[1];
  const double distance = std::sqrt(dx * dx + dy * dy);
  const double inverse = distance > 0.0 ? 1.0 / distance : 0.0;
  const double nx = dx * inverse;
  const double ny = dy * inverse;
  const double closing = nx * (y[6] - y[4]) + ny * (y[7] - y[5]);
  return {nx, ny, distance - radii.clearance(), closing - (k.r2_rate - k.r1_rate) * heat.rate};
}

struct NormalForce {
  kernel::laws::NormalState elastic;
  double force;  ///< with dissipation
};

/// @param impact_speed approach speed at the start of contact; 0: contact starts now
inline NormalForce normal_force(const Constants& k, const ContactPoint& at, const Radii& radii,
                                double impact_speed) {
  const kernel::laws::NormalState elastic = normal_state(k, at.depth, radii);
  if (!k.dissipation) return {elastic, elastic.force};
  const double speed = impact_speed > 0.0 ? impact_speed : at.approach_speed;
  return {elastic, kernel::laws::damped_force(elastic.force, damping_ratio(k.law, speed),
                                              at.approach_speed)};
}

struct TurnRates {
  double ab, bc;
};

template <class Terms>
TurnRates turn_rates(const Constants& k, const typename Terms::Vector& y) {
  const double bx = y[2] - k.bc.pin_x;
  return {(y[0] * y[5] - y[1] * y[4]) / (y[0] * y[0] + y[1] * y[1]),
          (bx * y[7] - y[3] * y[6]) / (bx * bx + y[3] * y[3])};
}

/// The planar contact in the form that the kernel's tangential velocity laws expect.
template <class Terms>
struct SpatialContact {
  kernel::JointContact contact;
  kernel::BodyMotion journal, bearing;

  SpatialContact(const typename Terms::Vector& y, const ContactPoint& at, const Radii& radii,
                 const TurnRates& turn) {
    const kernel::Vector3 normal(at.nx, at.ny, 0.0);
    journal = {{y[2], y[3], 0.0}, {y[6], y[7], 0.0}, {0.0, 0.0, turn.bc}};
    bearing = {{y[0], y[1], 0.0}, {y[4], y[5], 0.0}, {0.0, 0.0, turn.ab}};
    contact.penetration_depth = at.depth;
    contact.normal = normal;
    contact.arm_1 = (radii.journal - 0.5 * at.depth) * normal;
    contact.arm_2 = (radii.bearing + 0.5 * at.depth) * normal;
    contact.relative_velocity =
        material_velocity(journal, contact.arm_1) - material_velocity(bearing, contact.arm_2);
    contact.effective_radius = 0.0;  // the normal laws use the two radii
    contact.eccentricity = at.depth + radii.clearance();
  }
};

inline const kernel::Vector3& joint_axis() {
  static const kernel::Vector3 z = kernel::Vector3::UnitZ();
  return z;
}

/// Speed [m/s] of the journal relative to the bearing along (−n_y, n_x), according to the
/// tangential velocity law.
template <class Terms>
double sliding_speed(const Constants& k, const SpatialContact<Terms>& spatial,
                     const ContactPoint& at) {
  const kernel::Vector3 v = std::visit(
      [&](const auto& law) {
        return law.velocity(spatial.contact, spatial.journal, spatial.bearing, joint_axis());
      },
      k.law.tangential_velocity);
  return -at.ny * v.x() + at.nx * v.y();
}

/// Friction force; its first component acts along (−n_y, n_x).
/// @param motion slide of the step [m] for a law with memory (dissipation in J), otherwise speed
/// [m/s] (dissipation in W)
inline kernel::laws::FrictionResponse friction(const Constants& k, const NormalForce& normal,
                                               double motion, kernel::ContactHistory& history) {
  return kernel::laws::evaluate(
      k.law.friction, k.law.friction_parameters,
      {normal.force, kernel::laws::tangential_stiffness(k.pair, normal.elastic.stiffness),
       kernel::Vector3(motion, 0.0, 0.0), 1.0, kernel::Vector3::UnitY()},
      history);
}

/// Direction, length and axial force of one link.
struct LinkForces {
  double ux, uy, inverse_length, fx, fy;
};

template <class Vector>
LinkForces link_forces(const LinkConstants& k, double x, double y, double vx, double vy,
                       const Temperature& heat, Vector& rate) {
  const double rx = x - k.pin_x;
  const double length = std::sqrt(rx * rx + y * y);
  const double inverse = 1.0 / length;
  const double ux = rx * inverse;
  const double uy = y * inverse;
  const double free = k.length + k.expansion * heat.change;
  const double free_rate = k.expansion * heat.rate;
  const double tension = k.rigidity / free * (length - free);
  const double strain_rate = ux * vx + uy * vy - free_rate;
  const double dashpot = k.damping * strain_rate;
  const double pull = tension + dashpot;
  rate[thermal_work] -= (pull + 0.5 * tension * tension * k.inverse_rigidity) * free_rate;
  rate[axial_heat] += dashpot * strain_rate;
  return {ux, uy, inverse, -pull * ux, -pull * uy};
}

/// ∂V/∂ΔT [J/K] of the normal law at fixed depth due to expanding radii, as central difference over
/// 0.01 K. Its error, 1e-9 of V per kelvin, affects only the energy balance.
double radii_energy_rate(const Constants& k, double depth, double temperature_change);

/// Forces and couples of the contact on the two links.
struct ContactEffect {
  double fx = 0.0, fy = 0.0;                ///< on the bearing [N]; the journal gets the opposite
  double couple_ab = 0.0, couple_bc = 0.0;  ///< [N m]
};

/// Contact forces on the links; adds to the energy rates. Separate, so that rates() is short for an
/// open joint.
template <class Terms>
[[gnu::noinline]] ContactEffect contact_effect(const Constants& k, const typename Terms::Vector& y,
                                               const Temperature& heat, const State& memory,
                                               const TurnRates& turn,
                                               typename Terms::Vector& rate) {
  const Radii radii = radii_at(k, heat.change);
  const ContactPoint at = contact_point<Terms>(k, y, heat, radii);
  const NormalForce normal = normal_force(k, at, radii, memory.impact_speed);
  ContactEffect effect;
  effect.fx = normal.force * at.nx;
  effect.fy = normal.force * at.ny;
  if (k.expanding) {
    rate[thermal_work] +=
        (radii_energy_rate(k, at.depth, heat.change) - normal.force * (k.r2_rate - k.r1_rate)) *
        heat.rate;
  }
  if constexpr (Terms::all_terms) {
    rate[impact_heat] = (normal.force - normal.elastic.force) * at.approach_speed;
    if (k.friction) {
      const SpatialContact<Terms> spatial(y, at, radii, turn);
      const double speed = sliding_speed(k, spatial, at);
      rate[slide] = speed;
      kernel::ContactHistory trial = memory.contact;
      const kernel::laws::FrictionResponse answer =
          friction(k, normal, k.friction_has_memory ? y[slide] : speed, trial);
      if (!k.friction_has_memory) rate[friction_heat] = answer.dissipation;
      const double force = answer.force_on_1.x();
      const kernel::Vector3 on_journal(-at.ny * force, at.nx * force, 0.0);
      const kernel::Wrench wrench = std::visit(
          [&](const auto& law) { return law.wrench(spatial.contact, on_journal, joint_axis()); },
          k.law.tangential_velocity);
      effect.fx -= wrench.force_1.x();
      effect.fy -= wrench.force_1.y();
      effect.couple_bc = wrench.torque_1.z();
      effect.couple_ab = wrench.torque_2.z();
    }
  }
  return effect;
}

template <class Terms>
void rates(const Constants& k, const typename Terms::Vector& y, const Temperature& heat,
           const State& memory, typename Terms::Vector& rate) {
  for (std::size_t i = thermal_work; i < rate.size(); ++i) rate[i] = 0.0;
  LinkForces ab = link_forces(k.ab, y[0], y[1], y[4], y[5], heat, rate);
  LinkForces bc = link_forces(k.bc, y[2], y[3], y[6], y[7], heat, rate);
  TurnRates turn{};
  if constexpr (Terms::all_terms) {
    turn = {(ab.ux * y[5] - ab.uy * y[4]) * ab.inverse_length,
            (bc.ux * y[7] - bc.uy * y[6]) * bc.inverse_length};
  }
  ContactEffect joint;
  if (overlap<Terms>(k, y, heat.change) > 0.0) {
    joint = contact_effect<Terms>(k, y, heat, memory, turn, rate);
    ab.fx += joint.fx;
    ab.fy += joint.fy;
    bc.fx -= joint.fx;
    bc.fy -= joint.fy;
  }
  if constexpr (Terms::all_terms) {
    double moment = 0.0;
    if (k.torsion > 0.0) {
      moment =
          k.torsion *
          (std::atan2(ab.ux * bc.uy - ab.uy * bc.ux, ab.ux * bc.ux + ab.uy * bc.uy) - k.free_angle);
    }
    rate[pin_heat] = k.pin_damping * (turn.ab * turn.ab + turn.bc * turn.bc);
    const double across_ab =
        (joint.couple_ab + moment - k.pin_damping * turn.ab) * ab.inverse_length;
    const double across_bc =
        (joint.couple_bc - moment - k.pin_damping * turn.bc) * bc.inverse_length;
    ab.fx -= across_ab * ab.uy;
    ab.fy += across_ab * ab.ux;
    bc.fx -= across_bc * bc.uy;
    bc.fy += across_bc * bc.ux;
  }
  rate[0] = y[4];
  rate[1] = y[5];
  rate[2] = y[6];
  rate[3] = y[7];
  rate[4] = ab.fx * k.ab.inverse_mass;
  rate[5] = ab.fy * k.ab.inverse_mass;
  rate[6] = bc.fx * k.bc.inverse_mass;
  rate[7] = bc.fy * k.bc.inverse_mass;
}

template <class Terms>
typename Terms::Vector pack(const State& state) {
  typename Terms::Vector y{};
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto j = static_cast<std::size_t>(i);
    y[j] = state.bearing_centre[i];
    y[2 + j] = state.journal_centre[i];
    y[4 + j] = state.bearing_velocity[i];
    y[6 + j] = state.journal_velocity[i];
  }
  return y;
}

/// Copies positions and velocities; the friction history stays.
template <class Vector>
void unpack(const Vector& y, State& state) {
  state.bearing_centre = {y[0], y[1]};
  state.journal_centre = {y[2], y[3]};
  state.bearing_velocity = {y[4], y[5]};
  state.journal_velocity = {y[6], y[7]};
}

template <class Terms>
Account account(const typename Terms::Vector& y, double remembered_friction_heat) {
  Account result{y[thermal_work], y[axial_heat], 0.0, remembered_friction_heat, 0.0};
  if constexpr (Terms::all_terms) {
    result.pin_dissipation = y[pin_heat];
    result.friction_dissipation += y[friction_heat];
    result.impact_dissipation = y[impact_heat];
  }
  return result;
}

/// The failure with time and temperature appended to the message.
Failure failure(const std::domain_error& error, double time, double temperature_change);

/// Thermal work − dissipation − change of energy [J].
double energy_residue(const Linkage& model, const Sample& begin, const Sample& end);

}  // namespace statejump::linkage::detail
