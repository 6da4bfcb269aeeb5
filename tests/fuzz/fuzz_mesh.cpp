// SPDX-License-Identifier: GPL-3.0-or-later
// Mesh files as libFuzzer makes them: the first byte chooses the format, the rest is the file. What
// is accepted must be whole: every corner a vertex, every vertex finite.
//
// Linked with libFuzzer it searches; linked with replay.cpp it reads the files that it is given.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "formats.hpp"
#include "statejump/geometry/mesh_failure.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace statejump::geometry;
  if (size == 0) return 0;
  const auto format = static_cast<MeshFormat>(data[0] % 4);
  const std::string_view content(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    const Triangles mesh = parse_triangles(format, content, "mesh");
    const auto count = static_cast<int>(mesh.vertices.size());
    for (const auto& vertex : mesh.vertices)
      if (!vertex.allFinite()) std::abort();
    for (const auto& face : mesh.faces)
      for (const int corner : face)
        if (corner < 0 || corner >= count) std::abort();
    // In every format a triangle takes more than one byte; the triangles of a polygon share its
    // corners.
    if (mesh.faces.empty() || mesh.faces.size() > size) std::abort();
  } catch (const MeshFailure& failure) {
    if (failure.cause().empty()) std::abort();
  }
  return 0;
}
