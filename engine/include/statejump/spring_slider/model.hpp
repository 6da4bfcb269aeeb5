// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "statejump/start_friction.hpp"
#include "statejump/thermal/program.hpp"

namespace statejump::spring_slider {

/// A heated link that pushes a block with dry friction between two stops. This is the paper's
/// reduced model of a one-dimensional clearance joint (section 3, Figs 4 and 5; equation numbers in
/// parentheses).
///
/// The link is a massless spring between the fixed frame and the block. Its unloaded length is l_T
/// = l0 (1 + α ΔT), so its thermal displacement is x_T = l_T − l0 (2). With the block at x
///
///     F = k_T (x_T − x),   k_T = E A / l_T   (4)
///
/// is the axial force, positive in compression: it pushes the block towards +x. A preload spring to
/// the ground pulls it back with P + k_p x. Friction R with |R| <= f and a stop force W, at x = +c⁺
/// or x = −c⁻, balance the difference D = F − P − k_p x: D + R + W = 0. The path is quasi-static
/// and rate-independent, a function of the sequence of ΔT alone.
///
///   start   at ΔT = 0 with D = D0, x = −(P + D0)/(k + k_p), or at the stop in its way;
///           D0 = clamp(−P, −f, f) where it starts stuck, D0 = 0 where it starts frictionless
///   stick   |D| < f, x stays
///   slide   D = s f with the sense s of the motion, hence
///           x = (E A x_T − (s f + P) l_T)/(E A + k_p l_T)
///   stop    x = s c and s D > f
///
/// A cycle that ends sliding in sense s leaves the block with D = s f: the state jump is
/// (D0 − s f)/(k + k_p), unless P presses the block on a stop at the start.
///
/// At a rigid stop, equilibrium leaves R and W undetermined within −f <= R <= f. The model assumes
/// the smallest stop force, |W| = max(0, |D| − f): friction keeps its value from the arrival of the
/// block, and the stop supports the remainder.
///
/// A stop of stiffness k_s is compliant, W = −k_s (x − s c) beyond the clearance of side s. In
/// contact with it the block slides and sticks as it does between the stops, with an additional
/// spring:
///
///     P + k_p x − W = (P − k_s s c) + (k_p + k_s) x,
///
/// so every formula also holds with these two values instead of P and k_p, see in_region().
///
/// A play of width w in series with friction moves with the slide. Let p be the position of its
/// middle, and e = x − p:
///
///  play    |e| < w/2, no friction: D = 0, hence x = (E A x_T − P l_T)/(E A + k_p l_T)
///   stick   e = s w/2 and 0 <= s D <= f: friction pushes away from this end of the play only
///   slide   e = s w/2 and D = s f, p moves
///
/// Friction at a rigid stop again keeps its value from the arrival, f or 0. A block that starts
/// stuck starts in the middle of the play, p = 0; a preload may then move it to an end of the play
/// and further. A block that starts frictionless has p = x.
///
/// Limits: no inertia, no buckling (see euler_load), constant f, E and α independent of temperature
/// (for other α see report_temperatures_of). SpringSlider is a plain value; call validate() once.
struct SpringSlider {
  /// Young's modulus E of the link [Pa], > 0.
  double young_modulus = 0.0;
  /// Cross-sectional area A of the link [m²], > 0.
  double cross_section_area = 0.0;
  /// Length l0 of the unloaded link at ΔT = 0 [m], > 0.
  double stress_free_length = 0.0;
  /// Coefficient α of linear thermal expansion [1/K], any finite value.
  double thermal_expansion = 0.0;
  /// Friction limit f [N], >= 0 and < E A.
  double friction_force = 0.0;
  /// Distance c⁻ from the block's start to the stop at negative x [m]; between 0 and l0, or
  /// infinity.
  double clearance_minus = std::numeric_limits<double>::infinity();
  /// Distance c⁺ from the block's start to the stop at positive x [m], > 0 or infinity.
  double clearance_plus = std::numeric_limits<double>::infinity();
  /// Stiffness k_p of the spring from block to ground [N/m], >= 0.
  double preload_stiffness = 0.0;
  /// Tension P of the preload spring at x = 0 [N]. Positive P pulls the block towards −x. |P| + f <
  /// E A.
  double preload_force = 0.0;
  /// How the block reaches its start.
  StartFriction start_friction = StartFriction::stuck;
  /// Stiffness k_s of both stops [N/m], > 0; infinity: rigid.
  double stop_stiffness = std::numeric_limits<double>::infinity();
  /// Width w of the play in series with friction [m], >= 0. A play requires friction.
  double play = 0.0;

  /// Throws std::invalid_argument whose message names the first field out of range, its value and
  /// the range.
  void validate() const;

  /// E A [N].
  double axial_rigidity() const { return young_modulus * cross_section_area; }

  /// Distance to the stop on side `side` (+1 or −1) [m]; infinity if there is no stop.
  double clearance(int side) const { return side > 0 ? clearance_plus : clearance_minus; }

  bool has_soft_stops() const { return stop_stiffness < std::numeric_limits<double>::infinity(); }
};

/// Unloaded length l_T [m] at ΔT [K], eq. (2).
double free_length(const SpringSlider& model, double temperature_change);

/// Thermal displacement x_T = l0 α ΔT [m]. The difference l_T − l0 would lose digits.
double thermal_displacement(const SpringSlider& model, double temperature_change);

/// Stiffness k_T = E A/l_T of the link [N/m], eq. (4).
double link_stiffness(const SpringSlider& model, double temperature_change);

/// Axial force F = k_T (x_T − x) [N] of the link with the block at x [m], positive in compression.
double axial_force(const SpringSlider& model, double temperature_change, double displacement);

/// The model while the block touches its soft stop on side `region` (+1 or −1): the stop's spring
/// is added to the preload spring, and the stops are removed. 0: the model is unchanged.
SpringSlider in_region(const SpringSlider& model, int region);

/// Side (+1 or −1) of the soft stop that a block at x [m] touches; 0 if it touches none.
int region_of(const SpringSlider& model, double displacement);

/// Start of the block, ΔT = 0.
struct Start {
  double displacement = 0.0;  ///< x [m], where D = load, or at the stop if it is reached before
  double load = 0.0;          ///< D0 [N] balanced by friction, without stops
  double middle = 0.0;        ///< p [m], middle of the play
};
Start start_of(const SpringSlider& model);

/// Force D0 [N] that friction balances at the start, ΔT = 0, if there are no stops.
double start_load(const SpringSlider& model);

/// Position x [m] of the block at the start, ΔT = 0. The block rests where D = start_load(), or at
/// a stop in its way; at a soft stop, x exceeds the clearance.
double start_displacement(const SpringSlider& model);

/// Position x [m] of the block if it slides in direction `direction` (+1 or −1), or if it moves in
/// its play (`direction` = 0). Stops are ignored.
double sliding_displacement(const SpringSlider& model, double temperature_change, int direction);

/// ΔT [K] at which D = direction·f (0: D = 0) with the block at x [m]. Inverse of
/// sliding_displacement(). At this ΔT a stuck block starts to slide from x, and a sliding block
/// arrives at x. NaN if there is none (α = 0, or P + k_p x + direction·f >= E A).
double sliding_temperature(const SpringSlider& model, double displacement, int direction);

/// Displacement (D0 − s f)/(k + k_p) [m] after one closed cycle that ends sliding in direction s =
/// `direction` at ΔT = 0 and did not start at a stop. A heating cycle (s = −1) that starts without
/// friction gives f/(k + k_p). The displacement is independent of the clearance and of the largest
/// temperature (paper 3.4).
double state_jump(const SpringSlider& model, int direction = -1);

/// End conditions of a link for its buckling load.
enum class EndCondition { clamped_clamped, pinned_pinned };

/// Euler's buckling load E I π² β/l0² [N] of the unguided link at ΔT = 0 with β = 4 for clamped and
/// β = 1 for pinned ends. `second_moment_of_area` I [m⁴]; NaN, the default, means a square section,
/// I = A²/12. The model assumes a guided link, which never buckles.
double euler_load(const SpringSlider& model, EndCondition ends,
                  double second_moment_of_area = std::numeric_limits<double>::quiet_NaN());

}  // namespace statejump::spring_slider
