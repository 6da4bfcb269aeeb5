// SPDX-License-Identifier: GPL-3.0-or-later
#include "friction_element.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace statejump::truss::detail {

double FrictionElement::spring(double slide) const {
  const double free = elastic + stiffness * slide;
  if (status == Status::stick) return free;
  return sign() * std::min(sign() * free, bound);
}

double FrictionElement::force(double slide, double speed) const {
  return status == Status::stick ? elastic + stiffness * slide + damping * speed : sign() * bound;
}

double FrictionElement::margin(double slide, double speed, double h) const {
  if (status == Status::stick) {
    return bound - std::abs(elastic + stiffness * slide + damping * speed);
  }
  if (sign() * elastic >= bound) return sign() * speed * (damping + stiffness * h);
  return sign() * (spring(slide) + damping * speed) - bound;
}

double FrictionElement::margin_rate(double slide, double speed, double rise) const {
  const double free = elastic + stiffness * slide;
  if (status == Status::stick) {
    return -std::copysign(1.0, free + damping * speed) * (stiffness * speed + damping * rise);
  }
  if (sign() * free >= bound) return sign() * rise;
  return sign() * (stiffness * speed + damping * rise);
}

void FrictionElement::turn(double slide, double speed) {
  if (status != Status::stick) {
    status = Status::stick;
    return;
  }
  const bool forward = elastic + stiffness * slide + damping * speed > 0.0;
  status = forward ? Status::slip_plus : Status::slip_minus;
}

double FrictionElement::shortfall(double slide, double speed, double rise) const {
  if (status == Status::stick || sign() * elastic < bound) return margin(slide, speed, 0.0);
  const double forward = sign() * speed;
  return damping * forward + 0.5 * stiffness * forward * std::abs(speed / rise);
}

void SlipTrajectory::add(double time, double slide, double speed) {
  // Newton's divided differences. Points occur twice, with value and rate; only the last diagonal
  // is stored.
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

double SlipTrajectory::slide_at(double time) const {
  double sum = 0.0;
  for (std::size_t k = factor_.size(); k-- > 0;) sum = sum * (time - time_[k]) + factor_[k];
  return sum;
}

double SlipTrajectory::speed_at(double time) const {
  double sum = 0.0;
  double rate = 0.0;
  for (std::size_t k = factor_.size(); k-- > 0;) {
    rate = rate * (time - time_[k]) + sum;
    sum = sum * (time - time_[k]) + factor_[k];
  }
  return rate;
}

std::optional<double> end_of_status(const FrictionElement& element, const SlipTrajectory& way,
                                    double h, double level) {
  const auto margin = [&](double time) {
    return element.margin(way.slide_at(time), way.speed_at(time), h);
  };
  // Number of points checked for reversals. Between them, the reversal of a smooth trajectory is
  // smaller than the error of a step.
  constexpr int places = 32;
  double before = 0.0;
  for (int k = 1; k <= places; ++k) {
    double after = h * static_cast<double>(k) / places;
    if (margin(after) >= level - FrictionElement::allowance * element.bound) {
      before = after;
      continue;
    }
    // Bisection to rounding of the step.
    for (int halving = 0; halving < 48; ++halving) {
      const double middle = 0.5 * (before + after);
      (margin(middle) > level ? before : after) = middle;
    }
    return before;
  }
  return {};
}

std::optional<std::vector<FrictionElement>> friction_elements(const System& system,
                                                              const Contacts& contacts) {
  std::vector<FrictionElement> found;
  if (contacts.have_springs()) return {};
  for (const Contact& contact : contacts.all()) {
    const Joint& joint = system.model().joints[index(contact.joint)];
    // The direction of a latch hinge rotates with its links.
    const bool straight =
        std::holds_alternative<Slider>(joint) || std::holds_alternative<IwanJoint>(joint);
    const bool springs =
        contact.normal_column < 0 && contact.tangential_stiffness < Contact::infinite;
    if (!straight || !springs || !(contact.given_force > 0.0)) return {};
    FrictionElement one;
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
