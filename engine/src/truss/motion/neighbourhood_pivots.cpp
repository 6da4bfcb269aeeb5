// SPDX-License-Identifier: GPL-3.0-or-later
#include "neighbourhood_pivots.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace statejump::truss::detail {

using Eigen::Index;

namespace {

/// Initial size of a neighbourhood, in layers of joints. It is doubled while a correction reaches
/// the edge.
constexpr int first_layers = 4;
/// Tolerated velocity correction at the edge of a neighbourhood, divided by the largest correction.
/// Solves of the whole truss correct the remaining error. A smaller tolerance saves no solves: only
/// signs of residuals decide statuses.
constexpr double felt = 1e-2;

}  // namespace

NeighbourhoodPivots::NeighbourhoodPivots(const StepForces& forces, StepMatrix& matrix,
                                         TimeStep& step, StepContacts& contacts,
                                         ContactStatuses& statuses)
    : step_matrix_(matrix),
      step_(step),
      contacts_(contacts),
      statuses_(statuses),
      matrix_(matrix.matrix()),
      bodies_(forces.state().q.size() + matrix.constraints().columns().cols()),
      velocities_(forces.state().q.size()),
      position_(static_cast<std::size_t>(matrix_.cols()), -1),
      is_reached_(statuses.size(), false),
      residual_(VectorXd::Zero(bodies_)),
      left_(matrix_.cols()) {}

Index NeighbourhoodPivots::reach_of(const std::vector<std::size_t>& contacts) {
  Index sum = 0;
  for (const std::size_t contact : contacts) {
    begin(contact);
    sum += static_cast<Index>(inside_.size());
    if (sum > left_) break;
  }
  return sum;
}

bool NeighbourhoodPivots::settle(std::size_t contact) {
  if (requested(contact) == statuses_[contact]) return true;
  begin(contact);
  return find_active_set(*this);
}

NeighbourhoodPivots::Changes NeighbourhoodPivots::violated() const {
  Changes found;
  for (const std::size_t one : inside_contacts_) {
    const ContactStatus wanted = requested(one);
    if (wanted != statuses_[one]) found.emplace_back(one, wanted);
  }
  return found;
}

bool NeighbourhoodPivots::change(const Changes& changes, const PivotSearch<std::size_t>&) {
  for (const auto& [contact, to] : changes) {
    const auto mark = [contact = contact](ContactStatus status) {
      return (4 * contact + static_cast<std::size_t>(status) + 1) * 0x9e3779b97f4a7c15ull;
    };
    fingerprint_ ^= mark(statuses_[contact]) ^ mark(to);
    statuses_[contact] = to;
  }
  return true;
}

bool NeighbourhoodPivots::solve() {
  do {
    if (!move()) return false;
  } while (grow_where_felt());
  return true;
}

std::vector<std::size_t> NeighbourhoodPivots::reached_violations() const {
  std::vector<std::size_t> found;
  for (const std::size_t one : reached_) {
    if (requested(one) != statuses_[one]) found.push_back(one);
  }
  return found;
}

void NeighbourhoodPivots::begin(std::size_t contact) {
  for (const int unknown : inside_) position_[index(unknown)] = -1;
  inside_.clear();
  inside_contacts_.clear();
  std::vector<int> from;
  const auto n = static_cast<int>(bodies_) + 2 * static_cast<int>(contact);
  each_body_beside(n, [&](int body) { take_in(body, from); });
  each_body_beside(n + 1, [&](int body) { take_in(body, from); });
  layers_ = 0;
  grow(std::move(from), first_layers);
}

template <class Visit>
void NeighbourhoodPivots::each_body_beside(int unknown, Visit&& visit) const {
  for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_, unknown); it; ++it) {
    if (it.row() < bodies_) visit(static_cast<int>(it.row()));
  }
}

template <class Visit>
void NeighbourhoodPivots::each_neighbour(int body, Visit&& visit) const {
  for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_, body); it; ++it) {
    if (it.row() < bodies_) {
      visit(static_cast<int>(it.row()));
    } else {
      each_body_beside(static_cast<int>(it.row()), visit);
    }
  }
}

void NeighbourhoodPivots::take_in(int unknown, std::vector<int>& fresh) {
  if (position_[index(unknown)] >= 0) return;
  position_[index(unknown)] = 0;
  inside_.push_back(unknown);
  fresh.push_back(unknown);
}

void NeighbourhoodPivots::grow(std::vector<int> from, int layers) {
  std::vector<int> bodies = from;
  for (int k = 0; k < layers && !from.empty(); ++k) {
    std::vector<int> fresh;
    for (const int body : from) each_neighbour(body, [&](int one) { take_in(one, fresh); });
    bodies.insert(bodies.end(), fresh.begin(), fresh.end());
    from = std::move(fresh);
  }
  layers_ += layers;
  std::vector<int> fresh;
  for (const int body : bodies) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_, body); it; ++it) {
      if (it.row() < bodies_) continue;
      const Index contact = (it.row() - bodies_) / 2;
      const auto n = static_cast<int>(bodies_ + 2 * contact);
      if (position_[index(n)] >= 0) continue;
      const auto one = static_cast<std::size_t>(contact);
      inside_contacts_.push_back(one);
      if (!is_reached_[one]) reached_.push_back(one);
      is_reached_[one] = true;
      take_in(n, fresh);
      take_in(n + 1, fresh);
    }
  }
  std::sort(inside_.begin(), inside_.end());
  std::sort(inside_contacts_.begin(), inside_contacts_.end());
  for (std::size_t k = 0; k < inside_.size(); ++k) {
    position_[index(inside_[k])] = static_cast<int>(k);
  }
  factor_.emplace();
}

bool NeighbourhoodPivots::grow_where_felt() {
  const double most = felt * moved_.cwiseAbs().maxCoeff();
  std::vector<int> edge;
  for (std::size_t k = 0; k < inside_.size(); ++k) {
    const int body = inside_[k];
    if (body >= velocities_ || !(std::abs(moved_[static_cast<Index>(k)]) > most)) continue;
    bool at_edge = false;
    each_neighbour(body, [&](int one) { at_edge = at_edge || position_[index(one)] < 0; });
    if (at_edge) edge.push_back(body);
  }
  if (edge.empty()) return false;
  grow(std::move(edge), layers_);
  return true;
}

double NeighbourhoodPivots::right_side(Index i, bool across) const {
  const auto k = static_cast<std::size_t>(i);
  const Contact& contact = contacts_.contact(i);
  const ContactStatus status = statuses_[k];
  const Index row = 2 * i + (across ? 0 : 1);
  const double impulse = contacts_.impulses[row];
  if (across) {
    if (contact.normal_column < 0) return step_.h * contact.given_force - impulse;
    if (status == ContactStatus::open) return -impulse;
  } else if (status != ContactStatus::stick || contact.tangential_column < 0) {
    return StepContacts::friction_ratio(contact, status) * contacts_.impulses[2 * i] - impulse;
  }
  const ContactRow law = across ? contacts_.normal_row(step_, i) : contacts_.stick_row(step_, i);
  return -step_matrix_.scale() * contacts_.residual(law, step_, i, across);
}

bool NeighbourhoodPivots::move() {
  if (is_spent()) return false;
  left_ -= static_cast<Index>(inside_.size());
  const auto size = static_cast<Index>(inside_.size());
  VectorXd right(size);
  for (Index k = 0; k < size; ++k) {
    const int unknown = inside_[static_cast<std::size_t>(k)];
    if (unknown < bodies_) right[k] = residual_[unknown];
  }
  for (const std::size_t contact : inside_contacts_) {
    const auto i = static_cast<Index>(contact);
    const Index n = position_[static_cast<std::size_t>(bodies_ + 2 * i)];
    step_matrix_.update_entries(statuses_[contact], step_, contacts_, i);
    right[n] = right_side(i, true);
    right[n + 1] = right_side(i, false);
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (Index k = 0; k < size; ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_,
                                                       inside_[static_cast<std::size_t>(k)]);
         it; ++it) {
      const int row = position_[static_cast<std::size_t>(it.row())];
      if (row >= 0) entries.emplace_back(row, k, it.value());
    }
  }
  Eigen::SparseMatrix<double> part(size, size);
  part.setFromTriplets(entries.begin(), entries.end());
  part.makeCompressed();
  if (!factor_->factorize(part)) return false;
  moved_ = factor_->solve(right);
  if (!moved_.allFinite()) return false;
  for (Index k = 0; k < size; ++k) {
    const int unknown = inside_[static_cast<std::size_t>(k)];
    const double by = moved_[k];
    // The impulses of constraints are not needed for a guess.
    if (unknown < velocities_) {
      step_.v[unknown] += by;
    } else if (unknown >= bodies_) {
      contacts_.impulses[unknown - bodies_] += step_matrix_.scale() * by;
    }
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_, unknown); it; ++it) {
      if (it.row() < bodies_) residual_[it.row()] -= by * it.value();
    }
  }
  return true;
}

}  // namespace statejump::truss::detail
