// SPDX-License-Identifier: GPL-3.0-or-later
// For each element type a model for the tests that every type must pass. A new type adds its own.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "../parts.hpp"
#include "statejump/truss/motion.hpp"

namespace statejump::truss::testing {

/// Four nodes in space: one free, one free in a tilted plane, one free on a tilted line, one fixed.
inline Model four_nodes() {
  Model model;
  model.programs = {triangle(80.0, 2.0), triangle(-50.0, 2.0)};
  model.nodes = {node("A", {0.1, -0.2, 0.3}, 3), node("B", {1.2, 0.3, -0.1}, 2),
                 node("C", {0.4, 1.1, 0.5}, 1), node("D", {-0.6, 0.5, 0.9}, 0)};
  const Eigen::Quaterniond tilted = Eigen::Quaterniond(0.8, 0.3, -0.4, 0.2).normalized();
  for (const std::size_t tilts : {1u, 2u}) {
    model.nodes[tilts].free_directions = Eigen::Matrix3d(tilted.toRotationMatrix());
  }
  return model;
}

inline Model sample(std::type_identity<Bar>) {
  Model model = four_nodes();
  model.links = {{"AB", 0, 1, 3e5, 1.22, 2e-5, 0, 1.0},
                 {"BC", 1, 2, 2e5, 1.31, -3e-5, 1, 0.5},
                 {"CD", 2, 3, 1e5, 1.30, 0.0, 0, 1.0}};
  return model;
}

inline Model sample(std::type_identity<Spring>) {
  Model model = four_nodes();
  model.springs = {{"AB", 0, 1, 3e3, 0.9, false},
                   {"preloaded", 1, 2, 2e3, -0.4, false},
                   {"taut", 2, 0, 1e3, 0.7, true},
                   {"slack", 2, 3, 1e3, 3.0, true}};
  return model;
}

inline Model sample(std::type_identity<TorsionSpring>) {
  Model model = four_nodes();
  model.links = {{"AB", 0, 1, 3e5, 1.22, 0.0, 0, 1.0},
                 {"AC", 0, 2, 2e5, 1.31, 0.0, 0, 1.0},
                 {"DC", 3, 2, 1e5, 1.30, 0.0, 0, 1.0}};
  const Eigen::Vector3d axis = Eigen::Vector3d(0.2, -0.3, 0.9).normalized();
  model.torsion_springs = {{"two bars", 0, 1, 40.0, 0.2, axis},
                           {"apart", 2, 0, 30.0, -0.1, axis},
                           {"ground", 1, -1, 20.0, 0.3, Eigen::Vector3d::UnitZ()}};
  return model;
}

inline Model sample(std::type_identity<SpinSpring>) {
  Model model = four_nodes();
  model.spin_springs = {{"spin", 1, 3e3, Eigen::Vector3d(0.2, -0.3, 0.9).normalized()}};
  return model;
}

/// Beams with every parameter, one curved in its stress-free shape by its misfit only. The nodes
/// may rotate about three, two, one and no axes.
inline Model sample(std::type_identity<Beam>) {
  Model model = four_nodes();
  for (std::size_t n = 1; n < 4; ++n) {
    model.nodes[n].rotations = 3 - static_cast<int>(n);
    model.nodes[n].rotation_directions = model.nodes[1].free_directions;
  }
  const auto beam = [&](const char* name, int first, int second, double length) {
    Beam made;
    made.name = name;
    made.first = first;
    made.second = second;
    made.axial_stiffness = 3e5;
    made.torsional_stiffness = 3e3;
    made.bending_stiffness_y = 5e3;
    made.bending_stiffness_z = 8e3;
    made.stress_free_length = length;
    made.thermal_expansion = 2e-5;
    const Eigen::Vector3d along = model.nodes[static_cast<std::size_t>(second)].position -
                                  model.nodes[static_cast<std::size_t>(first)].position;
    made.axis_y = along.cross(Eigen::Vector3d(0.3, 0.2, 0.7)).normalized();
    return made;
  };
  model.beams = {beam("AB", 0, 1, 1.22), beam("BC", 1, 2, 1.31), beam("CD", 2, 3, 1.30)};
  model.beams[1].shear_stiffness_y = 2e4;
  model.beams[1].shear_stiffness_z = 4e4;
  model.beams[1].temperature_fraction = 0.5;
  model.beams[1].gradient_program = 1;
  model.beams[1].gradient_y = 3.0;
  model.beams[1].gradient_z = -2.0;
  model.beams[2].program = 1;
  model.beams[2].gradient_z = 4.0;
  measure_rotations(model);
  // Ends with releases and offsets.
  const std::size_t plain = model.beams.size();
  for (std::size_t k = 0; k < 6; ++k) model.beams.push_back(model.beams[k % plain]);
  model.beams[plain].name = "ball";
  model.beams[plain].released_second_x = true;
  model.beams[plain].released_second_y = model.beams[plain].released_second_z = true;
  model.beams[plain + 1].name = "hinge about z";
  model.beams[plain + 1].released_second_z = true;
  model.beams[plain + 2].name = "hinges about y and z";
  model.beams[plain + 2].released_first_y = model.beams[plain + 2].released_second_z = true;
  model.beams[plain + 3].name = "bar on arms";
  model.beams[plain + 3].released_first_x = true;
  model.beams[plain + 3].released_first_y = model.beams[plain + 3].released_first_z = true;
  model.beams[plain + 3].released_second_y = model.beams[plain + 3].released_second_z = true;
  model.beams[plain + 4].name = "arms";
  model.beams[plain + 5].name = "telescope";
  model.beams[plain + 5].released_second_axial = true;
  for (std::size_t k = plain + 3; k < model.beams.size(); ++k) {
    Beam& one = model.beams[k];
    one.offset_first = {0.1, -0.2, 0.05};
    one.offset_second = {-0.05, 0.1, 0.15};
    const Eigen::Vector3d along = model.nodes[static_cast<std::size_t>(one.second)].position -
                                  model.nodes[static_cast<std::size_t>(one.first)].position +
                                  one.offset_second - one.offset_first;
    one.axis_y = along.cross(Eigen::Vector3d(0.3, 0.2, 0.7)).normalized();
    one.stress_free_length = 1.02 * along.norm();
  }
  return model;
}

/// Bodies: one with rotations of some nodes and two thermal patterns, one with translations only,
/// and a bar. Their stiffness is that of random springs between points that move with the nodes, so
/// rigid motions cause no force.
inline Model sample(std::type_identity<CondensedBody>) {
  Model model = four_nodes();
  for (std::size_t n = 1; n < 4; ++n) {
    model.nodes[n].rotations = 3 - static_cast<int>(n);
    model.nodes[n].rotation_directions = model.nodes[1].free_directions;
  }
  const auto body = [&](const char* name, std::vector<bool> rotating) {
    CondensedBody made{name, {0, 1, 2, 3}, std::move(rotating), {}, {}, {}};
    std::vector<Eigen::Index> rows{0};
    for (const bool rotates : made.rotating) rows.push_back(rows.back() + (rotates ? 6 : 3));
    const Eigen::Index freedoms = rows.back();
    made.stiffness = Eigen::MatrixXd::Zero(freedoms, freedoms);
    // Each spring connects points fixed to two nodes.
    double number = 0.3;
    const auto next = [&] { return number = std::fmod(7.13 * number + 0.4137, 1.0); };
    for (int k = 0; k < 60; ++k) {
      const auto a = static_cast<std::size_t>(k % 4);
      const auto b = (a + 1 + static_cast<std::size_t>(k / 4 % 3)) % 4;
      Eigen::Vector3d arm_a(next() - 0.5, next() - 0.5, next() - 0.5);
      Eigen::Vector3d arm_b(next() - 0.5, next() - 0.5, next() - 0.5);
      if (!made.rotating[a]) arm_a.setZero();
      if (!made.rotating[b]) arm_b.setZero();
      const Eigen::Vector3d along =
          (model.nodes[b].position + arm_b - model.nodes[a].position - arm_a).normalized();
      Eigen::VectorXd row = Eigen::VectorXd::Zero(freedoms);
      row.segment<3>(rows[a]) -= along;
      row.segment<3>(rows[b]) += along;
      if (made.rotating[a]) row.segment<3>(rows[a] + 3) -= arm_a.cross(along);
      if (made.rotating[b]) row.segment<3>(rows[b] + 3) += arm_b.cross(along);
      made.stiffness += 1e4 * (0.5 + next()) * row * row.transpose();
    }
    for (const double scale : {2e-5, -1e-5}) {
      Eigen::VectorXd shape(freedoms);
      for (Eigen::Index i = 0; i < freedoms; ++i) shape[i] = scale * (next() - 0.5);
      made.patterns.push_back({static_cast<int>(made.patterns.size()), 0.7, shape});
    }
    return made;
  };
  model.bodies = {body("mixed", {true, true, false, true}),
                  body("translations", {false, false, false, false})};
  // A bar: its frame may roll.
  CondensedBody bar{"bar", {0, 2}, {false, false}, {}, {}, {}};
  const Eigen::Vector3d along = (model.nodes[2].position - model.nodes[0].position).normalized();
  Eigen::VectorXd row(6);
  row << -along, along;
  bar.stiffness = 1e4 * row * row.transpose();
  bar.patterns = {{0, 1.0, 1e-5 * row}};
  model.bodies.push_back(bar);
  measure_rotations(model);
  return model;
}

/// Rotates the axes of a body's matrices.
inline void turn_axes(CondensedBody& body, const Eigen::Matrix3d& turn) {
  const auto turn_rows = [&](auto&& rows) {
    for (Eigen::Index row = 0; row < rows.rows(); row += 3) {
      rows.template middleRows<3>(row) = (turn * rows.template middleRows<3>(row)).eval();
    }
  };
  turn_rows(body.stiffness);
  Eigen::MatrixXd transposed = body.stiffness.transpose();
  turn_rows(transposed);
  body.stiffness = transposed;
  for (ThermalPattern& pattern : body.patterns) turn_rows(pattern.free_shape);
}

/// Masses and moments of inertia for the elements of the samples.
inline Inertia sample_inertia() {
  Inertia made;
  made.link_mass = Eigen::Vector3d(1.0, 2.0, 4.0);
  made.link_moment = Eigen::Vector3d(0.1, 0.3, 0.2);
  made.link_centre.resize(2, 3);
  made.link_centre << 0.5, 0.4, 0.7, 0.0, 0.1, -0.2;
  return made;
}

/// Mass of all elements of a sample [kg].
inline double sample_mass(std::type_identity<Bar>) {
  return 7.0;
}
inline double sample_mass(std::type_identity<Spring>) {
  return 0.0;
}
inline double sample_mass(std::type_identity<TorsionSpring>) {
  return 0.0;
}
inline double sample_mass(std::type_identity<Beam>) {
  return 0.0;
}
inline double sample_mass(std::type_identity<CondensedBody>) {
  return 0.0;
}
inline double sample_mass(std::type_identity<SpinSpring>) {
  return 0.0;
}

}  // namespace statejump::truss::testing
