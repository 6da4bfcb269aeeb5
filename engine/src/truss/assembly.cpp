// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "elements/writer.hpp"
#include "parallel.hpp"
#include "system.hpp"

namespace statejump::truss {

namespace {

/// Setting this many numbers to zero takes one thread about ten times as long as starting a thread.
constexpr std::size_t numbers_at_once = 500000;

}  // namespace

void Assembly::clear() {
  residual.setZero();
  if (slots_ != nullptr && !residual_only_) {
    values_.resize(static_cast<Eigen::Index>(slots_->inner.size()));
    double* values = values_.data();
    each_in_parallel(static_cast<std::size_t>(values_.size()), numbers_at_once,
                     [values](std::size_t i) { values[i] = 0.0; });
  }
  largest_force = 0.0;
  pieces = 0;
}

void Assembly::record() {
  // A million joints write some 1e8 positions. To save memory, only rows are stored besides, column
  // by column.
  const Eigen::Index n = residual.size();
  std::vector<std::size_t> next(static_cast<std::size_t>(n) + 1, 0);
  for (const Run& run : runs_) {
    next[static_cast<std::size_t>(run.column) + 1] += static_cast<std::size_t>(run.length);
  }
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<int> rows(next.back());
  for (const Run& run : runs_) {
    std::size_t& to = next[static_cast<std::size_t>(run.column)];
    std::iota(rows.data() + to, rows.data() + to + run.length, run.row);
    to += static_cast<std::size_t>(run.length);
  }
  Slots made{std::vector<int>(static_cast<std::size_t>(n) + 1, 0), {}, {}, std::move(begin_)};
  auto kept = rows.begin(), begin = rows.begin();
  for (std::size_t column = 0; column < static_cast<std::size_t>(n); ++column) {
    const auto end = rows.begin() + static_cast<std::ptrdiff_t>(next[column]);
    std::sort(begin, end);
    kept = std::copy(begin, std::unique(begin, end), kept);
    made.outer[column + 1] = static_cast<int>(kept - rows.begin());
    begin = end;
  }
  made.inner.assign(rows.begin(), kept);
  rows = std::vector<int>();
  made.entries.reserve(runs_.size());
  const int* inner = made.inner.data();
  for (const Run& run : runs_) {
    const int* first = inner + made.outer[static_cast<std::size_t>(run.column)];
    const int* last = inner + made.outer[static_cast<std::size_t>(run.column) + 1];
    made.entries.push_back(static_cast<int>(std::lower_bound(first, last, run.row) - inner));
  }
  runs_ = std::vector<Run>();
  slots_ = std::make_shared<const Slots>(std::move(made));
  moved.resize(3, 0);  // copies do not use it
}

namespace detail {

void System::assemble_elements(const Region& region, const std::vector<double>& changes,
                               AssemblyStrand& to) const {
  ElementWriter writer(dofs_, to);
  for (const int site : region.loaded) {
    const Vector3d load = load_on(site);
    writer.force(site, -load);
    writer.carries(load.lpNorm<Eigen::Infinity>());
  }
  const ElementState state(drawn_, to.moved(), changes);
  each_element_type([&](const auto& elements, const auto& frames, std::size_t type) {
    for (const int i : region.elements[type]) {
      elements[index(i)].evaluate(frames[index(i)], state, writer);
    }
  });
}

template <class Write>
void System::write_regions(Assembly& to, Write&& write) const {
  const std::size_t regions = regions_.apart.size();
  if (to.records()) {
    // The sparsity pattern is recorded sequentially.
    for (std::size_t k = 0; k <= regions; ++k) {
      AssemblyStrand strand(to, k);
      write(k < regions ? regions_.apart[k] : regions_.between, strand);
    }
    return;
  }
  std::vector<AssemblyStrand> strands;
  for (std::size_t k = 0; k <= regions; ++k) strands.emplace_back(to, k);
  in_parallel(regions, [&](std::size_t k) { write(regions_.apart[k], strands[k]); });
  write(regions_.between, strands.back());
  for (AssemblyStrand& strand : strands) strand.end();
}

void System::assemble(Parts parts, const VectorXd& z, double time, const StepStart& start,
                      const Statuses& statuses, JointModel joints, double opening,
                      Assembly& to) const {
  to.clear();
  displacements(z, to.moved);
  const std::vector<double> changes = temperature_changes(time);
  const auto write = [&](const Region& region, AssemblyStrand& strand) {
    if (parts != Parts::joints) assemble_elements(region, changes, strand);
    if (parts == Parts::elements) return;
    for (const int i : region.joints) {
      JointWriter to_joint = joint_writer(i, strand);
      Trial at = trial(i, z, to.moved, time, start, joints, opening);
      at.in_motion = parts == Parts::joints;
      const JointStatus status = statuses[index(i)];
      std::visit([&](const auto& one) { one.evaluate(at, status, to_joint); },
                 model_->joints[index(i)]);
    }
  };
  write_regions(to, write);
}

void System::evaluate_joint(int joint, const VectorXd& z, double time, const StepStart& start,
                            JointStatus status, JointModel model, double opening,
                            Assembly& to) const {
  to.entries.clear();
  to.residual.segment(force_row(joint), force_count(joint)).setZero();
  AssemblyStrand strand(to, 0);
  JointWriter to_joint = joint_writer(joint, strand);
  const Trial at = trial(joint, z, time, start, model, opening);
  std::visit([&](const auto& one) { one.evaluate(at, status, to_joint); },
             model_->joints[index(joint)]);
}

VectorXd System::heating(const VectorXd& z, double time, const StepStart& start,
                         const Statuses& statuses, const std::vector<double>& program_rates) const {
  const Model& model = *model_;
  Assembly to = Assembly::without_jacobian(unknowns_);
  to.residual.setZero();
  displacements(z, to.moved);
  const std::vector<double> changes = temperature_changes(time);
  const auto write = [&](const Region& region, AssemblyStrand& strand) {
    ElementWriter writer(dofs_, strand);
    const ElementState state(drawn_, to.moved, changes);
    each_element_type([&](const auto& elements, const auto& frames, std::size_t type) {
      for (const int i : region.elements[type]) {
        elements[index(i)].thermal_rate(frames[index(i)], state, program_rates, writer);
      }
    });
    for (const int i : region.joints) {
      const JointFrame& frame = frames_[index(i)];
      if (frame.program < 0) continue;
      JointWriter to_joint = joint_writer(i, strand);
      const Trial at = trial(i, z, to.moved, time, start, JointModel::friction, 1.0);
      const double rate = frame.temperature_fraction * program_rates[index(frame.program)];
      std::visit([&](const auto& one) { one.warm(at, statuses[index(i)], rate, to_joint); },
                 model.joints[index(i)]);
    }
  };
  write_regions(to, write);
  return to.residual;
}

VectorXd System::slide_rates(const VectorXd& z, double time, const StepStart& start,
                             const Statuses& statuses, const VectorXd& rate,
                             const std::vector<double>& program_rates) const {
  const Model& model = *model_;
  VectorXd rates = VectorXd::Zero(static_cast<Eigen::Index>(model.joints.size()));
  each_joint([&](int i) {
    if (!is_slip(statuses[index(i)])) return;
    // Local dofs: 3 per node, then the forces of the joint.
    constexpr int forces_from = 3 * most_joint_nodes;
    const JointFrame& frame = frames_[index(i)];
    std::array<NodeDofs, most_joint_nodes> places;
    VectorXd own_rate = VectorXd::Zero(forces_from + most_joint_forces);
    for (int k = 0; k < most_joint_nodes; ++k) {
      const NodeDofs& place = dofs_.at(frame.nodes[index(k)]);
      places[index(k)] = {3 * k, place.freedoms, place.directions};
      own_rate.segment<3>(3 * k) = DofMap::along_directions(place, rate);
    }
    own_rate.segment(forces_from, frame.forces) = rate.segment(force_row_[index(i)], frame.forces);
    Assembly moving(own_rate);
    Assembly heated = Assembly::without_jacobian(own_rate.size());
    heated.residual.setZero();
    AssemblyStrand of_moving(moving, 0);
    AssemblyStrand of_heated(heated, 0);
    JointWriter to_moving(of_moving);
    JointWriter to_heated(of_heated);
    to_moving.places = to_heated.places = places;
    to_moving.first_force = to_heated.first_force = forces_from;
    // Evaluates the slide row as if the contact stuck: its rate is the slip rate.
    Trial at = trial(i, z, time, start, JointModel::friction, 1.0);
    at.unslipped = true;
    const double warming =
        frame.program < 0 ? 0.0 : frame.temperature_fraction * program_rates[index(frame.program)];
    std::visit(
        [&](const auto& one) {
          const int row = forces_from + one.slide_row;
          one.evaluate(at, JointStatus::stick, to_moving);
          one.warm(at, JointStatus::stick, warming, to_heated);
          rates[i] = moving.product[row] + heated.residual[row];
        },
        model.joints[index(i)]);
  });
  return rates;
}

JointWriter System::joint_writer(int joint, AssemblyStrand& to) const {
  JointWriter made(to);
  for (std::size_t k = 0; k < most_joint_nodes; ++k) {
    made.places[k] = dofs_.at(frames_[index(joint)].nodes[k]);
  }
  made.first_force = force_row_[index(joint)];
  return made;
}

void System::evaluate(const VectorXd& z, double time, const StepStart& start,
                      const Statuses& statuses, JointModel joints, double opening,
                      Assembly& to) const {
  assemble(Parts::all, z, time, start, statuses, joints, opening, to);
}

void System::evaluate_elements(const VectorXd& z, double time, Assembly& to) const {
  assemble(Parts::elements, z, time, {}, {}, JointModel::friction, 1.0, to);
}

void System::evaluate_joints(const VectorXd& z, double time, const StepStart& start,
                             const Statuses& statuses, Assembly& to) const {
  assemble(Parts::joints, z, time, start, statuses, JointModel::friction, 1.0, to);
}

Assembly System::recorded(Parts parts) const {
  Assembly made(unknowns_);
  const VectorXd z = VectorXd::Zero(unknowns_);
  const Statuses statuses = all_stick();
  assemble(parts, z, 0.0, begin(z, 0.0, statuses, 1.0), statuses, JointModel::pins, 1.0, made);
  made.record();
  return made;
}

}  // namespace detail
}  // namespace statejump::truss
