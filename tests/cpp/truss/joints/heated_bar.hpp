// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "../parts.hpp"

namespace statejump::truss::testing {

/// Bar of Table 1, fixed at one end. Heating pushes its other end against a joint on node 1, with
/// 1.26e6 N/m and 11.7 um/K.
inline Model heated_bar(Joint joint, double largest, int cycles) {
  Model model;
  model.programs = {triangle(largest)};
  model.programs[0].cycles = cycles;
  model.nodes = {node("held", 0, 0, 0), node("moved", 0.5, 0, 1)};
  model.links = {{"AB", 0, 1, 70e9 * 9e-6, 0.5, 23.4e-6, 0, 1.0}};
  model.joints = {std::move(joint)};
  return model;
}

}  // namespace statejump::truss::testing
