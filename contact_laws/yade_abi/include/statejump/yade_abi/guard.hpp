// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the interface for which the plugin was compiled with the interface of the running YADE.
#pragma once

#include <boost/python/object.hpp>
#include <string>

#include "statejump/yade_abi/interface.hpp"

namespace statejump::yade_abi {

struct GuardOptions {
  // Whether to compare build identifiers, the only check that covers every member. Tests with a
  // deliberately wrong declaration switch it off, so that the other checks run.
  bool check_build_ids = true;
};

struct Difference {
  std::string check;     // name of the check that found the difference; empty: no difference
  std::string sentence;  // without the ending that the caller adds
};

// Returns an empty difference if all checks pass. They run in this order, the cheap and safe ones
// first:
//   "build identifier": build ids of libyade, libpkg_common and libpkg_dem against the known ones;
//     skipped if the plugin was built with YADE's own headers;
//   "size": size of each class, the constant that the libraries pass to operator new;
//   "table": length and entries of the vtable of an empty derived class against the library's;
//   "getter": offset and type of every plain data member that YADE exposes to Python, read from the
//     pointer to member behind the attribute;
//   "coverage": every declared member is checked by a getter or by a value, and members checked by
//   a
//     value have the type that this check searches for;
//   "sentinel": writes members of fresh objects at their declared offsets, reads them through
//   Python;
//   "value": members that Python does not expose, found in YADE's objects by their contents.
// Checks up to "coverage" call and write nothing of YADE. "sentinel" and "value" use fresh objects
// and a scene of their own; the user's scene is only read.
// @param wrapper the module yade.wrapper
Difference difference_from_running_yade(const boost::python::object& wrapper,
                                        const GuardOptions& options = {});

// Name of the binary that the plugin was built for, e.g. "YADE 2023.02a of Debian 12".
std::string built_for();

}  // namespace statejump::yade_abi
