// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/linkage_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <stdexcept>

#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/hertz.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump {

using kernel::require;
using kernel::ThermalBranch;

namespace {

/// Tip positions 0–3 (AB, BC), velocities 4–7, thermal work 8, axial and pin heat 9 and 10, slide
/// of journal against bearing in this step 11.
using Vector = std::array<double, 12>;

struct LinkConstants {
  double pin_x, length, expansion, rigidity, inverse_mass, damping;
};

/// A Linkage with everything computed that does not change during a run.
struct Constants {
  LinkConstants ab, bc;
  kernel::ElasticPair pair;
  double r1, r2, r1_rate, r2_rate;  // radius and its derivative by ΔT
  double sign;                      // of R1 in the curvature's denominator
  double mu, pin_damping, torsion, free_angle;
  bool friction, couples, expanding;
};

LinkConstants constants(const ThermalLink& link, double pin_x, double ratio) {
  const double rigidity = link.young_modulus * link.cross_section_area;
  const double mass = link.mass / 3.0;
  return {pin_x,
          link.stress_free_length,
          link.stress_free_length * link.thermal_expansion,
          rigidity,
          1.0 / mass,
          2.0 * ratio * std::sqrt(rigidity / link.stress_free_length * mass)};
}

Constants constants(const Linkage& m) {
  Constants k;
  k.ab = constants(m.link_ab, 0.0, m.axial_damping_ratio);
  k.bc = constants(m.link_bc, m.frame_length, m.axial_damping_ratio);
  k.pair = kernel::elastic_pair(m.link_bc.young_modulus, m.link_bc.poisson_ratio,
                                m.link_ab.young_modulus, m.link_ab.poisson_ratio);
  k.r1 = m.journal_radius;
  k.r2 = m.bearing_radius;
  k.r1_rate = k.r1 * m.journal_thermal_expansion;
  k.r2_rate = k.r2 * m.bearing_thermal_expansion;
  k.sign = m.contact_radius == ContactRadius::internal ? -1.0 : 1.0;
  k.mu = m.friction_coefficient;
  k.pin_damping = m.pin_damping;
  k.torsion = m.torsion_stiffness;
  k.free_angle = m.free_angle();
  k.friction = m.friction == JointFriction::mindlin && k.mu > 0.0;
  k.couples = k.friction || k.pin_damping > 0.0 || k.torsion > 0.0;
  k.expanding = k.r1_rate != 0.0 || k.r2_rate != 0.0;
  return k;
}

struct Temperature {
  double change, rate;
};

Temperature temperature(const ThermalBranch& branch, double t) {
  if (branch.angular_frequency == 0.0) {
    const double rate = (branch.end - branch.start) / (branch.end_time - branch.start_time);
    return {branch.start + rate * (t - branch.start_time), rate};
  }
  const double size = std::copysign(branch.amplitude, branch.end - branch.start);
  const double angle = branch.angular_frequency * (t - branch.zero_time);
  return {size * std::sin(angle), size * branch.angular_frequency * std::cos(angle)};
}

/// Direction, length and axial force of one link.
struct LinkForces {
  double ux, uy, inverse_length, fx, fy, turn_rate;
};

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
  rate[8] -= (pull + 0.5 * tension * tension / k.rigidity) * free_rate;
  rate[9] += dashpot * strain_rate;
  return {ux, uy, inverse, -pull * ux, -pull * uy, (ux * vy - uy * vx) * inverse};
}

/// Tangential force on the journal; updates the history it is given.
kernel::MindlinEnergy friction(const Constants& k, double contact_radius, double normal_force,
                               double slide, kernel::ContactHistory& history) {
  return kernel::mindlin_step(
      kernel::mindlin_stiffness(k.pair.effective_shear_modulus, contact_radius),
      k.mu * normal_force, kernel::Vector3(slide, 0.0, 0.0), history);
}

struct Joint {
  double depth_squared;  // |d|² − c²: in contact where > 0, without a root
  double r1, r2, c;
};

inline Joint joint(const Constants& k, const Vector& y, double heat) {
  const double r1 = k.r1 + k.r1_rate * heat;
  const double r2 = k.r2 + k.r2_rate * heat;
  const double c = r2 - r1;
  const double dx = y[2] - y[0];
  const double dy = y[3] - y[1];
  return {dx * dx + dy * dy - c * c, r1, r2, c};
}

kernel::HertzState normal(const Constants& k, const Joint& at, double distance) {
  const double radius = at.r1 * at.r2 / (at.r2 + k.sign * at.r1);
  return kernel::hertz(k.pair.effective_young_modulus, radius, distance - at.c);
}

void rates(const Constants& k, const Vector& y, const Temperature& heat,
           const kernel::ContactHistory& history, Vector& rate) {
  rate[8] = rate[9] = rate[10] = rate[11] = 0.0;
  LinkForces ab = link_forces(k.ab, y[0], y[1], y[4], y[5], heat, rate);
  LinkForces bc = link_forces(k.bc, y[2], y[3], y[6], y[7], heat, rate);
  double couple_ab = 0.0;
  double couple_bc = 0.0;
  const Joint at = joint(k, y, heat.change);
  if (at.depth_squared > 0.0) {
    const double dx = y[2] - y[0];
    const double dy = y[3] - y[1];
    const double distance = std::sqrt(dx * dx + dy * dy);
    const double nx = dx / distance;
    const double ny = dy / distance;
    const kernel::HertzState hertz = normal(k, at, distance);
    double fx = hertz.force * nx;  // on the bearing
    double fy = hertz.force * ny;
    if (k.expanding) {
      const double sum = at.r2 + k.sign * at.r1;
      const double radius_rate =
          (k.r1_rate * at.r2 * at.r2 + k.sign * k.r2_rate * at.r1 * at.r1) / (sum * sum);
      rate[8] += (0.5 * hertz.elastic_energy * sum / (at.r1 * at.r2) * radius_rate -
                  hertz.force * (k.r2_rate - k.r1_rate)) *
                 heat.rate;
    }
    if (k.friction) {
      const double half = 0.5 * (distance - at.c);
      const double arm_1 = at.r1 - half;
      const double arm_2 = at.r2 + half;
      rate[11] =
          -ny * (y[6] - y[4]) + nx * (y[7] - y[5]) + bc.turn_rate * arm_1 - ab.turn_rate * arm_2;
      kernel::ContactHistory trial = history;
      friction(k, hertz.contact_radius, hertz.force, y[11], trial);
      const double force = trial.tangential_force.x();  // on the journal along (−ny, nx)
      fx += force * ny;
      fy -= force * nx;
      couple_bc = arm_1 * force;
      couple_ab = -arm_2 * force;
    }
    ab.fx += fx;
    ab.fy += fy;
    bc.fx -= fx;
    bc.fy -= fy;
  }
  if (k.couples) {
    if (k.torsion > 0.0) {
      const double moment =
          k.torsion *
          (std::atan2(ab.ux * bc.uy - ab.uy * bc.ux, ab.ux * bc.ux + ab.uy * bc.uy) - k.free_angle);
      couple_ab += moment;
      couple_bc -= moment;
    }
    couple_ab -= k.pin_damping * ab.turn_rate;
    couple_bc -= k.pin_damping * bc.turn_rate;
    rate[10] = k.pin_damping * (ab.turn_rate * ab.turn_rate + bc.turn_rate * bc.turn_rate);
    const double across_ab = couple_ab * ab.inverse_length;
    const double across_bc = couple_bc * bc.inverse_length;
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

Vector step(const Constants& k, const ThermalBranch& branch, double t, double h, const Vector& y,
            const kernel::ContactHistory& history) {
  Vector k1, k2, k3, k4, stage;
  const Temperature middle = temperature(branch, t + 0.5 * h);
  rates(k, y, temperature(branch, t), history, k1);
  for (std::size_t i = 0; i < y.size(); ++i) stage[i] = y[i] + 0.5 * h * k1[i];
  rates(k, stage, middle, history, k2);
  for (std::size_t i = 0; i < y.size(); ++i) stage[i] = y[i] + 0.5 * h * k2[i];
  rates(k, stage, middle, history, k3);
  for (std::size_t i = 0; i < y.size(); ++i) stage[i] = y[i] + h * k3[i];
  rates(k, stage, temperature(branch, t + h), history, k4);
  for (std::size_t i = 0; i < y.size(); ++i) {
    stage[i] = y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
  }
  return stage;
}

/// Root of |d| = c within a step that starts out of contact, by bisection on its length.
FirstContact locate(const Constants& k, const ThermalBranch& branch, double t, double h,
                    const Vector& y) {
  double before = 0.0;
  double after = h;
  for (int i = 0; i < 60; ++i) {
    const double tau = 0.5 * (before + after);
    const Vector at = step(k, branch, t, tau, y, {});
    const bool touches = joint(k, at, temperature(branch, t + tau).change).depth_squared > 0.0;
    (touches ? after : before) = tau;
  }
  return {t + after, temperature(branch, t + after).change};
}

LinkageState unpack(const Vector& y, const kernel::ContactHistory& history) {
  LinkageState state;
  state.bearing_centre = {y[0], y[1]};
  state.journal_centre = {y[2], y[3]};
  state.bearing_velocity = {y[4], y[5]};
  state.journal_velocity = {y[6], y[7]};
  state.contact = history;
  return state;
}

}  // namespace

LinkageRun simulate(const Linkage& model, const kernel::ThermalProgram& program,
                    const LinkageState& start, const LinkageRunOptions& options) {
  model.validate();
  program.validate();
  require(options.steps >= 1, "steps", options.steps, ">= 1");
  require(options.sample_every >= 0, "sample_every", options.sample_every, ">= 0");

  const Constants k = constants(model);
  kernel::ContactHistory history = start.contact;
  double friction_heat = 0.0;
  Vector y = {start.bearing_centre.x(),
              start.bearing_centre.y(),
              start.journal_centre.x(),
              start.journal_centre.y(),
              start.bearing_velocity.x(),
              start.bearing_velocity.y(),
              start.journal_velocity.x(),
              start.journal_velocity.y(),
              0.0,
              0.0,
              0.0,
              0.0};
  LinkageRun run;
  const auto record = [&](double time, double heat) {
    run.samples.push_back({time, heat, unpack(y, history), {y[8], y[9], y[10], friction_heat}});
  };
  double heat = program.temperature_change(0.0);
  double time = 0.0;
  record(time, heat);
  bool touching = joint(k, y, heat).depth_squared > 0.0;
  if (touching) run.first_contact = FirstContact{time, heat};

  long done = 0;
  for (const ThermalBranch& branch : kernel::monotone_branches(program)) {
    const double length = branch.end_time - branch.start_time;
    const long steps = std::max(1L, std::lround(options.steps * (length / program.duration())));
    const double h = length / static_cast<double>(steps);
    for (long i = 0; i < steps; ++i) {
      const double from = branch.start_time + static_cast<double>(i) * h;
      const Vector next = step(k, branch, from, h, y, history);
      const bool last = i + 1 == steps;
      time = last ? branch.end_time : from + h;
      heat = last ? branch.end : temperature(branch, time).change;
      const Joint at = joint(k, next, heat);
      if (!std::isfinite(at.depth_squared)) {
        char text[160];
        std::snprintf(text, sizeof text,
                      "eccentricity = %g m^2 over clearance^2 at time = %.9g s, "
                      "temperature_change = %.9g K: not finite, take more steps",
                      at.depth_squared, time, heat);
        throw std::domain_error(text);
      }
      const bool touches = at.depth_squared > 0.0;
      if (touches && !touching) {
        ++run.contacts;
        if (!run.first_contact) run.first_contact = locate(k, branch, from, h, y);
      }
      if (k.friction && (touches || touching)) {
        const double distance = std::sqrt(at.depth_squared + at.c * at.c);
        const kernel::HertzState hertz = normal(k, at, touches ? distance : 0.0);
        friction_heat +=
            friction(k, hertz.contact_radius, hertz.force, next[11], history).dissipation;
        if (!touches) history = {};
      }
      y = next;
      y[11] = 0.0;
      touching = touches;
      ++done;
      if (options.sample_every > 0 && done % options.sample_every == 0) record(time, heat);
    }
  }
  if (run.samples.back().time != time) record(time, heat);
  const LinkageSample& end = run.samples.back();
  const LinkageSample& begin = run.samples.front();
  const LinkageAccount& account = end.account;
  run.energy_residue = account.thermal_work - account.axial_dissipation - account.pin_dissipation -
                       account.friction_dissipation -
                       (energy(model, end.state, end.temperature_change).sum() -
                        energy(model, begin.state, begin.temperature_change).sum());
  return run;
}

}  // namespace statejump
