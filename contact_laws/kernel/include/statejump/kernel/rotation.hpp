// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>

#include "statejump/kernel/vector.hpp"

namespace statejump::kernel {

using Matrix3 = Eigen::Matrix3d;
using Quaternion = Eigen::Quaterniond;

/// Matrix S with S x = v × x.
inline Matrix3 skew(const Vector3& v) {
  Matrix3 made;
  made << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return made;
}

/// A coefficient f(a) of a rotation formula and f'(a)/a, both even functions of the angle a [rad].
struct AngleCoefficient {
  double value;
  double slope;
};

/// Sums f = Σ c_k a^(2k) and f'/a = Σ 2k c_k a^(2k-2).
template <std::size_t terms>
AngleCoefficient angle_series(const std::array<double, terms>& c, double squared) {
  AngleCoefficient sum{0.0, 0.0};
  for (std::size_t k = terms; k-- > 0;) {
    sum.value = sum.value * squared + c[k];
    if (k > 0) sum.slope = sum.slope * squared + 2.0 * static_cast<double>(k) * c[k];
  }
  return sum;
}

/// Rotation vector of a rotation matrix [rad], unique below π.
inline Vector3 rotation_vector(const Matrix3& turned) {
  Vector3 v(0.5 * (turned(2, 1) - turned(1, 2)), 0.5 * (turned(0, 2) - turned(2, 0)),
            0.5 * (turned(1, 0) - turned(0, 1)));
  const double sine = v.norm();
  if (sine == 0.0) return v;
  return std::atan2(sine, 0.5 * (turned.trace() - 1.0)) / sine * v;
}

/// Quaternion of a rotation vector [rad].
inline Quaternion rotation_of(const Vector3& vector) {
  const double angle = vector.norm();
  if (angle == 0.0) return Quaternion::Identity();
  const Vector3 part = std::sin(0.5 * angle) / angle * vector;
  return {std::cos(0.5 * angle), part.x(), part.y(), part.z()};
}

/// (R - I) r of a rotation R, without the difference of two vectors.
inline Vector3 moved_by(const Quaternion& rotation, const Vector3& r) {
  const Vector3 once = 2.0 * rotation.vec().cross(r);
  return rotation.w() * once + rotation.vec().cross(once);
}

/// (1 - (a/2) cot(a/2))/a²: the series is exact to rounding up to 1 rad.
inline AngleCoefficient inverse_spin_coefficient(double angle) {
  // |B_2k|/(2k)!
  static constexpr std::array<double, 10> c{
      1.0 / 12.0,           1.0 / 720.0,           1.0 / 30240.0,         1.0 / 1209600.0,
      1.0 / 47900160.0,     5.284190138687493e-10, 1.338253653068468e-11, 3.389680296322583e-13,
      8.58606205627785e-15, 2.174868698558062e-16};
  const double squared = angle * angle;
  if (angle < 1.0) return angle_series(c, squared);
  const double half = 0.5 * angle;
  const double cotangent = 1.0 / std::tan(half);
  const double value = (1.0 - half * cotangent) / squared;
  const double sine = std::sin(half);
  return {value, (0.5 * (half / (sine * sine) - cotangent) / angle - 2.0 * value) / squared};
}

/// The matrix that maps a spin (left, world axes) to the rate of the rotation vector: I - S/2 + c
/// S², S = skew(vector).
inline Matrix3 inverse_spin_map(const Vector3& vector) {
  const Matrix3 s = skew(vector);
  return Matrix3::Identity() - 0.5 * s + inverse_spin_coefficient(vector.norm()).value * s * s;
}

/// Derivative of inverse_spin_map(vector)ᵀ n with respect to the rotation vector.
inline Matrix3 inverse_spin_map_derivative(const Vector3& vector, const Vector3& n) {
  const AngleCoefficient c = inverse_spin_coefficient(vector.norm());
  const double along = vector.dot(n);
  const Vector3 twice = along * vector - vector.squaredNorm() * n;  // vector × (vector × n)
  return -0.5 * skew(n) +
         c.value *
             (vector * n.transpose() + along * Matrix3::Identity() - 2.0 * n * vector.transpose()) +
         c.slope * twice * vector.transpose();
}

/// Coefficients (1 - cos a)/a² and (a - sin a)/a³ of the matrix I + c₁ S + c₂ S² that maps the rate
/// of the rotation vector to the spin. The series are exact to rounding up to 2 rad.
struct SpinCoefficients {
  AngleCoefficient first, second;
};
inline SpinCoefficients spin_coefficients(double angle) {
  const double squared = angle * angle;
  if (angle < 2.0) {
    std::array<double, 12> first{}, second{};
    double factor = 0.5;  // (-1)^k/(2k + 2)!
    for (std::size_t k = 0; k < first.size(); ++k) {
      const double n = 2.0 * static_cast<double>(k);
      first[k] = factor;
      second[k] = factor / (n + 3.0);
      factor /= -(n + 3.0) * (n + 4.0);
    }
    return {angle_series(first, squared), angle_series(second, squared)};
  }
  const double sine = std::sin(angle);
  const double cosine = std::cos(angle);
  const double c1 = (1.0 - cosine) / squared;
  const double c2 = (angle - sine) / (squared * angle);
  return {{c1, (sine / angle - 2.0 * c1) / squared}, {c2, (c1 - 3.0 * c2) / squared}};
}

/// The matrix that maps the rate of the rotation vector to the spin (left, world axes).
inline Matrix3 spin_map(const Vector3& vector) {
  const SpinCoefficients c = spin_coefficients(vector.norm());
  const Matrix3 s = skew(vector);
  return Matrix3::Identity() + c.first.value * s + c.second.value * s * s;
}

/// Derivative of spin_map(vector)ᵀ n with respect to the rotation vector.
inline Matrix3 spin_map_derivative(const Vector3& vector, const Vector3& n) {
  const SpinCoefficients c = spin_coefficients(vector.norm());
  const double along = vector.dot(n);
  const Vector3 once = cross(vector, n);
  const Vector3 twice = along * vector - vector.squaredNorm() * n;
  return c.first.value * skew(n) - c.first.slope * once * vector.transpose() +
         c.second.value *
             (vector * n.transpose() + along * Matrix3::Identity() - 2.0 * n * vector.transpose()) +
         c.second.slope * twice * vector.transpose();
}

}  // namespace statejump::kernel
