// SPDX-License-Identifier: GPL-3.0-or-later
#include "bodies.hpp"
#include "start_of_motion.hpp"
#include "statejump/truss/modes.hpp"
#include "truss/of_nodes.hpp"

namespace statejump::truss {

Linearised linearise(const Model& model, const Inertia& inertia, StartFriction start_friction) {
  model.validate();
  MotionOptions options;
  options.start_friction = start_friction;
  const State start = detail::equilibrium(model, options).value();
  const detail::System system(model);
  const detail::Bodies bodies(system, inertia);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(system.unknowns());
  z.head(system.displacements()) = system.dofs().dofs_at(detail::sites_of(model, start));
  const detail::Statuses held = system.all_stick();
  const detail::StepStart begun = system.begin(z, start.time, held, 1.0);
  Assembly at = system.assembly();
  system.evaluate(z, start.time, begun, held, JointModel::pins, 1.0, at);
  const Eigen::Index n = system.displacements();
  Linearised made;
  made.stiffness = system.penalty_stiffness(z, start.time, held, JointModel::pins, 0.0, 0.0)
                       .selfadjointView<Eigen::Lower>();
  made.constraints = at.jacobian().block(n, 0, system.unknowns() - n, n);
  made.mass = bodies.mass();
  made.of_nodes = detail::of_nodes(model, system.dofs());
  return made;
}

}  // namespace statejump::truss
