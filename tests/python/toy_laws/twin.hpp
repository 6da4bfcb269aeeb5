// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "statejump/kernel/laws/dissipation.hpp"

/// Hunt and Crossley's law under another name. The same source must give the same bits.
struct Twin {
  static constexpr statejump::kernel::laws::LawInfo info{
      "twin",
      "chi = 3/2 K (1 - e)/v0",
      "the tests",
      "as hunt_crossley",
      statejump::kernel::laws::Trait::holds_static_load,
      {&statejump::kernel::laws::parameter::restitution}};
  double operator()(const statejump::kernel::laws::ImpactParameters& impact) const {
    return 1.5 * (1.0 - impact.restitution) / impact.impact_speed;
  }
};

using UserLaw = Twin;
