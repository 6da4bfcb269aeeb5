// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/joints/iwan_joint.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "statejump/kernel/require.hpp"
#include "truss/joints/prismatic.hpp"

namespace statejump::truss {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
/// Roundings of a slide: displacements of two nodes, the position of the slider, and the error of
/// Newton's method.
constexpr double roundings = 64.0;

double slide_of(const IwanJoint& joint, const Trial& trial) {
  return joint.axis.dot(trial.moved[0] - trial.moved[1]);
}

/// Calls use(stiffness, reach, from, to) for the slider of every interval, then for the sliders at
/// φm, which have from = to = reach.
template <class Use>
void for_each_element(const IwanJoint& joint, Use&& use) {
  const double last = joint.last_reach();
  const double chi = joint.exponent;
  const double spread = joint.tangent_stiffness / (1.0 + joint.stiffness_ratio);
  const double whole = joint.spacing > 1.0 ? std::pow(joint.spacing, joint.elements) - 1.0
                                           : static_cast<double>(joint.elements);
  double length = (joint.spacing > 1.0 ? joint.spacing - 1.0 : 1.0) / whole;
  // Start of the interval over φm; fractions of stiffness ∫ρ and force ∫φ ρ before it.
  double from = 0.0;
  double stiffness_before = 0.0;
  double force_before = 0.0;
  for (int i = 0; i < joint.elements; ++i) {
    const double to = i + 1 == joint.elements ? 1.0 : from + length;
    const double stiffness = std::pow(to, chi + 1.0);
    const double force = (chi + 1.0) / (chi + 2.0) * stiffness * to;
    const double share = stiffness - stiffness_before;
    use(spread * share, last * (force - force_before) / share, last * from, last * to);
    stiffness_before = stiffness;
    force_before = force;
    from = to;
    length *= joint.spacing;
  }
  use(spread * joint.stiffness_ratio, last, last, last);
}

/// Total force of all elements at a slide, given the previous positions of their sliders.
struct Response {
  double force = 0.0;
  double tangent = 0.0;
  std::size_t slipping = 0;
  double beyond_plus = -std::numeric_limits<double>::infinity();   ///< Largest s − p − φ [m].
  double beyond_minus = -std::numeric_limits<double>::infinity();  ///< Largest p − s − φ [m].
};

/// Force and tangent of a slide in one direction. A slider at its bound within rounding slips if
/// the joint slips in that direction: in a short step rounding must not decide the tangent.
/// @param before positions of all sliders at the start of the step
/// @param after receives the positions of all sliders at s, unless null
Response respond(const IwanJoint& joint, double s, JointStatus status, const double* before,
                 double* after) {
  Response found;
  int i = 0;
  for_each_element(joint, [&](double stiffness, double reach, double, double) {
    const double bend = s - before[i];
    const double kept = std::clamp(bend, -reach, reach);
    found.force += stiffness * kept;
    const double rounding = roundings * epsilon * (std::abs(s) + std::abs(before[i]));
    const double plus = status == JointStatus::slip_plus ? -rounding : 0.0;
    const double minus = status == JointStatus::slip_minus ? -rounding : 0.0;
    if (bend - reach <= plus && -bend - reach <= minus) {
      found.tangent += stiffness;
    } else {
      ++found.slipping;
    }
    found.beyond_plus = std::max(found.beyond_plus, bend - reach);
    found.beyond_minus = std::max(found.beyond_minus, -bend - reach);
    if (after != nullptr) after[i] = s - kept;
    ++i;
  });
  return found;
}

}  // namespace

double IwanJoint::last_reach() const {
  return slip_force * (1.0 + stiffness_ratio) /
         (tangent_stiffness * (stiffness_ratio + (exponent + 1.0) / (exponent + 2.0)));
}

std::vector<IwanJoint::Jenkins> IwanJoint::jenkins() const {
  std::vector<Jenkins> found;
  for_each_element(*this, [&](double k, double reach, double, double) {
    found.push_back({k, reach});
  });
  return found;
}

double IwanJoint::slack() const {
  // The force–slide curve is a polygon that equals the exact curve at both ends of an interval. Its
  // error is largest at its corner φ_i. There it is the integral ∫ (φ_i − φ) ρ dφ from the start of
  // the interval, over the exact sliders that already slip.
  const double last = last_reach();
  const double spread = tangent_stiffness / (1.0 + stiffness_ratio);
  const auto upto = [&](double share) { return std::pow(share, exponent + 1.0); };
  double largest = 0.0;
  for_each_element(*this, [&](double, double reach, double from, double to) {
    if (!(to > from)) return;
    const double a = from / last;
    const double c = reach / last;
    const double stiffness = upto(c) - upto(a);
    const double force = (exponent + 1.0) / (exponent + 2.0) * (upto(c) * c - upto(a) * a);
    largest = std::max(largest, spread * last * (c * stiffness - force));
  });
  return largest;
}

std::span<const Parameter<IwanJoint>> IwanJoint::parameters() {
  using I = IwanJoint;
  static const Parameter<I> table[] = {
      {"first_node", "first node", "-", Allowed::node, "the case's nodes", &I::first},
      {"second_node", "second node", "-", Allowed::node_or_ground, "the case's nodes", &I::second},
      {"axis", "axis", "-", Allowed::direction, "the case", &I::axis},
      {"tangent_stiffness_N_per_m", "tangent_stiffness", "N/m", Allowed::positive, "the case: K_T",
       &I::tangent_stiffness},
      {"slip_force_N", "slip_force", "N", Allowed::positive, "the case: F_S", &I::slip_force},
      {"exponent", "exponent", "-", Allowed::finite, "the case: χ", &I::exponent},
      {"stiffness_ratio", "stiffness_ratio", "-", Allowed::not_negative, "the case: β",
       &I::stiffness_ratio},
      {"elements", "elements", "-", Allowed::count, "the case", &I::elements},
      {"spacing", "spacing", "-", Allowed::positive, "the case", &I::spacing},
  };
  return table;
}

std::span<const Output> IwanJoint::outputs() {
  // Outputs: slide from the reference configuration; force on the first node, against the axis.
  static const Output table[] = {{"iwan_slide_m", 1}, {"iwan_force_N", 1}};
  return table;
}

void IwanJoint::validate(const Model&) const {
  const std::string item = "iwan_joint '" + name + "'";
  if (second == first) {
    throw kernel::OutOfRange(item, "second node", second, "another than the first");
  }
  if (!(exponent > -1.0 && exponent <= 0.0)) {
    throw kernel::OutOfRange(item, "exponent", exponent, "above -1, at most 0");
  }
  if (!(spacing >= 1.0)) throw kernel::OutOfRange(item, "spacing", spacing, ">= 1");
  // The first interval must exceed the rounding of the last one.
  const double longest = std::pow(spacing, elements - 1);
  if (!(longest < 1e12)) {
    throw kernel::OutOfRange(item, "spacing to the power of elements - 1", longest, "below 1e12");
  }
}

JointFrame IwanJoint::frame(const Model& model) const {
  return detail::prismatic_frame(model, first, second, axis);
}

void IwanJoint::evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const {
  const double s = slide_of(*this, trial);
  detail::push_along(trial, axis, writer);
  Response now;
  if (is_slip(status)) {
    now = respond(*this, s, status, trial.history, nullptr);
  } else {
    int i = 0;
    for_each_element(*this, [&](double stiffness, double, double, double) {
      now.force += stiffness * (s - trial.history[i++]);
    });
    now.tangent = tangent_stiffness;
  }
  // In metres: force difference times the compliance of the stuck joint.
  writer.piece(now.slipping);
  writer.closure(0, (now.force - trial.force[0]) / tangent_stiffness);
  writer.corner(0, 0, -1.0 / tangent_stiffness);
  writer.row(0, 0, now.tangent / tangent_stiffness * axis);
  writer.row(0, 1, -now.tangent / tangent_stiffness * axis);
  detail::hold_across(trial, writer);
}

JointStatus IwanJoint::decide(const Trial& trial, JointStatus status) const {
  const Response now = respond(*this, slide_of(*this, trial), status, trial.history, nullptr);
  const double rounding = trial.length_rounding;
  if (status == JointStatus::slip_plus && now.beyond_plus >= -rounding) return status;
  if (status == JointStatus::slip_minus && now.beyond_minus >= -rounding) return status;
  return now.beyond_plus > rounding    ? JointStatus::slip_plus
         : now.beyond_minus > rounding ? JointStatus::slip_minus
                                       : JointStatus::stick;
}

void IwanJoint::begin(const Trial& trial, JointStatus, double* now) const {
  // Memory at the start: one loading from the reference configuration, where all sliders are at
  // zero.
  const std::vector<double> drawn(static_cast<std::size_t>(history()), 0.0);
  respond(*this, slide_of(*this, trial), JointStatus::stick, drawn.data(), now);
}

void IwanJoint::commit(const Trial& trial, JointStatus status, double* after) const {
  if (is_slip(status)) {
    respond(*this, slide_of(*this, trial), status, trial.history, after);
  } else {
    std::copy_n(trial.history, history(), after);
  }
}

double IwanJoint::slip(const Trial& trial, const double* after) const {
  double slid = 0.0;
  int i = 0;
  for_each_element(*this, [&](double stiffness, double, double, double) {
    slid += stiffness * (after[i] - trial.history[i]);
    ++i;
  });
  return slid / tangent_stiffness;
}

double IwanJoint::dissipation(const Trial& trial, const double* after, double) const {
  double heat = 0.0;
  int i = 0;
  for_each_element(*this, [&](double stiffness, double reach, double, double) {
    heat += stiffness * reach * std::abs(after[i] - trial.history[i]);
    ++i;
  });
  return heat;
}

double IwanJoint::elastic_energy(const Trial& trial, const double* now) const {
  const double s = slide_of(*this, trial);
  double energy = 0.0;
  int i = 0;
  for_each_element(*this, [&](double stiffness, double, double, double) {
    const double bend = s - now[i++];
    energy += 0.5 * stiffness * bend * bend;
  });
  return energy;
}

void IwanJoint::describe(const Trial& trial, double* outputs) const {
  outputs[0] = slide_of(*this, trial);
  outputs[1] = trial.force[0];
}

double IwanJoint::slide_rounding(const Trial&, double length, double force) const {
  return length + force / tangent_stiffness;
}

bool IwanJoint::remembers_when(JointStatus before, JointStatus after) const {
  return is_slip(before) && before != after;
}

}  // namespace statejump::truss
