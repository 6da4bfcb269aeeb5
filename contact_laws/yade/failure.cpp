#include "failure.hpp"

#include <atomic>
#include <mutex>
#include <stdexcept>

#include "yade_api.hpp"

namespace statejump::dem {
namespace {

std::atomic<bool> failed{false};
std::mutex message_mutex;
std::string first_message;
const yade::Scene* failed_scene = nullptr;
long failed_iteration = 0;

}  // namespace

void record_failure(const std::string& message) {
  const std::lock_guard<std::mutex> lock(message_mutex);
  if (failed) return;
  first_message = message;
  failed_scene = yade::Omega::instance().getScene().get();
  failed_iteration = failed_scene->iter;
  failed = true;
}

void throw_recorded_failure() {
  if (!failed.load(std::memory_order_relaxed)) return;
  const std::lock_guard<std::mutex> lock(message_mutex);
  failed = false;
  // One of an earlier scene or run is no longer true.
  const yade::Scene* scene = yade::Omega::instance().getScene().get();
  const long since = scene->iter - failed_iteration;
  if (scene != failed_scene || since < 0 || since > 1) return;
  throw std::runtime_error(first_message);
}

}  // namespace statejump::dem
