// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss {

/// Bolted joint that slips gradually: the four-parameter Iwan model of Segalman [1], discretised by
/// Jenkins elements. The first node moves along a fixed axis relative to the second, or to the
/// ground. Across the axis it is constrained like the first node of a slider.
///
/// **Law.** The joint consists of springs in parallel, each in series with a slider. Their slip
/// distances φ have the density
///
///   ρ(φ) = R φ^χ + S δ(φ − φm),   0 <= φ <= φm
///
/// K_T = ∫ρ is the stiffness of the stuck joint, and F_S = ∫φ ρ the force at which all of it slips.
/// β = S (χ + 1)/(R φm^(χ + 1)) is the stiffness of the sliders at φm divided by that of all
/// others.
///
/// **Discretisation.** The distances from 0 to φm are divided into intervals. Each interval is
/// `spacing` times as long as the previous one [2]. One slider represents all sliders of an
/// interval, with their stiffness k_i = ∫ρ and their force k_i φ_i = ∫φ ρ. K_T, F_S and the force
/// of a first loading to the end of every interval are therefore exact. Between these ends the
/// force is too large, by at most slack(). Slider i has the position p_i:
///
///   λ = Σ k_i (s − p_i),   |s − p_i| <= φ_i,   p_i moves only at the bound
///
/// Elements need no statuses, because λ is a piecewise linear, monotone function of s. The status
/// `slip±` means that some elements slip in that direction.
///
/// [1] D. J. Segalman, J. Appl. Mech. 72 (2005) 752-760.
/// [2] D. J. Segalman, Sandia report SAND2002-3828 (2002): distances in a geometric series;
/// Segalman puts a slider in the middle of each interval.
struct IwanJoint : PlainJoint {
  std::string name;
  int first = 0;
  int second = -1;  ///< −1: ground.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  double tangent_stiffness = 0.0;  ///< K_T [N/m], > 0.
  double slip_force = 0.0;         ///< F_S [N], > 0.
  double exponent = -0.5;          ///< χ, above −1 and at most 0.
  double stiffness_ratio = 1.0;    ///< β, >= 0.
  int elements = 50;               ///< Number of intervals; the last sliders are one more element.
  double spacing = 1.2;            ///< >= 1; 1: intervals of one length.

  /// A spring and its slider.
  struct Jenkins {
    double stiffness = 0.0;  ///< [N/m]
    double reach = 0.0;      ///< Elongation at which it slips [m].
  };
  /// φm, where the last sliders slip [m].
  double last_reach() const;
  /// All elements, the first to slip first.
  std::vector<Jenkins> jenkins() const;
  /// Largest error of the force of a first loading [N].
  double slack() const;

  static constexpr const char* kind = "iwan_joint";
  static constexpr int slide_row = 0;
  static constexpr bool has_kinks = true;
  int history() const { return elements + 1; }
  static std::span<const Parameter<IwanJoint>> parameters();
  static std::span<const Output> outputs();
  void validate(const Model& model) const;
  JointFrame frame(const Model& model) const;
  void evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const;
  JointStatus decide(const Trial& trial, JointStatus status) const;
  void begin(const Trial& trial, JointStatus status, double* now) const;
  void commit(const Trial& trial, JointStatus status, double* after) const;
  double slip(const Trial& trial, const double* after) const;
  double dissipation(const Trial& trial, const double* after, double slip) const;
  double elastic_energy(const Trial& trial, const double* now) const;
  void describe(const Trial& trial, double* outputs) const;
  double slide_rounding(const Trial& trial, double length, double force) const;
  bool remembers_when(JointStatus before, JointStatus after) const;
  /// Its friction has no Coulomb cone, so the joint keeps its status in contact problems.
  std::optional<LocalContact> contact(const Trial&, JointStatus) const { return {}; }
};

}  // namespace statejump::truss
