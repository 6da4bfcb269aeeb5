// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "statejump/kernel/beam_state.hpp"
#include "statejump/kernel/require.hpp"
#include "statejump/kernel/rotation.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::kernel {

/// Corotational beam with exact rotations of its ends and small strains. One source for the
/// quasi-static solver and the DEM.
///
/// **Frame** (J.-M. Battini and C. Pacoste, Comput. Methods Appl. Mech. Engrg. 191 (2002)
/// 1755-1789). The deformed beam has the chord direction e₁. The mean q of its two section axes 2
/// (weighted by Beam::roll) and e₁ span the plane of e₁ and e₂; e₃ = e₁ × q/|…|. The frame treats
/// both ends alike. The local rotations θ₁, θ₂ of the ends are rotation vectors relative to this
/// frame.
///
/// **Energy.** With s = (θ₁ − θ₂)/2 and a = (θ₁ + θ₂)/2 about each axis k of bending, twist τ, and
/// Φ = 12 E I/(k G A l_T²):
///
///     e = l − l_T + l_T Σ (s²/6 + a²/(10 (1 + Φ)²))
///     W = E A e²/(2 l_T) + G J τ²/(2 l_T) + Σ E I/l_T (2 (s + κ_T l_T/2)² + 6 a²/(1 + Φ))
///
/// The sum in e is the bow of the element: its arc is longer than its chord. Without it, one
/// element per member underestimates the softening by curvature, and free thermal arcs converge
/// with n⁻² instead of n⁻⁴.
///
/// **Forces.** The gradient of W, in frame axes: N = ∂W/∂l, m_i = T(θ_i)⁻ᵀ ∂W/∂θ_i, m = m₁ + m₂.
/// With p_i: axis 2 of end i in frame axes, p = (p₁ + p₂)/2, and η = p_x/p_y:
///
///     force on the second end   F = (N, −m_z/l, (η m_x + m_y)/l), on the first end −F
///     moment on end i           m_i − m_x (p_iy, −p_ix, 0)/(2 p_y)
///
/// **Releases.** Where the rotation of an end is released, the end may rotate against its node. The
/// energy is then the minimum of W over the released local rotations, so that the moment about the
/// released axis is zero. For a given tension N, W is quadratic in the rotations of each plane, and
/// the released ones are
///
///     both ends    s = −2 E I κ_T/h_s,  a = 0
///     first end    θ₁ = ((h_s − h_a) θ₂ − 4 E I κ_T)/(h_s + h_a)
///
/// with h_s = 4 E I/l_T + N l_T/3 and h_a = 12 E I/(l_T (1 + Φ)) + N l_T/(5 (1 + Φ)²). N itself
/// solves N l_T/(E A) = l − l_T + l_T Σ(…), an increasing function of N above the buckling load of
/// the released element. Stiffnesses are Schur complements. A beam without moments is a bar: the
/// rotations of its nodes do not act on it.
///
/// **Tangent.** Derivative of these forces with respect to displacements and left spins in world
/// axes. In frame axes, δl and the spins of the ends relative to the frame determine δF and δm_i.
/// The rotation of the frame itself adds −[F]× and −[M_i]× times its spin. The tangent is symmetric
/// where the moments of all beams at a node balance.
class BeamStep {
 public:
  using Vector12 = Eigen::Matrix<double, 12, 1>;
  using Matrix12 = Eigen::Matrix<double, 12, 12>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  /// Largest local rotation of an end that the theory describes [rad].
  static constexpr double largest_rotation = 1.0;
  /// Rotations below this do not act on an end that rotates far about a released axis [rad].
  static constexpr double negligible_rotation = 1e-6;

  BeamStep(const Beam& beam, const BeamState& at) : beam_(&beam), at_(at) {
    length_ = at.along.norm();
    const std::array<const Quaternion*, 2> rotations{{&at.first, &at.second}};
    std::array<Matrix3, 2> ends;
    for (std::size_t i = 0; i < 2; ++i) ends[i] = rotations[i]->toRotationMatrix() * beam.triad;
    const Vector3 e1 = at.along / length_;
    const bool is_bar = is_free(0) && is_free(1);
    const Vector3 mean =
        is_bar ? across(e1)
               : Vector3(beam.roll[0] * ends[0].col(1) + beam.roll[1] * ends[1].col(1));
    const Vector3 e3 = cross(e1, mean).normalized();
    frame_ << e1, cross(e3, e1), e3;
    for (std::size_t i = 0; i < 2; ++i) {
      axis_[i] = is_bar ? Vector3::UnitY() : Vector3(frame_.transpose() * ends[i].col(1));
      local_[i] = is_free(i) ? Vector3::Zero() : rotation_vector(frame_.transpose() * ends[i]);
      map_[i] = inverse_spin_map(local_[i]);
    }
    mean_ = beam.roll[0] * axis_[0] + beam.roll[1] * axis_[1];
    modes_ << length_, 0.5 * (local_[0].tail<2>() - local_[1].tail<2>()),
        0.5 * (local_[0].tail<2>() + local_[1].tail<2>()), local_[1].x() - local_[0].x();
    for (std::size_t k = 0; k < 2; ++k) {
      shear_[k] = 12.0 * beam.bending[k] / (beam.shear[k] * at.free_length * at.free_length);
    }
    release();
    deform();
  }

  const Matrix3& frame() const { return frame_; }  ///< Columns: e₁, e₂, e₃.
  double length() const { return length_; }        ///< Of the chord [m].
  /// Rotation vector of an end (0 or 1) relative to the frame, in frame axes [rad].
  const Vector3& local_rotation(std::size_t end) const { return local_[end]; }
  /// Largest local rotation of an end, see largest_rotation. A released rotation counts where other
  /// rotations of the node act on the end, because their axes rotate with it.
  double largest_local_rotation() const {
    double largest = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
      Vector3 held = local_[i];
      Vector3 bent = local_[i];
      if (!has_torsion()) held.x() = bent.x() = 0.0;
      for (std::size_t k = 0; k < 2; ++k) {
        if (!is_released(i, k)) continue;
        const auto row = 1 + static_cast<Eigen::Index>(k);
        held[row] = 0.0;
        bent[row] = antisymmetric(k) + (i == 0 ? symmetric(k) : -symmetric(k));
      }
      largest = std::max(largest, bent.norm());
      if (held.norm() > negligible_rotation) largest = std::max(largest, local_[i].norm());
    }
    return largest;
  }
  /// Whether the compression exceeds the buckling load of an element with released ends.
  bool buckles() const { return natural_[0] <= least_tension(); }

  /// Elastic energy [J].
  double energy() const {
    const double free = at_.free_length;
    double sum = beam_->axial * stretch_ * stretch_ + torsional() * twist() * twist();
    for (std::size_t k = 0; k < 2; ++k) {
      const double bent = bending_strain(k);
      sum += 2.0 * beam_->bending[k] *
             (2.0 * bent * bent + 6.0 * antisymmetric(k) * antisymmetric(k) / (1.0 + shear_[k]));
    }
    return 0.5 * sum / free;
  }

  /// Axial force, tension positive [N].
  double tension() const { return natural_[0]; }
  /// gradient() in the axes of the frame: N, V₂, V₃ [N] and T, M₂, M₃ [N m] of the first end, then
  /// of the second.
  Vector12 gradient_in_frame() const { return in_frame(local_force_); }

  /// Gradient of the energy, that is force and moment that the ends exert on the beam, in world
  /// axes: force [N] and moment [N m] of the first end, then of the second.
  Vector12 gradient() const { return to_world(in_frame(local_force_)); }

  /// Derivative of gradient() with respect to displacements and left spins of both ends, world
  /// axes.
  Matrix12 tangent() const {
    const Matrix7 stiffness = local_stiffness();
    Matrix127 by_basic;
    for (int j = 0; j < 7; ++j) by_basic.col(j) = in_frame(stiffness.col(j));
    add_geometry(by_basic);
    Matrix12 made = by_basic * basic_rates();
    const Vector12 force = in_frame(local_force_);
    const Matrix312 spin = frame_spin();
    for (int block = 0; block < 4; ++block) {
      made.middleRows<3>(3 * block) -= skew(force.segment<3>(3 * block)) * spin;
    }
    for (int row = 0; row < 4; ++row) {
      made.middleRows<3>(3 * row) = (frame_ * made.middleRows<3>(3 * row)).eval();
    }
    for (int column = 0; column < 4; ++column) {
      made.middleCols<3>(3 * column) = (made.middleCols<3>(3 * column) * frame_.transpose()).eval();
    }
    return made;
  }

  /// Rates of the natural modes (l, s₂, s₃, a₂, a₃, τ) [m/s, rad/s].
  /// @param velocities velocity [m/s] and spin [rad/s] of the first end, then of the second, world
  ///     axes
  Vector6 mode_rates(const Vector12& velocities) const {
    Vector12 local;
    for (int k = 0; k < 4; ++k) {
      local.segment<3>(3 * k) = frame_.transpose() * velocities.segment<3>(3 * k);
    }
    const Vector3 apart = (local.segment<3>(6) - local.segment<3>(0)) / length_;
    Vector3 spin(0.0, -apart.z(), apart.y());
    spin.x() = mean_.x() / mean_.y() * spin.y();
    for (int i = 0; i < 2; ++i) {
      const auto end = static_cast<std::size_t>(i);
      const Vector3 own = local.segment<3>(3 + 6 * i);
      spin.x() +=
          beam_->roll[end] / mean_.y() * (axis_[end].y() * own.x() - axis_[end].x() * own.y());
    }
    const Vector3 first = map_[0] * (local.segment<3>(3) - spin);
    const Vector3 second = map_[1] * (local.segment<3>(9) - spin);
    Vector6 made;
    made << local[6] - local[0], 0.5 * (first.tail<2>() - second.tail<2>()),
        0.5 * (first.tail<2>() + second.tail<2>()), second.x() - first.x();
    return made;
  }
  /// Stiffnesses of the natural modes at the present tension [N/m, N m].
  Vector6 mode_stiffness() const {
    Vector6 made;
    made[0] = beam_->axial / at_.free_length;
    for (std::size_t k = 0; k < 2; ++k) {
      const std::array<double, 2> plane = plane_stiffness(k, natural_[0]);
      made[symmetric_row(k)] = plane[0];
      made[antisymmetric_row(k)] = plane[1];
    }
    made[5] = torsional() / at_.free_length;
    return made;
  }
  /// Whether the mode exists: no rotation about its axis is released.
  bool has_mode(Eigen::Index mode) const {
    if (mode == 0) return beam_->axial > 0.0;
    if (mode == 5) return has_torsion();
    const auto k = static_cast<std::size_t>((mode - 1) % 2);
    return !is_released(0, k) && !is_released(1, k);
  }
  /// Forces and moments of the ends, as in_frame(), that balance forces on the natural modes.
  Vector12 balance_in_frame(const Vector6& natural) const {
    Vector7 made = to_local(natural);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto row = 1 + 3 * static_cast<Eigen::Index>(i);
      made.segment<3>(row) = (map_[i].transpose() * made.segment<3>(row)).eval();
    }
    return in_frame(made);
  }
  /// Forces and moments in world axes for those in the axes of the frame.
  Vector12 to_world(const Vector12& in_frame) const {
    Vector12 made;
    for (int k = 0; k < 4; ++k) made.segment<3>(3 * k) = frame_ * in_frame.segment<3>(3 * k);
    return made;
  }

  /// ∂W/∂l_T at fixed ends and stress-free curvature [N].
  double by_length() const {
    const double free = at_.free_length;
    double sum = beam_->axial * stretch_ * (stretch_by_length_ - 0.5 * stretch_ / free) -
                 0.5 * torsional() * twist() * twist() / free;
    for (std::size_t k = 0; k < 2; ++k) {
      const double bent = bending_strain(k);
      const double a = antisymmetric(k);
      const double soft = 1.0 + shear_[k];
      sum += beam_->bending[k] * (2.0 * bent * (at_.curvature[k] - bent / free) +
                                  6.0 * a * a * (shear_[k] - 1.0) / (free * soft * soft));
    }
    return sum / free;
  }
  /// ∂W/∂κ_T about axis 2 (k = 0) or 3 (k = 1) [N m²/m].
  double by_curvature(std::size_t k) const { return 2.0 * beam_->bending[k] * bending_strain(k); }

  /// Derivative of gradient() by l_T.
  Vector12 gradient_by_length() const {
    const double free = at_.free_length;
    const double axial = beam_->axial;
    Vector6 rate;
    rate[0] = axial / free * (stretch_by_length_ - stretch_ / free);
    for (std::size_t k = 0; k < 2; ++k) {
      const double soft = 1.0 + shear_[k];
      const double a = antisymmetric(k);
      const double bow = 1.0 / (soft * soft);
      const double bow_by_length = 4.0 * shear_[k] / (free * soft * soft * soft);
      rate[symmetric_row(k)] =
          (-4.0 * beam_->bending[k] / (free * free) + axial * stretch_by_length_ / 3.0) *
          symmetric(k);
      rate[antisymmetric_row(k)] =
          (12.0 * beam_->bending[k] * (shear_[k] - 1.0) / (free * free * soft * soft) +
           axial * (stretch_by_length_ * bow + stretch_ * bow_by_length) / 5.0) *
          a;
    }
    rate[5] = -torsional() * twist() / (free * free);
    return to_world(in_frame(to_ends(rate)));
  }
  /// Derivative of gradient() by κ_T about axis 2 (k = 0) or 3 (k = 1).
  Vector12 gradient_by_curvature(std::size_t k) const {
    Vector6 rate = Vector6::Zero();
    rate[symmetric_row(k)] = 2.0 * beam_->bending[k];
    return to_world(in_frame(to_ends(rate)));
  }

 private:
  using Vector7 = Eigen::Matrix<double, 7, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Matrix7 = Eigen::Matrix<double, 7, 7>;
  using Matrix67 = Eigen::Matrix<double, 6, 7>;
  using Matrix127 = Eigen::Matrix<double, 12, 7>;
  using Matrix712 = Eigen::Matrix<double, 7, 12>;
  using Matrix312 = Eigen::Matrix<double, 3, 12>;

  static Eigen::Index symmetric_row(std::size_t k) { return 1 + static_cast<Eigen::Index>(k); }
  static Eigen::Index antisymmetric_row(std::size_t k) { return 3 + static_cast<Eigen::Index>(k); }
  double symmetric(std::size_t k) const { return modes_[symmetric_row(k)]; }
  double antisymmetric(std::size_t k) const { return modes_[antisymmetric_row(k)]; }
  double twist() const { return modes_[5]; }
  bool is_released(std::size_t end, std::size_t k) const { return beam_->released[end][1 + k]; }
  bool has_torsion() const { return !beam_->released[0][0] && !beam_->released[1][0]; }
  double torsional() const { return has_torsion() ? beam_->torsional : 0.0; }
  /// Whether no moment acts on an end.
  bool is_free(std::size_t end) const {
    return !has_torsion() && is_released(end, 0) && is_released(end, 1);
  }
  bool has_releases() const {
    return is_released(0, 0) || is_released(0, 1) || is_released(1, 0) || is_released(1, 1);
  }
  static Vector3 across(const Vector3& e1) {
    Eigen::Index least = 0;
    e1.cwiseAbs().minCoeff(&least);
    return cross(e1, Vector3::Unit(least));
  }
  /// h_s and h_a of a plane at a tension [N m].
  std::array<double, 2> plane_stiffness(std::size_t k, double tension) const {
    const double free = at_.free_length;
    const double soft = 1.0 + shear_[k];
    return {{4.0 * beam_->bending[k] / free + tension * free / 3.0,
             12.0 * beam_->bending[k] / (free * soft) + tension * free / (5.0 * soft * soft)}};
  }
  /// Tension at which a released element buckles, < 0 [N]; minus infinity without releases.
  double least_tension() const {
    double least = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 2; ++k) {
      const double soft = 1.0 + shear_[k];
      const double unit = beam_->bending[k] / (at_.free_length * at_.free_length);
      if (is_released(0, k) && is_released(1, k)) {
        least = std::max(least, -unit * std::min(12.0, 60.0 * soft));
      } else if (is_released(0, k) || is_released(1, k)) {
        least = std::max(least, -unit * (4.0 + 12.0 / soft) / (1.0 / 3.0 + 0.2 / (soft * soft)));
      }
    }
    return beam_->axial > 0.0 ? least : -std::numeric_limits<double>::infinity();
  }

  /// Bow of an element in one plane over its length, and its derivative by the tension.
  struct Bow {
    double value = 0.0;
    double slope = 0.0;
  };
  /// Rotates the released ends of plane k such that their moments are zero at a tension.
  Bow settle(std::size_t k, double tension) {
    const bool first = is_released(0, k);
    const bool second = is_released(1, k);
    const auto [hs, ha] = plane_stiffness(k, tension);
    const double free = at_.free_length;
    const double soft = 1.0 + shear_[k];
    const double bent = 2.0 * beam_->bending[k] * at_.curvature[k];
    const auto row = 1 + static_cast<Eigen::Index>(k);
    double one = local_[0][row];
    double other = local_[1][row];
    double& s = modes_[symmetric_row(k)];
    double& a = modes_[antisymmetric_row(k)];
    if (first && second) {
      s = -bent / hs;
      a = 0.0;
    } else if (first || second) {
      if (first) one = ((hs - ha) * other - 2.0 * bent) / (hs + ha);
      if (second) other = ((hs - ha) * one + 2.0 * bent) / (hs + ha);
      s = 0.5 * (one - other);
      a = 0.5 * (one + other);
    }
    const double by_s = free * s / 3.0;
    const double by_a = free * a / (5.0 * soft * soft);
    Bow made{s * s / 6.0 + a * a / (10.0 * soft * soft), 0.0};
    if (first && second) {
      made.slope = -by_s * by_s / (hs * free);
    } else if (first || second) {
      const double by_end = 0.5 * (first ? by_a + by_s : by_a - by_s);
      made.slope = -4.0 * by_end * by_end / ((hs + ha) * free);
    }
    return made;
  }
  Bow settle(double tension) {
    const Bow one = settle(0, tension);
    const Bow other = settle(1, tension);
    return {one.value + other.value, one.slope + other.slope};
  }

  /// Finds the tension, and with it the released rotations.
  void release() {
    if (!has_releases()) return;
    if (!(beam_->axial > 0.0)) {
      settle(0.0);
      return;
    }
    const double free = at_.free_length;
    const double compliance = free / beam_->axial;
    double low = least_tension();
    double high = std::max(0.0, (at_.stretch + free * settle(0.0).value) / compliance);
    double tension = high;
    constexpr int most_iterations = 200;
    for (int i = 0; i < most_iterations; ++i) {
      const Bow bow = settle(tension);
      const double misfit = compliance * tension - at_.stretch - free * bow.value;
      (misfit > 0.0 ? high : low) = tension;
      double next = tension - misfit / (compliance - free * bow.slope);
      if (!(next > low)) next = 0.5 * (tension + low);
      if (!(next <= high)) next = 0.5 * (tension + high);
      const double change = std::abs(next - tension);
      if (change <= 4.0 * std::numeric_limits<double>::epsilon() * std::abs(tension)) break;
      tension = next;
    }
  }
  /// s + κ_T l_T/2.
  double bending_strain(std::size_t k) const {
    return symmetric(k) + 0.5 * at_.curvature[k] * at_.free_length;
  }

  /// Strains and forces of the natural modes (l, s₂, s₃, a₂, a₃, τ).
  void deform() {
    const double free = at_.free_length;
    double bow = 0.0;
    double bow_by_length = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double soft = 1.0 + shear_[k];
      const double a = antisymmetric(k) / soft;
      bow += symmetric(k) * symmetric(k) / 6.0 + a * a / 10.0;
      bow_by_length += a * a / 10.0 * 4.0 * shear_[k] / soft;
    }
    stretch_ = at_.stretch + free * bow;
    stretch_by_length_ = -1.0 + bow + bow_by_length;
    natural_[0] = beam_->axial * stretch_ / free;
    stretch_gradient_ << 1.0, 0.0, 0.0, 0.0, 0.0, 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double soft = 1.0 + shear_[k];
      stretch_gradient_[symmetric_row(k)] = free * symmetric(k) / 3.0;
      stretch_gradient_[antisymmetric_row(k)] = free * antisymmetric(k) / (5.0 * soft * soft);
      const double bending = beam_->bending[k] / free;
      natural_[symmetric_row(k)] =
          4.0 * bending * bending_strain(k) + natural_[0] * stretch_gradient_[symmetric_row(k)];
      natural_[antisymmetric_row(k)] = 12.0 * bending * antisymmetric(k) / soft +
                                       natural_[0] * stretch_gradient_[antisymmetric_row(k)];
    }
    natural_[5] = torsional() * twist() / free;
    local_force_ = to_local(natural_);
    for (const int row : released_rows()) local_force_[row] = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto row = 1 + 3 * static_cast<Eigen::Index>(i);
      end_force_.segment<3>(row) = local_force_.segment<3>(row);
      local_force_.segment<3>(row) = (map_[i].transpose() * end_force_.segment<3>(row)).eval();
    }
    end_force_[0] = local_force_[0];
  }

  /// Forces of the natural modes as forces on (l, θ₁, θ₂).
  static Vector7 to_local(const Vector6& natural) {
    Vector7 made;
    made << natural[0], -natural[5], 0.5 * (natural.segment<2>(1) + natural.segment<2>(3)),
        natural[5], 0.5 * (natural.segment<2>(3) - natural.segment<2>(1));
    return made;
  }
  /// Released rotations among (l, θ₁, θ₂).
  std::vector<int> released_rows() const {
    std::vector<int> rows;
    for (std::size_t end = 0; end < 2; ++end) {
      for (std::size_t k = 0; k < 2; ++k) {
        if (is_released(end, k)) rows.push_back(2 + static_cast<int>(3 * end + k));
      }
    }
    return rows;
  }
  /// Rates of forces of the natural modes as those on (l, spins of the ends relative to the frame),
  /// where released ends follow.
  Vector7 to_ends(const Vector6& natural) const {
    Vector7 made = to_local(natural);
    Matrix7 stiffness = rotation_stiffness();
    for (const int row : released_rows()) eliminate(row, stiffness, &made);
    made.segment<3>(1) = (map_[0].transpose() * made.segment<3>(1)).eval();
    made.segment<3>(4) = (map_[1].transpose() * made.segment<3>(4)).eval();
    return made;
  }

  /// Hessian of W by (l, θ₁, θ₂).
  Matrix7 rotation_stiffness() const {
    const double free = at_.free_length;
    Matrix6 natural = beam_->axial / free * stretch_gradient_ * stretch_gradient_.transpose();
    for (std::size_t k = 0; k < 2; ++k) {
      const std::array<double, 2> plane = plane_stiffness(k, natural_[0]);
      natural(symmetric_row(k), symmetric_row(k)) += plane[0];
      natural(antisymmetric_row(k), antisymmetric_row(k)) += plane[1];
    }
    natural(5, 5) += torsional() / free;
    Matrix67 modes = Matrix67::Zero();  // by (l, θ₁, θ₂)
    modes(0, 0) = 1.0;
    for (int k = 0; k < 2; ++k) {
      modes(1 + k, 2 + k) = modes(3 + k, 2 + k) = modes(3 + k, 5 + k) = 0.5;
      modes(1 + k, 5 + k) = -0.5;
    }
    modes(5, 1) = -1.0;
    modes(5, 4) = 1.0;
    return modes.transpose() * natural * modes;
  }

  /// Removes the coordinate `row` from a stiffness and a force, as if no force acted on it.
  static void eliminate(int row, Matrix7& stiffness, Vector7* force) {
    const Vector7 column = stiffness.col(row) / stiffness(row, row);
    if (force != nullptr) *force -= column * (*force)[row];
    const Eigen::Matrix<double, 1, 7> own = stiffness.row(row);
    stiffness -= column * own;
    stiffness.row(row).setZero();
    stiffness.col(row).setZero();
  }

  /// Derivative of (N, m₁, m₂) with respect to l and the spins of the ends relative to the frame.
  Matrix7 local_stiffness() const {
    Matrix7 made = rotation_stiffness();
    for (const int row : released_rows()) eliminate(row, made, nullptr);
    for (int i = 0; i < 2; ++i) {
      const auto which = static_cast<std::size_t>(i);
      const int row = 1 + 3 * i;
      made.middleCols<3>(row) = (made.middleCols<3>(row) * map_[which]).eval();
      made.middleRows<3>(row) = (map_[which].transpose() * made.middleRows<3>(row)).eval();
      made.block<3, 3>(row, row) +=
          inverse_spin_map_derivative(local_[which], end_force_.segment<3>(row)) * map_[which];
    }
    return made;
  }

  /// Forces and moments on both ends in frame axes for given N, m₁, m₂.
  Vector12 in_frame(const Vector7& basic) const {
    const Vector3 first = basic.segment<3>(1);
    const Vector3 second = basic.segment<3>(4);
    const Vector3 sum = first + second;
    const double slope = mean_.x() / mean_.y();
    const Vector3 force(basic[0], -sum.z() / length_, (slope * sum.x() + sum.y()) / length_);
    const double share = sum.x() / mean_.y();
    const std::array<double, 2>& roll = beam_->roll;
    Vector12 made;
    made << -force, first - roll[0] * share * Vector3(axis_[0].y(), -axis_[0].x(), 0.0), force,
        second - roll[1] * share * Vector3(axis_[1].y(), -axis_[1].x(), 0.0);
    return made;
  }

  /// Adds the derivatives of in_frame() at fixed N, m₁, m₂ by l and the axes p_i.
  void add_geometry(Matrix127& made) const {
    const Vector3 sum = local_force_.segment<3>(1) + local_force_.segment<3>(4);
    const double slope = mean_.x() / mean_.y();
    const Vector3 by_length(0.0, sum.z() / (length_ * length_),
                            -(slope * sum.x() + sum.y()) / (length_ * length_));
    made.block<3, 1>(0, 0) -= by_length;
    made.block<3, 1>(6, 0) += by_length;
    const auto share = [&](int i) {
      return beam_->roll[static_cast<std::size_t>(i)] * sum.x() / mean_.y();
    };
    for (int i = 0; i < 2; ++i) {
      const double weight = beam_->roll[static_cast<std::size_t>(i)];
      // δp_i = spin × p_i
      const Matrix3 axis_rate = -skew(axis_[static_cast<std::size_t>(i)]);
      const Eigen::RowVector3d mean_x = weight * axis_rate.row(0);
      const Eigen::RowVector3d mean_y = weight * axis_rate.row(1);
      const Eigen::RowVector3d transverse =
          sum.x() / (length_ * mean_.y()) * (mean_x - slope * mean_y);
      const int column = 1 + 3 * i;
      made.block<1, 3>(2, column) -= transverse;
      made.block<1, 3>(8, column) += transverse;
      for (int j = 0; j < 2; ++j) {
        const Vector3& axis = axis_[static_cast<std::size_t>(j)];
        const int row = 3 + 6 * j;
        made.block<1, 3>(row, column) += share(j) * axis.y() / mean_.y() * mean_y;
        made.block<1, 3>(row + 1, column) -= share(j) * axis.x() / mean_.y() * mean_y;
      }
      const int row = 3 + 6 * i;
      made.block<1, 3>(row, column) -= share(i) * axis_rate.row(1);
      made.block<1, 3>(row + 1, column) += share(i) * axis_rate.row(0);
    }
  }

  /// Spin of the frame in frame axes, per displacement and spin of the ends in frame axes.
  Matrix312 frame_spin() const {
    Matrix312 made = Matrix312::Zero();
    made(2, 1) = -1.0 / length_;
    made(2, 7) = 1.0 / length_;
    made(1, 2) = 1.0 / length_;
    made(1, 8) = -1.0 / length_;
    const double slope = mean_.x() / mean_.y();
    made.row(0) = slope * made.row(1);
    for (int i = 0; i < 2; ++i) {
      const Vector3& axis = axis_[static_cast<std::size_t>(i)];
      const double weight = beam_->roll[static_cast<std::size_t>(i)];
      made(0, 3 + 6 * i) = weight * axis.y() / mean_.y();
      made(0, 4 + 6 * i) = -weight * axis.x() / mean_.y();
    }
    return made;
  }

  /// Rates of l and of the spins of the ends relative to the frame.
  Matrix712 basic_rates() const {
    const Matrix312 spin = frame_spin();
    Matrix712 made;
    made.row(0).setZero();
    made(0, 0) = -1.0;
    made(0, 6) = 1.0;
    made.middleRows<3>(1) = -spin;
    made.middleRows<3>(4) = -spin;
    made.block<3, 3>(1, 3) += Matrix3::Identity();
    made.block<3, 3>(4, 9) += Matrix3::Identity();
    return made;
  }

  const Beam* beam_;
  BeamState at_;
  double length_;
  Matrix3 frame_;
  std::array<Vector3, 2> axis_;   // axis 2 of the ends in frame axes
  std::array<Vector3, 2> local_;  // local rotations
  std::array<Matrix3, 2> map_;    // inverse_spin_map() of them
  Vector3 mean_;                  // of axis_
  Vector6 modes_;                 // l, s₂, s₃, a₂, a₃, τ
  std::array<double, 2> shear_;   // Φ
  double stretch_;                // e
  double stretch_by_length_;      // ∂e/∂l_T
  Vector6 stretch_gradient_;      // of e by the natural modes
  Vector6 natural_;               // forces on the natural modes
  Vector7 end_force_;             // forces on l, θ₁, θ₂
  Vector7 local_force_;           // N, m₁, m₂
};

/// The beam at a state, for energy, forces and tangent.
/// @throws OutOfRange if an end rotates by more than 1 rad relative to the beam
inline BeamStep beam_step(const Beam& beam, const BeamState& at) {
  BeamStep made(beam, at);
  require(made.largest_local_rotation() <= BeamStep::largest_rotation,
          "rotation of an end relative to the beam", made.largest_local_rotation(),
          "at most 1 rad; divide the beam into more elements");
  return made;
}

}  // namespace statejump::kernel
