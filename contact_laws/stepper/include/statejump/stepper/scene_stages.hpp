// SPDX-License-Identifier: GPL-3.0-or-later
// Links, torsion springs, sliders and guides of a scene in one step. Part of scene.hpp.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "statejump/stepper/scene.hpp"

namespace statejump::stepper {

// Measures all links at the start of a step, before any body moves. Their square roots and
// quotients depend only on positions, so the processor can compute them in parallel (out-of-order
// execution).
inline void Scene::measure_links() {
  for (Stage& stage : stages) {
    auto* links = std::get_if<Links>(&stage);
    if (!links) continue;
    for (LinkEntry& entry : links->links) {
      entry.span =
          span_of(body(entry.link.id1).motion.position, body(entry.link.id2).motion.position);
    }
  }
}

inline bool Scene::act(Links& group) {
  auto& links = group.links;
  if (group.needs_moments) {
    sum();
    scratch_.resize(links.size());
    for (std::size_t i = 0; i < links.size(); ++i) {
      if (links[i].link.tipTurnsWithLink) scratch_[i] = body(links[i].link.id2).torque;
    }
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    auto& [link, program, inverse, damping, last_softening, span] = links[i];
    Body& root = body(link.id1);
    Body& tip = body(link.id2);
    if (!span.is_proper()) return false;
    const LinkStep now = link_step(
        link, span, root.motion.velocity, tip.motion.velocity, changes_[program],
        [&, index = program] { return programs[index].temperature_rate(time); }, damping, time);
    if (inverse > 0 && !is_stable(now, inverse, time_step)) return false;
    Vector3 force = force_on_tip(now);
    if (link.tipTurnsWithLink) {
      if ((tip.blocked & all_rotations) != all_rotations) return false;
      if (tip.rotation_deferred && !rotates_in_plane(link, span.direction, tip.orientation)) {
        turn(tip, time_step);
      }
      tip.rotation_deferred = false;
      force += rotate_tip(link, now, scratch_[i], tip.orientation, tip.motion.angular_velocity);
    }
    // A NaN force persists in the moved bodies, where has_finite_state() detects it.
    if (tip.moves) {
      tip.added_force += force;
    } else if (!root.moves && !is_finite_fast(force)) {
      return false;
    }
    if (root.moves) root.added_force += -force;
    if (tracks_energy) {
      const LinkEnergy step = energy(link, now, time_step, last_softening);
      stored.link += step.elastic;
      energies.link_damping += step.damping;
      energies.pin_damping += step.pin_damping;
      if (step.works) energies.link_thermal_work += step.thermal_work;
    }
    keep(link, now, time);
  }
  return true;
}

inline bool Scene::act(std::vector<TorsionEntry>& springs) {
  for (TorsionEntry& entry : springs) {
    const auto span = [&](const std::array<int, 2>& ends) {
      return span_of(body(ends[0]).motion.position, body(ends[1]).motion.position);
    };
    const auto mobility = [&](const std::array<int, 2>& ends) {
      return body(ends[0]).inverse_mass + body(ends[1]).inverse_mass;
    };
    const Span first = span(entry.first);
    const Span second = span(entry.second);
    Torsion& spring = entry.spring;
    if (!first.is_proper() || !second.is_proper() || !is_planar(first, spring.axis) ||
        !is_planar(second, spring.axis) || has_friction_without_stiffness(spring)) {
      return false;
    }
    const TorsionEnergy energy = torsion_step(spring, first, second);
    const double inverse = inverse_inertia(first, mobility(entry.first)) +
                           inverse_inertia(second, mobility(entry.second));
    if (inverse > 0 &&
        !(time_step <= kernel::critical_time_step(1 / inverse, largest_stiffness(spring)))) {
      return false;
    }
    if (!std::isfinite(spring.moment)) return false;
    const auto add = [&](const std::array<int, 2>& ends, const Vector3& force) {
      if (body(ends[1]).moves) body(ends[1]).added_force += force;
      if (body(ends[0]).moves) body(ends[0]).added_force += -force;
    };
    add(entry.first, couple(first, spring.axis, spring.moment));
    add(entry.second, couple(second, spring.axis, -spring.moment));
    if (tracks_energy) {
      stored.torsion += energy.elastic;
      energies.torsion_friction += energy.friction;
    }
  }
  return true;
}

inline bool Scene::act(std::vector<Prismatic>& joints) {
  for (Prismatic& joint : joints) {
    Body& one = body(joint.id1);
    Body& two = body(joint.id2);
    if (has_friction_without_stiffness(joint) || has_stop_without_stiffness(joint)) return false;
    const double inverse = one.inverse_mass + two.inverse_mass;
    const PrismaticStep step =
        prismatic_step(joint,
                       {one.motion.position - two.motion.position,
                        one.motion.velocity - two.motion.velocity, inverse > 0 ? 1 / inverse : 0},
                       time_step);
    if (!(time_step <= step.largest_step) || !is_finite_fast(step.force)) return false;
    if (one.moves) one.added_force += step.force;
    if (two.moves) two.added_force += -step.force;
    if (tracks_energy) {
      stored.prismatic += step.elastic;
      energies.prismatic_friction += step.friction;
      energies.prismatic_damping += step.damping;
    }
  }
  return true;
}

inline bool Scene::act(std::vector<Guide>& guides) {
  sum();
  scratch_.resize(guides.size());
  for (std::size_t i = 0; i < guides.size(); ++i) {
    Body& held = body(guides[i].body);
    const Vector3& normal = guides[i].normal;
    scratch_[i] = held.force.dot(normal) * normal;
    if (!is_finite_fast(scratch_[i])) return false;
    held.motion.velocity -= held.motion.velocity.dot(normal) * normal;
  }
  for (std::size_t i = 0; i < guides.size(); ++i) body(guides[i].body).added_force += -scratch_[i];
  return true;
}

}  // namespace statejump::stepper
