// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <concepts>
#include <optional>
#include <span>
#include <string>

#include "statejump/truss/parameter.hpp"

namespace statejump::truss {

struct Model;
class JointWriter;

/// The branch of a joint's equations that is active, as found by the solver. The sign is the
/// direction of the slide. A slider slides along its axis; in a revolute the journal's surface
/// slides over the bearing's, positive anticlockwise.
enum class JointStatus : unsigned char {
  stick,
  slip_plus,
  slip_minus,
  stop_plus,   ///< Rests against a stop.
  stop_minus,  ///< Likewise, on the other side.
  open         ///< No contact.
};

/// "stick", "slip_plus", …: the enumerator's name.
const char* to_string(JointStatus status);

constexpr bool is_slip(JointStatus status) {
  return status == JointStatus::slip_plus || status == JointStatus::slip_minus;
}

/// Model that replaces joints with clearance while the solver seeks the first state. The search
/// starts with bilateral pins and continues with frictionless contacts. The path itself uses
/// friction.
enum class JointModel : unsigned char { pins, frictionless, friction };

/// A joint as a contact of a frictional contact problem: the rows for gap and slide that it has
/// with the status `stick`.
struct LocalContact {
  int tangential = 0;                 ///< Row of the slide.
  int normal = -1;                    ///< Row of the gap; −1: the normal force is given.
  double friction_coefficient = 0.0;  ///< [-]
  double normal_force = 0.0;          ///< [N], if it is given.
};

constexpr int most_joint_nodes = 4;
constexpr int most_joint_forces = 3;

/// Position of a joint in the truss, determined once.
struct JointFrame {
  /// Sites of the joint: nodes that it moves, nodes whose links rotate its parts, and rotations of
  /// nodes, see rotation_site(). −1 means the ground, or no node.
  std::array<int, most_joint_nodes> nodes{-1, -1, -1, -1};
  int node_count = 0;
  /// Whether a site is the rotation of a node.
  std::array<bool, most_joint_nodes> rotates{};
  /// Node::arm of the sites that are rotations [m].
  std::array<double, most_joint_nodes> arms{1.0, 1.0, 1.0, 1.0};
  int forces = 0;    ///< Unknown forces, each with a row of its own.
  int program = -1;  ///< Temperature program that it follows; −1: none.
  double temperature_fraction = 1.0;
  /// Right-handed frame of fixed directions.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  /// Whether a force constrains the first two nodes, for each direction of the joint.
  std::array<bool, 3> holds{false, false, false};
};

/// The state at which a joint is evaluated, together with the state at the start of the step.
struct Trial {
  /// Leaves positions and displacements uninitialised, because the caller fills them. Each
  /// evaluation constructs one Trial per joint.
  explicit Trial(const JointFrame& of) : frame(of) {}

  const JointFrame& frame;
  /// Positions of its nodes in the reference configuration [m]; of rotations 0.
  std::array<Eigen::Vector3d, most_joint_nodes> drawn;
  std::array<Eigen::Vector3d, most_joint_nodes> moved;  ///< Their displacements [m].
  std::array<double, most_joint_forces> force{};        ///< Its unknowns [N].
  const double* history = nullptr;          ///< Memory of the joint at the start of the step.
  JointStatus before = JointStatus::stick;  ///< Status at the start of the step.
  double temperature_change = 0.0;          ///< [K]
  JointModel model = JointModel::friction;
  /// Opened fraction of the clearances. It is below 1 only while the solver seeks the start.
  double opening = 1.0;
  /// True if the evaluation serves to find the slip rate. The slide row is then that of a sticking
  /// contact.
  bool unslipped = false;
  /// True in dynamics, where separate contacts represent soft stops and play, so that the joint
  /// omits its springs.
  bool in_motion = false;
  /// Slip error of a joint that rolls [m]: that of earlier steps plus that expected in this step;
  /// then its rate [m/s]. It is a scalar along the slide, or a vector in the tangent plane.
  Eigen::Vector3d owed = Eigen::Vector3d::Zero();
  Eigen::Vector3d owed_rate = Eigen::Vector3d::Zero();
  /// Spring stiffness against motion of a joint without force since the start of the step [N/m],
  /// see System::slack_stiffness(). 0: no spring.
  double slack_stiffness = 0.0;
  /// Whether this stiffness also acts on joints in contact.
  bool damps_contact = false;
  /// Whether the compliance of the contact grows in the step. Empty: as its normal forces require.
  /// Derivatives fix it, because short steps lie next to the kink between both laws.
  std::optional<bool> softens;
  /// Rounding errors of a length [m] and of a force [N]; 0: inequalities are checked exactly.
  double length_rounding = 0.0;
  double force_rounding = 0.0;

  /// Stiffness of the dashpot spring on the motion of a contact in the step [N/m]. It decreases to
  /// zero as the normal force grows, so that the total force is continuous.
  double slack_held(double normal_force, double clearance) const {
    if (damps_contact || normal_force <= 0.0) return slack_stiffness;
    return std::max(0.0, slack_stiffness - normal_force / clearance);
  }

  /// Vector between two nodes of the joint [m], computed without the difference of two positions.
  Eigen::Vector3d between(std::size_t from, std::size_t to) const {
    return (drawn[to] - drawn[from]) + (moved[to] - moved[from]);
  }
};

/// Displacement of a journal to its first contact, see Type::seat().
struct Seat {
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();  ///< Step of the first node [m].
  std::array<double, most_joint_forces> force{};    ///< New forces [N].
  bool touches = true;  ///< False: no force determines the contact point.
};

/// A type of joint is a struct of parameters with a name and a law between its nodes, whose forces
/// are unknowns.
///
/// | member | meaning |
/// |---|---|
/// | `kind` | its table in the case and its name in messages |
/// | `parameters()` | key, unit, range and source of each parameter |
/// | `outputs()`, `describe()` | numbers that are output at every state |
/// | `history()` | count of numbers that it stores from state to state |
/// | `validate()` | rules beyond the ranges of single parameters |
/// | `frame()` | nodes, directions, number of unknown forces |
/// | `evaluate()` | forces on nodes and rows of a status, with all derivatives |
///  `warm()` | rates of these forces and rows due to its temperature alone |
/// | `slide_row` | row that keeps the slide zero while the joint sticks |
/// | `decide()` | status that the inequalities require, given the status whose rows hold |
/// | `begin()` | writes its memory at the start of the path |
/// | `commit()` | writes its memory at the start of the next step |
/// | `slip()` | slide of the step that friction converted into heat [m] |
/// | `dissipation()` | heat of the step [J] |
/// | `elastic_energy()` | energy stored in it [J] |
/// | `slide_rounding()` | rounding error of the slide minus the elastic deflection [m] |
/// | `remembers_when()` | whether the state depends on the time in a step at which the status
/// changed |
/// | `slips_smoothly()` | whether its law has one row for stick and slip |
/// | `settled()` | status at the end of a step; differs from decide() only if slips_smoothly() |
/// | `contact()` | its rows as a frictional contact; empty if its status has no contact |
/// | `rest()` | status at the start of the path |
/// | `has_play()` | whether the start has to find its contact |
/// | `least_slide()` | smallest scale of its slides [m] |
/// | `seat()`, `jumps()` | how the start finds contact; whether a step was a jump |
///
/// Optional members:
///
/// | member | meaning |
/// |---|---|
/// | `rolls()`, `lag()` | whether the slide is an integral; slide minus elastic deflection [m] |
/// | `clearance_growth()` | growth of a clearance by its temperature [m/K] |
/// | `contact_force()` | force against which that growth works [N] |
/// | `beyond_edges()` | distance beyond each edge at which the stiffness jumps [m] |
/// | `has_kinks` | its force has kinks within a status, which no step ends at |
/// | `softens()` | whether the compliance of its contact grows in the step |
/// | `slack_motion()` | motion of an open joint since the start of the step [m] |
/// | `ties()` | linear constraints of its nodes, see ConstraintTerm |
///
/// @pre of all but validate(): the joint and the truss around it are valid. evaluate() writes the
/// same entries for every status. The histories of begin(), commit() and Trial have history()
/// numbers.
template <class Type>
concept JointType = requires(const Type& one, const Model& model, const Trial& trial,
                             JointStatus status, JointWriter& writer, double* written,
                             const double* after) {
  { Type::kind } -> std::convertible_to<const char*>;
  { Type::slide_row } -> std::convertible_to<int>;
  { Type::parameters() } -> std::same_as<std::span<const Parameter<Type>>>;
  { Type::outputs() } -> std::same_as<std::span<const Output>>;
  { one.name } -> std::convertible_to<std::string>;
  { one.history() } -> std::same_as<int>;
  { one.validate(model) } -> std::same_as<void>;
  { one.frame(model) } -> std::same_as<JointFrame>;
  { one.evaluate(trial, status, writer) } -> std::same_as<void>;
  { one.warm(trial, status, 1.0, writer) } -> std::same_as<void>;
  { one.decide(trial, status) } -> std::same_as<JointStatus>;
  { one.begin(trial, status, written) } -> std::same_as<void>;
  { one.commit(trial, status, written) } -> std::same_as<void>;
  { one.slip(trial, after) } -> std::same_as<double>;
  { one.dissipation(trial, after, 1.0) } -> std::same_as<double>;
  { one.elastic_energy(trial, after) } -> std::same_as<double>;
  { one.describe(trial, written) } -> std::same_as<void>;
  { one.slide_rounding(trial, 1.0, 1.0) } -> std::same_as<double>;
  { one.remembers_when(status, status) } -> std::same_as<bool>;
  { one.slips_smoothly() } -> std::same_as<bool>;
  { one.settled(trial, status) } -> std::same_as<JointStatus>;
  { one.contact(trial, status) } -> std::same_as<std::optional<LocalContact>>;
  { one.rest() } -> std::same_as<JointStatus>;
  { one.has_play() } -> std::same_as<bool>;
  { one.least_slide() } -> std::same_as<double>;
  { one.seat(trial, 1.0, 1.0, 1.0) } -> std::same_as<Seat>;
  { one.jumps(trial, status) } -> std::same_as<bool>;
};

/// Members of a joint without temperature of its own, play and partial slip.
struct PlainJoint {
  void warm(const Trial&, JointStatus, double, JointWriter&) const {}
  JointStatus settled(const Trial&, JointStatus status) const { return status; }
  bool slips_smoothly() const { return false; }
  double least_slide() const { return 0.0; }
  JointStatus rest() const { return JointStatus::stick; }
  bool has_play() const { return false; }
  Seat seat(const Trial&, double, double, double) const { return {}; }
  bool jumps(const Trial&, JointStatus) const { return false; }
};

// A natural map of Alart and Curnier [1] is piecewise smooth: λ − proj(λ − r g; bounds) equals r g
// on one branch, and λ minus a bound on the others. After a Newton step the active one of these
// expressions is zero. The choice between branches therefore does not depend on r > 0. Rows omit r:
// the residual is g in metres, or λ minus its bound in newtons.
//
// [1] P. Alart, A. Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353-375.

}  // namespace statejump::truss
