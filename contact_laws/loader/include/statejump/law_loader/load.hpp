// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "statejump/kernel/laws/user_law.hpp"

/// Finds user laws compiled by `statejump laws build` and adds them to the catalogue of laws.
namespace statejump::law_loader {

/// Hash of the kernel headers of this build. A law must be compiled with the same headers.
const char* kernel_hash();

/// Folders that are searched for laws: those listed in $STATEJUMP_LAWS (separated as in $PATH), and
/// ${XDG_DATA_HOME:-~/.local/share}/statejump/laws.
std::vector<std::filesystem::path> folders();

/// Loads every *.so of folders() that is not loaded yet, folder by folder, sorted by file name. It
/// never throws: an unusable object is added to the catalogue with its problem, see
/// kernel::laws::LoadedLaw. Call it before looking up laws, and not concurrently with a look-up.
void load_user_laws();

/// One sentence for each unusable object.
std::vector<std::string> problems();

/// Catalogue entry that load_user_laws() makes of one file. Its name is empty if the file contains
/// no law.
kernel::laws::LoadedLaw inspect(const std::filesystem::path& file);

}  // namespace statejump::law_loader
