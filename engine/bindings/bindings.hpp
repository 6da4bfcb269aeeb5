// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <string_view>

#include "start_friction.hpp"

namespace statejump::bindings {

/// Suffix that distinguishes the name of the second module from that of the first.
inline constexpr std::string_view more_suffix = "_more";

/// Name of the second module, for the name of the first.
inline std::string more_name(const std::string& engine) {
  return engine + std::string(more_suffix);
}

/// Adds EngineFailure, the exception into which the bindings translate every failure of the engine.
/// Call it before the other bind functions.
void bind_failure(pybind11::module_& module);

/// Uses the same exception for failures in the second module.
void use_failure(const pybind11::module_& engine);

/// Adds ThermalProgram to the module.
void bind_thermal_program(pybind11::module_& module);

/// Adds SpringSlider, Path and solve() to the module. Call it after bind_thermal_program.
void bind_spring_slider(pybind11::module_& module);

/// Adds the catalogue of contact laws to the module.
void bind_laws(pybind11::module_& module);

/// Adds drive_contact.
void bind_driven_contact(pybind11::module_& module);

/// Adds linkage::Linkage, its runs and the quasi-static loop. Call after bind_thermal_program.
void bind_linkage(pybind11::module_& module);

/// Adds the rest sets of loaded joints to the module.
void bind_rest_set(pybind11::module_& module);

/// Adds truss_path and truss_recorded_path. Call after bind_thermal_program.
void bind_truss(pybind11::module_& module);

/// Adds FrictionProblem.
void bind_complementarity(pybind11::module_& module);

/// Adds BoreMesh and the generators of bore meshes.
void bind_geometry(pybind11::module_& module);

}  // namespace statejump::bindings
