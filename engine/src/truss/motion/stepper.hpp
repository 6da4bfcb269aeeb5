// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bodies.hpp"
#include "contacts.hpp"
#include "drives.hpp"
#include "linear/sparse_factor.hpp"
#include "refilled_matrix.hpp"
#include "statejump/complementarity/solve.hpp"
#include "statejump/failure.hpp"

namespace statejump::truss::detail {

/// Energies since the start that a state does not tell [J].
struct Account {
  double thermal_work = 0.0;
  double damping = 0.0;
  double impact = 0.0;    ///< Of all contacts, across their surfaces.
  VectorXd friction;      ///< Of every joint.
  double negative = 0.0;  ///< Sum of what a contact gave below zero in a step.
  double drives = 0.0;    ///< Work of the drives.
};

/// An elastic contact is on its law to this share of its force: its problem is solved to 1e-10 of
/// the largest velocity in it, which a stiff contact turns into much more of a force.
constexpr double on_law = 1e-6;

/// Share of a contact's own force or of the largest speed by which it may miss an inequality, as
/// the contact problem's tolerance allows.
constexpr double allowance = 1e-10;

/// The contact of a planar problem whose law is violated most [unit of u], W_nn times what its
/// impulses lack; −1 without contacts.
Eigen::Index worst_contact(const complementarity::Problem& problem, const VectorXd& impulses);

/// A truss in motion, one step of Moreau and Jean's scheme after the other; see simulate().
class Stepper {
 public:
  Stepper(const System& system, const Bodies& bodies, const MotionOptions& options);

  /// Sets places and velocities, at rest in their contacts where a quasi-static state is given.
  void begin(const VectorXd& q, const VectorXd& v, const State* equilibrium);
  /// One step to this time; only a step that is made changes the stepper. False where a contact
  /// ends elsewhere than the directions of the step lead. @throws Failure if it has no solution
  /// that is found
  bool advance(double to);
  /// The same by implicit Euler with a matrix that is positive definite, for a step that was not
  /// found otherwise. False also where its branches are not found and `give_up`.
  bool advance_damped(double to, bool give_up);
  /// The same by backward differentiation, not yet taken: what displacements are off by [m]. Of
  /// second order where the step before was one of these. Without a number where its branches were
  /// not found and `give_up`, which saves the contact problem. @throws Failure as advance()
  std::optional<double> attempt(double to, bool give_up);
  /// Takes what was attempted last.
  void accept();

  const VectorXd& velocity() const { return v_; }
  double time() const { return time_; }
  const Statuses& statuses() const { return origin_.statuses; }
  const Account& account() const { return account_; }
  const VectorXd& drive_moment() const { return drive_moment_; }
  double kinetic_energy() const { return 0.5 * v_.dot(bodies_->mass() * v_); }
  void describe(State& state) const;
  const std::optional<Undetermined>& undetermined() const { return undetermined_; }
  const std::optional<Undetermined>& jammed() const { return jammed_; }
  long iterations() const { return iterations_; }
  long factorizations() const { return factorizations_; }
  double largest_merit() const { return largest_merit_; }

 private:
  /// The contact problem of a step: which contacts, and what their impulses do to the velocities.
  struct Local {
    std::vector<Contact*> contacts;
    Eigen::SparseMatrix<double> directions;  ///< H, columns by the problem's rows; empty: none.
    VectorXd before;  ///< Velocities of the contacts at the start of the step.
    // Only where the problem is solved.
    Eigen::MatrixXd answers;  ///< (M + …)⁻¹ H, and of the holds.
    Eigen::MatrixXd delassus;
    VectorXd impulses;
  };
  /// A step in the making: M (v − v_from) = h (θ f + (1 − θ) f0) + H r, q = q_from + h (θ v +
  /// (1 − θ) v0). After Moreau and Jean it begins where the last one ended; one of backward
  /// differentiation has θ = 1, begins where the last two point to, and its h is a part of it.
  struct Trial {
    long number = 0;
    double h = 0.0;  ///< [s]; impulses are h times the forces at the end.
    double to = 0.0;
    double length = 0.0;  ///< [s]
    double theta = 1.0;
    bool differentiates = false;  ///< From the last two steps.
    /// Whether its matrix leaves out what compression takes from the stiffness. Where a step begins
    /// a slack element is as compressed as its temperature makes it; where it ends it carries
    /// nothing, and only its mass resists a turn.
    bool is_definite = false;
    Bodies::Step span = {};
    VectorXd q_from;
    VectorXd v_from;
    VectorXd q_middle;
    VectorXd force_before;  ///< f0 [N]
    VectorXd q;
    VectorXd v;
    VectorXd held = {};  ///< Impulses of what holds or drives, against its scaled columns.

    /// A force by which a step of it works. One that has turned up within a step of backward
    /// differentiation was half as large in the mean; one at its bound was so as long as it slid.
    double in_mean(double before, double after, bool slides) const {
      return differentiates && !slides ? 0.5 * (before + after) : after;
    }
  };
  /// The step before the next one, for backward differentiation.
  struct Before {
    double length = 0.0;  ///< [s]; 0: none, or velocities jump.
    VectorXd q;           ///< Where it began.
    VectorXd v;
  };

  /// Depth of an elastic contact at the end of the step, opening at this speed [m].
  double depth(const Trial& step, const Local& local, Eigen::Index contact, double speed) const;
  /// The normal law of an elastic contact as its tangent at a speed.
  struct Tangent {
    double elastic;     ///< Without the dashpot [N].
    double force;       ///< [N]
    double compliance;  ///< [m/N]
    double gap;         ///< speed h + compliance force + gap = 0 is the tangent [m].
  };
  Tangent tangent(const Trial& step, const Local& local, Eigen::Index contact, double speed) const;
  /// Normal force without the dashpot, at the end of the step [N].
  double elastic_normal(const Trial& step, const Local& local, Eigen::Index contact) const;

  /// Speed with which a rigid contact opens after an impact, with its sign turned [m/s].
  double leaving(const Trial& step, const Local& local, Eigen::Index contact) const;

  Trial trial(double to);
  /// Finds the end of a step; none where its branches are not found and `give_up`.
  std::optional<Local> find(Trial& step, bool give_up);
  /// Whether a rigid contact closes in the step, so that velocities jump.
  static bool closes(const Local& local);
  /// Depth at the end of a step of rigid contacts that its middle did not know closed [m].
  double deepest(const Trial& step) const;
  /// Gap of a contact as the directions of the step tell it [m]. @param way from its middle [m]
  double gap_after(const Contact& contact, const VectorXd& way) const;
  /// Whether round contacts end where the directions of the step lead: of a step that is long
  /// beside their motion they do not, and its forces make energy.
  bool keeps_directions(const Trial& step) const;
  /// M + h θ C + (h θ)² K at the middle of the step, bordered by what holds or drives; also sets
  /// the directions of these.
  void fill_bodies(const Trial& step, RefilledMatrix& to);
  Eigen::Index held_count() const {
    return static_cast<Eigen::Index>(contacts_.holds().size()) + drives_.count();
  }
  Local local_problem(const Trial& step);
  /// Turns the friction of all balls to where an iterate of the step drives them, in
  /// ball_turns.cpp.
  /// @param turns how often that has been done in this step; 0: there is no iterate yet
  /// @return whether the step is to be solved (again); false once their friction is where it points
  /// @throws Failure with the joint if directions are not found
  bool turn_balls(const Trial& step, int turns, const Local& local);
  /// Directions of what holds or drives, and the speeds along them, of the size of a matrix.
  void hold_directions(const Trial& step, double scale);
  /// Seeks the branches of all contacts from those of the step before, by block pivoting; each try
  /// is one sparse system, whose factors are kept. False if single pivots come back to branches
  /// that were not right, or a try does not converge: the step is then spoilt.
  bool on_branches(Trial& step, Local& local);
  /// Of a contact: open, or in touch and held along its surface, or sliding on it.
  enum class Branch : unsigned char { open, stick, slip_plus, slip_minus };
  Branch branch(const Contact& contact) const;
  void note_branches();
  /// Factors of the equations of a step with every active contact on a branch, of this step or an
  /// earlier one of the same length.
  struct OnBranches {
    double h = 0.0;
    std::vector<int> active;
    std::vector<Branch> branches;
    double scale = 1.0;
    bool outdated = true;  ///< Not yet made, or to be made again: they converge slowly.
    linear::SparseFactor factor;
  };
  OnBranches& factors_for(double h, const std::vector<Branch>& branches);
  bool factorize(OnBranches& on, const Trial& step, const Local& local);
  /// The matrix of a step with its contacts on these branches at an iterate. What is not the
  /// contacts' is filled once for a step.
  void assemble(const std::vector<Branch>& branches, const Trial& step, const Local& local);
  /// Gives the matrix a contact on a branch at an iterate.
  void retell(Branch branch, const Trial& step, const Local& local, Eigen::Index i);
  /// Tells the entries of a contact one after the other, on all branches at the same places.
  template <class Tell>
  void tell_contact(Branch branch, const Trial& step, const Local& local, Eigen::Index i,
                    Tell&& tell) const;
  /// Solves the step with every active contact on a branch. False if it does not converge.
  /// @param is_near the iterate is where to begin; else that is the end of the last step
  bool solve_on(const std::vector<Branch>& branches, Trial& step, Local& local, bool is_near);
  class LocalPivots;
  /// Branches that are tried next, and whether the iterate is near to what they make of it.
  struct Guess {
    std::vector<Branch> branches;
    bool is_near = false;
  };
  /// Where few contacts of a solved step ask for other branches, pivots around each of them.
  /// @param next branches that they ask for
  Guess pivot_locally(const std::vector<Branch>& branches, const std::vector<Branch>& next,
                      const std::vector<std::size_t>& wrong, Trial& step, Local& local);
  /// Which factors Newton's method takes: of an earlier step, of where it begins, or of every
  /// iterate; these also only as far as they lead down.
  enum class Tangents : unsigned char { kept, once, anew, downhill };
  /// Newton's method; its iterations, none if it did not converge.
  std::optional<int> iterate(OnBranches& on, Trial& step, Local& local, Tangents tangents);
  /// What the rows of a system lack at an iterate [N s].
  struct Lack {
    VectorXd right;
    VectorXd balance;      ///< What momentum lacks without impulses.
    bool on_laws = false;  ///< Of contacts that are not elastic, and of what holds.
  };
  Lack lack_of(const OnBranches& on, Trial& step, const Local& local, double drift);
  /// Tangential over normal impulse of a contact that slides.
  static double slide(const Contact& contact, Branch branch);
  /// What a contact's law on its branch says of one of its rows, with the speed u along it and its
  /// impulse r: by_speed u + by_beside u' + offset + compliance r + by_normal r_n = 0.
  struct Law {
    double offset = 0.0;      ///< [m/s]
    double compliance = 0.0;  ///< [1/kg]
    double by_speed = 1.0;
    double by_beside = 0.0;  ///< By the speed along the other tangent of a ball.
    double by_normal = 0.0;  ///< [1/kg]
  };
  Law normal_law(const Trial& step, const Local& local, Eigen::Index i) const;
  Law stick_law(const Trial& step, const Local& local, Eigen::Index i) const;
  /// By how much a row is off its law [m/s]. @param across of the normal
  double lacks(const Law& law, const Trial& step, const Local& local, Eigen::Index i,
               bool across) const;
  // Of contacts that slip in part, in rings.cpp. An owner is the contact that is pressed.
  static Vector2d along(const Local& local, Eigen::Index owner, const VectorXd& speeds);
  /// Slide of the step that its speed does not tell [m].
  static Vector2d slid(const Local& local, Eigen::Index owner);
  /// Speeds of the contacts that slip in part, of others 0 [m/s].
  VectorXd speeds_of_rings(const Trial& step, const Local& local) const;
  /// Where tangents are taken: in the kinks of the laws; at an iterate; or there and, of those
  /// whose slide has turned round, in the kink.
  enum class Seen : unsigned char { kinks, here, next };
  /// Chooses that. @param speeds of the contacts [m/s]
  void see_rings(const Trial& step, const Local& local, const VectorXd& speeds, Seen seen);
  /// What presses a contact that opens at a speed [m/s].
  SlippingRings::Pressed pressed(const Trial& step, const Local& local, Eigen::Index owner,
                                 double opens) const;
  /// Its tangent, for a contact or the one beside it.
  Law rings_law(const Trial& step, const Local& local, Eigen::Index i) const;
  /// Whether impulses are on the law itself. @param drift rounding of speeds [m/s]
  bool on_rings(const Trial& step, const Local& local, double drift) const;
  /// The tangent for the contact problem. @param opens speed at which it does [m/s]
  void add_rings(const Trial& step, const Local& local, Eigen::Index owner, double opens,
                 complementarity::Problem& problem) const;
  /// Takes the friction of rings over. @param speeds of their contacts; @param through by which
  /// impulses work [m/s]
  void book_rings(const Trial& step, const Local& local, Eigen::Index owner, const VectorXd& speeds,
                  const VectorXd& through);
  /// The contact whose normal force presses one, and the other tangent of a ball.
  static Eigen::Index owner(const Local& local, Eigen::Index i) {
    return local.contacts[static_cast<std::size_t>(i)]->beside ? i - 1 : i;
  }
  static Eigen::Index partner(const Local& local, Eigen::Index i) {
    const Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
    return !contact.slips_in_part || contact.ball < 0 ? -1 : contact.beside ? i - 1 : i + 1;
  }
  /// The branch that a contact's inequalities ask for, from the one whose equations hold.
  Branch asked(const Trial& step, const Local& local, Eigen::Index i, Branch branch) const;
  /// Solves the step with its contact problem.
  void solve(Trial& step, Local& local);
  void complete(const Trial& step, Local& local);
  /// Solves the contact problem of an iterate. @param free velocities without impulses
  void solve_contacts(const Trial& step, const VectorXd& free, bool first, Local& local);
  /// Forces of links, springs, loads and of joints beside their contacts [N].
  VectorXd elastic_force(const VectorXd& q, double time);
  void evaluate_springs(const VectorXd& q, double time);
  /// f [N] at places and velocities; also leaves the forces without dashpots in `internal_after_`.
  VectorXd force(const VectorXd& q, const VectorXd& v, const Bodies::Step& step);
  /// Gaps and directions of the contacts, all of them closed and free of force.
  void evaluate_contacts(const VectorXd& q, double time);
  /// Goes to the places of the step's velocities; what their momentum lacks without impulses [N s].
  VectorXd move(Trial& step);
  /// @param by_branches a contact may pull, or be open where it closes: its branch is asked for
  /// next
  bool balanced(const Trial& step, const VectorXd& residual, const VectorXd& held,
                const Local& local, bool by_branches) const;
  /// Notes the first step whose reactions are not unique, in determined.cpp.
  void check_determined(const Trial& step, const Local& local);
  /// Branches of the active contacts at the end of a step, where those whose inequality is an
  /// equation as well hold.
  std::vector<Branch> held_branches(const Trial& step, const Local& local) const;
  /// Notes the first step in which a slide ends that could not go on.
  void check_slides(const Trial& step, const Local& local);
  /// Branches of the active contacts at the end of a step, by their impulses.
  static std::vector<Branch> branches_of(const Local& local);
  void book(const Trial& step, const Local& local);
  /// Takes the friction of a contact over. @param along speeds by which impulses work [m/s]
  void book_friction(const Trial& step, const Local& local, Eigen::Index i, const VectorXd& along);
  [[noreturn]] void fail(FailureKind kind, double when, const Contact* contact) const;

  const System* system_;
  const Bodies* bodies_;
  const MotionOptions* options_;
  Contacts contacts_;
  Assembly joints_;               ///< Gaps and directions at the middle of the step.
  Assembly springs_;              ///< Forces of joints beside their contacts.
  Assembly bars_;                 ///< Stiffness there.
  Assembly forces_;               ///< Forces where the step is; no Jacobian.
  RefilledMatrix bodies_matrix_;  ///< Of the contact problem.
  linear::SparseFactor factor_;
  /// Of all active contacts on branches, see assemble().
  RefilledMatrix matrix_;
  long matrix_of_ = -1;                     ///< Trial::number of its bodies.
  double matrix_scale_ = 1.0;               ///< Of what holds in it.
  std::vector<std::size_t> contact_entry_;  ///< The first one of every active contact.
  std::vector<Branch> branches_;  ///< Of all contacts in the last step, at first where they rest.
  std::vector<int> active_;       ///< Places of the contacts that are active in this one.
  std::vector<std::unique_ptr<OnBranches>> kept_;  ///< The last ones used, the latest first.
  Drives drives_;
  /// Columns that hold, and then those that drive, scaled; of the current factors.
  Eigen::SparseMatrix<double> holds_;
  VectorXd held_speed_;  ///< Along them at the end of the step.
  double hold_scale_ = 1.0;
  VectorXd drive_moment_;  ///< Of each drive in the last step [N m].
  StepStart origin_;
  VectorXd q_;
  VectorXd v_;
  VectorXd z_;  ///< q and the forces of the joints at the end of the last step.
  double time_ = 0.0;
  Before before_;
  std::optional<std::pair<Trial, Local>> attempted_;
  VectorXd internal_;        ///< Forces without dashpots and contacts at (q, time) [N].
  VectorXd internal_after_;  ///< The same where force() was asked last.
  Account account_;
  std::optional<Undetermined> undetermined_;
  std::optional<Undetermined> jammed_;
  std::vector<Branch> holding_;  ///< That check_determined() asked last …
  std::vector<int> holding_of_;  ///< … and of which contacts.
  long trials_ = 0;
  long iterations_ = 0;
  long factorizations_ = 0;
  double largest_merit_ = 0.0;
};

}  // namespace statejump::truss::detail
