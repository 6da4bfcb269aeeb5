// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/linkage/model.hpp"

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "../bindings.hpp"
#include "statejump/joint_loop/elastic_loop.hpp"
#include "statejump/joint_loop/rigid_loop.hpp"
#include "statejump/linkage/run.hpp"

namespace py = pybind11;

namespace statejump::bindings {

using Eigen::Vector2d;

namespace {

using Row = std::vector<std::pair<const char*, double>>;

/// Converts rows into arrays, one for each column name.
/// @param row_of returns row i as (name, value) pairs; all rows have the same names
template <class RowOf>
py::dict columns(std::size_t rows, RowOf&& row_of) {
  std::vector<std::pair<const char*, py::array_t<double>>> arrays;
  for (std::size_t i = 0; i < rows; ++i) {
    const Row row = row_of(i);
    for (std::size_t j = 0; j < row.size(); ++j) {
      if (i == 0) arrays.emplace_back(row[j].first, static_cast<py::ssize_t>(rows));
      arrays[j].second.mutable_data()[i] = row[j].second;
    }
  }
  py::dict result;
  for (const auto& [name, values] : arrays) result[name] = values;
  return result;
}

/// A run with the model and program that its columns need.
struct BoundRun {
  linkage::Linkage model;
  thermal::Program program;
  linkage::Run run;

  py::dict columns() const {
    return bindings::columns(run.samples.size(), [this](std::size_t i) -> Row {
      const linkage::Sample& s = run.samples[i];
      const linkage::Coordinates q = coordinates(model, s.state);
      const linkage::Energy e = energy(model, s.state, s.temperature_change);
      const linkage::Joint j = linkage::joint_state(model, s.state, s.temperature_change,
                                                    program.temperature_rate(s.time));
      return {
          {"time_s", s.time},
          {"temperature_change_K", s.temperature_change},
          {"theta2_rad", q.theta2},
          {"theta4_rad", q.theta4},
          {"length_ab_m", q.length_ab},
          {"length_bc_m", q.length_bc},
          {"centroid_ab_x_m", q.centroid_ab.x()},
          {"centroid_ab_y_m", q.centroid_ab.y()},
          {"centroid_bc_x_m", q.centroid_bc.x()},
          {"centroid_bc_y_m", q.centroid_bc.y()},
          {"bearing_x_m", s.state.bearing_centre.x()},
          {"bearing_y_m", s.state.bearing_centre.y()},
          {"journal_x_m", s.state.journal_centre.x()},
          {"journal_y_m", s.state.journal_centre.y()},
          {"eccentricity_x_m", q.eccentricity.x()},
          {"eccentricity_y_m", q.eccentricity.y()},
          {"penetration_depth_m", j.penetration_depth},
          {"normal_force_N", j.normal_force},
          {"tangential_force_N", j.tangential_force},
          {"slipping", j.slipping ? 1.0 : 0.0},
          {"kinetic_energy_J", e.kinetic},
          {"axial_energy_J", e.axial},
          {"contact_energy_J", e.contact + e.tangential},
          {"torsion_energy_J", e.torsion},
          {"axial_dissipation_J", s.account.axial_dissipation},
          {"pin_dissipation_J", s.account.pin_dissipation},
          {"friction_dissipation_J", s.account.friction_dissipation},
          {"impact_dissipation_J", s.account.impact_dissipation},
          {"thermal_work_J", s.account.thermal_work},
      };
    });
  }
};

linkage::Linkage make_linkage(double frame_length, const linkage::ThermalLink& link_ab,
                              const linkage::ThermalLink& link_bc, double journal_radius,
                              double bearing_radius, double journal_expansion,
                              double bearing_expansion, const std::string& normal_law,
                              const std::string& dissipation_law, const std::string& friction_law,
                              const std::string& tangential_velocity, double friction_coefficient,
                              double v0, double v1, double restitution,
                              double smallest_impact_speed, double contact_length,
                              double axial_damping_ratio, double pin_damping,
                              double torsion_stiffness, double torsion_free_angle) {
  linkage::Linkage model;
  model.frame_length = frame_length;
  model.link_ab = link_ab;
  model.link_bc = link_bc;
  model.journal_radius = journal_radius;
  model.bearing_radius = bearing_radius;
  model.journal_thermal_expansion = journal_expansion;
  model.bearing_thermal_expansion = bearing_expansion;
  model.law =
      kernel::laws::joint_law({normal_law, dissipation_law, friction_law, tangential_velocity});
  model.law.friction_parameters = {friction_coefficient, v0, v1};
  model.law.restitution = restitution;
  model.law.smallest_impact_speed = smallest_impact_speed;
  model.law.contact_length = contact_length;
  model.axial_damping_ratio = axial_damping_ratio;
  model.pin_damping = pin_damping;
  model.torsion_stiffness = torsion_stiffness;
  model.torsion_free_angle = torsion_free_angle;
  model.validate();
  return model;
}

linkage::Start start_mode(const std::string& mode) {
  if (mode == "rest") return linkage::Start::rest;
  if (mode == "matched") return linkage::Start::matched;
  throw kernel::OutOfRange("mode", mode, "one of rest, matched");
}

/// One point of a quasi-static path, rigid or elastic.
template <class Point>
Row point_row(const Point& p) {
  const Vector2d d = p.journal_centre - p.bearing_centre;
  Row row = {
      {"temperature_change_K", p.temperature_change},
      {"contact_angle_rad", p.contact_angle},
      {"theta2_rad", p.theta2},
      {"theta4_rad", p.theta4},
      {"eccentricity_x_m", d.x()},
      {"eccentricity_y_m", d.y()},
      {"bearing_x_m", p.bearing_centre.x()},
      {"bearing_y_m", p.bearing_centre.y()},
      {"journal_x_m", p.journal_centre.x()},
      {"journal_y_m", p.journal_centre.y()},
      {"spring_moment_N_m", p.spring_moment},
  };
  if constexpr (std::is_same_v<Point, joint_loop::ElasticJointPoint>) {
    row.emplace_back("penetration_depth_m", p.depth);
    row.emplace_back("normal_force_N", p.normal_force);
    row.emplace_back("tangential_force_N", p.tangential_force);
    row.emplace_back("slipping", p.slipping() ? 1.0 : 0.0);
  }
  return row;
}

template <class Point>
py::dict point_dict(const Point& point) {
  py::dict result;
  result["motion"] = to_string(point.motion);
  for (const auto& [name, value] : point_row(point)) result[name] = value;
  return result;
}

/// Common members of a rigid and an elastic loop.
template <class Loop>
py::class_<Loop> bind_path(py::module_& module, const char* name, const char* doc) {
  return py::class_<Loop>(module, name, doc)
      .def(
          "columns",
          [](const Loop& self) {
            return columns(self.points.size(),
                           [&self](std::size_t i) { return point_row(self.points[i]); });
          },
          "Points of the path as arrays by column name.")
      .def_property_readonly(
          "events",
          [](const Loop& self) {
            py::list result;
            for (const auto& point : self.events) result.append(point_dict(point));
            return result;
          },
          "First, last, changes of motion and corners of the program, as dicts.")
      .def_readonly("separated", &Loop::separated,
                    "The contact force vanished: the path ends there.")
      .def_property_readonly("theta2_jump_rad", &Loop::theta2_jump)
      .def_property_readonly("theta4_jump_rad", &Loop::theta4_jump)
      .def_property_readonly("bearing_jump_m",
                             [](const Loop& self) { return Vector2d(self.bearing_jump()); })
      .def_property_readonly("journal_jump_m",
                             [](const Loop& self) { return Vector2d(self.journal_jump()); });
}

joint_loop::TangentialCompliance tangential_compliance(const std::string& name) {
  if (name == "rigid") return joint_loop::TangentialCompliance::rigid;
  if (name == "mindlin") return joint_loop::TangentialCompliance::mindlin;
  throw kernel::OutOfRange("tangential_compliance", name, "one of rigid, mindlin");
}

void bind_models(py::module_& module) {
  const linkage::Linkage standard;
  py::class_<linkage::ThermalLink>(
      module, "ThermalLink", "A uniform link pinned to the frame; a third of its mass at its tip.")
      .def(py::init([](double length, double mass, double young_modulus, double area,
                       double expansion, double poisson_ratio) {
             return linkage::ThermalLink{length, mass,      young_modulus,
                                         area,   expansion, poisson_ratio};
           }),
           py::kw_only(), py::arg("stress_free_length_m"), py::arg("mass_kg"),
           py::arg("young_modulus_Pa"), py::arg("cross_section_area_m2"),
           py::arg("thermal_expansion_per_K"), py::arg("poisson_ratio") = 0.3);

  py::class_<linkage::Linkage>(
      module, "Linkage",
      "One deployed rib of the umbrella antenna: links AB and BC on pins of the "
      "frame, a clearance\njoint between them at B, a torsion spring on the flare "
      "angle theta4 - theta2. Immutable.\nRaises ValueError for a value out of "
      "range.")
      .def(py::init(&make_linkage), py::kw_only(), py::arg("frame_length_m"), py::arg("link_ab"),
           py::arg("link_bc"), py::arg("journal_radius_m"), py::arg("bearing_radius_m"),
           py::arg("journal_thermal_expansion_per_K") = 0.0,
           py::arg("bearing_thermal_expansion_per_K") = 0.0,
           py::arg("normal_law") = law_info(standard.law.normal).name,
           py::arg("dissipation_law") = law_info(standard.law.dissipation).name,
           py::arg("friction_law") = law_info(standard.law.friction).name,
           py::arg("tangential_velocity") = law_info(standard.law.tangential_velocity).name,
           py::arg("friction_coefficient") = 0.0,
           py::arg("friction_v0_m_per_s") = standard.law.friction_parameters.v0,
           py::arg("friction_v1_m_per_s") = standard.law.friction_parameters.v1,
           py::arg("restitution") = standard.law.restitution,
           py::arg("smallest_impact_speed_m_per_s") = standard.law.smallest_impact_speed,
           py::arg("contact_length_m") = standard.law.contact_length,
           py::arg("axial_damping_ratio") = 0.0, py::arg("pin_damping_N_m_s_per_rad") = 0.0,
           py::arg("torsion_stiffness_N_m_per_rad") = 0.0,
           py::arg("torsion_free_angle_rad") = standard.torsion_free_angle)
      .def_property_readonly("radial_clearance_m", &linkage::Linkage::radial_clearance)
      .def_property_readonly("friction_coefficient", &linkage::Linkage::friction_coefficient,
                             "mu [-]; 0 without a friction law.")
      .def_property_readonly("torsion_free_angle_rad", &linkage::Linkage::free_angle)
      .def("first_contact_temperature_change", &linkage::first_contact_temperature,
           "Closed form of first contact on heating [K]; inf if there is none.");

  py::class_<linkage::State>(module, "LinkageState", "Positions and velocities of the two tips.")
      .def_property_readonly("bearing_centre_m",
                             [](const linkage::State& s) { return Vector2d(s.bearing_centre); })
      .def_property_readonly("journal_centre_m",
                             [](const linkage::State& s) { return Vector2d(s.journal_centre); })
      .def_property_readonly("bearing_velocity_m_per_s",
                             [](const linkage::State& s) { return Vector2d(s.bearing_velocity); })
      .def_property_readonly("journal_velocity_m_per_s",
                             [](const linkage::State& s) { return Vector2d(s.journal_velocity); })
      .def_property_readonly(
          "tangential_force_N",
          [](const linkage::State& s) { return s.contact.tangential_force.x(); },
          "Remembered friction on the journal along (-n_y, n_x) [N].")
      .def_property_readonly("tangential_stiffness_N_per_m", [](const linkage::State& s) {
        return s.contact.tangential_stiffness;
      });
}

void bind_runs(py::module_& module) {
  py::class_<BoundRun>(module, "LinkageRun", "Result of simulate().")
      .def("columns", &BoundRun::columns,
           "Samples as arrays by column name; forces on the journal, energies since the start.")
      .def_property_readonly("first_contact_time_s",
                             [](const BoundRun& self) -> py::object {
                               if (!self.run.first_contact) return py::none();
                               return py::float_(self.run.first_contact->time);
                             })
      .def_property_readonly(
          "first_contact_temperature_change_K",
          [](const BoundRun& self) -> py::object {
            if (!self.run.first_contact) return py::none();
            return py::float_(self.run.first_contact->temperature_change);
          },
          "None if journal and bearing never touch.")
      .def_property_readonly("contacts", [](const BoundRun& self) { return self.run.contacts; })
      .def_property_readonly("steps", [](const BoundRun& self) { return self.run.steps; })
      .def_property_readonly("energy_residue_J",
                             [](const BoundRun& self) { return self.run.energy_residue; });

  module.def(
      "initial_state",
      [](const linkage::Linkage& model, const std::string& mode, double rate,
         const Vector2d& eccentricity) {
        return initial_state(model, start_mode(mode), rate, eccentricity);
      },
      py::arg("model"), py::arg("mode"), py::arg("temperature_rate_K_per_s") = 0.0,
      py::arg("eccentricity_m") = Vector2d(0.0, 0.0),
      "Unstrained links with the journal at the given place in the play; mode 'rest' or "
      "'matched'.");
  module.def(
      "simulate",
      [](const linkage::Linkage& model, const thermal::Program& program,
         const linkage::State& start, int steps, int sample_every) {
        const py::gil_scoped_release free;
        return BoundRun{model, program, simulate(model, program, start, {steps, sample_every})};
      },
      py::arg("model"), py::arg("program"), py::arg("start"), py::arg("steps") = 100000,
      py::arg("sample_every") = 0,
      "Classical Runge-Kutta with fixed steps over the whole program. Raises ValueError with time, "
      "temperature\nand value when a law leaves its range or the state ceases to be finite.");
  module.def(
      "simulate_adaptive",
      [](const linkage::Linkage& model, const thermal::Program& program,
         const linkage::State& start, double tolerance, int samples) {
        const py::gil_scoped_release free;
        return BoundRun{model, program,
                        simulate_adaptive(model, program, start, {tolerance, samples})};
      },
      py::arg("model"), py::arg("program"), py::arg("start"),
      py::arg("relative_tolerance") = linkage::AdaptiveRunOptions{}.relative_tolerance,
      py::arg("samples") = 0, "Dormand-Prince with error control, for laws without memory.");
}

void bind_loops(py::module_& module) {
  bind_path<joint_loop::RigidLoop>(
      module, "JointLoop", "Quasi-static path of the loaded joint, rigid links, exact Coulomb.");
  bind_path<joint_loop::ElasticLoop>(
      module, "ElasticLoop",
      "Quasi-static path of the loaded joint, elastic links and Hertz contact.")
      .def_readonly("largest_force_residual", &joint_loop::ElasticLoop::largest_force_residual);
  module.def(
      "joint_point",
      [](const linkage::Linkage& model, double change, int side, double contact_angle) {
        return point_dict(joint_loop::joint_point(model, change, side, contact_angle));
      },
      py::arg("model"), py::arg("temperature_change_K"), py::arg("side"),
      py::arg("contact_angle_rad"),
      "Equilibrium of rigid links in contact; side -1 when the spring closes the flare angle.");
  module.def(
      "joint_loop", &joint_loop::rigid_loop, py::arg("model"), py::arg("program"),
      py::arg("contact_angle_rad") = 0.0, py::arg("samples") = 200,
      "Quasi-static path from equilibrium at the given contact angle. Needs a torsion spring "
      "that loads the\njoint; raises ValueError otherwise.");
  module.def(
      "elastic_loop",
      [](const linkage::Linkage& model, const thermal::Program& program, double contact_angle,
         int samples, const std::string& compliance) {
        const joint_loop::ElasticLoopOptions options{samples, tangential_compliance(compliance)};
        const py::gil_scoped_release free;
        return elastic_loop(model, program, options, contact_angle);
      },
      py::arg("model"), py::arg("program"), py::arg("contact_angle_rad") = 0.0,
      py::arg("samples") = joint_loop::ElasticLoopOptions{}.samples,
      py::arg("tangential_compliance") = "rigid",
      "As joint_loop() with elastic links and Hertz contact; 'mindlin' is what slow dynamics and "
      "the DEM tend to.\nRaises ValueError as joint_loop(), RuntimeError if equilibrium is not "
      "found.");
  module.def("loaded_state", &joint_loop::loaded_state, py::arg("model"),
             py::arg("contact_angle_rad") = 0.0,
             "Equilibrium at dT = 0 in contact, at rest; a start for simulate().");
}

}  // namespace

void bind_linkage(py::module_& module) {
  bind_models(module);
  bind_runs(module);
  bind_loops(module);
}

}  // namespace statejump::bindings
