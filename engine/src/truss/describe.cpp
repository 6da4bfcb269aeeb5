// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "parts.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

namespace {

/// Angle between two links from the drawn shape, or of one from the ground [rad].
double torsion_angle(const Model& model, const TorsionSpring& spring, const Matrix32& plane,
                     const System& system, const VectorXd& z) {
  const auto turned = [&](int i) {
    const Link& link = model.links[index(i)];
    const Vector2d drawn = plane.transpose() * (model.nodes[index(link.second)].position -
                                                model.nodes[index(link.first)].position);
    const Vector2d moved = plane.transpose() * (system.displacement(link.second, z) -
                                                system.displacement(link.first, z));
    return std::atan2(cross(drawn, moved), drawn.dot(drawn + moved));
  };
  const double first = turned(spring.first_link);
  return spring.second_link < 0 ? first : turned(spring.second_link) - first;
}

/// Heat of micro-slip at the rim of a contact that sticks [J]: work of friction less the energy
/// that stays in the bend. Loading, where the force F at compliance C goes to F' at C' along
/// ΔF (C + C')/2: (F² + F'²) (C − C')/4; unloading, along F' C' − F C: F F' (C' − C)/2.
double rim_slip(double friction_before, double compliance_before, double friction,
                double compliance) {
  if (compliance_before == 0.0) return 0.0;
  if (compliance == 0.0) return 0.5 * compliance_before * friction_before * friction_before;
  if (compliance > compliance_before) {
    return 0.5 * friction_before * friction * (compliance - compliance_before);
  }
  return 0.25 * (friction_before * friction_before + friction * friction) *
         (compliance_before - compliance);
}

}  // namespace

Axial System::axial(const Link& link, const VectorXd& z, double time) const {
  const Lengths length = lengths_between(link.first, link.second, z);
  return link_axial(link, length.growth, length.drawn,
                    model_->temperature_change(link.program, link.temperature_fraction, time));
}

void System::describe(const VectorXd& z, double time, const StepStart& now, State& state) const {
  const Model& model = *model_;
  const auto size = [](const auto& list) { return static_cast<Eigen::Index>(list.size()); };
  state.time = time;
  state.temperature_change = model.temperature_change(0, 1.0, time);
  state.displacement.resize(3, size(model.nodes));
  state.axial_force.resize(size(model.links));
  state.tension.resize(size(model.springs));
  state.slide.resize(size(model.sliders));
  state.slider_force.resize(size(model.sliders));
  state.eccentricity.resize(3, size(model.revolutes));
  state.normal_force.resize(size(model.revolutes));
  state.friction_force.resize(size(model.revolutes));
  state.slider_status = now.statuses.sliders;
  state.revolute_status = now.statuses.revolutes;
  state.elastic_energy = 0.0;
  state.load_potential = 0.0;
  for (int i = 0; i < size(model.nodes); ++i) {
    state.displacement.col(i) = displacement(i, z);
    state.load_potential -= model.nodes[index(i)].load.dot(state.displacement.col(i));
  }
  for (int i = 0; i < size(model.links); ++i) {
    const Axial force = axial(model.links[index(i)], z, time);
    state.axial_force[i] = -force.tension;
    state.elastic_energy += 0.5 * force.tension * force.tension / force.stiffness;
  }
  for (int i = 0; i < size(model.springs); ++i) {
    const AxialSpring& spring = model.springs[index(i)];
    const Axial force = spring_axial(spring, lengths_between(spring.first, spring.second, z));
    state.tension[i] = force.tension;
    if (force.stiffness > 0.0) {
      state.elastic_energy += 0.5 * force.tension * force.tension / force.stiffness;
    }
  }
  for (std::size_t i = 0; i < model.torsion_springs.size(); ++i) {
    const TorsionSpring& spring = model.torsion_springs[i];
    const double wound =
        torsion_angle(model, spring, torsion_plane_[i], *this, z) - spring.free_angle;
    state.elastic_energy += 0.5 * spring.stiffness * wound * wound;
  }
  for (int i = 0; i < size(model.sliders); ++i) {
    state.slide[i] = slide(i, z);
    state.slider_force[i] = slider_force(i, z);
    const double stiffness = model.sliders[index(i)].tangential_stiffness;
    if (std::isfinite(stiffness)) {
      const double bend = state.slide[i] - now.slide[i];
      state.elastic_energy += 0.5 * stiffness * bend * bend;
    }
  }
  for (int i = 0; i < size(model.revolutes); ++i) {
    const ClearanceRevolute& revolute = model.revolutes[index(i)];
    state.eccentricity.col(i) = between(revolute.bearing_node, revolute.journal_node, z);
    const Vector2d force = revolute_force(i, z);
    state.normal_force[i] = force[0];
    state.friction_force[i] = force[1];
    state.elastic_energy += 0.4 * force[0] * depth_of(revolute, force[0]);  // 2/5 K δ^5/2
    state.elastic_energy += 0.5 * now.compliance[i] * now.friction[i] * now.friction[i];
  }
}

void System::account(const VectorXd& z_before, double time_before, const VectorXd& z, double time,
                     const StepStart& start, const StepStart& after, const VectorXd& slips,
                     State& state) const {
  const Model& model = *model_;
  const int sliders = static_cast<int>(model.sliders.size());
  for (int i = 0; i < sliders; ++i) {
    // Whenever it slides, friction is f; a stop takes no heat.
    state.slider_dissipation[i] += model.sliders[index(i)].friction_force * std::abs(slips[i]);
  }
  for (int i = 0; i < static_cast<int>(model.revolutes.size()); ++i) {
    const double normal = 0.5 * (revolute_force(i, z_before)[0] + revolute_force(i, z)[0]);
    state.revolute_dissipation[i] +=
        model.revolutes[index(i)].friction_coefficient * normal * std::abs(slips[sliders + i]) +
        rim_slip(start.friction[i], start.compliance[i], after.friction[i], after.compliance[i]);
  }
  for (const Link& link : model.links) {
    if (link.thermal_expansion == 0.0) continue;
    // ∂V/∂l_T = −N − N²/(2 E A), by the trapezoidal rule.
    const auto rate = [&](const VectorXd& at, double when) {
      const double tension = axial(link, at, when).tension;
      return -tension * (1.0 + 0.5 * tension / link.axial_stiffness);
    };
    const double growth =
        link.stress_free_length * link.thermal_expansion *
        (model.temperature_change(link.program, link.temperature_fraction, time) -
         model.temperature_change(link.program, link.temperature_fraction, time_before));
    state.thermal_work += 0.5 * (rate(z_before, time_before) + rate(z, time)) * growth;
  }
}

Eigen::SparseMatrix<double> System::joined_stiffness(const VectorXd& z, double time,
                                                     const Statuses& statuses, JointModel joints,
                                                     double held) const {
  // The forces of the joints are condensed: a direction that a joint holds becomes a stiff spring.
  // Rows that hold nothing drop out.
  VectorXd residual(unknowns_);
  Eigen::SparseMatrix<double> jacobian = pattern();
  evaluate(z, time, step_start(z, statuses), statuses, joints, 1.0, residual, jacobian);
  const Eigen::SparseMatrix<double> full = jacobian.block(0, 0, displacements_, displacements_);
  const int forces = unknowns_ - displacements_;
  Eigen::SparseMatrix<double> rows = jacobian.block(displacements_, 0, forces, displacements_);
  // Rows in metres have gradients of order one, whatever lever arms they have.
  Eigen::SparseMatrix<double> stiffness =
      0.5 * (full + Eigen::SparseMatrix<double>(full.transpose()));
  stiffness += held * stiffness_scale_ * (rows.transpose() * rows);
  return stiffness;
}

}  // namespace statejump::truss::detail
