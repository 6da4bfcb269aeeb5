// SPDX-License-Identifier: GPL-3.0-or-later
#include "painleve.hpp"

namespace statejump::truss::detail {

void PainleveCheck::check(const TimeStep& step, const StepContacts& contacts) {
  if (found_) return;
  const Eigen::Index n = forces_.state().q.size();
  for (Eigen::Index i = 0; i < contacts.count(); ++i) {
    const Contact& contact = contacts.contact(i);
    const auto at = static_cast<std::size_t>(i);
    const auto number = static_cast<std::size_t>(contacts.numbers[at]);
    const ContactStatus before = forces_.state().contacts[number];
    if (!contact.is_rigid() || contact.tangential_column < 0 || before == ContactStatus::stick) {
      continue;
    }
    const double normal = contacts.impulses[2 * i];
    const bool leaves = contact.normal_force > 0.0 && normal == 0.0;
    const bool stops = normal > 0.0 && contact.sticks(normal, contacts.impulses[2 * i + 1]);
    const double speed = contacts.before[2 * i + 1];
    if (!(leaves || stops) || speed == 0.0) continue;
    StatusFactors on;
    on.statuses = contacts.statuses();
    on.statuses[at] = ContactStatus::open;
    if (!matrix_.factorize(on, step, contacts)) continue;
    VectorXd right = VectorXd::Zero(matrix_.matrix().rows());
    const VectorXd across = contacts.directions.col(2 * i);
    const ContactStatus slip = speed > 0.0 ? ContactStatus::slip_plus : ContactStatus::slip_minus;
    right.head(n) = across + StepContacts::friction_ratio(contact, slip) *
                                 VectorXd(contacts.directions.col(2 * i + 1));
    if (across.dot(on.factor.solve(right).head(n)) > 0.0) continue;
    found_ = Undetermined{step.to, {contact.joint}};
    return;
  }
}

}  // namespace statejump::truss::detail
