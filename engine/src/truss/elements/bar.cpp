// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/elements/bar.hpp"

#include <cmath>

#include "statejump/truss/model.hpp"
#include "statejump/truss/motion.hpp"
#include "truss/elements/axial.hpp"
#include "truss/hermite.hpp"
#include "truss/thermal_step.hpp"

namespace statejump::truss {

using detail::Axial;
using detail::axial;
using detail::index;
using detail::Lengths;

namespace {

/// Tension and stiffness of a bar at a state.
Axial axial_at(const Bar& bar, const Lengths& length, const ElementState& state) {
  const double change = bar.temperature_fraction * state.temperature_change(bar.program);
  return axial(bar, length.growth, length.drawn, change);
}

}  // namespace

std::span<const Parameter<Bar>> Bar::parameters() {
  static const Parameter<Bar> table[] = {
      {"nodes", "first node", "-", Allowed::node, "the case's nodes", &Bar::first, 0, 2},
      {"nodes", "second node", "-", Allowed::node, "the case's nodes", &Bar::second, 1, 2},
      {"axial_stiffness_N", "axial_stiffness", "N", Allowed::positive, "the case: E A",
       &Bar::axial_stiffness},
      {"stress_free_length_m", "stress_free_length", "m", Allowed::positive, "the case",
       &Bar::stress_free_length},
      {"thermal_expansion_per_K", "thermal_expansion", "1/K", Allowed::finite, "the case: α",
       &Bar::thermal_expansion},
      {"program", "program", "-", Allowed::program, "the case's programs", &Bar::program},
      {"temperature_fraction", "temperature_fraction", "-", Allowed::finite, "the case",
       &Bar::temperature_fraction},
  };
  return table;
}

std::span<const Output> Bar::outputs() {
  static const Output table[] = {{"axial_force_N", 1}};  // compression positive
  return table;
}

void Bar::validate(const Model& model, std::span<const TemperatureRange> ranges) const {
  detail::check_length(kind, name, model, first, second);
  detail::check_expansion(kind, name, thermal_expansion, temperature_fraction,
                          ranges[index(program)]);
}

ElementScale Bar::scale(const Frame& frame, const std::vector<Eigen::Vector3d>& drawn) const {
  const double stiffness = axial_stiffness / stress_free_length;
  const double length = (drawn[index(frame.nodes[1])] - drawn[index(frame.nodes[0])]).norm();
  return {stiffness, stiffness * std::abs(length - stress_free_length),
          std::abs(thermal_expansion * temperature_fraction), program};
}

void Bar::scale_misfit(const Model& model, double fraction) {
  const double drawn = detail::drawn_length(model, first, second);
  stress_free_length = drawn + fraction * (stress_free_length - drawn);
}

void Bar::evaluate(const Frame& frame, const ElementState& state, ElementWriter& writer) const {
  const Lengths length = detail::lengths(frame.nodes, state);
  detail::write_axial(frame.nodes, length, axial_at(*this, length, state), writer);
}

void Bar::thermal_rate(const Frame& frame, const ElementState& state,
                       const std::vector<double>& program_rates, ElementWriter& writer) const {
  const double growth =
      stress_free_length * thermal_expansion * temperature_fraction * program_rates[index(program)];
  if (growth == 0.0) return;
  // Derivative of N = E A (L/l_T − 1) with respect to l_T.
  const Lengths length = detail::lengths(frame.nodes, state);
  const double change = temperature_fraction * state.temperature_change(program);
  const double free = thermal::length(stress_free_length, thermal_expansion, change);
  const Eigen::Vector3d tension = -axial_stiffness * growth / (free * free) * length.along;
  writer.force(frame.nodes[0], -tension);
  writer.force(frame.nodes[1], tension);
}

double Bar::energy(const Frame& frame, const ElementState& state) const {
  return axial_at(*this, detail::lengths(frame.nodes, state), state).energy();
}

void Bar::describe(const Frame& frame, const ElementState& state, double* outputs) const {
  outputs[0] = -axial_at(*this, detail::lengths(frame.nodes, state), state).tension;
}

double Bar::thermal_work(const Frame& frame, const detail::ThermalStep& step) const {
  const double expansion = stress_free_length * thermal_expansion * temperature_fraction;
  if (expansion == 0.0) return 0.0;
  const int from = frame.nodes[0];
  const int to = frame.nodes[1];
  const detail::Way& way = step.way;
  const Lengths start = step.lengths_between(from, to, way.from);
  const Lengths end = step.lengths_between(from, to, way.to);
  detail::Cubic growth{start.growth, end.growth, 0.0, 0.0};
  if (!way.is_straight()) {
    const auto growth_rate = [&](const Lengths& length, const Eigen::VectorXd& rate) {
      return way.step() * length.along.dot(step.moved_between(from, to, rate)) / length.now;
    };
    growth.first_rate = growth_rate(start, *way.from_rate);
    growth.last_rate = growth_rate(end, *way.to_rate);
  }
  // ∂V/∂l_T = −N − N²/(2 E A)
  const auto by_length = [&](double share, double change) {
    const double tension =
        axial(*this, growth.at(share), end.drawn, temperature_fraction * change).tension;
    return -tension * (1.0 + 0.5 * tension / axial_stiffness);
  };
  return expansion * step.quadratures[index(program)].along(by_length);
}

void Bar::mass(const Frame& frame, const Inertia& inertia, std::size_t i,
               MatrixWriter& writer) const {
  const double mass = inertia_of(inertia.link_mass, i);
  const double rotary = inertia.link_moment.size() == 0
                            ? mass / 12.0
                            : inertia_of(inertia.link_moment, i) / std::pow(stress_free_length, 2);
  // The centre of mass moves with (1 − G) v1 + G v2, where the matrix G rotates and stretches
  // vectors in the plane. The remaining part of v2 − v1 rotates the body.
  Eigen::Matrix3d to_second = 0.5 * Eigen::Matrix3d::Identity();
  if (inertia.link_centre.size() != 0) {
    const auto centre = inertia.link_centre.col(static_cast<Eigen::Index>(i));
    to_second = centre[0] * Eigen::Matrix3d::Identity();
    to_second(1, 0) = centre[1];
    to_second(0, 1) = -centre[1];
  }
  const Eigen::Matrix3d to_first = Eigen::Matrix3d::Identity() - to_second;
  const Eigen::Matrix3d turned = rotary * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d across = mass * to_first.transpose() * to_second - turned;
  const int one = frame.nodes[0];
  const int other = frame.nodes[1];
  writer.block(one, one, mass * to_first.transpose() * to_first + turned);
  writer.block(other, other, mass * to_second.transpose() * to_second + turned);
  writer.block(one, other, across);
  writer.block(other, one, across.transpose());
}

Dashpot Bar::dashpot(const Frame& frame, const Inertia& inertia, std::size_t i) const {
  return {frame.nodes[0],
          frame.nodes[1],
          inertia_of(inertia.link_damping, i),
          inertia_of(inertia.pin_damping, i),
          stress_free_length * thermal_expansion * temperature_fraction,
          program};
}

}  // namespace statejump::truss
