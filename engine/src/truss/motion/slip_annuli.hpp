// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "statejump/kernel/partial_slip_plane.hpp"

namespace statejump::truss::detail {

/// Partial slip of a contact, represented by concentric annuli that each have a friction limit.
/// Annuli have no statuses: friction is one function of the slide in a step, and its slope falls
/// from k_t to 0. A step is solved with tangents of this function.
///
/// A contact with a play in series has a similar law: friction is k_t times the deflection beyond
/// half the play, up to Coulomb's limit. It is represented by one annulus with one direction and no
/// dashpot.
struct SlipAnnuli {
  kernel::PartialSlipMemory memory;  ///< At the end of the last step.
  double energy = 0.0;               ///< Stored energy [J].
  bool slip_all = false;             ///< Whether all annuli slip.
  double play = 0.0;                 ///< Width of the play in series [m].
  double bend = 0.0;  ///< Deflection of a contact with play, at the end of the last step [m].

  /// Point of the tangent: slide [m] and slip rate [m/s].
  Eigen::Vector2d tangent_slide = Eigen::Vector2d::Zero();
  Eigen::Vector2d tangent_speed = Eigen::Vector2d::Zero();

  /// Loads of the law at the end of a step.
  struct Pressed {
    double stiffness = 0.0;  ///< k_t [N/m]
    double stiffens = 0.0;   ///< ∂k_t/∂λ_n [1/m]
    double friction_coefficient = 0.0;
    double normal_force = 0.0;  ///< λ_n [N]
    double dashpot = 0.0;       ///< c_t [N s/m]
  };
  /// Friction at the end of a step [N], opposite to the slide, with derivatives. The sum of spring
  /// and dashpot force is within Coulomb's limit. (The kernel omits the dashpot if all annuli slip.
  /// The law would then jump if a decreasing normal force makes them slip against the slide.)
  struct Law {
    Eigen::Vector2d friction = Eigen::Vector2d::Zero();
    Eigen::Matrix2d by_slide = Eigen::Matrix2d::Zero();   ///< [N/m]
    Eigen::Vector2d by_normal = Eigen::Vector2d::Zero();  ///< [-]
  };
  /// @param slide slide of the step along both tangents [m]
  /// @param speed slip rate at the end of the step [m/s]
  /// @param h ratio of slide to slip rate [s]
  Law law(const Pressed& by, const Eigen::Vector2d& slide, const Eigen::Vector2d& speed,
          double h) const;
  /// Slide [m] at the kink of the law. On both sides of the kink the slope falls from k_t to 0. The
  /// kink is at zero, unless a decreasing normal force makes all annuli slip; it is then the
  /// backward slide at which the last annulus sticks.
  Eigen::Vector2d kink(const Pressed& by) const;
  /// Sets the point of the tangent to an iterate, or to the kink if the previous point was on the
  /// other side of the kink. Tangents at the kink or at too short a slide underestimate the slide,
  /// so the iteration converges from one side. A tangent beyond the kink may overshoot in every
  /// iteration.
  /// @param begins true if there is no iterate yet
  /// @param slid part of the slide that does not depend on the slip rate [m]
  void place_tangent(bool begins, const Pressed& by, const Eigen::Vector2d& speed,
                     const Eigen::Vector2d& slid, double h);
  /// Commits a step.
  /// @return friction without the dashpot [N]
  Eigen::Vector2d take(const Pressed& by, const Eigen::Vector2d& slide);

  /// Part of the deflection within the play [m].
  double played() const;

 private:
  Law law_of_play(const Pressed& by, double slide) const;
  Eigen::Vector2d take_play(const Pressed& by, double slide);
};

}  // namespace statejump::truss::detail
