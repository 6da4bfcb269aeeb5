// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/elements/spring.hpp"

#include <cmath>

#include "statejump/truss/model.hpp"
#include "statejump/truss/motion.hpp"
#include "truss/elements/axial.hpp"

namespace statejump::truss {

using detail::Axial;
using detail::index;
using detail::Lengths;

namespace {

double stretch(const Spring& spring, const Lengths& length) {
  return detail::stretch(length.growth, length.drawn, spring.free_length);
}

Axial axial(const Spring& spring, const Lengths& length) {
  const double stretched = stretch(spring, length);
  if (spring.cable && stretched < 0.0) return {0.0, 0.0};
  return {spring.stiffness * stretched, spring.stiffness};
}

}  // namespace

std::span<const Parameter<Spring>> Spring::parameters() {
  static const Parameter<Spring> table[] = {
      {"nodes", "first node", "-", Allowed::node, "the case's nodes", &Spring::first, 0, 2},
      {"nodes", "second node", "-", Allowed::node, "the case's nodes", &Spring::second, 1, 2},
      {"stiffness_N_per_m", "stiffness", "N/m", Allowed::not_negative, "the case: k",
       &Spring::stiffness},
      {"free_length_m", "free_length", "m", Allowed::finite, "the case", &Spring::free_length},
      {"cable", "cable", "-", Allowed::flag, "the case", &Spring::cable},
  };
  return table;
}

std::span<const Output> Spring::outputs() {
  static const Output table[] = {{"tension_N", 1}};
  return table;
}

void Spring::validate(const Model& model, std::span<const TemperatureRange>) const {
  detail::check_length(kind, name, model, first, second);
}

ElementScale Spring::scale(const Frame& frame, const std::vector<Eigen::Vector3d>& drawn) const {
  const double length = (drawn[index(frame.nodes[1])] - drawn[index(frame.nodes[0])]).norm();
  return {stiffness, stiffness * std::abs(length - free_length)};
}

void Spring::scale_misfit(const Model& model, double fraction) {
  const double drawn = detail::drawn_length(model, first, second);
  // A slack cable has no stress.
  if (cable && free_length > drawn) return;
  free_length = drawn + fraction * (free_length - drawn);
}

void Spring::evaluate(const Frame& frame, const ElementState& state, ElementWriter& writer) const {
  const Lengths length = detail::lengths(frame.nodes, state);
  const Axial now = axial(*this, length);
  if (cable) writer.piece(now.stiffness > 0.0 ? 0 : 1);
  detail::write_axial(frame.nodes, length, now, writer);
}

double Spring::energy(const Frame& frame, const ElementState& state) const {
  return axial(*this, detail::lengths(frame.nodes, state)).energy();
}

void Spring::describe(const Frame& frame, const ElementState& state, double* outputs) const {
  outputs[0] = axial(*this, detail::lengths(frame.nodes, state)).tension;
}

Dashpot Spring::dashpot(const Frame& frame, const Inertia& inertia, std::size_t i) const {
  return {frame.nodes[0], frame.nodes[1], inertia_of(inertia.spring_damping, i)};
}

double Spring::beyond_edges(const Frame& frame, const ElementState& state) const {
  return stretch(*this, detail::lengths(frame.nodes, state));
}

}  // namespace statejump::truss
