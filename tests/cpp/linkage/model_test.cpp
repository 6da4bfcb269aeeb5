// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/linkage/model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "umbrella.hpp"

namespace statejump::linkage {
namespace {

constexpr double degree = 3.14159265358979323846 / 180.0;

TEST(Linkage, StandsWhereTheProjectSays) {
  const Linkage model = umbrella();
  const State state = initial_state(model, Start::rest, 0.0);
  const Coordinates q = coordinates(model, state);
  // Half a unit of the last digit that the project publishes.
  EXPECT_NEAR(state.bearing_centre.x(), 28.750e-3, 5e-9);
  EXPECT_NEAR(state.bearing_centre.y(), 40.907670e-3, 5e-10);
  EXPECT_NEAR(q.theta2, 54.900368 * degree, 5e-7 * degree);
  EXPECT_NEAR(q.theta4, 155.853152 * degree, 5e-7 * degree);
  EXPECT_NEAR(q.length_ab, 0.050, 1e-16);
  EXPECT_NEAR(q.length_bc, 0.100, 1e-16);
  EXPECT_NEAR(model.free_angle(), q.theta4 - q.theta2, 1e-14);
  EXPECT_EQ(q.eccentricity.norm(), 0.0);
  EXPECT_NEAR(q.centroid_bc.x(), 0.5 * (0.120 + 28.750e-3), 5e-9);
  EXPECT_LT(energy(model, state, 0.0).sum(), 1e-20);
}

TEST(Linkage, FirstContactInClosedForm) {
  EXPECT_NEAR(first_contact_temperature(umbrella(0.05e-3)), 17.5439, 5e-5);
  EXPECT_NEAR(first_contact_temperature(umbrella(0.20e-3)), 70.1754, 5e-5);
  Linkage grows = umbrella();
  grows.journal_thermal_expansion = grows.bearing_thermal_expansion = alpha;
  // α ΔT a = c (1 + α ΔT)
  EXPECT_NEAR(first_contact_temperature(grows), 1e-4 / (alpha * (frame - 1e-4)), 1e-9);
  grows.bearing_thermal_expansion = 1e-2;
  EXPECT_TRUE(std::isinf(first_contact_temperature(grows)));
}

void expect_refused(const Linkage& model, const std::string& text) {
  try {
    model.validate();
    FAIL() << "accepted, expected: " << text;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
  }
}

TEST(Linkage, RefusesWhatIsOutOfRange) {
  Linkage model = umbrella();
  model.frame_length = 0.2;
  expect_refused(model, "frame_length = 0.2");
  model = umbrella();
  model.link_bc.mass = 0.0;
  expect_refused(model, "link_bc.mass = 0,");
  model = umbrella(-1e-5);
  expect_refused(model, "bearing_radius = 0.00499");
  model = umbrella();
  model.axial_damping_ratio = -0.1;
  expect_refused(model, "axial_damping_ratio = -0.1");
  model = umbrella();
  model.torsion_free_angle = 4.0;
  expect_refused(model, "torsion_free_angle = 4");
}

}  // namespace
}  // namespace statejump::linkage
