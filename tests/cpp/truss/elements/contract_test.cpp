// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the contract of elements/interface.hpp for every registered type.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "samples.hpp"
#include "truss/elements/writer.hpp"
#include "truss/system.hpp"
#include "truss/thermal_step.hpp"

namespace statejump::truss {
namespace {

using detail::DofMap;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Derivative of a function at 0 by fourth-order differences with step h. The truncation error is
/// h⁴/30 times the fifth derivative, the rounding error 1.5 ε/h times the value.
template <class Function>
auto derivative(Function&& at, double h) {
  return ((8.0 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12.0 * h)).eval();
}

/// Step of the differences [m]. The samples have lengths of about 1 m, so the truncation error is
/// about 1e-14 of the largest derivative and the rounding error about 2e-12 of the value.
constexpr double step = 2.5e-4;
/// Relative tolerance for derivatives and for values per metre: truncation plus rounding error,
/// times ten because directions have larger fifth derivatives.
constexpr double of_differences = 1e-11;

/// Elements of one type in test states.
template <class Type>
class ElementContract : public ::testing::Test {
 protected:
  static constexpr std::size_t type = element_type_index<Type>();

  explicit ElementContract(Model of = testing::sample(std::type_identity<Type>()))
      : model(std::move(of)), dofs(model) {
    model.validate();
    for (const Node& node : model.nodes) drawn.push_back(node.position);
    frames = std::get<type>(detail::frames_of_elements(model));
  }

  const std::vector<Type>& elements() const { return std::get<type>(model.lists()); }
  /// Displacements of a twentieth of the lengths, without symmetry.
  VectorXd displaced(double phase = 0.0) const {
    VectorXd q(dofs.dofs());
    for (int i = 0; i < dofs.dofs(); ++i) q[i] = 0.05 * std::sin(1.3 + 2.1 * i + phase);
    return q;
  }
  std::vector<double> changes() const { return {60.0, -35.0}; }

  /// Calls `use(state)` with the nodes displaced by q.
  template <class Use>
  auto at(const VectorXd& q, const std::vector<double>& temperatures, Use&& use) const {
    Eigen::Matrix3Xd moved;
    dofs.displacements(q, moved);
    return use(ElementState(drawn, moved, temperatures));
  }
  double energy(std::size_t i, const VectorXd& q) const {
    return at(q, changes(),
              [&](const ElementState& state) { return elements()[i].energy(frames[i], state); });
  }
  /// Calls `write(state, writer)` and returns the forces and derivatives written.
  template <class Write>
  Assembly written(const VectorXd& q, const std::vector<double>& temperatures,
                   Write&& write) const {
    Assembly to = Assembly::listing(dofs.dofs());
    AssemblyStrand strand(to, 0);
    ElementWriter writer(dofs, strand);
    at(q, temperatures, [&](const ElementState& state) { write(state, writer); });
    return to;
  }
  Assembly evaluated(std::size_t i, const VectorXd& q,
                     const std::vector<double>& temperatures) const {
    return written(q, temperatures, [&](const ElementState& state, ElementWriter& writer) {
      elements()[i].evaluate(frames[i], state, writer);
    });
  }
  VectorXd force(std::size_t i, const VectorXd& q) const {
    return evaluated(i, q, changes()).residual;
  }
  MatrixXd tangent(std::size_t i, const VectorXd& q) const {
    MatrixXd sum = MatrixXd::Zero(dofs.dofs(), dofs.dofs());
    for (const auto& entry : evaluated(i, q, changes()).entries) {
      sum(entry.row(), entry.col()) += entry.value();
    }
    return sum;
  }

  void check_gradient_of_energy() const {
    const VectorXd q = displaced();
    for (std::size_t i = 0; i < elements().size(); ++i) {
      const VectorXd found = force(i, q);
      VectorXd gradient(q.size());
      for (Eigen::Index k = 0; k < q.size(); ++k) {
        gradient[k] = derivative(
            [&](double h) {
              VectorXd there = q;
              there[k] += h;
              return Eigen::Matrix<double, 1, 1>(energy(i, there));
            },
            step)[0];
      }
      const double scale = energy(i, q) + found.norm();
      EXPECT_LE((found - gradient).norm(), of_differences * scale) << elements()[i].name;
    }
  }
  void check_tangent() const {
    const VectorXd q = displaced();
    for (std::size_t i = 0; i < elements().size(); ++i) {
      const MatrixXd found = tangent(i, q);
      MatrixXd gradient(q.size(), q.size());
      for (Eigen::Index k = 0; k < q.size(); ++k) {
        gradient.col(k) = derivative(
            [&](double h) {
              VectorXd there = q;
              there[k] += h;
              return force(i, there);
            },
            step);
      }
      const double scale = force(i, q).norm() + found.norm();
      EXPECT_LE((found - gradient).norm(), of_differences * scale) << elements()[i].name;
      EXPECT_LE((found - found.transpose()).norm(), 16.0 * epsilon * found.norm());
    }
  }

  Model model;
  std::vector<Vector3d> drawn;
  DofMap dofs;
  std::vector<typename Type::Frame> frames;
};

template <class Indices>
struct Registered;
template <std::size_t... k>
struct Registered<std::index_sequence<k...>> {
  using Types = ::testing::Types<ElementType<k>...>;
};
using AllTypes = Registered<std::make_index_sequence<element_types>>::Types;

TYPED_TEST_SUITE(ElementContract, AllTypes);

TYPED_TEST(ElementContract, GradientOfTheEnergyIsTheForce) {
  this->check_gradient_of_energy();
}

TYPED_TEST(ElementContract, TangentIsTheGradientOfTheForce) {
  this->check_tangent();
}

/// Sample of an element type with two constraints between its nodes. They eliminate one
/// displacement of B and one of A.
template <class Type>
Model constrained_sample() {
  Model model = testing::sample(std::type_identity<Type>());
  model.constraints = {{"B", {{1, Vector3d(0.9, 0.2, -0.4)}, {2, Vector3d(0.1, 0.3, 0.2)}}},
                       {"A", {{0, Vector3d(1.0, -0.5, 0.3)}, {1, Vector3d(-0.2, 0.3, 0.4)}}}};
  return model;
}

template <class Type>
class ConstrainedElements : public ElementContract<Type> {
 protected:
  ConstrainedElements() : ElementContract<Type>(constrained_sample<Type>()) {}
};

TYPED_TEST_SUITE(ConstrainedElements, AllTypes);

TYPED_TEST(ConstrainedElements, GradientOfTheEnergyIsTheForce) {
  int rotations = 0;
  for (std::size_t site = 4; site < this->dofs.sites(); ++site) {
    rotations += this->dofs.at(static_cast<int>(site)).freedoms;
  }
  ASSERT_EQ(this->dofs.dofs() - rotations, 4);
  this->check_gradient_of_energy();
}

TYPED_TEST(ConstrainedElements, TangentIsTheGradientOfTheForce) {
  this->check_tangent();
}

TYPED_TEST(ElementContract, ThermalRateIsTheRateOfTheForceWhereNothingMoves) {
  const VectorXd q = this->displaced();
  const std::vector<double> rates{30.0, 80.0};
  for (std::size_t i = 0; i < this->elements().size(); ++i) {
    const VectorXd rate =
        this->written(q, this->changes(),
                      [&](const ElementState& state, ElementWriter& writer) {
                        this->elements()[i].thermal_rate(this->frames[i], state, rates, writer);
                      })
            .residual;
    // Thermal strain makes forces nonlinear in time. The effect is 1e-3 over a second, 1e-15 in the
    // fifth derivative.
    const VectorXd difference = derivative(
        [&](double h) {
          const std::vector<double> then{60.0 + h * rates[0], -35.0 + h * rates[1]};
          return this->evaluated(i, q, then).residual;
        },
        0.1);
    // Rounding of the force (1 m times the stiffness), divided by 0.1 s.
    const double rounding = 64.0 * epsilon * this->tangent(i, q).norm() / 0.1;
    EXPECT_LE((rate - difference).norm(), rounding + of_differences * rate.norm());
  }
}

TYPED_TEST(ElementContract, WorksOfForceAndTemperatureAreTheChangeOfTheEnergy) {
  // The program heats at a constant rate until t = 0.5, and nodes move at constant velocity.
  const VectorXd from = this->displaced();
  const double duration = 0.2;
  const VectorXd rate = (this->displaced(0.1) - from) / duration;
  const auto changes_at = [&](double time) {
    return std::vector<double>{this->model.temperature_change(0, 1.0, time),
                               this->model.temperature_change(1, 1.0, time)};
  };
  for (std::size_t i = 0; i < this->elements().size(); ++i) {
    const auto energy_at = [&](double time) {
      return this->at(from + time * rate, changes_at(time), [&](const ElementState& state) {
        return this->elements()[i].energy(this->frames[i], state);
      });
    };
    double stored = 0.0;
    const auto unbalanced = [&](double time) {
      const VectorXd to = from + time * rate;
      const detail::Way way{from, 0.0, to, time, &rate, &rate};
      const auto rules = detail::quadratures(way, this->model);
      const double heated = this->elements()[i].thermal_work(
          this->frames[i], detail::ThermalStep{way, this->drawn, this->dofs, rules});
      // Simpson's rule with 64 parts has an error of 64⁻⁴/2880 = 2e-11 of the fourth derivative.
      double work = 0.0;
      constexpr int parts = 64;
      for (int k = 0; k <= 2 * parts; ++k) {
        const double when = time * k / (2.0 * parts);
        const double weight = k == 0 || k == 2 * parts ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
        const VectorXd force = this->evaluated(i, from + when * rate, changes_at(when)).residual;
        work += weight * time / (6.0 * parts) * force.dot(rate);
      }
      stored = std::max(energy_at(0.0), energy_at(time));
      return std::abs(energy_at(time) - energy_at(0.0) - work - heated);
    };
    const double whole = unbalanced(duration);
    const double half = unbalanced(0.5 * duration);
    // The quadrature is of fourth order, so its error per step is of fifth order: half the step has
    // 1/32 of the error. The factor 1/16 allows for sixth-order terms, and the second term for
    // rounding and Simpson's rule.
    EXPECT_LE(half, whole / 16.0 + 1e-12 * stored) << this->elements()[i].name;
    EXPECT_LE(whole, 1e-3 * stored) << this->elements()[i].name;
  }
}

TYPED_TEST(ElementContract, ForcesTurnWithTheStructure) {
  // With all nodes free, their dofs are displacement components along the axes.
  for (Node& node : this->model.nodes) {
    node.freedoms = node.rotations = 3;
    node.free_directions = node.rotation_directions = Directions();
  }
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.5, -0.3, 0.7, 0.4).normalized().matrix();
  Model turned = this->model;
  for (Node& node : turned.nodes) node.position = turn * node.position;
  for (TypeParam& one : std::get<TestFixture::type>(turned.lists())) {
    if constexpr (std::is_same_v<TypeParam, SpinSpring>) one.axis = turn * one.axis;
    if constexpr (std::is_same_v<TypeParam, CondensedBody>) testing::turn_axes(one, turn);
    for (const Parameter<TypeParam>& parameter : TypeParam::parameters()) {
      if (const auto* direction = std::get_if<Vector3d TypeParam::*>(&parameter.member)) {
        one.*(*direction) = turn * one.*(*direction);
      }
    }
  }
  struct Free : ElementContract<TypeParam> {
    explicit Free(const Model& of) : ElementContract<TypeParam>(of) {}
    void TestBody() override {}
    using ElementContract<TypeParam>::displaced;
    using ElementContract<TypeParam>::energy;
    using ElementContract<TypeParam>::force;
    using ElementContract<TypeParam>::tangent;
    using ElementContract<TypeParam>::dofs;
  };
  const Free here(this->model);
  const Free there(turned);
  const VectorXd q = here.displaced();
  VectorXd turned_q(q.size());
  for (Eigen::Index n = 0; n < q.size() / 3; ++n) {
    turned_q.segment<3>(3 * n) = turn * q.segment<3>(3 * n);
  }
  for (std::size_t i = 0; i < this->elements().size(); ++i) {
    const VectorXd force = here.force(i, q);
    const VectorXd turned_force = there.force(i, turned_q);
    // Rounding of lengths of 1 m times the stiffness.
    const double rounding = 64.0 * epsilon * here.tangent(i, q).norm();
    Vector3d sum = Vector3d::Zero();
    for (Eigen::Index n = 0; n < q.size() / 3; ++n) {
      const Vector3d expected = turn * force.segment<3>(3 * n);
      EXPECT_LE((turned_force.segment<3>(3 * n) - expected).norm(), rounding);
    }
    for (int n = 0; n < 4; ++n) sum += force.segment<3>(here.dofs.at(n).row);
    // A translation does no work.
    EXPECT_LE(sum.norm(), rounding);
    EXPECT_NEAR(here.energy(i, q), there.energy(i, turned_q),
                rounding + 64.0 * epsilon * here.energy(i, q));
  }
}

TYPED_TEST(ElementContract, MassMovesWithATranslation) {
  for (Node& node : this->model.nodes) {
    node.freedoms = 3;
    node.free_directions = Directions();
  }
  const DofMap all(this->model);
  const Inertia inertia = testing::sample_inertia();
  std::vector<Eigen::Triplet<double>> entries;
  MatrixWriter writer(all, entries);
  for (std::size_t i = 0; i < this->elements().size(); ++i) {
    this->elements()[i].mass(this->frames[i], inertia, i, writer);
  }
  MatrixXd mass = MatrixXd::Zero(all.dofs(), all.dofs());
  for (const auto& entry : entries) mass(entry.row(), entry.col()) += entry.value();
  EXPECT_EQ(mass, mass.transpose());
  const double expected = testing::sample_mass(std::type_identity<TypeParam>());
  const Vector3d velocity(1.0, -2.0, 0.5);
  VectorXd translation = VectorXd::Zero(all.dofs());
  for (int n = 0; n < 4; ++n) translation.segment<3>(all.at(n).row) = velocity;
  EXPECT_NEAR(translation.dot(mass * translation), expected * velocity.squaredNorm(),
              64.0 * epsilon * mass.norm() * translation.squaredNorm());
}

TYPED_TEST(ElementContract, WithoutMisfitTheReferenceConfigurationIsFreeOfStress) {
  const Model as_given = this->model;
  const VectorXd none = VectorXd::Zero(this->dofs.dofs());
  const std::vector<double> cold{0.0, 0.0};
  for (std::size_t i = 0; i < this->elements().size(); ++i) {
    const VectorXd whole = this->evaluated(i, none, cold).residual;
    scale_misfits(this->model, 1.0);
    const double rounding = 64.0 * epsilon * this->tangent(i, none).norm();
    EXPECT_LE((this->evaluated(i, none, cold).residual - whole).norm(), rounding);
    scale_misfits(this->model, 0.0);
    EXPECT_LE(this->evaluated(i, none, cold).residual.norm(), rounding);
    this->model = as_given;
  }
}

TYPED_TEST(ElementContract, WritesTheSameEntriesAtEveryState) {
  const auto places = [](const Assembly& of) {
    std::vector<std::pair<int, int>> found;
    for (const auto& entry : of.entries) found.emplace_back(entry.row(), entry.col());
    return found;
  };
  for (std::size_t i = 0; i < this->elements().size(); ++i) {
    const auto reference =
        places(this->evaluated(i, VectorXd::Zero(this->dofs.dofs()), {0.0, 0.0}));
    // With ten times the displacement, cables change between taut and slack.
    const auto far = places(this->evaluated(i, 10.0 * this->displaced(), this->changes()));
    EXPECT_EQ(reference, far);
    const auto near = places(this->evaluated(i, -10.0 * this->displaced(), this->changes()));
    EXPECT_EQ(reference, near);
  }
}

TYPED_TEST(ElementContract, DescribesEveryOutput) {
  const std::size_t width = output_width<TypeParam>();
  for (std::size_t i = 0; i < this->elements().size(); ++i) {
    std::vector<double> outputs(width + 1, std::numeric_limits<double>::quiet_NaN());
    this->at(this->displaced(), this->changes(), [&](const ElementState& state) {
      this->elements()[i].describe(this->frames[i], state, outputs.data());
    });
    for (std::size_t k = 0; k < width; ++k) EXPECT_TRUE(std::isfinite(outputs[k]));
    EXPECT_TRUE(std::isnan(outputs[width]));  // writes nothing beyond its outputs
  }
}

TEST(ElementRegistry, KeysOfTablesAndOutputsAreUnique) {
  std::multiset<std::string> keys;
  for_each_element_type([&]<std::size_t k>(std::integral_constant<std::size_t, k>) {
    keys.insert(ElementType<k>::table);
    for (const Output& output : ElementType<k>::outputs()) keys.insert(output.key);
  });
  for (const std::string& key : keys) EXPECT_EQ(keys.count(key), 1u) << key;
}

TEST(DofMap, NumbersRotationsBehindTheTranslationsOfTheirNode) {
  const Model model = testing::four_nodes();  // with 3, 2, 1 and 0 translations
  const DofMap dofs(model, {false, true, false, true});
  EXPECT_EQ(dofs.dofs(), 3 + (2 + 3) + 1 + 3);
  EXPECT_EQ(dofs.sites(), 8u);
  EXPECT_EQ(dofs.at(1).row, 3);
  EXPECT_EQ(dofs.at(1).freedoms, 2);
  EXPECT_EQ(dofs.at(rotation_site(model, 1)).row, 5);
  EXPECT_EQ(dofs.at(rotation_site(model, 1)).freedoms, 3);
  EXPECT_EQ(dofs.at(rotation_site(model, 0)).freedoms, 0);
  EXPECT_EQ(dofs.at(2).row, 8);
  EXPECT_EQ(dofs.at(rotation_site(model, 3)).row, 9);
  EXPECT_EQ(dofs.at(-1).freedoms, 0);
  for (const auto& [dof, node] :
       std::vector<std::pair<int, int>>{{2, 0}, {3, 1}, {7, 1}, {8, 2}, {9, 3}, {11, 3}}) {
    EXPECT_EQ(dofs.node_of(dof), node) << dof;
  }
  // Without an element that has rotations, no node has any.
  const DofMap bars(testing::sample(std::type_identity<Bar>()));
  EXPECT_EQ(bars.dofs(), 6);
  EXPECT_EQ(bars.sites(), 4u);
}

}  // namespace
}  // namespace statejump::truss
