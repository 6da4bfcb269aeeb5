// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/rest_set/rest_set.hpp"

#include <Eigen/Geometry>

#include "arcs.hpp"
#include "numerics/change_between.hpp"

namespace statejump::rest_set {

using Eigen::Vector3d;
using namespace detail;

namespace {

Intervals one_interval(const Interval& i) {
  Intervals result = circle_set();
  result.add(i.a, i.b);
  return result;
}

// Cylinder in bore: the configuration surface is a can.

struct CanSet {
  Intervals band = circle_set(), low_rim = circle_set(), high_rim = circle_set();
  bool low_disc = false, high_disc = false;
};

/// Whether the vector (fe, fw, fz) lies in the sum of the friction cones about e and z.
bool in_sum(double fe, double fw, double fz, double alpha) {
  const double size = std::hypot(fe, fw, fz);
  const double s = std::sin(alpha), c = std::cos(alpha);
  const Vector3d force = Vector3d(fe, fw, fz) / size;
  const double rounding = 4e-16;
  if (2.0 * s * s >= 1.0) return true;  // the dual cones do not meet
  const double w = std::sqrt(1.0 - 2.0 * s * s);
  for (const double sign : {-1.0, 1.0}) {
    if (force.dot(Vector3d(s, sign * w, s)) < -rounding) return false;
  }
  for (const int i : {0, 2}) {
    const Vector3d axis = Vector3d::Unit(i), other = Vector3d::Unit(2 - i);
    const Vector3d across = force - force.dot(axis) * axis;
    if (across.norm() == 0.0) continue;
    const Vector3d lowest = s * axis - c * across.normalized();
    if (lowest.dot(other) >= s && force.dot(lowest) < -rounding) return false;
  }
  return true;
}

CanSet can_set(const Vector3d& force, double mu) {
  CanSet set;
  const double alpha = std::atan(mu);
  const double radial = std::hypot(force.x(), force.y());
  const double direction = std::atan2(force.y(), force.x());
  if (std::abs(force.z()) <= mu * radial && radial > 0.0) {
    const double t = force.z() / radial;
    const double half = std::atan2(std::sqrt(mu * mu - t * t), std::sqrt(1.0 + t * t));
    set.band.add(direction - half, direction + half);
  }
  set.high_disc = radial <= mu * force.z() && force.z() > 0.0;
  set.low_disc = radial <= -mu * force.z() && force.z() < 0.0;
  for (const bool high : {false, true}) {
    Intervals& rim = high ? set.high_rim : set.low_rim;
    const double push = high ? force.z() : -force.z();
    const auto held = [&](double phi) {
      return in_sum(radial * std::cos(phi), radial * std::sin(phi), push, alpha);
    };
    rim = set.band;
    if ((high ? set.high_disc : set.low_disc) || (radial > 0.0 && held(pi))) {
      rim.add(0.0, 2.0 * pi);
    } else if (radial > 0.0 && push >= -mu * radial) {
      const auto is_free = [&](double phi) { return !held(phi); };
      double inside = numerics::change_between(0.0, pi, is_free).before;
      if (mu == 0.0) inside = 0.0;  // removes rounding
      rim.add(direction - inside, direction + inside);
    }
  }
  return set;
}

CanSet united(const CanSet& a, const CanSet& b) {
  return {united(a.band, b.band), united(a.low_rim, b.low_rim), united(a.high_rim, b.high_rim),
          a.low_disc || b.low_disc, a.high_disc || b.high_disc};
}

CanSet common(const CanSet& a, const CanSet& b) {
  return {a.band.common(b.band), a.low_rim.common(b.low_rim), a.high_rim.common(b.high_rim),
          a.low_disc && b.low_disc, a.high_disc && b.high_disc};
}

/// The band is part of both rims, so the rims determine the diameter.
double can_diameter(const CanSet& set, double c, double b, std::array<Vector3d, 2>* farthest) {
  double best = 0.0;
  const auto consider = [&](const Intervals& one, double z1, const Intervals& other, double z2) {
    const AngularPair pair = farthest_angles(one, other);
    if (pair.angle < 0.0) return;
    const double distance = std::hypot(2.0 * c * std::sin(0.5 * pair.angle), z2 - z1);
    if (distance < best) return;
    best = distance;
    if (farthest != nullptr) {
      *farthest = {on_circle(c, pair.first, z1), on_circle(c, pair.second, z2)};
    }
  };
  consider(set.low_rim, -b, set.low_rim, -b);
  consider(set.high_rim, b, set.high_rim, b);
  consider(set.low_rim, -b, set.high_rim, b);
  return best;
}

RestSet can(const CanSet& set, double c, double b) {
  // Nodes of the graph: arcs of band, low rim and high rim, in this order.
  const std::array<const Intervals*, 3> rows = {&set.band, &set.low_rim, &set.high_rim};
  std::vector<std::pair<int, Interval>> nodes;
  for (int row = 0; row < 3; ++row) {
    for (const Interval& i : rows[row]->list()) nodes.emplace_back(row, i);
  }
  Components components(nodes.size());
  const auto meets = [](const Interval& i, const Interval& j) {
    return !one_interval(i).common(one_interval(j)).list().empty();
  };
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      if (nodes[i].first == 0 && nodes[j].first != 0 && meets(nodes[i].second, nodes[j].second)) {
        components.join(i, j);
      }
    }
  }
  RestSet result;
  for (std::size_t root = 0; root < nodes.size(); ++root) {
    if (components.find(root) != root) continue;
    CanSet own;
    RestComponent part;
    part.angle = 0.0;
    const std::array<Intervals*, 3> own_rows = {&own.band, &own.low_rim, &own.high_rim};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (components.find(i) != root) continue;
      own_rows[nodes[i].first]->add(nodes[i].second.a, nodes[i].second.b);
      part.angle = std::max(part.angle, nodes[i].second.width());
    }
    const auto width = [](const Intervals& intervals) {
      double sum = 0.0;
      for (const Interval& i : intervals.list()) sum += i.width();
      return sum;
    };
    const double band = width(own.band);
    part.area = 2.0 * b * c * band;
    if (band == 0.0 && !own.band.list().empty()) {
      part.length += 2.0 * b * static_cast<double>(own.band.list().size());
    }
    for (const bool high : {false, true}) {
      const Intervals& rim = high ? own.high_rim : own.low_rim;
      if ((high ? set.high_disc : set.low_disc) && rim.full()) {
        part.area += pi * c * c;
      } else if (!rim.list().empty()) {
        // Both are accurate to rounding, which must not leave a length.
        const double beyond = width(rim) - band;
        if (beyond > 1e-12) part.length += c * beyond;
      }
    }
    const auto& [row, arc] = nodes[root];
    part.representative = on_circle(c, 0.5 * (arc.a + arc.b), row == 0 ? 0.0 : row == 1 ? -b : b);
    part.diameter = can_diameter(own, c, b, nullptr);
    for (const bool high : {false, true}) {
      for (const Interval& i : (high ? own.high_rim : own.low_rim).list()) {
        std::vector<Vector3d> line;
        const int steps = i.width() > 0.0 ? 2 + static_cast<int>(i.width() * 60.0) : 0;
        for (int k = 0; k <= steps; ++k) {
          const double angle = steps ? i.a + i.width() * k / steps : i.a;
          line.push_back(on_circle(c, angle, high ? b : -b));
        }
        if (part.area > 0.0) {
          part.rims.push_back(line);
        } else if (own.band.list().empty()) {
          part.points = line;
        }
      }
    }
    if (part.area == 0.0 && !own.band.list().empty()) {  // a line over the whole height
      const double angle = own.band.list().front().a;
      part.points = {on_circle(c, angle, -b), on_circle(c, angle, b)};
    }
    result.parts.push_back(part);
  }
  result.diameter = can_diameter(set, c, b, &result.farthest);
  add_up(result);
  return result;
}

}  // namespace

RestStudy rest_in_bore(double clearance, double axial_play, const std::vector<Vector3d>& forces,
                       double mu) {
  check_length(clearance, "clearance");
  check_length(axial_play, "axial_play");
  check(forces, mu);
  std::vector<CanSet> sets;
  for (const Vector3d& force : forces) sets.push_back(can_set(force, mu));
  return study_of(
      sets, [&](const CanSet& set) { return can(set, clearance, axial_play); },
      [](const CanSet& a, const CanSet& b) { return united(a, b); },
      [](const CanSet& a, const CanSet& b) { return common(a, b); });
}

}  // namespace statejump::rest_set
