// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/joints/slider.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "statejump/kernel/require.hpp"
#include "truss/joints/partial_slip.hpp"
#include "truss/joints/prismatic.hpp"

namespace statejump::truss {

namespace {

/// One of the two directions of a slider.
struct Sense {
  double sign;
  JointStatus slip;
  JointStatus stop;
  JointStatus other_slip;
  JointStatus other_stop;
  /// Distance to a rigid stop [m].
  double clearance(const Slider& slider) const {
    if (slider.has_soft_stops()) return std::numeric_limits<double>::infinity();
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

/// With partial slip, history() holds the slide at the start of the step, then the contact's
/// memory.
kernel::PartialSlipMemory memory_of(const double* history) {
  return detail::read_partial_slip(history + 1);
}

/// Friction force with partial slip at the slide s.
kernel::PartialSlipLine rubbing(const Slider& slider, const double* history, double s) {
  return kernel::partial_slip_line(slider.tangential_stiffness, slider.friction_force,
                                   s - history[0], memory_of(history));
}

/// Applies the partial-slip law to the step that ends at the slide s.
/// @param memory on input at the start of the step, on output at its end
kernel::PartialSlipResponse rub(const Slider& slider, const double* history, double s,
                                kernel::PartialSlipMemory& memory) {
  return kernel::partial_slip_step(slider.tangential_stiffness, slider.friction_force,
                                   {s - history[0], 0.0}, memory);
}

/// Friction at the slide s [N].
/// @pre the contact is not rigid
double friction_at(const Slider& slider, const double* history, double s) {
  if (slider.partial_slip) return rubbing(slider, history, s).force;
  const double f = slider.friction_limit();
  return std::clamp(slider.tangential_stiffness * (s - history[0]), -f, f);
}

/// Slide beyond soft stops [m].
double beyond_stops(const Slider& slider, double s) {
  if (!slider.has_soft_stops()) return 0.0;
  return s - std::clamp(s, -slider.clearance_minus, slider.clearance_plus);
}

/// Part of the contact's deflection within its play [m].
double played(const Slider& slider, double bend) {
  return std::clamp(bend, -0.5 * slider.play, 0.5 * slider.play);
}

/// Forces of soft stops and play on the slider against its axis. They act in addition to the
/// unknown λ.
struct Springs {
  double force = 0.0;      ///< [N]
  double stiffness = 0.0;  ///< [N/m]
  std::size_t piece = 0;
};

Springs springs_at(const Slider& slider, const Trial& trial) {
  const double s = slide_of(slider, trial);
  Springs found;
  if (slider.has_soft_stops()) {
    const double beyond = beyond_stops(slider, s);
    found.force += slider.soft_stop_force(s);
    if (beyond != 0.0) found.stiffness += slider.stop_stiffness;
    found.piece += beyond > 0.0 ? 1 : beyond < 0.0 ? 2 : 0;
  }
  if (slider.play > 0.0 && !trial.in_motion) {
    const double bend = s - trial.history[0];
    const double inside = played(slider, bend);
    found.force -= slider.tangential_stiffness * inside;
    if (inside == bend) found.stiffness -= slider.tangential_stiffness;
    found.piece += inside == bend ? 0 : bend > 0.0 ? 3 : 6;
  }
  return found;
}

/// Applies the forces of soft stops and play to the slider's nodes. They act for every status.
void push_springs(const Slider& slider, const Trial& trial, JointWriter& writer) {
  const Springs found = springs_at(slider, trial);
  const Eigen::Vector3d force = found.force * slider.axis;
  const Eigen::Matrix3d block = found.stiffness * slider.axis * slider.axis.transpose();
  writer.carries(found.force);
  writer.piece(found.piece);
  writer.force(0, force);
  writer.force(1, -force);
  writer.block(0, 0, block);
  writer.block(1, 1, block);
  writer.block(0, 1, -block);
  writer.block(1, 0, -block);
}

/// Slide at a state [m]. At a stop it is set to the clearance, so that rounding does not
/// accumulate.
double slide_of(const Slider& slider, const Trial& trial, JointStatus status) {
  return status == JointStatus::stop_plus    ? slider.clearance_plus
         : status == JointStatus::stop_minus ? -slider.clearance_minus
                                             : slide_of(slider, trial);
}

/// Part of the slide that is slip [m], for a slider without partial slip.
/// @param before memory at the start of the step
double slipped(const Slider& slider, const Trial& trial, JointStatus status, const double* before) {
  const double s = slide_of(slider, trial, status);
  if (status != JointStatus::stop_plus && status != JointStatus::stop_minus) {
    return s - trial.force[0] / slider.tangential_stiffness;
  }
  if (std::isinf(slider.tangential_stiffness)) return s;
  return s - friction_at(slider, before, s) / slider.tangential_stiffness;
}

/// Status that the inequalities require if the slider slips in the given direction.
JointStatus after_slip(const Slider& slider, const Trial& trial, const Sense& way) {
  const double s = slide_of(slider, trial);
  if (way.sign * s > way.clearance(slider) + trial.length_rounding) return way.stop;
  // While the slider slips, the unknown force is friction.
  const bool elastic = std::isfinite(slider.tangential_stiffness);
  const double slid = s - trial.force[0] / slider.tangential_stiffness - trial.history[0];
  if (way.sign * slid >=
      -slider.slide_rounding(trial, trial.length_rounding, trial.force_rounding)) {
    return way.slip;
  }
  // Without friction both directions of slip are admissible.
  if (slider.friction_force == 0.0) return way.other_slip;
  return trial.before == way.other_stop && !elastic ? trial.before : JointStatus::stick;
}

/// Status that the inequalities require of a slider at a stop.
JointStatus after_stop(const Slider& slider, const Trial& trial, const Sense& way) {
  const double f = slider.friction_force;
  const double pushed = way.sign * trial.force[0];
  if (std::isfinite(slider.tangential_stiffness)) {
    const double rubs = friction_at(slider, trial.history, way.sign * way.clearance(slider));
    const bool leaves = pushed < way.sign * rubs - trial.force_rounding;
    return leaves ? JointStatus::stick : way.stop;
  }
  // Friction helps to hold a slider that was at the stop before the step. If it arrived in this
  // step, friction acts away from the stop.
  if (trial.before == way.stop) {
    return pushed < -(f + trial.force_rounding) ? way.other_slip : way.stop;
  }
  return pushed < f - trial.force_rounding ? way.slip : way.stop;
}

/// Status that the inequalities require of a sticking slider.
JointStatus after_stick(const Slider& slider, const Trial& trial, JointStatus status) {
  const bool elastic = std::isfinite(slider.tangential_stiffness);
  for (const Sense& way : {plus, minus}) {
    // A sticking slider may reach a stop by elastic deflection.
    const double s = way.sign * slide_of(slider, trial);
    if (elastic && s > way.clearance(slider) + trial.length_rounding) return way.stop;
    if (slider.partial_slip) continue;  // one row for stick and slip
    if (way.sign * trial.force[0] > slider.friction_limit() + trial.force_rounding) return way.slip;
  }
  return status;
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
      {"partial_slip", "partial_slip", "-", Allowed::flag, "the case", &Slider::partial_slip},
      {"stop_stiffness_N_per_m", "stop_stiffness", "N/m", Allowed::positive_or_infinite, "the case",
       &Slider::stop_stiffness},
      {"play_m", "play", "m", Allowed::not_negative, "the case", &Slider::play},
  };
  return table;
}

std::span<const Output> Slider::outputs() {
  // Outputs: slide from the reference configuration; friction plus stop force on the slider,
  // against its axis.
  static const Output table[] = {{"slide_m", 1}, {"slider_force_N", 1}};
  return table;
}

void Slider::validate(const Model&) const {
  if (second == first) {
    throw kernel::OutOfRange("slider '" + name + "'", "second node", second,
                             "another than the first");
  }
  if (partial_slip && !(friction_force > 0.0 && std::isfinite(tangential_stiffness))) {
    throw kernel::OutOfRange("slider '" + name + "'", "partial_slip", partial_slip,
                             "0 without friction or with a rigid contact");
  }
  if (play > 0.0 && !(friction_force > 0.0 && std::isfinite(tangential_stiffness))) {
    throw kernel::OutOfRange("slider '" + name + "'", "play", play,
                             "0 without friction or with a rigid contact");
  }
  if (play > 0.0 && partial_slip) {
    throw kernel::OutOfRange("slider '" + name + "'", "play", play, "0 with partial slip");
  }
}

int Slider::slip_memory_begin() const {
  return 1;
}

int Slider::history() const {
  return slip_memory_begin() + (partial_slip ? detail::partial_slip_history(1) : 0);
}

JointFrame Slider::frame(const Model& model) const {
  return detail::prismatic_frame(model, first, second, axis);
}

void Slider::evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const {
  const double s = slide_of(*this, trial);
  const double force = trial.force[0];
  detail::push_along(trial, axis, writer);
  if (has_springs()) push_springs(*this, trial, writer);
  if (partial_slip && status != JointStatus::stop_plus && status != JointStatus::stop_minus) {
    // In metres: force difference times the compliance of a sticking contact.
    const kernel::PartialSlipLine law = rubbing(*this, trial.history, s);
    const double gives = trial.unslipped ? 1.0 : law.by_slide / tangential_stiffness;
    writer.piece(detail::piece_of(law));
    writer.closure(0, (law.force - force) / tangential_stiffness);
    writer.corner(0, 0, -1.0 / tangential_stiffness);
    writer.row(0, 0, gives * axis);
    writer.row(0, 1, -gives * axis);
    detail::hold_across(trial, writer);
    return;
  }
  double corner = 0.0;
  switch (status) {
    case JointStatus::stop_plus:
      writer.closure(0, s - clearance_plus);
      break;
    case JointStatus::stop_minus:
      writer.closure(0, s + clearance_minus);
      break;
    case JointStatus::slip_plus:
      writer.balance(0, force - friction_limit());
      corner = 1.0;
      break;
    case JointStatus::slip_minus:
      writer.balance(0, force + friction_limit());
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
  if (partial_slip && is_slip(status)) return after_stick(*this, trial, status);
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
      return after_stick(*this, trial, status);
  }
}

void Slider::begin(const Trial& trial, JointStatus status, double* now) const {
  // Memory at the start: slide from the reference configuration, where slip is zero.
  std::vector<double> drawn(detail::index(history()), 0.0);
  Trial from = trial;
  from.history = drawn.data();
  if (partial_slip) {
    detail::write_partial_slip(detail::pressed(tangential_stiffness, friction_force), &drawn[1]);
  }
  commit(from, status, now);
}

void Slider::commit(const Trial& trial, JointStatus status, double* after) const {
  if (!partial_slip) {
    after[0] = slipped(*this, trial, status, trial.history);
    return;
  }
  const double s = slide_of(*this, trial, status);
  kernel::PartialSlipMemory memory = memory_of(trial.history);
  rub(*this, trial.history, s, memory);
  after[0] = s;
  detail::write_partial_slip(memory, after + 1);
}

double Slider::slip(const Trial& trial, const double* after) const {
  const double moved = after[0] - trial.history[0];
  if (!partial_slip) return moved;
  const double rubs = rubbing(*this, after, after[0]).force;
  const double rubbed = rubbing(*this, trial.history, trial.history[0]).force;
  return moved - (rubs - rubbed) / tangential_stiffness;
}

double Slider::dissipation(const Trial& trial, const double* after, double slip) const {
  if (partial_slip) {
    kernel::PartialSlipMemory memory = memory_of(trial.history);
    return rub(*this, trial.history, after[0], memory).dissipation;
  }
  // Whenever it slides, friction is f; a stop dissipates nothing.
  return friction_force * std::abs(slip);
}

double Slider::elastic_energy(const Trial& trial, const double* now) const {
  const double s = slide_of(*this, trial);
  double stored = 0.0;
  if (has_soft_stops()) {
    const double beyond = beyond_stops(*this, s);
    stored = 0.5 * stop_stiffness * beyond * beyond;
  }
  if (partial_slip) return stored + kernel::elastic_energy(memory_of(now));
  if (std::isinf(tangential_stiffness)) return stored;
  double bend = s - now[0];
  if (play > 0.0) bend -= played(*this, bend);
  return stored + 0.5 * tangential_stiffness * bend * bend;
}

std::array<double, 4> Slider::beyond_edges(const Trial& trial) const {
  constexpr double none = std::numeric_limits<double>::infinity();
  std::array<double, 4> found{none, none, none, none};
  const double s = slide_of(*this, trial);
  if (has_soft_stops()) {
    found[0] = s - clearance_plus;
    found[1] = s + clearance_minus;
  }
  if (play > 0.0) {
    const double bend = s - trial.history[0];
    found[2] = bend - 0.5 * play;
    found[3] = bend + 0.5 * play;
  }
  return found;
}

void Slider::describe(const Trial& trial, double* outputs) const {
  const double s = slide_of(*this, trial);
  outputs[0] = s;
  outputs[1] = trial.force[0];
  if (play > 0.0) {
    // While the play is open, the force is exactly zero. A difference of two forces would be
    // rounded.
    const double bend = s - trial.history[0];
    const double inside = played(*this, bend);
    outputs[1] = inside == bend ? 0.0 : trial.force[0] - tangential_stiffness * inside;
  }
  outputs[1] += soft_stop_force(s);
}

double Slider::soft_stop_force(double s) const {
  return has_soft_stops() ? stop_stiffness * beyond_stops(*this, s) : 0.0;
}

double Slider::slide_rounding(const Trial&, double length, double force) const {
  return length + force / tangential_stiffness;
}

bool Slider::remembers_when(JointStatus before, JointStatus after) const {
  return friction_force > 0.0 && !partial_slip && is_slip(before) &&
         (after == JointStatus::stick || is_slip(after));
}

JointStatus Slider::settled(const Trial& trial, JointStatus status) const {
  if (!partial_slip || !(status == JointStatus::stick || is_slip(status))) return status;
  return detail::sliding(rubbing(*this, trial.history, slide_of(*this, trial)), trial.before,
                         trial.length_rounding);
}

std::optional<LocalContact> Slider::contact(const Trial&, JointStatus status) const {
  if (partial_slip) return {};  // partial slip has no friction cone; the joint keeps its status
  // A slider at a stop keeps its status in contact problems, because statics does not determine how
  // wall and friction share a force.
  if (status == JointStatus::stop_plus || status == JointStatus::stop_minus) return {};
  return LocalContact{0, -1, 1.0, friction_limit()};
}

Seat Slider::seat(const Trial&, double, double, double) const {
  return {};
}

bool Slider::jumps(const Trial&, JointStatus) const {
  return false;
}

}  // namespace statejump::truss
