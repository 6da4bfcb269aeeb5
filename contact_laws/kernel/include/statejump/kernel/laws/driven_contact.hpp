// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/laws/joint_law.hpp"
#include "statejump/kernel/require.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::kernel::laws {

/// A single contact without bodies. Its depth and slide are prescribed along a path.
struct DrivenContact {
  JointLaw law;             ///< tangential_velocity is ignored: the path prescribes the slide
  ElasticPair elastic;      ///< E*, G* [Pa], > 0
  NormalGeometry geometry;  ///< see driven_geometry()
};

/// End point of one step. The path to it is a straight line, which the laws receive as a single
/// increment.
struct DrivenTarget {
  double depth = 0.0;                      ///< delta [m]; <= 0: the contact is open
  std::optional<double> normal_force;      ///< F_N [N], >= 0; if given, the depth follows from it
  double slide_x = 0.0;                    ///< body 1 relative to body 2 [m], 0 at the start
  double slide_y = 0.0;                    ///< perpendicular to slide_x [m]
  std::optional<double> tangential_force;  ///< F_T along x [N], positive along the slide that
                                           ///< causes it; if given, slide_x follows from it
  double duration = 0.0;  ///< duration of the step [s]; 0: rates are unknown and count as zero
};

/// State of the contact at the end of a step.
struct DrivenState {
  double depth = 0.0;               ///< [m]
  double slide_x = 0.0;             ///< [m]
  double slide_y = 0.0;             ///< [m]
  double normal_force = 0.0;        ///< F_N including the dissipation law [N], >= 0
  double tangential_force_x = 0.0;  ///< [N], positive in the direction of the slide that causes it
  double tangential_force_y = 0.0;  ///< [N]
  double normal_elastic_energy = 0.0;      ///< [J]
  double tangential_elastic_energy = 0.0;  ///< [J]
  double friction_dissipation = 0.0;       ///< since the start of the path [J]
  double damping_dissipation = 0.0;  ///< of the dissipation law, since the start of the path [J]
  double impact_speed = 0.0;  ///< approach speed when the current contact began [m/s]; 0: open
  ContactHistory history;     ///< of the friction law
};

/// Radii R1 and R2 with the given effective radius R = R1 R2/(R2 - R1) and clearance c = R2 - R1.
/// R1 is the root of R1^2 + c R1 = R c. An infinite clearance is a flat wall, R1 = R.
/// @param effective_radius R [m], > 0, @param radial_clearance c [m], > 0
/// @param contact_length length [m], > 0, of a line contact
inline NormalGeometry driven_geometry(double effective_radius, double radial_clearance,
                                      double contact_length) {
  require(std::isfinite(effective_radius) && effective_radius > 0.0, "effective_radius",
          effective_radius, "(0, inf) m");
  require(radial_clearance > 0.0, "radial_clearance", radial_clearance, "(0, inf] m");
  if (std::isinf(radial_clearance)) return {effective_radius, radial_clearance, contact_length};
  // root R1 = 2 R c/(c + sqrt(c^2 + 4 R c)), written without cancellation
  const double journal_radius =
      2.0 * effective_radius / (1.0 + std::sqrt(1.0 + 4.0 * effective_radius / radial_clearance));
  return {journal_radius, journal_radius + radial_clearance, contact_length};
}

/// Checks a driven contact. Call it whenever the contact is set.
/// @throws std::invalid_argument that names the field, its value and its range, or the law that
///        needs a missing field
inline void validate(const DrivenContact& contact) {
  validate(contact.law);
  require(std::isfinite(contact.elastic.effective_young_modulus) &&
              contact.elastic.effective_young_modulus > 0.0,
          "effective_young_modulus", contact.elastic.effective_young_modulus, "(0, inf) Pa");
  require(std::isfinite(contact.elastic.effective_shear_modulus) &&
              contact.elastic.effective_shear_modulus > 0.0,
          "effective_shear_modulus", contact.elastic.effective_shear_modulus, "(0, inf) Pa");
  if (has(contact.law.normal, Trait::needs_axis)) {
    require(std::isfinite(contact.geometry.bearing_radius), "radial_clearance",
            contact.geometry.clearance(), "finite for a line contact [m]");
  }
}

namespace detail {

/// Smallest number in [low, high] for which a monotone predicate holds, found by bisection down to
/// neighbouring floating-point numbers. The predicate must hold at high.
template <class Predicate>
double first_true(double low, double high, const Predicate& holds) {
  for (;;) {
    const double middle = low + 0.5 * (high - low);
    if (!(middle > std::min(low, high) && middle < std::max(low, high))) return high;
    (holds(middle) ? high : low) = middle;
  }
}

/// Depth [m] at which a normal law carries a force [N], >= 0.
/// @throws std::domain_error if the largest force of the law is smaller
inline double depth_at_force(const DrivenContact& contact, double force) {
  const NormalMaterial material{contact.elastic.effective_young_modulus};
  const auto carries = [&](double depth) {
    return evaluate(contact.law.normal, depth, contact.geometry, material).force >= force;
  };
  if (!(force > 0.0)) return 0.0;
  const double end = largest_depth(contact.law.normal, contact.geometry);
  const double last = std::isinf(end) ? end : std::nextafter(end, 0.0);
  double high = std::min(contact.geometry.journal_radius * 1e-6, last);
  while (!carries(high)) {
    if (high >= last) {
      char text[160];
      std::snprintf(text, sizeof text, "%s: normal_force = %.9g N, allowed is at most %.9g N",
                    law_info(contact.law.normal).name, force,
                    evaluate(contact.law.normal, last, contact.geometry, material).force);
      throw std::domain_error(text);
    }
    high = std::min(2.0 * high, last);
  }
  return first_true(0.0, high, carries);
}

}  // namespace detail

/// Drives a contact along a straight path. An open contact carries no force and has no history.
/// When it closes again, a new contact begins; only slide after the depth passed 0 counts.
///
/// A given tangential force determines the slide. The friction force does not decrease with the
/// slide, so bisection finds the smallest slide that reaches the force, to the last bit.
/// @param before state after the previous step; a default-constructed state means that there was no
///     contact
/// @throws std::domain_error for a depth outside the range of the normal law, or a force that
///        friction cannot reach
inline DrivenState drive(const DrivenContact& contact, const DrivenState& before,
                         const DrivenTarget& target) {
  const NormalMaterial material{contact.elastic.effective_young_modulus};
  DrivenState after = before;
  after.depth =
      target.normal_force ? detail::depth_at_force(contact, *target.normal_force) : target.depth;
  const NormalState normal = evaluate(contact.law.normal, after.depth, contact.geometry, material);
  const bool touching = after.depth > 0.0;
  const double duration = target.duration > 0.0 ? target.duration : 1.0;
  const double rate = target.duration > 0.0 ? (after.depth - before.depth) / duration : 0.0;
  if (!touching) {
    after.impact_speed = 0.0;
  } else if (!(before.impact_speed > 0.0)) {
    after.impact_speed = std::max(rate, contact.law.smallest_impact_speed);
  }
  after.normal_force =
      touching ? damped_force(normal.force, damping_ratio(contact.law, after.impact_speed), rate)
               : 0.0;
  after.normal_elastic_energy = normal.elastic_energy;
  after.damping_dissipation += (after.normal_force - normal.force) * rate * duration;

  const double stiffness = tangential_stiffness(contact.elastic, normal.stiffness);
  // The contact slides only while it touches: in a step that closes it, afterwards; in a step that
  // opens it, before. The slide is scaled by the fraction of the step with positive depth.
  const double one = std::max(before.depth, after.depth);
  const double other = std::min(before.depth, after.depth);
  const double fraction = one > 0.0 && other < 0.0 ? one / (one - other) : 1.0;
  const auto friction = [&](double slide_x, ContactHistory& history) {
    const Vector3 slide(slide_x - before.slide_x, target.slide_y - before.slide_y, 0.0);
    return evaluate(
        contact.law.friction, contact.law.friction_parameters,
        {after.normal_force, stiffness, slide * (fraction / duration), duration, Vector3::UnitZ()},
        history);
  };
  after.slide_x = target.slide_x;
  after.slide_y = target.slide_y;
  if (target.tangential_force) {
    const double force = *target.tangential_force;
    const auto at = [&](double slide_x) {
      ContactHistory trial = before.history;
      return -friction(slide_x, trial).force_on_1.x();
    };
    const double limit = contact.law.friction_parameters.friction_coefficient * after.normal_force;
    const double margin = 1e-14 * limit;  // a force rounded in a file can exceed the limit
                                          // slightly; it must still be reachable
    const double side = force < at(before.slide_x) ? -1.0 : 1.0;
    const auto reaches = [&](double slide_x) { return side * (at(slide_x) - force) >= -margin; };
    after.slide_x = before.slide_x;
    if (!reaches(after.slide_x)) {
      // The search starts at half the elastic slide force/k_t and gives up at 1000 journal radii.
      double far = stiffness > 0.0 ? 0.5 * std::max(std::abs(force), limit) / stiffness : 0.0;
      const double beyond = 1e3 * contact.geometry.journal_radius;
      while (far > 0.0 && far < beyond && !reaches(before.slide_x + side * far)) far *= 2.0;
      if (!(far > 0.0 && far < beyond)) {
        char text[160];
        std::snprintf(text, sizeof text,
                      "tangential_force = %.9g N, allowed is what friction carries, at most %.9g N",
                      force, limit);
        throw std::domain_error(text);
      }
      after.slide_x = detail::first_true(before.slide_x, before.slide_x + side * far, reaches);
    }
  }
  const FrictionResponse response = friction(after.slide_x, after.history);
  after.tangential_force_x = 0.0 - response.force_on_1.x();
  after.tangential_force_y = 0.0 - response.force_on_1.y();
  after.tangential_elastic_energy = response.elastic_energy;
  after.friction_dissipation += response.dissipation;
  return after;
}

}  // namespace statejump::kernel::laws
