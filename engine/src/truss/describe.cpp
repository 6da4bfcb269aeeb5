// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "hermite.hpp"
#include "system.hpp"
#include "thermal_step.hpp"

namespace statejump::truss::detail {

namespace {

/// Integrating the work or writing the outputs of this many elements takes about ten times as long
/// as starting a thread.
constexpr std::size_t parts_at_once = 5000;

}  // namespace

void System::describe(const VectorXd& z, double time, const StepStart& now, State& state) const {
  const Model& model = *model_;
  const auto size = [](const auto& list) { return static_cast<Eigen::Index>(list.size()); };
  state.time = time;
  state.temperature_change = model.temperature_change(0, 1.0, time);
  state.element_output.resize(element_outputs_);
  state.joint_output.resize(outputs_);
  state.joint_status = now.statuses;
  Eigen::Matrix3Xd sites;
  Eigen::Matrix3Xd& moved = dofs_.has_rotations() ? sites : state.displacement;
  displacements(z, moved);
  state.load_potential = 0.0;
  for (int i = 0; i < moved.cols(); ++i) state.load_potential -= load_on(i).dot(moved.col(i));
  state.elastic_energy = 0.0;
  // Energies are added in the order of the elements, so that the sum does not depend on the number
  // of threads.
  const auto add_energies = [&](const auto& parts, std::size_t at_once, auto&& energy_of) {
    VectorXd energies(size(parts));
    each_in_parallel(parts.size(), at_once, [&](std::size_t i) {
      energies[static_cast<Eigen::Index>(i)] = energy_of(i, parts[i]);
    });
    state.elastic_energy = std::accumulate(energies.begin(), energies.end(), state.elastic_energy);
  };
  const std::vector<double> changes = temperature_changes(time);
  const ElementState at_elements(drawn_, moved, changes);
  check_rotations(at_elements);
  if (dofs_.has_rotations()) {
    state.displacement = moved.leftCols(size(model.nodes));
    state.rotation = moved.rightCols(size(model.nodes));
    for (int i = 0; i < size(model.nodes); ++i) state.rotation.col(i) /= model.nodes[index(i)].arm;
  }
  double* outputs_of_type = state.element_output.data();
  each_element_type(
      [&]<class Type>(const std::vector<Type>& elements, const auto& frames, std::size_t) {
        const std::size_t width = output_width<Type>();
        add_energies(elements, parts_at_once, [&](std::size_t i, const auto& one) {
          one.describe(frames[i], at_elements, outputs_of_type + i * width);
          return one.energy(frames[i], at_elements);
        });
        outputs_of_type += elements.size() * width;
      });
  add_energies(model.joints, joints_at_once, [&](std::size_t i, const Joint& joint) {
    const int which = static_cast<int>(i);
    const Trial at = trial(which, z, moved, time, now, JointModel::friction, 1.0);
    double* outputs = state.joint_output.data() + output_begin_[i];
    return std::visit(
        [&](const auto& one) {
          one.describe(at, outputs);
          return one.elastic_energy(at, history(which, now));
        },
        joint);
  });
}

VectorXd System::beyond_edges(const VectorXd& z, double time, const StepStart& now) const {
  std::vector<double> found;
  Eigen::Matrix3Xd moved;
  if (has_edges_) displacements(z, moved);
  const std::vector<double> changes = temperature_changes(time);
  const ElementState state(drawn_, moved, changes);
  each_element_type([&](const auto& elements, const auto& frames, std::size_t) {
    for (std::size_t i = 0; i < elements.size(); ++i) {
      if constexpr (requires { elements[i].beyond_edges(frames[i], state); }) {
        if (elements[i].has_edge()) found.push_back(elements[i].beyond_edges(frames[i], state));
      }
    }
  });
  for (int i = 0; i < static_cast<int>(model_->joints.size()); ++i) {
    std::visit(
        [&](const auto& one) {
          if constexpr (requires(const Trial& at) { one.beyond_edges(at); }) {
            const Trial at = trial(i, z, time, now, JointModel::friction, 1.0);
            for (const double beyond : one.beyond_edges(at)) found.push_back(beyond);
          }
        },
        model_->joints[index(i)]);
  }
  return Eigen::Map<const VectorXd>(found.data(), static_cast<Eigen::Index>(found.size()));
}

VectorXd System::heat(const VectorXd& z, double time, const StepStart& start,
                      const StepStart& after, const VectorXd& slips) const {
  VectorXd found(slips.size());
  const Eigen::Matrix3Xd moved = displacements(z);
  each_joint([&](int i) {
    const Trial at = trial(i, z, moved, time, start, JointModel::friction, 1.0);
    // The closure error of a sticking joint is no slip.
    const double slip = after.statuses[index(i)] == JointStatus::stick ? 0.0 : slips[i];
    found[i] =
        std::visit([&](const auto& one) { return one.dissipation(at, history(i, after), slip); },
                   model_->joints[index(i)]);
  });
  return found;
}

std::optional<System::Halves> System::halves_of(const Way& way, const StepStart& start,
                                                const Statuses& statuses) const {
  const bool asked = !rolling_.empty() || slips_smoothly_ ||
                     std::any_of(statuses.begin(), statuses.end(), is_slip);
  if (way.is_straight() || !asked) return std::nullopt;
  Halves made;
  made.middle = 0.5 * (way.from + way.to) + 0.125 * way.step() * (*way.from_rate - *way.to_rate);
  made.time = way.from_time + 0.5 * way.step();
  made.half = commit(made.middle, made.time, statuses, start);
  made.whole = commit(way.to, way.to_time, statuses, made.half);
  return made;
}

void System::note_slides(const Way& way, const std::optional<Halves>& halves,
                         const StepStart& start, StepStart& after) const {
  if (rolling_.empty()) return;
  const auto joints = static_cast<Eigen::Index>(model_->joints.size());
  after.owed = after.lost = Eigen::Matrix3Xd::Zero(3, joints);
  if (halves) after.last_step = way.step();
  each_in_parallel(rolling_.size(), joints_at_once, [&](std::size_t which) {
    const int i = rolling_[which];
    if (after.statuses[index(i)] != JointStatus::stick) return;
    const Vector3d foreseen = start.foreseen(i, way.to_time);
    if (halves) {
      // The two halves together have a quarter of the error that the whole step has.
      after.lost.col(i) =
          4.0 / 3.0 *
          (lag(i, halves->middle, halves->time, start) + lag(i, way.to, way.to_time, halves->half) -
           lag(i, way.to, way.to_time, start));
    }
    after.owed.col(i) = after.lost.col(i) - foreseen;
  });
}

void System::account(const Way& way, const std::optional<Halves>& halves, const StepStart& start,
                     const StepStart& after, const VectorXd& slips, State& state) const {
  VectorXd dissipated = heat(way.to, way.to_time, start, after, slips);
  if (halves && (dissipated.array() > 0.0).any()) {
    // Extrapolates the result to zero step length, from the results with both halves and with the
    // whole step.
    const auto& [middle, then, half, whole] = *halves;
    const VectorXd by_halves =
        heat(middle, then, start, half, this->slips(middle, then, start, half)) +
        heat(way.to, way.to_time, half, whole, this->slips(way.to, way.to_time, half, whole));
    dissipated = by_halves + (by_halves - dissipated) / 3.0;
  }
  state.joint_dissipation += dissipated;
  state.thermal_work += work_on_elements(way) + work_on_joints(way, start);
}

double System::work_on_elements(const Way& way) const {
  const std::vector<Quadrature> rules = quadratures(way, *model_);
  const ThermalStep step{way, drawn_, dofs_, rules};
  double sum = 0.0;
  each_element_type([&](const auto& elements, const auto& frames, std::size_t) {
    VectorXd work(static_cast<Eigen::Index>(elements.size()));
    each_in_parallel(elements.size(), parts_at_once, [&](std::size_t i) {
      work[static_cast<Eigen::Index>(i)] = elements[i].thermal_work(frames[i], step);
    });
    sum = std::accumulate(work.begin(), work.end(), sum);
  });
  return sum;
}

double System::work_on_joints(const Way& way, const StepStart& start) const {
  const std::vector<Quadrature> asked = quadratures(way, *model_);
  VectorXd work = VectorXd::Zero(static_cast<Eigen::Index>(model_->joints.size()));
  each_joint([&](int i) {
    std::visit(
        [&](const auto& one) {
          if constexpr (requires { one.clearance_growth(); }) {
            const JointFrame& frame = frames_[index(i)];
            const double growth = one.clearance_growth() * frame.temperature_fraction;
            if (growth == 0.0) return;
            const auto at = [&](const VectorXd& z) {
              return trial(i, z, way.to_time, start, JointModel::friction, 1.0);
            };
            // A growing clearance yields to the contact force: ∂V/∂c = −N.
            const auto add = [&](auto&& joint_at) {
              work[i] = -growth * asked[index(frame.program)].along([&](double share, double) {
                return one.contact_force(joint_at(share));
              });
            };
            if (way.is_straight()) {
              add([&](double share) { return at(share == 0.0 ? way.from : way.to); });
            } else {
              const JointWay on{at(way.from), at(way.to), at(*way.from_rate), at(*way.to_rate),
                                way.step()};
              add([&](double share) { return on.at(share); });
            }
          }
        },
        model_->joints[index(i)]);
  });
  return std::accumulate(work.begin(), work.end(), 0.0);
}

}  // namespace statejump::truss::detail
