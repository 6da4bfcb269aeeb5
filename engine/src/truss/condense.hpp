// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "statejump/truss/local_problem.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

/// Returns the frictional contact problem of the step from the state `start` to the equilibrium z.
LocalProblem local_problem(const System& system, const VectorXd& z, double time,
                           const StepStart& start, const Statuses& statuses);

}  // namespace statejump::truss::detail
