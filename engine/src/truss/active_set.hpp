// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>
#include <vector>

namespace statejump::truss::detail {

/// A change of all violated contacts (block), or of the violated contact with the lowest number
/// (single).
enum class Pivot : unsigned char { block, single };

/// When find_active_set() stops changing all violated contacts at once.
enum class Blocks : unsigned char {
  while_fewer,     ///< At the first block that brings no new minimum of violations.
  until_repeated,  ///< At the first block that repeats earlier statuses: needs the fewest solves.
  /// As until_repeated, but a new minimum of violations does not erase the record of statuses.
  until_ever_repeated,
};

/// Chooses the next pivot of a search and detects cycles, for find_active_set().
/// @tparam Key identifies the statuses of a solve
template <class Key>
class PivotSearch {
 public:
  static constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

  /// @param most_single limit on consecutive single pivots
  explicit PivotSearch(Blocks blocks, std::size_t most_single = unlimited)
      : blocks_(blocks), most_single_(most_single) {}

  Pivot pivot() const { return pivot_; }
  bool was_tried(const Key& key) const { return tried_.count(key) > 0; }
  /// Number of pivots since the last new minimum of violations.
  int idle() const { return idle_; }
  /// Accepts the next statuses even if they were tried before, and does not record them.
  void admit_tried() { admits_tried_ = true; }

  /// Replaces the statuses on which inequalities are violated.
  /// @param solved key of these statuses
  /// @param violated number of these inequalities
  /// @param propose `std::optional<Key> propose()` changes the statuses by pivot(); nothing if
  /// the equations are singular
  /// @returns false if no statuses are left to be tried
  template <class Propose>
  bool advance(const Key& solved, std::size_t violated, Propose&& propose) {
    choose(solved, violated);
    if (pivot_ == Pivot::block) {
      const std::optional<Key> next = propose();
      if (!next) return false;
      if (std::exchange(admits_tried_, false) || tried_.insert(*next).second) return true;
      pivot_ = Pivot::single;
      tried_ = {solved};
    }
    if (tried_.size() > most_single_) return false;
    const std::optional<Key> next = propose();
    return next && tried_.insert(*next).second;
  }

 private:
  void choose(const Key& solved, std::size_t violated) {
    ++idle_;
    if (violated < fewest_) {
      // With until_ever_repeated the record of statuses tried by block pivots is kept.
      const bool keeps = blocks_ == Blocks::until_ever_repeated && pivot_ == Pivot::block;
      if (!keeps) tried_.clear();
      const bool begins = fewest_ == unlimited;
      if (blocks_ == Blocks::until_repeated || (keeps && begins)) tried_.insert(solved);
      fewest_ = violated;
      idle_ = 0;
      pivot_ = Pivot::block;
    } else if (blocks_ == Blocks::while_fewer) {
      pivot_ = Pivot::single;
    }
  }

  Blocks blocks_;
  std::size_t most_single_;
  std::size_t fewest_ = unlimited;
  std::set<Key> tried_;
  Pivot pivot_ = Pivot::block;
  int idle_ = 0;
  bool admits_tried_ = false;
};

/// Finds statuses on which all inequalities hold, by block principal pivoting [1].
///
/// All violated contacts change their status at once (block) until the rule `Blocks` ends this
/// phase. Then only the violated contact with the lowest number changes [2], until the number of
/// violations falls below its previous minimum. For a P-matrix the search ends after finitely many
/// pivots. If friction depends on an unknown normal force, the matrix need not be a P-matrix.
/// Statuses can then recur, and the search ends without a result.
///
/// The caller owns the linear system, and has solved it on its statuses when the search begins:
///
///   Key key() const                       statuses of the next solve, or of the last one
///   std::vector<Change> violated()        changes that inequalities request, the lowest first
///   bool change(changes, search)          changes statuses of the last solve by search.pivot();
///                                         false: is singular
///   bool solve()                          solves on the present statuses; false: gives up
///
/// The search ends if statuses recur that `search.was_tried()` reports.
///
/// @param most_single limit on consecutive single pivots
/// @returns whether statuses were found; otherwise the system keeps its last statuses
///
/// [1] J. J. Júdice, F. M. Pires, Comput. Oper. Res. 21 (1994) 587-596.
/// [2] K. G. Murty, Linear Algebra Appl. 9 (1974) 65-108.
template <class System>
bool find_active_set(System& system, Blocks blocks = Blocks::while_fewer,
                     std::size_t most_single = std::numeric_limits<std::size_t>::max()) {
  using Key = std::decay_t<decltype(system.key())>;
  PivotSearch<Key> search(blocks, most_single);
  for (;;) {
    auto changes = system.violated();
    if (changes.empty()) return true;
    const Key solved = system.key();
    const bool advances = search.advance(solved, changes.size(), [&]() -> std::optional<Key> {
      if (search.pivot() == Pivot::single) changes.resize(1);
      if (!system.change(changes, search)) return std::nullopt;
      return system.key();
    });
    if (!advances || !system.solve()) return false;
  }
}

}  // namespace statejump::truss::detail
