// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "statejump/kernel/laws/user_law.hpp"

/// Finds laws of one's own, compiled by `statejump laws build`, and enters them in the catalogue.
namespace statejump::law_loader {

/// Hash of the kernel headers of this build; a law has to have been compiled against the same.
const char* kernel_hash();

/// Folders that are searched: those of $STATEJUMP_LAWS, a list as in $PATH, and
/// ${XDG_DATA_HOME:-~/.local/share}/statejump/laws.
std::vector<std::filesystem::path> folders();

/// Loads every *.so of folders() that is not loaded yet, folders in their order, files by name.
/// Never throws: an object that cannot be used is entered with its problem, see
/// kernel::laws::LoadedLaw. Call before looking up laws; not at the same time as that.
void load_user_laws();

/// A sentence for each object that cannot be used.
std::vector<std::string> problems();

/// What load_user_laws() would enter for one file; an empty name: no law at all.
kernel::laws::LoadedLaw inspect(const std::filesystem::path& file);

}  // namespace statejump::law_loader
