// SPDX-License-Identifier: GPL-3.0-or-later
#include "truss_model.hpp"

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace py = pybind11;

namespace statejump::bindings {

using Eigen::Vector3d;

namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Indices = py::array_t<int, py::array::c_style | py::array::forcecast>;
using Flags = py::array_t<bool, py::array::c_style | py::array::forcecast>;

/// The arrays with the parameters of one type of element or joint. Rejects a missing array and
/// arrays of different lengths.
class Table {
 public:
  Table(const char* kind, const py::dict& arrays) : kind_(kind), arrays_(arrays) {
    names_ = arrays["names"].cast<std::vector<std::string>>();
  }
  std::size_t size() const { return names_.size(); }
  const std::string& name(std::size_t i) const { return names_[i]; }

  Numbers numbers(const char* key, py::ssize_t width = 1) const {
    return checked<Numbers>(key, width);
  }
  Indices indices(const char* key, py::ssize_t width = 1) const {
    return checked<Indices>(key, width);
  }
  Flags flags(const char* key, py::ssize_t width = 1) const { return checked<Flags>(key, width); }

 private:
  template <class Array>
  Array checked(const char* key, py::ssize_t width) const {
    if (!arrays_.contains(key)) throw py::key_error(std::string(kind_) + ": no array " + key);
    Array array = arrays_[key].template cast<Array>();
    if (array.size() != width * static_cast<py::ssize_t>(names_.size())) {
      throw py::value_error(std::string(kind_) + "." + key + " has " +
                            std::to_string(array.size()) + " numbers, needed are " +
                            std::to_string(width) + " for each of " +
                            std::to_string(names_.size()) + " items");
    }
    return array;
  }

  const char* kind_;
  py::dict arrays_;
  std::vector<std::string> names_;
};

Vector3d row(const Numbers& array, std::size_t i) {
  return Eigen::Map<const Vector3d>(array.data() + 3 * i);
}

/// Returns the directions that neither a fixed coordinate nor a guide plane constrains, and how
/// many there are.
std::pair<truss::Directions, int> free_directions(const bool* fixed, Vector3d normal) {
  std::vector<Vector3d> held;
  for (int k = 0; k < 3; ++k) {
    if (fixed[k]) held.push_back(Vector3d::Unit(k));
  }
  const auto remainder = [&](Vector3d direction) {
    for (const Vector3d& taken : held) direction -= taken * taken.dot(direction);
    return direction;
  };
  normal = remainder(normal);
  if (normal.norm() > 1e-9) held.push_back(normal.normalized());
  int freedoms = 0;
  Eigen::Matrix3d columns = Eigen::Matrix3d::Identity();
  while (held.size() < 3) {
    // The coordinate direction with the largest part outside the constrained directions.
    Vector3d best = remainder(Vector3d::UnitX());
    for (int k = 1; k < 3; ++k) {
      const Vector3d direction = remainder(Vector3d::Unit(k));
      if (direction.norm() > best.norm() + 1e-9) best = direction;
    }
    held.push_back(best.normalized());
    columns.col(freedoms++) = held.back();
  }
  return {truss::Directions(columns), freedoms};
}

/// Creates the elements or joints of one type from a table whose columns are their parameters.
template <class Type>
std::vector<Type> items_of(const Table& table) {
  std::vector<Type> items(table.size());
  for (std::size_t i = 0; i < table.size(); ++i) items[i].name = table.name(i);
  for (const truss::Parameter<Type>& parameter : Type::parameters()) {
    const auto width = static_cast<std::size_t>(parameter.width);
    const auto part = static_cast<std::size_t>(parameter.part);
    const auto fill = [&](auto member) {
      using Value = std::decay_t<decltype(items.front().*member)>;
      const auto copy = [&](const auto& values) {
        for (std::size_t i = 0; i < table.size(); ++i) {
          items[i].*member = values.data()[width * i + part];
        }
      };
      if constexpr (std::is_same_v<Value, double>) {
        copy(table.numbers(parameter.key, parameter.width));
      } else if constexpr (std::is_same_v<Value, int>) {
        copy(table.indices(parameter.key, parameter.width));
      } else if constexpr (std::is_same_v<Value, bool>) {
        copy(table.flags(parameter.key, parameter.width));
      } else {
        const auto values = table.numbers(parameter.key, 3);
        for (std::size_t i = 0; i < table.size(); ++i) items[i].*member = row(values, i);
      }
    };
    std::visit(fill, parameter.member);
  }
  return items;
}

/// Sets the moment curves of hinges; hinges with an empty table have none.
void set_curves(const py::dict& arrays, std::vector<truss::Hinge>& hinges) {
  using Lists = std::vector<std::vector<double>>;
  const auto angle = arrays["table_angle_rad"].cast<Lists>();
  const auto moment = arrays["table_moment_N_m"].cast<Lists>();
  const auto slope = arrays["table_slope_N_m_per_rad"].cast<Lists>();
  for (std::size_t i = 0; i < hinges.size(); ++i) {
    if (angle.at(i).empty()) continue;
    hinges[i].curve =
        std::make_shared<const truss::MomentCurve>(angle[i], moment.at(i), slope.at(i));
  }
}

/// Condensed bodies: of each its nodes and matrices.
std::vector<truss::CondensedBody> bodies_of(const py::dict& arrays) {
  const auto names = arrays["names"].cast<std::vector<std::string>>();
  const auto nodes = arrays["nodes"].cast<std::vector<std::vector<int>>>();
  const auto rotating = arrays["rotating"].cast<std::vector<std::vector<bool>>>();
  const auto stiffness = arrays["stiffness"].cast<std::vector<Eigen::MatrixXd>>();
  const auto inertia = arrays["mass"].cast<std::vector<Eigen::MatrixXd>>();
  const auto programs = arrays["programs"].cast<std::vector<std::vector<int>>>();
  const auto fractions = arrays["temperature_fractions"].cast<std::vector<std::vector<double>>>();
  const auto shapes = arrays["free_shapes"].cast<std::vector<std::vector<Eigen::VectorXd>>>();
  std::vector<truss::CondensedBody> made;
  for (std::size_t i = 0; i < names.size(); ++i) {
    truss::CondensedBody one{names[i],        nodes.at(i),   rotating.at(i),
                             stiffness.at(i), inertia.at(i), {}};
    for (std::size_t k = 0; k < programs.at(i).size(); ++k) {
      one.patterns.push_back({programs[i][k], fractions.at(i).at(k), shapes.at(i).at(k)});
    }
    made.push_back(std::move(one));
  }
  return made;
}

std::vector<truss::Constraint> constraints_of(const py::dict& arrays) {
  std::vector<truss::Constraint> made;
  if (!arrays.contains("names")) return made;
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const auto names = arrays["names"].cast<std::vector<std::string>>();
  const auto nodes = arrays["nodes"].cast<std::vector<std::vector<int>>>();
  const auto coefficients = arrays["coefficients"].cast<std::vector<Coefficients>>();
  for (std::size_t i = 0; i < names.size(); ++i) {
    truss::Constraint one{names[i], {}};
    for (std::size_t k = 0; k < nodes.at(i).size(); ++k) {
      one.terms.push_back({nodes[i][k], coefficients.at(i).row(static_cast<Eigen::Index>(k))});
    }
    made.push_back(std::move(one));
  }
  return made;
}

}  // namespace

truss::Model make_model(const py::dict& nodes_, const py::dict& elements_, const py::dict& joints_,
                        const py::dict& constraints_, std::vector<thermal::Program> programs) {
  truss::Model model;
  model.programs = std::move(programs);
  {
    const Table table("nodes", nodes_);
    const auto position = table.numbers("position_m", 3);
    const auto fixed = table.flags("fixed", 3);
    const auto normal = table.numbers("guide_normal", 3);
    const auto force = table.numbers("force_N", 3);
    // Most nodes have one of a few supports, so nodes with equal supports share one object.
    using Support = std::tuple<bool, bool, bool, double, double, double>;
    std::map<Support, std::pair<truss::Directions, int>> supports;
    model.nodes.reserve(table.size());
    for (std::size_t i = 0; i < table.size(); ++i) {
      truss::Node node;
      node.name = table.name(i);
      node.position = row(position, i);
      node.load = row(force, i);
      const bool* held = fixed.data() + 3 * i;
      const Vector3d guide = row(normal, i);
      const Support support{held[0], held[1], held[2], guide.x(), guide.y(), guide.z()};
      auto found = supports.find(support);
      if (found == supports.end()) {
        found = supports.emplace(support, free_directions(held, guide)).first;
      }
      std::tie(node.free_directions, node.freedoms) = found->second;
      model.nodes.push_back(std::move(node));
    }
    if (nodes_.contains("fixed_rotations")) {
      const auto clamped = table.flags("fixed_rotations", 3);
      const auto moment = table.numbers("moment_N_m", 3);
      for (std::size_t i = 0; i < table.size(); ++i) {
        truss::Node& node = model.nodes[i];
        node.moment = row(moment, i);
        std::tie(node.rotation_directions, node.rotations) =
            free_directions(clamped.data() + 3 * i, Vector3d::Zero());
      }
    }
  }
  truss::for_each_element_type([&]<std::size_t k>(std::integral_constant<std::size_t, k>) {
    using Type = truss::ElementType<k>;
    if (!elements_.contains(Type::table)) return;
    const auto arrays = elements_[Type::table].template cast<py::dict>();
    if constexpr (std::is_same_v<Type, truss::CondensedBody>) {
      model.bodies = bodies_of(arrays);
    } else {
      std::get<k>(model.lists()) = items_of<Type>(Table(Type::table, arrays));
    }
  });
  truss::for_each_joint_type([&]<class Type>(std::type_identity<Type>) {
    if (joints_.contains(Type::kind)) {
      const auto arrays = joints_[Type::kind].template cast<py::dict>();
      const Table table(Type::kind, arrays);
      model.joints.reserve(model.joints.size() + table.size());
      std::vector<Type> items = items_of<Type>(table);
      if constexpr (std::is_same_v<Type, truss::Hinge>) set_curves(arrays, items);
      for (Type& joint : items) model.joints.emplace_back(std::move(joint));
    }
  });
  model.constraints = constraints_of(constraints_);
  truss::measure_rotations(model);
  return model;
}

}  // namespace statejump::bindings
