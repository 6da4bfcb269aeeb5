// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "dof_map.hpp"
#include "joints/writer.hpp"
#include "parallel.hpp"
#include "parts.hpp"
#include "regions.hpp"
#include "statejump/truss/path.hpp"
#include "way.hpp"

namespace statejump::truss::detail {

using Statuses = std::vector<JointStatus>;

/// Hash (FNV-1a) of all statuses.
inline std::size_t fingerprint(const Statuses& statuses) {
  std::size_t hash = 14695981039346656037ull;
  for (const JointStatus status : statuses) {
    hash = (hash ^ static_cast<std::size_t>(status)) * 1099511628211ull;
  }
  return hash;
}

inline bool any_open(const Statuses& statuses) {
  return std::find(statuses.begin(), statuses.end(), JointStatus::open) != statuses.end();
}

/// The same joints open, all others held.
inline Statuses held_but_open(Statuses statuses) {
  for (JointStatus& status : statuses) {
    if (status != JointStatus::open) status = JointStatus::stick;
  }
  return statuses;
}

/// State at the start of a step, from which slides are counted.
struct StepStart {
  Statuses statuses;
  VectorXd history;   ///< What the joints remember, one after the other.
  double time = 0.0;  ///< [s]
  /// Of joints that roll, see System::note_slides(); empty: nothing.
  Eigen::Matrix3Xd owed;   ///< Slide that the steps before left over [m].
  Eigen::Matrix3Xd lost;   ///< What the rule of the slide left over in the last step [m].
  double last_step = 0.0;  ///< Its duration [s].
  /// Of joints that are open [N/m], see System::slack_stiffness(); kept from step to step.
  double slack_stiffness = 0.0;
  /// Whether joints with play are held so as well while they touch, see
  /// PathFollower::follow_snap().
  bool damps_contact = false;
  bool is_loose = false;       ///< Whether elements are slack, held by nothing but dashpots.
  double dashpot_force = 0.0;  ///< Of all dashpots of joints in the last step, added up [N].

  /// What the rule is going to leave in a step to a time [m]: it grows with the third power of the
  /// step, but of no longer step than the last one is it known.
  Vector3d foreseen(int joint, double to) const {
    if (!(last_step > 0.0)) return Vector3d::Zero();
    const double share = std::min(1.0, (to - time) / last_step);
    return share * share * share * lost.col(joint);
  }
  Vector3d foreseen_rate(int joint, double to) const {
    if (!(last_step > 0.0) || !(to > time)) return Vector3d::Zero();
    return 3.0 / (to - time) * foreseen(joint, to);
  }
};

/// Closures close to this share of System::reach(): some hundred roundings of it. What is less than
/// that far from the bound of an inequality is not told from it.
constexpr double closure_tolerance = 1e-13;

/// What rounding may make of lengths [m] and forces [N].
struct Rounding {
  double length = 0.0;
  double force = 0.0;
};

/// The frames of all elements of a model.
ElementFrames frames_of_elements(const Model& model);

/// Equations of a truss: layout of the unknowns, residual, Jacobian, inequalities. Elements and
/// joints contribute by their contracts; the types are not known here.
///
/// Unknowns z: free displacements of the nodes [m], then the forces of the joints [N]. Rows stand
/// in the same order.
class System {
 public:
  /// The model must outlive the system and be valid.
  explicit System(const Model& model);

  int unknowns() const { return unknowns_; }
  int displacements() const { return displacements_; }
  const Model& model() const { return *model_; }
  const DofMap& dofs() const { return dofs_; }
  /// Calls `use(elements, frames, k)` for every type k of element.
  template <class Use>
  void each_element_type(Use&& use) const {
    for_each_element_type([&]<std::size_t k>(std::integral_constant<std::size_t, k>) {
      use(std::get<k>(model_->lists()), std::get<k>(element_frames_), k);
    });
  }

  /// Residual and rows of a joint alone, each entry of the Jacobian listed.
  void evaluate_joint(int joint, const VectorXd& z, double time, const StepStart& start,
                      JointStatus status, JointModel model, double opening, Assembly& to) const;

  /// Which parts of a truss are evaluated.
  enum class Parts : unsigned char { all, elements, joints };

  /// Place for residual and Jacobian of these parts, whose pattern never changes.
  Assembly assembly(Parts parts = Parts::all) const {
    return parts == Parts::all ? pattern_ : recorded(parts);
  }

  /// Residual and Jacobian at z, the rows of the joints on the branches of `statuses`.
  /// @param opening share of the clearances that is open (start)
  void evaluate(const VectorXd& z, double time, const StepStart& start, const Statuses& statuses,
                JointModel joints, double opening, Assembly& to) const;
  /// The same of elements and loads alone.
  void evaluate_elements(const VectorXd& z, double time, Assembly& to) const;
  /// The same of the joints alone, as they are with friction in motion.
  void evaluate_joints(const VectorXd& z, double time, const StepStart& start,
                       const Statuses& statuses, Assembly& to) const;

  /// Derivative of the residual by time where nothing moves, from the rates of the programs [K/s].
  VectorXd heating(const VectorXd& z, double time, const StepStart& start, const Statuses& statuses,
                   const std::vector<double>& program_rates) const;

  /// How fast every joint that slips slides at z [m/s]; 0 for the others.
  /// @param rate of the unknowns, @param program_rates of the programs [K/s]
  VectorXd slide_rates(const VectorXd& z, double time, const StepStart& start,
                       const Statuses& statuses, const VectorXd& rate,
                       const std::vector<double>& program_rates) const;

  /// Calls `work(joint)` for every joint, many at a time in several threads: it may write what is
  /// the joint's own.
  template <class Work>
  void each_joint(Work&& work) const {
    each_in_parallel(model_->joints.size(), joints_at_once,
                     [&](std::size_t i) { work(static_cast<int>(i)); });
  }

  /// The first joint of which `is(joint)` holds, many asked at a time; −1: there is none.
  template <class Is>
  int first_joint(Is&& is) const {
    constexpr int none = std::numeric_limits<int>::max();
    std::atomic<int> first{none};
    each_joint([&](int i) {
      int before = first;
      if (i > before || !is(i)) return;
      while (i < before && !first.compare_exchange_weak(before, i)) continue;
    });
    return first == none ? -1 : first.load();
  }

  Statuses all_stick() const { return Statuses(model_->joints.size(), JointStatus::stick); }

  /// The branch that a joint's inequalities ask for, from the branch whose rows hold at z.
  /// @param moved displacements at z
  JointStatus decide(int joint, const VectorXd& z, const Eigen::Matrix3Xd& moved, double time,
                     const StepStart& start, JointModel joints, double opening, JointStatus status,
                     const Rounding& rounding) const;
  JointStatus decide(int joint, const VectorXd& z, double time, const StepStart& start,
                     JointModel joints, double opening, JointStatus status,
                     const Rounding& rounding) const;

  /// Gives joints whose law has one row for stick and slip the status that they have at the end of
  /// a step.
  void settle(const VectorXd& z, double time, const StepStart& start, Statuses& statuses) const;

  /// The state as the start of the first step, where nothing is remembered.
  StepStart begin(const VectorXd& z, double time, const Statuses& statuses, double opening) const;
  /// The state as the start of the next step, @param last that of the step that led here.
  StepStart commit(const VectorXd& z, double time, const Statuses& statuses,
                   const StepStart& last) const;

  /// Slides of a step that friction turned into heat, of every joint [m].
  /// @param after the state at z as the start of the next step
  VectorXd slips(const VectorXd& z, double time, const StepStart& start,
                 const StepStart& after) const;

  /// How far cables and joints are beyond the edges at which their stiffness jumps [m].
  VectorXd beyond_edges(const VectorXd& z, double time, const StepStart& now) const;

  /// A step by way of the middle of its cubic.
  struct Halves {
    VectorXd middle;
    double time;      ///< There [s].
    StepStart half;   ///< The state there as the start of the second half.
    StepStart whole;  ///< That of the end.
  };
  /// Nothing where the way is straight, or where no joint asks for it.
  std::optional<Halves> halves_of(const Way& way, const StepStart& start,
                                  const Statuses& statuses) const;
  /// What the slides of a step are off, noted in `after`. Such as ∫ |d| dφ are taken by the
  /// trapezoidal rule, whose error in a step is of third order. It does not add up: what a step is
  /// off, known from its halves (Richardson), is made up for in the next one, and as the next is
  /// off by nearly as much, that is foreseen there. So what is left at any state is of fourth
  /// order.
  void note_slides(const Way& way, const std::optional<Halves>& halves, const StepStart& start,
                   StepStart& after) const;

  /// Friction's heat of a step and the temperature's work, added to the state's.
  /// @param after the state at z as the start of the next step, @param slips see slips()
  /// @param way where statuses are the same at both ends, the rates by which both are of fourth
  /// order; without they are of second
  void account(const Way& way, const std::optional<Halves>& halves, const StepStart& start,
               const StepStart& after, const VectorXd& slips, State& state) const;
  /// The temperature's work on elements of a step [J].
  double work_on_elements(const Way& way) const;

  /// Displacements, forces and energies at z; dissipation and thermal work are left alone.
  /// @param now the state at z as the start of the next step
  void describe(const VectorXd& z, double time, const StepStart& now, State& state) const;

  /// How far a joint with play has moved within it since the start of a step [m]; zero: it has
  /// none.
  Vector3d slack_motion(int joint, const VectorXd& z, double time, const StepStart& start) const;
  /// Work that the dashpots of slack joints take in a step [J].
  double slack_work(const VectorXd& z, double time, const StepStart& start,
                    const Statuses& statuses) const;

  /// A joint at z, as its type is asked about it.
  Trial trial(int joint, const VectorXd& z, double time, const StepStart& start, JointModel joints,
              double opening) const;

  /// Moves the first node of a joint and sets the joint's forces.
  void apply(int joint, const Seat& seat, VectorXd& z) const;

  /// The same as trial(), where the displacements of all nodes are known.
  Trial trial(int joint, const VectorXd& z, const Eigen::Matrix3Xd& moved, double time,
              const StepStart& start, JointModel joints, double opening) const;

  Vector3d displacement(int node, const VectorXd& z) const { return dofs_.displacement(node, z); }
  /// Displacements of all nodes, for who asks many joints at one state [m].
  void displacements(const VectorXd& z, Eigen::Matrix3Xd& moved) const {
    dofs_.displacements(z, moved);
  }
  Eigen::Matrix3Xd displacements(const VectorXd& z) const {
    Eigen::Matrix3Xd moved;
    displacements(z, moved);
    return moved;
  }

  /// Symmetric stiffness of links and springs at z with joints closed (penalty), for the search for
  /// mechanisms and instability; free displacements only, the lower triangle. A joint listed as
  /// open or slipping does not hold there.
  /// @param held stiffness of a direction that a joint holds, in that of the stiffest part
  /// @param slack stiffness of a joint that is open [N/m]
  Eigen::SparseMatrix<double> penalty_stiffness(const VectorXd& z, double time,
                                                const Statuses& statuses, JointModel joints,
                                                double held, double slack) const;
  /// Displacement by which rounding at z is measured [m]: the largest one, but not below
  /// path_scale() nor above the size of the truss. Both bounds matter: a truss that comes back to
  /// its reference configuration has no displacement and no force, but the rounding of the path
  /// that led there; and where an iteration runs away, its distance excuses no residual.
  double reach(const VectorXd& z) const;
  /// Displacement that the model prescribes before anything is solved [m]: the largest thermal
  /// strain of a program times the size of the truss, or the largest force of a load, a spring or a
  /// misfit over the stiffness of the stiffest part, whichever is larger.
  double path_scale() const { return path_scale_; }
  /// Stiffness that holds a joint without contact against its motion in a step [N/m].
  ///
  /// Statics does not determine where an element hangs whose joint is open: it is slack. Dashpots
  /// in the pins choose: over a step Δt they are springs c/Δt on the motion since its start. As c
  /// goes to zero no force is left, and the element goes to the admissible position nearest to the
  /// last one: a proximal point step (R. T. Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898).
  /// A stiffness of 1e-8 of the stiffest element is that limit in floating point: forces are below
  /// 1e-8 of what a motion by the play would ask of that element, and what rounding leaves of the
  /// forces moves a slack element by less than 1e-6 of the largest displacement.
  ///
  /// Each level above is a hundred times as stiff, up to a hundredth of the stiffest element: for
  /// elements that compression pushes away from where they hang, or so many behind each other that
  /// rounding decides. What its dashpots take is counted as work.
  double slack_stiffness(double level) const {
    return 1e-8 * std::pow(100.0, level) * stiffness_scale_;
  }
  static constexpr double most_slack_level = 3.0;
  /// Level of dashpots that hold a path while its steps have no solution with softer ones: as stiff
  /// as the stiffest element, so that what they hold back follows within a few steps.
  static constexpr double stiffest_level = 4.0;
  /// What rounding at z leaves of the forces at a node [N]: some 64 terms are added up there, each
  /// of a stiffness times a displacement.
  double force_rounding(const VectorXd& z) const;
  /// Rounding of a displacement at z [m].
  double length_rounding(const VectorXd& z) const {
    return 4.0 * std::numeric_limits<double>::epsilon() * reach(z);
  }
  /// What equations that count as solved leave undecided at z: of a displacement, see
  /// closure_tolerance, and of the forces that come of its rounding.
  Rounding rounding(const VectorXd& z) const;
  /// Rounding of a joint's slide less what friction bends [m].
  /// @param by rounding(z), which reads all of z and so is asked for once for many joints
  double slide_rounding(int joint, const VectorXd& z, double time, const StepStart& start,
                        const Rounding& by) const;
  /// Node of a free displacement.
  int node_of(int displacement) const { return dofs_.node_of(displacement); }
  const JointFrame& frame(int joint) const { return frames_[index(joint)]; }
  /// First unknown of a joint's forces.
  int force_row(int joint) const { return force_row_[index(joint)]; }
  int force_count(int joint) const { return frames_[index(joint)].forces; }
  /// Whether the state depends on when in a step a joint changed its status.
  bool remembers_when(int joint, JointStatus before, JointStatus after) const;
  /// Whether a change of status is an event: one without friction that slides back is none.
  bool is_event(int joint, JointStatus before, JointStatus after) const {
    return !(is_slip(before) && is_slip(after)) || remembers_when(joint, before, after);
  }
  /// Forces of the dashpots of slack elements in a step, all taken as positive and added up [N].
  double dashpot_force(const VectorXd& z, double time, const StepStart& start,
                       const Statuses& statuses) const;
  /// The larger of the forces of these dashpots in a step and in the one before [N].
  double idle_force(const VectorXd& z, double time, const StepStart& start,
                    const Statuses& statuses) const {
    return std::max(start.dashpot_force, dashpot_force(z, time, start, statuses));
  }
  /// Whether a joint with play carries no more than `force` at both ends of a step. If that is its
  /// idle_force(), nothing depends on when the joint changes its status: without dashpots it would
  /// carry nothing.
  bool is_idle(int joint, const VectorXd& from, const VectorXd& to, double force) const;
  /// Whether a joint slips at its rim while it sticks.
  bool slips_smoothly() const { return slips_smoothly_; }
  /// Slide of a step less what friction bends, of a joint that rolls; nothing is owed to it [m].
  Vector3d lag(int joint, const VectorXd& z, double time, const StepStart& start) const;
  double stiffness_scale() const { return stiffness_scale_; }
  double size() const { return size_; }  ///< Largest extent of the drawn shape [m].

  /// What a joint remembers, of a type's history() many numbers.
  const double* history(int joint, const StepStart& start) const {
    return start.history.data() + history_begin_[index(joint)];
  }
  double* history(int joint, StepStart& start) const {
    return start.history.data() + history_begin_[index(joint)];
  }

 private:
  /// The temperature's work of a step on joints whose parts expand [J].
  double work_on_joints(const Way& way, const StepStart& start) const;
  /// Heat of a step of every joint [J], as if all were straight between its ends.
  VectorXd heat(const VectorXd& z, double time, const StepStart& start, const StepStart& after,
                const VectorXd& slips) const;
  void assemble(Parts parts, const VectorXd& z, double time, const StepStart& start,
                const Statuses& statuses, JointModel joints, double opening, Assembly& to) const;
  /// Calls `write(region, strand)` for all regions, those apart at the same time.
  template <class Write>
  void write_regions(Assembly& to, Write&& write) const;
  /// @param changes of the programs [K]
  void assemble_elements(const Region& region, const std::vector<double>& changes,
                         AssemblyStrand& to) const;
  Assembly recorded(Parts parts) const;
  /// Finds stiffness_scale() and path_scale().
  void find_scales();
  JointWriter joint_writer(int joint, AssemblyStrand& to) const;
  JointStatus decide(int joint, Trial& at, JointStatus status, const Rounding& rounding) const;
  /// Of all programs [K].
  std::vector<double> temperature_changes(double time) const {
    std::vector<double> changes;
    for (const auto& program : model_->programs) {
      changes.push_back(program.temperature_change(time));
    }
    return changes;
  }
  double temperature_change(const JointFrame& frame, double time) const {
    return frame.program < 0
               ? 0.0
               : model_->temperature_change(frame.program, frame.temperature_fraction, time);
  }

  /// Asking as many takes some ten times as long as starting a thread.
  static constexpr std::size_t joints_at_once = 2000;

  const Model* model_;
  int unknowns_ = 0;
  int displacements_ = 0;
  int history_ = 0;
  int outputs_ = 0;
  bool slips_smoothly_ = false;
  double stiffness_scale_ = 0.0;
  double size_ = 0.0;
  double path_scale_ = 0.0;
  std::vector<Vector3d> drawn_;  // of each node; the model's lie far apart in memory
  DofMap dofs_;
  std::vector<JointFrame> frames_;
  std::vector<int> force_row_;      // first force of each joint
  std::vector<int> history_begin_;  // of each joint
  std::vector<int> output_begin_;   // of each joint
  std::vector<int> rolling_;        // joints whose slides are integrals along the way
  ElementFrames element_frames_;
  Eigen::Index element_outputs_ = 0;
  bool has_edges_ = false;  // of an element
  Regions regions_;
  Assembly pattern_{0};  // of all parts, which others copy
};

}  // namespace statejump::truss::detail
