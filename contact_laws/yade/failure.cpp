#include "failure.hpp"

#include <atomic>
#include <mutex>
#include <stdexcept>

namespace statejump::dem {
namespace {

std::atomic<bool> failed{false};
std::mutex message_mutex;
std::string first_message;

}  // namespace

void record_failure(const std::string& message) {
  const std::lock_guard<std::mutex> lock(message_mutex);
  if (failed) return;
  first_message = message;
  failed = true;
}

void throw_recorded_failure() {
  if (!failed.load(std::memory_order_relaxed)) return;
  const std::lock_guard<std::mutex> lock(message_mutex);
  failed = false;
  throw std::runtime_error(first_message);
}

}  // namespace statejump::dem
