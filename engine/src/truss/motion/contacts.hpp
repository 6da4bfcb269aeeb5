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

/// One contact of a joint as a block of a local problem, with what it remembers. Directions are
/// columns of the joints' forces in the truss' Jacobian; a contact that lacks one has a row of its
/// own there that touches nothing else.
struct Contact {
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  int joint = 0;
  int normal_column = -1;      ///< −1: its normal force is given.
  double normal_sign = -1.0;   ///< The gap opens by this times the column times the velocity.
  int tangential_column = -1;  ///< −1: it does not rub.
  double friction_coefficient = 0.0;
  double given_force = 0.0;                ///< Normal force that is given [N].
  JointStatus stop = JointStatus::open;    ///< Of a slider's stop, which one; else open.
  double hertz_stiffness = infinite;       ///< K [N/m^1.5]
  double mindlin_stiffness = infinite;     ///< 8 G* √R [N/m^1.5]
  double tangential_stiffness = infinite;  ///< Of a slider [N/m].
  double damping = 0.0;                    ///< 2 ζ √m of its dashpots c = 2 ζ √(m k) [√kg].
  double least_depth = 0.0;                ///< Below which the elastic laws are taken as there [m].
  int ball = -1;                           ///< Of the truss' balls; −1: it is in a plane.
  bool beside = false;                     ///< Holds across the friction of the contact before it.
  bool slips_in_part = false;              ///< Partially: its annuli slip one after the other.

  // Remembered from step to step.
  double normal_force = 0.0;      ///< λ_n [N]
  double friction_force = 0.0;    ///< λ_t [N], against the slide.
  double elastic_normal = 0.0;    ///< λ_n without the dashpot [N].
  double elastic_friction = 0.0;  ///< λ_t without the dashpot [N].
  double compliance = 0.0;        ///< Tangential, at `elastic_friction` [m/N]; 0: rigid or open.
  double clearance = 0.0;         ///< Free gap of its joint at the end of the last step [m].
  SlipAnnuli annuli;              ///< Of one that slips in part, but of one beside another.

  // Of the current step.
  double gap = 0.0;  ///< At the middle, radii of the end [m].
  double clearance_after = 0.0;
  bool active = false;
  double opened = 0.0;  ///< What the gap at the end has beyond that of the middle at no speed [m].
  double slid = 0.0;    ///< Slide of the step that its speed at the end does not tell [m].
  // Of a ball, whose columns are forces along three fixed directions.
  Vector3d normal_shares = Vector3d::Zero();
  Vector3d tangential_shares = Vector3d::Zero();

  /// Columns whose sum is a direction, with their shares; −1: none.
  using Columns = std::array<std::pair<int, double>, 3>;
  Columns normal_columns() const { return columns(normal_column, normal_shares); }
  Columns tangential_columns() const { return columns(tangential_column, tangential_shares); }

  bool is_elastic() const { return hertz_stiffness < infinite; }
  /// Whether it keeps its gap closed without giving way.
  bool is_rigid() const { return normal_column >= 0 && !is_elastic(); }
  /// Whether it does not give way where it sticks.
  bool sticks_rigidly() const {
    return tangential_column >= 0 && friction_coefficient > 0.0 &&
           tangential_stiffness == infinite && mindlin_stiffness == infinite;
  }
  double depth(double force) const;
  double force_at(double depth) const;

  /// The law across the surface at the end of a step: force and its slope.
  struct Across {
    double elastic;  ///< Without the dashpot [N].
    double force;    ///< [N]; below 0 where the contact would pull, which it does not.
    double slope;    ///< −∂force/∂speed [N s/m]
    double share;    ///< Of the elastic force in it.
  };
  /// @param depth at the end of the step of length h [m]; @param speed at which it opens [m/s]
  Across across(double depth, double speed, double h) const;

  /// 1/k_t under an elastic normal force [m/N]; 0: rigid.
  double tangential_compliance(double normal) const;
  /// Friction that sticks over a step: f = (bend + h u)/compliance at the speed u of the slide.
  struct Along {
    double compliance;  ///< [m/N], 1/(k_t + c_t/h); 0: rigid.
    double bend;        ///< Of the force that is kept of the last step [m].
  };
  /// What loads a contact keeps the force, what unloads it the bend.
  /// @param normal elastic [N]
  Along along(double normal, double h) const;
  /// Friction of its spring after a slide of h u within a limit [N]. @param normal elastic [N]
  double spring_friction(double normal, double slide, double limit) const;
  /// The loads on the annuli of a contact that slips partially.
  /// @param elastic normal force without the dashpot [N]; @param normal force [N]
  /// @param share of its elastic part in the slope of the normal force
  SlipAnnuli::Pressed pressed(double elastic, double normal, double share) const;
  /// Whether friction holds it at these impulses.
  bool sticks(double normal, double tangential) const;
  /// Stored across and along its surface [J].
  double normal_energy() const { return 0.4 * elastic_normal * depth(elastic_normal); }
  double tangential_energy() const {
    return slips_in_part ? annuli.energy : 0.5 * compliance * elastic_friction * elastic_friction;
  }

 private:
  int first_column = -1;  ///< Of a ball's three.
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
  /// The system must outlive it.
  /// @param damping 2 ζ √m of the dashpots of every joint [√kg]; empty: none
  Contacts(const System& system, const VectorXd& damping);

  std::vector<Contact>& all() { return all_; }
  const std::vector<Contact>& all() const { return all_; }
  /// Columns that hold two nodes together.
  const std::vector<int>& holds() const { return holds_; }

  /// Statuses in which every joint has its closures and directions; open only where a journal is in
  /// the very middle of its bearing, where no normal is defined.
  Statuses closed(const VectorXd& z, double time, const StepStart& start) const;
  /// Forces of contacts as a quasi-static state has them. @param start how it was found
  void begin(const State& state, StartFriction start);
  /// Gaps at q, where the closures are those of an evaluation at the same q and time with all
  /// joints closed and free of force; chooses the active contacts of a step.
  void measure(const VectorXd& z, double time, const StepStart& start, const VectorXd& closures,
               double rounding);
  /// Gap of a round contact at z, the clearance being that of the end of a step [m].
  double gap_at(const Contact& contact, const VectorXd& z, double time,
                const StepStart& start) const;
  /// Takes what was measured as the end of a step.
  void remember_clearances();
  /// Writes what contacts that slip in part remember to where their joints do.
  void write_annuli(StepStart& to) const;

  std::vector<BallFriction>& balls() { return balls_; }
  /// Gives the contacts of a ball the directions that it has now.
  void direct(const BallFriction& cone);

  bool damped() const { return damped_; }
  /// Whether any of them does.
  bool slip_in_part() const { return slip_in_part_; }
  /// Whether any of them holds without giving way, across its surface or along.
  bool hold_rigidly() const { return hold_rigidly_; }
  /// Whether joints have forces on nodes besides their contacts'.
  bool have_springs() const { return springs_; }

  /// Elastic forces of the joints, of which the truss remembers and stores energy, and statuses.
  void write(VectorXd& z, Statuses& statuses) const;
  /// The same forces with those of the dashpots.
  VectorXd with_dashpots(VectorXd z) const;

 private:
  /// A contact of a joint, which tells whether it slips in part.
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
  void add(int joint, int first_column, const LatchHinge& hinge);
  /// One contact for every element, all along one direction.
  void add(int joint, int first_column, const IwanJoint& iwan);
  /// Friction that holds a joint of given normal force in a quasi-static state [N].
  double friction_at_rest(const Contact& contact, const State& state, StartFriction start) const;
  /// Slide of a slider since its friction carried nothing, in a quasi-static state [m].
  double slide_at_rest(const Contact& contact, const State& state, StartFriction start) const;
  /// Dry friction of a given bound [N] behind a spring [N/m].
  Contact& add_friction(int joint, int column, double bound, double stiffness);
  /// Friction of a ball as its contacts have it, with their dashpots or without [N].
  Vector3d friction(const BallFriction& cone, bool with_dashpots) const;
  /// Writes its force where the ball is at z.
  void write(const BallFriction& cone, bool with_dashpots, VectorXd& z) const;
  /// A type of joint whose contacts are not known here. @throws std::invalid_argument with its name
  template <class Type>
  void add(int, int, const Type& other) {
    throw std::invalid_argument(std::string(Type::kind) + " '" + other.name +
                                "' is a joint of quasi-static paths only");
  }

  const System* system_;
  std::vector<Contact> all_;
  std::vector<BallFriction> balls_;
  std::vector<int> holds_;
  bool damped_ = false;
  bool slip_in_part_ = false;
  bool hold_rigidly_ = false;
  bool springs_ = false;
};

}  // namespace statejump::truss::detail
