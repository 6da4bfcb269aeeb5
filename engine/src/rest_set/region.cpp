// SPDX-License-Identifier: GPL-3.0-or-later
#include "region.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

namespace statejump::rest_set::detail {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// Real roots of G(a + s b) in s, in order.
std::vector<double> roots(const Cone& cone, const Vector3d& a, const Vector3d& b) {
  const double c0 = cone.form(a, a), c1 = cone.form(a, b), c2 = cone.form(b, b);
  const double square = c1 * c1 - c0 * c2;
  if (square < 0.0) return {};
  const double q = -(c1 + std::copysign(std::sqrt(square), c1));
  std::vector<double> result;
  if (c2 != 0.0) result.push_back(q / c2);
  if (q != 0.0) result.push_back(c0 / q);
  std::sort(result.begin(), result.end());
  return result;
}

/// The part of a polygon to the left (sign 1) or right (sign −1) of the line from a to b.
Polygon clipped(const Polygon& polygon, const Plane& a, const Plane& b, double sign) {
  Polygon result;
  const auto side = [&](const Plane& p) { return sign * cross(b - a, p - a); };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Plane &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double sp = side(p), sq = side(q);
    if (sp >= 0.0) result.push_back(p);
    if ((sp > 0.0 && sq < 0.0) || (sp < 0.0 && sq > 0.0)) {
      result.push_back(p + sp / (sp - sq) * (q - p));
    }
  }
  return result;
}

}  // namespace

Span span_of(const Cone& cone, const Vector3d& a, const Vector3d& b) {
  std::vector<double> stations = {0.0};
  for (const double s : roots(cone, a, b - a)) {
    if (s > 0.0 && s < 1.0) stations.push_back(s);
  }
  stations.push_back(1.0);
  Span result;
  for (std::size_t i = 0; i + 1 < stations.size(); ++i) {
    const double middle = 0.5 * (stations[i] + stations[i + 1]);
    if (!cone.holds(a + middle * (b - a))) continue;
    result.a = std::min(result.a, stations[i]);
    result.b = std::max(result.b, stations[i + 1]);
  }
  return result;
}

double area_of(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    twice += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  }
  return 0.5 * twice;
}

void cut(const Polygon& polygon, const Polygon& region, double least, Polygon& inside,
         std::vector<Polygon>& outside) {
  inside = polygon;
  for (std::size_t i = 0; i < region.size() && !inside.empty(); ++i) {
    const Plane &a = region[i], &b = region[(i + 1) % region.size()];
    const Polygon off = clipped(inside, a, b, -1.0);
    if (area_of(off) <= least) continue;  // nothing is beyond this side
    outside.push_back(off);
    inside = clipped(inside, a, b, 1.0);
    if (area_of(inside) <= least) inside.clear();
  }
}

bool Region::axis_point(Plane& point) const {
  Matrix3d matrix;
  matrix << n_[0], n_[1], n_[2];
  const Eigen::FullPivLU<Matrix3d> lu(matrix);
  if (lu.rank() < 3) return false;
  Vector3d weights = lu.solve(cone_.axis);
  const double rounding = 1e-12 * weights.cwiseAbs().maxCoeff();
  if (!(weights.minCoeff() >= -rounding)) return false;
  weights = weights.cwiseMax(0.0);
  weights /= weights.sum();
  point = {weights[1], weights[2]};
  return true;
}

Polygon Region::polygon(const std::array<Span, 3>& spans) const {
  static const std::array<Plane, 3> corner = {Plane(0, 0), Plane(1, 0), Plane(0, 1)};
  Polygon result;
  std::vector<std::pair<Plane, Plane>> chords;  // straight pieces on the sides
  for (int i = 0; i < 3; ++i) {
    if (spans[i].empty()) continue;
    const Plane &a = corner[i], &b = corner[(i + 1) % 3];
    chords.emplace_back(a + spans[i].a * (b - a), a + spans[i].b * (b - a));
  }
  Plane middle;
  if (chords.empty()) {
    if (!axis_point(middle)) return {};
    std::array<Plane, 4> ring;
    const std::array<Plane, 4> directions = {Plane(1, 0), Plane(0, 1), Plane(-1, 0), Plane(0, -1)};
    for (int i = 0; i < 4; ++i) ring[i] = middle + reach(middle, directions[i]) * directions[i];
    for (int i = 0; i < 4; ++i) {
      result.push_back(ring[i]);
      arc(ring[i], ring[(i + 1) % 4], 4, result);
    }
    return result;
  }
  for (std::size_t i = 0; i < chords.size(); ++i) {
    result.push_back(chords[i].first);
    result.push_back(chords[i].second);
    arc(chords[i].second, chords[(i + 1) % chords.size()].first, 3, result);
  }
  Polygon distinct;
  for (const Plane& p : result) {
    if (distinct.empty() || (p - distinct.back()).norm() > 1e-13) distinct.push_back(p);
  }
  while (distinct.size() > 1 && (distinct.front() - distinct.back()).norm() <= 1e-13) {
    distinct.pop_back();
  }
  return distinct;
}

double Region::reach(const Plane& from, const Plane& direction) const {
  for (const double s : roots(cone_, at(from), at(from + direction) - at(from))) {
    if (s > 0.0) return s;
  }
  return 0.0;
}

void Region::arc(const Plane& a, const Plane& b, int depth, Polygon& result) const {
  const Plane chord = b - a;
  if (depth == 0 || chord.norm() < 1e-12) return;
  const Plane outward(chord.y(), -chord.x());
  const Plane from = 0.5 * (a + b);
  if (!cone_.holds(at(from))) return;
  const double distance = reach(from, outward);
  if (!(distance < 4.0)) return;  // nearly flat: the chord suffices
  Plane middle = from + distance * outward;
  // Roots on the smooth surface need not lie on the conic that linear normals define.
  middle = middle.cwiseMax(0.0);
  if (middle.sum() > 1.0) middle /= middle.sum();
  arc(a, middle, depth - 1, result);
  result.push_back(middle);
  arc(middle, b, depth - 1, result);
}

}  // namespace statejump::rest_set::detail
