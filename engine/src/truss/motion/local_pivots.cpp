// SPDX-License-Identifier: GPL-3.0-or-later
// Pivots in the neighbourhood of contacts that ask for another branch. Where slip spreads from one
// joint to the next, a step in which it passes many would be as many systems of the whole truss:
// every one shows the next joint only. Impulses are felt as far as sound goes in a step, so that
// these systems need not be of the whole truss; what they find is a guess, which is solved and
// asked as any other.
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "stepper.hpp"

namespace statejump::truss::detail {

namespace {

using Eigen::Index;

/// Joints that a neighbourhood reaches at first; it doubles while more is felt at its edge.
constexpr int first_layers = 4;
/// Share of the largest change of a velocity that its edge may feel. What is left of it has to be
/// found by the systems of the whole truss, which a smaller share would spare nothing: a contact is
/// on another branch by its sign.
constexpr double felt = 1e-2;

}  // namespace

class Stepper::LocalPivots {
 public:
  /// @param branches those on which the step is solved, and then those that are found
  LocalPivots(Stepper& stepper, Trial& step, Local& local, std::vector<Branch>& branches)
      : stepper_(stepper),
        step_(step),
        local_(local),
        branches_(branches),
        matrix_(stepper.matrix_.matrix()),
        bodies_(stepper.q_.size() + stepper.holds_.cols()),
        held_(stepper.q_.size()),
        place_(static_cast<std::size_t>(matrix_.cols()), -1),
        is_reached_(branches.size(), false),
        lacks_(VectorXd::Zero(bodies_)),
        left_(matrix_.cols()) {}

  /// Unknowns of the neighbourhoods of all these contacts, as they are at first.
  Index reach_of(const std::vector<std::size_t>& contacts) {
    Index sum = 0;
    for (const std::size_t contact : contacts) {
      begin(contact);
      sum += static_cast<Index>(inside_.size());
      if (sum > left_) break;
    }
    return sum;
  }

  /// Pivots around a contact until none that is felt there asks for another branch. False if that
  /// is not found, or if is_spent().
  bool settle(std::size_t contact) {
    if (asked(contact) == branches_[contact]) return true;
    begin(contact);
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    std::unordered_set<std::size_t> tried;
    for (;;) {
      std::vector<std::size_t> wrong;
      for (const std::size_t one : contacts_) {
        if (asked(one) != branches_[one]) wrong.push_back(one);
      }
      if (wrong.empty()) return true;
      if (wrong.size() < fewest) {
        fewest = wrong.size();
        tried.clear();
      } else {
        wrong.erase(wrong.begin() + 1, wrong.end());
      }
      for (const std::size_t one : wrong) change(one, asked(one));
      if (!tried.insert(fingerprint_).second) return false;
      do {
        if (!move()) return false;
      } while (grow_where_felt());
    }
  }

  /// Contacts of all neighbourhoods so far that ask for another branch.
  std::vector<std::size_t> asking() const {
    std::vector<std::size_t> found;
    for (const std::size_t one : reached_) {
      if (asked(one) != branches_[one]) found.push_back(one);
    }
    return found;
  }

  /// Whether it has cost as much as a system of the whole truss.
  bool is_spent() const { return left_ <= 0; }

 private:
  Branch asked(std::size_t contact) const {
    return stepper_.asked(step_, local_, static_cast<Index>(contact), branches_[contact]);
  }
  void change(std::size_t contact, Branch to) {
    const auto mark = [&](Branch branch) {
      return (4 * contact + static_cast<std::size_t>(branch) + 1) * 0x9e3779b97f4a7c15ull;
    };
    fingerprint_ ^= mark(branches_[contact]) ^ mark(to);
    branches_[contact] = to;
  }

  void begin(std::size_t contact) {
    for (const int unknown : inside_) place_[index(unknown)] = -1;
    inside_.clear();
    contacts_.clear();
    std::vector<int> from;
    const auto n = static_cast<int>(bodies_) + 2 * static_cast<int>(contact);
    each_body_beside(n, [&](int body) { see(body, from); });
    each_body_beside(n + 1, [&](int body) { see(body, from); });
    layers_ = 0;
    grow(std::move(from), first_layers);
  }

  template <class Visit>
  void each_body_beside(int unknown, Visit&& visit) const {
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_, unknown); it; ++it) {
      if (it.row() < bodies_) visit(static_cast<int>(it.row()));
    }
  }
  /// Bodies with which one shares a link, a hold or a contact, and itself.
  template <class Visit>
  void each_neighbour(int body, Visit&& visit) const {
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_, body); it; ++it) {
      if (it.row() < bodies_) {
        visit(static_cast<int>(it.row()));
      } else {
        each_body_beside(static_cast<int>(it.row()), visit);
      }
    }
  }
  void see(int unknown, std::vector<int>& fresh) {
    if (place_[index(unknown)] >= 0) return;
    place_[index(unknown)] = 0;
    inside_.push_back(unknown);
    fresh.push_back(unknown);
  }

  /// Takes in what is so many layers around bodies, with all contacts that touch a body inside.
  void grow(std::vector<int> from, int layers) {
    std::vector<int> bodies = from;
    for (int k = 0; k < layers && !from.empty(); ++k) {
      std::vector<int> fresh;
      for (const int body : from) each_neighbour(body, [&](int one) { see(one, fresh); });
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
        if (place_[index(n)] >= 0) continue;
        const auto one = static_cast<std::size_t>(contact);
        contacts_.push_back(one);
        if (!is_reached_[one]) reached_.push_back(one);
        is_reached_[one] = true;
        see(n, fresh);
        see(n + 1, fresh);
      }
    }
    std::sort(inside_.begin(), inside_.end());
    std::sort(contacts_.begin(), contacts_.end());
    for (std::size_t k = 0; k < inside_.size(); ++k) {
      place_[index(inside_[k])] = static_cast<int>(k);
    }
    factor_.emplace();
  }

  /// Whether the last move was felt at the edge, which then has become a wider one.
  bool grow_where_felt() {
    const double most = felt * moved_.cwiseAbs().maxCoeff();
    std::vector<int> edge;
    for (std::size_t k = 0; k < inside_.size(); ++k) {
      const int body = inside_[k];
      if (body >= held_ || !(std::abs(moved_[static_cast<Index>(k)]) > most)) continue;
      bool at_edge = false;
      each_neighbour(body, [&](int one) { at_edge = at_edge || place_[index(one)] < 0; });
      if (at_edge) edge.push_back(body);
    }
    if (edge.empty()) return false;
    grow(std::move(edge), layers_);
    return true;
  }

  /// What a row of a contact asks of a move.
  double right_side(Index i, bool across) const {
    const auto k = static_cast<std::size_t>(i);
    const Contact& contact = *local_.contacts[k];
    const Branch branch = branches_[k];
    const Index row = 2 * i + (across ? 0 : 1);
    const double impulse = local_.impulses[row];
    if (across) {
      if (contact.normal_column < 0) return step_.h * contact.given_force - impulse;
      if (branch == Branch::open) return -impulse;
    } else if (branch != Branch::stick || contact.tangential_column < 0) {
      return slide(contact, branch) * local_.impulses[2 * i] - impulse;
    }
    const Law law =
        across ? stepper_.normal_law(step_, local_, i) : stepper_.stick_law(step_, local_, i);
    return -stepper_.matrix_scale_ * stepper_.lacks(law, step_, local_, i, across);
  }

  /// Goes to the solution of the neighbourhood on the present branches.
  bool move() {
    if (is_spent()) return false;
    left_ -= static_cast<Index>(inside_.size());
    const auto size = static_cast<Index>(inside_.size());
    VectorXd right(size);
    for (Index k = 0; k < size; ++k) {
      const int unknown = inside_[static_cast<std::size_t>(k)];
      if (unknown < bodies_) right[k] = lacks_[unknown];
    }
    for (const std::size_t contact : contacts_) {
      const auto i = static_cast<Index>(contact);
      const Index n = place_[static_cast<std::size_t>(bodies_ + 2 * i)];
      stepper_.retell(branches_[contact], step_, local_, i);
      right[n] = right_side(i, true);
      right[n + 1] = right_side(i, false);
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (Index k = 0; k < size; ++k) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_,
                                                         inside_[static_cast<std::size_t>(k)]);
           it; ++it) {
        const int row = place_[static_cast<std::size_t>(it.row())];
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
      // What holds is nowhere asked for.
      if (unknown < held_) {
        step_.v[unknown] += by;
      } else if (unknown >= bodies_) {
        local_.impulses[unknown - bodies_] += stepper_.matrix_scale_ * by;
      }
      for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_, unknown); it; ++it) {
        if (it.row() < bodies_) lacks_[it.row()] -= by * it.value();
      }
    }
    return true;
  }

  Stepper& stepper_;
  Trial& step_;
  Local& local_;
  std::vector<Branch>& branches_;
  const Eigen::SparseMatrix<double>& matrix_;
  const Index bodies_;       ///< Unknowns that are not the contacts': velocities, and what holds.
  const Index held_;         ///< The first of what holds.
  std::vector<int> place_;   ///< Of an unknown in the neighbourhood, or −1.
  std::vector<int> inside_;  ///< Its unknowns.
  std::vector<std::size_t> contacts_;  ///< Its contacts.
  std::vector<std::size_t> reached_;   ///< Contacts of all neighbourhoods so far.
  std::vector<bool> is_reached_;
  int layers_ = 0;
  VectorXd lacks_;  ///< Right sides of all rows that are not contacts'.
  VectorXd moved_;  ///< By the last move.
  std::optional<linear::SparseFactor> factor_;
  std::size_t fingerprint_ = 0;  ///< Of the branches.
  Index left_;  ///< Unknowns to be solved for until it costs as much as the whole truss.
};

Stepper::Guess Stepper::pivot_locally(const std::vector<Branch>& branches,
                                      const std::vector<Branch>& next,
                                      const std::vector<std::size_t>& wrong, Trial& step,
                                      Local& local) {
  assemble(branches, step, local);
  std::vector<Branch> found = branches;
  LocalPivots pivots(*this, step, local, found);
  if (pivots.reach_of(wrong) > matrix_.matrix().cols()) return {next, false};
  // Those that are settled may ask again when others are.
  for (std::vector<std::size_t> asking = wrong; !asking.empty(); asking = pivots.asking()) {
    for (const std::size_t contact : asking) {
      if (pivots.settle(contact)) continue;
      if (!pivots.is_spent()) return {next, false};
      for (const std::size_t one : wrong) {
        if (found[one] == branches[one]) found[one] = next[one];
      }
      return {found, true};
    }
  }
  return {found, true};
}

}  // namespace statejump::truss::detail
