// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "statejump/rest_set/rest_set.hpp"

namespace statejump::rest_set {

/// A position on a configuration curve and the direction N in which the reaction pushes.
struct CurvePoint {
  Eigen::Vector2d position;  ///< of the component's centre [m]
  Eigen::Vector2d normal;    ///< unit vector to the free side
};

/// A planar configuration curve: nodes, and the function `at` for every point between them.
///
/// `at(t)` with t = i + fraction is between nodes i and i + 1; a closed curve continues from the
/// last node to the first. N must rotate by less than π between neighbouring nodes. At a corner
/// with two contacts, N may jump. All reactions between both normals are then possible, and
/// bisection on the rotating normal includes them.
struct Curve {
  std::vector<CurvePoint> nodes;
  bool closed = false;
  std::function<CurvePoint(double)> at;
  std::size_t segments() const { return closed ? nodes.size() : nodes.size() - 1; }
};

/// Γ(x, y), any unit: < 0 where the centre is free, 0 on the curve.
using PlaneFunction = std::function<double(const Eigen::Vector2d&)>;
using PlaneGradient = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

/// Curves Γ = 0 inside a box by marching squares. Roots on grid lines are found by bisection,
/// points between by Newton's method along the gradient. N = −∇Γ/|∇Γ|. Features smaller than a cell
/// are missed.
/// @param low,high corners of the box [m]
/// @param cells along its longer side, 4 to 4000
/// Throws std::invalid_argument for an invalid box, a value of Γ that is not finite, a vanishing
/// gradient on the curve, or no curve.
std::vector<Curve> implicit_curves(const PlaneFunction& gamma, const PlaneGradient& gradient,
                                   const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                                   int cells = 200);

/// Curve r(θ) = c (1 + ε cos nθ) as configuration curve, free inside. For n² ε + ε > 1 it is not
/// convex: several positions share a normal, and rest sets have several components.
/// @param clearance c [m], > 0
/// @param amplitude ε, |ε| < 1
/// @param lobes n, 1 to 1000
/// @param samples nodes, at least 16 n
Curve lobed_curve(double clearance, double amplitude, int lobes, int samples = 720);

/// Configuration curve of the centre of a journal of radius R1 in a bore with wall ρ(θ) [m].
///
/// The centre at distance r from the origin in direction e(φ) touches the wall's point ρ(θ) e(θ) at
///
///     r = ρ cos(θ−φ) − √(R1² − ρ² sin²(θ−φ)),
///
/// the first of two distances. The smallest r over all contact directions θ is where the journal
/// touches without overlap: the admissible inner part of the envelope. For a round bore it is the
/// clearance circle; for a smooth wall less curved than the journal, the parallel curve at R1. The
/// normal is that of the wall at the contact. Limits: only positions reached from the origin along
/// a straight line of free positions; contacts are sought at `samples` directions and refined.
/// Throws std::invalid_argument if the journal does not fit at the origin.
Curve journal_in_profile(const std::function<double(double)>& rho, double journal_radius,
                         int samples = 720);

/// Rest sets on planar curves. Bisection on the angle of N finds the ends of the components to
/// rounding. Lengths have an error of fourth order in the node distance on smooth curves. Line
/// searches along the curve improve the farthest pair of nodes. A component that N enters and
/// leaves between two nodes is missed unless N passes −F there.
RestStudy rest_on_curves(const std::vector<Curve>& curves,
                         const std::vector<Eigen::Vector2d>& forces, double mu);

}  // namespace statejump::rest_set
