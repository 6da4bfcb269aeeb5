// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <vector>

#include "statejump/truss/model.hpp"
#include "statejump/truss/path.hpp"

namespace statejump::bindings {

/// The truss that Python describes by tables; see truss_path().
truss::Model make_model(const pybind11::dict& nodes, const pybind11::dict& elements,
                        const pybind11::dict& joints, const pybind11::dict& constraints,
                        std::vector<thermal::Program> programs);

/// A path as truss_path() returns it.
pybind11::dict path_dict(const truss::Model& model, const truss::Path& path);

/// Adds truss_recorded_path. Call after bind_truss().
void bind_truss_gradient(pybind11::module_& module);

}  // namespace statejump::bindings
