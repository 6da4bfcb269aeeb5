// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace statejump::kernel::laws {

/// What a law says of itself, as data for a listing.
struct LawInfo {
  const char* name;     ///< as case files spell it
  const char* formula;  ///< plain text
  const char* source;   ///< publication and equation
  const char* range;    ///< where it is valid; what is an error outside
  bool
      holds_static_load;  ///< whether a body at rest can stay at rest under a load this law carries
};

}  // namespace statejump::kernel::laws
