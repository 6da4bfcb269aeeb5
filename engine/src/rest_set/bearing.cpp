// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/rest_set/rest_set.hpp"

#include "arcs.hpp"

namespace statejump::rest_set {

using Eigen::Vector2d;
using namespace detail;

namespace {

RestSet arcs(const Intervals& set, double c) {
  RestSet result;
  for (const Interval& i : set.list()) {
    RestComponent part;
    part.angle = i.width();
    part.length = c * i.width();
    part.diameter = 2.0 * c * std::sin(0.5 * std::min(i.width(), pi));
    part.representative = on_circle(c, 0.5 * (i.a + i.b));
    const int steps = i.width() > 0.0 ? 2 + static_cast<int>(i.width() * 60.0) : 0;
    for (int k = 0; k <= steps; ++k) {
      part.points.push_back(on_circle(c, steps ? i.a + i.width() * k / steps : i.a));
    }
    result.parts.push_back(part);
  }
  const AngularPair pair = farthest_angles(set, set);
  if (pair.angle >= 0.0) {
    result.diameter = 2.0 * c * std::sin(0.5 * pair.angle);
    result.farthest = {on_circle(c, pair.first), on_circle(c, pair.second)};
  }
  add_up(result);
  return result;
}

}  // namespace

RestStudy rest_in_bearing(double clearance, const std::vector<Vector2d>& forces, double mu) {
  check_length(clearance, "clearance");
  check(forces, mu);
  std::vector<Intervals> sets;
  for (const Vector2d& force : forces) {
    Intervals set = circle_set();
    const double direction = std::atan2(force.y(), force.x());
    set.add(direction - std::atan(mu), direction + std::atan(mu));
    sets.push_back(set);
  }
  return study_of(
      sets, [&](const Intervals& set) { return arcs(set, clearance); },
      [](const Intervals& a, const Intervals& b) { return united(a, b); },
      [](const Intervals& a, const Intervals& b) { return a.common(b); });
}

}  // namespace statejump::rest_set
