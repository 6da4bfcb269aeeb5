// SPDX-License-Identifier: GPL-3.0-or-later
// Cost of a bore given by triangles, by number of faces, and of the closed form of a round one.
//
//     build/bin/geometry_bench --benchmark_counters_tabular=true   (wherever the build puts it)
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <memory>

#include "statejump/geometry/bore_mesh.hpp"
#include "statejump/geometry/follow.hpp"
#include "statejump/kernel/elliptic_hertz.hpp"
#include "statejump/kernel/joint_kinematics.hpp"

namespace {

using Eigen::Vector3d;
using statejump::geometry::BoreMesh;

constexpr double bearing_radius = 5.1e-3;
constexpr double journal_radius = 5e-3;

statejump::geometry::Triangles mesh_of(int faces) {
  statejump::geometry::BoreShape shape{bearing_radius, 10e-3};
  shape.lobes = {{3, 1e-5, 0.3}};
  const int along = std::max(2, static_cast<int>(std::sqrt(faces / 6.28 * 0.6)));
  return bore_triangles(shape, faces / (2 * along), along);
}

const BoreMesh& bore(int faces) {
  static std::map<int, std::unique_ptr<BoreMesh>> known;
  auto& mesh = known[faces];
  if (!mesh) mesh = std::make_unique<BoreMesh>(mesh_of(faces));
  return *mesh;
}

/// Journal centres along the bore's circumference, 1 um deep on average.
Vector3d centre(int i) {
  const double angle = 1e-3 * i;
  return {1.01e-4 * std::cos(angle), 1.01e-4 * std::sin(angle), 1e-3};
}

void analytic_revolute_contact(benchmark::State& state) {
  using namespace statejump::kernel;
  const BodyMotion bearing{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  int i = 0;
  for (auto _ : state) {
    const BodyMotion journal{centre(++i), Vector3d::Zero(), Vector3d::Zero()};
    benchmark::DoNotOptimize(
        revolute_contact(journal, journal_radius, bearing, bearing_radius, Vector3d::UnitZ()));
  }
}
BENCHMARK(analytic_revolute_contact);

void bore_contacts(benchmark::State& state) {
  const BoreMesh& mesh = bore(static_cast<int>(state.range(0)));
  int i = 0;
  double count = 0;
  for (auto _ : state) {
    const auto found = mesh.contacts(centre(++i), Vector3d::UnitZ(), journal_radius, 0);
    count += static_cast<double>(found.size());
  }
  state.counters["contacts"] = count / static_cast<double>(state.iterations());
}
BENCHMARK(bore_contacts)->RangeMultiplier(10)->Range(1000, 1000000);

/// Follows the contacts of bore_contacts() in steps of 3e-4 rad. The smooth wall is evaluated in
/// every step.
void bore_followed(benchmark::State& state) {
  const BoreMesh& mesh = bore(static_cast<int>(state.range(0)));
  std::vector<double> track;
  std::vector<statejump::geometry::FollowedContact> found;
  int i = 0;
  double searches = 0;
  for (auto _ : state) {
    const double angle = 3e-4 * ++i;
    const Vector3d place(1.01e-4 * std::cos(angle), 1.01e-4 * std::sin(angle), 1e-3);
    const auto how =
        follow_contacts(mesh, {place, Vector3d::UnitZ(), journal_radius}, 2e-4, track, found);
    for (std::size_t k = 0; k < found.size(); ++k) statejump::geometry::set_label(track, k, 0);
    searches += how == statejump::geometry::Followed::search;
  }
  state.counters["searches"] = searches / static_cast<double>(state.iterations());
}
BENCHMARK(bore_followed)->RangeMultiplier(10)->Range(1000, 1000000);

void bore_no_contact(benchmark::State& state) {
  const BoreMesh& mesh = bore(static_cast<int>(state.range(0)));
  int i = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(
        mesh.contacts(0.5 * centre(++i), Vector3d::UnitZ(), journal_radius, 0));
}
BENCHMARK(bore_no_contact)->RangeMultiplier(10)->Range(1000, 1000000);

void bore_closest_point(benchmark::State& state) {
  const BoreMesh& mesh = bore(static_cast<int>(state.range(0)));
  int i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(mesh.closest_point(45.0 * centre(++i)));
}
BENCHMARK(bore_closest_point)->RangeMultiplier(10)->Range(1000, 1000000);

void bore_construction(benchmark::State& state) {
  const auto triangles = mesh_of(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(BoreMesh(triangles));
}
BENCHMARK(bore_construction)
    ->RangeMultiplier(10)
    ->Range(1000, 1000000)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

void elliptic_shape(benchmark::State& state) {
  double ratio = 1;
  for (auto _ : state) {
    ratio = ratio > 1e3 ? 1.1 : ratio * 1.01;
    benchmark::DoNotOptimize(statejump::kernel::elliptic_shape({4.0, 4.0 / ratio, 0}));
  }
}
BENCHMARK(elliptic_shape);

}  // namespace
