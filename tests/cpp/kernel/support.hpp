// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "statejump/kernel/joint_kinematics.hpp"

namespace statejump::kernel::testing {

constexpr double pi = 3.14159265358979323846;

/// Random inputs with a fixed seed: the same numbers in every run and with every compiler.
class Random {
 public:
  double uniform(double low, double high) {
    // The standard specifies the raw output of mt19937, but not the algorithms of its
    // distributions.
    return low + (high - low) * (static_cast<double>(generator_()) / 4294967296.0);
  }
  Eigen::Vector3d vector(double size) {
    const double x = uniform(-size, size);
    const double y = uniform(-size, size);
    const double z = uniform(-size, size);
    return {x, y, z};
  }
  Eigen::Vector3d unit() {
    Eigen::Vector3d v = vector(1.0);
    while (v.norm() < 0.1) v = vector(1.0);
    return v.normalized();
  }
  Eigen::Matrix3d rotation() {
    const Eigen::Vector3d axis = unit();
    return Eigen::AngleAxisd(uniform(-pi, pi), axis).toRotationMatrix();
  }

 private:
  std::mt19937 generator_{20210110};
};

/// Random rigid motion about a random point, with speeds up to 5 m/s. Returns a function that gives
/// the motion of a body at a position.
inline auto rigid_motion(Random& random) {
  const Eigen::Vector3d origin = random.vector(0.1);
  const Eigen::Vector3d drift = random.vector(1.0);
  const Eigen::Vector3d spin = random.vector(10.0);
  return [origin, drift, spin](const Eigen::Vector3d& position) {
    return BodyMotion{position, drift + spin.cross(position - origin), spin};
  };
}

/// Expects |a - b| <= tolerance for vectors.
inline void expect_vector_near(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double tolerance,
                               const char* what) {
  EXPECT_LE((a - b).norm(), tolerance)
      << what << ": " << a.transpose() << " against " << b.transpose();
}

}  // namespace statejump::kernel::testing
