// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "linear/sparse_factor.hpp"
#include "statejump/failure.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

/// How a Newton solve ended.
enum class SolveEnd : unsigned char { converged, singular, not_converged, stopped, event_ahead };

struct SolveReport {
  SolveEnd end = SolveEnd::not_converged;
  std::vector<int> joints;        ///< Whose branches changed last, the lowest first.
  double force_residual = 0.0;    ///< Over the largest force [-].
  double closure_residual = 0.0;  ///< [m]
  /// Share of the step after which the first joint leaves its branch, as the tangents see it; 1:
  /// none does.
  double first_change = 1.0;
  /// That joint, and the branch for which it leaves its own. Which of those behind it follow is not
  /// known: it may spare them that.
  std::optional<std::pair<int, JointStatus>> leaving;
  bool leaves_at_start = false;  ///< Whether that joint does so as soon as the step begins.
};

class Tracer;

/// What was singular in equations that a solve regularised.
enum class Regularisation : unsigned char { none, reactions, displacements };

/// From where to where a step goes, for the question when within it the first joint changes.
struct EventSearch {
  double from_time;  ///< [s]
  double now;        ///< Share of the step within which a change counts as one at its start.
  bool stop;         ///< End the solve there instead of passing it.
  /// Where the rates of the start lead: a nearer guess by old factors, whose first step is not
  /// asked what lies ahead.
  VectorXd foreseen;
};

/// Newton's method on the equations of a truss, in two layers; keeps the memory of the factors.
///
/// **On one set of branches** the equations are smooth. A step is taken in full as long as it is no
/// longer than those before it on this set (the natural monotonicity test of Deuflhard [1], which
/// compares lengths in metres and so asks for no scale between metres and newtons; non-monotone
/// over ten steps as in [2]); a longer one means that the step before it went too far, and that is
/// halved.
///
/// **Factors are kept** as long as the set of branches is that for which they were made: within a
/// solve, and for the next one where no joint changed. Steps by old factors (the simplified method
/// [1], ch. 2.1) shrink by the same share each; new ones are made where the steps that they save
/// cost more than a factorization. Branches and events are decided by steps on
/// factors of the same solve: where a joint leaves its branch after one on older ones, the solve
/// begins anew with factors of its start.
///
/// **The set of branches** changes by block principal pivoting [3]: every joint that violates its
/// inequality by more than the solution is exact to (System::rounding()) changes its branch at
/// once, after each full step. Strict inequalities would flicker: at a turning point of the
/// temperature many joints are at their bound and at rest, and on which side of it rounding
/// decides. If a set comes back, one joint at a time is changed, the lowest first and only where
/// the smooth equations hold (Murty), until fewer joints than ever violate theirs. For a P-matrix
/// that ends after finitely many pivots; friction that follows a normal force can make another one,
/// where a set comes back once more and the solve ends without a solution.
///
/// Many pivots of all joints may wander for long before a set comes back, and single ones take a
/// factorization each. Pivots on one factorization (schur_active_set()) settle those joints for the
/// price of a solution each. So they are turned to where the pivots that helped nothing have cost
/// as many factorizations as that, which is known to cost at most twice what the better choice
/// would [4]. They begin at the start of the step: pivots that wander lead far from where its
/// equations hold. If pivots wander again, the step is too long for them, and one that looks ahead
/// ends.
///
/// **Events ahead.** On one set of branches the state is nearly linear over a step, so the line
/// from its start to the first full step tells when the first joint violates its inequality. Joints
/// that do so at once change at the start of the step: that is the rate problem, solved by the same
/// pivoting. Where none does so any more, the first one to follow is the next event.
///
/// **Singular matrices.** Joints that stick may constrain a displacement more than once: reactions
/// are then not unique, displacements are. The matrix is factored again with a compliance in every
/// closure row, a thousandth of that of the stiffest element, while residuals stay exact. Newton's
/// method then is the method of multipliers [5]: it converges to exact closures and to the
/// reactions nearest to the last ones.
///
/// [1] P. Deuflhard, Newton Methods for Nonlinear Problems, Springer 2004, ch. 3.3.
/// [2] L. Grippo, F. Lampariello, S. Lucidi, SIAM J. Numer. Anal. 23 (1986) 707-716.
/// [3] J. J. Júdice, F. M. Pires, Comput. Oper. Res. 21 (1994) 587-596.
/// [4] A. R. Karlin, M. S. Manasse, L. Rudolph, D. D. Sleator, Algorithmica 3 (1988) 79-119.
/// [5] M. R. Hestenes, J. Optim. Theory Appl. 4 (1969) 303-320.
class Newton {
 public:
  /// @param locates whether changes are located in time, which asks for states as exact as only new
  /// factors make them
  /// @param going_on asked now and then; false stops the solve
  Newton(const System& system, bool locates, std::function<bool()> going_on)
      : system_(&system),
        locates_(locates),
        going_on_(std::move(going_on)),
        at_(system.assembly()) {}

  /// Solves for z and statuses at `time`, from the guess in them. On failure they are unspecified.
  /// @param most_iterations on one set of branches
  /// @param search whether and from where changes are looked for; else they are not
  /// @param held whether the joints stay on these branches, whatever their inequalities say
  SolveReport solve(double time, const StepStart& start, JointModel joints, double opening,
                    int most_iterations, VectorXd& z, Statuses& statuses,
                    const std::optional<EventSearch>& search = {}, bool held = false);

  /// Whether the last solve needed the regularisation of regularise(), and why.
  Regularisation regularisation() const { return regularisation_; }
  /// Joints whose reactions share a constraint, by the factors of the last solve, which regularised
  /// reactions.
  std::vector<int> dependent_joints() const;
  /// Traces every iteration from now on; null: none.
  void trace(Tracer* to) { tracer_ = to; }
  /// Lets free displacements be regularised as well, by this stiffness [N/m]: on the way to a first
  /// equilibrium, where friction may be exhausted before a stop or another part carries.
  void regularise_displacements(double stiffness) { proximal_stiffness_ = stiffness; }

  /// Rates of the unknowns along the path from where the last solve converged, by its factors.
  /// @param by_time derivative of the residual by time, see System::heating()
  /// @param guess of them, or empty; it saves solutions and changes the rates by rounding only
  /// @returns nothing where the equations are singular
  std::optional<VectorXd> rate(const VectorXd& by_time, const VectorXd& guess);

  /// Index of the equations where the last solve converged, see RateProblem; 0: singular.
  int stability_index();
  /// Index of the equations of another state with friction, on a set of branches. Their factors
  /// take the place of those of the last solve: beside them they would be the largest part of the
  /// memory.
  int stability_index(const Assembly& at, const Statuses& statuses);

  long factorizations() const { return factorizations_; }
  const std::function<bool()>& progress() const { return going_on_; }
  const linear::SparseFactor& factor() const { return factor_; }

 private:
  class Iteration;

  struct Violation {
    double share = 1.0;  ///< Of the way.
    int joint = -1;
  };

  Violation first_violation(const std::vector<int>& joints, const VectorXd& from,
                            const VectorXd& to, double from_time, double time,
                            const StepStart& start, JointModel model,
                            const Statuses& statuses) const;

  /// Factors the Jacobian at hand, which is one on this set of branches; see Singular matrices.
  bool factorize(const Statuses& statuses, JointModel joints,
                 double most_growth = linear::SparseFactor::refined_growth);
  /// Index of the factored equations; a negative one is checked by regularised factors, which then
  /// take the place of the others.
  int checked_index(const Assembly& at);
  /// Whether the factors are of equations on this set of branches.
  bool keeps(const Statuses& statuses, JointModel joints) const {
    return factored_ && joints == factored_model_ && statuses == factored_on_;
  }

  /// Whether steps by the factors that are there cost less than new ones.
  /// @param decades how often what is left of the way has to shrink as the last step did
  bool keeping_pays(double decades) const;

  const System* system_;
  bool locates_;
  std::function<bool()> going_on_;
  Assembly at_;
  linear::SparseFactor factor_;
  long factorizations_ = 0;
  /// Whether the factors were made in the last solve, of the set of branches on which it ended.
  bool current_ = false;
  bool quiet_ = false;     ///< Whether no joint changed in the last solve.
  bool factored_ = false;  ///< Whether there are factors, and of what:
  Statuses factored_on_;
  JointModel factored_model_ = JointModel::pins;
  Regularisation regularisation_ = Regularisation::none;
  double proximal_stiffness_ = 0.0;  ///< Of free displacements [N/m]; 0: they are not regularised.
  Statuses solved_on_;               ///< Where the last solve converged.
  JointModel solved_model_ = JointModel::pins;
  Tracer* tracer_ = nullptr;
};

/// Factors equations that are singular with a compliance in their closures, or, if that is not
/// enough and a stiffness is given, with that on all displacements; see Newton.
/// @returns what was regularised; none: they stay singular
Regularisation factor_regularised(const System& system, const Assembly& at,
                                  double proximal_stiffness, linear::SparseFactor& factor);

/// Modes of a truss that nothing resists.
struct FoundModes {
  int count = 0;                   ///< May be more than are described; 0: none.
  bool more = false;               ///< There may be more than `count`.
  std::vector<FailureMode> modes;  ///< The nodes that move most.
  std::vector<VectorXd> shapes;    ///< Of the unknowns, the largest displacement of order one.
  explicit operator bool() const { return count > 0; }
};

/// Free modes of the truss at z, its joints held as their statuses say.
FoundModes mechanism(const System& system, const VectorXd& z, double time, const Statuses& statuses,
                     JointModel joints);

/// Modes in which the equilibrium at z is unstable though every joint that is not open is held (so
/// friction cannot help). That a joint which slips makes the truss unstable is not seen.
/// @param slack stiffness of a joint that is open [N/m]
FoundModes buckling(const System& system, const VectorXd& z, double time, const Statuses& statuses,
                    double slack);

}  // namespace statejump::truss::detail
