// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "hermite.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

namespace {

/// Abscissae and weights on (0, 1) of the quadrature of order 8.
constexpr std::array<std::pair<double, double>, 4> gauss_legendre{
    {{0.069431844202973712, 0.17392742256872693},
     {0.33000947820757187, 0.32607257743127307},
     {0.66999052179242813, 0.32607257743127307},
     {0.93056815579702629, 0.17392742256872693}}};

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

VectorXd System::beyond_edges(const VectorXd& z, double time, const StepStart& now) const {
  std::vector<double> found;
  for (const AxialSpring& spring : model_->springs) {
    if (!spring.cable) continue;
    found.push_back(spring_stretch(spring, lengths_between(spring.first, spring.second, z)));
  }
  for (int i = 0; i < static_cast<int>(model_->joints.size()); ++i) {
    std::visit(
        [&](const auto& one) {
          if constexpr (requires(const Trial& at) { one.beyond_edges(at); }) {
            const Trial at = trial(i, z, time, now, JointModel::friction, 1.0);
            for (const double beyond : one.beyond_edges(at)) found.push_back(beyond);
          }
        },
        model_->joints[index(i)]);
  }
  return Eigen::Map<const VectorXd>(found.data(), static_cast<Eigen::Index>(found.size()));
}

VectorXd System::heat(const VectorXd& z, double time, const StepStart& start,
                      const StepStart& after, const VectorXd& slips) const {
  VectorXd found(slips.size());
  for (int i = 0; i < slips.size(); ++i) {
    const Trial at = trial(i, z, time, start, JointModel::friction, 1.0);
    found[i] = std::visit(
        [&](const auto& one) { return one.dissipation(at, history(i, after), slips[i]); },
        model_->joints[index(i)]);
  }
  return found;
}

void System::account(const VectorXd& z_before, double time_before, const VectorXd& z, double time,
                     const StepStart& start, const StepStart& after, const VectorXd& slips,
                     State& state, const VectorXd& rate_before, const VectorXd& rate) const {
  const Model& model = *model_;
  const double step = time - time_before;
  const bool known = rate_before.size() > 0 && rate.size() > 0;
  VectorXd dissipated = heat(z, time, start, after, slips);
  if (known && (dissipated.array() > 0.0).any()) {
    // By way of the middle of the cubic, and what that and the straight way say of no steps at all.
    const VectorXd middle = 0.5 * (z_before + z) + 0.125 * step * (rate_before - rate);
    const double then = time_before + 0.5 * step;
    const StepStart half = commit(middle, then, after.statuses, start);
    const StepStart whole = commit(z, time, after.statuses, half);
    const VectorXd halves =
        heat(middle, then, start, half, this->slips(middle, then, start, half)) +
        heat(z, time, half, whole, this->slips(z, time, half, whole));
    dissipated = halves + (halves - dissipated) / 3.0;
  }
  state.joint_dissipation += dissipated;
  const auto growth_rate = [&](const Link& link, const VectorXd& at, const VectorXd& moving) {
    const Lengths length = lengths_between(link.first, link.second, at);
    return step *
           length.along.dot(displacement(link.second, moving) - displacement(link.first, moving)) /
           length.now;
  };
  for (const Link& link : model.links) {
    const double expansion =
        link.stress_free_length * link.thermal_expansion * link.temperature_fraction;
    if (expansion == 0.0) continue;
    const thermal::Program& program = model.programs[index(link.program)];
    const Lengths first = lengths_between(link.first, link.second, z_before);
    const Lengths last = lengths_between(link.first, link.second, z);
    // ∂V/∂l_T = −N − N²/(2 E A)
    const auto by_length = [&](double growth, double when) {
      const double change = link.temperature_fraction * program.temperature_change(when);
      const double tension = link_axial(link, growth, last.drawn, change).tension;
      return -tension * (1.0 + 0.5 * tension / link.axial_stiffness);
    };
    if (!known) {
      const double warmed =
          program.temperature_change(time) - program.temperature_change(time_before);
      state.thermal_work += 0.5 *
                            (by_length(first.growth, time_before) + by_length(last.growth, time)) *
                            expansion * warmed;
      continue;
    }
    const Cubic growth{first.growth, last.growth, growth_rate(link, z_before, rate_before),
                       growth_rate(link, z, rate)};
    for (const auto& [share, weight] : gauss_legendre) {
      const double when = time_before + share * step;
      state.thermal_work += weight * step * expansion * program.temperature_rate(when) *
                            by_length(growth.at(share), when);
    }
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
