// SPDX-License-Identifier: GPL-3.0-or-later
// Entries of the joint contacts in O.energy. Laws run in several threads and share them.
#pragma once

#include <array>
#include <atomic>
#include <mutex>

#include "yade_api.hpp"

namespace statejump::dem {

class JointEnergies {
 public:
  // Values of one contact and one step [J]; elastic is what is stored now.
  struct Step {
    yade::Real elastic;
    yade::Real friction;
    yade::Real damping;
    yade::Real thermal_work;
  };
  void add(const yade::Scene& scene, const Step& step);

 private:
  void name(const yade::Scene& scene);
  std::array<int, 4> ids_ = {-1, -1, -1, -1};
  std::atomic<bool> named_{false};
  std::mutex naming_;
};

}  // namespace statejump::dem
