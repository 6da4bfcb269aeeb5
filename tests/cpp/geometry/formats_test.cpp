// SPDX-License-Identifier: GPL-3.0-or-later
// Untrusted mesh files: malformed ones that broke other readers. Each is rejected with its cause,
// in bounded memory.
#include "formats.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "statejump/geometry/mesh_failure.hpp"

namespace statejump::geometry {
namespace {

std::string refusal(MeshFormat format, const std::string& content) {
  try {
    parse_triangles(format, content, "mesh");
  } catch (const MeshFailure& failure) {
    EXPECT_TRUE(failure.fault() == MeshFault::unreadable ||
                failure.fault() == MeshFault::bad_faces);
    return failure.cause();
  }
  return "nothing was refused";
}

struct Refused {
  std::string content;
  std::string cause;
};

void expect_refused(MeshFormat format, const std::string& prefix,
                    const std::vector<Refused>& cases) {
  for (const Refused& each : cases) {
    const bool is_of_faces = each.cause.find("face") == 0 || each.cause.find("the mesh") == 0 ||
                             each.cause.find("vertex") == 0;
    EXPECT_EQ(refusal(format, each.content), is_of_faces ? each.cause : prefix + each.cause)
        << each.content;
  }
}

/// Binary STL of two triangles with a common edge. `moved` shifts its vertices in the second one.
std::string two_facets(float moved) {
  const float corners[2][4][3] = {{{0, 0, 1}, {0, 0, 0}, {5, 0, 0}, {0, 3, 0}},
                                  {{0, 0, 1}, {5 + moved, 0, 0}, {5, 3, 0}, {0, 3 + moved, 0}}};
  std::string content(80, ' ');
  const std::uint32_t count = 2;
  content.append(reinterpret_cast<const char*>(&count), 4);
  for (const auto& facet : corners) {
    content.append(reinterpret_cast<const char*>(facet), sizeof facet);
    content.append(2, '\0');
  }
  return content;
}

TEST(MeshFormats, FloatsAreWeldedWithinTheirRounding) {
  // Unit in the last place of a float: 4.8e-7 near 5, 2.4e-7 near 3.
  const float unit = 4.8e-7F;
  const Triangles welded = parse_triangles(MeshFormat::stl, two_facets(unit), "mesh");
  EXPECT_EQ(welded.vertices.size(), 4U);
  const Triangles apart = parse_triangles(MeshFormat::stl, two_facets(10 * unit), "mesh");
  EXPECT_EQ(apart.vertices.size(), 6U);
  // OFF and OBJ contain text with numbers of any precision.
  const Triangles exact = parse_triangles(
      MeshFormat::obj, "v 0 0 0\nv 5 0 0\nv 5.0000004 0 0\nv 0 3 0\nf 1 2 4\nf 1 3 4", "mesh");
  EXPECT_EQ(exact.vertices.size(), 4U);
}

TEST(MeshFormats, FacesOfTwoVerticesAreLeftOutAndCounted) {
  const Triangles mesh = parse_triangles(
      MeshFormat::obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 3 2 2\n", "mesh");
  EXPECT_EQ(mesh.faces.size(), 1U);
  EXPECT_EQ(mesh.removed, 2);
  EXPECT_EQ(refusal(MeshFormat::obj, "v 0 0 0\nv 1 0 0\nf 1 1 2\n"),
            "the mesh has no faces with three vertices");
}

TEST(MeshFormats, LinesOfObjGoOnBehindABackslash) {
  const Triangles mesh = parse_triangles(
      MeshFormat::obj,
      "# a comment\nv 0 0 0\nv 1 \\\n 0 0\nv 0 1\\\r\n 0\nvn 0 \\\n0 1\nf 1\\\n 2 3\n", "mesh");
  EXPECT_EQ(mesh.vertices.size(), 3U);
  EXPECT_EQ(mesh.faces.size(), 1U);
  EXPECT_EQ(refusal(MeshFormat::obj, "v 0 0 0\nv 1 \\\n 0\n"),
            "not readable as OBJ: line 3 has no three coordinates");
}

TEST(MeshFormats, FacesOfTwoCornersAreLeftOutAndCounted) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const Triangles mesh = parse_triangles(MeshFormat::obj, points + "f 1// 2//\nf 1 2 3\n", "mesh");
  EXPECT_EQ(mesh.faces.size(), 1U);
  EXPECT_EQ(mesh.removed, 1);
}

TEST(MeshFormats, TextsMayBeginWithAByteOrderMark) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(parse_triangles(MeshFormat::obj, mark + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "mesh")
                .faces.size(),
            1U);
  EXPECT_EQ(parse_triangles(MeshFormat::stl,
                            mark + "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
                                   "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n",
                            "mesh")
                .faces.size(),
            1U);
}

TEST(MeshFormats, CommentsEndWithTheirLine) {
  const Triangles mesh = parse_triangles(
      MeshFormat::obj, "# from C:\\parts\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "mesh");
  EXPECT_EQ(mesh.vertices.size(), 3U);
}

TEST(MeshFormats, Off) {
  const Triangles mesh = parse_triangles(MeshFormat::off,
                                         "# a comment\nSTCNOFF 5 2 0 # counts\n0 0 0 1 2 3\n"
                                         "+1 0 0\n\n1 1e0 0\n0 1 0\n0 0 -0\n"
                                         "4 0 1 2 3 255 0 0\n3 4 2 3",
                                         "mesh");
  EXPECT_EQ(mesh.vertices.size(), 4u);  // the last vertex equals the first
  const std::vector<std::array<int, 3>> faces{{0, 1, 2}, {0, 2, 3}, {0, 2, 3}};
  EXPECT_EQ(mesh.faces, faces);
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const char* start : {"OFF3 1 0\n", "3 1 0\n", "OFF\n3 1\n"})
    EXPECT_EQ(parse_triangles(MeshFormat::off, start + body, "mesh").faces.size(), 1U) << start;
  expect_refused(
      MeshFormat::off, "not readable as OFF: ",
      {{"", "it holds nothing"},
       {" \n# OFF", "it holds nothing"},
       {"OF", "line 1 does not begin with OFF"},
       {"4OFF\n1 1 0", "line 1 does not begin with OFF"},
       {"OFFx\n1 1 0", "line 1 does not begin with OFF"},
       {"OFF", "line 1 should hold the numbers of vertices and faces"},
       {"OFF BINARY\n", "it is binary: only OFF as text is read"},
       {"OFF\n-3 1 0\n", "line 2 should hold the numbers of vertices and faces"},
       {"OFF\n3 1e9 0\n", "line 2 should hold the numbers of vertices and faces"},
       {"OFF\n99999999999999999999 1 0\n", "line 2 should hold the numbers of vertices and faces"},
       {"OFF\n100000000 1 0\n0 0 0\n1 0 0\n0 1 0\n",
        "it declares 100000000 vertices and 1 faces, which do not fit into its 36 bytes"},
       {"OFF\n18446744073709551615 1 0\n",
        "it declares 18446744073709551615 vertices and 1 faces, which do not fit into its 29 "
        "bytes"},
       {"OFF\n1 18446744073709551615 0\n0 0 0\n",
        "it declares 1 vertices and 18446744073709551615 faces, which do not fit into its 35 "
        "bytes"},
       {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1\n3 0 1 2\n", "line 5 has no three coordinates"},
       {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0x1\n3 0 1 2\n", "line 5 has no three coordinates"},
       {"OFF\n3 1 0\n0.000000 0 0\n1.000000 0 0\n", "it ends before its last vertex"},
       {"OFF\n3 1 0\n0.000000 0 0\n1 0 0\n0 1 0\n", "it ends before its last face"},
       {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n1000000000 0 1 2\n",
        "line 6 has fewer corners than it declares"},
       {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "line 6 has no number of corners"},
       {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n",
        "line 7 follows the last of the faces that it declares"},
       {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1 2\n", "the mesh has no faces with three vertices"},
       {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n",
        "face 0 has corner 7, but there are only 3 vertices"},
       {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n",
        "face 0 has corner -1, but there are only 3 vertices"},
       {"OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "vertex 1 is not finite"},
       {"OFF\n3 1 0\n0 0 0\n1 0 -inf\n0 1 0\n3 0 1 2\n", "vertex 1 is not finite"},
       {"OFF\n0 0 0\n", "the mesh has no faces"}});
}

std::string binary_stl(std::uint32_t declared, int facets, const std::string& header = "") {
  std::string content = header;
  content.resize(80, ' ');
  content.append(reinterpret_cast<const char*>(&declared), 4);
  for (int f = 0; f < facets; ++f) {
    const std::array<float, 12> numbers{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, static_cast<float>(f)};
    content.append(reinterpret_cast<const char*>(numbers.data()), 48);
    content.append(2, '\0');
  }
  return content;
}

TEST(MeshFormats, Stl) {
  // A binary file is not read as text, even if it begins with the word "solid".
  const Triangles mesh =
      parse_triangles(MeshFormat::stl, binary_stl(2, 2, "solid of a maker that does not care"), "");
  const std::vector<std::array<int, 3>> faces{{0, 1, 2}, {0, 1, 3}};
  EXPECT_EQ(mesh.faces, faces);
  const std::string start = "solid\nfacet normal 0 0 1\nouter loop\n";
  const std::string vertices = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
  const std::string end = "endloop\nendfacet\nendsolid\n";
  EXPECT_EQ(
      parse_triangles(MeshFormat::stl, "S" + start.substr(1) + vertices + end, "").faces.size(),
      1u);
  std::string not_finite = binary_stl(1, 1);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(not_finite.data() + 84 + 12, &nan, 4);
  expect_refused(
      MeshFormat::stl, "not readable as STL: ",
      {{"", "it neither begins with solid nor has 84 bytes"},
       {std::string(83, '\0'), "it neither begins with solid nor has 84 bytes"},
       {binary_stl(4294967295u, 1),
        "it declares 4294967295 facets, which take 214748364834 bytes, but it has 134"},
       {binary_stl(2, 1), "it declares 2 facets, which take 184 bytes, but it has 134"},
       {binary_stl(1, 2), "it declares 1 facets, which take 134 bytes, but it has 184"},
       {binary_stl(0, 0), "the mesh has no faces"},
       {not_finite, "vertex 0 is not finite"},
       {"solid\nendsolid\n", "the mesh has no faces"},
       {start + vertices, "it ends before endsolid"},
       {start + "vertex 0 0\n" + end, "line 4 has no three coordinates"},
       {start + "vertex 0 0 0\n" + end, "line 5 is out of place"},
       {start + vertices + "vertex 0 1 0\n" + end, "line 7 is out of place"},
       {"solid\nfacet norm 0 0 1", "line 2 lacks the word normal"},
       {"solid\nfacet normal 0 0", "it ends inside a facet"},
       {start + vertices + "endloop\nendfac", "line 8 lacks the word endfacet"},
       {start + vertices + end + "facet normal 0 0 1", "line 10 is outside of a solid"}});
}

TEST(MeshFormats, FacetsOfStlMayHaveAttributes) {
  std::string content = binary_stl(2, 2);
  const std::size_t first_ends = 84 + 50;
  content[first_ends - 2] = 3;  // a colour: the file is not longer because of it
  EXPECT_EQ(parse_triangles(MeshFormat::stl, content, "mesh").faces.size(), 2U);
  content.insert(first_ends, "abc");
  EXPECT_EQ(parse_triangles(MeshFormat::stl, content, "mesh").faces.size(), 2U);
  content[first_ends - 2] = 2;
  EXPECT_EQ(refusal(MeshFormat::stl, content),
            "not readable as STL: it declares 2 facets, which take 184 bytes, but it has 187");
}

TEST(MeshFormats, Obj) {
  const Triangles mesh =
      parse_triangles(MeshFormat::obj,
                      "# made by hand\no part\nv 0 0 0 1\nv 1 0 0\nv 0 1 0\n"
                      "vn 0 0 1\nvt 0 0\nusemtl steel\nf 1/1/1 2//1 -1\nf 1 2 4\n"
                      "v 0 0 1",
                      "");
  const std::vector<std::array<int, 3>> faces{{0, 1, 2}, {0, 1, 3}};
  EXPECT_EQ(mesh.faces, faces);
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_refused(MeshFormat::obj, "not readable as OBJ: ",
                 {{"", "the mesh has no faces"},
                  {std::string(100, '\0'), "the mesh has no faces"},
                  {"v 0 0\n", "line 1 has no three coordinates"},
                  {points + "f 1 2 x\n", "line 4 has a corner that is no index of a vertex"},
                  {points + "f 1 2 0\n", "line 4 has a corner that is no index of a vertex"},
                  {points + "f 1 2 99999999999999999999\n",
                   "line 4 has a corner that is no index of a vertex"},
                  {points + "f 1 2 -9223372036854775807\n",
                   "line 4 has a corner that is no index of a vertex"},
                  {points + "f 1 2 -9223372036854775808\n",
                   "line 4 has a corner that is no index of a vertex"},
                  {points + "f 1 2 4\n", "face 0 has corner 3, but there are only 3 vertices"},
                  {points + "f 1 2 -4\n", "face 0 has corner -1, but there are only 3 vertices"},
                  {points + "f 1 2\n", "the mesh has no faces with three vertices"},
                  {points + "f\n", "the mesh has no faces with three vertices"},
                  {"v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3", "vertex 1 is not finite"}});
}

std::string ply(const std::string& format, const std::string& elements, const std::string& body) {
  return "ply\nformat " + format + " 1.0\ncomment by hand\n" + elements + "end_header\n" + body;
}

constexpr const char* xyz = "property float x\nproperty float y\nproperty float z\n";

std::string elements(const std::string& points, const std::string& faces,
                     const std::string& list = "list uchar int vertex_indices") {
  return "element vertex " + points + "\n" + xyz + "element face " + faces + "\nproperty " + list +
         "\n";
}

template <class Number>
void append(std::string& bytes, Number value, bool big) {
  std::string own(reinterpret_cast<const char*>(&value), sizeof value);
  if (big) own.assign(own.rbegin(), own.rend());
  bytes += own;
}

TEST(MeshFormats, Ply) {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const std::vector<std::array<int, 3>> faces{{0, 1, 2}};
  EXPECT_EQ(parse_triangles(MeshFormat::ply, ply("ascii", elements("3", "1"), body), "").faces,
            faces);
  // Faces first, an element and properties that are skipped, Windows line ends.
  std::string strange =
      ply("ascii",
          "element face 1\nproperty uchar red\nproperty list uint8 uint32 "
          "vertex_index\nproperty list int float weights\nelement edge 2\nproperty "
          "int32 a\nelement vertex 3\nproperty double z\nproperty int8 q\nproperty "
          "float64 x\nproperty short y\n",
          "255 3 2 1 0 1 0.5\n7\n8\n0 1 2 3\n1 2 3 4\n2 3 4 5\n");
  for (std::size_t at = 0; (at = strange.find('\n', at)) != std::string::npos; at += 2)
    strange.insert(at, "\r");
  const Triangles turned = parse_triangles(MeshFormat::ply, strange, "");
  EXPECT_EQ(turned.vertices[2], Eigen::Vector3d(4, 5, 2));
  for (const bool big : {false, true}) {
    std::string bytes;
    for (const float number : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
      append(bytes, number, big);
    append(bytes, std::uint16_t{3}, big);
    for (const std::int32_t corner : {0, 1, 2}) append(bytes, corner, big);
    const std::string file = ply(big ? "binary_big_endian" : "binary_little_endian",
                                 elements("3", "1", "list ushort int vertex_indices"), bytes);
    EXPECT_EQ(parse_triangles(MeshFormat::ply, file, "").faces, faces);
    EXPECT_EQ(refusal(MeshFormat::ply, file.substr(0, file.size() - 1)),
              "not readable as PLY: it ends before its last element");
    EXPECT_EQ(refusal(MeshFormat::ply, file + "x"),
              "not readable as PLY: it holds more than it declares");
  }
  // Triangle strips; every second triangle is reversed.
  const std::string strips = "element vertex 5\n" + std::string(xyz) +
                             "element tristrips 1\nproperty list int int vertex_indices\n"
                             "element nothing 0\n";
  const Triangles stripped = parse_triangles(
      MeshFormat::ply,
      ply("ascii", strips, "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 1\n8 0 1 2 3 -1 2 1 4\n"), "");
  const std::vector<std::array<int, 3>> of_strips{{0, 1, 2}, {2, 1, 3}, {2, 1, 4}};
  EXPECT_EQ(stripped.faces, of_strips);
  std::string endless =
      ply("binary_little_endian", elements("3", "1", "list uint int vertex_indices"),
          std::string(36, '\0'));
  append(endless, std::uint32_t{4294967295u}, false);
  expect_refused(
      MeshFormat::ply, "not readable as PLY: ",
      {{"", "its header has no end"},
       {"ply\nformat ascii 1.0\n", "its header has no end"},
       {"plyx\n", "line 1 does not begin with ply"},
       {ply("ascii", "elemen vertex 3\n" + elements("3", "1"), body),
        "line 4 is no line of a PLY header"},
       {ply("ascii", xyz + elements("3", "1"), body), "line 4 has a property before any element"},
       {ply("text", elements("3", "1"), body), "line 2 is no line of a PLY header"},
       {"ply\nend_header\n", "its header names no format"},
       {ply("ascii", elements("x", "1"), body), "line 4 is no line of a PLY header"},
       {ply("ascii", elements("-3", "1"), body), "line 4 is no line of a PLY header"},
       {ply("ascii", elements("3", "1") + "element vertex 3\n", body),
        "line 10 declares an element for the second time"},
       {ply("ascii", elements("3", "1", "list uchar vertex_indices"), body),
        "line 9 has a property of no known type"},
       {ply("ascii", elements("3", "1", "list float int vertex_indices"), body),
        "line 9 is no line of a PLY header"},
       {ply("ascii", elements("3", "1", "list uchar float vertex_indices"), body),
        "its faces lack vertex_indices"},
       {ply("ascii", elements("3", "1", "float128 q"), body),
        "line 9 has a property of no known type"},
       {ply("ascii",
            "element vertex 3\nproperty float x\nproperty float y\nproperty list uchar "
            "float z\nelement face 1\nproperty list uchar int vertex_indices\n",
            body),
        "its vertices lack a coordinate"},
       {ply("ascii", "element vertex 3\n" + std::string(xyz), "0 0 0\n1 0 0\n0 1 0\n"),
        "it lacks the element vertex or face"},
       {ply("ascii", elements("3", "1") + "element nothing 1000000000000\n", body),
        "its element 2 has no properties"},
       {ply("ascii", elements("4000000000", "1"), body),
        "it declares 4000000000 items of an element, which do not fit into its 205 bytes"},
       {ply("ascii", elements("3", "18446744073709551615"), body),
        "it declares 18446744073709551615 items of an element, which do not fit into its 215 "
        "bytes"},
       {ply("ascii", elements("3", "1"), "0 0 0\n1 0 0\n0 1 0\n255 0 1 2\n"),
        "it ends before its last element"},
       {ply("ascii", elements("3", "1", "list int int vertex_indices"),
            "0 0 0\n1 0 0\n0 1 0\n2147483647 0 1 2\n"),
        "it ends before its last element"},
       {endless, "it ends before its last element"},
       {ply("ascii", elements("3", "1", "list char int vertex_indices"),
            "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n"),
        "its data hold a list of negative length"},
       {ply("ascii", elements("3", "1"), "0 0 0\n1 0 0\n0 1 0\n3 0 1 2.5\n"),
        "its data hold a count or an index that is no whole number"},
       {ply("ascii", elements("3", "1"), "0 0 0\n1 0 0\n0 1 0\n3 0 1 nan\n"),
        "its data hold a count or an index that is no whole number"},
       {ply("ascii", elements("3", "1"), "0 0 0\n1 0 0\n0 1 0\n3 0 1 two\n"),
        "its data hold what is no number"},
       {ply("ascii", elements("3", "1"), body + "3 0 1 2\n"), "it holds more than it declares"},
       {ply("ascii", elements("3", "1"), "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
        "face 0 has corner 3, but there are only 3 vertices"},
       {ply("ascii", elements("3", "1"), "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"),
        "face 0 has corner -1, but there are only 3 vertices"},
       {ply("ascii", elements("3", "1"), "0 0 0\n1 inf 0\n0 1 0\n3 0 1 2\n"),
        "vertex 1 is not finite"}});
}

}  // namespace
}  // namespace statejump::geometry
