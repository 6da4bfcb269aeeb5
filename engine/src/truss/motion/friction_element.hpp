// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "contacts.hpp"

namespace statejump::truss::detail {

/// Dry friction of a given bound b in series with a spring, along one constant direction d. At a
/// slip s and a speed u = dᵀv its force is λ = e + c u, e' = k u, while |λ| < b, else ±b; the
/// spring then goes on to ±b itself. Between changes of its status it is smooth.
struct FrictionElement {
  enum class Status : signed char { slip_minus = -1, stick = 0, slip_plus = 1 };

  int joint = 0;
  int column = 0;                 ///< Of its force among the unknowns of the truss.
  double bound = 0.0;             ///< b [N]
  double stiffness = 0.0;         ///< k [N/m]
  double damping = 0.0;           ///< c [N s/m]
  std::array<int, 6> rows{};      ///< Free displacements that it reaches.
  std::array<double, 6> along{};  ///< d there.
  std::size_t count = 0;

  Status status = Status::stick;
  double elastic = 0.0;  ///< e at the start of the step [N].

  double sign() const { return static_cast<double>(status); }
  /// d times a vector of free displacements.
  template <class Column>
  double seen(const Column& of) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) sum += along[i] * of[rows[i]];
    return sum;
  }
  /// e after a slide from the start of the step that does not turn [N].
  double spring(double slide) const;
  /// λ [N]
  double force(double slide, double speed) const;
  /// How far the status is from its end [N]; below 0 it is over. Of a slide whose spring is at its
  /// bound it is what the contact would lose in a step of length h at this speed, were it to stick.
  double margin(double slide, double speed, double h) const;
  /// Rate of the margin where the status ends [N/s]; of a slide that turns, of its speed [m/s²].
  /// @param rise of the speed [m/s²]
  double margin_rate(double slide, double speed, double rise) const;
  /// @param level margin from which it counts, 0 or what the step began with below it: places
  /// between the ends of a step are known to its error only
  bool has_ended(double slide, double speed, double h, double level) const {
    return margin(slide, speed, h) < level - allowance * bound;
  }
  /// What its force is short of where its status ends [N]: of a slide that is about to turn, what
  /// it would gain until then, were it to stick. @param rise of the speed [m/s²]
  double shortfall(double slide, double speed, double rise) const;
  /// Goes to the status that follows on the one that has ended.
  void turn(double slide, double speed);
  /// Share of b that counts as none: rounding does not end a status.
  static constexpr double allowance = 1e-9;
};

/// A slide through a step: the polynomial through its values and rates at the start and the stages.
class SlipTrajectory {
 public:
  /// Of one place more [s; m; m/s].
  void add(double time, double slide, double speed);
  double slide_at(double time) const;
  double speed_at(double time) const;

 private:
  std::vector<double> time_;    ///< Every one twice.
  std::vector<double> factor_;  ///< Of Newton's form.
  std::vector<double> last_;    ///< Its last diagonal.
};

/// Time since the start of a step of length h at which the status of a contact ends [s]; none if it
/// lasts. @param level see FrictionElement::has_ended()
std::optional<double> end_of_status(const FrictionElement& element, const SlipTrajectory& way,
                                    double h, double level);

/// Friction elements of all contacts of a truss; none if it has contacts of another kind, or that
/// stick rigidly.
std::optional<std::vector<FrictionElement>> friction_elements(const System& system,
                                                              const Contacts& contacts);

}  // namespace statejump::truss::detail
