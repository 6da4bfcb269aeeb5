// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <set>
#include <type_traits>
#include <utility>
#include <vector>

namespace statejump::truss::detail {

/// Finds statuses on which all inequalities hold, by block principal pivoting [1].
///
/// Every violated contact changes its status at once, as long as each such block leaves fewer
/// violations than there ever were; else only the one of the lowest number changes [2]. For a
/// P-matrix that ends after finitely many pivots. Friction that follows a normal force can make
/// another matrix, and statuses come back: then the search ends without a result.
///
/// The linear system is the caller's, solved on its statuses when the search begins:
///
///   Key key() const                       identifies its statuses
///   std::vector<Change> violated()        changes that inequalities request, the lowest first
///   bool change(changes, tried)           puts contacts on other statuses; false: it is singular
///   bool solve()                          solves on the present statuses; false: it gives up
///
/// @returns whether they were found; if not, the system is where the search ended
///
/// [1] J. J. Júdice, F. M. Pires, Comput. Oper. Res. 21 (1994) 587-596.
/// [2] K. G. Murty, Linear Algebra Appl. 9 (1974) 65-108.
template <class System>
bool find_active_set(System& system) {
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  std::set<std::decay_t<decltype(system.key())>> tried;
  for (;;) {
    auto violated = system.violated();
    if (violated.empty()) return true;
    if (violated.size() < fewest) {
      fewest = violated.size();
      tried.clear();
    } else {
      violated.resize(1);
    }
    if (!system.change(violated, std::as_const(tried))) return false;
    if (!tried.insert(system.key()).second) return false;
    if (!system.solve()) return false;
  }
}

}  // namespace statejump::truss::detail
