// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "parts.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

namespace {

/// One of the two ways in which a slider may go.
struct Sense {
  double sign;
  JointStatus slip;
  JointStatus stop;
  JointStatus other_slip;
  JointStatus other_stop;
  double clearance(const Slider& slider) const {
    return sign > 0.0 ? slider.clearance_plus : slider.clearance_minus;
  }
};

constexpr Sense plus{1.0, JointStatus::slip_plus, JointStatus::stop_plus, JointStatus::slip_minus,
                     JointStatus::stop_minus};
constexpr Sense minus{-1.0, JointStatus::slip_minus, JointStatus::stop_minus,
                      JointStatus::slip_plus, JointStatus::stop_plus};

}  // namespace

int System::correct_statuses(const VectorXd& z, double time, const StepStart& start,
                             JointModel joints, double clearance_scale, Statuses& statuses,
                             int& last_changed) const {
  int changed = 0;
  // Inequalities are violated when rounding cannot be the reason; forces are as round as the
  // stiffest part makes them.
  const double length_slack = length_rounding(z);
  const double force_slack = force_rounding(length_slack);
  const auto become = [&](JointStatus& status, JointStatus next, int joint) {
    if (status == next) return;
    status = next;
    last_changed = joint;
    ++changed;
  };
  for (std::size_t i = 0; i < model_->sliders.size(); ++i) {
    const Slider& slider = model_->sliders[i];
    const int joint = static_cast<int>(i);
    const double s = slide(joint, z);
    const double force = slider_force(joint, z);
    const double f = slider.friction_force;
    const bool elastic = std::isfinite(slider.tangential_stiffness);
    const double bend_slack = slide_rounding(joint, z, length_slack);
    // While it slips, its friction is the force.
    const double step = s - force / slider.tangential_stiffness - start.slide[joint];
    JointStatus& status = statuses.sliders[i];
    const JointStatus before = start.statuses.sliders[i];
    const auto is_beyond_stop = [&](const Sense& way) {
      return way.sign * s > way.clearance(slider) + length_slack;
    };
    const auto slips = [&](const Sense& way) {
      if (is_beyond_stop(way)) {
        become(status, way.stop, joint);
      } else if (way.sign * step < -bend_slack) {
        become(status, before == way.other_stop && !elastic ? before : JointStatus::stick, joint);
      }
    };
    const auto rests = [&](const Sense& way) {
      // Rested there already: friction helps to stay. Arrived in this step: friction pushes back.
      const double pushed = way.sign * force;
      if (elastic) {
        const double bend = way.sign * way.clearance(slider) - start.slide[joint];
        if (pushed < way.sign * bent_friction(slider, bend) - force_slack) {
          become(status, JointStatus::stick, joint);
        }
      } else if (before == way.stop) {
        if (pushed < -(f + force_slack)) become(status, way.other_slip, joint);
      } else if (pushed < f - force_slack) {
        become(status, way.slip, joint);
      }
    };
    switch (status) {
      case JointStatus::stick:
        for (const Sense& way : {plus, minus}) {
          if (way.sign * force > f + force_slack) become(status, way.slip, joint);
        }
        // It may get to a stop while it bends.
        for (const Sense& way : {plus, minus}) {
          if (elastic && is_beyond_stop(way)) become(status, way.stop, joint);
        }
        break;
      case JointStatus::slip_plus:
        slips(plus);
        break;
      case JointStatus::slip_minus:
        slips(minus);
        break;
      case JointStatus::stop_plus:
        rests(plus);
        break;
      case JointStatus::stop_minus:
        rests(minus);
        break;
      case JointStatus::open:
        break;
    }
  }
  if (joints == JointModel::pins) return changed;
  for (std::size_t i = 0; i < model_->revolutes.size(); ++i) {
    const ClearanceRevolute& revolute = model_->revolutes[i];
    const int part = static_cast<int>(i);
    const int joint = static_cast<int>(model_->sliders.size()) + part;
    const RevoluteGeometry g = revolute_geometry(part, z, time, start, clearance_scale);
    const Vector2d force = revolute_force(part, z);
    JointStatus& status = statuses.revolutes[i];
    const double mu = joints == JointModel::friction ? revolute.friction_coefficient : 0.0;
    const JointStatus resting = mu > 0.0 ? JointStatus::stick : JointStatus::slip_plus;
    if (status == JointStatus::open) {
      if (g.eccentricity.norm() > g.clearance + length_slack) become(status, resting, joint);
    } else if (force[0] < -force_slack) {
      become(status, JointStatus::open, joint);
    } else if (mu == 0.0) {
      continue;  // slips freely either way
    } else if (status == JointStatus::stick) {
      const double bound = mu * force[0] + force_slack;
      if (force[1] > bound) become(status, JointStatus::slip_plus, joint);
      if (force[1] < -bound) become(status, JointStatus::slip_minus, joint);
    } else {
      const double sense = status == JointStatus::slip_plus ? 1.0 : -1.0;
      const ElasticSlide elastic = elastic_slide(part, z, start);
      if (sense * (g.surface_slide - elastic.slide) < -slide_rounding(joint, z, length_slack)) {
        become(status, JointStatus::stick, joint);
      }
    }
  }
  return changed;
}

}  // namespace statejump::truss::detail
