// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/geometry/bore_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "impl.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::geometry {

BoreMesh::BoreMesh(Triangles triangles, const BoreOptions& options, const std::string& name)
    : impl_(std::make_shared<const Impl>(std::move(triangles), options, name)) {}

BoreMesh BoreMesh::read(const std::string& file, const BoreOptions& options) {
  return BoreMesh(read_triangles(file), options, file);
}

WallPoint BoreMesh::closest_point(const Eigen::Vector3d& query) const {
  require_finite(query, "query");
  const Impl& m = *impl_;
  const auto [foot, facet] =
      m.tree.closest_point_and_primitive(Impl::Kernel::Point_3(query.x(), query.y(), query.z()));
  const int face = static_cast<int>(facet - m.facets.cbegin());
  const Vector3 flat(foot.x(), foot.y(), foot.z());
  const auto& c = m.corner[face];
  const Vector3 direction =
      cross(m.jet[c[1]].origin - m.jet[c[0]].origin, m.jet[c[2]].origin - m.jet[c[0]].origin)
          .normalized();
  Hit hit = m.follow(flat, direction, face);
  m.blend(flat, direction, hit);
  const Hit at_start = hit;
  const bool inside = m.descend(query, hit);
  if (!inside && (query - at_start.point).squaredNorm() < (query - hit.point).squaredNorm())
    hit = at_start;
  const Principal p = principal(hit);
  WallPoint result;
  result.point = hit.point;
  result.normal = hit.normal;
  const Vector3 way = query - hit.point;
  result.distance = std::copysign(way.norm(), way.dot(hit.normal));
  result.curvature_1 = p.larger;
  result.curvature_2 = p.smaller;
  result.direction_1 = p.direction_larger;
  result.direction_2 = p.direction_smaller;
  result.face = m.wall.faces[hit.face];
  result.barycentric = hit.weight;
  result.on_rim = !inside;
  return result;
}

std::vector<double> BoreMesh::section_radii(double z, int count) const {
  kernel::require(count >= 1, "count of radii", count, "at least 1");
  const Impl& m = *impl_;
  const Vector3 from = m.wall.centre + z * m.wall.axis;
  std::vector<double> radii(count, std::numeric_limits<double>::quiet_NaN());
  int near = -1;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * 3.141592653589793238462643 * i / count;
    const Hit hit =
        m.meet(from, std::cos(angle) * m.wall.axis_x + std::sin(angle) * m.wall.axis_y, near);
    if (!hit.found) continue;
    radii[i] = hit.s;
    near = hit.face;
  }
  return radii;
}

const Triangles& BoreMesh::triangles() const {
  return impl_->mesh;
}
const std::vector<int>& BoreMesh::wall() const {
  return impl_->wall.faces;
}
SurfaceKind BoreMesh::kind() const {
  return impl_->kind;
}
bool BoreMesh::closed() const {
  return impl_->wall.closed;
}
double BoreMesh::mean_radius() const {
  return impl_->wall.radius;
}
const Eigen::Vector3d& BoreMesh::centre() const {
  return impl_->wall.centre;
}
const Eigen::Vector3d& BoreMesh::axis() const {
  return impl_->wall.axis;
}
const Eigen::Vector3d& BoreMesh::axis_x() const {
  return impl_->wall.axis_x;
}
const Eigen::Vector3d& BoreMesh::axis_y() const {
  return impl_->wall.axis_y;
}
double BoreMesh::length() const {
  return impl_->wall.high - impl_->wall.low;
}
double BoreMesh::smallest_curvature() const {
  return impl_->least_curvature;
}
double BoreMesh::largest_curvature() const {
  return impl_->most_curvature;
}
double BoreMesh::reconstruction_error() const {
  return impl_->error;
}
double BoreMesh::prominence() const {
  return impl_->prominence;
}
const std::vector<Eigen::Vector3d>& BoreMesh::vertex_normals() const {
  return impl_->vertex_normal;
}

}  // namespace statejump::geometry
