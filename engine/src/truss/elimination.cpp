// SPDX-License-Identifier: GPL-3.0-or-later
#include "elimination.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace statejump::truss::detail {

namespace {

/// If two terms cancel to less than this fraction of the larger one, their sum counts as zero.
/// Terms are sums of at most some thousand products with a rounding of 1e-16.
constexpr double rounding_fraction = 1e-12;
/// Factors equal up to rounding count as equally large pivots.
constexpr double equal_fraction = 1.0 - rounding_fraction;

using Sum = std::map<int, double>;

/// Adds a value to the factor of a displacement in a sum.
/// @returns false if the factor cancels and the displacement is removed from the sum
bool add(Sum& sum, int place, double value) {
  const auto [at, is_new] = sum.try_emplace(place, value);
  if (is_new) return true;
  const double larger = std::max(std::abs(at->second), std::abs(value));
  at->second += value;
  if (std::abs(at->second) > rounding_fraction * larger) return true;
  sum.erase(at);
  return false;
}

/// Elimination while constraints are added.
class Eliminating {
 public:
  explicit Eliminating(const Model& model) : model_(&model) {}

  void add(int which) {
    if (!add(model_->constraints[static_cast<std::size_t>(which)])) {
      made_.redundant.push_back(which);
    }
  }
  /// @returns false if the constraint is redundant
  bool add(const Constraint& constraint) {
    Sum sum = independent(constraint);
    if (sum.empty()) return false;
    const int pivot = pivot_of(sum);
    const double by = -1.0 / sum.at(pivot);
    sum.erase(pivot);
    for (auto& [place, factor] : sum) factor *= by;
    substitute(pivot, sum);
    for (const auto& [place, factor] : sum) used_in_[place].insert(pivot);
    made_.sums.emplace(pivot, std::move(sum));
    return true;
  }
  Elimination take() && { return std::move(made_); }

 private:
  /// The terms of a constraint, in which sums of independent displacements replace the dependent
  /// ones.
  Sum independent(const Constraint& constraint) const {
    Sum sum;
    for (const ConstraintTerm& term : constraint.terms) {
      const auto count = static_cast<int>(model_->nodes.size());
      const bool is_rotation = term.node >= count;
      const Node& node =
          model_->nodes[static_cast<std::size_t>(is_rotation ? term.node - count : term.node)];
      const Directions& directions = is_rotation ? node.rotation_directions : node.free_directions;
      const int freedoms = is_rotation ? node.rotations : node.freedoms;
      // A rotation is measured at the distance Node::arm.
      const double unit = is_rotation ? 1.0 / node.arm : 1.0;
      for (int i = 0; i < freedoms; ++i) {
        const double part = directions.col(i).dot(term.factor);
        if (!(std::abs(part) > rounding_fraction * term.factor.norm())) continue;
        const double factor = unit * part;
        const int place = place_of(term.node, i);
        const auto dependent = made_.sums.find(place);
        if (dependent == made_.sums.end()) {
          detail::add(sum, place, factor);
          continue;
        }
        for (const auto& [of, share] : dependent->second) detail::add(sum, of, factor * share);
      }
    }
    return sum;
  }

  int pivot_of(const Sum& sum) const {
    double largest = 0.0;
    for (const auto& [place, factor] : sum) largest = std::max(largest, std::abs(factor));
    int pivot = -1;
    std::size_t fewest = 0;
    for (const auto& [place, factor] : sum) {
      if (std::abs(factor) < equal_fraction * largest) continue;
      const auto found = used_in_.find(place);
      const std::size_t uses = found == used_in_.end() ? 0 : found->second.size();
      if (pivot >= 0 && uses >= fewest) continue;
      pivot = place;
      fewest = uses;
    }
    return pivot;
  }

  /// Replaces a displacement in the sums of others.
  void substitute(int place, const Sum& by) {
    const auto uses = used_in_.find(place);
    if (uses == used_in_.end()) return;
    for (const int dependent : uses->second) {
      Sum& of = made_.sums.at(dependent);
      const double share = of.at(place);
      of.erase(place);
      for (const auto& [other, factor] : by) {
        if (detail::add(of, other, share * factor)) {
          used_in_[other].insert(dependent);
        } else {
          used_in_[other].erase(dependent);
        }
      }
    }
    used_in_.erase(place);
  }

  const Model* model_;
  Elimination made_;
  // dependent displacements by the displacements in their sums
  std::map<int, std::set<int>> used_in_;
};

}  // namespace

Elimination eliminate(const Model& model) {
  Eliminating made(model);
  for (std::size_t i = 0; i < model.constraints.size(); ++i) made.add(static_cast<int>(i));
  for (const Joint& joint : model.joints) {
    for (const Constraint& tie : ties_of(joint, model)) made.add(tie);
  }
  return std::move(made).take();
}

}  // namespace statejump::truss::detail
