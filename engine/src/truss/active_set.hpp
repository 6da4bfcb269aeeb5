// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
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
///   bool change(changes, tried, pivot)    changes statuses of the last solve; false: is singular
///   bool solve()                          solves on the present statuses; false: gives up
///
/// `tried` holds the keys visited in this search. The search ends if a key recurs.
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
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  std::set<Key> tried;
  Pivot pivot = Pivot::block;
  for (;;) {
    auto violated = system.violated();
    if (violated.empty()) return true;
    const Key solved = system.key();
    if (violated.size() < fewest) {
      fewest = violated.size();
      pivot = Pivot::block;
      tried.clear();
      if (blocks == Blocks::until_repeated) tried.insert(solved);
    } else if (blocks == Blocks::while_fewer) {
      pivot = Pivot::single;
    }
    if (pivot == Pivot::block) {
      if (!system.change(violated, std::as_const(tried), pivot)) return false;
      if (tried.count(system.key()) > 0) {
        pivot = Pivot::single;
        tried = {solved};
      }
    }
    if (pivot == Pivot::single) {
      if (tried.size() > most_single) return false;
      violated.resize(1);
      if (!system.change(violated, std::as_const(tried), pivot)) return false;
    }
    if (!tried.insert(system.key()).second) return false;
    if (!system.solve()) return false;
  }
}

}  // namespace statejump::truss::detail
