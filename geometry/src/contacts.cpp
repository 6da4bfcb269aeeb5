// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "impl.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::geometry {
namespace {

constexpr double pi = 3.141592653589793238462643;
constexpr double infinity = std::numeric_limits<double>::infinity();

using kernel::require;

void validate(const Vector3& centre, const char* centre_name, double radius,
              const char* radius_name, double maximum_gap) {
  require_finite(centre, centre_name);
  require(radius > 0 && std::isfinite(radius), radius_name, radius, "(0, inf) m");
  require(maximum_gap >= 0 && std::isfinite(maximum_gap), "maximum_gap", maximum_gap, "[0, inf) m");
}

BoreContact contact_at(const BoreMesh::Impl& m, const Hit& hit, const Vector3& normal,
                       double depth) {
  const Principal p = principal(hit);
  BoreContact contact;
  contact.point = hit.point;
  contact.normal = normal;
  contact.depth = depth;
  contact.section_curvature = p.smaller;
  contact.axial_curvature = p.larger;
  contact.curvature_1 = p.larger;
  contact.curvature_2 = p.smaller;
  contact.direction_1 = p.direction_larger;
  contact.direction_2 = p.direction_smaller;
  contact.face = m.wall.faces[hit.face];
  contact.previous = -1;
  return contact;
}

/// A contact and the wall point it belongs to.
struct Candidate {
  BoreContact contact;
  Hit hit;
};

template <class Equal>
void drop_equal(std::vector<Candidate>& candidates, const Equal& equal) {
  for (std::size_t i = 0; i < candidates.size(); ++i)
    for (std::size_t j = candidates.size(); j-- > i + 1;)
      if (equal(candidates[i], candidates[j]))
        candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(j));
}

std::vector<BoreContact> sort_and_match(std::vector<Candidate>& candidates,
                                        const std::vector<Vector3>& previous, Survey* survey) {
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.contact.depth > b.contact.depth;
  });
  std::vector<BoreContact> contacts;
  for (const Candidate& one : candidates) {
    contacts.push_back(one.contact);
    if (survey) survey->hits.push_back(one.hit);
  }
  std::vector<char> taken(previous.size(), 0);
  for (std::size_t round = 0; round < std::min(contacts.size(), previous.size()); ++round) {
    double best = 0.86602540378443865;  // cos(30 degrees): a twelfth of a turn
    std::size_t which = contacts.size(), whose = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (contacts[i].previous >= 0) continue;
      for (std::size_t j = 0; j < previous.size(); ++j)
        if (!taken[j] && contacts[i].normal.dot(previous[j]) > best) {
          best = contacts[i].normal.dot(previous[j]);
          which = i;
          whose = j;
        }
    }
    if (which == contacts.size()) break;
    contacts[which].previous = static_cast<int>(whose);
    taken[whose] = 1;
  }
  return contacts;
}

std::vector<Vector3> normals_of(const std::vector<BoreContact>& contacts) {
  std::vector<Vector3> normals;
  for (const BoreContact& one : contacts) normals.push_back(one.normal);
  return normals;
}

/// Minimum of values on a ring.
struct Minimum {
  int index;
  double value;
};

/// Removes each minimum that rises by less than the prominence before a lower minimum. The lowest
/// one always remains.
void drop_flat(std::vector<Minimum>& minima, const std::vector<double>& values, double prominence) {
  const int count = static_cast<int>(values.size());
  while (minima.size() > 1) {
    const std::size_t size = minima.size();
    double least = infinity;
    std::size_t which = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t j = (i + 1) % size;
      double top = std::max(minima[i].value, minima[j].value);
      for (int k = (minima[i].index + 1) % count; k != minima[j].index; k = (k + 1) % count)
        top = std::max(top, values[k]);
      const double rise = top - std::max(minima[i].value, minima[j].value);
      if (rise < least) {
        least = rise;
        which = minima[i].value > minima[j].value ? i : j;
      }
    }
    if (!(least < prominence)) return;
    minima.erase(minima.begin() + static_cast<std::ptrdiff_t>(which));
  }
}

/// Distance of the wall from the journal's centre along a direction in the journal's section, with
/// derivatives.
struct Section {
  const BoreMesh::Impl& m;
  Vector3 centre, axis;

  struct Sample {
    Hit hit;
    double slope = 0, bend = 0;  ///< first and second derivative of hit.s by the angle
  };

  bool at(const Vector3& direction, int near, Sample& sample) const {
    sample.hit = m.meet(centre, direction, near);
    if (!sample.hit.found) return false;
    const Vector3& n = sample.hit.normal;
    const Vector3 tau = cross(axis, direction);
    const double rho = sample.hit.s;
    sample.slope = -rho * n.dot(tau) / n.dot(direction);
    const Vector3 in_plane = n - n.dot(axis) * axis;
    const double lean = in_plane.norm();
    const Vector3 tangent = cross(axis, in_plane) / lean;
    const double curvature = tangent.dot(sample.hit.bend * tangent) / lean;
    const double speed_squared = rho * rho + sample.slope * sample.slope;
    sample.bend = (rho * rho + 2 * sample.slope * sample.slope -
                   curvature * speed_squared * std::sqrt(speed_squared)) /
                  rho;
    return true;
  }

  /// Finds the local minimum of the distance between two angles relative to `start`. Returns false
  /// if `start` meets no wall.
  bool minimum(const Vector3& start, double low, double high, int near, Sample& best) const {
    const Vector3 across = cross(axis, start);
    double angle = 0;
    for (int iteration = 0; iteration < 60; ++iteration) {
      const Vector3 direction = std::cos(angle) * start + std::sin(angle) * across;
      Sample sample;
      if (!at(direction, near, sample)) {
        // No wall in this direction: go back towards the start.
        if (angle == 0) return false;
        (angle < 0 ? low : high) = angle;
        angle *= 0.5;
        if (std::abs(angle) < 1e-9) return true;
        continue;
      }
      best = sample;
      near = sample.hit.face;
      if (std::abs(sample.slope) <= 1e-15 * sample.hit.s) return true;
      (sample.slope > 0 ? high : low) = angle;
      double next = angle - sample.slope / sample.bend;
      if (!(sample.bend > 0) || !(next > low && next < high)) next = 0.5 * (low + high);
      // Near a minimum, a change of 1e-10 rad changes the distance only by a fraction of 1e-20.
      if (std::abs(next - angle) < 1e-10) return true;
      angle = next;
    }
    return true;
  }
};

}  // namespace

std::vector<BoreContact> BoreMesh::contacts(const Eigen::Vector3d& journal_centre,
                                            const Eigen::Vector3d& journal_axis,
                                            double journal_radius, double maximum_gap,
                                            const std::vector<BoreContact>& previous) const {
  return find_contacts(*impl_, journal_centre, journal_axis, journal_radius, maximum_gap,
                       normals_of(previous), nullptr);
}

std::vector<BoreContact> BoreMesh::ball_contacts(const Eigen::Vector3d& ball_centre,
                                                 double ball_radius, double maximum_gap,
                                                 const std::vector<BoreContact>& previous) const {
  return find_ball_contacts(*impl_, ball_centre, ball_radius, maximum_gap, normals_of(previous),
                            nullptr);
}

std::vector<BoreContact> find_contacts(const BoreMesh::Impl& m, const Vector3& journal_centre,
                                       const Vector3& journal_axis, double journal_radius,
                                       double maximum_gap, const std::vector<Vector3>& previous,
                                       Survey* survey) {
  if (m.kind != SurfaceKind::bore)
    throw kernel::OutOfRange("kind of the mesh", "socket", "bore, which a journal needs");
  validate(journal_centre, "journal_centre", journal_radius, "journal_radius", maximum_gap);
  const double axis_length = journal_axis.norm();
  require(axis_length > 0 && std::isfinite(axis_length), "size of journal_axis", axis_length,
          "finite, > 0");
  Vector3 axis = journal_axis / axis_length;
  double along = axis.dot(m.wall.axis);
  if (along < 0) {
    axis = -axis;
    along = -along;
  }
  require(along > 0.5, "cosine of the journal's tilt", along, "(0.5, 1]");

  const Grid& grid = m.grid;
  const int columns = grid.columns;
  const double limit = journal_radius + maximum_gap;
  const Vector3 offset = journal_centre - m.wall.centre;
  const double height = offset.dot(axis) / along;
  const double lean_x = m.wall.axis_x.dot(axis) / along;
  const double lean_y = m.wall.axis_y.dot(axis) / along;
  const double centre_x = offset.dot(m.wall.axis_x);
  const double centre_y = offset.dot(m.wall.axis_y);
  const double centre_z = offset.dot(m.wall.axis);

  if (survey) survey->not_flat = infinity;
  if (grid.least - std::hypot(centre_x, centre_y) > limit) return {};

  // Distances of the grid samples in the journal's section, interpolated between rows. The vectors
  // are thread_local, so that repeated calls allocate no memory.
  thread_local std::vector<double> distance, x, y, z;
  for (auto* v : {&distance, &x, &y, &z}) v->resize(columns);
  const bool tilted = lean_x * lean_x + lean_y * lean_y > 0;
  double lowest = infinity;
  for (int c = 0; c < columns; ++c) {
    double level = height;
    if (tilted) level -= m.wall.radius * (grid.cosine[c] * lean_x + grid.sine[c] * lean_y);
    const double row = (level - grid.low) / grid.step;
    distance[c] = infinity;
    // The wall beside a missing sample is unknown. Assume that it is at least as curved as the
    // journal.
    if (survey && !(row >= 0 && row <= grid.rows - 1)) survey->not_flat = 0;
    if (!(row >= 0 && row <= grid.rows - 1)) continue;
    const int lower = std::min(static_cast<int>(row), grid.rows - 2);
    const double part = row - lower;
    const double* radius = &grid.radius[static_cast<std::size_t>(lower) * columns + c];
    const double r = (1 - part) * radius[0] + part * radius[columns];
    if (survey && !(r > 0)) survey->not_flat = 0;
    if (!(r > 0)) continue;  // a hole in the grid
    x[c] = r * grid.cosine[c] - centre_x;
    y[c] = r * grid.sine[c] - centre_y;
    z[c] = level - centre_z;
    distance[c] = std::sqrt(x[c] * x[c] + y[c] * y[c] + z[c] * z[c]);
    lowest = std::min(lowest, distance[c]);
    if (survey) {
      const double* hollow = &grid.hollow[static_cast<std::size_t>(lower) * columns + c];
      survey->look_at(distance[c], std::max(hollow[0], hollow[columns]), grid.sag);
    }
  }
  if (!(lowest < infinity)) return {};

  std::vector<Minimum> minima;
  for (int c = 0; c < columns; ++c) {
    const double here = distance[c];
    if (here == infinity) continue;
    const double before = distance[(c + columns - 1) % columns];
    const double after = distance[(c + 1) % columns];
    if (!(here <= before && here < after) && !(here < before && here <= after)) continue;
    // Between columns the wall may be nearer than at the sample; `below` is a parabolic estimate of
    // this. Interpolation between rows adds an eighth of the second difference.
    double below = 0;
    for (const double side : {before, after})
      if (side < infinity) below = std::max(below, side - here);
    if (here - below - 0.01 * m.wall.radius > limit) continue;
    minima.push_back({c, here});
  }
  if (minima.empty() && lowest <= limit)  // all distances are equal
    minima.push_back(
        {static_cast<int>(std::min_element(distance.begin(), distance.end()) - distance.begin()),
         lowest});
  if (minima.empty()) return {};
  drop_flat(minima, distance, m.prominence);

  const Section section{m, journal_centre, axis};
  std::vector<Candidate> result;
  for (const Minimum& seed : minima) {
    const int c = seed.index;
    const auto direction_of = [&](int i) -> Vector3 {
      return x[i] * m.wall.axis_x + y[i] * m.wall.axis_y + z[i] * m.wall.axis;
    };
    Vector3 start = direction_of(c);
    start -= start.dot(axis) * axis;
    start.normalize();
    const Vector3 across = cross(axis, start);
    const auto angle_of = [&](int i, double fallback) {
      if (distance[i] == infinity) return fallback;
      const Vector3 d = direction_of(i);
      return 1.5 * std::atan2(d.dot(across), d.dot(start));
    };
    const double low = angle_of((c + columns - 1) % columns, -3 * pi / columns);
    const double high = angle_of((c + 1) % columns, 3 * pi / columns);
    const int row =
        std::clamp(static_cast<int>((z[c] + centre_z - grid.low) / grid.step), 0, grid.rows - 1);
    Section::Sample best;
    if (!section.minimum(start, low, high, grid.face[row * columns + c], best)) continue;
    if (!(best.hit.s < limit)) continue;
    const Vector3 way = (best.hit.point - journal_centre).normalized();
    BoreContact contact = contact_at(m, best.hit, way, journal_radius - best.hit.s);
    const SectionCurvature k = section_curvature(best.hit, axis);
    contact.section_curvature = -k.section;
    contact.axial_curvature = -k.axial;
    result.push_back({contact, best.hit});
  }
  // Remove contacts of two samples that converged to the same minimum.
  drop_equal(result, [](const Candidate& a, const Candidate& b) {
    return a.contact.normal.dot(b.contact.normal) > 1 - 1e-8;
  });
  return sort_and_match(result, previous, survey);
}

std::vector<BoreContact> find_ball_contacts(const BoreMesh::Impl& m, const Vector3& ball_centre,
                                            double ball_radius, double maximum_gap,
                                            const std::vector<Vector3>& previous, Survey* survey) {
  validate(ball_centre, "ball_centre", ball_radius, "ball_radius", maximum_gap);
  const Grid& grid = m.grid;
  const int cells = grid.rows * grid.columns;
  const double limit = ball_radius + maximum_gap;
  // The offset from the axis (for a socket: from the middle) gives a lower bound of the distance.
  const Vector3 offset = ball_centre - m.wall.centre;
  const Vector3 across = m.kind == SurfaceKind::bore
                             ? Vector3(offset - offset.dot(m.wall.axis) * m.wall.axis)
                             : offset;
  if (survey) survey->not_flat = infinity;
  if (grid.least - across.norm() > limit) return {};
  thread_local std::vector<double> distance;
  distance.resize(cells);
  for (int i = 0; i < cells; ++i) {
    const double d = (grid.point[i] - ball_centre).norm();
    distance[i] = d >= 0 ? d : infinity;
    if (survey && d >= 0) survey->look_at(d, grid.hollow[i], grid.sag);
  }
  // Selects cells whose part of the wall may contain a point nearer than `limit`. Perpendicular to
  // the line of sight, such a point is at most `reach` away from the sample. Along it, the point is
  // nearer than the sample by at most the sag of the wall.
  const double within = limit + 0.01 * m.wall.radius + grid.sag;
  std::vector<int> order;
  for (int i = 0; i < cells; ++i)
    if (distance[i] * distance[i] < within * within + grid.reach[i] * grid.reach[i])
      order.push_back(i);
  if (order.empty()) return {};
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return distance[a] < distance[b] || (distance[a] == distance[b] && a < b);
  });
  // Floods the cells from the lowest upwards. A basin is dropped if it joins a lower one before it
  // has risen by the prominence.
  thread_local std::vector<int> basin;
  basin.assign(cells, -1);
  std::vector<int> parent, root, alive;
  const auto find = [&](int b) {
    while (parent[b] != b) b = parent[b] = parent[parent[b]];
    return b;
  };
  for (const int cell : order) {
    int own = -1;
    grid.for_neighbours(cell, [&](int other) {
      if (basin[other] < 0) return;
      const int b = find(basin[other]);
      if (own < 0) {
        own = b;
      } else if (own != b) {
        const int higher = distance[root[own]] > distance[root[b]] ? own : b;
        const int lower = higher == own ? b : own;
        if (distance[cell] - distance[root[higher]] < m.prominence) alive[higher] = 0;
        parent[higher] = lower;
        own = lower;
      }
    });
    if (own < 0) {
      own = static_cast<int>(parent.size());
      parent.push_back(own);
      root.push_back(cell);
      alive.push_back(1);
    }
    basin[cell] = own;
  }
  std::vector<Candidate> result;
  for (std::size_t b = 0; b < root.size(); ++b) {
    if (!alive[b]) continue;
    const Vector3 way = grid.point[root[b]] - ball_centre;
    Hit hit = m.meet(ball_centre, way.normalized(), grid.face[root[b]]);
    if (!hit.found) continue;
    if (!m.descend(ball_centre, hit)) continue;
    const Vector3 out = hit.point - ball_centre;
    const double reach = out.norm();
    if (!(reach < limit)) continue;
    result.push_back({contact_at(m, hit, out / reach, ball_radius - reach), hit});
  }
  drop_equal(result, [&](const Candidate& a, const Candidate& b) {
    return (a.contact.point - b.contact.point).norm() < 1e-4 * m.wall.radius;
  });
  return sort_and_match(result, previous, survey);
}

}  // namespace statejump::geometry
