// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/joints/slider.hpp"

#include <algorithm>
#include <cmath>

#include "statejump/kernel/require.hpp"
#include "truss/joints/prismatic.hpp"

namespace statejump::truss {

namespace {

/// One of the two ways in which a slider may go.
struct Sense {
  double sign;
  JointStatus slip;
  JointStatus stop;
  JointStatus other_slip;
  JointStatus other_stop;
  double clearance(const Slider& slider) const {
    return sign > 0.0 ? slider.clearance_plus : slider.clearance_minus;
  }
};

constexpr Sense plus{1.0, JointStatus::slip_plus, JointStatus::stop_plus, JointStatus::slip_minus,
                     JointStatus::stop_minus};
constexpr Sense minus{-1.0, JointStatus::slip_minus, JointStatus::stop_minus,
                      JointStatus::slip_plus, JointStatus::stop_plus};

double slide_of(const Slider& slider, const Trial& trial) {
  return slider.axis.dot(trial.moved[0] - trial.moved[1]);
}

/// Friction of a contact that is bent by so much [N]; only if it is not rigid.
double bent_friction(const Slider& slider, double bend) {
  const double f = slider.friction_force;
  return std::clamp(slider.tangential_stiffness * bend, -f, f);
}

/// What of the slide has slipped [m]. @param before the same at the start of the step
double slipped(const Slider& slider, const Trial& trial, JointStatus status, double before) {
  const bool plus_stop = status == JointStatus::stop_plus;
  if (!plus_stop && status != JointStatus::stop_minus) {
    return slide_of(slider, trial) - trial.force[0] / slider.tangential_stiffness;
  }
  // At a stop the slide is the clearance itself: rounding must not add up.
  const double s = plus_stop ? slider.clearance_plus : -slider.clearance_minus;
  if (std::isinf(slider.tangential_stiffness)) return s;
  return s - bent_friction(slider, s - before) / slider.tangential_stiffness;
}

/// Branch in which a slider that slips one way should be.
JointStatus after_slip(const Slider& slider, const Trial& trial, const Sense& way) {
  const double s = slide_of(slider, trial);
  if (way.sign * s > way.clearance(slider) + trial.length_rounding) return way.stop;
  // While it slips, its friction is the force.
  const bool elastic = std::isfinite(slider.tangential_stiffness);
  const double slid = s - trial.force[0] / slider.tangential_stiffness - trial.history[0];
  if (way.sign * slid >=
      -slider.slide_rounding(trial, trial.length_rounding, trial.force_rounding)) {
    return way.slip;
  }
  return trial.before == way.other_stop && !elastic ? trial.before : JointStatus::stick;
}

/// Branch in which a slider that rests at a stop should be.
JointStatus after_stop(const Slider& slider, const Trial& trial, const Sense& way) {
  const double f = slider.friction_force;
  const double pushed = way.sign * trial.force[0];
  if (std::isfinite(slider.tangential_stiffness)) {
    const double bend = way.sign * way.clearance(slider) - trial.history[0];
    const bool leaves = pushed < way.sign * bent_friction(slider, bend) - trial.force_rounding;
    return leaves ? JointStatus::stick : way.stop;
  }
  // Rested there already: friction helps to stay. Arrived in this step: friction pushes back.
  if (trial.before == way.stop) {
    return pushed < -(f + trial.force_rounding) ? way.other_slip : way.stop;
  }
  return pushed < f - trial.force_rounding ? way.slip : way.stop;
}

/// Branch in which a slider that sticks should be.
JointStatus after_stick(const Slider& slider, const Trial& trial) {
  const bool elastic = std::isfinite(slider.tangential_stiffness);
  for (const Sense& way : {plus, minus}) {
    // It may get to a stop while it bends.
    const double s = way.sign * slide_of(slider, trial);
    if (elastic && s > way.clearance(slider) + trial.length_rounding) return way.stop;
    if (way.sign * trial.force[0] > slider.friction_force + trial.force_rounding) return way.slip;
  }
  return JointStatus::stick;
}

}  // namespace

std::span<const Parameter<Slider>> Slider::parameters() {
  static const Parameter<Slider> table[] = {
      {"first_node", "first node", "-", Allowed::node, "the case's nodes", &Slider::first},
      {"second_node", "second node", "-", Allowed::node_or_ground, "the case's nodes",
       &Slider::second},
      {"axis", "axis", "-", Allowed::direction, "the case", &Slider::axis},
      {"friction_force_N", "friction_force", "N", Allowed::not_negative,
       "Coulomb: friction coefficient times normal force", &Slider::friction_force},
      {"clearance_minus_m", "clearance_minus", "m", Allowed::distance_or_infinite, "the case",
       &Slider::clearance_minus},
      {"clearance_plus_m", "clearance_plus", "m", Allowed::distance_or_infinite, "the case",
       &Slider::clearance_plus},
      {"tangential_stiffness_N_per_m", "tangential_stiffness", "N/m", Allowed::positive_or_infinite,
       "Mindlin, of the pad under its normal force", &Slider::tangential_stiffness},
  };
  return table;
}

std::span<const Output> Slider::outputs() {
  // Slide from the drawn shape; friction and stop on the slider, against its axis.
  static const Output table[] = {{"slide_m", 1}, {"slider_force_N", 1}};
  return table;
}

void Slider::validate(const Model&) const {
  if (second == first) {
    throw kernel::OutOfRange("slider '" + name + "'", "second node", second,
                             "another than the first");
  }
}

JointFrame Slider::frame(const Model& model) const {
  return detail::prismatic_frame(model, first, second, axis);
}

void Slider::evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const {
  const double s = slide_of(*this, trial);
  const double force = trial.force[0];
  detail::push_along(trial, axis, writer);
  double corner = 0.0;
  switch (status) {
    case JointStatus::stop_plus:
      writer.closure(0, s - clearance_plus);
      break;
    case JointStatus::stop_minus:
      writer.closure(0, s + clearance_minus);
      break;
    case JointStatus::slip_plus:
      writer.balance(0, force - friction_force);
      corner = 1.0;
      break;
    case JointStatus::slip_minus:
      writer.balance(0, force + friction_force);
      corner = 1.0;
      break;
    default:
      writer.closure(0, s - trial.history[0] - force / tangential_stiffness);
      corner = -1.0 / tangential_stiffness;
  }
  const double slides = is_slip(status) ? 0.0 : 1.0;
  writer.corner(0, 0, corner);
  writer.row(0, 0, slides * axis);
  writer.row(0, 1, -slides * axis);
  detail::hold_across(trial, writer);
}

JointStatus Slider::decide(const Trial& trial, JointStatus status) const {
  switch (status) {
    case JointStatus::slip_plus:
      return after_slip(*this, trial, plus);
    case JointStatus::slip_minus:
      return after_slip(*this, trial, minus);
    case JointStatus::stop_plus:
      return after_stop(*this, trial, plus);
    case JointStatus::stop_minus:
      return after_stop(*this, trial, minus);
    default:
      return after_stick(*this, trial);
  }
}

void Slider::begin(const Trial& trial, JointStatus status, double* now) const {
  // The start was found from the drawn shape, where nothing had slipped.
  now[0] = slipped(*this, trial, status, 0.0);
}

void Slider::commit(const Trial& trial, JointStatus status, double* after) const {
  after[0] = slipped(*this, trial, status, trial.history[0]);
}

double Slider::slip(const Trial& trial, const double* after) const {
  return after[0] - trial.history[0];
}

double Slider::dissipation(const Trial&, const double*, double slip) const {
  // Whenever it slides, friction is f; a stop takes no heat.
  return friction_force * std::abs(slip);
}

double Slider::elastic_energy(const Trial& trial, const double* now) const {
  if (std::isinf(tangential_stiffness)) return 0.0;
  const double bend = slide_of(*this, trial) - now[0];
  return 0.5 * tangential_stiffness * bend * bend;
}

void Slider::describe(const Trial& trial, double* outputs) const {
  outputs[0] = slide_of(*this, trial);
  outputs[1] = trial.force[0];
}

double Slider::slide_rounding(const Trial&, double length, double force) const {
  return length + force / tangential_stiffness;
}

bool Slider::remembers_when(JointStatus before, JointStatus after) const {
  return friction_force > 0.0 && is_slip(before) && (after == JointStatus::stick || is_slip(after));
}

std::optional<LocalContact> Slider::contact(const Trial&, JointStatus status) const {
  // Wall and friction share a force that is not told apart: at a stop it is held.
  if (status == JointStatus::stop_plus || status == JointStatus::stop_minus) return {};
  return LocalContact{0, -1, 1.0, friction_force};
}

Seat Slider::seat(const Trial&, double, double, double) const {
  return {};
}

bool Slider::jumps(const Trial&, JointStatus) const {
  return false;
}

}  // namespace statejump::truss
