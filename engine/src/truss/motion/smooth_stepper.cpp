// SPDX-License-Identifier: GPL-3.0-or-later
#include "smooth_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace statejump::truss::detail {

namespace {

/// Largest number of contacts for SmoothStepper. Every status change ends a step of the whole
/// truss, so the cost grows with the square of their number. For more contacts, steps with many
/// changes are cheaper.
constexpr std::size_t most_contacts = 200;
constexpr int most_iterations = 8;
/// New tangents are computed if a correction exceeds this fraction of the previous correction.
constexpr double falls_to = 0.3;
/// Tolerated iteration error of the stages, divided by the displacement tolerance. It is small
/// relative to the error of the step, a difference of stages.
constexpr double share_of_iteration = 1e-3;
/// Safety factor for the measured convergence rate, and number of steps until the rate is measured
/// again.
constexpr double caution = 10.0;
constexpr int most_trusted = 10;
/// Status changes closer than this fraction of a step are simultaneous. Those of equal contacts
/// differ by rounding.
constexpr double at_once = 1e-6;
/// A status may change early if the missing force divided by Coulomb's limit is at most this. The
/// error of the force is equally large until the force has grown by it.
constexpr double early = 1e-6;

}  // namespace

std::unique_ptr<SmoothStepper> SmoothStepper::of(const System& system, const Bodies& bodies,
                                                 const Inertia& inertia,
                                                 const MotionOptions& options, int stages) {
  if (element_count(system.model()) != system.model().links.size()) return {};
  const Contacts contacts(system, bodies.joint_damping());
  if (!contacts.holds().empty() || !contacts.turning_holds().empty()) return {};
  if (!options.drives.empty() || contacts.slip_in_part()) return {};
  std::optional<std::vector<FrictionElement>> found = friction_elements(system, contacts);
  if (!found || found->empty() || found->size() > most_contacts) return {};
  std::unique_ptr<SmoothStepper> made(
      new SmoothStepper(system, bodies, inertia, options, std::move(*found), stages));
  if (!made->mass_factor_.factorize(bodies.mass())) return {};
  return made;
}

SmoothStepper::SmoothStepper(const System& system, const Bodies& bodies, const Inertia& inertia,
                             const MotionOptions& options, std::vector<FrictionElement> elements,
                             int stages)
    : system_(&system),
      bodies_(&bodies),
      options_(&options),
      radau_(stages),
      contacts_(system, bodies.joint_damping()),
      friction_elements_(std::move(elements)),
      bars_(system.assembly(System::Parts::elements)),
      rods_(system, inertia),
      pair_factors_(radau_.pairs.size()),
      z_(VectorXd::Zero(system.unknowns())) {
  account_.friction = VectorXd::Zero(static_cast<Eigen::Index>(system.model().joints.size()));
  loads_ = VectorXd::Zero(system.displacements());
  int loaded = 0;
  for (const Node& node : system.model().nodes)
    system.dofs().add_force(loaded++, node.load, loads_);
  for (const thermal::Program& program : system.model().programs) {
    for (const thermal::Branch& branch : thermal::monotone_branches(program)) {
      corners_.push_back(branch.end_time);
    }
  }
  std::sort(corners_.begin(), corners_.end());
  level_.resize(friction_elements_.size());
  grace_.resize(friction_elements_.size());
}

void SmoothStepper::begin(const VectorXd& q, const VectorXd& v, const State* equilibrium) {
  const Eigen::Index n = q.size();
  q_ = q;
  v_ = v;
  z_.head(n) = q;
  statuses_ = system_->all_stick();
  origin_ = system_->begin(z_, 0.0, statuses_, 1.0);
  if (equilibrium != nullptr) contacts_.begin(*equilibrium, options_->start_friction);
  // Directions of the contacts, which are constant.
  Assembly joints = system_->assembly(System::Parts::joints);
  system_->evaluate_joints(z_, 0.0, origin_, statuses_, joints);
  const linear::SparseView jacobian = joints.jacobian();
  for (std::size_t k = 0; k < friction_elements_.size(); ++k) {
    FrictionElement& one = friction_elements_[k];
    one.elastic = contacts_.all()[k].elastic_friction;
    one.count = 0;
    for (linear::SparseView::InnerIterator it(jacobian, one.column); it; ++it) {
      if (it.row() >= n || it.value() == 0.0) continue;
      one.rows[one.count] = static_cast<int>(it.row());
      one.along[one.count++] = it.value();
    }
    if (std::abs(one.elastic) >= one.bound) one.turn(0.0, 0.0);
  }
  make_pattern(bodies_->damping(q));
  write();
  origin_ = system_->begin(z_, 0.0, statuses_, 1.0);
  start_from_here(true);
}

void SmoothStepper::force(const Rods::ConstColumn& q, const Rods::ConstColumn& v, double time,
                          VectorXd& to) {
  to = loads_;
  rods_.add_force(q, v, heat_at(time), to);
  for (std::size_t k = 0; k < friction_elements_.size(); ++k) {
    const FrictionElement& one = friction_elements_[k];
    const double pull = one.force(slide(k, q), one.seen(v));
    for (std::size_t i = 0; i < one.count; ++i) to[one.rows[i]] -= pull * one.along[i];
  }
}

const Rods::Heat& SmoothStepper::heat_at(double time) {
  // Rates just before a corner, because steps end there.
  const double within = std::min(time, std::nextafter(smooth_until_, 0.0));
  heat_.change.clear();
  heat_.rate.clear();
  for (const thermal::Program& program : system_->model().programs) {
    heat_.change.push_back(program.temperature_change(time));
    heat_.rate.push_back(program.temperature_rate(within));
  }
  return heat_;
}

void SmoothStepper::start_from_here(bool anew) {
  smooth_until_ = std::numeric_limits<double>::infinity();
  const auto next = std::upper_bound(corners_.begin(), corners_.end(), time_);
  if (next != corners_.end()) smooth_until_ = *next;
  slide_from_.resize(static_cast<Eigen::Index>(friction_elements_.size()));
  for (std::size_t k = 0; k < friction_elements_.size(); ++k) {
    slide_from_[static_cast<Eigen::Index>(k)] = friction_elements_[k].seen(q_);
  }
  tangents_are_new_ = false;
  if (!anew) return;
  force(q_, v_, time_, now_);
  a_ = mass_factor_.solve(now_);
}

std::optional<double> SmoothStepper::attempt(double to) {
  to_ = to;
  first_change_.reset();
  const double h = to_ - time_;
  for (std::size_t k = 0; k < friction_elements_.size(); ++k) {
    level_[k] =
        std::min(friction_elements_[k].margin(0.0, friction_elements_[k].seen(v_), h), 0.0) -
        grace_[k];
  }
  // Equal step lengths differ by rounding of times.
  while (std::abs(factor_h_ - h) > 1e-9 * h ? !factorize(h) || !solve_stages() : !solve_stages()) {
    if (tangents_are_new_) return {};
    renew_tangents();
  }
  find_change();
  return error();
}

bool SmoothStepper::solve_stages() {
  const Eigen::Index stages = radau_.c.size();
  const double h = to_ - time_;
  stage_v_ = v_.replicate(1, stages);
  Eigen::MatrixXd residual(v_.size(), stages);
  const double enough = share_of_iteration * options_->displacement_tolerance;
  const bool measures = trusted_ == 0 || trusted_ > most_trusted;
  double last = 0.0;
  for (int k = 0;; ++k) {
    stage_q_ = q_.replicate(1, stages) + h * stage_v_ * radau_.a.transpose();
    residual = -(bodies_->mass() * ((stage_v_.colwise() - v_) * radau_.inverse.transpose()));
    for (Eigen::Index i = 0; i < stages; ++i) {
      force(stage_q_.col(i), stage_v_.col(i), time_of(i), now_);
      residual.col(i) += h * now_;
    }
    const double size = h * correct(residual);
    if (!std::isfinite(size)) return false;
    // Corrections below rounding of the positions are not needed.
    const double rounding =
        4.0 * std::numeric_limits<double>::epsilon() * stage_q_.cwiseAbs().maxCoeff();
    if (k > 0 && last > rounding) {
      contraction_ = std::max(size, rounding) / last;
      trusted_ = 1;
      if (size > rounding && contraction_ > falls_to) return false;
    }
    last = size;
    // The measured convergence rate estimates the remaining error.
    if (size <= rounding) break;
    if ((k > 0 || !measures) && caution * contraction_ * size <= enough) break;
    if (k == most_iterations) return false;
  }
  ++trusted_;
  stage_q_ = q_.replicate(1, stages) + h * stage_v_ * radau_.a.transpose();
  stage_a_ = (stage_v_.colwise() - v_) * radau_.inverse.transpose() / h;
  return true;
}

double SmoothStepper::correct(const Eigen::MatrixXd& residual) {
  const VectorXd real = factor_.solve(residual * (radau_.to_mode / radau_.eigenvalue).transpose());
  Eigen::MatrixXd change = real * radau_.from_mode.transpose();
  for (std::size_t k = 0; k < radau_.pairs.size(); ++k) {
    const Radau::Pair& pair = radau_.pairs[k];
    Eigen::VectorXcd mode = residual * (pair.to_mode / pair.eigenvalue).transpose();
    pair_factors_[k].solve(mode);
    change += 2.0 * (mode * pair.from_mode.transpose()).real();
  }
  stage_v_ += change;
  return change.cwiseAbs().maxCoeff();
}

double SmoothStepper::error() {
  const double g = (to_ - time_) / radau_.eigenvalue;
  const VectorXd place = g * v_ + (stage_q_.colwise() - q_) * radau_.embedded;
  const VectorXd speed = g * a_ + (stage_v_.colwise() - v_) * radau_.embedded;
  // The estimate is filtered with the iteration matrix, so that stiff components are damped [Hairer
  // and Wanner].
  const VectorXd filtered = factor_.solve(bodies_->mass() * speed - g * (stiffness_ * place));
  return (place + g * filtered).cwiseAbs().maxCoeff();
}

void SmoothStepper::find_change() {
  const Eigen::Index stages = radau_.c.size();
  const double h = to_ - time_;
  double first = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, std::size_t>> ends;
  for (std::size_t k = 0; k < friction_elements_.size(); ++k) {
    const FrictionElement& one = friction_elements_[k];
    const auto speed = [&](Eigen::Index i) { return one.seen(stage_v_.col(i)); };
    const auto slid = [&](Eigen::Index i) { return slide(k, stage_q_.col(i)); };
    bool suspect = false;
    for (Eigen::Index i = 0; i < stages && !suspect; ++i) {
      suspect = one.has_ended(slid(i), speed(i), h, level_[k]);
    }
    if (!suspect) continue;
    SlipTrajectory way;
    way.add(0.0, 0.0, one.seen(v_));
    for (Eigen::Index i = 0; i < stages; ++i) way.add(radau_.c[i] * h, slid(i), speed(i));
    const std::optional<double> when = end_of_status(one, way, h, level_[k]);
    if (!when) continue;
    ends.emplace_back(*when, k);
    first = std::min(first, *when);
  }
  if (ends.empty()) return;
  first_change_ = std::min(time_ + first, to_);
  to_turn_.clear();
  for (const auto& [when, k] : ends) {
    if (when == first) first_to_turn_ = k;
    if (when <= first + at_once * h) to_turn_.push_back(k);
  }
}

void SmoothStepper::accept() {
  book();
  const Eigen::Index last = radau_.c.size() - 1;
  for (std::size_t k = 0; k < friction_elements_.size(); ++k) {
    FrictionElement& one = friction_elements_[k];
    one.elastic = one.spring(slide(k, stage_q_.col(last)));
  }
  const bool corner = to_ == smooth_until_;
  q_ = stage_q_.col(last);
  v_ = stage_v_.col(last);
  a_ = stage_a_.col(last);
  time_ = to_;
  start_from_here(corner);
  for (std::size_t k = 0; k < friction_elements_.size(); ++k) {
    if (friction_elements_[k].margin(0.0, friction_elements_[k].seen(v_), 0.0) >= 0.0)
      grace_[k] = 0.0;
  }
}

int SmoothStepper::turn() {
  std::vector<std::size_t> due;
  for (const std::size_t k : to_turn_) {
    const FrictionElement& one = friction_elements_[k];
    const double speed = one.seen(v_);
    const double rise = one.seen(a_);
    if (one.margin_rate(0.0, speed, rise) < 0.0 &&
        one.shortfall(0.0, speed, rise) <= early * one.bound) {
      due.push_back(k);
    }
  }
  to_turn_.clear();
  if (due.empty()) return 0;
  write();
  origin_ = system_->commit(z_, time_, statuses_, origin_);
  for (const std::size_t k : due) {
    FrictionElement& one = friction_elements_[k];
    const double speed = one.seen(v_);
    grace_[k] = 2.0 * std::max(one.shortfall(0.0, speed, one.seen(a_)), 0.0);
    one.turn(0.0, speed);
    // Without a dashpot the spring is at its limit.
    if (one.status != FrictionElement::Status::stick && one.damping == 0.0) {
      const double at_bound = one.sign() * one.bound;
      account_.friction[one.joint] -=
          0.5 * (at_bound * at_bound - one.elastic * one.elastic) / one.stiffness;
      one.elastic = at_bound;
    }
  }
  factor_h_ = 0.0;
  add_contacts();
  write();
  start_from_here(true);
  return static_cast<int>(due.size());
}

void SmoothStepper::book() {
  const Eigen::Index stages = radau_.c.size();
  const double h = to_ - time_;
  const auto weight = [&](Eigen::Index i) { return h * radau_.a(stages - 1, i); };
  for (Eigen::Index i = 0; i < stages; ++i) {
    const Rods::Power now = rods_.power(stage_q_.col(i), stage_v_.col(i), heat_at(time_of(i)));
    account_.damping += weight(i) * now.heat;
    account_.thermal_work += weight(i) * now.thermal;
  }
  for (std::size_t k = 0; k < friction_elements_.size(); ++k) {
    const FrictionElement& one = friction_elements_[k];
    if (one.status == FrictionElement::Status::stick) {
      if (one.damping == 0.0) continue;
      for (Eigen::Index i = 0; i < stages; ++i) {
        account_.damping += weight(i) * one.damping * std::pow(one.seen(stage_v_.col(i)), 2);
      }
    } else {
      // The spring deflects until its force is at the limit; the dashpot dissipates the difference
      // to the limit.
      const double slid = slide(k, stage_q_.col(stages - 1));
      const double elastic = one.spring(slid);
      const double bent = (elastic - one.elastic) / one.stiffness;
      account_.friction[one.joint] += one.sign() * one.bound * (slid - bent);
      account_.damping += (one.sign() * one.bound - 0.5 * (elastic + one.elastic)) * bent;
    }
  }
}

void SmoothStepper::write() {
  const Eigen::Index displacements = system_->displacements();
  z_.head(displacements) = q_;
  z_.tail(z_.size() - displacements).setZero();
  statuses_ = system_->all_stick();
  for (const FrictionElement& one : friction_elements_) {
    z_[one.column] += one.elastic;
    if (one.status == FrictionElement::Status::stick) continue;
    // A joint slips if any of its contacts does.
    statuses_[index(one.joint)] = one.status == FrictionElement::Status::slip_plus
                                      ? JointStatus::slip_plus
                                      : JointStatus::slip_minus;
  }
}

void SmoothStepper::describe(State& state) {
  write();
  origin_ = system_->commit(z_, time_, statuses_, origin_);
  system_->describe(z_, time_, origin_, state);
  if (contacts_.damped()) {
    VectorXd whole = z_;
    for (const FrictionElement& one : friction_elements_) {
      whole[one.column] += one.force(0.0, one.seen(v_)) - one.elastic;
    }
    State with;
    system_->describe(whole, time_, origin_, with);
    state.joint_output = std::move(with.joint_output);
  }
  state.thermal_work = account_.thermal_work;
  state.joint_dissipation = account_.friction;
}

}  // namespace statejump::truss::detail
