// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "truss_parts.hpp"
#include "truss_system.hpp"

namespace statejump::detail {

int TrussSystem::correct_statuses(const VectorXd& z, double time, const StepStart& start,
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
    const TrussSlider& slider = model_->sliders[i];
    const int joint = static_cast<int>(i);
    const double s = slide(joint, z);
    const double force = slider_force(joint, z);
    const double f = slider.friction_force;
    const double beyond = f + force_slack;
    const bool elastic = std::isfinite(slider.tangential_stiffness);
    const double bend_slack = slide_rounding(joint, z, length_slack);
    // While it slips, its friction is the force.
    const double step = s - force / slider.tangential_stiffness - start.slide[joint];
    const auto friction_at = [&](double stop) {
      return bent_friction(slider, stop - start.slide[joint]);
    };
    JointStatus& status = statuses.sliders[i];
    const JointStatus before = start.statuses.sliders[i];
    switch (status) {
      case JointStatus::stick:
        if (force > beyond) become(status, JointStatus::slip_plus, joint);
        if (force < -beyond) become(status, JointStatus::slip_minus, joint);
        // It may get to a stop while it bends.
        if (elastic && s > slider.clearance_plus + length_slack) {
          become(status, JointStatus::stop_plus, joint);
        }
        if (elastic && s < -slider.clearance_minus - length_slack) {
          become(status, JointStatus::stop_minus, joint);
        }
        break;
      case JointStatus::slip_plus:
        if (s > slider.clearance_plus + length_slack) {
          become(status, JointStatus::stop_plus, joint);
        } else if (step < -bend_slack) {
          become(status,
                 before == JointStatus::stop_minus && !elastic ? before : JointStatus::stick,
                 joint);
        }
        break;
      case JointStatus::slip_minus:
        if (s < -slider.clearance_minus - length_slack) {
          become(status, JointStatus::stop_minus, joint);
        } else if (step > bend_slack) {
          become(status, before == JointStatus::stop_plus && !elastic ? before : JointStatus::stick,
                 joint);
        }
        break;
      case JointStatus::stop_plus:
        // Rested there already: friction helps to stay. Arrived in this step: friction pushes back.
        if (elastic) {
          if (force < friction_at(slider.clearance_plus) - force_slack) {
            become(status, JointStatus::stick, joint);
          }
        } else if (before == JointStatus::stop_plus) {
          if (force < -beyond) become(status, JointStatus::slip_minus, joint);
        } else if (force < f - force_slack) {
          become(status, JointStatus::slip_plus, joint);
        }
        break;
      case JointStatus::stop_minus:
        if (elastic) {
          if (force > friction_at(-slider.clearance_minus) + force_slack) {
            become(status, JointStatus::stick, joint);
          }
        } else if (before == JointStatus::stop_minus) {
          if (force > beyond) become(status, JointStatus::slip_plus, joint);
        } else if (force > -f + force_slack) {
          become(status, JointStatus::slip_minus, joint);
        }
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

}  // namespace statejump::detail
