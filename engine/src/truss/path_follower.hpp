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

/// How a step ended: with the state moved on, or back at its start.
enum class StepEnd : unsigned char { done, event_inside, not_converged, imprecise, stopped };

/// Both ends of a step that has converged.
struct Ends {
  double from_time;
  double to_time;
  const StepStart& start;
  const Statuses& statuses;  ///< At its end.
  const VectorXd& from;
  const VectorXd& to;
  const VectorXd& from_rate;
  const VectorXd& to_rate;
  const VectorXd& from_slide_rate;
  const VectorXd& to_slide_rate;
  const VectorXd& slips;
};

/// Where loads that are followed from none lead on no farther.
struct Stall {
  double fraction;     ///< Of the loads that is carried.
  SolveReport report;  ///< Of the last try beyond, and where it ended:
  Statuses statuses;
  VectorXd z;
};

/// How far a node moves where a joint gives way within its play, over what that moves by: the
/// shortest element is the lever of a structure of this size.
double lever_of(const Model& model, double size);

/// Equilibrium being followed.
struct PathFollower {
  const Model& model;
  const System& system;
  const Options& options;
  Newton newton;
  RateProblem rates;
  double lever = lever_of(model, system.size());
  Path path = {};
  /// Joints that a note of each kind has named.
  std::map<NoteKind, std::set<int>> noted = {};
  VectorXd z = {};
  StepStart origin = {};  ///< The state as the start of the next step.
  State state = {};
  double time = 0.0;
  /// Share of the last step that was tried after which its first event comes; 1: unknown.
  double event_share = 1.0;
  /// Whether long steps hold open joints by dashpots: nothing else determines their positions.
  bool is_slack = false;
  /// Whether the last answer of note_slack() was that there are slack elements.
  bool is_loose = false;
  /// Level below which dashpots do not soften until the next increment: steps had no solution
  /// there.
  double softest_level = 0.0;
  bool flickers = false;     ///< Whether changes in this increment are no longer located.
  double slack_level = 0.0;  ///< Of these dashpots, see System::slack_stiffness().
  /// Levels by which dashpots become softer after a step.
  static constexpr double softer = 0.25;
  /// Joints that changed in the last step and carry no more than dashpots do, see
  /// System::is_idle().
  std::set<int> idle_changes = {};
  double snap_travel = 0.0;  ///< Of all snaps since the last corner [m].
  /// Statuses that a longer step found from the present state on; empty: none.
  Statuses changed_at_start = {};
  /// Whether such are looked for; not again where a short step did not confirm them, until the next
  /// event.
  bool looks_at_start = true;
  /// Whether the tangents of a longer step saw one at its start.
  bool expects_at_start = false;
  /// Whether the last step was refused because what slips at its end is unstable.
  bool slip_is_unstable = false;
  /// Whether steps end at foreseen changes; else they pass them, see most_unconfirmed.
  bool locates = true;
  /// Steps at most into which an increment is cut for its energies.
  static constexpr double most_parts = 64.0;
  /// Longest step that energies are likely to balance over [s]; none known: as long as may be.
  double balanced_step = std::numeric_limits<double>::infinity();
  double shortest_balanced = 0.0;  ///< No shorter step is asked for [s].
  int steps_to_hold = 0;           ///< Before a longer step is tried.
  double largest_work = 0.0;       ///< Of the temperature so far [J].
  double energy_gained = 0.0;      ///< What does not balance so far [J].
  double slack_work = 0.0;         ///< Of the dashpots in the last step [J].
  /// What the last step lost, if it was refused for that [J].
  double refused_loss = std::numeric_limits<double>::infinity();
  /// Rates of the unknowns at `time`; empty where they are not known.
  VectorXd rate = {};
  /// How fast every joint that slips slides at `time` [m/s].
  VectorXd slide_rate = {};

  /// Where the path has been followed to.
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
  /// Below this a pin force is rounding of what the stiffest part would carry [N].
  double seat_rounding() const { return 1e-14 * system.stiffness_scale() * system.size(); }
  void note(NoteKind kind, double when, const std::vector<int>& joints, double value = 0.0);
  bool note_slack(double when, const VectorXd& at, const Statuses& statuses);
  void note_not_unique(double when);
  void refuse_mechanism(double when, const Statuses& statuses, JointModel joints) const;
  void refuse_buckled(double when);
  /// Whether elements are slack, or were.
  bool has_slack() const { return is_slack || is_loose || noted.count(NoteKind::slack) > 0; }
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

  /// What the type of a joint says.
  template <class Ask>
  auto joint(int i, Ask&& ask) const {
    return std::visit(ask, model.joints[index(i)]);
  }
};

}  // namespace statejump::truss::detail
