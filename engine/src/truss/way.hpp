// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace statejump::truss::detail {

/// Interpolation of the unknowns in a step: linear, or cubic if the rates at both ends are known.
struct Way {
  const Eigen::VectorXd& from;
  double from_time;
  const Eigen::VectorXd& to;
  double to_time;
  const Eigen::VectorXd* from_rate = nullptr;  ///< Null or empty: unknown.
  const Eigen::VectorXd* to_rate = nullptr;

  bool is_straight() const {
    return from_rate == nullptr || to_rate == nullptr || from_rate->size() == 0 ||
           to_rate->size() == 0;
  }
  double step() const { return to_time - from_time; }
};

}  // namespace statejump::truss::detail
