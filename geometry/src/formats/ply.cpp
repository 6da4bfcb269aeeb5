// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <limits>

#include "bytes.hpp"
#include "words.hpp"

namespace statejump::geometry::formats {

namespace {

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
  PlyType count_type;  ///< only for a list
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
  std::size_t length = 0;  ///< including the end of its last line [byte]
};

PlyHeader ply_header(std::string_view content, const Reading& reading) {
  PlyHeader header;
  bool has_format = false;
  std::size_t at = 0;
  const auto bad_line = [&](int line) { reading.refuse_line(line, MeshReason::no_header_line); };
  for (int line = 1;; ++line) {
    const std::size_t end = content.find('\n', at);
    if (end == std::string_view::npos) reading.refuse(MeshReason::header_without_end);
    Words words(content.substr(at, end - at), '\0');
    at = end + 1;
    std::string_view word;
    const auto type = [&] {
      if (words.in_line(word))
        for (const PlyTypeName& known : ply_types)
          if (word == known.name || word == known.other_name) return known.type;
      reading.refuse_line(line, MeshReason::unknown_property_type);
    };
    if (!words.in_line(word)) continue;
    if (line == 1) {
      if (word != "ply") reading.refuse_line(line, MeshReason::wrong_first_word, "ply");
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
        if (other.name == element.name) reading.refuse_line(line, MeshReason::element_twice);
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      if (header.elements.empty()) reading.refuse_line(line, MeshReason::property_before_element);
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
      if (!has_format) reading.refuse(MeshReason::header_without_format);
      header.length = at;
      return header;
    } else {
      bad_line(line);
    }
  }
}

/// Reads the numbers of the body in sequence.
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
      if (!to_number(word, value)) reading_->refuse(MeshReason::no_number);
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
  /// Reads the next number, which must be an integer of at most 32 bits.
  std::int64_t integer(PlyType type) {
    const double value = number(type);
    constexpr double largest = 4294967296.0;
    if (!(std::abs(value) < largest) || value != std::floor(value))
      reading_->refuse(MeshReason::no_whole_number);
    return static_cast<std::int64_t>(value);
  }
  bool has_more() {
    std::string_view word;
    if (ascii_) return words_.next(word);
    return !std::all_of(body_.begin() + static_cast<std::ptrdiff_t>(at_), body_.end(), is_space);
  }

 private:
  [[noreturn]] void ends_early() const { reading_->refuse(MeshReason::ends_before_element); }

  std::string_view body_;
  Words words_;
  const Reading* reading_;
  bool ascii_, swapped_;
  std::size_t at_ = 0;
};

/// Rejects counts that exceed the size of the file, and files without vertices or faces.
void check_elements(const PlyHeader& header, std::string_view content, const Reading& reading) {
  bool has_points = false, has_faces = false;
  std::uint64_t left = content.size() - header.length + 1;  // the last line end may be missing
  for (const PlyElement& element : header.elements) {
    // In text format, each number takes at least two bytes: a digit and a space.
    std::uint64_t least = 0;
    for (const PlyProperty& property : element.properties)
      least += header.ascii ? 2 : bytes_of(property.is_list ? property.count_type : property.type);
    if (least == 0 && element.count > 0)
      reading.refuse(MeshReason::element_without_properties,
                     {{"element", &element - header.elements.data()}});
    if (least > 0 && element.count > left / least)
      reading.refuse(MeshReason::items_beyond_file,
                     {{"items", element.count}, {"bytes", content.size()}});
    left -= element.count * least;
    has_points = has_points || element.name == "vertex";
    has_faces = has_faces || element.name == "face" || element.name == "tristrips";
  }
  if (!has_points || !has_faces) reading.refuse(MeshReason::element_missing);
}

/// Adds the triangles of consecutive strips. The index -1 ends a strip; every second triangle of a
/// strip is reversed.
void add_strips(const std::vector<std::int64_t>& corners, Reading& reading) {
  std::size_t start = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (corners[k] == -1) start = k + 1;
    if (k < start + 2) continue;
    const bool turned = (k - start) % 2 == 1;
    reading.add_polygon(
        {corners[turned ? k - 1 : k - 2], corners[turned ? k - 2 : k - 1], corners[k]});
  }
}

}  // namespace

void read_ply(std::string_view content, Reading& reading) {
  const PlyHeader header = ply_header(content, reading);
  const std::string_view body = content.substr(header.length);
  check_elements(header, content, reading);

  PlyBody data(body, header, reading);
  std::vector<std::int64_t> corners;
  for (const PlyElement& element : header.elements) {
    const bool is_point = element.name == "vertex";
    const bool is_strips = element.name == "tristrips";
    const bool is_face = element.name == "face" || is_strips;
    std::vector<int> coordinate(element.properties.size(), -1);
    int found = 0;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      int place = -1;
      if (is_point && !property.is_list && property.name.size() == 1)
        place = static_cast<int>(std::string_view("xyz").find(property.name));
      if (is_face && property.is_list && is_integer(property.type) &&
          (property.name == "vertex_indices" || property.name == "vertex_index"))
        place = 3;
      coordinate[p] = place;
      if (place >= 0) found |= 1 << place;
    }
    if (is_point && found != 7) reading.refuse(MeshReason::coordinate_missing);
    for (std::size_t p = 0; is_point && p < coordinate.size(); ++p)
      if (coordinate[p] >= 0 && element.properties[p].type == PlyType::float32)
        reading.has_floats();
    if (is_face && found != 8 && element.count > 0)
      reading.refuse(MeshReason::vertex_indices_missing);
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
        if (count < 0) reading.refuse(MeshReason::list_of_negative_length);
        const bool is_polygon = coordinate[p] == 3;
        corners.clear();
        for (std::int64_t k = 0; k < count; ++k) {
          if (is_polygon)
            corners.push_back(data.integer(property.type));
          else
            data.number(property.type);
        }
        if (is_polygon && is_strips) add_strips(corners, reading);
        if (is_polygon && !is_strips) reading.add_polygon(corners);
      }
      if (is_point) reading.add_point(point);
    }
  }
  if (data.has_more()) reading.refuse(MeshReason::more_than_declared);
}

}  // namespace statejump::geometry::formats
