// SPDX-License-Identifier: GPL-3.0-or-later
#include "dof_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "elimination.hpp"
#include "parallel.hpp"
#include "statejump/truss/model.hpp"

namespace statejump::truss::detail {

namespace {

/// Copying the displacements of this many nodes takes about ten times as long as starting a thread.
constexpr std::size_t nodes_at_once = 50000;
/// If a unit displacement of a dof moves a node by less than this, the motion counts as zero, as in
/// moves_along() [-].
constexpr double least_motion = 1e-9;

/// Whether an element, a joint or a constraint rotates a node, for every node.
std::vector<bool> rotating_nodes(const Model& model) {
  const auto nodes = static_cast<int>(model.nodes.size());
  std::vector<bool> rotates(model.nodes.size(), false);
  const auto rotate = [&](int site) {
    if (site >= nodes) rotates[static_cast<std::size_t>(site - nodes)] = true;
  };
  const auto ask = [&]<class Type>(const std::vector<Type>& elements) {
    if constexpr (Type::dofs_per_node == 6) {
      for (const Type& one : elements) {
        for (const int site : one.frame(model).nodes) rotate(site);
      }
    }
  };
  std::apply([&](const auto&... lists) { (ask(lists), ...); }, model.lists());
  for (const Constraint& constraint : model.constraints) {
    for (const ConstraintTerm& term : constraint.terms) rotate(term.node);
  }
  for (const Joint& joint : model.joints) {
    if (!has_ties(joint)) continue;
    for (const int site :
         std::visit([&](const auto& one) { return one.frame(model).nodes; }, joint)) {
      rotate(site);
    }
    for (const Constraint& tie : ties_of(joint, model)) {
      for (const ConstraintTerm& term : tie.terms) rotate(term.node);
    }
  }
  return rotates;
}

}  // namespace

DofMap::DofMap(const Model& model) : DofMap(model, rotating_nodes(model)) {}

DofMap::DofMap(const Model& model, const std::vector<bool>& rotates) {
  const Elimination eliminated = eliminate(model);
  const auto is_dependent = [&](int node, int direction) {
    return eliminated.sums.count(place_of(node, direction)) > 0;
  };
  count_ = model.nodes.size();
  const bool any = std::find(rotates.begin(), rotates.end(), true) != rotates.end();
  sites_.resize((any ? 2 : 1) * count_ + 1);
  for (std::size_t which = 0; which < count_; ++which) {
    const Node& node = model.nodes[which];
    sites_[which] = {dofs_, node.freedoms, &node.free_directions.matrix()};
    for (int i = 0; i < node.freedoms; ++i)
      dofs_ += is_dependent(static_cast<int>(which), i) ? 0 : 1;
    if (!any) continue;
    const int rotations = rotates[which] ? node.rotations : 0;
    const std::size_t site = count_ + which;
    sites_[site] = {dofs_, rotations, &node.rotation_directions.matrix()};
    for (int i = 0; i < rotations; ++i) dofs_ += is_dependent(static_cast<int>(site), i) ? 0 : 1;
  }
  if (!eliminated.sums.empty()) add_sums(eliminated);
}

void DofMap::add_sums(const Elimination& eliminated) {
  const auto row_of = [&](int place) {
    int row = sites_[static_cast<std::size_t>(place / 3)].row;
    for (int before = place - place % 3; before < place; ++before) {
      row += eliminated.sums.count(before) > 0 ? 0 : 1;
    }
    return row;
  };
  std::map<int, DofSums> of_nodes;
  for (const auto& [place, unused] : eliminated.sums) of_nodes[place / 3] = {};
  for (auto& [node, sums] : of_nodes) {
    for (int i = 0; i < sites_[static_cast<std::size_t>(node)].freedoms; ++i) {
      const int own = place_of(node, i);
      const auto dependent = eliminated.sums.find(own);
      if (dependent == eliminated.sums.end()) {
        sums[static_cast<std::size_t>(i)] = {{row_of(own), 1.0}};
        continue;
      }
      for (const auto& [place, factor] : dependent->second) {
        sums[static_cast<std::size_t>(i)].push_back({row_of(place), factor});
      }
    }
  }
  sums_ = std::make_shared<const std::map<int, DofSums>>(std::move(of_nodes));
  for (const auto& [node, sums] : *sums_) sites_[static_cast<std::size_t>(node)].sums = &sums;
}

int DofMap::node_of(int dof) const {
  const auto end = sites_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto after = std::upper_bound(sites_.begin(), end, dof,
                                      [](int row, const NodeDofs& at) { return row < at.row; });
  return static_cast<int>(after - sites_.begin()) - 1;
}

Eigen::Vector3d DofMap::displacement(int site, const Eigen::VectorXd& z) const {
  const NodeDofs& at = sites_[static_cast<std::size_t>(site)];
  if (at.sums != nullptr) return *at.directions * along_directions(at, z);
  const double* along = z.data() + at.row;
  switch (at.freedoms) {
    case 3:
      return along[0] * at.directions->col(0) + along[1] * at.directions->col(1) +
             along[2] * at.directions->col(2);
    case 2:
      return along[0] * at.directions->col(0) + along[1] * at.directions->col(1);
    case 1:
      return along[0] * at.directions->col(0);
    default:
      return Eigen::Vector3d::Zero();
  }
}

void DofMap::displacements(const Eigen::VectorXd& z, Eigen::Matrix3Xd& moved) const {
  moved.resize(3, static_cast<Eigen::Index>(sites()));
  each_in_parallel(sites(), nodes_at_once, [&](std::size_t i) {
    moved.col(static_cast<Eigen::Index>(i)) = displacement(static_cast<int>(i), z);
  });
}

Eigen::VectorXd DofMap::dofs_at(const Eigen::Matrix3Xd& moved) const {
  Eigen::VectorXd found = Eigen::VectorXd::Zero(dofs_);
  for (Eigen::Index n = 0; n < moved.cols(); ++n) {
    const NodeDofs& at = sites_[static_cast<std::size_t>(n)];
    int row = at.row;
    for (int i = 0; i < at.freedoms; ++i) {
      if (at.is_own(i, row)) found[row++] = at.directions->col(i).dot(moved.col(n));
    }
  }
  return found;
}

void DofMap::add_force(int node, const Eigen::Vector3d& force, Eigen::VectorXd& to) const {
  const NodeDofs& dofs = at(node);
  for (int i = 0; i < dofs.freedoms; ++i) {
    const double along = dofs.directions->col(i).dot(force);
    dofs.each_term(i, [&](int row, double factor) { to[row] += factor * along; });
  }
}

bool DofMap::moves_apart(int first, int second, const Eigen::Vector3d& direction) const {
  std::map<int, double> gradient;
  for (const auto& [node, sign] : {std::pair(first, 1.0), std::pair(second, -1.0)}) {
    const NodeDofs& dofs = at(node);
    for (int i = 0; i < dofs.freedoms; ++i) {
      const double along = sign * dofs.directions->col(i).dot(direction);
      dofs.each_term(i, [&](int row, double factor) { gradient[row] += factor * along; });
    }
  }
  return std::any_of(gradient.begin(), gradient.end(),
                     [](const auto& term) { return std::abs(term.second) > least_motion; });
}

Eigen::Vector3d DofMap::along_directions(const NodeDofs& at, const Eigen::VectorXd& z) {
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  for (int i = 0; i < at.freedoms; ++i) {
    at.each_term(i, [&](int row, double factor) { along[i] += factor * z[row]; });
  }
  return along;
}

}  // namespace statejump::truss::detail
