// SPDX-License-Identifier: GPL-3.0-or-later
#include "slip_annuli.hpp"

#include <algorithm>
#include <cmath>

namespace statejump::truss::detail {

using Eigen::Matrix2d;
using Eigen::Vector2d;

namespace {

Vector2d vector(const kernel::Tangent& of) {
  return {of.a, of.b};
}

double bound_of(const SlipAnnuli::Pressed& by) {
  return by.friction_coefficient * std::max(by.normal_force, 0.0);
}

}  // namespace

SlipAnnuli::Law SlipAnnuli::law(const Pressed& by, const Vector2d& slide, const Vector2d& speed,
                                double h) const {
  if (play > 0.0) return law_of_play(by, slide[0]);
  Law law;
  const double bound = bound_of(by);
  if (!(bound > 0.0)) return law;
  const kernel::PartialSlipPlane annuli =
      kernel::partial_slip_plane(by.stiffness, bound, {slide[0], slide[1]}, memory);
  law.friction = vector(annuli.force);
  law.by_slide << vector(annuli.by_slide_a), vector(annuli.by_slide_b);
  law.by_normal =
      by.friction_coefficient * vector(annuli.by_limit) + by.stiffens * vector(annuli.by_stiffness);
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

Vector2d SlipAnnuli::kink(const Pressed& by) const {
  const double bound = bound_of(by);
  if (!(bound > 0.0) || play > 0.0) return Vector2d::Zero();
  const kernel::PartialSlipPlane annuli =
      kernel::partial_slip_plane(by.stiffness, bound, {0.0, 0.0}, memory);
  const double size = annuli.centre.norm();
  if (!(size > annuli.bound)) return Vector2d::Zero();
  return (annuli.bound / size - 1.0) * vector(annuli.centre);
}

void SlipAnnuli::place_tangent(bool begins, const Pressed& by, const Vector2d& speed,
                               const Vector2d& slid, double h) {
  const Vector2d slide = h * speed + slid;
  const Vector2d from = kink(by);
  const bool beyond = begins || (slide - from).dot(tangent_slide - from) < 0.0;
  tangent_slide = beyond ? from : slide;
  tangent_speed = beyond ? Vector2d((from - slid) / h) : speed;
}

double SlipAnnuli::played() const {
  return std::clamp(bend, -0.5 * play, 0.5 * play);
}

SlipAnnuli::Law SlipAnnuli::law_of_play(const Pressed& by, double slide) const {
  SlipAnnuli there = *this;
  there.bend += slide;
  const double pulls = by.stiffness * (there.bend - there.played());
  const double bound = bound_of(by);
  Law law;
  law.friction[0] = std::clamp(pulls, -bound, bound);
  if (pulls != 0.0 && std::abs(pulls) <= bound) law.by_slide(0, 0) = by.stiffness;
  return law;
}

Vector2d SlipAnnuli::take_play(const Pressed& by, double slide) {
  const double friction = law_of_play(by, slide).friction[0];
  const double reach = 0.5 * play + bound_of(by) / by.stiffness;
  slip_all = std::abs(bend + slide) >= reach;
  bend = std::clamp(bend + slide, -reach, reach);
  energy = 0.5 * friction * friction / by.stiffness;
  return {friction, 0.0};
}

Vector2d SlipAnnuli::take(const Pressed& by, const Vector2d& slide) {
  if (play > 0.0) return take_play(by, slide[0]);
  const double bound = bound_of(by);
  const kernel::PartialSlipResponse now = kernel::partial_slip_step(
      bound > 0.0 ? by.stiffness : 0.0, bound, {slide[0], slide[1]}, memory);
  energy = now.elastic;
  slip_all = now.slipping;
  return vector(now.force);
}

}  // namespace statejump::truss::detail
