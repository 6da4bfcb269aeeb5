// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/complementarity/problem.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include "cone.hpp"
#include "scaled_problem.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::complementarity {

namespace {

using kernel::OutOfRange;
using kernel::require;

/// A dense matrix is factored as a sparse one if its fraction of nonzero entries is at most this,
/// unless it is small. For piles of bodies, both take the same time at 0.05.
constexpr double largest_sparse_fraction = 0.05;
constexpr Eigen::Index least_sparse_size = 200;

bool all_finite(const Delassus& delassus) {
  if (const auto* dense = std::get_if<Eigen::MatrixXd>(&delassus)) return dense->allFinite();
  const auto& sparse = std::get<Eigen::SparseMatrix<double>>(delassus);
  for (int j = 0; j < sparse.outerSize(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(sparse, j); it; ++it) {
      if (!std::isfinite(it.value())) return false;
    }
  }
  return true;
}

}  // namespace

void validate(const Problem& problem) {
  require(problem.dimension == 2 || problem.dimension == 3, "dimension", problem.dimension,
          "2 or 3");
  const Eigen::Index size = problem.contacts() * problem.dimension;
  const std::string wanted = std::to_string(size) + ", contacts times dimension";
  const auto [rows, columns] = std::visit(
      [](const auto& matrix) { return std::pair(matrix.rows(), matrix.cols()); }, problem.delassus);
  require(rows == size, "rows of W", static_cast<double>(rows), wanted.c_str());
  require(columns == size, "columns of W", static_cast<double>(columns), wanted.c_str());
  require(problem.q.size() == size, "size of q", static_cast<double>(problem.q.size()),
          wanted.c_str());
  for (Eigen::Index i = 0; i < problem.contacts(); ++i) {
    const double mu = problem.mu[i];
    if (!(mu >= 0.0) || !std::isfinite(mu)) {
      throw OutOfRange("contact " + std::to_string(i), "mu", mu, "finite and >= 0");
    }
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    if (!std::isfinite(problem.q[i])) {
      throw OutOfRange("contact " + std::to_string(i / problem.dimension), "q", problem.q[i],
                       "finite");
    }
  }
  if (!all_finite(problem.delassus)) throw OutOfRange("W", "nan or inf", "finite entries");
}

Eigen::VectorXd velocities(const Problem& problem, const Eigen::VectorXd& reactions) {
  require(reactions.size() == problem.q.size(), "size of r", static_cast<double>(reactions.size()),
          (std::to_string(problem.q.size()) + ", contacts times dimension").c_str());
  return std::visit(
      [&](const auto& matrix) -> Eigen::VectorXd { return matrix * reactions + problem.q; },
      problem.delassus);
}

double natural_map_merit(const Problem& problem, const Eigen::VectorXd& reactions,
                         const Eigen::VectorXd& velocities) {
  const double norm = natural_map_norm(problem.dimension, problem.mu, reactions, velocities);
  return norm > 0.0 ? norm / std::max({problem.q.norm(), reactions.norm(), velocities.norm()})
                    : 0.0;
}

Merit merit(const Problem& problem, const Eigen::VectorXd& reactions) {
  validate(problem);
  const Eigen::VectorXd u = velocities(problem, reactions);
  const ScaledProblem scaled(problem);
  return {natural_map_merit(problem, reactions, u),
          scaled.merit(reactions / scaled.reaction_unit(), u / scaled.velocity_unit())};
}

ScaledProblem::ScaledProblem(const Problem& problem)
    : dimension_(problem.dimension), delassus_(problem.delassus), q_(problem.q), mu_(problem.mu) {
  const double size = std::visit(
      [](const auto& matrix) -> double {
        return matrix.rows() > 0 ? matrix.diagonal().cwiseAbs().mean() : 0.0;
      },
      delassus_);
  const double compliance = size > 0.0 ? size : 1.0;
  // Scales the entries of q to order one.
  const double size_of_q =
      q_.size() > 0 ? q_.norm() / std::sqrt(static_cast<double>(q_.size())) : 0.0;
  velocity_unit_ = size_of_q > 0.0 ? size_of_q : 1.0;
  reaction_unit_ = velocity_unit_ / compliance;
  q_ /= velocity_unit_;
  if (size_of_q > 0.0) size_of_q_ = q_.norm();
  std::visit([&](auto& matrix) { matrix /= compliance; }, delassus_);
  if (const auto* dense = std::get_if<Eigen::MatrixXd>(&delassus_)) {
    const auto entries = static_cast<double>((dense->array() != 0.0).count());
    if (dense->rows() >= least_sparse_size &&
        entries < largest_sparse_fraction * static_cast<double>(dense->size())) {
      delassus_ = Eigen::SparseMatrix<double>(dense->sparseView());
    }
  }

  blocks_.reserve(static_cast<std::size_t>(contacts()));
  for (Eigen::Index i = 0; i < contacts(); ++i) {
    const Eigen::Index at = i * dimension_;
    // In planar problems, the unused second tangential component gets unit compliance and no load.
    BlockMatrix block = BlockMatrix::Identity();
    for (int row = 0; row < dimension_; ++row) {
      for (int column = 0; column < dimension_; ++column) {
        block(row, column) = std::visit(
            [&](const auto& matrix) { return matrix.coeff(at + row, at + column); }, delassus_);
      }
    }
    blocks_.push_back(block);
  }
}

Eigen::VectorXd ScaledProblem::times(const Eigen::VectorXd& r) const {
  return std::visit([&](const auto& matrix) -> Eigen::VectorXd { return matrix * r; }, delassus_);
}

void ScaledProblem::add_columns(Eigen::Index contact, const Block& delta,
                                Eigen::VectorXd& u) const {
  const Eigen::Index at = contact * dimension_;
  if (const auto* dense = std::get_if<Eigen::MatrixXd>(&delassus_)) {
    for (int k = 0; k < dimension_; ++k) u += dense->col(at + k) * delta[k];
    return;
  }
  const auto& sparse = std::get<Eigen::SparseMatrix<double>>(delassus_);
  for (int k = 0; k < dimension_; ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(sparse, at + k); it; ++it) {
      u[it.row()] += it.value() * delta[k];
    }
  }
}

}  // namespace statejump::complementarity
