// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

namespace statejump::truss::detail {

/// A derivative and the estimate of its error.
struct Difference {
  Eigen::VectorXd value;
  double error = std::numeric_limits<double>::infinity();
};

/// Derivative at 0 of a smooth vector function of one variable, by central differences extrapolated
/// to step 0 (C. J. F. Ridders, Adv. Eng. Softw. 4 (1982) 75-76). The step is halved until the
/// error estimate no longer decreases. A linear function takes two pairs of evaluations.
/// @param step the first step, within which the function is smooth
template <class Function>
Difference difference(Function&& function, double step) {
  constexpr std::size_t levels = 12;
  constexpr double exact = 1e-14;
  std::array<Eigen::VectorXd, levels> last, now;
  Difference best;
  const auto size = [](const Eigen::VectorXd& of) {
    return of.size() == 0 ? 0.0 : of.lpNorm<Eigen::Infinity>();
  };
  for (std::size_t i = 0; i < levels; ++i, step *= 0.5) {
    now[0] = (function(step) - function(-step)) / (2.0 * step);
    if (i == 0) best.value = now[0];
    double factor = 1.0;
    for (std::size_t k = 1; k <= i; ++k) {
      factor *= 4.0;
      now[k] = (factor * now[k - 1] - last[k - 1]) / (factor - 1.0);
      const double error = std::max(size(now[k] - now[k - 1]), size(now[k] - last[k - 1]));
      if (error < best.error) best = {now[k], error};
    }
    if (i > 0 && best.error <= exact * size(best.value)) break;
    if (i > 2 && size(now[i] - last[i - 1]) > 4.0 * best.error) break;
    std::swap(now, last);
  }
  return best;
}

/// The most accurate of the derivatives with different first steps.
template <class Function>
Eigen::VectorXd derivative(Function&& function, std::initializer_list<double> steps) {
  Difference best;
  for (const double step : steps) {
    if (!(step > 0.0)) continue;
    Difference found = difference(function, step);
    if (best.value.size() == 0 || found.error < best.error) best = std::move(found);
    if (best.error == 0.0) break;
  }
  return best.value;
}

}  // namespace statejump::truss::detail
