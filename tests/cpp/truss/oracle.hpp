// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <variant>
#include <vector>

#include "statejump/truss/model.hpp"

namespace statejump::truss {

/// Truss of links, springs and sliders, solved by incremental energy minimisation. It shares only
/// the model with the solver.
///
/// At every instant the displacements x minimise, with the slips p_k of the previous instant,
///
///     E(x, t) − loads · x + Σ [k_t (s − p)²/2 + f |p − p_k|],   −c− <= s <= c+,
///
/// where s(x) is a slider's slide and p its slipped part (p = s if k_t is infinite). For a braced
/// truss near its reference configuration E is convex, so the minimum is unique. Method: sequential
/// quadratic programming. Each convex program is solved in its dual, a bound-constrained quadratic
/// program, by projected Gauss-Seidel sweeps; the method uses no statuses and no pivots.
class MinimisingTruss {
 public:
  explicit MinimisingTruss(const Model& model) : model_(&model) {
    for (const Node& node : model.nodes) {
      node_row_.push_back(unknowns_);
      unknowns_ += node.freedoms;
    }
    x_ = Eigen::VectorXd::Zero(unknowns_);
    for (const Joint& joint : model.joints) {
      const auto& slider = std::get<Slider>(joint);
      const Eigen::VectorXd slide = along(slider.axis, slider);
      const double f = slider.friction_force;
      friction_.push_back(rows_.size());
      rows_.push_back({slide, 0.0, -f, f, 1.0 / slider.tangential_stiffness});
      constexpr double any = std::numeric_limits<double>::infinity();
      stop_plus_.push_back(rows_.size());
      rows_.push_back({slide, slider.clearance_plus, 0.0, any, 0.0});
      stop_minus_.push_back(rows_.size());
      rows_.push_back({slide, -slider.clearance_minus, -any, 0.0, 0.0});
      if (slider.second >= 0) {
        const Eigen::Vector3d first = slider.axis.unitOrthogonal();
        for (const Eigen::Vector3d& across : {first, Eigen::Vector3d(slider.axis.cross(first))}) {
          rows_.push_back({along(across, slider), 0.0, -any, any, 0.0});
        }
      }
    }
    heat_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.joints.size()));
  }

  /// Advances to the energy minimum at the given time.
  /// @throws std::runtime_error if the programs do not converge
  void step(double time) {
    std::vector<Row*> active;
    for (Row& row : rows_) {
      if (std::isfinite(row.target) && row.gradient.squaredNorm() > 1e-20) active.push_back(&row);
    }
    const auto m = static_cast<Eigen::Index>(active.size());
    Eigen::MatrixXd gradients(m, unknowns_);
    for (Eigen::Index r = 0; r < m; ++r) gradients.row(r) = active[std::size_t(r)]->gradient;
    for (int iteration = 0; iteration < 30; ++iteration) {
      const auto [force, stiffness] = derivatives(time);
      const Eigen::LLT<Eigen::MatrixXd> factor(stiffness);
      if (factor.info() != Eigen::Success) throw std::runtime_error("the energy is not convex");
      const Eigen::MatrixXd compliant = factor.solve(gradients.transpose());
      Eigen::MatrixXd delassus = gradients * compliant;
      for (Eigen::Index r = 0; r < m; ++r) delassus(r, r) += active[std::size_t(r)]->compliance;
      const Eigen::VectorXd free = x_ - factor.solve(force);
      minimise(active, delassus, gradients * free);
      Eigen::VectorXd moved = free - x_;
      for (Eigen::Index r = 0; r < m; ++r) {
        moved -= compliant.col(r) * active[std::size_t(r)]->multiplier;
      }
      x_ += moved;
      // Quadratic convergence: the next step would be below rounding.
      if (moved.lpNorm<Eigen::Infinity>() < 1e-11) break;
      if (iteration == 29) throw std::runtime_error("quadratic programs do not converge");
    }
    for (std::size_t j = 0; j < friction_.size(); ++j) {
      Row& row = rows_[friction_[j]];
      // A multiplier within its bounds means stick. Its slip is rounding and must not accumulate as
      // heat.
      if (std::abs(row.multiplier) < row.upper) continue;
      const double slipped = row.gradient.dot(x_) - row.compliance * row.multiplier;
      heat_[Eigen::Index(j)] += row.upper * std::abs(slipped - row.target);
      row.target = slipped;
    }
  }

  Eigen::Vector3d displacement(int node) const {
    const Node& part = model_->nodes[std::size_t(node)];
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();
    for (int i = 0; i < part.freedoms; ++i) {
      moved += x_[node_row_[std::size_t(node)] + i] * part.free_directions.col(i);
    }
    return moved;
  }
  /// Force along a slider's axis, friction and stops together [N].
  double force(std::size_t joint) const {
    return rows_[friction_[joint]].multiplier + rows_[stop_plus_[joint]].multiplier +
           rows_[stop_minus_[joint]].multiplier;
  }
  /// Friction heat of each slider since the start [J].
  const Eigen::VectorXd& heat() const { return heat_; }

 private:
  /// A linear function of x, gradient · x − target, and its force (multiplier) within bounds.
  struct Row {
    Eigen::VectorXd gradient;
    double target;
    double lower;
    double upper;
    double compliance;  ///< 1/k_t [m/N]
    double multiplier = 0.0;
  };

  Eigen::VectorXd along(const Eigen::Vector3d& direction, const Slider& slider) const {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(unknowns_);
    for (const auto& [node, sign] :
         {std::pair{slider.first, 1.0}, std::pair{slider.second, -1.0}}) {
      if (node < 0) continue;
      const Node& part = model_->nodes[std::size_t(node)];
      for (int i = 0; i < part.freedoms; ++i) {
        row[node_row_[std::size_t(node)] + i] += sign * part.free_directions.col(i).dot(direction);
      }
    }
    return row;
  }

  /// Gradient and Hessian of E(x, t) − loads · x.
  std::pair<Eigen::VectorXd, Eigen::MatrixXd> derivatives(double time) const {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(unknowns_);
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(unknowns_, unknowns_);
    const auto directions = [&](int node) {
      return model_->nodes[std::size_t(node)].free_directions.matrix().leftCols(
          model_->nodes[std::size_t(node)].freedoms);
    };
    for (std::size_t n = 0; n < model_->nodes.size(); ++n) {
      const auto d = directions(int(n));
      gradient.segment(node_row_[n], d.cols()) -= d.transpose() * model_->nodes[n].load;
    }
    const auto bar = [&](int first, int second, double stiffness, double free_length) {
      const Eigen::Vector3d span = model_->nodes[std::size_t(second)].position +
                                   displacement(second) -
                                   model_->nodes[std::size_t(first)].position - displacement(first);
      const double length = span.norm();
      const Eigen::Vector3d unit = span / length;
      const double tension = stiffness * (length - free_length);
      const Eigen::Matrix3d block =
          stiffness * unit * unit.transpose() +
          tension / length * (Eigen::Matrix3d::Identity() - unit * unit.transpose());
      for (const auto& [a, sign] : {std::pair{first, -1.0}, std::pair{second, 1.0}}) {
        const auto da = directions(a);
        const int row = node_row_[std::size_t(a)];
        gradient.segment(row, da.cols()) += sign * tension * (da.transpose() * unit);
        for (const auto& [b, other] : {std::pair{first, -1.0}, std::pair{second, 1.0}}) {
          const auto db = directions(b);
          hessian.block(row, node_row_[std::size_t(b)], da.cols(), db.cols()) +=
              sign * other * (da.transpose() * block * db);
        }
      }
    };
    for (const Bar& link : model_->links) {
      const double now =
          link.stress_free_length *
          (1.0 + link.thermal_expansion *
                     model_->temperature_change(link.program, link.temperature_fraction, time));
      bar(link.first, link.second, link.axial_stiffness / now, now);
    }
    for (const Spring& spring : model_->springs) {
      bar(spring.first, spring.second, spring.stiffness, spring.free_length);
    }
    return {gradient, hessian};
  }

  /// Multipliers of the quadratic program, starting from the previous solution.
  /// @param free values of the rows at zero multipliers
  static void minimise(const std::vector<Row*>& rows, const Eigen::MatrixXd& delassus,
                       const Eigen::VectorXd& free) {
    const auto m = static_cast<Eigen::Index>(rows.size());
    Eigen::VectorXd value = free;
    for (Eigen::Index r = 0; r < m; ++r) {
      value -= delassus.col(r) * rows[std::size_t(r)]->multiplier;
    }
    // The values are computed from bar lengths of about one metre. The sweeps end when no value
    // changes by more than the rounding of these lengths.
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    for (int sweep = 0; sweep < 100000; ++sweep) {
      double largest = 0.0;
      for (Eigen::Index r = 0; r < m; ++r) {
        Row& row = *rows[std::size_t(r)];
        const double next = std::clamp(row.multiplier + (value[r] - row.target) / delassus(r, r),
                                       row.lower, row.upper);
        const double change = next - row.multiplier;
        if (change == 0.0) continue;
        value -= delassus.col(r) * change;
        row.multiplier = next;
        if (std::abs(change) > 4.0 * epsilon * std::abs(next)) {
          largest = std::max(largest, std::abs(change) * delassus(r, r));
        }
      }
      if (largest < epsilon) return;
    }
    throw std::runtime_error("Gauss-Seidel does not converge");
  }

  const Model* model_;
  int unknowns_ = 0;
  std::vector<int> node_row_;
  std::vector<Row> rows_;
  std::vector<std::size_t> friction_;  // indices of the rows of each slider
  std::vector<std::size_t> stop_plus_;
  std::vector<std::size_t> stop_minus_;
  Eigen::VectorXd x_;
  Eigen::VectorXd heat_;
};

}  // namespace statejump::truss
