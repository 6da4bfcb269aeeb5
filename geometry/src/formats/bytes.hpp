// SPDX-License-Identifier: GPL-3.0-or-later
// Reads numbers of binary files.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace statejump::geometry::formats {

/// Converts bytes to a number.
/// @param swapped whether the byte order differs from that of the machine
template <class Number>
Number from_bytes(const char* bytes, bool swapped) {
  std::array<char, sizeof(Number)> own;
  std::copy_n(bytes, sizeof(Number), own.begin());
  if (swapped) std::reverse(own.begin(), own.end());
  Number value;
  std::memcpy(&value, own.data(), sizeof value);
  return value;
}

inline bool machine_is_little_endian() {
  const std::uint16_t one = 1;
  unsigned char first = 0;
  std::memcpy(&first, &one, 1);
  return first == 1;
}

}  // namespace statejump::geometry::formats
