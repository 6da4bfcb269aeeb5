// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <typeinfo>

namespace statejump::dem {

/// dynamic_cast to a class derived from From; null for an object of another class. The results for
/// the last classes are cached, because dynamic_cast compares class names in every call.
template <class To, class From>
To* known_cast(From* from) {
  struct Answer {
    const std::type_info* type;
    bool is;
  };
  thread_local std::array<Answer, 8> answers{};
  thread_local std::size_t oldest = 0;
  if (!from) return nullptr;
  const std::type_info* type = &typeid(*from);
  for (const Answer& answer : answers) {
    if (answer.type == type) return answer.is ? static_cast<To*>(from) : nullptr;
  }
  To* const to = dynamic_cast<To*>(from);
  answers[oldest] = {type, to != nullptr};
  oldest = (oldest + 1) % answers.size();
  return to;
}

}  // namespace statejump::dem
