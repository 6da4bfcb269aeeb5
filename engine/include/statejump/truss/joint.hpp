// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <variant>

#include "statejump/truss/joints/ball_joint.hpp"
#include "statejump/truss/joints/hinge.hpp"
#include "statejump/truss/joints/interface.hpp"
#include "statejump/truss/joints/iwan_joint.hpp"
#include "statejump/truss/joints/latch_hinge.hpp"
#include "statejump/truss/joints/pad.hpp"
#include "statejump/truss/joints/revolute.hpp"
#include "statejump/truss/joints/rigid_arm.hpp"
#include "statejump/truss/joints/slider.hpp"

namespace statejump::truss {

/// A joint: one of several types. joints/interface.hpp documents the members that a type needs.
template <JointType... Types>
using JointOf = std::variant<Types...>;

/// The registry of joints. To add a type, change this list only.
using Joint =
    JointOf<Slider, ClearanceRevolute, LatchHinge, IwanJoint, BallJoint, RigidArm, Hinge, Pad>;

inline const std::string& name_of(const Joint& joint) {
  return std::visit([](const auto& one) -> const std::string& { return one.name; }, joint);
}

inline const char* kind_of(const Joint& joint) {
  return std::visit([](const auto& one) { return std::decay_t<decltype(one)>::kind; }, joint);
}

inline std::span<const Output> outputs_of(const Joint& joint) {
  return std::visit([](const auto& one) { return std::decay_t<decltype(one)>::outputs(); }, joint);
}

/// Calls `use` with every type of joint: use(std::type_identity<Slider>{}), …
template <class Use>
void for_each_joint_type(Use&& use) {
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    (use(std::type_identity<std::variant_alternative_t<i, Joint>>{}), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Joint>>{});
}

}  // namespace statejump::truss
