// SPDX-License-Identifier: GPL-3.0-or-later
#include "bytes.hpp"
#include "words.hpp"

namespace statejump::geometry::formats {

namespace {

void read_stl_text(std::string_view content, Reading& reading) {
  Words words(content, '\0');
  std::string_view word;
  bool in_solid = false;
  int corners = -1;  // of the current facet; -1: outside a facet
  const auto follows = [&](const char* wanted) {
    if (!words.next(word) || !same_word(word, wanted))
      reading.refuse_line(words.line(), MeshReason::line_lacks_word, wanted);
  };
  while (words.next(word)) {
    const bool in_facet = corners >= 0;
    if (!in_solid) {
      if (!same_word(word, "solid"))
        reading.refuse_line(words.line(), MeshReason::line_outside_solid);
      words.skip_line();
      in_solid = true;
    } else if (!in_facet && same_word(word, "endsolid")) {
      words.skip_line();
      in_solid = false;
    } else if (!in_facet && same_word(word, "facet")) {
      follows("normal");
      for (int k = 0; k < 3; ++k)
        if (!words.next(word)) reading.refuse(MeshReason::ends_inside_facet);
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
      reading.refuse_line(words.line(), MeshReason::line_out_of_place);
    }
  }
  if (in_solid) reading.refuse(MeshReason::ends_before_endsolid);
}

constexpr std::size_t stl_header = 84;  // [byte]: 80 of text and 4 with the number of facets
constexpr std::size_t stl_facet = 50;

/// Offset of each facet. The last two bytes of a facet are the number of attribute bytes that
/// follow. Many programs store a colour in them, so they only count if the file is longer than its
/// facets.
std::vector<std::size_t> facets_of(std::string_view content, std::uint64_t count, bool swapped) {
  const bool has_attributes = content.size() > stl_header + stl_facet * count;
  std::vector<std::size_t> starts;
  std::size_t at = stl_header;
  for (std::uint64_t f = 0; f < count && at + stl_facet <= content.size(); ++f) {
    starts.push_back(at);
    at += stl_facet;
    if (has_attributes) at += from_bytes<std::uint16_t>(content.data() + at - 2, swapped);
  }
  if (starts.size() == count && at == content.size()) return starts;
  return {};
}

}  // namespace

void read_stl(std::string_view content, Reading& reading) {
  reading.has_floats();
  const bool swapped = !machine_is_little_endian();
  const bool long_enough = content.size() >= stl_header;
  const std::uint64_t count =
      long_enough ? from_bytes<std::uint32_t>(content.data() + 80, swapped) : 0;
  const std::uint64_t expected = stl_header + stl_facet * count;
  const std::vector<std::size_t> facets =
      long_enough ? facets_of(content, count, swapped) : std::vector<std::size_t>{};
  if (!long_enough || facets.size() != count) {
    // A file that begins with "solid" is text, unless its length is that of a binary file.
    std::string_view word;
    if (Words(content, '\0').next(word) && same_word(word, "solid"))
      return read_stl_text(content, reading);
    if (!long_enough) reading.refuse(MeshReason::neither_text_nor_binary);
    reading.refuse(MeshReason::facets_of_other_length,
                   {{"facets", count}, {"needed_bytes", expected}, {"bytes", content.size()}});
  }
  for (const std::size_t start : facets) {
    const char* facet = content.data() + start;
    for (int k = 1; k <= 3; ++k) {  // k = 0 is the normal
      Eigen::Vector3d point;
      for (int i = 0; i < 3; ++i)
        point[i] = static_cast<double>(from_bytes<float>(facet + 12 * k + 4 * i, swapped));
      reading.add_point(point);
    }
    const auto last = static_cast<std::int64_t>(reading.points());
    reading.add_polygon({last - 3, last - 2, last - 1});
  }
}

}  // namespace statejump::geometry::formats
