// SPDX-License-Identifier: GPL-3.0-or-later
// Compares a contact driven along a path with independently written laws.
#include "statejump/kernel/laws/driven_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace statejump::kernel::laws {
namespace {

constexpr double young = 38.5e9, shear = 7.9e9, radius = 0.01, friction = 0.3;

DrivenContact contact_with(const JointLaw& law) {
  DrivenContact contact{law, {young, shear}, driven_geometry(radius, INFINITY, 0.01)};
  contact.law.friction_parameters.friction_coefficient = friction;
  return contact;
}

DrivenContact stuck() {
  JointLaw law;
  law.friction = MindlinFriction{};
  return contact_with(law);
}

double hertz_force(double depth) {
  return 4.0 / 3.0 * young * std::sqrt(radius * depth) * depth;
}

DrivenTarget at(double depth, double slide) {
  DrivenTarget target;
  target.depth = depth;
  target.slide_x = slide;
  return target;
}

TEST(DrivenContact, SpringThenSlideBothWays) {
  const DrivenContact contact = stuck();
  const double depth = 1e-6;
  const double stiffness = 8.0 * shear * std::sqrt(radius * depth);
  const double limit = friction * hertz_force(depth);
  const DrivenState begun = drive(contact, {}, at(depth, 0.0));
  EXPECT_NEAR(begun.normal_force, hertz_force(depth), 1e-14 * begun.normal_force);
  EXPECT_EQ(begun.tangential_force_x, 0.0);
  const double stick = 0.5 * limit / stiffness;
  const DrivenState held = drive(contact, begun, at(depth, stick));
  // positive in the direction of the slide
  EXPECT_NEAR(held.tangential_force_x, 0.5 * limit, 1e-13 * limit);
  EXPECT_NEAR(held.tangential_elastic_energy, 0.25 * limit * stick, 1e-13 * limit * stick);
  const DrivenState slid = drive(contact, held, at(depth, -10.0 * stick));
  EXPECT_NEAR(slid.tangential_force_x, -limit, 1e-13 * limit);
  EXPECT_TRUE(slid.history.slipping);
  EXPECT_GT(slid.friction_dissipation, 0.0);
}

TEST(DrivenContact, ForcesAreTurnedIntoDepthAndSlide) {
  const DrivenContact contact = stuck();
  const double depth = 2e-6;
  DrivenTarget target;
  target.normal_force = hertz_force(depth);
  const DrivenState begun = drive(contact, {}, target);
  EXPECT_NEAR(begun.depth, depth, 1e-14 * depth);
  for (const double force : {1e-9, 0.5, 1.0, 1e3}) {
    target.normal_force = force;
    EXPECT_NEAR(drive(contact, {}, target).normal_force, force, 1e-13 * force);
  }
  target.normal_force = hertz_force(depth);
  const double stiffness = 8.0 * shear * std::sqrt(radius * depth);
  const double limit = friction * hertz_force(depth);
  for (const double share : {0.3, -0.9, 1.0, -1.0}) {  // the limit itself can be reached
    target.tangential_force = share * limit;
    const DrivenState pulled = drive(contact, begun, target);
    EXPECT_NEAR(pulled.slide_x, share * limit / stiffness, 1e-12 * limit / stiffness);
    EXPECT_NEAR(pulled.tangential_force_x, share * limit, 1e-13 * limit);
  }
  target.tangential_force = 1.001 * limit;
  EXPECT_THROW(drive(contact, begun, target), std::domain_error);
  target.normal_force = 0.0;
  target.tangential_force = 0.0;
  const DrivenState let_go = drive(contact, begun, target);
  EXPECT_EQ(let_go.tangential_force_x, 0.0);
  EXPECT_EQ(let_go.normal_force, 0.0);
  EXPECT_EQ(let_go.depth, 0.0);
}

/// Slide before the contact closes (at depth 0) does not count. The contact is open during half of
/// each step of this path.
TEST(DrivenContact, LossAndReturnOfContact) {
  const DrivenContact contact = stuck();
  const double depth = 1e-6;
  const double stiffness = 8.0 * shear * std::sqrt(radius * depth);
  DrivenState state = drive(contact, {}, at(depth, 0.0));
  state = drive(contact, state, at(depth, 1e-8));
  EXPECT_NEAR(state.tangential_force_x, stiffness * 1e-8, 1e-13 * stiffness * 1e-8);
  state = drive(contact, state, at(-depth, 3e-8));
  EXPECT_EQ(state.normal_force, 0.0);
  EXPECT_EQ(state.tangential_force_x, 0.0);
  EXPECT_EQ(state.tangential_elastic_energy, 0.0);
  // dissipated: the energy of the spring, plus the work until the contact opens in the middle of
  // the step
  const double old = 0.5 * stiffness * 1e-16;
  EXPECT_NEAR(state.friction_dissipation, old + 0.5 * stiffness * 1e-8 * 1e-8, 1e-12 * old);
  state = drive(contact, state, at(depth, 3e-8));
  EXPECT_EQ(state.tangential_force_x, 0.0);
  state = drive(contact, state, at(-depth, 3e-8));
  state = drive(contact, state, at(depth, 5e-8));
  EXPECT_NEAR(state.tangential_force_x, stiffness * 1e-8, 1e-12 * stiffness * 1e-8);
}

/// Drives every law of the catalogue along one path. Forces stay within their bounds and no energy
/// is created.
template <class Law>
void leads(Law JointLaw::*member) {
  for (const std::string& name : law_names<Law>()) {
    JointLaw law;
    law.friction = MindlinFriction{};
    law.restitution = 0.5;
    law.*member = detail::Catalogue<Law>::find("law", name);
    DrivenContact contact = contact_with(law);
    contact.geometry = driven_geometry(radius, 1e-4, 0.01);
    validate(contact);
    DrivenState state;
    for (int i = 0; i <= 400; ++i) {
      DrivenTarget target = at(1e-6 * std::sin(0.05 * i), 2e-7 * std::sin(0.11 * i));
      target.slide_y = 1e-7 * std::cos(0.07 * i);
      target.duration = i > 0 ? 1e-6 : 0.0;
      const DrivenState next = drive(contact, state, target);
      EXPECT_GE(next.normal_force, 0.0) << name;
      EXPECT_LE(std::hypot(next.tangential_force_x, next.tangential_force_y),
                friction * next.normal_force * (1.0 + 1e-14))
          << name;
      EXPECT_GE(next.friction_dissipation, state.friction_dissipation) << name;
      EXPECT_GE(next.damping_dissipation, state.damping_dissipation) << name;
      state = next;
    }
  }
}

TEST(DrivenContact, EveryLawOfTheCatalogue) {
  leads(&JointLaw::normal);
  leads(&JointLaw::dissipation);
  leads(&JointLaw::friction);
}

TEST(DrivenContact, RadiiFromEffectiveRadiusAndClearance) {
  const NormalGeometry geometry = driven_geometry(0.255, 1e-4, 0.01);
  EXPECT_NEAR(geometry.journal_radius, 5e-3, 1e-16);  // R1 R2/(R2 - R1) = 5 mm x 5.1 mm/0.1 mm
  EXPECT_NEAR(geometry.clearance(), 1e-4, 1e-17);
  EXPECT_EQ(driven_geometry(0.01, INFINITY, 0.01).journal_radius, 0.01);
  EXPECT_THROW(driven_geometry(0.0, 1e-4, 0.01), OutOfRange);
  EXPECT_THROW(driven_geometry(0.01, 0.0, 0.01), OutOfRange);
  JointLaw line;
  line.normal = Johnson{};
  EXPECT_THROW(validate(contact_with(line)), OutOfRange);  // a line contact has no flat wall
}

}  // namespace
}  // namespace statejump::kernel::laws
