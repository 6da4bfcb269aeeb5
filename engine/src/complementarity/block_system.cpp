// SPDX-License-Identifier: GPL-3.0-or-later
#include "block_system.hpp"

namespace statejump::complementarity {

namespace {

/// Largest number of rows of a singular sparse matrix that is factored as a dense one. It then
/// takes 72 MB and some seconds.
constexpr Eigen::Index most_dense_rows = 3000;

}  // namespace

BlockSystem::BlockSystem(const ScaledProblem& problem, const BlockRows& rows)
    : dimension_(problem.dimension()), size_(problem.q().size()), contacts_(rows.contacts) {
  if (contacts_.empty()) return;
  if (const auto* dense = std::get_if<Eigen::MatrixXd>(&problem.delassus())) {
    factor_dense(*dense, rows);
  } else {
    factor_sparse(std::get<Eigen::SparseMatrix<double>>(problem.delassus()), rows);
  }
}

void BlockSystem::factor_dense(const Eigen::MatrixXd& w, const BlockRows& rows) {
  const int d = dimension_;
  const Eigen::Index count = static_cast<Eigen::Index>(contacts_.size());
  Eigen::MatrixXd matrix(count * d, count * d);
  for (Eigen::Index j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(j);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto row = static_cast<std::size_t>(i);
      matrix.block(i * d, j * d, d, d) = rows.a[row].topLeftCorner(d, d).lazyProduct(
          w.block(contacts_[row] * d, contacts_[at] * d, d, d));
    }
    matrix.block(j * d, j * d, d, d) += rows.b[at].topLeftCorner(d, d);
  }
  dense_.emplace(matrix);
}

void BlockSystem::factor_sparse(const Eigen::SparseMatrix<double>& w, const BlockRows& rows) {
  const int d = dimension_;
  const int count = static_cast<int>(contacts_.size());
  std::vector<int> place(static_cast<std::size_t>(size_ / d), -1);
  for (int i = 0; i < count; ++i) {
    place[static_cast<std::size_t>(contacts_[static_cast<std::size_t>(i)])] = i;
  }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(w.nonZeros() * d));
  for (int j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(j);
    for (int k = 0; k < d; ++k) {
      const int column = j * d + k;
      for (Eigen::SparseMatrix<double>::InnerIterator it(w, contacts_[at] * d + k); it; ++it) {
        const int row = place[static_cast<std::size_t>(it.row() / d)];
        if (row < 0) continue;
        for (int m = 0; m < d; ++m) {
          const double factor = rows.a[static_cast<std::size_t>(row)](m, it.row() % d);
          if (factor != 0.0) entries.emplace_back(row * d + m, column, factor * it.value());
        }
      }
      for (int m = 0; m < d; ++m) entries.emplace_back(j * d + m, column, rows.b[at](m, k));
    }
  }
  Eigen::SparseMatrix<double> matrix(count * d, count * d);
  matrix.setFromTriplets(entries.begin(), entries.end());
  sparse_ = std::make_unique<linear::SparseFactor>();
  if (sparse_->factorize(matrix)) return;
  sparse_.reset();
  if (matrix.rows() <= most_dense_rows) dense_.emplace(Eigen::MatrixXd(matrix));
}

std::optional<Eigen::VectorXd> BlockSystem::solve(const std::vector<Block>& c) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(size_);
  if (contacts_.empty()) return result;
  if (!dense_ && !sparse_) return {};
  const int d = dimension_;
  Eigen::VectorXd right(static_cast<Eigen::Index>(contacts_.size()) * d);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    set_block(right, static_cast<Eigen::Index>(i), d, c[i]);
  }
  const Eigen::VectorXd some =
      dense_ ? Eigen::VectorXd(dense_->solve(right)) : sparse_->solve(right);
  if (!some.allFinite()) return {};
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    result.segment(contacts_[i] * d, d) = some.segment(static_cast<Eigen::Index>(i) * d, d);
  }
  return result;
}

}  // namespace statejump::complementarity
