// SPDX-License-Identifier: GPL-3.0-or-later
#include "start_choice.hpp"

#include <algorithm>
#include <concepts>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include "truss/joints/partial_slip.hpp"

namespace statejump::truss::detail {

namespace {

constexpr double rigid = std::numeric_limits<double>::infinity();

/// The joint without friction, with the same unknowns.
Joint without_friction(const Slider& joint) {
  Slider loose = joint;
  loose.friction_force = 0.0;
  loose.tangential_stiffness = rigid;
  loose.partial_slip = 0;
  loose.play = 0.0;
  return loose;
}

template <class Type>
requires std::derived_from<Type, HingeLaw<Type>> Joint without_friction(const Type& joint) {
  Type loose = joint;
  loose.friction_moment = 0.0;
  loose.friction_stiffness = rigid;
  return loose;
}

/// All springs of an Iwan joint end in friction sliders, so without friction it is a prismatic
/// joint.
Joint without_friction(const IwanJoint& joint) {
  Slider loose;
  loose.name = joint.name;
  loose.first = joint.first;
  loose.second = joint.second;
  loose.axis = joint.axis;
  return loose;
}

/// Joints with play start without friction in any case.
template <class Type>
Joint without_friction(const Type& joint) {
  return joint;
}

}  // namespace

Model without_friction(const Model& model) {
  Model loose = model;
  for (Joint& joint : loose.joints) {
    joint = std::visit([](const auto& one) { return without_friction(one); }, Joint(joint));
  }
  return loose;
}

namespace {

/// Status with which friction begins. A slipping joint without play sticks; no other status
/// changes.
JointStatus begins(const Joint& joint, JointStatus status) {
  if (status == JointStatus::open) return status;
  if (std::visit([](const auto& one) { return one.has_play(); }, joint)) return status;
  return is_slip(status) ? JointStatus::stick : status;
}

/// Memory of a joint in which friction begins at zero force.
void begin(const Slider& joint, const Trial& trial, JointStatus, double* now) {
  now[0] = joint.axis.dot(trial.moved[0] - trial.moved[1]);
  if (!joint.partial_slip) return;
  write_partial_slip(pressed(joint.tangential_stiffness, joint.friction_force),
                     now + joint.slip_memory_begin());
}

void begin(const IwanJoint& joint, const Trial& trial, JointStatus, double* now) {
  std::fill_n(now, joint.history(), joint.axis.dot(trial.moved[0] - trial.moved[1]));
}

/// Memory of other joints: the accumulated slip, which is the whole slide at zero force. A joint
/// with play starts as usual.
template <class Type>
void begin(const Type& joint, const Trial& trial, JointStatus status, double* now) {
  joint.begin(trial, status, now);
}

}  // namespace

void begin_at_zero_force(const Joint& joint, const Trial& trial, JointStatus status, double* now) {
  std::visit([&](const auto& one) { begin(one, trial, status, now); }, joint);
}

void start_as_chosen(PathFollower& follower) {
  const System& system = follower.system;
  if (follower.options.start_friction == StartFriction::stuck) {
    follower.start();
    follower.origin = system.begin(follower.z, 0.0, follower.origin.statuses, 1.0);
    return;
  }
  const Model loose = without_friction(follower.model);
  const System loose_system(loose);
  const auto going_on = [&follower] {
    return !follower.options.progress || follower.options.progress(0.0);
  };
  PathFollower found{.model = loose,
                     .system = loose_system,
                     .options = follower.options,
                     .newton = Newton(loose_system, follower.options.locate_events, going_on),
                     .rates = RateProblem(loose_system),
                     .record = follower.record};
  found.slide_rate = VectorXd::Zero(follower.slide_rate.size());
  found.state.joint_dissipation = VectorXd::Zero(follower.slide_rate.size());
  found.start();
  follower.path.solves += found.path.solves;
  follower.path.notes = std::move(found.path.notes);
  follower.path.complete = found.path.complete;
  follower.z = std::move(found.z);
  Statuses statuses = std::move(found.origin.statuses);
  for (std::size_t i = 0; i < statuses.size(); ++i) {
    statuses[i] = begins(follower.model.joints[i], statuses[i]);
  }
  if (follower.record != nullptr) {
    for (RecordedStep& step : follower.record->steps) step.without_friction = true;
  }
  follower.first_writer = MemoryWriter::zero_force;
  follower.origin = system.begin(follower.z, 0.0, statuses, 1.0);
  for (int i = 0; i < static_cast<int>(follower.model.joints.size()); ++i) {
    const Trial at =
        system.trial(i, follower.z, 0.0, follower.origin, JointModel::frictionless, 1.0);
    begin_at_zero_force(follower.model.joints[index(i)], at, statuses[index(i)],
                        system.history(i, follower.origin));
  }
}

}  // namespace statejump::truss::detail
