// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "statejump/kernel/require.hpp"

namespace statejump::thermal {

/// Form of one temperature cycle; see Program.
enum class Shape { triangle, half_sine, sine, table };

/// Name of a shape as in case files: "triangle", "half_sine", "sine" or "table".
inline const char* to_string(Shape shape) {
  switch (shape) {
    case Shape::triangle:
      return "triangle";
    case Shape::half_sine:
      return "half_sine";
    case Shape::sine:
      return "sine";
    case Shape::table:
      return "table";
  }
  return "unknown";
}

/// Shape of the given name. Throws kernel::OutOfRange for any other text.
inline Shape shape_of(const std::string& name) {
  for (const Shape shape : {Shape::triangle, Shape::half_sine, Shape::sine, Shape::table}) {
    if (name == to_string(shape)) return shape;
  }
  throw kernel::OutOfRange("shape", name, "one of triangle, half_sine, sine, table");
}

/// Temperature of a part over time, as its change from the stress-free reference temperature.
///
/// ΔT(t) = T(t) − T0, over one cycle of length P, with the local time τ in [0, P]:
///
///   triangle   0 → ΔTmax at P/2 → 0, linear in between
///   half_sine  ΔTmax sin(π τ/P)
///   sine       ΔTmax sin(2π τ/P), so the second half is −ΔTmax
///   table      linear between given points (τ_i, ΔT_i)
///
/// The cycle is repeated `cycles` times. Before t = 0, ΔT is the value at the start of the first
/// cycle; after the last cycle it stays at its end value. ΔTmax < 0 cools first.
///
/// Every length is computed from this total ΔT, never from a sum of increments. A state jump is the
/// difference between two states at the same ΔT, so the program must return exactly to its end
/// value. Each half of a cycle is therefore evaluated from its own end, and cycle k ends at the
/// rounded product (k + 1)·P. Evaluated from the start, sin(π·1) would give 1.2e-16 ΔTmax instead
/// of 0.
///
/// This is a plain value type: set the fields and call validate() once. The other functions do not
/// check.
struct Program {
  Shape shape = Shape::half_sine;
  /// Largest temperature change ΔTmax [K], any finite value. A table ignores it.
  double temperature_change_max = 0.0;
  /// Length P of one cycle [s], > 0. For a table, it must equal the last of its times.
  double period = 1.0;
  /// Number of cycles, >= 1.
  int cycles = 1;
  /// Times of a table [s], strictly increasing from 0 to `period`. Empty for other shapes.
  std::vector<double> table_times;
  /// Temperature changes of a table [K], one per time. The first must be 0, because T0 is the
  /// temperature of the stress-free start. If the cycle repeats, the last one must also be 0.
  std::vector<double> table_temperature_changes;

  /// Throws std::invalid_argument that names the first field out of range, its value and its range.
  void validate() const;

  /// Length of the whole program [s].
  double duration() const { return cycles * period; }

  /// Temperature change ΔT at time t [K]. At the end of every cycle it is exactly the end value.
  double temperature_change(double t) const;

  /// Rate dΔT/dt at time t [K/s]. At a corner it is the rate just after the corner; outside the
  /// program it is 0.
  double temperature_rate(double t) const;
};

/// Stress-free length l0 (1 + α ΔT) [m] of a part with reference length l0 [m] and expansion
/// coefficient α [1/K]; see eq. (2) of the paper. Radii follow the same rule.
inline double length(double l0, double alpha, double temperature_change) {
  return l0 * (1.0 + alpha * temperature_change);
}

/// Monotone part of a program: ΔT rises, falls or is constant, with a closed-form inverse.
///
/// ΔT is linear between the two ends if `angular_frequency` is 0, otherwise
/// ±amplitude sin(ω (t − zero_time)) with the sign of (end − start).
struct Branch {
  double start_time = 0.0;         ///< [s]
  double end_time = 0.0;           ///< [s]
  double start = 0.0;              ///< ΔT at start_time [K]
  double end = 0.0;                ///< ΔT at end_time [K]
  double zero_time = 0.0;          ///< Time of the sine's zero at an end of the branch [s].
  double angular_frequency = 0.0;  ///< ω [rad/s]; 0 for a linear branch.
  double amplitude = 0.0;          ///< |ΔTmax| of the sine [K].
};

/// Time [s] at which the branch passes `temperature_change` [K]. If the branch does not reach the
/// value, the result is the nearer end; if the branch is constant, it is the start. Near the crest
/// of a sine the time is ill-conditioned: an error ε in ΔT changes it by sqrt(2 ε/amplitude)/ω.
inline double time_at(const Branch& branch, double temperature_change) {
  const double span = branch.end - branch.start;
  const double passed = (temperature_change - branch.start) / (span == 0.0 ? 1.0 : span);
  if (span == 0.0 || passed <= 0.0) return branch.start_time;
  if (passed >= 1.0) return branch.end_time;
  double time = 0.0;
  if (branch.angular_frequency == 0.0) {
    const double length = branch.end_time - branch.start_time;
    const double left = (branch.end - temperature_change) / span;
    time = passed < 0.5 ? branch.start_time + passed * length : branch.end_time - left * length;
  } else {
    const double sine = std::clamp(temperature_change / branch.amplitude, -1.0, 1.0);
    const double angle = std::copysign(1.0, span) * std::asin(sine);
    time = branch.zero_time + angle / branch.angular_frequency;
  }
  return std::clamp(time, branch.start_time, branch.end_time);
}

namespace detail {

constexpr double pi = 3.14159265358979323846;

/// Text "name[index]", for messages.
inline std::string entry(const char* name, std::size_t index) {
  return std::string(name).append("[").append(std::to_string(index)).append("]");
}

/// Position of a time within its cycle, measured from both ends of this cycle.
struct CyclePlace {
  double elapsed;    ///< Time since the cycle began [s].
  double remaining;  ///< Time until the cycle ends [s].
};

/// Position of the time 0 <= t < duration in its cycle. The division may round across the end of a
/// cycle; the loops correct this. Cycles end at the products k·period, where the differences are
/// zero.
inline CyclePlace cycle_place(const Program& program, double t) {
  double k = std::floor(t / program.period);
  while (k > 0.0 && t < k * program.period) k -= 1.0;
  while (t >= (k + 1.0) * program.period) k += 1.0;
  return {t - k * program.period, (k + 1.0) * program.period - t};
}

/// Index i of the table interval with times[i] <= tau < times[i + 1]; the last interval for later
/// times. A table has at least two times.
inline std::size_t table_piece(const Program& program, double tau) {
  const auto& times = program.table_times;
  const std::size_t last = times.size() - 2;
  std::size_t i = 0;
  for (std::size_t beyond = last + 1; beyond - i > 1;) {
    const std::size_t middle = i + (beyond - i) / 2;
    (tau < times[middle] ? beyond : i) = middle;
  }
  return i;
}

}  // namespace detail

inline void Program::validate() const {
  kernel::require(std::isfinite(period) && period > 0.0, "period", period, "finite, > 0 s");
  kernel::require(cycles >= 1, "cycles", cycles, ">= 1");
  kernel::require(std::isfinite(duration()), "cycles", cycles,
                  "small enough for a finite duration");
  const std::size_t n = table_times.size();
  const std::size_t n_values = table_temperature_changes.size();
  if (shape != Shape::table) {
    kernel::require(std::isfinite(temperature_change_max), "temperature_change_max",
                    temperature_change_max, "finite [K]");
    kernel::require(n == 0, "length of table_times", static_cast<double>(n),
                    "0 unless shape is table");
    kernel::require(n_values == 0, "length of table_temperature_changes",
                    static_cast<double>(n_values), "0 unless shape is table");
    return;
  }
  kernel::require(n >= 2, "length of table_times", static_cast<double>(n), ">= 2");
  kernel::require(n_values == n, "length of table_temperature_changes",
                  static_cast<double>(n_values), "the length of table_times");
  for (std::size_t i = 0; i < n; ++i) {
    const double time = table_times[i];
    const bool in_order = i == 0 ? time == 0.0 : time > table_times[i - 1];
    kernel::require(std::isfinite(time) && in_order, detail::entry("table_times", i).c_str(), time,
                    i == 0 ? "0 s" : "finite and > the time before it [s]");
    kernel::require(std::isfinite(table_temperature_changes[i]),
                    detail::entry("table_temperature_changes", i).c_str(),
                    table_temperature_changes[i], "finite [K]");
  }
  kernel::require(period == table_times.back(), "period", period, "the last of table_times [s]");
  kernel::require(table_temperature_changes.front() == 0.0, "table_temperature_changes[0]",
                  table_temperature_changes.front(), "0 K, the stress-free start");
  kernel::require(cycles == 1 || table_temperature_changes.back() == 0.0,
                  detail::entry("table_temperature_changes", n - 1).c_str(),
                  table_temperature_changes.back(), "0 K if cycles > 1, else the cycle is open");
}

inline double Program::temperature_change(double t) const {
  // The table is empty unless the shape is a table.
  const auto& table = table_temperature_changes;
  if (t <= 0.0) return table.empty() ? 0.0 : table.front();
  if (t >= duration()) return table.empty() ? 0.0 : table.back();
  const detail::CyclePlace place = detail::cycle_place(*this, t);
  const double nearest = std::min(place.elapsed, place.remaining);
  const double half = 0.5 * period;
  switch (shape) {
    case Shape::triangle:
      return temperature_change_max * std::min(1.0, nearest / half);
    case Shape::half_sine:
      return temperature_change_max * std::sin(detail::pi * nearest / period);
    case Shape::sine: {
      const double from_zero = std::max(0.0, std::min(nearest, half - nearest));
      const double size = temperature_change_max * std::sin(2.0 * detail::pi * from_zero / period);
      return place.elapsed <= place.remaining ? size : -size;
    }
    case Shape::table:
      break;
  }
  const std::size_t i = detail::table_piece(*this, place.elapsed);
  const double first = table_temperature_changes[i];
  const double last = table_temperature_changes[i + 1];
  const double passed = (place.elapsed - table_times[i]) / (table_times[i + 1] - table_times[i]);
  return passed < 1.0 ? first + passed * (last - first) : last;
}

inline double Program::temperature_rate(double t) const {
  if (t < 0.0 || t >= duration()) return 0.0;
  const detail::CyclePlace place = detail::cycle_place(*this, t);
  const double nearest = std::min(place.elapsed, place.remaining);
  const double side = place.elapsed < place.remaining ? 1.0 : -1.0;
  switch (shape) {
    case Shape::triangle:
      return side * temperature_change_max / (0.5 * period);
    case Shape::half_sine: {
      const double omega = detail::pi / period;
      return side * temperature_change_max * omega * std::cos(omega * nearest);
    }
    case Shape::sine: {
      // The rate is symmetric about the middle of the cycle, so it has the same sign in both
      // halves.
      const double omega = 2.0 * detail::pi / period;
      return temperature_change_max * omega * std::cos(omega * nearest);
    }
    case Shape::table:
      break;
  }
  const std::size_t i = detail::table_piece(*this, place.elapsed);
  return (table_temperature_changes[i + 1] - table_temperature_changes[i]) /
         (table_times[i + 1] - table_times[i]);
}

/// Calls `visit(const Branch&)` for all branches of one cycle (cycle = 0, 1, …) in order, without
/// allocating. A table has one branch per interval, other shapes two or three.
template <class Visit>
void for_each_branch(const Program& program, int cycle, Visit&& visit) {
  const double from = cycle * program.period;
  const double to = (cycle + 1) * program.period;
  const double middle = from + 0.5 * program.period;
  const double peak = program.temperature_change_max;
  const double size = std::abs(peak);
  switch (program.shape) {
    case Shape::triangle:
      visit(Branch{from, middle, 0.0, peak, from, 0.0, size});
      visit(Branch{middle, to, peak, 0.0, to, 0.0, size});
      return;
    case Shape::half_sine: {
      const double omega = detail::pi / program.period;
      visit(Branch{from, middle, 0.0, peak, from, omega, size});
      visit(Branch{middle, to, peak, 0.0, to, omega, size});
      return;
    }
    case Shape::sine: {
      const double omega = 2.0 * detail::pi / program.period;
      const double first = from + 0.25 * program.period;
      const double second = from + 0.75 * program.period;
      visit(Branch{from, first, 0.0, peak, from, omega, size});
      visit(Branch{first, second, peak, -peak, middle, omega, size});
      visit(Branch{second, to, -peak, 0.0, to, omega, size});
      return;
    }
    case Shape::table:
      break;
  }
  const auto& times = program.table_times;
  const auto& changes = program.table_temperature_changes;
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    const bool ends_cycle = i + 2 == times.size();
    visit(Branch{from + times[i], ends_cycle ? to : from + times[i + 1], changes[i], changes[i + 1],
                 0.0, 0.0, 0.0});
  }
}

/// All branches of the program in order. Each begins where the previous one ends.
inline std::vector<Branch> monotone_branches(const Program& program) {
  std::vector<Branch> branches;
  for (int cycle = 0; cycle < program.cycles; ++cycle) {
    for_each_branch(program, cycle,
                    [&branches](const Branch& branch) { branches.push_back(branch); });
  }
  return branches;
}

}  // namespace statejump::thermal
