// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermal_step.hpp"

#include <utility>

namespace statejump::truss::detail {

namespace {

/// Abscissae and weights of the Gauss–Legendre quadrature of order 8 on (0, 1).
constexpr std::array<std::pair<double, double>, 4> gauss_legendre{
    {{0.069431844202973712, 0.17392742256872693},
     {0.33000947820757187, 0.32607257743127307},
     {0.66999052179242813, 0.32607257743127307},
     {0.93056815579702629, 0.17392742256872693}}};

}  // namespace

std::vector<Quadrature> quadratures(const Way& way, const Model& model) {
  std::vector<Quadrature> made;
  for (const thermal::Program& program : model.programs) {
    Quadrature of;
    const auto add = [&](double share, double when, double warmed) {
      of.points[of.count++] = {share, program.temperature_change(when), warmed};
    };
    if (way.is_straight()) {
      const double warmed =
          program.temperature_change(way.to_time) - program.temperature_change(way.from_time);
      add(0.0, way.from_time, 0.5 * warmed);
      add(1.0, way.to_time, 0.5 * warmed);
    } else {
      for (const auto& [share, weight] : gauss_legendre) {
        const double when = way.from_time + share * way.step();
        add(share, when, weight * way.step() * program.temperature_rate(when));
      }
    }
    made.push_back(of);
  }
  return made;
}

}  // namespace statejump::truss::detail
