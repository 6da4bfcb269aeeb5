// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by mesh generation and rest_on_mesh(); not installed.
#pragma once

#include <utility>

#include "statejump/rest_set/surface.hpp"

namespace statejump::rest_set::detail {

/// An edge by its vertices, the smaller index first.
using EdgeKey = std::pair<int, int>;

/// @throws std::invalid_argument for a mesh without triangles, wrong indices or vertices
void check_mesh(const Mesh& mesh);

}  // namespace statejump::rest_set::detail
