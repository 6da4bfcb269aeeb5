// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace statejump {

/// Threads that in_parallel() uses: as many as OMP_NUM_THREADS says, whose meaning users know and
/// which those who start many processes set, else as many processors as the process may use.
std::size_t threads();

/// Calls `work(k)` for every k below `count`, several at a time, in any order. The threads end
/// before it returns: none is left for a process that forks. What `work` throws is thrown here, of
/// several the one with the lowest k; the others are done all the same.
void in_parallel(std::size_t count, const std::function<void(std::size_t)>& work);

/// Calls `work(i)` for every i below `count` in pieces of `length`, see above. Of one piece it is a
/// loop.
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
