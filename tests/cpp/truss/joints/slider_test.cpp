// SPDX-License-Identifier: GPL-3.0-or-later
#include "gradients.hpp"
#include "statejump/thermal/program.hpp"

namespace statejump::truss {
namespace {

TEST(Slider, GradientsAreThoseOfItsForces) {
  Model model;
  thermal::Program program;
  program.period = 1.0;
  model.programs = {program};
  Node carrier;
  carrier.name = "carrier";
  Node block;
  block.name = "block";
  block.position = {0.1, 0.0, 0.0};
  model.nodes = {carrier, block};
  // A link that defines the stiffness scale for rounding errors.
  model.links = {{"link", 0, 1, 1e2, 0.1, 0.0, 0, 1.0}};
  Slider slider;
  slider.name = "S";
  slider.first = 1;
  slider.second = 0;
  slider.axis = Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0;
  slider.friction_force = 30.0;
  slider.clearance_minus = 1e-4;
  slider.clearance_plus = 2e-4;
  const double rigid = std::numeric_limits<double>::infinity();
  // For partial slip: z is a slide of 1.5 times the gross slip 30 N/(1e7 N/m), or a fraction of it,
  // away from `before`.
  const auto check = [&](const std::vector<JointStatus>& statuses) {
    model.joints = {slider};
    const detail::System system(model);
    Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(system.unknowns(), 1e-5, 6e-5);
    z[6] = 12.0;
    Eigen::VectorXd before = z;
    before[1] += 1e-5;
    check_gradients(model, z, before, statuses, 1e-8, 1e-4);
  };
  const std::tuple<double, int> laws[] = {{1e7, 0}, {rigid, 0}, {1e7, 1}, {3e6, 1}};
  for (const auto& [stiffness, partial_slip] : laws) {
    slider.tangential_stiffness = stiffness;
    slider.partial_slip = partial_slip;
    check({JointStatus::stick, JointStatus::slip_plus, JointStatus::slip_minus,
           JointStatus::stop_plus, JointStatus::stop_minus});
  }
  // In the state z the soft stop on the plus side is compressed. The plays below are smaller or
  // larger than this compression.
  slider.partial_slip = 0;
  slider.tangential_stiffness = 1e7;
  slider.clearance_minus = slider.clearance_plus = 1e-6;
  slider.stop_stiffness = 3e6;
  for (const double play : {0.0, 1e-4, 1e-6}) {
    slider.play = play;
    check({JointStatus::stick, JointStatus::slip_plus, JointStatus::slip_minus});
  }
}

}  // namespace
}  // namespace statejump::truss
