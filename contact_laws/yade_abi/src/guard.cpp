// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/yade_abi/guard.hpp"

#include <elf.h>
#include <link.h>

#include <array>
#include <cstdio>
#include <cstring>

#include "checks.hpp"

namespace statejump::yade_abi {
namespace {

constexpr std::array<const char*, 3> checked_libraries = {"libyade.so", "libpkg_common.so",
                                                          "libpkg_dem.so"};

struct KnownBinary {
  const char* release;
  const char* version;
  std::array<const char*, 3> build_ids;  // in the order of checked_libraries
};

// The build generates this file from known_binaries.csv. It contains the rows and built_for_row,
// the index of the binary that the plugin is built for (-1 if built with YADE's own headers).
#include "statejump/yade_abi/known_binaries.inc"

std::string name_of(const KnownBinary& binary) {
  return std::string("YADE ") + binary.version + " of " + binary.release;
}

std::string build_id(const dl_phdr_info& info) {
  for (int i = 0; i < info.dlpi_phnum; ++i) {
    const auto& header = info.dlpi_phdr[i];
    if (header.p_type != PT_NOTE) continue;
    const char* position = reinterpret_cast<const char*>(info.dlpi_addr + header.p_vaddr);
    const char* end = position + header.p_memsz;
    while (position + sizeof(ElfW(Nhdr)) <= end) {
      ElfW(Nhdr) note;
      std::memcpy(&note, position, sizeof note);
      const char* name = position + sizeof note;
      const char* bytes = name + ((note.n_namesz + 3U) & ~3U);
      if (note.n_type == NT_GNU_BUILD_ID && std::string(name) == "GNU") {
        std::string text;
        for (unsigned k = 0; k < note.n_descsz; ++k) {
          char digits[3];
          std::snprintf(digits, sizeof digits, "%02x", static_cast<unsigned char>(bytes[k]));
          text += digits;
        }
        return text;
      }
      position = bytes + ((note.n_descsz + 3U) & ~3U);
    }
  }
  return "none";
}

struct LibrarySearch {
  const char* file_name;
  std::string build_id;
};

int find_library(dl_phdr_info* info, std::size_t, void* data) {
  auto& search = *static_cast<LibrarySearch*>(data);
  const std::string path = info->dlpi_name ? info->dlpi_name : "";
  if (path.substr(path.rfind('/') + 1) != search.file_name) return 0;
  search.build_id = build_id(*info);
  return 1;
}

std::string build_id_difference() {
  if (built_for_row < 0) return "";
  const KnownBinary& expected = known_binaries[static_cast<std::size_t>(built_for_row)];
  for (std::size_t i = 0; i < checked_libraries.size(); ++i) {
    LibrarySearch search{checked_libraries[i], ""};
    dl_iterate_phdr(find_library, &search);
    if (search.build_id.empty()) {
      return std::string(checked_libraries[i]) + " is not loaded: this is not a running YADE";
    }
    if (search.build_id == expected.build_ids[i]) continue;
    for (const auto& other : known_binaries) {
      if (search.build_id == other.build_ids[i]) return "this is " + name_of(other);
    }
    return std::string(checked_libraries[i]) + " has build identifier " + search.build_id +
           ", known is " + expected.build_ids[i];
  }
  return "";
}

}  // namespace

Difference difference_from_running_yade(const boost::python::object& wrapper,
                                        const GuardOptions& options) {
  if (options.check_build_ids) {
    if (auto sentence = build_id_difference(); !sentence.empty()) {
      return {"build identifier", sentence};
    }
  }
  const DeclaredInterface declared = declared_interface();
  if (auto sentence = size_difference(declared); !sentence.empty()) return {"size", sentence};
  if (auto sentence = table_difference(declared); !sentence.empty()) return {"table", sentence};
  if (auto sentence = getter_difference(declared, wrapper); !sentence.empty()) {
    return {"getter", sentence};
  }
  if (auto sentence = coverage_difference(declared); !sentence.empty()) {
    return {"coverage", sentence};
  }
  if (auto sentence = sentinel_difference(declared, wrapper); !sentence.empty()) {
    return {"sentinel", sentence};
  }
  if (auto sentence = value_difference(declared, wrapper); !sentence.empty()) {
    return {"value", sentence};
  }
  return {};
}

std::string built_for() {
  return built_for_row < 0 ? "the YADE whose headers it was built with"
                           : name_of(known_binaries[static_cast<std::size_t>(built_for_row)]);
}

}  // namespace statejump::yade_abi
