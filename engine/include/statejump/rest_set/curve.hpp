// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "statejump/rest_set/rest_set.hpp"

namespace statejump::rest_set {

/// A position on a configuration curve, and the direction N in which the reaction pushes there.
struct CurvePoint {
  Eigen::Vector2d position;  ///< of the component's centre [m]
  Eigen::Vector2d normal;    ///< unit vector to the free side
};

/// A planar configuration curve: nodes, and the function `at` for every point between them.
///
/// `at(t)` with t = i + fraction returns a point between nodes i and i + 1; a closed curve
/// continues from the last node to the first. N must rotate by less than π between neighbouring
/// nodes. At a corner with two contacts, N may jump. All reactions between both normals are then
/// possible. Bisection on the angle of N includes them.
struct Curve {
  std::vector<CurvePoint> nodes;
  bool closed = false;
  std::function<CurvePoint(double)> at;
  std::size_t segments() const { return closed ? nodes.size() : nodes.size() - 1; }
};

/// Γ(x, y) in any unit: negative where the centre can move freely, 0 on the curve.
using PlaneFunction = std::function<double(const Eigen::Vector2d&)>;
using PlaneGradient = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

/// Finds the curves Γ = 0 inside a box by marching squares. Bisection finds roots on grid lines;
/// points between them are found by Newton's method along the gradient. N = −∇Γ/|∇Γ|. Features
/// smaller than a cell are missed.
/// @param low,high corners of the box [m]
/// @param cells number along the longer side, 4 to 4000
/// Throws std::invalid_argument for an invalid box, a value of Γ that is not finite, a vanishing
/// gradient on the curve, or no curve.
std::vector<Curve> implicit_curves(const PlaneFunction& gamma, const PlaneGradient& gradient,
                                   const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                                   int cells = 200);

/// Configuration curve r(θ) = c (1 + ε cos nθ), inside which the centre can move freely. If n² ε +
/// ε > 1, the curve is not convex: several positions share a normal, and rest sets have several
/// components.
/// @param clearance c [m], > 0
/// @param amplitude ε, |ε| < 1
/// @param lobes number of lobes n, 1 to 1000
/// @param samples number of nodes, at least 16 n
Curve lobed_curve(double clearance, double amplitude, int lobes, int samples = 720);

/// Configuration curve of the centre of a journal of radius R1 in a bore with wall ρ(θ) [m].
///
/// The centre at distance r from the origin in direction e(φ) touches the wall's point ρ(θ) e(θ) at
///
///     r = ρ cos(θ−φ) − √(R1² − ρ² sin²(θ−φ)),
///
/// the smaller of two distances. At the smallest r over all contact directions θ the journal
/// touches without overlap. These positions form the configuration curve. It is the clearance
/// circle for a round bore, and the parallel curve at distance R1 for a smooth wall less curved
/// than the journal. N is the normal of the wall at the contact. Limits: only positions reached
/// from the origin along a straight line without overlap; contacts are sought in `samples`
/// directions and refined. Throws std::invalid_argument if the journal does not fit at the origin.
Curve journal_in_profile(const std::function<double(double)>& rho, double journal_radius,
                         int samples = 720);

/// Computes rest sets on planar curves. Bisection on the angle of N finds the ends of the
/// components to rounding. On smooth curves the error of lengths is of fourth order in the node
/// distance. The farthest pair of nodes is improved by line searches along the curve. A component
/// that lies entirely between two nodes is missed unless N passes the direction −F there.
RestStudy rest_on_curves(const std::vector<Curve>& curves,
                         const std::vector<Eigen::Vector2d>& forces, double mu);

}  // namespace statejump::rest_set
