// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace statejump {

/// Number of threads of in_parallel(). It is OMP_NUM_THREADS if set, so that users who start many
/// processes can limit it; otherwise the number of processors available to the process.
std::size_t threads();

/// Calls `work(k)` for every k from 0 to `count` − 1 on several threads, in any order. The threads
/// end before the function returns, so the process may fork afterwards. If `work` throws, all calls
/// are still made, and the exception with the lowest k is rethrown.
void in_parallel(std::size_t count, const std::function<void(std::size_t)>& work);

/// Calls `work(i)` for every i from 0 to `count` − 1. in_parallel() runs blocks of `length` calls;
/// a single block runs as a plain loop.
template <class Work>
void each_in_parallel(std::size_t count, std::size_t length, Work&& work) {
  const std::size_t pieces = (count + length - 1) / length;
  const auto piece = [&](std::size_t k) {
    const std::size_t end = k + 1 == pieces ? count : (k + 1) * length;
    for (std::size_t i = k * length; i < end; ++i) work(i);
  };
  if (pieces == 1) return piece(0);
  in_parallel(pieces, piece);
}

}  // namespace statejump
