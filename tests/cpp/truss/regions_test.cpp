// SPDX-License-Identifier: GPL-3.0-or-later
// A large truss is assembled by regions in several threads: the same equations and the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "parallel.hpp"
#include "parts.hpp"
#include "regions.hpp"
#include "system.hpp"

namespace statejump::truss {
namespace {

using detail::index;
using detail::Region;
using detail::Regions;

/// Independent rows of bars. The far end of each bar is on a block that slides on the ground.
/// @param order node indices of all rows, row by row
Model rows_of_bars(int rows, int bars, const std::vector<int>& order) {
  Model model;
  model.programs = {testing::triangle(100.0)};
  model.nodes.resize(order.size());
  for (int r = 0; r < rows; ++r) {
    for (int k = 0; k <= bars; ++k) {
      const int number = order[index(r * (bars + 1) + k)];
      const std::string name = std::to_string(r) + "-" + std::to_string(k);
      model.nodes[index(number)] = testing::node(name, 0.5 * k, r, k == 0 ? 0 : 1);
      if (k == 0) continue;
      const int before = order[index(r * (bars + 1) + k - 1)];
      model.links.push_back({name, before, number, 70e9 * 9e-6, 0.5, 23.4e-6, 0, 1.0});
      Slider slider;
      slider.name = name;
      slider.first = number;
      // The friction limits differ, so no two blocks start to slide at the same time.
      slider.friction_force = 0.01 * (1.0 + 0.1 * k / bars);
      model.joints.push_back(slider);
    }
  }
  return model;
}

std::vector<int> counted(int count) {
  std::vector<int> order(index(count));
  std::iota(order.begin(), order.end(), 0);
  return order;
}

Regions regions_of(const Model& model) {
  std::vector<JointFrame> joints;
  for (const Joint& joint : model.joints) {
    joints.push_back(std::visit([&](const auto& one) { return one.frame(model); }, joint));
  }
  const detail::DofMap dofs(model);
  return detail::regions_of(model, dofs, detail::frames_of_elements(model), joints);
}

const std::vector<int>& bars_of(const Region& region) {
  return region.elements[element_type_index<Bar>()];
}

/// Sets OMP_NUM_THREADS while the object exists.
class Threads {
 public:
  explicit Threads(int number) {
    if (const char* before = std::getenv("OMP_NUM_THREADS")) before_ = before;
    setenv("OMP_NUM_THREADS", std::to_string(number).c_str(), 1);
  }
  ~Threads() {
    if (before_.empty()) {
      unsetenv("OMP_NUM_THREADS");
    } else {
      setenv("OMP_NUM_THREADS", before_.c_str(), 1);
    }
  }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

 private:
  std::string before_;
};

TEST(Regions, ShareNoNodeThatMovesHoweverNodesAreNumbered) {
  constexpr int bars = 5000;
  std::vector<int> order = counted(bars + 1);
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  Model model = rows_of_bars(1, bars, order);
  model.nodes[index(order[bars])].load = {1.0, 0.0, 0.0};
  const Regions found = regions_of(model);
  ASSERT_GT(found.apart.size(), 1u);
  std::map<int, std::size_t> region_of_node;
  const auto claim = [&](int node, std::size_t region) {
    if (model.nodes[index(node)].freedoms == 0) return;
    const auto [at, is_new] = region_of_node.try_emplace(node, region);
    EXPECT_EQ(at->second, region) << "node " << node;
  };
  std::size_t links = bars_of(found.between).size();
  std::size_t joints = found.between.joints.size();
  std::size_t loaded = found.between.loaded.size();
  for (std::size_t k = 0; k < found.apart.size(); ++k) {
    const Region& region = found.apart[k];
    for (const int i : bars_of(region)) {
      claim(model.links[index(i)].first, k);
      claim(model.links[index(i)].second, k);
    }
    for (const int i : region.joints) claim(std::get<Slider>(model.joints[index(i)]).first, k);
    EXPECT_TRUE(std::is_sorted(bars_of(region).begin(), bars_of(region).end()));
    links += bars_of(region).size();
    joints += region.joints.size();
    loaded += region.loaded.size();
    // Elements are evenly distributed over the regions, except for a few that belong to none.
    EXPECT_NEAR(static_cast<double>(bars_of(region).size() + region.joints.size()),
                2.0 * bars / static_cast<double>(found.apart.size()), 3.0);
  }
  EXPECT_EQ(links, index(bars));
  EXPECT_EQ(joints, index(bars));
  EXPECT_EQ(loaded, 1u);
  // The search proceeds in both directions along the row, so each cut leaves one or two bars
  // between regions.
  EXPECT_LE(bars_of(found.between).size(), 2 * (found.apart.size() - 1));
}

TEST(Regions, OfASmallTrussThereAreNone) {
  const Model model = rows_of_bars(1, 100, counted(101));
  const Regions found = regions_of(model);
  EXPECT_TRUE(found.apart.empty());
  EXPECT_EQ(bars_of(found.between), counted(100));
  EXPECT_EQ(found.between.joints, counted(100));
}

TEST(Regions, EquationsAreThoseOfTheWhole) {
  // Compares one row alone, which is too small for regions, with a truss of equal rows.
  constexpr int rows = 8, bars = 700;
  const Model one = rows_of_bars(1, bars, counted(bars + 1));
  const Model all = rows_of_bars(rows, bars, counted(rows * (bars + 1)));
  ASSERT_TRUE(regions_of(one).apart.empty());
  ASSERT_GT(regions_of(all).apart.size(), 1u);
  const detail::System small(one), large(all);
  const auto evaluated = [](const detail::System& system, const Eigen::VectorXd& z) {
    const detail::Statuses statuses = system.all_stick();
    Assembly at = system.assembly();
    system.evaluate(z, 0.3, system.begin(z, 0.0, statuses, 1.0), statuses, JointModel::friction,
                    1.0, at);
    return at;
  };
  // Unknowns: the bars' ends, then the forces of the blocks.
  const auto place = [](int row, int i) {
    return (i / bars) * rows * bars + row * bars + i % bars;
  };
  Eigen::VectorXd z(large.unknowns());
  for (int i = 0; i < z.size(); ++i) z[i] = 1e-5 * std::sin(1.0 + 0.37 * i);
  const Assembly whole = evaluated(large, z);
  double largest = 0.0;
  for (int row = 0; row < rows; ++row) {
    Eigen::VectorXd own(small.unknowns());
    for (int i = 0; i < own.size(); ++i) own[i] = z[place(row, i)];
    const Assembly alone = evaluated(small, own);
    largest = std::max(largest, alone.largest_force);
    const linear::SparseView single = alone.jacobian();
    for (int i = 0; i < own.size(); ++i) {
      // Forces of two bars and a block (100 N) are summed in a different order, which causes a few
      // roundings.
      ASSERT_NEAR(whole.residual[place(row, i)], alone.residual[i], 1e-12);
      EXPECT_EQ(whole.units[index(place(row, i))], alone.units[index(i)]);
      for (linear::SparseView::InnerIterator it(single, i); it; ++it) {
        const double same =
            whole.jacobian().coeff(place(row, static_cast<int>(it.row())), place(row, i));
        ASSERT_NEAR(same, it.value(), 1e-15 * std::abs(it.value()) + 1e-12);
      }
    }
  }
  EXPECT_EQ(whole.largest_force, largest);
}

TEST(Regions, PathsHaveTheSameBitsWithAnyNumberOfThreads) {
  constexpr int rows = 500, bars = 5;
  const Model model = rows_of_bars(rows, bars, counted(rows * (bars + 1)));
  ASSERT_GT(regions_of(model).apart.size(), 1u);
  Options options;
  options.increments_per_branch = 4;
  options.locate_events = false;
  std::vector<Eigen::Matrix3Xd> moved;
  std::vector<double> work;
  for (const int threads : {1, 2, 5}) {
    const Threads told(threads);
    const Path path = solve(model, options);
    moved.push_back(path.states.back().displacement);
    work.push_back(path.states.back().thermal_work);
  }
  for (std::size_t k = 1; k < moved.size(); ++k) {
    EXPECT_EQ(moved[k], moved[0]);
    EXPECT_EQ(work[k], work[0]);
  }
  // At the end all blocks have slid back, so each bar carries the friction of all blocks beyond it.
  double jump = 0.0, beyond = 0.0;
  for (int k = bars; k > 0; --k) {
    beyond += std::get<Slider>(model.joints[index(k - 1)]).friction_force;
    jump += 0.5 / (70e9 * 9e-6) * beyond;
  }
  // The solver solves closures to 1e-13 of the largest displacement, 1.2 mm per bar at 100 K.
  for (int r = 0; r < rows; ++r) {
    EXPECT_NEAR(moved[0](0, r * (bars + 1) + bars), jump, 1e-13 * bars * 1.2e-3);
  }
}

TEST(InParallel, DoesAllAndThrowsWhatTheFirstThrew) {
  for (const int threads : {1, 3}) {
    const Threads told(threads);
    std::vector<int> done(100, 0);
    const auto work = [&](std::size_t k) {
      done[k] += 1;
      if (k == 17 || k == 60) throw std::runtime_error(std::to_string(k));
    };
    try {
      in_parallel(done.size(), work);
      FAIL() << "nothing thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "17");
    }
    EXPECT_EQ(done, std::vector<int>(100, 1));
  }
  in_parallel(0, [](std::size_t) { FAIL(); });
}

TEST(InParallel, PiecesAreAllOfIt) {
  for (const std::size_t count : {0u, 1u, 9u, 10u, 11u, 25u}) {
    std::vector<int> done(count, 0);
    each_in_parallel(count, 10, [&](std::size_t i) { done[i] += 1; });
    EXPECT_EQ(done, std::vector<int>(count, 1));
  }
}

}  // namespace
}  // namespace statejump::truss
