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
/// Compliance of a closure whose reaction is not unique, in that of the stiffest element. Rounding
/// of a closure then changes reactions by a thousand roundings of them, and what is regularised
/// wrongly in unique directions shrinks by a thousand in every iteration.
constexpr double reaction_compliance = 1e-3;

/// Multiplying as many columns takes some ten times as long as starting a thread.
constexpr Eigen::Index halved_columns = 50000;

/// What is left of the equations, each kind in its own unit.
struct Residuals {
  double balance = 0.0;  ///< Of the nodes [N].
  double closure = 0.0;  ///< Of joints that hold [m].
  double force = 0.0;    ///< Of joints that slip or are open [N].
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

/// What rates leave of the linear equations of an assembly.
struct LeftOver {
  VectorXd residual;
  /// The largest residual of a force over the largest sum of forces that are added up in a row, all
  /// taken as positive, or that of a closure over the largest such sum, whatever is larger; nothing
  /// moves in less than what these forces move the stiffest part by. No metres are compared with
  /// newtons, and rounding alone leaves some 1e-16, however ill the condition (a backward error:
  /// W. Oettli, W. Prager, Numer. Math. 6 (1964) 405-409).
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
    // The same halves whatever threads there are.
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

/// Whether steps that go on shrinking as the last two did leave nothing more to do.
bool is_last(const std::deque<double>& lengths, double enough) {
  if (lengths.empty()) return false;
  const double last = lengths.back();
  const double before = lengths.size() < 2 ? last : lengths[lengths.size() - 2];
  return last <= enough || last * last <= enough * before;
}

/// The joints that violate their inequalities, and where they belong.
struct Violations {
  std::vector<int> joints;
  Statuses corrected;
};

/// How the set of branches is changed.
enum class Pivoting : unsigned char { block, single };

}  // namespace

/// Smallest share of the way at which one of the joints violates its inequality: each violates it
/// at the end.
Newton::Violation Newton::first_violation(const std::vector<int>& joints, const VectorXd& from,
                                          const VectorXd& to, double from_time, double time,
                                          const StepStart& start, JointModel model,
                                          const Statuses& statuses) const {
  Violation first{1.0, joints.front()};
  // Of one joint only: what it is asked about is linear between both states.
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
    // One that is later than the first so far need not be known.
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
  // Laws of several pieces have other equations on each; located changes ask for states that
  // only new factors make as exact.
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
  // Steps on this set of branches, the last of them from `from` by `step`.
  std::deque<double> lengths;
  VectorXd from;
  VectorXd step;
  int halvings = 0;
  TracedSolve traced(tracer_,
                     {time, joints, opening, report, statuses, lengths, halvings, factorizations_});
  double merit_before = 0.0;  // what was left of the equations at `from` [N]
  int iterations = 0;
  std::size_t pieces = 0;
  double first_largest = 0.0;  // force where the solve begins [N]
  bool settled = false;        // whether no joint violates its inequality where z is
  // Pivots of all joints since there were ever fewer violations, and the joints that had any since.
  int idle = 0;
  std::set<int> wandering;
  VectorXd closing_z;  // where the last contact that was open closed
  // Pivots that wander lead far away, where the equations are others: they begin anew from here.
  const VectorXd first_z = z;
  const Statuses first_statuses = statuses;
  // Where a change is to be located it is sought along the tangent at the start.
  const bool is_foreseen = search && !search->stop;
  // The tension of elements that are not yet as long as their temperature makes them would turn
  // slack ones.
  const bool hangs = search && any_open(statuses);
  const VectorXd& begun_at = is_foreseen || hangs ? search->foreseen : first_z;
  if (is_foreseen || hangs || (search && kept && keeps(statuses, joints))) z = search->foreseen;
  bool condensed = false;
  bool patient = false;  // whether joints change only where the equations of their branches hold
  /// Takes the step from the start that pivots on its factors lead to; false: there is none. What
  /// wanders is as it was at the start, everything else on the branches that were found.
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
  /// False if the sets go round in a circle.
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
    // Laws of several pieces change them without a pivot: they are not condensed.
    const double paid = idle * factor_.solutions_per_factorization();
    const bool wanders = at_.pieces == 0 && pivoting == Pivoting::block && stepped && idle > 0 &&
                         paid >= static_cast<double>(wandering.size());
    if (wanders && !condensed && condense()) return begin_anew();
    if (wanders && search) {
      // Steps that have not converged may ask for branches that the solution does not.
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
    // A contact that pulls while it sticks and closes while it is open may slide, where it closes.
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
        // Over a step that is the question of the rate problem.
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

  // Looks once where on the way from the start the first of these joints leaves its branch. True:
  // the solve ends there.
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

  // Every joint once on each of the other branches that it has, at most five.
  const long most_pivots = most_iterations + 5 * static_cast<long>(statuses.size());
  for (long total = 0; iterations < most_iterations && total < most_pivots; ++total, ++iterations) {
    // By factors that are there the residual is enough.
    bool old = kept && at_.pieces == 0 && halvings == 0 && keeps(statuses, joints);
    kept = may_keep;
    bool differentiated = false;
    const auto evaluate = [&](bool jacobian) {
      at_.want_jacobian(jacobian);
      system_->evaluate(z, time, start, statuses, joints, opening, at_);
      differentiated = jacobian;
    };
    // Where the solve is likely to end, the Jacobian is wanted: for the rates.
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
    // Farther than the truss is large no equation of its start says where to go.
    if (pivoted && system_->size() > 0.0 && length(z - begun_at) > system_->size()) return report;
    // Steps on other pieces of the branches say nothing of those on these.
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
    // Branches were asked for by equations that do not hold where they led to: of many joints that
    // change at once, forces lack half of the largest one. A shorter step changes fewer. Where
    // changes are located none are passed together.
    if (total == 0) first_largest = largest;
    const bool astray = left.balance > 0.5 * std::max(largest, first_largest) + rounding;
    if (pivoted && is_foreseen && astray) return report;
    // Where steps no longer shrink, what rounding of the forces bends a contact by that hardly
    // touches is no gap.
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
    // Where rounding is larger than foreseen the iteration stands still: that is the end as well,
    // if forces balance at all.
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
        old = false;  // it stands still
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
    // Steps may grow along directions that only dashpots hold, if equations are met the better.
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
    // Steps to and fro between the same two places meet in the middle.
    const std::size_t taken = lengths.size();
    const auto stalls = [&](std::size_t steps) {
      return taken >= steps && next_length > 0.5 * lengths[taken - steps];
    };
    if (stalls(tuned.swing_steps)) next *= 0.5;
    // Where a shorter step or stiffer dashpots are the answer, one that shrinks no more is given
    // up.
    const bool gives_up = (search && pivoted) || start.damps_contact;
    if (gives_up && stalls(2 * tuned.swing_steps)) return report;
    step = next;
    z += next;
    settled = false;
    lengths.push_back(next_length);
    traced.step(next_length);
    if (lengths.size() > tuned.remembered_steps) lengths.pop_front();
    // Of a law with several pieces a step on the tangent of another piece says nothing: elements
    // that slip stand at their bound at the start of a step, where their tangent is that of
    // sticking.
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
  // Reactions that balance each other outgrow all others by a thousand in a solution.
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
  // By old factors each step is one decade, by new ones the first is two and every one twice that
  // of the last. An iteration passes the entries of the factors, as many in L and U as the cost of
  // a factorization tells, and those of the Jacobian.
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
  // Constraints that depend on each other may leave a pivot of rounding, whose sign means nothing.
  const Regularisation needed = factor_regularised(*system_, at, 0.0, factor_);
  factored_ = needed != Regularisation::none;
  if (!factored_) return found;
  const int regular = index_of(factor_.determinant_sign(), at);
  if (regular >= 0) regularisation_ = needed;
  return regular;
}

std::optional<VectorXd> Newton::rate(const VectorXd& by_time, const VectorXd& guess) {
  // The factors are those of the state before the last step, or of its start: what that leaves is
  // refined away, and where it is not (the branches have changed since), there are new factors.
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
      // Refinement that no longer halves what is left is at rounding, or leads nowhere.
      if (!(left.share <= 0.5 * last)) break;
      last = left.share;
      found -= factor_.solve(left.residual);
    }
    if (last <= (fresh ? std::sqrt(epsilon) : closure_tolerance)) return found;
  }
  return std::nullopt;
}

}  // namespace statejump::truss::detail
