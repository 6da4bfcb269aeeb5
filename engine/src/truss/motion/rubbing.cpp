// SPDX-License-Identifier: GPL-3.0-or-later
#include "rubbing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace statejump::truss::detail {

double Rubbing::spring(double slide) const {
  const double free = elastic + stiffness * slide;
  if (branch == Branch::stick) return free;
  return sign() * std::min(sign() * free, bound);
}

double Rubbing::force(double slide, double speed) const {
  return branch == Branch::stick ? elastic + stiffness * slide + damping * speed : sign() * bound;
}

double Rubbing::margin(double slide, double speed, double h) const {
  if (branch == Branch::stick) {
    return bound - std::abs(elastic + stiffness * slide + damping * speed);
  }
  if (sign() * elastic >= bound) return sign() * speed * (damping + stiffness * h);
  return sign() * (spring(slide) + damping * speed) - bound;
}

double Rubbing::margin_rate(double slide, double speed, double rise) const {
  const double free = elastic + stiffness * slide;
  if (branch == Branch::stick) {
    return -std::copysign(1.0, free + damping * speed) * (stiffness * speed + damping * rise);
  }
  if (sign() * free >= bound) return sign() * rise;
  return sign() * (stiffness * speed + damping * rise);
}

void Rubbing::turn(double slide, double speed) {
  if (branch != Branch::stick) {
    branch = Branch::stick;
    return;
  }
  const bool forward = elastic + stiffness * slide + damping * speed > 0.0;
  branch = forward ? Branch::slip_plus : Branch::slip_minus;
}

double Rubbing::shortfall(double slide, double speed, double rise) const {
  if (branch == Branch::stick || sign() * elastic < bound) return margin(slide, speed, 0.0);
  const double forward = sign() * speed;
  return damping * forward + 0.5 * stiffness * forward * std::abs(speed / rise);
}

void RubbingWay::add(double time, double slide, double speed) {
  // Newton's divided differences, the new place twice: their last diagonal is all that is needed.
  for (const bool again : {false, true}) {
    const std::size_t k = time_.size();
    time_.push_back(time);
    double now = slide;
    std::vector<double> diagonal{now};
    for (std::size_t order = 1; order <= k; ++order) {
      now = again && order == 1 ? speed : (now - last_[order - 1]) / (time - time_[k - order]);
      diagonal.push_back(now);
    }
    factor_.push_back(now);
    last_ = std::move(diagonal);
  }
}

double RubbingWay::slide_at(double time) const {
  double sum = 0.0;
  for (std::size_t k = factor_.size(); k-- > 0;) sum = sum * (time - time_[k]) + factor_[k];
  return sum;
}

double RubbingWay::speed_at(double time) const {
  double sum = 0.0;
  double rate = 0.0;
  for (std::size_t k = factor_.size(); k-- > 0;) {
    rate = rate * (time - time_[k]) + sum;
    sum = sum * (time - time_[k]) + factor_[k];
  }
  return rate;
}

std::optional<double> end_of_branch(const Rubbing& rubbing, const RubbingWay& way, double h,
                                    double level) {
  const auto margin = [&](double time) {
    return rubbing.margin(way.slide_at(time), way.speed_at(time), h);
  };
  // Between so many places a smooth way does not turn back unseen by more than the error of a step.
  constexpr int places = 32;
  double before = 0.0;
  for (int k = 1; k <= places; ++k) {
    double after = h * static_cast<double>(k) / places;
    if (margin(after) >= level - Rubbing::allowance * rubbing.bound) {
      before = after;
      continue;
    }
    // To rounding of the step.
    for (int halving = 0; halving < 48; ++halving) {
      const double middle = 0.5 * (before + after);
      (margin(middle) > level ? before : after) = middle;
    }
    return before;
  }
  return {};
}

std::optional<std::vector<Rubbing>> rubbings(const System& system, const Contacts& contacts) {
  std::vector<Rubbing> found;
  if (contacts.have_springs()) return {};
  for (const Contact& contact : contacts.all()) {
    const Joint& joint = system.model().joints[index(contact.joint)];
    // The direction of a latch hinge turns with its links.
    const bool straight =
        std::holds_alternative<Slider>(joint) || std::holds_alternative<IwanJoint>(joint);
    const bool springs =
        contact.normal_column < 0 && contact.tangential_stiffness < Contact::infinite;
    if (!straight || !springs || !(contact.given_force > 0.0)) return {};
    Rubbing one;
    one.joint = contact.joint;
    one.column = contact.tangential_column;
    one.bound = contact.friction_coefficient * contact.given_force;
    one.stiffness = contact.tangential_stiffness;
    one.damping = contact.damping * std::sqrt(one.stiffness);
    found.push_back(one);
  }
  return found;
}

}  // namespace statejump::truss::detail
