// SPDX-License-Identifier: GPL-3.0-or-later
#include "ball_directions.hpp"

#include <algorithm>
#include <cmath>

namespace statejump::truss::detail {

namespace {

/// Largest number of iterations for the friction directions in a step. Directions change little,
/// and the iteration converges quadratically.
constexpr int most_rotations = 50;
/// Tolerated transverse component of friction, divided by the friction limit. Half its square is
/// the relative error of the magnitude, which is below the tolerance for slip.
constexpr double aside = 1e-4;
/// Tolerated change of transverse friction if the stiffness of a sticking contact is updated,
/// divided by the friction limit.
constexpr double stiffened = 1e-8;

}  // namespace

bool direct_balls(const System& system, const TimeStep& step, int rotations,
                  const StepContacts& local, Contacts& contacts, ContactStatuses& statuses) {
  bool settled = rotations > 0;
  const Contact* last = nullptr;
  for (std::size_t at = 0; at < local.contacts.size(); ++at) {
    Contact& contact = *local.contacts[at];
    if (contact.ball < 0 || contact.beside) continue;
    BallFriction& cone = contacts.balls()[index(contact.ball)];
    Contact& beside = *local.contacts[at + 1];
    const auto i = static_cast<Eigen::Index>(at);
    const auto speed = [&](Eigen::Index row) { return local.speed(step, row); };
    const double bound = contact.friction_coefficient * local.impulses[2 * i] / step.h;
    const double given = std::max(2.0 * bound, 0.0);
    const Vector2d friction(-local.impulses[2 * i + 1] / step.h,
                            -local.impulses[2 * i + 3] / step.h);
    const bool had_friction = beside.given_force > 0.0;  // in this iterate
    const auto set = [&](double force, double compliance) {
      beside.given_force = force;
      beside.tangential_stiffness = compliance > 0.0 ? 1.0 / compliance : Contact::infinite;
      statuses[cone.place + 1] = status_of(beside);
    };
    if (contact.slips_in_part) {
      // The contact problem limits friction to `given_force`. A solve with given statuses uses only
      // the law.
      if (rotations > 0 && friction.norm() < beside.given_force) continue;
      beside.given_force = std::max(given, 2.0 * friction.norm());
      if (rotations > 0 && bound > 0.0) settled = false;
      last = &contact;
      continue;
    }
    if (!(bound > 0.0)) {
      if (had_friction) settled = false;
      set(0.0, 0.0);
      if (!settled) last = &contact;
      continue;
    }
    const double compliance = contact.tangential_compliance(local.elastic_normal(step, i));
    const Contact::Along law = contact.along(local.elastic_normal(step, i), step.h);
    const double was = beside.tangential_compliance(given);
    beside.compliance = std::min(contact.compliance, compliance);
    Vector2d pull(step.h * speed(2 * i + 1), step.h * speed(2 * i + 3));
    bool right = had_friction;
    double across = 0.0;
    if (compliance > 0.0) {
      const double share = law.compliance / compliance;
      const Vector2d kept(contact.elastic_friction, cone.across().dot(cone.kept));
      pull += share * (beside.compliance * kept + Vector2d(contact.slid, beside.slid));
      const bool sticks = pull.norm() <= bound * law.compliance;
      across = sticks ? compliance : pull.norm() / (share * bound);
      beside.damping = contact.damping * std::sqrt(compliance / across);
      const double changed = std::abs(friction[1]) * std::abs(across / was - 1.0);
      right = right && changed <= (sticks ? stiffened : aside) * bound;
    } else {
      const bool sticks = contact.sticks(bound / contact.friction_coefficient, friction.norm());
      if (sticks && had_friction && was == 0.0) {
        pull = friction;
      } else if (contact.sticks(bound / contact.friction_coefficient, friction[0])) {
        pull = friction;  // the iterate did not constrain the transverse direction
        right = false;
        if (was == 0.0 && had_friction) across = pull.norm() > bound ? Contact::infinite : 0.0;
      } else {
        across = pull.norm() / bound;
      }
      right = right && (sticks || std::abs(friction[1]) <= aside * bound);
    }
    if (across == Contact::infinite) {
      set(0.0, 0.0);
    } else {
      set(given, across);
    }
    if (right) continue;
    settled = false;
    last = &contact;
    cone.point(cone.along * pull[0] + cone.across() * pull[1]);
    contacts.direct(cone);
  }
  if (settled || contacts.balls().empty()) return !settled;
  if (rotations == most_rotations) fail_step(system, FailureKind::not_converged, step.to, last);
  return true;
}

}  // namespace statejump::truss::detail
