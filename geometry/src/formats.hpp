// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "statejump/geometry/triangles.hpp"

namespace statejump::geometry {

/// Formats of mesh files.
enum class MeshFormat : unsigned char { off, stl, ply, obj };

/// "OFF", "STL", "PLY", "OBJ".
const char* to_string(MeshFormat format);

/// Format that the ending of a file's name says; none for any other ending.
std::optional<MeshFormat> format_of(const std::string& file);

/// Triangles of a file's whole content, which may come from a stranger: time and memory are bounded
/// by a multiple of its length, whatever counts it declares.
///
/// Polygons are cut into fans; equal vertices become one, numbered by first appearance; vertices of
/// STL, and of PLY with float coordinates, also where they differ by rounding of floats.
/// OFF: text, also with normals, colours and texture (N, C, ST), which are skipped. STL: text or
/// binary, also with attributes behind its facets. PLY: text and both binary orders, any elements
/// beside vertex (x, y, z) and face or tristrips (vertex_indices or vertex_index). OBJ: v and f,
/// indices from 1 or back from the last vertex; a line goes on behind a backslash at its end; all
/// else is skipped.
/// @param name said first in errors
/// @throws MeshFailure `unreadable` for what is not of the format, `bad_faces` for corners that do
///         not exist, vertices that are not finite and a mesh without faces
Triangles parse_triangles(MeshFormat format, std::string_view content, const std::string& name);

}  // namespace statejump::geometry
