// SPDX-License-Identifier: GPL-3.0-or-later
// Steps whose branches are not found: the frictional contact problem of all contacts that may
// touch.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "stepper.hpp"

namespace statejump::truss::detail {

using complementarity::Problem;

namespace {

/// Whether a push would speed a contact up against it: the step is long beside how fast something
/// gives way, and the contact problem need not have a solution.
bool is_indefinite(const Eigen::MatrixXd& delassus) {
  constexpr double rounding = 1e-8;  // of systems whose condition is that of stiff links
  if (delassus.size() == 0) return false;
  const VectorXd pivots = delassus.ldlt().vectorD();
  return pivots.minCoeff() < -rounding * pivots.cwiseAbs().maxCoeff();
}

}  // namespace

/// What impulses do to the velocities.
void Stepper::complete(const Trial& step, Local& local) {
  ++factorizations_;
  const Eigen::Index n = q_.size();
  bodies_matrix_.begin(n + held_count());
  fill_bodies(step, bodies_matrix_);
  bodies_matrix_.end();
  if (!factor_.factorize(bodies_matrix_.matrix())) fail(FailureKind::singular, step.to, nullptr);
  const Eigen::Index rows = local.directions.cols();
  local.answers = Eigen::MatrixXd::Zero(n + holds_.cols(), rows);
  VectorXd right = VectorXd::Zero(n + holds_.cols());
  for (Eigen::Index k = 0; k < rows; ++k) {
    if (local.directions.col(k).nonZeros() == 0) continue;
    right.head(n) = local.directions.col(k);
    local.answers.col(k) = factor_.solve(right);
  }
  local.delassus = local.directions.transpose() * local.answers.topRows(n);
  if (is_indefinite(local.delassus)) fail(FailureKind::not_converged, step.to, nullptr);
  // Rows that touch nothing else are of the size of the others.
  const auto real = (local.delassus.diagonal().array() > 0.0).count();
  const double size = real > 0 ? local.delassus.trace() / static_cast<double>(real) : 1.0;
  for (Eigen::Index k = 0; k < rows; ++k) {
    const Contact& contact = *local.contacts[static_cast<std::size_t>(k / 2)];
    const int column = k % 2 == 0 ? contact.normal_column : contact.tangential_column;
    if (column < 0) local.delassus(k, k) = size;
  }
}

void Stepper::solve_contacts(const Trial& step, const VectorXd& free, bool first, Local& local) {
  const double h = step.h;
  Problem problem{2, local.delassus, local.directions.transpose() * free,
                  VectorXd::Zero(static_cast<Eigen::Index>(local.contacts.size()))};
  const VectorXd speeds =
      first ? VectorXd(local.directions.transpose() * v_)
            : VectorXd(local.directions.transpose() * free + local.delassus * local.impulses);
  if (contacts_.slip_in_part()) {
    see_rings(step, local, speeds, first ? Seen::kinks : Seen::next);
  }
  Eigen::MatrixXd& w = std::get<Eigen::MatrixXd>(problem.delassus);
  for (Eigen::Index i = 0; i < problem.mu.size(); ++i) {
    const Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
    const Eigen::Index n = 2 * i;
    const Eigen::Index t = n + 1;
    problem.mu[i] = contact.friction_coefficient;
    double normal = contact.given_force;
    if (contact.normal_column < 0) {
      problem.q[n] = -w(n, n) * h * contact.given_force;
    } else if (contact.is_elastic()) {
      const Tangent law = tangent(step, local, i, speeds[n]);
      normal = law.elastic;
      w(n, n) += law.compliance / (h * h);
      problem.q[n] += law.gap / h;
    } else {
      problem.q[n] += leaving(step, local, i);
    }
    if (contact.slips_in_part) {
      if (!contact.beside) add_rings(step, local, i, speeds[n], problem);
      continue;
    }
    const Contact::Along friction = contact.along(normal, h);
    w(t, t) += friction.compliance / (h * h);
    problem.q[t] += friction.bend / h;
  }
  ++iterations_;
  if (problem.q.isZero(0.0)) {
    local.impulses.setZero();
    return;
  }
  complementarity::Options options;
  options.guess = local.impulses;
  const complementarity::Solution solution = complementarity::solve(problem, options);
  if (solution.status != complementarity::Status::solved) {
    const Eigen::Index worst = worst_contact(problem, solution.reactions);
    fail(FailureKind::not_converged, step.to, local.contacts[static_cast<std::size_t>(worst)]);
  }
  largest_merit_ = std::max(largest_merit_, solution.merit.largest());
  local.impulses = solution.reactions;
}

Eigen::Index worst_contact(const Problem& problem, const VectorXd& impulses) {
  const VectorXd u = complementarity::velocities(problem, impulses);
  Eigen::Index found = -1;
  double most = -1.0;
  for (Eigen::Index i = 0; i < problem.mu.size(); ++i) {
    const double weight = std::get<Eigen::MatrixXd>(problem.delassus)(2 * i, 2 * i);
    const double normal = std::abs(std::min(u[2 * i], weight * impulses[2 * i]));
    const double bound = problem.mu[i] * std::max(impulses[2 * i], 0.0);
    const double pulled = impulses[2 * i + 1] - u[2 * i + 1] / weight;
    const double along = weight * std::abs(impulses[2 * i + 1] - std::clamp(pulled, -bound, bound));
    if (normal + along > most) {
      most = normal + along;
      found = i;
    }
  }
  return found;
}

void Stepper::solve(Trial& step, Local& local) {
  complete(step, local);
  const Eigen::Index n = q_.size();
  VectorXd& held = step.held;
  for (int k = 0;; ++k) {
    const VectorXd residual = move(step);
    if (!residual.allFinite()) fail(FailureKind::not_finite, step.to, nullptr);
    if (k > 0 && balanced(step, residual, held, local, false)) return;
    if (k == options_->most_iterations) fail(FailureKind::not_converged, step.to, nullptr);
    VectorXd right(n + holds_.cols());
    right.head(n) = -residual;
    if (holds_.cols() > 0) right.tail(holds_.cols()) = held_speed_ - holds_.transpose() * step.v;
    const VectorXd correction = factor_.solve(right);
    const VectorXd free = step.v + correction.head(n);
    held = correction.tail(holds_.cols());
    step.v = free;
    if (!local.contacts.empty()) {
      solve_contacts(step, free, k == 0, local);
      const VectorXd answer = local.answers * local.impulses;
      step.v += answer.head(n);
      held += answer.tail(holds_.cols());
    }
  }
}

}  // namespace statejump::truss::detail
