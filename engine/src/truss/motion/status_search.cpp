// SPDX-License-Identifier: GPL-3.0-or-later
#include "status_search.hpp"

#include <set>
#include <utility>

#include "neighbourhood_pivots.hpp"

namespace statejump::truss::detail {

namespace {

/// Statuses of the active contacts in the last step.
ContactStatuses first_statuses(const StepContacts& contacts, const MotionState& state) {
  ContactStatuses found;
  for (Eigen::Index i = 0; i < contacts.count(); ++i) {
    const auto number = static_cast<std::size_t>(contacts.numbers[static_cast<std::size_t>(i)]);
    const ContactStatus last = state.contacts[number];
    // A rigid contact that is active has closed.
    const bool closes = last == ContactStatus::open && contacts.contact(i).is_rigid();
    found.push_back(closes ? ContactStatus::stick : last);
  }
  return found;
}

}  // namespace

bool StatusSearch::find(TimeStep& step, StepContacts& contacts) {
  ContactStatuses statuses = first_statuses(contacts, forces_.state());
  std::set<ContactStatuses> tried{statuses};
  std::size_t fewest = statuses.size() + 1;
  bool one_by_one = false;
  Guess guess{std::move(statuses), false};
  for (;;) {
    if (!solver_.solve(guess.statuses, step, contacts, guess.is_near)) return false;
    statuses = std::move(guess.statuses);
    ContactStatuses next = statuses;
    std::vector<std::size_t> violated;
    for (std::size_t i = 0; i < statuses.size(); ++i) {
      next[i] = contacts.requested(step, static_cast<Eigen::Index>(i), statuses[i]);
      if (next[i] != statuses[i]) violated.push_back(i);
    }
    if (violated.empty()) return true;
    if (violated.size() < fewest) {
      fewest = violated.size();
      one_by_one = false;
      tried = {statuses};
    }
    if (!one_by_one) {
      const VectorXd impulses = contacts.impulses;
      guess = pivot_locally(statuses, next, violated, step, contacts);
      if (!guess.is_near) contacts.impulses = impulses;
      if (guess.is_near && tried.count(guess.statuses) > 0) guess = {next, false};
      one_by_one = tried.count(guess.statuses) > 0;
      if (one_by_one) tried = {statuses};
    }
    if (one_by_one) {
      // The contact problem takes no more systems than that.
      if (tried.size() > statuses.size()) return false;
      guess = {statuses, false};
      guess.statuses[violated.front()] = next[violated.front()];
    }
    if (!tried.insert(guess.statuses).second) return false;
  }
}

StatusSearch::Guess StatusSearch::pivot_locally(const ContactStatuses& statuses,
                                                const ContactStatuses& next,
                                                const std::vector<std::size_t>& violated,
                                                TimeStep& step, StepContacts& contacts) {
  matrix_.assemble(statuses, step, contacts);
  ContactStatuses found = statuses;
  NeighbourhoodPivots pivots(forces_, matrix_, step, contacts, found);
  if (pivots.reach_of(violated) > matrix_.matrix().cols()) return {next, false};
  // A settled contact may be violated again when others are settled.
  for (std::vector<std::size_t> left = violated; !left.empty();
       left = pivots.reached_violations()) {
    for (const std::size_t contact : left) {
      if (pivots.settle(contact)) continue;
      if (!pivots.is_spent()) return {next, false};
      for (const std::size_t one : violated) {
        if (found[one] == statuses[one]) found[one] = next[one];
      }
      return {found, true};
    }
  }
  return {found, true};
}

}  // namespace statejump::truss::detail
