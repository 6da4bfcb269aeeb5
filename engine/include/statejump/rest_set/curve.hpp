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

/// A planar configuration curve: nodes, and every point between them by `at`.
///
/// `at(t)` with t = i + fraction lies between nodes i and i + 1; a closed curve goes from the last
/// node back to the first. N must turn by less than π between neighbouring nodes. Where two
/// contacts meet, N may jump; the reactions between both normals are then available at the corner,
/// as bisection on the turning normal finds by itself.
struct Curve {
  std::vector<CurvePoint> nodes;
  bool closed = false;
  std::function<CurvePoint(double)> at;
  std::size_t segments() const { return closed ? nodes.size() : nodes.size() - 1; }
};

/// Γ(x, y), any unit: < 0 where the centre is free, 0 on the curve.
using PlaneFunction = std::function<double(const Eigen::Vector2d&)>;
using PlaneGradient = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

/// Curves Γ = 0 inside a box by marching squares; roots on grid lines by bisection, points between
/// by Newton's method along the gradient. N = −∇Γ/|∇Γ|. Features smaller than a cell are missed.
/// @param low,high corners of the box [m]  @param cells along its longer side, 4 to 4000
/// Throws std::invalid_argument for a bad box, a value of Γ that is not finite, a vanishing
/// gradient on the curve or no curve at all.
std::vector<Curve> implicit_curves(const PlaneFunction& gamma, const PlaneGradient& gradient,
                                   const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                                   int cells = 200);

/// Curve r(θ) = c (1 + ε cos nθ) as configuration curve, free inside. For n² ε + ε > 1 it is not
/// convex: several places share a normal, and rest sets fall into several parts.
/// @param clearance c [m], > 0  @param amplitude ε, |ε| < 1  @param lobes n, 1 to 1000
/// @param samples nodes, at least 16 n
Curve lobed_curve(double clearance, double amplitude, int lobes, int samples = 720);

/// Configuration curve of the centre of a journal of radius R1 in a bore with wall ρ(θ) [m].
///
/// The centre at distance r from the origin in direction e(φ) touches the wall's point ρ(θ) e(θ) at
///
///     r = ρ cos(θ−φ) − √(R1² − ρ² sin²(θ−φ)),
///
/// the first of two distances. The smallest r over all contact directions θ is where the journal
/// touches without overlap: the admissible inner part of the envelope (for a round bore the
/// clearance circle; for a smooth wall less curved than the journal the parallel curve at R1). The
/// normal is that of the wall at the contact. Limits: positions that are seen from the origin along
/// a straight line of free positions; contacts are sought at `samples` directions and refined.
/// Throws std::invalid_argument if the journal does not fit at the origin.
Curve journal_in_profile(const std::function<double(double)>& rho, double journal_radius,
                         int samples = 720);

/// Rest sets on planar curves. Ends of the parts are found by bisection on the angle of N, exact to
/// rounding; lengths have an error of fourth order in the node distance, as far as the curve is
/// smooth; the farthest pair of nodes is improved by line searches along the curve. A rest set
/// that N enters and leaves again between two nodes is missed unless N turns through −F there.
Study rest_on_curves(const std::vector<Curve>& curves, const std::vector<Eigen::Vector2d>& forces,
                     double mu);

}  // namespace statejump::rest_set
