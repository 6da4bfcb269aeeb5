// SPDX-License-Identifier: GPL-3.0-or-later
// Hinges between two bodies at one position.
#pragma once

#include <vector>

#include "failure.hpp"
#include "registered.hpp"
#include "statejump/stepper/hinge_bond.hpp"

namespace statejump::dem {

struct HingeBond : Registered<HingeBond, yade::Serializable>, stepper::Torsion {
  static constexpr const char* class_name = "HingeBond";
  static constexpr const char* base_name = "Serializable";
  static constexpr const char* doc =
      "Hinge between two bodies at one position, where beams end. The bodies move together and "
      "rotate against each other about the axis only. With the angle s of body 2 against body 1, "
      "less freeAngle, the moment M = M0 + K_M (s - clamp(s; -a, a)) + M_f acts on body 1 about "
      "the axis, its opposite on body 2; friction sticks as a spring, M_f = k_f (s - s_f), and "
      "slips at |M_f| = M_c. A body is part of one hinge at most.";
  int id1 = -1;
  int id2 = -1;

  void check() const;
  static auto attributes() {
    return std::make_tuple(
        attribute("id1", &HingeBond::id1, "First body; the axis rotates with it [-]"),
        attribute("id2", &HingeBond::id2, "Second body [-]"),
        attribute("axis", &HingeBond::axis,
                  "Axis where both bodies have the orientation 1, unit vector [-]"),
        attribute("stiffness", &HingeBond::stiffness, "Torsion stiffness K_M [N m/rad]"),
        attribute("freeAngle", &HingeBond::freeAngle, "Angle without moment [rad]"),
        attribute("deadband", &HingeBond::deadband,
                  "Free play a to either side of the free angle [rad]"),
        attribute("preload", &HingeBond::preload, "Moment M0 within the free play [N m]"),
        attribute("frictionLimit", &HingeBond::frictionLimit,
                  "Moment M_c at which friction slips; 0: no friction [N m]"),
        attribute("frictionStiffness", &HingeBond::frictionStiffness,
                  "Stiffness k_f of friction that sticks, above 0 where friction has a limit "
                  "[N m/rad]"),
        attribute("slipAngle", &HingeBond::slipAngle,
                  "Angle s_f at which friction has no moment; moves where friction slips [rad]"),
        attribute("frictionMoment", &HingeBond::frictionMoment,
                  "Moment M_f of friction in the last step, part of the moment [N m]"),
        read_only("angle", &HingeBond::angle, "Angle of the last step [rad]"),
        read_only("moment", &HingeBond::moment, "Moment M of the last step [N m]"));
  }
};

struct HingeBonds : Registered<HingeBonds, yade::GlobalEngine>, RaisesFailures {
  static constexpr const char* class_name = "HingeBonds";
  static constexpr const char* base_name = "GlobalEngine";
  static constexpr const char* doc =
      "Holds the bodies of HingeBond objects together. Place it after all engines that apply "
      "forces "
      "and before the StateRecorder and the NewtonIntegrator: it distributes the forces of the "
      "step over both bodies. The bodies need equal moments of inertia about all axes. Entries in "
      "O.energy: torsionElastic and torsionFriction, as of torsion springs.";
  std::vector<yade::shared_ptr<HingeBond>> hinges;

  void action() override;
  static auto attributes() {
    return std::make_tuple(
        attribute("hinges", &HingeBonds::hinges, "List of HingeBond objects"));
  }

 private:
  void act(HingeBond& hinge, stepper::HingeBody& one, stepper::HingeBody& two);
  int elastic_id_ = -1;
  int friction_id_ = -1;
  std::vector<stepper::HingeBody> bodies_;
};

}  // namespace statejump::dem
