// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the contract of joints/interface.hpp for every registered type.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "samples.hpp"
#include "truss/system.hpp"

namespace statejump::truss {
namespace {

using Eigen::VectorXd;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The joint of a sample truss, in contact and at rest since the start of a step.
template <class Type>
class JointContract : public ::testing::Test {
 protected:
  JointContract() : sample(testing::sample(std::type_identity<Type>())), system(sample.model) {
    sample.model.validate();
    // Displacements of about 1e-6 m, all different, plus those that close the contact.
    z = VectorXd::LinSpaced(system.unknowns(), 1e-6, 4e-6);
    z.segment<3>(system.dofs().at(3).row) += sample.touching;
    z.tail(system.force_count(0)).setConstant(3.0);
    start = system.begin(z, 0.1, system.all_stick(), 1.0);
  }

  const Type& joint() const { return std::get<Type>(sample.model.joints[0]); }
  Trial trial() const { return system.trial(0, z, 0.1, start, JointModel::friction, 1.0); }
  /// Row and column indices of the Jacobian entries that the joint writes in a status.
  std::vector<std::pair<int, int>> entries(JointStatus status) const {
    Assembly to = Assembly::listing(system.unknowns());
    system.evaluate_joint(0, z, 0.3, start, status, JointModel::friction, 1.0, to);
    std::vector<std::pair<int, int>> found;
    for (const auto& entry : to.entries) found.emplace_back(entry.row(), entry.col());
    return found;
  }

  testing::JointSample sample;
  detail::System system;
  VectorXd z;
  detail::StepStart start;
};

template <class Variant>
struct Alternatives;
template <class... Types>
struct Alternatives<std::variant<Types...>> {
  using List = ::testing::Types<Types...>;
};

TYPED_TEST_SUITE(JointContract, Alternatives<Joint>::List);

TYPED_TEST(JointContract, WritesTheSameEntriesWhateverTheStatus) {
  const auto expected = this->entries(JointStatus::stick);
  EXPECT_FALSE(expected.empty());
  for (const JointStatus status : this->sample.statuses) {
    EXPECT_EQ(this->entries(status), expected) << to_string(status);
  }
  if (this->joint().has_play()) {
    EXPECT_EQ(this->entries(JointStatus::open), expected);
  }
}

TYPED_TEST(JointContract, FrameNamesNodesAndARowForEveryForce) {
  const JointFrame frame = this->joint().frame(this->sample.model);
  EXPECT_LE(frame.node_count, most_joint_nodes);
  for (int i = 0; i < most_joint_nodes; ++i) {
    const int node = frame.nodes[static_cast<std::size_t>(i)];
    EXPECT_GE(node, i < frame.node_count ? 0 : -1);
    EXPECT_LT(node, 8);  // four nodes and their rotations
  }
  EXPECT_LE(frame.forces, most_joint_forces);
  EXPECT_LT(TypeParam::slide_row, frame.forces);
  // Unit vectors to a few roundings.
  EXPECT_TRUE(frame.axes.isUnitary(1e-14));
  const auto rows = this->entries(JointStatus::stick);
  for (int row = 0; row < frame.forces; ++row) {
    const int wanted = this->system.force_row(0) + row;
    EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), [&](const auto& entry) {
      return entry.first == wanted;
    })) << row;
  }
}

TYPED_TEST(JointContract, WritesAsManyNumbersAsItRemembers) {
  const auto count = static_cast<std::size_t>(this->joint().history());
  const Trial at = this->trial();
  for (const JointStatus status : this->sample.statuses) {
    std::vector<double> written(count + 1, nan);
    this->joint().begin(at, status, written.data());
    for (std::size_t i = 0; i < count; ++i) EXPECT_TRUE(std::isfinite(written[i])) << i;
    EXPECT_TRUE(std::isnan(written[count]));
    written.assign(count + 1, nan);
    this->joint().commit(at, status, written.data());
    for (std::size_t i = 0; i < count; ++i) EXPECT_TRUE(std::isfinite(written[i])) << i;
    EXPECT_TRUE(std::isnan(written[count]));
  }
}

TYPED_TEST(JointContract, RestMakesNoHeat) {
  const detail::StepStart after =
      this->system.commit(this->z, 0.1, this->system.all_stick(), this->start);
  const double slip = this->system.slips(this->z, 0.1, this->start, after)[0];
  // Rounding of lengths of 0.1 m.
  EXPECT_NEAR(slip, 0.0, 1e-16);
  const Trial at = this->trial();
  const double heat = this->joint().dissipation(at, after.history.data(), 0.0);
  // Rounding of lengths of 0.1 m, times forces of 100 N.
  EXPECT_NEAR(heat, 0.0, 1e-14);
  EXPECT_TRUE(std::isfinite(this->joint().elastic_energy(at, after.history.data())));
}

TYPED_TEST(JointContract, DescribesEveryOutput) {
  std::size_t width = 0;
  for (const Output& output : TypeParam::outputs()) width += static_cast<std::size_t>(output.width);
  std::vector<double> outputs(width + 1, nan);
  this->joint().describe(this->trial(), outputs.data());
  for (std::size_t k = 0; k < width; ++k) EXPECT_TRUE(std::isfinite(outputs[k])) << k;
  EXPECT_TRUE(std::isnan(outputs[width]));
}

TYPED_TEST(JointContract, RefusesEveryParameterThatIsNotFinite) {
  for (const Parameter<TypeParam>& parameter : TypeParam::parameters()) {
    const auto* number = std::get_if<double TypeParam::*>(&parameter.member);
    if (number == nullptr) continue;
    Model model = this->sample.model;
    std::get<TypeParam>(model.joints[0]).*(*number) = nan;
    EXPECT_THROW(model.validate(), std::invalid_argument) << parameter.key;
  }
}

TEST(JointRegistry, KindsAndOutputsAreUnique) {
  std::multiset<std::string> keys;
  for_each_joint_type([&]<class Type>(std::type_identity<Type>) {
    keys.insert(Type::kind);
    for (const Output& output : Type::outputs()) keys.insert(output.key);
  });
  for (const std::string& key : keys) EXPECT_EQ(keys.count(key), 1u) << key;
}

}  // namespace
}  // namespace statejump::truss
