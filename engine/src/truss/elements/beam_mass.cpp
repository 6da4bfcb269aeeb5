// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Core>
#include <utility>

#include "statejump/kernel/rotation.hpp"
#include "statejump/truss/elements/beam.hpp"
#include "statejump/truss/motion.hpp"
#include "truss/elements/writer.hpp"

namespace statejump::truss {

/// Translations are linear along the beam, so the mass matrix of both ends is m/6 [2 1; 1 2], as
/// that of a bar. Sections rotate with the ends, half of the beam with each. The matrix is that of
/// the reference configuration: its error is of second order in the rotations.
void Beam::mass(const Frame& frame, const Inertia& inertia, std::size_t i,
                MatrixWriter& writer) const {
  const double mass = inertia_of(inertia.beam_mass, i);
  const Eigen::Matrix3d axes = frame.beam.triad;
  Eigen::Vector3d moments =
      inertia.beam_moment.size() == 0
          ? Eigen::Vector3d::Zero()
          : Eigen::Vector3d(inertia.beam_moment.col(static_cast<Eigen::Index>(i)));
  if (frame.swapped) std::swap(moments[1], moments[2]);
  std::array<Eigen::Matrix3d, 2> by_rotation;  // of the displacement of an end
  for (std::size_t end = 0; end < 2; ++end) {
    by_rotation[end] = -kernel::skew(frame.offsets[end]) / frame.arms[end];
  }
  for (std::size_t a = 0; a < 2; ++a) {
    const int turning = frame.nodes[2 + a];
    for (std::size_t b = 0; b < 2; ++b) {
      const double share = mass / (a == b ? 3.0 : 6.0);
      const int turning_other = frame.nodes[2 + b];
      writer.block(frame.nodes[a], frame.nodes[b], share * Eigen::Matrix3d::Identity());
      writer.block(frame.nodes[a], turning_other, share * by_rotation[b]);
      writer.block(turning, frame.nodes[b], share * by_rotation[a].transpose());
      writer.block(turning, turning_other, share * by_rotation[a].transpose() * by_rotation[b]);
    }
    const Eigen::Matrix3d rotary = axes * moments.asDiagonal() * axes.transpose();
    writer.block(turning, turning, rotary / (frame.arms[a] * frame.arms[a]));
  }
}

}  // namespace statejump::truss
