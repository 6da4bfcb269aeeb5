// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "statejump/truss/path.hpp"

namespace statejump::truss::detail {

using Matrix32 = Eigen::Matrix<double, 3, 2>;

/// What stands in for the clearance revolutes: bilateral pins and frictionless contacts find the
/// start, friction is the path.
enum class JointModel : unsigned char { pins, frictionless, friction };

struct Axial;
struct Lengths;

struct Statuses {
  std::vector<JointStatus> sliders;
  std::vector<JointStatus> revolutes;
  bool operator==(const Statuses&) const = default;
};

/// State at the start of a step, from which slides are counted. In-plane vectors of a revolute are
/// components along its two plane directions.
struct StepStart {
  Statuses statuses;
  Eigen::VectorXd slide;          ///< Of sliders, less what their friction bends elastically [m].
  Eigen::Matrix2Xd eccentricity;  ///< [m]
  Eigen::Matrix2Xd journal_direction;  ///< Journal link, journal minus far node; zero without [m].
  Eigen::Matrix2Xd bearing_direction;  ///< Bearing link, likewise [m].
  Eigen::VectorXd friction;            ///< Of revolutes, on the journal against the slide [N].
  Eigen::VectorXd compliance;          ///< Of revolutes, 1/k_t [m/N]; 0 for rigid and open ones.
};

/// Elastic part of a revolute's surface slide in a step, and its derivatives.
struct ElasticSlide {
  double slide;        ///< [m]
  double by_normal;    ///< By the normal force [m/N].
  double by_friction;  ///< By friction [m/N].
};

/// A revolute as the equations see it at one state.
struct RevoluteGeometry {
  Eigen::Vector2d eccentricity;
  Eigen::Vector2d journal_direction;
  Eigen::Vector2d bearing_direction;
  double clearance;
  double journal_radius;
  double bearing_radius;
  double surface_slide;  ///< Δσ since the start of the step [m].
  double turned;         ///< Δφ since the start of the step [rad].
};

/// Equations of a truss: layout of the unknowns, residual, Jacobian, inequalities.
///
/// Unknowns z: free displacements of the nodes [m], then the forces of sliders (along the axis, and
/// across it where another node is held) and revolutes (normal, friction, along the axis where the
/// nodes may move so) [N]. Rows stand in the same order.
class System {
 public:
  /// The model must outlive the system and be valid.
  explicit System(const Model& model);

  int unknowns() const { return unknowns_; }
  const Model& model() const { return *model_; }

  /// Residual at z; its Jacobian goes into `jacobian`, whose pattern never changes. Returns the
  /// largest force of any part [N].
  /// @param clearance_scale share of the clearances that is open (start)
  double evaluate(const Eigen::VectorXd& z, double time, const StepStart& start,
                  const Statuses& statuses, JointModel joints, double clearance_scale,
                  Eigen::VectorXd& residual, Eigen::SparseMatrix<double>& jacobian) const;

  Statuses all_stick() const {
    return {std::vector<JointStatus>(model_->sliders.size(), JointStatus::stick),
            std::vector<JointStatus>(model_->revolutes.size(), JointStatus::stick)};
  }

  /// Jacobian with the right pattern and zeros.
  Eigen::SparseMatrix<double> pattern() const;

  /// Gives every joint that violates its inequality another status. Returns how many changed;
  /// `last_changed` is one of them, sliders before revolutes.
  int correct_statuses(const Eigen::VectorXd& z, double time, const StepStart& start,
                       JointModel joints, double clearance_scale, Statuses& statuses,
                       int& last_changed) const;

  /// The state as the start of the next step.
  /// @param last start of the step that led here: it tells how far friction is bent at a stop, else
  /// taken as not at all
  StepStart step_start(const Eigen::VectorXd& z, const Statuses& statuses,
                       const StepStart* last = nullptr) const;

  /// Slides of a step that friction turned into heat, sliders before revolutes [m].
  /// @param after the state at z as the start of the next step
  Eigen::VectorXd slips(const Eigen::VectorXd& z, double time, const StepStart& start,
                        const StepStart& after) const;

  /// Friction's heat of a step and the temperature's work, added to the state's.
  /// @param after the state at z as the start of the next step, @param slips see slips()
  void account(const Eigen::VectorXd& z_before, double time_before, const Eigen::VectorXd& z,
               double time, const StepStart& start, const StepStart& after,
               const Eigen::VectorXd& slips, State& state) const;

  /// Displacements, forces and energies at z; dissipation and thermal work are left alone.
  /// @param now the state at z as the start of the next step
  void describe(const Eigen::VectorXd& z, double time, const StepStart& now, State& state) const;

  RevoluteGeometry revolute_geometry(int revolute, const Eigen::VectorXd& z, double time,
                                     const StepStart& start, double clearance_scale) const;

  Eigen::Vector3d displacement(int node, const Eigen::VectorXd& z) const;
  double slide(int slider, const Eigen::VectorXd& z) const;
  double slider_force(int slider, const Eigen::VectorXd& z) const {
    return z[slider_row_[static_cast<std::size_t>(slider)]];
  }
  /// Components of the pin force (pins), or normal force and friction.
  Eigen::Vector2d revolute_force(int revolute, const Eigen::VectorXd& z) const {
    return z.segment<2>(revolute_row_[static_cast<std::size_t>(revolute)]);
  }
  /// Moves the journal's node by `step` [m] (in the revolute's plane).
  void move_journal(int revolute, const Eigen::Vector2d& step, Eigen::VectorXd& z) const;
  void set_revolute_force(int revolute, const Eigen::Vector2d& force, Eigen::VectorXd& z) const {
    z.segment<2>(revolute_row_[static_cast<std::size_t>(revolute)]) = force;
  }

  /// Symmetric stiffness of links and springs at z with joints closed (penalty), for the search for
  /// mechanisms and instability; free displacements only. A joint listed as open or slipping does
  /// not hold there.
  /// @param held stiffness of a direction that a joint holds, in that of the stiffest part
  Eigen::SparseMatrix<double> joined_stiffness(const Eigen::VectorXd& z, double time,
                                               const Statuses& statuses, JointModel joints,
                                               double held) const;
  /// Rounding of a displacement at z [m], and of the forces that come of it [N].
  double length_rounding(const Eigen::VectorXd& z) const;
  double force_rounding(double length_rounding) const {
    return 16.0 * stiffness_scale_ * length_rounding;
  }
  /// Rounding of a joint's slide less what friction bends, sliders before revolutes [m].
  /// @param length_rounding that of a displacement at z, which costs as much as the truss is large
  double slide_rounding(int joint, const Eigen::VectorXd& z, double length_rounding) const;
  int displacements() const { return displacements_; }
  /// Node of a free displacement.
  int node_of(int displacement) const;
  double stiffness_scale() const { return stiffness_scale_; }
  double size() const { return size_; }  ///< Largest extent of the drawn shape [m].

 private:
  template <class Sink>
  double assemble(const Eigen::VectorXd& z, double time, const StepStart& start,
                  const Statuses& statuses, JointModel joints, double clearance_scale,
                  Sink& sink) const;
  ElasticSlide elastic_slide(int revolute, const Eigen::VectorXd& z, const StepStart& start) const;
  double surface_angle(const Eigen::Vector2d& before, const Eigen::Vector2d& now) const;
  Eigen::Vector3d between(int from, int to, const Eigen::VectorXd& z) const;
  Lengths lengths_between(int from, int to, const Eigen::VectorXd& z) const;
  Eigen::Vector2d link_direction(int link, int at_node, const Matrix32& plane,
                                 const Eigen::VectorXd& z) const;
  int far_node(int link, int node) const;
  Axial axial(const Link& link, const Eigen::VectorXd& z, double time) const;

  const Model* model_;
  int unknowns_ = 0;
  int displacements_ = 0;
  double stiffness_scale_ = 0.0;
  double size_ = 0.0;
  std::vector<int> node_row_;      // first free displacement of each node
  std::vector<int> slider_row_;    // axial force, then forces across
  std::vector<int> revolute_row_;  // normal, friction, axial force
  std::vector<std::vector<Eigen::Vector3d>> slider_across_;
  std::vector<Matrix32> revolute_plane_;
  std::vector<Matrix32> torsion_plane_;
  std::vector<bool> revolute_holds_axis_;
};

}  // namespace statejump::truss::detail
