// SPDX-License-Identifier: GPL-3.0-or-later
#include "axial.hpp"

#include <string>

#include "statejump/kernel/require.hpp"

namespace statejump::truss::detail {

void check_length(const char* kind, const std::string& name, const Model& model, int first,
                  int second) {
  const double length = drawn_length(model, first, second);
  if (length > 0.0) return;
  throw kernel::OutOfRange(std::string(kind) + " '" + name + "'", "length", length,
                           "> 0 m: its nodes are at different places");
}

}  // namespace statejump::truss::detail
