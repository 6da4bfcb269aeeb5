// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cstring>

#include "words.hpp"

namespace statejump::geometry::formats {

void read_off(std::string_view content, Reading& reading) {
  Words words(content, '#');
  std::string_view word;
  if (!words.next(word)) reading.refuse(MeshReason::nothing_held);
  std::string_view kind = word;
  for (const char* part : {"ST", "C", "N"})
    if (kind.substr(0, std::strlen(part)) == part) kind.remove_prefix(std::strlen(part));
  std::array<std::uint64_t, 2> counts{};
  // Geomview accepts files that do not begin with OFF. Some collections write no space after it:
  // OFF8 6 12.
  bool has_count = to_number(kind, counts[0]);
  if (!has_count && kind.substr(0, 3) != "OFF")
    reading.refuse_line(words.line(), MeshReason::wrong_first_word, "OFF");
  if (!has_count) kind.remove_prefix(3);
  has_count = has_count || to_number(kind, counts[0]);
  if (!has_count && !kind.empty())
    reading.refuse_line(words.line(), MeshReason::wrong_first_word, "OFF");
  for (std::size_t k = has_count ? 1 : 0; k < counts.size(); ++k) {
    if (!words.next(word)) word = {};
    if (word == "BINARY") reading.refuse(MeshReason::binary_off);
    if (!to_number(word, counts[k]))
      reading.refuse_line(words.line(), MeshReason::line_without_counts);
  }
  words.skip_line();  // the number of edges
  // The shortest line of a vertex is "0 0 0", that of a face "3 0 1 2": 6 and 8 bytes with line
  // ends.
  const std::uint64_t length = content.size() + 1;
  if (counts[0] > length / 6 || counts[1] > (length - 6 * counts[0]) / 8)
    reading.refuse(MeshReason::counts_beyond_file,
                   {{"vertices", counts[0]}, {"faces", counts[1]}, {"bytes", content.size()}});
  // Each line contains one vertex. Normal, colour or texture may follow its three coordinates.
  for (std::uint64_t i = 0; i < counts[0]; ++i) {
    if (!words.next(word)) reading.refuse(MeshReason::ends_before_vertex);
    Eigen::Vector3d point;
    for (int k = 0; k < 3; ++k)
      if ((k > 0 && !words.in_line(word)) || !to_number(word, point[k]))
        reading.refuse_line(words.line(), MeshReason::line_without_coordinates);
    words.skip_line();
    reading.add_point(point);
  }
  std::vector<std::int64_t> corners;
  for (std::uint64_t i = 0; i < counts[1]; ++i) {
    std::uint64_t count = 0;
    if (!words.next(word)) reading.refuse(MeshReason::ends_before_face);
    if (!to_number(word, count))
      reading.refuse_line(words.line(), MeshReason::line_without_corner_count);
    corners.clear();
    for (std::uint64_t k = 0; k < count; ++k) {
      std::int64_t corner = 0;
      if (!words.in_line(word) || !to_number(word, corner))
        reading.refuse_line(words.line(), MeshReason::line_of_fewer_corners);
      corners.push_back(corner);
    }
    words.skip_line();
    reading.add_polygon(corners);
  }
  if (words.next(word)) reading.refuse_line(words.line(), MeshReason::line_after_last_face);
}

}  // namespace statejump::geometry::formats
