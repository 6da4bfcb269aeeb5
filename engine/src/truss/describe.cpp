// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

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
  state.joint_output.resize(outputs_);
  state.joint_status = now.statuses;
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
  for (int i = 0; i < size(model.joints); ++i) {
    const Trial at = trial(i, z, time, now, JointModel::friction, 1.0);
    double* outputs = state.joint_output.data() + output_begin_[index(i)];
    std::visit(
        [&](const auto& one) {
          one.describe(at, outputs);
          state.elastic_energy += one.elastic_energy(at, history(i, now));
        },
        model.joints[index(i)]);
  }
}

void System::account(const VectorXd& z_before, double time_before, const VectorXd& z, double time,
                     const StepStart& start, const StepStart& after, const VectorXd& slips,
                     State& state) const {
  const Model& model = *model_;
  for (int i = 0; i < static_cast<int>(model.joints.size()); ++i) {
    const Trial at = trial(i, z, time, start, JointModel::friction, 1.0);
    state.joint_dissipation[i] += std::visit(
        [&](const auto& one) { return one.dissipation(at, history(i, after), slips[i]); },
        model.joints[index(i)]);
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
  Assembly at = assembly();
  evaluate(z, time, begin(z, time, statuses, 1.0), statuses, joints, 1.0, at);
  const Eigen::SparseMatrix<double> full = at.jacobian.block(0, 0, displacements_, displacements_);
  const int forces = unknowns_ - displacements_;
  Eigen::SparseMatrix<double> rows = at.jacobian.block(displacements_, 0, forces, displacements_);
  // Rows in metres have gradients of order one, whatever lever arms they have.
  Eigen::SparseMatrix<double> stiffness =
      0.5 * (full + Eigen::SparseMatrix<double>(full.transpose()));
  stiffness += held * stiffness_scale_ * (rows.transpose() * rows);
  return stiffness;
}

}  // namespace statejump::truss::detail
