// SPDX-License-Identifier: GPL-3.0-or-later
#include "stepper.hpp"

#include <algorithm>
#include <cmath>

#include "ball_directions.hpp"
#include "contact_work.hpp"

namespace statejump::truss::detail {

namespace {

/// Tolerated error of a contact's predicted gap at the end of the step, divided by its clearance.
/// The prediction uses the directions at the middle of the step.
constexpr double off_course = 0.1;

}  // namespace

Stepper::Stepper(const System& system, const Bodies& bodies, const MotionOptions& options)
    : system_(system),
      bodies_(bodies),
      options_(options),
      contacts_(system, bodies.joint_damping()),
      forces_(system, bodies, contacts_, state_),
      matrix_(forces_, options.drives),
      search_(forces_, matrix_),
      contact_problem_(forces_, matrix_, options),
      uniqueness_(forces_, matrix_),
      painleve_(forces_, matrix_),
      drive_moment_(VectorXd::Zero(matrix_.constraints().drive_count())) {
  account_.friction = VectorXd::Zero(static_cast<Eigen::Index>(system.model().joints.size()));
}

void Stepper::begin(const VectorXd& q, const VectorXd& v, const State* equilibrium) {
  state_.q = q;
  state_.v = v;
  state_.time = 0.0;
  state_.z = VectorXd::Zero(system_.unknowns());
  state_.z.head(q.size()) = q;
  Statuses statuses = system_.all_stick();
  state_.origin = system_.begin(state_.z, 0.0, statuses, 1.0);
  state_.held = VectorXd::Zero(static_cast<Eigen::Index>(contacts_.turning_holds().size()));
  if (equilibrium != nullptr) {
    contacts_.begin(*equilibrium, options_.start_friction);
    state_.held = contacts_.held_at_rest(*equilibrium);
  }
  write_forces(state_.z, statuses);
  forces_.evaluate_contacts(q, 0.0);
  contacts_.measure(state_.z, 0.0, state_.origin, forces_.joints().residual, 0.0);
  note_statuses();
  contacts_.remember_clearances();
  state_.force = forces_.elastic_force(q, 0.0);
  state_.origin = system_.begin(state_.z, 0.0, statuses, 1.0);
  contacts_.write_annuli(state_.origin);
}

void Stepper::write_forces(VectorXd& z, Statuses& statuses) const {
  contacts_.write(z, statuses);
  z(contacts_.turning_holds()) = state_.held;
}

void Stepper::note_statuses() {
  state_.contacts.clear();
  for (const Contact& contact : contacts_.all()) state_.contacts.push_back(status_of(contact));
}

TimeStep Stepper::begin_step(double to) {
  const double length = to - state_.time;
  TimeStep step;
  step.number = ++steps_;
  step.h = step.length = length;
  step.to = to;
  step.theta = options_.theta;
  step.span = bodies_.step(state_.time, to);
  step.q_from = state_.q;
  step.v_from = step.v = state_.v;
  step.q_middle = state_.q + 0.5 * length * state_.v;
  return step;
}

StepContacts Stepper::contacts_of(const TimeStep& step) {
  return {contacts_, forces_.joints().jacobian(), state_, step, options_.restitution};
}

std::optional<StepContacts> Stepper::find(TimeStep& step, bool give_up) {
  matrix_.constraints().begin();
  step.force_before = forces_.force_before(step);
  forces_.evaluate_contacts(step.q_middle, step.to);
  VectorXd middle = state_.z;
  middle.head(state_.q.size()) = step.q_middle;
  contacts_.measure(middle, step.to, state_.origin, forces_.joints().residual,
                    system_.length_rounding(middle));
  StepContacts contacts = contacts_of(step);
  for (int rotations = 0;
       direct_balls(system_, step, rotations, contacts, contacts_, state_.contacts); ++rotations) {
    if (!contacts_.balls().empty()) contacts = contacts_of(step);
    if (search_.find(step, contacts)) continue;
    if (give_up) return {};
    step.v = state_.v;
    contacts = contacts_of(step);
    contact_problem_.solve(step, contacts);
  }
  return contacts;
}

bool Stepper::keeps_directions(const TimeStep& step) const {
  VectorXd z = state_.z;
  z.head(step.q.size()) = step.q;
  const VectorXd way = step.q - step.q_middle;
  for (const Contact& contact : contacts_.all()) {
    const bool is_round =
        contact.normal_column >= 0 && contact.stop == JointStatus::open && contact.turns_normal;
    if (!is_round || contact.gap == Contact::infinite) continue;
    const double gap = contacts_.gap_at(contact, z, step.to, state_.origin);
    const double off = std::abs(gap - forces_.gap_after(contact, way));
    if (off > off_course * contact.clearance_after) return false;
  }
  return true;
}

double Stepper::deepest(const TimeStep& step) const {
  double most = 0.0;
  const VectorXd way = step.q - step.q_middle;
  for (const Contact& contact : contacts_.all()) {
    if (contact.active || contact.normal_column < 0 || contact.gap == Contact::infinite) continue;
    most = std::max(most, -forces_.gap_after(contact, way));
  }
  return most;
}

bool Stepper::advance(double to) {
  TimeStep step = begin_step(to);
  const std::optional<StepContacts> contacts = find(step, false);
  if (!keeps_directions(step)) return false;
  commit(step, *contacts);
  return true;
}

bool Stepper::advance_damped(double to, bool give_up) {
  TimeStep step = begin_step(to);
  step.theta = 1.0;
  step.is_definite = true;
  const std::optional<StepContacts> contacts = find(step, give_up);
  if (!contacts || !keeps_directions(step)) return false;
  commit(step, *contacts);
  return true;
}

std::optional<double> Stepper::attempt(double to, bool give_up) {
  TimeStep step = begin_step(to);
  step.theta = 1.0;
  // BDF2 with variable steps; implicit Euler without a previous step.
  const double ratio = before_.length > 0.0 ? step.length / before_.length : 0.0;
  const double weight = 1.0 + 2.0 * ratio;
  step.differentiates = ratio > 0.0;
  step.h = (1.0 + ratio) / weight * step.length;
  VectorXd change = VectorXd::Zero(state_.v.size());  // extrapolated change of v from the last step
  if (ratio > 0.0) {
    change = ratio * (state_.v - before_.v);
    step.v_from += ratio / weight * change;
    step.q_from += ratio * ratio / weight * (state_.q - before_.q);
  }
  std::optional<StepContacts> contacts = find(step, give_up);
  if (!contacts) return {};
  if (contacts->closes() && before_.length > 0.0) {
    before_.length = 0.0;
    return attempt(to, give_up);
  }
  // Leading term of the error of one step: h²/2 v' for implicit Euler, (1+r)²/(6r(1+2r)) h³ v'' for
  // BDF2.
  const double share = ratio > 0.0 ? (1.0 + ratio) / (3.0 * weight) : 0.5;
  double off = deepest(step);
  if (state_.v.size() > 0) {
    off = std::max(off, share * step.length * (step.v - state_.v - change).cwiseAbs().maxCoeff());
  }
  attempted_.emplace(std::move(step), std::move(*contacts));
  return off;
}

void Stepper::accept() {
  const auto& [step, contacts] = *attempted_;
  before_ = {contacts.closes() ? 0.0 : step.length, state_.q, state_.v};
  commit(step, contacts);
  attempted_.reset();
}

void Stepper::commit(const TimeStep& step, const StepContacts& contacts) {
  // Mean velocities, by which impulses do work.
  const VectorXd through = step.differentiates ? VectorXd((step.q - state_.q) / step.h)
                                               : VectorXd(0.5 * (state_.v + step.v));
  const VelocityConstraints& constraints = matrix_.constraints();
  for (Eigen::Index k = 0; k < constraints.drive_count(); ++k) {
    const Eigen::Index column = constraints.count() - constraints.drive_count() + k;
    drive_moment_[k] = -constraints.scale() * step.held[column] / step.h;
    account_.drives -= step.held[column] * constraints.columns().col(column).dot(through);
  }
  const VectorXd held = constraints.turning_forces(step);
  // The checks factor other matrices and scale the constraints anew.
  painleve_.check(step, contacts);
  uniqueness_.check(step, contacts);
  commit_contacts(step, contacts, through, contacts_, account_);
  state_.held = held;
  if (bodies_.damped()) {
    const double theta = step.differentiates ? 0.5 : step.theta;
    const Bodies::Work work = bodies_.work(state_.q, state_.v, step.q, step.v, step.span, theta);
    account_.damping += work.heat;
    account_.thermal_work += work.thermal;
  }
  VectorXd z(state_.z.size());
  z.head(step.q.size()) = step.q;
  Statuses statuses = state_.origin.statuses;
  write_forces(z, statuses);
  StepStart after = system_.commit(z, step.to, statuses, state_.origin);
  contacts_.write_annuli(after);
  account_.thermal_work += system_.work_on_elements({state_.z, state_.time, z, step.to});
  note_statuses();
  contacts_.remember_clearances();
  state_.force = forces_.last_elastic_force();
  state_.q = step.q;
  state_.v = step.v;
  state_.z = std::move(z);
  state_.time = step.to;
  state_.origin = std::move(after);
}

void Stepper::describe(State& state) const {
  system_.describe(state_.z, state_.time, state_.origin, state);
  if (contacts_.damped()) {
    State whole;
    system_.describe(contacts_.with_dashpots(state_.z), state_.time, state_.origin, whole);
    state.joint_output = std::move(whole.joint_output);
  }
  state.thermal_work = account_.thermal_work;
  state.joint_dissipation = account_.friction;
}

}  // namespace statejump::truss::detail
