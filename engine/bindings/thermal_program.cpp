// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/thermal/program.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"

namespace py = pybind11;

namespace statejump::bindings {

using thermal::Program;
using thermal::Shape;

namespace {

Program make_program(const std::string& shape, double temperature_change_max, double period,
                     int cycles, std::vector<double> table_times,
                     std::vector<double> table_temperature_changes) {
  Program program;
  program.shape = thermal::shape_of(shape);
  program.cycles = cycles;
  program.table_times = std::move(table_times);
  program.table_temperature_changes = std::move(table_temperature_changes);
  const bool is_table = program.shape == Shape::table;
  const bool table_gives_period = is_table && std::isnan(period) && !program.table_times.empty();
  program.period = table_gives_period ? program.table_times.back() : period;
  program.temperature_change_max = temperature_change_max;
  program.validate();
  if (is_table) {
    program.temperature_change_max = 0.0;
    for (const double change : program.table_temperature_changes) {
      if (std::abs(change) > std::abs(program.temperature_change_max)) {
        program.temperature_change_max = change;
      }
    }
  }
  return program;
}

}  // namespace

void bind_thermal_program(py::module_& module) {
  constexpr double unset = std::numeric_limits<double>::quiet_NaN();
  py::class_<Program>(
      module, "ThermalProgram",
      "Temperature change dT(t) = T(t) - T0 of a part, a cycle repeated `cycles` times.\n\n"
      "shape: 'triangle' (0 to max at period/2 to 0), 'half_sine' (max sin(pi t/period)),\n"
      "'sine' (max sin(2 pi t/period)) or 'table' (straight lines between given points).\n"
      "temperature_change_max_K: any finite value, negative cools first; not given for a table.\n"
      "period_s: length of one cycle, > 0; for a table it may be left out (its last time).\n"
      "table_time_s: from 0, strictly increasing. table_temperature_change_K: one per time, the\n"
      "first 0; the last 0 as well if cycles > 1.\n"
      "After the last cycle dT holds its end value, exactly 0 for all shapes but a table.\n"
      "Raises ValueError for a value out of range.")
      .def(py::init(&make_program), py::kw_only(), py::arg("shape"),
           py::arg("temperature_change_max_K") = unset, py::arg("period_s") = unset,
           py::arg("cycles") = 1, py::arg("table_time_s") = std::vector<double>{},
           py::arg("table_temperature_change_K") = std::vector<double>{})
      .def_property_readonly("shape",
                             [](const Program& self) { return thermal::to_string(self.shape); })
      .def_readonly("temperature_change_max_K", &Program::temperature_change_max,
                    "Amplitude [K]; of a table the entry largest in size.")
      .def_readonly("period_s", &Program::period, "Length of one cycle [s].")
      .def_readonly("cycles", &Program::cycles)
      .def_readonly("table_time_s", &Program::table_times)
      .def_readonly("table_temperature_change_K", &Program::table_temperature_changes)
      .def_property_readonly("duration_s", &Program::duration, "cycles * period_s [s].")
      .def(
          "temperature_change",
          [](const Program& self, py::array_t<double> time_s) {
            return py::vectorize([&self](double t) { return self.temperature_change(t); })(time_s);
          },
          py::arg("time_s"), "dT [K] at a time or an array of times [s].")
      .def(
          "temperature_rate",
          [](const Program& self, py::array_t<double> time_s) {
            return py::vectorize([&self](double t) { return self.temperature_rate(t); })(time_s);
          },
          py::arg("time_s"),
          "d(dT)/dt [K/s] at a time or an array of times [s]; at a corner the rate after it.")
      .def("__repr__", [](const Program& self) {
        return "ThermalProgram(shape='" + std::string(thermal::to_string(self.shape)) +
               "', temperature_change_max_K=" +
               std::string(py::repr(py::float_(self.temperature_change_max))) +
               ", period_s=" + std::string(py::repr(py::float_(self.period))) +
               ", cycles=" + std::to_string(self.cycles) + ")";
      });
}

}  // namespace statejump::bindings
