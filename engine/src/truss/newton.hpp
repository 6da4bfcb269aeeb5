// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "linear/sparse_factor.hpp"
#include "statejump/failure.hpp"
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

/// Modes of a truss that nothing resists.
struct FoundModes {
  int count = 0;                   ///< May be more than are described; 0: none.
  bool more = false;               ///< There may be more than `count`.
  std::vector<FailureMode> modes;  ///< The nodes that move most.
  explicit operator bool() const { return count > 0; }
};

/// Free modes of the truss at z, its joints held as their statuses say.
FoundModes mechanism(const System& system, const Eigen::VectorXd& z, double time,
                     const Statuses& statuses, JointModel joints);

/// Modes in which the equilibrium at z is unstable though every joint is held (so friction cannot
/// help). That a joint which slips or leaves its bearing makes the truss unstable is not seen.
FoundModes buckling(const System& system, const Eigen::VectorXd& z, double time);

}  // namespace statejump::truss::detail
