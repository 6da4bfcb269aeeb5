// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace statejump::complementarity {

/// Numbers of one contact, normal component first; in the plane the second tangential one is zero.
using Block = Eigen::Vector3d;
/// Matrix of one contact.
using BlockMatrix = Eigen::Matrix3d;

/// Numbers of a contact among those of all.
inline Block block_of(const Eigen::VectorXd& all, Eigen::Index contact, int dimension) {
  return {all[contact * dimension], all[contact * dimension + 1],
          dimension == 3 ? all[contact * dimension + 2] : 0.0};
}

/// Writes the numbers of a contact among those of all.
inline void set_block(Eigen::VectorXd& all, Eigen::Index contact, int dimension,
                      const Block& block) {
  all.segment(contact * dimension, dimension) = block.head(dimension);
}

/// Projection onto Coulomb's cone |x_t| <= mu x_n.
inline Block project_on_cone(const Block& x, double mu) {
  const double normal = x[0];
  const double tangential = x.tail<2>().norm();
  if (tangential <= mu * normal) return x;
  Block result = Block::Zero();
  if (mu * tangential <= -normal) return result;
  result[0] = (mu * tangential + normal) / (mu * mu + 1.0);
  // With tangential = 0 one of the two above has returned.
  result.tail<2>() = x.tail<2>() * (mu * result[0] / tangential);
  return result;
}

/// r - P_K(r - û) of one contact: zero where Coulomb's law holds.
inline Block natural_map(const Block& r, const Block& u, double mu) {
  Block x = r - u;
  x[0] -= mu * u.tail<2>().norm();
  return r - project_on_cone(x, mu);
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
