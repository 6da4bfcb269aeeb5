// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/rest_set/rest_set.hpp"

#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <optional>
#include <vector>

#include "../bindings.hpp"
#include "statejump/rest_set/curve.hpp"
#include "statejump/rest_set/surface.hpp"

namespace py = pybind11;

namespace statejump::bindings {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

/// Vectors as the rows of an array.
template <class Vector>
py::array_t<double> rows(const std::vector<Vector>& vectors) {
  constexpr py::ssize_t width = Vector::RowsAtCompileTime;
  py::array_t<double> result({static_cast<py::ssize_t>(vectors.size()), width});
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    for (py::ssize_t j = 0; j < width; ++j) {
      *result.mutable_data(static_cast<py::ssize_t>(i), j) = vectors[i][j];
    }
  }
  return result;
}

py::dict set_dict(const rest_set::RestSet& set) {
  py::list parts;
  for (const rest_set::RestComponent& part : set.parts) {
    py::dict one;
    one["area_m2"] = part.area;
    one["length_m"] = part.length;
    one["diameter_m"] = part.diameter;
    one["angle_rad"] = std::isnan(part.angle) ? py::object(py::none()) : py::float_(part.angle);
    one["representative_m"] = part.representative;
    one["points_m"] = rows(part.points);
    py::list rims;
    for (const auto& rim : part.rims) rims.append(rows(rim));
    one["rims_m"] = rims;
    parts.append(one);
  }
  py::dict result;
  result["parts"] = parts;
  result["area_m2"] = set.area;
  result["length_m"] = set.length;
  result["diameter_m"] = set.diameter;
  result["farthest_m"] = rows(std::vector<Vector3d>(set.farthest.begin(), set.farthest.end()));
  result["diameter_error_m"] = set.diameter_error;
  return result;
}

py::dict study_dict(const rest_set::RestStudy& study) {
  py::list each;
  for (const rest_set::RestSet& set : study.each) each.append(set_dict(set));
  py::dict result;
  result["each"] = each;
  result["any"] = set_dict(study.any);
  result["all"] = set_dict(study.all);
  return result;
}

py::dict mesh_study(const rest_set::Mesh& mesh, const std::vector<Vector3d>& forces, double mu) {
  const rest_set::SurfaceStudy found = rest_on_mesh(mesh, forces, mu);
  py::dict result = study_dict(found.study);
  py::list polygons, triangles, counts;
  for (const rest_set::Piece& piece : found.pieces) {
    polygons.append(rows(piece.polygon));
    triangles.append(piece.triangle);
    counts.append(piece.forces);
  }
  result["polygons_m"] = polygons;
  result["polygon_triangles"] = triangles;
  result["polygon_forces"] = counts;
  result["cone_angles_rad"] = found.cone_angles;
  return result;
}

void bind_closed_forms(py::module_& module) {
  module.def(
      "rest_in_slot",
      [](double clearance, const std::vector<Vector3d>& forces, double mu) {
        return study_dict(rest_set::rest_in_slot(clearance, forces, mu));
      },
      py::arg("clearance_m"), py::arg("forces_N"), py::arg("friction_coefficient"),
      "Positions along x, -clearance to clearance, at which a block in a slot rests under each "
      "force, under\nany and under all of them.");
  module.def(
      "rest_in_bearing",
      [](double clearance, const std::vector<Vector2d>& forces, double mu) {
        return study_dict(rest_set::rest_in_bearing(clearance, forces, mu));
      },
      py::arg("clearance_m"), py::arg("forces_N"), py::arg("friction_coefficient"),
      "Rest positions of a journal's centre on the clearance circle; planar forces (x, y).");
  module.def(
      "rest_in_socket",
      [](double clearance, const std::vector<Vector3d>& forces, double mu) {
        return study_dict(rest_set::rest_in_socket(clearance, forces, mu));
      },
      py::arg("clearance_m"), py::arg("forces_N"), py::arg("friction_coefficient"),
      "Rest positions of a ball's centre on the clearance sphere.");
  module.def(
      "rest_in_bore",
      [](double clearance, double play, const std::vector<Vector3d>& forces, double mu) {
        return study_dict(rest_set::rest_in_bore(clearance, play, forces, mu));
      },
      py::arg("clearance_m"), py::arg("axial_play_m"), py::arg("forces_N"),
      py::arg("friction_coefficient"),
      "Rest positions of a cylinder's centre in a bore along z between shoulders at +-axial_play.");
}

void bind_curves(py::module_& module) {
  py::class_<rest_set::Curve>(module, "RestCurve", "A planar curve of the centre's positions.")
      .def_property_readonly("nodes_m",
                             [](const rest_set::Curve& self) {
                               std::vector<Vector2d> points;
                               for (const auto& node : self.nodes) points.push_back(node.position);
                               return rows(points);
                             })
      .def_property_readonly("normals",
                             [](const rest_set::Curve& self) {
                               std::vector<Vector2d> normals;
                               for (const auto& node : self.nodes) normals.push_back(node.normal);
                               return rows(normals);
                             })
      .def_readonly("closed", &rest_set::Curve::closed);
  module.def(
      "implicit_curves", &rest_set::implicit_curves, py::arg("gamma"), py::arg("gradient"),
      py::arg("low_m"), py::arg("high_m"), py::arg("cells") = 200,
      "Curves gamma(p) = 0 in a box; gamma < 0 where the centre is free. gradient(p) returns "
      "two numbers.");
  module.def("lobed_curve", &rest_set::lobed_curve, py::arg("clearance_m"), py::arg("amplitude"),
             py::arg("lobes"), py::arg("samples") = 720,
             "r(theta) = clearance (1 + amplitude cos(lobes theta)), free inside.");
  module.def("journal_in_profile", &rest_set::journal_in_profile, py::arg("rho"),
             py::arg("journal_radius_m"), py::arg("samples") = 720,
             "Curve of a journal's centre in a bore with the wall rho(theta) [m].");
  module.def(
      "rest_on_curves",
      [](const std::vector<rest_set::Curve>& curves, const std::vector<Vector2d>& forces,
         double mu) { return study_dict(rest_on_curves(curves, forces, mu)); },
      py::arg("curves"), py::arg("forces_N"), py::arg("friction_coefficient"),
      "Rest positions on planar curves.");
}

void bind_surfaces(py::module_& module) {
  py::class_<rest_set::Mesh>(module, "RestMesh",
                             "A triangulated surface of the centre's positions.")
      .def(py::init([](std::vector<Vector3d> vertices, std::vector<std::array<int, 3>> triangles,
                       std::optional<std::vector<Vector3d>> normals) {
             rest_set::Mesh mesh;
             mesh.vertices = std::move(vertices);
             mesh.triangles = std::move(triangles);
             if (normals) mesh.normals = std::move(*normals);
             return mesh;
           }),
           py::arg("vertices_m"), py::arg("triangles"), py::arg("normals") = py::none(),
           "normals point to the free side; without them the triangles' right-hand normals do.")
      .def_property_readonly("vertices_m",
                             [](const rest_set::Mesh& self) { return rows(self.vertices); })
      .def_property_readonly("normals",
                             [](const rest_set::Mesh& self) { return rows(self.normals); })
      .def_readonly("triangles", &rest_set::Mesh::triangles);
  module.def("welded", &rest_set::welded, py::arg("mesh"), py::arg("tolerance_m"),
             "The mesh with coinciding vertices made one.");
  module.def("implicit_surface", &rest_set::implicit_surface, py::arg("gamma"), py::arg("gradient"),
             py::arg("low_m"), py::arg("high_m"), py::arg("cells") = 40,
             "Surface gamma(p) = 0 in a box as a mesh; gamma < 0 where the centre is free.");
  module.def("clearance_sphere", &rest_set::clearance_sphere, py::arg("clearance_m"),
             py::arg("level"), "Mesh of a ball's positions in its socket: 20 * 4^level triangles.");
  module.def("rest_on_mesh", &mesh_study, py::arg("mesh"), py::arg("forces_N"),
             py::arg("friction_coefficient"),
             "Rest positions on a mesh; besides the sets the mesh cut into polygons, each with the "
             "number of\nforces that hold it, and the smallest angle(-F, N) at each vertex.");
}

}  // namespace

void bind_rest_set(py::module_& module) {
  bind_closed_forms(module);
  bind_curves(module);
  bind_surfaces(module);
}

}  // namespace statejump::bindings
