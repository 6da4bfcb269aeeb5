// SPDX-License-Identifier: GPL-3.0-or-later
// Tests every rejection with its message, and the reading of files.
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <stdexcept>

#include "statejump/geometry/mesh_failure.hpp"
#include "support.hpp"

namespace statejump::geometry {
namespace {

using testing::round_bore;

std::string refusal(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "nothing was refused";
}

std::string refusal(const Triangles& mesh, const BoreOptions& options = {}) {
  return refusal([&] { BoreMesh(mesh, options); });
}

Triangles tube() {
  return bore_triangles(round_bore(), 12, 2);
}

Triangles ring() {
  BoreShape shape = round_bore();
  shape.wall_thickness = 2e-3;
  return bore_triangles(shape, 24, 2);
}

TEST(BoreChecks, TubeAndRingAreAccepted) {
  const BoreMesh open(tube());
  EXPECT_FALSE(open.closed());
  EXPECT_EQ(open.wall().size(), 48u);
  const BoreMesh closed(ring());
  EXPECT_TRUE(closed.closed());
  EXPECT_EQ(closed.wall().size(), 96u);  // neither end faces nor outer faces
  for (const BoreMesh& mesh : {open, closed}) {
    EXPECT_NEAR(mesh.mean_radius(), 5.1e-3, 1e-17);
    EXPECT_NEAR(mesh.length(), 10e-3, 1e-17);
    EXPECT_NEAR((mesh.axis() - Eigen::Vector3d::UnitZ()).norm(), 0, 1e-14);
    EXPECT_NEAR(mesh.centre().norm(), 0, 1e-17);
  }
}

TEST(BoreChecks, ShapesOutsideTheirRangeAreRefused) {
  const auto refused = [](auto set) {
    BoreShape shape = round_bore();
    set(shape);
    return refusal([&] { bore_triangles(shape, 12, 2); });
  };
  EXPECT_EQ(refused([](BoreShape& s) { s.radius = 0.0; }), "radius = 0, allowed is (0, inf) m");
  EXPECT_EQ(refused([](BoreShape& s) { s.length = 0.0; }), "length = 0, allowed is (0, inf) m");
  EXPECT_EQ(refused([](BoreShape& s) { s.wear_width = 0.0; }),
            "wear_width = 0, allowed is (0, inf) rad");
  EXPECT_EQ(refused([](BoreShape& s) {
              s.lobes = {{0, 1e-6, 0.0}};
            }),
            "harmonic = 0, allowed is 1, 2, 3, ...");
  EXPECT_EQ(refused([](BoreShape& s) { s.lobes = {{1, 1e-6, 0.0}}; }), "nothing was refused");
  EXPECT_EQ(refused([](BoreShape& s) { s.crown = 0.5 * s.radius; }),
            "crown = 0.00255, allowed is (-radius/2, radius/2) m");
  EXPECT_EQ(refused([](BoreShape& s) {
              s.lobes = {{2, 0.5 * s.radius, 0.0}};
            }),
            "sum of the lobes' amplitudes = 0.00255, allowed is [0, radius/2) m");
  EXPECT_EQ(refused([](BoreShape& s) { s.wear_depth = s.wall_thickness = 0.0; }),
            "nothing was refused");
}

TEST(BoreChecks, BadArrays) {
  EXPECT_EQ(refusal(Triangles{}), "mesh: the mesh has no faces");
  Triangles mesh = tube();
  mesh.faces[7][1] = 99;
  EXPECT_EQ(refusal(mesh), "mesh: face 7 has corner 99, but there are only 36 vertices");
  mesh = tube();
  mesh.faces[7][1] = -1;
  EXPECT_EQ(refusal(mesh), "mesh: face 7 has corner -1, but there are only 36 vertices");
  mesh = tube();
  mesh.vertices[5].y() = std::nan("");
  EXPECT_EQ(refusal(mesh), "mesh: vertex 5 is not finite");
}

TEST(BoreChecks, FaceWithoutArea) {
  Triangles mesh = tube();
  mesh.vertices[12] = mesh.vertices[0];
  EXPECT_EQ(refusal(mesh),
            "mesh: face 1 (vertices 0, 13, 12) at (0.00487224, 0.00085, 0.00333333) m has no area");
}

/// Splits the axial edge of a face, on this face's side only, and its first half once more if
/// `twice`. Facets without area fill the gaps.
void divide_on_one_side(Triangles& mesh, std::size_t face, bool twice) {
  auto corners = mesh.faces[face];
  const auto vertex = [&](int k) { return mesh.vertices[static_cast<std::size_t>(k)]; };
  while ((vertex(corners[0]) - vertex(corners[1])).head<2>().norm() > 1e-9)
    std::rotate(corners.begin(), corners.begin() + 1, corners.end());
  const auto [a, b, c] = corners;
  const int half = static_cast<int>(mesh.vertices.size());
  mesh.vertices.emplace_back(0.5 * (vertex(a) + vertex(b)));
  mesh.faces[face] = {half, b, c};
  mesh.faces.push_back({a, b, half});
  if (!twice) {
    mesh.faces.push_back({a, half, c});
    return;
  }
  mesh.vertices.emplace_back(0.5 * (vertex(a) + vertex(half)));
  mesh.faces.push_back({a, half, half + 1});
  mesh.faces.push_back({half + 1, half, c});
  mesh.faces.push_back({a, half + 1, c});
}

TEST(BoreChecks, FlatFacesAreTakenOut) {
  const Triangles whole = bore_triangles(round_bore(), 48, 3);
  for (const bool twice : {false, true}) {
    Triangles mesh = whole;
    for (std::size_t f = 10; f < 100; f += 9) divide_on_one_side(mesh, f, twice);
    const BoreMesh bore(mesh);
    const std::size_t vertices = twice ? 20 : 10;
    EXPECT_EQ(bore.triangles().removed, static_cast<int>(vertices));
    // Each vertex on an edge adds two faces.
    EXPECT_EQ(bore.triangles().faces.size(), whole.faces.size() + 2 * vertices);
    EXPECT_NEAR(bore.mean_radius(), BoreMesh(whole).mean_radius(), 1e-15);  // rounding of 5 mm
  }
}

TEST(BoreChecks, FlatFacesAtTheRimAreTakenOut) {
  Triangles mesh = bore_triangles(round_bore(), 48, 2);
  const int middle = static_cast<int>(mesh.vertices.size());
  mesh.vertices.emplace_back(0.5 * (mesh.vertices[0] + mesh.vertices[1]));
  const std::size_t faces = mesh.faces.size();
  for (std::size_t f = 0; f < faces; ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b, c] = std::array<int, 3>{mesh.faces[f][k], mesh.faces[f][(k + 1) % 3],
                                                mesh.faces[f][(k + 2) % 3]};
      if (a + b != 1) continue;
      mesh.faces[f] = {a, middle, c};
      mesh.faces.push_back({middle, b, c});
      mesh.faces.push_back({a, b, middle});
    }
  const BoreMesh bore(mesh);
  EXPECT_EQ(bore.triangles().removed, 1);
  EXPECT_EQ(bore.triangles().faces.size(), faces + 1);
}

TEST(BoreChecks, EdgeOfThreeFaces) {
  Triangles mesh = tube();
  mesh.vertices.emplace_back(0, 0, 0);
  mesh.faces.push_back({12, 13, 36});
  EXPECT_EQ(refusal(mesh),
            "mesh: the edge between vertices 12 and 13 at (0.00475836, 0.001275, 0) m belongs to "
            "more than two faces (1, 24, 48)");
}

TEST(BoreChecks, SheetsThatMeetInAVertex) {
  Triangles mesh = tube();
  mesh.vertices.emplace_back(6e-3, 0, 0.008);
  mesh.vertices.emplace_back(6e-3, 1e-3, 0.008);
  mesh.faces.push_back({0, 36, 37});
  EXPECT_EQ(refusal(mesh),
            "mesh: at vertex 0 at (0.0051, 0, 0.005) m two sheets meet that share no edge");
}

TEST(BoreChecks, SeveralParts) {
  Triangles mesh = tube();
  const Triangles other = tube();
  for (auto v : other.vertices) mesh.vertices.push_back(v + Eigen::Vector3d(0, 0, 0.02));
  for (auto f : other.faces) mesh.faces.push_back({f[0] + 36, f[1] + 36, f[2] + 36});
  EXPECT_EQ(refusal(mesh),
            "mesh: the mesh has several parts: face 48 (vertices 36, 37, 49) at (0.00464449, "
            "0.0017, 0.0233333) m is not connected to face 0");
}

TEST(BoreChecks, Hole) {
  Triangles mesh = bore_triangles(round_bore(), 12, 4);
  mesh.faces.erase(mesh.faces.begin() + 24);
  EXPECT_EQ(refusal(mesh),
            "mesh: the mesh has 1 hole(s) beside the open end(s), the largest of 3 edges around "
            "(0.00464449, 0.0017, 0.00166667) m");
  mesh = ring();
  mesh.faces.erase(mesh.faces.begin() + 24);
  EXPECT_EQ(refusal(mesh).substr(0, 51), "mesh: the mesh has one open end, of 3 edges around ");
}

TEST(BoreChecks, FacesThatIntersect) {
  Triangles mesh = bore_triangles(round_bore(), 12, 4);
  mesh.vertices[24] = Eigen::Vector3d(-6e-3, 0, 1e-4);  // moved through the opposite wall
  const std::string sentence = refusal(mesh);
  EXPECT_NE(sentence.find(" intersect"), std::string::npos) << sentence;
  EXPECT_EQ(sentence.substr(0, 12), "mesh: faces ");
}

TEST(BoreChecks, InsideOut) {
  Triangles mesh = tube();
  for (auto& face : mesh.faces) std::swap(face[1], face[2]);
  EXPECT_EQ(refusal(mesh),
            "mesh: the mesh is inside out: its normals point away from the axis, as that of face 0 "
            "at (0.00464449, 0.0017, 0.00333333) m; flip turns it");
  BoreOptions options;
  options.flip = true;
  EXPECT_EQ(BoreMesh(mesh, options).wall().size(), 48u);
  mesh = ring();
  for (auto& face : mesh.faces) std::swap(face[1], face[2]);
  EXPECT_EQ(refusal(mesh),
            "mesh: the closed mesh is inside out: its normals point into the body; flip turns it");
}

TEST(BoreChecks, FacesThatDisagreeAreTurnedLikeTheFirst) {
  Triangles mesh = tube();
  for (const int f : {3, 8, 21, 22, 40}) std::swap(mesh.faces[f][1], mesh.faces[f][2]);
  const BoreMesh mended(mesh);
  EXPECT_EQ(mended.triangles().faces, tube().faces);
}

TEST(BoreChecks, NoBore) {
  Triangles cube;
  for (int i = 0; i < 8; ++i) cube.vertices.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
  cube.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  EXPECT_EQ(refusal(cube), "mesh: the closed mesh has no bore: no smooth wall surrounds an axis");
}

TEST(BoreChecks, Units) {
  BoreOptions options;
  options.scale = 1e3;
  EXPECT_EQ(refusal(tube(), options),
            "mesh: the mean radius is 5.1 m, allowed is 1e-05 to 0.5 m: are the coordinates in "
            "millimetres? Then scale by 0.001");
  options.largest_radius = 10;
  EXPECT_NEAR(BoreMesh(tube(), options).mean_radius(), 5.1, 1e-14);
  options = {};
  options.scale = 1e-3;
  EXPECT_EQ(refusal(tube(), options),
            "mesh: the mean radius is 5.1e-06 m, allowed is 1e-05 to 0.5 m: is the scale right?");
  options.scale = 0;
  EXPECT_EQ(refusal(tube(), options), "scale = 0, allowed is (0, inf) m");
  options = {};
  options.fit_degree = 5;
  EXPECT_EQ(refusal(tube(), options), "fit_degree = 5, allowed is 2, 3 or 4");
}

TEST(BoreChecks, Arguments) {
  const BoreMesh mesh(tube());
  const Eigen::Vector3d z(0, 0, 1), origin(0, 0, 0);
  EXPECT_EQ(refusal([&] { mesh.contacts(origin, z, 0, 0); }),
            "journal_radius = 0, allowed is (0, inf) m");
  EXPECT_EQ(refusal([&] { mesh.contacts(origin, z, 5e-3, -1); }),
            "maximum_gap = -1, allowed is [0, inf) m");
  EXPECT_EQ(refusal([&] { mesh.contacts(origin, origin, 5e-3, 0); }),
            "journal_axis has no direction");
  EXPECT_EQ(refusal([&] {
              mesh.contacts(origin, {1, 0, 0}, 5e-3, 0);
            }).substr(0, 31),
            "cosine of the journal's tilt = ");
  EXPECT_EQ(refusal([&] { mesh.closest_point({0, 0, std::nan("")}); }), "query is not finite");
  BoreOptions socket;
  socket.kind = SurfaceKind::socket;
  const BoreMesh cup(socket_triangles(8e-3, 1.5, 24, 10), socket);
  EXPECT_EQ(refusal([&] { cup.contacts(origin, z, 5e-3, 0); }),
            "a journal needs a bore, but the mesh is a socket");
  EXPECT_EQ(refusal([] {
              bore_triangles({5e-3, 1e-2}, 2, 1);
            }),
            "around = 2, allowed is 3, 4, 5, ...");
  EXPECT_EQ(refusal([] {
              bore_triangles({-5e-3, 1e-2}, 9, 1);
            }),
            "radius = -0.005, allowed is (0, inf) m");
}

class BoreFiles : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const {
    return ::testing::TempDir() + "statejump_" + std::to_string(::getpid()) + "_" + name;
  }
  std::string write(const std::string& name, const std::string& content) {
    files_.push_back(path(name));
    std::ofstream(files_.back(), std::ios::binary) << content;
    return files_.back();
  }
  void TearDown() override {
    for (const auto& file : files_) std::remove(file.c_str());
  }

 private:
  std::vector<std::string> files_;
};

std::string digits(const Eigen::Vector3d& v) {
  char text[128];
  std::snprintf(text, sizeof text, "%.17g %.17g %.17g", v.x(), v.y(), v.z());
  return text;
}

TEST_F(BoreFiles, EveryFormatHoldsTheSameMesh) {
  const Triangles mesh = tube();
  std::string off = "OFF\n36 48 0\n",
              ply =
                  "ply\nformat ascii 1.0\nelement vertex 36\nproperty double x\nproperty double "
                  "y\nproperty "
                  "double z\nelement face 48\nproperty list uchar int vertex_indices\nend_header\n";
  std::string text = "solid tube\n";
  std::string binary(80, ' ');
  const auto append = [&binary](const auto value) {
    binary.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(std::uint32_t{48});
  for (const auto& v : mesh.vertices) {
    off += digits(v) + "\n";
    ply += digits(v) + "\n";
  }
  for (const auto& f : mesh.faces) {
    const std::string line = "3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " +
                             std::to_string(f[2]) + "\n";
    off += line;
    ply += line;
    text += "facet normal 0 0 0\nouter loop\n";
    for (int i = 0; i < 3; ++i) append(0.0f);
    for (const int corner : f) {
      text += "vertex " + digits(mesh.vertices[corner]) + "\n";
      for (int i = 0; i < 3; ++i) append(static_cast<float>(mesh.vertices[corner][i]));
    }
    text += "endloop\nendfacet\n";
    append(std::uint16_t{0});
  }
  text += "endsolid tube\n";
  for (const std::string& file :
       {write("a.off", off), write("a.PLY", ply), write("t.stl", text), write("b.stl", binary)}) {
    const Triangles read = read_triangles(file);
    ASSERT_EQ(read.faces.size(), 48u) << file;
    ASSERT_EQ(read.vertices.size(), 36u) << file;
    const BoreMesh bore = BoreMesh::read(file);
    // Binary STL stores floats: relative error 6e-8 of 5 mm.
    EXPECT_NEAR(bore.mean_radius(), 5.1e-3, 4e-10) << file;
    for (std::size_t f = 0; f < 48; ++f)
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR((read.vertices[read.faces[f][k]] - mesh.vertices[mesh.faces[f][k]]).norm(), 0,
                    1e-9);
  }
}

TEST_F(BoreFiles, Refusals) {
  const auto sentence = [](const std::string& file) {
    return refusal([&] { BoreMesh::read(file); });
  };
  EXPECT_EQ(sentence("/nowhere/bore.stl"), "/nowhere/bore.stl: cannot be opened");
  EXPECT_EQ(sentence("/nowhere/bore.step"),
            "/nowhere/bore.step: a mesh file ends with .off, .stl, .ply or .obj");
  EXPECT_EQ(sentence("/nowhere/bore"),
            "/nowhere/bore: a mesh file ends with .off, .stl, .ply or .obj");
  std::string file = write("empty.off", "");
  EXPECT_EQ(sentence(file), file + ": the file is empty");
  file = write("rubbish.off", "this is no mesh\n");
  EXPECT_EQ(sentence(file), file + ": not readable as OFF: line 1 does not begin with OFF");
  file = write("none.off", "OFF\n0 0 0\n");
  EXPECT_EQ(sentence(file), file + ": the mesh has no faces");
}

TEST_F(BoreFiles, WhatIsNoFileIsNotOpened) {
  const std::string pipe = path("pipe.off");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(refusal([&] { read_triangles(pipe); }), pipe + ": is no regular file");
  std::remove(pipe.c_str());
  const std::string zeros = path("zeros.stl");
  ASSERT_EQ(::symlink("/dev/zero", zeros.c_str()), 0);
  EXPECT_EQ(refusal([&] { read_triangles(zeros); }), zeros + ": is no regular file");
  std::remove(zeros.c_str());
  const std::string folder = path("folder.ply");
  ASSERT_EQ(::mkdir(folder.c_str(), 0700), 0);
  EXPECT_EQ(refusal([&] { read_triangles(folder); }), folder + ": is no regular file");
  ::rmdir(folder.c_str());
}

TEST(BoreChecks, RefusalsAreTyped) {
  Triangles mesh = tube();
  for (auto& face : mesh.faces) std::swap(face[1], face[2]);
  try {
    BoreMesh{mesh};
    FAIL() << "accepted";
  } catch (const MeshFailure& failure) {
    EXPECT_EQ(failure.fault(), MeshFault::inside_out);
    EXPECT_EQ(failure.file(), "mesh");
    EXPECT_EQ(failure.remedy(), "flip turns it");
    EXPECT_EQ(failure.cause().find("the mesh is inside out"), 0u);
  }
}

TEST(BoreChecks, VertexWithManyNeighboursIsFittedToAllOfThem) {
  // At the bottom of a cup, 150 faces meet in one vertex. The curvature there must be the cup's in
  // all directions; a fit to only 60 of the neighbours would see one arc of them.
  BoreOptions socket;
  socket.kind = SurfaceKind::socket;
  constexpr double radius = 8e-3;
  const BoreMesh cup(socket_triangles(radius, 1.4, 150, 12), socket);
  const WallPoint bottom = cup.closest_point({0, 0, -0.99 * radius});
  // Rings at 0.145 rad. The error of a fit of fourth order is the fourth power of the radius of two
  // rings, 7e-3, times the ratio 1/8 of the sphere's coefficients of sixth and second order.
  EXPECT_NEAR(std::abs(bottom.curvature_1) * radius, 1.0, 1e-3);
  EXPECT_NEAR(std::abs(bottom.curvature_2) * radius, 1.0, 1e-3);
  EXPECT_NEAR(bottom.curvature_1, bottom.curvature_2, 1e-6 / radius);
}

TEST(BoreChecks, TooCoarse) {
  // Three to six facets around do not determine the polynomials: depths of 1e7 m once resulted.
  for (const int around : {3, 4, 5, 6})
    for (const int along : {1, 2, 4, 20}) {
      const std::string sentence = refusal(bore_triangles(round_bore(), around, along));
      EXPECT_EQ(sentence.find("mesh: the facets are too coarse: they leave the surface between"),
                0u)
          << around << ' ' << along << ": " << sentence;
    }
  EXPECT_EQ(refusal(bore_triangles(round_bore(), 3, 2)),
            "mesh: the facets are too coarse: they leave the surface between them open by 0.00765 "
            "m, allowed is 0.000102 m, a fiftieth of the mean radius; a cylinder needs 16 around");
  for (const int around : {7, 8, 9, 12, 16})
    EXPECT_NO_THROW(BoreMesh(bore_triangles(round_bore(), around, 3))) << around;
  // All neighbours of this cup's bottom lie beyond a crease and are used nevertheless, each of 150
  // from both of its faces. That is more than the 64 equations that are stored on the stack.
  BoreOptions socket;
  socket.kind = SurfaceKind::socket;
  EXPECT_NE(refusal(socket_triangles(8e-3, 0.4, 150, 2), socket).find("too coarse"),
            std::string::npos);
}

TEST(BoreChecks, HugeAndTinyCoordinates) {
  BoreOptions any;
  any.smallest_radius = 0;
  any.largest_radius = INFINITY;
  for (const double size : {1e-320, 1e-200, 1e-160, 1e63, 1e150, 1e300, 1e308}) {
    Triangles mesh = tube();
    for (auto& vertex : mesh.vertices) vertex *= size;
    const std::string sentence = refusal(mesh, any);
    EXPECT_EQ(sentence.find("mesh: "), 0u) << size << sentence;
  }
  Triangles mesh = tube();
  mesh.vertices[5] = {1e61, 0, 0};
  EXPECT_EQ(refusal(mesh), "mesh: vertex 5 at (1e+61, 0, 0) m is too far away for any joint");
}

}  // namespace
}  // namespace statejump::geometry
