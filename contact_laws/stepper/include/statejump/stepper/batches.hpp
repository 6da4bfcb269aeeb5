// SPDX-License-Identifier: GPL-3.0-or-later
// Steps the contacts and bodies of a scene in SIMD batches of four, where possible. Between steps,
// the arrays of the scene hold the motion of every body that other code reads. Contact states, and
// the motion of bodies with a single contact, stay in the batches until unload().
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <variant>
#include <vector>

#include "statejump/stepper/arrays.hpp"
#include "statejump/stepper/body_lanes.hpp"
#include "statejump/stepper/contact_lanes.hpp"

namespace statejump::stepper {

/// Scene data read and written by batches.
struct BatchedArrays {
  std::vector<Body>& bodies;
  std::vector<Contact>& contacts;
  const std::vector<Stage>& stages;
  const std::vector<Strain>& strains;
  Energies& energies;
  const Newton& newton;
  double time_step;  ///< [s]
  bool tracks_energy;
  bool uses_avx2;
};

class Batches {
 public:
  /// @param arrays after Scene::prepare()
  explicit Batches(const BatchedArrays& arrays) : arrays_(arrays) {}

  /// @param hertz_mindlin whether all contacts have the Hertz–Mindlin law
  /// @param nothing_between whether no engine between the contacts and the integrator sums the
  ///     forces
  void fill(bool hertz_mindlin, bool nothing_between);

  /// Whether fill() found contacts or bodies for a batch.
  bool useful() const { return useful_; }

  /// Steps all contacts in their order.
  /// @param one function that steps the contact with a given index; it returns false if it cannot
  template <class One>
  bool step_contacts(const One& one) {
    if (arrays_.uses_avx2) {
      return arrays_.tracks_energy ? with_avx2<true>(one) : with_avx2<false>(one);
    }
    return arrays_.tracks_energy ? step_all<true>(one) : step_all<false>(one);
  }

  /// Moves the bodies in batches. @return false if a body has left its collider bound
  bool move() { return arrays_.uses_avx2 ? move_with_avx2() : move_all(); }

  /// Indices of the bodies outside the batches, in their order.
  const std::vector<std::size_t>& others() const { return others_; }

  /// Writes the contact states and the body motions back to the arrays.
  void unload();

 private:
  // Consecutive contacts, which either form one batch or are stepped one by one.
  struct ContactRun {
    bool is_batch;
    std::size_t first, count;  // if is_batch, `first` is the index in contacts_
  };

  static bool allows(const Contact& contact) {
    return !contact.rotates && contact.joint != Joint::outer_balls &&
           contact.joint != Joint::bore && contact.physics.slipMemory.empty() &&
           !(contact.joint == Joint::revolute && contact.tilted);
  }
  // Contacts of a batch. It has a mover (a batch of bodies) if the contacts' first bodies have no
  // other interaction.
  struct Batch {
    ContactLanes contacts;
    std::size_t mover;  // index in movers_, or `none`
  };
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  void fill_movers();
  void fill_bodies(bool is_simple);
  std::vector<int> interaction_counts() const;
  void add(std::size_t first, std::size_t count);
  void load(ContactLanes& batch, std::size_t lane);

  template <bool tracks_energy, class One>
#ifdef __x86_64__
  [[gnu::target("avx2")]]
#endif
  bool
  with_avx2(const One& one) {
    return step_all<tracks_energy>(one);
  }
#ifdef __x86_64__
  [[gnu::target("avx2")]]
#endif
  bool
  move_with_avx2() {
    return move_all();
  }

  template <bool tracks_energy, class One>
  [[gnu::always_inline]] inline bool step_all(const One& one);
  using Places = std::array<std::size_t, lanes>;
  [[gnu::always_inline]] inline const kernel::BodyMotion& motion(std::size_t body) const {
    return arrays_.bodies[body].motion;
  }
  [[gnu::always_inline]] inline MotionLanes motions(const Places& at) const {
    const kernel::BodyMotion &a = motion(at[0]), &b = motion(at[1]), &c = motion(at[2]),
                             &d = motion(at[3]);
    return {gather(a.position, b.position, c.position, d.position),
            gather(a.velocity, b.velocity, c.velocity, d.velocity)};
  }
  [[gnu::always_inline]] inline Pack thermal_stretch(const Places& at) const {
    const std::vector<Strain>& all = arrays_.strains;
    return 1.0 + Pack{all[at[0]].strain, all[at[1]].strain, all[at[2]].strain, all[at[3]].strain};
  }
  template <bool tracks_energy>
  [[gnu::always_inline]] inline LanesStep step(ContactLanes& batch, const MotionLanes& one);
  template <bool tracks_energy>
  [[gnu::always_inline]] inline void account(const LanesStep& step, std::size_t lane);
  template <bool tracks_energy, class One>
  [[gnu::always_inline]] inline bool act(ContactLanes& batch, const LanesStep& step,
                                         const One& one);
  template <bool tracks_energy, class One>
  [[gnu::always_inline]] inline bool step_and_move(ContactLanes& batch, BodyLanes& bodies,
                                                   const One& one);
  template <bool tracks_energy, class One>
  [[gnu::cold, gnu::noinline]] bool apply_via_arrays(ContactLanes& batch, BodyLanes& bodies,
                                                     const LanesStep& step, const One& one,
                                                     Pack3& added);
  [[gnu::always_inline]] inline void apply(const ContactLanes& batch, std::size_t lane,
                                           const Vector3& force);
  void unload(const BodyLanes& batch);
  template <class One>
  [[gnu::cold, gnu::noinline]] bool step_one(ContactLanes& batch, std::size_t lane, const One& one);
  [[gnu::always_inline]] inline bool move_all();

  BatchedArrays arrays_;
  std::vector<Batch> contacts_;
  std::vector<ContactRun> runs_;
  std::vector<BodyLanes> movers_, bodies_;  // bodies moved with their contact; other bodies
  std::vector<std::size_t> others_;
  bool useful_ = false;
};

inline void Batches::fill(bool hertz_mindlin, bool nothing_between) {
  contacts_.clear();
  runs_.clear();
  const std::vector<Contact>& all = arrays_.contacts;
  for (std::size_t first = 0; first < all.size();) {
    std::size_t end = first;
    while (hertz_mindlin && end < all.size() && end - first < lanes && allows(all[end]) &&
           all[end].joint == all[first].joint) {
      ++end;
    }
    if (end > first + 1) {  // a single contact is faster without a batch
      add(first, end - first);
      first = end;
    } else {
      if (runs_.empty() || runs_.back().is_batch) runs_.push_back({false, first, 0});
      ++runs_.back().count;
      ++first;
    }
  }
  // Kinetic energies are summed body by body, so batches of bodies require zero damping and
  // gravity, or no energy tracking.
  const bool is_simple =
      nothing_between &&
      (!arrays_.tracks_energy || (arrays_.newton.damping == 0 && arrays_.newton.gravity.isZero(0)));
  movers_.clear();
  if (is_simple) fill_movers();
  fill_bodies(is_simple);
  useful_ = !contacts_.empty() || !bodies_.empty();
}

// Number of interactions of each body.
inline std::vector<int> Batches::interaction_counts() const {
  std::vector<int> interaction_counts(arrays_.bodies.size(), 0);
  const auto count = [&](const auto& list) {
    for (const auto& one : list) {
      for (const int body : bodies_of(one)) ++interaction_counts[static_cast<std::size_t>(body)];
    }
  };
  count(arrays_.contacts);
  for (const Stage& stage : arrays_.stages) {
    std::visit([&](const auto& one) { count(entries(one)); }, stage);
  }
  return interaction_counts;
}

inline void Batches::fill_movers() {
  if (contacts_.empty()) return;
  const std::vector<int> interaction_counts = this->interaction_counts();
  for (Batch& batch : contacts_) {
    const ContactLanes& contacts = batch.contacts;
    bool alone = !contacts.any_moves_2;
    for (std::size_t lane = 0; lane < contacts.count; ++lane) {
      alone = alone && contacts.moves_1[lane] && interaction_counts[contacts.body_1[lane]] == 1;
    }
    if (!alone) continue;
    batch.mover = movers_.size();
    BodyLanes& bodies = movers_.emplace_back();
    bodies.count = contacts.count;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      bodies.load(lane, contacts.body_1[lane], arrays_.bodies[contacts.body_1[lane]],
                  arrays_.newton);
      if (lane >= contacts.count) bodies.bounded[lane] = 0;  // unused lane: has no contact force
    }
  }
}

inline void Batches::fill_bodies(bool is_simple) {
  bodies_.clear();
  others_.clear();
  std::vector<bool> moved(arrays_.bodies.size(), false);
  for (const BodyLanes& batch : movers_) {
    for (const std::size_t body : batch.body) moved[body] = true;
  }
  for (std::size_t i = 0; i < arrays_.bodies.size(); ++i) {
    const Body& body = arrays_.bodies[i];
    if (!body.moves || moved[i]) continue;
    if (body.rotates || !is_simple) {
      others_.push_back(i);
      continue;
    }
    if (bodies_.empty() || bodies_.back().count == lanes) {
      BodyLanes& batch = bodies_.emplace_back();
      for (std::size_t lane = 1; lane < lanes; ++lane) batch.load(lane, i, body, arrays_.newton);
    }
    BodyLanes& batch = bodies_.back();
    batch.load(batch.count, i, body, arrays_.newton);
    ++batch.count;
  }
  if (bodies_.size() == 1 && bodies_.front().count == 1) {
    others_.insert(std::upper_bound(others_.begin(), others_.end(), bodies_.front().body[0]),
                   bodies_.front().body[0]);
    bodies_.clear();
  }
}

inline void Batches::add(std::size_t first, std::size_t count) {
  runs_.push_back({true, contacts_.size(), 1});
  contacts_.emplace_back().mover = none;
  ContactLanes& batch = contacts_.back().contacts;
  batch.first = first;
  batch.count = count;
  batch.joint = arrays_.contacts[first].joint;
  batch.any_moves_2 = batch.spins = false;
  for (std::size_t lane = 0; lane < lanes; ++lane) load(batch, lane);
}

inline void Batches::load(ContactLanes& batch, std::size_t lane) {
  const bool used = lane < batch.count;
  const Contact& contact = arrays_.contacts[batch.first + (used ? lane : 0)];
  const auto at = [&](int id) { return static_cast<std::size_t>(id); };
  const Body& one = arrays_.bodies[at(contact.body_1)];
  const Body& two = arrays_.bodies[at(contact.body_2)];
  batch.used[lane] = used ? -1 : 0;
  batch.body_1[lane] = at(contact.body_1);
  batch.body_2[lane] = at(contact.body_2);
  batch.strain_1[lane] = contact.strain_1;
  batch.strain_2[lane] = contact.strain_2;
  batch.moves_1[lane] = one.moves;
  batch.moves_2[lane] = two.moves;
  batch.any_moves_2 = batch.any_moves_2 || two.moves;
  batch.length_1[lane] = contact.length_1;
  batch.length_2[lane] = contact.length_2;
  put(batch.axis, lane,
      contact.joint == Joint::plane ? Vector3(two.orientation * contact.face_normal)
                                    : contact.axis);
  put(batch.position_2, lane, two.motion.position);
  put(batch.velocity_2, lane, two.motion.velocity);
  put(batch.spin_1, lane, one.motion.angular_velocity);
  put(batch.spin_2, lane, two.motion.angular_velocity);
  // Without spins, every product with a spin is 0 and can change only the sign of a zero sum. A
  // velocity that is not -0 never becomes -0 in this way.
  for (const Body* body : {&one, &two}) {
    for (int i = 0; i < 3; ++i) {
      const double velocity = body->motion.velocity[i];
      batch.spins = batch.spins || body->motion.angular_velocity[i] != 0 ||
                    (velocity == 0 && std::signbit(velocity));
    }
  }
  batch.load(lane, contact);
  if (!used) batch.real[lane] = 0;
}

inline void Batches::unload() {
  for (const Batch& batch : contacts_) {
    for (std::size_t lane = 0; lane < batch.contacts.count; ++lane) {
      batch.contacts.unload(lane, arrays_.contacts[batch.contacts.first + lane]);
    }
  }
  for (const BodyLanes& batch : movers_) unload(batch);
}

inline void Batches::unload(const BodyLanes& batch) {
  for (std::size_t lane = 0; lane < batch.count; ++lane) {
    kernel::BodyMotion& motion = arrays_.bodies[batch.body[lane]].motion;
    motion.position = get(batch.position, lane);
    motion.velocity = get(batch.velocity, lane);
  }
}

template <bool tracks_energy>
LanesStep Batches::step(ContactLanes& batch, const MotionLanes& one) {
  const MotionLanes two =
      batch.any_moves_2 ? motions(batch.body_2) : MotionLanes{batch.position_2, batch.velocity_2};
  return step_lanes<tracks_energy>(
      batch, one, two, batch.length_1 * thermal_stretch(batch.strain_1),
      batch.length_2 * thermal_stretch(batch.strain_2), arrays_.time_step);
}

inline void Batches::apply(const ContactLanes& batch, std::size_t lane, const Vector3& force) {
  if (batch.moves_1[lane]) arrays_.bodies[batch.body_1[lane]].added_force += force;
  if (batch.moves_2[lane]) arrays_.bodies[batch.body_2[lane]].added_force += -force;
}

template <bool tracks_energy>
void Batches::account(const LanesStep& step, std::size_t lane) {
  if constexpr (tracks_energy) {
    arrays_.energies.joint_friction += step.friction[lane];
    arrays_.energies.joint_damping += step.damping[lane];
    arrays_.energies.joint_thermal_work += step.thermal_work[lane];
  }
}

template <class One>
bool Batches::step_one(ContactLanes& batch, std::size_t lane, const One& one) {
  const std::size_t index = batch.first + lane;
  Contact& contact = arrays_.contacts[index];
  batch.unload(lane, contact);
  const bool made = one(index);
  batch.load(lane, contact);
  return made;
}

// Writes the forces and energies of a batch to the arrays.
template <bool tracks_energy, class One>
bool Batches::act(ContactLanes& batch, const LanesStep& step, const One& one) {
  const bool whole = !any(step.deferred);
  for (std::size_t lane = 0; lane < batch.count; ++lane) {
    if (!whole && step.deferred[lane]) {
      if (!step_one(batch, lane, one)) return false;
    } else if (step.touches[lane]) {
      account<tracks_energy>(step, lane);
      apply(batch, lane, get(step.force, lane));
    }
  }
  return true;
}

// Like apply(), but through the scene arrays, for bodies moved with this batch.
// @param added forces [N]
template <bool tracks_energy, class One>
bool Batches::apply_via_arrays(ContactLanes& batch, BodyLanes& bodies, const LanesStep& step,
                               const One& one, Pack3& added) {
  unload(bodies);
  const bool made = act<tracks_energy>(batch, step, one);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    put(added, lane, arrays_.bodies[bodies.body[lane]].added_force);
  }
  for (const std::size_t body : bodies.body) arrays_.bodies[body].added_force = Vector3::Zero();
  return made;
}

template <bool tracks_energy, class One>
bool Batches::step_and_move(ContactLanes& batch, BodyLanes& bodies, const One& one) {
  const LanesStep step = this->step<tracks_energy>(batch, {bodies.position, bodies.velocity});
  Pack3 added = select(step.touches, Pack3{} + step.force, Pack3{});
  if (any(step.deferred)) {
    if (!apply_via_arrays<tracks_energy>(batch, bodies, step, one, added)) return false;
  } else if constexpr (tracks_energy) {
    for (std::size_t lane = 0; lane < batch.count; ++lane) {
      if (step.touches[lane]) account<true>(step, lane);
    }
  }
  return !any(move_lanes(bodies, added, arrays_.newton, arrays_.time_step));
}

template <bool tracks_energy, class One>
bool Batches::step_all(const One& one) {
  for (const ContactRun& stretch : runs_) {
    if (!stretch.is_batch) {
      for (std::size_t i = stretch.first; i < stretch.first + stretch.count; ++i) {
        if (!one(i)) return false;
      }
      continue;
    }
    auto& [batch, mover] = contacts_[stretch.first];
    if (mover != none) {
      if (!step_and_move<tracks_energy>(batch, movers_[mover], one)) return false;
    } else {
      const LanesStep step = this->step<tracks_energy>(batch, motions(batch.body_1));
      if (!act<tracks_energy>(batch, step, one)) return false;
    }
  }
  return true;
}

inline bool Batches::move_all() {
  for (BodyLanes& batch : bodies_) {
    const auto added = [&](std::size_t lane) -> const Vector3& {
      return arrays_.bodies[batch.body[lane]].added_force;
    };
    const Mask deferred = move_lanes(batch, gather(added(0), added(1), added(2), added(3)),
                                     arrays_.newton, arrays_.time_step);
    for (std::size_t lane = 0; lane < batch.count; ++lane) {
      Body& body = arrays_.bodies[batch.body[lane]];
      body.motion.position = get(batch.position, lane);
      body.motion.velocity = get(batch.velocity, lane);
      body.added_force = Vector3::Zero();
    }
    if (any(deferred)) return false;
  }
  return true;
}

}  // namespace statejump::stepper
