// SPDX-License-Identifier: GPL-3.0-or-later
#include "rods.hpp"

#include <cmath>
#include <utility>

namespace statejump::truss::detail {

struct Rods::State {
  Vector3d direction;
  Vector3d across;  ///< Relative velocity of the ends across the rod [m/s].
  double length;
  double tension;      ///< Elastic [N].
  double growth_rate;  ///< Of the stress-free length [m/s].
  double strain_rate;  ///< L' − l_T' [m/s]
};

Rods::Rods(const System& system, const Inertia& inertia) {
  const Model& model = system.model();
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const Bar& link = model.links[i];
    Rod rod;
    rod.first_move = moves_.size();
    for (const auto& [end, sense] : {std::pair{link.second, 1.0}, std::pair{link.first, -1.0}}) {
      const double sign = sense;  // Clang captures no structured binding
      const NodeDofs& dofs = system.dofs().at(end);
      for (int k = 0; k < dofs.freedoms; ++k) {
        dofs.each_term(k, [&](int row, double factor) {
          moves_.push_back({row, sign * factor * dofs.directions->col(k)});
        });
      }
    }
    rod.last_move = moves_.size();
    rod.drawn = model.nodes[index(link.second)].position - model.nodes[index(link.first)].position;
    rod.drawn_length = rod.drawn.norm();
    rod.stress_free_length = link.stress_free_length;
    rod.axial_stiffness = link.axial_stiffness;
    rod.expansion = link.thermal_expansion * link.temperature_fraction;
    rod.program = index(link.program);
    rod.axial_damping = inertia_of(inertia.link_damping, i);
    rod.turning_damping = inertia_of(inertia.pin_damping, i);
    rods_.push_back(rod);
  }
}

inline Rods::State Rods::state(const Rod& rod, const double* q, const double* v,
                               const Heat& heat) const {
  Vector3d moved = Vector3d::Zero();
  Vector3d speed = Vector3d::Zero();
  for (std::size_t k = rod.first_move; k < rod.last_move; ++k) {
    const Move& move = moves_[k];
    moved += q[move.row] * move.by;
    speed += v[move.row] * move.by;
  }
  State now;
  const Vector3d along = rod.drawn + moved;
  now.length = along.norm();
  now.direction = (1.0 / now.length) * along;
  // As lengths() and link_axial(), without the difference of two lengths.
  const double growth = moved.dot(2.0 * rod.drawn + moved) / (rod.drawn_length + now.length);
  const double warmed = rod.expansion * heat.change[rod.program];
  const double stretch =
      growth + (rod.drawn_length - rod.stress_free_length) - rod.stress_free_length * warmed;
  now.tension = rod.axial_stiffness / (rod.stress_free_length * (1.0 + warmed)) * stretch;
  now.growth_rate = rod.stress_free_length * rod.expansion * heat.rate[rod.program];
  const double length_rate = speed.dot(now.direction);
  now.strain_rate = length_rate - now.growth_rate;
  now.across = speed - length_rate * now.direction;
  return now;
}

void Rods::add_force(const ConstColumn& q, const ConstColumn& v, const Heat& heat,
                     Eigen::VectorXd& to) const {
  double* force = to.data();
  for (const Rod& rod : rods_) {
    const State now = state(rod, q.data(), v.data(), heat);
    Vector3d pull = (now.tension + rod.axial_damping * now.strain_rate) * now.direction;
    if (rod.turning_damping > 0.0) {
      pull += rod.turning_damping / (now.length * now.length) * now.across;
    }
    for (std::size_t k = rod.first_move; k < rod.last_move; ++k) {
      force[moves_[k].row] -= moves_[k].by.dot(pull);
    }
  }
}

Rods::Power Rods::power(const ConstColumn& q, const ConstColumn& v, const Heat& heat) const {
  Power sum;
  for (const Rod& rod : rods_) {
    const State now = state(rod, q.data(), v.data(), heat);
    const double dashpot = rod.axial_damping * now.strain_rate;
    sum.heat += dashpot * now.strain_rate +
                rod.turning_damping / (now.length * now.length) * now.across.squaredNorm();
    // Thermal power from ∂V/∂l_T = −N − N²/(2 E A). The growth of l_T also works against the
    // dashpot.
    sum.thermal -=
        (now.tension * (1.0 + 0.5 * now.tension / rod.axial_stiffness) + dashpot) * now.growth_rate;
  }
  return sum;
}

}  // namespace statejump::truss::detail
