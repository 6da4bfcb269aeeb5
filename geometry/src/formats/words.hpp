// SPDX-License-Identifier: GPL-3.0-or-later
// Splits a text into words and numbers.
#pragma once

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string_view>

#include "reading.hpp"

namespace statejump::geometry::formats {

inline bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

inline bool same_word(std::string_view word, std::string_view lower_case) {
  return word.size() == lower_case.size() &&
         std::equal(word.begin(), word.end(), lower_case.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) == b;
         });
}

/// Converts a whole word to a correctly rounded number; also accepts "nan" and "inf".
template <class Number>
inline bool to_number(std::string_view word, Number& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size();
}

/// Words of a text, line by line; comments are skipped.
class Words {
 public:
  /// @param goes_on whether a backslash at the end of a line continues this line on the next one
  Words(std::string_view text, char comment, bool goes_on = false)
      : text_(text), comment_(comment), goes_on_(goes_on) {}

  /// Next word of this line; false at its end.
  bool in_line(std::string_view& word) {
    while (at_ < text_.size() &&
           (join() || (text_[at_] != '\n' && is_space(text_[at_]) && ++at_ > 0))) {
    }
    if (at_ >= text_.size() || text_[at_] == '\n') return false;
    if (comment_ != '\0' && text_[at_] == comment_) {
      // A backslash does not continue a comment, because names of folders may end with a backslash.
      at_ = std::min(text_.find('\n', at_), text_.size());
      return false;
    }
    const std::size_t start = at_;
    while (at_ < text_.size() && !is_space(text_[at_]) && joint() == 0 &&
           (comment_ == '\0' || text_[at_] != comment_))
      ++at_;
    word = text_.substr(start, at_ - start);
    return true;
  }
  /// Reads the next word, from this line or a later one. Returns false at the end of the text.
  bool next(std::string_view& word) {
    while (!in_line(word)) {
      if (at_ >= text_.size()) return false;
      ++at_;
      ++line_;
    }
    return true;
  }
  /// Skips the rest of this line.
  void skip_line() {
    while (at_ < text_.size() && (join() || (text_[at_] != '\n' && ++at_ > 0))) {
    }
  }
  int line() const { return line_; }

 private:
  /// Length of a backslash followed by a line end at the current position; 0 if there is none.
  std::size_t joint() const {
    if (!goes_on_ || text_[at_] != '\\') return 0;
    const std::string_view rest = text_.substr(at_ + 1, 2);
    return rest.substr(0, 1) == "\n" ? 2 : rest == "\r\n" ? 3 : 0;
  }
  /// Skips such a continuation; false if there is none.
  bool join() {
    const std::size_t length = joint();
    at_ += length;
    if (length > 0) ++line_;
    return length > 0;
  }

  std::string_view text_;
  char comment_;
  bool goes_on_;
  std::size_t at_ = 0;
  int line_ = 1;
};

inline Eigen::Vector3d coordinates(Words& words, const Reading& reading) {
  Eigen::Vector3d point;
  std::string_view word;
  for (int k = 0; k < 3; ++k)
    if (!words.in_line(word) || !to_number(word, point[k]))
      reading.refuse_line(words.line(), MeshReason::line_without_coordinates);
  return point;
}

}  // namespace statejump::geometry::formats
