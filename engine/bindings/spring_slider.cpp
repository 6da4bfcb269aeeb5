// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/spring_slider/model.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <limits>
#include <optional>
#include <string>

#include "bindings.hpp"
#include "statejump/kernel/require.hpp"
#include "statejump/spring_slider/history.hpp"
#include "statejump/spring_slider/path.hpp"

namespace py = pybind11;

namespace statejump::bindings {

namespace {

py::class_<spring_slider::SpringSlider> bind_model_fields(py::module_& module) {
  constexpr double no_stop = std::numeric_limits<double>::infinity();
  return py::class_<spring_slider::SpringSlider>(
             module, "SpringSlider",
             "A heated link that pushes a block with dry friction between two stops (paper, "
             "section "
             "3).\n\n"
             "Axial force F = k_T (x_T - x), positive in compression, k_T = E A/l_T,\n"
             "l_T = l0 (1 + alpha dT), x_T = l_T - l0. Quasi-static and rate-independent.\n"
             "Clearances are the distances to the stops, > 0, or infinity for no stop.\n"
             "Raises ValueError for a value out of range.")
      .def(py::init([](double young_modulus, double cross_section_area, double stress_free_length,
                       double thermal_expansion, double friction_force, double clearance_minus,
                       double clearance_plus, double preload_stiffness, double preload_force,
                       const std::string& start_friction, double stop_stiffness, double play) {
             const spring_slider::SpringSlider model{
                 young_modulus,      cross_section_area,
                 stress_free_length, thermal_expansion,
                 friction_force,     clearance_minus,
                 clearance_plus,     preload_stiffness,
                 preload_force,      start_friction_of(start_friction),
                 stop_stiffness,     play};
             model.validate();
             return model;
           }),
           py::kw_only(), py::arg("young_modulus_Pa"), py::arg("cross_section_area_m2"),
           py::arg("stress_free_length_m"), py::arg("thermal_expansion_per_K"),
           py::arg("friction_force_N"), py::arg("clearance_minus_m") = no_stop,
           py::arg("clearance_plus_m") = no_stop, py::arg("preload_stiffness_N_per_m") = 0.0,
           py::arg("preload_force_N") = 0.0, py::arg("start_friction") = "stuck",
           py::arg("stop_stiffness_N_per_m") = no_stop, py::arg("play_m") = 0.0)
      .def_readonly("young_modulus_Pa", &spring_slider::SpringSlider::young_modulus)
      .def_readonly("cross_section_area_m2", &spring_slider::SpringSlider::cross_section_area)
      .def_readonly("stress_free_length_m", &spring_slider::SpringSlider::stress_free_length)
      .def_readonly("thermal_expansion_per_K", &spring_slider::SpringSlider::thermal_expansion)
      .def_readonly("friction_force_N", &spring_slider::SpringSlider::friction_force)
      .def_readonly("clearance_minus_m", &spring_slider::SpringSlider::clearance_minus)
      .def_readonly("clearance_plus_m", &spring_slider::SpringSlider::clearance_plus)
      .def_readonly("preload_stiffness_N_per_m", &spring_slider::SpringSlider::preload_stiffness)
      .def_readonly("preload_force_N", &spring_slider::SpringSlider::preload_force,
                    "Tension of the preload spring at x = 0, towards -x when positive.")
      .def_readonly("stop_stiffness_N_per_m", &spring_slider::SpringSlider::stop_stiffness)
      .def_readonly("play_m", &spring_slider::SpringSlider::play);
}

void bind_model(py::module_& module) {
  bind_model_fields(module)
      .def_property_readonly(
          "start_displacement_m",
          [](const spring_slider::SpringSlider& self) { return start_displacement(self); },
          "Start position of the block [m]: stuck or without friction, or at a stop.")
      .def_property_readonly(
          "start_load_N", [](const spring_slider::SpringSlider& self) { return start_load(self); },
          "Force balanced by friction at the start [N], without stops.")
      .def_property_readonly(
          "start_middle_m",
          [](const spring_slider::SpringSlider& self) { return start_of(self).middle; },
          "Middle of the play at the start [m].")
      .def(
          "link_stiffness_N_per_m",
          [](const spring_slider::SpringSlider& self, double change) {
            return link_stiffness(self, change);
          },
          py::arg("temperature_change_K") = 0.0, "k_T = E A/l_T [N/m] at dT [K].")
      .def_property_readonly(
          "state_jump_m", [](const spring_slider::SpringSlider& self) { return state_jump(self); },
          "Displacement after one closed heating cycle [m] that ends sliding at dT = 0;\n"
          "f/(k + k_p) from a start without friction.")
      .def(
          "state_jump_after_slide_m",
          [](const spring_slider::SpringSlider& self, int direction) {
            return state_jump(self, direction);
          },
          py::arg("direction"),
          "The same [m] for a cycle that ends sliding in this direction, +1 or -1.")
      .def(
          "euler_load_N",
          [](const spring_slider::SpringSlider& self, const std::string& ends,
             double second_moment_of_area) {
            if (ends == "clamped_clamped") {
              return euler_load(self, spring_slider::EndCondition::clamped_clamped,
                                second_moment_of_area);
            }
            if (ends == "pinned_pinned") {
              return euler_load(self, spring_slider::EndCondition::pinned_pinned,
                                second_moment_of_area);
            }
            throw kernel::OutOfRange("ends", ends, "clamped_clamped or pinned_pinned");
          },
          py::arg("ends") = "clamped_clamped",
          py::arg("second_moment_of_area_m4") = std::numeric_limits<double>::quiet_NaN(),
          "Buckling load [N] of the unguided link. ends: 'clamped_clamped' or 'pinned_pinned';\n"
          "without a second moment of area the section is a square.");
}

void bind_path_parts(py::module_& module) {
  py::class_<spring_slider::Event>(
      module, "SpringSliderEvent",
      "An instant at which the stage changes or a cycle ends.\n\n"
      "kind: 'first_slip', 'slip', 'stop_reached', 'stop_unloaded', 'stop_left',\n"
      "'reversal', 'force_sign_change', 'cycle_end', 'play_opened' or 'play_closed'.")
      .def_property_readonly("kind",
                             [](const spring_slider::Event& self) { return to_string(self.kind); })
      .def_property_readonly(
          "stage_before",
          [](const spring_slider::Event& self) { return to_string(self.stage_before); })
      .def_property_readonly(
          "stage_after",
          [](const spring_slider::Event& self) { return to_string(self.stage_after); })
      .def_readonly("time_s", &spring_slider::Event::time)
      .def_readonly("temperature_change_K", &spring_slider::Event::temperature_change)
      .def_readonly("displacement_m", &spring_slider::Event::displacement)
      .def_readonly("axial_force_N", &spring_slider::Event::axial_force, "Positive in compression.")
      .def("__repr__", [](const spring_slider::Event& self) {
        return "<SpringSliderEvent " + std::string(to_string(self.kind)) +
               " at dT = " + std::string(py::repr(py::float_(self.temperature_change))) + " K, " +
               to_string(self.stage_before) + " -> " + to_string(self.stage_after) + ">";
      });
  py::class_<spring_slider::Segment>(
      module, "SpringSliderSegment",
      "Part of a path without an event inside; the temperature rises, falls or\n"
      "holds over it.\n\n"
      "stage: 'S1' to 'S5', 'at_stop_plus', 'at_stop_minus', 'in_play'; motion: 'stick',\n"
      "'slide', 'stop', 'play'; direction: sense of a slide or side of a stop, +1 or -1,\n"
      "0 for a stick; cycle: 0, 1, ...")
      .def_property_readonly(
          "stage", [](const spring_slider::Segment& self) { return to_string(self.stage); })
      .def_property_readonly(
          "motion", [](const spring_slider::Segment& self) { return to_string(self.motion); })
      .def_readonly("direction", &spring_slider::Segment::direction)
      .def_readonly("cycle", &spring_slider::Segment::cycle)
      .def_readonly("start_time_s", &spring_slider::Segment::start_time)
      .def_readonly("end_time_s", &spring_slider::Segment::end_time)
      .def_readonly("start_temperature_change_K", &spring_slider::Segment::start_temperature_change)
      .def_readonly("end_temperature_change_K", &spring_slider::Segment::end_temperature_change)
      .def_readonly("start_displacement_m", &spring_slider::Segment::start_displacement)
      .def_readonly("end_displacement_m", &spring_slider::Segment::end_displacement);
}

py::dict to_dict(const spring_slider::History& history) {
  py::list stage;
  for (const spring_slider::Stage entry : history.stage) stage.append(to_string(entry));
  py::dict result;
  result["time_s"] = history.time;
  result["temperature_change_K"] = history.temperature_change;
  result["displacement_m"] = history.displacement;
  result["axial_force_N"] = history.axial_force;
  result["friction_force_N"] = history.friction_force;
  result["stop_force_N"] = history.stop_force;
  result["elastic_energy_J"] = history.elastic_energy;
  result["preload_energy_J"] = history.preload_energy;
  result["friction_dissipation_J"] = history.friction_dissipation;
  result["thermal_work_J"] = history.thermal_work;
  result["stage"] = stage;
  return result;
}

void bind_path(py::module_& module) {
  py::class_<spring_slider::Path>(module, "SpringSliderPath",
                                  "Exact quasi-static path, the result of solve().")
      .def_readonly("model", &spring_slider::Path::model)
      .def_readonly("program", &spring_slider::Path::program)
      .def_readonly("events", &spring_slider::Path::events,
                    "List of Event of the cycles that are kept, in order of time.")
      .def_readonly("segments", &spring_slider::Path::segments,
                    "List of Segment of the cycles that are kept, without gaps in a cycle.")
      .def_readonly("largest_axial_force_N", &spring_slider::Path::largest_axial_force,
                    "Largest |F| over all cycles, kept or not.")
      .def_property_readonly("state_jump_m", &spring_slider::Path::state_jump,
                             "Displacement at the end minus that at the start [m].")
      .def("jump_after_cycle", &spring_slider::Path::jump_after_cycle, py::arg("cycle"),
           "Displacement [m] at the end of a cycle, counted from 1, minus that at the start.")
      .def_property_readonly(
          "exceeded_euler_load",
          [](const spring_slider::Path& self) -> py::object {
            const auto found = spring_slider::exceeded_euler_load(self);
            if (!found) return py::none();
            return py::dict(py::arg("axial_force_N") = found->axial_force,
                            py::arg("temperature_change_K") = found->temperature_change,
                            py::arg("clamped_N") = found->clamped,
                            py::arg("pinned_N") = found->pinned);
          },
          "Dict: axial_force_N, the largest compression, if it is above the Euler "
          "load of an unguided link; temperature_change_K; clamped_N and pinned_N, "
          "the Euler loads. Else None.")
      .def(
          "sample",
          [](const spring_slider::Path& self, const Eigen::VectorXd& time_s) {
            return to_dict(sample(self, time_s));
          },
          py::arg("time_s"),
          "The path at the times [s], in any order, >= 0 and in cycles that are kept: a dict of "
          "arrays time_s,\n"
          "temperature_change_K, displacement_m, axial_force_N (positive in compression),\n"
          "friction_force_N and stop_force_N (on the block, positive towards +x),\n"
          "elastic_energy_J (of the link), preload_energy_J, friction_dissipation_J,\n"
          "thermal_work_J, and `stage`, a list of names. Every entry is exact: it does not\n"
          "depend on the other times.");
  module.def(
      "solve_spring_slider",
      [](const spring_slider::SpringSlider& model, const thermal::Program& program,
         const std::optional<Eigen::VectorXd>& time_s,
         const std::optional<thermal::Program>& reported) {
        spring_slider::Path path = time_s ? solve(model, program, *time_s) : solve(model, program);
        if (reported) report_temperatures_of(*reported, path);
        return path;
      },
      py::arg("model"), py::arg("program"), py::arg("time_s") = py::none(),
      py::arg("told") = py::none(),
      "Exact path of a SpringSlider under a ThermalProgram, from rest at x = 0 and dT = 0.\n"
      "With times only the cycles are kept that sample() needs there, the first two and the last.\n"
      "`told` is a program of the same times whose temperatures events and samples tell, where\n"
      "`program` has the strain of a link over its coefficient.\n"
      "Raises ValueError if the program takes the link to a length <= 0.");
}

}  // namespace

void bind_spring_slider(py::module_& module) {
  bind_model(module);
  bind_path_parts(module);
  bind_path(module);
}

}  // namespace statejump::bindings
