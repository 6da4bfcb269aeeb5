// SPDX-License-Identifier: GPL-3.0-or-later
// Beams between two bodies.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "failure.hpp"
#include "registered.hpp"
#include "statejump/stepper/beam_bond.hpp"
#include "thermal.hpp"

namespace statejump::dem {

struct BeamBond : Registered<BeamBond, yade::Serializable>, stepper::BeamBond {
  static constexpr const char* class_name = "BeamBond";
  static constexpr const char* base_name = "Serializable";
  static constexpr const char* doc =
      "Straight beam between two bodies that it stretches, bends, twists and rotates: the "
      "corotational beam of the truss solver, with stiffnesses over the stress-free length "
      "l_T = l0 (1 + alpha dT) and a stress-free curvature of the gradients over its section. "
      "Forces "
      "and moments act at the bodies. In the reference configuration both bodies have the "
      "orientation 1. Give a body equal moments of inertia about all axes: YADE integrates others "
      "without gyroscopic moments.";
  yade::shared_ptr<ThermalProgram> program;
  yade::shared_ptr<ThermalProgram> gradientProgram;

  void check();
  // The beam, placed in the first step. @param along vector between the ends [m]
  const kernel::PlacedBeam& beam(const yade::State& one, const Vector3r& along);
  static auto attributes() {
    return std::make_tuple(
        attribute("id1", &BeamBond::id1, "Body at the first end [-]"),
        attribute("id2", &BeamBond::id2, "Body at the second end [-]"),
        attribute("axialStiffness", &BeamBond::axialStiffness, "E A [N]"),
        attribute("torsionalStiffness", &BeamBond::torsionalStiffness, "G J [N m2]"),
        attribute("bendingStiffnessY", &BeamBond::bendingStiffnessY,
                  "E I about axis y of the section [N m2]"),
        attribute("bendingStiffnessZ", &BeamBond::bendingStiffnessZ,
                  "E I about axis z of the section [N m2]"),
        attribute("shearStiffnessY", &BeamBond::shearStiffnessY,
                  "k G A for shear forces along y; infinity: no shear deformation [N]"),
        attribute("shearStiffnessZ", &BeamBond::shearStiffnessZ,
                  "k G A for shear forces along z; infinity: no shear deformation [N]"),
        attribute("stressFreeLength", &BeamBond::stressFreeLength,
                  "Stress-free length l0 at the reference temperature [m]"),
        attribute("thermalExpansion", &BeamBond::thermalExpansion,
                  "Coefficient of linear thermal expansion alpha [1/K]"),
        attribute("gradientY", &BeamBond::gradientY,
                  "Temperature gradient along y, over the temperature change of gradientProgram "
                  "[1/m]"),
        attribute("gradientZ", &BeamBond::gradientZ, "The same along z [1/m]"),
        attribute("dampingRatio", &BeamBond::dampingRatio,
                  "Ratio of the viscous damping of stretch, bending and twist to the critical one "
                  "[-]"),
        attribute("axisX", &BeamBond::axisX,
                  "Direction from the first end to the second in the reference configuration, unit "
                  "vector; zero: set in the first step from the positions [-]"),
        attribute("axisY", &BeamBond::axisY,
                  "Axis y of the section in the reference configuration, across the beam, unit "
                  "vector [-]"),
        attribute("offset1", &BeamBond::offset1,
                  "From the centre of body 1 to the first end in the reference configuration; it "
                  "rotates with the body [m]"),
        attribute("offset2", &BeamBond::offset2, "The same of body 2 [m]"),
        attribute("released1", &BeamBond::released1,
                  "What the first end does not transmit, letters of 'xXYZ': axial force, moments "
                  "about axes x, y and z of the section [-]"),
        attribute("released2", &BeamBond::released2, "The same of the second end [-]"),
        attribute("program", &BeamBond::program, "Temperature program of the mean"),
        attribute("gradientProgram", &BeamBond::gradientProgram,
                  "Temperature program of the gradients; None: no gradients"),
        read_only("temperatureChange", &BeamBond::temperatureChange,
                  "Mean temperature change of the last step [K]"),
        read_only("gradientTemperatureChange", &BeamBond::gradientTemperatureChange,
                  "Temperature change of gradientProgram in the last step [K]"),
        read_only("force1", &BeamBond::force1,
                  "Section force at the first end in the last step along x, y, z of the section, "
                  "tension positive [N]"),
        read_only("moment1", &BeamBond::moment1,
                  "Section moment at the first end in the last step about x, y, z [N m]"),
        read_only("force2", &BeamBond::force2, "Section force at the second end [N]"),
        read_only("moment2", &BeamBond::moment2, "Section moment at the second end [N m]"),
        read_only("previousStressFreeLength", &BeamBond::previousStressFreeLength,
                  "Stress-free length of the last step [m]; 0 before the first"),
        read_only("previousLengthDerivative", &BeamBond::previousLengthDerivative,
                  "Derivative of the energy by the stress-free length in the last step [N], kept "
                  "for the energy account"),
        read_only("previousCurvature", &BeamBond::previousCurvature,
                  "Stress-free curvature of the last step [1/m]"),
        read_only("previousCurvatureMoment", &BeamBond::previousCurvatureMoment,
                  "Derivative of the energy by the stress-free curvature in the last step [N m]"),
        read_only("previousTime", &BeamBond::previousTime, "Time of the last step [s]"));
  }

 private:
  std::optional<kernel::PlacedBeam> placed_;  // discarded by check()
};

// Mobility of a body: the smallest moment of inertia counts for all axes.
stepper::Mobility mobility_of(const yade::State& state);

struct BeamBonds : Registered<BeamBonds, yade::GlobalEngine>, RaisesFailures {
  static constexpr const char* class_name = "BeamBonds";
  static constexpr const char* base_name = "GlobalEngine";
  static constexpr const char* doc =
      "Applies the forces and moments of BeamBond objects. Place it after the InteractionLoop and "
      "before the NewtonIntegrator. A body at a bond must not be the tip of a ThermalLink that "
      "turns "
      "it. Entries in O.energy: beamElastic, beamDamping, beamThermalWork.";
  std::vector<yade::shared_ptr<BeamBond>> bonds;

  void action() override;
  static auto attributes() {
    return std::make_tuple(attribute("bonds", &BeamBonds::bonds, "List of BeamBond objects"));
  }

 private:
  void act(BeamBond& bond);
  std::array<int, 3> energy_ids_ = {-1, -1, -1};
};

}  // namespace statejump::dem
