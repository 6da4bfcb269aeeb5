// SPDX-License-Identifier: GPL-3.0-or-later
#include "step_forces.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace statejump::truss::detail {

namespace {

/// Momentum and forces must balance to this fraction of their largest values.
constexpr double balance = 1e-10;

}  // namespace

StepForces::StepForces(const System& system, const Bodies& bodies, Contacts& contacts,
                       const MotionState& state)
    : system_(system),
      bodies_(bodies),
      contacts_(contacts),
      state_(state),
      joints_(system.assembly(System::Parts::joints)),
      springs_(system.assembly(System::Parts::joints)),
      elements_(system.assembly(System::Parts::elements)),
      forces_(Assembly::without_jacobian(system.unknowns())) {}

VectorXd StepForces::unknowns_at(const VectorXd& q) const {
  VectorXd z = VectorXd::Zero(system_.unknowns());
  z.head(q.size()) = q;
  return z;
}

void StepForces::evaluate_contacts(const VectorXd& q, double time) {
  const VectorXd z = unknowns_at(q);
  system_.evaluate_joints(z, time, state_.origin, contacts_.closed(z, time, state_.origin),
                          joints_);
}

void StepForces::evaluate_springs_at(const VectorXd& z, double time) {
  system_.evaluate_joints(z, time, state_.origin, contacts_.closed(z, time, state_.origin),
                          springs_);
}

const Assembly& StepForces::evaluate_springs(const VectorXd& q, double time) {
  evaluate_springs_at(unknowns_at(q), time);
  return springs_;
}

const Assembly& StepForces::evaluate_springs_with_holds(const VectorXd& q, double time) {
  VectorXd z = unknowns_at(q);
  const std::vector<int>& turning = contacts_.turning_holds();
  for (std::size_t k = 0; k < turning.size(); ++k) {
    z[turning[k]] = state_.held[static_cast<Eigen::Index>(k)];
  }
  evaluate_springs_at(z, time);
  return springs_;
}

const Assembly& StepForces::evaluate_elements(const VectorXd& q, double time) {
  system_.evaluate_elements(unknowns_at(q), time, elements_);
  return elements_;
}

VectorXd StepForces::elastic_force(const VectorXd& q, double time) {
  // The joints are omitted, because r contains all contact forces.
  system_.evaluate_elements(unknowns_at(q), time, forces_);
  VectorXd found = -forces_.residual.head(q.size());
  if (!contacts_.have_springs()) return found;
  evaluate_springs(q, time);
  forces_.largest_force = std::max(forces_.largest_force, springs_.largest_force);
  return found - springs_.residual.head(q.size());
}

VectorXd StepForces::force_before(const TimeStep& step) const {
  VectorXd found = state_.force;
  if (bodies_.damped()) found += bodies_.force(state_.q, state_.v, step.span);
  return found;
}

double StepForces::gap_after(const Contact& contact, const VectorXd& way) const {
  const linear::SparseView jacobian = joints_.jacobian();
  double gap = contact.gap;
  for (const auto& [column, share] : contact.normal_columns()) {
    if (column < 0) continue;
    for (linear::SparseView::InnerIterator it(jacobian, column); it; ++it) {
      if (it.row() < way.size()) gap += share * contact.normal_sign * it.value() * way[it.row()];
    }
  }
  return gap;
}

double StepForces::rounding_at_middle(const TimeStep& step) const {
  VectorXd z = state_.z;
  z.head(state_.q.size()) = step.q_middle;
  return system_.length_rounding(z);
}

VectorXd StepForces::move(TimeStep& step) {
  const double theta = step.theta;
  step.q = step.q_from + step.h * (theta * step.v + (1.0 - theta) * state_.v);
  elastic_force_ = elastic_force(step.q, step.span.to);
  VectorXd now = elastic_force_;
  if (bodies_.damped()) now += bodies_.force(step.q, step.v, step.span);
  return bodies_.mass() * (step.v - step.v_from) -
         step.h * (theta * now + (1.0 - theta) * step.force_before);
}

bool StepForces::balanced(const TimeStep& step, const VectorXd& residual, const VectorXd& held,
                          const StepContacts& contacts, bool on_statuses) const {
  VectorXd left = residual;
  double largest = step.h * forces_.largest_force + (bodies_.mass() * step.v).cwiseAbs().maxCoeff();
  if (contacts.impulses.size() > 0) {
    const VectorXd pushed = contacts.directions * contacts.impulses;
    largest = std::max(largest, pushed.cwiseAbs().maxCoeff());
    left -= pushed;
  }
  if (held.size() > 0) {
    largest = std::max(largest, held.cwiseAbs().maxCoeff());
    left += held;
  }
  VectorXd z = state_.z;
  z.head(step.q.size()) = step.q;
  const double bound = balance * largest + step.h * system_.force_rounding(z);
  if (!(left.cwiseAbs().maxCoeff() <= bound)) return false;
  if (contacts_.slip_in_part() &&
      !contacts.on_partial_slip_laws(step, system_.length_rounding(z) / step.h)) {
    return false;
  }
  for (Eigen::Index i = 0; i < contacts.count(); ++i) {
    const Contact& contact = contacts.contact(i);
    if (!contact.is_elastic()) continue;
    const double impulse = contacts.impulses[2 * i];
    if (on_statuses && impulse == 0.0) continue;  // open; whether it may be is checked next
    const Contact::Across law = contacts.normal_law(step, i, contacts.speed(step, 2 * i));
    const double force = on_statuses ? law.force : std::max(law.force, 0.0);
    const double size = std::max(std::abs(law.elastic), std::abs(law.force - law.elastic));
    const double least = contact.force_at(contact.least_depth);
    if (std::abs(impulse - step.h * force) > step.h * (on_law * size + least)) return false;
  }
  return true;
}

void fail_step(const System& system, FailureKind kind, double time, const Contact* contact) {
  const Model& model = system.model();
  FailureFields fields{kind};
  fields.time = time;
  fields.temperature_change = model.temperature_change(0, 1.0, time);
  fields.sought = "no step of the motion";
  if (contact != nullptr) {
    const Joint& joint = model.joints[index(contact->joint)];
    fields.joints.push_back({kind_of(joint), name_of(joint)});
  }
  throw Failure(std::move(fields));
}

}  // namespace statejump::truss::detail
