// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "statejump/truss/motion.hpp"

namespace statejump::truss::detail {

/// Checks a model and its options for every scheme. Throws std::invalid_argument.
void check_motion(const Model& model, const MotionOptions& options);

/// First state of the quasi-static path; empty if the caller cancelled the search.
std::optional<State> equilibrium(const Model& model, const MotionOptions& options);

}  // namespace statejump::truss::detail
