// SPDX-License-Identifier: GPL-3.0-or-later
#include "drives.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>

#include "statejump/kernel/require.hpp"

namespace statejump::truss {

double Drive::speed_at(double t) const {
  if (t <= time[0]) return speed[0];
  const Eigen::Index last = time.size() - 1;
  if (t >= time[last]) return speed[last];
  const Eigen::Index i = std::upper_bound(time.begin(), time.end(), t) - time.begin() - 1;
  return speed[i] + (speed[i + 1] - speed[i]) * (t - time[i]) / (time[i + 1] - time[i]);
}

double Drive::turned_at(double t) const {
  // Speeds are linear between the rows, so the trapezoidal rule is exact. The speed is constant
  // before the first row and after the last.
  double sum = speed[0] * std::min(time[0], t);
  for (Eigen::Index i = 0; i + 1 < time.size() && time[i] < t; ++i) {
    const double to = std::min(time[i + 1], t);
    sum += 0.5 * (speed[i] + speed_at(to)) * (to - time[i]);
  }
  const Eigen::Index last = time.size() - 1;
  return sum + std::max(t - time[last], 0.0) * speed[last];
}

namespace detail {

Drives::Drives(const System& system, const std::vector<Drive>& drives)
    : system_(&system), drives_(&drives) {
  const Model& model = system.model();
  for (const Drive& drive : drives) {
    const std::string item = "drive '" + drive.name + "'";
    if (drive.link < 0 || static_cast<std::size_t>(drive.link) >= model.links.size()) {
      throw kernel::OutOfRange(item, "link", drive.link, "an existing item");
    }
    if (drive.time.size() == 0 || drive.time.size() != drive.speed.size()) {
      throw std::invalid_argument(item + ": as many speeds as times, one or more");
    }
    if (!drive.time.allFinite() || !drive.speed.allFinite() ||
        !std::is_sorted(drive.time.begin(), drive.time.end(), std::less_equal<>())) {
      throw std::invalid_argument(item + ": finite speeds at times that increase");
    }
  }
}

Vector2d Drives::along(const Drive& drive, const VectorXd& q) const {
  const Model& model = system_->model();
  const Bar& link = model.links[index(drive.link)];
  return (model.nodes[index(link.second)].position - model.nodes[index(link.first)].position +
          system_->displacement(link.second, q) - system_->displacement(link.first, q))
      .head<2>();
}

double Drives::drawn_angle(const Drive& drive) const {
  const Vector2d drawn = along(drive, VectorXd::Zero(system_->unknowns()));
  return std::atan2(drawn.y(), drawn.x());
}

std::vector<Eigen::Triplet<double>> Drives::directions(const VectorXd& q, double to) const {
  std::vector<Eigen::Triplet<double>> entries;
  const Model& model = system_->model();
  for (Eigen::Index k = 0; k < count(); ++k) {
    const Drive& drive = (*drives_)[static_cast<std::size_t>(k)];
    const double angle = drawn_angle(drive) + drive.turned_at(to);
    const Vector3d across =
        Vector3d(-std::sin(angle), std::cos(angle), 0.0) / along(drive, q).norm();
    const Bar& link = model.links[index(drive.link)];
    for (const auto& [end, sign] : {std::pair{link.second, 1.0}, std::pair{link.first, -1.0}}) {
      const NodeDofs& dofs = system_->dofs().at(end);
      for (int i = 0; i < dofs.freedoms; ++i) {
        const double along = sign * dofs.directions->col(i).dot(across);
        dofs.each_term(
            i, [&](int row, double factor) { entries.emplace_back(row, k, factor * along); });
      }
    }
  }
  return entries;
}

VectorXd Drives::targets(const VectorXd& q, double from, double to) const {
  VectorXd found(count());
  for (Eigen::Index k = 0; k < count(); ++k) {
    const Drive& drive = (*drives_)[static_cast<std::size_t>(k)];
    const Vector2d now = along(drive, q);
    const double lacks =
        std::remainder(drawn_angle(drive) + drive.turned_at(from) - std::atan2(now.y(), now.x()),
                       2.0 * std::numbers::pi);
    found[k] = drive.speed_at(to) + 0.5 * lacks / (to - from);
  }
  return found;
}

}  // namespace detail
}  // namespace statejump::truss
