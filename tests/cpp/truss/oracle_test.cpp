// SPDX-License-Identifier: GPL-3.0-or-later
#include "oracle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "statejump/truss/path.hpp"

namespace statejump::truss {
namespace {

using Eigen::Vector3d;

/// Random numbers from one seed, equal on every machine (unlike the standard distributions).
class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_()) / 4294967296.0;
  }
  double logarithmic(double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  }
  bool happens(double share) { return between(0.0, 1.0) < share; }

 private:
  std::mt19937 engine_;
};

std::string named(const char* kind, std::size_t number) {
  return std::string(kind).append(std::to_string(number));
}

Vector3d in_plane(double angle) {
  return {std::cos(angle), std::sin(angle), 0.0};
}

/// Plane truss with random sliders on the ground and between two nodes. Every node is braced
/// separately and connected to others, so the energy is convex for any slip. Each link follows one
/// of two temperature programs with its own factor.
Model random_truss(unsigned seed, int sliders) {
  Draw draw(seed);
  Model model;
  for (const auto shape : {thermal::Shape::triangle, thermal::Shape::half_sine}) {
    thermal::Program program;
    program.shape = shape;
    program.temperature_change_max = 100.0;
    program.cycles = 2;
    model.programs.push_back(program);
  }
  const bool prestressed = draw.happens(0.25);
  const auto add_node = [&](const Vector3d& at, int freedoms, double angle) {
    Node node;
    node.name = named("N", model.nodes.size());
    node.position = at;
    node.freedoms = freedoms;
    node.free_directions = (Eigen::Matrix3d() << in_plane(angle),
                            in_plane(angle + 0.5 * std::numbers::pi), Vector3d::UnitZ())
                               .finished();
    if (freedoms > 0 && prestressed) node.load = draw.between(0.0, 100.0) * in_plane(angle + 1.0);
    model.nodes.push_back(node);
    return static_cast<int>(model.nodes.size()) - 1;
  };
  const auto add_link = [&](int first, int second) {
    Bar link;
    link.name = named("L", model.links.size());
    link.first = first;
    link.second = second;
    link.axial_stiffness = draw.logarithmic(2e5, 2e6);
    link.stress_free_length =
        (model.nodes[std::size_t(second)].position - model.nodes[std::size_t(first)].position)
            .norm() *
        (prestressed ? 1.0 + draw.between(-1e-4, 1e-4) : 1.0);
    link.thermal_expansion = draw.between(1e-5, 3e-5);
    link.program = draw.happens(0.3) ? 1 : 0;
    link.temperature_fraction = draw.between(-0.3, 1.0);
    model.links.push_back(link);
  };
  std::vector<int> movable;
  const auto tied = [&](const Vector3d& at, int freedoms, double angle) {
    const int made = add_node(at, freedoms, angle);
    for (int i = 0; i < freedoms; ++i) {
      const double towards = angle + 0.5 * std::numbers::pi * i + draw.between(-0.7, 0.7);
      const int ground = add_node(at + draw.between(0.2, 0.8) * in_plane(towards), 0, 0.0);
      add_link(ground, made);
    }
    for (int ties = 0; ties < 2 && !movable.empty(); ++ties) {
      const int other = movable[std::size_t(draw.between(0.0, double(movable.size())))];
      if ((model.nodes[std::size_t(other)].position - at).norm() > 0.05) add_link(other, made);
    }
    return made;
  };
  for (int j = 0; j < sliders; ++j) {
    Slider slider;
    slider.name = named("S", std::size_t(j));
    const Vector3d at(draw.between(0.0, 2.0), draw.between(0.0, 2.0), 0.0);
    const double angle = draw.between(-std::numbers::pi, std::numbers::pi);
    slider.axis = in_plane(angle);
    if (draw.happens(0.65)) {
      slider.first = tied(at, 1, angle);
      movable.push_back(slider.first);
    } else {
      slider.first = tied(at, 2, angle);
      slider.second = tied(at, 2, angle);
      movable.push_back(slider.first);
      movable.push_back(slider.second);
    }
    // Constrained links carry E A times a strain of up to 3e-3, a few kN.
    slider.friction_force = draw.logarithmic(1.0, 1000.0);
    if (draw.happens(0.1)) slider.friction_force = 0.0;
    if (draw.happens(0.1)) slider.friction_force = 1e6;
    for (double* clearance : {&slider.clearance_minus, &slider.clearance_plus}) {
      if (draw.happens(0.5)) *clearance = draw.logarithmic(1e-6, 1e-3);
      if (draw.happens(0.05)) *clearance = 0.0;
    }
    if (draw.happens(0.3)) slider.tangential_stiffness = draw.logarithmic(1e6, 1e8);
    model.joints.push_back(slider);
  }
  return model;
}

/// The same truss with nodes, links and joints in another order.
struct Shuffled {
  Model model;
  std::vector<int> node_of;   ///< new index of each node
  std::vector<int> joint_of;  ///< new index of each joint
};

Shuffled shuffled(const Model& model, unsigned seed) {
  Draw draw(seed);
  const auto order = [&](std::size_t size) {
    std::vector<int> places(size);
    std::iota(places.begin(), places.end(), 0);
    for (std::size_t i = size; i > 1; --i) {
      std::swap(places[i - 1], places[std::size_t(draw.between(0.0, double(i)))]);
    }
    return places;
  };
  Shuffled made{model, order(model.nodes.size()), order(model.joints.size())};
  const std::vector<int> link_of = order(model.links.size());
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    made.model.nodes[std::size_t(made.node_of[n])] = model.nodes[n];
  }
  for (std::size_t l = 0; l < model.links.size(); ++l) {
    Bar& link = made.model.links[std::size_t(link_of[l])] = model.links[l];
    link.first = made.node_of[std::size_t(link.first)];
    link.second = made.node_of[std::size_t(link.second)];
    // The direction of a bar is arbitrary.
    if (draw.happens(0.5)) std::swap(link.first, link.second);
  }
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    Slider slider = std::get<Slider>(model.joints[j]);
    slider.first = made.node_of[std::size_t(slider.first)];
    if (slider.second >= 0) slider.second = made.node_of[std::size_t(slider.second)];
    made.model.joints[std::size_t(made.joint_of[j])] = slider;
  }
  return made;
}

class Oracle : public ::testing::TestWithParam<unsigned> {};

TEST_P(Oracle, OrderOfPartsDoesNotMatter) {
  // Tests one of ten random trusses, but all numbers of sliders. (All 200 trusses agree.)
  const unsigned seed = 10 * GetParam() + GetParam() % 10;
  const Model model = random_truss(seed, 2 + static_cast<int>(seed) % 39);
  const Shuffled other = shuffled(model, seed + 1000);
  const Path path = solve(model);
  const Path again = solve(other.model);
  double apart = 0.0;
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    for (std::size_t c = 0; c < path.cycle_ends.size(); ++c) {
      apart = std::max(apart, (path.cycle_ends[c].displacement.col(Eigen::Index(n)) -
                               again.cycle_ends[c].displacement.col(other.node_of[n]))
                                  .norm());
    }
  }
  // Displacements of a few mm have a relative rounding of 2e-16, amplified by the condition number
  // 10 (ratio of link stiffnesses). Located changes also differ by rounding.
  EXPECT_LT(apart, 1e-14) << "seed " << seed;
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    // a few kN times 1e-12 m, the uncertainty of a located change
    EXPECT_NEAR(path.cycle_ends.back().joint_dissipation[Eigen::Index(j)],
                again.cycle_ends.back().joint_dissipation[other.joint_of[j]], 1e-9);
  }
}

TEST_P(Oracle, RandomTrussesMinimiseTheirEnergy) {
  // Each test runs ten trusses. A change is located to 1e-9 of a branch, in which a joint slides a
  // few mm: 1e-12 m. Other joints have no larger error.
  constexpr double tolerance = 1e-11;
  std::size_t events = 0;
  for (unsigned seed = 10 * GetParam(); seed < 10 * GetParam() + 10; ++seed) {
    const int sliders = 2 + static_cast<int>(seed) % 39;
    const Model model = random_truss(seed, sliders);
    Options options;
    const Path path = solve(model, options);
    events += path.events.size();
    MinimisingTruss minimum(model);
    // The path starts from the rest position with friction. Only later heat counts.
    minimum.step(0.0);
    const Eigen::VectorXd cold = minimum.heat();
    double before = 0.0;
    double apart = 0.0;
    double force_apart = 0.0;
    double heat_apart = 0.0;
    std::vector<double> begun;  // starts of the intervals with changes
    for (const Event& event : path.events) begun.push_back(event.time - event.interval);
    auto next = begun.begin();
    for (std::size_t i = 1; i < path.states.size(); ++i) {
      const State& state = path.states[i];
      for (; next != begun.end() && *next < state.time; ++next) {
        if (*next > before) minimum.step(before = *next);
      }
      // The reference makes additional increments between the states of the path, to detect changes
      // that the path misses between two states.
      constexpr double longest = 0.5 / 100;
      const int parts = static_cast<int>(std::ceil((state.time - before) / longest));
      for (int part = 1; part < parts; ++part) {
        minimum.step(before + (state.time - before) * part / parts);
      }
      minimum.step(state.time);
      before = state.time;
      for (int n = 0; n < static_cast<int>(model.nodes.size()); ++n) {
        apart = std::max(apart, (minimum.displacement(n) - state.displacement.col(n)).norm());
      }
      for (std::size_t j = 0; j < model.joints.size(); ++j) {
        force_apart = std::max(
            force_apart,
            std::abs(minimum.force(j) - output(model, state, int(j), "slider_force_N")[0]));
      }
      heat_apart = std::max(
          heat_apart, (minimum.heat() - cold - state.joint_dissipation).lpNorm<Eigen::Infinity>());
    }
    EXPECT_LT(apart, tolerance) << "seed " << seed;
    // Stiffest element: 2 MN over 0.05 m.
    EXPECT_LT(force_apart, 4e7 * tolerance) << "seed " << seed;
    EXPECT_LT(heat_apart, 1e3 * tolerance) << "seed " << seed;
  }
  EXPECT_GT(events, 200u);  // otherwise the comparison would cover too little
}

INSTANTIATE_TEST_SUITE_P(Twenty, Oracle, ::testing::Range(0u, 2u));
// Run by `make check` only.
INSTANTIATE_TEST_SUITE_P(Campaign, Oracle, ::testing::Range(2u, 20u));

}  // namespace
}  // namespace statejump::truss
