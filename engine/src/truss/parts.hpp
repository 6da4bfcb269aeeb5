// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "statejump/truss/model.hpp"

namespace statejump::truss::detail {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

inline double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}
inline Vector2d turned_left(const Vector2d& v) {
  return {-v.y(), v.x()};
}

inline std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

/// Force and energy of a straight part at one length.
struct Axial {
  double tension;
  double stiffness;
};

inline Axial link_axial(const Link& link, double elongation_from_drawn, double drawn_length,
                        double change) {
  const double l0 = link.stress_free_length;
  // From differences: the rounding of a length would cost E A times 1e-16.
  const double stretch =
      elongation_from_drawn + (drawn_length - l0) - l0 * link.thermal_expansion * change;
  const double stiffness =
      link.axial_stiffness / thermal::length(l0, link.thermal_expansion, change);
  return {stiffness * stretch, stiffness};
}

/// Vector drawn + moved, its length and that length's growth, without the difference of two
/// lengths.
struct Lengths {
  Vector3d along;
  double drawn;
  double now;
  double growth;
};

inline Lengths lengths(const Vector3d& drawn, const Vector3d& moved) {
  const Vector3d along = drawn + moved;
  const double before = drawn.norm();
  const double now = along.norm();
  return {along, before, now, moved.dot(2.0 * drawn + moved) / (before + now)};
}

/// A stiff spring would make noise of the rounding of its length: what is drawn is fixed, only the
/// growth moves.
inline Axial spring_axial(const AxialSpring& spring, const Lengths& length) {
  const double stretch = (length.drawn - spring.free_length) + length.growth;
  if (spring.cable && stretch < 0.0) return {0.0, 0.0};
  return {spring.stiffness * stretch, spring.stiffness};
}

/// Friction of a slider whose contact is bent by so much [N]; only if it is not rigid.
inline double bent_friction(const Slider& slider, double bend) {
  const double f = slider.friction_force;
  return std::clamp(slider.tangential_stiffness * bend, -f, f);
}

/// Normal force below which the depth is a millionth of the clearance: Hertz's compliance and
/// Mindlin's, infinite without force, are taken there [N].
inline double least_force(const ClearanceRevolute& revolute) {
  return revolute.hertz_stiffness * std::pow(1e-6 * revolute.radial_clearance, 1.5);
}

inline double depth_of(const ClearanceRevolute& revolute, double normal_force) {
  if (std::isinf(revolute.hertz_stiffness) || normal_force <= 0.0) return 0.0;
  return std::pow(normal_force / revolute.hertz_stiffness, 2.0 / 3.0);
}

/// 1/k_t of a contact that sticks [m/N]; 0: rigid.
inline double tangential_compliance(const ClearanceRevolute& revolute, double normal_force) {
  if (std::isinf(revolute.mindlin_stiffness)) return 0.0;
  const double loaded = std::max(normal_force, least_force(revolute));
  return 1.0 / (revolute.mindlin_stiffness * std::sqrt(depth_of(revolute, loaded)));
}

}  // namespace statejump::truss::detail
