// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "../bindings.hpp"
#include "statejump/complementarity/solve.hpp"
#include "statejump/kernel/require.hpp"

namespace py = pybind11;

namespace statejump::bindings {

namespace {

using complementarity::Delassus;
using complementarity::Method;
using complementarity::Options;
using complementarity::Problem;
using complementarity::Solution;
using Eigen::VectorXd;

constexpr std::array methods = {Method::automatic, Method::gauss_seidel, Method::newton,
                                Method::interior_point, Method::lemke};

Method method_named(const std::string& name) {
  std::string names;
  for (const Method method : methods) {
    if (name == to_string(method)) return method;
    names += (names.empty() ? "" : ", ") + std::string(to_string(method));
  }
  throw kernel::OutOfRange("method", name, names);
}

Problem checked(Problem problem) {
  validate(problem);
  return problem;
}

/// W from compressed columns, as stored by scipy.sparse.csc_matrix.
Problem of_columns(int dimension, const std::vector<int>& starts, const std::vector<int>& rows,
                   const VectorXd& values, VectorXd q, VectorXd mu) {
  const auto entries = static_cast<Eigen::Index>(rows.size());
  bool fits = static_cast<Eigen::Index>(starts.size()) == q.size() + 1 &&
              values.size() == entries && starts.front() == 0 && starts.back() == entries;
  for (std::size_t j = 1; fits && j < starts.size(); ++j) fits = starts[j] >= starts[j - 1];
  for (const int row : rows) fits = fits && row >= 0 && row < q.size();
  if (!fits) {
    throw kernel::OutOfRange("W", "other", "compressed columns of a square matrix like q");
  }
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(rows.size());
  for (std::size_t j = 0; j + 1 < starts.size(); ++j) {
    for (int k = starts[j]; k < starts[j + 1]; ++k) {
      triplets.emplace_back(rows[static_cast<std::size_t>(k)], static_cast<int>(j), values[k]);
    }
  }
  Eigen::SparseMatrix<double> matrix(q.size(), q.size());
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return checked({dimension, std::move(matrix), std::move(q), std::move(mu)});
}

py::dict merit_dict(const complementarity::Merit& merit) {
  py::dict result;
  result["natural_map"] = merit.natural_map;
  result["scaled"] = merit.scaled;
  return result;
}

py::dict solved(const Problem& problem, double tolerance, const std::string& method,
                int most_sweeps, std::optional<VectorXd> guess,
                const std::function<void(double)>& progress) {
  Options options;
  options.tolerance = tolerance;
  options.method = method_named(method);
  options.most_sweeps = most_sweeps;
  options.guess = std::move(guess);
  options.progress = [&](double merit) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (progress) progress(merit);
    return true;
  };
  const Solution solution = solve(problem, options);
  py::dict iterations;
  iterations["gauss_seidel"] = solution.iterations.gauss_seidel;
  iterations["newton"] = solution.iterations.newton;
  iterations["interior_point"] = solution.iterations.interior_point;
  iterations["pivots"] = solution.iterations.pivots;
  py::dict result = merit_dict(solution.merit);
  result["reactions"] = solution.reactions;
  result["velocities"] = solution.velocities;
  result["iterations"] = iterations;
  result["status"] = to_string(solution.status);
  result["method"] = to_string(solution.method);
  return result;
}

}  // namespace

void bind_complementarity(py::module_& module) {
  std::vector<std::string> names;
  for (const Method method : methods) names.emplace_back(to_string(method));
  py::class_<Problem>(module, "FrictionProblem",
                      "Local frictional contact problem: u = W r + q with Coulomb's law at every "
                      "contact, the\nnormal component first in a contact's block. Units are the "
                      "caller's.")
      .def(py::init([](int dimension, Eigen::MatrixXd w, VectorXd q, VectorXd mu) {
             return checked({dimension, std::move(w), std::move(q), std::move(mu)});
           }),
           py::arg("dimension"), py::arg("delassus"), py::arg("q"), py::arg("mu"),
           "delassus: W, a square array; q: velocities without reactions; mu: friction "
           "coefficient of each contact.")
      .def_static("of_columns", &of_columns, py::arg("dimension"), py::arg("starts"),
                  py::arg("rows"), py::arg("values"), py::arg("q"), py::arg("mu"),
                  "The same with W in compressed columns; entries of one place add up.")
      .def("velocities", &complementarity::velocities, py::arg("reactions"), "W reactions + q.")
      .def(
          "merit",
          [](const Problem& self, const VectorXd& reactions) {
            return merit_dict(merit(self, reactions));
          },
          py::arg("reactions"),
          "Natural map of reactions: 'natural_map' over the largest of |q|, |r| and |u|, 'scaled' "
          "without units.")
      .def("solve", &solved, py::arg("tolerance") = 1e-10, py::arg("method") = "automatic",
           py::arg("most_sweeps") = 5000, py::arg("guess") = py::none(),
           py::arg("progress") = py::none(),
           "Reactions, velocities, merit, iterations, status ('solved', 'not_converged') and the "
           "method that\nfound them. progress(merit) is called now and then.");
  module.attr("FRICTION_METHODS") = py::tuple(py::cast(names));
}

}  // namespace statejump::bindings
