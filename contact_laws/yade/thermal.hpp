// SPDX-License-Identifier: GPL-3.0-or-later
// Temperature programs, the engine that applies them to shapes, and thermally expanding links.
#pragma once

#include <optional>
#include <vector>

#include "failure.hpp"
#include "registered.hpp"
#include "shapes.hpp"
#include "statejump/stepper/link.hpp"
#include "statejump/thermal/program.hpp"

namespace statejump::dem {

struct ThermalProgram : Registered<ThermalProgram, yade::Serializable> {
  static constexpr const char* class_name = "ThermalProgram";
  static constexpr const char* base_name = "Serializable";
  static constexpr const char* doc =
      "Temperature change against time: total change from the reference temperature, never an "
      "increment. After the last cycle the value stays. Immutable: construct another one to change "
      "it.";
  std::string shape = "triangle";
  Real temperatureChangeMax = 0;
  Real period = 1;
  int cycles = 1;
  std::vector<Real> tableTimes;
  std::vector<Real> tableTemperatureChanges;

  void check();
  const thermal::Program& program() const;
  Real temperature_change(Real time) const { return program().temperature_change(time); }
  Real temperature_rate(Real time) const { return program().temperature_rate(time); }

  static auto attributes() {
    return std::make_tuple(
        read_only("shape", &ThermalProgram::shape,
                  "'triangle' (0, max, 0), 'half_sine' (0, max, 0), 'sine' (0, max, 0, -max, 0) or "
                  "'table' [-]"),
        read_only("temperatureChangeMax", &ThermalProgram::temperatureChangeMax,
                  "Largest temperature change of the closed shapes [K]"),
        read_only("period", &ThermalProgram::period, "Duration of one cycle [s]"),
        read_only("cycles", &ThermalProgram::cycles, "Number of cycles [-]"),
        read_only("tableTimes", &ThermalProgram::tableTimes,
                  "Times of a table, from 0 to the period, rising [s]"),
        read_only("tableTemperatureChanges", &ThermalProgram::tableTemperatureChanges,
                  "Temperature changes of a table, linear in between [K]"));
  }
  template <class PythonClass>
  static void register_methods(PythonClass& entry) {
    entry.def("temperatureChange", &ThermalProgram::temperature_change, boost::python::arg("time"),
              "Total temperature change at the given time [K]");
  }

 private:
  std::optional<thermal::Program> program_;  // built by check()
};

struct ThermalExpansionEngine : Registered<ThermalExpansionEngine, yade::GlobalEngine>,
                                RaisesFailures {
  static constexpr const char* class_name = "ThermalExpansionEngine";
  static constexpr const char* base_name = "GlobalEngine";
  static constexpr const char* doc =
      "Sets the thermal strain of bodies with a ThermalShape to alpha times the total temperature "
      "change at the current time, alpha from each body's ThermalFrictMat. Place it before the "
      "InteractionLoop. It also raises errors that contacts met in the last step.";
  yade::shared_ptr<ThermalProgram> program;
  std::vector<int> ids;
  Real temperatureChange = 0;

  // A body and its shape when the targets were collected. They are compared before use, to detect
  // that a script erased the body or changed its shape. The pointers are plain, because Python
  // objects may only be released under the GIL, which a running simulation does not hold.
  struct Target {
    std::size_t id;
    ThermalShape* shape;
    const ThermalFrictMat* material;
    bool is_shared;  // an earlier body has the same shape; the material of that body applies
  };
  // Targets, collected again if the scene has changed.
  const std::vector<Target>& targets();

  void action() override;
  static auto attributes() {
    return std::make_tuple(
        attribute("program", &ThermalExpansionEngine::program,
                  "Temperature program of these bodies"),
        attribute("ids", &ThermalExpansionEngine::ids,
                  "Bodies it acts on; empty: all with a ThermalShape and a ThermalFrictMat [-]"),
        read_only("temperatureChange", &ThermalExpansionEngine::temperatureChange,
                  "Temperature change of the last step [K]"));
  }

 private:
  void collect_targets();
  bool collected() const;
  std::vector<Target> targets_;
  std::vector<int> collected_ids_;
  std::size_t number_of_bodies_ = 0;
};

struct ThermalLink : Registered<ThermalLink, yade::Serializable>, stepper::Link {
  static constexpr const char* class_name = "ThermalLink";
  static constexpr const char* base_name = "Serializable";
  static constexpr const char* doc =
      "Straight link between the centres of two bodies: an axial spring k_T = E A / l_T about the "
      "stress-free length l_T = l0 (1 + alpha dT), rigid in bending. A uniform rod of mass m "
      "pinned "
      "at a fixed point is exactly this spring with m/3 at its tip.";
  yade::shared_ptr<ThermalProgram> program;

  void check() const;
  static auto attributes() {
    return std::make_tuple(
        attribute("id1", &ThermalLink::id1, "Body at the root [-]"),
        attribute("id2", &ThermalLink::id2, "Body at the tip [-]"),
        attribute("youngModulus", &ThermalLink::youngModulus, "Young's modulus E [Pa]"),
        attribute("crossSectionArea", &ThermalLink::crossSectionArea, "Cross-section area A [m2]"),
        attribute("stressFreeLength", &ThermalLink::stressFreeLength,
                  "Stress-free length l0 at the reference temperature [m]"),
        attribute("thermalExpansion", &ThermalLink::thermalExpansion,
                  "Coefficient of linear thermal expansion alpha [1/K]"),
        attribute("dampingRatio", &ThermalLink::dampingRatio,
                  "Ratio of the viscous axial damping to the critical one [-]"),
        attribute("pinDamping", &ThermalLink::pinDamping,
                  "Viscous damping c_p of the pin at the root: moment -c_p times the angular "
                  "velocity of the link, as a couple of forces on its two ends [N m s/rad]"),
        attribute("tipTurnsWithLink", &ThermalLink::tipTurnsWithLink,
                  "Whether the tip body is fixed to the link: it turns with it, and a moment on it "
                  "becomes a couple of forces on the two ends. Its rotations must be blocked "
                  "(blockedDOFs containing XYZ). Torsion about the link's axis is held by the "
                  "root. [-]"),
        attribute("tensionOnly", &ThermalLink::tensionOnly,
                  "Whether the link is a cable: it goes slack where it is shorter than its "
                  "stress-free length, and never pushes [-]"),
        attribute("program", &ThermalLink::program, "Temperature program of the link"),
        read_only("axialForce", &ThermalLink::axialForce,
                  "Axial force of the last step, compression positive [N]"),
        read_only("temperatureChange", &ThermalLink::temperatureChange,
                  "Temperature change of the last step [K]"),
        read_only("previousTension", &ThermalLink::previousTension,
                  "Tension of the last step [N], kept for the energy account"),
        read_only("previousExtension", &ThermalLink::previousExtension,
                  "Elastic extension of the last step [m], kept for the energy account"),
        read_only("previousStressFreeLength", &ThermalLink::previousStressFreeLength,
                  "Stress-free length of the last step [m], kept for its rate and for the energy "
                  "account; 0 before the first"),
        read_only("previousTime", &ThermalLink::previousTime,
                  "Time of the last step [s], kept for the rate of the stress-free length"),
        read_only("tipDirection", &ThermalLink::tipDirection,
                  "Direction of the link in the axes of the tip body [-]; zero before the first "
                  "step"));
  }
};

// The two ends of a link at their current positions.
struct LinkEnds {
  yade::State& root;
  yade::State& tip;
  stepper::Span span;
  Real inverse_mass() const;  // 1/m1 + 1/m2 [1/kg]
};
LinkEnds ends_of(const yade::Scene& scene, const ThermalLink& link);
yade::Body& body_of(const yade::Scene& scene, int id, const char* who);

struct ThermalLinks : Registered<ThermalLinks, yade::GlobalEngine>, RaisesFailures {
  static constexpr const char* class_name = "ThermalLinks";
  static constexpr const char* base_name = "GlobalEngine";
  static constexpr const char* doc =
      "Applies the forces of ThermalLink objects. Place it after the InteractionLoop (it passes on "
      "the contact moments of the step) and before the NewtonIntegrator. Entries in O.energy: "
      "linkElastic, linkDamping, pinDamping, linkThermalWork.";
  std::vector<yade::shared_ptr<ThermalLink>> links;

  void action() override;
  static auto attributes() {
    return std::make_tuple(attribute("links", &ThermalLinks::links, "List of ThermalLink objects"));
  }

 private:
  // @param moment moment of the contacts on the tip [N m]; zero unless the tip rotates with the
  //     link
  void act(ThermalLink& link, const Vector3r& moment);
  std::vector<Vector3r> moments_;
  std::array<int, 4> energy_ids_ = {-1, -1, -1, -1};
};

}  // namespace statejump::dem
