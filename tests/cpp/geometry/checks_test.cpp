// SPDX-License-Identifier: GPL-3.0-or-later
// Every refusal with its reason and fields, and the files that are read.
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <set>

#include "statejump/geometry/mesh_failure.hpp"
#include "support.hpp"

namespace statejump::geometry {
namespace {

using statejump::testing::Argument;
using statejump::testing::no_argument;
using statejump::testing::refused_argument;
using testing::mesh_failure;
using testing::round_bore;

std::string refusal(const Triangles& mesh, const BoreOptions& options = {}) {
  return mesh_failure([&] { BoreMesh(mesh, options); });
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
  EXPECT_EQ(closed.wall().size(), 96u);  // neither ends nor outside
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
    return refused_argument([&] { bore_triangles(shape, 12, 2); });
  };
  EXPECT_EQ(refused([](BoreShape& s) { s.radius = 0.0; }), Argument("radius", 0));
  EXPECT_EQ(refused([](BoreShape& s) { s.length = 0.0; }), Argument("length", 0));
  EXPECT_EQ(refused([](BoreShape& s) { s.wear_width = 0.0; }), Argument("wear_width", 0));
  EXPECT_EQ(refused([](BoreShape& s) { s.lobes = {{0, 1e-6, 0.0}}; }), Argument("harmonic", 0));
  EXPECT_EQ(refused([](BoreShape& s) { s.lobes = {{1, 1e-6, 0.0}}; }), no_argument);
  EXPECT_EQ(refused([](BoreShape& s) { s.crown = 0.5 * s.radius; }), Argument("crown", 0.00255));
  EXPECT_EQ(refused([](BoreShape& s) {
              s.lobes = {{2, 0.5 * s.radius, 0.0}};
            }),
            Argument("sum of the lobes' amplitudes", 0.00255));
  EXPECT_EQ(refused([](BoreShape& s) { s.wear_depth = s.wall_thickness = 0.0; }), no_argument);
}

TEST(BoreChecks, BadArrays) {
  EXPECT_EQ(refusal(Triangles{}), "no_faces");
  Triangles mesh = tube();
  mesh.faces[7][1] = 99;
  EXPECT_EQ(refusal(mesh), "no_such_corner face=7 corner=99 vertices=36");
  mesh = tube();
  mesh.faces[7][1] = -1;
  EXPECT_EQ(refusal(mesh), "no_such_corner face=7 corner=-1 vertices=36");
  mesh = tube();
  mesh.vertices[5].y() = std::nan("");
  EXPECT_EQ(refusal(mesh), "vertex_not_finite vertex=5");
}

TEST(BoreChecks, FaceWithoutArea) {
  Triangles mesh = tube();
  mesh.vertices[12] = mesh.vertices[0];
  EXPECT_EQ(refusal(mesh),
            "face_without_area face=1 corners=0, 13, 12 at_m=0.00487224,0.00085,0.00333333");
}

/// Halves one edge of a face, along the bore, in this face only. With `twice`, its first half is
/// halved again. Facets of zero area fill the gaps.
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
    // A vertex within an edge makes two faces more.
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
  EXPECT_EQ(
      refusal(mesh),
      "edge_of_three_faces vertex=12 other_vertex=13 at_m=0.00475836,0.001275,0 faces=1, 24, 48");
}

TEST(BoreChecks, SheetsThatMeetInAVertex) {
  Triangles mesh = tube();
  mesh.vertices.emplace_back(6e-3, 0, 0.008);
  mesh.vertices.emplace_back(6e-3, 1e-3, 0.008);
  mesh.faces.push_back({0, 36, 37});
  EXPECT_EQ(refusal(mesh), "sheets_at_vertex vertex=0 at_m=0.0051,0,0.005");
}

TEST(BoreChecks, SeveralParts) {
  Triangles mesh = tube();
  const Triangles other = tube();
  for (auto v : other.vertices) mesh.vertices.push_back(v + Eigen::Vector3d(0, 0, 0.02));
  for (auto f : other.faces) mesh.faces.push_back({f[0] + 36, f[1] + 36, f[2] + 36});
  EXPECT_EQ(refusal(mesh),
            "several_parts face=48 corners=36, 37, 49 at_m=0.00464449,0.0017,0.0233333");
}

TEST(BoreChecks, Hole) {
  Triangles mesh = bore_triangles(round_bore(), 12, 4);
  mesh.faces.erase(mesh.faces.begin() + 24);
  EXPECT_EQ(refusal(mesh), "holes edges=3 at_m=0.00464449,0.0017,0.00166667 holes=1");
  mesh = ring();
  mesh.faces.erase(mesh.faces.begin() + 24);
  EXPECT_EQ(refusal(mesh).substr(0, 20), "one_open_end edges=3");
}

TEST(BoreChecks, FacesThatIntersect) {
  Triangles mesh = bore_triangles(round_bore(), 12, 4);
  mesh.vertices[24] = Eigen::Vector3d(-6e-3, 0, 1e-4);  // through the wall opposite
  EXPECT_EQ(refusal(mesh).substr(0, 21), "faces_intersect face=");
}

TEST(BoreChecks, InsideOut) {
  Triangles mesh = tube();
  for (auto& face : mesh.faces) std::swap(face[1], face[2]);
  EXPECT_EQ(refusal(mesh),
            "wall_inside_out target=the axis face=0 at_m=0.00464449,0.0017,0.00333333");
  BoreOptions options;
  options.flip = true;
  EXPECT_EQ(BoreMesh(mesh, options).wall().size(), 48u);
  mesh = ring();
  for (auto& face : mesh.faces) std::swap(face[1], face[2]);
  EXPECT_EQ(refusal(mesh), "body_inside_out");
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
  EXPECT_EQ(refusal(cube), "no_smooth_wall");
}

TEST(BoreChecks, Units) {
  BoreOptions options;
  options.scale = 1e3;
  EXPECT_EQ(refusal(tube(), options),
            "radius_too_large mean_radius_m=5.1 smallest_m=1e-05 largest_m=0.5");
  options.largest_radius = 10;
  EXPECT_NEAR(BoreMesh(tube(), options).mean_radius(), 5.1, 1e-14);
  options = {};
  options.scale = 1e-3;
  EXPECT_EQ(refusal(tube(), options),
            "radius_too_small mean_radius_m=5.1e-06 smallest_m=1e-05 largest_m=0.5");
  options.scale = 0;
  EXPECT_EQ(refused_argument([&] { BoreMesh(tube(), options); }), Argument("scale", 0));
  options = {};
  options.fit_degree = 5;
  EXPECT_EQ(refused_argument([&] { BoreMesh(tube(), options); }), Argument("fit_degree", 5));
}

TEST(BoreChecks, Arguments) {
  const BoreMesh mesh(tube());
  const Eigen::Vector3d z(0, 0, 1), origin(0, 0, 0);
  EXPECT_EQ(refused_argument([&] { mesh.contacts(origin, z, 0, 0); }),
            Argument("journal_radius", 0));
  EXPECT_EQ(refused_argument([&] { mesh.contacts(origin, z, 5e-3, -1); }),
            Argument("maximum_gap", -1));
  EXPECT_EQ(refused_argument([&] { mesh.contacts(origin, origin, 5e-3, 0); }),
            Argument("size of journal_axis", 0));
  EXPECT_EQ(refused_argument([&] {
              mesh.contacts(origin, {1, 0, 0}, 5e-3, 0);
            }).name,
            "cosine of the journal's tilt");
  EXPECT_EQ(refused_argument([&] {
              mesh.closest_point({0, 0, std::nan("")});
            }),
            Argument("query.z", std::nan("")));
  BoreOptions socket;
  socket.kind = SurfaceKind::socket;
  const BoreMesh cup(socket_triangles(8e-3, 1.5, 24, 10), socket);
  EXPECT_EQ(refused_argument([&] { cup.contacts(origin, z, 5e-3, 0); }),
            Argument("kind of the mesh", "socket"));
  EXPECT_EQ(refused_argument([] { bore_triangles({5e-3, 1e-2}, 2, 1); }), Argument("around", 2));
  EXPECT_EQ(refused_argument([] {
              bore_triangles({-5e-3, 1e-2}, 9, 1);
            }),
            Argument("radius", -0.005));
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
                  "y\nproperty double z\nelement face 48\nproperty list uchar int "
                  "vertex_indices\nend_header\n";
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
    // Binary STL holds floats: 6e-8 of 5 mm.
    EXPECT_NEAR(bore.mean_radius(), 5.1e-3, 4e-10) << file;
    for (std::size_t f = 0; f < 48; ++f)
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR((read.vertices[read.faces[f][k]] - mesh.vertices[mesh.faces[f][k]]).norm(), 0,
                    1e-9);
  }
}

TEST_F(BoreFiles, Refusals) {
  const auto failure = [](const std::string& file) {
    try {
      BoreMesh::read(file);
    } catch (const MeshFailure& failed) {
      EXPECT_EQ(failed.file(), file);
      return testing::shown(failed);
    }
    return std::string();
  };
  EXPECT_EQ(failure("/nowhere/bore.stl"), "not_opened");
  EXPECT_EQ(failure("/nowhere/bore.step"), "unknown_ending");
  EXPECT_EQ(failure("/nowhere/bore"), "unknown_ending");
  std::string file = write("empty.off", "");
  EXPECT_EQ(failure(file), "empty_file");
  file = write("rubbish.off", "this is no mesh\n");
  EXPECT_EQ(failure(file), "wrong_first_word format=OFF line=1 word=OFF");
  file = write("none.off", "OFF\n0 0 0\n");
  EXPECT_EQ(failure(file), "no_faces");
}

TEST_F(BoreFiles, WhatIsNoFileIsNotOpened) {
  const std::string pipe = path("pipe.off");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(mesh_failure([&] { read_triangles(pipe); }), "not_a_file");
  std::remove(pipe.c_str());
  const std::string zeros = path("zeros.stl");
  ASSERT_EQ(::symlink("/dev/zero", zeros.c_str()), 0);
  EXPECT_EQ(mesh_failure([&] { read_triangles(zeros); }), "not_a_file");
  std::remove(zeros.c_str());
  const std::string folder = path("folder.ply");
  ASSERT_EQ(::mkdir(folder.c_str(), 0700), 0);
  EXPECT_EQ(mesh_failure([&] { read_triangles(folder); }), "not_a_file");
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
    EXPECT_EQ(failure.reason(), MeshReason::wall_inside_out);
    EXPECT_EQ(failure.file(), "mesh");
    EXPECT_EQ(failure.remedy(), text_of(failure.reason()).remedy);
  }
}

TEST(BoreChecks, SentencesAreRenderedFromFields) {
  const std::array<double, 3> at{0.00464449123, -0.0, 1e-9};
  MeshFields intersecting{{"face", 3}, {"other_face", 7}, {"at_m", at}};
  EXPECT_EQ(cause(MeshReason::faces_intersect, intersecting),
            "faces 3 and 7 at (0.00464449, 0, 1e-09) m intersect");
  intersecting.emplace_back("more_pairs", std::uint64_t{2});
  EXPECT_EQ(cause(MeshReason::faces_intersect, intersecting),
            "faces 3 and 7 at (0.00464449, 0, 1e-09) m intersect, and 2 more pairs");
  const std::string coarse =
      cause(MeshReason::facets_too_coarse, {{"open_m", 1.23456}, {"allowed_m", 1e-4}});
  EXPECT_NE(coarse.find(" 1.23 m, allowed is 0.0001 m,"), std::string::npos) << coarse;
  EXPECT_STREQ(MeshFailure("a.off", MeshReason::wrong_first_word,
                           {{"format", "OFF"}, {"line", 1}, {"word", "OFF"}})
                   .what(),
               "a.off: not readable as OFF: line 1 does not begin with OFF");
  EXPECT_STREQ(
      MeshFailure("a.off", MeshReason::body_inside_out).what(),
      "a.off: the closed mesh is inside out: its normals point into the body; flip turns it");
  const std::string large = MeshFailure("a.off", MeshReason::radius_too_large).what();
  EXPECT_EQ(large.substr(large.find('?')), "? Then scale by 0.001");
}

TEST(BoreChecks, EveryReasonHasANameOfItsOwn) {
  std::set<std::string> names;
  for (int i = 0; i < mesh_reason_count; ++i)
    names.insert(text_of(static_cast<MeshReason>(i)).name);
  EXPECT_EQ(names.size(), static_cast<std::size_t>(mesh_reason_count));
  EXPECT_STREQ(text_of(MeshReason::no_faces).name, "no_faces");
  EXPECT_STREQ(text_of(MeshReason::radius_too_small).name, "radius_too_small");
}

TEST(BoreChecks, VertexWithManyNeighboursIsFittedToAllOfThem) {
  // At the bottom of a cup 150 faces meet. The fitted curvature must be that of the cup in all
  // directions. A fit to 60 neighbours would give that of an arc.
  BoreOptions socket;
  socket.kind = SurfaceKind::socket;
  constexpr double radius = 8e-3;
  const BoreMesh cup(socket_triangles(radius, 1.4, 150, 12), socket);
  const WallPoint bottom = cup.closest_point({0, 0, -0.99 * radius});
  // Vertex rings are 0.145 rad apart. The error of a fourth-order fit is (two rings)^4 = 7e-3,
  // times 1/8, the ratio of the sphere's sixth-order and second-order coefficients.
  EXPECT_NEAR(std::abs(bottom.curvature_1) * radius, 1.0, 1e-3);
  EXPECT_NEAR(std::abs(bottom.curvature_2) * radius, 1.0, 1e-3);
  EXPECT_NEAR(bottom.curvature_1, bottom.curvature_2, 1e-6 / radius);
}

TEST(BoreChecks, TooCoarse) {
  // Three to six facets around the bore do not determine the fitted polynomials. They once gave
  // depths of 1e7 m.
  for (const int around : {3, 4, 5, 6})
    for (const int along : {1, 2, 4, 20}) {
      const std::string failure = refusal(bore_triangles(round_bore(), around, along));
      EXPECT_EQ(failure.find("facets_too_coarse "), 0u)
          << around << ' ' << along << ": " << failure;
    }
  EXPECT_EQ(refusal(bore_triangles(round_bore(), 3, 2)),
            "facets_too_coarse open_m=0.00765 allowed_m=0.000102");
  for (const int around : {7, 8, 9, 12, 16})
    EXPECT_NO_THROW(BoreMesh(bore_triangles(round_bore(), around, 3))) << around;
  // All neighbours of a cup's bottom lie beyond a crease, but the fit uses them. Each of the 150
  // counts from both of its faces, which exceeds the 64 equations on the stack.
  BoreOptions socket;
  socket.kind = SurfaceKind::socket;
  EXPECT_EQ(refusal(socket_triangles(8e-3, 0.4, 150, 2), socket).find("facets_too_coarse "), 0u);
}

TEST(BoreChecks, HugeAndTinyCoordinates) {
  BoreOptions any;
  any.smallest_radius = 0;
  any.largest_radius = INFINITY;
  for (const double size : {1e-320, 1e-200, 1e-160, 1e63, 1e150, 1e300, 1e308}) {
    Triangles mesh = tube();
    for (auto& vertex : mesh.vertices) vertex *= size;
    EXPECT_NE(refusal(mesh, any), "") << size;
  }
  Triangles mesh = tube();
  mesh.vertices[5] = {1e61, 0, 0};
  EXPECT_EQ(refusal(mesh), "vertex_too_far vertex=5 at_m=1e+61,0,0");
}

}  // namespace
}  // namespace statejump::geometry
