// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of joints constrained by links, for cost_of_checks.py. Arguments: JOINTS STEPS.
#include <cstdio>
#include <cstdlib>

#include "scenes.hpp"

int main(int count, char** range_text) {
  if (count != 3) return 2;
  namespace scenes = statejump::stepper::scenes;
  statejump::stepper::Scene scene = scenes::held_crowd(std::strtoul(range_text[1], nullptr, 10));
  scene.prepare();
  const long steps = std::atol(range_text[2]);
  const bool whole = scene.run(steps, scenes::maker()) == steps;
  std::printf("%.17g\n", scene.bodies[1].motion.position[0]);  // equal with and without checks
  return whole && scene.has_finite_state() ? 0 : 1;
}
