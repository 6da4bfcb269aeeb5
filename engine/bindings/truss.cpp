// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "statejump/truss/path.hpp"

namespace py = pybind11;

namespace statejump::bindings {

using Eigen::Vector3d;

namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Indices = py::array_t<int, py::array::c_style | py::array::forcecast>;
using Flags = py::array_t<bool, py::array::c_style | py::array::forcecast>;

/// The arrays of one kind of item; a missing one or one of another length is refused.
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

/// Gives the node the directions that neither a fixed coordinate nor a guide plane takes away.
void set_free_directions(const bool* fixed, Vector3d normal, truss::Node& node) {
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
  node.freedoms = 0;
  while (held.size() < 3) {
    // The coordinate direction of which most is left.
    Vector3d best = remainder(Vector3d::UnitX());
    for (int k = 1; k < 3; ++k) {
      const Vector3d direction = remainder(Vector3d::Unit(k));
      if (direction.norm() > best.norm() + 1e-9) best = direction;
    }
    held.push_back(best.normalized());
    node.free_directions.col(node.freedoms++) = held.back();
  }
}

truss::Model make_model(const py::dict& nodes_, const py::dict& links_, const py::dict& springs_,
                        const py::dict& torsion_springs_, const py::dict& sliders_,
                        const py::dict& revolutes_, std::vector<thermal::Program> programs) {
  truss::Model model;
  model.programs = std::move(programs);
  {
    const Table table("nodes", nodes_);
    const auto position = table.numbers("position_m", 3);
    const auto fixed = table.flags("fixed", 3);
    const auto normal = table.numbers("guide_normal", 3);
    const auto force = table.numbers("force_N", 3);
    for (std::size_t i = 0; i < table.size(); ++i) {
      truss::Node node;
      node.name = table.name(i);
      node.position = row(position, i);
      node.load = row(force, i);
      set_free_directions(fixed.data() + 3 * i, row(normal, i), node);
      model.nodes.push_back(std::move(node));
    }
  }
  {
    const Table table("links", links_);
    const auto ends = table.indices("nodes", 2);
    const auto stiffness = table.numbers("axial_stiffness_N");
    const auto length = table.numbers("stress_free_length_m");
    const auto expansion = table.numbers("thermal_expansion_per_K");
    const auto program = table.indices("program");
    const auto fraction = table.numbers("temperature_fraction");
    for (std::size_t i = 0; i < table.size(); ++i) {
      model.links.push_back({table.name(i), ends.data()[2 * i], ends.data()[2 * i + 1],
                             stiffness.data()[i], length.data()[i], expansion.data()[i],
                             program.data()[i], fraction.data()[i]});
    }
  }
  {
    const Table table("springs", springs_);
    const auto ends = table.indices("nodes", 2);
    const auto stiffness = table.numbers("stiffness_N_per_m");
    const auto length = table.numbers("free_length_m");
    const auto cable = table.flags("cable");
    for (std::size_t i = 0; i < table.size(); ++i) {
      model.springs.push_back({table.name(i), ends.data()[2 * i], ends.data()[2 * i + 1],
                               stiffness.data()[i], length.data()[i], cable.data()[i]});
    }
  }
  {
    const Table table("torsion_springs", torsion_springs_);
    const auto links = table.indices("links", 2);
    const auto stiffness = table.numbers("stiffness_N_m_per_rad");
    const auto bias = table.numbers("bias_rad");
    const auto axis = table.numbers("axis", 3);
    for (std::size_t i = 0; i < table.size(); ++i) {
      model.torsion_springs.push_back({table.name(i), links.data()[2 * i], links.data()[2 * i + 1],
                                       stiffness.data()[i], bias.data()[i], row(axis, i)});
    }
  }
  {
    const Table table("sliders", sliders_);
    const auto ends = table.indices("nodes", 2);
    const auto axis = table.numbers("axis", 3);
    const auto friction = table.numbers("friction_force_N");
    const auto minus = table.numbers("clearance_minus_m");
    const auto plus = table.numbers("clearance_plus_m");
    const auto tangential = table.numbers("tangential_stiffness_N_per_m");
    for (std::size_t i = 0; i < table.size(); ++i) {
      model.sliders.push_back({table.name(i), ends.data()[2 * i], ends.data()[2 * i + 1],
                               row(axis, i), friction.data()[i], minus.data()[i], plus.data()[i],
                               tangential.data()[i]});
    }
  }
  {
    const Table table("revolutes", revolutes_);
    const auto journal_node = table.indices("journal_node");
    const auto bearing_node = table.indices("bearing_node");
    const auto journal_link = table.indices("journal_link");
    const auto bearing_link = table.indices("bearing_link");
    const auto radius = table.numbers("journal_radius_m");
    const auto clearance = table.numbers("radial_clearance_m");
    const auto journal_expansion = table.numbers("journal_thermal_expansion_per_K");
    const auto bearing_expansion = table.numbers("bearing_thermal_expansion_per_K");
    const auto friction = table.numbers("friction_coefficient");
    const auto hertz = table.numbers("hertz_stiffness_N_per_m15");
    const auto mindlin = table.numbers("mindlin_stiffness_N_per_m15");
    const auto axis = table.numbers("axis", 3);
    const auto program = table.indices("program");
    const auto fraction = table.numbers("temperature_fraction");
    for (std::size_t i = 0; i < table.size(); ++i) {
      model.revolutes.push_back({table.name(i), journal_node.data()[i], bearing_node.data()[i],
                                 journal_link.data()[i], bearing_link.data()[i], radius.data()[i],
                                 clearance.data()[i], journal_expansion.data()[i],
                                 bearing_expansion.data()[i], friction.data()[i], hertz.data()[i],
                                 mindlin.data()[i], row(axis, i), program.data()[i],
                                 fraction.data()[i]});
    }
  }
  return model;
}

/// One array (states, items) or (states, items, 3) of a member of every state.
template <class Member>
py::array_t<double> stacked(const std::vector<truss::State>& states, Member member,
                            py::ssize_t width) {
  const auto count = static_cast<py::ssize_t>(states.size());
  const py::ssize_t items = count == 0 ? 0 : (states.front().*member).size() / width;
  std::vector<py::ssize_t> shape{count, items};
  if (width > 1) shape.push_back(width);
  py::array_t<double> result(shape);
  double* to = result.mutable_data();
  for (const truss::State& state : states) {
    const auto& values = state.*member;
    to = std::copy(values.data(), values.data() + values.size(), to);
  }
  return result;
}

template <class Member>
py::array_t<double> scalars(const std::vector<truss::State>& states, Member member) {
  py::array_t<double> result(static_cast<py::ssize_t>(states.size()));
  for (std::size_t i = 0; i < states.size(); ++i) result.mutable_data()[i] = states[i].*member;
  return result;
}

template <class Member>
py::array_t<unsigned char> statuses(const std::vector<truss::State>& states, Member member) {
  const auto count = static_cast<py::ssize_t>(states.size());
  const auto items = static_cast<py::ssize_t>(count == 0 ? 0 : (states.front().*member).size());
  py::array_t<unsigned char> result({count, items});
  unsigned char* to = result.mutable_data();
  for (const truss::State& state : states) {
    for (const truss::JointStatus status : state.*member)
      *to++ = static_cast<unsigned char>(status);
  }
  return result;
}

py::dict states_dict(const std::vector<truss::State>& states) {
  py::dict d;
  d["time_s"] = scalars(states, &truss::State::time);
  d["temperature_change_K"] = scalars(states, &truss::State::temperature_change);
  d["displacement_m"] = stacked(states, &truss::State::displacement, 3);
  d["axial_force_N"] = stacked(states, &truss::State::axial_force, 1);
  d["tension_N"] = stacked(states, &truss::State::tension, 1);
  d["slide_m"] = stacked(states, &truss::State::slide, 1);
  d["slider_force_N"] = stacked(states, &truss::State::slider_force, 1);
  d["slider_status"] = statuses(states, &truss::State::slider_status);
  d["slider_dissipation_J"] = stacked(states, &truss::State::slider_dissipation, 1);
  d["eccentricity_m"] = stacked(states, &truss::State::eccentricity, 3);
  d["normal_force_N"] = stacked(states, &truss::State::normal_force, 1);
  d["friction_force_N"] = stacked(states, &truss::State::friction_force, 1);
  d["revolute_status"] = statuses(states, &truss::State::revolute_status);
  d["revolute_dissipation_J"] = stacked(states, &truss::State::revolute_dissipation, 1);
  d["elastic_energy_J"] = scalars(states, &truss::State::elastic_energy);
  d["load_potential_J"] = scalars(states, &truss::State::load_potential);
  d["thermal_work_J"] = scalars(states, &truss::State::thermal_work);
  return d;
}

py::dict path_dict(const truss::Path& path) {
  py::dict result;
  result["states"] = states_dict(path.states);
  result["cycle_ends"] = states_dict(path.cycle_ends);
  py::list events;
  for (const truss::Event& event : path.events) {
    py::dict one;
    one["time_s"] = event.time;
    one["interval_s"] = event.interval;
    one["temperature_change_K"] = event.temperature_change;
    one["joint_kind"] = event.is_revolute ? "revolute" : "slider";
    one["joint"] = event.joint;
    one["before"] = to_string(event.before);
    one["after"] = to_string(event.after);
    events.append(one);
  }
  result["events"] = events;
  result["complete"] = path.complete;
  result["solves"] = path.solves;
  result["factorizations"] = path.factorizations;
  result["unknowns"] = path.unknowns;
  result["largest_force_residual"] = path.largest_force_residual;
  result["largest_closure_residual_m"] = path.largest_closure_residual;
  return result;
}

}  // namespace

void bind_truss(py::module_& module) {
  module.def(
      "truss_path",
      [](const py::dict& nodes, const py::dict& links, const py::dict& springs,
         const py::dict& torsion_springs, const py::dict& sliders, const py::dict& revolutes,
         std::vector<thermal::Program> programs, int increments_per_branch, bool locate_events,
         double event_tolerance, bool cycle_ends_only, const py::object& progress) {
        const truss::Model model = make_model(nodes, links, springs, torsion_springs, sliders,
                                              revolutes, std::move(programs));
        truss::Options options;
        options.increments_per_branch = increments_per_branch;
        options.locate_events = locate_events;
        options.event_tolerance = event_tolerance;
        options.cycle_ends_only = cycle_ends_only;
        options.progress = [&progress](double done) {
          py::gil_scoped_acquire lock;
          if (PyErr_CheckSignals() != 0) throw py::error_already_set();  // Ctrl-C
          return progress.is_none() || !progress(done).is(py::bool_(false));
        };
        truss::Path path;
        {
          py::gil_scoped_release unlocked;
          path = truss::solve(model, options);
        }
        return path_dict(path);
      },
      py::arg("nodes"), py::arg("links"), py::arg("springs"), py::arg("torsion_springs"),
      py::arg("sliders"), py::arg("revolutes"), py::arg("programs"), py::kw_only(),
      py::arg("increments_per_branch") = 50, py::arg("locate_events") = true,
      py::arg("event_tolerance") = 1e-9, py::arg("cycle_ends_only") = false,
      py::arg("progress") = py::none(),
      "Quasi-static path of a truss: exact Coulomb friction at every joint.\n\n"
      "Every kind of item is a dict of arrays, one entry per item, and 'names'. Index -1: ground.\n"
      "nodes: position_m (n, 3), fixed (n, 3), guide_normal (n, 3), force_N (n, 3)\n"
      "links: nodes (m, 2), axial_stiffness_N, stress_free_length_m, thermal_expansion_per_K,\n"
      "  program, temperature_fraction\n"
      "springs: nodes (k, 2), stiffness_N_per_m, free_length_m, cable\n"
      "torsion_springs: links (t, 2), stiffness_N_m_per_rad, bias_rad, axis (t, 3)\n"
      "sliders: nodes (s, 2), axis (s, 3), friction_force_N, clearance_minus_m, clearance_plus_m\n"
      "revolutes: journal_node, bearing_node, journal_link, bearing_link, journal_radius_m,\n"
      "  radial_clearance_m, journal_thermal_expansion_per_K, bearing_thermal_expansion_per_K,\n"
      "  friction_coefficient, hertz_stiffness_N_per_m15 (inf: rigid), axis (r, 3), program,\n"
      "  temperature_fraction\n\n"
      "Returns states and cycle_ends (dicts of arrays, first axis the state; axial force positive\n"
      "in compression), events, complete, solves, factorizations, unknowns, largest residuals.\n"
      "progress(share) may return False to end the path early: complete is then False. Raises "
      "ValueError for items out of range, RuntimeError that names joint or nodes "
      "and\n"
      "temperature for mechanisms, unloaded joints and failed equilibrium.");
}

}  // namespace statejump::bindings
