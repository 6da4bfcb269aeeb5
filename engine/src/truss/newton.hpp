// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "linear/sparse_factor.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

/// How a Newton solve ended.
enum class SolveEnd : unsigned char { converged, singular, not_converged };

struct SolveReport {
  SolveEnd end = SolveEnd::not_converged;
  int joint = -1;  ///< Whose status changed last; sliders before revolutes. −1: none.
  double force_residual = 0.0;    ///< Over the largest force [-].
  double closure_residual = 0.0;  ///< [m]
};

/// Newton's method with an active set on the equations of a truss; keeps the memory of the factors.
class Newton {
 public:
  explicit Newton(const System& system)
      : system_(&system), jacobian_(system.pattern()), residual_(system.unknowns()) {}

  /// Solves for z and statuses at `time`, from the guess in them. On failure they are unspecified.
  SolveReport solve(double time, const StepStart& start, JointModel joints, double clearance_scale,
                    int most_iterations, Eigen::VectorXd& z, Statuses& statuses);

  long factorizations() const { return factorizations_; }

 private:
  const System* system_;
  Eigen::SparseMatrix<double> jacobian_;
  Eigen::VectorXd residual_;
  linear::SparseFactor factor_;
  long factorizations_ = 0;
};

/// Sentence that names the free modes of the truss at z, or "" if it has none: its joints held as
/// their statuses say.
std::string mechanism(const System& system, const Eigen::VectorXd& z, double time,
                      const Statuses& statuses, JointModel joints);

/// Sentence that names the modes in which the equilibrium at z is unstable though every joint is
/// held (so friction cannot help), or "". That a joint which slips or leaves its bearing makes the
/// truss unstable is not seen.
std::string buckling(const System& system, const Eigen::VectorXd& z, double time);

}  // namespace statejump::truss::detail
