// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "path_follower.hpp"
#include "status_enumeration.hpp"

namespace statejump::truss::detail {

namespace {

/// Largest displacement in one load step, divided by the size of the truss. A deployed structure
/// that loads move farther is not the modelled one.
constexpr double near_share = 0.05;
/// Smallest step of the load fraction. It determines the limit load to six digits.
constexpr double least_step = 1e-6;
/// Proximal stiffness, over that of the stiffest element, of displacements that only friction at
/// its limit resists. It limits the step of an iteration, not the solution.
constexpr double proximal_share = 1e-6;

}  // namespace

Model loaded(Model model, double fraction) {
  scale_misfits(model, fraction);
  for (Node& node : model.nodes) {
    node.load *= fraction;
    node.moment *= fraction;
  }
  return model;
}

/// Whether loads and misfits do work on at least one of the displacements `shapes` from the
/// reference configuration.
bool PathFollower::are_loaded(const std::vector<VectorXd>& shapes) const {
  Assembly at = Assembly::without_jacobian(system.unknowns());
  const VectorXd drawn = VectorXd::Zero(system.unknowns());
  const Statuses stuck = system.all_stick();
  system.evaluate(drawn, 0.0, system.begin(drawn, 0.0, stuck, 1.0), stuck, JointModel::pins, 1.0,
                  at);
  const auto forces = at.residual.head(system.displacements());
  const double share = std::sqrt(std::numeric_limits<double>::epsilon());
  return std::any_of(shapes.begin(), shapes.end(), [&](const VectorXd& shape) {
    const auto moved = shape.head(system.displacements());
    return std::abs(forces.dot(moved)) > share * forces.norm() * moved.norm();
  });
}

/// Whether displacements are small relative to the size of the truss.
bool PathFollower::is_near(const VectorXd& moved) const {
  const double farthest = length_of(moved, system.displacements());
  return system.size() == 0.0 || farthest <= near_share * system.size();
}

/// Increases loads and misfits from zero to their full values in steps with small displacements.
/// Each step starts from the last equilibrium. A joint at its friction limit slides to the next
/// equilibrium if this is near: at a stop, or in a position in which another element takes the
/// load.
/// @returns the point at which the load increase stalled; empty at full load or if the caller
/// stopped
std::optional<Stall> PathFollower::follow_loads() {
  z = VectorXd::Zero(system.unknowns());
  origin.statuses = system.all_stick();
  StepStart begin = system.begin(z, 0.0, origin.statuses, 1.0);
  forget_after(0);
  MemoryWriter writer = MemoryWriter::none;
  double reached = 0.0;
  double step = 1.0;
  while (reached < 1.0) {
    const double next = std::min(1.0, reached + step);
    const Model part = loaded(model, next);
    const System there(part);
    Newton solver(there, options.locate_events, newton.progress());
    solver.regularise_displacements(proximal_share * system.stiffness_scale());
    VectorXd trial = z;
    Statuses statuses = origin.statuses;
    const SolveReport report =
        solver.solve(0.0, begin, JointModel::pins, 1.0, options.most_iterations, trial, statuses);
    note(report);
    if (report.end == SolveEnd::stopped) {
      path.complete = false;
      return std::nullopt;
    }
    const bool found = report.end == SolveEnd::converged && is_near(trial - z) &&
                       solver.regularisation() != Regularisation::displacements &&
                       solver.stability_index() >= 0;
    if (found) {
      z = std::move(trial);
      origin.statuses = std::move(statuses);
      record_start(begin, std::exchange(writer, MemoryWriter::commit), JointModel::pins, 1.0, {},
                   {});
      if (record != nullptr) record->steps.back().load_fraction = next;
      begin = there.commit(z, 0.0, origin.statuses, begin);
      step = 2.0 * (next - reached);
      reached = next;
      continue;
    }
    step = 0.5 * (next - reached);
    if (step < least_step) return Stall{reached, report, statuses, trial};
  }
  // Computes the factors for the full load, which the path reuses.
  const SolveReport last =
      newton.solve(0.0, begin, JointModel::pins, 1.0, options.most_iterations, z, origin.statuses);
  note(last);
  if (last.end == SolveEnd::converged) {
    record_start(begin, writer, JointModel::pins, 1.0, {}, {});
    return std::nullopt;
  }
  return Stall{1.0, last, origin.statuses, z};
}

/// Throws a failure with the reason of the stall: buckling, or joints that slip at or beyond it.
void PathFollower::refuse_overload(const Stall& at) {
  std::set<int> exhausted(at.report.joints.begin(), at.report.joints.end());
  Statuses beyond = at.statuses;
  system.settle(at.z, 0.0, system.begin(z, 0.0, origin.statuses, 1.0), beyond);
  for (int i = 0; i < static_cast<int>(beyond.size()); ++i) {
    if (is_slip(origin.statuses[index(i)]) || is_slip(beyond[index(i)])) exhausted.insert(i);
  }
  if (at.report.end == SolveEnd::converged || exhausted.empty()) {
    z = at.z;
    origin.statuses = at.statuses;
    refuse_buckled(0.0);
  }
  if (exhausted.empty())
    fail(at.report, JointModel::pins, 0.0, "no equilibrium of the drawn shape");
  FailureFields fields = failure_at(FailureKind::overloaded, model, 0.0);
  for (const int i : exhausted) fields.joints.push_back(named(model, i));
  fields.numbers = {{"load_fraction", at.fraction}};
  throw Failure(std::move(fields));
}

}  // namespace statejump::truss::detail
