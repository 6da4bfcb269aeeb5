// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include "newton.hpp"
#include "path_record.hpp"
#include "rate_problem.hpp"
#include "statejump/failure.hpp"
#include "statejump/truss/path.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

FailureJoint named(const Model& model, int joint);

/// Fields of a failure at an instant.
FailureFields failure_at(FailureKind kind, const Model& model, double time);

[[noreturn]] void fail_modes(FailureFields fields, FoundModes found);
[[noreturn]] void fail_joint(FailureFields fields, FailureJoint joint);

/// Result of a step. Only a step with the result `done` changes the state.
enum class StepEnd : unsigned char { done, event_inside, not_converged, imprecise, stopped };

/// Times of the corners of all programs [s], in ascending order. Corners closer than
/// Model::same_time of the duration are merged, because times such as 3 · 0.1 s and 0.3 s differ by
/// rounding.
std::vector<double> corners(const Model& model);

/// Copy of a truss with a fraction of its loads and misfits. With fraction 0 the reference
/// configuration is stress-free.
Model loaded(Model model, double fraction);

/// Both ends of a converged step.
struct Ends {
  double from_time;
  double to_time;
  const StepStart& start;
  const Statuses& statuses;  ///< At the end of the step.
  const VectorXd& from;
  const VectorXd& to;
  const VectorXd& from_rate;
  const VectorXd& to_rate;
  const VectorXd& from_slide_rate;
  const VectorXd& to_slide_rate;
  const VectorXd& slips;
};

/// Point at which the load increase stalled.
struct Stall {
  double fraction;     ///< Fraction of the loads in equilibrium.
  SolveReport report;  ///< Last failed attempt beyond it, and its final statuses and unknowns:
  Statuses statuses;
  VectorXd z;
};

/// Ratio of the largest displacement of any node to the motion within the play of a joint that
/// causes it. Estimate: size of the structure over length of its shortest bar.
double lever_of(const Model& model, double size);

/// State of a path while solve() follows it.
struct PathFollower {
  const Model& model;
  const System& system;
  const Options& options;
  Newton newton;
  RateProblem rates;
  /// Receives every equilibrium; null: nothing is recorded.
  PathRecord* record = nullptr;
  /// How the memory at the start of the next recorded step was written.
  MemoryWriter first_writer = MemoryWriter::begin;
  double lever = lever_of(model, system.size());
  Path path = {};
  /// Joints already named in a note of each kind.
  std::map<NoteKind, std::set<int>> noted = {};
  VectorXd z = {};
  StepStart origin = {};  ///< The present state as the start of the next step.
  State state = {};
  double time = 0.0;
  /// Fraction of the last attempted step at which its first event occurs; 1: unknown.
  double event_share = 1.0;
  /// Whether dashpots act on open joints in long steps too, because nothing else determines the
  /// positions of these joints.
  bool is_slack = false;
  /// Result of the last note_slack(): whether elements are slack.
  bool is_loose = false;
  /// Lowest level of the dashpots in the present increment. Steps with softer dashpots had no
  /// solution.
  double softest_level = 0.0;
  bool flickers = false;  ///< Whether changes of status in this increment are no longer located.
  /// Whether so many joints are open in this increment that their changes are not located.
  bool passes_changes = false;
  double slack_level = 0.0;  ///< Level of the dashpots, see System::slack_stiffness().
  /// Decrease of the dashpot level after a step.
  static constexpr double softer = 0.25;
  /// Joints that changed their status in the last step while their contact forces did not exceed
  /// the dashpot forces, see System::is_idle().
  std::set<int> idle_changes = {};
  double snap_travel = 0.0;  ///< Sum of all snaps since the last corner [m].
  /// Statuses for the present state that a longer step predicted; empty if there is no prediction.
  Statuses changed_at_start = {};
  /// Whether longer steps predict the statuses at their start. This is disabled until the next
  /// event if a short step did not confirm a prediction.
  bool looks_at_start = true;
  /// Whether the tangent of a longer step predicted a status change at the start of that step.
  bool expects_at_start = false;
  /// Whether the last step was rejected because slip at its end is unstable.
  bool slip_is_unstable = false;
  /// True: steps end at predicted events. False: steps pass these events, see most_unconfirmed.
  bool locates = true;
  /// Largest number of steps per increment for the energy balance.
  static constexpr double most_parts = 64.0;
  /// Longest step whose energy error is expected to be within its tolerance [s]; infinity: unknown.
  double balanced_step = std::numeric_limits<double>::infinity();
  double shortest_balanced = 0.0;  ///< Lower limit of steps shortened for the energy balance [s].
  int steps_to_hold = 0;           ///< Steps before a longer one is attempted.
  double largest_work = 0.0;       ///< Largest work of the temperature so far [J].
  double energy_gained = 0.0;      ///< Accumulated error of the energy balance [J].
  double slack_work = 0.0;         ///< Work of the dashpots in the last step [J].
  /// Energy error of the last step if it was rejected for it [J]; otherwise infinity.
  double refused_loss = std::numeric_limits<double>::infinity();
  /// Rates of the unknowns at `time`; empty: unknown.
  VectorXd rate = {};
  /// Slip rate of every slipping joint at `time` [m/s].
  VectorXd slide_rate = {};

  /// State of the path at a time, to return to.
  struct Position {
    VectorXd z;
    StepStart origin;
    State state;
    double time;
    VectorXd rate, slide_rate;
  };
  Position position() const;
  void return_to(const Position& to);

  [[noreturn]] void fail(const SolveReport& report, JointModel joints, double when,
                         const char* sought);
  void note(const SolveReport& report);
  void start();
  std::optional<Stall> follow_loads();
  void record_start(const StepStart& from, MemoryWriter writer, JointModel joints, double opening,
                    const VectorXd& written_at, const Statuses& written_with);
  std::size_t recorded() const { return record == nullptr ? 0 : record->steps.size(); }
  void forget_after(std::size_t count) {
    if (record != nullptr) record->keep(count);
  }
  bool is_near(const VectorXd& moved) const;
  bool are_loaded(const std::vector<VectorXd>& shapes) const;
  [[noreturn]] void refuse_overload(const Stall& at);
  std::vector<FailureJoint> slipping(const Statuses& statuses) const;
  void open_clearances();
  void seat(const std::vector<int>& with_play, JointModel contact);
  bool come_to_rest_at(double opening, JointModel contact, const std::vector<int>& with_play,
                       double opened);
  void seat_at(double opened, double opening, const std::vector<int>& with_play,
               VectorXd& there) const;
  SolveReport open_seated(const std::vector<int>& with_play, JointModel contact);
  /// Pin forces below this value are rounding errors of the force in the stiffest element [N].
  double seat_rounding() const { return 1e-14 * system.stiffness_scale() * system.size(); }
  void note(NoteKind kind, double when, const std::vector<int>& joints, double value = 0.0);
  bool note_slack(double when, const VectorXd& at, const Statuses& statuses);
  void note_not_unique(double when);
  void refuse_mechanism(double when, const Statuses& statuses, JointModel joints) const;
  void refuse_buckled(double when);
  /// Whether elements are slack now or were earlier.
  bool has_slack() const { return is_slack || is_loose || noted.count(NoteKind::slack) > 0; }
  bool note_many_open(double when);
  bool stiffen_slack(const Statuses& statuses);
  bool damp();
  StepEnd step_to(double target, double tolerance);
  StepEnd step_with_slack(double target, double until, double tolerance);
  bool come_to_rest(const std::function<std::optional<double>(double level)>& step, double drift);
  bool follow_snap(double until, double tolerance);
  SolveReport continue_from_event(double target, VectorXd& to, Statuses& statuses,
                                  SolveReport first);
  SolveReport slide_on(double target, bool is_short, VectorXd& to, Statuses& statuses,
                       SolveReport first);
  std::vector<double> program_rates_before(double target) const;
  [[noreturn]] void fail_continuation(FailureKind kind, double when, std::vector<int> joints) const;
  bool follows_its_rates(const Ends& ends) const;
  bool any_slips(const Statuses& statuses) const;
  bool passes_instability(const Statuses& statuses);
  bool slide_at_stake(int joint, JointStatus before, double target, const Rounding& rounding) const;
  double first_edge(double target, const VectorXd& to, const StepStart& begin,
                    const Rounding& rounding) const;
  bool balances(const State& next, const VectorXd& to, double step, double taken);
  double first_turn(const Ends& ends) const;
  double turn_of_slip(int joint, const Ends& ends, const Rounding& rounding) const;
  double turn_of_stick(int joint, const Ends& ends, const Rounding& rounding) const;

  /// Calls `ask` with the joint as its own type.
  template <class Ask>
  auto joint(int i, Ask&& ask) const {
    return std::visit(ask, model.joints[index(i)]);
  }
};

}  // namespace statejump::truss::detail
