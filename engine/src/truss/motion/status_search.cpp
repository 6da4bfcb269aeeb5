// SPDX-License-Identifier: GPL-3.0-or-later
#include "status_search.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "neighbourhood_pivots.hpp"

namespace statejump::truss::detail {

namespace {

/// Statuses of the active contacts in the last step.
ContactStatuses first_statuses(const StepContacts& contacts, const MotionState& state) {
  ContactStatuses found;
  for (Eigen::Index i = 0; i < contacts.count(); ++i) {
    const auto number = static_cast<std::size_t>(contacts.numbers[static_cast<std::size_t>(i)]);
    const ContactStatus last = state.contacts[number];
    // A rigid contact is active only if its gap has closed.
    const bool closes = last == ContactStatus::open && contacts.contact(i).is_rigid();
    found.push_back(closes ? ContactStatus::stick : last);
  }
  return found;
}

/// The equations of one step, for find_active_set().
class StepPivots {
 public:
  using Changes = std::vector<std::pair<std::size_t, ContactStatus>>;

  StepPivots(StepForces& forces, StepMatrix& matrix, StatusSolver& solver, TimeStep& step,
             StepContacts& contacts)
      : forces_(forces),
        matrix_(matrix),
        solver_(solver),
        step_(step),
        contacts_(contacts),
        next_{first_statuses(contacts, forces.state()), false} {}

  const ContactStatuses& key() const { return next_.statuses; }

  Changes violated() const {
    Changes found;
    for (std::size_t i = 0; i < solved_.size(); ++i) {
      const ContactStatus wanted =
          contacts_.requested(step_, static_cast<Eigen::Index>(i), solved_[i]);
      if (wanted != solved_[i]) found.emplace_back(i, wanted);
    }
    return found;
  }

  bool change(const Changes& changes, const PivotSearch<ContactStatuses>& search) {
    Guess changed{solved_, false};
    for (const auto& [contact, wanted] : changes) changed.statuses[contact] = wanted;
    next_ = std::move(changed);
    if (search.pivot() == Pivot::single) return true;
    const VectorXd impulses = contacts_.impulses;
    std::optional<ContactStatuses> found = pivot_locally(changes);
    if (!found) {
      contacts_.impulses = impulses;
    } else if (!search.was_tried(*found)) {
      next_ = {std::move(*found), true};
    }
    return true;
  }

  bool solve() {
    solved_ = next_.statuses;
    return solver_.solve(solved_, step_, contacts_, next_.is_near);
  }

 private:
  /// Statuses for the next solve, and whether the present iterate is near to the solution with
  /// these statuses.
  struct Guess {
    ContactStatuses statuses;
    bool is_near = false;
  };

  /// Changes statuses (pivots) in the neighbourhood of each violated contact. The iterate is then
  /// near the solution with the resulting statuses.
  std::optional<ContactStatuses> pivot_locally(const Changes& violated);

  StepForces& forces_;
  StepMatrix& matrix_;
  StatusSolver& solver_;
  TimeStep& step_;
  StepContacts& contacts_;
  ContactStatuses solved_;
  Guess next_;
};

std::optional<ContactStatuses> StepPivots::pivot_locally(const Changes& violated) {
  matrix_.assemble(solved_, step_, contacts_);
  ContactStatuses found = solved_;
  NeighbourhoodPivots pivots(forces_, matrix_, step_, contacts_, found);
  std::vector<std::size_t> left;
  for (const auto& one : violated) left.push_back(one.first);
  if (pivots.reach_of(left) > matrix_.matrix().cols()) return std::nullopt;
  // A settled contact may be violated again when others are settled.
  for (; !left.empty(); left = pivots.reached_violations()) {
    for (const std::size_t contact : left) {
      if (pivots.settle(contact)) continue;
      if (!pivots.is_spent()) return std::nullopt;
      for (const auto& [one, wanted] : violated) {
        if (found[one] == solved_[one]) found[one] = wanted;
      }
      return found;
    }
  }
  return found;
}

}  // namespace

bool StatusSearch::find(TimeStep& step, StepContacts& contacts) {
  StepPivots pivots(forces_, matrix_, solver_, step, contacts);
  // The contact problem needs as many solves as there are contacts.
  const auto most_single = static_cast<std::size_t>(contacts.count());
  return pivots.solve() && find_active_set(pivots, Blocks::until_repeated, most_single);
}

}  // namespace statejump::truss::detail
