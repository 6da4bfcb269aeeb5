// SPDX-License-Identifier: GPL-3.0-or-later
#include "slipping_rings.hpp"

#include <algorithm>

namespace statejump::truss::detail {

using Eigen::Matrix2d;
using Eigen::Vector2d;

namespace {

Vector2d vector(const kernel::Tangent& of) {
  return {of.a, of.b};
}

double bound_of(const SlippingRings::Pressed& by) {
  return by.friction_coefficient * std::max(by.normal_force, 0.0);
}

}  // namespace

SlippingRings::Law SlippingRings::law(const Pressed& by, const Vector2d& slide,
                                      const Vector2d& speed, double h) const {
  Law law;
  const double bound = bound_of(by);
  if (!(bound > 0.0)) return law;
  const kernel::PartialSlipPlane rings =
      kernel::partial_slip_plane(by.stiffness, bound, {slide[0], slide[1]}, memory);
  law.friction = vector(rings.force);
  law.by_slide << vector(rings.by_slide_a), vector(rings.by_slide_b);
  law.by_normal =
      by.friction_coefficient * vector(rings.by_limit) + by.stiffens * vector(rings.by_stiffness);
  if (by.dashpot == 0.0) return law;
  law.friction += by.dashpot * speed;
  law.by_slide += by.dashpot / h * Matrix2d::Identity();
  const double size = law.friction.norm();
  if (!(size > bound)) return law;
  const Vector2d way = law.friction / size;
  law.friction = bound * way;
  law.by_slide = bound / size * (Matrix2d::Identity() - way * way.transpose()) * law.by_slide;
  law.by_normal = by.friction_coefficient * way;
  return law;
}

Vector2d SlippingRings::kink(const Pressed& by) const {
  const double bound = bound_of(by);
  if (!(bound > 0.0)) return Vector2d::Zero();
  const kernel::PartialSlipPlane rings =
      kernel::partial_slip_plane(by.stiffness, bound, {0.0, 0.0}, memory);
  const double size = rings.centre.norm();
  if (!(size > rings.bound)) return Vector2d::Zero();
  return (rings.bound / size - 1.0) * vector(rings.centre);
}

void SlippingRings::see(bool begins, const Pressed& by, const Vector2d& speed, const Vector2d& slid,
                        double h) {
  const Vector2d slide = h * speed + slid;
  const Vector2d from = kink(by);
  const bool beyond = begins || (slide - from).dot(seen_slide - from) < 0.0;
  seen_slide = beyond ? from : slide;
  seen_speed = beyond ? Vector2d((from - slid) / h) : speed;
}

Vector2d SlippingRings::take(const Pressed& by, const Vector2d& slide) {
  const double bound = bound_of(by);
  const kernel::PartialSlipResponse now = kernel::partial_slip_step(
      bound > 0.0 ? by.stiffness : 0.0, bound, {slide[0], slide[1]}, memory);
  energy = now.elastic;
  slip_all = now.slipping;
  return vector(now.force);
}

}  // namespace statejump::truss::detail
