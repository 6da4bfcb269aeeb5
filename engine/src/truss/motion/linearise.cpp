// SPDX-License-Identifier: GPL-3.0-or-later
#include <vector>

#include "bodies.hpp"
#include "start_of_motion.hpp"
#include "statejump/truss/modes.hpp"

namespace statejump::truss {

namespace {

/// The matrix of Linearised::of_nodes.
Eigen::SparseMatrix<double> of_nodes(const Model& model, const detail::DofMap& dofs) {
  const std::size_t nodes = model.nodes.size();
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t site = 0; site < dofs.sites(); ++site) {
    const NodeDofs& at = dofs.at(static_cast<int>(site));
    const double unit = site < nodes ? 1.0 : model.nodes[site - nodes].arm;
    for (int along = 0; along < at.freedoms; ++along) {
      const Eigen::Vector3d direction = at.directions->col(along) / unit;
      at.each_term(along, [&](int dof, double factor) {
        for (int x = 0; x < 3; ++x) {
          entries.emplace_back(3 * static_cast<int>(site) + x, dof, factor * direction[x]);
        }
      });
    }
  }
  Eigen::SparseMatrix<double> made(static_cast<Eigen::Index>(3 * dofs.sites()), dofs.dofs());
  made.setFromTriplets(entries.begin(), entries.end());
  return made;
}

}  // namespace

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
  made.of_nodes = of_nodes(model, system.dofs());
  return made;
}

}  // namespace statejump::truss
