// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a scene that do not feel each other: each makes all its steps while its numbers are
// near, and on as many cores as there are. What a part computes does not depend on the others, so
// neither the parts nor the number of threads change a bit.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <variant>
#include <vector>

#include "statejump/stepper/scene.hpp"

namespace statejump::stepper {

/// Bodies of a part: so many fit into a processor's first cache.
constexpr std::size_t bodies_of_a_part = 32;

namespace detail {

/// Sets of bodies that feel each other.
class Groups {
 public:
  explicit Groups(std::size_t count) : above_(count) {
    std::iota(above_.begin(), above_.end(), std::size_t{0});
  }
  std::size_t of(std::size_t one) {
    while (above_[one] != one) one = above_[one] = above_[above_[one]];
    return one;
  }
  void join(std::size_t one, std::size_t two) {
    const std::size_t first = of(one), second = of(two);
    above_[std::max(first, second)] = std::min(first, second);
  }

 private:
  std::vector<std::size_t> above_;
};

}  // namespace detail

/// A scene in parts. Bodies that rest may be in several of them.
class Parts {
 public:
  /// @param whole prepared
  explicit Parts(const Scene& whole) : whole_(whole) { split(); }

  std::size_t size() const { return parts_.size(); }

  /// Steps of all parts as Scene::run(); make is called from several threads.
  long run(long steps, const Scene::Make& make);
  /// Puts the parts back into a scene like the one they were made of. All have made equally many
  /// steps.
  void collect(Scene& whole) const;

 private:
  struct Part {
    Scene scene;
    std::vector<std::size_t> bodies, contacts;     // places in the whole
    std::vector<std::vector<std::size_t>> stages;  // of each stage
  };
  void split();
  void fill(Part& part, std::vector<int>& places) const;

  const Scene& whole_;
  std::vector<Part> parts_;
};

inline void Parts::split() {
  const auto moves = [&](int id) { return whole_.bodies[static_cast<std::size_t>(id)].moves; };
  detail::Groups groups(whole_.bodies.size());
  const auto join = [&](const auto& ids) {
    int first = -1;
    for (const int id : ids) {
      if (!moves(id)) continue;
      if (first >= 0) groups.join(static_cast<std::size_t>(first), static_cast<std::size_t>(id));
      first = id;
    }
    return first;
  };
  for (const Contact& contact : whole_.contacts) join(bodies_of(contact));
  for (const Stage& stage : whole_.stages) {
    std::visit(
        [&](const auto& one) {
          for (const auto& entry : entries(one)) join(bodies_of(entry));
        },
        stage);
  }
  // Groups in the order of their first body, several to a part.
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> size(whole_.bodies.size(), 0), part_of(whole_.bodies.size(), none);
  for (std::size_t i = 0; i < whole_.bodies.size(); ++i) {
    if (whole_.bodies[i].moves) ++size[groups.of(i)];
  }
  std::size_t filled = bodies_of_a_part;
  for (std::size_t i = 0; i < whole_.bodies.size(); ++i) {
    if (!whole_.bodies[i].moves) continue;
    const std::size_t group = groups.of(i);
    if (part_of[group] == none) {
      if (filled + size[group] > bodies_of_a_part) {
        parts_.emplace_back();
        parts_.back().stages.resize(whole_.stages.size());
        filled = 0;
      }
      filled += size[group];
      part_of[group] = parts_.size() - 1;
    }
    parts_[part_of[group]].bodies.push_back(i);
  }
  if (parts_.empty()) {
    parts_.emplace_back();
    parts_.back().stages.resize(whole_.stages.size());
  }
  // What holds resting bodies only belongs to the first part.
  const auto part_with = [&](const auto& ids) -> Part& {
    for (const int id : ids) {
      if (moves(id)) return parts_[part_of[groups.of(static_cast<std::size_t>(id))]];
    }
    return parts_.front();
  };
  for (std::size_t i = 0; i < whole_.contacts.size(); ++i) {
    part_with(bodies_of(whole_.contacts[i])).contacts.push_back(i);
  }
  for (std::size_t s = 0; s < whole_.stages.size(); ++s) {
    std::visit(
        [&](const auto& one) {
          const auto& list = entries(one);
          for (std::size_t i = 0; i < list.size(); ++i) {
            part_with(bodies_of(list[i])).stages[s].push_back(i);
          }
        },
        whole_.stages[s]);
  }
  std::vector<int> places(whole_.bodies.size(), -1);
  for (Part& part : parts_) fill(part, places);
}

inline void Parts::fill(Part& part, std::vector<int>& places) const {
  Scene& scene = part.scene;
  scene.time = whole_.time;
  scene.time_step = whole_.time_step;
  scene.iteration = whole_.iteration;
  scene.tracks_energy = whole_.tracks_energy;
  scene.uses_avx2 = whole_.uses_avx2;
  scene.largest_tilt = whole_.largest_tilt;
  scene.newton = whole_.newton;
  scene.programs = whole_.programs;
  scene.strains = whole_.strains;
  scene.heaters = whole_.heaters;
  scene.law = whole_.law;
  scene.bore_law = whole_.bore_law;
  std::vector<std::size_t> taken;
  const auto place = [&](int& id) {
    const auto body = static_cast<std::size_t>(id);
    if (places[body] < 0) {
      places[body] = static_cast<int>(scene.bodies.size());
      scene.bodies.push_back(whole_.bodies[body]);
      taken.push_back(body);
    }
    id = places[body];
  };
  for (const std::size_t body : part.bodies) {
    int id = static_cast<int>(body);
    place(id);
  }
  for (const std::size_t i : part.contacts) {
    Contact contact = whole_.contacts[i];
    place(contact.body_1);
    place(contact.body_2);
    if (contact.joint == Joint::bore) {
      scene.bores.push_back(whole_.bores[contact.bore]);
      contact.bore = scene.bores.size() - 1;
    }
    scene.contacts.push_back(contact);
  }
  for (std::size_t s = 0; s < whole_.stages.size(); ++s) {
    const std::vector<std::size_t>& chosen = part.stages[s];
    if (const auto* links = std::get_if<Links>(&whole_.stages[s])) {
      Links some;
      some.needs_moments = links->needs_moments;
      for (const std::size_t i : chosen) {
        some.places.push_back(links->places[i]);
        place(some.places.back().link.id1);
        place(some.places.back().link.id2);
      }
      scene.stages.emplace_back(std::move(some));
    } else if (const auto* springs = std::get_if<std::vector<TorsionPlace>>(&whole_.stages[s])) {
      std::vector<TorsionPlace> some;
      for (const std::size_t i : chosen) {
        some.push_back((*springs)[i]);
        for (int& id : some.back().first) place(id);
        for (int& id : some.back().second) place(id);
      }
      scene.stages.emplace_back(std::move(some));
    } else if (const auto* joints = std::get_if<std::vector<Prismatic>>(&whole_.stages[s])) {
      std::vector<Prismatic> some;
      for (const std::size_t i : chosen) {
        some.push_back((*joints)[i]);
        place(some.back().id1);
        place(some.back().id2);
      }
      scene.stages.emplace_back(std::move(some));
    } else {
      std::vector<Guide> some;
      for (const std::size_t i : chosen) {
        some.push_back(std::get<std::vector<Guide>>(whole_.stages[s])[i]);
        place(some.back().body);
      }
      scene.stages.emplace_back(std::move(some));
    }
  }
  for (const std::size_t body : taken) places[body] = -1;
  scene.prepare();
}

inline long Parts::run(long steps, const Scene::Make& make) {
  const auto count = static_cast<long>(parts_.size());
  std::vector<long> done(parts_.size(), 0);
#pragma omp parallel for schedule(static)
  for (long i = 0; i < count; ++i) {
    Part& part = parts_[static_cast<std::size_t>(i)];
    done[static_cast<std::size_t>(i)] =
        part.scene.run(steps, [&](std::size_t contact) { return make(part.contacts[contact]); });
  }
  return *std::min_element(done.begin(), done.end());
}

inline void Parts::collect(Scene& whole) const {
  const Scene& first = parts_.front().scene;
  whole.time = first.time;
  whole.iteration = first.iteration;
  whole.strains = first.strains;
  for (const Part& part : parts_) {
    for (std::size_t i = 0; i < part.bodies.size(); ++i) {
      whole.bodies[part.bodies[i]] = part.scene.bodies[i];
    }
    for (std::size_t i = 0; i < part.contacts.size(); ++i) {
      Contact& to = whole.contacts[part.contacts[i]];
      const int body_1 = to.body_1, body_2 = to.body_2;
      const std::size_t bore = to.bore;
      to = part.scene.contacts[i];
      if (to.joint == Joint::bore) whole.bores[bore] = part.scene.bores[to.bore];
      to.body_1 = body_1;
      to.body_2 = body_2;
      to.bore = bore;
    }
    for (std::size_t s = 0; s < part.stages.size(); ++s) {
      for (std::size_t i = 0; i < part.stages[s].size(); ++i) {
        const std::size_t place = part.stages[s][i];
        if (auto* links = std::get_if<Links>(&whole.stages[s])) {
          Link& to = links->places[place].link;
          const int id1 = to.id1, id2 = to.id2;
          to = std::get<Links>(part.scene.stages[s]).places[i].link;
          to.id1 = id1;
          to.id2 = id2;
        } else if (auto* springs = std::get_if<std::vector<TorsionPlace>>(&whole.stages[s])) {
          (*springs)[place].spring =
              std::get<std::vector<TorsionPlace>>(part.scene.stages[s])[i].spring;
        } else if (auto* joints = std::get_if<std::vector<Prismatic>>(&whole.stages[s])) {
          Prismatic& to = (*joints)[place];
          const int id1 = to.id1, id2 = to.id2;
          to = std::get<std::vector<Prismatic>>(part.scene.stages[s])[i];
          to.id1 = id1;
          to.id2 = id2;
        }
      }
    }
    whole.any_contact = whole.any_contact || part.scene.any_contact;
    whole.begun.add(part.scene.begun);
    whole.begun_in_bores.add(part.scene.begun_in_bores);
  }
}

}  // namespace statejump::stepper
