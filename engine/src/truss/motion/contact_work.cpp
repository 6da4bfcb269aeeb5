// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_work.hpp"

#include <algorithm>

namespace statejump::truss::detail {

namespace {

using Eigen::Index;

/// Commits the step for a contact whose friction is a spring with Coulomb's limit.
/// @param along mean slip rates of the contacts in the step [m/s]
void commit_friction(const TimeStep& step, const StepContacts& contacts, Index i,
                     const VectorXd& along, EnergyAccount& account) {
  Contact& contact = contacts.contact(i);
  const Index t = 2 * i + 1;
  const double h = step.h;
  const double friction_before = contact.friction_force;
  const double elastic_before = contact.elastic_friction;
  const double stored_before = contact.tangential_energy();
  const double normal = contacts.impulses[2 * i] / h;
  const double elastic = contacts.elastic_normal(step, i);
  contact.friction_force = normal > 0.0 ? -contacts.impulses[t] / h : 0.0;
  const double compliance = normal > 0.0 ? contact.tangential_compliance(elastic) : 0.0;
  contact.elastic_friction =
      contact.damping > 0.0 && compliance > 0.0
          ? contact.spring_friction(elastic, h * contacts.speed(step, t) + contact.slid,
                                    contact.friction_coefficient * normal)
          : contact.friction_force;
  contact.compliance = compliance;
  if (contact.tangential_column < 0) return;
  const bool slides = normal > 0.0 && !contact.sticks(normal, contact.friction_force);
  const double force = step.mean(friction_before, contact.friction_force, slides);
  const double spring = step.mean(elastic_before, contact.elastic_friction, slides);
  const double dashpot = (force - spring) * h * along[t];
  account.damping += dashpot;
  const double heat =
      force * h * along[t] - dashpot - (contact.tangential_energy() - stored_before);
  account.friction[contact.joint] += heat;
  account.negative += std::min(heat, 0.0);
}

/// Stores state and energies at the end of a step for a contact with partial slip. Such a contact
/// has a second tangential direction, whose contact follows it in the list.
/// @param speeds of the contacts at the end of the step [m/s]
void commit_partial_slip(const TimeStep& step, const StepContacts& contacts, Index owner,
                         const VectorXd& speeds, const VectorXd& along, EnergyAccount& account) {
  Contact& contact = contacts.contact(owner);
  const Index second = contacts.partner(owner);
  const SlipAnnuli::Pressed by = contacts.pressed(step, owner, speeds[2 * owner]);
  const double stored = contact.annuli.energy;
  const Vector2d spring =
      contact.annuli.take(by, step.h * contacts.along(owner, speeds) + contacts.slid(owner));
  contact.compliance = 1.0 / by.stiffness;
  double work = 0.0;
  double dashpots = 0.0;
  const auto take = [&](Contact& one, Index t, int row) {
    const double friction = by.normal_force > 0.0 ? -contacts.impulses[t] / step.h : 0.0;
    const bool slides = contact.annuli.slip_all;
    const double force = step.mean(one.friction_force, friction, slides);
    const double bent = by.dashpot > 0.0 ? spring[row] : friction;
    const double elastic = step.mean(one.elastic_friction, bent, slides);
    one.friction_force = friction;
    one.elastic_friction = bent;
    work += force * step.h * along[t];
    dashpots += (force - elastic) * step.h * along[t];
  };
  take(contact, 2 * owner + 1, 0);
  if (second >= 0) take(contacts.contact(owner + 1), 2 * second + 1, 1);
  account.damping += dashpots;
  const double heat = work - dashpots - (contact.annuli.energy - stored);
  account.friction[contact.joint] += heat;
  account.negative += std::min(heat, 0.0);
}

}  // namespace

void commit_contacts(const TimeStep& step, const StepContacts& contacts, const VectorXd& through,
                     Contacts& all, EnergyAccount& account) {
  const double h = step.h;
  for (Contact& contact : all.all()) {
    if (contact.active) continue;
    contact.normal_force = contact.friction_force = contact.compliance = 0.0;
    contact.elastic_normal = contact.elastic_friction = 0.0;
    contact.annuli = {};
  }
  const VectorXd along = contacts.directions.transpose() * through;
  VectorXd speeds;
  if (all.slip_in_part()) speeds = contacts.partial_slip_speeds(step);
  for (Index i = 0; i < contacts.count(); ++i) {
    Contact& contact = contacts.contact(i);
    const double normal_before = contact.normal_force;
    const double elastic_before = contact.elastic_normal;
    const double stored_before = contact.normal_energy();
    if (contact.normal_column >= 0) {
      contact.normal_force = contacts.impulses[2 * i] / h;
      contact.elastic_normal = contacts.elastic_normal(step, i);
    }
    if (!contact.slips_in_part) {
      commit_friction(step, contacts, i, along, account);
    } else if (!contact.beside) {
      commit_partial_slip(step, contacts, i, speeds, along, account);
    }
    if (contact.normal_column < 0) continue;
    const double growth = contact.clearance_after - contact.clearance;
    const bool rigid = !contact.is_elastic();
    const double force = step.mean(normal_before, contact.normal_force, rigid);
    const double elastic_force = step.mean(elastic_before, contact.elastic_normal, rigid);
    const double opened = h * along[2 * i] + growth;
    const double dashpot = -(force - elastic_force) * opened;
    account.damping += dashpot;
    const double heat = -force * opened - dashpot - (contact.normal_energy() - stored_before);
    account.impact += heat;
    if (rigid) account.negative += std::min(heat, 0.0);
    account.thermal_work -= force * growth;
  }
}

}  // namespace statejump::truss::detail
