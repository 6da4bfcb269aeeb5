// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace statejump::complementarity {

/// Components of one contact, normal first; in the plane the second tangential one is zero.
using Block = Eigen::Vector3d;
/// 3 x 3 matrix of one contact.
using BlockMatrix = Eigen::Matrix3d;

/// Block of a contact in a vector of all contacts.
inline Block block_of(const Eigen::VectorXd& all, Eigen::Index contact, int dimension) {
  return {all[contact * dimension], all[contact * dimension + 1],
          dimension == 3 ? all[contact * dimension + 2] : 0.0};
}

/// Writes the block of one contact into a vector that holds the blocks of all contacts.
inline void set_block(Eigen::VectorXd& all, Eigen::Index contact, int dimension,
                      const Block& block) {
  all.segment(contact * dimension, dimension) = block.head(dimension);
}

/// r - P_K(r - û) of one contact: zero if Coulomb's law holds. P_K projects onto the cone |x_t| <=
/// mu x_n. The formula of each branch keeps a small û accurate beside a large r.
inline Block natural_map(const Block& r, const Block& u, double mu) {
  Block modified = u;
  modified[0] += mu * u.tail<2>().norm();
  const Block x = r - modified;
  const double size = x.tail<2>().norm();
  // Without friction the cone is a ray. The projection of a point behind its tip is zero.
  if (x[0] >= 0.0 && size <= mu * x[0]) return modified;
  if (mu * size <= -x[0]) return r;
  // Projection onto the boundary of the cone. Here size > 0.
  Block edge(1.0, mu * x[1] / size, mu * x[2] / size);
  edge /= std::sqrt(1.0 + mu * mu);
  return r - edge * edge.dot(r) + edge * edge.dot(modified);
}

/// Euclidean norm of the natural map over all contacts.
inline double natural_map_norm(int dimension, const Eigen::VectorXd& mu, const Eigen::VectorXd& r,
                               const Eigen::VectorXd& u) {
  double squares = 0.0;
  for (Eigen::Index i = 0; i < mu.size(); ++i) {
    squares +=
        natural_map(block_of(r, i, dimension), block_of(u, i, dimension), mu[i]).squaredNorm();
  }
  return std::sqrt(squares);
}

}  // namespace statejump::complementarity
