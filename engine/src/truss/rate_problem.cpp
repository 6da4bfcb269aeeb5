// SPDX-License-Identifier: GPL-3.0-or-later
#include "rate_problem.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <variant>

#include "status_enumeration.hpp"

namespace statejump::truss::detail {

namespace {

/// Largest number of joints at a limit for which a converged step is checked for other
/// continuations.
constexpr std::size_t most_joints = 8;
/// Largest number of entries of the dense response matrix: 1 GiB.
constexpr std::size_t most_numbers = std::size_t{1} << 27;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

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

/// The row of a candidate that differs between stick and slip, and the layers of both statuses.
struct Exchange {
  Eigen::Index row;
  std::size_t stick, slip;
};

/// Exists only if the candidate's statuses are stick and slip. Slip in both directions must have
/// the same gradients.
std::optional<Exchange> exchange_of(const Branches& of, const Candidate& one) {
  Exchange found{-1, one.branches.size(), one.branches.size()};
  for (std::size_t layer = 0; layer < one.branches.size(); ++layer) {
    const JointStatus status = one.branches[layer];
    if (status == JointStatus::stick) {
      found.stick = layer;
    } else if (is_slip(status)) {
      found.slip = layer;
    } else {
      return std::nullopt;
    }
  }
  if (std::max(found.stick, found.slip) == one.branches.size()) return std::nullopt;
  const Layer& stick = of.layers[found.stick];
  for (std::size_t layer = 0; layer < one.branches.size(); ++layer) {
    const auto gradients = [&](const Layer& with) {
      return with.influence.middleRows(one.place, one.rows);
    };
    if (layer != found.stick && gradients(of.layers[layer]) != gradients(of.layers[found.slip])) {
      return std::nullopt;
    }
  }
  for (Eigen::Index k = one.place; k < one.place + one.rows; ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (stick.units[at] == of.layers[found.slip].units[at]) continue;
    if (found.row >= 0) return std::nullopt;
    found.row = k;
  }
  return found.row >= 0 ? std::optional(found) : std::nullopt;
}

/// Matrix of the complementarity problem: slide of each candidate per decrease of the friction of
/// each candidate, while all slip. It exists only if exchange_of() exists for every candidate.
std::optional<Eigen::MatrixXd> complementarity_matrix(const Branches& of) {
  const auto n = static_cast<Eigen::Index>(of.candidates.size());
  std::vector<Exchange> exchanged;
  for (const Candidate& one : of.candidates) {
    const auto found = exchange_of(of, one);
    if (!found) return std::nullopt;
    exchanged.push_back(*found);
  }
  Eigen::MatrixXd stick(n, n), slip(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Exchange& one = exchanged[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < n; ++j) {
      const Eigen::Index to = exchanged[static_cast<std::size_t>(j)].row;
      stick(i, j) = of.layers[one.stick].influence(one.row, to);
      slip(i, j) = of.layers[one.slip].influence(one.row, to);
    }
  }
  if (slip.isIdentity(0.0)) return -stick;  // all slip in the base
  const Eigen::PartialPivLU<Eigen::MatrixXd> factors(slip);
  if (!(factors.rcond() > epsilon)) return std::nullopt;
  return -stick * factors.inverse();
}

/// Number of continuations that the complementarity matrix alone guarantees.
enum class Guarantee : unsigned char {
  none,
  one_motion,  ///< All solutions have the same displacements; friction forces may differ.
  one,
};

/// Candidates that slide in some motion. Joints that stick prevent the slides of all others, whose
/// rows and columns are rounding. Nothing if the matrix is not positive semidefinite.
std::optional<std::vector<Eigen::Index>> that_slide(const Eigen::MatrixXd& matrix) {
  const double rounding = epsilon * matrix.cwiseAbs().maxCoeff();
  std::vector<Eigen::Index> found;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    if (matrix(i, i) > rounding) {
      found.push_back(i);
    } else if (matrix.row(i).cwiseAbs().maxCoeff() > rounding ||
               matrix.col(i).cwiseAbs().maxCoeff() > rounding) {
      return std::nullopt;
    }
  }
  return found;
}

/// See RateProblem. The symmetric part is compared with zero to √ε of a matrix with unit diagonal:
/// the factors of the equations and the matrix itself each lose some of the ε of its entries.
Guarantee guaranteed_by(Eigen::MatrixXd matrix) {
  if (matrix.size() == 0) return Guarantee::one;  // no candidates
  const Eigen::Index all = matrix.rows();
  const auto moving = that_slide(matrix);
  if (!moving) return Guarantee::none;
  if (moving->empty()) return Guarantee::one_motion;
  matrix = matrix(*moving, *moving).eval();
  const VectorXd unit = matrix.diagonal().cwiseSqrt().cwiseInverse();
  matrix = unit.asDiagonal() * matrix * unit.asDiagonal();
  const double rounding = std::sqrt(epsilon);
  const Eigen::MatrixXd symmetric = 0.5 * (matrix + matrix.transpose());
  const Eigen::LDLT<Eigen::MatrixXd> factors(symmetric);
  const bool is_definite =
      factors.info() == Eigen::Success && (factors.vectorD().array() > rounding).all();
  if (is_definite && matrix.rows() == all) return Guarantee::one;
  if ((matrix - symmetric).lpNorm<Eigen::Infinity>() > rounding) return Guarantee::none;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric, Eigen::EigenvaluesOnly);
  const bool is_semidefinite =
      eigen.info() == Eigen::Success && eigen.eigenvalues()[0] >= -rounding;
  return is_semidefinite ? Guarantee::one_motion : Guarantee::none;
}

/// Step for which the statuses at its start are sought.
struct Sought {
  const System& system;
  const VectorXd& z;
  double target;
  const StepStart& start;
  const Statuses& found;  ///< See RateProblem::solve().
};

/// The search of RateProblem::solve(). Each round enumerates the statuses of the candidates. If a
/// solution requests a status that is not among them, the next round includes it.
class RateSearch {
 public:
  RateSearch(const Sought& of, Assembly& at, linear::SparseFactor& factor)
      : of_(of), at_(at), factor_(factor) {}

  RateAnswer solve(const std::vector<int>& changing) {
    if (!add_found()) return answer_;
    for (const int joint : changing) candidate(joint);
    // The loop ends, because every round adds at least one status to one of the joints.
    while (!is_too_large() && round()) continue;
    return answer_;
  }

 private:
  /// Solutions of a round.
  struct Round {
    const Branches& branches;
    const Asking asking;
    std::vector<Group> groups;
    std::vector<Found> found;  ///< For each group.
    const Guarantee guarantee;
  };

  bool solved() const { return !of_.found.empty(); }
  std::size_t candidate(int joint);
  /// Adds a status to a candidate; returns whether it is new. The base (first status) must be
  /// closed: an open joint has no normal.
  bool add(std::size_t candidate, JointStatus status);
  /// Adds joints that slip or change their status. False: there are too many.
  bool add_found();
  bool is_too_large() const;
  /// Returns whether another round follows; otherwise answer_ is complete.
  bool round();
  bool add_requested(const Round& now);
  bool add_slips(const Round& now);
  bool add_others(const Round& now);
  void conclude(const Round& now);
  /// Combines a motion of one group with the first motion of every other group, to check the joints
  /// that are not candidates.
  static Motion together(const Round& now, std::size_t special, const Motion& with);
  /// The continuation of a group whose solutions are one; null otherwise.
  const Motion* only(const Found& of, Guarantee guarantee) const;

  Sought of_;
  Assembly& at_;
  linear::SparseFactor& factor_;
  std::vector<Candidate> candidates_;
  RateAnswer answer_;
};

std::size_t RateSearch::candidate(int joint) {
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (candidates_[i].joint == joint) return i;
  }
  const int rows = of_.system.force_count(joint);
  candidates_.push_back(
      {joint, {of_.start.statuses[index(joint)]}, of_.system.force_row(joint), rows, 0});
  return candidates_.size() - 1;
}

bool RateSearch::add(std::size_t candidate, JointStatus status) {
  Candidate& to = candidates_[candidate];
  if (to.has(status)) return false;
  to.branches.push_back(status);
  if (to.branches.front() == JointStatus::open) std::swap(to.branches.front(), to.branches.back());
  return true;
}

bool RateSearch::add_found() {
  for (int i = 0; i < static_cast<int>(of_.start.statuses.size()); ++i) {
    const JointStatus before = of_.start.statuses[index(i)];
    const bool slips = is_slip(before) && of_.system.remembers_when(i, before, JointStatus::stick);
    if (slips) add(candidate(i), JointStatus::stick);
    if (solved() && of_.found[index(i)] != before) add(candidate(i), of_.found[index(i)]);
    if (solved() && candidates_.size() > most_joints) return false;
  }
  return true;
}

bool RateSearch::is_too_large() const {
  std::size_t numbers = 0;
  for (const Candidate& one : candidates_) numbers += index(one.rows);
  numbers *= index(of_.system.unknowns());
  return (solved() && candidates_.size() > most_joints) || numbers > most_numbers;
}

bool RateSearch::round() {
  answer_.joints.clear();
  for (const Candidate& one : candidates_) {
    answer_.joints.push_back(one.joint);
    answer_.opens = answer_.opens || one.has(JointStatus::open);
  }
  const auto branches =
      prepare(of_.system, of_.z, of_.target, of_.start, candidates_, at_, factor_);
  if (!branches) return false;
  const auto matrix = complementarity_matrix(*branches);
  const Guarantee guarantee = matrix ? guaranteed_by(*matrix) : Guarantee::none;
  if (guarantee != Guarantee::none && solved()) {
    answer_.count = Continuation::one;
    answer_.statuses = of_.found;
    return false;
  }
  Round now{*branches,
            {of_.system, of_.z, of_.target, of_.start, *branches,
             farthest(of_.system, of_.z, branches->step)},
            groups_of(*branches),
            {},
            guarantee};
  if (branches->index < 0) {
    // It is unknown which group makes the base unstable.
    Group all(candidates_.size());
    std::iota(all.begin(), all.end(), 0);
    now.groups = {all};
  }
  for (const Group& group : now.groups) {
    now.found.push_back(motions_of(*branches, group, now.asking));
    const std::optional<Choice>& singular = now.found.back().singular;
    if (singular) answer_.singular = now.asking.statuses(*singular);
  }
  if (add_requested(now) || add_slips(now) || add_others(now)) return true;
  conclude(now);
  return false;
}

bool RateSearch::add_requested(const Round& now) {
  bool widened = false;
  for (const Found& group : now.found) {
    for (const auto& [i, wanted] : group.requested) widened = add(i, wanted) || widened;
  }
  return widened;
}

/// If a contact would be in tension while it sticks, and would penetrate while it is open, it may
/// slip.
bool RateSearch::add_slips(const Round& now) {
  bool widened = false;
  for (std::size_t g = 0; g < now.groups.size() && !widened; ++g) {
    if (!now.found[g].motions.empty()) continue;
    for (const std::size_t i : now.groups[g]) {
      if (!candidates_[i].has(JointStatus::open)) continue;
      for (const JointStatus slip : {JointStatus::slip_plus, JointStatus::slip_minus}) {
        widened = add(i, slip) || widened;
      }
    }
  }
  return widened;
}

Motion RateSearch::together(const Round& now, std::size_t special, const Motion& with) {
  Motion whole{Choice(now.branches.candidates.size(), 0), with.step, with.index};
  for (std::size_t g = 0; g < now.groups.size(); ++g) {
    const Motion& part = g == special ? with : now.found[g].motions.front();
    for (const std::size_t i : now.groups[g]) whole.choice[i] = part.choice[i];
    if (g != special) whole.step += part.step - now.branches.step;
  }
  return whole;
}

/// Adds joints that are not candidates, but request another status.
bool RateSearch::add_others(const Round& now) {
  const bool each = std::all_of(now.found.begin(), now.found.end(),
                                [](const Found& one) { return !one.motions.empty(); });
  bool widened = false;
  for (std::size_t g = 0; g < now.groups.size() && each; ++g) {
    for (const Motion& motion : now.found[g].motions) {
      const Motion whole = together(now, g, motion);
      const Statuses statuses = now.asking.statuses(whole.choice);
      for (int i = 0; i < static_cast<int>(statuses.size()); ++i) {
        const JointStatus wanted = now.asking.wanted(i, whole, statuses[index(i)]);
        if (wanted != statuses[index(i)]) widened = add(candidate(i), wanted) || widened;
      }
    }
  }
  return widened;
}

const Motion* RateSearch::only(const Found& of, Guarantee guarantee) const {
  const auto& motions = of.motions;
  const auto count = std::count_if(motions.begin(), motions.end(),
                                   [](const Motion& one) { return one.index >= 0; });
  // The indices of all solutions sum to one (degree of the equations). Without unstable solutions
  // and singular sets, several stable solutions are therefore equal up to rounding. If the matrix
  // guarantees one motion, sets are singular because their constraints are dependent.
  const bool equal = !of.singular || guarantee != Guarantee::none;
  const bool is_one = count == 1 || (count > 1 && count == std::ssize(motions) && equal);
  if (!is_one) return nullptr;
  const auto far = [&](const Motion& to) {
    return to.index < 0 ? std::numeric_limits<double>::infinity()
                        : length_of(to.step, of_.system.displacements());
  };
  return &*std::min_element(
      motions.begin(), motions.end(),
      [&](const Motion& one, const Motion& other) { return far(one) < far(other); });
}

/// Groups without a continuation (`stopped`) or with several (`parting`) determine the result.
/// Their joints are reported.
void RateSearch::conclude(const Round& now) {
  std::vector<int> stopped, parting;
  bool parts_only = true;
  bool examined = true;
  std::vector<const Motion*> stable;
  for (std::size_t g = 0; g < now.groups.size(); ++g) {
    const auto& motions = now.found[g].motions;
    const bool none = std::none_of(motions.begin(), motions.end(),
                                   [](const Motion& one) { return one.index >= 0; });
    if (none && !now.found[g].examined) examined = false;
    if (const Motion* const one = only(now.found[g], now.guarantee)) {
      stable.push_back(one);
      continue;
    }
    std::vector<int>& named = none ? stopped : parting;
    parts_only = parts_only && !none;
    for (const std::size_t i : now.groups[g]) named.push_back(candidates_[i].joint);
  }
  if (!examined) return;
  if (stable.size() < now.groups.size()) {
    answer_.count = parts_only ? Continuation::several : Continuation::none;
    answer_.joints = parts_only ? parting : stopped;
    return;
  }
  answer_.count = Continuation::one;
  Choice choice(candidates_.size(), 0);
  answer_.step = now.branches.step;
  for (std::size_t g = 0; g < now.groups.size(); ++g) {
    for (const std::size_t i : now.groups[g]) choice[i] = stable[g]->choice[i];
    answer_.step += stable[g]->step - now.branches.step;
  }
  answer_.statuses = now.asking.statuses(choice);
}

}  // namespace

int index_of(int determinant_sign, const Assembly& at) {
  const auto closures = std::count(at.units.begin(), at.units.end(), RowUnit::closure);
  return closures % 2 == 0 ? determinant_sign : -determinant_sign;
}

std::optional<VectorXd> RateProblem::rates_on(const Statuses& statuses, const VectorXd& z,
                                              double time, const StepStart& start,
                                              const std::vector<double>& program_rates) {
  if (!factor_.factorize(equations(z, time, start, statuses).jacobian())) return std::nullopt;
  return factor_.solve(-system_->heating(z, time, start, statuses, program_rates));
}

const Assembly& RateProblem::equations(const VectorXd& z, double time, const StepStart& start,
                                       const Statuses& statuses) {
  begin();
  system_->evaluate(z, time, start, statuses, JointModel::friction, 1.0, at_);
  return at_;
}

RateAnswer RateProblem::solve(const VectorXd& z, double target, const StepStart& start,
                              const Statuses& found, const std::vector<int>& changing) {
  begin();
  return RateSearch({*system_, z, target, start, found}, at_, factor_).solve(changing);
}

}  // namespace statejump::truss::detail
