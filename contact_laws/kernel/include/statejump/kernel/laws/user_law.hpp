// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <exception>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "statejump/kernel/laws/dissipation.hpp"
#include "statejump/kernel/laws/friction.hpp"
#include "statejump/kernel/laws/normal.hpp"
#include "statejump/kernel/laws/tangential_velocity.hpp"

/// Laws that are compiled separately and found by name at run time.
///
/// A law is one type, as in the catalogue, with `info` and the call operator of its kind. A
/// tangential velocity law has velocity() and wrench() instead. The shared object contains a table
/// of functions generated from that type; the program stores values that point to such a table.
namespace statejump::kernel::laws {

enum class LawKind : std::uint32_t { normal, dissipation, friction, tangential_velocity };

/// nullptr if there is no error, otherwise its text, valid until the next call in the same thread.
using ErrorText = const char*;

/// Interface of a shared object. Functions of other kinds are null.
struct UserLawTable {
  // The first four fields never change their positions, so that a program can identify an object
  // compiled for another version.
  std::uint32_t version;  ///< user_law_version of the object
  LawKind kind;
  const char* name;
  const char* kernel;  ///< hash of the kernel headers that the object was compiled with

  std::uint32_t sizes;  ///< exchanged_sizes() as computed by the compiler of the object
  const LawInfo* info;
  ErrorText (*largest_depth)(const NormalGeometry&, double&);
  ErrorText (*normal)(double, const NormalGeometry&, const NormalMaterial&, NormalState&);
  ErrorText (*dissipation)(const ImpactParameters&, double&);
  ErrorText (*friction)(const FrictionParameters&, const FrictionKinematics&, ContactHistory&,
                        FrictionResponse&);
  ErrorText (*largest_slope)(const FrictionParameters&, double, double&);
  ErrorText (*velocity)(const JointContact&, const BodyMotion&, const BodyMotion&, const Vector3&,
                        Vector3&);
  ErrorText (*wrench)(const JointContact&, const Vector3&, const Vector3&, Wrench&);
};

inline constexpr std::uint32_t user_law_version = 1;

/// Hash of the sizes of all types in the table, to detect incompatible compilers and versions.
constexpr std::uint32_t exchanged_sizes() {
  std::uint32_t all = 0;
  for (const std::size_t size :
       {sizeof(UserLawTable), sizeof(LawInfo), sizeof(LawParameter), sizeof(NormalGeometry),
        sizeof(NormalMaterial), sizeof(NormalState), sizeof(ImpactParameters),
        sizeof(FrictionParameters), sizeof(FrictionKinematics), sizeof(FrictionResponse),
        sizeof(ContactHistory), sizeof(JointContact), sizeof(BodyMotion), sizeof(Vector3),
        sizeof(Wrench)}) {
    all = all * 31U + static_cast<std::uint32_t>(size);
  }
  return all;
}

// ---- in the shared object

namespace detail {

template <class Law, class = void>
struct IsVelocityLaw : std::false_type {};
template <class Law>
struct IsVelocityLaw<Law, std::void_t<decltype(&Law::velocity), decltype(&Law::wrench)>>
    : std::true_type {};

template <class Law>
constexpr LawKind kind_of() {
  constexpr bool normal = std::is_invocable_r_v<NormalState, const Law&, double,
                                                const NormalGeometry&, const NormalMaterial&>;
  constexpr bool dissipation = std::is_invocable_r_v<double, const Law&, const ImpactParameters&>;
  constexpr bool friction =
      std::is_invocable_r_v<FrictionResponse, const Law&, const FrictionParameters&,
                            const FrictionKinematics&, ContactHistory&>;
  static_assert(normal || dissipation || friction || IsVelocityLaw<Law>::value,
                "UserLaw has the call operator of no kind of law: see normal.hpp, dissipation.hpp, "
                "friction.hpp and tangential_velocity.hpp");
  return normal        ? LawKind::normal
         : dissipation ? LawKind::dissipation
         : friction    ? LawKind::friction
                       : LawKind::tangential_velocity;
}

/// Calls a function of the law and returns the text of its exception. No exception may leave the
/// shared object.
template <class Function>
ErrorText guarded(Function&& function) {
  thread_local std::string text;
  try {
    function();
    return nullptr;
  } catch (const std::exception& error) {
    text = error.what();
  } catch (...) {
    text = "an exception that is no std::exception";
  }
  return text.c_str();
}

}  // namespace detail

/// Function table of a law type.
/// @param kernel hash of the kernel headers
template <class Law>
const UserLawTable* user_law_table(const char* kernel) {
  constexpr LawKind kind = detail::kind_of<Law>();
  static UserLawTable table{};
  table.version = user_law_version;
  table.kind = kind;
  table.name = Law::info.name;
  table.kernel = kernel;
  table.sizes = exchanged_sizes();
  table.info = &Law::info;
  if constexpr (kind == LawKind::normal) {
    table.largest_depth = [](const NormalGeometry& geometry, double& result) {
      return detail::guarded([&] { result = Law::largest_depth(geometry); });
    };
    table.normal = [](double depth, const NormalGeometry& geometry, const NormalMaterial& material,
                      NormalState& result) {
      return detail::guarded([&] { result = Law{}(depth, geometry, material); });
    };
  } else if constexpr (kind == LawKind::dissipation) {
    table.dissipation = [](const ImpactParameters& impact, double& result) {
      return detail::guarded([&] { result = Law{}(impact); });
    };
  } else if constexpr (kind == LawKind::friction) {
    table.friction = [](const FrictionParameters& parameters, const FrictionKinematics& kinematics,
                        ContactHistory& history, FrictionResponse& result) {
      return detail::guarded([&] { result = Law{}(parameters, kinematics, history); });
    };
    table.largest_slope = [](const FrictionParameters& parameters, double force, double& result) {
      return detail::guarded([&] { result = Law::largest_slope(parameters, force); });
    };
  } else {
    table.velocity = [](const JointContact& contact, const BodyMotion& journal,
                        const BodyMotion& bearing, const Vector3& axis, Vector3& result) {
      return detail::guarded([&] { result = Law{}.velocity(contact, journal, bearing, axis); });
    };
    table.wrench = [](const JointContact& contact, const Vector3& force, const Vector3& axis,
                      Wrench& result) {
      return detail::guarded([&] { result = Law{}.wrench(contact, force, axis); });
    };
  }
  return &table;
}

// ---- in the program

/// A loaded law, or a law whose name is known but that could not be loaded.
struct LoadedLaw {
  LawKind kind{};
  std::string name;
  std::string origin;                   ///< file that contains it, for messages
  std::string problem;                  ///< why it is unusable; empty if usable
  LawInfo info{};                       ///< description; its parameters are copied into the program
  const UserLawTable* table = nullptr;  ///< null if `problem` is not empty
};

/// All loaded laws. The loader adds them before the first look-up. Entries keep their addresses.
inline std::deque<LoadedLaw>& loaded_laws() {
  static std::deque<LoadedLaw> laws;
  return laws;
}

/// Common part of the user law values.
class UserLawValue {
 public:
  UserLawValue() = default;
  explicit UserLawValue(const LoadedLaw& law) : law_(&law) {}
  const LawInfo& info() const { return law_->info; }

 protected:
  const UserLawTable& table() const { return *law_->table; }
  /// @throws std::domain_error that names the law
  void throw_if(ErrorText error) const {
    if (error) fail(error);
  }
  /// Rejects a result that is not finite or for which `good` is false, for example a negative
  /// stiffness.
  void require_result(bool good, const char* what, double value) const {
    if (good && std::isfinite(value)) return;
    char text[96];
    std::snprintf(text, sizeof text, "returned %s = %.9g", what, value);
    fail(text);
  }
  void require_finite(const Vector3& vector, const char* what) const {
    for (int i = 0; i < 3; ++i) require_result(true, what, vector[i]);
  }

 private:
  [[noreturn, gnu::cold, gnu::noinline]] void fail(const char* error) const {
    std::string text = law_->name;
    throw std::domain_error(text.append(" (").append(law_->origin).append("): ").append(error));
  }
  const LoadedLaw* law_ = nullptr;
};

/// A normal law from a shared object.
class UserNormalLaw : public UserLawValue {
 public:
  static constexpr LawKind kind = LawKind::normal;
  using UserLawValue::UserLawValue;
  double largest_depth(const NormalGeometry& geometry) const {
    double result = 0.0;
    throw_if(table().largest_depth(geometry, result));
    return result;
  }
  NormalState operator()(double depth, const NormalGeometry& geometry,
                         const NormalMaterial& material) const {
    detail::require_depth(depth, largest_depth(geometry), info().name);
    NormalState result{};
    throw_if(table().normal(depth, geometry, material, result));
    require_result(result.force >= 0.0, "force", result.force);
    require_result(result.stiffness >= 0.0, "stiffness", result.stiffness);
    require_result(result.contact_width >= 0.0, "contact_width", result.contact_width);
    require_result(result.elastic_energy >= 0.0, "elastic_energy", result.elastic_energy);
    return result;
  }
};

/// A dissipation law from a shared object.
class UserDissipationLaw : public UserLawValue {
 public:
  static constexpr LawKind kind = LawKind::dissipation;
  using UserLawValue::UserLawValue;
  double operator()(const ImpactParameters& impact) const {
    double result = 0.0;
    throw_if(table().dissipation(impact, result));
    require_result(result >= 0.0, "chi/K", result);
    return result;
  }
};

/// A friction law from a shared object.
class UserFrictionLaw : public UserLawValue {
 public:
  static constexpr LawKind kind = LawKind::friction;
  using UserLawValue::UserLawValue;
  double largest_slope(const FrictionParameters& parameters, double normal_force) const {
    double result = 0.0;
    throw_if(table().largest_slope(parameters, normal_force, result));
    require_result(result >= 0.0, "largest_slope", result);
    return result;
  }
  FrictionResponse operator()(const FrictionParameters& parameters,
                              const FrictionKinematics& kinematics, ContactHistory& history) const {
    FrictionResponse result{Vector3::Zero(), 0.0, 0.0};
    throw_if(table().friction(parameters, kinematics, history, result));
    require_finite(result.force_on_1, "force_on_1");
    require_result(true, "elastic_energy", result.elastic_energy);
    require_result(true, "dissipation", result.dissipation);
    require_finite(history.tangential_force, "history.tangential_force");
    require_result(history.tangential_stiffness >= 0.0, "history.tangential_stiffness",
                   history.tangential_stiffness);
    return result;
  }
};

/// A tangential velocity law from a shared object.
class UserVelocityLaw : public UserLawValue {
 public:
  static constexpr LawKind kind = LawKind::tangential_velocity;
  using UserLawValue::UserLawValue;
  Vector3 velocity(const JointContact& contact, const BodyMotion& journal,
                   const BodyMotion& bearing, const Vector3& axis) const {
    Vector3 result = Vector3::Zero();
    throw_if(table().velocity(contact, journal, bearing, axis, result));
    require_finite(result, "velocity");
    return result;
  }
  Wrench wrench(const JointContact& contact, const Vector3& force_on_1, const Vector3& axis) const {
    Wrench result{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
    throw_if(table().wrench(contact, force_on_1, axis, result));
    require_finite(result.force_1, "wrench.force_1");
    require_finite(result.torque_1, "wrench.torque_1");
    require_finite(result.force_2, "wrench.force_2");
    require_finite(result.torque_2, "wrench.torque_2");
    return result;
  }
};

}  // namespace statejump::kernel::laws
