// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/rest_set/rest_set.hpp"

#include <Eigen/Geometry>

#include "arcs.hpp"

namespace statejump::rest_set {

using Eigen::Vector3d;
using namespace detail;

namespace {

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

/// An arc of a cap's circle that is part of the boundary of a union or an intersection of caps.
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
  /// Part of circle i that lies inside cap j: cos(psi - psi_j) >= tan(gamma/2)/tan(alpha).
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

  /// The arc that begins at the end of this one.
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

  /// Angle between the tangents of two arcs of different circles at their common point.
  double corner(const BoundaryArc& arc, const BoundaryArc& following) const {
    const Vector3d point = end(arc);
    return angle_between(circles_[arc.circle].axis.cross(point),
                         circles_[following.circle].axis.cross(point));
  }

  RestComponent cap(const Vector3d& axis) const {
    RestComponent part;
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
      RestComponent part = cap(circle.axis);
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
    RestComponent part = cap(circles_[root].axis);
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
      // Farthest points are on the great circle through both axes, on the outer sides, or opposite
      // each other.
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

  RestComponent part;
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
  // Each farthest point is a corner, or lies on an arc whose centre is between both points.
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

}  // namespace

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

}  // namespace statejump::rest_set
