// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/model.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "statejump/kernel/require.hpp"

namespace statejump::truss {

namespace {

void check(bool holds, const std::string& item, const char* field, double value,
           const char* range) {
  if (!holds) throw kernel::OutOfRange(item, field, value, range);
}

void check_index(int i, std::size_t count, const std::string& item, const char* field) {
  check(i >= 0 && static_cast<std::size_t>(i) < count, item, field, i, "an existing item");
}

std::string named(const char* kind, const std::string& name) {
  return std::string(kind) + " '" + name + "'";
}

/// Smallest and largest ΔT of a program [K].
Eigen::Vector2d range_of(const thermal::Program& program) {
  Eigen::Vector2d range(0.0, 0.0);
  for (const auto& branch : thermal::monotone_branches(program)) {
    range[0] = std::min({range[0], branch.start, branch.end});
    range[1] = std::max({range[1], branch.start, branch.end});
  }
  return range;
}

/// Largest value of `per_kelvin` · ΔT over a program, downwards.
double lowest_strain(double per_kelvin, const Eigen::Vector2d& range) {
  return std::min(per_kelvin * range[0], per_kelvin * range[1]);
}

}  // namespace

void Model::validate() const {
  kernel::require(!programs.empty(), "number of programs", 0, ">= 1");
  std::vector<Eigen::Vector2d> ranges;
  for (const auto& program : programs) {
    program.validate();
    const double first = programs.front().duration();
    kernel::require(std::abs(program.duration() - first) <= same_time * first,
                    "duration of a program", program.duration(), "that of the first program [s]");
    ranges.push_back(range_of(program));
  }
  for (const Node& node : nodes) {
    const std::string item = named("node", node.name);
    check(node.position.allFinite(), item, "position", node.position.norm(), "finite [m]");
    check(node.load.allFinite(), item, "load", node.load.norm(), "finite [N]");
    check(node.freedoms >= 0 && node.freedoms <= 3, item, "freedoms", node.freedoms, "0 to 3");
    const Eigen::Matrix3d product = node.free_directions.transpose() * node.free_directions;
    for (int i = 0; i < node.freedoms; ++i) {
      for (int j = 0; j < node.freedoms; ++j) {
        check(std::abs(product(i, j) - (i == j ? 1.0 : 0.0)) < 1e-12, item,
              "product of free directions", product(i, j), "1 or, of different ones, 0");
      }
    }
  }
  const auto check_ends = [&](const std::string& item, int first, int second) {
    check_index(first, nodes.size(), item, "first node");
    check_index(second, nodes.size(), item, "second node");
    const double length = (nodes[static_cast<std::size_t>(second)].position -
                           nodes[static_cast<std::size_t>(first)].position)
                              .norm();
    check(length > 0.0, item, "length", length, "> 0 m: its nodes are at different places");
  };
  for (const Link& link : links) {
    const std::string item = named("link", link.name);
    check_ends(item, link.first, link.second);
    check_index(link.program, programs.size(), item, "program");
    check(std::isfinite(link.axial_stiffness) && link.axial_stiffness > 0, item, "axial_stiffness",
          link.axial_stiffness, "finite, > 0 N");
    check(std::isfinite(link.stress_free_length) && link.stress_free_length > 0, item,
          "stress_free_length", link.stress_free_length, "finite, > 0 m");
    check(std::isfinite(link.temperature_fraction), item, "temperature_fraction",
          link.temperature_fraction, "finite");
    const double strain = lowest_strain(link.thermal_expansion * link.temperature_fraction,
                                        ranges[static_cast<std::size_t>(link.program)]);
    check(std::isfinite(strain) && strain > -1, item, "thermal_expansion", link.thermal_expansion,
          "finite and such that a length is left [1/K]");
  }
  for (const AxialSpring& spring : springs) {
    const std::string item = named("spring", spring.name);
    check_ends(item, spring.first, spring.second);
    check(std::isfinite(spring.stiffness) && spring.stiffness >= 0, item, "stiffness",
          spring.stiffness, "finite, >= 0 N/m");
    check(std::isfinite(spring.free_length), item, "free_length", spring.free_length, "finite [m]");
  }
  const auto check_axis = [](const std::string& item, const Eigen::Vector3d& axis) {
    check(std::abs(axis.norm() - 1.0) < 1e-9, item, "length of the axis", axis.norm(), "1");
  };
  for (const TorsionSpring& spring : torsion_springs) {
    const std::string item = named("torsion spring", spring.name);
    check_index(spring.first_link, links.size(), item, "first link");
    if (spring.second_link != -1) {
      check_index(spring.second_link, links.size(), item, "second link");
      check(spring.second_link != spring.first_link, item, "second link", spring.second_link,
            "another than the first");
    }
    check(std::isfinite(spring.stiffness) && spring.stiffness >= 0, item, "stiffness",
          spring.stiffness, "finite, >= 0 N m/rad");
    check(std::isfinite(spring.free_angle), item, "free_angle", spring.free_angle, "finite [rad]");
    check_axis(item, spring.axis);
  }
  for (const Slider& slider : sliders) {
    const std::string item = named("slider", slider.name);
    check_index(slider.first, nodes.size(), item, "first node");
    if (slider.second != -1) {
      check_index(slider.second, nodes.size(), item, "second node");
      check(slider.second != slider.first, item, "second node", slider.second,
            "another than the first");
    }
    check_axis(item, slider.axis);
    check(std::isfinite(slider.friction_force) && slider.friction_force >= 0, item,
          "friction_force", slider.friction_force, "finite, >= 0 N");
    check(slider.clearance_minus >= 0, item, "clearance_minus", slider.clearance_minus, ">= 0 m");
    check(slider.clearance_plus >= 0, item, "clearance_plus", slider.clearance_plus, ">= 0 m");
    check(slider.tangential_stiffness > 0, item, "tangential_stiffness",
          slider.tangential_stiffness, "> 0 N/m");
  }
  for (const ClearanceRevolute& revolute : revolutes) {
    const std::string item = named("revolute", revolute.name);
    check_index(revolute.journal_node, nodes.size(), item, "journal node");
    check_index(revolute.bearing_node, nodes.size(), item, "bearing node");
    check(revolute.journal_node != revolute.bearing_node, item, "bearing node",
          revolute.bearing_node, "another than the journal's");
    const auto check_link = [&](int link, int node, const char* field) {
      if (link == -1) return;
      check_index(link, links.size(), item, field);
      const Link& part = links[static_cast<std::size_t>(link)];
      check(part.first == node || part.second == node, item, field, link,
            "a link that ends at the joint's node");
    };
    check_link(revolute.journal_link, revolute.journal_node, "journal link");
    check_link(revolute.bearing_link, revolute.bearing_node, "bearing link");
    check_index(revolute.program, programs.size(), item, "program");
    check(std::isfinite(revolute.journal_radius) && revolute.journal_radius > 0, item,
          "journal_radius", revolute.journal_radius, "finite, > 0 m");
    check(std::isfinite(revolute.radial_clearance) && revolute.radial_clearance > 0, item,
          "radial_clearance", revolute.radial_clearance, "finite, > 0 m");
    check(std::isfinite(revolute.friction_coefficient) && revolute.friction_coefficient >= 0, item,
          "friction_coefficient", revolute.friction_coefficient, "finite, >= 0");
    check(revolute.hertz_stiffness > 0, item, "hertz_stiffness", revolute.hertz_stiffness,
          "> 0 N/m^1.5");
    check(revolute.mindlin_stiffness > 0, item, "mindlin_stiffness", revolute.mindlin_stiffness,
          "> 0 N/m^1.5");
    check(std::isinf(revolute.mindlin_stiffness) || std::isfinite(revolute.hertz_stiffness), item,
          "mindlin_stiffness", revolute.mindlin_stiffness, "infinite, because hertz_stiffness is");
    check_axis(item, revolute.axis);
    const double growth =
        revolute.bearing_thermal_expansion * (revolute.journal_radius + revolute.radial_clearance) -
        revolute.journal_thermal_expansion * revolute.journal_radius;
    const double least = revolute.radial_clearance +
                         lowest_strain(growth * revolute.temperature_fraction,
                                       ranges[static_cast<std::size_t>(revolute.program)]);
    check(least > 0, item, "clearance at the program's worst temperature", least, "> 0 m");
  }
}

}  // namespace statejump::truss
