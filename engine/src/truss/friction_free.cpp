// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/friction_free.hpp"

#include <algorithm>
#include <concepts>
#include <limits>
#include <variant>
#include <vector>

#include "motion/start_of_motion.hpp"
#include "of_nodes.hpp"
#include "truss/elements/writer.hpp"

namespace statejump::truss {

namespace {

using Entries = std::vector<Eigen::Triplet<double>>;
using Eigen::Index;

/// Friction of a joint whose limit is given.
struct Friction {
  double limit = std::numeric_limits<double>::quiet_NaN();
  double slide = 0.0;
  double stiffness = std::numeric_limits<double>::infinity();
  double full_slip = 0.0;
  double radius = 1.0;
};

Friction friction_of(const Slider& joint, const Trial& at) {
  const double k = joint.tangential_stiffness, f = joint.friction_limit();
  // Of a Mindlin contact, the last part of the pad slips at 1.5 f/k.
  return {f, joint.axis.dot(at.moved[0] - at.moved[1]), k, (joint.partial_slip ? 1.5 : 1.0) * f / k,
          1.0};
}

Friction friction_of(const IwanJoint& joint, const Trial& at) {
  return {joint.slip_force, joint.axis.dot(at.moved[0] - at.moved[1]), joint.tangent_stiffness,
          joint.last_reach(), 1.0};
}

template <class Type>
requires std::derived_from<Type, HingeLaw<Type>> Friction friction_of(const Type& joint,
                                                                      const Trial& at) {
  const double radius = joint.radius(at);
  return {joint.friction_moment / radius, radius * joint.rotation(at),
          joint.friction_stiffness / (radius * radius),
          radius * joint.friction_moment / joint.friction_stiffness, radius};
}

template <class Type>
Friction friction_of(const Type&, const Trial&) {
  return {};
}

Eigen::SparseMatrix<double> matrix(Index rows, Index columns, const Entries& entries) {
  Eigen::SparseMatrix<double> made(rows, columns);
  made.setFromTriplets(entries.begin(), entries.end());
  return made;
}

/// Forces that prevent the expansion of each element by 1 K, with the sign reversed.
Eigen::SparseMatrix<double> heating_of(const detail::System& system, const Eigen::VectorXd& z) {
  const Model& model = system.model();
  const detail::DofMap& dofs = system.dofs();
  const Eigen::Matrix3Xd moved = system.displacements(z);
  const std::vector<double> changes(model.programs.size(), 0.0), rates(model.programs.size(), 1.0);
  std::vector<Eigen::Vector3d> drawn;
  for (const Node& node : model.nodes) drawn.push_back(node.position);
  const ElementState state(drawn, moved, changes);
  Assembly to = Assembly::without_jacobian(system.unknowns());
  to.residual.setZero();
  Entries entries;
  Index column = 0;
  system.each_element_type([&](const auto& elements, const auto& frames, std::size_t) {
    for (std::size_t i = 0; i < elements.size(); ++i, ++column) {
      AssemblyStrand strand(to, 0);
      ElementWriter writer(dofs, strand);
      elements[i].thermal_rate(frames[i], state, rates, writer);
      for (const int site : frames[i].nodes) {
        const NodeDofs& at = dofs.at(site);
        for (int along = 0; along < at.freedoms; ++along) {
          at.each_term(along, [&](int dof, double) {
            if (to.residual[dof] != 0.0) entries.emplace_back(dof, column, -to.residual[dof]);
            to.residual[dof] = 0.0;
          });
        }
      }
    }
  });
  return matrix(system.displacements(), column, entries);
}

/// Splits the rows of joint forces into those of the slides and those of the guides across them.
void split_rows(const detail::System& system, const linear::SparseView& jacobian,
                FrictionFree& made) {
  const Index n = system.displacements();
  const auto joints = static_cast<int>(system.model().joints.size());
  std::vector<int> joint_of(static_cast<std::size_t>(system.unknowns() - n), -1);
  made.guide_joint = Eigen::VectorXi::Constant(system.unknowns() - n, -1);
  for (int i = 0; i < joints; ++i) {
    made.guide_joint.segment(system.force_row(i) - n, system.force_count(i)).setConstant(i);
    if (system.force_count(i) > 0) {
      joint_of[static_cast<std::size_t>(system.force_row(i) - n)] = i;
    }
  }
  Entries slides, guides;
  for (Index row = n; row < system.unknowns(); ++row) {
    const int joint = joint_of[static_cast<std::size_t>(row - n)];
    // Columns of forces: rows of slides may have factors, as those of Iwan joints.
    for (linear::SparseView::InnerIterator entry(jacobian, row); entry; ++entry) {
      if (entry.row() >= n || entry.value() == 0.0) continue;
      if (joint >= 0) {
        slides.emplace_back(joint, entry.row(), entry.value());
      } else {
        guides.emplace_back(row - n, entry.row(), entry.value());
      }
    }
  }
  made.slides = matrix(joints, n, slides);
  made.guides = matrix(system.unknowns() - n, n, guides);
}

}  // namespace

FrictionFree friction_free(const Model& model, StartFriction from) {
  model.validate();
  MotionOptions options;
  options.start_friction = from;
  const State start = detail::equilibrium(model, options).value();
  const detail::System system(model);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(system.unknowns());
  z.head(system.displacements()) = system.dofs().dofs_at(detail::sites_of(model, start));
  const detail::Statuses held = system.all_stick();
  const detail::StepStart begun = system.begin(z, 0.0, held, 1.0);
  Assembly at = system.assembly();
  system.evaluate(z, 0.0, begun, held, JointModel::friction, 1.0, at);
  const linear::SparseView jacobian = at.jacobian();
  FrictionFree made;
  made.stiffness = jacobian.topLeftCorner(system.displacements(), system.displacements());
  made.load = -at.residual.head(system.displacements());
  split_rows(system, jacobian, made);
  made.heating = heating_of(system, z);
  made.of_nodes = detail::of_nodes(model, system.dofs());
  made.displacement = start.displacement;
  const auto joints = static_cast<Index>(model.joints.size());
  for (Eigen::VectorXd* one : {&made.friction_limit, &made.slide, &made.sticking_stiffness,
                               &made.full_slip, &made.radius}) {
    one->resize(joints);
  }
  for (int i = 0; i < static_cast<int>(joints); ++i) {
    const Trial trial = system.trial(i, z, 0.0, begun, JointModel::friction, 1.0);
    const Friction found = std::visit([&](const auto& one) { return friction_of(one, trial); },
                                      model.joints[static_cast<std::size_t>(i)]);
    made.friction_limit[i] = found.limit;
    made.slide[i] = found.slide;
    made.sticking_stiffness[i] = found.stiffness;
    made.full_slip[i] = found.full_slip;
    made.radius[i] = found.radius;
  }
  return made;
}

}  // namespace statejump::truss
