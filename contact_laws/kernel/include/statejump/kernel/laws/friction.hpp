// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "statejump/kernel/laws/parameters.hpp"
#include "statejump/kernel/mindlin.hpp"
#include "statejump/kernel/partial_slip.hpp"
#include "statejump/kernel/require.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::kernel::laws {

/// Parameters of the friction laws; each law reads only its own.
struct FrictionParameters {
  double friction_coefficient = parameter::friction_coefficient.default_value;  ///< mu [-], >= 0
  double v0 =
      parameter::v0.default_value;  ///< [m/s], 0 <= v0 < v1; ambrosio: no friction for v <= v0
  double v1 = parameter::v1.default_value;  ///< [m/s]; ambrosio: full friction for v >= v1
};

/// Checks friction parameters. Call it whenever they are set.
/// @throws std::invalid_argument that names the field, its value and its range
inline void validate(const FrictionParameters& parameters) {
  check(parameter::friction_coefficient, parameters.friction_coefficient);
  require(parameters.v0 >= 0.0 && parameters.v0 < parameters.v1, "v0", parameters.v0,
          "[0, v1) m/s");
  require(std::isfinite(parameters.v1), "v1", parameters.v1, "(v0, inf) m/s");
}

/// Input of a friction law in this step.
struct FrictionKinematics {
  double normal_force;          ///< F_N [N], >= 0
  double tangential_stiffness;  ///< k_t [N/m]; read only by laws with a memory
  Vector3 tangential_velocity;  ///< v_t of 1 relative to 2 [m/s], see tangential_velocity.hpp
  double time_step;             ///< dt [s], >= 0
  Vector3 normal;               ///< unit, perpendicular to the tangent plane
};

/// Output of a friction law.
struct FrictionResponse {
  Vector3 force_on_1;     ///< [N], at most mu F_N; body 2 gets the opposite
  double elastic_energy;  ///< stored by the law [J], >= 0
  double dissipation;     ///< of this step [J], >= 0
};

/// A friction law is one of two types. A law with memory (Trait::has_memory) receives the slide of
/// the step, as velocity times time step. A law without memory is a function of the current
/// velocity, smooth enough for an adaptive integrator. `largest_slope()` returns the largest slope
/// of force over velocity [N s/m]. It acts as a viscous damper that an explicit integrator has to
/// resolve.

/// No friction; the force is exactly zero.
struct NoFriction {
  static double largest_slope(const FrictionParameters&, double) { return 0.0; }
  static constexpr LawInfo info{"none", "F_T = 0", "-", "frictionless", Trait::frictionless, {}};
  FrictionResponse operator()(const FrictionParameters&, const FrictionKinematics&,
                              ContactHistory& history) const {
    history = {};
    return {Vector3::Zero(), 0.0, 0.0};
  }
};

/// Ambrosio's regularised Coulomb friction, the paper's eqs (9) and (10):
///
///    F_T = mu mu_d F_N,   mu_d = 0 (v <= v0), (v - v0)/(v1 - v0) between, 1 (v >= v1),
///
/// directed opposite to v_t, which the paper does not state. The dissipation of a step is F_T v dt
/// [J].
/// Limits: the force is zero up to v0, so it cannot hold a static load. Under a tangential load T,
/// a joint creeps at v0 + (v1 - v0) T/(mu F_N). The law stores no energy and has no history.
struct AmbrosioFriction {
  static double largest_slope(const FrictionParameters& parameters, double normal_force) {
    return parameters.friction_coefficient * normal_force / (parameters.v1 - parameters.v0);
  }
  static constexpr LawInfo info{
      "ambrosio",
      "F_T = mu F_N min(1, max(0, (v - v0)/(v1 - v0))), against v",
      "Ambrosio, 2003; Chen, Li, Tang, Wang, Mech. Sci. 12, 2021, eqs 9-10",
      "0 <= v0 < v1; cannot hold a static load: creeps",
      {},
      {&parameter::friction_coefficient, &parameter::v0, &parameter::v1}};
  FrictionResponse operator()(const FrictionParameters& parameters,
                              const FrictionKinematics& kinematics, ContactHistory& history) const {
    history = {};
    const double speed = kinematics.tangential_velocity.norm();
    if (!(speed > parameters.v0)) return {Vector3::Zero(), 0.0, 0.0};
    const double correction =
        std::min(1.0, (speed - parameters.v0) / (parameters.v1 - parameters.v0));
    const double size =
        parameters.friction_coefficient * correction * std::max(0.0, kinematics.normal_force);
    return {kinematics.tangential_velocity * (-size / speed), 0.0,
            size * speed * kinematics.time_step};
  }
};

/// Mindlin's history spring under Coulomb's limit: mindlin_step() with the limit mu F_N. The caller
/// rotates the history with the contact, see transport(). The spring holds a static load up to mu
/// F_N. Its stiffness in a circular contact is k_t = 8 G* a; for a line contact the caller supplies
/// k_t.
struct MindlinFriction {
  static double largest_slope(const FrictionParameters&, double) { return 0.0; }
  static constexpr LawInfo info{"mindlin",
                                "dF_T = -k_t ds, |F_T| <= mu F_N, k_t = 8 G* a",
                                "Mindlin, J. Appl. Mech. 16, 1949; Johnson 1985, eq. 7.44",
                                "any load; no partial slip below the limit",
                                Trait::holds_static_load | Trait::has_memory,
                                {&parameter::friction_coefficient}};
  FrictionResponse operator()(const FrictionParameters& parameters,
                              const FrictionKinematics& kinematics, ContactHistory& history) const {
    const MindlinEnergy energy = mindlin_step(
        kinematics.tangential_stiffness, parameters.friction_coefficient * kinematics.normal_force,
        kinematics.tangential_velocity * kinematics.time_step, history);
    return {history.tangential_force, energy.elastic, energy.dissipation};
  }
};

/// Hertz contact with partial slip, which starts at the rim. It calls partial_slip_step() with k =
/// k_t and the limit mu F_N. The caller rotates axis and force of the history with the contact.
struct MindlinDeresiewiczFriction {
  static double largest_slope(const FrictionParameters&, double) { return 0.0; }
  static constexpr LawInfo info{
      "mindlin_deresiewicz",
      "dF_T = -8 G* c ds, c(history) <= a the radius of stick; first loading s = 3 mu F_N/(16 G* "
      "a) "
      "(1 - (1 - F_T/(mu F_N))^(2/3))",
      "Cattaneo 1938; Mindlin, Deresiewicz, J. Appl. Mech. 20, 1953; Jaeger, Arch. Appl. Mech. 65, "
      "1995",
      "point contacts, any load; exact in one direction, to 0.2 % of mu F_N where it turns in the "
      "plane; a << R, quasi-static, similar materials",
      Trait::holds_static_load | Trait::has_memory | Trait::needs_point_contact,
      {&parameter::friction_coefficient}};
  FrictionResponse operator()(const FrictionParameters& parameters,
                              const FrictionKinematics& kinematics, ContactHistory& history) const {
    Vector3& first = history.tangential_axis;
    if (!(first.squaredNorm() > 0.0)) {
      first = perpendicular(kinematics.normal);
      history.memory.clear();
    }
    const Vector3 second = cross(kinematics.normal, first);
    const Vector3& velocity = kinematics.tangential_velocity;
    const PartialSlipResponse response = partial_slip_step(
        kinematics.tangential_stiffness, parameters.friction_coefficient * kinematics.normal_force,
        kinematics.time_step * Tangent{velocity.dot(first), velocity.dot(second)}, history.memory);
    history.tangential_force = -response.force.a * first - response.force.b * second;
    history.tangential_stiffness = std::max(0.0, kinematics.tangential_stiffness);
    history.slipping = response.slipping;
    if (history.memory.size() == 0) first = Vector3::Zero();
    return {history.tangential_force, response.elastic, response.dissipation};
  }
  /// History of a contact that was loaded with a constant ratio of tangential to normal force. Then
  /// no annulus has slipped, and the slide is 3/2 F_T/k_t.
  /// @param force_on_1 tangential force on body 1 [N], at most mu F_N
  /// @param under kinematics of the contact; its velocity is ignored
  ContactHistory preloaded(const FrictionParameters& parameters, const Vector3& force_on_1,
                           FrictionKinematics under) const {
    under.tangential_velocity = -1.5 / under.tangential_stiffness * force_on_1;
    under.time_step = 1.0;
    ContactHistory history;
    (*this)(parameters, under, history);
    return history;
  }

 private:
  /// A unit vector perpendicular to `normal`: the coordinate axis along which `normal` is smallest,
  /// made orthogonal.
  static Vector3 perpendicular(const Vector3& normal) {
    Eigen::Index least = 0;
    normal.cwiseAbs().minCoeff(&least);
    Vector3 axis = Vector3::Zero();
    axis[least] = 1.0;
    axis -= normal[least] * normal;
    return axis / axis.norm();
  }
};

}  // namespace statejump::kernel::laws
