// SPDX-License-Identifier: GPL-3.0-or-later
// Building blocks of trusses for tests.
#pragma once

#include <string>

#include "statejump/thermal/program.hpp"
#include "statejump/truss/path.hpp"

namespace statejump::truss::testing {

/// Program of a single triangle.
inline thermal::Program triangle(double largest, double seconds = 1.0) {
  thermal::Program program;
  program.shape = thermal::Shape::triangle;
  program.temperature_change_max = largest;
  program.period = seconds;
  return program;
}

/// @param freedoms number of free directions, taken in the order x, y, z
inline Node node(const std::string& name, const Eigen::Vector3d& position, int freedoms) {
  Node made;
  made.name = name;
  made.position = position;
  made.freedoms = freedoms;
  return made;
}

inline Node node(const std::string& name, double x, double y, int freedoms) {
  return node(name, {x, y, 0.0}, freedoms);
}

/// Joint of a rib of two bars. The tip of the first bar (link 0, node 2) is the bearing, that of
/// the second (link 1, node 3) the journal. Radius 5 mm, clearance 0.1 mm, frictionless, rigid.
inline ClearanceRevolute rib_joint() {
  ClearanceRevolute joint;
  joint.name = std::string("joint");
  joint.bearing_node = 2;
  joint.journal_node = 3;
  joint.bearing_link = 0;
  joint.journal_link = 1;
  joint.journal_radius = 5e-3;
  joint.radial_clearance = 1e-4;
  return joint;
}

/// Bar of Table 1 on a block that slides on the ground, with 30 N of friction and no stops.
inline Model sliding_bar(double seconds = 1.0) {
  Model model;
  model.programs = {triangle(100.0, seconds)};
  model.nodes = {node("A", 0, 0, 0), node("B", 0.5, 0, 1)};
  model.links = {{"AB", 0, 1, 70e9 * 9e-6, 0.5, 23.4e-6, 0, 1.0}};
  Slider slider;
  slider.name = std::string("S");
  slider.first = 1;
  slider.friction_force = 30.0;
  model.joints = {slider};
  return model;
}

/// Replaces the links of a model by soft beams, which rotate its nodes.
inline void bend_links(Model& model) {
  for (const Bar& link : model.links) {
    Beam beam;
    beam.name = link.name;
    beam.first = link.first;
    beam.second = link.second;
    const Eigen::Vector3d along = model.nodes[static_cast<std::size_t>(link.second)].position -
                                  model.nodes[static_cast<std::size_t>(link.first)].position;
    beam.axial_stiffness = 1e2;
    beam.torsional_stiffness = beam.bending_stiffness_y = beam.bending_stiffness_z = 0.1;
    beam.stress_free_length = along.norm();
    beam.axis_y = Eigen::Vector3d::UnitZ().cross(along).normalized();
    model.beams.push_back(beam);
  }
  model.links.clear();
  measure_rotations(model);
}

}  // namespace statejump::truss::testing
