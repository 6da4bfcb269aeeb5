// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the interface for which the plugin was compiled with the interface of the running YADE.
#pragma once

#include <boost/python/object.hpp>
#include <string>

#include "statejump/yade_abi/interface.hpp"

namespace statejump::yade_abi {

struct GuardOptions {
  // Whether build identifiers are compared, which is the only check that covers every member. Tests
  // with a wrong declaration switch it off, so that the other checks run.
  bool check_build_ids = true;
};

struct Difference {
  std::string check;     // name of the check that found the difference; empty: no difference
  std::string sentence;  // without the ending that the caller adds
};

// Returns an empty difference if all checks pass. The checks run in this order, cheap and safe ones
// first:
//   "build identifier" compares build ids of libyade, libpkg_common and libpkg_dem with known ones;
//     it is skipped if the plugin was built with YADE's own headers.
//   "size" compares the size of each class with the constant that YADE passes to operator new.
//   "table" compares length and entries of the vtable of an empty derived class with YADE's.
//   "getter" checks offset and type of every plain data member that YADE exposes to Python. They
//     are read from the pointer to member behind the attribute.
//   "coverage" requires that a getter or a value checks every declared member. Members checked by
//     a value must have the type that this check searches for.
//   "sentinel" writes members of fresh objects at declared offsets and reads them through Python.
//   "value" finds members that Python does not expose by their contents in YADE's objects.
// Checks up to "coverage" neither call YADE nor write to its objects. "sentinel" and "value" use
// fresh objects and a scene of their own; the user's scene is only read.
// @param wrapper the module yade.wrapper
Difference difference_from_running_yade(const boost::python::object& wrapper,
                                        const GuardOptions& options = {});

// Name of the YADE binary that the plugin was built for, e.g. "YADE 2023.02a of Debian 12".
std::string built_for();

}  // namespace statejump::yade_abi
