// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "statejump/kernel/partial_slip_plane.hpp"

namespace statejump::truss::detail {

/// Friction of a contact that slides at its rim first, as a row of annuli each under its own bound.
/// No status of the contact says which of them slip: the law is one function of the slide of a
/// step, whose slope falls from k_t to 0, and its tangent is what a step is solved with.
///
/// Friction of a contact with a play in series is such a law as well: k_t times the bend beyond
/// half of the play, up to Coulomb's bound. It has one annulus, one direction and no dashpot.
struct SlipAnnuli {
  kernel::PartialSlipMemory memory;  ///< At the end of the last step.
  double energy = 0.0;               ///< That it holds [J].
  bool slip_all = false;             ///< None of them stuck there.
  double play = 0.0;                 ///< Width of the play in series [m].
  double bend = 0.0;                 ///< Of a contact with a play, at the end of the last step [m].

  /// Where in a step the tangent of the law is taken: slide [m] and speed [m/s].
  Eigen::Vector2d tangent_slide = Eigen::Vector2d::Zero();
  Eigen::Vector2d tangent_speed = Eigen::Vector2d::Zero();

  /// Loads on them at the end of a step.
  struct Pressed {
    double stiffness = 0.0;  ///< k_t [N/m]
    double stiffens = 0.0;   ///< ∂k_t/∂λ_n [1/m]
    double friction_coefficient = 0.0;
    double normal_force = 0.0;  ///< λ_n [N]
    double dashpot = 0.0;       ///< c_t [N s/m]
  };
  /// Friction at the end of a step against the slide [N], with the dashpot within the bound of
  /// Coulomb, and its derivatives. (The kernel's has no dashpot where all annuli slip: that differs
  /// where they slip one way because less presses them and the slide goes the other way, and would
  /// be a jump of the law.)
  struct Law {
    Eigen::Vector2d friction = Eigen::Vector2d::Zero();
    Eigen::Matrix2d by_slide = Eigen::Matrix2d::Zero();   ///< [N/m]
    Eigen::Vector2d by_normal = Eigen::Vector2d::Zero();  ///< [-]
  };
  /// @param slide of the step along both tangents [m]; @param speed at its end [m/s]
  /// @param h by which speeds make slides [s]
  Law law(const Pressed& by, const Eigen::Vector2d& slide, const Eigen::Vector2d& speed,
          double h) const;
  /// Slide to the kink, on either side of which the slope falls from k_t to 0: none, or where all
  /// slip because less presses them back until the last of them sticks [m].
  Eigen::Vector2d kink(const Pressed& by) const;
  /// Takes the tangent at an iterate, or in the kink if the last was taken beyond it. From there,
  /// and from a slide that is too short, a tangent falls short of where it leads to; one from the
  /// other side may leap over it for ever.
  /// @param begins there is no iterate yet; @param slid of the slide, what no speed tells [m]
  void place_tangent(bool begins, const Pressed& by, const Eigen::Vector2d& speed,
                     const Eigen::Vector2d& slid, double h);
  /// Takes a step over. @return friction without the dashpot [N]
  Eigen::Vector2d take(const Pressed& by, const Eigen::Vector2d& slide);

  /// Part of the bend that the play takes [m].
  double played() const;

 private:
  Law law_of_play(const Pressed& by, double slide) const;
  Eigen::Vector2d take_play(const Pressed& by, double slide);
};

}  // namespace statejump::truss::detail
