// SPDX-License-Identifier: GPL-3.0-or-later
#include "stepper.hpp"

#include <algorithm>
#include <cmath>

#include "entries.hpp"

namespace statejump::truss::detail {

namespace {

/// Momentum and forces balance to this share of the largest of either.
constexpr double balance = 1e-10;
/// Share of its clearance by which a contact may end beside where its directions, those of the
/// middle of the step, lead.
constexpr double off_course = 0.1;
}  // namespace

Stepper::Stepper(const System& system, const Bodies& bodies, const MotionOptions& options)
    : system_(&system),
      bodies_(&bodies),
      options_(&options),
      contacts_(system, bodies.joint_damping()),
      joints_(system.assembly(System::Parts::joints)),
      springs_(system.assembly(System::Parts::joints)),
      bars_(system.assembly(System::Parts::elements)),
      forces_(Assembly::without_jacobian(system.unknowns())),
      drives_(system, options.drives),
      drive_moment_(VectorXd::Zero(drives_.count())) {
  account_.friction = VectorXd::Zero(static_cast<Eigen::Index>(system.model().joints.size()));
}

void Stepper::begin(const VectorXd& q, const VectorXd& v, const State* equilibrium) {
  q_ = q;
  v_ = v;
  time_ = 0.0;
  z_ = VectorXd::Zero(system_->unknowns());
  z_.head(q.size()) = q;
  Statuses statuses = system_->all_stick();
  origin_ = system_->begin(z_, 0.0, statuses, 1.0);
  if (equilibrium != nullptr) contacts_.begin(*equilibrium, options_->start_friction);
  contacts_.write(z_, statuses);
  evaluate_contacts(q_, 0.0);
  contacts_.measure(z_, 0.0, origin_, joints_.residual, 0.0);
  note_branches();
  contacts_.remember_clearances();
  internal_ = elastic_force(q, 0.0);
  origin_ = system_->begin(z_, 0.0, statuses, 1.0);
  contacts_.tell_rings(origin_);
}

void Stepper::evaluate_contacts(const VectorXd& q, double time) {
  VectorXd z = VectorXd::Zero(system_->unknowns());
  z.head(q.size()) = q;
  system_->evaluate_joints(z, time, origin_, contacts_.closed(z, time, origin_), joints_);
}

VectorXd Stepper::elastic_force(const VectorXd& q, double time) {
  VectorXd z = VectorXd::Zero(system_->unknowns());
  z.head(q.size()) = q;
  // Of joints only what does not come by a contact, of which r has all.
  system_->evaluate_elements(z, time, forces_);
  VectorXd found = -forces_.residual.head(q.size());
  if (!contacts_.have_springs()) return found;
  evaluate_springs(q, time);
  forces_.largest_force = std::max(forces_.largest_force, springs_.largest_force);
  return found - springs_.residual.head(q.size());
}

void Stepper::evaluate_springs(const VectorXd& q, double time) {
  VectorXd z = VectorXd::Zero(system_->unknowns());
  z.head(q.size()) = q;
  system_->evaluate_joints(z, time, origin_, contacts_.closed(z, time, origin_), springs_);
}

VectorXd Stepper::force(const VectorXd& q, const VectorXd& v, const Bodies::Step& step) {
  VectorXd found = internal_after_ = elastic_force(q, step.to);
  if (bodies_->damped()) found += bodies_->force(q, v, step);
  return found;
}

void Stepper::fill_bodies(const Trial& step, RefilledMatrix& to) {
  const Eigen::Index n = q_.size();
  const double by_speed = step.h * step.theta;
  const double by_place = by_speed * by_speed;
  VectorXd diagonal = VectorXd::Zero(n);
  const auto add = [&](Eigen::Index row, Eigen::Index column, double value) {
    to.add(row, column, value);
    if (row == column) diagonal[row] += value;
  };
  const auto add_block = [&](const auto& matrix, double share) {
    each_entry(matrix, n, [&](Eigen::Index row, Eigen::Index column, double value) {
      add(row, column, share * value);
    });
  };
  VectorXd middle = VectorXd::Zero(system_->unknowns());
  middle.head(n) = step.q_middle;
  system_->evaluate_elements(middle, step.to, bars_);
  add_block(bodies_->mass(), 1.0);
  add_block(bars_.jacobian(), by_place);
  if (step.is_definite) {
    for (const auto& one : bodies_->compression_entries(step.q_middle, step.to)) {
      add(one.row(), one.col(), by_place * one.value());
    }
  }
  if (contacts_.have_springs()) {
    evaluate_springs(step.q_middle, step.to);
    add_block(springs_.jacobian(), by_place);
  }
  if (bodies_->damped()) {
    for (const auto& one : bodies_->damping_entries(step.q_middle)) {
      add(one.row(), one.col(), by_speed * one.value());
    }
  }
  // Of the size of the rest, so that pivots compare.
  hold_directions(step, diagonal.maxCoeff());
  for (Eigen::Index k = 0; k < holds_.cols(); ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(holds_, k); it; ++it) {
      to.add(it.row(), n + k, it.value());
      to.add(n + k, it.row(), it.value());
    }
  }
}

void Stepper::hold_directions(const Trial& step, double scale) {
  const Eigen::Index n = q_.size();
  const auto holding = static_cast<Eigen::Index>(contacts_.holds().size());
  hold_scale_ = scale;
  holds_.resize(n, held_count());
  held_speed_ = VectorXd::Zero(holds_.cols());
  if (holds_.cols() == 0) return;
  std::vector<Eigen::Triplet<double>> columns;
  const linear::SparseView jacobian = joints_.jacobian();
  for (Eigen::Index k = 0; k < holding; ++k) {
    const int column = contacts_.holds()[static_cast<std::size_t>(k)];
    for (linear::SparseView::InnerIterator it(jacobian, column); it; ++it) {
      if (it.row() < n) columns.emplace_back(it.row(), k, scale * it.value());
    }
  }
  for (const auto& one : drives_.directions(step.q_middle, step.to)) {
    columns.emplace_back(one.row(), holding + one.col(), scale * one.value());
  }
  held_speed_.tail(drives_.count()) = scale * drives_.targets(q_, time_, step.to);
  holds_.setFromTriplets(columns.begin(), columns.end());
}

Stepper::Local Stepper::local_problem(const Trial& step) {
  Local local;
  for (Contact& contact : contacts_.all()) {
    if (contact.active) local.contacts.push_back(&contact);
  }
  const Eigen::Index n = q_.size();
  const auto rows = static_cast<Eigen::Index>(2 * local.contacts.size());
  std::vector<Eigen::Triplet<double>> entries;
  const linear::SparseView jacobian = joints_.jacobian();
  const auto take = [&](int column, double sign, Eigen::Index to) {
    if (column < 0) return;
    for (linear::SparseView::InnerIterator it(jacobian, column); it; ++it) {
      if (it.row() < n) entries.emplace_back(it.row(), to, sign * it.value());
    }
  };
  local.impulses = VectorXd::Zero(rows);
  for (Eigen::Index i = 0; i < rows / 2; ++i) {
    const Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
    for (const auto& [column, share] : contact.normal_columns()) {
      take(column, share * contact.normal_sign, 2 * i);
    }
    for (const auto& [column, share] : contact.tangential_columns()) take(column, share, 2 * i + 1);
    local.impulses[2 * i] =
        step.h * (contact.normal_column < 0 ? contact.given_force : contact.normal_force);
    local.impulses[2 * i + 1] = -step.h * contact.friction_force;
  }
  local.directions.resize(n, rows);
  local.directions.setFromTriplets(entries.begin(), entries.end());
  local.before = local.directions.transpose() * v_;
  const VectorXd opened = local.directions.transpose() * (step.q_from - step.q_middle);
  const VectorXd slid = local.directions.transpose() * (step.q_from - q_);
  for (Eigen::Index i = 0; i < rows / 2; ++i) {
    Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
    local.before[2 * i] += (contact.clearance_after - contact.clearance) / step.length;
    contact.opened = opened[2 * i];
    contact.slid = slid[2 * i + 1];
  }
  return local;
}

double Stepper::depth(const Trial& step, const Local& local, Eigen::Index i, double speed) const {
  const Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
  return -(contact.gap + contact.opened + step.h * speed);
}

Stepper::Tangent Stepper::tangent(const Trial& step, const Local& local, Eigen::Index i,
                                  double speed) const {
  const Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
  const Contact::Across law = contact.across(depth(step, local, i, speed), speed, step.h);
  const double compliance = step.h / law.slope;
  return {std::max(law.elastic, 0.0), law.force, compliance,
          -(step.h * speed + compliance * law.force)};
}

double Stepper::elastic_normal(const Trial& step, const Local& local, Eigen::Index i) const {
  const Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
  const double normal = local.impulses[2 * i] / step.h;
  if (!contact.is_elastic() || contact.damping == 0.0) return normal;
  return contact.force_at(depth(step, local, i, local.directions.col(2 * i).dot(step.v)));
}

double Stepper::leaving(const Trial& step, const Local& local, Eigen::Index i) const {
  const Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
  return (contact.clearance_after - contact.clearance) / step.length +
         options_->restitution * std::min(local.before[2 * i], 0.0);
}

VectorXd Stepper::move(Trial& step) {
  const double theta = step.theta;
  step.q = step.q_from + step.h * (theta * step.v + (1.0 - theta) * v_);
  const VectorXd now = force(step.q, step.v, step.span);
  return bodies_->mass() * (step.v - step.v_from) -
         step.h * (theta * now + (1.0 - theta) * step.force_before);
}

bool Stepper::balanced(const Trial& step, const VectorXd& residual, const VectorXd& held,
                       const Local& local, bool by_branches) const {
  VectorXd left = residual;
  double largest =
      step.h * forces_.largest_force + (bodies_->mass() * step.v).cwiseAbs().maxCoeff();
  if (local.impulses.size() > 0) {
    const VectorXd pushed = local.directions * local.impulses;
    largest = std::max(largest, pushed.cwiseAbs().maxCoeff());
    left -= pushed;
  }
  if (held.size() > 0) left += holds_ * held;
  VectorXd z = z_;
  z.head(step.q.size()) = step.q;
  const double bound = balance * largest + step.h * system_->force_rounding(z);
  if (!(left.cwiseAbs().maxCoeff() <= bound)) return false;
  // Elastic contacts are on their law, not only on its tangent.
  if (contacts_.slip_in_part() && !on_rings(step, local, system_->length_rounding(z) / step.h)) {
    return false;
  }
  for (std::size_t i = 0; i < local.contacts.size(); ++i) {
    const Contact& contact = *local.contacts[i];
    if (!contact.is_elastic()) continue;
    const auto n = static_cast<Eigen::Index>(2 * i);
    if (by_branches && local.impulses[n] == 0.0) continue;  // open; whether it may is asked next
    const double speed = local.directions.col(n).dot(step.v);
    const Contact::Across law = contact.across(depth(step, local, n / 2, speed), speed, step.h);
    const double force = by_branches ? law.force : std::max(law.force, 0.0);
    const double size = std::max(std::abs(law.elastic), std::abs(law.force - law.elastic));
    const double least = contact.force_at(contact.least_depth);
    if (std::abs(local.impulses[n] - step.h * force) > step.h * (on_law * size + least)) {
      return false;
    }
  }
  return true;
}

Stepper::Trial Stepper::trial(double to) {
  const double length = to - time_;
  Trial step;
  step.number = ++trials_;
  step.h = step.length = length;
  step.to = to;
  step.theta = options_->theta;
  step.span = bodies_->step(time_, to);
  step.q_from = q_;
  step.v_from = step.v = v_;
  step.q_middle = q_ + 0.5 * length * v_;
  return step;
}

std::optional<Stepper::Local> Stepper::find(Trial& step, bool give_up) {
  step.force_before = internal_;
  if (bodies_->damped()) step.force_before += bodies_->force(q_, v_, step.span);

  evaluate_contacts(step.q_middle, step.to);
  VectorXd middle = z_;
  middle.head(q_.size()) = step.q_middle;
  contacts_.measure(middle, step.to, origin_, joints_.residual, system_->length_rounding(middle));
  Local local = local_problem(step);
  for (int turns = 0; turn_balls(step, turns, local); ++turns) {
    if (!contacts_.balls().empty()) local = local_problem(step);
    if (on_branches(step, local)) continue;
    if (give_up) return {};
    step.v = v_;
    local = local_problem(step);
    solve(step, local);
  }
  return local;
}

bool Stepper::keeps_directions(const Trial& step) const {
  VectorXd z = z_;
  z.head(step.q.size()) = step.q;
  const VectorXd way = step.q - step.q_middle;
  for (const Contact& contact : contacts_.all()) {
    const bool is_round =
        contact.normal_column >= 0 && contact.stop == JointStatus::open && !contact.beside;
    if (!is_round || contact.gap == Contact::infinite) continue;
    const double gap = contacts_.gap_at(contact, z, step.to, origin_);
    if (std::abs(gap - gap_after(contact, way)) > off_course * contact.clearance_after)
      return false;
  }
  return true;
}

bool Stepper::advance(double to) {
  Trial step = trial(to);
  const std::optional<Local> local = find(step, false);
  if (!keeps_directions(step)) return false;
  book(step, *local);
  return true;
}

bool Stepper::advance_damped(double to, bool give_up) {
  Trial step = trial(to);
  step.theta = 1.0;
  step.is_definite = true;
  const std::optional<Local> local = find(step, give_up);
  if (!local || !keeps_directions(step)) return false;
  book(step, *local);
  return true;
}

/// Takes the step: memories, energies, statuses.
void Stepper::book(const Trial& step, const Local& local) {
  const double h = step.h;
  check_slides(step, local);
  check_determined(step, local);
  for (Contact& contact : contacts_.all()) {
    if (contact.active) continue;
    contact.normal_force = contact.friction_force = contact.compliance = 0.0;
    contact.elastic_normal = contact.elastic_friction = 0.0;
    contact.rings = {};
  }
  // Speeds by which impulses work.
  const VectorXd through =
      step.differentiates ? VectorXd((step.q - q_) / h) : VectorXd(0.5 * (v_ + step.v));
  const VectorXd along = local.directions.transpose() * through;
  VectorXd speeds;
  if (contacts_.slip_in_part()) speeds = speeds_of_rings(step, local);
  for (std::size_t k = 0; k < local.contacts.size(); ++k) {
    Contact& contact = *local.contacts[k];
    const auto i = static_cast<Eigen::Index>(k);
    const double normal_before = contact.normal_force;
    const double elastic_before = contact.elastic_normal;
    const double stored_before = contact.normal_energy();
    if (contact.normal_column >= 0) {
      contact.normal_force = local.impulses[2 * i] / h;
      contact.elastic_normal = elastic_normal(step, local, i);
    }
    if (!contact.slips_in_part) {
      book_friction(step, local, i, along);
    } else if (!contact.beside) {
      book_rings(step, local, i, speeds, along);
    }
    if (contact.normal_column >= 0) {
      const double growth = contact.clearance_after - contact.clearance;
      const bool rigid = !contact.is_elastic();
      const double force = step.in_mean(normal_before, contact.normal_force, rigid);
      const double elastic_force = step.in_mean(elastic_before, contact.elastic_normal, rigid);
      const double opened = h * along[2 * i] + growth;
      const double dashpot = -(force - elastic_force) * opened;
      account_.damping += dashpot;
      const double heat = -force * opened - dashpot - (contact.normal_energy() - stored_before);
      account_.impact += heat;
      if (rigid) account_.negative += std::min(heat, 0.0);
      account_.thermal_work -= force * growth;
    }
  }
  for (Eigen::Index k = 0; k < drives_.count(); ++k) {
    const Eigen::Index column = holds_.cols() - drives_.count() + k;
    drive_moment_[k] = -hold_scale_ * step.held[column] / h;
    account_.drives -= step.held[column] * holds_.col(column).dot(through);
  }
  if (bodies_->damped()) {
    const double theta = step.differentiates ? 0.5 : step.theta;
    const Bodies::Work work = bodies_->work(q_, v_, step.q, step.v, step.span, theta);
    account_.damping += work.heat;
    account_.thermal_work += work.thermal;
  }
  VectorXd z(z_.size());
  z.head(step.q.size()) = step.q;
  Statuses statuses = origin_.statuses;
  contacts_.write(z, statuses);
  StepStart after = system_->commit(z, step.to, statuses, origin_);
  contacts_.tell_rings(after);
  account_.thermal_work += system_->work_on_elements({z_, time_, z, step.to});
  note_branches();
  contacts_.remember_clearances();
  internal_ = internal_after_;
  q_ = step.q;
  v_ = step.v;
  z_ = std::move(z);
  time_ = step.to;
  origin_ = std::move(after);
}

void Stepper::book_friction(const Trial& step, const Local& local, Eigen::Index i,
                            const VectorXd& along) {
  Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
  const Eigen::Index t = 2 * i + 1;
  const double h = step.h;
  const double friction_before = contact.friction_force;
  const double elastic_before = contact.elastic_friction;
  const double stored_before = contact.tangential_energy();
  const double normal = local.impulses[2 * i] / h;
  const double elastic = elastic_normal(step, local, i);
  contact.friction_force = normal > 0.0 ? -local.impulses[t] / h : 0.0;
  const double compliance = normal > 0.0 ? contact.tangential_compliance(elastic) : 0.0;
  contact.elastic_friction =
      contact.damping > 0.0 && compliance > 0.0
          ? contact.spring_friction(elastic, h * local.directions.col(t).dot(step.v) + contact.slid,
                                    contact.friction_coefficient * normal)
          : contact.friction_force;
  contact.compliance = compliance;
  if (contact.tangential_column < 0) return;
  const bool slides = normal > 0.0 && !contact.sticks(normal, contact.friction_force);
  const double force = step.in_mean(friction_before, contact.friction_force, slides);
  const double spring = step.in_mean(elastic_before, contact.elastic_friction, slides);
  const double dashpot = (force - spring) * h * along[t];
  account_.damping += dashpot;
  const double heat =
      force * h * along[t] - dashpot - (contact.tangential_energy() - stored_before);
  account_.friction[contact.joint] += heat;
  account_.negative += std::min(heat, 0.0);
}

void Stepper::describe(State& state) const {
  system_->describe(z_, time_, origin_, state);
  if (contacts_.damped()) {
    State whole;
    system_->describe(contacts_.with_dashpots(z_), time_, origin_, whole);
    state.joint_output = std::move(whole.joint_output);
  }
  state.thermal_work = account_.thermal_work;
  state.joint_dissipation = account_.friction;
}

void Stepper::fail(FailureKind kind, double when, const Contact* contact) const {
  const Model& model = system_->model();
  FailureFields fields{kind};
  fields.time = when;
  fields.temperature_change = model.temperature_change(0, 1.0, when);
  fields.sought = "no step of the motion";
  if (contact != nullptr) {
    const Joint& joint = model.joints[index(contact->joint)];
    fields.joints.push_back({kind_of(joint), name_of(joint)});
  }
  throw Failure(std::move(fields));
}

}  // namespace statejump::truss::detail
