// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "parallel.hpp"
#include "system.hpp"

namespace statejump::truss {

namespace {

/// Setting as many numbers to zero takes some ten times as long as starting a thread.
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
  // A million joints write some 1e8 places: beside them only their rows are held, column by column.
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
  moved.resize(3, 0);  // of which copies have no use
}

namespace detail {

namespace {

/// Adds forces on nodes and their derivatives, through the nodes' free directions.
class NodeWriter {
 public:
  NodeWriter(const std::vector<JointWriter::Place>& places, AssemblyStrand& to)
      : places_(places), to_(to) {}

  const JointWriter::Place& at(int node) const { return places_[index(node)]; }
  void force(int node, const Vector3d& value) {
    const JointWriter::Place& place = at(node);
    for (int i = 0; i < place.freedoms; ++i) {
      to_.residual(place.row + i, place.directions->col(i).dot(value));
    }
  }
  /// Derivative of a node's force by another node's displacement: `value(direction of the force,
  /// direction of the displacement)`.
  template <class Value>
  void block(int row_node, int column_node, Value&& value) {
    const JointWriter::Place& rows = at(row_node);
    const JointWriter::Place& columns = at(column_node);
    to_.block(rows.row, rows.freedoms, columns.row, columns.freedoms, value);
  }
  /// A vector along the directions in which a node moves.
  Vector3d seen(int node, const Vector3d& vector) const {
    return at(node).directions->transpose() * vector;
  }

 private:
  const std::vector<JointWriter::Place>& places_;
  AssemblyStrand& to_;
};

}  // namespace

void System::assemble_bars(const Region& region, const std::vector<double>& changes,
                           AssemblyStrand& to) const {
  const Model& model = *model_;
  NodeWriter nodes(place_, to);
  for (const int node : region.loaded) {
    const Vector3d& load = model.nodes[index(node)].load;
    nodes.force(node, -load);
    to.carries(load.lpNorm<Eigen::Infinity>());
  }

  const auto moved_between = [&](int first, int second) -> Vector3d {
    return to.moved().col(second) - to.moved().col(first);
  };
  const auto bar = [&](int first, int second, const Vector3d& direction, double length,
                       const Axial& axial) {
    nodes.force(first, -axial.tension * direction);
    nodes.force(second, axial.tension * direction);
    to.carries(axial.tension);
    if (to.residual_only()) return;
    // Along the bar its stiffness, across it that of the tension.
    const double across = axial.tension / length;
    const double more = axial.stiffness - across;
    const auto own = [&](int node, const Vector3d& along) {
      nodes.block(node, node, [&](int i, int j) {
        return more * along[i] * along[j] + (i == j ? across : 0.0);
      });
    };
    const JointWriter::Place& one = nodes.at(first);
    const JointWriter::Place& other = nodes.at(second);
    // Of the places of a node that is fixed there are none.
    if (one.freedoms == 0 || other.freedoms == 0) {
      if (one.freedoms > 0) own(first, nodes.seen(first, direction));
      if (other.freedoms > 0) own(second, nodes.seen(second, direction));
      return;
    }
    const Vector3d at_first = nodes.seen(first, direction);
    const Vector3d at_second =
        one.directions == other.directions ? at_first : nodes.seen(second, direction);
    const Matrix3d both = one.directions->transpose() * *other.directions;
    own(first, at_first);
    nodes.block(first, second, [&](int i, int j) {
      return -(more * at_first[i] * at_second[j] + across * both(i, j));
    });
    nodes.block(second, first, [&](int i, int j) {
      return -(more * at_second[i] * at_first[j] + across * both(j, i));
    });
    own(second, at_second);
  };
  for (const int i : region.links) {
    const Link& link = model.links[index(i)];
    const Lengths length = lengths_between(link.first, link.second, to.moved());
    const double change = link.temperature_fraction * changes[index(link.program)];
    bar(link.first, link.second, length.along / length.now, length.now,
        link_axial(link, length.growth, length.drawn, change));
  }
  for (const int i : region.springs) {
    const AxialSpring& spring = model.springs[index(i)];
    const Lengths length = lengths_between(spring.first, spring.second, to.moved());
    const Axial axial = spring_axial(spring, length);
    if (spring.cable) to.piece(axial.stiffness > 0.0 ? 0 : 1);
    bar(spring.first, spring.second, length.along / length.now, length.now, axial);
  }

  for (const int i : region.torsion_springs) {
    const TorsionSpring& spring = model.torsion_springs[index(i)];
    const Matrix32& plane = torsion_plane_[index(i)];
    std::array<int, 2> links{spring.first_link, spring.second_link};
    // The angle runs from the first link to the second; that of a single link from the ground.
    std::array<double, 2> sign{-1.0, 1.0};
    if (spring.second_link < 0) sign[0] = 1.0;
    double angle = 0.0;
    std::array<Vector2d, 2> now;
    for (std::size_t k = 0; k < 2; ++k) {
      if (links[k] < 0) continue;
      const Link& link = model.links[index(links[k])];
      const Vector2d before = plane.transpose() * (drawn(link.second) - drawn(link.first));
      const Vector2d moved = plane.transpose() * moved_between(link.first, link.second);
      now[k] = before + moved;
      angle += sign[k] * turn_by(before, moved);
    }
    const double moment = spring.stiffness * (angle - spring.free_angle);
    // The angle by the places of the ends: that of the second of a link as turn, of the first
    // against.
    struct End {
      std::size_t link;
      int node;
      Vector3d turns;    ///< Derivative of the angle along the node's directions [rad/m].
      Vector3d outward;  ///< Direction of the link over its length, along the same [1/m].
    };
    std::array<End, 4> ends;
    std::size_t count = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      if (links[k] < 0) continue;
      const Link& link = model.links[index(links[k])];
      const double squared = now[k].squaredNorm();
      const Vector3d turns = plane * (sign[k] / squared * turned_left(now[k]));
      nodes.force(link.second, moment * turns);
      nodes.force(link.first, -moment * turns);
      to.carries(moment * turns.norm());
      if (to.residual_only()) continue;
      const Vector3d outward = plane * (now[k] / squared);
      ends[count++] = {k, link.second, nodes.seen(link.second, turns),
                       nodes.seen(link.second, outward)};
      ends[count++] = {k, link.first, -nodes.seen(link.first, turns),
                       -nodes.seen(link.first, outward)};
    }
    for (std::size_t a = 0; a < count; ++a) {
      const End& by = ends[a];
      for (std::size_t b = 0; b < count; ++b) {
        const End& of = ends[b];
        const double bends = by.link == of.link ? moment : 0.0;
        nodes.block(by.node, of.node, [&](int m, int n) {
          return spring.stiffness * by.turns[m] * of.turns[n] -
                 bends * (by.outward[m] * of.turns[n] + by.turns[m] * of.outward[n]);
        });
      }
    }
  }
}

template <class Write>
void System::write_regions(Assembly& to, Write&& write) const {
  const std::size_t regions = regions_.apart.size();
  if (to.records()) {
    // Places are written down one after the other.
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
    if (parts != Parts::joints) assemble_bars(region, changes, strand);
    if (parts == Parts::bars) return;
    for (const int i : region.joints) {
      JointWriter to_joint = writer(i, strand);
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
  JointWriter to_joint = writer(joint, strand);
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
    NodeWriter nodes(place_, strand);
    for (const int i : region.links) {
      const Link& link = model.links[index(i)];
      const double growth = link.stress_free_length * link.thermal_expansion *
                            link.temperature_fraction * program_rates[index(link.program)];
      if (growth == 0.0) continue;
      // N = E A (L/l_T − 1) by l_T.
      const Lengths length = lengths_between(link.first, link.second, to.moved);
      const double change = link.temperature_fraction * changes[index(link.program)];
      const double free = thermal::length(link.stress_free_length, link.thermal_expansion, change);
      const Vector3d tension = -link.axial_stiffness * growth / (free * free) * length.along;
      nodes.force(link.first, -tension);
      nodes.force(link.second, tension);
    }
    for (const int i : region.joints) {
      const JointFrame& frame = frames_[index(i)];
      if (frame.program < 0) continue;
      JointWriter to_joint = writer(i, strand);
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
    // The joint alone: the unknowns of its nodes, then its forces.
    constexpr int forces_from = 3 * most_joint_nodes;
    const JointFrame& frame = frames_[index(i)];
    std::array<JointWriter::Place, most_joint_nodes> places;
    VectorXd own_rate = VectorXd::Zero(forces_from + most_joint_forces);
    for (int k = 0; k < most_joint_nodes; ++k) {
      const int node = frame.nodes[index(k)];
      const JointWriter::Place& place = node < 0 ? place_.back() : place_[index(node)];
      places[index(k)] = {3 * k, place.freedoms, place.directions};
      own_rate.segment(3 * k, place.freedoms) = rate.segment(place.row, place.freedoms);
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
    // One that slips is asked for the rate of what would be closed if it stuck.
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

JointWriter System::writer(int joint, AssemblyStrand& to) const {
  JointWriter made(to);
  for (std::size_t k = 0; k < most_joint_nodes; ++k) {
    const int node = frames_[index(joint)].nodes[k];
    made.places[k] = node < 0 ? place_.back() : place_[index(node)];
  }
  made.first_force = force_row_[index(joint)];
  return made;
}

void System::evaluate(const VectorXd& z, double time, const StepStart& start,
                      const Statuses& statuses, JointModel joints, double opening,
                      Assembly& to) const {
  assemble(Parts::all, z, time, start, statuses, joints, opening, to);
}

void System::evaluate_bars(const VectorXd& z, double time, Assembly& to) const {
  assemble(Parts::bars, z, time, {}, {}, JointModel::friction, 1.0, to);
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
