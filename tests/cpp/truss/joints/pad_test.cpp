// SPDX-License-Identifier: GPL-3.0-or-later
#include "gradients.hpp"
#include "samples.hpp"

namespace statejump::truss {
namespace {

TEST(Pad, GradientsAreThoseOfItsForces) {
  testing::JointSample sample = testing::sample(std::type_identity<Pad>());
  auto& pad = std::get<Pad>(sample.model.joints[0]);
  const detail::System system(sample.model);
  Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(system.unknowns(), 1e-5, 6e-5);
  z.segment<3>(system.dofs().at(3).row) += sample.touching;
  z.tail<3>() << 3.0, -2.0, 12.0;
  Eigen::VectorXd before = z;
  before[1] += 1e-5;
  before.tail<3>() << 1.0, 2.0, 10.0;
  // A slide of 1e-5 m, whose force of 8 N is beyond the limit, beside a slide far below it.
  for (const double friction : {0.3, 30.0, 0.0}) {
    pad.friction_coefficient = friction;
    check_gradients(sample.model, z, before,
                    {JointStatus::stick, JointStatus::slip_plus, JointStatus::open}, 1e-9, 1e-4);
  }
}

TEST(Pad, PlaneOnTheGroundGivesTheSameRows) {
  testing::JointSample sample = testing::sample(std::type_identity<Pad>());
  std::get<Pad>(sample.model.joints[0]).second = -1;
  sample.model.validate();
  const detail::System system(sample.model);
  Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(system.unknowns(), 1e-5, 6e-5);
  z.tail<3>() << 3.0, -2.0, 12.0;
  check_gradients(sample.model, z, z, {JointStatus::stick, JointStatus::slip_plus}, 1e-9, 1e-4);
}

}  // namespace
}  // namespace statejump::truss
