// SPDX-License-Identifier: GPL-3.0-or-later
#include "bodies.hpp"

#include <cmath>
#include <string>

#include "statejump/kernel/require.hpp"
#include "truss/parts.hpp"

namespace statejump::truss::detail {

namespace {

/// Number of an item in an optional list.
double of(const VectorXd& values, std::size_t i) {
  return values.size() == 0 ? 0.0 : values[static_cast<Eigen::Index>(i)];
}

void check(const VectorXd& values, std::size_t count, const char* name, const char* unit) {
  if (values.size() != 0 && static_cast<std::size_t>(values.size()) != count) {
    throw kernel::OutOfRange("", std::string("count of ") + name,
                             static_cast<double>(values.size()),
                             std::to_string(count) + " or none");
  }
  for (const double value : values) {
    kernel::require(std::isfinite(value) && value >= 0.0, name, value,
                    (std::string("finite, >= 0 ") + unit).c_str());
  }
}

}  // namespace

Bodies::Bodies(const System& system, const Inertia& inertia)
    : system_(&system), joint_damping_(inertia.joint_damping) {
  const Model& model = system.model();
  check(inertia.link_mass, model.links.size(), "link mass", "kg");
  check(inertia.node_mass, model.nodes.size(), "node mass", "kg");
  check(inertia.link_moment, model.links.size(), "moment of inertia of links", "kg m2");
  if (inertia.link_centre.size() != 0) {
    kernel::require(inertia.link_centre.allFinite() &&
                        static_cast<std::size_t>(inertia.link_centre.cols()) == model.links.size(),
                    "count of link centres", static_cast<double>(inertia.link_centre.cols()),
                    "one of each link, finite");
  }
  check(inertia.link_damping, model.links.size(), "link damping", "N s/m");
  check(inertia.pin_damping, model.links.size(), "pin damping", "N m s/rad");
  check(inertia.spring_damping, model.springs.size(), "spring damping", "N s/m");
  check(inertia.joint_damping, model.joints.size(), "joint damping", "kg^1/2");
  int rows = 0;
  for (const Node& node : model.nodes) {
    row_.push_back(rows);
    rows += node.freedoms;
  }
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int i, int j, double value) { entries.emplace_back(i, j, value); };
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const double mass = of(inertia.link_mass, i);
    const double turning_inertia =
        inertia.link_moment.size() == 0
            ? mass / 12.0
            : of(inertia.link_moment, i) / std::pow(link.stress_free_length, 2);
    // The centre of mass moves by (1 − G) v1 + G v2 with G a turn and stretch of the plane, the
    // body turns by what is left of v2 − v1.
    Matrix3d to_second = 0.5 * Matrix3d::Identity();
    if (inertia.link_centre.size() != 0) {
      const auto centre = inertia.link_centre.col(static_cast<Eigen::Index>(i));
      to_second = centre[0] * Matrix3d::Identity();
      to_second(1, 0) = centre[1];
      to_second(0, 1) = -centre[1];
    }
    const Matrix3d to_first = Matrix3d::Identity() - to_second;
    const Matrix3d turned = turning_inertia * Matrix3d::Identity();
    const Matrix3d across = mass * to_first.transpose() * to_second - turned;
    spread(link.first, link.first, mass * to_first.transpose() * to_first + turned, add);
    spread(link.second, link.second, mass * to_second.transpose() * to_second + turned, add);
    spread(link.first, link.second, across, add);
    spread(link.second, link.first, across.transpose(), add);
    const double axial = of(inertia.link_damping, i);
    const double turning = of(inertia.pin_damping, i);
    if (axial > 0.0 || turning > 0.0) {
      struts_.push_back({link.first, link.second, axial, turning, &link});
    }
  }
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const int node = static_cast<int>(i);
    spread(node, node, of(inertia.node_mass, i) * Matrix3d::Identity(), add);
  }
  for (std::size_t i = 0; i < model.springs.size(); ++i) {
    const AxialSpring& spring = model.springs[i];
    const double axial = of(inertia.spring_damping, i);
    if (axial > 0.0) struts_.push_back({spring.first, spring.second, axial, 0.0, nullptr});
  }
  damped_ = !struts_.empty();
  mass_.resize(rows, rows);
  mass_.setFromTriplets(entries.begin(), entries.end());
}

template <class Add>
void Bodies::spread(int row_node, int column_node, const Matrix3d& value, Add&& add) const {
  const Node& rows = system_->model().nodes[index(row_node)];
  const Node& columns = system_->model().nodes[index(column_node)];
  for (int j = 0; j < columns.freedoms; ++j) {
    const Vector3d image = value * columns.free_directions.col(j);
    for (int i = 0; i < rows.freedoms; ++i) {
      add(row_[index(row_node)] + i, row_[index(column_node)] + j,
          rows.free_directions.col(i).dot(image));
    }
  }
}

template <class Add>
void Bodies::spread_between(int first, int second, const Matrix3d& value, Add&& add) const {
  spread(first, first, value, add);
  spread(second, second, value, add);
  spread(first, second, -value, add);
  spread(second, first, -value, add);
}

Bodies::Step Bodies::step(double from, double to) const {
  Step made{from, to, std::vector<double>(struts_.size(), 0.0)};
  std::vector<double> rates;  // of the programs [K/s]
  for (const thermal::Program& program : system_->model().programs) {
    rates.push_back((program.temperature_change(to) - program.temperature_change(from)) /
                    (to - from));
  }
  for (std::size_t i = 0; i < struts_.size(); ++i) {
    const Link* link = struts_[i].link;
    if (link == nullptr) continue;
    made.growth_rate[i] = link->stress_free_length * link->thermal_expansion *
                          link->temperature_fraction * rates[index(link->program)];
  }
  return made;
}

Bodies::Rate Bodies::rate(const Strut& strut, const Eigen::Matrix3Xd& moved,
                          const Eigen::Matrix3Xd& velocity, double growth_rate) const {
  const Model& model = system_->model();
  const Vector3d along =
      (model.nodes[index(strut.second)].position - model.nodes[index(strut.first)].position) +
      (moved.col(strut.second) - moved.col(strut.first));
  Rate found;
  found.length = along.norm();
  found.direction = along / found.length;
  const Vector3d relative = velocity.col(strut.second) - velocity.col(strut.first);
  const double length_rate = relative.dot(found.direction);
  found.strain_rate = length_rate - growth_rate;
  found.across = relative - length_rate * found.direction;
  return found;
}

VectorXd Bodies::force(const VectorXd& q, const VectorXd& v, const Step& step) const {
  VectorXd found = VectorXd::Zero(mass_.rows());
  const Model& model = system_->model();
  const Eigen::Matrix3Xd moved = of_nodes(q);
  const Eigen::Matrix3Xd velocity = of_nodes(v);
  for (std::size_t k = 0; k < struts_.size(); ++k) {
    const Strut& strut = struts_[k];
    const Rate now = rate(strut, moved, velocity, step.growth_rate[k]);
    const Vector3d pull = strut.axial * now.strain_rate * now.direction +
                          strut.turning / (now.length * now.length) * now.across;
    for (const auto& [node, sign] : {std::pair{strut.first, 1.0}, std::pair{strut.second, -1.0}}) {
      const Node& part = model.nodes[index(node)];
      for (int i = 0; i < part.freedoms; ++i) {
        found[row_[index(node)] + i] += sign * part.free_directions.col(i).dot(pull);
      }
    }
  }
  return found;
}

std::vector<Eigen::Triplet<double>> Bodies::damping_entries(const VectorXd& q) const {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(36 * struts_.size());
  const auto add = [&](int i, int j, double value) { entries.emplace_back(i, j, value); };
  const Eigen::Matrix3Xd moved = of_nodes(q);
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, moved.cols());
  for (const Strut& strut : struts_) {
    const Rate now = rate(strut, moved, none, 0.0);
    const Matrix3d along = now.direction * now.direction.transpose();
    const Matrix3d block = strut.axial * along + strut.turning / (now.length * now.length) *
                                                     (Matrix3d::Identity() - along);
    spread_between(strut.first, strut.second, block, add);
  }
  return entries;
}

std::vector<Eigen::Triplet<double>> Bodies::compression_entries(const VectorXd& q,
                                                                double time) const {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int i, int j, double value) { entries.emplace_back(i, j, value); };
  const Model& model = system_->model();
  const Eigen::Matrix3Xd moved = of_nodes(q);
  for (const Link& link : model.links) {
    const Lengths length =
        lengths(model.nodes[index(link.second)].position - model.nodes[index(link.first)].position,
                moved.col(link.second) - moved.col(link.first));
    const double change = model.temperature_change(link.program, link.temperature_fraction, time);
    const double tension = link_axial(link, length.growth, length.drawn, change).tension;
    if (!(tension < 0.0)) continue;
    const Vector3d direction = length.along / length.now;
    const Matrix3d block =
        -tension / length.now * (Matrix3d::Identity() - direction * direction.transpose());
    spread_between(link.first, link.second, block, add);
  }
  return entries;
}

Eigen::SparseMatrix<double> Bodies::damping(const VectorXd& q) const {
  const std::vector<Eigen::Triplet<double>> entries = damping_entries(q);
  Eigen::SparseMatrix<double> made(mass_.rows(), mass_.cols());
  made.setFromTriplets(entries.begin(), entries.end());
  return made;
}

Bodies::Work Bodies::work(const VectorXd& q0, const VectorXd& v0, const VectorXd& q1,
                          const VectorXd& v1, const Step& step, double theta) const {
  Work sum;
  const double h = step.to - step.from;
  const Eigen::Matrix3Xd moved_before = of_nodes(q0);
  const Eigen::Matrix3Xd velocity_before = of_nodes(v0);
  const Eigen::Matrix3Xd moved_after = of_nodes(q1);
  const Eigen::Matrix3Xd velocity_after = of_nodes(v1);
  for (std::size_t k = 0; k < struts_.size(); ++k) {
    const Strut& strut = struts_[k];
    const double growth = step.growth_rate[k];
    const Rate before = rate(strut, moved_before, velocity_before, growth);
    const Rate after = rate(strut, moved_after, velocity_after, growth);
    const double force =
        strut.axial * (theta * after.strain_rate + (1.0 - theta) * before.strain_rate);
    sum.heat += h * force * 0.5 * (before.strain_rate + after.strain_rate);
    sum.thermal -= h * force * growth;
    const Vector3d turned =
        strut.turning * (theta / (after.length * after.length) * after.across +
                         (1.0 - theta) / (before.length * before.length) * before.across);
    sum.heat += h * turned.dot(0.5 * (before.across + after.across));
  }
  return sum;
}

VectorXd Bodies::free_part(const Eigen::Matrix3Xd& of_nodes) const {
  VectorXd found(mass_.rows());
  const Model& model = system_->model();
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    for (int i = 0; i < model.nodes[n].freedoms; ++i) {
      found[row_[n] + i] =
          model.nodes[n].free_directions.col(i).dot(of_nodes.col(static_cast<Eigen::Index>(n)));
    }
  }
  return found;
}

}  // namespace statejump::truss::detail
