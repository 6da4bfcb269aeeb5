// SPDX-License-Identifier: GPL-3.0-or-later
#include "walker.hpp"

#include <algorithm>
#include <cmath>

namespace statejump::truss::detail {

/// Share of a step after which the first joint turns round within it: one that slips the other way
/// for a while, or one that leaves its branch and comes back. 1: none does. The unknowns and the
/// slides are cubics through both ends of the step and their rates.
double Walker::first_turn(const Ends& ends) const {
  const Rounding rounding = system.rounding(ends.to);
  const auto joints_at = [&](const VectorXd& unknowns, double then) {
    return [&, then, moved = system.displacements(unknowns)](int i) {
      return system.trial(i, unknowns, moved, then, ends.start, JointModel::friction, 1.0);
    };
  };
  const auto first = joints_at(ends.from, ends.from_time);
  const auto last = joints_at(ends.to, ends.to_time);
  const auto first_rate = joints_at(ends.from_rate, ends.from_time);
  const auto last_rate = joints_at(ends.to_rate, ends.to_time);
  const double step = ends.to_time - ends.from_time;
  VectorXd turn = VectorXd::Ones(static_cast<Eigen::Index>(model.joints.size()));
  system.each_joint([&](int i) {
    const JointStatus status = ends.statuses[index(i)];
    if (is_slip(status)) {
      turn[i] = turn_of_slip(i, ends, system.slide_rounding(i, last(i), rounding));
    } else if (status == ends.start.statuses[index(i)]) {
      const JointWay way{first(i), last(i), first_rate(i), last_rate(i), step};
      turn[i] = turn_of_stick(i, ends, way, rounding);
    }
  });
  return turn.size() == 0 ? 1.0 : std::min(1.0, turn.minCoeff());
}

double Walker::turn_of_slip(int i, const Ends& ends, double rounding) const {
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
  if (slide.last_rate < -rounding) return slipped ? slide.turn(1.0) : 0.5;
  const auto slowest = slide.slowest();
  if (slipped && slowest && slide.rate(*slowest) < -rounding) return slide.turn(*slowest);
  return 1.0;
}

double Walker::turn_of_stick(int i, const Ends& ends, const JointWay& way,
                             const Rounding& rounding) const {
  const JointStatus status = ends.statuses[index(i)];
  const auto& [first, last, first_rate, last_rate, step] = way;
  const auto leaves = [&](double share) {
    Trial at = way.at(share);
    at.length_rounding = rounding.length;
    at.force_rounding = rounding.force;
    const JointFrame& frame = last.frame;
    if (frame.program >= 0) {
      at.temperature_change = model.temperature_change(frame.program, frame.temperature_fraction,
                                                       ends.from_time + share * way.duration);
    }
    return joint(i, [&](const auto& one) { return one.decide(at, status); }) != status;
  };
  // What goes to and fro is farthest where its rate is 0.
  double found = 1.0;
  const auto ask = [&](double from, double to, double from_rate, double to_rate) {
    if (!(from_rate * to_rate < 0.0)) return;
    const double sense = from_rate > 0.0 ? step : -step;
    const double share =
        Cubic{0.0, (from_rate > 0.0 ? 1.0 : -1.0) * (to - from), sense * from_rate, sense * to_rate}
            .turn(1.0);
    if (share < found && leaves(share)) found = share;
  };
  for (std::size_t k = 0; k < most_joint_forces; ++k) {
    ask(first.force[k], last.force[k], first_rate.force[k], last_rate.force[k]);
  }
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d along = last.frame.axes.col(k);
    const auto apart = [&](const Trial& of) { return along.dot(of.moved[0] - of.moved[1]); };
    ask(apart(first), apart(last), apart(first_rate), apart(last_rate));
  }
  return found;
}

}  // namespace statejump::truss::detail
