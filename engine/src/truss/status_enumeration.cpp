// SPDX-License-Identifier: GPL-3.0-or-later
#include "status_enumeration.hpp"

#include <Eigen/LU>

#include "active_set.hpp"
#include "newton.hpp"
#include "rate_problem.hpp"

namespace statejump::truss::detail {

namespace {

using RowMajor = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Largest group whose sets are all tried; joints have two statuses as a rule.
constexpr std::size_t most_joints = 8;
constexpr std::size_t most_sets = std::size_t{1} << most_joints;

}  // namespace

double length_of(const VectorXd& step, int displacements) {
  return displacements == 0 ? 0.0 : step.head(displacements).lpNorm<Eigen::Infinity>();
}

std::optional<Branches> prepare(const System& system, const VectorXd& z, double target,
                                const StepStart& start, std::vector<Candidate> candidates,
                                Assembly& at, linear::SparseFactor& factor) {
  Branches made{std::move(candidates), start.statuses, {}, {}, {}, 0};
  Eigen::Index rows = 0;
  std::size_t most = 0;
  for (Candidate& one : made.candidates) {
    one.place = rows;
    rows += one.rows;
    most = std::max(most, one.branches.size());
    made.base[index(one.joint)] = one.branches.front();
  }
  system.evaluate(z, target, start, made.base, JointModel::friction, 1.0, at);
  if (!factor.factorize(at.jacobian()) &&
      factor_regularised(system, at, 0.0, factor) == Regularisation::none) {
    return std::nullopt;
  }
  made.index = index_of(factor.determinant_sign(), at);
  made.step = factor.solve(-at.residual);
  made.response.resize(system.unknowns(), rows);
  for (const Candidate& one : made.candidates) {
    for (int k = 0; k < one.rows; ++k) {
      made.response.col(one.place + k) =
          factor.solve(VectorXd::Unit(system.unknowns(), one.first_row + k));
    }
  }
  if (!made.step.allFinite() || !made.response.allFinite()) return std::nullopt;
  for (std::size_t layer = 0; layer < most; ++layer) {
    Statuses statuses = made.base;
    for (const Candidate& one : made.candidates) {
      statuses[index(one.joint)] = one.branches[std::min(layer, one.branches.size() - 1)];
    }
    if (layer > 0) system.evaluate(z, target, start, statuses, JointModel::friction, 1.0, at);
    Layer added{Eigen::MatrixXd(rows, rows), VectorXd(rows), {}};
    const RowMajor jacobian = at.jacobian();
    for (const Candidate& one : made.candidates) {
      for (int k = 0; k < one.rows; ++k) {
        const int row = one.first_row + k;
        added.influence.row(one.place + k) = jacobian.row(row) * made.response;
        added.value[one.place + k] = at.residual[row] + jacobian.row(row).dot(made.step);
        added.units.push_back(at.units[index(row)]);
      }
    }
    made.layers.push_back(std::move(added));
  }
  return made;
}

std::vector<Group> groups_of(const Branches& of) {
  const std::size_t n = of.candidates.size();
  const auto moves = [&](const Candidate& one, const Candidate& other) {
    return std::any_of(of.layers.begin(), of.layers.end(), [&](const Layer& layer) {
      return !layer.influence.block(one.place, other.place, one.rows, other.rows).isZero(0.0);
    });
  };
  std::vector<Group> groups;
  std::vector<bool> grouped(n, false);
  for (std::size_t first = 0; first < n; ++first) {
    if (grouped[first]) continue;
    Group group{first};
    grouped[first] = true;
    for (std::size_t k = 0; k < group.size(); ++k) {
      const Candidate& one = of.candidates[group[k]];
      for (std::size_t other = 0; other < n; ++other) {
        const Candidate& two = of.candidates[other];
        if (grouped[other] || !(moves(one, two) || moves(two, one))) continue;
        grouped[other] = true;
        group.push_back(other);
      }
    }
    std::sort(group.begin(), group.end());
    groups.push_back(std::move(group));
  }
  return groups;
}

namespace {

std::optional<Motion> motion_on(const Branches& of, const Group& group, const Choice& choice) {
  std::vector<Eigen::Index> rows;
  for (const std::size_t i : group) {
    const Candidate& one = of.candidates[i];
    for (Eigen::Index k = one.place; k < one.place + one.rows; ++k) rows.push_back(k);
  }
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd matrix(n, n);
  VectorXd value(n);
  int sign = of.index;
  Eigen::Index to = 0;
  for (const std::size_t i : group) {
    const Candidate& one = of.candidates[i];
    const Layer& layer = of.layers[choice[i]];
    for (Eigen::Index k = one.place; k < one.place + one.rows; ++k, ++to) {
      matrix.row(to) = layer.influence(k, rows);
      value[to] = layer.value[k];
      const auto at = static_cast<std::size_t>(k);
      if (layer.units[at] != of.layers[0].units[at]) sign = -sign;
    }
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> factors(matrix);
  if (!factors.isInvertible()) return std::nullopt;
  if (factors.determinant() < 0.0) sign = -sign;
  return Motion{choice, of.step - of.response(Eigen::all, rows) * factors.solve(value), sign};
}

/// Number of status sets of a group; counting stops above most_sets.
std::size_t sets_of(const Branches& of, const Group& group) {
  std::size_t sets = 1;
  for (const std::size_t i : group) {
    sets *= of.candidates[i].branches.size();
    if (sets > most_sets) break;
  }
  return sets;
}

/// Candidates of a group that request another status.
std::vector<RequestedStatus> violations(const Branches& of, const Group& group,
                                        const Asking& asking, const Motion& motion) {
  std::vector<RequestedStatus> found;
  for (const std::size_t i : group) {
    const Candidate& one = of.candidates[i];
    const JointStatus status = one.branches[motion.choice[i]];
    const JointStatus wanted = asking.wanted(one.joint, motion, status);
    if (wanted != status) found.emplace_back(i, wanted);
  }
  return found;
}

Found try_all(const Branches& of, const Group& group, const Asking& asking) {
  Found found;
  Choice choice(of.candidates.size(), 0);
  const std::size_t sets = sets_of(of, group);
  for (std::size_t number = 0; number < sets && found.requested.empty(); ++number) {
    std::size_t left = number;
    for (const std::size_t i : group) {
      choice[i] = left % of.candidates[i].branches.size();
      left /= of.candidates[i].branches.size();
    }
    const auto motion = motion_on(of, group, choice);
    if (!motion) found.singular = choice;
    if (!motion || !asking.is_short(*motion)) continue;
    const std::vector<RequestedStatus> off = violations(of, group, asking, *motion);
    for (const RequestedStatus& request : off) {
      if (!of.candidates[request.first].has(request.second)) found.requested.push_back(request);
    }
    if (!off.empty()) continue;
    const auto known =
        std::find_if(found.motions.begin(), found.motions.end(),
                     [&](const Motion& other) { return asking.agree(*motion, other); });
    if (known == found.motions.end()) {
      found.motions.push_back(*motion);
    } else if (motion->index > known->index) {
      *known = *motion;
    }
  }
  return found;
}

/// Pivoting in a group with too many sets to try, for find_active_set().
class GroupPivots {
 public:
  GroupPivots(const Branches& of, const Group& group, const Asking& asking)
      : of_(of), group_(group), asking_(asking), choice_(of.candidates.size(), 0) {
    found_.examined = false;
  }

  /// One solution; others are not excluded.
  Found find() {
    if (solve() && find_active_set(*this) && asking_.is_short(*motion_)) {
      found_.motions.push_back(*motion_);
    }
    return std::move(found_);
  }

  const Choice& key() const { return choice_; }
  const std::vector<RequestedStatus>& violated() const { return violated_; }
  bool change(const std::vector<RequestedStatus>& changes, const PivotSearch<Choice>& search) {
    for (const auto& [i, wanted] : changes) choice_[i] = branch_of(i, wanted);
    if (search.was_tried(choice_)) slide_instead(changes.front().first, search);
    return true;
  }
  /// False if the equations are singular, or if a candidate requests a status that is not among its
  /// statuses.
  bool solve() {
    motion_ = motion_on(of_, group_, choice_);
    if (!motion_) {
      found_.singular = choice_;
      return false;
    }
    violated_ = violations(of_, group_, asking_, *motion_);
    for (const RequestedStatus& request : violated_) {
      if (!of_.candidates[request.first].has(request.second)) found_.requested.push_back(request);
    }
    return found_.requested.empty();
  }

 private:
  std::size_t branch_of(std::size_t candidate, JointStatus status) const {
    const std::vector<JointStatus>& branches = of_.candidates[candidate].branches;
    const auto found = std::find(branches.begin(), branches.end(), status);
    return static_cast<std::size_t>(found - branches.begin());
  }

  /// A contact in tension while it sticks and in penetration while it is open may slip: selects
  /// such a choice if one was not tried yet.
  void slide_instead(std::size_t candidate, const PivotSearch<Choice>& search) {
    const std::vector<JointStatus>& branches = of_.candidates[candidate].branches;
    if (!of_.candidates[candidate].has(JointStatus::open)) return;
    for (std::size_t branch = 0; branch < branches.size(); ++branch) {
      if (!is_slip(branches[branch])) continue;
      Choice sliding = choice_;
      sliding[candidate] = branch;
      if (search.was_tried(sliding)) continue;
      choice_ = std::move(sliding);
      return;
    }
  }

  const Branches& of_;
  const Group& group_;
  const Asking& asking_;
  Choice choice_;
  std::optional<Motion> motion_;
  std::vector<RequestedStatus> violated_;
  Found found_;
};

}  // namespace

Found motions_of(const Branches& of, const Group& group, const Asking& asking) {
  const bool few = group.size() <= most_joints && sets_of(of, group) <= most_sets;
  return few ? try_all(of, group, asking) : GroupPivots(of, group, asking).find();
}

}  // namespace statejump::truss::detail
