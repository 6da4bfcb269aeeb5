// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "statejump/kernel/laws/dissipation.hpp"
#include "statejump/kernel/laws/friction.hpp"
#include "statejump/kernel/laws/normal.hpp"
#include "statejump/kernel/laws/tangential_velocity.hpp"

namespace statejump::kernel::laws {

/// The catalogue. A new law is one type with an `info` and one entry here; names, listing and
/// look-up follow from it.
using NormalLaw = std::variant<HertzPaper, HertzInternal, Johnson, Esdu78035, Persson>;
using DissipationLaw =
    std::variant<NoDissipation, LankaraniNikravesh, HuntCrossley, FloresDissipation>;
using FrictionLaw = std::variant<NoFriction, AmbrosioFriction, MindlinFriction>;
using TangentialVelocityLaw = std::variant<MaterialVelocity, PaperVelocity>;

namespace detail {

template <class Law>
struct Catalogue;

template <class... Types>
struct Catalogue<std::variant<Types...>> {
  static std::vector<LawInfo> infos() { return {Types::info...}; }

  static std::variant<Types...> find(const char* kind, const std::string& name) {
    std::variant<Types...> law;
    const bool found = ((name == Types::info.name && (law = Types{}, true)) || ...);
    if (found) return law;
    std::string message = std::string(kind) + " = '" + name + "', allowed is one of ";
    const char* separator = "";
    ((message += separator, message += Types::info.name, separator = ", "), ...);
    throw std::invalid_argument(message);
  }
};

}  // namespace detail

/// Law of that name. @throws std::invalid_argument that lists the known names
inline NormalLaw normal_law(const std::string& name) {
  return detail::Catalogue<NormalLaw>::find("normal_law", name);
}
/// @copydoc normal_law
inline DissipationLaw dissipation_law(const std::string& name) {
  return detail::Catalogue<DissipationLaw>::find("dissipation_law", name);
}
/// @copydoc normal_law
inline FrictionLaw friction_law(const std::string& name) {
  return detail::Catalogue<FrictionLaw>::find("friction_law", name);
}
/// @copydoc normal_law
inline TangentialVelocityLaw tangential_velocity_law(const std::string& name) {
  return detail::Catalogue<TangentialVelocityLaw>::find("tangential_velocity_law", name);
}

/// What the laws of one kind say of themselves, e.g. law_infos<NormalLaw>().
template <class Law>
std::vector<LawInfo> law_infos() {
  return detail::Catalogue<Law>::infos();
}

/// Names of one kind, in the order of the catalogue, e.g. law_names<FrictionLaw>().
template <class Law>
std::vector<std::string> law_names() {
  std::vector<std::string> names;
  for (const LawInfo& info : law_infos<Law>()) names.emplace_back(info.name);
  return names;
}

/// What a law says of itself.
template <class... Types>
const LawInfo& law_info(const std::variant<Types...>& law) {
  return std::visit([](const auto& l) -> const LawInfo& { return l.info; }, law);
}

/// Whether a friction law remembers; see friction.hpp.
inline bool has_memory(const FrictionLaw& law) {
  return std::visit([](const auto& l) { return l.has_memory; }, law);
}

/// Largest slope of friction against velocity [N s/m]; see friction.hpp.
inline double largest_slope(const FrictionLaw& law, const FrictionParameters& parameters,
                            double normal_force) {
  return std::visit([&](const auto& l) { return l.largest_slope(parameters, normal_force); }, law);
}

/// Normal contact by any law. @param depth delta [m], <= 0 gives zeros
/// @throws std::domain_error outside the law's range
inline NormalState evaluate(const NormalLaw& law, double depth, const NormalGeometry& geometry,
                            const NormalMaterial& material) {
  return std::visit([&](const auto& l) { return l(depth, geometry, material); }, law);
}

/// First depth [m] that a law refuses; +infinity if none.
inline double largest_depth(const NormalLaw& law, const NormalGeometry& geometry) {
  return std::visit([&](const auto& l) { return l.largest_depth(geometry); }, law);
}

/// chi/K [s/m] of any dissipation law, for damped_force().
inline double damping_ratio(const DissipationLaw& law, const ImpactParameters& impact) {
  return std::visit([&](const auto& l) { return l(impact); }, law);
}

/// Friction by any law; updates the history.
inline FrictionResponse evaluate(const FrictionLaw& law, const FrictionParameters& parameters,
                                 const FrictionKinematics& kinematics, ContactHistory& history) {
  return std::visit([&](const auto& l) { return l(parameters, kinematics, history); }, law);
}

}  // namespace statejump::kernel::laws
