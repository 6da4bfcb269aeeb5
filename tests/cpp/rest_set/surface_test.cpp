// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/rest_set/surface.hpp"
#include "../support/argument.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>

namespace statejump::rest_set {
namespace {

using Eigen::Vector3d;
using statejump::testing::Argument;
using statejump::testing::refused_argument;

constexpr double pi = 3.14159265358979323846;
constexpr double c = 1e-4;

Mesh implicit_sphere(int cells) {
  return implicit_surface([](const Vector3d& p) { return p.squaredNorm() - c * c; },
                          [](const Vector3d& p) -> Vector3d { return 2.0 * p; },
                          Vector3d(-1.21e-4, -1.23e-4, -1.22e-4),
                          Vector3d(1.24e-4, 1.22e-4, 1.25e-4), cells);
}

TEST(RestOnMesh, SphereConvergesWithTheSquareOfTheEdge) {
  const Vector3d force(0.3, -0.5, 1.0);
  const double mu = 0.5;
  const RestSet exact = rest_in_socket(c, {force}, mu).any;
  double area_before = 0.0, diameter_before = 0.0;
  std::printf("level  triangles  error of area  of diameter (relative)\n");
  for (int level = 2; level <= 6; ++level) {
    const Mesh mesh = clearance_sphere(c, level);
    const RestSet set = rest_on_mesh(mesh, {force}, mu).study.any;
    ASSERT_EQ(set.parts.size(), 1u);
    const double area = std::abs(set.area / exact.area - 1.0);
    const double diameter = std::abs(set.diameter / exact.diameter - 1.0);
    std::printf("%5d  %9zu  %.3e  %.3e\n", level, mesh.triangles.size(), area, diameter);
    EXPECT_LT(std::abs(set.diameter - exact.diameter), set.diameter_error);
    if (level > 2) {
      EXPECT_NEAR(area_before / area, 4.0, 1.0);
      EXPECT_LT(diameter, diameter_before / 2.0);
    }
    area_before = area;
    diameter_before = diameter;
  }
}

TEST(RestOnMesh, ImplicitSphere) {
  const Vector3d force(0.3, -0.5, 1.0);
  const double mu = 0.5;
  const RestSet exact = rest_in_socket(c, {force}, mu).any;
  double before = 0.0;
  std::printf("cells  triangles  error of area  of diameter (relative)\n");
  for (const int cells : {6, 12, 24, 48}) {
    const Mesh mesh = implicit_sphere(cells);
    const RestSet set = rest_on_mesh(mesh, {force}, mu).study.any;
    ASSERT_EQ(set.parts.size(), 1u);
    // The diameter is measured between points of the sphere. (On a sphere linear normals are exact,
    // so this does not test the roots on edges.)
    EXPECT_NEAR(set.diameter / exact.diameter, 1.0, 1e-8);
    const double area = std::abs(set.area / exact.area - 1.0);
    std::printf("%5d  %9zu  %.3e  %.3e\n", cells, mesh.triangles.size(), area,
                std::abs(set.diameter / exact.diameter - 1.0));
    if (before > 0.0) {
      EXPECT_LT(area, before / 2.5);
    }
    before = area;
  }
  EXPECT_LT(before, 2e-3);
}

TEST(RestOnMesh, BorderOnAnImplicitSurfaceIsWhereTheConeEnds) {
  // On an ellipsoid the normal is not linear along an edge, unlike on a sphere.
  const Vector3d axes(1.0e-4, 0.7e-4, 0.5e-4), force(0.3, -0.5, 1.0);
  const double mu = 0.5;
  const Mesh mesh = implicit_surface(
      [&](const Vector3d& p) { return p.cwiseQuotient(axes).squaredNorm() - 1.0; },
      [&](const Vector3d& p) -> Vector3d {
        return 2.0 * p.cwiseQuotient(axes).cwiseQuotient(axes);
      },
      Vector3d(-1.21e-4, -0.93e-4, -0.72e-4), Vector3d(1.24e-4, 0.92e-4, 0.75e-4), 24);
  double linear = 0.0;
  int borders = 0, exact = 0;
  for (const Piece& piece : rest_on_mesh(mesh, {force}, mu).pieces) {
    if (piece.forces == 0) continue;
    const auto& corners = mesh.triangles[piece.triangle];
    for (const Vector3d& point : piece.polygon) {
      Vector3d flat = Vector3d::Zero();
      bool corner = false;
      double total = 0.0, least = 1.0;
      for (int k = 0; k < 3; ++k) {
        const Vector3d& a = mesh.vertices[corners[k]];
        const Vector3d& b = mesh.vertices[corners[(k + 1) % 3]];
        const Vector3d& d = mesh.vertices[corners[(k + 2) % 3]];
        corner = corner || (point - a).norm() < 1e-12;
        const double weight = (b - point).cross(d - point).norm();
        flat += weight * mesh.normal(a).normalized();
        total += weight;
        least = std::min(least, weight);
      }
      // Inside a triangle the border follows the linearly interpolated normals.
      if (corner || least > 1e-9 * total) continue;
      const auto beyond = [&](const Vector3d& normal) {
        return std::abs(std::atan2(force.cross(normal).norm(), -force.dot(normal)) - std::atan(mu));
      };
      ++borders;
      // 60 bisections of a fifth of an edge.
      exact += beyond(mesh.normal(mesh.project(point))) < 1e-9;
      linear = std::max(linear, beyond(flat / total));
    }
  }
  EXPECT_GT(borders, 50);
  // Roots of the true normal are exact. At the remaining points, the border of linear normals
  // crosses an edge beside such a root.
  EXPECT_GT(exact, 0.8 * borders);
  std::printf("%d of %d places on edges are exact\n", exact, borders);
  // The test is meaningful only if linear normals have different roots than the true normal.
  EXPECT_GT(linear, 1e-5);
}

TEST(RestOnMesh, CapInsideOneTriangle) {
  // The friction cone is far smaller than a triangle, so no corner and no side of the triangle is
  // in the rest set.
  const Mesh mesh = clearance_sphere(c, 2);
  const Vector3d force(0.31, -0.52, 1.0);
  const double mu = 1e-3;
  const RestSet set = rest_on_mesh(mesh, {force}, mu).study.any;
  ASSERT_EQ(set.parts.size(), 1u);
  EXPECT_NEAR(set.area / (pi * c * c * mu * mu), 1.0, 0.1);
  EXPECT_NEAR((set.parts[0].representative.normalized() - force.normalized()).norm(), 0.0, 0.02);
}

TEST(RestOnMesh, WithoutFrictionIsolatedPoints) {
  for (const Vector3d& force : {Vector3d(0.31, -0.52, 1.0), Vector3d(0, 0, 1), Vector3d(1, 1, 1)}) {
    const RestSet set = rest_on_mesh(clearance_sphere(c, 4), {force}, 0.0).study.any;
    ASSERT_EQ(set.parts.size(), 1u);
    EXPECT_EQ(set.area, 0.0);
    EXPECT_EQ(set.diameter, 0.0);
    EXPECT_NEAR((set.parts[0].representative / c - force.normalized()).norm(), 0.0, 2e-3);
  }
}

TEST(RestOnMesh, TwoForces) {
  const Mesh mesh = clearance_sphere(c, 5);
  for (const double beta : {0.3, 0.8, 1.2}) {
    const std::vector<Vector3d> forces = {{0, 0.1, 1}, {std::sin(beta), 0.1, std::cos(beta)}};
    const RestStudy exact = rest_in_socket(c, forces, 0.5);
    const SurfaceStudy found = rest_on_mesh(mesh, forces, 0.5);
    EXPECT_NEAR(found.study.any.area, exact.any.area, 3e-3 * exact.any.area);
    EXPECT_NEAR(found.study.all.area, exact.all.area, 3e-3 * exact.any.area);
    EXPECT_EQ(found.study.any.parts.size(), exact.any.parts.size());
    EXPECT_EQ(found.study.all.parts.size(), exact.all.parts.size());
    EXPECT_NEAR(found.study.any.diameter, exact.any.diameter, 3e-3 * c);
    EXPECT_NEAR(found.study.all.diameter, exact.all.diameter, 3e-3 * c);
    EXPECT_NEAR(found.study.each[1].area, exact.each[1].area, 3e-3 * exact.any.area);
    // The pieces cover the whole mesh.
    double whole = 0.0;
    for (const Piece& piece : found.pieces) {
      for (std::size_t i = 1; i + 1 < piece.polygon.size(); ++i) {
        whole += 0.5 * (piece.polygon[i] - piece.polygon[0])
                           .cross(piece.polygon[i + 1] - piece.polygon[0])
                           .norm();
      }
    }
    EXPECT_NEAR(whole / (4.0 * pi * c * c), 1.0, 2e-3);
  }
}

Mesh box_of_soup() {
  // A closed box whose faces share no vertices. By the right-hand rule, normals point inwards.
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Vector3d n = side * Vector3d::Unit(axis), u = Vector3d::Unit((axis + 1) % 3),
                     v = n.cross(u);
      const int first = static_cast<int>(mesh.vertices.size());
      for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        mesh.vertices.push_back(c * (n + a * u + b * v));
      }
      mesh.triangles.push_back({first, first + 2, first + 1});
      mesh.triangles.push_back({first, first + 3, first + 2});
    }
  }
  return mesh;
}

TEST(RestOnMesh, FlatFaces) {
  // The faces are not welded, so every face has its own normal and the rest set consists of whole
  // faces.
  const RestSet one = rest_on_mesh(box_of_soup(), {Vector3d(0.1, 0.1, 1.0)}, 0.2).study.any;
  ASSERT_EQ(one.parts.size(), 1u);
  EXPECT_NEAR(one.area, 4.0 * c * c, 1e-20);
  EXPECT_NEAR(one.diameter, std::sqrt(8.0) * c, 1e-18);
  EXPECT_GT(one.parts[0].representative.z(), 0.99 * c);
  const Mesh closed = welded(box_of_soup(), 1e-9);
  EXPECT_EQ(closed.vertices.size(), 8u);
  EXPECT_EQ(closed.triangles.size(), 12u);
  const RestStudy two =
      rest_on_mesh(box_of_soup(), {Vector3d(0, 0, 1), Vector3d(0, 0, -1)}, 0.2).study;
  EXPECT_EQ(two.any.parts.size(), 2u);
  EXPECT_TRUE(two.all.parts.empty());
  EXPECT_NEAR(two.any.diameter, std::sqrt(12.0) * c, 1e-18);
  // Without friction, a face perpendicular to the force is in the rest set as a whole.
  EXPECT_NEAR(rest_on_mesh(box_of_soup(), {Vector3d(0, 0, 1)}, 0.0).study.any.area, 4.0 * c * c,
              1e-20);
}

TEST(RestOnMesh, TorusHasTwoParts) {
  // Torus about z with the free side inside its tube. A force along z has a ring of rest positions.
  const auto rho = [](const Vector3d& p) { return std::hypot(p.x(), p.y()); };
  const Mesh mesh = implicit_surface(
      [rho](const Vector3d& p) { return std::pow(rho(p) - 3.0, 2) + p.z() * p.z() - 1.0; },
      [rho](const Vector3d& p) -> Vector3d {
        const double r = rho(p), k = 2.0 * (r - 3.0) / r;
        return {k * p.x(), k * p.y(), 2.0 * p.z()};
      },
      Vector3d(-4.5, -4.5, -1.6), Vector3d(4.5, 4.5, 1.6), 48);
  const double phi = std::atan(0.3);
  const RestSet ring = rest_on_mesh(mesh, {Vector3d(0, 0, 1)}, 0.3).study.any;
  ASSERT_EQ(ring.parts.size(), 1u);
  EXPECT_NEAR(ring.area / (2.0 * pi * 3.0 * 2.0 * phi), 1.0, 0.02);
  EXPECT_NEAR(ring.diameter, 2.0 * (3.0 + std::sin(phi)), 0.01);
  // For a force along x, the normal opposes it at the outermost and at the innermost point of the
  // tube.
  const RestSet two = rest_on_mesh(mesh, {Vector3d(1, 0, 0)}, 0.3).study.any;
  EXPECT_EQ(two.parts.size(), 2u);
}

TEST(RestOnMesh, ErrorOfTheDiameterIsTwiceASagitta) {
  // Expected error: twice the sagitta L²/(8 D/2) of the longest edge L, on a sphere whose radius is
  // half the box diagonal D.
  const Mesh mesh = clearance_sphere(c, 1);
  double longest = 0.0;
  Eigen::AlignedBox3d box;
  for (const Vector3d& vertex : mesh.vertices) box.extend(vertex);
  for (const auto& t : mesh.triangles) {
    for (const int i : {0, 1, 2}) {
      const Vector3d edge = mesh.vertices[std::size_t(t[std::size_t(i)])] -
                            mesh.vertices[std::size_t(t[std::size_t((i + 1) % 3)])];
      longest = std::max(longest, edge.norm());
    }
  }
  EXPECT_DOUBLE_EQ(rest_on_mesh(mesh, {Vector3d::UnitX()}, 0.3).study.any.diameter_error,
                   longest * longest / (2.0 * box.diagonal().norm()));
}

TEST(RestOnMesh, VertexOfNoTriangleNeedsNoNormal) {
  Mesh mesh = clearance_sphere(c, 1);
  const double area = rest_on_mesh(mesh, {Vector3d::UnitX()}, 0.3).study.any.area;
  mesh.vertices.push_back(Vector3d::Zero());
  if (!mesh.normals.empty()) mesh.normals.push_back(Vector3d::Zero());
  EXPECT_EQ(rest_on_mesh(mesh, {Vector3d::UnitX()}, 0.3).study.any.area, area);
}

TEST(RestOnMesh, WithoutFrictionALineHasALengthAndNoArea) {
  // Tube along y, pressed down: the set is its lowest line.
  const auto tube = implicit_surface(
      [](const Vector3d& p) { return p.x() * p.x() + p.z() * p.z() - c * c; },
      [](const Vector3d& p) -> Vector3d {
        return {2.0 * p.x(), 0.0, 2.0 * p.z()};
      },
      Vector3d(-1.31 * c, -2.0 * c, -1.27 * c), Vector3d(1.31 * c, 2.0 * c, 1.27 * c), 24);
  const RestSet set = rest_on_mesh(tube, {-Vector3d::UnitZ()}, 0.0).study.any;
  ASSERT_EQ(set.parts.size(), 1u);
  EXPECT_EQ(set.area, 0.0);
  EXPECT_NEAR(set.length, 4.0 * c, 1e-3 * c);
  EXPECT_EQ(set.length, set.parts[0].length);
}

TEST(RestOnMesh, Refusals) {
  const auto refusal = [](const Mesh& mesh, const Vector3d& force) {
    return refused_argument([&] { rest_on_mesh(mesh, {force}, 0.1); });
  };
  Mesh mesh = clearance_sphere(c, 0);
  EXPECT_EQ(refusal(mesh, Vector3d::Zero()), Argument("size of forces[0]", 0));
  mesh.normals.pop_back();
  EXPECT_EQ(refusal(mesh, Vector3d::UnitX()), Argument("number of normals", 11));
  mesh.normals.push_back(Vector3d::Zero());
  EXPECT_EQ(refusal(mesh, Vector3d::UnitX()), Argument("size of normals[11]", 0));
  mesh.triangles[3][1] = 12;
  EXPECT_EQ(refusal(mesh, Vector3d::UnitX()), Argument("triangles[3]", 12));
  mesh.triangles[0][2] = -1;
  EXPECT_EQ(refusal(mesh, Vector3d::UnitX()), Argument("triangles[0]", -1));
  for (const std::size_t far : {0u, 11u}) {
    mesh = clearance_sphere(c, 0);
    mesh.vertices[far].y() = INFINITY;
    EXPECT_EQ(refusal(mesh, Vector3d::UnitX()),
              Argument("vertices[" + std::to_string(far) + "]", HUGE_VAL));
  }
  EXPECT_EQ(refusal(Mesh{}, Vector3d::UnitX()), Argument("number of triangles", 0));
}

}  // namespace
}  // namespace statejump::rest_set
