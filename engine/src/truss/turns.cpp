// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <optional>

#include "hermite.hpp"
#include "path_follower.hpp"

namespace statejump::truss::detail {

/// Fraction of a step at which a joint first reverses; 1: no joint reverses. A joint reverses if it
/// slips backwards for a while, or leaves its status and returns. Cubics through the values and
/// rates at both ends interpolate unknowns and slides.
double PathFollower::first_turn(const Ends& ends) const {
  const Rounding rounding = system.rounding(ends.to);
  VectorXd turn = VectorXd::Ones(static_cast<Eigen::Index>(model.joints.size()));
  system.each_joint([&](int i) {
    const JointStatus status = ends.statuses[index(i)];
    if (is_slip(status)) {
      turn[i] = turn_of_slip(i, ends, rounding);
    } else if (status == ends.start.statuses[index(i)]) {
      turn[i] = turn_of_stick(i, ends, rounding);
    }
  });
  return turn.size() == 0 ? 1.0 : std::min(1.0, turn.minCoeff());
}

double PathFollower::turn_of_slip(int i, const Ends& ends, const Rounding& by) const {
  const JointStatus status = ends.statuses[index(i)];
  const bool matters =
      joint(i, [&](const auto& one) { return one.remembers_when(status, JointStatus::stick); });
  if (!matters) return 1.0;
  const double step = ends.to_time - ends.from_time;
  const double sense = status == JointStatus::slip_plus ? 1.0 : -1.0;
  const bool slipped = ends.start.statuses[index(i)] == status;
  const Cubic slide{0.0, sense * ends.slips[i],
                    slipped ? std::max(0.0, sense * step * ends.from_slide_rate[i]) : 0.0,
                    sense * step * ends.to_slide_rate[i]};
  // A smaller backward slip cannot be distinguished from rest, see slide_at_stake().
  const double rounding = 10.0 * system.slide_rounding(i, ends.to, ends.to_time, ends.start, by);
  if (slide.last_rate < -rounding) return slipped ? slide.turn(1.0) : 0.5;
  const auto slowest = slide.slowest();
  if (slipped && slowest && slide.rate(*slowest) < -rounding) return slide.turn(*slowest);
  return 1.0;
}

double PathFollower::turn_of_stick(int i, const Ends& ends, const Rounding& rounding) const {
  const JointStatus status = ends.statuses[index(i)];
  const double step = ends.to_time - ends.from_time;
  const JointFrame& frame = system.frame(i);
  std::optional<JointWay> way;  // constructed on demand: few joints reverse
  const auto leaves = [&](double share) {
    if (!way) {
      const auto at = [&](const VectorXd& unknowns, double then) {
        return system.trial(i, unknowns, then, ends.start, JointModel::friction, 1.0);
      };
      way.emplace(JointWay{at(ends.from, ends.from_time), at(ends.to, ends.to_time),
                           at(ends.from_rate, ends.from_time), at(ends.to_rate, ends.to_time),
                           step});
    }
    Trial at = way->at(share);
    at.length_rounding = rounding.length;
    at.force_rounding = rounding.force;
    if (frame.program >= 0) {
      at.temperature_change = model.temperature_change(frame.program, frame.temperature_fraction,
                                                       ends.from_time + share * step);
    }
    return joint(i, [&](const auto& one) { return one.decide(at, status); }) != status;
  };
  // A quantity that reverses is extreme where its rate is 0.
  double found = 1.0;
  const auto ask = [&](double from_rate, double to_rate, auto&& passed) {
    if (!(from_rate * to_rate < 0.0)) return;
    const double sense = from_rate > 0.0 ? 1.0 : -1.0;
    const double share =
        Cubic{0.0, sense * passed(), sense * step * from_rate, sense * step * to_rate}.turn(1.0);
    if (share < found && leaves(share)) found = share;
  };
  for (int k = 0; k < frame.forces; ++k) {
    const int row = system.force_row(i) + k;
    ask(ends.from_rate[row], ends.to_rate[row], [&] { return ends.to[row] - ends.from[row]; });
  }
  const auto apart = [&](const VectorXd& unknowns) -> Vector3d {
    const auto displacement = [&](int node) -> Vector3d {
      return node < 0 ? Vector3d::Zero() : system.displacement(node, unknowns);
    };
    return displacement(frame.nodes[0]) - displacement(frame.nodes[1]);
  };
  const Vector3d from_rate = frame.axes.transpose() * apart(ends.from_rate);
  const Vector3d to_rate = frame.axes.transpose() * apart(ends.to_rate);
  for (int k = 0; k < 3; ++k) {
    ask(from_rate[k], to_rate[k],
        [&] { return frame.axes.col(k).dot(apart(ends.to) - apart(ends.from)); });
  }
  return found;
}

}  // namespace statejump::truss::detail
