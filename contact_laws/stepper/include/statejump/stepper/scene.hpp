// SPDX-License-Identifier: GPL-3.0-or-later
// A scene of clearance joints, links and torsion springs as plain arrays, and its time steps. A
// step does the work of YADE's engines, in the same order, without YADE.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "statejump/kernel/laws/static_law.hpp"
#include "statejump/stepper/arrays.hpp"
#include "statejump/stepper/batches.hpp"
#include "statejump/stepper/bore.hpp"
#include "statejump/stepper/checks.hpp"
#include "statejump/stepper/stable_link.hpp"
#include "statejump/thermal/program.hpp"

namespace statejump::stepper {

/// The default contact law, which is not composed of named laws.
struct HertzMindlin {};

class Scene {
 public:
  double time = 0;       ///< [s]
  double time_step = 0;  ///< [s]
  long iteration = 0;
  bool tracks_energy = false;
  bool uses_avx2 = has_avx2();
  double largest_tilt = 0;  ///< allowed angle between the axes of journal and bearing [rad]
  Newton newton;
  std::vector<thermal::Program> programs;
  std::vector<Strain> strains;
  std::vector<Heater> heaters;
  std::vector<Body> bodies;
  std::vector<Contact> contacts;
  std::vector<Bore> bores;
  std::vector<Stage> stages;
  std::variant<HertzMindlin, NamedLaw> law;
  NamedLaw bore_law;  ///< for contacts with meshed bores
  Energies energies;
  StoredEnergies stored;  ///< of the last step of run()
  FirstTouch begun, begun_in_bores;
  bool any_contact = false;  ///< a contact was computed since the arrays were filled

  /// Creates the physics of the contact with a given index when it begins; nothing for invalid
  /// materials.
  using CreatePhysics = std::function<std::optional<ContactPhysics>(std::size_t)>;

  /// Function called in the last step of a run, between forces and motion. Positions, forces and
  /// contacts then belong to the same time; velocities are half a step older.
  using Observe = std::function<void()>;

  /// Computes derived data, such as which bodies rest or move; call it after filling the arrays.
  void prepare();

  /// Makes steps until YADE must make one itself. Reasons: a failure, which YADE's own loop
  /// reports, or a body that leaves its bound, so that the collider must run. That step is left
  /// incomplete; the caller then fills the arrays again and repeats the complete steps.
  /// @param observe called in the last step; may be empty
  /// @return number of complete steps
  long run(long steps, const CreatePhysics& make, const Observe& observe = {});

  /// Whether all numbers that a step writes are finite.
  bool has_finite_state() const;

 private:
  // Receives the forces and energies of one contact.
  struct Host {
    Scene& scene;
    const Contact& contact;
    double time_step() const { return scene.time_step; }
    bool tracks_energy() const { return scene.tracks_energy; }
    void add(const ContactEnergy& energy) {
      scene.stored.joint += energy.elastic;
      scene.energies.joint_friction += energy.friction;
      scene.energies.joint_damping += energy.damping;
      scene.energies.joint_thermal_work += energy.thermal_work;
    }
    void apply(const kernel::Wrench& wrench) {
      Body& one = scene.bodies[static_cast<std::size_t>(contact.body_1)];
      Body& two = scene.bodies[static_cast<std::size_t>(contact.body_2)];
      if (one.moves) {
        one.added_force += wrench.force_1;
        if (one.rotates) one.added_torque += wrench.torque_1;
      }
      if (two.moves) {
        two.added_force += wrench.force_2;
        if (two.rotates) two.added_torque += wrench.torque_2;
      }
    }
    static constexpr bool checks_response = false;  // step_contact() checks afterwards
  };

  // Returns whether the angle between the axes of a journal and its bearing exceeds largest_tilt.
  bool is_tilted(const Body& journal, const Vector3& axis) const {
    return !(axis_of(journal.orientation).cross(axis).squaredNorm() <= largest_tilt * largest_tilt);
  }
  Body& body(int id) { return bodies[static_cast<std::size_t>(id)]; }
  template <class Contacts, class Move>
  bool step(const Contacts& contacts_of_all, const Move& move);
  bool sums_before_moving() const;
  bool change_temperatures();
  bool keeps_lengths_positive(std::size_t program) const;
  void measure_links();
  void heat();
  template <class Law>
  bool step_contact(const Law& law, std::size_t index, const CreatePhysics& make);
  template <class Law>
  bool step_named(const Named<Law>& named, const Contact& contact, const ContactGeometry& geometry,
                  ContactPhysics& physics, FirstTouch& begun_contacts, bool& touches);
  template <class Act>
  decltype(auto) with_law(Act&& act) const;
  bool step_in_bore(std::size_t index, const CreatePhysics& make);
  BoreSearch find(const Contact& contact, Bore& bore);
  bool accepts(const ContactPhysics& physics) const;
  ContactSearch find(Contact& contact);
  bool act(Links& group);
  bool act(std::vector<TorsionEntry>& springs);
  bool act(std::vector<Prismatic>& joints);
  bool act(std::vector<Guide>& guides);
  void sum();
  void account_motion(const Body& body);
  bool move_all(const std::vector<std::size_t>& indices, bool last);

  std::vector<std::size_t> moving_;
  std::vector<double> changes_;  // temperature changes of the programs in this step [K]
  std::vector<double>
      safe_changes_;  // per program: keeps_lengths_positive() holds for smaller |changes| [K]
  std::vector<Vector3> scratch_;  // moments on tips, forces across planes
  bool summed_ = false;
};

inline void Scene::prepare() {
  for (Body& each : bodies) {
    each.added_force = each.added_torque = Vector3::Zero();
    each.rotates = can_rotate(each);
    each.moves = !is_at_rest(each);
  }
  for (Stage& stage : stages) {
    auto* links = std::get_if<Links>(&stage);
    if (!links) continue;
    for (LinkEntry& entry : links->links) {
      Body& tip = body(entry.link.id2);
      entry.inverse_mass = body(entry.link.id1).inverse_mass + tip.inverse_mass;
      entry.damping = damping_coefficient(entry.link, entry.inverse_mass);
      entry.softening = previous_softening(entry.link);
      if (!entry.link.tipTurnsWithLink) continue;
      tip.rotates = tip.moves = tip.rotation_deferrable = true;
    }
  }
  for (const Contact& contact : contacts) {
    if (contact.joint != Joint::plane && contact.joint != Joint::bore) continue;
    for (const int id : bodies_of(contact)) body(id).rotation_deferrable = false;
  }
  moving_.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].moves) moving_.push_back(i);
  }
  changes_.assign(programs.size(), 0);
  safe_changes_.assign(programs.size(), std::numeric_limits<double>::infinity());
  const auto limit = [&](std::size_t program, double change) {
    safe_changes_[program] = std::min(safe_changes_[program], change);
  };
  for (const Heater& heater : heaters) {
    for (const Heater::Target& target : heater.targets) {
      limit(heater.program, safe_temperature_change(target.expansion));
    }
  }
  for (const Stage& stage : stages) {
    const auto* links = std::get_if<Links>(&stage);
    if (!links) continue;
    for (const LinkEntry& entry : links->links) {
      const bool has_length = entry.link.stressFreeLength > 0;
      limit(entry.program, has_length ? safe_temperature_change(entry.link.thermalExpansion) : 0);
    }
  }
  for (Contact& contact : contacts) {
    const Body& one = body(contact.body_1);
    const Body& two = body(contact.body_2);
    contact.rotates = one.rotates || two.rotates;
    contact.axis = axis_of(two.orientation);
    contact.tilted = is_tilted(one, contact.axis);
    contact.stable_stiffness = stable_stiffness(contact.physics, time_step);
  }
}

inline bool Scene::sums_before_moving() const {
  return std::any_of(stages.begin(), stages.end(), [](const Stage& stage) {
    const auto* links = std::get_if<Links>(&stage);
    return links ? links->needs_moments : std::holds_alternative<std::vector<Guide>>(stage);
  });
}

// Calls `act` with the contact law, as its static type if this is precompiled.
template <class Act>
decltype(auto) Scene::with_law(Act&& act) const {
  const auto* named = std::get_if<NamedLaw>(&law);
  if (!named) return act(std::get<HertzMindlin>(law));
  return kernel::laws::with_precompiled_law(named->law, [&](const auto& known) {
    return act(Named<std::decay_t<decltype(known)>>{known, named->needs_axis});
  });
}

inline long Scene::run(long steps, const CreatePhysics& make, const Observe& observe) {
  return with_law([&](const auto& one) {
    const auto contact = [&](std::size_t index) { return step_contact(one, index, make); };
    long done = 0;
    if (steps > 1) {
      Batches batches({bodies, contacts, stages, strains, energies, newton, time_step,
                       tracks_energy, uses_avx2});
      batches.fill(std::is_same_v<decltype(one), const HertzMindlin&>, !sums_before_moving());
      // The last step is made without batches, so that all data are in the arrays afterwards.
      while (done < steps - 1 && batches.useful() &&
             step([&] { return batches.step_contacts(contact); },
                  [&] { return batches.move() && move_all(batches.others(), false); })) {
        ++done;
      }
      if (batches.useful() && done < steps - 1) return done;
      batches.unload();
    }
    const auto one_by_one = [&] {
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (!contact(i)) return false;
      }
      return true;
    };
    const auto observed = [&] {
      const bool last = done == steps - 1;
      if (observe && last) {
        sum();
        observe();
      }
      return move_all(moving_, last);
    };
    while (done < steps && step(one_by_one, observed)) ++done;
    return done;
  });
}

template <class Contacts, class Move>
bool Scene::step(const Contacts& contacts_of_all, const Move& move) {
  summed_ = false;
  stored = {};
  measure_links();
  if (!change_temperatures()) return false;
  heat();
  if (!contacts_of_all()) return false;
  for (Stage& stage : stages) {
    if (!std::visit([&](auto& list) { return act(list); }, stage)) return false;
  }
  if (!move()) return false;
  time += time_step;
  ++iteration;
  return true;
}

inline bool Scene::has_finite_state() const {
  const auto of_links = [](const auto& stage) {
    using Kind = std::decay_t<decltype(stage)>;
    if constexpr (std::is_same_v<Kind, Links>) {
      return std::all_of(stage.links.begin(), stage.links.end(), [](const LinkEntry& entry) {
        return std::isfinite(entry.link.axialForce);
      });
    } else {
      return true;
    }
  };
  return std::all_of(bodies.begin(), bodies.end(),
                     [](const Body& each) { return is_finite(each.motion); }) &&
         std::all_of(contacts.begin(), contacts.end(),
                     [](const Contact& each) {
                       return is_finite(each.physics.normalForce) &&
                              is_finite(each.physics.shearForce);
                     }) &&
         std::all_of(bores.begin(), bores.end(),
                     [](const Bore& each) {
                       return is_finite(each.physics.normalForce) &&
                              is_finite(each.physics.shearForce);
                     }) &&
         std::all_of(stages.begin(), stages.end(),
                     [&](const Stage& stage) { return std::visit(of_links, stage); });
}

inline bool Scene::change_temperatures() {
  for (std::size_t i = 0; i < programs.size(); ++i) {
    changes_[i] = programs[i].temperature_change(time);
    if (!is_below(std::abs(changes_[i]), safe_changes_[i]) && !keeps_lengths_positive(i))
      return false;
  }
  return true;
}

// Whether all lengths that a program heats stay positive.
[[gnu::cold, gnu::noinline]] inline bool Scene::keeps_lengths_positive(std::size_t program) const {
  const double change = changes_[program];
  const auto of_heater = [&](const Heater& heater) {
    return heater.program != program || std::all_of(heater.targets.begin(), heater.targets.end(),
                                                    [&](const Heater::Target& target) {
                                                      return is_strain(target.expansion * change);
                                                    });
  };
  const auto of_stage = [&](const Stage& stage) {
    const auto* links = std::get_if<Links>(&stage);
    return !links ||
           std::all_of(links->links.begin(), links->links.end(), [&](const LinkEntry& entry) {
             return entry.program != program || stress_free_length(entry.link, change) > 0;
           });
  };
  return std::all_of(heaters.begin(), heaters.end(), of_heater) &&
         std::all_of(stages.begin(), stages.end(), of_stage);
}

inline void Scene::heat() {
  for (const Heater& heater : heaters) {
    const double change = changes_[heater.program];
    for (const Heater::Target& target : heater.targets) {
      Strain& now = strains[target.strain];
      const double strain = target.expansion * change;
      now.rate = (strain - now.strain) / time_step;
      now.strain = strain;
    }
  }
}

inline void Scene::sum() {
  for (const std::size_t i : moving_) sum_forces(bodies[i], !summed_);
  summed_ = true;
}

inline void Scene::account_motion(const Body& each) {
  const kernel::BodyMotion& motion = each.motion;
  if (newton.damping != 0 && each.damped) {
    energies.numerical_damping +=
        motion.velocity.cwiseAbs().dot(each.force.cwiseAbs()) * newton.damping * time_step;
    energies.numerical_damping +=
        motion.angular_velocity.cwiseAbs().dot(each.torque.cwiseAbs()) * newton.damping * time_step;
  }
  energies.gravity_work += -newton.gravity.dot(motion.velocity) * each.mass * time_step;
}

inline bool Scene::move_all(const std::vector<std::size_t>& indices, bool last) {
  for (const std::size_t i : indices) {
    Body& each = bodies[i];
    sum_forces(each, !summed_);
    if (tracks_energy) account_motion(each);
    move(each, newton, time_step, last);
    if (left_bound(each)) return false;
  }
  return true;
}

}  // namespace statejump::stepper

#include "statejump/stepper/scene_contacts.hpp"
#include "statejump/stepper/scene_stages.hpp"
