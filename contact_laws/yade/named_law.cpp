// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "contact_parts.hpp"
#include "failure.hpp"
#include "joint.hpp"
#include "joint_exchange.hpp"
#include "ranges.hpp"
#include "shapes.hpp"

namespace statejump::dem {
namespace {

namespace laws = kernel::laws;

// Returns the law of a given type and name, or throws an exception that lists the known names.
template <class Law>
Law law_by_name(Law (*find)(const std::string&), const char* class_name, const char* attribute,
                const std::string& name) {
  const std::vector<std::string> known = laws::law_names<Law>();
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    std::string allowed = "one of ";
    for (const std::string& each : known) allowed += each + ", ";
    allowed.resize(allowed.size() - 2);
    refuse(class_name, attribute, name, allowed);
  }
  if (const std::string problem = laws::law_problem<Law>(name); !problem.empty()) {
    refuse({"unusable_law", std::string(class_name) + "." + attribute, "'" + name + "'", problem});
  }
  return find(name);
}

// Keeps a sentence in memory until the program ends, which Python requires of documentation
// strings.
const char* kept(const std::string& sentence) {
  static std::mutex mutex;
  static std::set<std::string> sentences;
  const std::lock_guard<std::mutex> lock(mutex);
  return sentences.insert(sentence).first->c_str();
}

// Appends the names of the laws of one type that read a parameter, separated by commas.
template <class Law>
void add_readers(const laws::LawParameter& parameter, std::string& names) {
  for (const laws::LawInfo& info : laws::law_infos<Law>()) {
    const auto& read = info.parameters;
    if (std::find(read.begin(), read.end(), &parameter) == read.end()) continue;
    names.append(names.empty() ? "" : ", ").append(info.name);
  }
}

bool on_a_ball(const yade::Scene& scene, const yade::Interaction& contact) {
  const auto& body = body_at(scene, static_cast<std::size_t>(contact.id2));
  return dynamic_cast<const Ball*>(body->shape.get()) != nullptr;
}

// Example: "a Ball in a MeshBore".
std::string pair_of(const yade::Scene& scene, const yade::Interaction& contact, bool outside) {
  const auto shape = [&](int id) {
    return body_at(scene, static_cast<std::size_t>(id))->shape->getClassName();
  };
  std::string text = "a ";
  text.append(shape(contact.id1)).append(outside ? " on a " : " in a ").append(shape(contact.id2));
  return text;
}

}  // namespace

template <class Law>
const char* law_docs() {
  std::string text;
  for (const laws::LawInfo& info : laws::law_infos<Law>()) {
    text.append("'").append(info.name).append("': ").append(info.formula);
    text.append(" (").append(info.range);
    if (!info.has(laws::Trait::holds_static_load)) text += "; holds no static load";
    if (info.has(laws::Trait::needs_axis)) text += "; needs the axis of a Bearing";
    if (info.has(laws::Trait::needs_point_contact)) {
      text += "; needs normalLaw " + laws::names_with<laws::NormalLaw>(laws::Trait::point_contact);
    }
    text += "). ";
  }
  return kept(text + "[-]");
}
template const char* law_docs<laws::NormalLaw>();
template const char* law_docs<laws::DissipationLaw>();
template const char* law_docs<laws::FrictionLaw>();
template const char* law_docs<laws::TangentialVelocityLaw>();

const char* parameter_docs(const laws::LawParameter& parameter) {
  std::string readers;
  add_readers<laws::NormalLaw>(parameter, readers);
  add_readers<laws::DissipationLaw>(parameter, readers);
  add_readers<laws::FrictionLaw>(parameter, readers);
  return kept(readers + ": " + parameter.meaning + ", " + allowed_range(parameter));
}

void NamedJointLaw::build(const char* class_name) {
  laws::JointLaw law;
  law.normal = law_by_name(laws::normal_law, class_name, "normalLaw", normalLaw);
  law.dissipation =
      law_by_name(laws::dissipation_law, class_name, "dissipationLaw", dissipationLaw);
  law.friction = law_by_name(laws::friction_law, class_name, "frictionLaw", frictionLaw);
  law.tangential_velocity = law_by_name(laws::tangential_velocity_law, class_name,
                                        "tangentialVelocity", tangentialVelocity);
  if (!laws::are_compatible(law.normal, law.friction)) {
    dem::refuse(class_name, "normalLaw", normalLaw,
                laws::names_with<laws::NormalLaw>(laws::Trait::point_contact) +
                    " with frictionLaw '" + frictionLaw + "'");
  }
  require_allowed(class_name, "restitution", restitution, laws::restitution_of(law.dissipation));
  require_allowed(class_name, "smallestImpactSpeed", smallestImpactSpeed,
                  laws::parameter::smallest_impact_speed);
  require_allowed(class_name, "contactLength", contactLength, laws::parameter::contact_length);
  require_allowed(class_name, "v0", v0, laws::parameter::v0);
  if (!(v1 > v0 && std::isfinite(v1))) dem::refuse(class_name, "v1", v1, "above v0 [m/s]");
  law.restitution = restitution;
  law.smallest_impact_speed = smallestImpactSpeed;
  law.contact_length = contactLength;
  law.friction_parameters = {0, v0, v1};  // the friction coefficient belongs to each contact
  laws::validate(law);
  prepare(law.dissipation, law.restitution);
  named_.law = law;
  named_.needs_axis = laws::has(law.normal, laws::Trait::needs_axis) ||
                      laws::has(law.tangential_velocity, laws::Trait::needs_axis);
}

bool NamedJointLaw::step(const JointGeom& geometry, JointPhys& physics,
                         const yade::Interaction& contact, yade::Scene& scene) {
  switch (stepper::misfit(named_, geometry)) {
    case stepper::Misfit::bulging_wall:
      record_failure(
          {"law_for_flat_walls", "normalLaw", normalLaw},
          (on_a_ball(scene, contact) ? pair_of(scene, contact, true) : "a wall that bulges") +
              " needs normalLaw " +
              laws::names_with<laws::NormalLaw>(laws::Trait::accepts_bulging_wall) + ", not '" +
              normalLaw + "'",
          scene, contact);
      return true;
    case stepper::Misfit::no_axis:
      record_failure(
          {"law_needs_axis", "normalLaw, tangentialVelocity",
           normalLaw + ", " + tangentialVelocity},
          pair_of(scene, contact, std::isinf(geometry.bearingRadius) || on_a_ball(scene, contact)) +
              " needs normalLaw " +
              (geometry.bearingRadius < 0
                   ? laws::names_with<laws::NormalLaw>(laws::Trait::accepts_bulging_wall)
                   : laws::names_with<laws::NormalLaw>(laws::Trait::needs_axis, false)) +
              " and tangentialVelocity " +
              laws::names_with<laws::TangentialVelocityLaw>(laws::Trait::needs_axis, false) +
              ", not '" + normalLaw + "' and '" + tangentialVelocity + "'",
          scene, contact);
      return true;
    case stepper::Misfit::none:
      break;
  }
  if (geometry.penetrationDepth > 0 && !physics.begun) {
    const Real touched = stepper::begin(geometry, physics, scene.time, scene.dt);
    const std::lock_guard<std::mutex> lock(beginning_);
    stepper::FirstTouch begun{firstContactTime, contacts};
    begun.add(touched);
    firstContactTime = begun.first;
    contacts = begun.count;
  }
  const auto& state1 = *body_at(scene, static_cast<std::size_t>(contact.id1))->state;
  const auto& state2 = *body_at(scene, static_cast<std::size_t>(contact.id2))->state;
  try {
    return stepper::joint_law_step(named_.law, geometry, physics, motion(state1), motion(state2),
                                   ContactHost{scene, contact, energies_});
  } catch (const laws::DepthOutOfRange& left) {
    record_failure(
        {"law_left_range", left.law(), text_of(left.depth()), "below " + text_of(left.limit())},
        left.what(), scene, contact);
  } catch (const std::exception& error) {
    record_failure({"law_failed", normalLaw}, error.what(), scene, contact);
  }
  return true;
}

}  // namespace statejump::dem
