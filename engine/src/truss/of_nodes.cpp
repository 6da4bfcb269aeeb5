// SPDX-License-Identifier: GPL-3.0-or-later
#include "truss/of_nodes.hpp"

#include <vector>

namespace statejump::truss::detail {

Eigen::SparseMatrix<double> of_nodes(const Model& model, const DofMap& dofs) {
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

}  // namespace statejump::truss::detail
