// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>

#include "statejump/thermal/program.hpp"
#include "statejump/truss/path.hpp"

namespace statejump::truss::testing {

/// The bar of Table 1, held at one end, that heating pushes against a joint on node 1: 1.26e6 N/m,
/// 11.7 um/K.
inline Model heated_bar(Joint joint, double largest, int cycles) {
  Model model;
  thermal::Program program;
  program.shape = thermal::Shape::triangle;
  program.temperature_change_max = largest;
  program.period = 1.0;
  program.cycles = cycles;
  model.programs = {program};
  Node held;
  held.name = std::string("held");
  held.freedoms = 0;
  Node moved;
  moved.name = std::string("moved");
  moved.position = {0.5, 0.0, 0.0};
  moved.freedoms = 1;
  model.nodes = {held, moved};
  model.links = {{"AB", 0, 1, 70e9 * 9e-6, 0.5, 23.4e-6, 0, 1.0}};
  model.joints = {std::move(joint)};
  return model;
}

}  // namespace statejump::truss::testing
