// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "dof_map.hpp"
#include "hermite.hpp"
#include "parts.hpp"
#include "way.hpp"

namespace statejump::truss::detail {

/// Quadrature points of a step, for the work done by the temperature of one program.
struct Quadrature {
  struct Point {
    double share;
    double temperature_change;  ///< [K]
    double warmed;              ///< Weight: part of the temperature change [K].
  };
  std::array<Point, 4> points{};
  std::size_t count = 0;

  /// Integral of `function(fraction, temperature)` over the temperature in a step [K].
  template <class Function>
  double along(Function&& function) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      sum += points[k].warmed * function(points[k].share, points[k].temperature_change);
    }
    return sum;
  }
};

/// Quadrature of every program: the trapezoidal rule if the unknowns are interpolated linearly,
/// otherwise a fourth-order rule.
std::vector<Quadrature> quadratures(const Way& way, const Model& model);

/// A step in which elements integrate the work of the temperature.
struct ThermalStep {
  const Way& way;
  const std::vector<Vector3d>& drawn;  ///< Positions of the nodes at ΔT = 0 [m].
  const DofMap& dofs;
  const std::vector<Quadrature>& quadratures;  ///< Of every program.

  /// Displacement of a site at a fraction of the step [m]. A straight way is evaluated at its ends
  /// only.
  Vector3d displacement(int site, double share) const {
    if (way.is_straight()) return dofs.displacement(site, share == 0.0 ? way.from : way.to);
    const Vector3d from = dofs.displacement(site, way.from);
    const Vector3d to = dofs.displacement(site, way.to);
    const Vector3d from_rate = way.step() * dofs.displacement(site, *way.from_rate);
    const Vector3d to_rate = way.step() * dofs.displacement(site, *way.to_rate);
    Vector3d made;
    for (Eigen::Index x = 0; x < 3; ++x) {
      made[x] = Cubic{from[x], to[x], from_rate[x], to_rate[x]}.at(share);
    }
    return made;
  }
  Vector3d moved_between(int from, int to, const VectorXd& z) const {
    return dofs.displacement(to, z) - dofs.displacement(from, z);
  }
  Lengths lengths_between(int from, int to, const VectorXd& z) const {
    return lengths(drawn[index(to)] - drawn[index(from)], moved_between(from, to, z));
  }
};

}  // namespace statejump::truss::detail
