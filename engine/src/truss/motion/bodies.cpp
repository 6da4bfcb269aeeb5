// SPDX-License-Identifier: GPL-3.0-or-later
#include "bodies.hpp"

#include <cmath>
#include <string>

#include "statejump/kernel/require.hpp"
#include "truss/elements/axial.hpp"
#include "truss/parts.hpp"

namespace statejump::truss::detail {

namespace {

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
  check(inertia.beam_mass, model.beams.size(), "beam mass", "kg");
  if (inertia.beam_moment.size() != 0) {
    kernel::require(inertia.beam_moment.allFinite() && inertia.beam_moment.minCoeff() >= 0.0 &&
                        static_cast<std::size_t>(inertia.beam_moment.cols()) == model.beams.size(),
                    "count of moments of inertia of beams",
                    static_cast<double>(inertia.beam_moment.cols()), "one of each beam, >= 0");
  }
  check(inertia.spring_damping, model.springs.size(), "spring damping", "N s/m");
  check(inertia.joint_damping, model.joints.size(), "joint damping", "kg^1/2");
  std::vector<Eigen::Triplet<double>> entries;
  MatrixWriter writer(system.dofs(), entries);
  system.each_element_type([&](const auto& elements, const auto& frames, std::size_t) {
    for (std::size_t i = 0; i < elements.size(); ++i) {
      elements[i].mass(frames[i], inertia, i, writer);
      const Dashpot dashpot = elements[i].dashpot(frames[i], inertia, i);
      if (dashpot.axial > 0.0 || dashpot.turning > 0.0) dashpots_.push_back(dashpot);
    }
  });
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const int node = static_cast<int>(i);
    writer.block(node, node, inertia_of(inertia.node_mass, i) * Matrix3d::Identity());
  }
  mass_.resize(system.displacements(), system.displacements());
  mass_.setFromTriplets(entries.begin(), entries.end());
}

Bodies::Step Bodies::step(double from, double to) const {
  Step made{from, to, std::vector<double>(dashpots_.size(), 0.0)};
  std::vector<double> rates;  // of the programs [K/s]
  for (const thermal::Program& program : system_->model().programs) {
    rates.push_back((program.temperature_change(to) - program.temperature_change(from)) /
                    (to - from));
  }
  for (std::size_t i = 0; i < dashpots_.size(); ++i) {
    const Dashpot& dashpot = dashpots_[i];
    if (dashpot.program < 0) continue;
    made.growth_rate[i] = dashpot.expansion * rates[index(dashpot.program)];
  }
  return made;
}

Bodies::Rate Bodies::rate(const Dashpot& dashpot, const Eigen::Matrix3Xd& moved,
                          const Eigen::Matrix3Xd& velocity, double growth_rate) const {
  const Model& model = system_->model();
  const Vector3d along =
      (model.nodes[index(dashpot.second)].position - model.nodes[index(dashpot.first)].position) +
      (moved.col(dashpot.second) - moved.col(dashpot.first));
  Rate found;
  found.length = along.norm();
  found.direction = along / found.length;
  const Vector3d relative = velocity.col(dashpot.second) - velocity.col(dashpot.first);
  const double length_rate = relative.dot(found.direction);
  found.strain_rate = length_rate - growth_rate;
  found.across = relative - length_rate * found.direction;
  return found;
}

VectorXd Bodies::force(const VectorXd& q, const VectorXd& v, const Step& step) const {
  VectorXd found = VectorXd::Zero(mass_.rows());
  const Eigen::Matrix3Xd moved = of_nodes(q);
  const Eigen::Matrix3Xd velocity = of_nodes(v);
  for (std::size_t k = 0; k < dashpots_.size(); ++k) {
    const Dashpot& dashpot = dashpots_[k];
    const Rate now = rate(dashpot, moved, velocity, step.growth_rate[k]);
    const Vector3d pull = dashpot.axial * now.strain_rate * now.direction +
                          dashpot.turning / (now.length * now.length) * now.across;
    for (const auto& [node, sign] :
         {std::pair{dashpot.first, 1.0}, std::pair{dashpot.second, -1.0}}) {
      system_->dofs().add_force(node, sign * pull, found);
    }
  }
  return found;
}

std::vector<Eigen::Triplet<double>> Bodies::damping_entries(const VectorXd& q) const {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(36 * dashpots_.size());
  MatrixWriter writer(system_->dofs(), entries);
  const Eigen::Matrix3Xd moved = of_nodes(q);
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, moved.cols());
  for (const Dashpot& dashpot : dashpots_) {
    const Rate now = rate(dashpot, moved, none, 0.0);
    const Matrix3d along = now.direction * now.direction.transpose();
    const Matrix3d block = dashpot.axial * along + dashpot.turning / (now.length * now.length) *
                                                       (Matrix3d::Identity() - along);
    writer.between(dashpot.first, dashpot.second, block);
  }
  return entries;
}

std::vector<Eigen::Triplet<double>> Bodies::compression_entries(const VectorXd& q,
                                                                double time) const {
  std::vector<Eigen::Triplet<double>> entries;
  MatrixWriter writer(system_->dofs(), entries);
  const Model& model = system_->model();
  const Eigen::Matrix3Xd moved = of_nodes(q);
  for (const Bar& link : model.links) {
    const Lengths length =
        lengths(model.nodes[index(link.second)].position - model.nodes[index(link.first)].position,
                moved.col(link.second) - moved.col(link.first));
    const double change = model.temperature_change(link.program, link.temperature_fraction, time);
    const double tension = axial(link, length.growth, length.drawn, change).tension;
    if (!(tension < 0.0)) continue;
    const Vector3d direction = length.along / length.now;
    const Matrix3d block =
        -tension / length.now * (Matrix3d::Identity() - direction * direction.transpose());
    writer.between(link.first, link.second, block);
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
  for (std::size_t k = 0; k < dashpots_.size(); ++k) {
    const Dashpot& dashpot = dashpots_[k];
    const double growth = step.growth_rate[k];
    const Rate before = rate(dashpot, moved_before, velocity_before, growth);
    const Rate after = rate(dashpot, moved_after, velocity_after, growth);
    const double force =
        dashpot.axial * (theta * after.strain_rate + (1.0 - theta) * before.strain_rate);
    sum.heat += h * force * 0.5 * (before.strain_rate + after.strain_rate);
    sum.thermal -= h * force * growth;
    const Vector3d turned =
        dashpot.turning * (theta / (after.length * after.length) * after.across +
                           (1.0 - theta) / (before.length * before.length) * before.across);
    sum.heat += h * turned.dot(0.5 * (before.across + after.across));
  }
  return sum;
}

}  // namespace statejump::truss::detail
