// SPDX-License-Identifier: GPL-3.0-or-later
#include "refusal.hpp"

#include <array>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace statejump::dem {
namespace {

// Code and sentence, with {key}, {value} and {allowed}.
constexpr std::array<std::pair<std::string_view, std::string_view>, 34> sentences{{
    {"not_allowed", "{key} = {value} is not allowed: must be {allowed}"},
    {"wrong_type", "{key} = {value} is not allowed: must be {allowed}"},
    {"unusable_law", "{key} = {value} cannot be used: {allowed}"},
    {"positional", "{key}: give attributes as keywords, name=value"},
    {"missing", "{key} is missing"},
    {"holds_none", "{key} holds None"},
    {"no_body", "{key}: there is no body {value}"},
    {"same_body", "{key} = {value} is not allowed: must be another body than {allowed}"},
    {"no_thermal_body", "{key}: body {value} needs a ThermalShape and a ThermalFrictMat"},
    {"rotations_free", "{key}: block the rotations of body {value} (blockedDOFs containing 'XYZ')"},
    {"other_number", "{key}: {value} ids, but {allowed} normals"},
    {"odd_ids", "{key} holds an odd number of ids: two of each contact"},
    {"contact_twice", "{key} names bodies {value} twice"},
    {"no_joint_contact", "{key}: the contact of bodies {value} has no JointGeom and JointPhys"},
    {"no_triangle", "a triangle has three corners, number {value} has another number of them"},
    // Scenes that a JointStepper cannot step
    {"other_yade", "JointStepper: the engines of this YADE have other attributes"},
    {"periodic", "JointStepper: the scene is periodic"},
    {"no_newton", "JointStepper: there is no NewtonIntegrator"},
    {"two_steppers", "JointStepper: there are two of them"},
    {"two_engines", "JointStepper: there are two {key}s"},
    {"unknown_engine", "JointStepper: it does not know the engine {key}"},
    {"misplaced_engine", "JointStepper: {key} stands in the wrong place, the order is {allowed}"},
    {"no_verlet_distance",
     "JointStepper: {key} must be {allowed}: without it the collider looks for contacts in every "
     "step"},
    {"must_be_off", "JointStepper: {key} must be off"},
    {"mask", "JointStepper: {key} must be -1: every body moves"},
    {"damped_gravity", "JointStepper: with O.trackEnergy and gravity {key} must be 0"},
    {"two_functors", "JointStepper: the InteractionLoop holds two of {key}"},
    {"unknown_functor", "JointStepper: it does not know {key} of the InteractionLoop"},
    {"two_laws", "JointStepper: the InteractionLoop holds two laws for the same contacts"},
    {"callbacks", "JointStepper: the InteractionLoop has callbacks"},
    {"clump", "JointStepper: {key} belongs to a clump"},
    {"unknown_shape", "JointStepper: it does not know the shape of {key}, {value}"},
    {"shape_heated_twice", "JointStepper: two ThermalExpansionEngines set the shape of {key}"},
    {"aspherical", "JointStepper: {key} is aspherical and free to turn about all axes"},
}};

std::mutex last_mutex;
std::optional<Refusal> last;

void fill(std::string& text, std::string_view name, const std::string& value) {
  const std::size_t at = text.find(name);
  if (at != std::string::npos) text.replace(at, name.size(), value);
}

}  // namespace

std::string sentence(const Refusal& refusal) {
  if (!refusal.said.empty()) return refusal.said;
  for (const auto& [code, words] : sentences) {
    if (code != refusal.code) continue;
    std::string text(words);
    fill(text, "{allowed}", refusal.allowed);
    fill(text, "{value}", refusal.value);
    fill(text, "{key}", refusal.key);
    return text;
  }
  return refusal.key + ": " + refusal.code;
}

void keep(const Refusal& refusal) {
  const std::lock_guard<std::mutex> lock(last_mutex);
  last = refusal;
}

void refuse(const Refusal& refusal) {
  keep(refusal);
  throw std::invalid_argument(sentence(refusal));
}

boost::python::object take_refusal() {
  std::optional<Refusal> taken;
  {
    const std::lock_guard<std::mutex> lock(last_mutex);
    taken = std::exchange(last, std::nullopt);
  }
  if (!taken) return boost::python::object();
  boost::python::dict result;
  result["code"] = taken->code;
  result["key"] = taken->key;
  result["value"] = taken->value;
  result["allowed"] = taken->allowed;
  result["sentence"] = sentence(*taken);
  return result;
}

}  // namespace statejump::dem
