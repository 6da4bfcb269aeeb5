// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/local_problem.hpp"

#include <Eigen/SparseCholesky>
#include <optional>

#include "condense.hpp"
#include "linear/sparse_factor.hpp"

namespace statejump::truss::detail {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// If the truss without its contacts is softer than this fraction of the stiffest element, it
/// counts as a mechanism. W contains the inverse stiffness, so this bounds its error.
constexpr double soft_share = 1e-9;
/// Initial proximal stiffness over that of the stiffest element. The softest generated trusses have
/// 1e-4.
constexpr double proximal_share = 1e-3;

/// The unknowns in two groups: contacts, and all others (the structure).
struct Groups {
  std::vector<int> place;  ///< Index of an unknown within its group.
  std::vector<bool> contact;
  int contacts = 0;
  int others = 0;
};

/// Block of the Jacobian with the rows of one group and the columns of one group.
Sparse block(const Sparse& jacobian, const Groups& of, bool contact_rows, bool contact_columns) {
  Triplets entries;
  for (int column = 0; column < jacobian.outerSize(); ++column) {
    if (of.contact[index(column)] != contact_columns) continue;
    for (Sparse::InnerIterator entry(jacobian, column); entry; ++entry) {
      const int row = static_cast<int>(entry.row());
      if (of.contact[index(row)] != contact_rows) continue;
      entries.emplace_back(of.place[index(row)], of.place[index(column)], entry.value());
    }
  }
  const auto size = [&](bool contact) { return contact ? of.contacts : of.others; };
  Sparse made(size(contact_rows), size(contact_columns));
  made.setFromTriplets(entries.begin(), entries.end());
  return made;
}

/// Whether every displacement has a positive stiffness. Constraint rows count as springs as stiff
/// as the stiffest element.
bool is_stable(const Sparse& structure, int displacements, double scale, double proximal) {
  const int rows = static_cast<int>(structure.rows()) - displacements;
  const Sparse full = structure.block(0, 0, displacements, displacements);
  const Sparse held = structure.block(displacements, 0, rows, displacements);
  Sparse shift(displacements, displacements);
  shift.setIdentity();
  Sparse symmetric = 0.5 * (full + Sparse(full.transpose()));
  symmetric += scale * Sparse(held.transpose() * held);
  symmetric += (proximal - soft_share * scale) * shift;
  const Eigen::SimplicialLDLT<Sparse> factors(symmetric);
  return factors.info() == Eigen::Success && (factors.vectorD().array() > 0.0).all();
}

}  // namespace

LocalProblem local_problem(const System& system, const VectorXd& z, double time,
                           const StepStart& start, const Statuses& statuses) {
  const Model& model = system.model();
  const int displacements = system.displacements();
  LocalProblem made;
  made.time = time;
  made.temperature_change = model.temperature_change(0, 1.0, time);

  std::vector<LocalContact> contacts;
  Statuses branches = statuses;
  Groups groups{std::vector<int>(index(system.unknowns())),
                std::vector<bool>(index(system.unknowns()), false), 0, 0};
  std::vector<int> unknowns;  // of the contacts
  for (int i = 0; i < static_cast<int>(model.joints.size()); ++i) {
    const Trial at = system.trial(i, z, time, start, JointModel::friction, 1.0);
    const std::optional<LocalContact> contact =
        std::visit([&](const auto& one) { return one.contact(at, statuses[index(i)]); },
                   model.joints[index(i)]);
    if (!contact) continue;
    branches[index(i)] = JointStatus::stick;  // its rows are gap and slide
    made.joints.push_back(i);
    contacts.push_back(*contact);
    for (const int row : {contact->normal, contact->tangential}) {
      if (row < 0) continue;
      const int unknown = system.force_row(i) + row;
      groups.contact[index(unknown)] = true;
      groups.place[index(unknown)] = groups.contacts++;
      unknowns.push_back(unknown);
    }
  }
  for (int i = 0; i < system.unknowns(); ++i) {
    if (!groups.contact[index(i)]) groups.place[index(i)] = groups.others++;
  }

  Assembly at = system.assembly();
  system.evaluate(z, time, start, branches, JointModel::friction, 1.0, at);
  const Sparse jacobian = at.jacobian();
  Sparse structure = block(jacobian, groups, false, false);
  const Sparse columns = block(jacobian, groups, false, true);
  const Sparse rows = block(jacobian, groups, true, false);
  const Sparse own = block(jacobian, groups, true, true);
  const double scale = system.stiffness_scale();
  while (!is_stable(structure, displacements, scale, made.proximal_stiffness)) {
    made.proximal_stiffness = std::max(proximal_share * scale, 10.0 * made.proximal_stiffness);
  }
  if (made.proximal_stiffness > 0.0) {
    Sparse shift(groups.others, groups.others);
    for (int i = 0; i < displacements; ++i) shift.insert(i, i) = made.proximal_stiffness;
    structure += shift;
  }
  linear::SparseFactor factor;
  if (groups.others > 0) factor.factorize(structure);
  Eigen::MatrixXd compliance = -Eigen::MatrixXd(own);
  for (int j = 0; j < groups.contacts && groups.others > 0; ++j) {
    compliance.col(j) += rows * factor.solve(VectorXd(columns.col(j)));
  }

  // Each contact has a normal and a friction row. A given normal force has an artificial gap that
  // it closes.
  const auto count = static_cast<Eigen::Index>(contacts.size());
  std::vector<Eigen::Index> row_of;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (contacts[static_cast<std::size_t>(k)].normal >= 0) row_of.push_back(2 * k);
    row_of.push_back(2 * k + 1);
  }
  const double mean = groups.contacts > 0 ? compliance.diagonal().mean() : 0.0;
  const double pressed = mean > 0.0 ? mean : 1.0;
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(2 * count, 2 * count);
  made.reactions = made.velocities = VectorXd::Zero(2 * count);
  made.problem.mu = VectorXd::Zero(count);
  for (std::size_t i = 0; i < row_of.size(); ++i) {
    made.reactions[row_of[i]] = z[unknowns[i]];
    made.velocities[row_of[i]] = -at.residual[unknowns[i]];
    for (std::size_t j = 0; j < row_of.size(); ++j) {
      w(row_of[i], row_of[j]) =
          compliance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  for (Eigen::Index k = 0; k < count; ++k) {
    const LocalContact& contact = contacts[static_cast<std::size_t>(k)];
    made.problem.mu[k] = contact.friction_coefficient;
    if (contact.normal >= 0) continue;
    made.reactions[2 * k] = contact.normal_force;
    w(2 * k, 2 * k) = pressed;
  }
  made.problem.dimension = 2;
  made.problem.q = made.velocities - w * made.reactions;
  made.problem.delassus = std::move(w);
  return made;
}

}  // namespace statejump::truss::detail
