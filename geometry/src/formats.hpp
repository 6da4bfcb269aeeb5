// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "statejump/geometry/triangles.hpp"

namespace statejump::geometry {

/// Formats of mesh files.
enum class MeshFormat : unsigned char { off, stl, ply, obj };

/// Name of the format, e.g. "OFF".
const char* to_string(MeshFormat format);

/// Mesh format for the extension of a file name; nothing for any other extension.
std::optional<MeshFormat> format_of(const std::string& file);

/// Creates triangles from the whole content of a file. The content may be untrusted: time and
/// memory are bounded by a multiple of its length, whatever counts it declares.
///
/// Polygons are split into fans. Equal vertices are merged and numbered by first appearance.
/// Vertices of STL, and of PLY with float coordinates, are also merged if they differ by rounding.
/// OFF: text; normals, colours and texture (N, C, ST) are skipped.
/// STL: text or binary; attributes after the facets are skipped.
/// PLY: text or binary in either byte order. It reads vertex (x, y, z) and face or tristrips
///   (vertex_indices or vertex_index); other elements are skipped.
/// OBJ: v and f, with indices from 1 or negative ones from the last vertex. A backslash at the end
///   continues a line; everything else is skipped.
/// @param name name of the mesh, printed first in errors
/// @throws MeshFailure `unreadable` if the content is not of this format; `bad_faces` for corners
///     that do not exist, vertices that are not finite, or a mesh without faces
Triangles parse_triangles(MeshFormat format, std::string_view content, const std::string& name);

}  // namespace statejump::geometry
