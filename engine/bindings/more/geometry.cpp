// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <string>
#include <tuple>
#include <vector>

#include "../bindings.hpp"
#include "statejump/geometry/bore_mesh.hpp"
#include "statejump/geometry/mesh_failure.hpp"
#include "statejump/kernel/require.hpp"

namespace py = pybind11;

namespace statejump::bindings {

namespace {

using geometry::BoreMesh;
using geometry::Triangles;
using Vertices = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Faces = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;

Triangles from_arrays(const Vertices& vertices, const Faces& faces) {
  Triangles mesh;
  for (Eigen::Index i = 0; i < vertices.rows(); ++i)
    mesh.vertices.emplace_back(vertices.row(i).transpose());
  for (Eigen::Index i = 0; i < faces.rows(); ++i)
    mesh.faces.push_back({faces(i, 0), faces(i, 1), faces(i, 2)});
  return mesh;
}

py::tuple to_arrays(const Triangles& mesh) {
  Vertices vertices(static_cast<Eigen::Index>(mesh.vertices.size()), 3);
  Faces faces(static_cast<Eigen::Index>(mesh.faces.size()), 3);
  for (Eigen::Index i = 0; i < vertices.rows(); ++i)
    vertices.row(i) = mesh.vertices[static_cast<std::size_t>(i)].transpose();
  for (Eigen::Index i = 0; i < faces.rows(); ++i)
    for (int k = 0; k < 3; ++k) faces(i, k) = mesh.faces[static_cast<std::size_t>(i)][k];
  return py::make_tuple(vertices, faces);
}

geometry::BoreOptions options(const std::string& kind, double scale, bool flip,
                              double smallest_radius, double largest_radius, int fit_degree) {
  geometry::BoreOptions result;
  if (kind == "socket")
    result.kind = geometry::SurfaceKind::socket;
  else if (kind != "bore")
    throw kernel::OutOfRange("kind", kind, "one of bore, socket");
  result.scale = scale;
  result.flip = flip;
  result.smallest_radius = smallest_radius;
  result.largest_radius = largest_radius;
  result.fit_degree = fit_degree;
  return result;
}

py::dict to_dict(const geometry::BoreContact& contact) {
  py::dict result;
  result["point_m"] = contact.point;
  result["normal"] = contact.normal;
  result["depth_m"] = contact.depth;
  result["section_curvature_per_m"] = contact.section_curvature;
  result["axial_curvature_per_m"] = contact.axial_curvature;
  result["face"] = contact.face;
  return result;
}

py::list to_list(const std::vector<geometry::BoreContact>& contacts) {
  py::list result;
  for (const auto& contact : contacts) result.append(to_dict(contact));
  return result;
}

void bind_generators(py::module_& module) {
  module.def(
      "bore_triangles",
      [](double radius, double length, int around, int along,
         const std::vector<std::tuple<int, double, double>>& lobes, double wear_depth,
         double wear_angle, double wear_width, double crown, double wall_thickness) {
        geometry::BoreShape shape{radius, length};
        for (const auto& [harmonic, amplitude, phase] : lobes)
          shape.lobes.push_back({harmonic, amplitude, phase});
        shape.wear_depth = wear_depth;
        shape.wear_angle = wear_angle;
        shape.wear_width = wear_width;
        shape.crown = crown;
        shape.wall_thickness = wall_thickness;
        return to_arrays(geometry::bore_triangles(shape, around, along));
      },
      py::arg("radius_m"), py::arg("length_m"), py::arg("around"), py::arg("along"),
      py::arg("lobes") = std::vector<std::tuple<int, double, double>>{},
      py::arg("wear_depth_m") = 0.0, py::arg("wear_angle_rad") = 0.0,
      py::arg("wear_width_rad") = 0.5, py::arg("crown_m") = 0.0, py::arg("wall_thickness_m") = 0.0,
      "Mesh of a bore along z: (vertices [m], faces). lobes are (harmonic, amplitude [m],\n"
      "phase [rad]); harmonic 2 is an ellipse. wall_thickness_m > 0 makes a closed ring.");
  module.def(
      "socket_triangles",
      [](double radius, double opening, int around, int along) {
        return to_arrays(geometry::socket_triangles(radius, opening, around, along));
      },
      py::arg("radius_m"), py::arg("opening_rad"), py::arg("around"), py::arg("along"),
      "Mesh of the cup of a ball-and-socket joint about the origin: (vertices [m], faces).");
}

py::class_<BoreMesh> bind_mesh(py::module_& module) {
  return py::class_<BoreMesh>(
             module, "BoreMesh",
             "Inner surface of a bore or socket given by triangles, smooth between its\n"
             "vertices. Raises ValueError or RuntimeError with one sentence that says\n"
             "what is wrong with the mesh, and where.")
      .def(py::init([](const Vertices& vertices, const Faces& faces, const std::string& kind,
                       double scale, bool flip, double smallest_radius, double largest_radius,
                       int fit_degree) {
             return BoreMesh(
                 from_arrays(vertices, faces),
                 options(kind, scale, flip, smallest_radius, largest_radius, fit_degree));
           }),
           py::arg("vertices"), py::arg("faces"), py::arg("kind") = "bore", py::arg("scale") = 1.0,
           py::arg("flip") = false, py::arg("smallest_radius_m") = 1e-5,
           py::arg("largest_radius_m") = 0.5, py::arg("fit_degree") = 4)
      .def_static(
          "read",
          [](const std::string& file, const std::string& kind, double scale, bool flip,
             double smallest_radius, double largest_radius, int fit_degree) {
            const auto chosen =
                options(kind, scale, flip, smallest_radius, largest_radius, fit_degree);
            py::gil_scoped_release release;
            return BoreMesh::read(file, chosen);
          },
          py::arg("file"), py::arg("kind") = "bore", py::arg("scale") = 1.0,
          py::arg("flip") = false, py::arg("smallest_radius_m") = 1e-5,
          py::arg("largest_radius_m") = 0.5, py::arg("fit_degree") = 4,
          "Reads OFF, STL (text or binary), PLY or OBJ; scale is the file's unit [m].");
}

void bind_contacts(py::class_<BoreMesh>& mesh_class) {
  mesh_class
      .def(
          "closest_point",
          [](const BoreMesh& mesh, const Eigen::Vector3d& query) {
            const geometry::WallPoint wall = mesh.closest_point(query);
            py::dict result;
            result["point_m"] = wall.point;
            result["normal"] = wall.normal;
            result["distance_m"] = wall.distance;
            result["curvature_1_per_m"] = wall.curvature_1;
            result["curvature_2_per_m"] = wall.curvature_2;
            result["face"] = wall.face;
            result["on_rim"] = wall.on_rim;
            return result;
          },
          py::arg("point_m"), "Nearest point of the smooth wall, as a dict.")
      .def(
          "contacts",
          [](const BoreMesh& mesh, const Eigen::Vector3d& centre, const Eigen::Vector3d& axis,
             double radius,
             double gap) { return to_list(mesh.contacts(centre, axis, radius, gap)); },
          py::arg("journal_centre_m"), py::arg("journal_axis"), py::arg("journal_radius_m"),
          py::arg("maximum_gap_m") = 0.0,
          "All contacts of a journal with the wall, deepest first: a list of dicts.")
      .def(
          "ball_contacts",
          [](const BoreMesh& mesh, const Eigen::Vector3d& centre, double radius, double gap) {
            return to_list(mesh.ball_contacts(centre, radius, gap));
          },
          py::arg("ball_centre_m"), py::arg("ball_radius_m"), py::arg("maximum_gap_m") = 0.0,
          "All contacts of a ball with the wall, deepest first: a list of dicts.")
      .def(
          "section_radii_m",
          [](const BoreMesh& mesh, double z, int count) -> Eigen::VectorXd {
            const std::vector<double> radii = mesh.section_radii(z, count);
            return Eigen::Map<const Eigen::VectorXd>(radii.data(),
                                                     static_cast<Eigen::Index>(radii.size()));
          },
          py::arg("z_m"), py::arg("count"),
          "Radii of the smooth wall about the fitted axis at equal angles from axis_x; NaN where\n"
          "there is no wall.");
}

}  // namespace

void bind_geometry(py::module_& module) {
  bind_generators(module);
  module.def(
      "mesh_reasons",
      [] {
        py::list rows;
        for (int i = 0; i < geometry::mesh_reason_count; ++i) {
          const auto reason = static_cast<geometry::MeshReason>(i);
          const geometry::MeshReasonText& text = geometry::text_of(reason);
          rows.append(py::make_tuple(geometry::to_string(text.fault), text.name,
                                     geometry::cause_template(reason), text.remedy));
        }
        return rows;
      },
      "Why a mesh is rejected: fault, reason, template of the cause, remedy.");
  py::class_<BoreMesh> mesh_class = bind_mesh(module);
  bind_contacts(mesh_class);
  mesh_class
      .def_property_readonly("vertices_m",
                             [](const BoreMesh& m) { return to_arrays(m.triangles())[0]; })
      .def_property_readonly("faces", [](const BoreMesh& m) { return to_arrays(m.triangles())[1]; })
      .def_property_readonly("vertex_count",
                             [](const BoreMesh& m) { return m.triangles().vertices.size(); })
      .def_property_readonly("face_count",
                             [](const BoreMesh& m) { return m.triangles().faces.size(); })
      .def_property_readonly("removed_face_count",
                             [](const BoreMesh& m) { return m.triangles().removed; })
      .def_property_readonly("wall_face_count", [](const BoreMesh& m) { return m.wall().size(); })
      .def_property_readonly("closed", &BoreMesh::closed)
      .def_property_readonly("mean_radius_m", &BoreMesh::mean_radius)
      .def_property_readonly("centre_m", &BoreMesh::centre)
      .def_property_readonly("axis", &BoreMesh::axis)
      .def_property_readonly("axis_x", &BoreMesh::axis_x)
      .def_property_readonly("axis_y", &BoreMesh::axis_y)
      .def_property_readonly("length_m", &BoreMesh::length)
      .def_property_readonly("smallest_curvature_per_m", &BoreMesh::smallest_curvature)
      .def_property_readonly("largest_curvature_per_m", &BoreMesh::largest_curvature)
      .def_property_readonly("reconstruction_error_m", &BoreMesh::reconstruction_error)
      .def_property_readonly("prominence_m", &BoreMesh::prominence);
}

}  // namespace statejump::bindings
