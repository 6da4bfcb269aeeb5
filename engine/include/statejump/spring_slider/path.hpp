// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "statejump/spring_slider/model.hpp"

namespace statejump::spring_slider {

/// Stage of the loading process, the paper's S1 to S5 (section 3.2) and the two stops.
///
/// The paper defines the five stages for one heating and cooling. This table extends them to later
/// cycles and to negative ΔT. F is the axial force:
///
///   S1  stick, the block has never slid
///   S2  slide in the sense of the first slide
///   S3  stick after a slide, F still pushes in the sense of the last slide (the link unloads)
///   S4  stick after a slide, F pushes against the sense of the last slide
///   S5  slide against the sense of the first slide
///
/// A second cycle therefore runs S3, S4, S2, S3, S4, S5. With a preload spring F may change sign
/// during a slide; S3 or S4 may then be missing. If the preload presses the block on a stop, a path
/// may start there. Between stages the block may move in its play; that stage is `in_play`.
enum class Stage : unsigned char { S1, S2, S3, S4, S5, at_stop_plus, at_stop_minus, in_play };

/// Motion of the block, independent of the stage. `stop`: it rests at a loaded stop. `play`: it
/// moves within its play.
enum class BlockMotion : unsigned char { stick, slide, stop, play };

/// Instants at which the stage changes or ends.
enum class EventKind : unsigned char {
  first_slip,     ///< The block starts to slide for the first time.
  slip,           ///< It starts to slide again, away from the stops.
  stop_reached,   ///< A stop force starts to act: the block arrives, or the stop is loaded again.
  stop_unloaded,  ///< The stop force falls to zero; friction holds the block in place.
  stop_left,      ///< The block starts to slide away from a stop, or separates from a soft one.
  reversal,       ///< The temperature rate changes sign while the block slides; the block sticks.
  force_sign_change,  ///< The axial force passes zero during a stick after a slide.
  cycle_end,          ///< A cycle of the thermal program ends.
  play_opened,        ///< Friction falls to zero; the block moves in its play.
  play_closed         ///< The play is used up; friction holds the block.
};

/// "S1", …, "S5", "at_stop_plus", "at_stop_minus", "in_play".
const char* to_string(Stage stage);
/// "stick", "slide", "stop", "play".
const char* to_string(BlockMotion motion);
/// "first_slip", "slip", "stop_reached", …: the enumerator's name.
const char* to_string(EventKind kind);

/// One event of a path. Its two stages are equal if it is only the end of a cycle.
struct Event {
  EventKind kind;
  Stage stage_before;
  Stage stage_after;
  double time;                ///< [s]
  double temperature_change;  ///< ΔT [K]
  double displacement;        ///< x [m]
  double axial_force;         ///< F [N], positive in compression
};

/// Part of a path without events inside, over which ΔT rises, falls or is constant. x(ΔT) has a
/// closed form there: see displacement().
struct Segment {
  Stage stage;
  BlockMotion motion;
  /// Direction (+1 or −1) of a slide or of the motion in the play, or side of the stop; 0 for a
  /// stick.
  int direction;
  /// Cycle that the segment belongs to, 0, 1, …
  int cycle;
  double start_time;                ///< [s]
  double end_time;                  ///< [s]
  double start_temperature_change;  ///< ΔT [K]
  double end_temperature_change;    ///< ΔT [K]
  double start_displacement;        ///< x [m]
  double end_displacement;          ///< x [m]
  double friction_dissipation;      ///< Heat of friction from the program's start to start_time [J]
  double thermal_work;              ///< Work of the temperature over the same time [J]
  int region = 0;                   ///< Side of the soft stop that the block touches; 0: none.
  /// Direction in which friction is at its limit, also while a stop is loaded; 0 if friction is
  /// below its limit.
  int friction_sign = 0;
  double middle = 0.0;  ///< Of the play at start_time [m].

  /// Whether x follows the temperature.
  bool moves() const { return motion == BlockMotion::slide || motion == BlockMotion::play; }
};

/// Exact quasi-static path of a spring-slider under a thermal program: the result of solve().
struct Path {
  SpringSlider model;
  thermal::Program program;
  /// Segments of the kept cycles in order of time, without gaps within a cycle. The last segment
  /// ends at program.duration(). The list is never empty.
  std::vector<Segment> segments;
  /// Events of the kept cycles.
  std::vector<Event> events;
  /// Displacement at the end of every cycle [m], kept or not.
  std::vector<double> cycle_end_displacements;
  /// Largest compression at the end of any segment of any cycle [N] and the ΔT at which it occurs;
  /// 0 without compression.
  double largest_compression = 0.0;
  double largest_compression_temperature_change = 0.0;  ///< [K]
  double largest_compression_time = 0.0;                ///< [s]
  /// Largest |F| [N] over all cycles. F is monotonic within a segment, so the largest value is at
  /// the end of a segment. See point_at().
  double largest_axial_force = 0.0;
  /// Temperatures reported instead of the program's own, see report_temperatures_of().
  std::optional<thermal::Program> reported;

  /// Displacement at the end minus that at the start [m].
  double state_jump() const { return cycle_end_displacements.back() - start_displacement(model); }

  /// Displacement at the end of cycle `cycle` (from 1) minus that at the start [m]. Throws
  /// std::invalid_argument unless 1 <= cycle <= program.cycles.
  double jump_after_cycle(int cycle) const;
};

/// Computes the exact path from rest at start_displacement(), ΔT = 0. The ΔT of every event is the
/// root of a linear equation, and its time is the closed-form inverse of the program. Stepping and
/// iteration are not needed. Throws std::invalid_argument if model or program is out of range, or
/// if the program gives the link a length l_T <= 0. Limits: events are ordered by ΔT within
/// rounding, so two coincident events may have either order. Without friction a stick has no
/// duration: it starts and ends at one temperature.
Path solve(const SpringSlider& model, const thermal::Program& program);

/// Writes the path of solve() into an existing object and reuses its memory. After an error the
/// content of `path` is unspecified.
void solve(const SpringSlider& model, const thermal::Program& program, Path& path);

/// Computes the path of solve(), but keeps only the first two cycles, the last, and those that
/// sample() needs at `times` [s]. A long program needs memory only for the requested times and the
/// displacement at the end of every cycle. All cycles are computed. Throws std::invalid_argument if
/// a time is negative or not finite.
Path solve(const SpringSlider& model, const thermal::Program& program,
           const Eigen::Ref<const Eigen::VectorXd>& times);

/// Replaces the temperature changes in events, samples and the largest compression by those of the
/// program `reported` at the same times. If the expansion coefficient depends on temperature, the
/// solved program is thermal strain over a constant coefficient, and `reported` the temperature.
/// Segments keep the solved values.
void report_temperatures_of(thermal::Program reported, Path& path);

/// Position x [m] at ΔT [K] within the segment. It is constant in a stick and at a stop; otherwise
/// it is sliding_displacement().
double displacement(const SpringSlider& model, const Segment& segment, double temperature_change);

/// The path at one time.
struct PathPoint {
  double temperature_change;  ///< ΔT [K]
  double displacement;        ///< x [m]
  double axial_force;         ///< F [N], positive in compression
};

/// State of the path at `time` [s] within a segment. The time of an event is rounded, so the
/// program's ΔT may be outside the segment by one ulp. ΔT is therefore clamped to the segment, so
/// that x stays within the stops and |F| within the friction limit.
PathPoint point_at(const SpringSlider& model, const thermal::Program& program,
                   const Segment& segment, double time);

/// Thermal work [J] from the segment's start to ΔT [K].
///
/// The link stores V = E A (x − x_T)²/(2 l_T). At fixed x, heating changes x_T and the stiffness:
/// ∂V/∂l_T = −N − N²/(2 E A), with the tension N = (E A/l_T)(x − x_T). Hence the power is P = −N
/// l̇_T − ½ (E A/l_T²)(x − x_T)² l̇_T. Five-point Gauss-Legendre quadrature integrates P along
/// x(ΔT) of the segment. The integrand is analytic up to l_T = 0, so the relative error is below
/// 1e-15 for |α ΔT| < 0.1. Neither the energies nor the friction enter, so the balance thermal work
/// = elastic energy + dissipation is a check, not a definition.
double thermal_work(const SpringSlider& model, const Segment& segment, double temperature_change);

/// Axial force above the Euler load of an unguided link with square section.
struct EulerLoadExceeded {
  double axial_force;         ///< Largest compression [N].
  double temperature_change;  ///< ΔT [K] at this force.
  double clamped;             ///< Euler load [N] with clamped ends.
  double pinned;              ///< Euler load [N] with pinned ends.
  bool operator==(const EulerLoadExceeded&) const = default;
};

/// The largest compression of a path, if it exceeds the Euler load with pinned ends.
std::optional<EulerLoadExceeded> exceeded_euler_load(const Path& path);

}  // namespace statejump::spring_slider
