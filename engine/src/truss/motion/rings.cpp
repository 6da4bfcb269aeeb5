// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts that slip in part: their law is one function of the slide, solved by its tangent.
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "stepper.hpp"

namespace statejump::truss::detail {

using complementarity::Problem;

namespace {

/// Share of k_t that the contact problem takes for the least slope of a law: where all rings slip
/// there is none, and it is Coulomb's bound that holds.
constexpr double least_slope = 1e-9;

}  // namespace

/// Along both tangents of a contact; the second of a plane is 0.
Vector2d Stepper::along(const Local& local, Eigen::Index owner, const VectorXd& speeds) {
  const Eigen::Index second = partner(local, owner);
  return {speeds[2 * owner + 1], second < 0 ? 0.0 : speeds[2 * second + 1]};
}

Vector2d Stepper::slid(const Local& local, Eigen::Index owner) {
  const auto at = static_cast<std::size_t>(owner);
  return {local.contacts[at]->slid, partner(local, owner) < 0 ? 0.0 : local.contacts[at + 1]->slid};
}

VectorXd Stepper::speeds_of_rings(const Trial& step, const Local& local) const {
  VectorXd speeds = VectorXd::Zero(local.directions.cols());
  for (Eigen::Index i = 0; i < speeds.size() / 2; ++i) {
    if (!local.contacts[static_cast<std::size_t>(i)]->slips_in_part) continue;
    for (const Eigen::Index row : {2 * i, 2 * i + 1}) {
      speeds[row] = local.directions.col(row).dot(step.v);
    }
  }
  return speeds;
}

void Stepper::see_rings(const Trial& step, const Local& local, const VectorXd& speeds, Seen seen) {
  for (Eigen::Index i = 0; i < speeds.size() / 2; ++i) {
    Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
    if (!contact.slips_in_part || contact.beside) continue;
    SlippingRings& rings = contact.rings;
    const Vector2d speed = along(local, i, speeds);
    if (seen == Seen::here) rings.seen_slide = step.h * speed + slid(local, i);
    rings.see(seen == Seen::kinks, pressed(step, local, i, speeds[2 * i]), speed, slid(local, i),
              step.h);
  }
}

SlippingRings::Pressed Stepper::pressed(const Trial& step, const Local& local, Eigen::Index owner,
                                        double opens) const {
  const Contact& contact = *local.contacts[static_cast<std::size_t>(owner)];
  if (contact.normal_column < 0) {
    return contact.pressed(contact.given_force, contact.given_force, 0.0);
  }
  const double normal = local.impulses[2 * owner] / step.h;
  const double deep = depth(step, local, owner, opens);
  const double elastic = contact.damping > 0.0 ? contact.force_at(deep) : normal;
  return contact.pressed(elastic, normal, contact.across(deep, opens, step.h).share);
}

Stepper::Law Stepper::rings_law(const Trial& step, const Local& local, Eigen::Index i) const {
  const Eigen::Index first = owner(local, i);
  const Eigen::Index row = i == first ? 0 : 1;
  const Contact& contact = *local.contacts[static_cast<std::size_t>(first)];
  const SlippingRings::Pressed by =
      pressed(step, local, first, local.directions.col(2 * first).dot(step.v));
  const SlippingRings& rings = contact.rings;
  const Vector2d& speed = rings.seen_speed;
  const SlippingRings::Law now = rings.law(by, rings.seen_slide, speed, step.h);
  // As a speed: what the force lacks, moved in a step by a contact that sticks.
  const double unit = 1.0 / (by.stiffness * step.h);
  Law law;
  law.compliance = unit / step.h;
  law.by_speed = now.by_slide(row, row) / by.stiffness;
  if (partner(local, i) >= 0) law.by_beside = now.by_slide(row, 1 - row) / by.stiffness;
  if (contact.normal_column >= 0) law.by_normal = unit * now.by_normal[row] / step.h;
  law.offset = unit * now.friction[row] - law.by_speed * speed[row] -
               law.by_beside * speed[1 - row] - law.by_normal * local.impulses[2 * first];
  return law;
}

bool Stepper::on_rings(const Trial& step, const Local& local, double drift) const {
  const VectorXd speeds = speeds_of_rings(step, local);
  for (Eigen::Index i = 0; i < speeds.size() / 2; ++i) {
    const Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
    if (!contact.slips_in_part || contact.beside) continue;
    const SlippingRings::Pressed by = pressed(step, local, i, speeds[2 * i]);
    const Vector2d now = along(local, i, speeds);
    Vector2d off = contact.rings.law(by, step.h * now + slid(local, i), now, step.h).friction;
    off[0] += local.impulses[2 * i + 1] / step.h;
    if (partner(local, i) >= 0) off[1] += local.impulses[2 * partner(local, i) + 1] / step.h;
    const double least = contact.is_elastic() ? contact.force_at(contact.least_depth) : 0.0;
    const double bound = by.friction_coefficient * (std::max(by.normal_force, 0.0) + least);
    if (off.norm() > on_law * bound + by.stiffness * step.h * drift) return false;
  }
  return true;
}

void Stepper::add_rings(const Trial& step, const Local& local, Eigen::Index owner, double opens,
                        Problem& problem) const {
  const Eigen::Index rows[2] = {2 * owner + 1, 2 * partner(local, owner) + 1};
  const int count = partner(local, owner) < 0 ? 1 : 2;
  const SlippingRings& rings = local.contacts[static_cast<std::size_t>(owner)]->rings;
  const SlippingRings::Pressed by = pressed(step, local, owner, opens);
  const Vector2d& speed = rings.seen_speed;
  const SlippingRings::Law now = rings.law(by, rings.seen_slide, speed, step.h);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> slopes(now.by_slide);
  const Vector2d slope = slopes.eigenvalues().cwiseMax(least_slope * by.stiffness);
  const Eigen::Matrix2d compliance =
      slopes.eigenvectors() * slope.cwiseInverse().asDiagonal() * slopes.eigenvectors().transpose();
  const Vector2d bend = compliance * now.friction - step.h * speed;
  for (int a = 0; a < count; ++a) {
    problem.q[rows[a]] += bend[a] / step.h;
    for (int b = 0; b < count; ++b) {
      std::get<Eigen::MatrixXd>(problem.delassus)(rows[a], rows[b]) +=
          compliance(a, b) / (step.h * step.h);
    }
  }
}

void Stepper::book_rings(const Trial& step, const Local& local, Eigen::Index owner,
                         const VectorXd& speeds, const VectorXd& through) {
  const auto at = static_cast<std::size_t>(owner);
  Contact& contact = *local.contacts[at];
  const Eigen::Index second = partner(local, owner);
  const SlippingRings::Pressed by = pressed(step, local, owner, speeds[2 * owner]);
  const double stored = contact.rings.energy;
  const Vector2d spring =
      contact.rings.take(by, step.h * along(local, owner, speeds) + slid(local, owner));
  contact.compliance = 1.0 / by.stiffness;
  double work = 0.0;
  double dashpots = 0.0;
  const auto take = [&](Contact& one, Eigen::Index t, int row) {
    const double friction = by.normal_force > 0.0 ? -local.impulses[t] / step.h : 0.0;
    const bool slides = contact.rings.slip_all;
    const double force = step.in_mean(one.friction_force, friction, slides);
    const double bent = by.dashpot > 0.0 ? spring[row] : friction;
    const double elastic = step.in_mean(one.elastic_friction, bent, slides);
    one.friction_force = friction;
    one.elastic_friction = bent;
    work += force * step.h * through[t];
    dashpots += (force - elastic) * step.h * through[t];
  };
  take(contact, 2 * owner + 1, 0);
  if (second >= 0) take(*local.contacts[at + 1], 2 * second + 1, 1);
  account_.damping += dashpots;
  const double heat = work - dashpots - (contact.rings.energy - stored);
  account_.friction[contact.joint] += heat;
  account_.negative += std::min(heat, 0.0);
}

}  // namespace statejump::truss::detail
