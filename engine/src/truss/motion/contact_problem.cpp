// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_problem.hpp"

#include <algorithm>
#include <cmath>

namespace statejump::truss::detail {

using complementarity::Problem;

void ContactProblem::solve_contacts(const TimeStep& step, const VectorXd& free, bool first,
                                    StepContacts& contacts) {
  const double h = step.h;
  const Eigen::MatrixXd& delassus = contacts.delassus.matrix;
  Problem problem{2, delassus, contacts.directions.transpose() * free,
                  VectorXd::Zero(contacts.count())};
  const VectorXd speeds =
      first ? VectorXd(contacts.directions.transpose() * forces_.state().v)
            : VectorXd(contacts.directions.transpose() * free + delassus * contacts.impulses);
  using At = StepContacts::TangentAt;
  if (forces_.contacts().slip_in_part()) {
    contacts.place_tangents(step, speeds, first ? At::kinks : At::next);
  }
  Eigen::MatrixXd& w = std::get<Eigen::MatrixXd>(problem.delassus);
  for (Eigen::Index i = 0; i < problem.mu.size(); ++i) {
    const Contact& contact = contacts.contact(i);
    const Eigen::Index n = 2 * i;
    const Eigen::Index t = n + 1;
    problem.mu[i] = contact.friction_coefficient;
    double normal = contact.given_force;
    if (contact.normal_column < 0) {
      problem.q[n] = -w(n, n) * h * contact.given_force;
    } else if (contact.is_elastic()) {
      const StepContacts::Tangent law = contacts.normal_tangent(step, i, speeds[n]);
      normal = law.elastic;
      w(n, n) += law.compliance / (h * h);
      problem.q[n] += law.gap / h;
    } else {
      problem.q[n] += contacts.leaving_speed(step, i);
    }
    if (contact.slips_in_part) {
      if (!contact.beside) contacts.add_partial_slip(step, i, speeds[n], problem);
      continue;
    }
    const Contact::Along friction = contact.along(normal, h);
    w(t, t) += friction.compliance / (h * h);
    problem.q[t] += friction.bend / h;
  }
  ++iterations_;
  if (problem.q.isZero(0.0)) {
    contacts.impulses.setZero();
    return;
  }
  complementarity::Options options;
  options.guess = contacts.impulses;
  const complementarity::Solution solution = complementarity::solve(problem, options);
  if (solution.status != complementarity::Status::solved) {
    const Eigen::Index worst = worst_contact(problem, solution.reactions);
    fail_step(forces_.system(), FailureKind::not_converged, step.to, &contacts.contact(worst));
  }
  largest_merit_ = std::max(largest_merit_, solution.merit.largest());
  contacts.impulses = solution.reactions;
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

void ContactProblem::solve(TimeStep& step, StepContacts& contacts) {
  const System& system = forces_.system();
  contacts.delassus = matrix_.delassus(step, contacts);
  VelocityConstraints& constraints = matrix_.constraints();
  const Eigen::SparseMatrix<double>& columns = constraints.columns();
  const Eigen::Index n = forces_.state().q.size();
  VectorXd& held = step.held;
  held = VectorXd::Zero(columns.cols());
  const double drift = forces_.rounding_at_middle(step) / step.h;
  for (int k = 0;; ++k) {
    const VectorXd residual = forces_.move(step);
    if (!residual.allFinite()) fail_step(system, FailureKind::not_finite, step.to, nullptr);
    constraints.follow();
    const VectorXd pushed = columns.cols() > 0 ? constraints.push(step) : VectorXd();
    const VectorXd lack = constraints.lack(step);
    if (k > 0 && forces_.balanced(step, residual, pushed, contacts, false) &&
        constraints.met(step, lack, drift)) {
      return;
    }
    if (k == options_.most_iterations) {
      fail_step(system, FailureKind::not_converged, step.to, nullptr);
    }
    VectorXd right(n + columns.cols());
    right.head(n) = -residual;
    if (columns.cols() > 0) {
      right.head(n) -= pushed;
      right.tail(columns.cols()) = lack;
    }
    const VectorXd correction = matrix_.solve_bodies(right);
    const VectorXd free = step.v + correction.head(n);
    held += correction.tail(columns.cols());
    step.v = free;
    if (contacts.count() > 0) {
      solve_contacts(step, free, k == 0, contacts);
      const VectorXd answer = contacts.delassus.responses * contacts.impulses;
      step.v += answer.head(n);
      held += answer.tail(columns.cols());
    }
  }
}

}  // namespace statejump::truss::detail
