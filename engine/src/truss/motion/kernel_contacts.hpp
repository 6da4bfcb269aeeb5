// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "slip_annuli.hpp"
#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/laws/joint_law.hpp"
#include "statejump/truss/path.hpp"
#include "truss/system.hpp"

namespace statejump::truss::detail {

/// One contact of a truss with the laws of a DEM, and what it remembers.
struct KernelContact {
  int joint = 0;
  int first_column = 0;  ///< Of the joint's forces.
  int first = 0;         ///< Node of the journal, ball or pad.
  int second = -1;       ///< Node of the bearing or socket; −1: the ground.
  int first_far = -1;    ///< Far end of the link that turns it; −1: it does not turn.
  int second_far = -1;   ///< Likewise.
  bool is_ball = false;
  Vector3d axis = Vector3d::UnitZ();       ///< Of a bearing, or along which a pad slides.
  kernel::ContactParameters parameters{};  ///< Of a pad without moduli: see `held`.
  double first_radius = 0.0;               ///< At ΔT = 0 [m].
  double second_radius = 0.0;              ///< Likewise.
  double first_expansion = 0.0;
  double second_expansion = 0.0;
  int program = 0;
  double temperature_fraction = 1.0;
  double pressed = 0.0;  ///< Of a pad, its bound of friction [N] …
  double held = 0.0;     ///< … and its k_t [N/m]; 0: it is not a pad.

  bool is_pad() const { return held > 0.0; }
  /// Of a pad with a play in series: a spring behind Coulomb's bound, whatever law others have.
  SlipAnnuli annuli;
  bool has_play() const { return annuli.play > 0.0; }
  SlipAnnuli::Pressed loads_annuli() const { return {held, 0.0, 1.0, pressed, 0.0}; }

  // Where the last step ended.
  kernel::ContactHistory history;
  Vector3d normal = Vector3d::UnitX();  ///< From the first part into the second.
  kernel::ContactResponse response{0.0, 0.0, 0.0, 0.0, Vector3d::Zero(), Vector3d::Zero(),
                                   0.0, 0.0, 0.0, 0.0};
  double clearance = 0.0;  ///< [m]
  double radius = 0.0;     ///< Effective [m].
};

/// Energies that contacts took in a step [J].
struct KernelHeat {
  VectorXd friction;  ///< Of every joint.
  double damping = 0.0;
  double thermal_work = 0.0;  ///< Of the expansion of their parts.
};

/// All contacts of a truss with laws of the kernel, which remember what was there at the end of the
/// last step. A slide within a step is an integral along the way, of two components and the turn of
/// both parts about the normal: three numbers a contact, which whoever steps them integrates with
/// the places.
class KernelContacts {
 public:
  /// The system must outlive it. @param damping 2 ζ √m of every joint [√kg]; empty: none
  /// @throws std::invalid_argument for a law that is not known, kernel::OutOfRange or
  /// std::invalid_argument with the name of a joint that has no such contact
  KernelContacts(const System& system, const VectorXd& damping, const std::string& friction_law);

  /// A truss on its way from the end of the last step.
  struct Stage {
    const VectorXd& q;
    const VectorXd& v;
    double time;          ///< [s]
    double since;         ///< Since the end of the last step [s], > 0.
    const VectorXd& way;  ///< Slides [m], [m] and turn [rad] of every contact since then.
  };
  Eigen::Index numbers() const { return 3 * static_cast<Eigen::Index>(all_.size()); }
  /// `Stage::way` that loads pads by the friction of a state at rest; contacts of round parts start
  /// without friction.
  VectorXd start_way(const State& start, StartFriction friction) const;
  /// Adds forces of all contacts [N]; leaves nothing behind. @param rates of `Stage::way`
  void respond(const Stage& stage, VectorXd& force, VectorXd& rates) const;
  /// The same at the end of a step, which the contacts take over. @param heat is added to
  void commit(const Stage& stage, VectorXd& force, VectorXd& rates, KernelHeat& heat);

  /// Forces as the truss' unknowns, and the status of every joint.
  void write(VectorXd& z, Statuses& statuses) const;
  /// Energy that all contacts store [J].
  double stored() const;
  /// Largest square of an angular frequency that a contact alone has on its nodes now [1/s²].
  double stiffest(const VectorXd& q, const VectorXd& inverse_mass) const;

 private:
  void add(int joint, int first_column, const Slider& slider, double damping);
  void add(int joint, int first_column, const ClearanceRevolute& revolute, double damping);
  void add(int joint, int first_column, const BallJoint& socketed, double damping);
  template <class Type>
  void add(int, int, const Type& other, double) {
    refuse(Type::kind, other.name, "has no contact of the kernel's");
  }
  [[noreturn]] static void refuse(const char* kind, const std::string& name, const char* why);
  /// Fills what round parts have in common. @param hertz, mindlin [N/m^1.5]
  static KernelContact round(const KernelContact& parts, double hertz, double mindlin,
                             double friction_coefficient, double damping, const JointFrame& frame);
  struct Place;
  /// @param history of the start of the step; out: of the stage
  kernel::ContactResponse answer(const KernelContact& contact, const Stage& stage,
                                 const double* way, kernel::ContactHistory& history,
                                 VectorXd& force, double* rates, Place& place) const;
  kernel::ContactResponse answer_with_play(const KernelContact& contact, const Stage& stage,
                                           double slide, VectorXd& force, double* rates) const;
  /// Takes a step over. @return heat of friction [J]
  static double take_play(KernelContact& contact, double slide);
  void push_soft_stops(const VectorXd& q, VectorXd& force) const;
  Vector3d at(int node, const VectorXd& free) const;
  void push(int node, const Vector3d& by, VectorXd& force) const;
  double mobility(int node, const VectorXd& inverse_mass) const;
  /// Pushes a part, and turns the link that carries it.
  void push(int node, int far, const Vector3d& by, const Vector3d& torque, const VectorXd& q,
            VectorXd& force) const;
  kernel::BodyMotion motion(int node, int far, const Stage& stage) const;

  const System* system_;
  kernel::laws::JointLaw law_;
  bool remembers_ = true;  ///< The law of friction is given slides, not velocities.
  std::vector<KernelContact> all_;
  std::vector<const Slider*> soft_stops_;  ///< Only their forces; the joint has their energy.
};

}  // namespace statejump::truss::detail
