// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "path_follower.hpp"
#include "status_enumeration.hpp"
#include "truss/elements/axial.hpp"

namespace statejump::truss::detail {

namespace {

/// Most steps of a snap; a longer motion counts as unstable.
constexpr int most_snap_steps = 200;
/// Increase of the dashpot level after a step without solution. With stiffer dashpots, steps
/// converge even if the truss has a negative stiffness.
constexpr double stiffer = 0.5;
/// Initial dashpot level, as stiff as the stiffest element, and highest level, with negligible
/// motion.
constexpr double first_level = 4.0;
constexpr double stiffest = 6.0;
/// A snap has ended if a step adds less than this fraction of its motion.
constexpr double at_rest = 1e-6;
/// After this many failed steps, the softest dashpots with which steps converged are not softened
/// further.
constexpr int most_refused = 3;
/// After this many steps at level 0 with decreasing motion, the motion counts as slow.
constexpr int most_slower = 16;
/// Most joints that a snap note names.
constexpr std::size_t most_named = 3;

/// Diameter of a joint's play [m], or the range of a hinge's moment curve on its radius; 0: it has
/// none.
double play_of(const Model& model, const Joint& joint) {
  if (const auto* hinge = std::get_if<Hinge>(&joint)) {
    return hinge->curve ? model.nodes[index(hinge->first)].arm * hinge->curve->range() : 0.0;
  }
  return std::visit(
      [](const auto& one) {
        if constexpr (requires { one.radial_clearance; }) return 2.0 * one.radial_clearance;
        return 0.0;
      },
      joint);
}

/// Sum of all plays [m].
double sum_of_plays(const Model& model) {
  double sum = 0.0;
  for (const Joint& joint : model.joints) sum += play_of(model, joint);
  return sum;
}

/// The largest play [m].
double largest_play(const Model& model) {
  double largest = 0.0;
  for (const Joint& joint : model.joints) largest = std::max(largest, play_of(model, joint));
  return largest;
}

/// Motion that rounding errors of the forces cause in an element that only soft dashpots hold [m].
double moved_by_rounding(const System& system, const VectorXd& z) {
  return 8.0 * system.force_rounding(z) / system.slack_stiffness(0.0);
}

}  // namespace

double lever_of(const Model& model, double size) {
  double shortest = size;
  for (const Bar& link : model.links) {
    const double length = drawn_length(model, link.first, link.second);
    if (length > 0.0) shortest = std::min(shortest, length);
  }
  return shortest > 0.0 ? size / shortest : 1.0;
}

/// Moves journals within their play, damped by dashpots while they slip, until they are at rest.
///
/// Every step is a proximal point step on the potential with the present friction cones. At first
/// dashpots are as stiff as the stiffest element. They become softer while steps converge, and
/// stiffer if steps fail; at the end their forces are negligible. They do not stabilise an
/// instability whose motion exceeds the play.
/// @param step takes one step with dashpots of the given level. Returns the motion [m], or nothing
/// if there is no solution; the state is then unchanged
/// @param drift motion in a step if nothing is unstable [m]
bool PathFollower::come_to_rest(const std::function<std::optional<double>(double level)>& step,
                                double drift) {
  const double most_carried = system.slack_stiffness(0.0) * largest_play(model);
  double level = first_level;
  double without = 0.0;  // highest level without a solution
  int refused = 0;
  double whole = 0.0, last = 0.0;
  int slower = 0;
  for (int k = 0; k < most_snap_steps; ++k) {
    const std::optional<double> moved = step(level);
    if (!path.complete) return true;
    if (!moved) {
      if (level >= stiffest) return false;
      without = std::max(without, level);
      ++refused;
      level = std::min(stiffest, level + stiffer);
      continue;
    }
    whole += *moved;
    const double ordinary = moved_by_rounding(system, z) + drift;
    const double carried = system.slack_stiffness(level) * (*moved - drift);
    const bool is_softest = refused >= most_refused && level <= without + stiffer;
    if (is_softest && carried <= most_carried) return true;
    if (level == 0.0 && *moved <= at_rest * whole + ordinary) return true;
    // Slack elements on soft dashpots continue to move, slower and slower.
    slower = level == 0.0 && *moved <= last ? slower + 1 : 0;
    if (slower >= most_slower) return true;
    last = *moved;
    level = std::max(0.0, level - PathFollower::softer);
  }
  return false;
}

/// Follows unstable slip within the play of the joints until it comes to rest.
///
/// A journal that slips from an unstable position snaps to a stable position within its play.
/// Statics does not describe this motion. Dashpots in joints with play describe it at a nearly
/// constant temperature. An instability that exceeds the play remains a failure.
/// @param until time before which the snap must end [s]
/// @returns false if dashpots do not stabilise the slip, or if no joint has play; the state is then
/// unchanged
bool PathFollower::follow_snap(double until, double tolerance) {
  const double plays = sum_of_plays(model) * lever;
  if (plays == 0.0 || !options.locate_events) return false;
  const Position before = position();
  const auto events = static_cast<std::ptrdiff_t>(path.events.size());
  const std::size_t states = path.states.size();
  const std::size_t steps_before = recorded();
  const double level_before = slack_level;
  const double stride = std::min(tolerance, (until - time) / (most_snap_steps + 1));
  const int moving = before.rate.size() == 0 ? 0 : system.displacements();
  const double drift = 2.0 * length_of(before.rate, moving) * stride;
  double level_after = level_before;
  const bool damped_before = origin.damps_contact;
  const bool rests = come_to_rest(
      [&](double level) -> std::optional<double> {
        const VectorXd from = z;
        const Statuses statuses = origin.statuses;
        slack_level = level_after = level;
        origin.damps_contact = true;
        changed_at_start.clear();
        try {
          const StepEnd end = step_to(time + stride, tolerance);
          if (end == StepEnd::stopped) path.complete = false;
          const double moved = length_of(z - from, system.displacements());
          if (end == StepEnd::done) return moved;
        } catch (const Failure&) {
          origin.statuses = statuses;
        }
        return std::nullopt;
      },
      drift);
  slack_level = level_before;
  origin.damps_contact = damped_before;
  if (!path.complete) return true;
  const double whole = length_of(z - before.z, system.displacements());
  snap_travel += whole;
  if (!rests || snap_travel > plays) {
    return_to(before);
    forget_after(steps_before);
    path.events.erase(path.events.begin() + events, path.events.end());
    path.states.resize(states, State{});
    return false;
  }
  if (level_after > level_before) {
    // The stiffer dashpots with which steps converged stay in use.
    slack_level = std::min(level_after, System::most_slack_level);
    origin.damps_contact = true;
    is_slack = true;
  }
  const double ordinary = drift * (time - before.time) / stride + moved_by_rounding(system, z);
  if (whole <= ordinary) return true;
  std::vector<double> by;
  for (int i = 0; i < static_cast<int>(model.joints.size()); ++i) {
    by.push_back(system.slack_motion(i, z, time, before.origin).norm());
  }
  std::vector<int> joints(by.size());
  std::iota(joints.begin(), joints.end(), 0);
  std::stable_sort(joints.begin(), joints.end(),
                   [&](int a, int b) { return by[index(a)] > by[index(b)]; });
  joints.resize(std::min(joints.size(), most_named));
  note(NoteKind::snap, time, joints, whole);
  return true;
}

PathFollower::Position PathFollower::position() const {
  return {z, origin, state, time, rate, slide_rate};
}

void PathFollower::return_to(const Position& to) {
  z = to.z;
  origin = to.origin;
  state = to.state;
  time = to.time;
  rate = to.rate;
  slide_rate = to.slide_rate;
}

}  // namespace statejump::truss::detail
