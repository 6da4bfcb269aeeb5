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
  std::vector<int> joints;        ///< Joints whose status changed last, in ascending order.
  double force_residual = 0.0;    ///< Divided by the largest force [-].
  double closure_residual = 0.0;  ///< [m]
  /// Fraction of the step after which the first joint changes its status, estimated from the
  /// tangent; 1: no joint does.
  double first_change = 1.0;
  /// That joint and its new status. Later violations are not reported, because this change may
  /// prevent them.
  std::optional<std::pair<int, JointStatus>> leaving;
  bool leaves_at_start = false;  ///< Whether the joint changes its status at the start of the step.
};

class Tracer;

/// Kind of singularity that a solve regularised.
enum class Regularisation : unsigned char { none, reactions, displacements };

/// Event detection in a step: when does the first joint change its status?
struct EventSearch {
  double from_time;  ///< [s]
  double now;        ///< Fraction of the step up to which a change counts as one at its start.
  bool stop;         ///< Whether the solve ends at the first event; false: it continues across it.
  /// Predictor: unknowns at the end of the step, extrapolated with the rates at its start. Initial
  /// guess if factors are reused, events are passed, or elements are slack. Iterations with reused
  /// factors do not detect events.
  VectorXd foreseen;
};

/// Newton's method for the equations of a truss, with an outer search for the joint statuses.
/// Factors and their memory are reused between solves.
///
/// **Fixed statuses.** The equations are smooth. A full step is accepted if it is not longer than
/// the longest of the last ten on these statuses: the natural monotonicity test of Deuflhard [1] in
/// the non-monotone form of [2]. It compares lengths in metres, so no scale between metres and
/// newtons is needed. If a step is longer, the previous step was too long and is halved.
///
/// **Reused factors.** Factors are kept while the statuses are unchanged, within a solve and for
/// the next solve. Steps with old factors (simplified Newton method [1], ch. 2.1) converge
/// linearly. New factors are computed when they save more time than a factorization takes. Status
/// changes and events are decided only by steps on factors of the same solve: if a step on older
/// factors suggests a change, the solve restarts with factors at its start.
///
/// **Statuses** change by block principal pivoting [3]. After each full step every joint that
/// violates its inequality by more than the accuracy of the solution (System::rounding()) changes
/// its status. Without this tolerance statuses would alternate: at a reversal of the temperature
/// many joints are at their limit and at rest, so that rounding decides. If statuses recur, only
/// the joint with the lowest number changes, and only once the equations hold (Murty), until the
/// number of violations falls below its previous minimum. For a P-matrix this ends after finitely
/// many pivots. If friction depends on an unknown normal force, statuses may recur again; the solve
/// then ends without a solution.
///
/// **Cycling.** Block pivots may continue for long before statuses recur, and each costs a
/// factorization. A Schur-complement active set (schur_active_set()) needs one factorization and
/// one solution per cycling joint. It is used once the unsuccessful block pivots have cost as much,
/// so that the total cost is at most twice that of the better choice [4]. It starts from the start
/// of the step, because cycling pivots lead far from it. If pivots cycle again, a step with event
/// detection ends: it is too long.
///
/// **Event detection.** On fixed statuses the state is nearly linear over a step. The line from the
/// start of the step to the end of the first full step therefore estimates when the first joint
/// violates its inequality. Joints that do so immediately change at the start of the step: this is
/// the rate problem, solved by the same pivoting. The first later violation is the next event.
///
/// **Singular matrices.** Sticking joints may constrain a displacement more than once. Reactions
/// are then not unique, but displacements are. The matrix is factored again with a compliance in
/// every closure row, a thousandth of the compliance of the stiffest element. Residuals stay exact,
/// so the iteration is the method of multipliers [5]. It converges to exact closures and to the
/// reactions nearest to the previous ones.
///
/// [1] P. Deuflhard, Newton Methods for Nonlinear Problems, Springer 2004, ch. 3.3.
/// [2] L. Grippo, F. Lampariello, S. Lucidi, SIAM J. Numer. Anal. 23 (1986) 707-716.
/// [3] J. J. Júdice, F. M. Pires, Comput. Oper. Res. 21 (1994) 587-596.
/// [4] A. R. Karlin, M. S. Manasse, L. Rudolph, D. D. Sleator, Algorithmica 3 (1988) 79-119.
/// [5] M. R. Hestenes, J. Optim. Theory Appl. 4 (1969) 303-320.
class Newton {
 public:
  /// @param locates whether changes of status are located in time; this requires the accuracy of
  /// new factors
  /// @param going_on called at intervals; if it returns false, the solve stops
  Newton(const System& system, bool locates, std::function<bool()> going_on)
      : system_(&system),
        locates_(locates),
        going_on_(std::move(going_on)),
        at_(system.assembly()) {}

  /// Solves for z and statuses at `time`. Both are initial guesses, and unspecified after a
  /// failure.
  /// @param most_iterations limit for one set of statuses
  /// @param search event detection; empty: none
  /// @param held whether statuses are fixed, without checks of inequalities
  SolveReport solve(double time, const StepStart& start, JointModel joints, double opening,
                    int most_iterations, VectorXd& z, Statuses& statuses,
                    const std::optional<EventSearch>& search = {}, bool held = false);

  /// Regularisation that the last solve needed; see factor_regularised().
  Regularisation regularisation() const { return regularisation_; }
  /// Joints with non-unique reactions, from the factors of the last solve.
  /// @pre regularisation() is `reactions`
  std::vector<int> dependent_joints() const;
  /// Traces every iteration from now on; null: none.
  void trace(Tracer* to) { tracer_ = to; }
  /// Allows a regularisation of free displacements by this stiffness [N/m]. Needed for the first
  /// equilibrium, where friction may reach its limit before a stop or another element takes the
  /// load.
  void regularise_displacements(double stiffness) { proximal_stiffness_ = stiffness; }

  /// Rates of the unknowns at the last converged solution, with its factors.
  /// @param by_time partial derivative of the residual with respect to time; see System::heating()
  /// @param guess initial guess of the rates, or empty; it saves solutions and affects rounding
  /// only
  /// @returns nothing if the equations are singular
  std::optional<VectorXd> rate(const VectorXd& by_time, const VectorXd& guess);

  /// Stability index at the last converged solution, see RateProblem; 0: singular.
  int stability_index();
  /// Stability index at another state, with friction and these statuses. The factors of the last
  /// solve are replaced, to save memory.
  int stability_index(const Assembly& at, const Statuses& statuses);

  long factorizations() const { return factorizations_; }
  const std::function<bool()>& progress() const { return going_on_; }
  const linear::SparseFactor& factor() const { return factor_; }

 private:
  class Iteration;

  struct Violation {
    double share = 1.0;  ///< Fraction of the step.
    int joint = -1;
  };

  Violation first_violation(const std::vector<int>& joints, const VectorXd& from,
                            const VectorXd& to, double from_time, double time,
                            const StepStart& start, JointModel model,
                            const Statuses& statuses) const;

  /// Factors the present Jacobian, assembled on these statuses; regularised if it is singular.
  bool factorize(const Statuses& statuses, JointModel joints,
                 double most_growth = linear::SparseFactor::refined_growth);
  /// Index of the factored equations. A negative index is confirmed with regularised factors, which
  /// replace the others.
  int checked_index(const Assembly& at);
  /// Whether the factors belong to these statuses.
  bool keeps(const Statuses& statuses, JointModel joints) const {
    return factored_ && joints == factored_model_ && statuses == factored_on_;
  }

  /// Whether iterations with the present factors cost less than new factors.
  /// @param decades remaining reduction of the step length, in reductions of the last step
  bool keeping_pays(double decades) const;

  const System* system_;
  bool locates_;
  std::function<bool()> going_on_;
  Assembly at_;
  linear::SparseFactor factor_;
  long factorizations_ = 0;
  /// Whether the factors were computed in the last solve, on its final statuses.
  bool current_ = false;
  bool quiet_ = false;     ///< Whether no joint changed in the last solve.
  bool factored_ = false;  ///< Whether factors exist, for the statuses and model that follow.
  Statuses factored_on_;
  JointModel factored_model_ = JointModel::pins;
  Regularisation regularisation_ = Regularisation::none;
  double proximal_stiffness_ = 0.0;  ///< Of free displacements [N/m]; 0: not regularised.
  Statuses solved_on_;               ///< Statuses of the last converged solution.
  JointModel solved_model_ = JointModel::pins;
  Tracer* tracer_ = nullptr;
};

/// The Jacobian with a compliance in every closure row, a thousandth of that of the stiffest
/// element; see Newton.
Eigen::SparseMatrix<double> with_compliant_closures(const System& system, const Assembly& at);

/// Factors a singular matrix with a compliance in every closure row. If it is still singular and a
/// stiffness is given, this stiffness is added to all displacements; see Newton.
/// @returns what was regularised; none: the matrix is still singular
Regularisation factor_regularised(const System& system, const Assembly& at,
                                  double proximal_stiffness, linear::SparseFactor& factor);

/// Modes of a truss without resistance.
struct FoundModes {
  int count = 0;                   ///< Number of modes, may exceed those described; 0: none.
  bool more = false;               ///< There may be more than `count`.
  std::vector<FailureMode> modes;  ///< Nodes with the largest motion in each mode.
  /// Modes of the unknowns; the largest displacement is of order one.
  std::vector<VectorXd> shapes;
  explicit operator bool() const { return count > 0; }
};

/// A motion that is softer than this fraction of the stiffest element counts as free. Rounding is
/// 1e-16 of that stiffness; the softest mode of a ring of 100 000 bays has 1e-12.
constexpr double free_share = 1e-13;

/// Modes without stiffness at z, with the joints in the given statuses.
FoundModes mechanism(const System& system, const VectorXd& z, double time, const Statuses& statuses,
                     JointModel joints);

/// Unstable modes of the equilibrium at z with all closed joints fixed, so that friction cannot
/// stabilise it. Instability by slip is not detected.
/// @param slack stiffness of an open joint [N/m]
FoundModes buckling(const System& system, const VectorXd& z, double time, const Statuses& statuses,
                    double slack);

}  // namespace statejump::truss::detail
