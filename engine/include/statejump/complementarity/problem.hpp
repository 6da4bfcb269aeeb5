// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <variant>

namespace statejump::complementarity {

/// Delassus matrix, dense or sparse.
using Delassus = std::variant<Eigen::MatrixXd, Eigen::SparseMatrix<double>>;

/// Local frictional contact problem: velocities u = W r + q with Coulomb's law at every contact.
///
/// Each contact has a block of `dimension` numbers, the normal component first: reaction r = (r_n,
/// r_t), velocity u = (u_n, u_t), u_n > 0 opening. Coulomb's law is
///
///     r_n >= 0,  u_n >= 0,  r_n u_n = 0,  |r_t| <= mu r_n,  r_t = -mu r_n u_t/|u_t| where u_t != 0
///
/// and in one line (De Saxcé, Feng 1998): with û = u + mu |u_t| n,
///
///     K* ∋ û ⟂ r ∈ K,   K = {|r_t| <= mu r_n},   K* = {mu |û_t| <= û_n}.
///
/// The caller chooses the units. r may be forces, impulses or their rates; u may be velocities,
/// displacements or gap rates. W maps r to u: it is the condensed compliance or inverse mass. In
/// mechanics W is symmetric positive semidefinite, of any rank; the solvers do not use its
/// symmetry.
struct Problem {
  int dimension = 3;   ///< of a contact's block, 2 or 3
  Delassus delassus;   ///< W, square, rows and columns contacts * dimension
  Eigen::VectorXd q;   ///< velocities without reactions
  Eigen::VectorXd mu;  ///< friction coefficient of each contact, >= 0

  /// Number of contacts.
  Eigen::Index contacts() const { return mu.size(); }
};

/// Checks the sizes and values of a problem.
/// @throws kernel::OutOfRange for a dimension other than 2 and 3, inconsistent sizes, values that
///        are not finite, mu < 0
void validate(const Problem& problem);

/// u = W r + q.
/// @throws kernel::OutOfRange if the sizes of `reactions` and q differ
Eigen::VectorXd velocities(const Problem& problem, const Eigen::VectorXd& reactions);

/// Error of reactions as a solution; 0 for an exact one.
struct Merit {
  /// |r - P_K(r - û)| / max(|q|, |r|, |u|) with u = W r + q and Euclidean norms over all contacts.
  /// This is the natural map in the units of the problem, as in fc3d_compute_error() of Siconos
  /// 4.4.
  double natural_map = 0.0;
  /// |r - P_K(r - û)| / |q| after W is divided by its mean diagonal and r multiplied by it. This
  /// value is independent of units, which can make the natural map insensitive to u or r. It does
  /// not become small if there is no solution and reactions grow without bound.
  double scaled = 0.0;

  /// The value that is compared with the tolerance.
  double largest() const { return natural_map > scaled ? natural_map : scaled; }
};

/// Returns the errors of given reactions as a solution.
/// @throws kernel::OutOfRange as validate(), and if the sizes of `reactions` and q differ
Merit merit(const Problem& problem, const Eigen::VectorXd& reactions);

}  // namespace statejump::complementarity
