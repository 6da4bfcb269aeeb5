// SPDX-License-Identifier: GPL-3.0-or-later
#include "newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "newton_options.hpp"
#include "numerics/raise.hpp"
#include "parallel.hpp"
#include "rate_problem.hpp"

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

}  // namespace

/// Smallest fraction of the step at which one of the joints violates its inequality. @pre each
/// joint violates it at the end of the step
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

namespace {

void add_to_diagonal(Eigen::SparseMatrix<double>& matrix, Eigen::Index row, double value) {
  for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, row); it; ++it) {
    if (it.row() == row) it.valueRef() += value;
  }
}

}  // namespace

Eigen::SparseMatrix<double> with_compliant_closures(const System& system, const Assembly& at) {
  Eigen::SparseMatrix<double> regular = at.jacobian();
  for (Eigen::Index row = system.displacements(); row < regular.rows(); ++row) {
    if (at.units[index(static_cast<int>(row))] != RowUnit::closure) continue;
    add_to_diagonal(regular, row, -reaction_compliance / system.stiffness_scale());
  }
  return regular;
}

Regularisation factor_regularised(const System& system, const Assembly& at,
                                  double proximal_stiffness, linear::SparseFactor& factor) {
  if (!(system.stiffness_scale() > 0.0)) return Regularisation::none;
  Eigen::SparseMatrix<double> regular = with_compliant_closures(system, at);
  if (factor.factorize(regular)) return Regularisation::reactions;
  if (proximal_stiffness == 0.0) return Regularisation::none;
  for (Eigen::Index row = 0; row < system.displacements(); ++row) {
    add_to_diagonal(regular, row, proximal_stiffness);
  }
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
