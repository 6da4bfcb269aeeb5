// SPDX-License-Identifier: GPL-3.0-or-later
// The corotational beam: forces against the energy, tangent against the forces, balance,
// invariance.
#include "statejump/kernel/beam.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <type_traits>
#include <utility>

namespace statejump::kernel {

namespace {

using Vector12 = BeamStep::Vector12;
using Matrix12 = BeamStep::Matrix12;

constexpr double drawn_length = 1.3;

Beam beam_of(bool shears) {
  Beam made;
  made.axial = 900.0;
  made.torsional = 40.0;
  made.bending = {70.0, 110.0};
  if (shears) made.shear = {400.0, 700.0};
  made.triad = Quaternion(0.8, -0.3, 0.4, 0.2).normalized().toRotationMatrix();
  return made;
}

/// Ends of a beam, moved and rotated by up to `by`, with the whole beam rotated by `whole`.
struct Ends {
  std::array<Vector3, 2> place;
  std::array<Quaternion, 2> rotation;
  double free_length = drawn_length;
  std::array<double, 2> curvature{{0.0, 0.0}};

  BeamState state() const {
    BeamState made;
    made.along = place[1] - place[0];
    made.stretch = made.along.norm() - free_length;
    made.first = rotation[0];
    made.second = rotation[1];
    made.free_length = free_length;
    made.curvature = curvature;
    return made;
  }
  Ends moved(int dof, double by) const {
    Ends made = *this;
    const auto end = static_cast<std::size_t>(dof / 6);
    const Vector3 unit = Vector3::Unit(dof % 3);
    if (dof % 6 < 3) {
      made.place[end] += by * unit;
    } else {
      made.rotation[end] = rotation_of(by * unit) * made.rotation[end];
    }
    return made;
  }
};

Ends random_ends(const Beam& beam, double by, std::mt19937& random) {
  std::uniform_real_distribution<double> between(-1.0, 1.0);
  const auto vector = [&] { return Vector3(between(random), between(random), between(random)); };
  const Quaternion whole = rotation_of(3.0 * vector());
  Ends made;
  const Vector3 start = vector();
  made.place = {start, start + whole * (drawn_length * beam.triad.col(0) + by * vector())};
  made.rotation = {whole * rotation_of(by * vector()), whole * rotation_of(by * vector())};
  made.free_length = drawn_length * (1.0 + 0.1 * between(random));
  made.curvature = {0.3 * between(random), 0.3 * between(random)};
  return made;
}

/// Sixth-order central difference of `of(step)`.
template <class Of>
auto difference(double h, Of&& of) -> decltype(of(h)) {
  using Value = decltype(of(h));
  const Value far = of(3 * h) - of(-3 * h);
  const Value middle = of(2 * h) - of(-2 * h);
  const Value near = of(h) - of(-h);
  return (far - 9.0 * middle + 45.0 * near) / (60.0 * h);
}

template <class Use>
void for_many_states(Use&& use) {
  std::mt19937 random(7);
  for (const bool shears : {false, true}) {
    const Beam beam = beam_of(shears);
    for (const double by : {1e-6, 0.1, 0.4}) {
      for (int repeat = 0; repeat < 20; ++repeat) use(beam, random_ends(beam, by, random));
    }
  }
}

using Releases = std::array<std::array<bool, 3>, 2>;

/// Beams with released ends: one or both planes at one end, one at each, a bar, and others.
template <class Use>
void for_many_releases(Use&& use) {
  struct Case {
    Releases released;
    std::array<double, 2> roll;
    bool axial = true;
  };
  const std::array<Case, 9> cases{
      {{{{{false, true, false}, {false, false, false}}}, {{0.5, 0.5}}},
       {{{{false, false, true}, {false, false, false}}}, {{0.0, 1.0}}},
       {{{{false, true, true}, {false, false, false}}}, {{0.0, 1.0}}},
       {{{{false, false, false}, {true, true, true}}}, {{1.0, 0.0}}},
       {{{{false, true, false}, {false, true, false}}}, {{0.3, 0.7}}},
       {{{{false, true, false}, {false, false, true}}}, {{1.0, 0.0}}},
       {{{{false, true, true}, {false, true, true}}}, {{0.5, 0.5}}},
       {{{{true, true, true}, {false, true, true}}}, {{0.5, 0.5}}},
       {{{{false, false, true}, {false, false, false}}}, {{0.0, 1.0}}, false}}};
  std::mt19937 random(11);
  for (const Case& one : cases) {
    for (const bool shears : {false, true}) {
      Beam beam = beam_of(shears);
      beam.released = one.released;
      beam.roll = one.roll;
      if (!one.axial) beam.axial = 0.0;
      for (const double by : {1e-6, 0.1}) {
        for (int repeat = 0; repeat < 5; ++repeat) use(beam, random_ends(beam, by, random));
      }
    }
  }
}

}  // namespace

// Differences of the energy have an error of 1e-16 W/h + h⁶: 1e-11 of the largest force.
TEST(Beam, ForcesAreTheGradientOfTheEnergy) {
  const auto check = [](const Beam& beam, const Ends& ends) {
    const Vector12 force = beam_step(beam, ends.state()).gradient();
    const double scale = std::max(1.0, force.lpNorm<Eigen::Infinity>());
    for (int i = 0; i < 12; ++i) {
      const double by_energy = difference(
          2e-3, [&](double h) { return BeamStep(beam, ends.moved(i, h).state()).energy(); });
      EXPECT_NEAR(force[i], by_energy, 1e-10 * scale) << i;
    }
  };
  for_many_states(check);
  for_many_releases(check);
}

TEST(Beam, TangentIsTheDerivativeOfTheForces) {
  const auto check = [](const Beam& beam, const Ends& ends) {
    const Matrix12 tangent = BeamStep(beam, ends.state()).tangent();
    const double scale = tangent.lpNorm<Eigen::Infinity>();
    for (int j = 0; j < 12; ++j) {
      const Vector12 by_force = difference(1e-3, [&](double h) -> Vector12 {
        return BeamStep(beam, ends.moved(j, h).state()).gradient();
      });
      EXPECT_LT((tangent.col(j) - by_force).lpNorm<Eigen::Infinity>(), 1e-11 * scale) << j;
    }
  };
  for_many_states(check);
  for_many_releases(check);
}

TEST(Beam, DerivativesByTheStressFreeShape) {
  const auto check = [](const Beam& beam, const Ends& ends) {
    const BeamStep at(beam, ends.state());
    const auto with = [&](double length, double second, double third) {
      Ends made = ends;
      made.free_length += length;
      made.curvature[0] += second;
      made.curvature[1] += third;
      return BeamStep(beam, made.state());
    };
    const auto energy = [](const BeamStep& one) { return one.energy(); };
    const auto force = [](const BeamStep& one) { return one.gradient(); };
    const auto by = [&](auto&& of, double length, double second, double third) {
      using Value = std::decay_t<decltype(of(at))>;
      return difference(
          1e-3, [&](double h) -> Value { return of(with(h * length, h * second, h * third)); });
    };
    const double scale = at.tangent().lpNorm<Eigen::Infinity>();
    EXPECT_NEAR(at.by_length(), by(energy, 1, 0, 0), 1e-10 * scale);
    EXPECT_NEAR(at.by_curvature(0), by(energy, 0, 1, 0), 1e-10 * scale);
    EXPECT_NEAR(at.by_curvature(1), by(energy, 0, 0, 1), 1e-10 * scale);
    EXPECT_LT((at.gradient_by_length() - by(force, 1, 0, 0)).norm(), 1e-10 * scale);
    EXPECT_LT((at.gradient_by_curvature(0) - by(force, 0, 1, 0)).norm(), 1e-10 * scale);
    EXPECT_LT((at.gradient_by_curvature(1) - by(force, 0, 0, 1)).norm(), 1e-10 * scale);
  };
  for_many_states(check);
  for_many_releases(check);
}

// Forces, and moments about the first end, balance to rounding: some 1e-16 of the largest force.
TEST(Beam, ForcesAndMomentsBalance) {
  const auto check = [](const Beam& beam, const Ends& ends) {
    const Vector12 force = BeamStep(beam, ends.state()).gradient();
    const double scale = force.lpNorm<Eigen::Infinity>();
    const Vector3 arm = ends.place[1] - ends.place[0];
    EXPECT_LT((force.segment<3>(0) + force.segment<3>(6)).norm(), 1e-14 * scale);
    EXPECT_LT((force.segment<3>(3) + force.segment<3>(9) + cross(arm, force.segment<3>(6))).norm(),
              2e-14 * scale);
  };
  for_many_states(check);
  for_many_releases(check);
}

/// Everything rotated about the origin.
Ends rotated(const Ends& ends, const Quaternion& by) {
  Ends made = ends;
  for (std::size_t i = 0; i < 2; ++i) {
    made.place[i] = by * ends.place[i];
    made.rotation[i] = by * ends.rotation[i];
  }
  return made;
}

// A quaternion of 1000 rad carries the rounding 1e-13 of its angle, which is that of a rigid
// rotation too.
TEST(Beam, RigidRotationRotatesTheForces) {
  for (const double angle : {1e-3, 1.0, 3.1, 1000.0}) {
    const Quaternion by = rotation_of(angle * Vector3(0.48, -0.6, 0.64));
    for_many_states([&](const Beam& beam, const Ends& ends) {
      const BeamStep before(beam, ends.state());
      const BeamStep after(beam, rotated(ends, by).state());
      const double scale = beam.axial;
      EXPECT_NEAR(before.energy(), after.energy(), 1e-13 * scale);
      for (int k = 0; k < 4; ++k) {
        const Vector3 expected = by * Vector3(before.gradient().segment<3>(3 * k));
        EXPECT_LT((expected - after.gradient().segment<3>(3 * k)).norm(), 1e-12 * scale);
      }
    });
  }
}

TEST(Beam, RigidMotionHasNoForce) {
  const Beam beam = beam_of(true);
  Ends ends;
  ends.place = {Vector3(0.3, -0.2, 0.7),
                Vector3(0.3, -0.2, 0.7) + drawn_length * beam.triad.col(0)};
  ends.rotation = {Quaternion::Identity(), Quaternion::Identity()};
  for (const double angle : {0.5, 3.1, 1000.0}) {
    const Ends at = rotated(ends, rotation_of(angle * Vector3(0.48, -0.6, 0.64)));
    EXPECT_LT(BeamStep(beam, at.state()).gradient().norm(), 1e-12 * beam.axial);
  }
}

// A released moment is zero. Both released planes and a released torsion make a bar: its force does
// not depend on the rotations of its nodes, however large.
TEST(Beam, ReleasedEndsTransmitNoMoment) {
  for_many_releases([](const Beam& beam, const Ends& ends) {
    const BeamStep at(beam, ends.state());
    const Vector12 force = at.gradient_in_frame();
    for (std::size_t end = 0; end < 2; ++end) {
      const auto row = 6 * static_cast<Eigen::Index>(end) + 3;
      const bool has_torsion = !beam.released[0][0] && !beam.released[1][0];
      if (has_torsion || !beam.released[end][1] || !beam.released[end][2]) continue;
      EXPECT_EQ(force.segment<3>(row).norm(), 0.0);
    }
    const bool is_bar = beam.released[0][0] && beam.released[1][1] && beam.released[1][2];
    if (!is_bar) return;
    EXPECT_LT(force.segment(1, 5).norm() + force.tail(5).norm(), 1e-12 * beam.axial);
    Ends other = ends;
    other.rotation[0] = rotation_of(Vector3(1.0, -2.0, 2.0)) * other.rotation[0];
    other.rotation[1] = rotation_of(Vector3(-2.5, 0.3, 1.0)) * other.rotation[1];
    const BeamStep spun(beam, other.state());
    EXPECT_NEAR(spun.tension(), at.tension(), 1e-12 * beam.axial);
    EXPECT_NEAR(spun.energy(), at.energy(), 1e-12 * beam.axial);
    EXPECT_LE(spun.largest_local_rotation(), BeamStep::largest_rotation);
  });
}

// Cantilever with a hinge at its tip: 3 E I/l³ (1 + Φ/4)⁻¹ against a transverse force.
TEST(Beam, HingedEndHasTheStiffnessOfAProppedCantilever) {
  for (const bool shears : {false, true}) {
    Beam beam = beam_of(shears);
    beam.triad.setIdentity();
    beam.released = {{{false, false, false}, {false, true, true}}};
    beam.roll = {{1.0, 0.0}};
    BeamState at;
    at.along = {drawn_length, 0.0, 0.0};
    at.free_length = drawn_length;
    const Matrix12 tangent = BeamStep(beam, at).tangent();
    const double cube = drawn_length * drawn_length * drawn_length;
    for (const std::size_t k : {0u, 1u}) {
      const double phi = 12.0 * beam.bending[k] / (beam.shear[k] * drawn_length * drawn_length);
      const auto row = static_cast<Eigen::Index>(k == 0 ? 8 : 7);
      const double expected = 3.0 * beam.bending[k] / cube / (1.0 + 0.25 * phi);
      EXPECT_NEAR(tangent(row, row), expected, 1e-13 * beam.axial);
    }
    EXPECT_LT(tangent.bottomRightCorner(2, 2).norm(), 1e-13 * beam.axial);
  }
}

// The ends are equivalent: exchanged, with the axes 1 and 3 reversed, the beam has the same forces.
TEST(Beam, EndsAreEquivalent) {
  for_many_states([](const Beam& beam, const Ends& ends) {
    Beam reversed = beam;
    reversed.triad.col(0) *= -1.0;
    reversed.triad.col(2) *= -1.0;
    Ends other = ends;
    std::swap(other.place[0], other.place[1]);
    std::swap(other.rotation[0], other.rotation[1]);
    // About axis 2 the curvature changes its sign with the direction of the beam; about axis 3 axis
    // and direction change.
    other.curvature[0] *= -1.0;
    const Vector12 force = BeamStep(beam, ends.state()).gradient();
    const Vector12 same = BeamStep(reversed, other.state()).gradient();
    const double scale = force.lpNorm<Eigen::Infinity>();
    EXPECT_LT((force.head<6>() - same.tail<6>()).norm(), 1e-13 * scale);
    EXPECT_LT((force.tail<6>() - same.head<6>()).norm(), 1e-13 * scale);
  });
}

// Small displacements: the stiffness of the Timoshenko beam.
TEST(Beam, SmallDisplacementsHaveTheStiffnessOfATimoshenkoBeam) {
  Beam beam = beam_of(true);
  beam.triad.setIdentity();
  BeamState at;
  at.along = drawn_length * Vector3::UnitX();
  at.free_length = drawn_length;
  const Matrix12 k = BeamStep(beam, at).tangent();
  const double l = drawn_length;
  const double shear = 12.0 * beam.bending[1] / (beam.shear[1] * l * l);
  const double ei = beam.bending[1] / (1.0 + shear);
  EXPECT_NEAR(k(0, 0), beam.axial / l, 1e-12 * beam.axial);
  EXPECT_NEAR(k(3, 3), beam.torsional / l, 1e-12 * beam.axial);
  EXPECT_NEAR(k(7, 7), 12.0 * ei / (l * l * l), 1e-12 * beam.axial);
  EXPECT_NEAR(k(7, 11), -6.0 * ei / (l * l), 1e-12 * beam.axial);
  EXPECT_NEAR(k(5, 5), (4.0 + shear) * ei / l, 1e-12 * beam.axial);
  EXPECT_NEAR(k(5, 11), (2.0 - shear) * ei / l, 1e-12 * beam.axial);
  EXPECT_LT((k - k.transpose()).norm(), 1e-12 * beam.axial);
}

// Rates of the modes against differences of the local rotations; forces on the modes do the work of
// their balance. Rounding grows with the velocities, of order 1, over the length.
TEST(Beam, RatesAndForcesOfItsModesAreDual) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> between(-1.0, 1.0);
  for_many_states([&](const Beam& beam, const Ends& ends) {
    const BeamStep step = beam_step(beam, ends.state());
    Vector12 velocities;
    for (auto& one : velocities) one = between(random);
    const auto moved = [&](double time) {
      Ends made = ends;
      for (std::size_t end = 0; end < 2; ++end) {
        const auto row = 6 * static_cast<Eigen::Index>(end);
        made.place[end] += time * velocities.segment<3>(row);
        made.rotation[end] =
            rotation_of(time * velocities.segment<3>(row + 3)) * ends.rotation[end];
      }
      const BeamStep at(beam, made.state());
      const Vector3 first = at.local_rotation(0), second = at.local_rotation(1);
      BeamStep::Vector6 modes;
      modes << at.length(), 0.5 * (first.tail<2>() - second.tail<2>()),
          0.5 * (first.tail<2>() + second.tail<2>()), second.x() - first.x();
      return modes;
    };
    const BeamStep::Vector6 rates = step.mode_rates(velocities);
    EXPECT_LT((rates - difference(1e-3, moved)).norm(), 1e-11);
    BeamStep::Vector6 forces;
    for (auto& one : forces) one = between(random);
    const Vector12 balance = step.to_world(step.balance_in_frame(forces));
    EXPECT_NEAR(balance.dot(velocities), forces.dot(rates), 1e-13);
  });
}

TEST(Beam, RefusesLargeLocalRotations) {
  const Beam beam = beam_of(false);
  Ends ends;
  ends.place = {Vector3::Zero(), drawn_length * beam.triad.col(0)};
  ends.rotation = {rotation_of(1.01 * beam.triad.col(0)), Quaternion::Identity()};
  EXPECT_NO_THROW(beam_step(beam, ends.moved(3, 0.0).state())) << "twist is shared by both ends";
  ends.rotation = {rotation_of(1.01 * beam.triad.col(2)), Quaternion::Identity()};
  try {
    beam_step(beam, ends.state());
    FAIL();
  } catch (const OutOfRange& refused) {
    EXPECT_NEAR(refused.number(), 1.01, 1e-12);
    EXPECT_EQ(refused.range(), "at most 1 rad; divide the beam into more elements");
  }
  ends.rotation[0] = rotation_of(0.99 * beam.triad.col(2));
  EXPECT_NO_THROW(beam_step(beam, ends.state()));
}

TEST(Rotation, MapsAreInverseToEachOther) {
  for (const double angle :
       {0.0, 1e-9, 1e-3, 0.5, 0.999999, 1.000001, 1.999999, 2.000001, 3.0, 5.0}) {
    const Vector3 vector = angle * Vector3(0.48, -0.6, 0.64);
    EXPECT_LT((spin_map(vector) * inverse_spin_map(vector) - Matrix3::Identity()).norm(), 1e-14);
    // The map gives the spin of a changing rotation vector.
    const Vector3 rate(0.3, 0.5, -0.2);
    const Matrix3 spin = difference(1e-3, [&](double h) -> Matrix3 {
      return rotation_of(vector + h * rate).toRotationMatrix() *
             rotation_of(vector).toRotationMatrix().transpose();
    });
    EXPECT_LT((spin - skew(spin_map(vector) * rate)).norm(), 1e-12) << angle;
    const Vector3 n(0.7, -0.1, 0.4);
    for (int j = 0; j < 3; ++j) {
      const Vector3 unit = Vector3::Unit(j);
      const Vector3 map = difference(
          1e-3, [&](double h) -> Vector3 { return spin_map(vector + h * unit).transpose() * n; });
      EXPECT_LT((map - spin_map_derivative(vector, n).col(j)).norm(), 1e-12) << angle;
      const Vector3 inverse = difference(1e-3, [&](double h) -> Vector3 {
        return inverse_spin_map(vector + h * unit).transpose() * n;
      });
      EXPECT_LT((inverse - inverse_spin_map_derivative(vector, n).col(j)).norm(), 1e-12) << angle;
    }
  }
}

TEST(Rotation, VectorOfAMatrix) {
  for (const double angle : {0.0, 1e-12, 1e-3, 1.0, 2.0, 3.1}) {
    const Vector3 vector = angle * Vector3(0.48, -0.6, 0.64);
    const Vector3 found = rotation_vector(rotation_of(vector).toRotationMatrix());
    EXPECT_LT((found - vector).norm(), 1e-14 + 1e-13 * angle) << angle;
  }
}

}  // namespace statejump::kernel
