// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/joint_loop/rigid_loop.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/change_between.hpp"
#include "statejump/failure.hpp"

namespace statejump::joint_loop {

using Eigen::Vector2d;
using kernel::require;
using numerics::change_between;

namespace {

/// Follows the path. `arc` is the value of rolling_arc() that the current rolling motion keeps
/// constant.
class PathFollower {
 public:
  PathFollower(const linkage::Linkage& model, int side, double contact_angle)
      : model_(model), side_(side), limit_(std::atan(model.friction_coefficient())) {
    now_ = joint_point(model_, 0.0, side_, contact_angle);
    arc_ = rolling_arc(model_, now_);
  }

  /// State at ΔT. The step to ΔT must be so small that φ is monotone.
  JointPoint next(double temperature_change) const {
    const double wanted = std::clamp(rolling_angle(temperature_change), -limit_, limit_);
    return joint_point(model_, temperature_change, side_, wanted);
  }

  /// Whether φ would leave the friction cone if the joint rolled from the current state to ΔT.
  bool slips(double temperature_change) const {
    return arc_at(temperature_change, limit_) < arc_ || arc_at(temperature_change, -limit_) > arc_;
  }

  bool loaded(const JointPoint& point) const { return side_ * point.spring_moment > 0.0; }

  void accept(const JointPoint& point, JointMotion motion) {
    now_ = point;
    now_.motion = motion;
    if (motion == JointMotion::slip) arc_ = rolling_arc(model_, now_);
  }

  const JointPoint& now() const { return now_; }

 private:
  double arc_at(double temperature_change, double angle) const {
    return rolling_arc(model_, joint_point(model_, temperature_change, side_, angle));
  }

  /// Angle φ in the friction cone at which rolling_arc() has its constant value. The arc grows with
  /// φ.
  double rolling_angle(double temperature_change) const {
    if (arc_at(temperature_change, limit_) <= arc_) return limit_;
    if (arc_at(temperature_change, -limit_) >= arc_) return -limit_;
    const auto is_beyond = [&](double angle) { return arc_at(temperature_change, angle) >= arc_; };
    return change_between(-limit_, limit_, is_beyond).after;
  }

  const linkage::Linkage& model_;
  int side_;
  double limit_;
  JointPoint now_;
  double arc_ = 0.0;
};

}  // namespace

const char* to_string(JointMotion motion) {
  switch (motion) {
    case JointMotion::roll:
      return "roll";
    case JointMotion::slip:
      return "slip";
    case JointMotion::separated:
      return "separated";
  }
  return "unknown";
}

JointPoint joint_point(const linkage::Linkage& model, double temperature_change, int side,
                       double contact_angle) {
  const double l1 = thermal::length(model.link_ab.stress_free_length,
                                    model.link_ab.thermal_expansion, temperature_change);
  const double l2 = thermal::length(model.link_bc.stress_free_length,
                                    model.link_bc.thermal_expansion, temperature_change);
  const double c = side * model.radial_clearance();
  const Vector2d d(c * std::cos(contact_angle), c * std::sin(contact_angle));
  const Vector2d w = Vector2d(model.frame_length, 0.0) - d;
  const double length = w.norm();
  // Foot of the perpendicular from B on w, and its height. An arc cosine is inaccurate near ±1.
  const double x = (length * length + (l1 - l2) * (l1 + l2)) / (2.0 * length);
  const double y = std::sqrt((l1 - x) * (l1 + x));
  const Vector2d along = w / length;
  const Vector2d across(-along.y(), along.x());
  const Vector2d ab = x * along + y * across;
  const Vector2d bc = ab - w;
  JointPoint point;
  point.temperature_change = temperature_change;
  point.contact_angle = contact_angle;
  point.theta2 = std::atan2(ab.y(), ab.x());
  point.theta4 = std::atan2(bc.y(), bc.x());
  point.eccentricity = d;
  point.bearing_centre = ab;
  point.journal_centre = ab + d;
  point.spring_moment =
      model.torsion_stiffness * (point.theta4 - point.theta2 - model.free_angle());
  point.motion = JointMotion::roll;
  return point;
}

double rolling_arc(const linkage::Linkage& model, const JointPoint& point) {
  return model.radial_clearance() * point.contact_angle + model.journal_radius * point.theta4 -
         model.bearing_radius * point.theta2;
}

int loaded_side(const linkage::Linkage& model, double contact_angle) {
  require(model.torsion_stiffness > 0.0, "torsion_stiffness", model.torsion_stiffness,
          "> 0 N m/rad, else statics leaves the position within the play undetermined");
  require(std::abs(contact_angle) <= std::atan(model.friction_coefficient()), "contact_angle",
          contact_angle, "[-atan(mu), atan(mu)] rad");
  // The resulting sign of M must equal the assumed sign. If this holds for neither sign, the
  // contact is unloaded.
  int side = 0;
  for (const int candidate : {-1, 1}) {
    if (candidate * joint_point(model, 0.0, candidate, contact_angle).spring_moment > 0.0) {
      side = candidate;
    }
  }
  if (side == 0) {
    throw UnloadedJoint("", "torsion_free_angle", model.free_angle(),
                        "far enough from the ideal flare angle to load the joint at the start "
                        "[rad]");
  }
  return side;
}

RigidLoop rigid_loop(const linkage::Linkage& model, const thermal::Program& program,
                     double contact_angle, int samples) {
  model.validate();
  program.validate();
  require(model.journal_thermal_expansion == 0.0, "journal_thermal_expansion",
          model.journal_thermal_expansion, "0 here");
  require(model.bearing_thermal_expansion == 0.0, "bearing_thermal_expansion",
          model.bearing_thermal_expansion, "0 here");
  require(samples >= 1, "samples", samples, ">= 1");
  const double limit = std::atan(model.friction_coefficient());
  const int side = loaded_side(model, contact_angle);

  RigidLoop loop;
  PathFollower follower(model, side, contact_angle);
  loop.points.push_back(follower.now());
  bool first = true;
  const auto event = [&loop](const JointPoint& point) { loop.events.push_back(point); };
  for (const thermal::Branch& branch : thermal::monotone_branches(program)) {
    // The joint rolls again after a corner: a reversal brings φ back into the friction cone.
    bool fresh = true;
    for (int i = 1; i <= samples; ++i) {
      const double from = follower.now().temperature_change;
      const double part = static_cast<double>(i) / samples;
      const double to =
          i == samples ? branch.end : branch.start + part * (branch.end - branch.start);
      const JointMotion before = follower.now().motion;
      const bool slips = follower.slips(to);
      const JointPoint reached = follower.next(to);
      if (!follower.loaded(reached)) {
        const double at = change_between(from, to, [&](double heat) {
                            return !follower.loaded(follower.next(heat));
                          }).after;
        follower.accept(follower.next(at), JointMotion::separated);
        event(follower.now());
        loop.points.push_back(follower.now());
        loop.separated = true;
        return loop;
      }
      const JointMotion motion = slips ? JointMotion::slip : JointMotion::roll;
      if (fresh || motion != before) {
        JointPoint change = follower.now();
        change.motion = motion;
        if (slips && std::abs(follower.now().contact_angle) < limit) {
          if (fresh) {
            change.motion = JointMotion::roll;
            event(change);
          }
          const auto slips_at = [&](double heat) { return follower.slips(heat); };
          change = follower.next(change_between(from, to, slips_at).after);
          change.motion = JointMotion::slip;
          loop.points.push_back(change);
        }
        event(change);
        if (first) loop.points.front().motion = loop.events.front().motion;
      }
      first = fresh = false;
      follower.accept(reached, motion);
      loop.points.push_back(follower.now());
    }
  }
  event(follower.now());
  return loop;
}

}  // namespace statejump::joint_loop
