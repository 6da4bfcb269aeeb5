// SPDX-License-Identifier: GPL-3.0-or-later
// Frames of beams in equilibrium, by Newton's method on left spins, against closed forms and
// published numbers. Tolerances follow from the order of convergence, which the tests measure.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "statejump/kernel/beam.hpp"

namespace statejump::kernel {

namespace {

constexpr double pi = 3.14159265358979323846;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Beams between nodes with 6 dofs.
struct Frame {
  struct Joint {
    Vector3 drawn;
    std::array<bool, 6> held{};
    Vector6 load = Vector6::Zero();  // moments keep their direction in space
    Vector3 place = drawn;
    Quaternion rotation = Quaternion::Identity();
  };
  struct Member {
    int first, second;
    Beam beam;
    double free_length;
    std::array<double, 2> curvature{{0.0, 0.0}};
  };
  std::vector<Joint> joints;
  std::vector<Member> members;

  int node(const Vector3& at, std::array<bool, 6> held = {}) {
    Joint made;
    made.drawn = made.place = at;
    made.held = held;
    joints.push_back(made);
    return static_cast<int>(joints.size()) - 1;
  }
  /// @param second_axis a vector in the plane of axes 1 and 2
  Member& member(int first, int second, Beam beam, const Vector3& second_axis) {
    const Vector3 along = of(second).drawn - of(first).drawn;
    const Vector3 e1 = along.normalized();
    const Vector3 e3 = cross(e1, second_axis).normalized();
    beam.triad << e1, cross(e3, e1), e3;
    members.push_back({first, second, beam, along.norm()});
    return members.back();
  }
  Joint& of(int node) { return joints[static_cast<std::size_t>(node)]; }
  const Joint& of(int node) const { return joints[static_cast<std::size_t>(node)]; }

  BeamStep step(const Member& member) const {
    BeamState at;
    at.along = of(member.second).place - of(member.first).place;
    at.stretch = at.along.norm() - member.free_length;
    at.first = of(member.first).rotation;
    at.second = of(member.second).rotation;
    at.free_length = member.free_length;
    at.curvature = member.curvature;
    return BeamStep(member.beam, at);
  }
  /// Gradient and tangent of the elastic energy, all dofs.
  void assemble(Eigen::VectorXd& force, Eigen::MatrixXd& stiffness) const {
    const auto n = 6 * static_cast<Eigen::Index>(joints.size());
    force = Eigen::VectorXd::Zero(n);
    stiffness = Eigen::MatrixXd::Zero(n, n);
    for (const Member& one : members) {
      const BeamStep at = step(one);
      const auto gradient = at.gradient();
      const auto tangent = at.tangent();
      const std::array<int, 2> rows{{6 * one.first, 6 * one.second}};
      for (int i = 0; i < 2; ++i) {
        force.segment<6>(rows[static_cast<std::size_t>(i)]) += gradient.segment<6>(6 * i);
        for (int j = 0; j < 2; ++j) {
          stiffness.block<6, 6>(rows[static_cast<std::size_t>(i)],
                                rows[static_cast<std::size_t>(j)]) +=
              tangent.block<6, 6>(6 * i, 6 * j);
        }
      }
    }
  }
  /// Forces and moments of the supports on a node.
  Vector6 reaction(int node) const {
    Eigen::VectorXd force;
    Eigen::MatrixXd stiffness;
    assemble(force, stiffness);
    return force.segment<6>(6 * node) - of(node).load;
  }
  std::vector<int> free_dofs() const {
    std::vector<int> made;
    for (int k = 0; k < 6 * static_cast<int>(joints.size()); ++k) {
      if (!of(k / 6).held[static_cast<std::size_t>(k % 6)]) made.push_back(k);
    }
    return made;
  }
  /// Newton's method until its steps are rounding. Returns the number of iterations, -1: none.
  int solve(double load = 1.0, int most = 60) {
    const std::vector<int> rows = free_dofs();
    if (rows.empty()) return 0;
    double last = 1e300;
    for (int iteration = 1; iteration <= most; ++iteration) {
      Eigen::VectorXd force;
      Eigen::MatrixXd stiffness;
      assemble(force, stiffness);
      for (std::size_t k = 0; k < joints.size(); ++k) {
        force.segment<6>(6 * static_cast<Eigen::Index>(k)) -= load * joints[k].load;
      }
      const Eigen::VectorXd wanted = force(rows);
      const Eigen::VectorXd change = stiffness(rows, rows).partialPivLu().solve(-wanted);
      for (std::size_t k = 0; k < rows.size(); ++k) {
        Joint& at = of(rows[k] / 6);
        const double by = change[static_cast<Eigen::Index>(k)];
        const int dof = rows[k] % 6;
        if (dof < 3) at.place[dof] += by;
      }
      for (std::size_t n = 0; n < joints.size(); ++n) turn(n, rows, change);
      const double now = change.lpNorm<Eigen::Infinity>();
      if (now < 1e-9 && now >= 0.25 * last) return iteration;
      last = now;
    }
    return -1;
  }

 private:
  void turn(std::size_t node, const std::vector<int>& rows, const Eigen::VectorXd& change) {
    Vector3 spin = Vector3::Zero();
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (rows[k] / 6 != static_cast<int>(node) || rows[k] % 6 < 3) continue;
      spin[rows[k] % 6 - 3] = change[static_cast<Eigen::Index>(k)];
    }
    joints[node].rotation = (rotation_of(spin) * joints[node].rotation).normalized();
  }
};

constexpr std::array<bool, 6> clamped{{true, true, true, true, true, true}};
constexpr std::array<bool, 6> planar{{false, false, true, true, true, false}};  // x, y plane

Beam round_beam(double axial, double bending, double torsional = 1.0) {
  Beam made;
  made.axial = axial;
  made.bending = {bending, bending};
  made.torsional = torsional;
  return made;
}

/// Straight cantilever along x of n elements; node 0 is clamped.
Frame cantilever(int n, double length, const Beam& beam, std::array<bool, 6> held = planar) {
  Frame made;
  made.node(Vector3::Zero(), clamped);
  for (int k = 1; k <= n; ++k) {
    made.node({length * k / n, 0.0, 0.0}, held);
    made.member(k - 1, k, beam, Vector3::UnitY());
  }
  return made;
}

/// Result for n and 2n elements, extrapolated to infinitely many with the order of convergence.
template <class Of>
auto extrapolated(Of&& of, int n, int order) -> decltype(of(n)) {
  using Value = decltype(of(n));
  const Value coarse = of(n);
  const Value fine = of(2 * n);
  return fine + (fine - coarse) / (std::pow(2.0, order) - 1.0);
}

/// Order of convergence to a known value from n to 2n elements.
double order_of(double coarse_error, double fine_error) {
  return std::log2(std::abs(coarse_error / fine_error));
}

}  // namespace

// Inextensible elastica with a transverse tip force. The error is of fourth order; with E A =
// 1e9 E I/L² the member extends by up to 1e-8 of its length.
TEST(BeamFrame, ElasticaWithTipForce) {
  struct Row {
    double load, x, w;
  };
  for (const Row& row :
       {Row{1.0, 0.943566763717, 0.301720773800}, Row{5.0, 0.612371639276, 0.713791523612},
        Row{10.0, 0.445004402246, 0.810609024880}}) {
    const auto tip = [&](int n) -> Vector3 {
      // Newton's method reaches large rotations in steps, with soft extension first.
      Frame frame = cantilever(n, 1.0, round_beam(1e3, 1.0));
      frame.of(n).load[1] = row.load;
      for (int part = 1; part <= 40; ++part) EXPECT_GT(frame.solve(part / 40.0), 0);
      for (double axial = 1e4; axial < 2e9; axial *= 10.0) {
        for (Frame::Member& one : frame.members) one.beam.axial = axial;
        EXPECT_GT(frame.solve(), 0) << axial;
      }
      return frame.of(n).place;
    };
    const Vector3 exact(row.x, row.w, 0.0);
    const double coarse = (tip(8) - exact).norm();
    const double fine = (tip(16) - exact).norm();
    EXPECT_LT(coarse, 4e-5);
    EXPECT_NEAR(order_of(coarse, fine), 4.0, 0.1);
    EXPECT_LT((extrapolated(tip, 8, 4) - exact).norm(), 5e-8);
  }
}

// A polygon whose corners all turn by 2π/n closes for every number of elements.
TEST(BeamFrame, EndMomentBendsToACircle) {
  for (const int n : {7, 8, 20}) {
    Frame frame = cantilever(n, 1.0, round_beam(1e3, 1.0));
    frame.of(n).load[5] = 2.0 * pi;
    for (int part = 1; part <= 40; ++part) EXPECT_GT(frame.solve(part / 40.0), 0);
    EXPECT_LT(frame.of(n).place.norm(), 1e-14);
    EXPECT_NEAR(std::abs(frame.of(n).rotation.w()), 1.0, 1e-14);
  }
}

// Cantilever that is an eighth of a circle, with a force out of its plane. Straight elements on the
// curve: the error is of second order.
TEST(BeamFrame, FortyFiveDegreeBend) {
  const std::array<double, 3> loads{{300.0, 450.0, 600.0}};
  const auto tips = [&](int n) {
    Frame frame;
    for (int k = 0; k <= n; ++k) {
      const double angle = 0.25 * pi * k / n;
      frame.node(100.0 * Vector3(1.0 - std::cos(angle), std::sin(angle), 0.0),
                 k == 0 ? clamped : std::array<bool, 6>{});
      if (k == 0) continue;
      frame.member(k - 1, k, round_beam(1e7, 1e7 / 12.0, 5e6 * 0.140577015), Vector3::UnitZ());
    }
    frame.of(n).load[2] = 1.0;
    Matrix3 made;
    for (int k = 0; k < 3; ++k) {
      const double load = loads[static_cast<std::size_t>(k)];
      for (const double part : {0.5, 1.0}) EXPECT_GT(frame.solve(part * load), 0);
      made.col(k) = frame.of(n).place;
    }
    return made;
  };
  Matrix3 exact;
  exact << 22.113118655, 18.369839217, 15.558334255,  //
      58.537050522, 51.971182307, 46.893617742,       //
      40.477781496, 48.701986376, 53.604283660;
  const double coarse = (tips(8) - exact).norm();
  const double fine = (tips(16) - exact).norm();
  EXPECT_NEAR(order_of(coarse, fine), 2.0, 0.02);
  EXPECT_LT((extrapolated(tips, 16, 2) - exact).norm(), 1e-5);
}

namespace {

/// Force that holds the apex of a toggle lowered by `down`; half of the toggle is modelled.
double toggle_force(int n, double down, double span, double rise, const Beam& beam, bool hinged) {
  std::array<bool, 6> foot = clamped;
  foot[5] = !hinged;
  std::array<bool, 6> apex = foot;
  Frame frame;
  for (int k = 0; k <= n; ++k) {
    frame.node({span * k / n, rise * k / n, 0.0}, k == 0 ? foot : k == n ? apex : planar);
    if (k > 0) frame.member(k - 1, k, beam, Vector3::UnitY());
  }
  for (int part = 1; part <= 4; ++part) {
    frame.of(n).place.y() = rise - down * part / 4.0;
    EXPECT_GE(frame.solve(), 0);
  }
  return -2.0 * frame.reaction(n)[1];
}

/// Value and place of the maximum of a function, by golden sections.
Eigen::Array2d maximum(const std::function<double(double)>& of, double from, double to) {
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  while (to - from > 1e-8 * to) {
    const double a = to - ratio * (to - from);
    const double b = from + ratio * (to - from);
    const bool falls = of(a) > of(b);
    (falls ? to : from) = falls ? b : a;
  }
  return {of(0.5 * (from + to)), 0.5 * (from + to)};
}

}  // namespace

// F. W. Williams, Q. J. Mech. Appl. Math. 17 (1964) 451-469. The axial strain of 4e-4 limits the
// agreement of theories of small strain to some 1e-6. Errors fall by 16 per halving.
TEST(BeamFrame, LimitLoadOfTheWilliamsToggle) {
  const Eigen::Array2d exact(33.861233016, 0.232055);
  const auto limit = [&](int n) {
    const auto force = [&](double down) {
      return toggle_force(n, down, 12.943, 0.386, round_beam(1.885e6, 9270.0), false);
    };
    return maximum(force, 0.1, 0.35);
  };
  EXPECT_LT((limit(1) / exact - 1.0).abs().maxCoeff(), 0.025);
  EXPECT_LT((limit(4) / exact - 1.0).abs().maxCoeff(), 1e-3);
  EXPECT_LT((extrapolated(limit, 8, 4) / exact - 1.0).abs().maxCoeff(), 3e-6);
}

// Hinged at all ends, a beam is a bar.
TEST(BeamFrame, LimitLoadOfTheVonMisesTruss) {
  const auto force = [&](double down) {
    return toggle_force(1, down, 5.0, 1.0, round_beam(1280e6, 1e6), true);
  };
  const Eigen::Array2d found = maximum(force, 0.1, 0.9);
  EXPECT_NEAR(found[0], 3789462.5, 0.05);
  EXPECT_NEAR(found[1], 0.4264278, 1e-6);
}

// Beam of 6 m with 20 K over 0.4 m. The free shapes are arcs, so exact; with one support in
// excess, terms of order (κ L)² = 1.3e-5 remain.
TEST(BeamFrame, TemperatureGradient) {
  const double bending = 6e7;
  const double curvature = 1.2e-5 * 20.0 / 0.4;
  const auto bent = [&](bool first_turns, std::array<bool, 6> last) {
    Frame frame = cantilever(2, 6.0, round_beam(4.5e9, bending, 1e7));
    frame.of(0).held[5] = !first_turns;
    frame.of(2).held = last;
    for (Frame::Member& one : frame.members) one.curvature[1] = curvature;
    EXPECT_GT(frame.solve(), 0);
    return frame;
  };
  std::array<bool, 6> roller = planar;
  roller[1] = true;
  const double deep = -(1.0 - std::cos(3.0 * curvature)) / curvature;
  EXPECT_NEAR(bent(true, roller).of(1).place.y(), deep, 1e-13);
  EXPECT_NEAR(deep, -2.7e-3, 1e-9);
  EXPECT_NEAR(bent(false, clamped).reaction(0)[5], 36e3, 1e-8);
  const Frame propped = bent(false, roller);
  EXPECT_NEAR(propped.reaction(0)[1], 9e3, 1.3e-5 * 9e3);
  EXPECT_NEAR(propped.reaction(0)[5], 54e3, 1.3e-5 * 54e3);
  const double tip = (1.0 - std::cos(6.0 * curvature)) / curvature;
  EXPECT_NEAR(bent(false, planar).of(2).place.y(), tip, 1e-12);
  EXPECT_NEAR(tip, 10.8e-3, 2e-8);
}

TEST(BeamFrame, FreeThermalArcConvergesWithFourthOrder) {
  const auto error = [](int n) {
    Frame frame = cantilever(n, 1.0, round_beam(1e3, 1.0));
    for (Frame::Member& one : frame.members) one.curvature[1] = 1.0;
    EXPECT_GT(frame.solve(), 0);
    return (frame.of(n).place - Vector3(std::sin(1.0), 1.0 - std::cos(1.0), 0.0)).norm();
  };
  EXPECT_LT(error(4), 2e-6);
  EXPECT_NEAR(order_of(error(4), error(8)), 4.0, 0.05);
}

// Portal with one element per member whose left column is 60 K warmer, in the limit of small
// displacements: a thousandth of the temperature.
TEST(BeamFrame, PortalWithAHeatedColumn) {
  const double fraction = 1e-3;
  const Beam beam = round_beam(210e9 * 5e-3, 210e9 * 8e-5, 1e6);
  Frame frame;
  frame.node({0.0, 0.0, 0.0}, clamped);
  frame.node({0.0, 4.0, 0.0}, planar);
  frame.node({6.0, 4.0, 0.0}, planar);
  frame.node({6.0, 0.0, 0.0}, clamped);
  frame.member(0, 1, beam, Vector3::UnitX()).free_length *= 1.0 + fraction * 1.2e-5 * 60.0;
  frame.member(1, 2, beam, Vector3::UnitY());
  frame.member(2, 3, beam, Vector3::UnitX());
  EXPECT_GT(frame.solve(), 0);
  EXPECT_NEAR(frame.reaction(0)[1] / fraction, 536.8365, 1e-3);
  EXPECT_NEAR(frame.reaction(0)[5] / fraction, 1610.5095, 3e-3);
  EXPECT_NEAR(frame.reaction(3)[5] / fraction, 1610.5095, 3e-3);
}

// Natural frequencies of a Timoshenko cantilever with linear mass matrices: second order, the
// next term of fourth order.
TEST(BeamFrame, FrequenciesOfATimoshenkoCantilever) {
  const double e = 70e9, rho = 2700.0, width = 0.02, height = 0.05, area = width * height;
  const double inertia = area * height * height / 12.0;
  Beam beam = round_beam(e * area, e * inertia, 1e3);
  beam.shear.fill(5.0 / 6.0 * e / (2.0 * 1.33) * area);
  const auto frequencies = [&](int n) -> Eigen::Array3d {
    Frame frame = cantilever(n, 1.0, beam, {{true, false, true, true, true, false}});
    Eigen::VectorXd force;
    Eigen::MatrixXd stiffness;
    frame.assemble(force, stiffness);
    Eigen::MatrixXd mass = 0.0 * stiffness;
    for (int row = 0; row < 6 * n; ++row) {
      const double per_length = rho * (row % 6 < 3 ? area : inertia);
      Eigen::Matrix2d linear;
      linear << 2.0, 1.0, 1.0, 2.0;
      const std::array<int, 2> rows{{row, row + 6}};
      mass(rows, rows) += per_length / (6.0 * n) * linear;
    }
    const std::vector<int> rows = frame.free_dofs();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(stiffness(rows, rows),
                                                                          mass(rows, rows));
    return modes.eigenvalues().head(3).array().sqrt() / (2.0 * pi);
  };
  const Eigen::Array3d exact(41.042921971, 254.164745330, 698.626607530);
  EXPECT_LT((frequencies(8) / exact - 1.0).abs().maxCoeff(), 0.057);
  const auto once = [&](int n) { return extrapolated(frequencies, n, 2); };
  EXPECT_LT((extrapolated(once, 16, 4) / exact - 1.0).abs().maxCoeff(), 3e-7);
}

}  // namespace statejump::kernel
