// SPDX-License-Identifier: GPL-3.0-or-later
#include "system.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "statejump/kernel/require.hpp"

namespace statejump::truss::detail {

ElementFrames frames_of_elements(const Model& model) {
  ElementFrames made;
  for_each_element_type([&]<std::size_t k>(std::integral_constant<std::size_t, k>) {
    const auto& elements = std::get<k>(model.lists());
    auto& frames = std::get<k>(made);
    frames.reserve(elements.size());
    for (const auto& one : elements) frames.push_back(one.frame(model));
  });
  return made;
}

System::System(const Model& model)
    : model_(&model), dofs_(model), element_frames_(frames_of_elements(model)) {
  drawn_.reserve(model.nodes.size());
  for (const Node& node : model.nodes) drawn_.push_back(node.position);
  frames_.reserve(model.joints.size());
  displacements_ = unknowns_ = dofs_.dofs();
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
          if constexpr (requires { one.has_kinks; }) has_kinks_ = has_kinks_ || one.has_kinks;
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
  each_element_type([&]<class Type>(const std::vector<Type>& elements, const auto&, std::size_t) {
    element_outputs_ += static_cast<Eigen::Index>(elements.size() * output_width<Type>());
    if constexpr (requires(const Type& one) { one.has_edge(); }) {
      has_edges_ = has_edges_ || std::any_of(elements.begin(), elements.end(),
                                             [](const Type& one) { return one.has_edge(); });
    }
  });
  find_scales();
  regions_ = regions_of(model, dofs_, element_frames_, frames_);
  pattern_ = recorded(Parts::all);
}

void System::find_scales() {
  const Model& model = *model_;
  std::vector<double> hottest;  // largest |ΔT| of each program [K]
  for (int i = 0; i < static_cast<int>(model.programs.size()); ++i) {
    hottest.push_back(std::max(-model.lowest_strain(i, 1.0), -model.lowest_strain(i, -1.0)));
  }
  double strain = 0.0;
  double force = 0.0;
  each_element_type([&](const auto& elements, const auto& frames, std::size_t) {
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const ElementScale scale = elements[i].scale(frames[i], drawn_);
      stiffness_scale_ = std::max(stiffness_scale_, scale.stiffness);
      force = std::max(force, scale.force);
      force_by_rotation_ = std::max(force_by_rotation_, scale.by_rotation);
      if (scale.program < 0) continue;
      strain = std::max(strain, scale.strain_per_kelvin * hottest[index(scale.program)]);
    }
  });
  for (const Node& node : model.nodes) force = std::max(force, node.load.norm());
  for (std::size_t site = model.nodes.size(); site < dofs_.sites(); ++site) {
    force = std::max(force, load_on(static_cast<int>(site)).norm());
  }
  const double by_force = stiffness_scale_ > 0.0 ? force / stiffness_scale_ : 0.0;
  path_scale_ = std::max(strain * size_, by_force);
}

Vector3d System::load_on(int site) const {
  const int nodes = static_cast<int>(model_->nodes.size());
  if (site < nodes) return model_->nodes[index(site)].load;
  const Node& node = model_->nodes[index(site - nodes)];
  return node.moment / node.arm;
}

void System::check_rotations(const ElementState& at) const {
  each_element_type([&](const auto& elements, const auto& frames, std::size_t) {
    for (std::size_t i = 0; i < elements.size(); ++i) {
      if constexpr (requires { elements[i].check_state(frames[i], at); }) {
        elements[i].check_state(frames[i], at);
      }
    }
  });
  const int nodes = static_cast<int>(model_->nodes.size());
  for (int n = 0; n < nodes && dofs_.has_rotations(); ++n) {
    // A rotation about one axis has no limit.
    if (dofs_.at(nodes + n).freedoms < 2) continue;
    const Node& node = model_->nodes[index(n)];
    const double rotation = at.moved(nodes + n).norm() / node.arm;
    if (rotation <= largest_node_rotation) continue;
    throw kernel::OutOfRange("node '" + node.name + "'", "rotation", rotation,
                             "at most 5.5 rad about changing axes");
  }
}

double System::reach(const VectorXd& z) const {
  const double largest =
      displacements_ == 0 ? 0.0 : z.head(displacements_).lpNorm<Eigen::Infinity>();
  return std::clamp(largest, path_scale_, std::max(size_, path_scale_));
}

double System::force_rounding(const VectorXd& z) const {
  // Rotations of nodes are those of matrices, whose entries are rounded as 1 is.
  return 64.0 * std::numeric_limits<double>::epsilon() *
         (stiffness_scale_ * reach(z) + force_by_rotation_);
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
    if (index(node) < drawn.size()) {
      trial.drawn[k] = drawn[index(node)];
    } else {
      trial.drawn[k].setZero();  // the rotation of a node
    }
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

bool System::is_idle(int joint, const VectorXd& from, const VectorXd& to, double force) const {
  const bool has_play =
      std::visit([](const auto& one) { return one.has_play(); }, model_->joints[index(joint)]);
  const auto carries_more = [&](const VectorXd& z) {
    return z.segment(force_row(joint), force_count(joint)).lpNorm<Eigen::Infinity>() > force;
  };
  return has_play && !carries_more(from) && !carries_more(to);
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
  const NodeDofs& place = dofs_.at(frame.nodes[0]);
  for (int i = 0; i < place.freedoms; ++i) {
    const double along = place.directions->col(i).dot(seat.moved);
    double squared = 0.0;
    place.each_term(i, [&](int, double factor) { squared += factor * factor; });
    // Changes the dofs by the smallest amount that moves the node by this distance.
    place.each_term(i, [&](int row, double factor) { z[row] += factor / squared * along; });
  }
  for (int k = 0; k < frame.forces; ++k) z[force_row_[index(joint)] + k] = seat.force[index(k)];
}

}  // namespace statejump::truss::detail
