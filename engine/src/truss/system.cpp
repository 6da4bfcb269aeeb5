// SPDX-License-Identifier: GPL-3.0-or-later
#include "system.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "parts.hpp"

namespace statejump::truss::detail {

namespace {

/// Two directions that make a right-handed frame with the axis; x and y for the z axis.
Matrix32 plane_of(const Vector3d& axis) {
  Matrix32 plane;
  const Vector3d a = axis.normalized();
  if (a.isApprox(Vector3d::UnitZ())) {
    plane << 1, 0, 0, 1, 0, 0;
    return plane;
  }
  Eigen::Index smallest = 0;
  a.cwiseAbs().minCoeff(&smallest);
  const Vector3d first = Vector3d::Unit(smallest).cross(a).normalized();
  plane << first, a.cross(first);
  return plane;
}

bool moves_along(const Node& node, const Vector3d& direction) {
  for (int i = 0; i < node.freedoms; ++i) {
    if (std::abs(node.free_directions.col(i).dot(direction)) > 1e-9) return true;
  }
  return false;
}

}  // namespace

System::System(const Model& model) : model_(&model) {
  for (const Node& node : model.nodes) {
    node_row_.push_back(unknowns_);
    unknowns_ += node.freedoms;
  }
  displacements_ = unknowns_;
  Eigen::AlignedBox3d box;
  for (const Node& node : model.nodes) box.extend(node.position);
  size_ = box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
  for (const Slider& slider : model.sliders) {
    slider_row_.push_back(unknowns_++);
    std::vector<Vector3d> across;
    if (slider.second >= 0) {
      const Matrix32 plane = plane_of(slider.axis);
      for (int i = 0; i < 2; ++i) {
        const Vector3d direction = plane.col(i);
        if (moves_along(model.nodes[index(slider.first)], direction) ||
            moves_along(model.nodes[index(slider.second)], direction)) {
          across.push_back(direction);
          ++unknowns_;
        }
      }
    }
    slider_across_.push_back(std::move(across));
  }
  for (const ClearanceRevolute& revolute : model.revolutes) {
    revolute_row_.push_back(unknowns_);
    unknowns_ += 2;
    revolute_plane_.push_back(plane_of(revolute.axis));
    const bool holds = moves_along(model.nodes[index(revolute.journal_node)], revolute.axis) ||
                       moves_along(model.nodes[index(revolute.bearing_node)], revolute.axis);
    revolute_holds_axis_.push_back(holds);
    if (holds) ++unknowns_;
  }
  for (const TorsionSpring& spring : model.torsion_springs) {
    torsion_plane_.push_back(plane_of(spring.axis));
  }
  for (const Link& link : model.links) {
    stiffness_scale_ = std::max(stiffness_scale_, link.axial_stiffness / link.stress_free_length);
  }
  for (const AxialSpring& spring : model.springs) {
    stiffness_scale_ = std::max(stiffness_scale_, spring.stiffness);
  }
}

Vector3d System::displacement(int node, const VectorXd& z) const {
  const Node& part = model_->nodes[index(node)];
  Vector3d moved = Vector3d::Zero();
  for (int i = 0; i < part.freedoms; ++i) {
    moved += z[node_row_[index(node)] + i] * part.free_directions.col(i);
  }
  return moved;
}

Vector3d System::between(int from, int to, const VectorXd& z) const {
  return (model_->nodes[index(to)].position - model_->nodes[index(from)].position) +
         (displacement(to, z) - displacement(from, z));
}

Lengths System::lengths_between(int from, int to, const VectorXd& z) const {
  return lengths(model_->nodes[index(to)].position - model_->nodes[index(from)].position,
                 displacement(to, z) - displacement(from, z));
}

int System::far_node(int link, int node) const {
  const Link& part = model_->links[index(link)];
  return part.first == node ? part.second : part.first;
}

int System::node_of(int displacement) const {
  const auto after = std::upper_bound(node_row_.begin(), node_row_.end(), displacement);
  return static_cast<int>(after - node_row_.begin()) - 1;
}

double System::slide(int slider, const VectorXd& z) const {
  const Slider& part = model_->sliders[index(slider)];
  Vector3d moved = displacement(part.first, z);
  if (part.second >= 0) moved -= displacement(part.second, z);
  return part.axis.dot(moved);
}

Vector2d System::link_direction(int link, int at_node, const Matrix32& plane,
                                const VectorXd& z) const {
  if (link < 0) return Vector2d::Zero();
  return plane.transpose() * between(far_node(link, at_node), at_node, z);
}

/// Angle from one direction to another [rad]; exact for small ones.
double System::surface_angle(const Vector2d& before, const Vector2d& now) const {
  const Vector2d step = now - before;
  return std::atan2(cross(before, step), before.dot(now));
}

RevoluteGeometry System::revolute_geometry(int i, const VectorXd& z, double time,
                                           const StepStart& start, double clearance_scale) const {
  const ClearanceRevolute& part = model_->revolutes[index(i)];
  const Matrix32& plane = revolute_plane_[index(i)];
  RevoluteGeometry g{};
  g.eccentricity = plane.transpose() * between(part.bearing_node, part.journal_node, z);
  g.journal_direction = link_direction(part.journal_link, part.journal_node, plane, z);
  g.bearing_direction = link_direction(part.bearing_link, part.bearing_node, plane, z);
  const double change = model_->temperature_change(part.program, part.temperature_fraction, time);
  const double bearing = part.journal_radius + part.radial_clearance;
  const double growth = change * (part.bearing_thermal_expansion * bearing -
                                  part.journal_thermal_expansion * part.journal_radius);
  g.clearance = clearance_scale * (part.radial_clearance + growth);
  // Both surfaces meet half-way between them.
  const double depth = g.eccentricity.norm() - g.clearance;
  g.journal_radius = part.journal_radius * (1.0 + part.journal_thermal_expansion * change) -
                     0.5 * std::max(0.0, depth);
  g.bearing_radius =
      bearing * (1.0 + part.bearing_thermal_expansion * change) + 0.5 * std::max(0.0, depth);
  const Vector2d before = start.eccentricity.col(i);
  if (before.squaredNorm() > 0.0 && g.eccentricity.squaredNorm() > 0.0) {
    g.turned = surface_angle(before, g.eccentricity);
    g.surface_slide = 0.5 * (before.norm() + g.eccentricity.norm()) * g.turned;
  }
  if (part.journal_link >= 0) {
    g.surface_slide +=
        g.journal_radius * surface_angle(start.journal_direction.col(i), g.journal_direction);
  }
  if (part.bearing_link >= 0) {
    g.surface_slide -=
        g.bearing_radius * surface_angle(start.bearing_direction.col(i), g.bearing_direction);
  }
  return g;
}

/// Mindlin's contact: what loads it meanwhile keeps the force, what unloads it keeps the bend.
ElasticSlide System::elastic_slide(int i, const VectorXd& z, const StepStart& start) const {
  const ClearanceRevolute& part = model_->revolutes[index(i)];
  if (std::isinf(part.mindlin_stiffness)) return {0.0, 0.0, 0.0};
  const Vector2d force = revolute_force(i, z);
  const double compliance = tangential_compliance(part, force[0]);
  // k_t grows as the cube root of the force.
  const double slope = force[0] > least_force(part) ? -compliance / (3.0 * force[0]) : 0.0;
  const double before = start.compliance[i];
  const double stored = start.friction[i];
  if (before == 0.0) return {compliance * force[1], slope * force[1], compliance};
  if (compliance > before) {
    return {compliance * force[1] - before * stored, slope * force[1], compliance};
  }
  // ∫ dF/k_t by the trapezoidal rule.
  const double mean = 0.5 * (before + compliance);
  return {mean * (force[1] - stored), 0.5 * slope * (force[1] - stored), mean};
}

VectorXd System::slips(const VectorXd& z, double time, const StepStart& start,
                       const StepStart& after) const {
  const auto sliders = static_cast<Eigen::Index>(model_->sliders.size());
  VectorXd found(sliders + static_cast<Eigen::Index>(model_->revolutes.size()));
  found.head(sliders) = after.slide - start.slide;
  for (int i = 0; i < static_cast<int>(model_->revolutes.size()); ++i) {
    found[sliders + i] =
        revolute_geometry(i, z, time, start, 1.0).surface_slide - elastic_slide(i, z, start).slide;
  }
  return found;
}

double System::length_rounding(const VectorXd& z) const {
  const double reach = displacements_ == 0 ? 0.0 : z.head(displacements_).lpNorm<Eigen::Infinity>();
  return 4.0 * std::numeric_limits<double>::epsilon() * reach;
}

double System::slide_rounding(int joint, const VectorXd& z, double length_rounding) const {
  const int sliders = static_cast<int>(model_->sliders.size());
  const double compliance = joint < sliders
                                ? 1.0 / model_->sliders[index(joint)].tangential_stiffness
                                : tangential_compliance(model_->revolutes[index(joint - sliders)],
                                                        revolute_force(joint - sliders, z)[0]);
  return length_rounding + compliance * force_rounding(length_rounding);
}

StepStart System::step_start(const VectorXd& z, const Statuses& statuses,
                             const StepStart* last) const {
  StepStart start;
  start.statuses = statuses;
  start.slide.resize(static_cast<Eigen::Index>(model_->sliders.size()));
  for (int i = 0; i < start.slide.size(); ++i) {
    const Slider& slider = model_->sliders[index(i)];
    // At a stop the slide is the clearance itself: rounding must not add up.
    const JointStatus status = statuses.sliders[index(i)];
    const bool plus = status == JointStatus::stop_plus;
    if (!plus && status != JointStatus::stop_minus) {
      start.slide[i] = slide(i, z) - slider_force(i, z) / slider.tangential_stiffness;
      continue;
    }
    const double stop = plus ? slider.clearance_plus : -slider.clearance_minus;
    const double friction = last == nullptr || std::isinf(slider.tangential_stiffness)
                                ? 0.0
                                : bent_friction(slider, stop - last->slide[i]);
    start.slide[i] = stop - friction / slider.tangential_stiffness;
  }
  const auto count = static_cast<Eigen::Index>(model_->revolutes.size());
  start.eccentricity.resize(2, count);
  start.journal_direction.resize(2, count);
  start.bearing_direction.resize(2, count);
  start.friction.resize(count);
  start.compliance.resize(count);
  for (int i = 0; i < count; ++i) {
    const ClearanceRevolute& part = model_->revolutes[index(i)];
    const Matrix32& plane = revolute_plane_[index(i)];
    start.eccentricity.col(i) =
        plane.transpose() * between(part.bearing_node, part.journal_node, z);
    start.journal_direction.col(i) = link_direction(part.journal_link, part.journal_node, plane, z);
    start.bearing_direction.col(i) = link_direction(part.bearing_link, part.bearing_node, plane, z);
    const bool open = statuses.revolutes[index(i)] == JointStatus::open;
    const Vector2d force = revolute_force(i, z);
    start.friction[i] = open ? 0.0 : force[1];
    start.compliance[i] = open ? 0.0 : tangential_compliance(part, force[0]);
  }
  return start;
}

void System::move_journal(int revolute, const Vector2d& step, VectorXd& z) const {
  const int node = model_->revolutes[index(revolute)].journal_node;
  const Node& part = model_->nodes[index(node)];
  const Vector3d moved = revolute_plane_[index(revolute)] * step;
  for (int i = 0; i < part.freedoms; ++i) {
    z[node_row_[index(node)] + i] += part.free_directions.col(i).dot(moved);
  }
}

}  // namespace statejump::truss::detail
