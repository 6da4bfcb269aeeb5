// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace statejump::truss::detail {

/// Step sizes through one span of time, each a half of the next longer one, so that factors of a
/// length may be kept. A step begins at a multiple of its length, so that steps end at the end of
/// the span.
class DyadicStepSize {
 public:
  /// @param level halvings of the span for the first step; @param most_halvings at which the
  /// shortest step is
  DyadicStepSize(int level, int most_halvings);

  /// Share of the span where the next step ends.
  double to() const;
  /// Length of the next step as a share of the span.
  double length() const;
  int level() const { return level_; }
  bool is_shortest() const { return level_ == most_; }
  bool done() const { return at_ == whole(); }

  /// Goes on; to a step of twice the length where that is possible and wanted.
  void accept(bool longer);
  /// Halves the next step so often, as far as possible.
  void shorten(int halvings);

 private:
  // Multiples of the shortest step.
  long whole() const { return 1L << most_; }
  long step() const { return 1L << (most_ - level_); }

  int most_;
  int level_;
  long at_ = 0;
};

}  // namespace statejump::truss::detail
