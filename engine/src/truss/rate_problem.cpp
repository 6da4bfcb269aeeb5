// SPDX-License-Identifier: GPL-3.0-or-later
#include "rate_problem.hpp"

#include <Eigen/Cholesky>
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

/// The complementarity matrix. It exists only if every candidate has exactly two statuses, stick
/// and slip in one direction, which differ in one row.
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
  // The complementary variables, both >= 0, are the slide in the slip direction, and the friction
  // limit minus friction.
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
  if (matrix.size() == 0) return true;  // no candidates
  // Scaling to a unit diagonal makes the rounding tolerance uniform.
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
  // Adds a status to a candidate; returns whether it is new. The base (first status) must be
  // closed: an open joint has no normal.
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
    if (!found.empty() && candidates.size() > most_joints) return answer;
  }
  for (const int joint : changing) candidate(joint);
  // The loop ends, because every round adds at least one status to one of the joints.
  for (;;) {
    std::size_t numbers = 0;
    for (const Candidate& one : candidates) numbers += index(one.rows);
    numbers *= index(system_->unknowns());
    if ((!found.empty() && candidates.size() > most_joints) || numbers > most_numbers)
      return answer;
    answer.joints.clear();
    for (const Candidate& one : candidates) {
      answer.joints.push_back(one.joint);
      answer.opens = answer.opens || one.has(JointStatus::open);
    }
    const auto of = prepare(*system_, z, target, start, candidates, at_, factor_);
    if (!of) return answer;
    const auto matrix = complementarity_matrix(*of);
    const bool is_unique = matrix && has_positive_symmetric_part(*matrix);
    if (is_unique && !found.empty()) {
      answer.count = Continuation::one;
      answer.statuses = found;
      return answer;
    }
    const Asking asking(*system_, z, target, start, *of, farthest(*system_, z, of->step));
    std::vector<Group> groups = groups_of(*of);
    if (of->index < 0) {
      // It is unknown which group makes the base unstable.
      Group all(candidates.size());
      std::iota(all.begin(), all.end(), 0);
      groups = {all};
    }
    std::vector<Found> all;
    bool widened = false;
    for (const Group& group : groups) {
      all.push_back(motions_of(*of, group, asking));
      for (const auto& [i, wanted] : all.back().requested) {
        widened = add(candidates[i], wanted) || widened;
      }
      if (all.back().singular) answer.singular = asking.statuses(*all.back().singular);
    }
    // If a contact would be in tension while it sticks, and would penetrate while it is open, it
    // may slip.
    for (std::size_t g = 0; g < groups.size() && !widened; ++g) {
      if (!all[g].motions.empty()) continue;
      for (const std::size_t i : groups[g]) {
        if (!candidates[i].has(JointStatus::open)) continue;
        for (const JointStatus slip : {JointStatus::slip_plus, JointStatus::slip_minus}) {
          widened = add(candidates[i], slip) || widened;
        }
      }
    }
    if (widened) continue;

    // Combines a motion of one group with the first motion of every other group, to check the
    // joints that are not candidates.
    const auto together = [&](std::size_t special, const Motion& with) {
      Motion whole{Choice(of->candidates.size(), 0), with.step, with.index};
      for (std::size_t g = 0; g < groups.size(); ++g) {
        const Motion& part = g == special ? with : all[g].motions.front();
        for (const std::size_t i : groups[g]) whole.choice[i] = part.choice[i];
        if (g != special) whole.step += part.step - of->step;
      }
      return whole;
    };
    const bool each =
        std::all_of(all.begin(), all.end(), [](const Found& one) { return !one.motions.empty(); });
    for (std::size_t g = 0; g < groups.size() && each; ++g) {
      for (const Motion& motion : all[g].motions) {
        const Motion whole = together(g, motion);
        const Statuses statuses = asking.statuses(whole.choice);
        for (int i = 0; i < static_cast<int>(statuses.size()); ++i) {
          const JointStatus wanted = asking.wanted(i, whole, statuses[index(i)]);
          if (wanted != statuses[index(i)]) widened = add(candidate(i), wanted) || widened;
        }
      }
    }
    if (widened) continue;

    // Groups without a continuation (`stopped`) or with several (`parting`) determine the result.
    // Their joints are reported.
    std::vector<int> stopped, parting;
    bool parts_only = true;
    bool examined = true;
    std::vector<Motion> stable;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const auto& motions = all[g].motions;
      const auto count = std::count_if(motions.begin(), motions.end(),
                                       [](const Motion& one) { return one.index >= 0; });
      if (count == 0 && !all[g].examined) examined = false;
      // The indices of all solutions sum to one (degree of the equations). Without unstable
      // solutions and mechanisms, several stable solutions are therefore equal up to rounding.
      const bool is_one =
          count == 1 || (count > 1 && count == std::ssize(motions) && !all[g].singular);
      if (is_one) {
        stable.push_back(*std::min_element(
            motions.begin(), motions.end(), [&](const Motion& one, const Motion& other) {
              const auto far = [&](const Motion& to) {
                return to.index < 0 ? std::numeric_limits<double>::infinity()
                                    : length_of(to.step, system_->displacements());
              };
              return far(one) < far(other);
            }));
        continue;
      }
      std::vector<int>& named = count == 0 ? stopped : parting;
      parts_only = parts_only && count > 0;
      for (const std::size_t i : groups[g]) named.push_back(candidates[i].joint);
    }
    if (!examined) return answer;
    if (stable.size() < groups.size()) {
      answer.count = parts_only ? Continuation::several : Continuation::none;
      answer.joints = parts_only ? parting : stopped;
      return answer;
    }
    answer.count = Continuation::one;
    Choice choice(candidates.size(), 0);
    answer.step = of->step;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (const std::size_t i : groups[g]) choice[i] = stable[g].choice[i];
      answer.step += stable[g].step - of->step;
    }
    answer.statuses = asking.statuses(choice);
    return answer;
  }
}

}  // namespace statejump::truss::detail
