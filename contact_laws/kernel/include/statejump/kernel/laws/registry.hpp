// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "statejump/kernel/laws/dissipation.hpp"
#include "statejump/kernel/laws/friction.hpp"
#include "statejump/kernel/laws/normal.hpp"
#include "statejump/kernel/laws/tangential_velocity.hpp"
#include "statejump/kernel/laws/user_law.hpp"

namespace statejump::kernel::laws {

/// The catalogue of laws. To add a law, write one type with an `info` and add it to its list;
/// look-up and listing use these lists. The last type of each list holds user laws, see
/// user_law.hpp.
using NormalLaw =
    std::variant<HertzPaper, HertzInternal, Johnson, Esdu78035, Persson, UserNormalLaw>;
using DissipationLaw = std::variant<NoDissipation, LankaraniNikravesh, HuntCrossley,
                                    FloresDissipation, ExactRestitution, UserDissipationLaw>;
using FrictionLaw = std::variant<NoFriction, AmbrosioFriction, MindlinFriction,
                                 MindlinDeresiewiczFriction, UserFrictionLaw>;
using TangentialVelocityLaw = std::variant<MaterialVelocity, PaperVelocity, UserVelocityLaw>;

/// A law from a shared object that cannot be used.
class UnusableLaw : public std::invalid_argument {
 public:
  UnusableLaw(const std::string& key, std::string name, std::string reason)
      : std::invalid_argument(key + " = '" + name + "' cannot be used: " + reason),
        name_(std::move(name)),
        reason_(std::move(reason)) {}
  const std::string& name() const { return name_; }
  const std::string& reason() const { return reason_; }

 private:
  std::string name_, reason_;
};

namespace detail {

template <class Law>
struct Catalogue;

template <class... Types>
struct Catalogue<std::variant<Types...>> {
  using Variant = std::variant<Types...>;
  template <class Type>
  static constexpr bool is_loaded = std::is_base_of_v<UserLawValue, Type>;
  static constexpr LawKind kind = std::variant_alternative_t<sizeof...(Types) - 1, Variant>::kind;

  template <class Visit>  // visits one value of each built-in law type
  static void for_each(Visit&& visit) {
    const auto own = [&](const auto& law) {
      if constexpr (!is_loaded<std::decay_t<decltype(law)>>) visit(law);
    };
    (own(Types{}), ...);
  }

  static std::vector<LawInfo> infos() {
    std::vector<LawInfo> all;
    for_each([&](const auto& law) { all.push_back(law.info); });
    for (const LoadedLaw& loaded : loaded_laws()) {
      if (loaded.kind == kind && loaded.table) all.push_back(loaded.info);
    }
    return all;
  }

  static std::vector<std::string> names() {
    std::vector<std::string> all;
    for_each([&](const auto& law) { all.emplace_back(law.info.name); });
    for (const LoadedLaw& loaded : loaded_laws()) {
      const bool is_new = std::find(all.begin(), all.end(), loaded.name) == all.end();
      if (loaded.kind == kind && is_new) all.push_back(loaded.name);
    }
    return all;
  }

  static std::string problem(const std::string& name) {
    for (const LoadedLaw& loaded : loaded_laws()) {
      if (loaded.kind == kind && loaded.name == name && !loaded.table) return loaded.problem;
    }
    return "";
  }

  static Variant find(const char* what, const std::string& name) {
    if (const std::string wrong = problem(name); !wrong.empty()) {
      throw UnusableLaw(what, name, wrong);
    }
    Variant found;
    bool known = false;
    for_each([&](const auto& law) {
      if (name == law.info.name) found = law, known = true;
    });
    for (const LoadedLaw& loaded : loaded_laws()) {
      if (loaded.kind != kind || loaded.name != name) continue;
      found = std::variant_alternative_t<sizeof...(Types) - 1, Variant>(loaded);
      known = true;
    }
    if (known) return found;
    std::string allowed = "one of ";
    const char* separator = "";
    for (const std::string& each : names()) {
      allowed.append(separator).append(each);
      separator = ", ";
    }
    throw OutOfRange(what, name, allowed);
  }
};

template <class Law, class = void>
struct HasPreloaded : std::false_type {};
template <class Law>
struct HasPreloaded<Law, std::void_t<decltype(&Law::preloaded)>> : std::true_type {};

template <class Law, class = void>
struct HasPrepare : std::false_type {};
template <class Law>
struct HasPrepare<Law, std::void_t<decltype(&Law::prepare)>> : std::true_type {};

template <class Law>
const LawInfo& info_of(const Law& law) {
  if constexpr (std::is_base_of_v<UserLawValue, Law>) {
    return law.info();
  } else {
    return law.info;
  }
}

}  // namespace detail

/// Returns the law with that name.
/// @throws std::invalid_argument that lists the known names, or states why a loaded law is unusable
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

/// Descriptions of the usable laws of one kind, e.g. law_infos<NormalLaw>().
template <class Law>
std::vector<LawInfo> law_infos() {
  return detail::Catalogue<Law>::infos();
}

/// Names of the laws of one kind in the order of the catalogue, e.g. law_names<FrictionLaw>().
/// Unusable loaded laws are included, because looking them up reports the problem.
template <class Law>
std::vector<std::string> law_names() {
  return detail::Catalogue<Law>::names();
}

/// Reason why the loaded law with this name is unusable. Empty if the law is usable or not loaded.
template <class Law>
std::string law_problem(const std::string& name) {
  return detail::Catalogue<Law>::problem(name);
}

namespace detail {

template <class Law>
inline constexpr bool is_variant = false;
template <class... Types>
inline constexpr bool is_variant<std::variant<Types...>> = true;

}  // namespace detail

/// Calls `act` with the law that a variant holds, or directly with a law of known type.
template <class Law, class Act>
decltype(auto) visit_law(const Law& law, Act&& act) {
  if constexpr (detail::is_variant<Law>) {
    return std::visit(act, law);
  } else {
    return act(law);
  }
}

/// Description of a law.
template <class... Types>
const LawInfo& law_info(const std::variant<Types...>& law) {
  return std::visit([](const auto& l) -> const LawInfo& { return detail::info_of(l); }, law);
}

/// Whether a law of any kind has a trait.
template <class Law>
bool has(const Law& law, Trait trait) {
  return visit_law(law, [&](const auto& l) { return detail::info_of(l).has(trait); });
}

/// Names of the laws of one kind with, or without, a trait. The names are in the order of the
/// catalogue and formatted for a sentence: "'hertz_paper' or 'hertz_internal'".
template <class Law>
std::string names_with(Trait trait, bool present = true) {
  std::vector<const char*> names;
  for (const LawInfo& info : law_infos<Law>()) {
    if (info.has(trait) == present) names.push_back(info.name);
  }
  std::string sentence;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) sentence += i + 1 == names.size() ? " or " : ", ";
    sentence.append("'").append(names[i]).append("'");
  }
  return sentence;
}

/// Allowed range of the restitution e for a dissipation law; the default range if the law does not
/// read e.
inline const LawParameter& restitution_of(const DissipationLaw& law) {
  for (const LawParameter* each : law_info(law).parameters) {
    if (each && std::string(each->name) == parameter::restitution.name) return *each;
  }
  return parameter::restitution;
}

/// Returns whether two laws of a joint are compatible: some friction laws need a point contact.
inline bool are_compatible(const NormalLaw& normal, const FrictionLaw& friction) {
  return !has(friction, Trait::needs_point_contact) || has(normal, Trait::point_contact);
}

/// Largest slope of friction over velocity [N s/m]; see friction.hpp.
template <class Law>
double largest_slope(const Law& law, const FrictionParameters& parameters, double normal_force) {
  return visit_law(law, [&](const auto& l) { return l.largest_slope(parameters, normal_force); });
}

/// Normal contact by any law.
/// @param depth delta [m]; a depth <= 0 gives zeros
/// @throws std::domain_error outside the law's range
template <class Law>
NormalState evaluate(const Law& law, double depth, const NormalGeometry& geometry,
                     const NormalMaterial& material) {
  return visit_law(law, [&](const auto& l) { return l(depth, geometry, material); });
}

/// Smallest depth [m] that a law rejects; +infinity if none.
inline double largest_depth(const NormalLaw& law, const NormalGeometry& geometry) {
  return std::visit([&](const auto& l) { return l.largest_depth(geometry); }, law);
}

/// chi/K [s/m] of any dissipation law, for damped_force().
template <class Law>
double damping_ratio(const Law& law, const ImpactParameters& impact) {
  return visit_law(law, [&](const auto& l) { return l(impact); });
}

/// Precomputes the coefficient of a law for the restitution e, because the law is evaluated in
/// every step.
inline void prepare(DissipationLaw& law, double restitution) {
  std::visit(
      [&](auto& l) {
        if constexpr (detail::HasPrepare<std::decay_t<decltype(l)>>::value) l.prepare(restitution);
      },
      law);
}

/// History of a contact that is loaded at the start: `preloaded` of the law if it defines this
/// function, otherwise the history of a spring.
/// @param force_on_1 tangential force on body 1 [N], at most mu F_N
/// @param under kinematics of the contact; its velocity is ignored
inline ContactHistory preloaded_history(const FrictionLaw& law,
                                        const FrictionParameters& parameters,
                                        const Vector3& force_on_1,
                                        const FrictionKinematics& under) {
  return std::visit(
      [&](const auto& l) -> ContactHistory {
        if constexpr (detail::HasPreloaded<std::decay_t<decltype(l)>>::value) {
          return l.preloaded(parameters, force_on_1, under);
        } else {
          ContactHistory history;
          history.tangential_force = force_on_1;
          history.tangential_stiffness = under.tangential_stiffness;
          return history;
        }
      },
      law);
}

/// Friction by any law; updates the history.
template <class Law>
FrictionResponse evaluate(const Law& law, const FrictionParameters& parameters,
                          const FrictionKinematics& kinematics, ContactHistory& history) {
  return visit_law(law, [&](const auto& l) { return l(parameters, kinematics, history); });
}

}  // namespace statejump::kernel::laws
