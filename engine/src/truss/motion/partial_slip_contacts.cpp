// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts with partial slip. Their law is one function of the slide, and its tangent enters a
// step.
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "step_contacts.hpp"

namespace statejump::truss::detail {

using complementarity::Problem;

namespace {

/// Least slope of the partial-slip law in the contact problem, divided by k_t. If all annuli slip,
/// the slope would be zero, and Coulomb's limit bounds friction.
constexpr double least_slope = 1e-9;

}  // namespace

Vector2d StepContacts::along(Index owner, const VectorXd& speeds) const {
  const Index second = partner(owner);
  return {speeds[2 * owner + 1], second < 0 ? 0.0 : speeds[2 * second + 1]};
}

Vector2d StepContacts::slid(Index owner) const {
  return {contact(owner).slid, partner(owner) < 0 ? 0.0 : contact(owner + 1).slid};
}

VectorXd StepContacts::partial_slip_speeds(const TimeStep& step) const {
  VectorXd speeds = VectorXd::Zero(directions.cols());
  for (Index i = 0; i < speeds.size() / 2; ++i) {
    if (!contact(i).slips_in_part) continue;
    for (const Index row : {2 * i, 2 * i + 1}) {
      speeds[row] = speed(step, row);
    }
  }
  return speeds;
}

void StepContacts::place_tangents(const TimeStep& step, const VectorXd& speeds, TangentAt at) {
  for (Index i = 0; i < speeds.size() / 2; ++i) {
    if (!contact(i).slips_in_part || contact(i).beside) continue;
    SlipAnnuli& annuli = contact(i).annuli;
    const Vector2d speed = along(i, speeds);
    if (at == TangentAt::iterate) annuli.tangent_slide = step.h * speed + slid(i);
    annuli.place_tangent(at == TangentAt::kinks, pressed(step, i, speeds[2 * i]), speed, slid(i),
                         step.h);
  }
}

SlipAnnuli::Pressed StepContacts::pressed(const TimeStep& step, Index owner, double opens) const {
  const Contact& one = contact(owner);
  if (one.normal_column < 0) {
    return one.pressed(one.given_force, one.given_force, 0.0);
  }
  const double normal = impulses[2 * owner] / step.h;
  const double deep = depth(step, owner, opens);
  const double elastic = one.damping > 0.0 ? one.force_at(deep) : normal;
  return one.pressed(elastic, normal, one.across(deep, opens, step.h).share);
}

ContactRow StepContacts::partial_slip_row(const TimeStep& step, Index i) const {
  const Index first = owner(i);
  const Index row = i == first ? 0 : 1;
  const SlipAnnuli::Pressed by = pressed(step, first, speed(step, 2 * first));
  const SlipAnnuli& annuli = contact(first).annuli;
  const Vector2d& speed = annuli.tangent_speed;
  const SlipAnnuli::Law now = annuli.law(by, annuli.tangent_slide, speed, step.h);
  // Scaled to a speed: missing force over k_t h.
  const double unit = 1.0 / (by.stiffness * step.h);
  ContactRow law;
  law.compliance = unit / step.h;
  law.by_speed = now.by_slide(row, row) / by.stiffness;
  if (partner(i) >= 0) law.by_beside = now.by_slide(row, 1 - row) / by.stiffness;
  if (contact(first).normal_column >= 0) law.by_normal = unit * now.by_normal[row] / step.h;
  law.offset = unit * now.friction[row] - law.by_speed * speed[row] -
               law.by_beside * speed[1 - row] - law.by_normal * impulses[2 * first];
  return law;
}

bool StepContacts::on_partial_slip_laws(const TimeStep& step, double drift) const {
  const VectorXd speeds = partial_slip_speeds(step);
  for (Index i = 0; i < speeds.size() / 2; ++i) {
    const Contact& one = contact(i);
    if (!one.slips_in_part || one.beside) continue;
    const SlipAnnuli::Pressed by = pressed(step, i, speeds[2 * i]);
    const Vector2d now = along(i, speeds);
    Vector2d off = one.annuli.law(by, step.h * now + slid(i), now, step.h).friction;
    off[0] += impulses[2 * i + 1] / step.h;
    if (partner(i) >= 0) off[1] += impulses[2 * partner(i) + 1] / step.h;
    const double least = one.is_elastic() ? one.force_at(one.least_depth) : 0.0;
    const double bound = by.friction_coefficient * (std::max(by.normal_force, 0.0) + least);
    if (off.norm() > on_law * bound + by.stiffness * step.h * drift) return false;
  }
  return true;
}

void StepContacts::add_partial_slip(const TimeStep& step, Index owner, double opens,
                                    Problem& problem) const {
  const Index rows[2] = {2 * owner + 1, 2 * partner(owner) + 1};
  const int count = partner(owner) < 0 ? 1 : 2;
  const SlipAnnuli& annuli = contact(owner).annuli;
  const SlipAnnuli::Pressed by = pressed(step, owner, opens);
  const Vector2d& speed = annuli.tangent_speed;
  const SlipAnnuli::Law now = annuli.law(by, annuli.tangent_slide, speed, step.h);
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

}  // namespace statejump::truss::detail
