// SPDX-License-Identifier: GPL-3.0-or-later
#include "step_matrix.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "entries.hpp"

namespace statejump::truss::detail {

namespace {

/// Number of stored factors of other statuses or step lengths.
constexpr std::size_t most_kept = 8;

/// Whether an impulse could accelerate a contact opposite to the impulse. If so, the step is longer
/// than the time scale of an instability, and the contact problem may have no solution.
bool is_indefinite(const Eigen::MatrixXd& delassus) {
  constexpr double rounding = 1e-8;  // of systems with the condition number of stiff links
  if (delassus.size() == 0) return false;
  const VectorXd pivots = delassus.ldlt().vectorD();
  return pivots.minCoeff() < -rounding * pivots.cwiseAbs().maxCoeff();
}

}  // namespace

StepMatrix::StepMatrix(StepForces& forces, const std::vector<Drive>& drives)
    : forces_(forces), constraints_(forces, drives) {}

void StepMatrix::fill_bodies(const TimeStep& step, RefilledMatrix& to) {
  const Bodies& bodies = forces_.bodies();
  const Eigen::Index n = forces_.state().q.size();
  const double by_speed = step.h * step.theta;
  const double by_place = by_speed * by_speed;
  VectorXd diagonal = VectorXd::Zero(n);
  const auto add = [&](Eigen::Index row, Eigen::Index column, double value) {
    to.add(row, column, value);
    if (row == column) diagonal[row] += value;
  };
  const auto add_block = [&](const auto& matrix, double share) {
    each_entry(matrix, n, [&](Eigen::Index row, Eigen::Index column, double value) {
      add(row, column, share * value);
    });
  };
  add_block(bodies.mass(), 1.0);
  add_block(forces_.evaluate_elements(step.q_middle, step.to).jacobian(), by_place);
  if (step.is_definite) {
    for (const auto& one : bodies.compression_entries(step.q_middle, step.to)) {
      add(one.row(), one.col(), by_place * one.value());
    }
  }
  if (forces_.contacts().have_springs()) {
    add_block(forces_.evaluate_springs_with_holds(step.q_middle, step.to).jacobian(), by_place);
  }
  if (bodies.damped()) {
    for (const auto& one : bodies.damping_entries(step.q_middle)) {
      add(one.row(), one.col(), by_speed * one.value());
    }
  }
  constraints_.set(step, diagonal.maxCoeff());
  const Eigen::SparseMatrix<double>& columns = constraints_.columns();
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(columns, k); it; ++it) {
      to.add(it.row(), n + k, it.value());
      to.add(n + k, it.row(), it.value());
    }
  }
}

StatusFactors& StepMatrix::factors_for(double h, const StepContacts& contacts,
                                       const ContactStatuses& statuses) {
  // Equal step lengths differ by rounding of times.
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const auto& one) {
    return std::abs(one->h - h) <= 1e-6 * h && one->statuses == statuses &&
           one->active == contacts.numbers;
  });
  if (found != kept_.end()) {
    std::rotate(kept_.begin(), found, found + 1);
    return *kept_.front();
  }
  // The pattern depends on the active contacts only. The oldest factors with the same pattern are
  // overwritten, so that no new ordering is needed.
  const auto same = std::find_if(kept_.rbegin(), kept_.rend(),
                                 [&](const auto& one) { return one->active == contacts.numbers; });
  if (kept_.size() < most_kept || same == kept_.rend()) {
    if (kept_.size() == most_kept) kept_.pop_back();
    kept_.insert(kept_.begin(), std::make_unique<StatusFactors>());
  } else {
    std::rotate(kept_.begin(), same.base() - 1, same.base());
  }
  StatusFactors& made = *kept_.front();
  made.h = h;
  made.active = contacts.numbers;
  made.statuses = statuses;
  made.outdated = true;
  return made;
}

bool StepMatrix::factorize(StatusFactors& of, const TimeStep& step, const StepContacts& contacts) {
  assemble(of.statuses, step, contacts);
  of.scale = constraints_.scale();
  ++factorizations_;
  return of.factor.factorize(matrix_.matrix());
}

void StepMatrix::assemble(const ContactStatuses& statuses, const TimeStep& step,
                          const StepContacts& contacts) {
  const bool is_new = step_number_ != step.number;
  if (is_new) {
    matrix_.begin(forces_.state().q.size() + constraints_.count() + contacts.impulses.size());
    fill_bodies(step, matrix_);
    scale_ = constraints_.scale();
    contact_entries_.resize(statuses.size());
  } else if (constraints_.scale() != scale_) {
    constraints_.set(step, scale_);
  }
  for (std::size_t k = 0; k < statuses.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (is_new) {
      contact_entries_[k] = matrix_.next();
      each_contact_entry(statuses[k], step, contacts, i, [&](auto row, auto column, double value) {
        matrix_.add(row, column, value);
      });
    } else {
      update_entries(statuses[k], step, contacts, i);
    }
  }
  if (is_new) matrix_.end();
  step_number_ = step.number;
}

void StepMatrix::update_entries(ContactStatus status, const TimeStep& step,
                                const StepContacts& contacts, Eigen::Index i) {
  std::size_t entry = contact_entries_[static_cast<std::size_t>(i)];
  each_contact_entry(status, step, contacts, i,
                     [&](auto, auto, double value) { matrix_.set(entry++, value); });
}

template <class Visit>
void StepMatrix::each_contact_entry(ContactStatus now, const TimeStep& step,
                                    const StepContacts& contacts, Eigen::Index i,
                                    Visit&& visit) const {
  const Contact& contact = contacts.contact(i);
  const double scale = constraints_.scale();
  const Eigen::Index n = forces_.state().q.size() + constraints_.columns().cols() + 2 * i;
  const Eigen::Index t = n + 1;
  // An inactive row is an identity row: its impulse keeps its value.
  // @param beside index of the contact for the other tangent; −1: none
  const auto row = [&](Eigen::Index at, bool is_active, const ContactRow& law,
                       Eigen::Index beside) {
    using Column = Eigen::SparseMatrix<double>::InnerIterator;
    Column other(contacts.directions, 2 * std::max<Eigen::Index>(beside, 0) + 1);
    for (Column it(contacts.directions, 2 * i + at - n); it; ++it) {
      double speed = law.by_speed * it.value();
      // Both columns have the same pattern.
      if (beside >= 0) {
        speed += law.by_beside * other.value();
        ++other;
      }
      visit(at, it.row(), is_active ? scale * speed : 0.0);
      visit(it.row(), at, -scale * it.value());
    }
    visit(at, at, is_active ? scale * scale * law.compliance : scale);
  };
  const bool touches = now != ContactStatus::open && contact.normal_column >= 0;
  const bool sticks = now == ContactStatus::stick && contact.tangential_column >= 0;
  row(n, touches, touches ? contacts.normal_row(step, i) : ContactRow{}, -1);
  const ContactRow along = sticks ? contacts.stick_row(step, i) : ContactRow{};
  row(t, sticks, along, contacts.partner(i));
  const double pressed = scale * scale * along.by_normal;
  if (contact.slips_in_part && contact.beside) visit(t, n - 2, pressed);
  visit(t, n,
        touches && !sticks ? -scale * StepContacts::friction_ratio(contact, now)
        : contact.beside   ? 0.0
                           : pressed);
}

Delassus StepMatrix::delassus(const TimeStep& step, const StepContacts& contacts) {
  ++factorizations_;
  const Eigen::Index n = forces_.state().q.size();
  bodies_matrix_.begin(n + constraints_.count());
  fill_bodies(step, bodies_matrix_);
  bodies_matrix_.end();
  if (!bodies_factor_.factorize(bodies_matrix_.matrix())) {
    fail_step(forces_.system(), FailureKind::singular, step.to, nullptr);
  }
  const Eigen::Index constraints = constraints_.columns().cols();
  const Eigen::Index rows = contacts.directions.cols();
  Delassus found;
  found.responses = Eigen::MatrixXd::Zero(n + constraints, rows);
  VectorXd right = VectorXd::Zero(n + constraints);
  for (Eigen::Index k = 0; k < rows; ++k) {
    if (contacts.directions.col(k).nonZeros() == 0) continue;
    right.head(n) = contacts.directions.col(k);
    found.responses.col(k) = bodies_factor_.solve(right);
  }
  found.matrix = contacts.directions.transpose() * found.responses.topRows(n);
  if (is_indefinite(found.matrix)) {
    fail_step(forces_.system(), FailureKind::not_converged, step.to, nullptr);
  }
  // Empty rows are scaled to the size of the others.
  const auto real = (found.matrix.diagonal().array() > 0.0).count();
  const double size = real > 0 ? found.matrix.trace() / static_cast<double>(real) : 1.0;
  for (Eigen::Index k = 0; k < rows; ++k) {
    const Contact& contact = contacts.contact(k / 2);
    const int column = k % 2 == 0 ? contact.normal_column : contact.tangential_column;
    if (column < 0) found.matrix(k, k) = size;
  }
  return found;
}

}  // namespace statejump::truss::detail
