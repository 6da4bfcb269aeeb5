// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <tuple>
#include <variant>

#include "statejump/kernel/laws/joint_law.hpp"

namespace statejump::kernel::laws {

/// A JointLaw whose four laws are known at compile time, so a contact step is one inlined function
/// without type dispatch. The results equal those of the JointLaw to the last bit.
template <class Normal, class Dissipation, class Friction, class TangentialVelocity>
struct StaticJointLaw {
  Normal normal;
  Dissipation dissipation;
  Friction friction;
  TangentialVelocity tangential_velocity;
  FrictionParameters friction_parameters;
  double restitution;
  double smallest_impact_speed;
  double contact_length;

  /// Whether the four laws have the types of this class.
  static bool covers(const JointLaw& law) {
    return std::holds_alternative<Normal>(law.normal) &&
           std::holds_alternative<Dissipation>(law.dissipation) &&
           std::holds_alternative<Friction>(law.friction) &&
           std::holds_alternative<TangentialVelocity>(law.tangential_velocity);
  }
  /// @param law a law for which covers() holds
  explicit StaticJointLaw(const JointLaw& law)
      : normal(std::get<Normal>(law.normal)),
        dissipation(std::get<Dissipation>(law.dissipation)),
        friction(std::get<Friction>(law.friction)),
        tangential_velocity(std::get<TangentialVelocity>(law.tangential_velocity)),
        friction_parameters(law.friction_parameters),
        restitution(law.restitution),
        smallest_impact_speed(law.smallest_impact_speed),
        contact_length(law.contact_length) {}
};

/// Precompiled combinations of laws: the defaults of case files. Each combination adds the code of
/// one contact step.
using PrecompiledJointLaws =
    std::tuple<StaticJointLaw<HertzInternal, NoDissipation, MindlinFriction, MaterialVelocity>>;

namespace detail {

template <std::size_t place, class Act>
decltype(auto) with_precompiled_law(const JointLaw& law, Act&& act) {
  if constexpr (place == std::tuple_size_v<PrecompiledJointLaws>) {
    return act(law);
  } else {
    using Precompiled = std::tuple_element_t<place, PrecompiledJointLaws>;
    return Precompiled::covers(law) ? act(Precompiled(law))
                                    : with_precompiled_law<place + 1>(law, act);
  }
}

}  // namespace detail

/// Calls `act` with the law as one of PrecompiledJointLaws, or with `law` itself if no combination
/// matches.
template <class Act>
decltype(auto) with_precompiled_law(const JointLaw& law, Act&& act) {
  return detail::with_precompiled_law<0>(law, act);
}

}  // namespace statejump::kernel::laws
