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

// Enumeration of the statuses of joints at a limit. All sets of statuses use the factors of one
// set; see RateProblem.

/// A joint at a limit and its possible statuses; the first one is a closed status.
struct Candidate {
  int joint;
  std::vector<JointStatus> branches;
  int first_row;
  int rows;
  Eigen::Index place;  ///< Index of its first row among the rows of all candidates.

  bool has(JointStatus status) const {
    return std::find(branches.begin(), branches.end(), status) != branches.end();
  }
};

/// Rows of all candidates, each on one of its statuses.
struct Layer {
  Eigen::MatrixXd influence;  ///< Values of these rows for a unit in each row of the base.
  VectorXd value;             ///< Values of these rows after the step of the base.
  std::vector<RowUnit> units;
};

/// Rows of all candidates on all of their statuses.
struct Branches {
  std::vector<Candidate> candidates;
  Statuses base;
  std::vector<Layer> layers;  ///< Layer k: every candidate on its status k, or on its last one.
  Eigen::MatrixXd response;   ///< Response of the unknowns to a unit in each row of the base.
  VectorXd step;              ///< Step of the unknowns on the base.
  int index = 0;              ///< Index of the base.
};

/// Largest displacement [m].
double length_of(const VectorXd& step, int displacements);

/// Factors the base (first status of every candidate) and evaluates the other statuses. Empty if
/// the base is singular.
std::optional<Branches> prepare(const System& system, const VectorXd& z, double target,
                                const StepStart& start, std::vector<Candidate> candidates,
                                Assembly& at, linear::SparseFactor& factor);

/// Index of a status for every candidate.
using Choice = std::vector<std::size_t>;
/// Indices of some candidates.
using Group = std::vector<std::size_t>;

/// One choice of statuses in a group, with its step and index while other candidates keep the base.
struct Motion {
  Choice choice;
  VectorXd step;
  int index = 0;
};

/// Groups of candidates that influence each other, directly or through others.
std::vector<Group> groups_of(const Branches& of);

/// Evaluates the state at the end of a motion, and the statuses that the joints request there.
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
  double same_;  ///< Error of displacements after Newton's method [m].
  double near_;
};

/// Index of a candidate, and a requested status that is not yet among its statuses.
using RequestedStatus = std::pair<std::size_t, JointStatus>;

/// Admissible motions of a group; equal motions are listed once.
struct Found {
  std::vector<Motion> motions;
  /// If not empty, the search must be repeated with these statuses.
  std::vector<RequestedStatus> requested;
  bool examined = true;            ///< Whether all sets were tried.
  std::optional<Choice> singular;  ///< Statuses for which the equations are singular.
};

/// All admissible motions of a small group, or the one motion that pivoting finds in a large group.
Found motions_of(const Branches& of, const Group& group, const Asking& asking);

}  // namespace statejump::truss::detail
