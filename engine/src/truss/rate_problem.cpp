// SPDX-License-Identifier: GPL-3.0-or-later
#include "rate_problem.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace statejump::truss::detail {

namespace {

/// Joints at a bound that are decided together, as a rule with two branches each.
constexpr std::size_t most_joints = 8;
constexpr std::size_t most_sets = std::size_t{1} << most_joints;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

using RowMajor = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// A joint at a bound and its branches there, the first of them with contact.
struct Candidate {
  int joint;
  std::vector<JointStatus> branches;
  int first_row;
  int rows;
  Eigen::Index place;  ///< Of its first row among those of all candidates.

  bool has(JointStatus status) const {
    return std::find(branches.begin(), branches.end(), status) != branches.end();
  }
};

/// Largest displacement [m].
double length_of(const VectorXd& step, int displacements) {
  return displacements == 0 ? 0.0 : step.head(displacements).lpNorm<Eigen::Infinity>();
}

/// Displacement beyond which a motion is a jump [m].
double farthest(const System& system, const VectorXd& z, const VectorXd& step) {
  const int displacements = system.displacements();
  const Eigen::Index forces = z.size() - displacements;
  double share = length_of(step, displacements) / system.size();
  if (forces > 0) {
    const double force = z.tail(forces).lpNorm<Eigen::Infinity>();
    if (force > 0.0) share = std::max(share, step.tail(forces).lpNorm<Eigen::Infinity>() / force);
  }
  return std::sqrt(share) * system.size();
}

/// Rows of all candidates on one branch each.
struct Layer {
  Eigen::MatrixXd influence;  ///< On these rows of a unit of each row of the base.
  VectorXd value;             ///< Of the rows after the base's step.
  std::vector<RowUnit> units;
};

/// The problem with the candidates' branches fixed.
struct Branches {
  std::vector<Candidate> candidates;
  Statuses base;
  std::vector<Layer>
      layers;                ///< Layer k: every candidate on its branch k, the last if it has less.
  Eigen::MatrixXd response;  ///< Of the unknowns to a unit in each row of the base.
  VectorXd step;             ///< Of the unknowns on the base.
  int index = 0;             ///< Of the base.
};

/// Whether only stick and slip one way are asked, each a row of its own kind.
std::optional<Eigen::MatrixXd> complementarity_matrix(const Branches& of) {
  const auto n = static_cast<Eigen::Index>(of.candidates.size());
  std::vector<Eigen::Index> row(static_cast<std::size_t>(n));
  VectorXd sense(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Candidate& one = of.candidates[static_cast<std::size_t>(i)];
    if (one.branches.size() != 2) return std::nullopt;
    const bool slips_second = is_slip(one.branches[1]);
    const JointStatus slip = one.branches[slips_second ? 1 : 0];
    const JointStatus held = one.branches[slips_second ? 0 : 1];
    if (held != JointStatus::stick || !is_slip(slip)) return std::nullopt;
    sense[i] = slip == JointStatus::slip_plus ? 1.0 : -1.0;
    Eigen::Index differs = -1;
    for (Eigen::Index k = one.place; k < one.place + one.rows; ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (of.layers[0].units[at] == of.layers[1].units[at]) continue;
      if (differs >= 0) return std::nullopt;
      differs = k;
    }
    if (differs < 0) return std::nullopt;
    row[static_cast<std::size_t>(i)] = differs;
  }
  // Sliding the slip's way and what friction has left of its bound are both to be >= 0.
  Eigen::MatrixXd matrix(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      matrix(i, j) = -sense[i] * sense[j] *
                     of.layers[1].influence(row[static_cast<std::size_t>(i)],
                                            row[static_cast<std::size_t>(j)]);
    }
  }
  return matrix;
}

bool has_positive_symmetric_part(Eigen::MatrixXd matrix) {
  // Rows and columns in units of their own, for a rounding that is the same everywhere.
  if (!(matrix.diagonal().array() > 0.0).all()) return false;
  const VectorXd unit = matrix.diagonal().cwiseSqrt().cwiseInverse();
  matrix = unit.asDiagonal() * matrix * unit.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> factors(0.5 * (matrix + matrix.transpose()));
  const double rounding = std::sqrt(epsilon);
  return factors.info() == Eigen::Success && (factors.vectorD().array() > rounding).all();
}

}  // namespace

int index_of(int determinant_sign, const Assembly& at) {
  const auto closures = std::count(at.units.begin(), at.units.end(), RowUnit::closure);
  return closures % 2 == 0 ? determinant_sign : -determinant_sign;
}

int RateProblem::index_at(const VectorXd& z, double time, const StepStart& start,
                          const Statuses& statuses) {
  system_->evaluate(z, time, start, statuses, JointModel::friction, 1.0, at_);
  if (!factor_.factorize(at_.jacobian)) return 0;
  return index_of(factor_.determinant_sign(), at_);
}

namespace {

/// Factors the base and evaluates the other branches; nothing if the base is singular.
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
  if (!factor.factorize(at.jacobian)) return std::nullopt;
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
    const RowMajor jacobian = at.jacobian;
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

/// The motion with every candidate on one of its branches, and the index of that set.
struct Motion {
  VectorXd step;
  int index;
};

std::optional<Motion> motion_on(const Branches& of, const std::vector<std::size_t>& choice) {
  const Eigen::Index rows = of.response.cols();
  Eigen::MatrixXd matrix(rows, rows);
  VectorXd value(rows);
  int sign = of.index;
  for (std::size_t i = 0; i < of.candidates.size(); ++i) {
    const Candidate& one = of.candidates[i];
    const Layer& layer = of.layers[choice[i]];
    for (Eigen::Index k = one.place; k < one.place + one.rows; ++k) {
      matrix.row(k) = layer.influence.row(k);
      value[k] = layer.value[k];
      const auto at = static_cast<std::size_t>(k);
      if (layer.units[at] != of.layers[0].units[at]) sign = -sign;
    }
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> factors(matrix);
  if (!factors.isInvertible()) return std::nullopt;
  if (factors.determinant() < 0.0) sign = -sign;
  return Motion{of.step - of.response * factors.solve(value), sign};
}

}  // namespace

RateAnswer RateProblem::solve(const VectorXd& z, double target, const StepStart& start,
                              const Statuses& found, const std::vector<int>& changing) {
  RateAnswer answer;
  std::vector<Candidate> candidates;
  const auto candidate = [&](int joint) -> Candidate& {
    for (Candidate& one : candidates) {
      if (one.joint == joint) return one;
    }
    const int rows = system_->force_count(joint);
    candidates.push_back(
        {joint, {start.statuses[index(joint)]}, system_->force_row(joint), rows, 0});
    return candidates.back();
  };
  // Whether something was added. An open joint has no normal: its rows are no base for the others.
  const auto add = [](Candidate& to, JointStatus status) {
    if (to.has(status)) return false;
    to.branches.push_back(status);
    if (to.branches.front() == JointStatus::open) {
      std::swap(to.branches.front(), to.branches.back());
    }
    return true;
  };
  for (int i = 0; i < static_cast<int>(start.statuses.size()); ++i) {
    const JointStatus before = start.statuses[index(i)];
    const bool slips = is_slip(before) && system_->remembers_when(i, before, JointStatus::stick);
    if (slips) add(candidate(i), JointStatus::stick);
    if (!found.empty() && found[index(i)] != before) add(candidate(i), found[index(i)]);
    if (candidates.size() > most_joints) return answer;
  }
  for (const int joint : changing) candidate(joint);

  const int displacements = system_->displacements();
  const Rounding rounding = system_->rounding(z);
  // Every round knows one more branch of one of at most so many joints.
  for (;;) {
    std::size_t sets = 1;
    for (const Candidate& one : candidates) sets *= one.branches.size();
    if (candidates.size() > most_joints || sets > most_sets) return answer;
    answer.joints.clear();
    for (const Candidate& one : candidates) {
      answer.joints.push_back(one.joint);
      answer.opens = answer.opens || one.has(JointStatus::open);
    }
    const auto of = prepare(*system_, z, target, start, candidates, at_, factor_);
    if (!of) return answer;
    if (!found.empty()) {
      const auto matrix = complementarity_matrix(*of);
      if (matrix && has_positive_symmetric_part(*matrix)) {
        answer.count = Continuation::one;
        answer.statuses = found;
        return answer;
      }
    }
    const double near = farthest(*system_, z, of->step);

    bool widened = false;
    std::vector<Motion> solutions;
    std::vector<Statuses> sets_found;
    std::vector<std::size_t> choice(candidates.size(), 0);
    for (std::size_t set = 0; set < sets && !widened; ++set) {
      Statuses statuses = start.statuses;
      std::size_t left = set;
      for (std::size_t i = 0; i < candidates.size(); ++i) {
        choice[i] = left % candidates[i].branches.size();
        left /= candidates[i].branches.size();
        statuses[index(candidates[i].joint)] = candidates[i].branches[choice[i]];
      }
      const auto motion = motion_on(*of, choice);
      if (!motion) answer.singular = statuses;
      if (!motion || !(length_of(motion->step, displacements) <= near)) continue;
      const VectorXd end = z + motion->step;
      const auto asked = [&](int joint) {
        return system_->decide(joint, end, target, start, JointModel::friction, 1.0,
                               statuses[index(joint)], rounding);
      };
      bool holds = true;
      for (std::size_t i = 0; i < candidates.size(); ++i) {
        const JointStatus wanted = asked(candidates[i].joint);
        if (wanted == candidates[i].branches[choice[i]]) continue;
        holds = false;
        widened = add(candidates[i], wanted) || widened;
      }
      if (!holds) continue;
      for (int i = 0; i < static_cast<int>(statuses.size()); ++i) {
        const JointStatus wanted = asked(i);
        if (wanted == statuses[index(i)]) continue;
        holds = false;
        widened = add(candidate(i), wanted) || widened;
      }
      if (!holds) continue;
      const auto agrees = [&](const Motion& other) {
        const double apart = length_of(other.step - motion->step, displacements);
        const double size = length_of(motion->step, displacements);
        return apart <= std::sqrt((rounding.length + epsilon * size) * size);
      };
      const auto known = std::find_if(solutions.begin(), solutions.end(), agrees);
      if (known == solutions.end()) {
        solutions.push_back(*motion);
        sets_found.push_back(statuses);
      } else if (motion->index > known->index) {
        *known = *motion;
        sets_found[static_cast<std::size_t>(known - solutions.begin())] = statuses;
      }
    }
    if (widened) continue;
    int stable = 0;
    for (std::size_t i = 0; i < solutions.size(); ++i) {
      if (solutions[i].index < 0) continue;
      ++stable;
      answer.statuses = sets_found[i];
      answer.step = solutions[i].step;
    }
    answer.count = stable == 0   ? Continuation::none
                   : stable == 1 ? Continuation::one
                                 : Continuation::several;
    return answer;
  }
}

}  // namespace statejump::truss::detail
