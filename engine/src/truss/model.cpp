// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>

#include "dof_map.hpp"
#include "elimination.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::truss {

namespace {

void check(bool holds, const std::string& item, const char* field, double value,
           const char* range) {
  if (!holds) throw kernel::OutOfRange(item, field, value, range);
}

void check_index(int i, std::size_t count, const std::string& item, const char* field) {
  check(i >= 0 && static_cast<std::size_t>(i) < count, item, field, i, "an existing item");
}

std::string named(const char* kind, const std::string& name) {
  return std::string(kind) + " '" + name + "'";
}

void check_axis(const std::string& item, const Eigen::Vector3d& axis) {
  check(std::abs(axis.norm() - 1.0) < 1e-9, item, "length of the axis", axis.norm(), "1");
}

/// Rejects free directions that are not orthonormal.
void check_directions(const std::string& item, const Eigen::Matrix3d& directions, int free) {
  const Eigen::Matrix3d product = directions.transpose() * directions;
  for (int i = 0; i < free; ++i) {
    for (int j = 0; j < free; ++j) {
      check(std::abs(product(i, j) - (i == j ? 1.0 : 0.0)) < 1e-12, item,
            "product of free directions", product(i, j), "1 or, of different ones, 0");
    }
  }
}

/// Allowed range of a number as text: "finite, > 0 N".
std::string range(Allowed allowed, const std::string& unit) {
  const std::string with_unit = unit == "-" ? "" : " " + unit;
  switch (allowed) {
    case Allowed::positive:
      return "finite, > 0" + with_unit;
    case Allowed::not_negative:
      return "finite, >= 0" + with_unit;
    case Allowed::positive_or_infinite:
      return "> 0" + with_unit;
    case Allowed::distance_or_infinite:
      return ">= 0" + with_unit;
    default:
      return unit == "-" ? "finite" : "finite [" + unit + "]";
  }
}

bool allows(Allowed allowed, double value) {
  switch (allowed) {
    case Allowed::positive:
      return std::isfinite(value) && value > 0.0;
    case Allowed::not_negative:
      return std::isfinite(value) && value >= 0.0;
    case Allowed::positive_or_infinite:
      return value > 0.0;
    case Allowed::distance_or_infinite:
      return value >= 0.0;
    default:
      return std::isfinite(value);
  }
}

/// Checks that the parameters of an element or a joint are within the ranges of its parameter
/// table.
template <class Type>
void check_parameters(const Type& one, const Model& model) {
  const std::string item = named(Type::kind, one.name);
  for (const Parameter<Type>& parameter : Type::parameters()) {
    const auto check_member = [&](auto member) {
      const auto& value = one.*member;
      using Value = std::decay_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, double>) {
        check(allows(parameter.allowed, value), item, parameter.words, value,
              range(parameter.allowed, parameter.unit).c_str());
      } else if constexpr (std::is_same_v<Value, int>) {
        if (parameter.allowed == Allowed::flag) {
          check(value == 0 || value == 1, item, parameter.words, value, "0 or 1");
          return;
        }
        if (parameter.allowed == Allowed::count) {
          check(value >= 1, item, parameter.words, value, ">= 1");
          return;
        }
        const bool may_be_none = parameter.allowed == Allowed::node_or_ground ||
                                 parameter.allowed == Allowed::link_or_none;
        if (may_be_none && value == -1) return;
        const bool is_node =
            parameter.allowed == Allowed::node || parameter.allowed == Allowed::node_or_ground;
        const std::size_t count = is_node                                 ? model.nodes.size()
                                  : parameter.allowed == Allowed::program ? model.programs.size()
                                                                          : model.links.size();
        check_index(value, count, item, parameter.words);
      } else if constexpr (std::is_same_v<Value, Eigen::Vector3d>) {
        if (parameter.allowed == Allowed::direction) return check_axis(item, value);
        check(value.allFinite(), item, parameter.words, value.norm(),
              range(parameter.allowed, parameter.unit).c_str());
      }
    };
    std::visit(check_member, parameter.member);
  }
}

TemperatureRange range_of(const thermal::Program& program) {
  TemperatureRange range;
  for (const auto& branch : thermal::monotone_branches(program)) {
    range.lowest = std::min({range.lowest, branch.start, branch.end});
    range.highest = std::max({range.highest, branch.start, branch.end});
  }
  return range;
}

void check_constraint(const Constraint& constraint, const Model& model) {
  const std::string item = named(Constraint::kind, constraint.name);
  check(!constraint.terms.empty(), item, "number of terms", 0.0, ">= 1");
  // Factors of displacements have no unit, those of rotations metres: each compares with its own.
  std::array<double, 2> largest{};
  const auto largest_beside = [&](const ConstraintTerm& term) -> double& {
    return largest[term.node < rotation_site(model, 0) ? 0 : 1];
  };
  for (const ConstraintTerm& term : constraint.terms) {
    check_index(term.node, 2 * model.nodes.size(), item, "node");
    check(term.factor.allFinite(), item, "factor", term.factor.norm(), "finite");
    largest_beside(term) = std::max(largest_beside(term), term.factor.norm());
  }
  for (const ConstraintTerm& term : constraint.terms) {
    const double size = term.factor.norm();
    check(size > 0.0 && size >= Constraint::least_factor * largest_beside(term), item, "factor",
          size, "not 0, at least 1e-9 of the largest factor");
  }
}

/// Rejects a joint that constrains its nodes along a direction in which supports or constraints
/// already prevent their relative motion. Otherwise two forces would constrain one direction.
void check_held_directions(const Model& model) {
  const detail::DofMap dofs(model);
  for (const Joint& joint : model.joints) {
    const JointFrame frame = std::visit([&](const auto& one) { return one.frame(model); }, joint);
    for (int k = 0; k < 3; ++k) {
      if (!frame.holds[static_cast<std::size_t>(k)]) continue;
      const Eigen::Vector3d along = frame.axes.col(k);
      if (dofs.moves_apart(frame.nodes[0], frame.nodes[1], along)) continue;
      throw std::invalid_argument(named(kind_of(joint), name_of(joint)) +
                                  ": constraints hold its nodes in a direction that it holds "
                                  "itself; leave out the constraint of its nodes");
    }
  }
}

/// Calls `reach` with each node whose rotation is in a constraint, and the distances of the other
/// nodes of the constraint.
template <class Reach>
void reach_constrained(const Model& model, const Reach& reach) {
  const int count = rotation_site(model, 0);
  for (const Constraint& constraint : model.constraints) {
    for (const ConstraintTerm& term : constraint.terms) {
      if (term.node < count || term.node >= 2 * count) continue;  // validate() rejects the last
      const Node& node = model.nodes[static_cast<std::size_t>(term.node - count)];
      for (const ConstraintTerm& other : constraint.terms) {
        if (other.node < 0 || other.node >= count) continue;
        const Node& far = model.nodes[static_cast<std::size_t>(other.node)];
        reach(term.node - count, (far.position - node.position).norm());
      }
    }
  }
}

}  // namespace

void Model::validate() const {
  kernel::require(!programs.empty(), "number of programs", 0, ">= 1");
  std::vector<TemperatureRange> ranges;
  for (const auto& program : programs) {
    program.validate();
    const double first = programs.front().duration();
    kernel::require(std::abs(program.duration() - first) <= same_time * first,
                    "duration of a program", program.duration(), "that of the first program [s]");
    ranges.push_back(range_of(program));
  }
  for (const Node& node : nodes) {
    const std::string item = named("node", node.name);
    check(node.position.allFinite(), item, "position", node.position.norm(), "finite [m]");
    check(node.load.allFinite(), item, "load", node.load.norm(), "finite [N]");
    check(node.freedoms >= 0 && node.freedoms <= 3, item, "freedoms", node.freedoms, "0 to 3");
    check_directions(item, node.free_directions.matrix(), node.freedoms);
    check(node.moment.allFinite(), item, "moment", node.moment.norm(), "finite [N m]");
    check(node.rotations >= 0 && node.rotations <= 3, item, "rotations", node.rotations, "0 to 3");
    check(std::isfinite(node.arm) && node.arm > 0.0, item, "arm", node.arm, "finite, > 0 m");
    check_directions(item, node.rotation_directions.matrix(), node.rotations);
  }
  const auto check_elements = [&](const auto& elements) {
    for (const auto& one : elements) {
      check_parameters(one, *this);
      one.validate(*this, ranges);
    }
  };
  std::apply([&](const auto&... all) { (check_elements(all), ...); }, lists());
  for (const Joint& joint : joints) {
    std::visit(
        [this](const auto& one) {
          check_parameters(one, *this);
          one.validate(*this);
        },
        joint);
  }
  for (const Constraint& constraint : constraints) check_constraint(constraint, *this);
  if (!constraints.empty() || std::any_of(joints.begin(), joints.end(), has_ties)) {
    check_held_directions(*this);
  }
}

std::vector<int> Model::redundant_constraints() const {
  return detail::eliminate(*this).redundant;
}

double Model::lowest_strain(int program, double per_kelvin) const {
  const TemperatureRange range = range_of(programs[static_cast<std::size_t>(program)]);
  return std::min(per_kelvin * range.lowest, per_kelvin * range.highest);
}

bool has_ties(const Joint& joint) {
  return std::visit(
      []<class Type>(const Type& one) {
        return requires(const Model& of) {
          one.ties(of);
        };
      },
      joint);
}

std::vector<Constraint> ties_of(const Joint& joint, const Model& model) {
  return std::visit(
      [&](const auto& one) -> std::vector<Constraint> {
        if constexpr (requires { one.ties(model); }) return one.ties(model);
        return {};
      },
      joint);
}

void measure_rotations(Model& model) {
  std::vector<double> longest(model.nodes.size(), 0.0);
  const auto reach = [&](int node, double length) {
    if (node < 0 || static_cast<std::size_t>(node) >= longest.size()) return;
    double& longest_of_node = longest[static_cast<std::size_t>(node)];
    longest_of_node = std::max(longest_of_node, length);
  };
  for (const Joint& joint : model.joints) {
    const auto* rigid = std::get_if<RigidArm>(&joint);
    if (rigid == nullptr) continue;
    const auto one = static_cast<std::size_t>(rigid->master);
    const auto other = static_cast<std::size_t>(rigid->node);
    if (one >= longest.size() || other >= longest.size()) continue;  // validate() rejects it
    const double length = (model.nodes[other].position - model.nodes[one].position).norm();
    reach(rigid->master, length);
    reach(rigid->node, length);
  }
  for (const Beam& beam : model.beams) {
    const auto one = static_cast<std::size_t>(beam.first);
    const auto other = static_cast<std::size_t>(beam.second);
    if (one >= longest.size() || other >= longest.size()) continue;  // validate() rejects it
    const double length = (model.nodes[other].position - model.nodes[one].position +
                           beam.offset_second - beam.offset_first)
                              .norm();
    reach(beam.first, std::max(length, beam.offset_first.norm()));
    reach(beam.second, std::max(length, beam.offset_second.norm()));
  }
  for (const CondensedBody& body : model.bodies) {
    for (const int node : body.nodes) {
      for (const int other : body.nodes) {
        const auto largest = static_cast<std::size_t>(std::max({node, other, 0}));
        if (largest >= longest.size() || std::min(node, other) < 0) continue;
        reach(node, (model.nodes[static_cast<std::size_t>(other)].position -
                     model.nodes[static_cast<std::size_t>(node)].position)
                        .norm());
      }
    }
  }
  reach_constrained(model, reach);
  for (std::size_t n = 0; n < longest.size(); ++n) {
    if (longest[n] > 0.0) model.nodes[n].arm = longest[n];
  }
}

void scale_misfits(Model& model, double fraction) {
  const auto scale = [&](auto& elements) {
    for (auto& one : elements) one.scale_misfit(model, fraction);
  };
  std::apply([&](auto&... lists) { (scale(lists), ...); }, model.lists());
}

}  // namespace statejump::truss
