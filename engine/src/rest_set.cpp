// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/rest_set.hpp"

#include <Eigen/Geometry>
#include <functional>

#include "rest_set_detail.hpp"

namespace statejump {

using Eigen::Vector2d;
using Eigen::Vector3d;
using namespace rest_detail;

namespace {

Vector3d on_circle(double radius, double angle, double z = 0.0) {
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// Sums over the parts; the caller has set diameter and farthest.
void add_up(RestSet& set) {
  for (const RestPart& part : set.parts) {
    set.area += part.area;
    set.length += part.length;
  }
}

/// Each, any and all of sets that know union and intersection; `describe` turns one into a RestSet.
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

Intervals united(const Intervals& a, const Intervals& b) {
  Intervals result = a;
  result.add(b);
  return result;
}

/// Positions on the segment from -c to c.
RestSet segments(const Intervals& set, double) {
  RestSet result;
  for (const Interval& i : set.list()) {
    RestPart part;
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

struct AngularPair {
  double angle = -1.0;  ///< between the two, at most pi; negative: a set is empty
  double first = 0.0, second = 0.0;
};

/// Largest angle between a point of one set of arcs and a point of another.
AngularPair farthest_angles(const Intervals& one, const Intervals& other) {
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

Intervals circle_set() {
  return Intervals(2.0 * pi);
}

Intervals one_interval(const Interval& i) {
  Intervals result = circle_set();
  result.add(i.a, i.b);
  return result;
}

RestSet arcs(const Intervals& set, double c) {
  RestSet result;
  for (const Interval& i : set.list()) {
    RestPart part;
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

// Ball in socket: equal caps on the unit sphere.

double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Circle of points at the angle alpha from `axis`.
struct CapCircle {
  Vector3d axis, x, y;
  double sine, cosine;

  CapCircle(const Vector3d& direction, double alpha)
      : axis(direction), sine(std::sin(alpha)), cosine(std::cos(alpha)) {
    int smallest = 0;
    axis.cwiseAbs().minCoeff(&smallest);
    x = Vector3d::Unit(smallest).cross(axis).normalized();
    y = axis.cross(x);
  }
  Vector3d at(double psi) const {
    return cosine * axis + sine * (std::cos(psi) * x + std::sin(psi) * y);
  }
  double angle_of(const Vector3d& direction) const {
    return std::atan2(direction.dot(y), direction.dot(x));
  }
};

/// A piece of a cap's circle on the boundary of a union or an intersection.
struct BoundaryArc {
  std::size_t circle;
  Interval psi;
};

class Caps {
 public:
  Caps(const std::vector<Vector3d>& forces, double alpha, double c) : alpha_(alpha), c_(c) {
    for (const Vector3d& force : forces) {
      const Vector3d u = force.stableNormalized();
      const bool known = std::any_of(circles_.begin(), circles_.end(), [&u](const CapCircle& k) {
        return angle_between(k.axis, u) < 1e-14;
      });
      if (!known) circles_.emplace_back(u, alpha);
    }
  }

  RestSet any() const;
  RestSet all() const;

 private:
  /// Where circle i lies in cap j: cos(psi - psi_j) >= tan(gamma/2)/tan(alpha).
  Intervals inside(std::size_t i, std::size_t j) const {
    Intervals result = circle_set();
    const double gamma = angle_between(circles_[i].axis, circles_[j].axis);
    const double q = std::tan(0.5 * gamma) / std::tan(alpha_);
    if (q <= 1.0) {
      const double middle = circles_[i].angle_of(circles_[j].axis);
      result.add(middle - std::acos(q), middle + std::acos(q));
    }
    return result;
  }

  Vector3d start(const BoundaryArc& arc) const { return circles_[arc.circle].at(arc.psi.a); }
  Vector3d end(const BoundaryArc& arc) const { return circles_[arc.circle].at(arc.psi.b); }

  /// The arc that begins where this one ends.
  std::size_t next(const std::vector<BoundaryArc>& arcs, std::size_t i) const {
    std::size_t best = i;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < arcs.size(); ++j) {
      const double distance = (start(arcs[j]) - end(arcs[i])).norm();
      if (distance < nearest) {
        nearest = distance;
        best = j;
      }
    }
    return best;
  }

  /// Angle between the directions of two arcs of different circles at their common point.
  double corner(const BoundaryArc& arc, const BoundaryArc& following) const {
    const Vector3d point = end(arc);
    return angle_between(circles_[arc.circle].axis.cross(point),
                         circles_[following.circle].axis.cross(point));
  }

  RestPart cap(const Vector3d& axis) const {
    RestPart part;
    const double half = std::sin(0.5 * alpha_);
    part.area = 4.0 * pi * c_ * c_ * half * half;
    part.angle = 2.0 * alpha_;
    part.diameter = 2.0 * c_ * std::sin(alpha_);
    part.representative = c_ * axis;
    return part;
  }

  RestSet points() const {
    RestSet result;
    for (const CapCircle& circle : circles_) {
      RestPart part = cap(circle.axis);
      part.points = {part.representative};
      result.parts.push_back(part);
    }
    return result;
  }

  std::vector<CapCircle> circles_;
  double alpha_, c_;
};

RestSet Caps::any() const {
  const std::size_t n = circles_.size();
  Components components(n);
  std::vector<BoundaryArc> arcs;
  for (std::size_t i = 0; i < n; ++i) {
    Intervals covered = circle_set();
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j) continue;
      if (angle_between(circles_[i].axis, circles_[j].axis) <= 2.0 * alpha_) components.join(i, j);
      if (alpha_ > 0.0) covered.add(inside(i, j));
    }
    if (alpha_ == 0.0) continue;
    const Intervals bare = covered.complement();
    for (const Interval& arc : bare.list()) {
      if (arc.width() > 0.0) arcs.push_back({i, arc});
    }
  }
  RestSet result = alpha_ == 0.0 ? points() : RestSet{};
  for (std::size_t root = 0; alpha_ > 0.0 && root < n; ++root) {
    if (components.find(root) != root) continue;
    // Gauss-Bonnet: area + geodesic curvature + exterior angles = 2 pi (2 - boundary curves).
    double area = 4.0 * pi;
    std::vector<bool> seen(arcs.size());
    for (std::size_t i = 0; i < arcs.size(); ++i) {
      if (seen[i] || components.find(arcs[i].circle) != root) continue;
      area -= 2.0 * pi;
      for (std::size_t k = i; !seen[k];) {
        seen[k] = true;
        area -= std::cos(alpha_) * arcs[k].psi.width();
        const std::size_t following = next(arcs, k);
        if (arcs[following].circle != arcs[k].circle) area += corner(arcs[k], arcs[following]);
        k = following;
      }
    }
    RestPart part = cap(circles_[root].axis);
    bool alone = true;
    for (std::size_t i = 0; i < n; ++i) {
      if (components.find(i) != root) continue;
      if (i != root) alone = false;
      for (std::size_t j = 0; j < i; ++j) {
        if (components.find(j) != root) continue;
        const double gamma = angle_between(circles_[i].axis, circles_[j].axis);
        part.angle = std::max(part.angle, std::min(pi, gamma + 2.0 * alpha_));
      }
    }
    if (!alone) part.area = c_ * c_ * area;
    part.diameter = 2.0 * c_ * std::sin(0.5 * part.angle);
    result.parts.push_back(part);
  }
  double largest = -1.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const double gamma = i == j ? 0.0 : angle_between(circles_[i].axis, circles_[j].axis);
      const double angle = std::min(pi, gamma + 2.0 * alpha_);
      if (angle <= largest) continue;
      largest = angle;
      result.diameter = 2.0 * c_ * std::sin(0.5 * angle);
      // Along the great circle through both axes, outwards; opposite points if that is too far.
      const CapCircle& a = circles_[i];
      const double psi = i == j ? 0.0 : a.angle_of(-circles_[j].axis);
      const Vector3d first = a.at(psi);
      const Vector3d radial = std::cos(psi) * a.x + std::sin(psi) * a.y;
      const Vector3d tangent = -a.cosine * radial + a.sine * a.axis;  // from first to the axis
      result.farthest = {c_ * first, c_ * (std::cos(angle) * first + std::sin(angle) * tangent)};
    }
  }
  add_up(result);
  return result;
}

RestSet Caps::all() const {
  const std::size_t n = circles_.size();
  if (n == 1) return any();
  RestSet result;
  if (alpha_ == 0.0) return result;
  std::vector<Intervals> on_circle_allowed;
  std::vector<BoundaryArc> arcs;
  for (std::size_t i = 0; i < n; ++i) {
    Intervals allowed = circle_set();
    allowed.add(0.0, 2.0 * pi);
    for (std::size_t j = 0; j < n; ++j) {
      if (i != j) allowed = allowed.common(inside(i, j));
    }
    for (const Interval& arc : allowed.list()) arcs.push_back({i, arc});
    on_circle_allowed.push_back(allowed);
  }
  if (arcs.empty()) return result;

  RestPart part;
  double area = 2.0 * pi;
  Vector3d middle = Vector3d::Zero();
  std::vector<Vector3d> candidates;
  for (std::size_t k = 0; k < arcs.size(); ++k) {
    area -= std::cos(alpha_) * arcs[k].psi.width();
    const std::size_t following = next(arcs, k);
    if (arcs[following].circle != arcs[k].circle) area -= corner(arcs[k], arcs[following]);
    candidates.push_back(start(arcs[k]));
    candidates.push_back(end(arcs[k]));
    middle += circles_[arcs[k].circle].at(0.5 * (arcs[k].psi.a + arcs[k].psi.b));
  }
  part.area = c_ * c_ * std::max(0.0, area);
  // A farthest point is a corner or lies on an arc, across the arc's centre from its partner.
  const std::size_t corners = candidates.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto add = [&](double psi) {
      if (on_circle_allowed[i].contains(psi)) candidates.push_back(circles_[i].at(psi));
    };
    for (std::size_t k = 0; k < corners; ++k) add(circles_[i].angle_of(-candidates[k]));
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j) continue;
      add(circles_[i].angle_of(circles_[j].axis));
      add(circles_[i].angle_of(-circles_[j].axis));
    }
    const AngularPair across = farthest_angles(on_circle_allowed[i], on_circle_allowed[i]);
    if (across.angle >= 0.0) {
      candidates.push_back(circles_[i].at(across.first));
      candidates.push_back(circles_[i].at(across.second));
    }
  }
  std::size_t first = 0, second = 0;
  result.diameter = part.diameter = c_ * farthest_pair(candidates, first, second);
  part.angle = angle_between(candidates[first], candidates[second]);
  result.farthest = {c_ * candidates[first], c_ * candidates[second]};
  part.representative = c_ * middle.normalized();
  result.parts = {part};
  add_up(result);
  return result;
}

// Cylinder in bore: the can.

struct CanSet {
  Intervals band = circle_set(), low_rim = circle_set(), high_rim = circle_set();
  bool low_disc = false, high_disc = false;
};

/// Whether (along e, across, along z) lies in the sum of the friction cones about e and z.
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
      double inside = 0.0, outside = pi;
      for (int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (inside + outside);
        if (middle == inside || middle == outside) break;
        (held(middle) ? inside : outside) = middle;
      }
      if (mu == 0.0) inside = 0.0;  // what rounding lets through
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

/// The band is part of both rims, so these decide the diameter.
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
  // Nodes: the arcs of band, low rim and high rim, in this order.
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
    RestPart part;
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
        // Both are found to rounding; what is common must not leave a length.
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
      sets, [&](const Intervals& set) { return segments(set, clearance); },
      [](const Intervals& a, const Intervals& b) { return united(a, b); },
      [](const Intervals& a, const Intervals& b) { return a.common(b); });
}

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

RestStudy rest_in_socket(double clearance, const std::vector<Vector3d>& forces, double mu) {
  check_length(clearance, "clearance");
  check(forces, mu);
  const double alpha = std::atan(mu);
  RestStudy study;
  for (const Vector3d& force : forces) {
    study.each.push_back(Caps({force}, alpha, clearance).any());
  }
  const Caps caps(forces, alpha, clearance);
  study.any = caps.any();
  study.all = caps.all();
  return study;
}

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

}  // namespace statejump
