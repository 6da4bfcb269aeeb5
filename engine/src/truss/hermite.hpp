// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <optional>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss::detail {

/// Cubic Hermite interpolation over a step, from the values and rates at its ends. The argument is
/// the fraction of the step. The error is of fourth order in the step length.
struct Cubic {
  double first;
  double last;
  double first_rate;  ///< Per step.
  double last_rate;   ///< Per step.

  double at(double share) const {
    const double passed = last - first;
    const double left = 1.0 - share;
    return first + share * passed +
           share * left * (left * (first_rate - passed) - share * (last_rate - passed));
  }
  /// The rate at a fraction s is first_rate + linear · s + square · s².
  double linear() const { return 6.0 * (last - first) - 4.0 * first_rate - 2.0 * last_rate; }
  double square() const { return 3.0 * (first_rate + last_rate) - 6.0 * (last - first); }
  double rate(double share) const { return first_rate + share * (linear() + share * square()); }
  /// Fraction of the step at which the rate is smallest. It is empty if the minimum is at the start
  /// or the end.
  std::optional<double> slowest() const {
    if (!(square() > 0.0)) return std::nullopt;
    const double share = -0.5 * linear() / square();
    return share > 0.0 && share < 1.0 ? std::optional(share) : std::nullopt;
  }
  /// First fraction in (0, end] at which the rate becomes 0. The rate must be positive at 0 and <=
  /// 0 at `end`.
  double turn(double end) const {
    double before = 0.0;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (before + end);
      (rate(middle) > 0.0 ? before : end) = middle;
    }
    return end;
  }
};

/// State of a joint within a step: displacements and forces follow cubics, all other values are
/// those at the end of the step.
struct JointWay {
  Trial first;
  Trial last;
  Trial first_rate;  ///< The joint evaluated with rates in place of displacements and forces.
  Trial last_rate;
  double duration;

  Trial at(double share) const {
    Trial on = last;
    for (std::size_t k = 0; k < most_joint_nodes; ++k) {
      for (Eigen::Index x = 0; x < 3; ++x) {
        on.moved[k][x] = Cubic{first.moved[k][x], last.moved[k][x],
                               duration * first_rate.moved[k][x], duration * last_rate.moved[k][x]}
                             .at(share);
      }
    }
    for (std::size_t k = 0; k < most_joint_forces; ++k) {
      on.force[k] = Cubic{first.force[k], last.force[k], duration * first_rate.force[k],
                          duration * last_rate.force[k]}
                        .at(share);
    }
    return on;
  }
};

}  // namespace statejump::truss::detail
