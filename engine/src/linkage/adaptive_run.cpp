// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <stdexcept>

#include "numerics/change_between.hpp"
#include "rates.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::linkage {

using kernel::require;
using thermal::Branch;

namespace detail {
namespace {

namespace odeint = boost::numeric::odeint;
using Vector = AllTerms::Vector;

/// Scales of all components for one tolerance: the play for positions, the play times the stiffer
/// link's angular frequency for speeds, E A times the play for energies.
Vector scales(const Constants& k, double clearance, double angular_frequency) {
  Vector result;
  result.fill(k.ab.rigidity * clearance);
  for (std::size_t i = 0; i < 4; ++i) result[i] = clearance;
  for (std::size_t i = 4; i < 8; ++i) result[i] = clearance * angular_frequency;
  result[slide] = 1.0;  // not integrated: no law here has a memory
  return result;
}

class AdaptiveRun {
 public:
  AdaptiveRun(const Linkage& model, const State& start, double tolerance)
      : model_(model), k_(constants(model)), memory_(start), tolerance_(tolerance) {
    const double fastest = std::max(angular_frequency(k_.ab), angular_frequency(k_.bc));
    scales_ = scales(k_, model.radial_clearance(), fastest);
    largest_step_ = 0.5 / fastest;
    y_ = pack<AllTerms>(start);
  }

  Run integrate(const thermal::Program& program, int samples) {
    interval_ = samples > 0 ? program.duration() / samples : program.duration();
    const double heat = program.temperature_change(0.0);
    record(0.0, heat, y_);
    touching_ = overlap<AllTerms>(k_, y_, heat) > 0.0;
    if (touching_) {
      run_.first_contact = FirstContact{0.0, heat};
      memory_.impact_speed = std::max(memory_.impact_speed, k_.law.smallest_impact_speed);
    }
    for (const Branch& branch : thermal::monotone_branches(program)) integrate(branch);
    // Rounding may put the last of the evenly spaced samples just before or after the end of the
    // run.
    if (run_.samples.back().time < time_ * (1.0 - 1e-12)) record(time_, heat_, y_);
    run_.energy_residue = energy_residue(model_, run_.samples.front(), run_.samples.back());
    return std::move(run_);
  }

 private:
  void integrate(const Branch& branch) {
    const Trajectory trajectory(branch);
    const auto system = [&](const Vector& scaled, Vector& rate, double time) {
      rates<AllTerms>(k_, physical(scaled), trajectory(time), memory_, rate);
      for (std::size_t i = 0; i < rate.size(); ++i) rate[i] /= scales_[i];
    };
    auto stepper = odeint::make_dense_output(tolerance_, 0.0, largest_step_,
                                             odeint::runge_kutta_dopri5<Vector>());
    time_ = branch.start_time;
    stepper.initialize(scaled(y_), time_, std::min(largest_step_, branch.end_time - time_));
    while (time_ < branch.end_time) {
      try {
        stepper.do_step(system);
      } catch (const std::domain_error& error) {
        throw failure(error, time_, trajectory(time_).change);
      }
      ++run_.steps;
      const double begin = time_;
      double end = std::min(stepper.current_time(), branch.end_time);
      const auto at = [&](double time) {
        Vector state;
        stepper.calc_state(time, state);
        return physical(state);
      };
      const auto beyond = [&](double time, const Vector& y) {
        return overlap<AllTerms>(k_, y, trajectory(time).change);
      };
      Vector y = at(end);
      if (!std::isfinite(beyond(end, y))) {
        throw failure(NotFinite(), begin, trajectory(begin).change);
      }
      bool touches = beyond(end, y) > 0.0;
      const bool changes = touches != touching_;
      if (changes) {  // the step ends at the edge of contact, where the law's state changes
        const auto changed = [&](double time) { return (beyond(time, at(time)) > 0.0) == touches; };
        end = numerics::change_between(begin, end, changed, numerics::fine * (end - begin)).after;
        y = at(end);
      }
      sample(trajectory, at, end);
      if (changes) change(trajectory, end, y, touches);
      y_ = y;
      time_ = end;
      heat_ = end == branch.end_time ? branch.end : trajectory(end).change;
      if (changes) {
        stepper.initialize(scaled(y_), time_, std::min(largest_step_, stepper.current_time_step()));
      }
    }
  }

  void change(const Trajectory& trajectory, double time, const Vector& y, bool touches) {
    touching_ = touches;
    memory_.impact_speed = 0.0;
    if (!touches) return;
    const Temperature heat = trajectory(time);
    ++run_.contacts;
    if (!run_.first_contact) run_.first_contact = FirstContact{time, heat.change};
    memory_.impact_speed =
        std::max(contact_point<AllTerms>(k_, y, heat, radii_at(k_, heat.change)).approach_speed,
                 k_.law.smallest_impact_speed);
  }

  template <class State>
  void sample(const Trajectory& trajectory, const State& at, double end) {
    for (;;) {
      const double time = static_cast<double>(run_.samples.size()) * interval_;
      if (time > end || time > trajectory.branch.end_time) return;
      record(time, trajectory(time).change, at(time));
    }
  }

  void record(double time, double heat, const Vector& y) {
    State state = memory_;
    unpack(y, state);
    run_.samples.push_back({time, heat, state, account<AllTerms>(y, 0.0)});
  }

  Vector physical(Vector y) const {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] *= scales_[i];
    return y;
  }
  Vector scaled(Vector y) const {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] /= scales_[i];
    return y;
  }

  const Linkage& model_;
  Constants k_;
  State memory_;  // its impact speed is used
  double tolerance_;
  Vector scales_, y_;
  double largest_step_ = 0.0;
  double interval_ = 0.0;
  Run run_;
  double time_ = 0.0;
  double heat_ = 0.0;
  bool touching_ = false;
};

}  // namespace
}  // namespace detail

Run simulate_adaptive(const Linkage& model, const thermal::Program& program, const State& start,
                      const AdaptiveRunOptions& options) {
  model.validate();
  program.validate();
  require(options.relative_tolerance >= 1e-14 && options.relative_tolerance <= 1e-3,
          "relative_tolerance", options.relative_tolerance, "[1e-14, 1e-3]");
  require(options.samples >= 0, "samples", options.samples, ">= 0");
  if (has(model.law.friction, kernel::laws::Trait::has_memory)) {
    throw kernel::OutOfRange("friction_law", law_info(model.law.friction).name,
                             "a law without memory in the adaptive method");
  }
  return detail::AdaptiveRun(model, start, options.relative_tolerance)
      .integrate(program, options.samples);
}

}  // namespace statejump::linkage
