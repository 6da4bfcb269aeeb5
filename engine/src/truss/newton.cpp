// SPDX-License-Identifier: GPL-3.0-or-later
#include "newton.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <limits>
#include <set>
#include <unordered_set>
#include <utility>

#include "newton_options.hpp"
#include "numerics/raise.hpp"
#include "parallel.hpp"
#include "rate_problem.hpp"
#include "schur_active_set.hpp"
#include "trace.hpp"

namespace statejump::truss::detail {

namespace {

using numerics::raise;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr NewtonOptions tuned;
/// Compliance of closures with non-unique reactions, over that of the stiffest element. The
/// rounding error of a closure changes reactions by a thousand of their roundings. The error of the
/// regularisation in unique directions shrinks by a factor of a thousand per iteration.
constexpr double reaction_compliance = 1e-3;

/// Multiplying this many columns takes about ten times as long as starting a thread.
constexpr Eigen::Index halved_columns = 50000;

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

/// Residual of the linear rate equations.
struct LeftOver {
  VectorXd residual;
  /// Backward error (W. Oettli, W. Prager, Numer. Math. 6 (1964) 405-409). It is the larger of two
  /// ratios: force residual over the largest absolute sum of force terms in a row, and closure
  /// residual over the largest absolute sum of closure terms. The latter sum is at least the former
  /// divided by the stiffness of the stiffest element. Metres and newtons are not compared, and
  /// rounding alone gives about 1e-16 for any condition number.
  double share = 0.0;
};

LeftOver left_over(const Assembly& of, const VectorXd& rate, const VectorXd& by_time,
                   double stiffness) {
  LeftOver left{by_time};
  VectorXd added = by_time.cwiseAbs();
  const linear::SparseView jacobian = of.jacobian();
  const auto add_columns = [&](Eigen::Index begin, Eigen::Index end, VectorXd& sum,
                               VectorXd& absolute) {
    for (Eigen::Index column = begin; column < end; ++column) {
      const double by = rate[column];
      for (linear::SparseView::InnerIterator it(jacobian, column); it; ++it) {
        const double term = it.value() * by;
        sum[it.row()] += term;
        absolute[it.row()] += std::abs(term);
      }
    }
  };
  const Eigen::Index columns = jacobian.outerSize();
  if (columns < halved_columns) {
    add_columns(0, columns, left.residual, added);
  } else {
    // The division does not depend on the number of threads.
    VectorXd second = VectorXd::Zero(columns), second_added = second;
    in_parallel(2, [&](std::size_t k) {
      k == 0 ? add_columns(0, columns / 2, left.residual, added)
             : add_columns(columns / 2, columns, second, second_added);
    });
    left.residual += second;
    added += second_added;
  }
  double force_left = 0.0, force_added = 0.0, closure_left = 0.0, closure_added = 0.0;
  for (Eigen::Index row = 0; row < added.size(); ++row) {
    const bool closes = of.units[index(static_cast<int>(row))] == RowUnit::closure;
    raise(closes ? closure_left : force_left, std::abs(left.residual[row]));
    raise(closes ? closure_added : force_added, added[row]);
  }
  if (stiffness > 0.0) closure_added = std::max(closure_added, force_added / stiffness);
  const auto share = [](double most_left, double most_added) {
    return most_left == 0.0 ? 0.0 : most_left / most_added;
  };
  raise(left.share, share(force_left, force_added));
  raise(left.share, share(closure_left, closure_added));
  return left;
}

/// Whether the next step will be negligible if steps continue to shrink as the last two did.
bool is_last(const std::deque<double>& lengths, double enough) {
  if (lengths.empty()) return false;
  const double last = lengths.back();
  const double before = lengths.size() < 2 ? last : lengths[lengths.size() - 2];
  return last <= enough || last * last <= enough * before;
}

/// Joints that violate their inequalities, and their corrected statuses.
struct Violations {
  std::vector<int> joints;
  Statuses corrected;
};

/// Which violated joints change their status: all (block), or the lowest (single).
enum class Pivoting : unsigned char { block, single };

}  // namespace

/// Smallest fraction of the step at which one of the joints violates its inequality.
/// @pre each joint violates it at the end of the step
Newton::Violation Newton::first_violation(const std::vector<int>& joints, const VectorXd& from,
                                          const VectorXd& to, double from_time, double time,
                                          const StepStart& start, JointModel model,
                                          const Statuses& statuses) const {
  Violation first{1.0, joints.front()};
  // The joint's displacements and forces are interpolated linearly between both ends.
  const auto violates = [&](int joint, double share) {
    Trial at = system_->trial(joint, from, from_time, start, model, 1.0);
    const Trial end = system_->trial(joint, to, time, start, model, 1.0);
    for (std::size_t k = 0; k < most_joint_nodes; ++k) {
      at.moved[k] += share * (end.moved[k] - at.moved[k]);
    }
    for (std::size_t k = 0; k < most_joint_forces; ++k) {
      at.force[k] += share * (end.force[k] - at.force[k]);
    }
    at.temperature_change += share * (end.temperature_change - at.temperature_change);
    const JointStatus status = statuses[index(joint)];
    return std::visit([&](const auto& one) { return one.decide(at, status); },
                      system_->model().joints[index(joint)]) != status;
  };
  for (const int joint : joints) {
    // A later violation than the first one found so far is skipped.
    if (first.share < 1.0 && !violates(joint, first.share)) continue;
    first.joint = joint;
    double before = 0.0;
    for (int halving = 0; halving < tuned.fraction_halvings; ++halving) {
      const double middle = 0.5 * (before + first.share);
      (violates(joint, middle) ? first.share : before) = middle;
    }
  }
  return first;
}

SolveReport Newton::solve(double time, const StepStart& start, JointModel joints, double opening,
                          int most_iterations, VectorXd& z, Statuses& statuses,
                          const std::optional<EventSearch>& search, bool held) {
  SolveReport report;
  current_ = false;
  regularisation_ = Regularisation::none;
  // Piecewise laws change their equations within a solve, and located changes need the accuracy of
  // new factors.
  const bool may_keep = !locates_ && !system_->slips_smoothly();
  bool kept = std::exchange(quiet_, false) && may_keep;
  bool stale = true;  // no factors have been made yet
  bool pivoted = false;
  bool looking = search.has_value();
  const int displacements = system_->displacements();
  const auto length = [displacements](const VectorXd& of) {
    return displacements == 0 ? 0.0 : of.head(displacements).lpNorm<Eigen::Infinity>();
  };
  auto told = std::chrono::steady_clock::now();

  Pivoting pivoting = Pivoting::block;
  std::unordered_set<std::size_t> seen{fingerprint(statuses)};
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  const auto violations = [&] {
    const Rounding slack = system_->rounding(z);
    Violations found{{}, statuses};
    if (held) return found;
    system_->displacements(z, at_.moved);
    system_->each_joint([&](int i) {
      JointStatus& status = found.corrected[index(i)];
      status = system_->decide(i, z, at_.moved, time, start, joints, opening, status, slack);
    });
    for (int i = 0; i < static_cast<int>(statuses.size()); ++i) {
      if (found.corrected[index(i)] != statuses[index(i)]) found.joints.push_back(i);
    }
    return found;
  };
  // Lengths of the steps on the present statuses [m]; the last step leads from `from` by `step`.
  std::deque<double> lengths;
  VectorXd from;
  VectorXd step;
  int halvings = 0;
  TracedSolve traced(tracer_,
                     {time, joints, opening, report, statuses, lengths, halvings, factorizations_});
  double merit_before = 0.0;  // scaled residual at `from` [N]
  int iterations = 0;
  std::size_t pieces = 0;
  double first_largest = 0.0;  // largest force at the start of the solve [N]
  bool settled = false;        // whether no joint violates its inequality at z
  // Cycling test: block pivots since the last new minimum of violations, and the joints changed
  // since.
  int idle = 0;
  std::set<int> wandering;
  VectorXd closing_z;  // unknowns at which an open contact closed last
  // Cycling pivots lead to other linearised equations. Restarts begin from these values.
  const VectorXd first_z = z;
  const Statuses first_statuses = statuses;
  // Starts from the predictor unless changes are located: these are searched along the tangent.
  const bool is_foreseen = search && !search->stop;
  // With slack elements the solve also starts from the predictor. At the old length, thermal strain
  // of an element would appear as a tension that moves slack elements.
  const bool hangs = search && any_open(statuses);
  const VectorXd& begun_at = is_foreseen || hangs ? search->foreseen : first_z;
  if (is_foreseen || hangs || (search && kept && keeps(statuses, joints))) z = search->foreseen;
  bool condensed = false;
  bool patient = false;  // whether statuses change only once the equations hold
  /// Takes the Newton step from the start of the solve with statuses from the Schur-complement
  /// active set. Cycling joints begin in their first statuses, all others in the present ones.
  /// False: no solution.
  const auto condense = [&] {
    condensed = true;
    idle = 0;
    Statuses begun = statuses;
    for (const int i : wandering) begun[index(i)] = first_statuses[index(i)];
    at_.want_jacobian(true);
    system_->evaluate(first_z, time, start, begun, joints, opening, at_);
    constexpr double stable = linear::SparseFactor::stable_growth;
    if (!factorize(begun, joints, stable)) return false;
    const VectorXd whole = factor_.solve(-at_.residual);
    const std::vector<int> in_play(wandering.begin(), wandering.end());
    const Linearized here{first_z, time, start, joints, opening, begun, factor_, whole};
    auto answer = schur_active_set(*system_, here, in_play);
    if (!answer || !seen.insert(fingerprint(answer->statuses)).second) return false;
    statuses = std::move(answer->statuses);
    z = first_z + answer->step;
    return true;
  };
  /// Changes statuses of violated joints. False: statuses cycle.
  /// @param stepped whether z is at the end of a full step on the present factors
  const auto pivot = [&](const Violations& found, bool stepped) {
    if (found.joints.empty()) return true;
    pivoted = true;
    const auto begin_anew = [&] {
      current_ = false;
      report.joints = found.joints;
      lengths.clear();
      halvings = 0;
      iterations = 0;
      return true;
    };
    ++idle;
    if (found.joints.size() < fewest) {
      fewest = found.joints.size();
      idle = 0;
      wandering.clear();
      condensed = false;
      if (pivoting == Pivoting::single) {
        pivoting = Pivoting::block;
        seen.clear();
      }
    }
    wandering.insert(found.joints.begin(), found.joints.end());
    // Piecewise laws change their branch without a pivot, so they are not condensed.
    const double paid = idle * factor_.solutions_per_factorization();
    const bool wanders = at_.pieces == 0 && pivoting == Pivoting::block && stepped && idle > 0 &&
                         paid >= static_cast<double>(wandering.size());
    if (wanders && !condensed && condense()) return begin_anew();
    if (wanders && search) {
      // Iterates that have not converged may request statuses that the solution does not.
      if (std::exchange(patient, true)) return false;
      statuses = found.corrected;
      return begin_anew();
    }
    const auto take = [&] {
      if (pivoting != Pivoting::single) return found.corrected;
      Statuses one = statuses;
      one[index(found.joints.front())] = found.corrected[index(found.joints.front())];
      return one;
    };
    if (statuses[index(found.joints.front())] == JointStatus::open) closing_z = z;
    // A contact in tension while it sticks and in penetration while it is open may slip where it
    // closes.
    const auto slides = [&](const Violations& of) {
      const std::size_t first = index(of.joints.front());
      if (statuses[first] != JointStatus::open && of.corrected[first] != JointStatus::open) {
        return false;
      }
      for (const JointStatus slip : {JointStatus::slip_plus, JointStatus::slip_minus}) {
        Statuses sliding = statuses;
        sliding[first] = slip;
        if (!seen.insert(fingerprint(sliding)).second) continue;
        statuses = std::move(sliding);
        if (closing_z.size() > 0) z = closing_z;
        return true;
      }
      return false;
    };
    Statuses next = take();
    while (!seen.insert(fingerprint(next)).second) {
      if (pivoting == Pivoting::single) {
        // In a step of the path the rate problem decides this.
        const bool is_path = time != start.time && !start.damps_contact;
        if (is_path || !slides(found)) return false;
        return begin_anew();
      }
      pivoting = Pivoting::single;
      seen = {fingerprint(statuses)};
      next = take();
    }
    statuses = next;
    return begin_anew();
  };

  // Event detection, once per solve: finds the first of these joints that changes its status after
  // the start of the step. True: the solve ends at this event.
  const auto leaves_ahead = [&](const Violations& found) {
    if (!looking) return false;
    std::vector<int> leaving;
    const double idle_force = system_->idle_force(z, time, start, statuses);
    for (const int i : found.joints) {
      const bool is_event = system_->is_event(i, statuses[index(i)], found.corrected[index(i)]);
      if (is_event && !system_->is_idle(i, first_z, z, idle_force)) leaving.push_back(i);
    }
    if (leaving.empty()) return false;
    const Violation first =
        first_violation(leaving, first_z, z, search->from_time, time, start, joints, statuses);
    report.leaves_at_start = !(first.share > search->now);
    if (report.leaves_at_start) return false;
    looking = false;
    report.first_change = first.share;
    report.leaving.emplace(first.joint, found.corrected[index(first.joint)]);
    report.joints = found.joints;
    if (!search->stop) return false;
    quiet_ = !pivoted;
    report.end = SolveEnd::event_ahead;
    return true;
  };

  // Every joint may change once to each of its other statuses, at most five.
  const long most_pivots = most_iterations + 5 * static_cast<long>(statuses.size());
  for (long total = 0; iterations < most_iterations && total < most_pivots; ++total, ++iterations) {
    // With old factors only the residual is needed.
    bool old = kept && at_.pieces == 0 && halvings == 0 && keeps(statuses, joints);
    kept = may_keep;
    bool differentiated = false;
    const auto evaluate = [&](bool jacobian) {
      at_.want_jacobian(jacobian);
      system_->evaluate(z, time, start, statuses, joints, opening, at_);
      differentiated = jacobian;
    };
    // If the solve is likely to end here, the Jacobian is evaluated too: the rates need it.
    evaluate(!old || is_last(lengths, closure_tolerance * system_->reach(z)));
    const auto start_anew = [&] {
      z = begun_at;
      settled = false;
      lengths.clear();
      kept = false;
    };
    const double reach = system_->reach(z);
    const double rounding = system_->force_rounding(z);
    const Residuals left = residuals(at_);
    traced.iteration(left.balance, left.closure, left.force);
    // Beyond the size of the truss the linearised equations have no meaning.
    if (pivoted && system_->size() > 0.0 && length(z - begun_at) > system_->size()) return report;
    // Step lengths on another branch of a piecewise law are not comparable.
    if (std::exchange(pieces, at_.pieces) != at_.pieces) {
      lengths.clear();
      halvings = 0;
    }
    const double largest = at_.largest_force;
    const double merit = left.balance + left.force + system_->stiffness_scale() * left.closure;
    if (!std::isfinite(left.balance + left.closure + left.force)) {
      if (!stale || total == 0) return report;
      start_anew();
      continue;
    }
    // The new statuses were requested by linearised equations that are inaccurate if the force
    // residual exceeds half of the largest force, because many joints changed at once. A shorter
    // step changes fewer. Located changes are never passed together.
    if (total == 0) first_largest = largest;
    const bool astray = left.balance > 0.5 * std::max(largest, first_largest) + rounding;
    if (pivoted && is_foreseen && astray) return report;
    // If steps no longer shrink, a closure residual within the elastic deflection that rounding of
    // the forces causes in a lightly loaded contact is accepted.
    const auto closes = [&](double largest_gap) {
      if (largest_gap <= closure_tolerance * reach) return true;
      const std::size_t n = lengths.size();
      const bool shrinks = n < 2 || lengths[n - 1] < 0.5 * lengths[n - 2];
      if (shrinks || largest_gap > 1e3 * closure_tolerance * reach) return false;
      const Rounding by = system_->rounding(z);
      return system_->first_joint([&](int i) {
        const Eigen::Index row = system_->force_row(i);
        for (Eigen::Index k = row; k < row + system_->force_count(i); ++k) {
          const bool is_gap = at_.units[index(static_cast<int>(k))] == RowUnit::closure;
          if (!is_gap || std::abs(at_.residual[k]) <= by.length) continue;
          if (std::abs(at_.residual[k]) > system_->slide_rounding(i, z, time, start, by))
            return true;
        }
        return false;
      }) < 0;
    };
    // If rounding is larger than estimated, steps stagnate. This also counts as convergence,
    // provided that forces balance.
    const bool closed = left.balance <= tuned.force_tolerance * largest + rounding &&
                        closes(left.closure) && left.force <= 16.0 * epsilon * largest + rounding;
    const bool still = !lengths.empty() && lengths.back() <= closure_tolerance * reach &&
                       left.balance <= 1e3 * tuned.force_tolerance * largest + rounding;
    if (total > 0 && (closed || still)) {
      Violations found = settled ? Violations{} : violations();
      if (found.joints.empty()) {
        if (!differentiated) evaluate(true);
        report.end = SolveEnd::converged;
        report.force_residual = largest > 0.0 ? left.balance / largest : 0.0;
        report.closure_residual = left.closure;
        quiet_ = !pivoted;
        solved_on_ = statuses;
        solved_model_ = joints;
        return report;
      }
      if (stale) {
        start_anew();
        continue;
      }
      if (leaves_ahead(found)) return report;
      if (!pivot(found, false)) return report;
      continue;
    }
    VectorXd next;
    double next_length = 0.0;
    if (old) {
      next = factor_.solve(-at_.residual);
      next_length = length(next);
      const double enough = closure_tolerance * reach;
      if (!lengths.empty() && next_length > enough) {
        const double share = next_length / lengths.back();
        const bool shrinks = share < 1.0;
        if (!shrinks && stale) {
          start_anew();
          continue;
        }
        old = shrinks && keeping_pays(std::log(enough / next_length) / std::log(share));
      } else if (!lengths.empty() && lengths.back() <= enough) {
        old = false;  // stagnates
      }
      old = old && next.allFinite();
      if (!old && !differentiated) evaluate(true);
    }
    if (!old) {
      if (!factorize(statuses, joints)) {
        report.end = SolveEnd::singular;
        return report;
      }
      stale = false;
      current_ = true;
      next = factor_.solve(-at_.residual);
      if (!next.allFinite()) {
        report.end = SolveEnd::singular;
        return report;
      }
      next_length = length(next);
      const double most = tuned.proximal_fraction * system_->size();
      if (regularisation_ == Regularisation::displacements && next_length > most && most > 0.0) {
        next *= most / next_length;
        next_length = most;
      }
    }
    // Steps may grow along directions held by dashpots only, if the residual at least halves.
    const bool improves = start.slack_stiffness > 0.0 && merit <= 0.5 * merit_before;
    const bool too_long = !improves && !lengths.empty() &&
                          next_length > closure_tolerance * reach &&
                          next_length > *std::max_element(lengths.begin(), lengths.end());
    if (too_long) {
      if (++halvings > tuned.most_halvings) return report;
      z = from + std::ldexp(1.0, -halvings) * step;
      settled = false;
      continue;
    }
    const bool damped = halvings > 0;
    halvings = 0;
    from = z;
    merit_before = merit;
    // Iterates that alternate between two states are replaced by their mean.
    const std::size_t taken = lengths.size();
    const auto stalls = [&](std::size_t steps) {
      return taken >= steps && next_length > 0.5 * lengths[taken - steps];
    };
    if (stalls(tuned.swing_steps)) next *= 0.5;
    // If the caller can shorten the step or stiffen dashpots, a stagnating solve ends early.
    const bool gives_up = (search && pivoted) || start.damps_contact;
    if (gives_up && stalls(2 * tuned.swing_steps)) return report;
    step = next;
    z += next;
    settled = false;
    lengths.push_back(next_length);
    traced.step(next_length);
    if (lengths.size() > tuned.remembered_steps) lengths.pop_front();
    // The first step on a piecewise law may use the tangent of another branch: elements that slip
    // are at their limit at the start of a step, with the tangent of sticking. Statuses are not
    // checked then.
    const bool on_piece = at_.pieces == 0 || lengths.size() > 1;
    if (!damped && on_piece && !patient && pivoting != Pivoting::single) {
      const Violations found = violations();
      settled = found.joints.empty();
      if (stale && !settled) {
        start_anew();
        continue;
      }
      if (leaves_ahead(found)) return report;
      if (!pivot(found, true)) return report;
    }
    const auto now = std::chrono::steady_clock::now();
    if (std::chrono::duration<double>(now - told).count() > tuned.progress_interval_s) {
      told = now;
      if (!going_on_()) {
        report.end = SolveEnd::stopped;
        return report;
      }
    }
  }
  return report;
}

bool Newton::factorize(const Statuses& statuses, JointModel joints, double most_growth) {
  ++factorizations_;
  factored_ = factor_.factorize(at_.jacobian(), most_growth);
  regularisation_ = Regularisation::none;
  if (!factored_) {
    regularisation_ = factor_regularised(*system_, at_, proximal_stiffness_, factor_);
    factored_ = regularisation_ != Regularisation::none;
  }
  factored_on_ = statuses;
  factored_model_ = joints;
  return factored_;
}

std::vector<int> Newton::dependent_joints() const {
  // Self-equilibrated reactions grow a thousand times more than all others in a solution.
  VectorXd reactions = VectorXd::Zero(system_->unknowns());
  for (Eigen::Index row = system_->displacements(); row < reactions.size(); ++row) {
    reactions[row] = std::sin(1.0 + 1.7 * static_cast<double>(row));
  }
  const Eigen::Index first = system_->displacements();
  for (int round = 0; round < 2; ++round) {
    reactions = factor_.solve(reactions);
    reactions.head(first).setZero();
    reactions /= std::max(reactions.lpNorm<Eigen::Infinity>(), std::numeric_limits<double>::min());
  }
  std::vector<int> found;
  for (int i = 0; i < static_cast<int>(solved_on_.size()); ++i) {
    const Eigen::Index row = system_->force_row(i);
    const Eigen::Index rows = system_->force_count(i);
    if (reactions.segment(row, rows).lpNorm<Eigen::Infinity>() > 0.1) found.push_back(i);
  }
  return found;
}

Regularisation factor_regularised(const System& system, const Assembly& at,
                                  double proximal_stiffness, linear::SparseFactor& factor) {
  const double stiffness = system.stiffness_scale();
  if (!(stiffness > 0.0)) return Regularisation::none;
  Eigen::SparseMatrix<double> regular = at.jacobian();
  const auto add = [&](Eigen::Index row, double value) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(regular, row); it; ++it) {
      if (it.row() == row) it.valueRef() += value;
    }
  };
  for (Eigen::Index row = system.displacements(); row < regular.rows(); ++row) {
    const bool closes = at.units[index(static_cast<int>(row))] == RowUnit::closure;
    if (closes) add(row, -reaction_compliance / stiffness);
  }
  if (factor.factorize(regular)) return Regularisation::reactions;
  if (proximal_stiffness == 0.0) return Regularisation::none;
  for (Eigen::Index row = 0; row < system.displacements(); ++row) add(row, proximal_stiffness);
  return factor.factorize(regular) ? Regularisation::displacements : Regularisation::none;
}

bool Newton::keeping_pays(double decades) const {
  // With old factors each step gains one decade. With new factors the first gains two, and every
  // further one twice as many as the last. One iteration reads the entries of L and U, estimated
  // from the cost of a factorization, and those of the Jacobian.
  const double saved = factor_.solutions_per_factorization();
  const double factors = 4.0 * saved * system_->unknowns();
  const auto jacobian = static_cast<double>(at_.entries_of_jacobian());
  const double by_new = std::ceil(std::log2(0.5 * decades + 1.0));
  return std::ceil(decades) - by_new <= saved * factors / (factors + jacobian);
}

int Newton::stability_index() {
  if (!current_) current_ = factorize(solved_on_, solved_model_);
  if (!current_) return 0;
  const int found = checked_index(at_);
  current_ = found >= 0;
  return found;
}

int Newton::stability_index(const Assembly& at, const Statuses& statuses) {
  current_ = false;
  factored_ = factor_.factorize(at.jacobian(), linear::SparseFactor::refined_growth);
  factored_on_ = statuses;
  factored_model_ = JointModel::friction;
  return factored_ ? checked_index(at) : 0;
}

int Newton::checked_index(const Assembly& at) {
  const int found = index_of(factor_.determinant_sign(), at);
  if (found >= 0) return found;
  // Dependent constraints may leave a pivot of the size of rounding, whose sign is arbitrary.
  const Regularisation needed = factor_regularised(*system_, at, 0.0, factor_);
  factored_ = needed != Regularisation::none;
  if (!factored_) return found;
  const int regular = index_of(factor_.determinant_sign(), at);
  if (regular >= 0) regularisation_ = needed;
  return regular;
}

std::optional<VectorXd> Newton::rate(const VectorXd& by_time, const VectorXd& guess) {
  // The factors belong to an earlier iterate, so the rates are refined iteratively. If refinement
  // fails, for example after a change of statuses, new factors are computed.
  const double rounding = 16.0 * epsilon;  // of a row, which has some fifteen entries
  for (const bool fresh : {false, true}) {
    if (!fresh && !factored_) continue;
    if (fresh) {
      current_ = factorize(solved_on_, solved_model_);
      if (!current_) return std::nullopt;
    }
    VectorXd found = fresh || guess.size() == 0 ? VectorXd(factor_.solve(-by_time)) : guess;
    double last = std::numeric_limits<double>::infinity();
    for (;;) {
      const LeftOver left = left_over(at_, found, by_time, system_->stiffness_scale());
      if (left.share <= rounding) return found;
      // Refinement has reached rounding or diverges if the residual no longer halves.
      if (!(left.share <= 0.5 * last)) break;
      last = left.share;
      found -= factor_.solve(left.residual);
    }
    if (last <= (fresh ? std::sqrt(epsilon) : closure_tolerance)) return found;
  }
  return std::nullopt;
}

}  // namespace statejump::truss::detail
