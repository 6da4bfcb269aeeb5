// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <limits>
#include <set>
#include <utility>

#include "active_set.hpp"
#include "newton.hpp"
#include "newton_options.hpp"
#include "numerics/raise.hpp"
#include "schur_active_set.hpp"
#include "trace.hpp"

namespace statejump::truss::detail {

namespace {

using numerics::raise;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr NewtonOptions tuned;

/// Residuals of the equations, each in its own unit.
struct Residuals {
  double balance = 0.0;  ///< Force balance of the nodes [N].
  double closure = 0.0;  ///< Closures of stops, contacts and sticking joints [m].
  double force = 0.0;    ///< Forces of slipping or open joints [N].
};

Residuals residuals(const Assembly& at) {
  Residuals found;
  for (Eigen::Index i = 0; i < at.residual.size(); ++i) {
    const RowUnit unit = at.units[index(static_cast<int>(i))];
    double& largest = unit == RowUnit::balance   ? found.balance
                      : unit == RowUnit::closure ? found.closure
                                                 : found.force;
    raise(largest, std::abs(at.residual[i]));
  }
  return found;
}

/// Whether the next step will be negligible if steps continue to shrink as the last two did.
bool is_last(const std::deque<double>& lengths, double enough) {
  if (lengths.empty()) return false;
  const double last = lengths.back();
  const double before = lengths.size() < 2 ? last : lengths[lengths.size() - 2];
  return last <= enough || last * last <= enough * before;
}

}  // namespace

/// One call of Newton::solve(): Newton's method on the statuses that find_active_set() chooses.
class Newton::Iteration {
 public:
  /// Arguments of Newton::solve().
  struct Problem {
    double time;
    const StepStart& start;
    JointModel joints;
    double opening;
    int most_iterations;
    const std::optional<EventSearch>& search;
    bool held;
  };

  Iteration(Newton& newton, const Problem& problem, VectorXd& z, Statuses& statuses);

  SolveReport run() {
    predict();
    if (iterate()) find_active_set(*this, Blocks::until_ever_repeated);
    return report_;
  }

  // Interface for find_active_set().
  using Changes = std::vector<std::pair<int, JointStatus>>;
  using Search = PivotSearch<std::size_t>;
  std::size_t key() const { return fingerprint(next_statuses_); }
  const Changes& violated() const { return violated_; }
  bool change(const Changes& changes, Search& search);
  bool solve();

 private:
  /// Continuation after an iteration.
  enum class Turn : unsigned char {
    iteration,  ///< Another iteration on the same statuses.
    linear_step,
    statuses,  ///< Violated inequalities request other statuses.
    converged,
    failed,
  };

  // Newton's method on the present statuses.

  void predict();
  /// Iterates until inequalities are violated or the equations and all inequalities hold.
  /// @returns false if the iteration is given up
  bool iterate();
  Turn advance();
  void evaluate(bool jacobian);
  void evaluate_iterate();
  bool is_too_far() const;
  bool is_astray() const;
  bool is_solved() const;
  /// Whether closures with this largest residual [m] count as satisfied.
  bool closes(double largest_gap) const;
  /// Restarts the solve with new factors at its initial state.
  Turn start_anew();
  Turn finish();

  /// Computes the next step, with old factors if that is cheaper.
  Turn linear_step();
  bool old_factors_pay() const;
  bool step_by_new_factors();

  /// The natural monotonicity test.
  bool is_too_long() const;
  Turn halve();
  bool take_step();
  bool stalls(std::size_t steps) const;
  bool goes_on();

  // Changes of statuses.

  void find_violations();
  std::vector<int> violated_joints() const {
    std::vector<int> joints;
    for (const auto& one : violated_) joints.push_back(one.first);
    return joints;
  }
  Turn update_statuses();
  bool leaves_ahead();
  bool wanders(const Search& search) const;
  bool condense(const Search& search);
  void slide_instead(const Changes& changes, const Search& search);

  double length(const VectorXd& of) const {
    const int displacements = system_.displacements();
    return displacements == 0 ? 0.0 : of.head(displacements).lpNorm<Eigen::Infinity>();
  }
  bool keeps_factors() const { return newton_.keeps(statuses_, problem_.joints); }

  Newton& newton_;
  const System& system_;
  Assembly& at_;
  const Problem problem_;
  VectorXd& z_;
  Statuses& statuses_;
  SolveReport report_;

  // Piecewise laws change their equations within a solve, and located changes need the accuracy of
  // new factors.
  const bool may_keep_;
  bool kept_;
  bool stale_ = true;  // no factors have been made yet
  bool begins_anew_ = false;
  bool pivoted_ = false;
  bool looking_;
  std::chrono::steady_clock::time_point told_ = std::chrono::steady_clock::now();

  // Cycling pivots lead to other linearised equations. Restarts begin from these values.
  const VectorXd first_z_;
  const Statuses first_statuses_;
  // Starts from the predictor unless changes are located: these are searched along the tangent.
  const bool is_foreseen_;
  // With slack elements the solve also starts from the predictor. At the old length, thermal
  // strain of an element would appear as a tension that moves slack elements.
  const bool hangs_;
  const VectorXd& begun_at_;

  // Every joint may change once to each of its other statuses, at most five.
  const long most_pivots_;
  long total_ = 0;
  int iterations_ = 0;
  bool old_ = false;             // whether the next step uses old factors
  bool differentiated_ = false;  // whether the Jacobian is that of z
  double reach_ = 0.0;           // length scale of the closure tolerance [m]
  double rounding_ = 0.0;        // rounding of the forces [N]
  Residuals left_;
  double merit_ = 0.0;          // scaled residual at z [N]
  double merit_before_ = 0.0;   // scaled residual at `from_` [N]
  double first_largest_ = 0.0;  // largest force at the start of the solve [N]
  std::size_t pieces_ = 0;
  // Lengths of the steps on the present statuses [m]; the last step leads from `from_` by `step_`.
  std::deque<double> lengths_;
  VectorXd from_;
  VectorXd step_;
  VectorXd next_step_;
  double next_length_ = 0.0;
  int halvings_ = 0;
  bool damped_ = false;   // whether the last step was halved
  bool settled_ = false;  // whether no joint violates its inequality at z

  Changes violated_;
  Statuses wanted_;
  Statuses next_statuses_;
  Pivot pivoting_ = Pivot::block;
  bool stepped_ = false;  // whether z is at the end of a full step on the present factors
  // Joints that changed their status since the last new minimum of violations.
  std::set<int> wandering_;
  bool condensed_ = false;
  int condensed_at_ = 0;  // number of idle pivots at the last condensed answer
  bool patient_ = false;  // whether statuses change only once the equations hold
  VectorXd closing_z_;    // unknowns at which an open contact closed last

  TracedSolve traced_;  // reads the other members when it ends
};

SolveReport Newton::solve(double time, const StepStart& start, JointModel joints, double opening,
                          int most_iterations, VectorXd& z, Statuses& statuses,
                          const std::optional<EventSearch>& search, bool held) {
  return Iteration(*this, {time, start, joints, opening, most_iterations, search, held}, z,
                   statuses)
      .run();
}

Newton::Iteration::Iteration(Newton& newton, const Problem& problem, VectorXd& z,
                             Statuses& statuses)
    : newton_(newton),
      system_(*newton.system_),
      at_(newton.at_),
      problem_(problem),
      z_(z),
      statuses_(statuses),
      may_keep_(!newton.locates_ && !newton.system_->slips_smoothly()),
      kept_(std::exchange(newton.quiet_, false) && may_keep_),
      looking_(problem.search.has_value()),
      first_z_(z),
      first_statuses_(statuses),
      is_foreseen_(problem.search && !problem.search->stop),
      hangs_(problem.search && any_open(statuses)),
      begun_at_(is_foreseen_ || hangs_ ? problem.search->foreseen : first_z_),
      most_pivots_(problem.most_iterations + 5 * static_cast<long>(statuses.size())),
      next_statuses_(statuses),
      traced_(newton.tracer_, {problem.time, problem.joints, problem.opening, report_, statuses_,
                               lengths_, halvings_, newton.factorizations_}) {
  newton.current_ = false;
  newton.regularisation_ = Regularisation::none;
}

void Newton::Iteration::predict() {
  const bool is_near = problem_.search && kept_ && keeps_factors();
  if (is_foreseen_ || hangs_ || is_near) z_ = problem_.search->foreseen;
}

bool Newton::Iteration::iterate() {
  for (; iterations_ < problem_.most_iterations && total_ < most_pivots_; ++total_, ++iterations_) {
    const Turn turn = advance();
    if (turn != Turn::iteration) return turn != Turn::failed;
  }
  return false;
}

Newton::Iteration::Turn Newton::Iteration::advance() {
  evaluate_iterate();
  if (is_too_far()) return Turn::failed;
  // Step lengths on another branch of a piecewise law are not comparable.
  if (std::exchange(pieces_, at_.pieces) != at_.pieces) {
    lengths_.clear();
    halvings_ = 0;
  }
  if (!std::isfinite(left_.balance + left_.closure + left_.force)) {
    return stale_ && total_ > 0 ? start_anew() : Turn::failed;
  }
  if (total_ == 0) first_largest_ = at_.largest_force;
  if (is_astray()) return Turn::failed;
  // A restart replaces old factors, so it takes a step with new ones even if the equations hold:
  // otherwise violated inequalities would request the same restart again.
  if (total_ > 0 && !std::exchange(begins_anew_, false) && is_solved()) return finish();
  const Turn turn = linear_step();
  if (turn != Turn::linear_step) return turn;
  if (is_too_long()) return halve();
  return take_step() ? update_statuses() : Turn::failed;
}

void Newton::Iteration::evaluate(bool jacobian) {
  at_.want_jacobian(jacobian);
  system_.evaluate(z_, problem_.time, problem_.start, statuses_, problem_.joints, problem_.opening,
                   at_);
  differentiated_ = jacobian;
}

void Newton::Iteration::evaluate_iterate() {
  // With old factors only the residual is needed.
  old_ = kept_ && at_.pieces == 0 && halvings_ == 0 && keeps_factors();
  kept_ = may_keep_;
  // If the solve is likely to end here, the Jacobian is evaluated too: the rates need it.
  evaluate(!old_ || is_last(lengths_, closure_tolerance * system_.reach(z_)));
  reach_ = system_.reach(z_);
  rounding_ = system_.force_rounding(z_);
  left_ = residuals(at_);
  merit_ = left_.balance + left_.force + system_.stiffness_scale() * left_.closure;
  traced_.iteration(left_.balance, left_.closure, left_.force);
}

/// Beyond the size of the truss the linearised equations have no meaning.
bool Newton::Iteration::is_too_far() const {
  return pivoted_ && system_.size() > 0.0 && length(z_ - begun_at_) > system_.size();
}

/// The new statuses were requested by linearised equations that are inaccurate if the force
/// residual exceeds half of the largest force, because many joints changed at once. A shorter step
/// changes fewer. Located changes are never passed together.
bool Newton::Iteration::is_astray() const {
  const double largest = std::max(at_.largest_force, first_largest_);
  return pivoted_ && is_foreseen_ && left_.balance > 0.5 * largest + rounding_;
}

/// If rounding is larger than estimated, steps stagnate. This also counts as convergence, provided
/// that forces balance.
bool Newton::Iteration::is_solved() const {
  const double largest = at_.largest_force;
  const bool closed = left_.balance <= tuned.force_tolerance * largest + rounding_ &&
                      closes(left_.closure) && left_.force <= 16.0 * epsilon * largest + rounding_;
  const bool still = !lengths_.empty() && lengths_.back() <= closure_tolerance * reach_ &&
                     left_.balance <= 1e3 * tuned.force_tolerance * largest + rounding_;
  return closed || still;
}

/// If steps no longer shrink, a closure residual within the elastic deflection that rounding of
/// the forces causes in a lightly loaded contact is accepted.
bool Newton::Iteration::closes(double largest_gap) const {
  if (largest_gap <= closure_tolerance * reach_) return true;
  const std::size_t n = lengths_.size();
  const bool shrinks = n < 2 || lengths_[n - 1] < 0.5 * lengths_[n - 2];
  if (shrinks || largest_gap > 1e3 * closure_tolerance * reach_) return false;
  const Rounding by = system_.rounding(z_);
  return system_.first_joint([&](int i) {
    const Eigen::Index row = system_.force_row(i);
    for (Eigen::Index k = row; k < row + system_.force_count(i); ++k) {
      const bool is_gap = at_.units[index(static_cast<int>(k))] == RowUnit::closure;
      if (!is_gap || std::abs(at_.residual[k]) <= by.length) continue;
      if (std::abs(at_.residual[k]) >
          system_.slide_rounding(i, z_, problem_.time, problem_.start, by))
        return true;
    }
    return false;
  }) < 0;
}

Newton::Iteration::Turn Newton::Iteration::start_anew() {
  z_ = begun_at_;
  settled_ = false;
  lengths_.clear();
  kept_ = false;
  begins_anew_ = true;
  return Turn::iteration;
}

Newton::Iteration::Turn Newton::Iteration::finish() {
  if (settled_) {
    violated_.clear();
  } else {
    find_violations();
  }
  if (!violated_.empty()) {
    if (stale_) return start_anew();
    stepped_ = false;
    return leaves_ahead() ? Turn::failed : Turn::statuses;
  }
  if (!differentiated_) evaluate(true);
  report_.end = SolveEnd::converged;
  report_.force_residual = at_.largest_force > 0.0 ? left_.balance / at_.largest_force : 0.0;
  report_.closure_residual = left_.closure;
  newton_.quiet_ = !pivoted_;
  newton_.solved_on_ = statuses_;
  newton_.solved_model_ = problem_.joints;
  return Turn::converged;
}

Newton::Iteration::Turn Newton::Iteration::linear_step() {
  if (old_) {
    next_step_ = newton_.factor_.solve(-at_.residual);
    next_length_ = length(next_step_);
    const bool grows = !lengths_.empty() && next_length_ > closure_tolerance * reach_ &&
                       !(next_length_ / lengths_.back() < 1.0);
    if (grows && stale_) return start_anew();
    old_ = !grows && old_factors_pay() && next_step_.allFinite();
    if (!old_ && !differentiated_) evaluate(true);
  }
  if (old_ || step_by_new_factors()) return Turn::linear_step;
  report_.end = SolveEnd::singular;
  return Turn::failed;
}

bool Newton::Iteration::old_factors_pay() const {
  if (lengths_.empty()) return true;
  const double enough = closure_tolerance * reach_;
  // The iteration stagnates.
  if (!(next_length_ > enough)) return lengths_.back() > enough;
  const double share = next_length_ / lengths_.back();
  return newton_.keeping_pays(std::log(enough / next_length_) / std::log(share));
}

bool Newton::Iteration::step_by_new_factors() {
  if (!newton_.factorize(statuses_, problem_.joints)) return false;
  stale_ = false;
  newton_.current_ = true;
  next_step_ = newton_.factor_.solve(-at_.residual);
  if (!next_step_.allFinite()) return false;
  next_length_ = length(next_step_);
  const double most = tuned.proximal_fraction * system_.size();
  const bool is_regular = newton_.regularisation_ == Regularisation::displacements;
  if (is_regular && next_length_ > most && most > 0.0) {
    next_step_ *= most / next_length_;
    next_length_ = most;
  }
  return true;
}

bool Newton::Iteration::is_too_long() const {
  // Steps may grow along directions held by dashpots only, if the residual at least halves.
  const bool improves = problem_.start.slack_stiffness > 0.0 && merit_ <= 0.5 * merit_before_;
  return !improves && !lengths_.empty() && next_length_ > closure_tolerance * reach_ &&
         next_length_ > *std::max_element(lengths_.begin(), lengths_.end());
}

Newton::Iteration::Turn Newton::Iteration::halve() {
  if (++halvings_ > tuned.most_halvings) return Turn::failed;
  z_ = from_ + std::ldexp(1.0, -halvings_) * step_;
  settled_ = false;
  return Turn::iteration;
}

bool Newton::Iteration::stalls(std::size_t steps) const {
  const std::size_t taken = lengths_.size();
  return taken >= steps && next_length_ > 0.5 * lengths_[taken - steps];
}

bool Newton::Iteration::take_step() {
  damped_ = halvings_ > 0;
  halvings_ = 0;
  from_ = z_;
  merit_before_ = merit_;
  // Iterates that alternate between two states are replaced by their mean.
  if (stalls(tuned.swing_steps)) next_step_ *= 0.5;
  // If the caller can shorten the step or stiffen dashpots, a stagnating solve ends early.
  const bool gives_up = (problem_.search && pivoted_) || problem_.start.damps_contact;
  if (gives_up && stalls(2 * tuned.swing_steps)) return false;
  std::swap(step_, next_step_);
  z_ += step_;
  settled_ = false;
  lengths_.push_back(next_length_);
  traced_.step(next_length_);
  if (lengths_.size() > tuned.remembered_steps) lengths_.pop_front();
  return true;
}

bool Newton::Iteration::goes_on() {
  const auto now = std::chrono::steady_clock::now();
  if (std::chrono::duration<double>(now - told_).count() <= tuned.progress_interval_s) return true;
  told_ = now;
  if (newton_.going_on_()) return true;
  report_.end = SolveEnd::stopped;
  return false;
}

void Newton::Iteration::find_violations() {
  violated_.clear();
  const Rounding slack = system_.rounding(z_);
  if (problem_.held) return;
  wanted_ = statuses_;
  system_.displacements(z_, at_.moved);
  system_.each_joint([&](int i) {
    JointStatus& status = wanted_[index(i)];
    status = system_.decide(i, z_, at_.moved, problem_.time, problem_.start, problem_.joints,
                            problem_.opening, status, slack);
  });
  for (int i = 0; i < static_cast<int>(statuses_.size()); ++i) {
    const JointStatus wanted = wanted_[index(i)];
    if (wanted != statuses_[index(i)]) violated_.emplace_back(i, wanted);
  }
}

Newton::Iteration::Turn Newton::Iteration::update_statuses() {
  // The first step on a piecewise law may use the tangent of another branch: elements that slip
  // are at their limit at the start of a step, with the tangent of sticking. Statuses are not
  // checked then.
  const bool on_piece = at_.pieces == 0 || lengths_.size() > 1;
  if (!damped_ && on_piece && !patient_ && pivoting_ != Pivot::single) {
    find_violations();
    settled_ = violated_.empty();
    if (stale_ && !settled_) return start_anew();
    if (leaves_ahead()) return Turn::failed;
    stepped_ = true;
    if (!settled_) return Turn::statuses;
  }
  return goes_on() ? Turn::iteration : Turn::failed;
}

/// Event detection, once per solve: finds the violated joint that changes its status first after
/// the start of the step. True: the solve ends at this event.
bool Newton::Iteration::leaves_ahead() {
  if (!looking_ || violated_.empty()) return false;
  const StepStart& start = problem_.start;
  std::vector<int> leaving;
  const double idle_force = system_.idle_force(z_, problem_.time, start, statuses_);
  for (const auto& [i, wanted] : violated_) {
    const bool is_event = system_.is_event(i, statuses_[index(i)], wanted);
    if (is_event && !system_.is_idle(i, first_z_, z_, idle_force)) leaving.push_back(i);
  }
  if (leaving.empty()) return false;
  const Violation first = newton_.first_violation(leaving, first_z_, z_, problem_.search->from_time,
                                                  problem_.time, start, problem_.joints, statuses_);
  report_.leaves_at_start = !(first.share > problem_.search->now);
  if (report_.leaves_at_start) return false;
  looking_ = false;
  report_.first_change = first.share;
  report_.leaving.emplace(first.joint, wanted_[index(first.joint)]);
  report_.joints = violated_joints();
  if (!problem_.search->stop) return false;
  newton_.quiet_ = !pivoted_;
  report_.end = SolveEnd::event_ahead;
  return true;
}

bool Newton::Iteration::change(const Changes& changes, Search& search) {
  pivoted_ = true;
  pivoting_ = search.pivot();
  if (search.idle() == 0) {
    wandering_.clear();
    condensed_ = false;
    condensed_at_ = 0;
  }
  for (const auto& one : changes) wandering_.insert(one.first);
  next_statuses_ = statuses_;
  for (const auto& [joint, wanted] : changes) next_statuses_[index(joint)] = wanted;
  if (wanders(search)) {
    if (!condensed_ && condense(search)) return true;
    if (problem_.search) {
      // Iterates that have not converged may request statuses that the solution does not.
      search.admit_tried();
      return !std::exchange(patient_, true);
    }
  }
  if (statuses_[index(changes.front().first)] == JointStatus::open) closing_z_ = z_;
  if (pivoting_ == Pivot::single && search.was_tried(key())) slide_instead(changes, search);
  return true;
}

/// Piecewise laws change their branch without a pivot, so they are not condensed.
bool Newton::Iteration::wanders(const Search& search) const {
  if (at_.pieces != 0 || pivoting_ != Pivot::block || !stepped_) return false;
  const int idle = search.idle() - condensed_at_;
  const double paid = idle * newton_.factor_.solutions_per_factorization();
  return idle > 0 && paid >= static_cast<double>(wandering_.size());
}

/// Takes the Newton step from the start of the solve with statuses from the Schur-complement
/// active set. Cycling joints begin in their first statuses, all others in the present ones.
/// False: no solution.
bool Newton::Iteration::condense(const Search& search) {
  condensed_ = true;
  condensed_at_ = search.idle();
  Statuses begun = statuses_;
  for (const int i : wandering_) begun[index(i)] = first_statuses_[index(i)];
  at_.want_jacobian(true);
  system_.evaluate(first_z_, problem_.time, problem_.start, begun, problem_.joints,
                   problem_.opening, at_);
  constexpr double stable = linear::SparseFactor::stable_growth;
  if (!newton_.factorize(begun, problem_.joints, stable)) return false;
  const VectorXd whole = newton_.factor_.solve(-at_.residual);
  const std::vector<int> in_play(wandering_.begin(), wandering_.end());
  const Linearized here{first_z_,         problem_.time, problem_.start,  problem_.joints,
                        problem_.opening, begun,         newton_.factor_, whole};
  auto answer = schur_active_set(system_, here, in_play);
  if (!answer || search.was_tried(fingerprint(answer->statuses))) return false;
  next_statuses_ = std::move(answer->statuses);
  z_ = first_z_ + answer->step;
  return true;
}

/// A contact in tension while it sticks and in penetration while it is open may slip where it
/// closes.
void Newton::Iteration::slide_instead(const Changes& changes, const Search& search) {
  // In a step of the path the rate problem decides this.
  if (problem_.time != problem_.start.time && !problem_.start.damps_contact) return;
  const auto& [joint, wanted] = changes.front();
  if (statuses_[index(joint)] != JointStatus::open && wanted != JointStatus::open) return;
  for (const JointStatus slip : {JointStatus::slip_plus, JointStatus::slip_minus}) {
    Statuses sliding = statuses_;
    sliding[index(joint)] = slip;
    if (search.was_tried(fingerprint(sliding))) continue;
    next_statuses_ = std::move(sliding);
    if (closing_z_.size() > 0) z_ = closing_z_;
    return;
  }
}

bool Newton::Iteration::solve() {
  newton_.current_ = false;
  statuses_ = next_statuses_;
  report_.joints = violated_joints();
  lengths_.clear();
  halvings_ = 0;
  if (stepped_ && !goes_on()) return false;
  ++total_;
  iterations_ = 1;
  return iterate();
}

}  // namespace statejump::truss::detail
