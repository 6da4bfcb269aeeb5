// SPDX-License-Identifier: GPL-3.0-or-later
#include "system.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace statejump::truss::detail {

namespace {

/// Copying as many displacements takes some ten times as long as starting a thread.
constexpr std::size_t nodes_at_once = 50000;

}  // namespace

System::System(const Model& model) : model_(&model) {
  drawn_.reserve(model.nodes.size());
  place_.reserve(model.nodes.size() + 1);
  for (const Node& node : model.nodes) {
    drawn_.push_back(node.position);
    place_.push_back({unknowns_, node.freedoms, &node.free_directions.matrix()});
    unknowns_ += node.freedoms;
  }
  place_.emplace_back();
  frames_.reserve(model.joints.size());
  displacements_ = unknowns_;
  Eigen::AlignedBox3d box;
  for (const Node& node : model.nodes) box.extend(node.position);
  size_ = box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
  for (const Joint& joint : model.joints) {
    std::visit(
        [&](const auto& one) {
          frames_.push_back(one.frame(model));
          history_begin_.push_back(history_);
          history_ += one.history();
          slips_smoothly_ = slips_smoothly_ || one.slips_smoothly();
          if constexpr (requires { one.rolls(); }) {
            if (one.rolls()) rolling_.push_back(static_cast<int>(frames_.size()) - 1);
          }
        },
        joint);
    output_begin_.push_back(outputs_);
    for (const Output& output : outputs_of(joint)) outputs_ += output.width;
    force_row_.push_back(unknowns_);
    unknowns_ += frames_.back().forces;
  }
  for (const TorsionSpring& spring : model.torsion_springs) {
    torsion_plane_.push_back(plane_of(spring.axis));
  }
  for (const Link& link : model.links) {
    stiffness_scale_ = std::max(stiffness_scale_, link.axial_stiffness / link.stress_free_length);
  }
  for (const AxialSpring& spring : model.springs) {
    stiffness_scale_ = std::max(stiffness_scale_, spring.stiffness);
  }
  path_scale_ = prescribed_displacement();
  regions_ = regions_of(model, frames_);
  pattern_ = recorded(Parts::all);
}

double System::prescribed_displacement() const {
  const Model& model = *model_;
  std::vector<double> hottest;  // largest |ΔT| of each program [K]
  for (int i = 0; i < static_cast<int>(model.programs.size()); ++i) {
    hottest.push_back(std::max(-model.lowest_strain(i, 1.0), -model.lowest_strain(i, -1.0)));
  }
  double strain = 0.0;
  double force = 0.0;
  const auto drawn_length = [&](const auto& part) {
    return (drawn(part.second) - drawn(part.first)).norm();
  };
  for (const Link& link : model.links) {
    strain = std::max(strain, std::abs(link.thermal_expansion * link.temperature_fraction) *
                                  hottest[index(link.program)]);
    const double misfit = std::abs(drawn_length(link) - link.stress_free_length);
    force = std::max(force, link.axial_stiffness / link.stress_free_length * misfit);
  }
  for (const AxialSpring& spring : model.springs) {
    force = std::max(force, spring.stiffness * std::abs(drawn_length(spring) - spring.free_length));
  }
  for (const TorsionSpring& spring : model.torsion_springs) {
    const double arm = drawn_length(model.links[index(spring.first_link)]);
    force = std::max(force, spring.stiffness * std::abs(spring.free_angle) / arm);
  }
  for (const Node& node : model.nodes) force = std::max(force, node.load.norm());
  const double by_force = stiffness_scale_ > 0.0 ? force / stiffness_scale_ : 0.0;
  return std::max(strain * size_, by_force);
}

double System::reach(const VectorXd& z) const {
  const double largest =
      displacements_ == 0 ? 0.0 : z.head(displacements_).lpNorm<Eigen::Infinity>();
  return std::clamp(largest, path_scale_, std::max(size_, path_scale_));
}

double System::force_rounding(const VectorXd& z) const {
  return 64.0 * std::numeric_limits<double>::epsilon() * stiffness_scale_ * reach(z);
}

Vector3d System::displacement(int node, const VectorXd& z) const {
  const JointWriter::Place& at = place_[index(node)];
  const double* along = z.data() + at.row;
  switch (at.freedoms) {
    case 3:
      return along[0] * at.directions->col(0) + along[1] * at.directions->col(1) +
             along[2] * at.directions->col(2);
    case 2:
      return along[0] * at.directions->col(0) + along[1] * at.directions->col(1);
    case 1:
      return along[0] * at.directions->col(0);
    default:
      return Vector3d::Zero();
  }
}

void System::displacements(const VectorXd& z, Eigen::Matrix3Xd& moved) const {
  moved.resize(3, static_cast<Eigen::Index>(model_->nodes.size()));
  each_in_parallel(model_->nodes.size(), nodes_at_once, [&](std::size_t i) {
    moved.col(static_cast<Eigen::Index>(i)) = displacement(static_cast<int>(i), z);
  });
}

Lengths System::lengths_between(int from, int to, const VectorXd& z) const {
  return lengths(drawn(to) - drawn(from), displacement(to, z) - displacement(from, z));
}

int System::node_of(int displacement) const {
  const auto nodes = place_.end() - 1;
  const auto after =
      std::upper_bound(place_.begin(), nodes, displacement,
                       [](int row, const JointWriter::Place& place) { return row < place.row; });
  return static_cast<int>(after - place_.begin()) - 1;
}

namespace {

template <class Moved>
Trial asked(const std::vector<Vector3d>& drawn, const JointFrame& frame, const double* force,
            const double* history, double time, double temperature_change, int joint,
            const StepStart& start, JointModel joints, double opening, Moved&& moved) {
  Trial trial(frame);
  trial.history = history;
  trial.before = start.statuses[index(joint)];
  trial.temperature_change = temperature_change;
  trial.model = joints;
  trial.opening = opening;
  if (start.owed.cols() > 0) {
    trial.owed = start.owed.col(joint) + start.foreseen(joint, time);
    trial.owed_rate = start.foreseen_rate(joint, time);
  }
  trial.slack_stiffness = start.slack_stiffness;
  trial.damps_contact = start.damps_contact;
  for (std::size_t k = 0; k < most_joint_nodes; ++k) {
    const int node = frame.nodes[k];
    if (node < 0) {
      trial.drawn[k].setZero();
      trial.moved[k].setZero();
      continue;
    }
    trial.drawn[k] = drawn[index(node)];
    trial.moved[k] = moved(node);
  }
  std::copy_n(force, frame.forces, trial.force.begin());
  return trial;
}

/// Whether dashpots hold a joint with play.
bool is_damped(JointStatus status, const StepStart& start) {
  return start.damps_contact || status == JointStatus::open;
}

}  // namespace

Trial System::trial(int joint, const VectorXd& z, double time, const StepStart& start,
                    JointModel joints, double opening) const {
  const JointFrame& frame = frames_[index(joint)];
  return asked(drawn_, frame, z.data() + force_row_[index(joint)], history(joint, start), time,
               temperature_change(frame, time), joint, start, joints, opening,
               [&](int node) { return displacement(node, z); });
}

Trial System::trial(int joint, const VectorXd& z, const Eigen::Matrix3Xd& moved, double time,
                    const StepStart& start, JointModel joints, double opening) const {
  const JointFrame& frame = frames_[index(joint)];
  return asked(drawn_, frame, z.data() + force_row_[index(joint)], history(joint, start), time,
               temperature_change(frame, time), joint, start, joints, opening,
               [&](int node) -> Vector3d { return moved.col(node); });
}

JointStatus System::decide(int joint, const VectorXd& z, double time, const StepStart& start,
                           JointModel joints, double opening, JointStatus status,
                           const Rounding& rounding) const {
  Trial at = trial(joint, z, time, start, joints, opening);
  return decide(joint, at, status, rounding);
}

JointStatus System::decide(int joint, const VectorXd& z, const Eigen::Matrix3Xd& moved, double time,
                           const StepStart& start, JointModel joints, double opening,
                           JointStatus status, const Rounding& rounding) const {
  Trial at = trial(joint, z, moved, time, start, joints, opening);
  return decide(joint, at, status, rounding);
}

JointStatus System::decide(int joint, Trial& at, JointStatus status,
                           const Rounding& rounding) const {
  at.length_rounding = rounding.length;
  at.force_rounding = rounding.force;
  return std::visit([&](const auto& one) { return one.decide(at, status); },
                    model_->joints[index(joint)]);
}

StepStart System::begin(const VectorXd& z, double time, const Statuses& statuses,
                        double opening) const {
  StepStart start{statuses, VectorXd::Zero(history_), time, {}, {}, 0.0, 0.0};
  StepStart made = start;
  const Eigen::Matrix3Xd moved = displacements(z);
  each_joint([&](int i) {
    const Trial at = trial(i, z, moved, time, start, JointModel::friction, opening);
    double* now = made.history.data() + history_begin_[index(i)];
    std::visit([&](const auto& one) { one.begin(at, statuses[index(i)], now); },
               model_->joints[index(i)]);
  });
  return made;
}

StepStart System::commit(const VectorXd& z, double time, const Statuses& statuses,
                         const StepStart& last) const {
  StepStart made{statuses,          VectorXd(history_), time, {}, {}, 0.0, last.slack_stiffness,
                 last.damps_contact};
  made.dashpot_force = dashpot_force(z, time, last, statuses);
  const Eigen::Matrix3Xd moved = displacements(z);
  each_joint([&](int i) {
    const Trial at = trial(i, z, moved, time, last, JointModel::friction, 1.0);
    double* after = made.history.data() + history_begin_[index(i)];
    std::visit([&](const auto& one) { one.commit(at, statuses[index(i)], after); },
               model_->joints[index(i)]);
  });
  return made;
}

VectorXd System::slips(const VectorXd& z, double time, const StepStart& start,
                       const StepStart& after) const {
  VectorXd found(static_cast<Eigen::Index>(model_->joints.size()));
  const Eigen::Matrix3Xd moved = displacements(z);
  each_joint([&](int i) {
    const Trial at = trial(i, z, moved, time, start, JointModel::friction, 1.0);
    found[i] = std::visit([&](const auto& one) { return one.slip(at, history(i, after)); },
                          model_->joints[index(i)]);
  });
  return found;
}

void System::settle(const VectorXd& z, double time, const StepStart& start,
                    Statuses& statuses) const {
  const Rounding by = rounding(z);
  const Eigen::Matrix3Xd moved = displacements(z);
  each_joint([&](int i) {
    Trial at = trial(i, z, moved, time, start, JointModel::friction, 1.0);
    at.length_rounding = by.length;
    JointStatus& status = statuses[index(i)];
    status = std::visit([&](const auto& one) { return one.settled(at, status); },
                        model_->joints[index(i)]);
  });
}

Rounding System::rounding(const VectorXd& z) const {
  const double length = closure_tolerance * reach(z);
  return {length, stiffness_scale_ * length};
}

double System::slide_rounding(int joint, const VectorXd& z, double time, const StepStart& start,
                              const Rounding& by) const {
  const Trial at = trial(joint, z, time, start, JointModel::friction, 1.0);
  return std::visit([&](const auto& one) { return one.slide_rounding(at, by.length, by.force); },
                    model_->joints[index(joint)]);
}

bool System::remembers_when(int joint, JointStatus before, JointStatus after) const {
  return std::visit([&](const auto& one) { return one.remembers_when(before, after); },
                    model_->joints[index(joint)]);
}

Vector3d System::lag(int joint, const VectorXd& z, double time, const StepStart& start) const {
  Trial at = trial(joint, z, time, start, JointModel::friction, 1.0);
  at.owed.setZero();
  return std::visit(
      [&](const auto& one) -> Vector3d {
        if constexpr (requires { one.lag(at); }) return one.lag(at);
        return Vector3d::Zero();
      },
      model_->joints[index(joint)]);
}

Vector3d System::slack_motion(int joint, const VectorXd& z, double time,
                              const StepStart& start) const {
  const Trial at = trial(joint, z, time, start, JointModel::friction, 1.0);
  return std::visit(
      [&](const auto& one) -> Vector3d {
        if constexpr (requires { one.slack_motion(at); }) return one.slack_motion(at);
        return Vector3d::Zero();
      },
      model_->joints[index(joint)]);
}

double System::dashpot_force(const VectorXd& z, double time, const StepStart& start,
                             const Statuses& statuses) const {
  if (!start.is_loose || start.slack_stiffness == 0.0) return 0.0;
  double sum = 0.0;
  for (int i = 0; i < static_cast<int>(statuses.size()); ++i) {
    if (!is_damped(statuses[index(i)], start)) continue;
    sum += start.slack_stiffness * slack_motion(i, z, time, start).norm();
  }
  return sum;
}

bool System::is_idle(int joint, const VectorXd& z, double force) const {
  const bool has_play =
      std::visit([](const auto& one) { return one.has_play(); }, model_->joints[index(joint)]);
  return has_play &&
         z.segment(force_row(joint), force_count(joint)).lpNorm<Eigen::Infinity>() <= force;
}

double System::slack_work(const VectorXd& z, double time, const StepStart& start,
                          const Statuses& statuses) const {
  double work = 0.0;
  for (int i = 0; i < static_cast<int>(statuses.size()); ++i) {
    if (!is_damped(statuses[index(i)], start)) continue;
    work += start.slack_stiffness * slack_motion(i, z, time, start).squaredNorm();
  }
  return work;
}

void System::apply(int joint, const Seat& seat, VectorXd& z) const {
  const JointFrame& frame = frames_[index(joint)];
  const JointWriter::Place& place = place_[index(frame.nodes[0])];
  for (int i = 0; i < place.freedoms; ++i) {
    z[place.row + i] += place.directions->col(i).dot(seat.moved);
  }
  for (int k = 0; k < frame.forces; ++k) z[force_row_[index(joint)] + k] = seat.force[index(k)];
}

}  // namespace statejump::truss::detail
