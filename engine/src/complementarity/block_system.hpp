// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <memory>
#include <optional>
#include <vector>

#include "linear/sparse_factor.hpp"
#include "scaled_problem.hpp"

namespace statejump::complementarity {

/// The contacts with their blocks of A and B, in order.
struct BlockRows {
  std::vector<Eigen::Index> contacts;
  std::vector<BlockMatrix> a;
  std::vector<BlockMatrix> b;
};

/// Factors of A W + B for a subset of the contacts, with block-diagonal A and B. The factors are
/// dense if W is dense, otherwise sparse. If sparse factors are singular to rounding, dense factors
/// with full row pivoting replace them, unless the matrix is too large.
class BlockSystem {
 public:
  BlockSystem(const ScaledProblem& problem, const BlockRows& rows);

  /// Solution r of (A W + B) r = c, with zero for contacts outside the system; empty if the
  /// equations are singular to rounding.
  /// @param c right-hand side: one block for each contact in the system
  std::optional<Eigen::VectorXd> solve(const std::vector<Block>& c) const;

 private:
  void factor_dense(const Eigen::MatrixXd& w, const BlockRows& rows);
  void factor_sparse(const Eigen::SparseMatrix<double>& w, const BlockRows& rows);

  int dimension_;
  Eigen::Index size_;  ///< Of the result.
  std::vector<Eigen::Index> contacts_;
  std::optional<Eigen::PartialPivLU<Eigen::MatrixXd>> dense_;
  std::unique_ptr<linear::SparseFactor> sparse_;
};

}  // namespace statejump::complementarity
