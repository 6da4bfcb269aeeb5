// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/linkage/run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "numerics/change_between.hpp"
#include "rates.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::linkage {

using kernel::require;
using thermal::Branch;

namespace detail {
namespace {

template <class Terms>
typename Terms::Vector step(const Constants& k, const Trajectory& trajectory, double t, double h,
                            const typename Terms::Vector& y, const State& memory) {
  typename Terms::Vector k1, k2, k3, k4, stage;
  const Temperature middle = trajectory(t + 0.5 * h);
  rates<Terms>(k, y, trajectory(t), memory, k1);
  for (std::size_t i = 0; i < y.size(); ++i) stage[i] = y[i] + 0.5 * h * k1[i];
  rates<Terms>(k, stage, middle, memory, k2);
  for (std::size_t i = 0; i < y.size(); ++i) stage[i] = y[i] + 0.5 * h * k2[i];
  rates<Terms>(k, stage, middle, memory, k3);
  for (std::size_t i = 0; i < y.size(); ++i) stage[i] = y[i] + h * k3[i];
  rates<Terms>(k, stage, trajectory(t + h), memory, k4);
  for (std::size_t i = 0; i < y.size(); ++i) {
    stage[i] = y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
  }
  return stage;
}

/// Finds |d| = c within a step that starts without contact, by bisection on the step length.
template <class Terms>
FirstContact locate(const Constants& k, const Trajectory& trajectory, double t, double h,
                    const typename Terms::Vector& y) {
  const auto touches = [&](double tau) {
    return overlap<Terms>(k, step<Terms>(k, trajectory, t, tau, y, {}),
                          trajectory(t + tau).change) > 0.0;
  };
  const double after = numerics::change_between(0.0, h, touches, numerics::fine * h).after;
  return {t + after, trajectory(t + after).change};
}

template <class Terms>
class FixedStepRun {
 public:
  FixedStepRun(const Linkage& model, const State& start)
      : model_(model), k_(constants(model)), memory_(start), y_(pack<Terms>(start)) {}

  Run integrate(const thermal::Program& program, const RunOptions& options) {
    heat_ = program.temperature_change(0.0);
    record();
    touching_ = overlap<Terms>(k_, y_, heat_) > 0.0;
    if (touching_) {
      run_.first_contact = FirstContact{0.0, heat_};
      memory_.impact_speed = std::max(memory_.impact_speed, k_.law.smallest_impact_speed);
    }
    long done = 0;
    try {
      for (const Branch& branch : thermal::monotone_branches(program)) {
        const Trajectory trajectory(branch);
        const double length = branch.end_time - branch.start_time;
        const long steps = std::max(1L, std::lround(options.steps * (length / program.duration())));
        const double h = length / static_cast<double>(steps);
        run_.steps += steps;
        for (long i = 0; i < steps; ++i) {
          advance(trajectory, branch.start_time + static_cast<double>(i) * h, h, i + 1 == steps);
          ++done;
          if (options.sample_every > 0 && done % options.sample_every == 0) record();
        }
      }
    } catch (const std::domain_error& error) {
      throw failure(error, time_, heat_);
    }
    if (run_.samples.back().time != time_) record();
    run_.energy_residue = energy_residue(model_, run_.samples.front(), run_.samples.back());
    return std::move(run_);
  }

 private:
  void advance(const Trajectory& trajectory, double from, double h, bool last) {
    const auto next = step<Terms>(k_, trajectory, from, h, y_, memory_);
    const Temperature before = trajectory(from);
    time_ = last ? trajectory.branch.end_time : from + h;
    heat_ = last ? trajectory.branch.end : trajectory(time_).change;
    const double beyond = overlap<Terms>(k_, next, heat_);
    if (!std::isfinite(beyond)) {
      throw NotFinite();
    }
    const bool touches = beyond > 0.0;
    if (touches && !touching_) {
      ++run_.contacts;
      if (!run_.first_contact) run_.first_contact = locate<Terms>(k_, trajectory, from, h, y_);
      memory_.impact_speed =
          std::max(contact_point<Terms>(k_, y_, before, radii_at(k_, before.change)).approach_speed,
                   k_.law.smallest_impact_speed);
    }
    if constexpr (Terms::all_terms) {
      if (k_.friction_has_memory && (touches || touching_)) remember(next, touches, before.rate);
    }
    if (!touches) {
      memory_.contact = {};
      memory_.impact_speed = 0.0;
    }
    y_ = next;
    if constexpr (Terms::all_terms) y_[slide] = 0.0;
    touching_ = touches;
  }

  void remember(const typename Terms::Vector& next, bool touches, double rate) {
    NormalForce normal{};
    if (touches) {
      const Radii radii = radii_at(k_, heat_);
      const ContactPoint at = contact_point<Terms>(k_, next, {heat_, rate}, radii);
      normal = normal_force(k_, at, radii, memory_.impact_speed);
    }
    friction_heat_ += friction(k_, normal, next[slide], memory_.contact).dissipation;
  }

  void record() {
    unpack(y_, memory_);
    run_.samples.push_back({time_, heat_, memory_, account<Terms>(y_, friction_heat_)});
  }

  const Linkage& model_;
  Constants k_;
  State memory_;  // positions and velocities are those of the last sample
  typename Terms::Vector y_;
  Run run_;
  double time_ = 0.0;
  double heat_ = 0.0;
  double friction_heat_ = 0.0;  // for a law with memory
  bool touching_ = false;
};

}  // namespace

/// Largest step [s] for which the method does not amplify the links' axial motion: |λ| h <= 2.78,
/// slightly inside the stability bounds on the real axis (2.785) and the imaginary axis (2.828).
double stable_step(const Linkage& model) {
  const Constants k = constants(model);
  const double zeta = model.axial_damping_ratio;
  const double faster = zeta > 1.0 ? zeta + std::sqrt(zeta * zeta - 1.0) : 1.0;
  return 2.78 / (faster * std::max(angular_frequency(k.ab), angular_frequency(k.bc)));
}

Failure failure(const std::domain_error& error, double time, double temperature_change) {
  const bool not_finite = dynamic_cast<const NotFinite*>(&error) != nullptr;
  FailureFields fields{not_finite ? FailureKind::not_finite : FailureKind::law_left_range};
  fields.time = time;
  fields.temperature_change = temperature_change;
  fields.cause = error.what();
  if (const auto* left = dynamic_cast<const kernel::laws::DepthOutOfRange*>(&error)) {
    fields.numbers = {{"penetration_depth_m", left->depth()}, {"limit_m", left->limit()}};
  }
  return Failure(std::move(fields));
}

double energy_residue(const Linkage& model, const Sample& begin, const Sample& end) {
  return end.account.thermal_work - end.account.dissipation() -
         (energy(model, end.state, end.temperature_change).sum() -
          energy(model, begin.state, begin.temperature_change).sum());
}

}  // namespace detail

Run simulate(const Linkage& model, const thermal::Program& program, const State& start,
             const RunOptions& options) {
  model.validate();
  program.validate();
  require(options.steps >= 1, "steps", options.steps, ">= 1");
  require(options.sample_every >= 0, "sample_every", options.sample_every, ">= 0");
  const double needed = std::ceil(program.duration() / detail::stable_step(model));
  char range[64];
  std::snprintf(range, sizeof range, "at least %.0f, or the links' ringing is unstable", needed);
  require(options.steps >= needed, "steps", options.steps, range);
  if (detail::constants(model).all_terms()) {
    return detail::FixedStepRun<detail::AllTerms>(model, start).integrate(program, options);
  }
  return detail::FixedStepRun<detail::BasicTerms>(model, start).integrate(program, options);
}

}  // namespace statejump::linkage
