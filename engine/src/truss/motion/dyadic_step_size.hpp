// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace statejump::truss::detail {

/// Step sizes within a time span. Each is half of the next larger size, so that factors can be
/// reused. Every step starts at a multiple of its length, so that the last step ends at the end of
/// the span.
class DyadicStepSize {
 public:
  /// @param level halvings of the span that give the first step
  /// @param most_halvings halvings of the span that give the shortest step
  DyadicStepSize(int level, int most_halvings);

  /// End of the next step as a fraction of the span.
  double to() const;
  /// Length of the next step as a fraction of the span.
  double length() const;
  int level() const { return level_; }
  bool is_shortest() const { return level_ == most_; }
  bool done() const { return at_ == whole(); }

  /// Accepts the step. The next step is twice as long if `longer` is set and the time is a multiple
  /// of the doubled length.
  void accept(bool longer);
  /// Halves the next step this many times, but not below the shortest step.
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
