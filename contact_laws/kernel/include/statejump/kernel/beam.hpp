// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "statejump/kernel/require.hpp"
#include "statejump/kernel/rotation.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::kernel {

/// Straight prismatic beam: stiffnesses, and its triad in the reference configuration. Axis 1 runs
/// along the beam, axes 2 and 3 are the principal axes of the section. The shear centre is the
/// centroid, and there is no warping.
struct Beam {
  double axial = 0.0;                     ///< E A [N], > 0.
  double torsional = 0.0;                 ///< G J [N m²], > 0.
  std::array<double, 2> bending{{0, 0}};  ///< E I about axes 2 and 3 [N m²], > 0.
  /// k G A for the shear force that bends about axes 2 and 3, thus along axes 3 and 2 [N], > 0.
  /// Infinity: no shear deformation.
  std::array<double, 2> shear{
      {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()}};
  Matrix3 triad = Matrix3::Identity();  ///< Columns: axes 1, 2, 3.
};

/// Configuration and stress-free shape of a beam.
struct BeamState {
  Vector3 along = Vector3::Zero();  ///< From the first end to the second [m].
  /// Length minus stress-free length [m]. It is separate, because the difference of two lengths
  /// would lose digits.
  double stretch = 0.0;
  Quaternion first = Quaternion::Identity();  ///< Rotation of the first end since the reference.
  Quaternion second = Quaternion::Identity();
  double free_length = 0.0;                     ///< Stress-free length l_T [m], > 0.
  std::array<double, 2> curvature{{0.0, 0.0}};  ///< Stress-free, about axes 2 and 3 [1/m].
};

/// Corotational beam with exact rotations of its ends and small strains. One source for the
/// quasi-static solver and the DEM.
///
/// **Frame** (J.-M. Battini and C. Pacoste, Comput. Methods Appl. Mech. Engrg. 191 (2002)
/// 1755-1789). The deformed beam has the chord direction e₁. The mean q of its two section axes 2
/// and e₁ span the plane of e₁ and e₂; e₃ = e₁ × q/|…|. The frame treats both ends alike. The local
/// rotations θ₁, θ₂ of the ends are rotation vectors relative to this frame.
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
/// **Tangent.** Derivative of these forces with respect to displacements and left spins in world
/// axes. In frame axes, δl and the spins of the ends relative to the frame determine δF and δm_i.
/// The rotation of the frame itself adds −[F]× and −[M_i]× times its spin. The tangent is symmetric
/// where the moments of all beams at a node balance.
class BeamStep {
 public:
  using Vector12 = Eigen::Matrix<double, 12, 1>;
  using Matrix12 = Eigen::Matrix<double, 12, 12>;

  /// Largest local rotation of an end that the theory describes [rad].
  static constexpr double largest_rotation = 1.0;

  BeamStep(const Beam& beam, const BeamState& at) : beam_(&beam), at_(at) {
    length_ = at.along.norm();
    const std::array<const Quaternion*, 2> rotations{{&at.first, &at.second}};
    std::array<Matrix3, 2> ends;
    for (std::size_t i = 0; i < 2; ++i) ends[i] = rotations[i]->toRotationMatrix() * beam.triad;
    const Vector3 mean = 0.5 * (ends[0].col(1) + ends[1].col(1));
    const Vector3 e1 = at.along / length_;
    const Vector3 e3 = cross(e1, mean).normalized();
    frame_ << e1, cross(e3, e1), e3;
    for (std::size_t i = 0; i < 2; ++i) {
      axis_[i] = frame_.transpose() * ends[i].col(1);
      local_[i] = rotation_vector(frame_.transpose() * ends[i]);
      map_[i] = inverse_spin_map(local_[i]);
    }
    mean_ = 0.5 * (axis_[0] + axis_[1]);
    modes_ << length_, 0.5 * (local_[0].tail<2>() - local_[1].tail<2>()),
        0.5 * (local_[0].tail<2>() + local_[1].tail<2>()), local_[1].x() - local_[0].x();
    deform();
  }

  const Matrix3& frame() const { return frame_; }  ///< Columns: e₁, e₂, e₃.
  double length() const { return length_; }        ///< Of the chord [m].
  /// Rotation vector of an end (0 or 1) relative to the frame, in frame axes [rad].
  const Vector3& local_rotation(std::size_t end) const { return local_[end]; }
  double largest_local_rotation() const { return std::max(local_[0].norm(), local_[1].norm()); }

  /// Elastic energy [J].
  double energy() const {
    const double free = at_.free_length;
    double sum = beam_->axial * stretch_ * stretch_ + beam_->torsional * twist() * twist();
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

  /// ∂W/∂l_T at fixed ends and stress-free curvature [N].
  double by_length() const {
    const double free = at_.free_length;
    double sum = beam_->axial * stretch_ * (stretch_by_length_ - 0.5 * stretch_ / free) -
                 0.5 * beam_->torsional * twist() * twist() / free;
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
    rate[5] = -beam_->torsional * twist() / (free * free);
    return to_world(in_frame(to_ends(rate)));
  }
  /// Derivative of gradient() by κ_T about axis 2 (k = 0) or 3 (k = 1).
  Vector12 gradient_by_curvature(std::size_t k) const {
    Vector6 rate = Vector6::Zero();
    rate[symmetric_row(k)] = 2.0 * beam_->bending[k];
    return to_world(in_frame(to_ends(rate)));
  }

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
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
      shear_[k] = 12.0 * beam_->bending[k] / (beam_->shear[k] * free * free);
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
    natural_[5] = beam_->torsional * twist() / free;
    local_force_ = to_local(natural_);
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
  /// Forces of the natural modes as forces on (l, spins of the ends relative to the frame).
  Vector7 to_ends(const Vector6& natural) const {
    Vector7 made = to_local(natural);
    made.segment<3>(1) = (map_[0].transpose() * made.segment<3>(1)).eval();
    made.segment<3>(4) = (map_[1].transpose() * made.segment<3>(4)).eval();
    return made;
  }

  /// Derivative of (N, m₁, m₂) with respect to l and the spins of the ends relative to the frame.
  Matrix7 local_stiffness() const {
    const double free = at_.free_length;
    Matrix6 natural = beam_->axial / free * stretch_gradient_ * stretch_gradient_.transpose();
    for (std::size_t k = 0; k < 2; ++k) {
      const double soft = 1.0 + shear_[k];
      const double bending = beam_->bending[k] / free;
      natural(symmetric_row(k), symmetric_row(k)) += 4.0 * bending + natural_[0] * free / 3.0;
      natural(antisymmetric_row(k), antisymmetric_row(k)) +=
          12.0 * bending / soft + natural_[0] * free / (5.0 * soft * soft);
    }
    natural(5, 5) += beam_->torsional / free;
    Matrix67 rates = Matrix67::Zero();  // of the natural modes
    rates(0, 0) = 1.0;
    for (int k = 0; k < 2; ++k) {
      rates.row(1 + k).segment<3>(1) = 0.5 * map_[0].row(1 + k);
      rates.row(1 + k).segment<3>(4) = -0.5 * map_[1].row(1 + k);
      rates.row(3 + k).segment<3>(1) = 0.5 * map_[0].row(1 + k);
      rates.row(3 + k).segment<3>(4) = 0.5 * map_[1].row(1 + k);
    }
    rates.row(5).segment<3>(1) = -map_[0].row(0);
    rates.row(5).segment<3>(4) = map_[1].row(0);
    Matrix7 made = rates.transpose() * natural * rates;
    for (int i = 0; i < 2; ++i) {
      const auto which = static_cast<std::size_t>(i);
      const int row = 1 + 3 * i;
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
    const double share = 0.5 * sum.x() / mean_.y();
    Vector12 made;
    made << -force, first - share * Vector3(axis_[0].y(), -axis_[0].x(), 0.0), force,
        second - share * Vector3(axis_[1].y(), -axis_[1].x(), 0.0);
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
    const double share = 0.5 * sum.x() / mean_.y();
    for (int i = 0; i < 2; ++i) {
      // δp_i = spin × p_i
      const Matrix3 axis_rate = -skew(axis_[static_cast<std::size_t>(i)]);
      const Eigen::RowVector3d mean_x = 0.5 * axis_rate.row(0);
      const Eigen::RowVector3d mean_y = 0.5 * axis_rate.row(1);
      const Eigen::RowVector3d transverse =
          sum.x() / (length_ * mean_.y()) * (mean_x - slope * mean_y);
      const int column = 1 + 3 * i;
      made.block<1, 3>(2, column) -= transverse;
      made.block<1, 3>(8, column) += transverse;
      for (int j = 0; j < 2; ++j) {
        const Vector3& axis = axis_[static_cast<std::size_t>(j)];
        const int row = 3 + 6 * j;
        made.block<1, 3>(row, column) += share * axis.y() / mean_.y() * mean_y;
        made.block<1, 3>(row + 1, column) -= share * axis.x() / mean_.y() * mean_y;
      }
      const int row = 3 + 6 * i;
      made.block<1, 3>(row, column) -= share * axis_rate.row(1);
      made.block<1, 3>(row + 1, column) += share * axis_rate.row(0);
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
      made(0, 3 + 6 * i) = 0.5 * axis.y() / mean_.y();
      made(0, 4 + 6 * i) = -0.5 * axis.x() / mean_.y();
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

  Vector12 to_world(const Vector12& in_frame) const {
    Vector12 made;
    for (int k = 0; k < 4; ++k) made.segment<3>(3 * k) = frame_ * in_frame.segment<3>(3 * k);
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
