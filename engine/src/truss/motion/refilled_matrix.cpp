// SPDX-License-Identifier: GPL-3.0-or-later
#include "refilled_matrix.hpp"

#include <algorithm>

#include "entries.hpp"

namespace statejump::truss::detail {

void RefilledMatrix::end() {
  if (!moved_ && next_ == places_.size()) {
    std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
    for (std::size_t k = 0; k < next_; ++k) matrix_.valuePtr()[slots_[k]] += values_[k];
    return;
  }
  places_.resize(next_);
  values_.resize(next_);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(next_);
  for (std::size_t k = 0; k < next_; ++k) {
    entries.emplace_back(places_[k].first, places_[k].second, values_[k]);
  }
  matrix_.resize(size_, size_);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  matrix_.makeCompressed();
  slots_.resize(next_);
  for (std::size_t k = 0; k < next_; ++k) {
    slots_[k] = static_cast<int>(place(matrix_, places_[k].first, places_[k].second));
  }
}

}  // namespace statejump::truss::detail
