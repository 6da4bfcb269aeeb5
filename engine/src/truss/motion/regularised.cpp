// SPDX-License-Identifier: GPL-3.0-or-later
// A truss in motion as an ordinary differential equation, with the contact laws of a DEM.
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "bodies.hpp"
#include "kernel_contacts.hpp"
#include "start_of_motion.hpp"
#include "statejump/failure.hpp"
#include "statejump/kernel/require.hpp"
#include "statejump/truss/motion.hpp"

namespace statejump::truss {

namespace {

using detail::index;
using detail::KernelContacts;
using detail::Statuses;
using Eigen::VectorXd;

/// Stability limit of the classical Runge–Kutta method: largest (ω h)², with ω h = 2 √2.
constexpr double largest_turn_squared = 8.0;
/// The mass matrix counts as diagonal if the ratio of off-diagonal entries to diagonal entries is
/// at most this.
constexpr double orthogonal = 1e-12;

void check(const Model& model, const MotionOptions& options) {
  detail::check_motion(model, options);
  kernel::require(model.beams.empty(), "count of beams in explicit steps",
                  static_cast<double>(model.beams.size()), "0");
  kernel::require(options.displacement_tolerance == 0.0, "displacement_tolerance",
                  options.displacement_tolerance, "0 m with the scheme 'regularised'");
  kernel::require(options.restitution == 0.0, "restitution", options.restitution,
                  "0 with the scheme 'regularised'");
  kernel::require(options.drives.empty(), "count of drives",
                  static_cast<double>(options.drives.size()), "0 with the scheme 'regularised'");
}

/// A motion in progress.
class Run {
 public:
  Run(const Model& model, const Inertia& inertia, const std::string& friction_law,
      const MotionOptions& options)
      : model_(model),
        options_(options),
        duration_(model.programs.front().duration()),
        system_(model),
        bodies_(system_, inertia),
        contacts_(system_, inertia.joint_damping, friction_law),
        forces_(Assembly::without_jacobian(system_.unknowns())),
        statuses_(system_.all_stick()) {
    const auto joints = static_cast<Eigen::Index>(model.joints.size());
    heat_.friction = VectorXd::Zero(joints);
    const VectorXd mass = bodies_.mass().diagonal();
    for (Eigen::Index i = 0; i < mass.size(); ++i) {
      const Node& node = model.nodes[index(system_.node_of(static_cast<int>(i)))];
      if (mass[i] > 0.0) continue;
      throw kernel::OutOfRange("node '" + node.name + "'", "mass", mass[i], "> 0 kg");
    }
    inverse_mass_ = mass.cwiseInverse();
    const double beside =
        Eigen::SparseMatrix<double>(bodies_.mass() - Eigen::SparseMatrix<double>(mass.asDiagonal()))
            .norm();
    kernel::require(beside <= orthogonal * mass.norm(), "mass beside the diagonal", beside,
                    "none with the scheme 'regularised': masses are lumped");
  }

  Motion make() &&;

 private:
  /// Rates of positions, velocities and slides in a stage.
  struct Rates {
    VectorXd velocity;
    VectorXd acceleration;
    VectorXd way;
  };
  bool begin();
  void advance(double to);
  Rates rates(const KernelContacts::Stage& stage, const detail::Bodies::Step& span);
  void commit(const KernelContacts::Stage& stage);
  /// Forces of links, springs and loads [N].
  VectorXd elastic_force(const VectorXd& q, double time);
  /// Dashpot forces of links, springs and pins [N].
  VectorXd dashpots(const VectorXd& q, const VectorXd& v, const detail::Bodies::Step& span) const {
    return bodies_.damped() ? bodies_.force(q, v, span) : VectorXd::Zero(q.size());
  }
  VectorXd with_forces() const;
  void sample();
  void note(long step);
  [[noreturn]] void fail(FailureKind kind, double when, const std::string& cause) const;

  const Model& model_;
  const MotionOptions& options_;
  const double duration_;  // [s]
  const detail::System system_;
  const detail::Bodies bodies_;
  KernelContacts contacts_;
  Assembly forces_;
  VectorXd inverse_mass_;  // [1/kg]
  VectorXd q_;
  VectorXd v_;
  double time_ = 0.0;
  Rates now_;  // at the end of the last step, without dashpots, whose forces jump at a corner of a
               // program
  detail::KernelHeat heat_;
  double thermal_work_ = 0.0;  // of the links
  double damping_ = 0.0;       // of links, springs and pins
  Statuses statuses_;
  Motion motion_;
};

VectorXd Run::elastic_force(const VectorXd& q, double time) {
  VectorXd z = VectorXd::Zero(system_.unknowns());
  z.head(q.size()) = q;
  system_.evaluate_elements(z, time, forces_);
  return -forces_.residual.head(q.size());
}

Run::Rates Run::rates(const KernelContacts::Stage& stage, const detail::Bodies::Step& span) {
  Rates found{stage.v, elastic_force(stage.q, stage.time) + dashpots(stage.q, stage.v, span),
              VectorXd::Zero(contacts_.numbers())};
  contacts_.respond(stage, found.acceleration, found.way);
  found.acceleration = found.acceleration.cwiseProduct(inverse_mass_);
  return found;
}

void Run::commit(const KernelContacts::Stage& stage) {
  now_.velocity = stage.v;
  now_.acceleration = elastic_force(stage.q, stage.time);
  now_.way = VectorXd::Zero(contacts_.numbers());
  contacts_.commit(stage, now_.acceleration, now_.way, heat_);
  now_.acceleration = now_.acceleration.cwiseProduct(inverse_mass_);
}

/// Takes a classical fourth-order Runge–Kutta step. All stages evaluate contacts with their memory
/// at the start of the step. The memory is updated once, at the end of the step.
void Run::advance(double to) {
  const double h = to - time_;
  const detail::Bodies::Step span = bodies_.step(time_, to);
  Rates first = now_;
  first.acceleration += dashpots(q_, v_, span).cwiseProduct(inverse_mass_);
  const auto stage = [&](const Rates& from, double share) {
    const VectorXd q = q_ + share * h * from.velocity;
    const VectorXd v = v_ + share * h * from.acceleration;
    const VectorXd way = share * h * from.way;
    return rates({q, v, time_ + share * h, share * h, way}, span);
  };
  const Rates second = stage(first, 0.5);
  const Rates third = stage(second, 0.5);
  const Rates fourth = stage(third, 1.0);
  const auto mean = [&](VectorXd Rates::*of) -> VectorXd {
    return h / 6.0 * (first.*of + 2.0 * second.*of + 2.0 * third.*of + fourth.*of);
  };
  const VectorXd q = q_ + mean(&Rates::velocity);
  const VectorXd v = v_ + mean(&Rates::acceleration);
  const VectorXd way = mean(&Rates::way);
  if (!q.allFinite() || !v.allFinite()) fail(FailureKind::not_finite, to, "");
  if (bodies_.damped()) {
    const detail::Bodies::Work work = bodies_.work(q_, v_, q, v, span, 0.5);
    damping_ += work.heat;
    thermal_work_ += work.thermal;
  }
  VectorXd from = VectorXd::Zero(system_.unknowns());
  VectorXd end = from;
  from.head(q.size()) = q_;
  end.head(q.size()) = q;
  thermal_work_ += system_.work_on_elements({from, time_, end, to});
  commit({q, v, to, h, way});
  q_ = q;
  v_ = v;
  time_ = to;
  if (contacts_.stiffest(q_, inverse_mass_) * h * h > largest_turn_squared) ++motion_.inexact_steps;
}

void Run::fail(FailureKind kind, double when, const std::string& cause) const {
  FailureFields fields{kind};
  fields.time = when;
  fields.temperature_change = model_.temperature_change(0, 1.0, when);
  fields.cause = cause;
  throw Failure(std::move(fields));
}

VectorXd Run::with_forces() const {
  VectorXd z = VectorXd::Zero(system_.unknowns());
  z.head(q_.size()) = q_;
  Statuses statuses = statuses_;
  contacts_.write(z, statuses);
  return z;
}

void Run::sample() {
  const VectorXd z = with_forces();
  State state;
  system_.describe(z, time_, system_.begin(z, time_, statuses_, 1.0), state);
  // The contact laws determine the energy stored by contacts.
  VectorXd unloaded = VectorXd::Zero(system_.unknowns());
  unloaded.head(q_.size()) = q_;
  State bars;
  system_.describe(unloaded, time_, system_.begin(unloaded, time_, statuses_, 1.0), bars);
  state.elastic_energy = bars.elastic_energy + contacts_.stored();
  state.thermal_work = thermal_work_ + heat_.thermal_work;
  state.joint_dissipation = heat_.friction;
  motion_.states.push_back(std::move(state));
  motion_.moving.push_back({bodies_.of_nodes(v_), 0.5 * v_.dot(bodies_.mass() * v_),
                            damping_ + heat_.damping, 0.0, 0.0, VectorXd::Zero(0)});
}

void Run::note(long step) {
  if (options_.watched_node >= 0) {
    motion_.watched_velocity.col(step) = system_.displacement(options_.watched_node, v_);
  }
}

bool Run::begin() {
  VectorXd way = VectorXd::Zero(contacts_.numbers());
  if (options_.start) {
    q_ = bodies_.free_part(options_.start->displacement);
    v_ = bodies_.free_part(options_.start->velocity);
  } else {
    const std::optional<State> start = detail::equilibrium(model_, options_);
    if (!start) return false;
    q_ = bodies_.free_part(start->displacement);
    v_ = VectorXd::Zero(q_.size());
    way = contacts_.start_way(*start, options_.start_friction);
  }
  const double h = duration_ / static_cast<double>(options_.steps);
  // The normal force acts first, then friction, because partial slip depends on the order.
  commit({q_, v_, 0.0, h, VectorXd::Zero(contacts_.numbers())});
  if (!way.isZero(0.0)) commit({q_, v_, 0.0, h, way});
  heat_.friction.setZero();
  heat_.damping = heat_.thermal_work = 0.0;
  VectorXd z = VectorXd::Zero(system_.unknowns());
  contacts_.write(z, statuses_);
  return true;
}

Motion Run::make() && {
  motion_.unknowns = system_.displacements();
  motion_.time_step = duration_ / static_cast<double>(options_.steps);
  if (!begin()) {
    motion_.complete = false;
    return std::move(motion_);
  }
  if (options_.watched_node >= 0) motion_.watched_velocity.resize(3, options_.steps + 1);
  sample();
  note(0);
  VectorXd z = VectorXd::Zero(system_.unknowns());
  for (long k = 1; k <= options_.steps && motion_.complete; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(options_.steps);
    const double heat = heat_.friction.sum();
    const Statuses before = statuses_;
    try {
      advance(duration_ * share);
    } catch (const std::domain_error& left) {
      fail(FailureKind::law_left_range, duration_ * share, left.what());
    }
    ++motion_.steps;
    contacts_.write(z, statuses_);
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (before[i] == statuses_[i]) continue;
      motion_.events.push_back({time_, motion_.time_step, model_.temperature_change(0, 1.0, time_),
                                static_cast<int>(i), before[i], statuses_[i]});
      motion_.event_heat.push_back(heat_.friction.sum() - heat);
    }
    note(k);
    if (k == options_.steps || k % options_.sample_every == 0) sample();
    motion_.complete = !options_.progress || options_.progress(share) || share == 1.0;
  }
  return std::move(motion_);
}

}  // namespace

Motion simulate_regularised(const Model& model, const Inertia& inertia,
                            const std::string& friction_law, const MotionOptions& options) {
  check(model, options);
  return Run(model, inertia, friction_law, options).make();
}

}  // namespace statejump::truss
