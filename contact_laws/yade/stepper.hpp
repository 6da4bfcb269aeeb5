// SPDX-License-Identifier: GPL-3.0-or-later
// Makes steps of a scene of joints ahead of YADE's own loop.
#pragma once

#include <vector>

#include "failure.hpp"
#include "registered.hpp"

namespace statejump::dem {

struct JointStepper : Registered<JointStepper, yade::GlobalEngine>, RaisesFailures {
  static constexpr const char* class_name = "JointStepper";
  static constexpr const char* base_name = "GlobalEngine";
  static constexpr const char* doc =
      "Makes most steps of a scene of joints, links and torsion springs itself, in arrays of plain "
      "numbers, and leaves one step in every substeps to the other engines: the same steps of "
      "O.dt, "
      "bit for bit on one thread, at a fraction of the cost. O.iter and O.time count them all, and "
      "O.run(n) still makes n. Place it right behind the ForceResetter; the other engines stay. "
      "They run where O.iter is a multiple of substeps, so a recorder whose iterPeriod is one "
      "records what it recorded without the stepper; what a recorder with another period sees is "
      "up to substeps - 1 steps late. A step in which something fails, or before which the "
      "collider has to look again, is left to the other engines, too: messages, times and new "
      "contacts are theirs. A scene with a body or an engine that it does not know is refused.";
  int substeps = 1000;

  JointStepper() { check(); }
  void action() override;
  void check() const;
  static auto attributes() {
    return std::make_tuple(attribute("substeps", &JointStepper::substeps,
                                     "Every how many steps all engines run, 1 or above [-]"));
  }

 private:
  // Returns whether YADE's own loop made the previous step with the same engines and number of
  // bodies. Contacts and names of energies then exist.
  bool follows_an_ordinary_step();
  long last_iteration_ = -1;
  const yade::Scene* last_scene_ = nullptr;
  std::size_t last_bodies_ = 0;
  std::vector<const yade::Engine*> last_engines_;
};

}  // namespace statejump::dem
