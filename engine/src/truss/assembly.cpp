// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "system.hpp"

namespace statejump::truss {

void Assembly::record() {
  // A million joints write some 1e8 places: beside them only their rows are held, column by column.
  const Eigen::Index n = residual.size();
  std::vector<int> rows(places_.size()), next(static_cast<std::size_t>(n) + 1, 0);
  for (const auto& place : places_) ++next[static_cast<std::size_t>(place.second) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (const auto& [row, column] : places_) {
    rows[static_cast<std::size_t>(next[static_cast<std::size_t>(column)]++)] = row;
  }
  jacobian.resize(n, n);
  auto kept = rows.begin(), begin = rows.begin();
  for (Eigen::Index column = 0; column < n; ++column) {
    const auto end = rows.begin() + next[static_cast<std::size_t>(column)];
    std::sort(begin, end);
    kept = std::copy(begin, std::unique(begin, end), kept);
    jacobian.outerIndexPtr()[column + 1] = static_cast<int>(kept - rows.begin());
    begin = end;
  }
  jacobian.resizeNonZeros(kept - rows.begin());
  std::copy(rows.begin(), kept, jacobian.innerIndexPtr());
  std::fill_n(jacobian.valuePtr(), jacobian.nonZeros(), 0.0);
  rows = {};
  std::vector<int> slots;
  slots.reserve(places_.size());
  for (const auto& [row, column] : places_) {
    const int* inner = jacobian.innerIndexPtr();
    const int* first = inner + jacobian.outerIndexPtr()[column];
    const int* last = inner + jacobian.outerIndexPtr()[column + 1];
    slots.push_back(static_cast<int>(std::lower_bound(first, last, row) - inner));
  }
  places_ = {};
  slots_ = std::make_shared<const std::vector<int>>(std::move(slots));
}

namespace detail {

namespace {

/// Adds forces on nodes and their derivatives, through the nodes' free directions.
class NodeWriter {
 public:
  NodeWriter(const std::vector<JointWriter::Place>& places, Assembly& to)
      : places_(places), to_(to) {}

  const JointWriter::Place& at(int node) const { return places_[index(node)]; }
  void force(int node, const Vector3d& value) {
    const JointWriter::Place& place = at(node);
    for (int i = 0; i < place.freedoms; ++i) {
      to_.residual[place.row + i] += place.directions->col(i).dot(value);
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
  Assembly& to_;
};

}  // namespace

void System::assemble_bars(double time, Assembly& to) const {
  const Model& model = *model_;
  NodeWriter nodes(place_, to);
  std::vector<double> changes;
  for (const auto& program : model.programs) changes.push_back(program.temperature_change(time));

  for (const int node : loaded_) {
    const Vector3d& load = model.nodes[index(node)].load;
    nodes.force(node, -load);
    to.largest_force = std::max(to.largest_force, load.lpNorm<Eigen::Infinity>());
  }

  const auto moved_between = [&](int first, int second) -> Vector3d {
    return to.moved.col(second) - to.moved.col(first);
  };
  const auto lengths_of = [&](int first, int second) {
    return lengths(drawn_.col(second) - drawn_.col(first), moved_between(first, second));
  };
  const auto bar = [&](int first, int second, const Vector3d& direction, double length,
                       const Axial& axial) {
    nodes.force(first, -axial.tension * direction);
    nodes.force(second, axial.tension * direction);
    to.largest_force = std::max(to.largest_force, std::abs(axial.tension));
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
  for (const Link& link : model.links) {
    const Lengths length = lengths_of(link.first, link.second);
    const double change = link.temperature_fraction * changes[index(link.program)];
    bar(link.first, link.second, length.along / length.now, length.now,
        link_axial(link, length.growth, length.drawn, change));
  }
  for (const AxialSpring& spring : model.springs) {
    const Lengths length = lengths_of(spring.first, spring.second);
    bar(spring.first, spring.second, length.along / length.now, length.now,
        spring_axial(spring, length));
  }

  for (std::size_t i = 0; i < model.torsion_springs.size(); ++i) {
    const TorsionSpring& spring = model.torsion_springs[i];
    const Matrix32& plane = torsion_plane_[i];
    std::array<int, 2> links{spring.first_link, spring.second_link};
    // The angle runs from the first link to the second; that of a single link from the ground.
    std::array<double, 2> sign{-1.0, 1.0};
    if (spring.second_link < 0) sign[0] = 1.0;
    double angle = 0.0;
    std::array<Vector2d, 2> now;
    for (std::size_t k = 0; k < 2; ++k) {
      if (links[k] < 0) continue;
      const Link& link = model.links[index(links[k])];
      const Vector2d drawn = plane.transpose() * (drawn_.col(link.second) - drawn_.col(link.first));
      const Vector2d moved = plane.transpose() * moved_between(link.first, link.second);
      now[k] = drawn + moved;
      angle += sign[k] * std::atan2(cross(drawn, moved), drawn.dot(now[k]));
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
      to.largest_force = std::max(to.largest_force, std::abs(moment) * turns.norm());
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

void System::assemble_joints(const VectorXd& z, double time, const StepStart& start,
                             const Statuses& statuses, JointModel joints, double opening,
                             Assembly& to) const {
  const Model& model = *model_;
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    JointWriter to_joint = writer(static_cast<int>(i), to);
    const Trial at = trial(static_cast<int>(i), z, to.moved, time, start, joints, opening);
    std::visit([&](const auto& one) { one.evaluate(at, statuses[i], to_joint); }, model.joints[i]);
  }
}

void System::evaluate_joint(int joint, const VectorXd& z, double time, const StepStart& start,
                            JointStatus status, JointModel model, double opening,
                            Assembly& to) const {
  to.entries.clear();
  to.residual.segment(force_row(joint), force_count(joint)).setZero();
  JointWriter to_joint = writer(joint, to);
  const Trial at = trial(joint, z, time, start, model, opening);
  std::visit([&](const auto& one) { one.evaluate(at, status, to_joint); },
             model_->joints[index(joint)]);
}

VectorXd System::heating(const VectorXd& z, double time, const StepStart& start,
                         const Statuses& statuses, const std::vector<double>& program_rates) const {
  const Model& model = *model_;
  Assembly to(unknowns_);
  to.residual.setZero();
  NodeWriter nodes(place_, to);
  for (const Link& link : model.links) {
    const double growth = link.stress_free_length * link.thermal_expansion *
                          link.temperature_fraction * program_rates[index(link.program)];
    if (growth == 0.0) continue;
    // N = E A (L/l_T − 1) by l_T.
    const Lengths length = lengths_between(link.first, link.second, z);
    const double change = model.temperature_change(link.program, link.temperature_fraction, time);
    const double free = thermal::length(link.stress_free_length, link.thermal_expansion, change);
    const Vector3d tension = -link.axial_stiffness * growth / (free * free) * length.along;
    nodes.force(link.first, -tension);
    nodes.force(link.second, tension);
  }
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const JointFrame& frame = frames_[i];
    if (frame.program < 0) continue;
    JointWriter to_joint = writer(static_cast<int>(i), to);
    const Trial at = trial(static_cast<int>(i), z, time, start, JointModel::friction, 1.0);
    const double rate = frame.temperature_fraction * program_rates[index(frame.program)];
    std::visit([&](const auto& one) { one.warm(at, statuses[i], rate, to_joint); },
               model.joints[i]);
  }
  return to.residual;
}

VectorXd System::slide_rates(const VectorXd& z, double time, const StepStart& start,
                             const Statuses& statuses, const VectorXd& rate,
                             const std::vector<double>& program_rates) const {
  const Model& model = *model_;
  VectorXd rates = VectorXd::Zero(static_cast<Eigen::Index>(model.joints.size()));
  // A joint that slips is asked for the rate of what would be closed if it stuck.
  Assembly moving(rate);
  Assembly heated(unknowns_);
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (!is_slip(statuses[i])) continue;
    Trial at = trial(static_cast<int>(i), z, time, start, JointModel::friction, 1.0);
    at.unslipped = true;
    const JointFrame& frame = frames_[i];
    const double warming =
        frame.program < 0 ? 0.0 : frame.temperature_fraction * program_rates[index(frame.program)];
    JointWriter to_moving = writer(static_cast<int>(i), moving);
    JointWriter to_heated = writer(static_cast<int>(i), heated);
    std::visit(
        [&](const auto& one) {
          const int row = force_row_[i] + one.slide_row;
          heated.residual[row] = 0.0;
          one.evaluate(at, JointStatus::stick, to_moving);
          one.warm(at, JointStatus::stick, warming, to_heated);
          rates[static_cast<Eigen::Index>(i)] = moving.product[row] + heated.residual[row];
        },
        model.joints[i]);
  }
  return rates;
}

JointWriter System::writer(int joint, Assembly& to) const {
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
  to.clear();
  displacements(z, to.moved);
  assemble_bars(time, to);
  assemble_joints(z, time, start, statuses, joints, opening, to);
}

void System::evaluate_bars(const VectorXd& z, double time, Assembly& to) const {
  to.clear();
  displacements(z, to.moved);
  assemble_bars(time, to);
}

void System::evaluate_joints(const VectorXd& z, double time, const StepStart& start,
                             const Statuses& statuses, Assembly& to) const {
  to.clear();
  displacements(z, to.moved);
  assemble_joints(z, time, start, statuses, JointModel::friction, 1.0, to);
}

Assembly System::recorded(Parts parts) const {
  Assembly made(unknowns_);
  const VectorXd z = VectorXd::Zero(unknowns_);
  const Statuses statuses = all_stick();
  displacements(z, made.moved);
  if (parts != Parts::joints) assemble_bars(0.0, made);
  if (parts != Parts::bars) {
    assemble_joints(z, 0.0, begin(z, 0.0, statuses, 1.0), statuses, JointModel::pins, 1.0, made);
  }
  made.record();
  return made;
}

}  // namespace detail
}  // namespace statejump::truss
