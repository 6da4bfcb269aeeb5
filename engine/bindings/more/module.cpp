// SPDX-License-Identifier: GPL-3.0-or-later
// All models except the bar on a slider. The module _engine looks up their names here.
#include <string>

#include "../bindings.hpp"
#include "statejump/law_loader/load.hpp"

PYBIND11_MODULE(_engine_more, module) {
  namespace bindings = statejump::bindings;
  module.doc() = "Models that _engine offers beside the bar on a slider.";
  const std::string name = module.attr("__name__").cast<std::string>();
  // Classes of _engine are arguments of functions of this module.
  const auto engine =
      pybind11::module_::import(name.substr(0, name.size() - bindings::more_suffix.size()).c_str());
  bindings::use_failure(engine);
  statejump::law_loader::load_user_laws();
  module.def("_load_user_laws", &statejump::law_loader::load_user_laws);
  bindings::bind_driven_contact(module);
  bindings::bind_linkage(module);
  bindings::bind_rest_set(module);
  bindings::bind_truss(module);
  bindings::bind_complementarity(module);
  bindings::bind_geometry(module);
}
