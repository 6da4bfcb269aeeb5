// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/joints/pad.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "statejump/kernel/require.hpp"
#include "statejump/truss/model.hpp"
#include "truss/joints/writer.hpp"
#include "truss/parts.hpp"

namespace statejump::truss {

using detail::index;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr std::size_t node = 0, plane = 1;
constexpr int along_normal = 2;  ///< Row and force of the normal.

/// What a pad remembers of the end of a step.
struct Memory {
  Vector3d moved;     ///< u along the axes [m].
  Vector2d friction;  ///< t [N].
  double pressed;     ///< λ [N].

  static constexpr int size = 6;
  static Memory of(const double* from) {
    return {Eigen::Map<const Vector3d>(from), Eigen::Map<const Vector2d>(from + 3), from[5]};
  }
  void to(double* target) const {
    Eigen::Map<Vector3d>(target, 3) = moved;
    Eigen::Map<Vector2d>(target + 3, 2) = friction;
    target[5] = pressed;
  }
};

/// A pad in a trial state.
struct State {
  Vector3d moved;     ///< u along the axes [m].
  Vector2d friction;  ///< t [N].
  double pressed;     ///< λ [N].
  Vector2d pull;      ///< t₀/k_t − Δs, the deflection if the pad sticks [m].
};

State state_of(const Pad& pad, const Trial& trial) {
  State made;
  made.moved = trial.frame.axes.transpose() * (trial.moved[node] - trial.moved[plane]);
  // The unknowns are the forces of the node on the pad.
  made.friction = {-trial.force[0], -trial.force[1]};
  made.pressed = -trial.force[2];
  const Memory start = Memory::of(trial.history);
  made.pull =
      start.friction / pad.tangential_stiffness - (made.moved.head<2>() - start.moved.head<2>());
  return made;
}

/// Rows of a pad with their derivatives by u and by the unknowns, along the axes.
struct Rows {
  Vector3d value = Vector3d::Zero();
  Matrix3d by_moved = Matrix3d::Zero();
  Matrix3d by_force = Matrix3d::Zero();
  std::array<bool, 3> is_balance{false, false, false};
};

Rows rows_of(const Pad& pad, const Trial& trial, JointStatus status, const State& now) {
  Rows made;
  const bool open = status == JointStatus::open;
  if (open || trial.model == JointModel::pins) {
    for (int k = 0; k < 3; ++k) {
      made.is_balance[index(k)] = open || !trial.frame.holds[index(k)];
      if (made.is_balance[index(k)]) {
        made.value[k] = trial.force[index(k)];
        made.by_force(k, k) = 1.0;
      } else {
        made.value[k] = now.moved[k];
        made.by_moved(k, k) = 1.0;
      }
    }
    return made;
  }
  const double compliance = 1.0 / pad.tangential_stiffness;
  // The opened fraction of the clearance also scales the depth, so that the start proceeds from
  // pins to contacts in small steps.
  made.value[along_normal] = now.moved[along_normal] +
                             trial.opening * (pad.clearance + now.pressed / pad.normal_stiffness);
  made.by_moved(along_normal, along_normal) = 1.0;
  made.by_force(along_normal, along_normal) = -trial.opening / pad.normal_stiffness;
  made.value.head<2>() = compliance * now.friction;
  made.by_force.topLeftCorner<2, 2>() = -compliance * Matrix2d::Identity();
  if (trial.model != JointModel::friction || pad.friction_coefficient == 0.0) return made;
  const double size = now.pull.norm();
  if (!is_slip(status) || size == 0.0) {
    made.value.head<2>() -= now.pull;
    made.by_moved.topLeftCorner<2, 2>() = Matrix2d::Identity();
    return made;
  }
  const double bound = pad.friction_coefficient * now.pressed * compliance;
  // If the trial force is below half of the friction limit, it is doubled instead of scaled to the
  // limit, as in a ball joint: the direction of a tiny slide is mostly rounding.
  if (size < 0.5 * bound) {
    made.value.head<2>() -= 2.0 * now.pull;
    made.by_moved.topLeftCorner<2, 2>() = 2.0 * Matrix2d::Identity();
    return made;
  }
  const Vector2d direction = now.pull / size;
  made.value.head<2>() -= bound * direction;
  made.by_moved.topLeftCorner<2, 2>() =
      bound / size * (Matrix2d::Identity() - direction * direction.transpose());
  made.by_force.block<2, 1>(0, along_normal) = pad.friction_coefficient * compliance * direction;
  return made;
}

/// Replaces the slide row by the slip since the start of the step along the trial deflection. Its
/// rate is the slip rate.
void set_slipped(const Pad& pad, const State& now, Rows& rows) {
  rows.value[Pad::slide_row] = 0.0;
  rows.by_moved.row(Pad::slide_row).setZero();
  rows.by_force.row(Pad::slide_row).setZero();
  rows.is_balance[Pad::slide_row] = false;
  const double size = now.pull.norm();
  if (size == 0.0) return;
  const double compliance = 1.0 / pad.tangential_stiffness;
  const Vector2d direction = now.pull / size;
  const double along = direction.dot(now.friction);
  rows.value[Pad::slide_row] = size - compliance * along;
  const Vector2d by_pull = direction - compliance / size * (now.friction - along * direction);
  rows.by_moved.block<1, 2>(Pad::slide_row, 0) = -by_pull.transpose();
  rows.by_force.block<1, 2>(Pad::slide_row, 0) = compliance * direction.transpose();
}

}  // namespace

std::span<const Parameter<Pad>> Pad::parameters() {
  static const Parameter<Pad> table[] = {
      {"nodes", "node", "-", Allowed::node, "the case's nodes", &Pad::first, 0, 2},
      {"nodes", "node of the plane", "-", Allowed::node_or_ground, "the case's nodes", &Pad::second,
       1, 2},
      {"normal", "normal", "-", Allowed::direction, "the case", &Pad::normal},
      {"clearance_m", "clearance", "m", Allowed::not_negative, "the case: c", &Pad::clearance},
      {"normal_stiffness_N_per_m", "normal_stiffness", "N/m", Allowed::positive, "the case: k_n",
       &Pad::normal_stiffness},
      {"tangential_stiffness_N_per_m", "tangential_stiffness", "N/m", Allowed::positive,
       "the case: k_t", &Pad::tangential_stiffness},
      {"friction_coefficient", "friction_coefficient", "-", Allowed::not_negative, "the case: μ",
       &Pad::friction_coefficient},
  };
  return table;
}

std::span<const Output> Pad::outputs() {
  static const Output table[] = {
      {"pad_offset_m", 3}, {"pad_normal_force_N", 1}, {"pad_friction_N", 3}};
  return table;
}

int Pad::history() const {
  return Memory::size;
}

void Pad::validate(const Model&) const {
  if (second == first) {
    throw kernel::OutOfRange("pad '" + name + "'", "node of the plane", second,
                             "another than its node");
  }
}

JointFrame Pad::frame(const Model& model) const {
  JointFrame frame;
  frame.nodes = {first, second, -1, -1};
  frame.node_count = 2;
  frame.forces = 3;
  // If supports prevent a motion in the plane, its direction becomes an axis: pins have no row
  // along it.
  const detail::Matrix32 across = detail::plane_of(normal);
  Matrix2d free = Matrix2d::Zero();
  for (const int at : {first, second}) {
    for (int k = 0; at >= 0 && k < model.nodes[index(at)].freedoms; ++k) {
      const Vector2d along = across.transpose() * model.nodes[index(at)].free_directions.col(k);
      free += along * along.transpose();
    }
  }
  const Eigen::SelfAdjointEigenSolver<Matrix2d> modes(free);
  frame.axes << across * modes.eigenvectors(), normal;
  if (frame.axes.determinant() < 0.0) frame.axes.col(0) *= -1.0;
  for (int k = 0; k < 3; ++k) {
    const auto moves = [&](int at) {
      return at >= 0 && detail::moves_along(model.nodes[index(at)], frame.axes.col(k));
    };
    frame.holds[index(k)] = moves(first) || moves(second);
  }
  return frame;
}

void Pad::evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const {
  const State now = state_of(*this, trial);
  Rows rows = rows_of(*this, trial, status, now);
  if (trial.unslipped) set_slipped(*this, now, rows);
  const Matrix3d& axes = trial.frame.axes;
  const Vector3d force = axes * Vector3d(trial.force[0], trial.force[1], trial.force[2]);
  // Dashpots act on an open pad.
  const bool damped = status == JointStatus::open || trial.damps_contact;
  const double slack = damped ? trial.slack_stiffness : 0.0;
  const Vector3d held = slack > 0.0 ? Vector3d(slack * slack_motion(trial)) : Vector3d::Zero();
  writer.force(node, force + held);
  writer.force(plane, -force - held);
  for (int k = 0; k < 3; ++k) {
    writer.carries(trial.force[index(k)]);
    writer.column(node, k, axes.col(k));
    writer.column(plane, k, -axes.col(k));
    if (rows.is_balance[index(k)]) {
      writer.balance(k, rows.value[k]);
    } else {
      writer.closure(k, rows.value[k]);
    }
    const Vector3d gradient = axes * rows.by_moved.row(k).transpose();
    writer.row(k, node, gradient);
    writer.row(k, plane, -gradient);
    for (int j = 0; j < 3; ++j) writer.corner(k, j, rows.by_force(k, j));
  }
  for (const std::size_t by : {node, plane}) {
    for (const std::size_t of : {node, plane}) {
      writer.block(by, of, (by == of ? slack : -slack) * Matrix3d::Identity());
    }
  }
}

Vector3d Pad::slack_motion(const Trial& trial) const {
  const State now = state_of(*this, trial);
  return trial.frame.axes * (now.moved - Memory::of(trial.history).moved);
}

JointStatus Pad::decide(const Trial& trial, JointStatus status) const {
  if (trial.model == JointModel::pins) return status;
  const State now = state_of(*this, trial);
  const double mu = trial.model == JointModel::friction ? friction_coefficient : 0.0;
  if (status == JointStatus::open) {
    const double gap = now.moved[along_normal] + trial.opening * clearance;
    if (gap >= -trial.length_rounding) return status;
    return mu > 0.0 ? JointStatus::stick : JointStatus::slip_plus;
  }
  // A normal force counts as zero if it moves a slack element by at most a thousandth of the play
  // in a step, see System::slack_stiffness().
  const double slack = 1e-3 * trial.slack_stiffness * clearance;
  if (now.pressed < -trial.force_rounding - slack) return JointStatus::open;
  if (mu == 0.0) return status;
  const double bound = mu * std::max(now.pressed, slack);
  if (status == JointStatus::stick) {
    return now.friction.norm() > bound + trial.force_rounding ? JointStatus::slip_plus : status;
  }
  const double rounding = slide_rounding(trial, trial.length_rounding, trial.force_rounding);
  // The pad sticks, because Newton's method has reversed the slide relative to friction.
  const double carried = now.friction.norm();
  if (now.pressed > slack + trial.force_rounding && carried > trial.force_rounding &&
      now.pull.dot(now.friction) < -rounding * carried) {
    return JointStatus::stick;
  }
  return now.pull.norm() - bound / tangential_stiffness < -rounding ? JointStatus::stick : status;
}

void Pad::begin(const Trial& trial, JointStatus status, double* now_) const {
  const State now = state_of(*this, trial);
  const bool open = status == JointStatus::open;
  Memory{now.moved, open ? Vector2d::Zero() : now.friction, open ? 0.0 : now.pressed}.to(now_);
}

double Pad::slip(const Trial& trial, const double* after) const {
  const Memory end = Memory::of(after);
  if (end.pressed == 0.0) return 0.0;  // open
  return (state_of(*this, trial).pull - end.friction / tangential_stiffness).norm();
}

double Pad::dissipation(const Trial& trial, const double* after, double) const {
  const Memory start = Memory::of(trial.history);
  const Memory end = Memory::of(after);
  // Work against the mean friction minus the energy of the deflection: zero while the pad sticks.
  const Vector2d slide = end.moved.head<2>() - start.moved.head<2>();
  const double work = -0.5 * (start.friction + end.friction).dot(slide);
  const double stored = end.friction.squaredNorm() - start.friction.squaredNorm();
  return work - 0.5 * stored / tangential_stiffness;
}

double Pad::elastic_energy(const Trial&, const double* now) const {
  const Memory at = Memory::of(now);
  return 0.5 * (at.pressed * at.pressed / normal_stiffness +
                at.friction.squaredNorm() / tangential_stiffness);
}

void Pad::describe(const Trial& trial, double* outputs) const {
  const State now = state_of(*this, trial);
  const Matrix3d& axes = trial.frame.axes;
  Eigen::Map<Vector3d>(outputs, 3) = axes * now.moved;
  outputs[3] = now.pressed;
  Eigen::Map<Vector3d>(outputs + 4, 3) = axes.leftCols<2>() * now.friction;
}

Seat Pad::seat(const Trial& trial, double opened, double next, double rounding) const {
  Seat seat;
  seat.force = trial.force;
  seat.touches = opened > 0.0 || -trial.force[2] > rounding;
  if (seat.touches) seat.moved = -(next - opened) * clearance * normal;
  return seat;
}

}  // namespace statejump::truss
