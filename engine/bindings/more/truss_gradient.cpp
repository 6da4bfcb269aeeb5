// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../bindings.hpp"
#include "statejump/truss/gradient.hpp"
#include "truss_model.hpp"

namespace py = pybind11;

namespace statejump::bindings {

namespace {

using Covectors = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A recorded path with its model.
struct TrussRecord {
  truss::Model model;
  truss::RecordedPath recorded;
};

struct TrussDerivative {
  truss::OutputDerivative derivative;
};

TrussRecord recorded_path(const py::dict& nodes, const py::dict& elements, const py::dict& joints,
                          std::vector<thermal::Program> programs, int increments_per_branch,
                          double event_tolerance, double energy_tolerance,
                          const std::string& start_friction, const py::object& progress,
                          const py::dict& constraints) {
  TrussRecord made{make_model(nodes, elements, joints, constraints, std::move(programs)), {}};
  truss::Options options;
  options.start_friction = start_friction_of(start_friction);
  options.increments_per_branch = increments_per_branch;
  options.event_tolerance = event_tolerance;
  options.energy_tolerance = energy_tolerance;
  options.cycle_ends_only = true;
  options.progress = [&progress](double done) {
    py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();  // Ctrl-C
    return progress.is_none() || !progress(done).is(py::bool_(false));
  };
  py::gil_scoped_release unlocked;
  made.recorded = truss::solve_recorded(made.model, options);
  return made;
}

TrussDerivative derivative_of(const TrussRecord& record, const Covectors& covectors) {
  const auto ends = static_cast<py::ssize_t>(record.recorded.path.cycle_ends.size());
  if (covectors.ndim() != 3 || covectors.shape(0) != ends || covectors.shape(2) != 3) {
    throw py::value_error("covectors must have the shape (cycle ends, sites, 3)");
  }
  std::vector<Eigen::Matrix3Xd> given;
  for (py::ssize_t c = 0; c < ends; ++c) {
    given.emplace_back(
        Eigen::Map<const Eigen::Matrix3Xd>(covectors.data(c, 0, 0), 3, covectors.shape(1)));
  }
  py::gil_scoped_release unlocked;
  return {truss::OutputDerivative(record.recorded, given)};
}

/// Summands of the Lagrangian for a changed truss, by kind of item.
py::dict summands_of(const TrussDerivative& of, const py::dict& nodes, const py::dict& elements,
                     const py::dict& joints, std::vector<thermal::Program> programs,
                     const py::dict& constraints) {
  const truss::Model model = make_model(nodes, elements, joints, constraints, std::move(programs));
  Eigen::VectorXd all;
  {
    py::gil_scoped_release unlocked;
    all = of.derivative.summands(model);
  }
  Eigen::Index next = 0;
  const auto take = [&](std::size_t count) {
    const auto size = static_cast<Eigen::Index>(count);
    const Eigen::VectorXd part = all.segment(next, size);
    next += size;
    return part;
  };
  py::dict made;
  made["node"] = take(model.nodes.size());
  py::dict of_elements;
  truss::for_each_element_type([&]<std::size_t k>(std::integral_constant<std::size_t, k>) {
    const std::size_t count = std::get<k>(model.lists()).size();
    of_elements[truss::ElementType<k>::table] = take(count);
  });
  made["elements"] = of_elements;
  py::dict of_joints;
  truss::for_each_joint_type([&]<class Type>(std::type_identity<Type>) {
    std::size_t count = 0;
    for (const truss::Joint& joint : model.joints) count += std::holds_alternative<Type>(joint);
    of_joints[Type::kind] = take(count);
  });
  made["joints"] = of_joints;
  return made;
}

}  // namespace

void bind_truss_gradient(py::module_& module) {
  py::class_<TrussDerivative>(
      module, "TrussDerivative",
      "Derivative of an output of a recorded path, prepared for all parameters.")
      .def("summands", summands_of, py::arg("nodes"), py::arg("elements"), py::arg("joints"),
           py::arg("programs"), py::kw_only(), py::arg("constraints") = py::dict(),
           "Lagrangian of a truss with changed parameters, a summand for each item: node, "
           "elements[table],\njoints[kind]. Differences of two such values are derivatives of "
           "the output; see\nstatejump/truss/gradient.hpp.")
      .def_property_readonly("solutions",
                             [](const TrussDerivative& of) { return of.derivative.solutions(); })
      .def_property_readonly("events",
                             [](const TrussDerivative& of) { return of.derivative.events(); })
      .def_property_readonly("kinks",
                             [](const TrussDerivative& of) { return of.derivative.kinks(); });
  py::class_<TrussRecord>(module, "TrussRecord", "A path of a truss with all of its equilibria.")
      .def_property_readonly(
          "path", [](const TrussRecord& of) { return path_dict(of.model, of.recorded.path); })
      .def("derivative", derivative_of, py::arg("covectors"),
           "Derivative of an output that is a linear function of the displacements at the ends of "
           "cycles.\ncovectors (cycle ends, sites, 3): by displacements of all nodes, then by "
           "rotation vectors.");
  module.def("truss_recorded_path", recorded_path, py::arg("nodes"), py::arg("elements"),
             py::arg("joints"), py::arg("programs"), py::kw_only(),
             py::arg("increments_per_branch") = truss::Options().increments_per_branch,
             py::arg("event_tolerance") = truss::Options().event_tolerance,
             py::arg("energy_tolerance") = truss::Options().energy_tolerance,
             py::arg("start_friction") = "stuck", py::arg("progress") = py::none(),
             py::arg("constraints") = py::dict(),
             "truss_path() with all events located, recorded for derivatives.");
}

}  // namespace statejump::bindings
