// SPDX-License-Identifier: GPL-3.0-or-later
// A module with the guard and nothing else: what does it say about the running YADE?
#include <dlfcn.h>
#include <link.h>

#include <boost/python.hpp>

#include "statejump/yade_abi/guard.hpp"

namespace {

namespace py = boost::python;
using statejump::yade_abi::GuardOptions;

py::tuple as_tuple(const statejump::yade_abi::Difference& difference) {
  return py::make_tuple(difference.check, difference.sentence);
}

// Sentence of the first difference, as the plugin's Python package requests it.
std::string setup(const py::object& wrapper) {
  return statejump::yade_abi::difference_from_running_yade(wrapper).sentence;
}

// All checks, as the plugin runs them.
py::tuple all_checks(const py::object& wrapper) {
  return as_tuple(statejump::yade_abi::difference_from_running_yade(wrapper));
}

// All checks except that of the build identifiers, which do not depend on the compiled
// declarations.
py::tuple interface_checks(const py::object& wrapper) {
  GuardOptions options;
  options.check_build_ids = false;
  return as_tuple(statejump::yade_abi::difference_from_running_yade(wrapper, options));
}

// Name of the function or object that a table entry points to, with `child` instead of the child's
// name.
std::string entry_name(const void* entry, const std::string& child) {
  Dl_info info;
  if (!dladdr(entry, &info) || !info.dli_sname || info.dli_saddr != entry) {
    return std::to_string(reinterpret_cast<std::ptrdiff_t>(entry));
  }
  std::string name = info.dli_sname;
  const auto place = name.find(child);
  return place == std::string::npos ? name : name.replace(place, child.size(), "child");
}

// All data that the compiled declarations determine. Equal descriptions mean equal interfaces.
py::list description() {
  const auto declared = statejump::yade_abi::declared_interface();
  py::list result;
  for (const auto& one : declared.classes) result.append(py::make_tuple(one.name, one.size));
  for (const auto& one : declared.members) {
    result.append(py::make_tuple(one.class_name + "." + one.name, one.offset, one.type));
  }
  Dl_info module;
  dladdr(reinterpret_cast<const void*>(&description), &module);
  void* handle = dlopen(module.dli_fname, RTLD_LAZY | RTLD_NOLOAD);
  for (const auto& table : declared.tables) {
    const std::string child = table.mangled_child.substr(1, table.mangled_child.size() - 2);
    const auto* entries =
        static_cast<const void* const*>(dlsym(handle, ("_ZTVN" + child + "E").c_str()));
    Dl_info info;
    ElfW(Sym)* symbol = nullptr;
    dladdr1(entries, &info, reinterpret_cast<void**>(&symbol), RTLD_DL_SYMENT);
    for (std::size_t i = 0; i < symbol->st_size / sizeof(void*); ++i) {
      result.append(py::make_tuple(table.class_name, i, entry_name(entries[i], child)));
    }
  }
  dlclose(handle);
  result.append(declared.view_flag_size);
  return result;
}

}  // namespace

BOOST_PYTHON_MODULE(_native) {
  py::def("setup", &setup);
  py::def("built_for", &statejump::yade_abi::built_for);
  py::def("all_checks", &all_checks);
  py::def("interface_checks", &interface_checks);
  py::def("description", &description);
}
