// SPDX-License-Identifier: GPL-3.0-or-later
// Partition of a scene into subscenes that do not interact. Each subscene makes all its steps while
// its data are in the cache; subscenes run on all cores. Their results are independent, so neither
// the partition nor the number of threads changes a bit.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <variant>
#include <vector>

#include "statejump/stepper/scene.hpp"

namespace statejump::stepper {

/// Number of bodies per subscene, chosen such that they fit into the first-level cache of a
/// processor.
constexpr std::size_t bodies_per_subscene = 32;

namespace detail {

/// Union-find of interacting bodies.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t of(std::size_t one) {
    while (parent_[one] != one) one = parent_[one] = parent_[parent_[one]];
    return one;
  }
  void unite(std::size_t one, std::size_t two) {
    const std::size_t first = of(one), second = of(two);
    parent_[std::max(first, second)] = std::min(first, second);
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace detail

/// A scene divided into subscenes. A body at rest may belong to several of them.
class Partition {
 public:
  /// @param whole after Scene::prepare()
  explicit Partition(const Scene& whole) : whole_(whole) { split(); }

  std::size_t size() const { return subscenes_.size(); }

  /// Runs all subscenes as Scene::run() does; several threads call `make`.
  long run(long steps, const Scene::CreatePhysics& make);
  /// Copies the results into `whole`, a scene with the bodies and contacts of the original one. All
  /// subscenes must have made the same number of steps.
  void collect(Scene& whole) const;

 private:
  struct Subscene {
    Scene scene;
    std::vector<std::size_t> bodies, contacts;     // indices in the whole scene
    std::vector<std::vector<std::size_t>> stages;  // for each stage, indices of its entries there
  };
  void split();
  void fill(Subscene& subscene, std::vector<int>& local_ids) const;

  const Scene& whole_;
  std::vector<Subscene> subscenes_;
};

inline void Partition::split() {
  const auto moves = [&](int id) { return whole_.bodies[static_cast<std::size_t>(id)].moves; };
  detail::DisjointSets groups(whole_.bodies.size());
  const auto unite = [&](const auto& ids) {
    int first = -1;
    for (const int id : ids) {
      if (!moves(id)) continue;
      if (first >= 0) groups.unite(static_cast<std::size_t>(first), static_cast<std::size_t>(id));
      first = id;
    }
    return first;
  };
  for (const Contact& contact : whole_.contacts) unite(bodies_of(contact));
  for (const Stage& stage : whole_.stages) {
    std::visit(
        [&](const auto& one) {
          for (const auto& entry : entries(one)) unite(bodies_of(entry));
        },
        stage);
  }
  // Groups in the order of their first body, several per subscene.
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> size(whole_.bodies.size(), 0), subscene_of(whole_.bodies.size(), none);
  for (std::size_t i = 0; i < whole_.bodies.size(); ++i) {
    if (whole_.bodies[i].moves) ++size[groups.of(i)];
  }
  std::size_t filled = bodies_per_subscene;
  for (std::size_t i = 0; i < whole_.bodies.size(); ++i) {
    if (!whole_.bodies[i].moves) continue;
    const std::size_t group = groups.of(i);
    if (subscene_of[group] == none) {
      if (filled + size[group] > bodies_per_subscene) {
        subscenes_.emplace_back();
        subscenes_.back().stages.resize(whole_.stages.size());
        filled = 0;
      }
      filled += size[group];
      subscene_of[group] = subscenes_.size() - 1;
    }
    subscenes_[subscene_of[group]].bodies.push_back(i);
  }
  if (subscenes_.empty()) {
    subscenes_.emplace_back();
    subscenes_.back().stages.resize(whole_.stages.size());
  }
  // An object whose bodies are all at rest belongs to the first subscene.
  const auto subscene_with = [&](const auto& ids) -> Subscene& {
    for (const int id : ids) {
      if (moves(id)) return subscenes_[subscene_of[groups.of(static_cast<std::size_t>(id))]];
    }
    return subscenes_.front();
  };
  for (std::size_t i = 0; i < whole_.contacts.size(); ++i) {
    subscene_with(bodies_of(whole_.contacts[i])).contacts.push_back(i);
  }
  for (std::size_t s = 0; s < whole_.stages.size(); ++s) {
    std::visit(
        [&](const auto& one) {
          const auto& list = entries(one);
          for (std::size_t i = 0; i < list.size(); ++i) {
            subscene_with(bodies_of(list[i])).stages[s].push_back(i);
          }
        },
        whole_.stages[s]);
  }
  std::vector<int> local_ids(whole_.bodies.size(), -1);
  for (Subscene& subscene : subscenes_) fill(subscene, local_ids);
}

inline void Partition::fill(Subscene& subscene, std::vector<int>& local_ids) const {
  Scene& scene = subscene.scene;
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
  const auto renumber = [&](int& id) {
    const auto body = static_cast<std::size_t>(id);
    if (local_ids[body] < 0) {
      local_ids[body] = static_cast<int>(scene.bodies.size());
      scene.bodies.push_back(whole_.bodies[body]);
      taken.push_back(body);
    }
    id = local_ids[body];
  };
  for (const std::size_t body : subscene.bodies) {
    int id = static_cast<int>(body);
    renumber(id);
  }
  for (const std::size_t i : subscene.contacts) {
    Contact contact = whole_.contacts[i];
    renumber(contact.body_1);
    renumber(contact.body_2);
    if (contact.joint == Joint::bore) {
      scene.bores.push_back(whole_.bores[contact.bore]);
      contact.bore = scene.bores.size() - 1;
    }
    scene.contacts.push_back(contact);
  }
  for (std::size_t s = 0; s < whole_.stages.size(); ++s) {
    const std::vector<std::size_t>& chosen = subscene.stages[s];
    if (const auto* links = std::get_if<Links>(&whole_.stages[s])) {
      Links some;
      some.needs_moments = links->needs_moments;
      for (const std::size_t i : chosen) {
        some.links.push_back(links->links[i]);
        renumber(some.links.back().link.id1);
        renumber(some.links.back().link.id2);
      }
      scene.stages.emplace_back(std::move(some));
    } else if (const auto* springs = std::get_if<std::vector<TorsionEntry>>(&whole_.stages[s])) {
      std::vector<TorsionEntry> some;
      for (const std::size_t i : chosen) {
        some.push_back((*springs)[i]);
        for (int& id : some.back().first) renumber(id);
        for (int& id : some.back().second) renumber(id);
      }
      scene.stages.emplace_back(std::move(some));
    } else if (const auto* joints = std::get_if<std::vector<Prismatic>>(&whole_.stages[s])) {
      std::vector<Prismatic> some;
      for (const std::size_t i : chosen) {
        some.push_back((*joints)[i]);
        renumber(some.back().id1);
        renumber(some.back().id2);
      }
      scene.stages.emplace_back(std::move(some));
    } else {
      std::vector<Guide> some;
      for (const std::size_t i : chosen) {
        some.push_back(std::get<std::vector<Guide>>(whole_.stages[s])[i]);
        renumber(some.back().body);
      }
      scene.stages.emplace_back(std::move(some));
    }
  }
  for (const std::size_t body : taken) local_ids[body] = -1;
  scene.prepare();
}

inline long Partition::run(long steps, const Scene::CreatePhysics& make) {
  const auto count = static_cast<long>(subscenes_.size());
  std::vector<long> done(subscenes_.size(), 0);
#pragma omp parallel for schedule(static)
  for (long i = 0; i < count; ++i) {
    Subscene& subscene = subscenes_[static_cast<std::size_t>(i)];
    done[static_cast<std::size_t>(i)] = subscene.scene.run(
        steps, [&](std::size_t contact) { return make(subscene.contacts[contact]); });
  }
  return *std::min_element(done.begin(), done.end());
}

inline void Partition::collect(Scene& whole) const {
  const Scene& first = subscenes_.front().scene;
  whole.time = first.time;
  whole.iteration = first.iteration;
  whole.strains = first.strains;
  for (const Subscene& subscene : subscenes_) {
    for (std::size_t i = 0; i < subscene.bodies.size(); ++i) {
      whole.bodies[subscene.bodies[i]] = subscene.scene.bodies[i];
    }
    for (std::size_t i = 0; i < subscene.contacts.size(); ++i) {
      Contact& to = whole.contacts[subscene.contacts[i]];
      const int body_1 = to.body_1, body_2 = to.body_2;
      const std::size_t bore = to.bore;
      to = subscene.scene.contacts[i];
      if (to.joint == Joint::bore) whole.bores[bore] = subscene.scene.bores[to.bore];
      to.body_1 = body_1;
      to.body_2 = body_2;
      to.bore = bore;
    }
    for (std::size_t s = 0; s < subscene.stages.size(); ++s) {
      for (std::size_t i = 0; i < subscene.stages[s].size(); ++i) {
        const std::size_t index = subscene.stages[s][i];
        if (auto* links = std::get_if<Links>(&whole.stages[s])) {
          Link& to = links->links[index].link;
          const int id1 = to.id1, id2 = to.id2;
          to = std::get<Links>(subscene.scene.stages[s]).links[i].link;
          to.id1 = id1;
          to.id2 = id2;
        } else if (auto* springs = std::get_if<std::vector<TorsionEntry>>(&whole.stages[s])) {
          (*springs)[index].spring =
              std::get<std::vector<TorsionEntry>>(subscene.scene.stages[s])[i].spring;
        } else if (auto* joints = std::get_if<std::vector<Prismatic>>(&whole.stages[s])) {
          Prismatic& to = (*joints)[index];
          const int id1 = to.id1, id2 = to.id2;
          to = std::get<std::vector<Prismatic>>(subscene.scene.stages[s])[i];
          to.id1 = id1;
          to.id2 = id2;
        }
      }
    }
    whole.any_contact = whole.any_contact || subscene.scene.any_contact;
    whole.begun.add(subscene.scene.begun);
    whole.begun_in_bores.add(subscene.scene.begun_in_bores);
  }
}

}  // namespace statejump::stepper
