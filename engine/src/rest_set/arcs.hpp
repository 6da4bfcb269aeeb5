// SPDX-License-Identifier: GPL-3.0-or-later
// Sets of arcs on a circle, and rest sets assembled from their components; not installed.
#pragma once

#include <cmath>
#include <vector>

#include "detail.hpp"

namespace statejump::rest_set::detail {

inline Eigen::Vector3d on_circle(double radius, double angle, double z = 0.0) {
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// Sums over the components; the caller has set diameter and farthest.
inline void add_up(RestSet& set) {
  for (const RestComponent& part : set.parts) {
    set.area += part.area;
    set.length += part.length;
  }
}

/// RestStudy of all sets, their union and their intersection. `describe` converts a set into a
/// RestSet.
template <class Set, class Describe, class Unite, class Intersect>
RestStudy study_of(const std::vector<Set>& sets, Describe&& describe, Unite&& unite,
                   Intersect&& intersect) {
  RestStudy study;
  Set any = sets.front(), all = sets.front();
  for (const Set& set : sets) {
    study.each.push_back(describe(set));
    any = unite(any, set);
    all = intersect(all, set);
  }
  study.any = describe(any);
  study.all = describe(all);
  return study;
}

inline Intervals united(const Intervals& a, const Intervals& b) {
  Intervals result = a;
  result.add(b);
  return result;
}

inline Intervals circle_set() {
  return Intervals(2.0 * pi);
}

struct AngularPair {
  double angle = -1.0;  ///< between the two, at most pi; negative: a set is empty
  double first = 0.0, second = 0.0;
};

/// Largest angle between a point of one set of arcs and a point of another.
inline AngularPair farthest_angles(const Intervals& one, const Intervals& other) {
  AngularPair best;
  if (one.list().empty() || other.list().empty()) return best;
  const Intervals opposite = one.common(other.shifted(pi));
  if (!opposite.list().empty()) {
    const double a = opposite.list().front().a;
    return {pi, a, a + pi};
  }
  for (const Interval& i : one.list()) {
    for (const Interval& j : other.list()) {
      for (const double a : {i.a, i.b}) {
        for (const double b : {j.a, j.b}) {
          const double angle = std::abs(std::remainder(b - a, 2.0 * pi));
          if (angle > best.angle) best = {angle, a, b};
        }
      }
    }
  }
  return best;
}

}  // namespace statejump::rest_set::detail
