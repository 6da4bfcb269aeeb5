// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/joints/moment_curve.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

namespace statejump::truss {

namespace {

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double one) { return std::isfinite(one); });
}

}  // namespace

MomentCurve::MomentCurve(std::vector<double> angle, std::vector<double> moment,
                         std::vector<double> slope)
    : angle_(std::move(angle)), moment_(std::move(moment)), slope_(std::move(slope)) {
  if (angle_.size() < 2 || moment_.size() != angle_.size() || slope_.size() != angle_.size()) {
    throw std::invalid_argument("a moment curve has two or more points");
  }
  if (!all_finite(angle_) || !all_finite(moment_) || !all_finite(slope_) ||
      !std::is_sorted(angle_.begin(), angle_.end(), std::less_equal<>())) {
    throw std::invalid_argument(
        "the angles of a moment curve increase, and its numbers are finite");
  }
  energy_.assign(angle_.size(), 0.0);
  for (std::size_t k = 0; k + 1 < angle_.size(); ++k) {
    const double width = angle_[k + 1] - angle_[k];
    energy_[k + 1] = energy_[k] + 0.5 * width * (moment_[k] + moment_[k + 1]) +
                     width * width / 12.0 * (slope_[k] - slope_[k + 1]);
  }
  at_zero_ = from_first(0.0).energy;
}

MomentCurve::At MomentCurve::at(double rotation) const {
  At found = from_first(rotation);
  found.energy -= at_zero_;
  return found;
}

MomentCurve::At MomentCurve::from_first(double rotation) const {
  if (rotation <= angle_.front() || rotation >= angle_.back()) {
    const std::size_t end = rotation <= angle_.front() ? 0 : angle_.size() - 1;
    const double beyond = rotation - angle_[end];
    return {moment_[end] + slope_[end] * beyond, slope_[end],
            energy_[end] + beyond * (moment_[end] + 0.5 * slope_[end] * beyond)};
  }
  const auto k = static_cast<std::size_t>(std::upper_bound(angle_.begin(), angle_.end(), rotation) -
                                          angle_.begin() - 1);
  const double width = angle_[k + 1] - angle_[k];
  const double x = rotation - angle_[k];
  // moment = moment_k + slope_k x + square x² + cube x³
  const double secant = (moment_[k + 1] - moment_[k]) / width;
  const double square = (3.0 * secant - 2.0 * slope_[k] - slope_[k + 1]) / width;
  const double cube = (slope_[k] + slope_[k + 1] - 2.0 * secant) / (width * width);
  return {
      moment_[k] + x * (slope_[k] + x * (square + x * cube)),
      slope_[k] + x * (2.0 * square + 3.0 * cube * x),
      energy_[k] + x * (moment_[k] + x * (slope_[k] / 2.0 + x * (square / 3.0 + x * cube / 4.0)))};
}

}  // namespace statejump::truss
