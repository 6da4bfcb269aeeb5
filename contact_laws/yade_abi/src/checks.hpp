// SPDX-License-Identifier: GPL-3.0-or-later
// The single checks of the guard. Each returns the beginning of a sentence about the first
// difference, or an empty string.
#pragma once

#include <boost/python/object.hpp>
#include <string>

#include "statejump/yade_abi/interface.hpp"

namespace statejump::yade_abi {

std::string size_difference(const DeclaredInterface& declared);
std::string table_difference(const DeclaredInterface& declared);
std::string getter_difference(const DeclaredInterface& declared,
                              const boost::python::object& wrapper);
// Checks that getters or values cover every declared member and establish its type.
std::string coverage_difference(const DeclaredInterface& declared);
std::string sentinel_difference(const DeclaredInterface& declared,
                                const boost::python::object& wrapper);
std::string value_difference(const DeclaredInterface& declared,
                             const boost::python::object& wrapper);

}  // namespace statejump::yade_abi
