// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings.hpp"

#include "statejump/kernel/require.hpp"

statejump::StartFriction statejump::bindings::start_friction_of(const std::string& name) {
  if (name == "stuck") return StartFriction::stuck;
  if (name == "frictionless") return StartFriction::frictionless;
  throw kernel::OutOfRange("start_friction", name, "stuck or frictionless");
}

PYBIND11_MODULE(_engine, module) {
  module.doc() =
      "Reduced models of state jump in exact, closed or quasi-static form.\n\n"
      "SI units everywhere; every name that carries a quantity ends with its unit. Arguments out "
      "of\n"
      "range and models without a result raise EngineFailure, a ValueError and RuntimeError with "
      "fields.";
  statejump::bindings::bind_failure(module);
  statejump::bindings::bind_thermal_program(module);
  statejump::bindings::bind_spring_slider(module);
  statejump::bindings::bind_laws(module);
  statejump::bindings::bind_linkage(module);
  statejump::bindings::bind_rest_set(module);
  statejump::bindings::bind_truss(module);
  statejump::bindings::bind_complementarity(module);
  statejump::bindings::bind_geometry(module);
}
