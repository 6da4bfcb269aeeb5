// SPDX-License-Identifier: GPL-3.0-or-later
#include "failure.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iostream>
#include <mutex>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "contact_parts.hpp"
#include "faults.hpp"
#include "yade_api.hpp"

namespace statejump::dem {
namespace {

std::atomic<bool> failed{false};
std::mutex message_mutex;
Failure first_failure;
std::optional<Failure> thrown_failure;
const yade::Scene* failed_scene = nullptr;
long failed_iteration = 0;
// Stored per thread, because YADE makes each run and each single step in a separate thread.
thread_local const yade::Scene* looked_at = nullptr;

bool raised_by_an_engine(const yade::Scene& scene) {
  return std::any_of(scene.engines.begin(), scene.engines.end(), [](const auto& engine) {
    return dynamic_cast<const RaisesFailures*>(engine.get()) != nullptr;
  });
}

}  // namespace

std::string Failure::sentence() const {
  const std::string bodies = std::to_string(id1) + " and " + std::to_string(id2);
  switch (part) {
    case Part::contact:
      return before + after + " (contact of bodies " + bodies + ", " + when + ")";
    case Part::scene:
      return before + after + " (" + when + ")";
    case Part::body:
      return before + "body " + std::to_string(id1) + after + " (" + when + ")";
    case Part::link:
      return before + "the link between bodies " + bodies + after + " (" + when + ")";
    case Part::prismatic_joint:
      return before + "the prismatic joint between bodies " + bodies + after + " (" + when + ")";
    case Part::beam:
      return before + "the beam between bodies " + bodies + after + " (" + when + ")";
    case Part::torsion_spring:
      break;
  }
  return before + "the torsion spring between the links of bodies " + bodies + after + " (" + when +
         ")";
}

std::string text_of(yade::Real value, int digits) {
  std::ostringstream text;
  text.precision(digits);
  text << value;
  return text.str();
}

std::string text_of(const yade::Vector3r& value) {
  return "(" + text_of(value[0]) + ", " + text_of(value[1]) + ", " + text_of(value[2]) + ")";
}

Failure failure(const yade::Scene& scene, Failure::Part part, int id1, int id2, std::string before,
                std::string after, FailureDetail detail, yade::Real stable_time_step) {
  return {part,
          id1,
          id2,
          std::move(before),
          std::move(after),
          scene.time,
          stable_time_step,
          when(scene),
          std::move(detail)};
}

Failure unstable_time_step(const yade::Scene& scene, Failure::Part part, int id1, int id2,
                           yade::Real stable) {
  return failure(scene, part, id1, id2,
                 "the time step " + text_of(scene.dt, 6) + " s is above the stable one of ",
                 ", " + text_of(stable, 6) + " s",
                 {"time_step_unstable", "O.dt", text_of(scene.dt)}, stable);
}

void record_failure(FailureDetail detail, const std::string& sentence, const yade::Scene& scene,
                    const yade::Interaction& contact) {
  if (auto fault = fault_of_contact(scene, contact)) return record_failure(*std::move(fault));
  record_failure(failure(scene, Failure::Part::contact, contact.id1, contact.id2, sentence, "",
                         std::move(detail)));
}

void record_failure(Failure failure) {
  const std::lock_guard<std::mutex> lock(message_mutex);
  yade::Scene* scene = yade::Omega::instance().getScene().get();
  if (failed && failed_scene == scene && failed_iteration == scene->iter) return;
  first_failure = std::move(failure);
  failed_scene = scene;
  failed_iteration = scene->iter;
  failed = true;
  if (raised_by_an_engine(*scene)) return;
  // If no engine will throw the failure, print it and end the run.
  std::cerr << "statejump_yade: " << first_failure.sentence() << std::endl;
  scene->stopAtIter = scene->iter + 1;
}

namespace {

void throw_recorded_failure() {
  const std::lock_guard<std::mutex> lock(message_mutex);
  failed = false;
  // Ignore a failure of another scene or an earlier run.
  const yade::Scene* scene = yade::Omega::instance().getScene().get();
  const long since = scene->iter - failed_iteration;
  if (scene != failed_scene || since < 0 || since > 1) return;
  thrown_failure = first_failure;
  throw std::runtime_error(first_failure.sentence());
}

}  // namespace

void RaisesFailures::begin(const yade::Scene& scene) {
  if (failed.load(std::memory_order_relaxed)) throw_recorded_failure();
  const bool is_step = scene.dt > 0 && scene.dt <= std::numeric_limits<yade::Real>::max();
  if (is_step && looked_at == &scene) return;
  if (auto fault = fault_of_scene(scene)) throw_failure(*std::move(fault));
  looked_at = &scene;
}

void throw_failure(Failure failure) {
  const std::lock_guard<std::mutex> lock(message_mutex);
  const std::string sentence = failure.sentence();
  thrown_failure = std::move(failure);
  throw std::runtime_error(sentence);
}

boost::python::object take_failure() {
  namespace py = boost::python;
  const std::lock_guard<std::mutex> lock(message_mutex);
  if (!thrown_failure) return py::object();
  const Failure taken = *std::exchange(thrown_failure, std::nullopt);
  const char* const parts[] = {"contact", "link", "torsion_spring", "prismatic_joint",
                               "beam",    "body", "scene"};
  py::dict result;
  result["part"] = parts[static_cast<std::size_t>(taken.part)];
  py::list bodies;
  for (const int id : {taken.id1, taken.id2}) {
    if (id >= 0) bodies.append(id);
  }
  result["bodies"] = py::tuple(bodies);
  result["before"] = taken.before;
  result["after"] = taken.after;
  result["time"] = taken.time;
  result["stable_time_step"] =
      std::isnan(taken.stable_time_step) ? py::object() : py::object(taken.stable_time_step);
  result["code"] = taken.detail.code;
  result["quantity"] = taken.detail.quantity;
  result["value"] = taken.detail.value;
  result["allowed"] = taken.detail.allowed;
  result["sentence"] = taken.sentence();
  return result;
}

}  // namespace statejump::dem
