// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats.hpp"

#include "formats/reading.hpp"
#include "formats/words.hpp"

namespace statejump::geometry {

const char* to_string(MeshFormat format) {
  switch (format) {
    case MeshFormat::off:
      return "OFF";
    case MeshFormat::stl:
      return "STL";
    case MeshFormat::ply:
      return "PLY";
    case MeshFormat::obj:
      return "OBJ";
  }
  return "unknown";
}

std::optional<MeshFormat> format_of(const std::string& file) {
  const auto dot = file.find_last_of('.');
  const auto slash = file.find_last_of('/');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return {};
  const std::string_view ending = std::string_view(file).substr(dot + 1);
  if (formats::same_word(ending, "off")) return MeshFormat::off;
  if (formats::same_word(ending, "stl")) return MeshFormat::stl;
  if (formats::same_word(ending, "ply")) return MeshFormat::ply;
  if (formats::same_word(ending, "obj")) return MeshFormat::obj;
  return {};
}

Triangles parse_triangles(MeshFormat format, std::string_view content, const std::string& name) {
  formats::Reading reading(format, name);
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // written by .NET programs
  if (content.substr(0, byte_order_mark.size()) == byte_order_mark)
    content.remove_prefix(byte_order_mark.size());
  switch (format) {
    case MeshFormat::off:
      formats::read_off(content, reading);
      break;
    case MeshFormat::stl:
      formats::read_stl(content, reading);
      break;
    case MeshFormat::ply:
      formats::read_ply(content, reading);
      break;
    case MeshFormat::obj:
      formats::read_obj(content, reading);
      break;
  }
  return reading.triangles();
}

}  // namespace statejump::geometry
