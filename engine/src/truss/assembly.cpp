// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "parts.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

namespace {

/// Collects the places of the Jacobian's entries.
class PatternSink {
 public:
  void add(int row, int column, double) { places.emplace_back(row, column, 0.0); }
  void residual(int, double) {}
  std::vector<Eigen::Triplet<double>> places;
};

/// Adds up values.
class ValueSink {
 public:
  ValueSink(VectorXd& residual, Eigen::SparseMatrix<double>& jacobian)
      : residual_(&residual), jacobian_(&jacobian) {
    residual.setZero();
    std::fill_n(jacobian.valuePtr(), jacobian.nonZeros(), 0.0);
  }
  void add(int row, int column, double value) {
    const int* rows = jacobian_->innerIndexPtr();
    const int* begin = rows + jacobian_->outerIndexPtr()[column];
    const int* end = rows + jacobian_->outerIndexPtr()[column + 1];
    jacobian_->valuePtr()[std::lower_bound(begin, end, row) - rows] += value;
  }
  void residual(int row, double value) { (*residual_)[row] += value; }

 private:
  VectorXd* residual_;
  Eigen::SparseMatrix<double>* jacobian_;
};

/// Adds forces on nodes and their derivatives, through the nodes' free directions.
template <class Sink>
class NodeWriter {
 public:
  NodeWriter(const Model& model, const std::vector<int>& rows, Sink& sink)
      : model_(model), rows_(rows), sink_(sink) {}

  void force(int node, const Vector3d& value) {
    const Node& part = model_.nodes[index(node)];
    for (int i = 0; i < part.freedoms; ++i) {
      sink_.residual(rows_[index(node)] + i, part.free_directions.col(i).dot(value));
    }
  }
  void block(int row_node, int column_node, const Matrix3d& value) {
    const Node& row_part = model_.nodes[index(row_node)];
    const Node& column_part = model_.nodes[index(column_node)];
    for (int j = 0; j < column_part.freedoms; ++j) {
      const Vector3d image = value * column_part.free_directions.col(j);
      for (int i = 0; i < row_part.freedoms; ++i) {
        sink_.add(rows_[index(row_node)] + i, rows_[index(column_node)] + j,
                  row_part.free_directions.col(i).dot(image));
      }
    }
  }
  void row(int row, int node, const Vector3d& gradient) {
    const Node& part = model_.nodes[index(node)];
    for (int i = 0; i < part.freedoms; ++i) {
      sink_.add(row, rows_[index(node)] + i, part.free_directions.col(i).dot(gradient));
    }
  }
  void column(int node, int column, const Vector3d& gradient) {
    const Node& part = model_.nodes[index(node)];
    for (int i = 0; i < part.freedoms; ++i) {
      sink_.add(rows_[index(node)] + i, column, part.free_directions.col(i).dot(gradient));
    }
  }
  /// Holds two nodes together along a direction by a force; its closure stands in its own row.
  void hold(int first, int second, const Vector3d& along, int held, double force, double closure) {
    sink_.residual(held, closure);
    row(held, first, along);
    row(held, second, -along);
    this->force(first, force * along);
    this->force(second, -force * along);
    column(first, held, along);
    column(second, held, -along);
    sink_.add(held, held, 0.0);
  }

 private:
  const Model& model_;
  const std::vector<int>& rows_;
  Sink& sink_;
};

/// Gradient and Hessian of the angle of an in-plane vector.
struct AngleDerivatives {
  Vector3d gradient;
  Matrix3d hessian;
};

AngleDerivatives angle_derivatives(const Vector2d& v, const Matrix32& plane) {
  const double length = v.norm();
  const Vector3d along = plane * (v / length);
  const Vector3d left = plane * (turned_left(v) / length);
  return {left / length,
          -(along * left.transpose() + left * along.transpose()) / (length * length)};
}

}  // namespace

template <class Sink>
double System::assemble(const VectorXd& z, double time, const StepStart& start,
                        const Statuses& statuses, JointModel joints, double clearance_scale,
                        Sink& sink) const {
  const Model& model = *model_;
  NodeWriter<Sink> nodes(model, node_row_, sink);
  double largest = 0.0;
  std::vector<double> changes;
  for (const auto& program : model.programs) changes.push_back(program.temperature_change(time));

  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    nodes.force(static_cast<int>(n), -model.nodes[n].load);
    largest = std::max(largest, model.nodes[n].load.lpNorm<Eigen::Infinity>());
  }

  const auto bar = [&](int first, int second, const Vector3d& direction, double length,
                       const Axial& axial) {
    const Matrix3d along = direction * direction.transpose();
    const Matrix3d stiffness =
        axial.stiffness * along + axial.tension / length * (Matrix3d::Identity() - along);
    nodes.force(first, -axial.tension * direction);
    nodes.force(second, axial.tension * direction);
    nodes.block(first, first, stiffness);
    nodes.block(second, second, stiffness);
    nodes.block(first, second, -stiffness);
    nodes.block(second, first, -stiffness);
    largest = std::max(largest, std::abs(axial.tension));
  };
  for (const Link& link : model.links) {
    const Lengths length = lengths_between(link.first, link.second, z);
    const double change = link.temperature_fraction * changes[index(link.program)];
    bar(link.first, link.second, length.along / length.now, length.now,
        link_axial(link, length.growth, length.drawn, change));
  }
  for (const AxialSpring& spring : model.springs) {
    const Lengths length = lengths_between(spring.first, spring.second, z);
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
    std::array<AngleDerivatives, 2> turn;
    for (std::size_t k = 0; k < 2; ++k) {
      if (links[k] < 0) continue;
      const Link& link = model.links[index(links[k])];
      const Vector2d drawn = plane.transpose() * (model.nodes[index(link.second)].position -
                                                  model.nodes[index(link.first)].position);
      const Vector2d moved =
          plane.transpose() * (displacement(link.second, z) - displacement(link.first, z));
      angle += sign[k] * std::atan2(cross(drawn, moved), drawn.dot(drawn + moved));
      turn[k] = angle_derivatives(drawn + moved, plane);
    }
    const double moment = spring.stiffness * (angle - spring.free_angle);
    for (std::size_t k = 0; k < 2; ++k) {
      if (links[k] < 0) continue;
      const Link& link = model.links[index(links[k])];
      const Vector3d force = moment * sign[k] * turn[k].gradient;
      nodes.force(link.second, force);
      nodes.force(link.first, -force);
      largest = std::max(largest, force.norm());
      for (std::size_t m = 0; m < 2; ++m) {
        if (links[m] < 0) continue;
        const Link& other = model.links[index(links[m])];
        Matrix3d block =
            spring.stiffness * sign[k] * sign[m] * turn[k].gradient * turn[m].gradient.transpose();
        if (k == m) block += moment * sign[k] * turn[k].hessian;
        nodes.block(link.second, other.second, block);
        nodes.block(link.first, other.first, block);
        nodes.block(link.second, other.first, -block);
        nodes.block(link.first, other.second, -block);
      }
    }
  }

  for (std::size_t i = 0; i < model.sliders.size(); ++i) {
    const Slider& slider = model.sliders[i];
    const int row = slider_row_[i];
    const double s = slide(static_cast<int>(i), z);
    const double force = z[row];
    largest = std::max(largest, std::abs(force));
    nodes.force(slider.first, force * slider.axis);
    nodes.column(slider.first, row, slider.axis);
    if (slider.second >= 0) {
      nodes.force(slider.second, -force * slider.axis);
      nodes.column(slider.second, row, -slider.axis);
    }
    bool is_slip = false;
    double closure = 0.0;
    double bend = 0.0;
    switch (statuses.sliders[i]) {
      case JointStatus::stop_plus:
        closure = s - slider.clearance_plus;
        break;
      case JointStatus::stop_minus:
        closure = s + slider.clearance_minus;
        break;
      case JointStatus::slip_plus:
        is_slip = true;
        closure = force - slider.friction_force;
        break;
      case JointStatus::slip_minus:
        is_slip = true;
        closure = force + slider.friction_force;
        break;
      default:
        closure =
            s - start.slide[static_cast<Eigen::Index>(i)] - force / slider.tangential_stiffness;
        bend = -1.0 / slider.tangential_stiffness;
    }
    const double slides = is_slip ? 0.0 : 1.0;
    sink.residual(row, closure);
    sink.add(row, row, is_slip ? 1.0 : bend);
    nodes.row(row, slider.first, slides * slider.axis);
    if (slider.second >= 0) nodes.row(row, slider.second, -slides * slider.axis);
    for (std::size_t k = 0; k < slider_across_[i].size(); ++k) {
      const Vector3d& across = slider_across_[i][k];
      const int held = row + 1 + static_cast<int>(k);
      const Vector3d moved = displacement(slider.first, z) - displacement(slider.second, z);
      nodes.hold(slider.first, slider.second, across, held, z[held], across.dot(moved));
      largest = std::max(largest, std::abs(z[held]));
    }
  }

  for (std::size_t i = 0; i < model.revolutes.size(); ++i) {
    const ClearanceRevolute& revolute = model.revolutes[i];
    const Matrix32& plane = revolute_plane_[i];
    const int row = revolute_row_[i];
    const int part = static_cast<int>(i);
    const RevoluteGeometry g = revolute_geometry(part, z, time, start, clearance_scale);
    const double first_force = z[row];
    const double second_force = z[row + 1];
    largest = std::max({largest, std::abs(first_force), std::abs(second_force)});

    // Four nodes: journal, bearing, far ends of the links that turn them.
    const std::array<int, 4> node{
        revolute.journal_node, revolute.bearing_node,
        revolute.journal_link < 0 ? -1 : far_node(revolute.journal_link, revolute.journal_node),
        revolute.bearing_link < 0 ? -1 : far_node(revolute.bearing_link, revolute.bearing_node)};
    std::array<Vector3d, 4> normal_gradient;
    std::array<Vector3d, 4> slide_gradient;  // virtual work of friction
    std::array<Vector3d, 4> friction_row;    // derivative of Δσ
    std::array<std::array<Matrix3d, 4>, 4> hessian;
    normal_gradient.fill(Vector3d::Zero());
    slide_gradient.fill(Vector3d::Zero());
    friction_row.fill(Vector3d::Zero());
    for (auto& line : hessian) line.fill(Matrix3d::Zero());
    double first_closure = 0.0;
    double second_closure = 0.0;
    std::array<double, 4> corner{};  // d(first row)/d(forces), d(second row)/d(forces)
    bool first_geometric = false;
    bool second_geometric = false;

    if (joints == JointModel::pins) {
      normal_gradient[0] = plane.col(0);
      normal_gradient[1] = -plane.col(0);
      slide_gradient[0] = plane.col(1);
      slide_gradient[1] = -plane.col(1);
      friction_row = slide_gradient;
      first_closure = g.eccentricity.x();
      second_closure = g.eccentricity.y();
      first_geometric = second_geometric = true;
    } else {
      const double distance = g.eccentricity.norm();
      const Vector2d n = g.eccentricity / distance;
      const Vector3d along = plane * n;
      const Vector3d left = plane * turned_left(n);
      normal_gradient[0] = along;
      normal_gradient[1] = -along;
      slide_gradient[0] = left;
      slide_gradient[1] = -left;
      const Matrix3d bend =
          (first_force * left - second_force * along) * left.transpose() / distance;
      hessian[0][0] += bend;
      hessian[1][1] += bend;
      hessian[0][1] -= bend;
      hessian[1][0] -= bend;
      const Vector2d before = start.eccentricity.col(part);
      friction_row[0] = (0.5 * (before.norm() / distance + 1.0)) * left + 0.5 * g.turned * along;
      friction_row[1] = -friction_row[0];
      const auto turn = [&](std::size_t at, std::size_t far, const Vector2d& direction,
                            double radius) {
        const AngleDerivatives angle = angle_derivatives(direction, plane);
        slide_gradient[at] += radius * angle.gradient;
        slide_gradient[far] -= radius * angle.gradient;
        friction_row[at] += radius * angle.gradient;
        friction_row[far] -= radius * angle.gradient;
        const Matrix3d block = second_force * radius * angle.hessian;
        hessian[at][at] += block;
        hessian[far][far] += block;
        hessian[at][far] -= block;
        hessian[far][at] -= block;
      };
      if (node[2] >= 0) turn(0, 2, g.journal_direction, g.journal_radius);
      if (node[3] >= 0) turn(1, 3, g.bearing_direction, -g.bearing_radius);

      const JointStatus status = statuses.revolutes[i];
      if (status == JointStatus::open) {
        first_closure = first_force;
        second_closure = second_force;
        corner = {1.0, 0.0, 0.0, 1.0};
      } else {
        first_geometric = true;
        first_closure = distance - g.clearance - depth_of(revolute, first_force);
        if (!std::isinf(revolute.hertz_stiffness)) {
          const double loaded = std::max(first_force, least_force(revolute));
          corner[0] = -2.0 / 3.0 * depth_of(revolute, loaded) / loaded;
        }
        const double mu = joints == JointModel::friction ? revolute.friction_coefficient : 0.0;
        if (status == JointStatus::stick && joints == JointModel::friction) {
          second_geometric = true;
          const ElasticSlide elastic = elastic_slide(part, z, start);
          second_closure = g.surface_slide - elastic.slide;
          corner[2] = -elastic.by_normal;
          corner[3] = -elastic.by_friction;
        } else {
          const double sense = status == JointStatus::slip_minus ? -1.0 : 1.0;
          second_closure = second_force - sense * mu * first_force;
          corner[2] = -sense * mu;
          corner[3] = 1.0;
        }
      }
    }

    for (std::size_t a = 0; a < 4; ++a) {
      if (node[a] < 0) continue;
      nodes.force(node[a], first_force * normal_gradient[a] + second_force * slide_gradient[a]);
      nodes.column(node[a], row, normal_gradient[a]);
      nodes.column(node[a], row + 1, slide_gradient[a]);
      nodes.row(row, node[a], (first_geometric ? 1.0 : 0.0) * normal_gradient[a]);
      nodes.row(row + 1, node[a], (second_geometric ? 1.0 : 0.0) * friction_row[a]);
      for (std::size_t b = 0; b < 4; ++b) {
        if (node[b] >= 0) nodes.block(node[a], node[b], hessian[a][b]);
      }
    }
    sink.residual(row, first_closure);
    sink.residual(row + 1, second_closure);
    sink.add(row, row, corner[0]);
    sink.add(row, row + 1, corner[1]);
    sink.add(row + 1, row, corner[2]);
    sink.add(row + 1, row + 1, corner[3]);
    if (revolute_holds_axis_[i]) {
      const int held = row + 2;
      const Vector3d apart = between(revolute.bearing_node, revolute.journal_node, z);
      nodes.hold(revolute.journal_node, revolute.bearing_node, revolute.axis, held, z[held],
                 revolute.axis.dot(apart));
    }
  }
  return largest;
}

double System::evaluate(const VectorXd& z, double time, const StepStart& start,
                        const Statuses& statuses, JointModel joints, double clearance_scale,
                        VectorXd& residual, Eigen::SparseMatrix<double>& jacobian) const {
  ValueSink sink(residual, jacobian);
  return assemble(z, time, start, statuses, joints, clearance_scale, sink);
}

Eigen::SparseMatrix<double> System::pattern() const {
  PatternSink sink;
  const Statuses statuses = all_stick();
  const VectorXd z = VectorXd::Zero(unknowns_);
  assemble(z, 0.0, step_start(z, statuses), statuses, JointModel::pins, 1.0, sink);
  Eigen::SparseMatrix<double> matrix(unknowns_, unknowns_);
  matrix.setFromTriplets(sink.places.begin(), sink.places.end());
  matrix.makeCompressed();
  return matrix;
}

}  // namespace statejump::truss::detail
