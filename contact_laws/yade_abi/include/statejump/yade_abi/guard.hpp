// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the interface for which the plugin was compiled with that of the running YADE.
#pragma once

#include <boost/python/object.hpp>
#include <string>

#include "statejump/yade_abi/interface.hpp"

namespace statejump::yade_abi {

struct GuardOptions {
  // Whether to compare build identifiers, the only check that covers every member. Tests that
  // deliberately declare a wrong interface switch it off, so that the other checks run.
  bool check_build_ids = true;
};

struct Difference {
  std::string check;     // which check found it; empty: none
  std::string sentence;  // without its end
};

// Empty when all checks pass, in this order, the cheap and safe ones first:
//   "build identifier": those of libyade, libpkg_common and libpkg_dem against the known ones; not
//     where the plugin was built with YADE's own headers;
//   "size": the constant that the libraries themselves give to operator new;
//   "table": length and entries of the table of virtual functions of a do-nothing child against the
//     library's own;
//   "getter": offset and type of every plain data member that YADE shows in Python, from the
//   pointer
//     to member behind the attribute;
//   "coverage": no declared member is left that neither a getter nor a value shows, and those that
//     values show are declared with the type that is looked for;
//   "sentinel": the same members of fresh objects, written at their place and read through Python;
//   "value": members that Python does not show, found in YADE's objects by what they hold.
// Up to "coverage" nothing of YADE's is called or written. The last two work on fresh objects and a
// scene of their own; the user's scene is only looked at.
// wrapper: the module yade.wrapper.
Difference difference_from_running_yade(const boost::python::object& wrapper,
                                        const GuardOptions& options = {});

// The binary that the plugin was built for: "YADE 2023.02a of Debian 12".
std::string built_for();

}  // namespace statejump::yade_abi
