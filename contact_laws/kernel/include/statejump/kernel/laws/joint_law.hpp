// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/laws/parameters.hpp"
#include "statejump/kernel/laws/registry.hpp"

namespace statejump::kernel::laws {

/// The four laws of one clearance joint and their parameters, as plain values. Call validate()
/// once.
struct JointLaw {
  NormalLaw normal = HertzInternal{};
  DissipationLaw dissipation = NoDissipation{};
  FrictionLaw friction = NoFriction{};
  TangentialVelocityLaw tangential_velocity = MaterialVelocity{};
  FrictionParameters friction_parameters;                     ///< mu, v0, v1
  double restitution = parameter::restitution.default_value;  ///< e [-], see restitution_of()
  /// Lower bound of the impact speed in the dissipation law [m/s], > 0. Without it, damping would
  /// be unbounded in a contact that begins slowly, for example by thermal expansion.
  double smallest_impact_speed = parameter::smallest_impact_speed.default_value;
  /// Axial length of a line contact [m], > 0. Laws of point contacts ignore it.
  double contact_length = parameter::contact_length.default_value;
};

/// Names of the four laws as spelled in case files.
struct JointLawNames {
  std::string normal = HertzInternal::info.name;
  std::string dissipation = NoDissipation::info.name;
  std::string friction = NoFriction::info.name;
  std::string tangential_velocity = MaterialVelocity::info.name;
};

/// Returns the laws with these names and default parameters.
/// @throws std::invalid_argument that lists the known names
inline JointLaw joint_law(const JointLawNames& names) {
  JointLaw law;
  law.normal = normal_law(names.normal);
  law.dissipation = dissipation_law(names.dissipation);
  law.friction = friction_law(names.friction);
  law.tangential_velocity = tangential_velocity_law(names.tangential_velocity);
  return law;
}

/// Reason why two laws of a joint are incompatible; empty if they are compatible.
inline std::string incompatibility(const JointLaw& law) {
  if (are_compatible(law.normal, law.friction)) return "";
  return std::string("friction_law = '") + law_info(law.friction).name +
         "' is that of a point contact and needs normal_law " +
         names_with<NormalLaw>(Trait::point_contact) + ", not '" + law_info(law.normal).name + "'";
}

/// Checks the parameters and whether the laws are compatible. Call it whenever they are
/// set.
/// @throws std::invalid_argument that names the field, its value and its range
inline void validate(const JointLaw& law) {
  if (const std::string wrong = incompatibility(law); !wrong.empty()) {
    throw std::invalid_argument(wrong);
  }
  validate(law.friction_parameters);
  check(restitution_of(law.dissipation), law.restitution);
  check(parameter::smallest_impact_speed, law.smallest_impact_speed);
  check(parameter::contact_length, law.contact_length);
}

/// Tangential stiffness for any normal law, k_t = 4 (G*/E*) k_n [N/m], by Mindlin's ratio of the
/// two stiffnesses. The ratio is exact for a circular contact, where k_n = 2 E* a and k_t = 8 G* a.
/// For a line contact it is a choice, because tangential and normal compliance of an infinite
/// cylinder contain the same logarithm.
/// @param normal_stiffness elastic stiffness dF_N/d(delta) [N/m]
inline double tangential_stiffness(const ElasticPair& elastic, double normal_stiffness) {
  return 4.0 * elastic.effective_shear_modulus / elastic.effective_young_modulus * normal_stiffness;
}

/// Damping ratio chi/K [s/m] of a contact that began at the given approach speed [m/s]; see
/// damped_force().
template <class Law>
double damping_ratio(const Law& law, double impact_speed) {
  return damping_ratio(
      law.dissipation,
      ImpactParameters{law.restitution, std::max(impact_speed, law.smallest_impact_speed)});
}

}  // namespace statejump::kernel::laws
