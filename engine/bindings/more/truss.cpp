// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "../bindings.hpp"
#include "statejump/truss/friction_free.hpp"
#include "statejump/truss/modes.hpp"
#include "statejump/truss/motion.hpp"
#include "statejump/truss/path.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

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

/// If a truss has more nodes than this, reading it leaves megabytes of free memory in the process.
constexpr std::size_t many_nodes = 10000;

/// Returns free memory to the operating system. Reading a large truss leaves free gaps between used
/// blocks that are too small for the arrays of the solver.
void give_back_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
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

/// Array of one member of every state, with shape (states, items) or (states, items, 3).
template <class State, class Member>
py::array_t<double> stacked(const std::vector<State>& states, Member member, py::ssize_t width) {
  const auto count = static_cast<py::ssize_t>(states.size());
  const py::ssize_t items = count == 0 ? 0 : (states.front().*member).size() / width;
  std::vector<py::ssize_t> shape{count, items};
  if (width > 1) shape.push_back(width);
  py::array_t<double> result(shape);
  double* to = result.mutable_data();
  for (const State& state : states) {
    const auto& values = state.*member;
    to = std::copy(values.data(), values.data() + values.size(), to);
  }
  return result;
}

template <class State, class Member>
py::array_t<double> scalars(const std::vector<State>& states, Member member) {
  py::array_t<double> result(static_cast<py::ssize_t>(states.size()));
  for (std::size_t i = 0; i < states.size(); ++i) result.mutable_data()[i] = states[i].*member;
  return result;
}

/// Indices of one type's joints among all joints, and of their outputs among all outputs.
struct OfType {
  std::vector<py::ssize_t> joints;
  std::vector<py::ssize_t> outputs;
};

template <class Type>
OfType of_type(const truss::Model& model) {
  OfType found;
  py::ssize_t output = 0;
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (std::holds_alternative<Type>(model.joints[i])) {
      found.joints.push_back(static_cast<py::ssize_t>(i));
      found.outputs.push_back(output);
    }
    for (const truss::Output& one : truss::outputs_of(model.joints[i])) output += one.width;
  }
  return found;
}

/// An array (states, joints) or (states, joints, width) of `value(state, joint)`.
template <class Number, class Value>
py::array_t<Number> of_joints(const std::vector<truss::State>& states, std::size_t joints,
                              py::ssize_t width, Value value) {
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(states.size()),
                                 static_cast<py::ssize_t>(joints)};
  if (width > 1) shape.push_back(width);
  py::array_t<Number> result(shape);
  Number* to = result.mutable_data();
  for (const truss::State& state : states) {
    for (std::size_t i = 0; i < joints; ++i) {
      for (py::ssize_t k = 0; k < width; ++k) *to++ = value(state, i, k);
    }
  }
  return result;
}

/// Outputs of all types by key. Statuses and heat are stored for each type of joint.
py::dict states_dict(const truss::Model& model, const std::vector<truss::State>& states) {
  using truss::State;
  py::dict d;
  d["time_s"] = scalars(states, &State::time);
  d["temperature_change_K"] = scalars(states, &State::temperature_change);
  d["displacement_m"] = stacked(states, &State::displacement, 3);
  const bool rotates = !states.empty() && states.front().rotation.size() > 0;
  if (rotates) d["rotation_rad"] = stacked(states, &State::rotation, 3);
  truss::for_each_element_type([&]<std::size_t k>(std::integral_constant<std::size_t, k>) {
    using Type = truss::ElementType<k>;
    const std::size_t count = std::get<k>(model.lists()).size();
    py::ssize_t offset = 0;
    for (const truss::Output& output : Type::outputs()) {
      std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(states.size()),
                                     static_cast<py::ssize_t>(count)};
      if (output.width > 1) shape.push_back(output.width);
      py::array_t<double> column(shape);
      double* to = column.mutable_data();
      for (const State& state : states) {
        const auto all = truss::element_output<Type>(model, state);
        Eigen::Map<Eigen::MatrixXd>(to, output.width, all.cols()) =
            all.middleRows(offset, output.width);
        to += output.width * all.cols();
      }
      d[output.key] = column;
      offset += output.width;
    }
  });
  truss::for_each_joint_type([&]<class Type>(std::type_identity<Type>) {
    const OfType these = of_type<Type>(model);
    const std::string kind = Type::kind;
    py::ssize_t offset = 0;
    for (const truss::Output& output : Type::outputs()) {
      d[output.key] = of_joints<double>(states, these.joints.size(), output.width,
                                        [&](const State& state, std::size_t i, py::ssize_t k) {
                                          return state.joint_output[these.outputs[i] + offset + k];
                                        });
      offset += output.width;
    }
    d[py::str(kind + "_status")] = of_joints<unsigned char>(
        states, these.joints.size(), 1, [&](const State& state, std::size_t i, py::ssize_t) {
          return static_cast<unsigned char>(
              state.joint_status[static_cast<std::size_t>(these.joints[i])]);
        });
    d[py::str(kind + "_dissipation_J")] = of_joints<double>(
        states, these.joints.size(), 1, [&](const State& state, std::size_t i, py::ssize_t) {
          return state.joint_dissipation[these.joints[i]];
        });
  });
  d["elastic_energy_J"] = scalars(states, &State::elastic_energy);
  d["load_potential_J"] = scalars(states, &State::load_potential);
  d["thermal_work_J"] = scalars(states, &State::thermal_work);
  return d;
}

/// An array with one number per event.
template <class Number, class Value>
py::array_t<Number> of_events(const std::vector<truss::Event>& found, Value value) {
  py::array_t<Number> result(static_cast<py::ssize_t>(found.size()));
  std::transform(found.begin(), found.end(), result.mutable_data(), value);
  return result;
}

/// Events as columns, because a truss of a million joints has millions of events. A joint's number
/// counts only joints of its type. Statuses are stored as codes; `statuses` lists their names.
py::dict event_columns(const truss::Model& model, const std::vector<truss::Event>& found) {
  using truss::Event;
  std::vector<py::ssize_t> place(model.joints.size());
  std::vector<unsigned char> kind(model.joints.size());
  py::list kinds;
  truss::for_each_joint_type([&]<class Type>(std::type_identity<Type>) {
    py::ssize_t next = 0;
    for (const py::ssize_t joint : of_type<Type>(model).joints) {
      place[static_cast<std::size_t>(joint)] = next++;
      kind[static_cast<std::size_t>(joint)] = static_cast<unsigned char>(kinds.size());
    }
    kinds.append(std::string(Type::kind));
  });
  py::dict statuses;
  for (const Event& event : found) {
    for (const truss::JointStatus status : {event.before, event.after}) {
      const py::int_ code(static_cast<int>(status));
      if (!statuses.contains(code)) statuses[code] = to_string(status);
    }
  }
  const auto code = [](truss::JointStatus status) { return static_cast<unsigned char>(status); };
  const auto joint = [](const Event& event) { return static_cast<std::size_t>(event.joint); };
  py::dict events;
  events["time_s"] = of_events<double>(found, [](const Event& event) { return event.time; });
  events["interval_s"] =
      of_events<double>(found, [](const Event& event) { return event.interval; });
  events["temperature_change_K"] =
      of_events<double>(found, [](const Event& event) { return event.temperature_change; });
  events["kind"] =
      of_events<unsigned char>(found, [&](const Event& event) { return kind[joint(event)]; });
  events["joint"] =
      of_events<py::ssize_t>(found, [&](const Event& event) { return place[joint(event)]; });
  events["before"] =
      of_events<unsigned char>(found, [&](const Event& event) { return code(event.before); });
  events["after"] =
      of_events<unsigned char>(found, [&](const Event& event) { return code(event.after); });
  events["kinds"] = kinds;
  events["statuses"] = statuses;
  return events;
}

/// Passes the finished fraction of a run to the caller's function, which returns whether to
/// continue.
std::function<bool(double)> going_on(const py::object& progress) {
  return [&progress](double done) {
    py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();  // Ctrl-C
    return progress.is_none() || !progress(done).is(py::bool_(false));
  };
}

/// Passes the iterations of a path to a caller's function, as tuples in the order of TraceRecord.
truss::TraceSink trace_to(const py::object& function, const truss::Model& model) {
  if (function.is_none()) return {};
  return [&](const truss::TraceRecord& one) {
    py::gil_scoped_acquire lock;
    const std::string joint =
        one.changed_joint < 0
            ? std::string()
            : truss::name_of(model.joints[static_cast<std::size_t>(one.changed_joint)]);
    function(py::make_tuple(one.branch, one.increment, one.step, one.solve, to_string(one.joints),
                            one.opening, one.time, one.temperature_change, one.iteration,
                            one.node_residual, one.closure_residual, one.joint_residual,
                            one.step_length, one.status_changes, joint, one.factorizations,
                            to_string(one.decision), one.step_end));
  };
}

/// Reports progress like going_on(), for runs whose partial results are useful: Ctrl-C ends the run
/// and keeps them.
std::function<bool(double)> until_interrupted(const py::object& progress) {
  return [go_on = going_on(progress)](double done) {
    try {
      return go_on(done);
    } catch (py::error_already_set& stopped) {
      py::gil_scoped_acquire lock;
      if (!stopped.matches(PyExc_KeyboardInterrupt)) throw;
      return false;
    }
  };
}

py::dict motion_dict(const truss::Model& model, const truss::Motion& motion) {
  using truss::MovingState;
  py::dict result;
  py::dict states = states_dict(model, motion.states);
  states["velocity_m_per_s"] = stacked(motion.moving, &MovingState::velocity, 3);
  states["kinetic_energy_J"] = scalars(motion.moving, &MovingState::kinetic_energy);
  states["damping_dissipation_J"] = scalars(motion.moving, &MovingState::damping_dissipation);
  states["impact_dissipation_J"] = scalars(motion.moving, &MovingState::impact_dissipation);
  states["drive_work_J"] = scalars(motion.moving, &MovingState::drive_work);
  states["drive_moment_N_m"] = stacked(motion.moving, &MovingState::drive_moment, 1);
  result["states"] = states;
  result["events"] = event_columns(model, motion.events);
  result["event_heat_J"] = py::array_t<double>(static_cast<py::ssize_t>(motion.event_heat.size()),
                                               motion.event_heat.data());
  result["watched_velocity_m_per_s"] = Eigen::MatrixX3d(motion.watched_velocity.transpose());
  result["complete"] = motion.complete;
  result["time_step_s"] = motion.time_step;
  result["steps"] = motion.steps;
  result["rejected_steps"] = motion.rejected_steps;
  result["inexact_steps"] = motion.inexact_steps;
  result["iterations"] = motion.iterations;
  result["factorizations"] = motion.factorizations;
  result["unknowns"] = motion.unknowns;
  result["largest_contact_merit"] = motion.largest_contact_merit;
  result["negative_dissipation_J"] = motion.negative_dissipation;
  const auto time_and_joints = [&](const std::optional<truss::Undetermined>& found) -> py::object {
    if (!found) return py::none();
    py::list joints;
    for (const int joint : found->joints) {
      joints.append(truss::name_of(model.joints[static_cast<std::size_t>(joint)]));
    }
    return py::make_tuple(found->time, joints);
  };
  result["undetermined"] = time_and_joints(motion.undetermined);
  result["jammed"] = time_and_joints(motion.jammed);
  return result;
}

py::dict path_dict(const truss::Model& model, const truss::Path& path) {
  py::dict result;
  result["states"] = states_dict(model, path.states);
  result["cycle_ends"] = states_dict(model, path.cycle_ends);
  result["events"] = event_columns(model, path.events);
  py::list problems;
  for (const truss::LocalProblem& problem : path.problems) {
    py::dict one;
    one["time_s"] = problem.time;
    one["temperature_change_K"] = problem.temperature_change;
    one["delassus"] = std::get<Eigen::MatrixXd>(problem.problem.delassus);
    one["q"] = problem.problem.q;
    one["mu"] = problem.problem.mu;
    one["reactions"] = problem.reactions;
    one["velocities"] = problem.velocities;
    py::list names;
    for (const int joint : problem.joints) {
      names.append(truss::name_of(model.joints[static_cast<std::size_t>(joint)]));
    }
    one["joints"] = names;
    one["proximal_stiffness_N_per_m"] = problem.proximal_stiffness;
    problems.append(one);
  }
  result["problems"] = problems;
  py::list notes;
  for (const truss::Note& note : path.notes) {
    py::list joints;
    for (const FailureJoint& joint : note.joints) {
      joints.append(py::make_tuple(joint.kind, joint.name));
    }
    py::dict one;
    one["kind"] = to_string(note.kind);
    one["time_s"] = note.time;
    one["temperature_change_K"] = note.temperature_change;
    one["joints"] = joints;
    one["value"] = note.value;
    notes.append(one);
  }
  for (const int which : model.redundant_constraints()) {
    py::dict one;
    one["kind"] = "redundant_constraint";
    for (const char* key : {"time_s", "temperature_change_K", "value"}) one[key] = 0.0;
    one["joints"] = std::vector<std::pair<std::string, std::string>>{
        {truss::Constraint::kind, model.constraints[static_cast<std::size_t>(which)].name}};
    notes.append(one);
  }
  result["notes"] = notes;
  result["complete"] = path.complete;
  result["solves"] = path.solves;
  result["factorizations"] = path.factorizations;
  result["unknowns"] = path.unknowns;
  result["largest_force_residual"] = path.largest_force_residual;
  result["largest_closure_residual_m"] = path.largest_closure_residual;
  return result;
}

/// Description of a type of element or joint for Python.
template <class Type>
py::dict type_dict() {
  py::list parameters;
  for (const truss::Parameter<Type>& parameter : Type::parameters()) {
    py::dict one;
    one["key"] = parameter.key;
    one["unit"] = parameter.unit;
    one["source"] = parameter.source;
    parameters.append(one);
  }
  py::list outputs;
  for (const truss::Output& output : Type::outputs()) outputs.append(output.key);
  py::dict made;
  made["parameters"] = parameters;
  made["outputs"] = outputs;
  return made;
}

/// Documentation of truss_path().
constexpr const char* about_path =
    "Quasi-static path of a truss: exact Coulomb friction at every joint.\n\n"
    "Every kind of item is a dict of arrays, one entry per item, and 'names'. Index -1: ground.\n"
    "nodes: position_m (n, 3), fixed (n, 3), guide_normal (n, 3), force_N (n, 3); with beams\n"
    "fixed_rotations (n, 3), moment_N_m (n, 3)\n"
    "elements: table -> such a dict, with the arrays that truss_elements() lists for it\n"
    "joints: kind -> such a dict, with the arrays that truss_joints() lists for it\n"
    "constraints: names, nodes (terms,) and coefficients (terms, 3) of each: a sum that is 0\n\n"
    "Returns states and cycle_ends (dicts of arrays, first axis the state; axial force positive\n"
    "in compression), events, problems (frictional contact problems of the first steps that end "
    "at\n"
    "problem_times or later, see truss/local_problem.hpp), complete, solves, factorizations, "
    "unknowns, largest residuals.\n"
    "start_friction: 'stuck' or 'frictionless', see start_friction.hpp.\n"
    "progress(share) may return False to end the path early: complete is then False.\n"
    "trace is called with every Newton iteration, a tuple in the order of\n"
    "statejump/truss/trace.hpp with names in place of numbers. Raises "
    "ValueError for items out of range, RuntimeError that names joint or nodes "
    "and\n"
    "temperature for mechanisms, unloaded joints and failed equilibrium.";

py::dict path_of(const py::dict& nodes, const py::dict& elements, const py::dict& joints,
                 std::vector<thermal::Program> programs, int increments_per_branch,
                 bool locate_events, double event_tolerance, double energy_tolerance,
                 bool cycle_ends_only, std::vector<double> problem_times,
                 const std::string& start_friction, const py::object& progress,
                 const py::object& trace, const py::dict& constraints) {
  const truss::Model model = make_model(nodes, elements, joints, constraints, std::move(programs));
  truss::Options options;
  options.start_friction = start_friction_of(start_friction);
  options.increments_per_branch = increments_per_branch;
  options.locate_events = locate_events;
  options.event_tolerance = event_tolerance;
  options.energy_tolerance = energy_tolerance;
  options.cycle_ends_only = cycle_ends_only;
  options.problem_times = std::move(problem_times);
  options.progress = going_on(progress);
  options.trace = trace_to(trace, model);
  truss::Path path;
  {
    py::gil_scoped_release unlocked;
    if (model.nodes.size() >= many_nodes) give_back_memory();
    path = truss::solve(model, options);
  }
  return path_dict(model, path);
}

truss::Inertia inertia_of(const py::dict& from) {
  const auto numbers = [&](const char* key) { return from[key].cast<Eigen::VectorXd>(); };
  truss::Inertia made{numbers("link_mass_kg"),
                      numbers("node_mass_kg"),
                      numbers("link_damping_N_s_per_m"),
                      numbers("pin_damping_N_m_s_per_rad"),
                      numbers("spring_damping_N_s_per_m"),
                      numbers("joint_damping_sqrt_kg"),
                      from["link_centre"].cast<Eigen::MatrixX2d>().transpose(),
                      numbers("link_moment_kg_m2")};
  made.beam_mass = numbers("beam_mass_kg");
  made.beam_moment = from["beam_moment_kg_m2"].cast<Eigen::MatrixX3d>().transpose();
  return made;
}

/// Documentation of truss_motion().
constexpr const char* about_motion =
    "Motion of a truss from the equilibrium in which its quasi-static path begins, or from the\n"
    "drawn shape, at rest.\n\n"
    "Items as of truss_path(). inertia: link_mass_kg, link_damping_N_s_per_m,\n"
    "pin_damping_N_m_s_per_rad (a number for each link), node_mass_kg,\n"
    "spring_damping_N_s_per_m, joint_damping_sqrt_kg (2 ζ √m of each joint, kind by kind as of\n"
    "truss_joints()), link_centre (m, 2) shares along and to the left, link_moment_kg_m2,\n"
    "beam_mass_kg, beam_moment_kg_m2 (m, 3) of half a beam about x, y, z of its section.\n"
    "steps: of the whole program. displacement_tolerance_m: of a step, which is then as long as\n"
    "that allows; 0: equal steps. drives: dicts with name, link, time_s,\n"
    "angular_velocity_rad_per_s; their moments and work are among the states. friction_law: the\n"
    "contacts of a DEM with friction of that name, in explicit steps; \"\": sets.\n\n"
    "Returns states as truss_path() with velocities and energies, events with the heat of their\n"
    "step, the watched node's velocity at every step. Ctrl-C, or progress(share) that returns\n"
    "False, ends it with what it has, complete is then False. Raises ValueError for items out of "
    "range,\n"
    "RuntimeError that names joint and temperature for a step without solution.";

py::dict motion_of(const py::dict& nodes, const py::dict& elements, const py::dict& joints,
                   std::vector<thermal::Program> programs, const py::dict& inertia, long steps,
                   long sample_every, double theta, double displacement_tolerance_m,
                   double restitution, int watched_node, const py::list& drives, bool start_drawn,
                   const std::string& start_friction, const std::string& friction_law,
                   const py::object& progress, const py::dict& constraints) {
  const truss::Model model = make_model(nodes, elements, joints, constraints, std::move(programs));
  const truss::Inertia masses = inertia_of(inertia);
  truss::MotionOptions options;
  for (const py::handle& one : drives) {
    options.drives.push_back({one["name"].cast<std::string>(), one["link"].cast<int>(),
                              one["time_s"].cast<Eigen::VectorXd>(),
                              one["angular_velocity_rad_per_s"].cast<Eigen::VectorXd>()});
  }
  options.start_friction = start_friction_of(start_friction);
  if (start_drawn) {
    const auto count = static_cast<Eigen::Index>(model.nodes.size());
    options.start =
        truss::MotionStart{Eigen::Matrix3Xd::Zero(3, count), Eigen::Matrix3Xd::Zero(3, count)};
  }
  options.steps = steps;
  options.sample_every = sample_every;
  options.theta = theta;
  options.displacement_tolerance = displacement_tolerance_m;
  options.restitution = restitution;
  options.watched_node = watched_node;
  options.progress = until_interrupted(progress);
  truss::Motion motion;
  {
    py::gil_scoped_release unlocked;
    motion = friction_law.empty()
                 ? truss::simulate(model, masses, options)
                 : truss::simulate_regularised(model, masses, friction_law, options);
  }
  return motion_dict(model, motion);
}

py::dict linearised(const py::dict& nodes, const py::dict& elements, const py::dict& joints,
                    std::vector<thermal::Program> programs, const py::dict& inertia,
                    const std::string& start_friction, const py::dict& constraints) {
  const truss::Model model = make_model(nodes, elements, joints, constraints, std::move(programs));
  const truss::Inertia masses = inertia_of(inertia);
  truss::Linearised found;
  {
    py::gil_scoped_release unlocked;
    found = truss::linearise(model, masses, start_friction_of(start_friction));
  }
  py::dict made;
  made["stiffness_N_per_m"] = std::move(found.stiffness);
  made["mass_kg"] = std::move(found.mass);
  made["constraints"] = std::move(found.constraints);
  made["of_nodes"] = std::move(found.of_nodes);
  return made;
}

py::dict friction_free_of(const py::dict& nodes, const py::dict& elements, const py::dict& joints,
                          std::vector<thermal::Program> programs, const py::dict& constraints,
                          const std::string& start_friction) {
  const truss::Model model = make_model(nodes, elements, joints, constraints, std::move(programs));
  const auto from = start_friction_of(start_friction);
  truss::FrictionFree found;
  {
    py::gil_scoped_release unlocked;
    found = truss::friction_free(model, from);
  }
  py::dict made;
  made["stiffness_N_per_m"] = std::move(found.stiffness);
  made["guides"] = std::move(found.guides);
  made["guide_joint"] = std::move(found.guide_joint);
  made["load_N"] = std::move(found.load);
  made["slides"] = std::move(found.slides);
  made["heating_N_per_K"] = std::move(found.heating);
  made["of_nodes"] = std::move(found.of_nodes);
  made["friction_limit_N"] = std::move(found.friction_limit);
  made["slide_m"] = std::move(found.slide);
  made["sticking_stiffness_N_per_m"] = std::move(found.sticking_stiffness);
  made["full_slip_m"] = std::move(found.full_slip);
  made["radius_m"] = std::move(found.radius);
  made["displacement_m"] = Eigen::MatrixX3d(found.displacement.transpose());
  return made;
}

void bind_types(py::module_& module) {
  module.def(
      "truss_elements",
      [] {
        py::dict tables;
        truss::for_each_element_type([&]<std::size_t k>(std::integral_constant<std::size_t, k>) {
          using Type = truss::ElementType<k>;
          if (Type::parameters().empty() && Type::outputs().empty()) return;  // no item of a case
          tables[Type::table] = type_dict<Type>();
        });
        return tables;
      },
      "Types of elements of a truss: table -> parameters (key, unit, source) and keys of outputs.\n"
      "A key that is listed n times is an array of n columns.");
  module.def(
      "truss_joints",
      [] {
        py::dict kinds;
        truss::for_each_joint_type(
            [&]<class Type>(std::type_identity<Type>) { kinds[Type::kind] = type_dict<Type>(); });
        return kinds;
      },
      "Types of joints of a truss: kind -> parameters (key, unit, source) and keys of outputs.");
  module.def(
      "iwan_slack_N",
      [](double tangent_stiffness, double slip_force, double exponent, double stiffness_ratio,
         int elements, double spacing) {
        truss::IwanJoint joint;
        joint.tangent_stiffness = tangent_stiffness;
        joint.slip_force = slip_force;
        joint.exponent = exponent;
        joint.stiffness_ratio = stiffness_ratio;
        joint.elements = elements;
        joint.spacing = spacing;
        return joint.slack();
      },
      py::arg("tangent_stiffness_N_per_m"), py::arg("slip_force_N"), py::arg("exponent"),
      py::arg("stiffness_ratio"), py::arg("elements"), py::arg("spacing"),
      "Largest error [N] of a first loading of an Iwan joint in Jenkins elements.");
}

void bind_path(py::module_& module) {
  module.def("truss_path", path_of, py::arg("nodes"), py::arg("elements"), py::arg("joints"),
             py::arg("programs"), py::kw_only(),
             py::arg("increments_per_branch") = truss::Options().increments_per_branch,
             py::arg("locate_events") = truss::Options().locate_events,
             py::arg("event_tolerance") = truss::Options().event_tolerance,
             py::arg("energy_tolerance") = truss::Options().energy_tolerance,
             py::arg("cycle_ends_only") = truss::Options().cycle_ends_only,
             py::arg("problem_times") = std::vector<double>(), py::arg("start_friction") = "stuck",
             py::arg("progress") = py::none(), py::arg("trace") = py::none(),
             py::arg("constraints") = py::dict(), about_path);
}

void bind_motion(py::module_& module) {
  module.def("truss_motion", motion_of, py::arg("nodes"), py::arg("elements"), py::arg("joints"),
             py::arg("programs"), py::arg("inertia"), py::kw_only(), py::arg("steps"),
             py::arg("sample_every"), py::arg("theta") = 0.5,
             py::arg("displacement_tolerance_m") = 0.0, py::arg("restitution") = 0.0,
             py::arg("watched_node") = -1, py::arg("drives") = py::list(),
             py::arg("start_drawn") = false, py::arg("start_friction") = "stuck",
             py::arg("friction_law") = "", py::arg("progress") = py::none(),
             py::arg("constraints") = py::dict(), about_motion);
  module.def("truss_linearised", linearised, py::arg("nodes"), py::arg("elements"),
             py::arg("joints"), py::arg("programs"), py::arg("inertia"), py::kw_only(),
             py::arg("start_friction") = "stuck", py::arg("constraints") = py::dict(),
             "Matrices of small vibrations about the first equilibrium, every joint held.\n\n"
             "Items as of truss_motion(). Returns sparse matrices of scipy: stiffness_N_per_m and "
             "mass_kg of the\ndofs q; constraints, whose product with q is zero; of_nodes: "
             "displacements [m] of all nodes, then\nrotation vectors [rad], as functions of q.");
}

void bind_friction_free(py::module_& module) {
  module.def(
      "truss_friction_free", friction_free_of, py::arg("nodes"), py::arg("elements"),
      py::arg("joints"), py::arg("programs"), py::kw_only(), py::arg("constraints") = py::dict(),
      py::arg("start_friction") = "frictionless",
      "Equations about an equilibrium, every friction joint free to slide.\n\nItems and "
      "start_friction as of truss_path(): 'frictionless' is the equilibrium without "
      "friction.\nReturns sparse matrices of scipy: stiffness_N_per_m, guides, slides\n"
      "(joints, dofs), heating_N_per_K (dofs, elements), of_nodes; load_N of joint "
      "forces; guide_joint of each guide (-1: none); of each "
      "joint, kind by kind as of\ntruss_joints(): friction_limit_N (NaN: not given), slide_m,"
      " sticking_stiffness_N_per_m,\nfull_slip_m, radius_m; displacement_m (nodes, 3).");
}

}  // namespace

void bind_truss(py::module_& module) {
  bind_types(module);
  bind_path(module);
  bind_motion(module);
  bind_friction_free(module);
}

}  // namespace statejump::bindings
