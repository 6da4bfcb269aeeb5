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

/// One contact of a truss with laws of the kernel, and its memory.
struct KernelContact {
  int joint = 0;
  int first_column = 0;  ///< First column of the joint's forces.
  int first = 0;         ///< Node of the journal, ball or pad.
  int second = -1;       ///< Node of the bearing or socket; −1: the ground.
  int first_far = -1;    ///< Far end of the link that rotates it; −1: no rotation.
  int second_far = -1;   ///< Likewise for the second node.
  bool is_ball = false;
  Vector3d axis = Vector3d::UnitZ();       ///< Axis of a bearing, or slide direction of a pad.
  kernel::ContactParameters parameters{};  ///< A pad has no moduli, see `held`.
  double first_radius = 0.0;               ///< At ΔT = 0 [m].
  double second_radius = 0.0;              ///< Likewise.
  double first_expansion = 0.0;
  double second_expansion = 0.0;
  int program = 0;
  double temperature_fraction = 1.0;
  double pressed = 0.0;  ///< Friction limit of a pad [N].
  double held = 0.0;     ///< k_t of a pad [N/m]; 0: no pad.

  bool is_pad() const { return held > 0.0; }
  /// Law of a pad with play: a spring with Coulomb's limit, whatever the friction law of other
  /// contacts.
  SlipAnnuli annuli;
  bool has_play() const { return annuli.play > 0.0; }
  SlipAnnuli::Pressed loads_annuli() const { return {held, 0.0, 1.0, pressed, 0.0}; }

  // State at the end of the last step.
  kernel::ContactHistory history;
  Vector3d normal = Vector3d::UnitX();  ///< From the first part into the second.
  kernel::ContactResponse response{0.0, 0.0, 0.0, 0.0, Vector3d::Zero(), Vector3d::Zero(),
                                   0.0, 0.0, 0.0, 0.0};
  double clearance = 0.0;  ///< [m]
  double radius = 0.0;     ///< Effective radius [m].
};

/// Energies of contacts in a step [J].
struct KernelHeat {
  VectorXd friction;  ///< Of every joint.
  double damping = 0.0;
  double thermal_work = 0.0;  ///< By the expansion of their parts.
};

/// All contacts of a truss with laws of the kernel, with their memory at the end of the last step.
/// Each contact has three integrals along the path of a step: two components of its slide, and the
/// rotation of both parts about the normal. The caller integrates these three numbers together with
/// the positions.
class KernelContacts {
 public:
  /// @pre The system must outlive this object.
  /// @param damping 2 ζ √m for the dashpots of every joint [√kg]; empty: no dashpots
  /// @throws std::invalid_argument for an unknown law; kernel::OutOfRange or std::invalid_argument
  /// with the name of a joint without such a contact
  KernelContacts(const System& system, const VectorXd& damping, const std::string& friction_law);

  /// State of the truss in a stage after the last step.
  struct Stage {
    const VectorXd& q;
    const VectorXd& v;
    double time;   ///< [s]
    double since;  ///< Since the end of the last step [s], > 0.
    /// Slide components [m], [m] and rotation about the normal [rad] of every contact since the
    /// last step.
    const VectorXd& way;
  };
  Eigen::Index numbers() const { return 3 * static_cast<Eigen::Index>(all_.size()); }
  /// Value of `Stage::way` at which pads have the friction of the quasi-static state `start`.
  /// Contacts of round parts start without friction.
  VectorXd start_way(const State& start, StartFriction friction) const;
  /// Adds forces of all contacts [N] without changing their memory.
  /// @param rates receives the rates of `Stage::way`
  void respond(const Stage& stage, VectorXd& force, VectorXd& rates) const;
  /// Adds the forces like respond(), at the end of a step, and updates the memory of the contacts.
  /// @param heat the heat of the step is added to it
  void commit(const Stage& stage, VectorXd& force, VectorXd& rates, KernelHeat& heat);

  /// Writes the contact forces into the unknowns z of the truss, and the status of every joint.
  void write(VectorXd& z, Statuses& statuses) const;
  /// Energy stored by all contacts [J].
  double stored() const;
  /// Largest squared angular frequency [1/s²] of any single contact that vibrates with the masses
  /// of its nodes.
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
  /// Sets the common values of round parts.
  /// @param hertz, mindlin [N/m^1.5]
  static KernelContact round(const KernelContact& parts, double hertz, double mindlin,
                             double friction_coefficient, double damping, const JointFrame& frame);
  struct Place;
  /// @param history on input at the start of the step, on output in the stage
  kernel::ContactResponse answer(const KernelContact& contact, const Stage& stage,
                                 const double* way, kernel::ContactHistory& history,
                                 VectorXd& force, double* rates, Place& place) const;
  kernel::ContactResponse answer_with_play(const KernelContact& contact, const Stage& stage,
                                           double slide, VectorXd& force, double* rates) const;
  /// Commits a step of a play.
  /// @return heat of friction [J]
  static double take_play(KernelContact& contact, double slide);
  void push_soft_stops(const VectorXd& q, VectorXd& force) const;
  Vector3d at(int node, const VectorXd& free) const;
  void push(int node, const Vector3d& by, VectorXd& force) const;
  double mobility(int node, const VectorXd& inverse_mass) const;
  /// Adds a force on a part, and a torque on the link that rotates it.
  void push(int node, int far, const Vector3d& by, const Vector3d& torque, const VectorXd& q,
            VectorXd& force) const;
  kernel::BodyMotion motion(int node, int far, const Stage& stage) const;

  const System* system_;
  kernel::laws::JointLaw law_;
  bool remembers_ = true;  ///< Whether the friction law has memory and receives integrated slides.
  std::vector<KernelContact> all_;
  std::vector<const Slider*> soft_stops_;  ///< Forces only; the joint has their energy.
};

}  // namespace statejump::truss::detail
