// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <string>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss {

/// Revolute joint with clearance and dry friction about a fixed axis: a journal in a bearing, each
/// on the end of a link or on a node that rotates.
///
/// **Law.** d is the eccentricity and n = d/|d| the normal. φ, θ_J, θ_B are the angles of d and of
/// the links or nodes that rotate journal and bearing. r1 is the journal's radius minus half the
/// depth, r2 the bearing's radius plus half the depth, so that both surfaces meet in one point and
/// the moments balance. The surfaces slide in a step by Δσ = ∫ |d| dφ + r1 dθ_J − r2 dθ_B:
///
///   open    λ_n = λ_t = 0, |d| <= c    contact |d| = c + (λ_n/K)^(2/3), λ_n >= 0
///   stick   Δσ = 0, |λ_t| <= μ λ_n     slip±   λ_t = ±μ λ_n, ±Δσ >= 0
///
/// A joint that sticks therefore rolls. The integral uses the trapezoidal rule with the radii at
/// start and end of the step. Its third-order error in a step is corrected in the next step. With a
/// finite tangential stiffness k_t, a sticking contact deflects elastically, as in a DEM: Δσ is
/// then the slide minus the elastic deflection ∫ dλ_t/k_t. k_t depends on the depth (Mindlin, k_t =
/// 8 G* √(R δ)). An increase of the normal load keeps λ_t; a decrease keeps λ_t/k_t. The energy
/// lost in both cases is heat at the rim of the contact.
///
/// With partial slip λ_t is the force of kernel::partial_slip_step() for the slide Δσ, the
/// stiffness k_t at the depth and the limit μ λ_n. Each path step is one step of that law. One row
/// covers stick and slip. `slip±` then means that the whole contact slides.
struct ClearanceRevolute {
  std::string name;
  int journal_node = 0;
  int bearing_node = 0;
  int journal_link = -1;                 ///< Rotates the journal; −1: none.
  int bearing_link = -1;                 ///< Rotates the bearing; −1: none.
  int journal_turns = 0;                 ///< 1: its node rotates the journal, no link.
  int bearing_turns = 0;                 ///< 1: its node rotates the bearing, no link.
  double journal_radius = 0.0;           ///< R1 at ΔT = 0 [m], > 0.
  double radial_clearance = 0.0;         ///< c = R2 − R1 at ΔT = 0 [m], > 0.
  double journal_thermal_expansion = 0;  ///< [1/K].
  double bearing_thermal_expansion = 0;  ///< [1/K].
  double friction_coefficient = 0.0;     ///< μ, >= 0.
  /// K of Hertz's F_N = K δ^1.5 [N/m^1.5]; infinity: rigid.
  double hertz_stiffness = std::numeric_limits<double>::infinity();
  /// 8 G* √R of Mindlin's k_t = 8 G* √(R δ), the stiffness of the sticking contact [N/m^1.5];
  /// infinity: rigid stick. It may be finite only if `hertz_stiffness` is finite.
  double mindlin_stiffness = std::numeric_limits<double>::infinity();
  /// 1: the contact slips partially, starting at its rim. Needs friction and finite stiffnesses.
  int partial_slip = 0;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  int program = 0;
  double temperature_fraction = 1;

  static constexpr const char* kind = "revolute";
  int history() const;
  static constexpr int slide_row = 1;
  static std::span<const Parameter<ClearanceRevolute>> parameters();
  static std::span<const Output> outputs();
  void validate(const Model& model) const;
  JointFrame frame(const Model& model) const;
  void evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const;
  void warm(const Trial& trial, JointStatus status, double temperature_rate,
            JointWriter& writer) const;
  /// Displacement of journal against bearing since the start of the step; joint open [m].
  Eigen::Vector3d slack_motion(const Trial& trial) const;
  JointStatus decide(const Trial& trial, JointStatus status) const;
  void begin(const Trial& trial, JointStatus status, double* now) const;
  void commit(const Trial& trial, JointStatus status, double* after) const;
  bool rolls() const { return friction_coefficient > 0.0 && partial_slip == 0; }
  bool softens(const Trial& trial) const;
  Eigen::Vector3d lag(const Trial& trial) const;
  double slip(const Trial& trial, const double* after) const;
  double dissipation(const Trial& trial, const double* after, double slip) const;
  double elastic_energy(const Trial& trial, const double* now) const;
  double clearance_growth() const {
    return bearing_thermal_expansion * (journal_radius + radial_clearance) -
           journal_thermal_expansion * journal_radius;
  }
  static double contact_force(const Trial& trial) { return trial.force[0]; }
  void describe(const Trial& trial, double* outputs) const;
  double slide_rounding(const Trial& trial, double length, double force) const;
  bool remembers_when(JointStatus before, JointStatus after) const;
  JointStatus settled(const Trial& trial, JointStatus status) const;
  std::optional<LocalContact> contact(const Trial& trial, JointStatus status) const;
  /// Index in history() at which the memory of a contact with partial slip begins.
  int slip_memory_begin() const;
  bool slips_smoothly() const { return partial_slip != 0; }
  double least_slide() const { return radial_clearance; }
  JointStatus rest() const {
    return friction_coefficient > 0.0 ? JointStatus::stick : JointStatus::slip_plus;
  }
  bool has_play() const { return true; }
  Seat seat(const Trial& trial, double opened, double next, double rounding) const;
  bool jumps(const Trial& trial, JointStatus status) const;
};

}  // namespace statejump::truss
