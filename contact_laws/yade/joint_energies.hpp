// SPDX-License-Identifier: GPL-3.0-or-later
// Entries of the joint contacts in O.energy. The law functors of all threads share them.
#pragma once

#include <array>
#include <atomic>
#include <mutex>

#include "statejump/stepper/contact.hpp"
#include "yade_api.hpp"

namespace statejump::dem {

class JointEnergies {
 public:
  void add(const yade::Scene& scene, const stepper::ContactEnergy& step);
  // Adds the names with value 0.
  void name(const yade::Scene& scene);

 private:
  std::array<int, 4> ids_ = {-1, -1, -1, -1};
  std::atomic<bool> named_{false};
  std::mutex naming_;
};

}  // namespace statejump::dem
