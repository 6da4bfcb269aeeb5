// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <vector>

#include "statejump/geometry/mesh_failure.hpp"

namespace statejump::geometry {
namespace {

bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

bool same_word(std::string_view word, std::string_view lower_case) {
  return word.size() == lower_case.size() &&
         std::equal(word.begin(), word.end(), lower_case.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) == b;
         });
}

/// A whole word as a number, correctly rounded; "nan" and "inf" are numbers here.
template <class Number>
bool to_number(std::string_view word, Number& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size();
}

/// What was read, and where errors are told.
class Reading {
 public:
  Reading(MeshFormat format, const std::string& name) : format_(format), name_(name) {}

  [[noreturn]] void refuse(const std::string& cause) const {
    throw MeshFailure(name_, MeshFault::unreadable,
                      std::string("not readable as ") + to_string(format_) + ": " + cause);
  }
  [[noreturn]] void refuse_line(int line, const std::string& cause) const {
    refuse("line " + std::to_string(line) + " " + cause);
  }

  void add_point(const Eigen::Vector3d& point) { points_.push_back(point); }
  /// @param corners from 0; any integer is taken here and checked in the end
  void add_polygon(const std::vector<std::int64_t>& corners) {
    if (corners.size() < 3)
      refuse_faces("face " + std::to_string(polygons_) + " has fewer than 3 corners");
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
      fans_.push_back({corners[0], corners[k], corners[k + 1]});
      polygon_of_.push_back(polygons_);
    }
    ++polygons_;
  }
  std::size_t points() const { return points_.size(); }

  Triangles triangles() const {
    if (fans_.empty()) refuse_faces("the mesh has no faces");
    Triangles result;
    std::map<std::array<double, 3>, int> known;
    std::vector<int> number(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!points_[i].allFinite()) refuse_faces("vertex " + std::to_string(i) + " is not finite");
      const std::array<double, 3> key{points_[i].x(), points_[i].y(), points_[i].z()};
      const auto [place, fresh] = known.emplace(key, static_cast<int>(result.vertices.size()));
      if (fresh) result.vertices.push_back(points_[i]);
      number[i] = place->second;
    }
    const auto count = static_cast<std::int64_t>(points_.size());
    for (std::size_t f = 0; f < fans_.size(); ++f) {
      for (const std::int64_t corner : fans_[f])
        if (corner < 0 || corner >= count)
          refuse_faces("face " + std::to_string(polygon_of_[f]) + " has corner " +
                       std::to_string(corner) + ", but there are only " + std::to_string(count) +
                       " vertices");
      const auto& fan = fans_[f];
      result.faces.push_back({number[static_cast<std::size_t>(fan[0])],
                              number[static_cast<std::size_t>(fan[1])],
                              number[static_cast<std::size_t>(fan[2])]});
    }
    return result;
  }

 private:
  [[noreturn]] void refuse_faces(const std::string& cause) const {
    throw MeshFailure(name_, MeshFault::bad_faces, cause);
  }

  MeshFormat format_;
  const std::string& name_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::array<std::int64_t, 3>> fans_;
  std::vector<std::size_t> polygon_of_;  ///< of each triangle
  std::size_t polygons_ = 0;
};

/// Words of a text, line by line; what follows a comment sign is skipped.
class Words {
 public:
  Words(std::string_view text, char comment) : text_(text), comment_(comment) {}

  /// Next word of this line; false at its end.
  bool in_line(std::string_view& word) {
    while (at_ < text_.size() && text_[at_] != '\n' && is_space(text_[at_])) ++at_;
    if (at_ >= text_.size() || text_[at_] == '\n') return false;
    if (comment_ != '\0' && text_[at_] == comment_) {
      skip_line();
      return false;
    }
    const std::size_t start = at_;
    while (at_ < text_.size() && !is_space(text_[at_]) &&
           (comment_ == '\0' || text_[at_] != comment_))
      ++at_;
    word = text_.substr(start, at_ - start);
    return true;
  }
  /// Next word, of this line or a later one; false at the end of the text.
  bool next(std::string_view& word) {
    while (!in_line(word)) {
      if (at_ >= text_.size()) return false;
      ++at_;
      ++line_;
    }
    return true;
  }
  /// To the end of this line.
  void skip_line() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  }
  int line() const { return line_; }

 private:
  std::string_view text_;
  char comment_;
  std::size_t at_ = 0;
  int line_ = 1;
};

Eigen::Vector3d coordinates(Words& words, const Reading& reading) {
  Eigen::Vector3d point;
  std::string_view word;
  for (int k = 0; k < 3; ++k)
    if (!words.in_line(word) || !to_number(word, point[k]))
      reading.refuse_line(words.line(), "has no three coordinates");
  return point;
}

void read_off(std::string_view content, Reading& reading) {
  Words words(content, '#');
  std::string_view word;
  if (!words.next(word)) reading.refuse("it holds nothing");
  std::string_view kind = word;
  for (const char* part : {"ST", "C", "N"})
    if (kind.substr(0, std::strlen(part)) == part) kind.remove_prefix(std::strlen(part));
  if (kind != "OFF") reading.refuse_line(words.line(), "does not begin with OFF");
  std::array<std::uint64_t, 2> counts{};
  for (std::uint64_t& count : counts)
    if (!words.next(word) || !to_number(word, count))
      reading.refuse_line(words.line(), "should hold the numbers of vertices and faces");
  words.skip_line();  // the number of edges
  // No vertex is shorter than "0 0 0", no face than "3 0 1 2", each with the end of its line.
  const std::uint64_t length = content.size() + 1;
  if (counts[0] > length / 6 || counts[1] > (length - 6 * counts[0]) / 8)
    reading.refuse("it declares " + std::to_string(counts[0]) + " vertices and " +
                   std::to_string(counts[1]) + " faces, which do not fit into its " +
                   std::to_string(content.size()) + " bytes");
  // A vertex stands in one line. Its first three numbers are read: normal, colour, texture follow.
  for (std::uint64_t i = 0; i < counts[0]; ++i) {
    if (!words.next(word)) reading.refuse("it ends before its last vertex");
    Eigen::Vector3d point;
    for (int k = 0; k < 3; ++k)
      if ((k > 0 && !words.in_line(word)) || !to_number(word, point[k]))
        reading.refuse_line(words.line(), "has no three coordinates");
    words.skip_line();
    reading.add_point(point);
  }
  std::vector<std::int64_t> corners;
  for (std::uint64_t i = 0; i < counts[1]; ++i) {
    std::uint64_t count = 0;
    if (!words.next(word)) reading.refuse("it ends before its last face");
    if (!to_number(word, count)) reading.refuse_line(words.line(), "has no number of corners");
    corners.clear();
    for (std::uint64_t k = 0; k < count; ++k) {
      std::int64_t corner = 0;
      if (!words.in_line(word) || !to_number(word, corner))
        reading.refuse_line(words.line(), "has fewer corners than it declares");
      corners.push_back(corner);
    }
    words.skip_line();
    reading.add_polygon(corners);
  }
  if (words.next(word))
    reading.refuse_line(words.line(), "follows the last of the faces that it declares");
}

void read_stl_text(std::string_view content, Reading& reading) {
  Words words(content, '\0');
  std::string_view word;
  bool in_solid = false;
  int corners = -1;  // of the facet that is being read; -1: none
  const auto follows = [&](const char* wanted) {
    if (!words.next(word) || !same_word(word, wanted))
      reading.refuse_line(words.line(), std::string("lacks the word ") + wanted);
  };
  while (words.next(word)) {
    const bool in_facet = corners >= 0;
    if (!in_solid) {
      if (!same_word(word, "solid")) reading.refuse_line(words.line(), "is outside of a solid");
      words.skip_line();
      in_solid = true;
    } else if (!in_facet && same_word(word, "endsolid")) {
      words.skip_line();
      in_solid = false;
    } else if (!in_facet && same_word(word, "facet")) {
      follows("normal");
      for (int k = 0; k < 3; ++k)
        if (!words.next(word)) reading.refuse("it ends inside a facet");
      follows("outer");
      follows("loop");
      corners = 0;
    } else if (in_facet && corners < 3 && same_word(word, "vertex")) {
      reading.add_point(coordinates(words, reading));
      ++corners;
    } else if (corners == 3 && same_word(word, "endloop")) {
      follows("endfacet");
      const auto last = static_cast<std::int64_t>(reading.points());
      reading.add_polygon({last - 3, last - 2, last - 1});
      corners = -1;
    } else {
      reading.refuse_line(words.line(), "is out of place");
    }
  }
  if (in_solid) reading.refuse("it ends before endsolid");
}

/// A number of a binary file. @param swapped its bytes stand in the other order than the machine's
template <class Number>
Number from_bytes(const char* bytes, bool swapped) {
  std::array<char, sizeof(Number)> own;
  std::copy_n(bytes, sizeof(Number), own.begin());
  if (swapped) std::reverse(own.begin(), own.end());
  Number value;
  std::memcpy(&value, own.data(), sizeof value);
  return value;
}

bool machine_is_little_endian() {
  const std::uint16_t one = 1;
  unsigned char first = 0;
  std::memcpy(&first, &one, 1);
  return first == 1;
}

constexpr std::size_t stl_header = 84;  // bytes: 80 of text and the number of facets
constexpr std::size_t stl_facet = 50;

void read_stl(std::string_view content, Reading& reading) {
  const bool swapped = !machine_is_little_endian();
  const bool long_enough = content.size() >= stl_header;
  const std::uint64_t count =
      long_enough ? from_bytes<std::uint32_t>(content.data() + 80, swapped) : 0;
  const std::uint64_t expected = stl_header + stl_facet * count;
  if (!long_enough || content.size() != expected) {
    // Binary files may begin with "solid", too, but then their length is right.
    std::string_view word;
    if (Words(content, '\0').next(word) && same_word(word, "solid"))
      return read_stl_text(content, reading);
    if (!long_enough) reading.refuse("it neither begins with solid nor has 84 bytes");
    reading.refuse("it declares " + std::to_string(count) + " facets, which take " +
                   std::to_string(expected) + " bytes, but it has " +
                   std::to_string(content.size()));
  }
  for (std::uint64_t f = 0; f < count; ++f) {
    const char* facet = content.data() + stl_header + stl_facet * f;
    for (int k = 1; k <= 3; ++k) {  // the normal comes first
      Eigen::Vector3d point;
      for (int i = 0; i < 3; ++i)
        point[i] = static_cast<double>(from_bytes<float>(facet + 12 * k + 4 * i, swapped));
      reading.add_point(point);
    }
    const auto last = static_cast<std::int64_t>(reading.points());
    reading.add_polygon({last - 3, last - 2, last - 1});
  }
}

void read_obj(std::string_view content, Reading& reading) {
  Words words(content, '#');
  std::string_view word;
  std::vector<std::int64_t> corners;
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
  while (words.next(word)) {
    if (word == "v") {
      reading.add_point(coordinates(words, reading));
    } else if (word == "f") {
      corners.clear();
      while (words.in_line(word)) {
        std::int64_t index = 0;
        if (!to_number(word.substr(0, word.find('/')), index) || index == 0 || index > most ||
            index < -most)
          reading.refuse_line(words.line(), "has a corner that is no index of a vertex");
        corners.push_back(index > 0 ? index - 1
                                    : static_cast<std::int64_t>(reading.points()) + index);
      }
      reading.add_polygon(corners);
    }
    words.skip_line();
  }
}

// ---- PLY

enum class PlyType : unsigned char { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyTypeName {
  const char* name;
  const char* other_name;
  PlyType type;
  std::size_t bytes;
};
constexpr std::array<PlyTypeName, 8> ply_types{{{"char", "int8", PlyType::int8, 1},
                                                {"uchar", "uint8", PlyType::uint8, 1},
                                                {"short", "int16", PlyType::int16, 2},
                                                {"ushort", "uint16", PlyType::uint16, 2},
                                                {"int", "int32", PlyType::int32, 4},
                                                {"uint", "uint32", PlyType::uint32, 4},
                                                {"float", "float32", PlyType::float32, 4},
                                                {"double", "float64", PlyType::float64, 8}}};

bool is_integer(PlyType type) {
  return type != PlyType::float32 && type != PlyType::float64;
}
std::size_t bytes_of(PlyType type) {
  return ply_types[static_cast<std::size_t>(type)].bytes;
}

struct PlyProperty {
  std::string name;
  PlyType type;
  bool is_list;
  PlyType count_type;  ///< of a list
};
struct PlyElement {
  std::string name;
  std::uint64_t count;
  std::vector<PlyProperty> properties;
};
struct PlyHeader {
  bool ascii = false;
  bool little_endian = false;
  std::vector<PlyElement> elements;
  std::size_t length = 0;  ///< [bytes], with the end of its last line
};

PlyHeader ply_header(std::string_view content, const Reading& reading) {
  PlyHeader header;
  bool has_format = false;
  std::size_t at = 0;
  const auto bad_line = [&](int line) { reading.refuse_line(line, "is no line of a PLY header"); };
  for (int line = 1;; ++line) {
    const std::size_t end = content.find('\n', at);
    if (end == std::string_view::npos) reading.refuse("its header has no end");
    Words words(content.substr(at, end - at), '\0');
    at = end + 1;
    std::string_view word;
    const auto type = [&] {
      if (words.in_line(word))
        for (const PlyTypeName& known : ply_types)
          if (word == known.name || word == known.other_name) return known.type;
      reading.refuse_line(line, "has a property of no known type");
    };
    if (!words.in_line(word)) continue;
    if (line == 1) {
      if (word != "ply") reading.refuse_line(line, "does not begin with ply");
    } else if (word == "comment" || word == "obj_info") {
      continue;
    } else if (word == "format") {
      if (has_format || !words.in_line(word)) bad_line(line);
      header.ascii = word == "ascii";
      header.little_endian = word == "binary_little_endian";
      has_format = true;
      if (!header.ascii && !header.little_endian && word != "binary_big_endian") bad_line(line);
    } else if (word == "element") {
      PlyElement element{};
      if (!words.in_line(word)) bad_line(line);
      element.name = word;
      if (!words.in_line(word) || !to_number(word, element.count)) bad_line(line);
      for (const PlyElement& other : header.elements)
        if (other.name == element.name)
          reading.refuse_line(line, "declares an element for the second time");
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      if (header.elements.empty()) reading.refuse_line(line, "has a property before any element");
      PlyProperty property{};
      Words ahead = words;
      property.is_list = ahead.in_line(word) && word == "list";
      if (property.is_list) {
        words = ahead;
        property.count_type = type();
        if (!is_integer(property.count_type)) bad_line(line);
      }
      property.type = type();
      if (!words.in_line(word)) bad_line(line);
      property.name = word;
      header.elements.back().properties.push_back(std::move(property));
    } else if (word == "end_header") {
      if (!has_format) reading.refuse("its header names no format");
      header.length = at;
      return header;
    } else {
      bad_line(line);
    }
  }
}

/// Numbers of the body, one after the other.
class PlyBody {
 public:
  PlyBody(std::string_view body, const PlyHeader& header, const Reading& reading)
      : body_(body),
        words_(body, '\0'),
        reading_(&reading),
        ascii_(header.ascii),
        swapped_(header.little_endian != machine_is_little_endian()) {}

  double number(PlyType type) {
    if (ascii_) {
      std::string_view word;
      double value = 0;
      if (!words_.next(word)) ends_early();
      if (!to_number(word, value)) reading_->refuse("its data hold what is no number");
      return value;
    }
    const std::size_t size = bytes_of(type);
    if (body_.size() - at_ < size) ends_early();
    const char* bytes = body_.data() + at_;
    at_ += size;
    switch (type) {
      case PlyType::int8:
        return from_bytes<std::int8_t>(bytes, swapped_);
      case PlyType::uint8:
        return from_bytes<std::uint8_t>(bytes, swapped_);
      case PlyType::int16:
        return from_bytes<std::int16_t>(bytes, swapped_);
      case PlyType::uint16:
        return from_bytes<std::uint16_t>(bytes, swapped_);
      case PlyType::int32:
        return from_bytes<std::int32_t>(bytes, swapped_);
      case PlyType::uint32:
        return from_bytes<std::uint32_t>(bytes, swapped_);
      case PlyType::float32:
        return static_cast<double>(from_bytes<float>(bytes, swapped_));
      case PlyType::float64:
        return from_bytes<double>(bytes, swapped_);
    }
    return 0;
  }
  /// Whole numbers only; those beyond 32 bits are refused.
  std::int64_t integer(PlyType type) {
    const double value = number(type);
    constexpr double largest = 4294967296.0;
    if (!(std::abs(value) < largest) || value != std::floor(value))
      reading_->refuse("its data hold a count or an index that is no whole number");
    return static_cast<std::int64_t>(value);
  }
  bool has_more() {
    std::string_view word;
    if (ascii_) return words_.next(word);
    return !std::all_of(body_.begin() + static_cast<std::ptrdiff_t>(at_), body_.end(), is_space);
  }

 private:
  [[noreturn]] void ends_early() const { reading_->refuse("it ends before its last element"); }

  std::string_view body_;
  Words words_;
  const Reading* reading_;
  bool ascii_, swapped_;
  std::size_t at_ = 0;
};

void read_ply(std::string_view content, Reading& reading) {
  const PlyHeader header = ply_header(content, reading);
  const std::string_view body = content.substr(header.length);
  bool has_points = false, has_faces = false;
  std::uint64_t left = body.size() + 1;  // the last line may lack its end
  for (const PlyElement& element : header.elements) {
    // As text a property takes a digit and a space.
    std::uint64_t least = 0;
    for (const PlyProperty& property : element.properties)
      least += header.ascii ? 2 : bytes_of(property.is_list ? property.count_type : property.type);
    if (least == 0)
      reading.refuse("its element " + std::to_string(&element - header.elements.data()) +
                     " has no properties");
    if (element.count > left / least)
      reading.refuse("it declares " + std::to_string(element.count) +
                     " items of an element, which do not fit into its " +
                     std::to_string(content.size()) + " bytes");
    left -= element.count * least;
    has_points = has_points || element.name == "vertex";
    has_faces = has_faces || element.name == "face";
  }
  if (!has_points || !has_faces) reading.refuse("it lacks the element vertex or face");

  PlyBody data(body, header, reading);
  std::vector<std::int64_t> corners;
  for (const PlyElement& element : header.elements) {
    const bool is_point = element.name == "vertex";
    std::vector<int> coordinate(element.properties.size(), -1);
    int found = 0;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      int place = -1;
      if (is_point && !property.is_list && property.name.size() == 1)
        place = static_cast<int>(std::string_view("xyz").find(property.name));
      if (element.name == "face" && property.is_list && is_integer(property.type) &&
          (property.name == "vertex_indices" || property.name == "vertex_index"))
        place = 3;
      coordinate[p] = place;
      if (place >= 0) found |= 1 << place;
    }
    if (is_point && found != 7) reading.refuse("its vertices lack a coordinate");
    if (element.name == "face" && found != 8) reading.refuse("its faces lack vertex_indices");
    for (std::uint64_t i = 0; i < element.count; ++i) {
      Eigen::Vector3d point = Eigen::Vector3d::Zero();
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (!property.is_list) {
          const double value = data.number(property.type);
          if (coordinate[p] >= 0) point[coordinate[p]] = value;
          continue;
        }
        const std::int64_t count = data.integer(property.count_type);
        if (count < 0) reading.refuse("its data hold a list of negative length");
        const bool is_polygon = coordinate[p] == 3;
        corners.clear();
        for (std::int64_t k = 0; k < count; ++k) {
          if (is_polygon)
            corners.push_back(data.integer(property.type));
          else
            data.number(property.type);
        }
        if (is_polygon) reading.add_polygon(corners);
      }
      if (is_point) reading.add_point(point);
    }
  }
  if (data.has_more()) reading.refuse("it holds more than it declares");
}

}  // namespace

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
  if (same_word(ending, "off")) return MeshFormat::off;
  if (same_word(ending, "stl")) return MeshFormat::stl;
  if (same_word(ending, "ply")) return MeshFormat::ply;
  if (same_word(ending, "obj")) return MeshFormat::obj;
  return {};
}

Triangles parse_triangles(MeshFormat format, std::string_view content, const std::string& name) {
  Reading reading(format, name);
  switch (format) {
    case MeshFormat::off:
      read_off(content, reading);
      break;
    case MeshFormat::stl:
      read_stl(content, reading);
      break;
    case MeshFormat::ply:
      read_ply(content, reading);
      break;
    case MeshFormat::obj:
      read_obj(content, reading);
      break;
  }
  return reading.triangles();
}

}  // namespace statejump::geometry
