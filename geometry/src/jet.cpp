// SPDX-License-Identifier: GPL-3.0-or-later
#include "jet.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace statejump::geometry {
namespace {

constexpr double higher_power_scale = 0.05;

struct Height {
  double h, hu, hv;
};

struct Bend {
  double huu, huv, hvv;
};

Height height(const Jet& jet, double u, double v) {
  const auto& c = jet.coefficient;
  const double x = u / jet.scale_u;
  const double y = v / jet.scale_v;
  const double h = x * (c[0] + x * (c[2] + x * (c[5] + x * c[9]))) +
                   y * (c[1] + x * (c[3] + x * (c[6] + x * c[10])) +
                        y * (c[4] + x * (c[7] + x * c[11]) + y * (c[8] + x * c[12] + y * c[13])));
  const double hx =
      c[0] + x * (2 * c[2] + x * (3 * c[5] + x * 4 * c[9])) +
      y * (c[3] + x * (2 * c[6] + x * 3 * c[10]) + y * (c[7] + 2 * x * c[11] + y * c[12]));
  const double hy =
      c[1] + x * (c[3] + x * (c[6] + x * c[10])) +
      y * (2 * (c[4] + x * (c[7] + x * c[11])) + y * (3 * (c[8] + x * c[12]) + 4 * y * c[13]));
  return {h, hx / jet.scale_u, hy / jet.scale_v};
}

Bend second(const Jet& jet, double u, double v) {
  const auto& c = jet.coefficient;
  const double x = u / jet.scale_u;
  const double y = v / jet.scale_v;
  const double hxx =
      2 * c[2] + x * (6 * c[5] + x * 12 * c[9]) + y * (2 * c[6] + 6 * x * c[10] + 2 * y * c[11]);
  const double hxy =
      c[3] + x * (2 * c[6] + 3 * x * c[10]) + y * (2 * c[7] + 4 * x * c[11] + 3 * y * c[12]);
  const double hyy =
      2 * (c[4] + x * (c[7] + x * c[11])) + y * (6 * (c[8] + x * c[12]) + 12 * y * c[13]);
  return {hxx / (jet.scale_u * jet.scale_u), hxy / (jet.scale_u * jet.scale_v),
          hyy / (jet.scale_v * jet.scale_v)};
}

using Solution = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 14, 1>;

/// Largest number of neighbours for which the equations are stored on the stack.
constexpr int usual_rows = 64;

/// Coefficients of the scaled polynomial by weighted least squares.
template <int most_rows>
Solution fitted(const Jet& jet, const std::vector<Vector3>& points, int degree) {
  const int unknowns = degree * (degree + 3) / 2;
  const int count = static_cast<int>(points.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_rows, 14> matrix(count, unknowns);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_rows, 1> heights(count);
  for (int i = 0; i < count; ++i) {
    const Vector3 from = points[i] - jet.origin;
    const double x = from.dot(jet.tangent_u) / jet.scale_u;
    const double y = from.dot(jet.tangent_v) / jet.scale_v;
    // Nearer neighbours get more weight.
    const double weight = 1 / (0.1 + x * x + y * y);
    double factor = weight;
    int column = 0;
    for (int d = 1; d <= degree; ++d, factor *= higher_power_scale)
      for (int j = 0; j <= d; ++j) {
        double power = factor;
        for (int k = 0; k < d - j; ++k) power *= x;
        for (int k = 0; k < j; ++k) power *= y;
        matrix(i, column++) = power;
      }
    heights(i) = weight * from.dot(jet.normal);
  }
  Eigen::CompleteOrthogonalDecomposition<decltype(matrix)> solver;
  solver.setThreshold(1e-10);
  solver.compute(matrix);
  return solver.solve(heights);
}

}  // namespace

double Jet::meet(const Vector3& point, const Vector3& direction, double guess) const {
  const Vector3 from = point - origin;
  const double u0 = from.dot(tangent_u), v0 = from.dot(tangent_v), w0 = from.dot(normal);
  const double du = direction.dot(tangent_u), dv = direction.dot(tangent_v);
  const double dw = direction.dot(normal);
  double s = guess;
  for (int i = 0; i < 6; ++i) {
    const Height at = height(*this, u0 + s * du, v0 + s * dv);
    const double slope = dw - at.hu * du - at.hv * dv;
    const double step = (w0 + s * dw - at.h) / slope;
    s -= step;
    // Newton's method squares the error, so the next step would be of order step^2 times a
    // curvature.
    if (!(std::abs(step) > 1e-9 * (scale_u + scale_v))) break;
  }
  return s;
}

JetHit Jet::hit(const Vector3& point, const Vector3& direction, double guess) const {
  JetHit result;
  result.s = meet(point, direction, guess);
  const Vector3 from = point + result.s * direction - origin;
  const double u = from.dot(tangent_u), v = from.dot(tangent_v);
  const Height at = height(*this, u, v);
  const Bend bend = second(*this, u, v);
  const double stretch = std::sqrt(1 + at.hu * at.hu + at.hv * at.hv);
  result.normal = (normal - at.hu * tangent_u - at.hv * tangent_v) / stretch;
  // Dual basis of the tangents T_u = t_u + hu n, T_v = t_v + hv n.
  const Vector3 along_u = tangent_u + at.hu * normal, along_v = tangent_v + at.hv * normal;
  const double squared = stretch * stretch;  // determinant of the metric
  const Vector3 dual_u = ((1 + at.hv * at.hv) * along_u - at.hu * at.hv * along_v) / squared;
  const Vector3 dual_v = ((1 + at.hu * at.hu) * along_v - at.hu * at.hv * along_u) / squared;
  result.bend = (bend.huu * dual_u * dual_u.transpose() + bend.hvv * dual_v * dual_v.transpose() +
                 bend.huv * (dual_u * dual_v.transpose() + dual_v * dual_u.transpose())) /
                stretch;
  return result;
}

Jet fit_jet(const Vector3& origin, const Vector3& normal, const Vector3& along,
            const std::vector<Vector3>& points, int degree) {
  Jet jet;
  jet.origin = origin;
  jet.normal = normal;
  // In a polynomial along the axes of the surface, coefficients that the neighbours do not
  // determine are small.
  const Vector3 projected = along - along.dot(normal) * normal;
  if (projected.squaredNorm() > 0.01) {
    jet.tangent_v = projected.normalized();
  } else {
    const Vector3 away = std::abs(normal.x()) < 0.6 ? Vector3::UnitX() : Vector3::UnitY();
    jet.tangent_v = (away - away.dot(normal) * normal).normalized();
  }
  jet.tangent_u = cross(jet.tangent_v, normal);
  double largest_u = 0, largest_v = 0;
  for (const Vector3& p : points) {
    largest_u = std::max(largest_u, std::abs((p - origin).dot(jet.tangent_u)));
    largest_v = std::max(largest_v, std::abs((p - origin).dot(jet.tangent_v)));
  }
  jet.scale_u = largest_u > 0 ? largest_u : 1;
  jet.scale_v = largest_v > 1e-9 * jet.scale_u ? largest_v : jet.scale_u;

  const Solution solution = static_cast<int>(points.size()) <= usual_rows
                                ? fitted<usual_rows>(jet, points, degree)
                                : fitted<Eigen::Dynamic>(jet, points, degree);
  double factor = 1;
  int column = 0;
  for (int d = 1; d <= degree; ++d, factor *= higher_power_scale)
    for (int j = 0; j <= d; ++j, ++column) jet.coefficient[column] = factor * solution(column);
  return jet;
}

}  // namespace statejump::geometry
