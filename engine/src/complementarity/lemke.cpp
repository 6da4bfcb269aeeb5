// SPDX-License-Identifier: GPL-3.0-or-later
#include "lemke.hpp"

#include <cmath>
#include <variant>
#include <vector>

namespace statejump::complementarity {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Smallest accepted pivot. It exceeds the rounding of some hundred eliminations of entries of
/// order one.
constexpr double least_pivot = 1e-11;
/// Two ratios or entries count as equal if they differ by less than this tolerance.
constexpr double tie_tolerance = 1e-12;

/// Matrix of the linear complementarity problem; z = (r_n, p, m, lambda) of each contact.
MatrixXd lcp_matrix(const ScaledProblem& problem) {
  const Index contacts = problem.contacts();
  const MatrixXd w =
      std::visit([](const auto& matrix) { return MatrixXd(matrix); }, problem.delassus());
  MatrixXd m = MatrixXd::Zero(4 * contacts, 4 * contacts);
  for (Index i = 0; i < contacts; ++i) {
    for (Index j = 0; j < contacts; ++j) {
      const Eigen::Matrix2d block = w.block<2, 2>(2 * i, 2 * j);
      Eigen::Matrix3d part;
      part << block(0, 0), block(0, 1), -block(0, 1),  //
          block(1, 0), block(1, 1), -block(1, 1),      //
          -block(1, 0), -block(1, 1), block(1, 1);
      m.block<3, 3>(4 * i, 4 * j) = part;
    }
    m.block<2, 1>(4 * i + 1, 4 * i + 3).setOnes();
    m.block<1, 3>(4 * i + 3, 4 * i) << problem.mu()[i], -1.0, -1.0;
  }
  return m;
}

/// Lemke's tableau. It has one row per basic variable, and columns for w, for z, for the artificial
/// variable, and for the values.
class Table {
 public:
  explicit Table(const ScaledProblem& problem)
      : size_(4 * problem.contacts()),
        rows_(MatrixXd::Zero(size_, 2 * size_ + 2)),
        basis_(static_cast<std::size_t>(size_)) {
    rows_.leftCols(size_).setIdentity();
    rows_.middleCols(size_, size_) = -lcp_matrix(problem);
    rows_.col(artificial()).setConstant(-1.0);
    for (Index i = 0; i < problem.contacts(); ++i) {
      const double tangential = problem.q()[2 * i + 1];
      rows_.col(2 * size_ + 1).segment<4>(4 * i) << problem.q()[2 * i], tangential, -tangential,
          0.0;
    }
    for (Index i = 0; i < size_; ++i) basis_[static_cast<std::size_t>(i)] = i;
  }

  Index artificial() const { return 2 * size_; }
  Index complement(Index variable) const {
    return variable < size_ ? variable + size_ : variable - size_;
  }

  /// Row with the most negative value; -1 if there is none.
  Index most_negative() const {
    Index worst = -1;
    for (Index i = 0; i < size_; ++i) {
      if (value(i) < 0.0 && (worst < 0 || value(i) < value(worst))) worst = i;
    }
    return worst;
  }

  /// Row of the variable that leaves the basis when `entering` grows from zero. It has the
  /// lexicographically smallest ratio; the artificial variable takes precedence. -1: ray.
  Index leaving(Index entering) const {
    Index best = -1;
    for (Index i = 0; i < size_; ++i) {
      if (rows_(i, entering) > least_pivot && (best < 0 || before(i, best, entering))) best = i;
    }
    return best;
  }

  /// Exchanges the variables.
  /// @return the variable that left the basis
  Index pivot(Index row, Index entering) {
    rows_.row(row) /= rows_(row, entering);
    for (Index i = 0; i < size_; ++i) {
      if (i == row || rows_(i, entering) == 0.0) continue;
      rows_.row(i) -= rows_(i, entering) * rows_.row(row);
    }
    const auto at = static_cast<std::size_t>(row);
    const Index left = basis_[at];
    basis_[at] = entering;
    return left;
  }

  VectorXd reactions() const {
    VectorXd z = VectorXd::Zero(size_);
    for (Index i = 0; i < size_; ++i) {
      const Index variable = basis_[static_cast<std::size_t>(i)];
      if (variable >= size_ && variable < artificial()) z[variable - size_] = value(i);
    }
    VectorXd r(size_ / 2);
    for (Index i = 0; i < size_ / 4; ++i) {
      r[2 * i] = z[4 * i];
      r[2 * i + 1] = z[4 * i + 1] - z[4 * i + 2];
    }
    return r;
  }

 private:
  double value(Index row) const { return rows_(row, 2 * size_ + 1); }
  bool is_artificial(Index row) const {
    return basis_[static_cast<std::size_t>(row)] == artificial();
  }
  bool before(Index i, Index j, Index entering) const {
    const double a = rows_(i, entering);
    const double b = rows_(j, entering);
    const double difference = value(i) / a - value(j) / b;
    if (std::abs(difference) > tie_tolerance) return difference < 0.0;
    if (is_artificial(i) || is_artificial(j)) return is_artificial(i);
    for (Index k = 0; k < size_; ++k) {
      const double step = rows_(i, k) / a - rows_(j, k) / b;
      if (std::abs(step) > tie_tolerance) return step < 0.0;
    }
    return false;
  }

  Index size_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows_;
  std::vector<Index> basis_;
};

}  // namespace

std::optional<VectorXd> lemke(const ScaledProblem& problem, int most, int& counted) {
  Table table(problem);
  Index row = table.most_negative();
  if (row < 0) return VectorXd::Zero(problem.q().size());
  Index entering = table.artificial();
  for (int k = 0; k < most; ++k) {
    ++counted;
    const Index left = table.pivot(row, entering);
    if (left == table.artificial()) return table.reactions();
    entering = table.complement(left);
    row = table.leaving(entering);
    if (row < 0) return {};
  }
  return {};
}

}  // namespace statejump::complementarity
