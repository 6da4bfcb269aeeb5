// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/spring_slider/path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "statejump/kernel/require.hpp"

namespace statejump::spring_slider {

namespace {

constexpr double never = std::numeric_limits<double>::quiet_NaN();

int sign(double value) {
  return (value > 0.0) - (value < 0.0);
}

/// Follows the program branch by branch and writes the path. Its state consists of the segment not
/// yet ended, the last event and the direction of the last slide.
class PathFollower {
 public:
  /// `kept`: the cycles to keep, ascending.
  PathFollower(Path& path, const std::vector<int>& kept)
      : path_(path), model_(path.model), kept_(kept) {
    const Start start = start_of(model_);
    open_.start_displacement = open_.end_displacement = start.displacement;
    open_.middle = start.middle;
    const double load =
        -model_.preload_force -
        (link_stiffness(model_, 0.0) + model_.preload_stiffness) * open_.end_displacement;
    const int side = sign(load);
    open_.region = region_of(model_, open_.end_displacement);
    held_ = has_play() ? sign(start.load) : 0;
    const double friction = has_play() ? std::abs(start.load) : model_.friction_force;
    if (is_at_stop(open_.end_displacement, side) && side * load > friction) {
      open_.stage = stage_at_stop(side);
      open_.motion = BlockMotion::stop;
      open_.direction = side;
      open_.friction_sign = has_play() ? held_ : side;
    } else if (has_play() && held_ == 0) {
      open_.stage = Stage::in_play;
      open_.motion = BlockMotion::play;
    }
  }

  void follow(const thermal::Branch& branch) {
    const int heating = sign(branch.end - branch.start);
    if (heating != heating_) close();
    heating_ = heating;
    // While its unloaded length grows, the link pushes the block towards +x.
    drive_ = heating * sign(model_.thermal_expansion);
    branch_ = &branch;
    if (drive_ != 0) {
      if (open_.motion == BlockMotion::slide && open_.direction != drive_) turn_back();
      if (open_.motion == BlockMotion::play) open_.direction = drive_;
      while (pass_next_event()) {
      }
    }
    move_to(branch.end, branch.end_time);
  }

  void end_cycle() {
    close();
    add_event(EventKind::cycle_end, open_.stage, open_.stage);
    path_.cycle_end_displacements.push_back(open_.end_displacement);
    if (keeps()) ++next_kept_;
    ++open_.cycle;
  }

  /// Ends the path: records the force at the end of the last segment, which no next segment
  /// records.
  void end() {
    const Segment& last = path_.segments.back();
    note_force(last, last.end_time);
  }

 private:
  /// Extends the open segment to ΔT at `time`.
  void move_to(double temperature_change, double time) {
    open_.end_temperature_change = temperature_change;
    open_.end_time = std::max(open_.start_time, time);
    open_.end_displacement = displacement(model_, open_, temperature_change);
  }

  /// Ends the current segment and starts the next segment in the same stage.
  void close() {
    const double end = open_.end_temperature_change;
    const double work = thermal_work(model_, open_, end);
    const double slid = open_.motion == BlockMotion::slide
                            ? std::abs(open_.end_displacement - open_.start_displacement)
                            : 0.0;
    if (open_.end_time > open_.start_time) {
      note_force(open_, open_.start_time);
      note_compression();
      if (keeps()) path_.segments.push_back(open_);
    }
    open_.thermal_work += work;
    open_.friction_dissipation += model_.friction_force * slid;
    open_.start_time = open_.end_time;
    open_.start_temperature_change = end;
    open_.start_displacement = open_.end_displacement;
    if (open_.motion == BlockMotion::slide) {
      open_.middle = open_.end_displacement - open_.direction * 0.5 * model_.play;
    }
  }

  /// Whether the current cycle is kept.
  bool keeps() const { return next_kept_ < kept_.size() && kept_[next_kept_] == open_.cycle; }

  void note_force(const Segment& segment, double time) {
    const double force = point_at(model_, path_.program, segment, time).axial_force;
    path_.largest_axial_force = std::max(path_.largest_axial_force, std::abs(force));
  }

  void note_compression() {
    const double force = axial_force(model_, open_.end_temperature_change, open_.end_displacement);
    if (force > path_.largest_compression) {
      path_.largest_compression = force;
      path_.largest_compression_temperature_change = open_.end_temperature_change;
      path_.largest_compression_time = open_.end_time;
    }
  }

  void add_event(EventKind kind, Stage before, Stage after) {
    if (!keeps()) return;
    path_.events.push_back({kind, before, after, open_.start_time, open_.start_temperature_change,
                            open_.start_displacement,
                            spring_slider::axial_force(model_, open_.start_temperature_change,
                                                       open_.start_displacement)});
  }

  void enter(EventKind kind, Stage stage, BlockMotion motion, int direction) {
    close();
    add_event(kind, open_.stage, stage);
    open_.stage = stage;
    open_.motion = motion;
    open_.direction = direction;
    open_.friction_sign = motion == BlockMotion::slide ? direction : 0;
  }

  bool has_play() const { return model_.play > 0.0; }

  bool is_at_stop(double x, int side) const {
    return !model_.has_soft_stops() && x == side * model_.clearance(side);
  }

  void start_slide() {
    const double x = open_.end_displacement;
    EventKind kind = EventKind::slip;
    if (first_slide_ == 0) {
      kind = EventKind::first_slip;
      first_slide_ = drive_;
    } else if (is_at_stop(x, -drive_)) {
      kind = EventKind::stop_left;
    }
    last_slide_ = drive_;
    enter(kind, drive_ == first_slide_ ? Stage::S2 : Stage::S5, BlockMotion::slide, drive_);
  }

  /// @param friction_sign direction in which friction is at its limit when the stop is loaded; 0:
  /// the play is open
  void load_stop(int friction_sign) {
    // x is set to the clearance without rounding, so that an exact comparison shows when the block
    // leaves the stop.
    open_.end_displacement = drive_ * model_.clearance(drive_);
    enter(EventKind::stop_reached, stage_at_stop(drive_), BlockMotion::stop, drive_);
    open_.friction_sign = friction_sign;
  }

  /// End of the play in which the block moves [m].
  double end_of_play() const { return open_.middle + drive_ * 0.5 * model_.play; }

  void open_play(EventKind kind) {
    enter(is_at_stop(open_.end_displacement, -drive_) ? EventKind::stop_left : kind, Stage::in_play,
          BlockMotion::play, drive_);
  }

  void close_play() {
    open_.end_displacement = end_of_play();
    held_ = drive_;
    // D = 0 there: only the link balances the springs.
    const SpringSlider pressed = in_region(model_, open_.region);
    const double force = pressed.preload_force + pressed.preload_stiffness * open_.end_displacement;
    const int side = force == 0.0 ? drive_ : sign(force);
    const Stage stage = last_slide_ == 0 ? Stage::S1 : last_slide_ == side ? Stage::S3 : Stage::S4;
    enter(EventKind::play_closed, stage, BlockMotion::stick, 0);
  }

  /// Passes the edge of a soft stop: switches between the models inside and outside the stop, see
  /// in_region().
  void pass_soft_stop(int side) {
    open_.end_displacement = side * model_.clearance(side);
    enter(open_.region == 0 ? EventKind::stop_reached : EventKind::stop_left, open_.stage,
          open_.motion, drive_);
    open_.region = open_.region == 0 ? side : 0;
  }

  /// ΔT at which a block at x starts to slide in `direction`. At a stop: ΔT at which the stop force
  /// vanishes.
  double onset_from(double x, int direction) const {
    return sliding_temperature(in_region(model_, open_.region), x, direction);
  }

  void turn_back() {
    held_ = open_.direction;
    enter(EventKind::reversal, stage_of_stick(), BlockMotion::stick, 0);
  }

  static Stage stage_at_stop(int side) {
    return side > 0 ? Stage::at_stop_plus : Stage::at_stop_minus;
  }

  /// Stage of a stick that starts at the end of the open segment.
  Stage stage_of_stick() const {
    if (last_slide_ == 0) return Stage::S1;
    const double force = axial_force(model_, open_.end_temperature_change, open_.end_displacement);
    return last_slide_ * force >= 0.0 ? Stage::S3 : Stage::S4;
  }

  /// Whether an event at ΔT occurs before the end of the branch. False for NaN, which means no
  /// event.
  bool is_due(double temperature_change) const {
    return heating_ * (branch_->end - temperature_change) > 0.0;
  }

  /// Extends the segment to the event's ΔT. If rounding or a corner of the program puts the event
  /// before the current ΔT, the event happens at the current ΔT.
  void move_to_event(double temperature_change) {
    const double now = open_.end_temperature_change;
    if (heating_ * (temperature_change - now) > 0.0) {
      move_to(temperature_change, thermal::time_at(*branch_, temperature_change));
    }
  }

  /// Processes the next event of the branch. Returns false if there is none. A branch only passes
  /// through loaded stop → stick → play → stick → slide → stop, so events end.
  bool pass_next_event() {
    if (open_.motion == BlockMotion::stop) return pass_end_of_stop();
    return open_.moves() ? pass_end_of_motion() : pass_end_of_stick();
  }

  bool pass_end_of_stop() {
    if (open_.direction == drive_) return false;
    const double unload = onset_from(open_.end_displacement, open_.friction_sign);
    if (!is_due(unload)) return false;
    move_to_event(unload);
    if (has_play() && open_.friction_sign != open_.direction) {
      held_ = open_.friction_sign;
      enter(EventKind::stop_unloaded, Stage::in_play, BlockMotion::play, drive_);
      open_play(EventKind::play_opened);
      return true;
    }
    held_ = open_.friction_sign;
    enter(EventKind::stop_unloaded, stage_of_stick(), BlockMotion::stick, 0);
    return true;
  }

  /// ΔT at which a moving block arrives at the next stop, or separates from a soft stop.
  double arrival_at(int side) const {
    const double clearance = model_.clearance(side);
    if (open_.region == drive_ || std::isinf(clearance)) return never;
    return sliding_temperature(model_, side * clearance, open_.friction_sign);
  }

  bool pass_end_of_motion() {
    const int side = open_.region == 0 ? drive_ : open_.region;
    const double arrival = arrival_at(side);
    const double closed = open_.motion == BlockMotion::play ? onset_from(end_of_play(), 0) : never;
    if (is_due(closed) && !(heating_ * (arrival - closed) < 0.0)) {
      move_to_event(closed);
      close_play();
      return true;
    }
    if (!is_due(arrival)) return false;
    move_to_event(arrival);
    if (model_.has_soft_stops()) {
      pass_soft_stop(side);
    } else {
      load_stop(open_.friction_sign);
    }
    return true;
  }

  bool pass_end_of_stick() {
    const double x = open_.end_displacement;
    // A play opens when friction reaches zero.
    const int limit = has_play() && held_ != drive_ ? 0 : drive_;
    // Without friction every force moves the block. A rounded onset would cause a tiny stick
    // segment.
    const double onset =
        model_.friction_force == 0.0 ? open_.end_temperature_change : onset_from(x, limit);
    const double zero = force_zero();
    if (is_due(zero) && !(heating_ * (onset - zero) <= 0.0)) {
      move_to_event(zero);
      enter(EventKind::force_sign_change, open_.stage == Stage::S3 ? Stage::S4 : Stage::S3,
            BlockMotion::stick, 0);
      return true;
    }
    if (!is_due(onset)) return false;
    move_to_event(onset);
    if (is_at_stop(x, drive_)) {
      load_stop(limit);
    } else if (limit == 0) {
      open_play(EventKind::play_opened);
    } else {
      start_slide();
    }
    return true;
  }

  /// ΔT at which the axial force passes zero (x_T = x) during a stick after a slide. NaN if the
  /// force moves away from zero.
  double force_zero() const {
    const Stage towards_zero = drive_ == last_slide_ ? Stage::S4 : Stage::S3;
    if (open_.stage != towards_zero) return never;
    return open_.end_displacement / (model_.stress_free_length * model_.thermal_expansion);
  }

  Path& path_;
  const SpringSlider& model_;
  const std::vector<int>& kept_;
  std::size_t next_kept_ = 0;
  const thermal::Branch* branch_ = nullptr;
  Segment open_{Stage::S1, BlockMotion::stick, 0, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0};
  int heating_ = 0;
  int drive_ = 0;
  int first_slide_ = 0;
  int last_slide_ = 0;
  int held_ = 0;  ///< Side of the play at which friction acts; 0: without play.
};

/// Throws unless l_T stays positive over the program.
void require_positive_length(const SpringSlider& model, const thermal::Program& program) {
  thermal::for_each_branch(program, 0, [&model](const thermal::Branch& branch) {
    kernel::require(free_length(model, branch.end) > 0.0, "temperature change", branch.end,
                    "one that keeps stress_free_length * (1 + thermal_expansion * change) > 0");
  });
}

}  // namespace

const char* to_string(Stage stage) {
  constexpr std::array names{"S1",     "S2", "S3", "S4", "S5", "at_stop_plus", "at_stop_minus",
                             "in_play"};
  return names[static_cast<std::size_t>(stage)];
}

const char* to_string(BlockMotion motion) {
  constexpr std::array names{"stick", "slide", "stop", "play"};
  return names[static_cast<std::size_t>(motion)];
}

const char* to_string(EventKind kind) {
  constexpr std::array names{"first_slip",  "slip",       "stop_reached",      "stop_unloaded",
                             "stop_left",   "reversal",   "force_sign_change", "cycle_end",
                             "play_opened", "play_closed"};
  return names[static_cast<std::size_t>(kind)];
}

double Path::jump_after_cycle(int cycle) const {
  kernel::require(cycle >= 1 && cycle <= program.cycles, "cycle", cycle,
                  "1 to the program's number of cycles");
  return cycle_end_displacements[static_cast<std::size_t>(cycle) - 1];
}

namespace {

/// Follows the program and keeps the given cycles. Model and program are not checked.
void follow(const SpringSlider& model, const thermal::Program& program,
            const std::vector<int>& kept, Path& path) {
  require_positive_length(model, program);
  path.model = model;
  path.program = program;
  path.segments.clear();
  path.events.clear();
  path.cycle_end_displacements.clear();
  path.largest_compression = path.largest_compression_temperature_change = 0.0;
  path.largest_axial_force = path.largest_compression_time = 0.0;
  path.reported.reset();
  // A cycle that touches both stops has 12 events, with a play 16. Only tables with many reversals
  // have more.
  path.segments.reserve(16 * kept.size());
  path.events.reserve(16 * kept.size());
  path.cycle_end_displacements.reserve(static_cast<std::size_t>(program.cycles));
  PathFollower follower(path, kept);
  for (int cycle = 0; cycle < program.cycles; ++cycle) {
    thermal::for_each_branch(
        program, cycle, [&follower](const thermal::Branch& branch) { follower.follow(branch); });
    follower.end_cycle();
  }
  follower.end();
}

/// Cycles that sample() needs: those that contain `times`, their neighbours (because t/P is
/// rounded), the first two and the last.
std::vector<int> cycles_of(const thermal::Program& program,
                           const Eigen::Ref<const Eigen::VectorXd>& times) {
  const int last = program.cycles - 1;
  std::vector<int> cycles{0, std::min(1, last), last};
  int before = -1;
  for (const double time : times) {
    kernel::require(std::isfinite(time) && time >= 0.0, "time", time, "finite, >= 0 s");
    const int cycle = static_cast<int>(std::min<double>(std::floor(time / program.period), last));
    if (cycle == before) continue;
    before = cycle;
    for (int near = std::max(cycle - 1, 0); near <= std::min(cycle + 1, last); ++near) {
      cycles.push_back(near);
    }
  }
  std::sort(cycles.begin(), cycles.end());
  cycles.erase(std::unique(cycles.begin(), cycles.end()), cycles.end());
  return cycles;
}

}  // namespace

void solve(const SpringSlider& model, const thermal::Program& program, Path& path) {
  model.validate();
  program.validate();
  std::vector<int> all(static_cast<std::size_t>(program.cycles));
  std::iota(all.begin(), all.end(), 0);
  follow(model, program, all, path);
}

Path solve(const SpringSlider& model, const thermal::Program& program) {
  Path path;
  solve(model, program, path);
  return path;
}

Path solve(const SpringSlider& model, const thermal::Program& program,
           const Eigen::Ref<const Eigen::VectorXd>& times) {
  model.validate();
  program.validate();
  Path path;
  follow(model, program, cycles_of(program, times), path);
  return path;
}

PathPoint point_at(const SpringSlider& model, const thermal::Program& program,
                   const Segment& segment, double time) {
  const auto [lowest, highest] =
      std::minmax(segment.start_temperature_change, segment.end_temperature_change);
  const double change = std::clamp(program.temperature_change(time), lowest, highest);
  const double x = displacement(model, segment, change);
  // In a slide, equilibrium with friction at its limit gives the force. The difference of x and x_T
  // is less accurate.
  if (segment.moves()) {
    const SpringSlider pressed = in_region(model, segment.region);
    return {change, x,
            segment.friction_sign * model.friction_force + pressed.preload_force +
                pressed.preload_stiffness * x};
  }
  return {change, x, axial_force(model, change, x)};
}

double displacement(const SpringSlider& model, const Segment& segment, double temperature_change) {
  if (!segment.moves()) return segment.start_displacement;
  const SpringSlider pressed = in_region(model, segment.region);
  double x = sliding_displacement(pressed, temperature_change, segment.friction_sign);
  if (segment.motion == BlockMotion::play) {
    x = std::clamp(x, segment.middle - 0.5 * model.play, segment.middle + 0.5 * model.play);
  }
  if (segment.region > 0) return std::max(x, model.clearance_plus);
  if (segment.region < 0) return std::min(x, -model.clearance_minus);
  return std::clamp(x, -model.clearance_minus, model.clearance_plus);
}

double thermal_work(const SpringSlider& model, const Segment& segment, double temperature_change) {
  constexpr std::array<double, 5> nodes{-0.90617984593866399280, -0.53846931010568309104, 0.0,
                                        0.53846931010568309104, 0.90617984593866399280};
  constexpr std::array<double, 5> weights{0.23692688505618908751, 0.47862867049936646804,
                                          0.56888888888888888889, 0.47862867049936646804,
                                          0.23692688505618908751};
  const double start = segment.start_temperature_change;
  const double half_span = 0.5 * (temperature_change - start);
  const double middle = 0.5 * (temperature_change + start);
  const SpringSlider pressed = in_region(model, segment.region);
  double mean = 0.0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double at = middle + half_span * nodes[i];
    const double length = free_length(model, at);
    double strain = 0.0;  // (x − x_T)/l_T
    if (segment.moves()) {
      // The strain is computed from equilibrium, because the difference of x and x_T would lose the
      // digits that the energy balance needs.
      strain = -(segment.friction_sign * model.friction_force + pressed.preload_force +
                 pressed.preload_stiffness * thermal_displacement(model, at)) /
               (model.axial_rigidity() + pressed.preload_stiffness * length);
    } else {
      strain = (segment.start_displacement - thermal_displacement(model, at)) / length;
    }
    mean += weights[i] * (-strain - 0.5 * strain * strain);
  }
  const double growth = model.stress_free_length * model.thermal_expansion * half_span;
  return model.axial_rigidity() * growth * mean;
}

std::optional<EulerLoadExceeded> exceeded_euler_load(const Path& path) {
  const EulerLoadExceeded found{path.largest_compression,
                                path.largest_compression_temperature_change,
                                euler_load(path.model, EndCondition::clamped_clamped),
                                euler_load(path.model, EndCondition::pinned_pinned)};
  if (found.axial_force <= found.pinned) return std::nullopt;
  return found;
}

}  // namespace statejump::spring_slider
