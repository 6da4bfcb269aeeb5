// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ball_friction.hpp"
#include "slip_annuli.hpp"
#include "statejump/complementarity/problem.hpp"
#include "truss/system.hpp"

namespace statejump::truss::detail {

/// One contact of a joint, with its memory: a block of the contact problem. Its directions are
/// columns of the joint forces in the Jacobian of the truss. If a contact has no normal or no
/// tangential direction, an uncoupled row takes its place.
struct Contact {
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  int joint = 0;
  int normal_column = -1;      ///< −1: its normal force is given.
  double normal_sign = -1.0;   ///< Opening speed over column times velocity.
  int tangential_column = -1;  ///< −1: no friction.
  double friction_coefficient = 0.0;
  double given_force = 0.0;                ///< [N], if there is no normal column.
  JointStatus stop = JointStatus::open;    ///< Which stop of a slider; open: none.
  double hertz_stiffness = infinite;       ///< K [N/m^1.5]
  double normal_stiffness = infinite;      ///< k_n of a pad [N/m].
  double mindlin_stiffness = infinite;     ///< 8 G* √R [N/m^1.5]
  double tangential_stiffness = infinite;  ///< Of a slider [N/m].
  double damping = 0.0;                    ///< 2 ζ √m of its dashpots c = 2 ζ √(m k) [√kg].
  double least_depth = 0.0;                ///< The elastic laws are linear below it [m].
  int ball = -1;                           ///< Index of its ball or pad; −1: planar contact.
  bool beside = false;         ///< Transverse contact of a ball or pad; follows its first contact.
  bool turns_normal = true;    ///< Whether the normal rotates as the contact slides.
  bool slips_in_part = false;  ///< Has partial slip, see SlipAnnuli.

  // Memory.
  double normal_force = 0.0;      ///< λ_n [N]
  double friction_force = 0.0;    ///< λ_t [N], against the slide.
  double elastic_normal = 0.0;    ///< λ_n without the dashpot [N].
  double elastic_friction = 0.0;  ///< λ_t without the dashpot [N].
  double compliance = 0.0;        ///< Tangential, at `elastic_friction` [m/N]; 0: rigid or open.
  double clearance = 0.0;         ///< Free gap of its joint at the end of the last step [m].
  SlipAnnuli annuli;              ///< Partial slip; unused in a transverse contact.

  // Values of the current step.
  double gap = 0.0;  ///< At the middle, with the radii at the end [m].
  double clearance_after = 0.0;
  bool active = false;
  double opened = 0.0;  ///< Change of the gap from the middle to the end at zero end speed [m].
  double slid = 0.0;    ///< Slide of the step at zero end speed [m].
  // Components of a ball contact's directions along the joint's three force columns.
  Vector3d normal_shares = Vector3d::Zero();
  Vector3d tangential_shares = Vector3d::Zero();

  /// Columns and factors whose sum is a direction; −1: none.
  using Columns = std::array<std::pair<int, double>, 3>;
  Columns normal_columns() const { return columns(normal_column, normal_shares); }
  Columns tangential_columns() const { return columns(tangential_column, tangential_shares); }

  bool is_elastic() const { return hertz_stiffness < infinite || is_linear(); }
  /// Whether its normal force is proportional to its depth.
  bool is_linear() const { return normal_stiffness < infinite; }
  /// Whether it closes its gap without deflection.
  bool is_rigid() const { return normal_column >= 0 && !is_elastic(); }
  /// Whether it sticks without deflection.
  bool sticks_rigidly() const {
    return tangential_column >= 0 && friction_coefficient > 0.0 &&
           tangential_stiffness == infinite && mindlin_stiffness == infinite;
  }
  double depth(double force) const;
  double force_at(double depth) const;
  double slope_at(double depth) const;  ///< [N/m]

  /// Result of the normal law at the end of a step: normal force and its slope.
  struct Across {
    double elastic;  ///< Without the dashpot [N].
    double force;    ///< [N]; negative: tension, which the status excludes.
    double slope;    ///< −∂force/∂speed [N s/m]
    double share;    ///< Elastic fraction of the slope.
  };
  /// @param depth at the end of the step of length h [m]
  /// @param speed opening speed [m/s]
  Across across(double depth, double speed, double h) const;

  /// 1/k_t under an elastic normal force [m/N]; 0: rigid.
  double tangential_compliance(double normal) const;
  /// Friction of a sticking contact after a step of length h with slip rate u: f = (bend + h
  /// u)/compliance.
  struct Along {
    double compliance;  ///< [m/N], 1/(k_t + c_t/h); 0: rigid.
    double bend;        ///< Deflection by the retained friction of the last step [m].
  };
  /// Friction law of a sticking contact. An increase of the normal load keeps the friction force; a
  /// decrease keeps the deflection.
  /// @param normal elastic normal force [N]
  Along along(double normal, double h) const;
  /// Friction force of the contact's spring after a slide [N], bounded by `limit`.
  /// @param normal elastic normal force [N]
  double spring_friction(double normal, double slide, double limit) const;
  /// Loads of the partial-slip law.
  /// @param elastic elastic part of the normal force, without the dashpot [N]
  /// @param normal total normal force [N]
  /// @param share fraction of the normal force's slope that is elastic
  SlipAnnuli::Pressed pressed(double elastic, double normal, double share) const;
  /// Whether it sticks under these forces.
  bool sticks(double normal, double tangential) const;
  /// Energies stored by the normal and the tangential law [J].
  double normal_energy() const {
    return (is_linear() ? 0.5 : 0.4) * elastic_normal * depth(elastic_normal);
  }
  double tangential_energy() const {
    return slips_in_part ? annuli.energy : 0.5 * compliance * elastic_friction * elastic_friction;
  }

 private:
  int first_column = -1;  ///< First of the three columns of a ball.
  Columns columns(int column, const Vector3d& shares) const {
    if (column < 0 || ball < 0) return {{{column, 1.0}, {-1, 0.0}, {-1, 0.0}}};
    return {
        {{first_column, shares[0]}, {first_column + 1, shares[1]}, {first_column + 2, shares[2]}}};
  }
  friend class Contacts;
};

/// All contacts of a truss.
class Contacts {
 public:
  /// @pre The system must outlive this object.
  /// @param damping 2 ζ √m for the dashpots of every joint [√kg]; empty: no dashpots
  Contacts(const System& system, const VectorXd& damping);

  std::vector<Contact>& all() { return all_; }
  const std::vector<Contact>& all() const { return all_; }
  /// Columns of constraints between two nodes.
  const std::vector<int>& holds() const { return holds_; }
  /// Columns of constraints whose directions rotate with the nodes: of rigid arms, and across the
  /// axes of hinges.
  const std::vector<int>& turning_holds() const { return turning_holds_; }

  /// Statuses in which all joints are closed, for the evaluation of closures and directions. Only a
  /// joint whose journal is exactly in the middle stays open, because it has no normal.
  Statuses closed(const VectorXd& z, double time, const StepStart& start) const;
  /// Initial contact forces from a quasi-static state.
  /// @param start how the truss reached that state
  void begin(const State& state, StartFriction start);
  /// Forces of turning_holds() in a quasi-static state: those of rigid arms. Those of hinges, which
  /// are not output, are zero [N].
  VectorXd held_at_rest(const State& state) const;
  /// Computes the gaps at z and selects the active contacts of a step. The closures must be
  /// evaluated at the same displacements and time, with all joints closed and without forces.
  void measure(const VectorXd& z, double time, const StepStart& start, const VectorXd& closures,
               double rounding);
  /// Gap of a round contact at z, with the clearance at the end of the step [m].
  double gap_at(const Contact& contact, const VectorXd& z, double time,
                const StepStart& start) const;
  /// Stores the clearances from the last measure() as those at the end of a step.
  void remember_clearances();
  /// Copies the partial-slip memory of all contacts into the memory of the joints.
  void write_annuli(StepStart& to) const;

  std::vector<BallFriction>& balls() { return balls_; }
  /// Updates the directions of a ball's contacts.
  void direct(const BallFriction& cone);

  bool damped() const { return damped_; }
  /// Whether any contact has partial slip.
  bool slip_in_part() const { return slip_in_part_; }
  /// Whether any contact is rigid along its normal, or sticks rigidly.
  bool hold_rigidly() const { return hold_rigidly_; }
  /// Whether joints have forces on nodes besides contact forces.
  bool have_springs() const { return springs_ || !turning_holds_.empty(); }

  /// Writes statuses and elastic joint forces, whose energy the truss stores.
  void write(VectorXd& z, Statuses& statuses) const;
  /// The same forces including dashpots.
  VectorXd with_dashpots(VectorXd z) const;

 private:
  /// A contact of a joint that may have partial slip.
  template <class Joint>
  static Contact made(int joint, const Joint& of) {
    Contact contact;
    contact.joint = joint;
    contact.slips_in_part = of.partial_slip != 0;
    return contact;
  }
  void add(int joint, int first_column, const Slider& slider);
  void add(int joint, int first_column, const ClearanceRevolute& revolute);
  void add(int joint, int first_column, const BallJoint& socketed);
  void add(int joint, int first_column, const Pad& pad);
  void add(int joint, int first_column, const LatchHinge& hinge);
  void add(int joint, int first_column, const Hinge& hinge);
  void add(int joint, int first_column, const RigidArm& arm);
  /// Adds the friction of a hinge as a force on a lever of this radius, as in the rows of HingeLaw.
  template <class Type>
  void add_hinge(int joint, int first_column, const HingeLaw<Type>& hinge, double radius);
  /// One contact for every Jenkins element, all along one direction.
  void add(int joint, int first_column, const IwanJoint& iwan);
  /// Sets the forces of a pad to those of a quasi-static state.
  void begin_pad(Contact& contact, const State& state, StartFriction start);
  /// Friction in a quasi-static state of a contact whose normal force is given [N].
  double friction_at_rest(const Contact& contact, const State& state, StartFriction start) const;
  /// Deflection of a slider's contact in a quasi-static state [m], measured from the position of
  /// zero friction.
  double slide_at_rest(const Contact& contact, const State& state, StartFriction start) const;
  /// Adds a contact with dry friction of limit `bound` [N] in series with a spring of the given
  /// stiffness [N/m].
  Contact& add_friction(int joint, int column, double bound, double stiffness);
  /// Appends the contact of a ball or pad, and its transverse contact.
  void add_surface(Contact contact, int first_column, BallFriction friction);
  /// Friction vector of a ball or pad [N], from its two contacts. Dashpot forces are optional.
  Vector3d friction(const BallFriction& cone, bool with_dashpots) const;
  /// Writes the force of a ball or pad at z.
  void write(const BallFriction& cone, bool with_dashpots, VectorXd& z) const;
  /// Friction moment of a hinge in a quasi-static state [N m].
  template <class Type>
  double hinge_friction(const Contact& contact, const State& state, const Type& hinge) const;
  /// Rejects joints of a type that has no contacts in dynamics.
  /// @throws std::invalid_argument with the name of the type
  template <class Type>
  void add(int, int, const Type& other) {
    throw std::invalid_argument(std::string(Type::kind) + " '" + other.name +
                                "' is a joint of quasi-static paths only");
  }

  const System* system_;
  std::vector<Contact> all_;
  std::vector<BallFriction> balls_;
  std::vector<int> holds_;
  std::vector<int> turning_holds_;
  bool damped_ = false;
  bool slip_in_part_ = false;
  bool hold_rigidly_ = false;
  bool springs_ = false;
};

}  // namespace statejump::truss::detail
