// SPDX-License-Identifier: GPL-3.0-or-later
// Steps whose contacts keep or soon find their branches: the laws of all contacts are then
// equations, which stand beside those of the bodies in one sparse matrix.
#include <algorithm>
#include <cmath>
#include <set>

#include "stepper.hpp"

namespace statejump::truss::detail {

namespace {

/// Newton's method converges in three or four iterations, or a contact is on another branch.
constexpr int most_iterations = 8;
/// Share of a contact's own force by which it may miss an inequality, as the contact problem's
/// tolerance allows.
constexpr double allowance = 1e-10;

}  // namespace

Stepper::Branch Stepper::branch(const Contact& contact) const {
  if (!contact.active) return Branch::open;
  const double normal = contact.normal_column < 0 ? contact.given_force : contact.normal_force;
  if (!(normal > 0.0)) return Branch::open;
  if (contact.sticks(normal, contact.friction_force)) return Branch::stick;
  return contact.friction_force >= 0.0 ? Branch::slip_plus : Branch::slip_minus;
}

void Stepper::note_branches() {
  branches_.clear();
  for (const Contact& contact : contacts_.all()) branches_.push_back(branch(contact));
}

bool Stepper::on_branches(Trial& step, Local& local) {
  std::vector<Branch> branches;
  std::vector<int> active;
  for (std::size_t place = 0; place < branches_.size(); ++place) {
    const Contact& contact = contacts_.all()[place];
    if (!contact.active) continue;
    // A rigid contact that is active has closed.
    const bool closes =
        branches_[place] == Branch::open && contact.normal_column >= 0 && !contact.is_elastic();
    branches.push_back(closes ? Branch::stick : branches_[place]);
    active.push_back(static_cast<int>(place));
  }
  if (active != active_) branch_factor_.reset();
  active_ = std::move(active);
  const Eigen::SparseMatrix<double> middle = at_.jacobian;
  // Block pivoting with single pivots as a safeguard (Judice and Pires 1994): all contacts that ask
  // for another branch change, unless that has been tried; then only the first of them does, until
  // fewer ask than ever before. Most changes are of one contact, found at the second try.
  std::set<std::vector<Branch>> tried{branches};
  std::size_t fewest = branches.size() + 1;
  bool one_by_one = false;
  for (;;) {
    step.v = v_;
    if (!solve_on(branches, step, local)) return false;
    std::vector<Branch> next = branches;
    std::vector<std::size_t> wrong;
    for (std::size_t i = 0; i < branches.size(); ++i) {
      next[i] = asked(step, local, static_cast<Eigen::Index>(i), branches[i]);
      if (next[i] != branches[i]) wrong.push_back(i);
    }
    if (wrong.empty()) return true;
    if (wrong.size() < fewest) {
      fewest = wrong.size();
      one_by_one = false;
    }
    if (!one_by_one && tried.count(next) > 0) one_by_one = true;
    if (one_by_one) {
      const Branch first = next[wrong.front()];
      next = branches;
      next[wrong.front()] = first;
    }
    if (!tried.insert(next).second) return false;
    branches = std::move(next);
    at_.jacobian = middle;
  }
}

bool Stepper::solve_on(const std::vector<Branch>& branches, Trial& step, Local& local) {
  const double h = step.h;
  const Eigen::Index n = q_.size();
  // What a contact asks for: that it moves as its law says along one of its directions.
  struct Row {
    Eigen::Index contact;
    bool normal;
    double slide;  ///< Tangential force over that of the normal one.
  };
  std::vector<Row> rows;
  VectorXd given = VectorXd::Zero(local.impulses.size());
  for (std::size_t k = 0; k < branches.size(); ++k) {
    const Contact& contact = *local.contacts[k];
    const Branch now = branches[k];
    if (now == Branch::open) continue;
    const auto i = static_cast<Eigen::Index>(k);
    // Friction on the body is against the slide.
    const double slide = (now == Branch::slip_plus    ? -1.0
                          : now == Branch::slip_minus ? 1.0
                                                      : 0.0) *
                         contact.friction_coefficient;
    if (contact.normal_column < 0) {
      given[2 * i] = h * contact.given_force;
      given[2 * i + 1] = slide * given[2 * i];
    } else {
      rows.push_back({i, true, slide});
    }
    if (now == Branch::stick && contact.tangential_column >= 0) rows.push_back({i, false, 0.0});
  }

  const Eigen::SparseMatrix<double> matrix = iteration_matrix(step);
  const Eigen::Index bodies = matrix.rows();
  const double scale = matrix.diagonal().head(n).maxCoeff();
  const auto size = bodies + static_cast<Eigen::Index>(rows.size());
  std::vector<Eigen::Triplet<double>> fixed;
  for (Eigen::Index j = 0; j < matrix.outerSize(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, j); it; ++it) {
      fixed.emplace_back(it.row(), it.col(), it.value());
    }
  }
  const auto along = [&](Eigen::Index column, auto&& use) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(local.directions, column); it; ++it) {
      use(it.row(), it.value());
    }
  };
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row& row = rows[k];
    const auto to = bodies + static_cast<Eigen::Index>(k);
    const Eigen::Index column = 2 * row.contact + (row.normal ? 0 : 1);
    along(column, [&](Eigen::Index at, double value) {
      fixed.emplace_back(to, at, scale * value);
      fixed.emplace_back(at, to, -scale * value);
    });
    if (row.slide != 0.0) {
      along(column + 1, [&](Eigen::Index at, double value) {
        fixed.emplace_back(at, to, -scale * row.slide * value);
      });
    }
  }
  if (!branch_factor_ || factored_ != branches) {
    branch_factor_ = std::make_unique<linear::SparseFactor>();
    factored_ = branches;
  }
  Eigen::SparseMatrix<double> bordered(size, size);
  VectorXd& held = step.held;
  for (int k = 0;; ++k) {
    const VectorXd residual = move(step);
    if (!residual.allFinite()) return false;
    if (k > 0 && balanced(step, residual, held, local, true)) break;
    if (k == most_iterations) return false;
    VectorXd right(size);
    right.head(n) = -residual + local.directions * given;
    if (holds_.cols() > 0) {
      right.segment(n, holds_.cols()) = held_speed_ - holds_.transpose() * step.v;
    }
    std::vector<Eigen::Triplet<double>> entries = fixed;
    double normal_force = 0.0;
    Eigen::Index normal_of = -1;
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const Row& row = rows[j];
      const Contact& contact = *local.contacts[static_cast<std::size_t>(row.contact)];
      const auto at = bodies + static_cast<Eigen::Index>(j);
      const double speed = local.directions.col(2 * row.contact + (row.normal ? 0 : 1)).dot(step.v);
      double compliance = 0.0;
      double offset = 0.0;
      if (row.normal && contact.is_elastic()) {
        const Tangent law = tangent(step, local, row.contact, speed);
        compliance = law.compliance;
        offset = law.gap / h;
        normal_force = law.elastic;
        normal_of = row.contact;
      } else if (row.normal) {
        offset = leaving(step, local, row.contact);
      } else {
        const Contact::Along friction =
            contact.along(normal_of == row.contact ? normal_force : contact.given_force, h);
        compliance = friction.compliance;
        offset = friction.bend / h;
      }
      entries.emplace_back(at, at, scale * scale * compliance / (h * h));
      right[at] = -scale * (speed + offset);
    }
    bordered.setFromTriplets(entries.begin(), entries.end());
    bordered.makeCompressed();
    ++factorizations_;
    if (!branch_factor_->factorize(bordered)) return false;
    const VectorXd found = branch_factor_->solve(right);
    step.v += found.head(n);
    held = found.segment(n, holds_.cols());
    local.impulses = given;
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const Row& row = rows[j];
      const double impulse = scale * found[bodies + static_cast<Eigen::Index>(j)];
      local.impulses[2 * row.contact + (row.normal ? 0 : 1)] = impulse;
      if (row.slide != 0.0) local.impulses[2 * row.contact + 1] = row.slide * impulse;
    }
  }
  return true;
}

Stepper::Branch Stepper::asked(const Trial& step, const Local& local, Eigen::Index i,
                               Branch branch) const {
  const double h = step.h;
  const Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
  const double normal = local.impulses[2 * i];
  const double tangential = local.impulses[2 * i + 1];
  const double bound = contact.friction_coefficient * normal;
  if (branch == Branch::open) {
    if (contact.normal_column < 0) return branch;
    const double speed = local.directions.col(2 * i).dot(step.v);
    const bool closes = contact.is_elastic() ? tangent(step, local, i, speed).force > 0.0
                                             : depth(step, local, i, speed) > 0.0;
    return closes ? Branch::stick : branch;
  }
  if (!(normal > 0.0)) return Branch::open;
  if (contact.tangential_column < 0 || bound == 0.0) {
    return branch == Branch::stick ? Branch::slip_plus : branch;  // slides freely either way
  }
  if (branch == Branch::stick) {
    if (std::abs(tangential) <= bound * (1.0 - allowance)) return branch;
    return tangential < 0.0 ? Branch::slip_plus : Branch::slip_minus;
  }
  const Contact::Along friction = contact.along(elastic_normal(step, local, i), h);
  const double slide = local.directions.col(2 * i + 1).dot(step.v) +
                       (friction.compliance * tangential / h + friction.bend) / h;
  return tangential * slide <= 0.0 ? branch : Branch::stick;
}

}  // namespace statejump::truss::detail
