// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <tuple>
#include <variant>

#include "statejump/kernel/laws/joint_law.hpp"

namespace statejump::kernel::laws {

/// A JointLaw whose four laws are known when it is compiled. A step of its contact is one piece of
/// code, in which nothing is asked for its type or handed on in memory; the numbers are those of
/// the JointLaw, bit for bit.
template <class Normal, class Dissipation, class Friction, class TangentialVelocity>
struct KnownJointLaw {
  Normal normal;
  Dissipation dissipation;
  Friction friction;
  TangentialVelocity tangential_velocity;
  FrictionParameters friction_parameters;
  double restitution;
  double smallest_impact_speed;
  double contact_length;

  /// Whether a law is of these types.
  static bool covers(const JointLaw& law) {
    return std::holds_alternative<Normal>(law.normal) &&
           std::holds_alternative<Dissipation>(law.dissipation) &&
           std::holds_alternative<Friction>(law.friction) &&
           std::holds_alternative<TangentialVelocity>(law.tangential_velocity);
  }
  /// @param law that it covers()
  explicit KnownJointLaw(const JointLaw& law)
      : normal(std::get<Normal>(law.normal)),
        dissipation(std::get<Dissipation>(law.dissipation)),
        friction(std::get<Friction>(law.friction)),
        tangential_velocity(std::get<TangentialVelocity>(law.tangential_velocity)),
        friction_parameters(law.friction_parameters),
        restitution(law.restitution),
        smallest_impact_speed(law.smallest_impact_speed),
        contact_length(law.contact_length) {}
};

/// Laws that are compiled in one piece: those that cases are computed with unless they name others.
/// One more costs as much code as a step has.
using UsualJointLaws =
    std::tuple<KnownJointLaw<HertzInternal, NoDissipation, MindlinFriction, MaterialVelocity>>;

namespace detail {

template <std::size_t place, class Act>
decltype(auto) with_usual_types(const JointLaw& law, Act&& act) {
  if constexpr (place == std::tuple_size_v<UsualJointLaws>) {
    return act(law);
  } else {
    using Known = std::tuple_element_t<place, UsualJointLaws>;
    return Known::covers(law) ? act(Known(law)) : with_usual_types<place + 1>(law, act);
  }
}

}  // namespace detail

/// Calls act with a law as one of UsualJointLaws, where it is one, else as it is.
template <class Act>
decltype(auto) with_usual_types(const JointLaw& law, Act&& act) {
  return detail::with_usual_types<0>(law, act);
}

}  // namespace statejump::kernel::laws
