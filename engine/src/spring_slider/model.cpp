// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/spring_slider/model.hpp"

#include <algorithm>
#include <cmath>

#include "statejump/kernel/require.hpp"

namespace statejump::spring_slider {

using kernel::require;

void SpringSlider::validate() const {
  require(std::isfinite(young_modulus) && young_modulus > 0.0, "young_modulus", young_modulus,
          "finite, > 0 Pa");
  require(std::isfinite(cross_section_area) && cross_section_area > 0.0, "cross_section_area",
          cross_section_area, "finite, > 0 m^2");
  require(std::isfinite(stress_free_length) && stress_free_length > 0.0, "stress_free_length",
          stress_free_length, "finite, > 0 m");
  require(std::isfinite(thermal_expansion), "thermal_expansion", thermal_expansion, "finite [1/K]");
  require(friction_force >= 0.0 && friction_force < axial_rigidity(), "friction_force",
          friction_force, ">= 0 N and below young_modulus * cross_section_area");
  const bool minus_ok = clearance_minus > 0.0 &&
                        (clearance_minus < stress_free_length || std::isinf(clearance_minus));
  require(minus_ok, "clearance_minus", clearance_minus,
          "> 0 m and below stress_free_length, or infinity");
  require(clearance_plus > 0.0, "clearance_plus", clearance_plus, "> 0 m, or infinity");
  require(std::isfinite(preload_stiffness) && preload_stiffness >= 0.0, "preload_stiffness",
          preload_stiffness, "finite, >= 0 N/m");
  require(std::abs(preload_force) + friction_force < axial_rigidity(), "preload_force",
          preload_force, "of a size below young_modulus * cross_section_area - friction_force [N]");
  require(stop_stiffness > 0.0, "stop_stiffness", stop_stiffness, "> 0 N/m, or infinity");
  require(std::isfinite(play) && play >= 0.0, "play", play, "finite, >= 0 m");
  require(play == 0.0 || friction_force > 0.0, "play", play, "0 m without friction_force");
}

namespace {

/// Position [m] at ΔT = 0 in which friction balances a load [N]. If a stop is in its way, the
/// position is there.
double rest_under(const SpringSlider& model, double load) {
  const double stiffness = link_stiffness(model, 0.0) + model.preload_stiffness;
  const double excess = -model.preload_force - load;
  const double slid = excess == 0.0 ? 0.0 : excess / stiffness;  // not −0
  const int region = region_of(model, slid);
  if (region == 0) return std::clamp(slid, -model.clearance_minus, model.clearance_plus);
  const double clearance = region * model.clearance(region);
  return clearance + (excess - stiffness * clearance) / (stiffness + model.stop_stiffness);
}

/// Friction force needed at ΔT = 0 [N], without rigid stops.
double load_at(const SpringSlider& model, double x) {
  const SpringSlider pressed = in_region(model, region_of(model, x));
  return -pressed.preload_force - (link_stiffness(model, 0.0) + pressed.preload_stiffness) * x;
}

/// From the middle of the play the block moves until friction balances its load.
Start start_in_play(const SpringSlider& model) {
  const double half = 0.5 * model.play;
  const double free = rest_under(model, 0.0);
  if (std::abs(free) <= half) return {free, 0.0, 0.0};
  const double end = std::copysign(half, free);
  const double held = load_at(model, end);
  if (std::abs(held) <= model.friction_force) return {end, held, 0.0};
  const double load = std::copysign(model.friction_force, free);
  const double slid = rest_under(model, load);
  return {slid, load, slid - end};
}

}  // namespace

Start start_of(const SpringSlider& model) {
  if (model.start_friction == StartFriction::frictionless) {
    const double x = rest_under(model, 0.0);
    return {x, 0.0, x};
  }
  if (model.play > 0.0) return start_in_play(model);
  const double load = std::clamp(-model.preload_force, -model.friction_force, model.friction_force);
  const double x = rest_under(model, load);
  return {x, load, x};
}

double free_length(const SpringSlider& model, double temperature_change) {
  return thermal::length(model.stress_free_length, model.thermal_expansion, temperature_change);
}

double thermal_displacement(const SpringSlider& model, double temperature_change) {
  return model.stress_free_length * model.thermal_expansion * temperature_change;
}

double link_stiffness(const SpringSlider& model, double temperature_change) {
  return model.axial_rigidity() / free_length(model, temperature_change);
}

double axial_force(const SpringSlider& model, double temperature_change, double displacement) {
  return link_stiffness(model, temperature_change) *
         (thermal_displacement(model, temperature_change) - displacement);
}

double start_load(const SpringSlider& model) {
  return start_of(model).load;
}

double start_displacement(const SpringSlider& model) {
  return start_of(model).displacement;
}

SpringSlider in_region(const SpringSlider& model, int region) {
  if (region == 0) return model;
  SpringSlider made = model;
  made.preload_force -= model.stop_stiffness * region * model.clearance(region);
  made.preload_stiffness += model.stop_stiffness;
  made.clearance_minus = made.clearance_plus = std::numeric_limits<double>::infinity();
  return made;
}

int region_of(const SpringSlider& model, double displacement) {
  if (!model.has_soft_stops()) return 0;
  return displacement > model.clearance_plus ? 1 : displacement < -model.clearance_minus ? -1 : 0;
}

double sliding_displacement(const SpringSlider& model, double temperature_change, int direction) {
  const double rigidity = model.axial_rigidity();
  const double length = free_length(model, temperature_change);
  return (rigidity * thermal_displacement(model, temperature_change) -
          (direction * model.friction_force + model.preload_force) * length) /
         (rigidity + model.preload_stiffness * length);
}

double sliding_temperature(const SpringSlider& model, double displacement, int direction) {
  // The equation E A (x_T − x) = g l_T with g = s f + P + k_p x is linear in ΔT, because x_T = l0 α
  // ΔT and l_T = l0 + x_T.
  const double rigidity = model.axial_rigidity();
  const double force = direction * model.friction_force + model.preload_force +
                       model.preload_stiffness * displacement;
  const double slope = model.stress_free_length * model.thermal_expansion * (rigidity - force);
  if (slope == 0.0 || force >= rigidity) return std::numeric_limits<double>::quiet_NaN();
  return (rigidity * displacement + force * model.stress_free_length) / slope;
}

double state_jump(const SpringSlider& model, int direction) {
  return (start_load(model) - direction * model.friction_force) /
         (link_stiffness(model, 0.0) + model.preload_stiffness);
}

double euler_load(const SpringSlider& model, EndCondition ends, double second_moment_of_area) {
  const double square = model.cross_section_area * model.cross_section_area / 12.0;
  const double moment = std::isnan(second_moment_of_area) ? square : second_moment_of_area;
  const double fixity = ends == EndCondition::clamped_clamped ? 4.0 : 1.0;
  constexpr double pi = thermal::detail::pi;
  return fixity * pi * pi * model.young_modulus * moment /
         (model.stress_free_length * model.stress_free_length);
}

}  // namespace statejump::spring_slider
