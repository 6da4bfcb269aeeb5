#include "failure.hpp"

#include <algorithm>
#include <atomic>
#include <iostream>
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

bool raised_by_an_engine(const yade::Scene& scene) {
  return std::any_of(scene.engines.begin(), scene.engines.end(), [](const auto& engine) {
    return dynamic_cast<const RaisesFailures*>(engine.get()) != nullptr;
  });
}

}  // namespace

void record_failure(const std::string& message) {
  const std::lock_guard<std::mutex> lock(message_mutex);
  yade::Scene* scene = yade::Omega::instance().getScene().get();
  if (failed && failed_scene == scene && failed_iteration == scene->iter) return;
  first_message = message;
  failed_scene = scene;
  failed_iteration = scene->iter;
  failed = true;
  if (raised_by_an_engine(*scene)) return;
  // Nobody will raise it: say it and end the run.
  std::cerr << "statejump_yade: " << message << std::endl;
  scene->stopAtIter = scene->iter + 1;
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
