// SPDX-License-Identifier: GPL-3.0-or-later
// Steps whose contacts keep or soon find their branches: the laws of all contacts are then
// equations, which stand beside those of the bodies in one sparse matrix.
#include <algorithm>
#include <cmath>
#include <set>

#include "stepper.hpp"

namespace statejump::truss::detail {

namespace {

/// Factors kept, of other branches or lengths of steps.
constexpr std::size_t most_kept = 8;

}  // namespace

Stepper::Branch Stepper::branch(const Contact& contact) const {
  if (!contact.active) return Branch::open;
  if (contact.slips_in_part && contact.beside) return Branch::stick;
  const double normal = contact.normal_column < 0 ? contact.given_force : contact.normal_force;
  if (!(normal > 0.0)) return Branch::open;
  if (contact.slips_in_part || contact.sticks(normal, contact.friction_force)) {
    return Branch::stick;
  }
  return contact.friction_force >= 0.0 ? Branch::slip_plus : Branch::slip_minus;
}

void Stepper::note_branches() {
  branches_.clear();
  for (const Contact& contact : contacts_.all()) branches_.push_back(branch(contact));
}

bool Stepper::on_branches(Trial& step, Local& local) {
  std::vector<Branch> branches;
  std::vector<int> active;
  for (std::size_t place = 0; place < branches_.size(); ++place) {
    const Contact& contact = contacts_.all()[place];
    if (!contact.active) continue;
    // A rigid contact that is active has closed.
    const bool closes = branches_[place] == Branch::open && contact.is_rigid();
    branches.push_back(closes ? Branch::stick : branches_[place]);
    active.push_back(static_cast<int>(place));
  }
  active_ = std::move(active);
  // Block pivoting with single pivots as a safeguard (Judice and Pires 1994): all contacts that ask
  // for another branch change, with what follows from it near by, unless that has been tried; then
  // only the first of them does, until fewer ask than ever before. Most changes are of one contact,
  // found at the second try.
  std::set<std::vector<Branch>> tried{branches};
  std::size_t fewest = branches.size() + 1;
  bool one_by_one = false;
  Guess guess{std::move(branches), false};
  for (;;) {
    if (!solve_on(guess.branches, step, local, guess.is_near)) return false;
    branches = std::move(guess.branches);
    std::vector<Branch> next = branches;
    std::vector<std::size_t> wrong;
    for (std::size_t i = 0; i < branches.size(); ++i) {
      next[i] = asked(step, local, static_cast<Eigen::Index>(i), branches[i]);
      if (next[i] != branches[i]) wrong.push_back(i);
    }
    if (wrong.empty()) return true;
    if (wrong.size() < fewest) {
      fewest = wrong.size();
      one_by_one = false;
      tried = {branches};
    }
    if (!one_by_one) {
      const VectorXd impulses = local.impulses;
      guess = pivot_locally(branches, next, wrong, step, local);
      if (!guess.is_near) local.impulses = impulses;
      if (guess.is_near && tried.count(guess.branches) > 0) guess = {next, false};
      one_by_one = tried.count(guess.branches) > 0;
      if (one_by_one) tried = {branches};
    }
    if (one_by_one) {
      // The contact problem takes no more systems than that.
      if (tried.size() > branches.size()) return false;
      guess = {branches, false};
      guess.branches[wrong.front()] = next[wrong.front()];
    }
    if (!tried.insert(guess.branches).second) return false;
  }
}

Stepper::OnBranches& Stepper::factors_for(double h, const std::vector<Branch>& branches) {
  // Steps of one length differ by the rounding of times.
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const auto& one) {
    return std::abs(one->h - h) <= 1e-6 * h && one->branches == branches && one->active == active_;
  });
  if (found != kept_.end()) {
    std::rotate(kept_.begin(), found, found + 1);
    return *kept_.front();
  }
  // The pattern goes with the contacts that are active, not with their branches: the oldest factors
  // of the same pattern need no new order.
  const auto same = std::find_if(kept_.rbegin(), kept_.rend(),
                                 [&](const auto& one) { return one->active == active_; });
  if (kept_.size() < most_kept || same == kept_.rend()) {
    if (kept_.size() == most_kept) kept_.pop_back();
    kept_.insert(kept_.begin(), std::make_unique<OnBranches>());
  } else {
    std::rotate(kept_.begin(), same.base() - 1, same.base());
  }
  OnBranches& made = *kept_.front();
  made.h = h;
  made.active = active_;
  made.branches = branches;
  made.outdated = true;
  return made;
}

bool Stepper::factorize(OnBranches& on, const Trial& step, const Local& local) {
  assemble(on.branches, step, local);
  on.scale = hold_scale_;
  ++factorizations_;
  return on.factor.factorize(matrix_.matrix());
}

/// Rows: balance, what holds, then two of each active contact. A contact's impulses are unknowns on
/// every branch, so that the pattern is the same on all of them.
void Stepper::assemble(const std::vector<Branch>& branches, const Trial& step, const Local& local) {
  const bool is_new = matrix_of_ != step.number;
  if (is_new) {
    matrix_.begin(q_.size() + held_count() + local.impulses.size());
    fill_bodies(step, matrix_);
    matrix_scale_ = hold_scale_;
    contact_entry_.resize(branches.size());
  } else if (hold_scale_ != matrix_scale_) {
    hold_directions(step, matrix_scale_);
  }
  for (std::size_t k = 0; k < branches.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (is_new) {
      contact_entry_[k] = matrix_.next();
      tell_contact(branches[k], step, local, i,
                   [&](auto row, auto column, double value) { matrix_.add(row, column, value); });
    } else {
      retell(branches[k], step, local, i);
    }
  }
  if (is_new) matrix_.end();
  matrix_of_ = step.number;
}

void Stepper::retell(Branch branch, const Trial& step, const Local& local, Eigen::Index i) {
  std::size_t entry = contact_entry_[static_cast<std::size_t>(i)];
  tell_contact(branch, step, local, i,
               [&](auto, auto, double value) { matrix_.set(entry++, value); });
}

template <class Tell>
void Stepper::tell_contact(Branch now, const Trial& step, const Local& local, Eigen::Index i,
                           Tell&& tell) const {
  const Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
  const double scale = hold_scale_;
  const Eigen::Index n = q_.size() + holds_.cols() + 2 * i;
  const Eigen::Index t = n + 1;
  // A row that is not asked says that its impulse is what it is. @param beside the other tangent
  const auto row = [&](Eigen::Index at, bool asked, const Law& law, Eigen::Index beside) {
    using Column = Eigen::SparseMatrix<double>::InnerIterator;
    Column other(local.directions, 2 * std::max<Eigen::Index>(beside, 0) + 1);
    for (Column it(local.directions, 2 * i + at - n); it; ++it) {
      double speed = law.by_speed * it.value();
      // Both are sums of the same columns.
      if (beside >= 0) {
        speed += law.by_beside * other.value();
        ++other;
      }
      tell(at, it.row(), asked ? scale * speed : 0.0);
      tell(it.row(), at, -scale * it.value());
    }
    tell(at, at, asked ? scale * scale * law.compliance : scale);
  };
  const bool touches = now != Branch::open && contact.normal_column >= 0;
  const bool sticks = now == Branch::stick && contact.tangential_column >= 0;
  row(n, touches, touches ? normal_law(step, local, i) : Law{}, -1);
  const Law along = sticks ? stick_law(step, local, i) : Law{};
  row(t, sticks, along, partner(local, i));
  const double pressed = scale * scale * along.by_normal;
  if (contact.slips_in_part && contact.beside) tell(t, n - 2, pressed);
  tell(t, n, touches && !sticks ? -scale * slide(contact, now) : contact.beside ? 0.0 : pressed);
}

double Stepper::slide(const Contact& contact, Branch branch) {
  // Friction on the body is against the slide.
  return branch == Branch::slip_plus    ? -contact.friction_coefficient
         : branch == Branch::slip_minus ? contact.friction_coefficient
                                        : 0.0;
}

Stepper::Branch Stepper::asked(const Trial& step, const Local& local, Eigen::Index i,
                               Branch branch) const {
  const double h = step.h;
  const Contact& contact = *local.contacts[static_cast<std::size_t>(i)];
  const double normal = local.impulses[2 * i];
  const double tangential = local.impulses[2 * i + 1];
  const double bound = contact.friction_coefficient * normal;
  if (contact.slips_in_part && contact.beside) return branch;
  if (branch == Branch::open) {
    if (contact.normal_column < 0) return branch;
    const double speed = local.directions.col(2 * i).dot(step.v);
    const bool closes = contact.is_elastic() ? tangent(step, local, i, speed).force > 0.0
                                             : depth(step, local, i, speed) > 0.0;
    return closes ? Branch::stick : branch;
  }
  if (!(normal > 0.0)) return Branch::open;
  if (contact.slips_in_part) return Branch::stick;  // one law, from nothing to all that slips
  if (contact.tangential_column < 0 || bound == 0.0) {
    return branch == Branch::stick ? Branch::slip_plus : branch;  // slides freely either way
  }
  if (branch == Branch::stick) {
    if (std::abs(tangential) <= bound * (1.0 + allowance)) return branch;
    return tangential < 0.0 ? Branch::slip_plus : Branch::slip_minus;
  }
  const Contact::Along friction = contact.along(elastic_normal(step, local, i), h);
  const double slide = local.directions.col(2 * i + 1).dot(step.v) +
                       (friction.compliance * tangential / h + friction.bend) / h;
  return tangential * slide <= 0.0 ? branch : Branch::stick;
}

}  // namespace statejump::truss::detail
