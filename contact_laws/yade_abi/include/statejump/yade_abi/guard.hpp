// Checks that the declared interface is the one of the running YADE.
#pragma once

#include <boost/python/object.hpp>
#include <string>

namespace statejump::yade_abi {

struct GuardOptions {
  // The build identifiers of the libraries are the only check that covers every member; tests that
  // deliberately declare something else switch it off to see the others work.
  bool check_build_ids = true;
};

// Empty when all four checks pass, in this order, the cheap and safe ones first:
//   1. GNU build identifiers of libyade, libpkg_common and libpkg_dem against the measured ones;
//   2. object sizes: the constant that the libraries themselves give to operator new;
//   3. length and entries of the vtable of a do-nothing child against the library's own vtable;
//   4. sentinels written through Python and read at the declared places, and the other way round.
// Otherwise one sentence that says what differs. Objects are touched in 4 only.
// wrapper: the module yade.wrapper. Works on fresh objects and a scene of its own; the user's scene
// is only looked at.
std::string difference_from_running_yade(const boost::python::object& wrapper,
                                         const GuardOptions& options = {});

}  // namespace statejump::yade_abi
