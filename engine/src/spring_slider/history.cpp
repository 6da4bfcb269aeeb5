// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/spring_slider/history.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "statejump/kernel/require.hpp"

namespace statejump::spring_slider {

namespace {

/// Segment with start_time <= time < end_time; after the end, the last segment. `hint` is the index
/// found for the previous time. It is tried first, because times usually ascend. Throws
/// std::invalid_argument for a time in an omitted cycle.
const Segment& segment_at(const std::vector<Segment>& segments, double time, std::size_t& hint) {
  const auto holds = [&](std::size_t i) {
    return segments[i].start_time <= time && time < segments[i].end_time;
  };
  if (!holds(hint)) {
    const auto later = [](double t, const Segment& segment) { return t < segment.start_time; };
    const auto after = std::upper_bound(segments.begin() + 1, segments.end(), time, later);
    hint = static_cast<std::size_t>(after - segments.begin()) - 1;
    kernel::require(holds(hint) || hint + 1 == segments.size(), "time", time,
                    "one in a cycle that the path keeps [s]");
  }
  return segments[hint];
}

}  // namespace

void report_temperatures_of(thermal::Program reported, Path& path) {
  reported.validate();
  for (Event& event : path.events)
    event.temperature_change = reported.temperature_change(event.time);
  path.largest_compression_temperature_change =
      reported.temperature_change(path.largest_compression_time);
  path.reported = std::move(reported);
}

History sample(const Path& path, const Eigen::Ref<const Eigen::VectorXd>& times) {
  const SpringSlider& model = path.model;
  const Eigen::Index n = times.size();
  History history;
  for (Eigen::VectorXd* column :
       {&history.time, &history.temperature_change, &history.displacement, &history.axial_force,
        &history.friction_force, &history.stop_force, &history.elastic_energy,
        &history.preload_energy, &history.friction_dissipation, &history.thermal_work}) {
    column->resize(n);
  }
  history.stage.reserve(static_cast<std::size_t>(n));
  std::size_t hint = 0;
  const double start = start_displacement(path.model);
  const auto beyond = [&model](double x) {
    return model.has_soft_stops() ? x - std::clamp(x, -model.clearance_minus, model.clearance_plus)
                                  : 0.0;
  };
  const auto stored = [&](double x) {
    const double preload = (0.5 * model.preload_stiffness * x + model.preload_force) * x;
    const double depth = beyond(x);
    return depth == 0.0 ? preload : preload + 0.5 * model.stop_stiffness * depth * depth;
  };
  const double start_energy = 0.5 * link_stiffness(model, 0.0) * start * start + stored(start);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double time = times[i];
    kernel::require(std::isfinite(time) && time >= 0.0, "time", time, "finite, >= 0 s");
    const Segment& segment = segment_at(path.segments, time, hint);
    const auto [change, x, force] = point_at(model, path.program, segment, time);
    const double preload_force = -model.preload_force - model.preload_stiffness * x;
    const double depth = beyond(x);
    const double soft_stop = depth == 0.0 ? 0.0 : -model.stop_stiffness * depth;
    const double load = force + preload_force + soft_stop;
    const double friction = segment.motion == BlockMotion::stick
                                ? -load
                                : -segment.friction_sign * model.friction_force;
    const double slid =
        segment.motion == BlockMotion::slide ? std::abs(x - segment.start_displacement) : 0.0;
    history.time[i] = time;
    history.temperature_change[i] =
        path.reported ? path.reported->temperature_change(time) : change;
    history.displacement[i] = x;
    history.axial_force[i] = force;
    history.friction_force[i] = friction;
    history.stop_force[i] = segment.motion == BlockMotion::stop ? -(load + friction) : soft_stop;
    history.elastic_energy[i] = 0.5 * force * force / link_stiffness(model, change);
    history.preload_energy[i] = stored(x) - start_energy;
    history.friction_dissipation[i] = segment.friction_dissipation + model.friction_force * slid;
    history.thermal_work[i] = segment.thermal_work + thermal_work(model, segment, change);
    history.stage.push_back(segment.stage);
  }
  return history;
}

}  // namespace statejump::spring_slider
