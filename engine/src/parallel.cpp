// SPDX-License-Identifier: GPL-3.0-or-later
#include "parallel.hpp"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <thread>
#include <vector>

namespace statejump {

namespace {

std::size_t processors() {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return 1;
  return static_cast<std::size_t>(CPU_COUNT(&allowed));
}

}  // namespace

std::size_t threads() {
  if (const char* text = std::getenv("OMP_NUM_THREADS")) {
    const int number = std::atoi(text);
    if (number > 0) return static_cast<std::size_t>(number);
  }
  return processors();
}

void in_parallel(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::vector<std::exception_ptr> failures(count);
  std::atomic<std::size_t> next{0};
  const auto take = [&] {
    for (std::size_t k = next++; k < count; k = next++) {
      try {
        work(k);
      } catch (...) {
        failures[k] = std::current_exception();
      }
    }
  };
  {
    std::vector<std::jthread> others(count < 2 ? 0 : std::min(count, threads()) - 1);
    for (std::jthread& one : others) one = std::jthread(take);
    take();
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace statejump
