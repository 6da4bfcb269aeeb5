// SPDX-License-Identifier: GPL-3.0-or-later
#include "step_contacts.hpp"

#include <algorithm>
#include <cmath>

namespace statejump::truss::detail {

using Eigen::Index;

StepContacts::StepContacts(Contacts& all, const linear::SparseView& jacobian,
                           const MotionState& state, const TimeStep& step, double restitution)
    : restitution_(restitution) {
  for (std::size_t number = 0; number < all.all().size(); ++number) {
    Contact& contact = all.all()[number];
    if (!contact.active) continue;
    contacts.push_back(&contact);
    numbers.push_back(static_cast<int>(number));
  }
  const Index n = state.q.size();
  const Index rows = 2 * count();
  std::vector<Eigen::Triplet<double>> entries;
  const auto take = [&](int column, double sign, Index to) {
    if (column < 0) return;
    for (linear::SparseView::InnerIterator it(jacobian, column); it; ++it) {
      if (it.row() < n) entries.emplace_back(it.row(), to, sign * it.value());
    }
  };
  impulses = VectorXd::Zero(rows);
  for (Index i = 0; i < count(); ++i) {
    const Contact& one = contact(i);
    for (const auto& [column, share] : one.normal_columns()) {
      take(column, share * one.normal_sign, 2 * i);
    }
    for (const auto& [column, share] : one.tangential_columns()) take(column, share, 2 * i + 1);
    impulses[2 * i] = step.h * (one.normal_column < 0 ? one.given_force : one.normal_force);
    impulses[2 * i + 1] = -step.h * one.friction_force;
  }
  directions.resize(n, rows);
  directions.setFromTriplets(entries.begin(), entries.end());
  before = directions.transpose() * state.v;
  const VectorXd opened = directions.transpose() * (step.q_from - step.q_middle);
  const VectorXd slid = directions.transpose() * (step.q_from - state.q);
  for (Index i = 0; i < count(); ++i) {
    Contact& one = contact(i);
    before[2 * i] += (one.clearance_after - one.clearance) / step.length;
    one.opened = opened[2 * i];
    one.slid = slid[2 * i + 1];
  }
}

double StepContacts::depth(const TimeStep& step, Index i, double speed) const {
  return -(contact(i).gap + contact(i).opened + step.h * speed);
}

Contact::Across StepContacts::normal_law(const TimeStep& step, Index i, double speed) const {
  return contact(i).across(depth(step, i, speed), speed, step.h);
}

StepContacts::Tangent StepContacts::normal_tangent(const TimeStep& step, Index i,
                                                   double speed) const {
  const Contact::Across law = normal_law(step, i, speed);
  const double compliance = step.h / law.slope;
  return {std::max(law.elastic, 0.0), law.force, compliance,
          -(step.h * speed + compliance * law.force)};
}

double StepContacts::elastic_normal(const TimeStep& step, Index i) const {
  const double normal = impulses[2 * i] / step.h;
  if (!contact(i).is_elastic() || contact(i).damping == 0.0) return normal;
  return contact(i).force_at(depth(step, i, speed(step, 2 * i)));
}

double StepContacts::leaving_speed(const TimeStep& step, Index i) const {
  return (contact(i).clearance_after - contact(i).clearance) / step.length +
         restitution_ * std::min(before[2 * i], 0.0);
}

ContactRow StepContacts::normal_row(const TimeStep& step, Index i) const {
  if (!contact(i).is_elastic()) return {leaving_speed(step, i)};
  const Tangent law = normal_tangent(step, i, speed(step, 2 * i));
  return {law.gap / step.h, law.compliance / (step.h * step.h)};
}

ContactRow StepContacts::stick_row(const TimeStep& step, Index i) const {
  if (contact(i).slips_in_part) return partial_slip_row(step, i);
  double normal = contact(i).given_force;
  if (contact(i).normal_column >= 0 && contact(i).is_elastic()) {
    normal = normal_tangent(step, i, speed(step, 2 * i)).elastic;
  } else if (contact(i).normal_column >= 0) {
    normal = impulses[2 * i] / step.h;
  }
  const Contact::Along friction = contact(i).along(normal, step.h);
  return {friction.bend / step.h, friction.compliance / (step.h * step.h)};
}

double StepContacts::residual(const ContactRow& row, const TimeStep& step, Index i,
                              bool across) const {
  const Index at = 2 * i + (across ? 0 : 1);
  double sum = row.by_speed * speed(step, at) + row.offset + row.compliance * impulses[at];
  if (row.by_normal != 0.0) sum += row.by_normal * impulses[2 * owner(i)];
  if (row.by_beside != 0.0) sum += row.by_beside * speed(step, 2 * partner(i) + 1);
  return sum;
}

double StepContacts::friction_ratio(const Contact& contact, ContactStatus status) {
  // Friction on the body is against the slip.
  return status == ContactStatus::slip_plus    ? -contact.friction_coefficient
         : status == ContactStatus::slip_minus ? contact.friction_coefficient
                                               : 0.0;
}

ContactStatus StepContacts::requested(const TimeStep& step, Index i, ContactStatus status) const {
  const double h = step.h;
  const Contact& one = contact(i);
  const double normal = impulses[2 * i];
  const double tangential = impulses[2 * i + 1];
  const double bound = one.friction_coefficient * normal;
  if (one.slips_in_part && one.beside) return status;
  if (status == ContactStatus::open) {
    if (one.normal_column < 0) return status;
    const double opens = speed(step, 2 * i);
    const bool closes =
        one.is_elastic() ? normal_tangent(step, i, opens).force > 0.0 : depth(step, i, opens) > 0.0;
    return closes ? ContactStatus::stick : status;
  }
  if (!(normal > 0.0)) return ContactStatus::open;
  // One law covers all states from no slip to slip of all annuli, so the status is always `stick`.
  if (one.slips_in_part) return ContactStatus::stick;
  if (one.tangential_column < 0 || bound == 0.0) {
    // It slides freely in both directions.
    return status == ContactStatus::stick ? ContactStatus::slip_plus : status;
  }
  if (status == ContactStatus::stick) {
    if (std::abs(tangential) <= bound * (1.0 + allowance)) return status;
    return tangential < 0.0 ? ContactStatus::slip_plus : ContactStatus::slip_minus;
  }
  const Contact::Along friction = one.along(elastic_normal(step, i), h);
  const double slide =
      speed(step, 2 * i + 1) + (friction.compliance * tangential / h + friction.bend) / h;
  return tangential * slide <= 0.0 ? status : ContactStatus::stick;
}

ContactStatuses StepContacts::statuses() const {
  ContactStatuses found;
  for (Index i = 0; i < count(); ++i) {
    const double normal = impulses[2 * i];
    const double friction = -impulses[2 * i + 1];
    if (contact(i).slips_in_part) {
      const bool open = !contact(i).beside && !(normal > 0.0);
      found.push_back(open ? ContactStatus::open : ContactStatus::stick);
      continue;
    }
    found.push_back(!(normal > 0.0)                       ? ContactStatus::open
                    : contact(i).sticks(normal, friction) ? ContactStatus::stick
                    : friction >= 0.0                     ? ContactStatus::slip_plus
                                                          : ContactStatus::slip_minus);
  }
  return found;
}

bool StepContacts::closes() const {
  for (Index i = 0; i < count(); ++i) {
    if (contact(i).is_rigid() && contact(i).normal_force == 0.0 && impulses[2 * i] > 0.0) {
      return true;
    }
  }
  return false;
}

ContactStatus status_of(const Contact& contact) {
  if (!contact.active) return ContactStatus::open;
  if (contact.slips_in_part && contact.beside) return ContactStatus::stick;
  const double normal = contact.normal_column < 0 ? contact.given_force : contact.normal_force;
  if (!(normal > 0.0)) return ContactStatus::open;
  if (contact.slips_in_part || contact.sticks(normal, contact.friction_force)) {
    return ContactStatus::stick;
  }
  return contact.friction_force >= 0.0 ? ContactStatus::slip_plus : ContactStatus::slip_minus;
}

}  // namespace statejump::truss::detail
