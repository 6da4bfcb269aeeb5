// SPDX-License-Identifier: GPL-3.0-or-later
// Sliders between two bodies.
#pragma once

#include <array>
#include <vector>

#include "failure.hpp"
#include "registered.hpp"
#include "statejump/stepper/prismatic.hpp"

namespace statejump::dem {

struct PrismaticJoint : Registered<PrismaticJoint, yade::Serializable>, stepper::Prismatic {
  static constexpr const char* class_name = "PrismaticJoint";
  static constexpr const char* base_name = "Serializable";
  static constexpr const char* doc =
      "Slider between two bodies: body 1 slides against body 2 along an axis fixed in space and is "
      "held across it. With the slide s = (x1 - x2 - offset) . axis the force on body 1 against "
      "the axis is dry friction, a spring F = k_t (s - s_f) that slips at |F| = f and is slack in "
      "a play about s_f, and where s is beyond a clearance by d a stop, Hertz's K d^1.5 and a "
      "spring k_s d; across the axis a spring k_n. Forces act at the centres and do not turn the "
      "bodies.";

  void check() const;
  static auto attributes() {
    return std::make_tuple(
        attribute("id1", &PrismaticJoint::id1, "Body that slides [-]"),
        attribute("id2", &PrismaticJoint::id2, "Body on which it slides [-]"),
        attribute("axis", &PrismaticJoint::axis, "Axis, fixed in space, unit vector [-]"),
        attribute("offset", &PrismaticJoint::offset,
                  "Position of body 1 less that of body 2 where the slide is 0 [m]"),
        attribute(
            "stiffnessAcross", &PrismaticJoint::stiffnessAcross,
            "Stiffness k_n that holds the bodies together across the axis; 0: they are not [N/m]"),
        attribute("frictionLimit", &PrismaticJoint::frictionLimit,
                  "Force f at which friction slips; 0: no friction [N]"),
        attribute("frictionStiffness", &PrismaticJoint::frictionStiffness,
                  "Stiffness k_t of friction that sticks, above 0 where friction has a limit "
                  "[N/m]"),
        attribute("clearanceMinus", &PrismaticJoint::clearanceMinus,
                  "Slide against the axis up to a stop; infinity: no stop [m]"),
        attribute("clearancePlus", &PrismaticJoint::clearancePlus,
                  "Slide along the axis up to a stop; infinity: no stop [m]"),
        attribute("stopStiffness", &PrismaticJoint::stopStiffness,
                  "K of Hertz's contact at the stops; this or stopSpring is above 0 where there "
                  "are any [N/m^1.5]"),
        attribute("stopSpring", &PrismaticJoint::stopSpring,
                  "Stiffness k_s of linear stops, beside Hertz's contact [N/m]"),
        attribute("play", &PrismaticJoint::play,
                  "Width of the play in series with friction; it moves where friction slips [m]"),
        attribute("dampingRatio", &PrismaticJoint::dampingRatio,
                  "Ratio of the viscous damping of each spring to the critical one [-]"),
        attribute("slipPosition", &PrismaticJoint::slipPosition,
                  "Slide s_f at which friction has no force; moves where friction slips [m]"),
        attribute("frictionForce", &PrismaticJoint::frictionForce,
                  "Friction on body 1 against the axis in the last step, without its dashpot [N]"),
        read_only("slide", &PrismaticJoint::slide, "Slide s of the last step [m]"),
        read_only("stopForce", &PrismaticJoint::stopForce,
                  "Force of the stops on body 1 against the axis in the last step [N]"));
  }
};

struct PrismaticJoints : Registered<PrismaticJoints, yade::GlobalEngine>, RaisesFailures {
  static constexpr const char* class_name = "PrismaticJoints";
  static constexpr const char* base_name = "GlobalEngine";
  static constexpr const char* doc =
      "Applies the forces of PrismaticJoint objects. Place it after the InteractionLoop and before "
      "the NewtonIntegrator. Entries in O.energy: prismaticElastic, prismaticFriction, "
      "prismaticDamping.";
  std::vector<yade::shared_ptr<PrismaticJoint>> joints;

  void action() override;
  static auto attributes() {
    return std::make_tuple(
        attribute("joints", &PrismaticJoints::joints, "List of PrismaticJoint objects"));
  }

 private:
  void act(PrismaticJoint& joint);
  std::array<int, 3> energy_ids_ = {-1, -1, -1};
};

}  // namespace statejump::dem
