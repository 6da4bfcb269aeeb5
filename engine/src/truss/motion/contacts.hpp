// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

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
  double least_depth = 0.0;                ///< Below which the elastic laws are taken as there [m].

  // Remembered from step to step.
  double normal_force = 0.0;    ///< λ_n [N]
  double friction_force = 0.0;  ///< λ_t [N], against the slide.
  double compliance = 0.0;      ///< Tangential, at `friction_force` [m/N]; 0: rigid or open.
  double clearance = 0.0;       ///< Free gap of its joint at the end of the last step [m].

  // Of the current step.
  double gap = 0.0;  ///< At the middle, radii of the end [m].
  double clearance_after = 0.0;
  bool active = false;

  bool is_elastic() const { return hertz_stiffness < infinite; }
  double depth(double force) const;
  double force_at(double depth) const;
  /// 1/k_t under a normal force [m/N]; 0: rigid.
  double tangential_compliance(double normal) const;
  /// Bend [m] that friction has kept of the last step, now that the compliance is another one:
  /// what loads a contact keeps the force, what unloads it the bend.
  double kept_bend(double compliance_now) const;
  /// Whether friction holds it at these impulses.
  bool sticks(double normal, double tangential) const;
  /// Stored across and along its surface [J].
  double normal_energy() const { return 0.4 * normal_force * depth(normal_force); }
  double tangential_energy() const { return 0.5 * compliance * friction_force * friction_force; }
};

/// All contacts of a truss.
class Contacts {
 public:
  /// The system must outlive it.
  explicit Contacts(const System& system);

  std::vector<Contact>& all() { return all_; }
  const std::vector<Contact>& all() const { return all_; }
  /// Columns that hold two nodes together.
  const std::vector<int>& holds() const { return holds_; }

  /// Statuses in which every joint has its closures and directions; open only where a journal is in
  /// the very middle of its bearing, where no normal is defined.
  Statuses closed(const VectorXd& z, double time, const StepStart& start) const;
  /// Forces of contacts as a quasi-static state has them.
  void begin(const State& state);
  /// Gaps at q, where the closures are those of an evaluation at the same q and time with all
  /// joints closed and free of force; chooses the active contacts of a step.
  void measure(const VectorXd& z, double time, const StepStart& start, const VectorXd& closures,
               double rounding);
  /// Takes what was measured as the end of a step.
  void remember_clearances();

  /// Forces of the joints and statuses that follow from the contacts' forces.
  void write(VectorXd& z, Statuses& statuses) const;

 private:
  void add(int joint, int first_column, const Slider& slider);
  void add(int joint, int first_column, const ClearanceRevolute& revolute);
  /// A type of joint whose contacts are not known here. @throws std::invalid_argument with its name
  template <class Type>
  void add(int, int, const Type& other) {
    throw std::invalid_argument(std::string(Type::kind) + " '" + other.name +
                                "' is a joint of quasi-static paths only");
  }

  const System* system_;
  std::vector<Contact> all_;
  std::vector<int> holds_;
};

}  // namespace statejump::truss::detail
