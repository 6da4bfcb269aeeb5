// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the polynomial of a vertex with CGAL's jet fitting, the same method by its authors.
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Simple_cartesian.h>

#include <Eigen/Dense>
#include <algorithm>

#include "jet.hpp"
#include "support.hpp"

namespace statejump::geometry {
namespace {

using testing::bearing_radius;
using testing::pi;
using testing::Random;
using testing::Vector3d;

struct Curvatures {
  double larger, smaller;  // [1/m], positive where the surface rises to the normal
};

Curvatures ours(const std::vector<Vector3d>& points, const Vector3d& normal) {
  const Jet jet =
      fit_jet(points[0], normal, Vector3d::UnitZ(), {points.begin() + 1, points.end()}, 4);
  const JetHit hit = jet.hit(points[0], normal, 0);
  // The tensor has no component along the normal, so one eigenvalue is 0. The loop skips it.
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(hit.bend);
  Eigen::Index along = 0;
  (solver.eigenvectors().transpose() * hit.normal).cwiseAbs().maxCoeff(&along);
  const double a = solver.eigenvalues()((along + 1) % 3), b = solver.eigenvalues()((along + 2) % 3);
  return {std::max(a, b), std::min(a, b)};
}

Curvatures cgals(const std::vector<Vector3d>& points, const Vector3d& normal) {
  using Kernel = CGAL::Simple_cartesian<double>;
  std::vector<Kernel::Point_3> given;
  for (const Vector3d& p : points) given.emplace_back(p.x(), p.y(), p.z());
  CGAL::Monge_via_jet_fitting<Kernel> fit;
  auto form = fit(given.begin(), given.end(), 4, 4);
  form.comply_wrt_given_normal(Kernel::Vector_3(normal.x(), normal.y(), normal.z()));
  return {form.principal_curvatures(0), form.principal_curvatures(1)};
}

TEST(JetFit, AgreesWithCgalsMongeViaJetFitting) {
  BoreShape shape{bearing_radius, 10e-3};
  shape.lobes = {{3, 1e-4, 0.3}};
  shape.crown = 2e-4;
  Random random;
  double last = 0;
  for (const int around : {60, 120, 240}) {
    const double step = 2 * pi / around, along = step * bearing_radius;
    double apart = 0;
    for (int i = 0; i < 100; ++i) {
      const double theta = random.uniform(-3, 3), z = random.uniform(-3e-3, 3e-3);
      const auto at = [&](double t, double h) {
        const double r = bore_radius(shape, t, h);
        return Vector3d(r * std::cos(t), r * std::sin(t), h);
      };
      std::vector<Vector3d> points{at(theta, z)};
      for (int a = -2; a <= 2; ++a)
        for (int b = -2; b <= 2; ++b)
          if (a != 0 || b != 0)
            points.push_back(at(theta + (a + random.uniform(-0.2, 0.2)) * step,
                                z + (b + random.uniform(-0.2, 0.2)) * along));
      const Vector3d normal = -Vector3d(std::cos(theta), std::sin(theta), 0);
      const Curvatures one = ours(points, normal), other = cgals(points, normal);
      apart = std::max(
          {apart, std::abs(one.larger - other.larger), std::abs(one.smaller - other.smaller)});
    }
    apart *= bearing_radius;
    std::printf("%d around: principal curvatures differ by %.2g / R\n", around, apart);
    // The two fits weight the neighbours differently, and only ours passes through the vertex.
    // Their curvatures differ by neglected fifth-order terms, i.e. by order h^3 for facet length h.
    if (last > 0) {
      EXPECT_LT(apart, last / 6);
    }
    EXPECT_LT(apart, std::pow(step, 3));
    last = apart;
  }
}

TEST(JetFit, CurvatureIsTheChangeOfTheNormal) {
  Random random;
  for (int i = 0; i < 50; ++i) {
    Jet jet;
    jet.origin = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    jet.normal = Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), 2).normalized();
    jet.tangent_u = jet.normal.unitOrthogonal();
    jet.tangent_v = jet.normal.cross(jet.tangent_u);
    jet.scale_u = 1.3;
    jet.scale_v = 0.7;
    for (double& one : jet.coefficient) one = random.uniform(-0.2, 0.2);
    const double u = random.uniform(-0.5, 0.5), v = random.uniform(-0.5, 0.5), step = 1e-5;
    const auto at = [&](double along_u, double along_v) {
      const Vector3d above = jet.origin + (u + along_u) * jet.tangent_u +
                             (v + along_v) * jet.tangent_v + 3 * jet.normal;
      JetHit hit = jet.hit(above, -jet.normal, 3);
      return std::pair<Vector3d, JetHit>(above - hit.s * jet.normal, hit);
    };
    for (const auto& [du, dv] : {std::pair(step, 0.0), std::pair(0.0, step)}) {
      const auto after = at(du, dv), before = at(-du, -dv);
      const Vector3d way = (after.first - before.first) / (2 * step);
      const Vector3d turn = (after.second.normal - before.second.normal) / (2 * step);
      // Central differences: step^2 times third derivatives of order 10, plus rounding/step.
      EXPECT_NEAR((turn + at(0, 0).second.bend * way).norm(), 0, 2e-8) << i;
    }
  }
}

}  // namespace
}  // namespace statejump::geometry
