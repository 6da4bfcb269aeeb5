// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace statejump::truss::detail {

/// Step sizes within a time span, each half of the next longer one, so that factors of a length can
/// be reused. A step starts at a multiple of its length, so that the last step ends at the end of
/// the span.
class DyadicStepSize {
 public:
  /// @param level halvings of the span for the first step
  /// @param most_halvings halvings of the span for the shortest step
  DyadicStepSize(int level, int most_halvings);

  /// End of the next step as a fraction of the span.
  double to() const;
  /// Length of the next step as a fraction of the span.
  double length() const;
  int level() const { return level_; }
  bool is_shortest() const { return level_ == most_; }
  bool done() const { return at_ == whole(); }

  /// Accepts the step. The next one is twice as long if `longer` is set and the time is a multiple
  /// of that length.
  void accept(bool longer);
  /// Halves the next step this many times, down to the shortest step.
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
