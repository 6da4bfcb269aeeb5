// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "ladder.hpp"
#include "statejump/failure.hpp"
#include "statejump/kernel/require.hpp"
#include "statejump/truss/motion.hpp"
#include "stepper.hpp"

namespace statejump::truss {

namespace {

using detail::index;
using Eigen::VectorXd;

/// Share of the duration below which times do not tell the length of a step to 1e-6, from which
/// factors are known to be of the same length.
constexpr double shortest = 1e6 * std::numeric_limits<double>::epsilon();
/// Halvings between two samples because branches of many contacts were not found at once, down to a
/// thousandth of a step. Forces that hold each other have no branches to be found, however short.
constexpr int most_unsettled = 10;

/// State in which the quasi-static path begins; empty if the caller ended the search for it.
std::optional<State> equilibrium(const Model& model, const MotionOptions& options) {
  Options statics;
  bool ended = false;
  // The path itself is not asked for: it ends after its first short step.
  statics.progress = [&](double share) {
    ended = options.progress && !options.progress(0.0);
    return !ended && share <= 0.0;
  };
  Path path = solve(model, statics);
  if (ended) return {};
  return std::move(path.states.front());
}

void check(const Model& model, const MotionOptions& options) {
  model.validate();
  kernel::require(options.steps >= 1, "steps", static_cast<double>(options.steps), ">= 1");
  kernel::require(options.sample_every >= 1, "sample_every",
                  static_cast<double>(options.sample_every), ">= 1");
  kernel::require(options.theta >= 0.5 && options.theta <= 1.0, "theta", options.theta, "0.5 to 1");
  kernel::require(options.restitution >= 0.0 && options.restitution <= 1.0, "restitution",
                  options.restitution, "0 to 1");
  kernel::require(options.displacement_tolerance >= 0.0, "displacement_tolerance",
                  options.displacement_tolerance, ">= 0 m");
  kernel::require(options.displacement_tolerance == 0.0 || options.watched_node < 0, "watched_node",
                  options.watched_node, "-1 where steps are not equal");
  kernel::require(options.most_iterations >= 1, "most_iterations", options.most_iterations, ">= 1");
  const auto nodes = static_cast<Eigen::Index>(model.nodes.size());
  kernel::require(options.watched_node >= -1 && options.watched_node < nodes, "watched_node",
                  options.watched_node, "a node, or -1");
  if (!options.start) return;
  for (const auto* of_nodes : {&options.start->displacement, &options.start->velocity}) {
    kernel::require(of_nodes->cols() == nodes, "nodes of the start",
                    static_cast<double>(of_nodes->cols()), "as many as the truss has");
  }
}

/// What an attempted step is off by [m]; infinite where it has no solution that is found.
double attempt(detail::Stepper& stepper, double to, bool give_up, bool is_last) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  try {
    return stepper.attempt(to, give_up).value_or(unknown);
  } catch (const Failure&) {
    if (is_last) throw;
    return unknown;
  }
}

/// A motion that is being made.
class Run {
 public:
  Run(const Model& model, const Inertia& inertia, const MotionOptions& options)
      : model_(model),
        options_(options),
        duration_(model.programs.front().duration()),
        system_(model),
        bodies_(system_, inertia),
        stepper_(system_, bodies_, options) {}

  Motion make() &&;

 private:
  bool begin();
  void make_equal_steps();
  void make_steps_within_tolerance();
  /// From one sample to the next. @param level halvings of the span for its first step; out: for
  /// the first of the next
  void make_span(long first, long count, int& level);
  /// Makes a step as long as the ladder says, or shortens it. @param to where it ends, and the
  /// length of the whole span [s]; @param unsettled tries in the span that found no solution
  /// @return whether the step is made
  bool try_step(double to, double span, detail::Ladder& ladder, int& unsettled);

  /// Changes of joints and their heat in a step that is taken. @param length of it [s]
  template <class Take>
  void note(double length, const Take& take);
  void sample();
  void watch(long step);
  /// Tells how far it is. @param time [s]; @return whether to go on
  bool go_on(double time);
  /// Time of a step of the options [s]; of the whole, for a sum of steps would not end at the end.
  double time_of(double steps) const {
    return duration_ * (steps / static_cast<double>(options_.steps));
  }

  const Model& model_;
  const MotionOptions& options_;
  const double duration_;  // [s]
  const detail::System system_;
  const detail::Bodies bodies_;
  detail::Stepper stepper_;
  Motion motion_;
};

bool Run::begin() {
  if (options_.start) {
    stepper_.begin(bodies_.free_part(options_.start->displacement),
                   bodies_.free_part(options_.start->velocity), nullptr);
    return true;
  }
  const std::optional<State> start = equilibrium(model_, options_);
  if (!start) return false;
  stepper_.begin(bodies_.free_part(start->displacement), VectorXd::Zero(system_.displacements()),
                 &*start);
  return true;
}

void Run::sample() {
  State state;
  stepper_.describe(state);
  motion_.states.push_back(std::move(state));
  motion_.moving.push_back({bodies_.of_nodes(stepper_.velocity()), stepper_.kinetic_energy(),
                            stepper_.account().damping, stepper_.account().impact,
                            stepper_.account().drives, stepper_.drive_moment()});
}

void Run::watch(long step) {
  if (options_.watched_node < 0) return;
  motion_.watched_velocity.col(step) =
      system_.displacement(options_.watched_node, stepper_.velocity());
}

bool Run::go_on(double time) {
  const double share = time / duration_;
  motion_.complete = !options_.progress || options_.progress(share) || share == 1.0;
  return motion_.complete;
}

template <class Take>
void Run::note(double length, const Take& take) {
  detail::Statuses before;
  before = stepper_.statuses();  // a copy: the step changes them
  const auto heat = [&] { return stepper_.account().friction.sum() + stepper_.account().impact; };
  const double heat_before = heat();
  take();
  ++motion_.steps;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const JointStatus after = stepper_.statuses()[i];
    if (before[i] == after) continue;
    const double time = stepper_.time();
    motion_.events.push_back({time, length, model_.temperature_change(0, 1.0, time),
                              static_cast<int>(i), before[i], after});
    motion_.event_heat.push_back(heat() - heat_before);
  }
}

void Run::make_equal_steps() {
  if (options_.watched_node >= 0) motion_.watched_velocity.resize(3, options_.steps + 1);
  watch(0);
  for (long k = 1; k <= options_.steps && motion_.complete; ++k) {
    const double to = time_of(static_cast<double>(k));
    note(motion_.time_step, [&] { stepper_.advance(to); });
    watch(k);
    if (k == options_.steps || k % options_.sample_every == 0) sample();
    go_on(to);
  }
}

void Run::make_steps_within_tolerance() {
  motion_.time_step = duration_;
  int level = 0;
  for (long k = 0; k < options_.steps && motion_.complete; k += options_.sample_every) {
    make_span(k, std::min(options_.sample_every, options_.steps - k), level);
  }
}

void Run::make_span(long first, long count, int& level) {
  const double span = time_of(static_cast<double>(count));
  const int most = std::max(static_cast<int>(std::log2(span / (shortest * duration_))), 0);
  detail::Ladder ladder(level, most);
  int unsettled = 0;
  const auto time_at = [&](double share) {
    return time_of(static_cast<double>(first) + share * static_cast<double>(count));
  };
  while (!ladder.done()) {
    const bool made = try_step(time_at(ladder.to()), span, ladder, unsettled);
    if (made && !ladder.done() && !go_on(stepper_.time())) return;
  }
  level = ladder.level();
  sample();
  go_on(time_of(static_cast<double>(first + count)));
}

bool Run::try_step(double to, double span, detail::Ladder& ladder, int& unsettled) {
  const bool give_up = unsettled < most_unsettled && !ladder.is_shortest();
  const double off = attempt(stepper_, to, give_up, ladder.is_shortest());
  if (!std::isfinite(off)) ++unsettled;
  const bool too_far = off > options_.displacement_tolerance;
  if (too_far && !ladder.is_shortest()) {
    ++motion_.rejected_steps;
    // A force that turns up in a step puts it off by its square, a jump of the velocity by its
    // first power: then there is another try.
    const double halvings = 0.5 * std::log2(off / options_.displacement_tolerance);
    ladder.shorten(std::isfinite(off) ? std::max(static_cast<int>(std::ceil(halvings)), 1) : 1);
    return false;
  }
  if (too_far) ++motion_.inexact_steps;
  const double length = span * ladder.length();
  note(length, [&] { stepper_.accept(); });
  motion_.time_step = std::min(motion_.time_step, length);
  // Of second order: a step of twice the length is eight times as far off.
  ladder.accept(8.0 * off <= options_.displacement_tolerance);
  return true;
}

Motion Run::make() && {
  motion_.unknowns = system_.displacements();
  motion_.time_step = duration_ / static_cast<double>(options_.steps);
  if (!begin()) {
    motion_.complete = false;
    return std::move(motion_);
  }
  sample();
  if (options_.displacement_tolerance > 0.0) {
    make_steps_within_tolerance();
  } else {
    make_equal_steps();
  }
  motion_.iterations = stepper_.iterations();
  motion_.factorizations = stepper_.factorizations();
  motion_.largest_contact_merit = stepper_.largest_merit();
  motion_.undetermined = stepper_.undetermined();
  motion_.jammed = stepper_.jammed();
  motion_.negative_dissipation = stepper_.account().negative;
  return std::move(motion_);
}

}  // namespace

Motion simulate(const Model& model, const Inertia& inertia, const MotionOptions& options) {
  check(model, options);
  return Run(model, inertia, options).make();
}

}  // namespace statejump::truss
