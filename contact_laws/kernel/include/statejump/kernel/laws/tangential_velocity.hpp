// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/kernel/laws/law_info.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::kernel::laws {

/// A tangential velocity law has two parts. The first is the velocity v of body 1 (journal)
/// relative to body 2 (bearing) [m/s] that friction uses. The second is the wrench, the forces and
/// moments on the two centres caused by a contact force F. Both parts are transposes of each other:
/// for all motions
///
///    F . v = force_1 . v_C + torque_1 . omega_1 + force_2 . v_D + torque_2 . omega_2,
///
/// so a friction force opposite to v never adds power to the bodies. Never combine the parts of
/// different laws.

/// Velocity of the material at the contact point, v_C + omega_1 x arm_1 - v_D - omega_2 x arm_2,
/// with the moments arm x F, as for two rough surfaces. Forces and moments balance. See
/// revolute_contact(), contact_wrench().
struct MaterialVelocity {
  static constexpr LawInfo info{"material",
                                "v = v_C + w1 x r1 - v_D - w2 x r2, moments r x F",
                                "rigid-body kinematics",
                                "any motion",
                                Trait::holds_static_load,
                                {}};
  Vector3 velocity(const JointContact& contact, const BodyMotion&, const BodyMotion&,
                   const Vector3&) const {
    return contact.relative_velocity;
  }
  Wrench wrench(const JointContact& contact, const Vector3& force_on_1, const Vector3&) const {
    return contact_wrench(force_on_1, contact.arm_1, contact.arm_2);
  }
};

/// The paper's eqs (14) to (16) as printed: time derivatives of the geometric points C1 = r_C + R1
/// n and D1 = r_D + R2 n. With d = r_C - r_D perpendicular to the bearing's axis, dn/dt = (d' -
/// (d'.n) n)/|d| and c = R2 - R1, the difference is
///
///    v = d' - c dn/dt = (d'.n) n + (delta/|d|) d'_t.
///
/// The spins are absent, so a journal that rotates in place slides without friction. The tangential
/// part is the relative velocity of the centres times delta/|d|, a few hundredths in a joint with
/// play.
/// By virtual power, the wrench is force_1 = F_n n + (delta/|d|) F_t on C, the opposite on D, and
/// no moment on either body. (F_t and R x F_t on the bodies, combined with this velocity, would
/// create power.)
/// Limits: the two forces are |d| apart and leave a moment delta n x F_t unbalanced, as do the two
/// points of eq. (14). When the whole joint rotates as one body, v is not zero. Axial motion is
/// ignored. For concentric bodies v has no tangential part.
struct PaperVelocity {
  static constexpr LawInfo info{
      "paper",
      "v = d/dt(r_C + R1 n) - d/dt(r_D + R2 n) = d'_n + (delta/|d|) d'_t, no moments",
      "Chen, Li, Tang, Wang, Mech. Sci. 12, 2021, eqs 14-16; forces by virtual power",
      "spins are not seen; leaves a moment delta F_t unbalanced",
      Trait::holds_static_load | Trait::needs_axis,
      {}};
  Vector3 velocity(const JointContact& contact, const BodyMotion& journal,
                   const BodyMotion& bearing, const Vector3& axis) const {
    return across(contact, perpendicular_part(journal.velocity - bearing.velocity, axis));
  }
  Wrench wrench(const JointContact& contact, const Vector3& force_on_1, const Vector3& axis) const {
    const Vector3 force = across(contact, perpendicular_part(force_on_1, axis));
    return {force, Vector3::Zero(), -force, Vector3::Zero()};
  }

 private:
  /// Applies n n^T + (delta/|d|) (1 - n n^T), a symmetric matrix, i.e. its own transpose.
  static Vector3 across(const JointContact& contact, const Vector3& v) {
    const double fraction =
        contact.eccentricity > 0.0 ? contact.penetration_depth / contact.eccentricity : 0.0;
    const Vector3 along = v.dot(contact.normal) * contact.normal;
    return along + fraction * (v - along);
  }
};

}  // namespace statejump::kernel::laws
