// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "linear/sparse_factor.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

// Sets of branches of the joints at a bound, all on the factors of one of them; see RateProblem.

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

/// Largest displacement [m].
double length_of(const VectorXd& step, int displacements);

/// Factors the base and evaluates the other branches; nothing if the base is singular.
std::optional<Branches> prepare(const System& system, const VectorXd& z, double target,
                                const StepStart& start, std::vector<Candidate> candidates,
                                Assembly& at, linear::SparseFactor& factor);

/// One branch of every candidate.
using Choice = std::vector<std::size_t>;
/// Some of the candidates.
using Group = std::vector<std::size_t>;

/// The motion with the candidates of a group each on one of its branches, the others on those of
/// the base, and the index of that set.
struct Motion {
  Choice choice;
  VectorXd step;
  int index = 0;
};

/// Candidates that move each other, directly or by way of others; those of different groups are
/// problems of their own.
std::vector<Group> groups_of(const Branches& of);

/// What is asked of a motion: where it leads, and which branches the joints want there.
class Asking {
 public:
  Asking(const System& system, const VectorXd& z, double target, const StepStart& start,
         const Branches& of, double near)
      : system_(system),
        z_(z),
        target_(target),
        start_(start),
        of_(of),
        rounding_{system.length_rounding(z), system.force_rounding(z)},
        same_(system.rounding(z).length),
        near_(near) {}

  Statuses statuses(const Choice& choice) const {
    Statuses made = start_.statuses;
    for (std::size_t i = 0; i < choice.size(); ++i) {
      made[index(of_.candidates[i].joint)] = of_.candidates[i].branches[choice[i]];
    }
    return made;
  }
  JointStatus wanted(int joint, const Motion& motion, JointStatus status) const {
    return system_.decide(joint, z_ + motion.step, target_, start_, JointModel::friction, 1.0,
                          status, rounding_);
  }
  bool is_short(const Motion& motion) const {
    return length_of(motion.step, system_.displacements()) <= near_;
  }
  bool agree(const Motion& one, const Motion& other) const {
    const double apart = length_of(other.step - one.step, system_.displacements());
    const double size = length_of(one.step, system_.displacements());
    const double epsilon = std::numeric_limits<double>::epsilon();
    return apart <= std::max(same_, std::sqrt((rounding_.length + epsilon * size) * size));
  }

 private:
  const System& system_;
  const VectorXd& z_;
  double target_;
  const StepStart& start_;
  const Branches& of_;
  Rounding rounding_;
  double same_;  ///< What Newton's method leaves of a displacement [m].
  double near_;
};

/// A branch that a candidate wants and is not known to have.
using RequestedStatus = std::pair<std::size_t, JointStatus>;

/// Motions of a group that hold, those that agree counted once.
struct Found {
  std::vector<Motion> motions;
  std::vector<RequestedStatus> requested;  ///< Anything here: the rest is not known yet.
  bool examined = true;                    ///< Whether all sets were tried.
  std::optional<Choice> singular;          ///< A set that leaves the equations singular.
};

/// Motions of a group: all of them where it is small, else the one that pivots find.
Found motions_of(const Branches& of, const Group& group, const Asking& asking);

}  // namespace statejump::truss::detail
