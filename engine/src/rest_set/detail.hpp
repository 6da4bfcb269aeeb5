// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "statejump/kernel/require.hpp"
#include "statejump/rest_set/rest_set.hpp"

namespace statejump::rest_set::detail {

constexpr double pi = 3.14159265358979323846;

template <class Vector>
void check(const std::vector<Vector>& forces, double mu) {
  kernel::require(std::isfinite(mu) && mu >= 0.0, "mu", mu, "finite, >= 0");
  kernel::require(!forces.empty(), "number of forces", 0.0, "at least 1");
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const double size = forces[i].stableNorm();
    kernel::require(std::isfinite(size) && size > 0.0,
                    ("size of forces[" + std::to_string(i) + "]").c_str(), size,
                    "finite, > 0 N: without a force every position is at rest");
  }
}

inline void check_length(double value, const char* name) {
  kernel::require(std::isfinite(value) && value > 0.0, name, value, "finite, > 0 m");
}

/// Closed interval from a to b. On a circle 0 <= a < period and b - a <= period.
struct Interval {
  double a, b;
  double width() const { return b - a; }
};

/// Disjoint closed intervals on a line (period 0) or a circle. An interval may be a single point.
class Intervals {
 public:
  explicit Intervals(double period = 0.0, double tolerance = 0.0)
      : period_(period), tolerance_(tolerance) {}

  void add(double a, double b) {
    if (period_ > 0.0) {
      if (b - a >= period_) {
        list_ = {{0.0, period_}};
        return;
      }
      const double shift = period_ * std::floor(a / period_);
      a -= shift;
      b -= shift;
    }
    list_.push_back({a, b});
    merge();
  }

  void add(const Intervals& other) {
    for (const Interval& i : other.list_) add(i.a, i.b);
  }

  bool full() const { return period_ > 0.0 && list_.size() == 1 && list_[0].width() >= period_; }

  Intervals common(const Intervals& other) const {
    if (full()) return other;
    if (other.full()) return *this;
    Intervals result(period_, tolerance_);
    for (const Interval& i : list_) {
      for (const Interval& j : other.list_) {
        for (int turn = period_ > 0.0 ? -1 : 0; turn <= (period_ > 0.0 ? 1 : 0); ++turn) {
          const double low = std::max(i.a, j.a + turn * period_);
          const double high = std::min(i.b, j.b + turn * period_);
          if (low <= high) result.add(low, high);
        }
      }
    }
    return result;
  }

  /// The gaps between the intervals, with their ends.
  Intervals complement() const {
    Intervals result(period_, tolerance_);
    if (list_.empty()) {
      result.add(0.0, period_);
    } else if (!full()) {
      for (std::size_t i = 0; i < list_.size(); ++i) {
        const double next = i + 1 < list_.size() ? list_[i + 1].a : list_[0].a + period_;
        result.add(list_[i].b, next);
      }
    }
    return result;
  }

  Intervals shifted(double by) const {
    Intervals result(period_, tolerance_);
    for (const Interval& i : list_) result.add(i.a + by, i.b + by);
    return result;
  }

  bool contains(double x) const {
    Intervals point(period_, tolerance_);
    point.add(x, x);
    return !common(point).list().empty();
  }

  const std::vector<Interval>& list() const { return list_; }

 private:
  void merge() {
    std::sort(list_.begin(), list_.end(), [](const Interval& i, const Interval& j) {
      return i.a < j.a || (i.a == j.a && i.b < j.b);
    });
    std::vector<Interval> joined;
    for (const Interval& i : list_) {
      if (!joined.empty() && i.a <= joined.back().b + tolerance_) {
        joined.back().b = std::max(joined.back().b, i.b);
      } else {
        joined.push_back(i);
      }
    }
    // The last interval may reach around to the first ones.
    while (period_ > 0.0 && joined.size() > 1 &&
           joined.front().a + period_ <= joined.back().b + tolerance_) {
      joined.back().b = std::max(joined.back().b, joined.front().b + period_);
      joined.erase(joined.begin());
    }
    if (period_ > 0.0 && joined.size() == 1 && joined[0].width() >= period_ - tolerance_) {
      joined = {{0.0, period_}};
    }
    list_ = std::move(joined);
  }

  double period_, tolerance_;
  std::vector<Interval> list_;
};

/// Exact farthest pair of points. Distances from the centre of the bounding box exclude most of
/// them.
template <class Points>
double farthest_pair(const Points& points, std::size_t& first, std::size_t& second) {
  first = second = 0;
  if (points.size() < 2) return 0.0;
  auto low = points[0], high = points[0];
  for (const auto& p : points) {
    low = low.cwiseMin(p).eval();
    high = high.cwiseMax(p).eval();
  }
  const auto centre = (0.5 * (low + high)).eval();
  std::vector<std::pair<double, std::size_t>> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) order[i] = {(points[i] - centre).norm(), i};
  std::sort(order.rbegin(), order.rend());
  double best = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (2.0 * order[i].first < best) break;
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      if (order[i].first + order[j].first < best) break;
      const double distance = (points[order[i].second] - points[order[j].second]).norm();
      if (distance > best) {
        best = distance;
        first = order[i].second;
        second = order[j].second;
      }
    }
  }
  return best;
}

/// Connected components of numbered nodes.
class Components {
 public:
  explicit Components(std::size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t i, std::size_t j) {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace statejump::rest_set::detail
