// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "statejump/thermal/program.hpp"
#include "statejump/truss/element.hpp"
#include "statejump/truss/joint.hpp"

namespace statejump::truss {

/// Three directions as the columns of a matrix. Copies share the matrix, because most nodes of a
/// truss have the same directions.
class Directions {
 public:
  /// The coordinate directions.
  Directions() : Directions(coordinates()) {}
  // NOLINTNEXTLINE(google-explicit-constructor): a matrix is three directions.
  Directions(const Eigen::Matrix3d& columns)
      : columns_(std::make_shared<const Eigen::Matrix3d>(columns)) {}

  const Eigen::Matrix3d& matrix() const { return *columns_; }
  auto col(Eigen::Index i) const { return columns_->col(i); }

 private:
  explicit Directions(std::shared_ptr<const Eigen::Matrix3d> columns)
      : columns_(std::move(columns)) {}
  static const std::shared_ptr<const Eigen::Matrix3d>& coordinates() {
    static const auto kept = std::make_shared<const Eigen::Matrix3d>(Eigen::Matrix3d::Identity());
    return kept;
  }
  std::shared_ptr<const Eigen::Matrix3d> columns_;
};

/// Point where elements end.
struct Node {
  std::string name;                                    ///< For messages.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< Drawn shape, ΔT = 0 [m].
  Directions free_directions;  ///< Orthonormal; the node may move in the first `freedoms` of them.
  int freedoms = 3;            ///< 0: fixed.
  Eigen::Vector3d load = Eigen::Vector3d::Zero();  ///< Dead load [N].

  // The rest matters only for nodes that a beam, a rigid body or a hinge rotates.
  Directions rotation_directions;  ///< The node may rotate about the first `rotations` of them.
  int rotations = 3;               ///< 0: clamped.
  /// Conjugate to the rotation vector of the node [N m]. Its potential is −moment · rotation
  /// vector: it is conservative, and constant while the node rotates about the axis of the moment.
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  /// A rotation counts as the displacement at this distance [m]. It is that at the far end of the
  /// longest beam of the node, see measure_rotations().
  double arm = 1.0;
};

/// Largest rotation of a node that may rotate about several axes [rad]. At 2π its rotation vector
/// is not unique.
constexpr double largest_node_rotation = 5.5;

/// A term of a constraint: displacement of a node along a vector, times the vector's length. For a
/// rotation_site() the rotation vector [rad] replaces the displacement.
struct ConstraintTerm {
  int node = 0;                                      ///< Site.
  Eigen::Vector3d factor = Eigen::Vector3d::Zero();  ///< [-]
};

/// A linear constraint: the sum of factor · displacement over all its terms is always zero.
struct Constraint {
  std::string name;                   ///< For messages.
  std::vector<ConstraintTerm> terms;  ///< At least one.

  static constexpr const char* kind = "constraint";  ///< In messages.
  /// Factors of a constraint below this fraction of its largest factor, of displacements or of
  /// rotations, are rejected [-]. If factors cancel in the elimination, their rounding is below a
  /// thousandth of this fraction.
  static constexpr double least_factor = 1e-9;
};

/// Elements, frictional joints and loads of a structure, for quasi-static paths.
struct Model : Elements {
  std::vector<Node> nodes;
  std::vector<Joint> joints;
  std::vector<Constraint> constraints;
  std::vector<thermal::Program> programs;  ///< At least one; all of one duration.

  /// Two times count as equal if their difference is below this fraction of the duration [-].
  /// Programs of 3 x 0.1 s and of 1 x 0.3 s thus have the same length, also if entered with ten
  /// digits. The fraction is smaller than the default interval within which events are located.
  static constexpr double same_time = 1e-9;

  /// Throws std::invalid_argument whose message names the element or joint, its value and the
  /// range. Rejected are indices and numbers out of range, links without length at some time of
  /// their program, joints whose parts do not fit, and directions that a joint and constraints both
  /// determine.
  void validate() const;

  /// Redundant constraints: those that follow from supports and earlier constraints.
  std::vector<int> redundant_constraints() const;

  /// Largest negative value of `per_kelvin` · ΔT over a program.
  double lowest_strain(int program, double per_kelvin) const;

  /// ΔT [K] of an item at time t [s].
  double temperature_change(int program, double fraction, double t) const {
    return fraction * programs[static_cast<std::size_t>(program)].temperature_change(t);
  }
};

/// The site of a node's rotation. Sites are places where displacements are measured: first the
/// positions of all nodes, then their rotations, in metres at the distance Node::arm.
inline int rotation_site(const Model& model, int node) {
  return static_cast<int>(model.nodes.size()) + node;
}

/// Whether the type of a joint constrains displacements linearly.
bool has_ties(const Joint& joint);
/// The linear constraints of a joint's nodes; none for most types.
std::vector<Constraint> ties_of(const Joint& joint, const Model& model);

/// Sets Node::arm of all nodes that rotate.
void measure_rotations(Model& model);

/// Multiplies the stress that all elements have in the reference configuration by a fraction.
void scale_misfits(Model& model, double fraction);

}  // namespace statejump::truss
