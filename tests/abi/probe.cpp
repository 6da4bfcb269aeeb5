// A module with the guard and nothing else: what does it say about the running YADE?
#include <boost/python.hpp>

#include "statejump/yade_abi/guard.hpp"

namespace {

// All checks, as the plugin runs them.
std::string setup(const boost::python::object& wrapper) {
  return statejump::yade_abi::difference_from_running_yade(wrapper);
}

// Without the build identifiers: they do not change with the declarations that are compiled in.
std::string difference(const boost::python::object& wrapper) {
  statejump::yade_abi::GuardOptions options;
  options.check_build_ids = false;
  return statejump::yade_abi::difference_from_running_yade(wrapper, options);
}

}  // namespace

BOOST_PYTHON_MODULE(_native) {
  boost::python::def("setup", &setup);
  boost::python::def("difference", &difference);
}
