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

/// Replaces every closed status by stick; open joints stay open.
inline Statuses held_but_open(Statuses statuses) {
  for (JointStatus& status : statuses) {
    if (status != JointStatus::open) status = JointStatus::stick;
  }
  return statuses;
}

/// State at the start of a step. Slides in the step are measured from this state.
struct StepStart {
  Statuses statuses;
  VectorXd history;   ///< Memory of all joints, one after the other.
  double time = 0.0;  ///< [s]
  /// Quadrature error of the slide in the last step, which this step corrects [m]; see
  /// System::note_slides(). Empty: no joint rolls.
  Eigen::Matrix3Xd owed;
  Eigen::Matrix3Xd lost;   ///< Quadrature error of the slide in the last step [m].
  double last_step = 0.0;  ///< Duration of the last step [s].
  /// Of open joints [N/m], see System::slack_stiffness(); copied from step to step.
  double slack_stiffness = 0.0;
  /// Whether dashpots also hold closed joints with play, see PathFollower::follow_snap().
  bool damps_contact = false;
  bool is_loose = false;  ///< Whether elements are slack: only dashpots determine their positions.
  double dashpot_force = 0.0;  ///< Sum of all dashpot forces of joints in the last step [N].

  /// Expected quadrature error of a slide in the step to the time `to` [m]. It is the error of the
  /// last step times the third power of the ratio of step lengths. This ratio is limited to 1.
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

/// Tolerance of closures divided by System::reach(); it is some hundred roundings. A smaller
/// distance from the bound of an inequality counts as zero.
constexpr double closure_tolerance = 1e-13;

/// Tolerances of lengths [m] and forces [N] for inequalities.
struct Rounding {
  double length = 0.0;
  double force = 0.0;
};

/// The frames of all elements of a model.
ElementFrames frames_of_elements(const Model& model);

/// Equations of a truss: layout of the unknowns, residual, Jacobian, inequalities. Elements and
/// joints contribute through their interfaces; this class does not depend on their types.
///
/// Unknowns z: free displacements of the nodes and, where beams end, their rotation vectors times
/// Node::arm [m]; then joint forces [N]. Rows have the same order. Rotation vectors start at the
/// reference configuration. So unknowns are added, interpolated and extrapolated as vectors, and
/// the tangent of the elements is symmetric in every state.
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

  /// Evaluates residual and Jacobian of one joint. The entries of the Jacobian are listed without
  /// sums.
  void evaluate_joint(int joint, const VectorXd& z, double time, const StepStart& start,
                      JointStatus status, JointModel model, double opening, Assembly& to) const;

  /// Parts of a truss that are evaluated.
  enum class Parts : unsigned char { all, elements, joints };

  /// Creates storage for residual and Jacobian of the given parts, with their fixed sparsity
  /// pattern.
  Assembly assembly(Parts parts = Parts::all) const {
    return parts == Parts::all ? pattern_ : recorded(parts);
  }

  /// Evaluates residual and Jacobian at z with the given statuses.
  /// @param opening opened fraction of the clearances
  void evaluate(const VectorXd& z, double time, const StepStart& start, const Statuses& statuses,
                JointModel joints, double opening, Assembly& to) const;
  /// Evaluates elements and loads only.
  void evaluate_elements(const VectorXd& z, double time, Assembly& to) const;
  /// Evaluates joints only, with friction and in motion.
  void evaluate_joints(const VectorXd& z, double time, const StepStart& start,
                       const Statuses& statuses, Assembly& to) const;

  /// Partial derivative of the residual with respect to time, caused by the rates of the
  /// temperature programs [K/s].
  VectorXd heating(const VectorXd& z, double time, const StepStart& start, const Statuses& statuses,
                   const std::vector<double>& program_rates) const;

  /// Slip rates of all slipping joints at z [m/s]; 0 for the others.
  /// @param rate rates of the unknowns
  /// @param program_rates rates of the temperature programs [K/s]
  VectorXd slide_rates(const VectorXd& z, double time, const StepStart& start,
                       const Statuses& statuses, const VectorXd& rate,
                       const std::vector<double>& program_rates) const;

  /// Calls `work(joint)` for every joint, in several threads. `work` may write only data of its own
  /// joint.
  template <class Work>
  void each_joint(Work&& work) const {
    each_in_parallel(model_->joints.size(), joints_at_once,
                     [&](std::size_t i) { work(static_cast<int>(i)); });
  }

  /// Lowest index of a joint for which `is(joint)` returns true; −1: none. Several threads evaluate
  /// it.
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

  /// Status that the inequalities of a joint require, given the status whose rows hold at z.
  /// @param moved displacements at z [m]
  JointStatus decide(int joint, const VectorXd& z, const Eigen::Matrix3Xd& moved, double time,
                     const StepStart& start, JointModel joints, double opening, JointStatus status,
                     const Rounding& rounding) const;
  JointStatus decide(int joint, const VectorXd& z, double time, const StepStart& start,
                     JointModel joints, double opening, JointStatus status,
                     const Rounding& rounding) const;

  /// Sets the statuses of joints whose law has one row for stick and slip to those at the end of
  /// the step.
  void settle(const VectorXd& z, double time, const StepStart& start, Statuses& statuses) const;

  /// The state at z as the start of the first step, without memory of friction.
  StepStart begin(const VectorXd& z, double time, const Statuses& statuses, double opening) const;
  /// The state at z as the start of the next step.
  /// @param last start of the step that led to this state
  StepStart commit(const VectorXd& z, double time, const Statuses& statuses,
                   const StepStart& last) const;

  /// Slides of a step that friction converted into heat, for every joint [m].
  /// @param after the state at z as the start of the next step
  VectorXd slips(const VectorXd& z, double time, const StepStart& start,
                 const StepStart& after) const;

  /// Distances by which cables and joints are beyond the edges at which their stiffness jumps [m].
  VectorXd beyond_edges(const VectorXd& z, double time, const StepStart& now) const;

  /// A step divided into two halves at the middle of its cubic interpolation, for Richardson
  /// extrapolation.
  struct Halves {
    VectorXd middle;
    double time;      ///< Time of the middle [s].
    StepStart half;   ///< State at the middle as the start of the second half.
    StepStart whole;  ///< State at the end, reached in two halves.
  };
  /// Divides a step into halves. The result is empty if the interpolation is straight, or if no
  /// joint needs the halves.
  std::optional<Halves> halves_of(const Way& way, const StepStart& start,
                                  const Statuses& statuses) const;
  /// Stores the quadrature errors of the slides of a step in `after`. The trapezoidal rule computes
  /// slides such as ∫ |d| dφ with a third-order error per step. The error of this step is estimated
  /// from its halves (Richardson) and corrected in the next step. The next step has nearly the same
  /// error; its error is predicted from that of this step and corrected too. The remaining error of
  /// every state is of fourth order.
  void note_slides(const Way& way, const std::optional<Halves>& halves, const StepStart& start,
                   StepStart& after) const;

  /// Adds the heat of friction and the work of the temperature in a step to the state.
  /// @param after the state at z as the start of the next step
  /// @param slips see slips()
  /// @param way interpolation of the unknowns; with rates, heat and work are fourth-order accurate,
  /// otherwise second-order
  void account(const Way& way, const std::optional<Halves>& halves, const StepStart& start,
               const StepStart& after, const VectorXd& slips, State& state) const;
  /// Work of the temperature on elements in a step [J].
  double work_on_elements(const Way& way) const;

  /// Writes displacements, forces and energies at z, but not dissipation and thermal work.
  /// @param now the state at z as the start of the next step
  void describe(const VectorXd& z, double time, const StepStart& now, State& state) const;

  /// Motion of a joint within its play since the start of a step [m]; zero without play.
  Vector3d slack_motion(int joint, const VectorXd& z, double time, const StepStart& start) const;
  /// Work that the dashpots of slack joints absorb in a step [J].
  double slack_work(const VectorXd& z, double time, const StepStart& start,
                    const Statuses& statuses) const;

  /// State of a joint at z, to evaluate its type.
  Trial trial(int joint, const VectorXd& z, double time, const StepStart& start, JointModel joints,
              double opening) const;

  /// Moves the first node of a joint and sets its forces.
  void apply(int joint, const Seat& seat, VectorXd& z) const;

  /// As the other trial(), with given displacements of all nodes.
  Trial trial(int joint, const VectorXd& z, const Eigen::Matrix3Xd& moved, double time,
              const StepStart& start, JointModel joints, double opening) const;

  Vector3d displacement(int node, const VectorXd& z) const { return dofs_.displacement(node, z); }
  /// Load on a node or, for its site rotation_site(), moment over Node::arm [N].
  Vector3d load_on(int site) const;
  /// Computes the displacements of all sites [m] at z once, to evaluate many joints at this state.
  void displacements(const VectorXd& z, Eigen::Matrix3Xd& moved) const {
    dofs_.displacements(z, moved);
  }
  Eigen::Matrix3Xd displacements(const VectorXd& z) const {
    Eigen::Matrix3Xd moved;
    displacements(z, moved);
    return moved;
  }

  /// Symmetric stiffness of the elements at z plus penalty stiffness of the closed joints, to
  /// search for mechanisms and instability. Lower triangle for free displacements only. Open joints
  /// and slipping directions have no penalty stiffness.
  /// @param held penalty stiffness of a constrained direction, divided by the stiffness of the
  /// stiffest element
  /// @param slack stiffness of an open joint [N/m]
  Eigen::SparseMatrix<double> penalty_stiffness(const VectorXd& z, double time,
                                                const Statuses& statuses, JointModel joints,
                                                double held, double slack) const;
  /// Displacement that scales rounding errors at z [m]. It is the largest displacement, but at
  /// least path_scale() and at most the size of the truss. The lower bound matters if a truss
  /// returns to its reference configuration, where displacements and forces vanish but rounding
  /// errors of the path do not. The upper bound keeps a diverging iteration from loosening the
  /// tolerances.
  double reach(const VectorXd& z) const;
  /// Displacement expected from the model before a solution is known [m]. It is the larger of two
  /// values. They are the largest thermal strain times the size of the truss, and the largest force
  /// of a load, spring or misfit over the largest element stiffness.
  double path_scale() const { return path_scale_; }
  /// Stiffness, as springs, of the dashpots that resist the motion of an open joint in a step
  /// [N/m].
  ///
  /// If statics does not determine the position of an element with an open joint, the element is
  /// slack. Dashpots in the joints then select a position. Over a step Δt a dashpot c acts as a
  /// spring c/Δt on the motion since its start. As c goes to zero, dashpot forces vanish, and the
  /// element moves to the admissible position nearest to its last one: a proximal point step (R. T.
  /// Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898). Level 0, with 1e-8 of the stiffness of
  /// the stiffest element, approximates this limit in floating point. A motion by the play then
  /// causes 1e-8 of the force that it would cause in the stiffest element. Rounding of the forces
  /// moves a slack element by less than 1e-6 of the largest displacement.
  ///
  /// Each level is a hundred times as stiff as the previous level, up to a hundredth of the
  /// stiffest element at most_slack_level. Higher levels serve elements that compression moves away
  /// from their last position, and chains so long that rounding decides. The energy balance
  /// includes the work of the dashpots.
  double slack_stiffness(double level) const {
    return 1e-8 * std::pow(100.0, level) * stiffness_scale_;
  }
  static constexpr double most_slack_level = 3.0;
  /// Highest dashpot level, used while steps with softer dashpots have no solution. Dashpots are
  /// then as stiff as the stiffest element, so that delayed motions complete within a few steps.
  static constexpr double stiffest_level = 4.0;
  /// Rounding error of the force balance of a node at z [N]. The balance adds about 64 terms, each
  /// a stiffness times a displacement.
  double force_rounding(const VectorXd& z) const;
  /// Rounding of a displacement at z [m].
  double length_rounding(const VectorXd& z) const {
    return 4.0 * std::numeric_limits<double>::epsilon() * reach(z);
  }
  /// Tolerances of a converged solution at z: a length, which is closure_tolerance times reach(),
  /// and the force that it causes in the stiffest element.
  Rounding rounding(const VectorXd& z) const;
  /// Rounding error of a joint's slide minus its elastic deflection [m].
  /// @param by result of rounding(z), computed once for many joints
  double slide_rounding(int joint, const VectorXd& z, double time, const StepStart& start,
                        const Rounding& by) const;
  /// Node of a free displacement.
  int node_of(int displacement) const { return dofs_.node_of(displacement); }
  const JointFrame& frame(int joint) const { return frames_[index(joint)]; }
  /// First unknown of a joint's forces.
  int force_row(int joint) const { return force_row_[index(joint)]; }
  int force_count(int joint) const { return frames_[index(joint)].forces; }
  /// Whether the state at the end of a step depends on the time at which a joint changed its status
  /// within it.
  bool remembers_when(int joint, JointStatus before, JointStatus after) const;
  /// Whether a change of status is an event. A reversal of slip without friction is not an event.
  bool is_event(int joint, JointStatus before, JointStatus after) const {
    return !(is_slip(before) && is_slip(after)) || remembers_when(joint, before, after);
  }
  /// Sum of the magnitudes of all dashpot forces on slack elements in a step [N].
  double dashpot_force(const VectorXd& z, double time, const StepStart& start,
                       const Statuses& statuses) const;
  /// The larger dashpot_force() of this step and the one before [N].
  double idle_force(const VectorXd& z, double time, const StepStart& start,
                    const Statuses& statuses) const {
    return std::max(start.dashpot_force, dashpot_force(z, time, start, statuses));
  }
  /// Whether the force of a joint with play is at most `force` at both ends of a step. If `force`
  /// is idle_force(), only the dashpots of slack elements cause the joint's force. It then does not
  /// matter when in the step the joint changes its status.
  bool is_idle(int joint, const VectorXd& from, const VectorXd& to, double force) const;
  /// Whether a joint has partial slip.
  bool slips_smoothly() const { return slips_smoothly_; }
  /// Whether the force of a joint has kinks within a status. A step across a kink follows the law
  /// exactly, but the quadrature of its work is only second-order accurate.
  bool has_kinks() const { return has_kinks_; }
  /// Slide of a step minus the elastic deflection, without corrections of the slip error [m]; for a
  /// joint that rolls.
  Vector3d lag(int joint, const VectorXd& z, double time, const StepStart& start) const;
  double stiffness_scale() const { return stiffness_scale_; }
  double size() const { return size_; }  ///< Largest extent of the reference configuration [m].

  /// Memory of a joint: history() numbers of its type.
  const double* history(int joint, const StepStart& start) const {
    return start.history.data() + history_begin_[index(joint)];
  }
  double* history(int joint, StepStart& start) const {
    return start.history.data() + history_begin_[index(joint)];
  }

 private:
  /// Work that the temperature does in a step on joints whose parts expand [J].
  double work_on_joints(const Way& way, const StepStart& start) const;
  /// Heat of every joint in a step [J], if the unknowns are interpolated linearly.
  VectorXd heat(const VectorXd& z, double time, const StepStart& start, const StepStart& after,
                const VectorXd& slips) const;
  void assemble(Parts parts, const VectorXd& z, double time, const StepStart& start,
                const Statuses& statuses, JointModel joints, double opening, Assembly& to) const;
  /// Calls `write(region, strand)` for all regions. Regions without common nodes run in parallel.
  template <class Write>
  void write_regions(Assembly& to, Write&& write) const;
  /// @param changes ΔT of the programs [K]
  void assemble_elements(const Region& region, const std::vector<double>& changes,
                         AssemblyStrand& to) const;
  Assembly recorded(Parts parts) const;
  /// Rejects a state with rotations beyond the range of the theory.
  void check_rotations(const ElementState& at) const;
  /// Computes stiffness_scale() and path_scale().
  void find_scales();
  JointWriter joint_writer(int joint, AssemblyStrand& to) const;
  JointStatus decide(int joint, Trial& at, JointStatus status, const Rounding& rounding) const;
  /// ΔT of all programs [K].
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

  /// Evaluating this many joints takes one thread about ten times as long as starting a thread.
  static constexpr std::size_t joints_at_once = 2000;

  const Model* model_;
  int unknowns_ = 0;
  int displacements_ = 0;
  int history_ = 0;
  int outputs_ = 0;
  bool slips_smoothly_ = false;
  bool has_kinks_ = false;
  double stiffness_scale_ = 0.0;
  double force_by_rotation_ = 0.0;  // of a node by 1 rad [N]
  double size_ = 0.0;
  double path_scale_ = 0.0;
  std::vector<Vector3d> drawn_;  // of each node; contiguous, unlike those of the model
  DofMap dofs_;
  std::vector<JointFrame> frames_;
  std::vector<int> force_row_;      // first force of each joint
  std::vector<int> history_begin_;  // of each joint
  std::vector<int> output_begin_;   // of each joint
  std::vector<int> rolling_;        // joints whose slides are integrals along the path
  ElementFrames element_frames_;
  Eigen::Index element_outputs_ = 0;
  bool has_edges_ = false;  // of elements
  Regions regions_;
  Assembly pattern_{0};  // of all parts; copied by assembly()
};

}  // namespace statejump::truss::detail
