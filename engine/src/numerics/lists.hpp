// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace statejump::numerics {

/// Lists of numbers in one contiguous array.
class Lists {
 public:
  Lists() = default;
  /// @param begins index of the first number of each list, followed by the end of the last list
  Lists(std::vector<std::size_t> begins, std::vector<int> numbers)
      : numbers_(std::move(numbers)), begin_(std::move(begins)) {}

  void end_list() { begin_.push_back(numbers_.size()); }
  void push_back(int number) { numbers_.push_back(number); }
  std::size_t size() const { return begin_.size() - 1; }
  const int* begin(std::size_t list) const { return numbers_.data() + begin_[list]; }
  const int* end(std::size_t list) const { return numbers_.data() + begin_[list + 1]; }
  std::size_t numbers() const { return numbers_.size(); }

  /// For every number below `count`, the lists that contain it.
  Lists inverted(std::size_t count) const {
    std::vector<std::size_t> begins(count + 1, 0);
    for (const int number : numbers_) ++begins[static_cast<std::size_t>(number) + 1];
    std::partial_sum(begins.begin(), begins.end(), begins.begin());
    std::vector<int> lists(numbers_.size());
    std::vector<std::size_t> next(begins.begin(), begins.end() - 1);
    // NOLINTNEXTLINE(build/include_what_you_use): a number
    for (std::size_t list = 0; list < size(); ++list) {
      for (const int* number = begin(list); number != end(list); ++number) {
        lists[next[static_cast<std::size_t>(*number)]++] = static_cast<int>(list);
      }
    }
    return {std::move(begins), std::move(lists)};
  }

 private:
  std::vector<int> numbers_;
  std::vector<std::size_t> begin_{0};
};

/// Items in breadth-first order. When no more items can be reached, the search restarts at the
/// first item not yet visited.
/// @param groups_of list of groups for every item
/// @param items_of list of items for every group
inline std::vector<int> breadth_first(const Lists& groups_of, const Lists& items_of) {
  std::vector<int> order;
  order.reserve(groups_of.size());
  std::vector<bool> met(groups_of.size(), false), met_group(items_of.size(), false);
  for (std::size_t first = 0; first < groups_of.size(); ++first) {
    if (met[first]) continue;
    met[first] = true;
    order.push_back(static_cast<int>(first));
    for (std::size_t next = order.size() - 1; next < order.size(); ++next) {
      const auto item = static_cast<std::size_t>(order[next]);
      for (const int* its = groups_of.begin(item); its != groups_of.end(item); ++its) {
        const auto group = static_cast<std::size_t>(*its);
        if (met_group[group]) continue;
        met_group[group] = true;
        for (const int* other = items_of.begin(group); other != items_of.end(group); ++other) {
          if (met[static_cast<std::size_t>(*other)]) continue;
          met[static_cast<std::size_t>(*other)] = true;
          order.push_back(*other);
        }
      }
    }
  }
  return order;
}

}  // namespace statejump::numerics
