// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <fstream>

#include "formats.hpp"
#include "statejump/geometry/mesh_failure.hpp"
#include "statejump/geometry/triangles.hpp"

namespace statejump::geometry {
namespace {

constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 31U;  // binary STL of 40 million facets

[[noreturn]] void refuse(const std::string& file, MeshReason reason) {
  throw MeshFailure(file, reason);
}

/// Returns the whole content of a file. It does not open pipes, devices and other special files.
std::string content_of(const std::string& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    refuse(file, MeshReason::not_a_file);
  std::ifstream stream(file, std::ios::binary);
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (!stream || error) refuse(file, MeshReason::not_opened);
  if (size > most_bytes) refuse(file, MeshReason::above_2_gib);
  std::string content(static_cast<std::size_t>(size), '\0');
  stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  if (stream.bad()) refuse(file, MeshReason::read_failed);
  content.resize(static_cast<std::size_t>(stream.gcount()));
  if (content.empty()) refuse(file, MeshReason::empty_file);
  return content;
}

}  // namespace

Triangles read_triangles(const std::string& file) {
  const std::optional<MeshFormat> format = format_of(file);
  if (!format) refuse(file, MeshReason::unknown_ending);
  return parse_triangles(*format, content_of(file), file);
}

}  // namespace statejump::geometry
