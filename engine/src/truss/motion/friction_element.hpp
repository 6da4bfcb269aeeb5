// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "contacts.hpp"

namespace statejump::truss::detail {

/// Dry friction with limit b in series with a spring, and a dashpot, along a constant direction d.
/// At slip rate u = dᵀv its force is λ = e + c u while |λ| < b; the spring force e follows e' = k
/// u. Otherwise λ = ±b, and e continues to change until it reaches ±b. Between changes of status
/// the element is smooth.
struct FrictionElement {
  enum class Status : signed char { slip_minus = -1, stick = 0, slip_plus = 1 };

  int joint = 0;
  int column = 0;                 ///< Column of its force among the unknowns of the truss.
  double bound = 0.0;             ///< b [N]
  double stiffness = 0.0;         ///< k [N/m]
  double damping = 0.0;           ///< c [N s/m]
  std::array<int, 6> rows{};      ///< Free displacements on which it acts.
  std::array<double, 6> along{};  ///< Entries of d for these displacements.
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
  /// Spring force e after a slide since the start of the step that has not reversed [N].
  double spring(double slide) const;
  /// λ [N]
  double force(double slide, double speed) const;
  /// Force margin of the present status [N]: if it is negative, the status has ended. For a slip
  /// with the spring at its limit, it is the force by which the spring would unload if the contact
  /// stuck for a step of length h at this slip rate.
  double margin(double slide, double speed, double h) const;
  /// Rate of margin() at the end of a status [N/s]. For a slip that reverses, it is the rate of the
  /// slip rate [m/s²].
  /// @param rise rate of the slip rate [m/s²]
  double margin_rate(double slide, double speed, double rise) const;
  /// @param level margin below which the status has ended: 0, or the margin at the start of the
  /// step if that is negative (positions have the error of the step)
  bool has_ended(double slide, double speed, double h, double level) const {
    return margin(slide, speed, h) < level - allowance * bound;
  }
  /// Change of force until the status ends [N]. For a slip about to reverse, it is the force by
  /// which the spring would unload until then if the contact stuck.
  /// @param rise rate of the slip rate [m/s²]
  double shortfall(double slide, double speed, double rise) const;
  /// Switches to the status that follows.
  void turn(double slide, double speed);
  /// Tolerance of the margin, as a fraction of b, so that rounding does not end a status.
  static constexpr double allowance = 1e-9;
};

/// The slide in a step: a polynomial through its values and rates at the start and the stages.
class SlipTrajectory {
 public:
  /// Adds a point [s; m; m/s].
  void add(double time, double slide, double speed);
  double slide_at(double time) const;
  double speed_at(double time) const;

 private:
  std::vector<double> time_;    ///< Every point twice.
  std::vector<double> factor_;  ///< Coefficients of Newton's form.
  std::vector<double> last_;    ///< Last diagonal of divided differences.
};

/// Time since the start of a step of length h at which the status of a contact ends [s]; empty if
/// the status does not end in the step.
/// @param level see FrictionElement::has_ended()
std::optional<double> end_of_status(const FrictionElement& element, const SlipTrajectory& way,
                                    double h, double level);

/// Friction elements that represent all contacts of a truss. Empty if a contact is of another type
/// or sticks rigidly.
std::optional<std::vector<FrictionElement>> friction_elements(const System& system,
                                                              const Contacts& contacts);

}  // namespace statejump::truss::detail
