// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>
#include <cstddef>
#include <utility>
#include <vector>

namespace statejump::truss::detail {

/// A square sparse matrix that is filled repeatedly in the same order. The position of every entry
/// is determined only once. Values at the same position are added.
class RefilledMatrix {
 public:
  void begin(Eigen::Index size) {
    moved_ = size != matrix_.rows();
    size_ = size;
    next_ = 0;
  }
  void add(Eigen::Index row, Eigen::Index column, double value) {
    const Place place{static_cast<int>(row), static_cast<int>(column)};
    if (next_ == places_.size()) {
      places_.push_back(place);
      values_.push_back(value);
      moved_ = true;
    } else {
      moved_ = moved_ || places_[next_] != place;
      places_[next_] = place;
      values_[next_] = value;
    }
    ++next_;
  }
  /// Number of the next entry.
  std::size_t next() const { return next_; }
  /// Updates the positions if the entries differ from the last filling.
  void end();

  /// Replaces the value of an entry. No other entry may be added at the same position.
  void set(std::size_t entry, double value) { matrix_.valuePtr()[slots_[entry]] = value; }

  const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }

 private:
  using Place = std::pair<int, int>;  // row, column

  std::vector<Place> places_;
  std::vector<double> values_;
  std::vector<int> slots_;
  std::size_t next_ = 0;
  Eigen::Index size_ = 0;
  bool moved_ = true;
  Eigen::SparseMatrix<double> matrix_;
};

}  // namespace statejump::truss::detail
