// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "dyadic_step_size.hpp"
#include "smooth_stepper.hpp"
#include "start_of_motion.hpp"
#include "statejump/failure.hpp"
#include "statejump/kernel/require.hpp"
#include "statejump/truss/motion.hpp"
#include "stepper.hpp"

namespace statejump::truss {

namespace {

using detail::index;
using Eigen::VectorXd;

/// Smallest step divided by the duration. Below it, the rounding of times exceeds 1e-6 of the step,
/// up to which steps count as equal and share factors.
constexpr double shortest = 1e6 * std::numeric_limits<double>::epsilon();
/// Largest number of halvings between two samples if the statuses are not found; ten give a
/// thousandth of a step. If reactions are self-equilibrated, statuses are not found at any step
/// length.
constexpr int most_unsettled = 10;

/// Most halvings of an equal step without solution.
constexpr int most_halvings = 16;
/// Substeps of one length before a longer one is attempted.
constexpr int before_longer = 8;

/// Limit of steps and substeps over requested steps; at least the substeps of one step are allowed.
/// Shorter equal steps are cheaper than more substeps.
constexpr long most_parts = 10;

/// After this many consecutive attempts without progress, a step counts as unsolvable.
constexpr int most_tries = 1000;

void check(const Model& model, const MotionOptions& options) {
  detail::check_motion(model, options);
  kernel::require(options.theta >= 0.5 && options.theta <= 1.0, "theta", options.theta, "0.5 to 1");
  kernel::require(options.restitution >= 0.0 && options.restitution <= 1.0, "restitution",
                  options.restitution, "0 to 1");
  kernel::require(options.displacement_tolerance >= 0.0, "displacement_tolerance",
                  options.displacement_tolerance, ">= 0 m");
  kernel::require(options.displacement_tolerance == 0.0 || options.watched_node < 0, "watched_node",
                  options.watched_node, "-1 where steps are not equal");
  kernel::require(options.most_iterations >= 1, "most_iterations", options.most_iterations, ">= 1");
}

/// Error of an attempted step [m]; infinite without a solution.
double attempt(detail::Stepper& stepper, double to, bool give_up, bool is_last) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  try {
    return stepper.attempt(to, give_up).value_or(unknown);
  } catch (const Failure&) {
    if (is_last) throw;
    return unknown;
  }
}

/// A motion in progress.
class Run {
 public:
  Run(const Model& model, const Inertia& inertia, const MotionOptions& options)
      : model_(model),
        options_(options),
        duration_(model.programs.front().duration()),
        system_(model),
        bodies_(system_, inertia),
        stepper_(system_, bodies_, options) {
    if (options.displacement_tolerance > 0.0) {
      smooth_ = detail::SmoothStepper::of(system_, bodies_, inertia, options);
    }
  }

  Motion make() &&;

 private:
  bool begin();
  void make_equal_steps();
  /// Takes one of equal steps. If it has no solution, it is divided into halves.
  /// @param level on input the number of halvings for the first substep, on output that for the
  /// next equal step
  void make_equal_step(long number, int& level);
  void make_steps_within_tolerance();
  /// Integrates over a span, from one sample to the next.
  /// @param level on input the number of halvings for the first step, on output that for the next
  /// span
  void make_span(long first, long count, int& level);
  /// Takes a step of the present size if its error is small enough; otherwise shortens it.
  /// @param to time at the end of the step [s]
  /// @param span length of the whole span [s]
  /// @param unsettled number of attempts in the span that had no solution
  /// @return whether the step was taken
  bool try_step(double to, double span, detail::DyadicStepSize& step_size, int& unsettled);
  /// Steps with event location, for a truss that SmoothStepper supports.
  void make_smooth_steps();
  [[noreturn]] void fail() const;
  /// @throws Failure if there are too many substeps
  /// @param length length of the last substep [s]
  void check_parts(double length) const;

  /// Calls `take`, which commits a step, and records its heat and status changes.
  /// @param length length of the step [s]
  template <class Stepper, class Take>
  void note(const Stepper& stepper, double length, const Take& take);
  template <class Stepper>
  void sample(Stepper& stepper);
  void watch(long step);
  /// Reports the progress.
  /// @param time [s]
  /// @return whether to continue
  bool go_on(double time);
  /// Time after this many steps of the options [s]. It is a fraction of the duration: a sum of
  /// lengths would not end exactly there.
  double time_of(double steps) const {
    return duration_ * (steps / static_cast<double>(options_.steps));
  }

  const Model& model_;
  const MotionOptions& options_;
  const double duration_;  // [s]
  const detail::System system_;
  const detail::Bodies bodies_;
  detail::Stepper stepper_;
  std::unique_ptr<detail::SmoothStepper> smooth_;  ///< Null if the truss is not supported.
  Motion motion_;
  int settled_ = 0;  ///< Steps or substeps since the last one without solution.
};

bool Run::begin() {
  const auto at = [&](const VectorXd& q, const VectorXd& v, const State* equilibrium) {
    if (smooth_) {
      smooth_->begin(q, v, equilibrium);
    } else {
      stepper_.begin(q, v, equilibrium);
    }
  };
  if (options_.start) {
    const auto free = [&](const Eigen::Matrix3Xd& of_nodes) {
      return bodies_.free_part(detail::sites_of(system_, of_nodes));
    };
    at(free(options_.start->displacement), free(options_.start->velocity), nullptr);
    return true;
  }
  const std::optional<State> start = detail::equilibrium(model_, options_);
  if (!start) return false;
  at(bodies_.free_part(detail::sites_of(model_, *start)), VectorXd::Zero(system_.displacements()),
     &*start);
  return true;
}

template <class Stepper>
void Run::sample(Stepper& stepper) {
  State state;
  stepper.describe(state);
  motion_.states.push_back(std::move(state));
  motion_.moving.push_back({bodies_.of_nodes(stepper.velocity())
                                .leftCols(static_cast<Eigen::Index>(model_.nodes.size())),
                            stepper.kinetic_energy(), stepper.account().damping,
                            stepper.account().impact, stepper.account().drives,
                            stepper_.drive_moment()});
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

template <class Stepper, class Take>
void Run::note(const Stepper& stepper, double length, const Take& take) {
  detail::Statuses before;
  before = stepper.statuses();  // copy: the step changes the original
  const auto heat = [&] { return stepper.account().friction.sum() + stepper.account().impact; };
  const double heat_before = heat();
  take();
  for (std::size_t i = 0; i < before.size(); ++i) {
    const JointStatus after = stepper.statuses()[i];
    if (before[i] == after) continue;
    const double time = stepper.time();
    motion_.events.push_back({time, length, model_.temperature_change(0, 1.0, time),
                              static_cast<int>(i), before[i], after});
    motion_.event_heat.push_back(heat() - heat_before);
  }
}

void Run::make_equal_steps() {
  if (options_.watched_node >= 0) motion_.watched_velocity.resize(3, options_.steps + 1);
  watch(0);
  int level = 0;
  for (long k = 1; k <= options_.steps && motion_.complete; ++k) {
    make_equal_step(k, level);
    watch(k);
    if (k == options_.steps || k % options_.sample_every == 0) sample(stepper_);
    go_on(time_of(static_cast<double>(k)));
  }
}

void Run::make_equal_step(long number, int& level) {
  const double whole = time_of(1.0);
  const int most =
      std::clamp(static_cast<int>(std::log2(whole / (shortest * duration_))), 0, most_halvings);
  detail::DyadicStepSize step_size(level, most);
  // Without numerical damping, oscillations faster than the step persist, and steps may have no
  // solution. Implicit Euler damps them.
  bool damps = level > 0;
  int unsettled = 0;
  while (!step_size.done()) {
    const double to = time_of(static_cast<double>(number - 1) + step_size.to());
    const double length = whole * step_size.length();
    bool made = false;
    try {
      note(stepper_, length, [&] {
        const bool give_up = unsettled < most_unsettled && !step_size.is_shortest();
        made = damps ? stepper_.advance_damped(to, give_up) : stepper_.advance(to);
      });
    } catch (const Failure&) {
      if (damps && step_size.is_shortest()) throw;
      made = false;
    }
    if (!made) {
      ++motion_.rejected_steps;
      ++unsettled;
      settled_ = 0;
      if (damps) step_size.shorten(1);
      damps = true;
      continue;
    }
    ++motion_.steps;
    check_parts(length);
    if (damps) ++motion_.inexact_steps;
    motion_.time_step = std::min(motion_.time_step, length);
    const int before = step_size.level();
    step_size.accept(++settled_ >= before_longer);
    if (step_size.level() < before) settled_ = 0;
  }
  level = step_size.level();
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
  detail::DyadicStepSize step_size(level, most);
  int unsettled = 0;
  const auto time_at = [&](double share) {
    return time_of(static_cast<double>(first) + share * static_cast<double>(count));
  };
  while (!step_size.done()) {
    const bool made = try_step(time_at(step_size.to()), span, step_size, unsettled);
    if (made && !step_size.done() && !go_on(stepper_.time())) return;
  }
  level = step_size.level();
  sample(stepper_);
  go_on(time_of(static_cast<double>(first + count)));
}

bool Run::try_step(double to, double span, detail::DyadicStepSize& step_size, int& unsettled) {
  const bool give_up = unsettled < most_unsettled && !step_size.is_shortest();
  const double off = attempt(stepper_, to, give_up, step_size.is_shortest());
  if (!std::isfinite(off)) ++unsettled;
  const bool too_far = off > options_.displacement_tolerance;
  if (too_far && !step_size.is_shortest()) {
    ++motion_.rejected_steps;
    // A force that starts within the step causes an error of second order. A velocity jump causes
    // one of first order and needs a further attempt.
    const double halvings = 0.5 * std::log2(off / options_.displacement_tolerance);
    step_size.shorten(std::isfinite(off) ? std::max(static_cast<int>(std::ceil(halvings)), 1) : 1);
    return false;
  }
  if (too_far) ++motion_.inexact_steps;
  const double length = span * step_size.length();
  note(stepper_, length, [&] { stepper_.accept(); });
  ++motion_.steps;
  motion_.time_step = std::min(motion_.time_step, length);
  // The error is of third order: eight times as large at double length.
  step_size.accept(8.0 * off <= options_.displacement_tolerance);
  return true;
}

void Run::make_smooth_steps() {
  const double tolerance = options_.displacement_tolerance;
  long next_sample = options_.sample_every;
  const auto sample_time = [&] {
    return time_of(static_cast<double>(std::min(next_sample, options_.steps)));
  };
  double length = sample_time();
  double after_change = length;  // length of the first step after a change of status
  bool has_changed = true;
  int standing = 0;              // attempts without progress
  std::optional<double> change;  // time at which the step should end
  while (smooth_->time() < duration_ && motion_.complete) {
    const double from = smooth_->time();
    const double until = std::min(smooth_->smooth_until(), sample_time());
    double to = from + length < until - shortest * duration_ ? from + length : until;
    if (change) to = *change;
    const double tried = to - from;
    if (++standing > most_tries) fail();
    const std::optional<double> off = smooth_->attempt(to);
    // Step ratio from the leading error term.
    constexpr double none = std::numeric_limits<double>::min();
    const double best =
        off ? std::pow(tolerance / std::max(*off, none), 1.0 / smooth_->error_power()) : 0.5;
    const double share = std::clamp(0.9 * best, 0.1, 5.0);
    const bool too_far = !off || *off > tolerance;
    if (too_far && tried > shortest * duration_) {
      ++motion_.rejected_steps;
      length = tried * std::min(share, 0.9);
      change.reset();
      continue;
    }
    if (!off) fail();
    change = smooth_->first_change();
    if (change && *change <= from) {
      // The change is at the start of the step.
      int turned = 0;
      note(*smooth_, 0.0, [&] { turned = smooth_->turn(); });
      if (turned == 0) length = 0.25 * tried;
      has_changed = true;
      change.reset();
      continue;
    }
    // A change within rounding of the step's end counts as a change at the end.
    if (change && *change < to - 1e-6 * tried) {
      ++motion_.rejected_steps;
      continue;
    }
    if (too_far) ++motion_.inexact_steps;
    motion_.time_step = std::min(motion_.time_step, tried);
    int turned = 0;
    note(*smooth_, tried, [&] {
      smooth_->accept();
      turned = smooth_->turn();
    });
    ++motion_.steps;
    standing = 0;
    change.reset();
    if (has_changed) after_change = tried * share;  // the length that the tolerance allowed
    // Steps of equal length reuse the factors.
    if (share > 1.25) length = std::max(length, tried * share);
    has_changed = turned > 0;
    if (has_changed) length = std::min(length, after_change);
    if (smooth_->time() == sample_time()) {
      sample(*smooth_);
      next_sample += options_.sample_every;
    }
    go_on(smooth_->time());
  }
}

void Run::fail() const {
  FailureFields fields{FailureKind::not_converged};
  fields.time = smooth_->time();
  fields.temperature_change = model_.temperature_change(0, 1.0, smooth_->time());
  fields.sought = "no step of the motion";
  const Joint& joint = model_.joints[index(smooth_->turning_joint())];
  fields.joints.push_back({kind_of(joint), name_of(joint)});
  throw Failure(std::move(fields));
}

void Run::check_parts(double length) const {
  const long parts = motion_.steps + motion_.rejected_steps;
  if (parts <= std::max(most_parts * options_.steps, 1L << most_halvings)) return;
  FailureFields fields{FailureKind::too_many_steps};
  fields.time = stepper_.time();
  fields.temperature_change = model_.temperature_change(0, 1.0, stepper_.time());
  fields.sought = "no step of the motion";
  fields.numbers = {{"steps", static_cast<double>(parts)}, {"last_step_s", length}};
  throw Failure(std::move(fields));
}

Motion Run::make() && {
  motion_.unknowns = system_.displacements();
  motion_.time_step = duration_ / static_cast<double>(options_.steps);
  if (!begin()) {
    motion_.complete = false;
    return std::move(motion_);
  }
  if (smooth_) {
    sample(*smooth_);
    motion_.time_step = duration_;
    make_smooth_steps();
    motion_.factorizations = smooth_->factorizations();
    return std::move(motion_);
  }
  sample(stepper_);
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
