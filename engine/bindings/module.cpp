// SPDX-License-Identifier: GPL-3.0-or-later
// The module that every import of the package loads, with the bar on a slider. The other models are
// in _engine_more, which is loaded when one of its names is first used.
#include <string>

#include "bindings.hpp"

namespace py = pybind11;

namespace statejump::bindings {
namespace {

py::object attribute_of_more(const std::string& engine, const std::string& name) {
  // Python itself looks for names such as __path__.
  if (name.rfind("__", 0) != 0) {
    const std::string more = more_name(engine);
    try {
      const py::module_ module = py::module_::import(more.c_str());
      if (py::hasattr(module, name.c_str())) return module.attr(name.c_str());
    } catch (py::error_already_set& failed) {
      if (!failed.matches(PyExc_ModuleNotFoundError)) throw;
      const py::object error = py::module_::import("statejump.core.errors").attr("StatejumpError");
      const py::object missing = error(py::arg("code") = "not_in_build", py::arg("name") = name);
      PyErr_SetObject(error.ptr(), missing.ptr());
      throw py::error_already_set();
    }
  }
  throw py::attribute_error("module '" + engine + "' has no attribute '" + name + "'");
}

}  // namespace
}  // namespace statejump::bindings

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
  const auto engine = module.attr("__name__").cast<std::string>();
  module.def("__getattr__", [engine](const std::string& name) {
    return statejump::bindings::attribute_of_more(engine, name);
  });
}
