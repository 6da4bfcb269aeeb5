// SPDX-License-Identifier: GPL-3.0-or-later
#include "schur_active_set.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

#include "active_set.hpp"

namespace statejump::truss::detail {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// A row of the equations on one status.
struct Row {
  std::vector<std::pair<int, double>> gradient;  ///< Unknowns and derivatives.
  double value = 0.0;

  bool operator==(const Row&) const = default;
};

/// Rows of a joint's forces on one status.
using Rows = std::vector<Row>;

/// The equations of a step, condensed to the rows that change with the statuses.
class Condensed {
 public:
  Condensed(const System& system, const Linearized& of, const std::vector<int>& joints)
      : system_(system),
        of_(of),
        listing_(Assembly::listing(system.unknowns())),
        statuses_(of.statuses),
        end_(of.z + of.step),
        local_(index(system.unknowns()), -1) {
    for (const int joint : joints) {
      if (of.statuses[index(joint)] == JointStatus::open) continue;
      joints_.push_back(joint);
      // Its rows contain all unknowns on which it depends.
      for (const Row& row : rows(joint, of.statuses[index(joint)])) {
        for (const auto& entry : row.gradient) see(entry.first);
      }
      for (int k = 0; k < system.force_count(joint); ++k) see(system.force_row(joint) + k);
    }
  }

  std::optional<SchurActiveSet> find() {
    if (!find_active_set(*this)) return std::nullopt;
    return SchurActiveSet{statuses_, whole_step()};
  }

  // For find_active_set().
  using Changes = std::vector<std::pair<int, JointStatus>>;
  std::size_t key() const { return fingerprint(statuses_); }
  Changes violated() const {
    const Rounding slack = system_.rounding(end_);
    Changes found;
    for (const int joint : joints_) {
      const JointStatus status = statuses_[index(joint)];
      const JointStatus wanted =
          system_.decide(joint, end_, of_.time, of_.start, of_.model, of_.opening, status, slack);
      if (wanted != status && wanted != JointStatus::open) found.emplace_back(joint, wanted);
    }
    return found;
  }
  bool change(const Changes& changes, const PivotSearch<std::size_t>&) {
    return std::all_of(changes.begin(), changes.end(),
                       [&](const auto& one) { return change(one.first, one.second); });
  }
  /// Computes the solution on the present statuses, for the unknowns on which the joints depend.
  bool solve() {
    condensed_ = inverse_ * values_;
    VectorXd moved = VectorXd::Zero(static_cast<Index>(seen_.size()));
    for (std::size_t j = 0; j < responses_.size(); ++j) {
      moved += condensed_[static_cast<Index>(j)] * responses_[j];
    }
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      const int unknown = seen_[k];
      end_[unknown] = of_.z[unknown] + of_.step[unknown] - moved[static_cast<Index>(k)];
    }
    return true;
  }

 private:
  const Rows& rows(int joint, JointStatus status) {
    const auto [found, is_new] = rows_.try_emplace({joint, status});
    if (!is_new) return found->second;
    system_.evaluate_joint(joint, of_.z, of_.time, of_.start, status, of_.model, of_.opening,
                           listing_);
    const int first = system_.force_row(joint);
    Rows made(index(system_.force_count(joint)));
    for (std::size_t k = 0; k < made.size(); ++k) {
      made[k].value = listing_.residual[first + static_cast<int>(k)];
    }
    for (const auto& entry : listing_.entries) {
      const int row = entry.row() - first;
      if (row < 0 || row >= static_cast<int>(made.size())) continue;
      made[index(row)].gradient.emplace_back(entry.col(), entry.value());
    }
    return found->second = std::move(made);
  }

  void see(int unknown) {
    int& place = local_[index(unknown)];
    if (place >= 0) return;
    place = static_cast<int>(seen_.size());
    seen_.push_back(unknown);
  }

  /// Changes the status of a joint. False: the equations become singular.
  bool change(int joint, JointStatus status) {
    const Rows& before = rows(joint, statuses_[index(joint)]);
    const Rows& after = rows(joint, status);
    statuses_[index(joint)] = status;
    for (std::size_t k = 0; k < after.size(); ++k) {
      if (before[k] == after[k]) continue;
      if (!set(place_of(system_.force_row(joint) + static_cast<int>(k)), after[k])) return false;
    }
    return true;
  }

  /// Index of a row among the condensed rows; a new row begins on the status of the base.
  Index place_of(int row) {
    const auto n = static_cast<Index>(responses_.size());
    const auto [found, is_new] = place_.try_emplace(row, n);
    if (!is_new) return found->second;
    rows_condensed_.push_back(row);
    const VectorXd response = of_.factors.solve(VectorXd::Unit(system_.unknowns(), row));
    responses_.emplace_back(response(seen_));
    // In the condensed matrix the new row is an identity row, because it still has the status that
    // was factored. The other rows have their present status.
    VectorXd column(n);
    for (Index i = 0; i < n; ++i) column[i] = along(now_[static_cast<std::size_t>(i)], n);
    inverse_.conservativeResize(n + 1, n + 1);
    inverse_.col(n).head(n) = -(inverse_.topLeftCorner(n, n) * column);
    inverse_.row(n).setZero();
    inverse_(n, n) = 1.0;
    values_.conservativeResize(n + 1);
    values_[n] = 0.0;
    now_.emplace_back();
    matrix_.conservativeResize(n + 1, n + 1);
    matrix_.col(n).head(n) = column;
    matrix_.row(n).setZero();
    matrix_(n, n) = 1.0;
    return n;
  }

  double along(const Row& row, Index column) const {
    double sum = 0.0;
    const VectorXd& response = responses_[static_cast<std::size_t>(column)];
    for (const auto& [unknown, slope] : row.gradient) {
      sum += slope * response[local_[index(unknown)]];
    }
    return sum;
  }

  bool set(Index place, const Row& row) {
    const auto n = static_cast<Index>(responses_.size());
    Eigen::RowVectorXd now(n);
    for (Index j = 0; j < n; ++j) now[j] = along(row, j);
    const Eigen::RowVectorXd passed = (now - matrix_.row(place)) * inverse_;
    const double pivot = 1.0 + passed[place];
    if (!(std::abs(pivot) > 0.0) || !std::isfinite(pivot)) return false;
    inverse_ -= VectorXd(inverse_.col(place)) * (passed / pivot);
    matrix_.row(place) = now;
    values_[place] = row.value;
    for (const auto& [unknown, slope] : row.gradient) values_[place] += slope * of_.step[unknown];
    now_[static_cast<std::size_t>(place)] = row;
    return true;
  }

  VectorXd whole_step() const {
    VectorXd right = VectorXd::Zero(system_.unknowns());
    for (std::size_t j = 0; j < rows_condensed_.size(); ++j) {
      right[rows_condensed_[j]] = condensed_[static_cast<Index>(j)];
    }
    return of_.step - of_.factors.solve(right);
  }

  const System& system_;
  const Linearized& of_;
  Assembly listing_;
  std::vector<int> joints_;
  Statuses statuses_;
  VectorXd end_;            ///< End of the step, for the unknowns in seen_.
  std::vector<int> local_;  ///< Index of an unknown in seen_, or −1.
  std::vector<int> seen_;   ///< Unknowns on which the joints depend.
  std::map<std::pair<int, JointStatus>, Rows> rows_;
  std::unordered_map<int, Index> place_;  ///< Condensed index of a row of the equations.
  std::vector<int> rows_condensed_;
  std::vector<Row> now_;  ///< Each condensed row on its present status; empty: that of the base.
  std::vector<VectorXd> responses_;  ///< Response of seen_ to a unit in each condensed row.
  MatrixXd matrix_;
  MatrixXd inverse_;
  VectorXd values_;
  VectorXd condensed_;
};

}  // namespace

std::optional<SchurActiveSet> schur_active_set(const System& system, const Linearized& of,
                                               const std::vector<int>& joints) {
  return Condensed(system, of, joints).find();
}

}  // namespace statejump::truss::detail
