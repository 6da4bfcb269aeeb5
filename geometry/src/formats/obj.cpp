// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "words.hpp"

namespace statejump::geometry::formats {

void read_obj(std::string_view content, Reading& reading) {
  Words words(content, '#', true);
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
          reading.refuse_line(words.line(), MeshReason::corner_no_index);
        corners.push_back(index > 0 ? index - 1
                                    : static_cast<std::int64_t>(reading.points()) + index);
      }
      reading.add_polygon(corners);
    }
    words.skip_line();
  }
}

}  // namespace statejump::geometry::formats
