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

/// Laws that are compiled apart from the project and found by name at run time.
///
/// A law is one type, as in the catalogue: `info`, and the call operator (for a tangential velocity
/// velocity() and wrench()) of its kind. The shared object holds a table of functions that is made
/// from the type; the program holds values that point to such a table.
namespace statejump::kernel::laws {

enum class LawKind : std::uint32_t { normal, dissipation, friction, tangential_velocity };

/// nullptr, or what went wrong; the text lives until the next call in the same thread.
using Complaint = const char*;

/// What a shared object hands over. Functions of other kinds are null.
struct UserLawTable {
  // These four never move, so that a program can say what is wrong with an object of another time.
  std::uint32_t version;  ///< user_law_version of the object
  LawKind kind;
  const char* name;
  const char* kernel;  ///< hash of the kernel headers that it was compiled against

  std::uint32_t sizes;  ///< exchanged_sizes() as its compiler had them
  const LawInfo* info;
  Complaint (*largest_depth)(const NormalGeometry&, double&);
  Complaint (*normal)(double, const NormalGeometry&, const NormalMaterial&, NormalState&);
  Complaint (*dissipation)(const ImpactParameters&, double&);
  Complaint (*friction)(const FrictionParameters&, const FrictionKinematics&, ContactHistory&,
                        FrictionResponse&);
  Complaint (*largest_slope)(const FrictionParameters&, double, double&);
  Complaint (*velocity)(const JointContact&, const BodyMotion&, const BodyMotion&, const Vector3&,
                        Vector3&);
  Complaint (*wrench)(const JointContact&, const Vector3&, const Vector3&, Wrench&);
};

inline constexpr std::uint32_t user_law_version = 1;

/// Sizes of what goes through the table, as one number.
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

/// Runs a function of the law; no exception leaves the object.
template <class Function>
Complaint guarded(Function&& function) {
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

/// The table of a law's type.
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
    table.largest_depth = [](const NormalGeometry& geometry, double& answer) {
      return detail::guarded([&] { answer = Law::largest_depth(geometry); });
    };
    table.normal = [](double depth, const NormalGeometry& geometry, const NormalMaterial& material,
                      NormalState& answer) {
      return detail::guarded([&] { answer = Law{}(depth, geometry, material); });
    };
  } else if constexpr (kind == LawKind::dissipation) {
    table.dissipation = [](const ImpactParameters& impact, double& answer) {
      return detail::guarded([&] { answer = Law{}(impact); });
    };
  } else if constexpr (kind == LawKind::friction) {
    table.friction = [](const FrictionParameters& parameters, const FrictionKinematics& kinematics,
                        ContactHistory& history, FrictionResponse& answer) {
      return detail::guarded([&] { answer = Law{}(parameters, kinematics, history); });
    };
    table.largest_slope = [](const FrictionParameters& parameters, double force, double& answer) {
      return detail::guarded([&] { answer = Law::largest_slope(parameters, force); });
    };
  } else {
    table.velocity = [](const JointContact& contact, const BodyMotion& journal,
                        const BodyMotion& bearing, const Vector3& axis, Vector3& answer) {
      return detail::guarded([&] { answer = Law{}.velocity(contact, journal, bearing, axis); });
    };
    table.wrench = [](const JointContact& contact, const Vector3& force, const Vector3& axis,
                      Wrench& answer) {
      return detail::guarded([&] { answer = Law{}.wrench(contact, force, axis); });
    };
  }
  return &table;
}

// ---- in the program

/// A law that was loaded, or that could not be but is known by name.
struct LoadedLaw {
  LawKind kind{};
  std::string name;
  std::string origin;                   ///< where it came from, for messages
  std::string problem;                  ///< why it cannot be used; empty: it can
  LawInfo info{};                       ///< its parameters are those of the program
  const UserLawTable* table = nullptr;  ///< null with a problem
};

/// All of them; filled by the loader before laws are looked up, entries stay where they are.
inline std::deque<LoadedLaw>& loaded_laws() {
  static std::deque<LoadedLaw> laws;
  return laws;
}

/// What the values below have in common.
class UserLawValue {
 public:
  UserLawValue() = default;
  explicit UserLawValue(const LoadedLaw& law) : law_(&law) {}
  const LawInfo& info() const { return law_->info; }

 protected:
  const UserLawTable& table() const { return *law_->table; }
  /// @throws std::domain_error that names the law
  void require_no(Complaint complaint) const {
    if (complaint) fail(complaint);
  }
  /// Refuses an answer that is no number, or negative where that has no meaning.
  void require_answer(bool good, const char* what, double value) const {
    if (good && std::isfinite(value)) return;
    char text[96];
    std::snprintf(text, sizeof text, "answered %s = %.9g", what, value);
    fail(text);
  }
  void require_finite(const Vector3& vector, const char* what) const {
    for (int i = 0; i < 3; ++i) require_answer(true, what, vector[i]);
  }

 private:
  [[noreturn, gnu::cold, gnu::noinline]] void fail(const char* complaint) const {
    std::string text = law_->name;
    throw std::domain_error(text.append(" (").append(law_->origin).append("): ").append(complaint));
  }
  const LoadedLaw* law_ = nullptr;
};

/// A normal law from a shared object.
class UserNormalLaw : public UserLawValue {
 public:
  static constexpr LawKind kind = LawKind::normal;
  using UserLawValue::UserLawValue;
  double largest_depth(const NormalGeometry& geometry) const {
    double answer = 0.0;
    require_no(table().largest_depth(geometry, answer));
    return answer;
  }
  NormalState operator()(double depth, const NormalGeometry& geometry,
                         const NormalMaterial& material) const {
    detail::require_depth(depth, largest_depth(geometry), info().name);
    NormalState answer{};
    require_no(table().normal(depth, geometry, material, answer));
    require_answer(answer.force >= 0.0, "force", answer.force);
    require_answer(answer.stiffness >= 0.0, "stiffness", answer.stiffness);
    require_answer(answer.contact_width >= 0.0, "contact_width", answer.contact_width);
    require_answer(answer.elastic_energy >= 0.0, "elastic_energy", answer.elastic_energy);
    return answer;
  }
};

/// A dissipation law from a shared object.
class UserDissipationLaw : public UserLawValue {
 public:
  static constexpr LawKind kind = LawKind::dissipation;
  using UserLawValue::UserLawValue;
  double operator()(const ImpactParameters& impact) const {
    double answer = 0.0;
    require_no(table().dissipation(impact, answer));
    require_answer(answer >= 0.0, "chi/K", answer);
    return answer;
  }
};

/// A friction law from a shared object.
class UserFrictionLaw : public UserLawValue {
 public:
  static constexpr LawKind kind = LawKind::friction;
  using UserLawValue::UserLawValue;
  double largest_slope(const FrictionParameters& parameters, double normal_force) const {
    double answer = 0.0;
    require_no(table().largest_slope(parameters, normal_force, answer));
    require_answer(answer >= 0.0, "largest_slope", answer);
    return answer;
  }
  FrictionResponse operator()(const FrictionParameters& parameters,
                              const FrictionKinematics& kinematics, ContactHistory& history) const {
    FrictionResponse answer{Vector3::Zero(), 0.0, 0.0};
    require_no(table().friction(parameters, kinematics, history, answer));
    require_finite(answer.force_on_1, "force_on_1");
    require_answer(true, "elastic_energy", answer.elastic_energy);
    require_answer(true, "dissipation", answer.dissipation);
    require_finite(history.tangential_force, "history.tangential_force");
    require_answer(history.tangential_stiffness >= 0.0, "history.tangential_stiffness",
                   history.tangential_stiffness);
    return answer;
  }
};

/// A tangential velocity law from a shared object.
class UserVelocityLaw : public UserLawValue {
 public:
  static constexpr LawKind kind = LawKind::tangential_velocity;
  using UserLawValue::UserLawValue;
  Vector3 velocity(const JointContact& contact, const BodyMotion& journal,
                   const BodyMotion& bearing, const Vector3& axis) const {
    Vector3 answer = Vector3::Zero();
    require_no(table().velocity(contact, journal, bearing, axis, answer));
    require_finite(answer, "velocity");
    return answer;
  }
  Wrench wrench(const JointContact& contact, const Vector3& force_on_1, const Vector3& axis) const {
    Wrench answer{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
    require_no(table().wrench(contact, force_on_1, axis, answer));
    require_finite(answer.force_1, "wrench.force_1");
    require_finite(answer.torque_1, "wrench.torque_1");
    require_finite(answer.force_2, "wrench.force_2");
    require_finite(answer.torque_2, "wrench.torque_2");
    return answer;
  }
};

}  // namespace statejump::kernel::laws
