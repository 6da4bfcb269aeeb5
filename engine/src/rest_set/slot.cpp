// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/rest_set/rest_set.hpp"

#include "arcs.hpp"

namespace statejump::rest_set {

using Eigen::Vector3d;
using namespace detail;

namespace {

/// Positions on the segment from -c to c.
RestSet segments(const Intervals& set) {
  RestSet result;
  for (const Interval& i : set.list()) {
    RestComponent part;
    part.length = part.diameter = i.width();
    part.representative = {0.5 * (i.a + i.b), 0.0, 0.0};
    part.points = {{i.a, 0.0, 0.0}};
    if (i.b > i.a) part.points.push_back({i.b, 0.0, 0.0});
    result.parts.push_back(part);
  }
  if (!set.list().empty()) {
    result.farthest = {Vector3d(set.list().front().a, 0, 0), Vector3d(set.list().back().b, 0, 0)};
    result.diameter = set.list().back().b - set.list().front().a;
  }
  add_up(result);
  return result;
}

}  // namespace

RestStudy rest_in_slot(double clearance, const std::vector<Vector3d>& forces, double mu) {
  check_length(clearance, "clearance");
  check(forces, mu);
  std::vector<Intervals> sets;
  for (const Vector3d& force : forces) {
    Intervals set;
    const double along = force.x();
    if (std::abs(along) <= mu * std::hypot(force.y(), force.z())) {
      set.add(-clearance, clearance);
    } else {
      const double stop = std::copysign(clearance, along);
      set.add(stop, stop);
    }
    sets.push_back(set);
  }
  return study_of(
      sets, [](const Intervals& set) { return segments(set); },
      [](const Intervals& a, const Intervals& b) { return united(a, b); },
      [](const Intervals& a, const Intervals& b) { return a.common(b); });
}

}  // namespace statejump::rest_set
