// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/rest_set/curve.hpp"

#include <map>
#include <stdexcept>
#include <utility>

#include "detail.hpp"
#include "numerics/change_between.hpp"

namespace statejump::rest_set {

using Eigen::Vector2d;
using Eigen::Vector3d;
using kernel::require;
using namespace detail;

namespace {

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Signed angle from a to b in (−π, π].
double signed_angle(const Vector2d& a, const Vector2d& b) {
  return std::atan2(cross(a, b), a.dot(b));
}

double wrapped(double angle) {
  return std::remainder(angle, 2.0 * pi);
}

Vector3d lifted(const Vector2d& p) {
  return {p.x(), p.y(), 0.0};
}

// Implicit curves.

/// Γ with checks.
struct Implicit {
  PlaneFunction gamma;
  PlaneGradient gradient;
  double size;  ///< of a cell [m]

  double value(const Vector2d& p) const {
    const double result = gamma(p);
    if (!std::isfinite(result)) {
      throw kernel::OutOfRange(
          "", "gamma(" + std::to_string(p.x()) + ", " + std::to_string(p.y()) + ")", result,
          "finite");
    }
    return result;
  }

  Vector2d slope(const Vector2d& p) const {
    Vector2d result = gradient(p);
    const double norm = result.norm();
    require(std::isfinite(norm) && norm > 0.0, "size of the gradient of gamma on the curve", norm,
            "finite, > 0");
    return result;
  }

  CurvePoint projected(Vector2d p) const {
    for (int i = 0; i < 50; ++i) {
      const Vector2d g = slope(p);
      const Vector2d step = value(p) / g.squaredNorm() * g;
      p -= step;
      if (step.norm() <= 1e-15 * (p.norm() + size)) break;
    }
    return {p, -slope(p).normalized()};
  }

  /// Root on a grid line between two points at which Γ has different signs. The points differ in
  /// one coordinate.
  Vector2d root(const Vector2d& inside, const Vector2d& outside) const {
    const int k = inside.x() != outside.x() ? 0 : 1;
    Vector2d p = inside;
    const auto is_outside = [&](double coordinate) {
      p[k] = coordinate;
      return !(value(p) < 0.0);
    };
    const double width = std::abs(outside[k] - inside[k]);
    const auto found =
        numerics::change_between(inside[k], outside[k], is_outside, numerics::fine * width);
    p[k] = 0.5 * (found.before + found.after);
    return p;
  }
};

/// A segment of a grid line: its lower end (i, j), and its direction x (0) or y (1).
using GridEdge = std::array<int, 3>;

// Rest sets.

/// Angle of N from −F at t, continued from `from`.
double continued(const Curve& curve, const Vector2d& reaction, double t, double from) {
  return from + wrapped(signed_angle(reaction, curve.at(t).normal) - from);
}

Intervals rest_on_curve(const Curve& curve, const Vector2d& force, double alpha) {
  const Vector2d reaction = -force.normalized();
  const std::size_t n = curve.segments();
  Intervals result(curve.closed ? static_cast<double>(n) : 0.0, 1e-9);
  std::vector<double> angle(curve.nodes.size());
  for (std::size_t i = 0; i < angle.size(); ++i) {
    angle[i] = signed_angle(reaction, curve.nodes[i].normal);
    if (std::abs(angle[i]) <= alpha) result.add(static_cast<double>(i), static_cast<double>(i));
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double start = angle[i];
    const double stop = start + wrapped(angle[(i + 1) % angle.size()] - start);
    // Levels of the angle between both nodes, in order.
    std::vector<double> levels;
    for (int turn = -1; turn <= 1; ++turn) {
      for (const double level : {2.0 * pi * turn - alpha, 2.0 * pi * turn + alpha}) {
        if ((level - start) * (level - stop) < 0.0) levels.push_back(level);
      }
    }
    std::sort(levels.begin(), levels.end());
    if (stop < start) std::reverse(levels.begin(), levels.end());
    const double first = static_cast<double>(i);
    double before = first, before_level = start;
    for (std::size_t k = 0; k <= levels.size(); ++k) {
      double here = first + 1.0;
      const double level = k < levels.size() ? levels[k] : stop;
      if (k < levels.size()) {
        const auto reached = [&](double t) {
          return !((continued(curve, reaction, t, start) - level) * (stop - start) < 0.0);
        };
        here = numerics::change_between(before, here, reached).after;
      }
      if (std::abs(wrapped(0.5 * (before_level + level))) <= alpha) result.add(before, here);
      before = here;
      before_level = level;
    }
  }
  return result;
}

Vector2d position(const Curve& curve, double t) {
  const double n = static_cast<double>(curve.segments());
  if (curve.closed) t -= n * std::floor(t / n);
  const double node = std::floor(t);
  if (t == node) return curve.nodes[static_cast<std::size_t>(node) % curve.nodes.size()].position;
  return curve.at(t).position;
}

/// A position with its curve and parameter.
struct Mark {
  std::size_t curve;
  Interval allowed;
  double t;
};

/// Length, points and marks of one interval.
void walk(const Curve& curve, std::size_t index, const Interval& i, RestComponent& part,
          std::vector<Mark>& marks) {
  std::vector<double> stations = {i.a};
  for (double t = std::floor(i.a) + 1.0; t < i.b; t += 1.0) stations.push_back(t);
  if (i.b > i.a) stations.push_back(i.b);
  for (std::size_t k = 0; k < stations.size(); ++k) {
    const Vector2d here = position(curve, stations[k]);
    part.points.push_back(lifted(here));
    marks.push_back({index, i, stations[k]});
    if (k == 0) continue;
    const Vector2d before = position(curve, stations[k - 1]);
    const Vector2d middle = position(curve, 0.5 * (stations[k - 1] + stations[k]));
    const double chord = (here - before).norm();
    const double chords = (here - middle).norm() + (middle - before).norm();
    part.length += (4.0 * chords - chord) / 3.0;
  }
  part.representative = lifted(position(curve, 0.5 * (i.a + i.b)));
}

/// Farthest pair of marks, improved along the curves.
double farthest(const std::vector<Curve>& curves, const std::vector<Mark>& marks,
                std::array<Vector3d, 2>& pair) {
  if (marks.empty()) return 0.0;
  std::vector<Vector2d> points;
  for (const Mark& mark : marks) points.push_back(position(curves[mark.curve], mark.t));
  std::size_t first = 0, second = 0;
  double best = farthest_pair(points, first, second);
  std::array<Mark, 2> ends = {marks[first], marks[second]};
  for (int round = 0; round < 4 && best > 0.0; ++round) {
    for (const int moving : {0, 1}) {
      Mark& mark = ends[moving];
      const Mark& other = ends[1 - moving];
      const Vector2d fixed = position(curves[other.curve], other.t);
      const auto distance = [&](double t) {
        return (position(curves[mark.curve], t) - fixed).norm();
      };
      double low = std::max(mark.allowed.a, mark.t - 1.0);
      double high = std::min(mark.allowed.b, mark.t + 1.0);
      for (int i = 0; i < 60; ++i) {
        const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
        (distance(a) < distance(b) ? low : high) = distance(a) < distance(b) ? a : b;
      }
      const double found = distance(0.5 * (low + high));
      if (found > best) {
        best = found;
        mark.t = 0.5 * (low + high);
      }
    }
  }
  pair = {lifted(position(curves[ends[0].curve], ends[0].t)),
          lifted(position(curves[ends[1].curve], ends[1].t))};
  return best;
}

RestSet described(const std::vector<Curve>& curves, const std::vector<Intervals>& sets) {
  RestSet result;
  std::vector<Mark> marks;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    for (const Interval& i : sets[c].list()) {
      RestComponent part;
      std::vector<Mark> own;
      // A set that is a point up to rounding.
      const bool point = i.width() <= 1e-9;
      walk(curves[c], c, point ? Interval{i.a, i.a} : i, part, own);
      std::array<Vector3d, 2> pair;
      part.diameter = farthest(curves, own, pair);
      result.length += part.length;
      result.parts.push_back(part);
      marks.insert(marks.end(), own.begin(), own.end());
    }
  }
  result.diameter = farthest(curves, marks, result.farthest);
  return result;
}

/// Grid of marching squares.
struct CurveGrid {
  const Implicit& surface;
  Vector2d low, extent;
  int nx, ny;
  std::vector<bool> free;  ///< of every node

  CurveGrid(const Implicit& its_surface, const Vector2d& its_low, const Vector2d& its_extent)
      : surface(its_surface),
        low(its_low),
        extent(its_extent),
        nx(std::max(1, static_cast<int>(std::lround(extent.x() / surface.size)))),
        ny(std::max(1, static_cast<int>(std::lround(extent.y() / surface.size)))),
        free(static_cast<std::size_t>(nx + 1) * (ny + 1)) {
    for (int j = 0; j <= ny; ++j) {
      for (int i = 0; i <= nx; ++i) {
        free[static_cast<std::size_t>(j) * (nx + 1) + i] = surface.value(node(i, j)) < 0.0;
      }
    }
  }
  Vector2d node(int i, int j) const {
    return Vector2d(low.x() + extent.x() * i / nx, low.y() + extent.y() * j / ny);
  }
  bool is_free(int i, int j) const { return free[static_cast<std::size_t>(j) * (nx + 1) + i]; }
  std::map<GridEdge, std::vector<GridEdge>> neighbours() const;
};

/// Each cell connects the roots on its sides in pairs. So every root has at most two neighbours.
std::map<GridEdge, std::vector<GridEdge>> CurveGrid::neighbours() const {
  std::map<GridEdge, std::vector<GridEdge>> result;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const std::array<bool, 4> corner = {is_free(i, j), is_free(i + 1, j), is_free(i + 1, j + 1),
                                          is_free(i, j + 1)};
      const std::array<GridEdge, 4> side = {GridEdge{i, j, 0}, GridEdge{i + 1, j, 1},
                                            GridEdge{i, j + 1, 0}, GridEdge{i, j, 1}};
      std::vector<int> crossed;
      for (int k = 0; k < 4; ++k) {
        if (corner[k] != corner[(k + 1) % 4]) crossed.push_back(k);
      }
      if (crossed.size() == 4 &&
          (surface.value(0.5 * (node(i, j) + node(i + 1, j + 1))) < 0.0) == corner[0]) {
        // If the cell's centre belongs to corners 0 and 2, the listed order separates corners 1 and
        // 3. Otherwise rotate the list.
      } else if (crossed.size() == 4) {
        crossed = {3, 0, 1, 2};
      }
      for (std::size_t k = 0; k + 1 < crossed.size(); k += 2) {
        result[side[crossed[k]]].push_back(side[crossed[k + 1]]);
        result[side[crossed[k + 1]]].push_back(side[crossed[k]]);
      }
    }
  }
  return result;
}

}  // namespace

std::vector<Curve> implicit_curves(const PlaneFunction& gamma, const PlaneGradient& gradient,
                                   const Vector2d& low, const Vector2d& high, int cells) {
  const Vector2d extent = high - low;
  for (const int i : {0, 1}) {
    require(std::isfinite(extent[i]) && extent[i] > 0.0, "high - low", extent[i],
            "finite, > 0 m in x and y");
  }
  require(cells >= 4 && cells <= 4000, "cells", cells, "4 to 4000");
  const double step = extent.maxCoeff() / cells;
  const Implicit surface{gamma, gradient, step};
  const CurveGrid grid(surface, low, extent);
  std::map<GridEdge, std::vector<GridEdge>> neighbours = grid.neighbours();
  require(!neighbours.empty(), "number of curves gamma = 0 in the box", 0.0,
          "at least 1: gamma must change its sign between grid points");

  std::map<GridEdge, bool> used;
  std::vector<Curve> result;
  const auto trace = [&](const GridEdge& from) {
    Curve curve;
    std::vector<GridEdge> chain;
    for (GridEdge now = from;;) {
      used[now] = true;
      chain.push_back(now);
      const auto& next = neighbours[now];
      const auto free_one =
          std::find_if(next.begin(), next.end(), [&](const GridEdge& e) { return !used[e]; });
      if (free_one == next.end()) {
        const auto& last = neighbours[now];
        curve.closed = chain.size() > 2 && std::find(last.begin(), last.end(), from) != last.end();
        break;
      }
      now = *free_one;
    }
    for (const auto& [i, j, along_y] : chain) {
      const Vector2d a = grid.node(i, j);
      const Vector2d b = along_y ? grid.node(i, j + 1) : grid.node(i + 1, j);
      const Vector2d p = grid.is_free(i, j) ? surface.root(a, b) : surface.root(b, a);
      // Roots on either side of a grid point may coincide.
      if (!curve.nodes.empty() && (curve.nodes.back().position - p).norm() < 1e-9 * step) continue;
      curve.nodes.push_back({p, -surface.slope(p).normalized()});
    }
    if (curve.nodes.size() < 2) return;
    curve.at = [nodes = curve.nodes, surface](double t) {
      const std::size_t i = static_cast<std::size_t>(std::floor(t));
      const double part = t - std::floor(t);
      const Vector2d& a = nodes[i % nodes.size()].position;
      const Vector2d& b = nodes[(i + 1) % nodes.size()].position;
      return surface.projected((1.0 - part) * a + part * b);
    };
    result.push_back(std::move(curve));
  };
  for (const auto& [edge, next] : neighbours) {
    if (next.size() == 1 && !used[edge]) trace(edge);  // ends at the box
  }
  for (const auto& [edge, next] : neighbours) {
    if (!used[edge]) trace(edge);
  }
  return result;
}

namespace {

Curve by_angle(const std::function<CurvePoint(double)>& at_angle, int samples) {
  Curve curve;
  curve.closed = true;
  curve.at = [at_angle, samples](double t) { return at_angle(2.0 * pi * t / samples); };
  for (int i = 0; i < samples; ++i) curve.nodes.push_back(curve.at(i));
  return curve;
}

}  // namespace

Curve lobed_curve(double clearance, double amplitude, int lobes, int samples) {
  check_length(clearance, "clearance");
  require(std::abs(amplitude) < 1.0, "amplitude", amplitude, "above -1 and below 1");
  require(lobes >= 1 && lobes <= 1000, "lobes", lobes, "1 to 1000");
  require(samples >= 16 * lobes, "samples", samples, "at least 16 per lobe");
  return by_angle(
      [=](double theta) {
        const double r = clearance * (1.0 + amplitude * std::cos(lobes * theta));
        const double slope = -clearance * amplitude * lobes * std::sin(lobes * theta);
        const Vector2d e(std::cos(theta), std::sin(theta)), across(-e.y(), e.x());
        return CurvePoint{r * e, (slope * across - r * e).normalized()};
      },
      samples);
}

namespace {

/// A bore's wall and the journal in it.
struct Profile {
  std::function<double(double)> rho;
  double journal_radius;
  int samples;

  double step() const { return 2.0 * pi / samples; }
  double wall(double theta) const {
    const double value = rho(theta);
    require(std::isfinite(value) && value > 0.0, ("rho(" + std::to_string(theta) + ")").c_str(),
            value, "finite, > 0 m");
    return value;
  }
  /// Distance r of the centre in direction phi at which it touches the wall point at theta;
  /// infinity if it never does.
  double first_touch(double theta, double phi) const {
    const double value = wall(theta);
    const double side = value * std::sin(theta - phi);
    if (std::cos(theta - phi) <= 0.0 || std::abs(side) > journal_radius) {
      return std::numeric_limits<double>::infinity();
    }
    return value * std::cos(theta - phi) -
           std::sqrt((journal_radius - side) * (journal_radius + side));
  }
  double nearest_contact(double phi, double& least) const;
  double refined_contact(const Vector2d& centre, double contact) const;
};

/// Angle of the wall point that is touched first in direction phi, refined by golden section
/// search.
/// @param least on input first_touch(phi, phi), on output the smallest distance on the grid of
/// samples
double Profile::nearest_contact(double phi, double& least) const {
  double contact = phi;
  for (int i = -samples / 4; i <= samples / 4; ++i) {
    const double r = first_touch(phi + i * step(), phi);
    if (r < least) {
      least = r;
      contact = phi + i * step();
    }
  }
  double low = contact - step(), high = contact + step();
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  double a = high - ratio * (high - low), b = low + ratio * (high - low);
  double fa = first_touch(a, phi), fb = first_touch(b, phi);
  for (int i = 0; i < 80; ++i) {
    if (fa < fb) {
      high = b;
      b = a;
      fb = fa;
      a = high - ratio * (high - low);
      fa = first_touch(a, phi);
    } else {
      low = a;
      a = b;
      fa = fb;
      b = low + ratio * (high - low);
      fb = first_touch(b, phi);
    }
  }
  return 0.5 * (low + high);
}

/// A minimum is accurate only to the square root of rounding, too coarse for the normal. The
/// direction from wall to centre is normal to the wall; the secant method solves this condition.
double Profile::refined_contact(const Vector2d& centre, double contact) const {
  const auto tangency = [&](double theta) {
    const double h = 1e-4;
    const double value = wall(theta);
    const double slope = (8.0 * (wall(theta + h) - wall(theta - h)) -
                          (wall(theta + 2.0 * h) - wall(theta - 2.0 * h))) /
                         (12.0 * h);
    const Vector2d e(std::cos(theta), std::sin(theta)), across(-e.y(), e.x());
    return (centre - value * e).dot(slope * e + value * across);
  };
  double t0 = contact - 1e-6, t1 = contact + 1e-6;
  double f0 = tangency(t0), f1 = tangency(t1);
  for (int i = 0; i < 20 && f1 != f0; ++i) {
    const double t2 = t1 - f1 * (t1 - t0) / (f1 - f0);
    if (!(std::abs(t2 - contact) < step())) break;
    t0 = t1;
    f0 = f1;
    t1 = t2;
    f1 = tangency(t1);
    if (t1 == t0) break;
  }
  return std::abs(t1 - contact) < 1e-4 ? t1 : contact;
}

}  // namespace

Curve journal_in_profile(const std::function<double(double)>& rho, double journal_radius,
                         int samples) {
  check_length(journal_radius, "journal_radius");
  require(samples >= 16, "samples", samples, "at least 16");
  const Profile profile{rho, journal_radius, samples};
  for (int i = 0; i < samples; ++i) {
    const double value = profile.wall(2.0 * pi * i / samples);
    require(value > journal_radius, ("rho(" + std::to_string(2.0 * pi * i / samples) + ")").c_str(),
            value, "above journal_radius [m]: the journal must fit at the origin");
  }
  return by_angle(
      [profile](double phi) {
        double least = profile.first_touch(phi, phi);
        double contact = profile.nearest_contact(phi, least);
        const double r = std::min(profile.first_touch(contact, phi), least);
        const Vector2d centre = r * Vector2d(std::cos(phi), std::sin(phi));
        contact = profile.refined_contact(centre, contact);
        const Vector2d touching =
            profile.wall(contact) * Vector2d(std::cos(contact), std::sin(contact));
        return CurvePoint{centre, (centre - touching).normalized()};
      },
      samples);
}

RestStudy rest_on_curves(const std::vector<Curve>& curves, const std::vector<Vector2d>& forces,
                         double mu) {
  check(forces, mu);
  require(!curves.empty(), "number of curves", 0.0, "at least 1");
  for (const Curve& curve : curves) {
    require(curve.nodes.size() >= 2, "number of nodes", static_cast<double>(curve.nodes.size()),
            "at least 2");
  }
  RestStudy study;
  std::vector<Intervals> any, all;
  for (const Vector2d& force : forces) {
    std::vector<Intervals> sets;
    for (const Curve& curve : curves) {
      sets.push_back(rest_on_curve(curve, force, std::atan(mu)));
    }
    study.each.push_back(described(curves, sets));
    if (any.empty()) {
      any = all = sets;
      continue;
    }
    for (std::size_t i = 0; i < sets.size(); ++i) {
      any[i].add(sets[i]);
      all[i] = all[i].common(sets[i]);
    }
  }
  study.any = described(curves, any);
  study.all = described(curves, all);
  return study;
}

}  // namespace statejump::rest_set
