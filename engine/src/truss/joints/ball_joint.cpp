// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/joints/ball_joint.hpp"

#include <cmath>

#include "truss/joints/ball_rubbing.hpp"
#include "truss/joints/writer.hpp"
#include "truss/parts.hpp"

namespace statejump::truss {

using detail::ball;
using detail::ball_bend;
using detail::ball_far;
using detail::ball_slide;
using detail::ball_variables;
using detail::BallBend;
using detail::BallMemory;
using detail::BallState;
using detail::Dual;
using detail::HertzContact;
using detail::index;
using detail::socket;
using detail::socket_far;
using detail::Vector;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// Cosine of the largest angle by which a contact may move around its socket in one step, 0.5 rad.
/// A larger angle in a step of the shortest length is a jump.
constexpr double most_turned = 0.8775825618903728;

constexpr int first_force = 3 * most_joint_nodes;
constexpr int temperature = ball_variables - 1;

HertzContact contact_of(const BallJoint& joint) {
  return {joint.hertz_stiffness, joint.mindlin_stiffness, joint.radial_clearance};
}

BallState<double> state_of(const BallJoint& joint, const Trial& trial) {
  const Vector3d force =
      trial.frame.axes * Vector3d(trial.force[0], trial.force[1], trial.force[2]);
  return detail::ball_state_at(joint, force, trial);
}

/// State with derivatives with respect to all unknowns.
BallState<Dual> dual_state_of(const BallJoint& joint, const Trial& trial) {
  Vector<Dual> force = Vector<Dual>::Zero();
  for (int k = 0; k < 3; ++k) {
    const Dual one(trial.force[index(k)], ball_variables, first_force + k);
    force += Vector3d(trial.frame.axes.col(k)).cast<Dual>() * one;
  }
  const auto between = [&](std::size_t from, std::size_t to) {
    const Vector3d value = trial.between(from, to);
    Vector<Dual> made;
    for (int k = 0; k < 3; ++k) {
      made[k] = Dual(value[k]);
      made[k].derivatives().setZero();
      made[k].derivatives()[3 * static_cast<int>(to) + k] = 1.0;
      made[k].derivatives()[3 * static_cast<int>(from) + k] = -1.0;
    }
    return made;
  };
  const auto rotation = [&](std::size_t site) {
    const double scale = 1.0 / trial.frame.arms[site];
    Vector<Dual> made;
    for (int k = 0; k < 3; ++k) {
      made[k] = Dual(scale * trial.moved[site][k], ball_variables, 3 * static_cast<int>(site) + k);
      made[k].derivatives() *= scale;
    }
    return made;
  };
  return detail::ball_state<Dual>(joint, force,
                                  Dual(trial.temperature_change, ball_variables, temperature),
                                  trial.opening, between, rotation);
}

/// Slip correction, projected onto the tangent plane [m].
template <class Number>
Vector<Number> across(const Vector<Number>& owed, const BallState<Number>& now) {
  return owed - now.normal * Number(now.normal.dot(owed));
}

/// Elastic predictor of the step, with the slip correction.
template <class Number>
BallBend<Number> bend_of(const BallJoint& joint, const Trial& trial, const BallState<Number>& now) {
  BallBend<Number> bend = ball_bend(joint, now, BallMemory::of(trial.history), trial.softens);
  if (!trial.owed.isZero(0.0)) bend.pull += across<Number>(trial.owed.cast<Number>(), now);
  return bend;
}

/// Forces on the nodes, and the residual.
struct Response {
  std::array<Vector<Dual>, most_joint_nodes> force;
  Vector<Dual> row;  ///< Residual along the axes of the frame.
  std::array<bool, 3> is_balance{false, false, false};
  std::size_t piece = 0;
};

/// Adds a moment on a part to the forces on its link: a couple of transverse forces on both ends.
void add_moment(const Vector<Dual>& moment, const Vector<Dual>& direction, Vector<Dual>& at,
                Vector<Dual>& far) {
  const Vector<Dual> across = moment.cross(direction) / direction.squaredNorm();
  at += across;
  far -= across;
}

kernel::PartialSlipMemory slip_memory(const double* history) {
  return detail::read_partial_slip(history + BallMemory::size, 2);
}

/// Applies the partial-slip law to the step.
/// @param memory on input at the start of the step, on output at its end
kernel::PartialSlipResponse rub(const BallJoint& joint, const Trial& trial, bool open,
                                kernel::PartialSlipMemory& memory) {
  const BallState<double> now = state_of(joint, trial);
  const auto by = detail::ball_rub(now, BallMemory::of(trial.history));
  const double stiffness =
      open ? 0.0 : 1.0 / contact_of(joint).tangential_compliance(now.normal_force).value;
  return kernel::partial_slip_step(stiffness, joint.friction_coefficient * now.normal_force,
                                   {by.along_first, by.along_second}, memory);
}

/// Residual of the tangential law, zero if the joint satisfies its status [m]. In stick it is slide
/// minus elastic deflection; in slip, friction in excess of its limit, times the compliance. The
/// vector lies in the tangent plane.
Vector<Dual> tangential_row(const BallJoint& joint, const Trial& trial, const BallState<Dual>& now,
                            JointStatus status) {
  const BallMemory start = BallMemory::of(trial.history);
  const BallBend<Dual> bend = bend_of(joint, trial, now);
  const Vector<Dual> carries = now.friction * bend.compliance;
  if (trial.model != JointModel::friction || joint.friction_coefficient == 0.0) return -carries;
  if (!is_slip(status) || bend.pull.squaredNorm().value() == 0.0) return bend.pull - carries;
  const Dual bound = joint.friction_coefficient * now.normal_force * bend.compliance;
  // If the trial force is below half of the friction limit, it is doubled instead of scaled to the
  // limit. The direction of a tiny slide is mostly rounding; friction at its limit along this
  // direction would reverse in every iteration.
  if (bend.pull.squaredNorm() < 0.25 * bound * bound) return bend.pull * Dual(2.0) - carries;
  // With dashpots the trial force is only projected onto the cone. Its direction rotates little in
  // a step, and friction must be a smooth function of the slide.
  const bool turns = is_slip(trial.before) && !trial.damps_contact;
  return detail::slip_direction(joint, now, start, bend, turns) * bound - carries;
}

Response respond(const BallJoint& joint, const Trial& trial, JointStatus status) {
  const BallState<Dual> now = dual_state_of(joint, trial);
  Response made;
  made.force.fill(Vector<Dual>::Zero());
  made.force[ball] = now.force;
  made.force[socket] = -now.force;
  const bool open = status == JointStatus::open;
  if (open || trial.model == JointModel::pins) {
    // An open joint has no force. The normal is not used: a ball exactly in the middle has none.
    for (int k = 0; k < 3; ++k) {
      const Vector<Dual> along = Vector3d(trial.frame.axes.col(k)).cast<Dual>();
      made.is_balance[index(k)] = open || !trial.frame.holds[index(k)];
      made.row[k] = along.dot(made.is_balance[index(k)] ? now.force : now.offset);
    }
    return made;
  }
  const Vector<Dual> moment = now.normal.cross(now.friction);
  if (joint.ball_link >= 0) {
    add_moment(moment * now.ball_radius, now.ball_direction, made.force[ball],
               made.force[ball_far]);
  }
  if (joint.socket_link >= 0) {
    add_moment(-moment * now.socket_radius, now.socket_direction, made.force[socket],
               made.force[socket_far]);
  }
  if (now.ball_turns) {
    made.force[ball_far] = detail::moment_on<Dual>(now.ball_direction, moment * now.ball_radius) *
                           Dual(1.0 / trial.frame.arms[ball_far]);
  }
  if (now.socket_turns) {
    made.force[socket_far] =
        detail::moment_on<Dual>(now.socket_direction, -moment * now.socket_radius) *
        Dual(1.0 / trial.frame.arms[socket_far]);
  }
  const Dual depth =
      detail::chain(now.normal_force, contact_of(joint).depth(now.normal_force.value()));
  // The opened fraction of the clearance also scales the depth, so that the start proceeds from
  // pins to contacts in small steps.
  const Dual gap = now.distance - now.clearance - trial.opening * depth;
  Vector<Dual> row = now.normal * gap;
  if (joint.partial_slip && trial.model == JointModel::friction) {
    // In metres: force difference times the compliance of a sticking contact.
    const Dual compliance = detail::chain(
        now.normal_force, contact_of(joint).tangential_compliance(now.normal_force.value()));
    const detail::BallRubbed law = detail::ball_rubbed(joint, now, BallMemory::of(trial.history),
                                                       compliance, slip_memory(trial.history));
    made.piece = law.piece;
    row += (law.friction - now.friction) * compliance;
  } else {
    row += tangential_row(joint, trial, now, status);
  }
  for (int k = 0; k < 3; ++k) {
    made.row[k] = Vector3d(trial.frame.axes.col(k)).cast<Dual>().dot(row);
  }
  return made;
}

/// Slip since the start of the step, along the trial deflection: trial deflection minus elastic
/// deflection. The rate of this value is the slip rate.
Dual slipped(const BallJoint& joint, const Trial& trial) {
  const BallState<Dual> now = dual_state_of(joint, trial);
  const BallBend<Dual> bend = bend_of(joint, trial, now);
  const Dual squared = bend.pull.squaredNorm();
  if (!(squared.value() > 0.0)) return {0.0, Dual::DerType::Zero()};
  const Dual size = sqrt(squared);
  return size - bend.compliance * bend.pull.dot(now.friction) / size;
}

Vector3d gradient(const Dual& of, std::size_t node) {
  return of.derivatives().segment<3>(3 * static_cast<int>(node));
}

}  // namespace

int BallJoint::slip_memory_begin() const {
  return BallMemory::size;
}

int BallJoint::history() const {
  return slip_memory_begin() + (partial_slip ? detail::partial_slip_history(2) : 0);
}

void BallJoint::evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const {
  const Response made = respond(*this, trial, status);
  if (partial_slip) writer.piece(made.piece);
  for (int k = 0; k < 3; ++k) writer.carries(trial.force[index(k)]);
  // Dashpots act where contact forces do not constrain the tangential directions.
  const bool is_open = status == JointStatus::open;
  double slack = 0.0;
  Vector3d slack_by_normal = Vector3d::Zero(), normal = Vector3d::Zero();
  if (trial.slack_stiffness > 0.0 && (is_open || trial.model != JointModel::pins)) {
    const BallState<double> now = state_of(*this, trial);
    slack = is_open ? trial.slack_stiffness : trial.slack_held(now.normal_force, radial_clearance);
    const Vector3d moved = trial.between(socket, ball) - BallMemory::of(trial.history).offset;
    writer.force(ball, slack * moved);
    writer.force(socket, -slack * moved);
    normal = now.normal;
    if (slack > 0.0 && slack < trial.slack_stiffness) slack_by_normal = -moved / radial_clearance;
  }
  for (std::size_t a = 0; a < most_joint_nodes; ++a) {
    const Vector<Dual>& force = made.force[a];
    writer.force(a, {force[0].value(), force[1].value(), force[2].value()});
    const double sense = a == ball ? 1.0 : a == socket ? -1.0 : 0.0;
    for (int k = 0; k < 3; ++k) {
      const Vector3d by_force(force[0].derivatives()[first_force + k],
                              force[1].derivatives()[first_force + k],
                              force[2].derivatives()[first_force + k]);
      const double by_normal = sense * normal.dot(trial.frame.axes.col(k));
      writer.column(a, k, by_force + by_normal * slack_by_normal);
    }
    for (std::size_t b = 0; b < most_joint_nodes; ++b) {
      Matrix3d block;
      for (int i = 0; i < 3; ++i) block.row(i) = gradient(force[i], b);
      const bool both = a <= socket && b <= socket;
      if (both) block.diagonal().array() += a == b ? slack : -slack;
      writer.block(a, b, block);
    }
  }
  for (int k = 0; k < 3; ++k) {
    const Dual row = trial.unslipped && k == slide_row ? slipped(*this, trial) : made.row[k];
    if (made.is_balance[index(k)]) {
      writer.balance(k, row.value());
    } else {
      writer.closure(k, row.value());
    }
    for (std::size_t a = 0; a < most_joint_nodes; ++a) writer.row(k, a, gradient(row, a));
    for (int j = 0; j < 3; ++j) writer.corner(k, j, row.derivatives()[first_force + j]);
  }
}

void BallJoint::warm(const Trial& trial, JointStatus status, double temperature_rate,
                     JointWriter& writer) const {
  if (trial.model == JointModel::pins || status == JointStatus::open) return;
  const Response made = respond(*this, trial, status);
  const auto rate = [&](const Dual& of) {
    return of.derivatives()[temperature] * temperature_rate;
  };
  for (std::size_t a = 0; a < most_joint_nodes; ++a) {
    const Vector<Dual>& force = made.force[a];
    writer.force(a, {rate(force[0]), rate(force[1]), rate(force[2])});
  }
  Vector3d foreseen = Vector3d::Zero();
  if (rolls() && status == JointStatus::stick)
    foreseen = across(trial.owed_rate, state_of(*this, trial));
  for (int k = 0; k < 3; ++k) {
    const Dual row = trial.unslipped && k == slide_row ? slipped(*this, trial) : made.row[k];
    writer.closure(k, rate(row) + trial.frame.axes.col(k).dot(foreseen));
  }
}

Eigen::Vector3d BallJoint::slack_motion(const Trial& trial) const {
  return trial.between(socket, ball) - BallMemory::of(trial.history).offset;
}

JointStatus BallJoint::decide(const Trial& trial, JointStatus status) const {
  if (trial.model == JointModel::pins) return status;
  const BallState<double> now = state_of(*this, trial);
  const double mu = trial.model == JointModel::friction ? friction_coefficient : 0.0;
  if (status == JointStatus::open) {
    if (now.distance <= now.clearance + trial.length_rounding) return status;
    return mu > 0.0 ? JointStatus::stick : JointStatus::slip_plus;
  }
  // A normal force counts as zero if it moves a slack element by at most a thousandth of the play
  // in a step, see System::slack_stiffness().
  const double slack = 1e-3 * trial.slack_stiffness * radial_clearance;
  if (now.normal_force < -trial.force_rounding - slack) return JointStatus::open;
  if (mu == 0.0 || partial_slip) return status;  // slips freely, or one row for stick and slip
  const double bound = mu * (now.normal_force < slack ? slack : now.normal_force);
  if (status == JointStatus::stick) {
    return now.friction.norm() > bound + trial.force_rounding ? JointStatus::slip_plus : status;
  }
  const BallBend<double> bend = bend_of(*this, trial, now);
  const double rounding = slide_rounding(trial, trial.length_rounding, trial.force_rounding);
  // The joint sticks, because Newton's method has reversed the slide relative to friction.
  const double carried = now.friction.norm();
  if (now.normal_force > slack + trial.force_rounding && carried > trial.force_rounding &&
      bend.pull.dot(now.friction) < -rounding * carried) {
    return JointStatus::stick;
  }
  return bend.pull.norm() - bend.compliance * bound < -rounding ? JointStatus::stick : status;
}

void BallJoint::begin(const Trial& trial, JointStatus status, double* now_) const {
  const BallState<double> now = state_of(*this, trial);
  const bool open = status == JointStatus::open;
  const double compliance =
      open ? 0.0 : contact_of(*this).tangential_compliance(now.normal_force).value;
  BallMemory{now.offset,
             now.ball_direction,
             now.socket_direction,
             open ? Vector3d::Zero() : now.friction,
             partial_slip ? detail::any_across(now.normal) : Vector3d::Zero(),
             now.ball_radius,
             now.socket_radius,
             now.normal_force,
             compliance}
      .to(now_);
  if (!partial_slip) return;
  detail::write_partial_slip(
      detail::pressed(open ? 0.0 : 1.0 / compliance, friction_coefficient * now.normal_force),
      now_ + BallMemory::size, 2);
}

void BallJoint::commit(const Trial& trial, JointStatus status, double* after) const {
  begin(trial, status, after);
  if (!partial_slip) return;
  const bool open = status == JointStatus::open;
  kernel::PartialSlipMemory memory = slip_memory(trial.history);
  rub(*this, trial, open, memory);
  detail::write_partial_slip(memory, after + BallMemory::size, 2);
  if (open) return;
  const BallState<double> now = state_of(*this, trial);
  const Vector3d carried = detail::ball_slide(now, BallMemory::of(trial.history)).axis;
  if (carried.isZero(0.0)) return;
  BallMemory end = BallMemory::of(after);
  // Projects the direction onto the tangent plane, because the rounding of many steps would move it
  // out.
  end.axis = (carried - now.normal * now.normal.dot(carried)).normalized();
  end.to(after);
}

bool BallJoint::softens(const Trial& trial) const {
  const double normal = state_of(*this, trial).normal_force;
  return contact_of(*this).tangential_compliance(normal).value >
         BallMemory::of(trial.history).compliance;
}

Vector3d BallJoint::lag(const Trial& trial) const {
  const BallState<double> now = state_of(*this, trial);
  const BallBend<double> bend = bend_of(*this, trial, now);
  return bend.pull - bend.compliance * now.friction;
}

double BallJoint::slip(const Trial& trial, const double* after) const {
  if (BallMemory::of(after).compliance == 0.0) return 0.0;  // open
  if (partial_slip) {
    const BallState<double> now = state_of(*this, trial);
    const BallMemory start = BallMemory::of(trial.history);
    const BallBend<double> bend = ball_bend(*this, now, start);
    const BallMemory end = BallMemory::of(after);
    return (bend.moved.slide + start.compliance * bend.moved.kept - end.compliance * now.friction)
        .norm();
  }
  return lag(trial).norm();
}

double BallJoint::dissipation(const Trial& trial, const double* after_, double slip) const {
  const BallMemory start = BallMemory::of(trial.history);
  const BallMemory after = BallMemory::of(after_);
  if (partial_slip) {
    kernel::PartialSlipMemory memory = slip_memory(trial.history);
    return rub(*this, trial, after.compliance == 0.0, memory).dissipation;
  }
  const Vector3d kept = ball_slide(state_of(*this, trial), start).kept;
  return friction_coefficient * 0.5 * (start.normal_force + after.normal_force) * slip +
         detail::rim_slip(start.friction.squaredNorm(), start.compliance, kept.dot(after.friction),
                          after.friction.squaredNorm(), after.compliance);
}

double BallJoint::elastic_energy(const Trial& trial, const double* now_) const {
  const BallMemory now = BallMemory::of(now_);
  const double bent = partial_slip ? kernel::elastic_energy(slip_memory(now_))
                                   : 0.5 * now.compliance * now.friction.squaredNorm();
  return contact_of(*this).energy(state_of(*this, trial).normal_force) + bent;
}

double BallJoint::contact_force(const Trial& trial) const {
  return state_of(*this, trial).normal_force;
}

void BallJoint::describe(const Trial& trial, double* outputs) const {
  const BallState<double> now = state_of(*this, trial);
  Eigen::Map<Vector3d>(outputs, 3) = now.offset;
  outputs[3] = now.normal_force;
  Eigen::Map<Vector3d>(outputs + 4, 3) = -now.friction;
}

double BallJoint::slide_rounding(const Trial& trial, double length, double force) const {
  const double normal = state_of(*this, trial).normal_force;
  return length + contact_of(*this).tangential_compliance(normal).value * force;
}

bool BallJoint::remembers_when(JointStatus before, JointStatus after) const {
  if (friction_coefficient == 0.0) return false;
  if (before == JointStatus::open) return true;
  return !partial_slip && is_slip(before) && after == JointStatus::stick;
}

JointStatus BallJoint::settled(const Trial& trial, JointStatus status) const {
  if (!partial_slip || status == JointStatus::open) return status;
  const BallState<double> now = state_of(*this, trial);
  const double compliance = contact_of(*this).tangential_compliance(now.normal_force).value;
  const auto by = detail::ball_rub(now, BallMemory::of(trial.history));
  const kernel::PartialSlipPlane law =
      kernel::partial_slip_plane(1.0 / compliance, friction_coefficient * now.normal_force,
                                 {by.along_first, by.along_second}, slip_memory(trial.history));
  return detail::sliding(law, trial.before, trial.length_rounding);
}

Seat BallJoint::seat(const Trial& trial, double opened, double next, double rounding) const {
  Seat seat;
  seat.force = trial.force;
  const BallState<double> now = state_of(*this, trial);
  // The ball makes contact in the direction of its pin force.
  const double pushes = now.force.norm();
  seat.touches = opened > 0.0 || pushes > rounding;
  if (!seat.touches) return seat;
  const Vector3d normal = opened > 0.0 ? now.normal : Vector3d(now.force / pushes);
  seat.moved = (next - opened) * radial_clearance * normal;
  return seat;
}

bool BallJoint::jumps(const Trial& trial, JointStatus status) const {
  if (trial.before == JointStatus::open || status == JointStatus::open) return false;
  const BallMemory start = BallMemory::of(trial.history);
  const Vector3d normal = state_of(*this, trial).normal;
  return normal.dot(start.offset.normalized()) < most_turned;
}

}  // namespace statejump::truss
