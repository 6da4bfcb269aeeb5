// SPDX-License-Identifier: GPL-3.0-or-later
// Torsion springs between the two links of a joint.
#pragma once

#include <vector>

#include "failure.hpp"
#include "registered.hpp"
#include "thermal.hpp"

namespace statejump::dem {

struct TorsionSpring : Registered<TorsionSpring, yade::Serializable>, stepper::Torsion {
  static constexpr const char* class_name = "TorsionSpring";
  static constexpr const char* base_name = "Serializable";
  static constexpr const char* doc =
      "Torsion spring between two links that share a joint, in the plane across its axis. Its "
      "flare "
      "angle alpha is the angle from the direction of link1 (root to tip) to that of link2, "
      "anticlockwise "
      "about the axis, in (-pi, pi]. The moment M = K_M (alpha - alpha0) (equation 17 of Chen et "
      "al. "
      "2021) acts on link1, its opposite on link2. With the stretch s = alpha - alpha0, "
      "a deadband "
      "a, a preload M0 and dry friction it is M = M0 + K_M (s - clamp(s; -a, a)) + M_f, where "
      "friction "
      "sticks as a spring, M_f = k_f (s - s_f), and slips at |M_f| = M_c.";
  yade::shared_ptr<ThermalLink> link1;
  yade::shared_ptr<ThermalLink> link2;

  void check() const;
  static auto attributes() {
    return std::make_tuple(
        attribute("link1", &TorsionSpring::link1, "ThermalLink that takes the moment +M"),
        attribute("link2", &TorsionSpring::link2, "ThermalLink that takes the moment -M"),
        attribute("stiffness", &TorsionSpring::stiffness, "Torsion stiffness K_M [N m/rad]"),
        attribute("freeAngle", &TorsionSpring::freeAngle,
                  "Flare angle alpha0 without moment, in (-pi, pi] [rad]"),
        attribute("axis", &TorsionSpring::axis,
                  "Axis about which angles are anticlockwise, fixed in space, unit vector [-]"),
        attribute("deadband", &TorsionSpring::deadband,
                  "Free play a to either side of the free angle [rad]"),
        attribute("preload", &TorsionSpring::preload, "Moment M0 within the free play [N m]"),
        attribute("frictionLimit", &TorsionSpring::frictionLimit,
                  "Moment M_c at which friction slips; 0: no friction [N m]"),
        attribute("frictionStiffness", &TorsionSpring::frictionStiffness,
                  "Stiffness k_f of friction that sticks, above 0 where friction has a limit "
                  "[N m/rad]"),
        attribute("slipAngle", &TorsionSpring::slipAngle,
                  "Stretch s_f at which friction has no moment; moves where friction slips [rad]"),
        attribute("frictionMoment", &TorsionSpring::frictionMoment,
                  "Moment M_f of friction in the last step, part of the moment [N m]"),
        read_only("angle", &TorsionSpring::angle, "Flare angle alpha of the last step [rad]"),
        read_only("moment", &TorsionSpring::moment, "Moment M of the last step [N m]"));
  }
};

struct TorsionSprings : Registered<TorsionSprings, yade::GlobalEngine>, RaisesFailures {
  static constexpr const char* class_name = "TorsionSprings";
  static constexpr const char* base_name = "GlobalEngine";
  static constexpr const char* doc =
      "Applies the moments of TorsionSpring objects, each as a couple of forces across its two "
      "links. Place it after the InteractionLoop and before the NewtonIntegrator. Entries in "
      "O.energy: torsionElastic, and torsionFriction where friction has a limit.";
  std::vector<yade::shared_ptr<TorsionSpring>> springs;

  void action() override;
  static auto attributes() {
    return std::make_tuple(
        attribute("springs", &TorsionSprings::springs, "List of TorsionSpring objects"));
  }

 private:
  void act(TorsionSpring& spring);
  int elastic_id_ = -1;
  int friction_id_ = -1;
};

}  // namespace statejump::dem
