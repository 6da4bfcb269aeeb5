// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace statejump::truss {

/// Elastic moment of a hinge over its rotation, from a table, for example of a tape spring.
///
/// **Law.** Between two points the moment is the cubic with the given moments and slopes. With the
/// slopes of Fritsch and Carlson [1] it is monotone there, so that peaks are those of the table.
/// Beyond the table it continues as a straight line. It need not be monotone: where the slope is
/// negative, the hinge may snap.
///
/// [1] F. N. Fritsch, R. E. Carlson, SIAM J. Numer. Anal. 17 (1980) 238-246.
class MomentCurve {
 public:
  /// @param angle [rad], two or more, increasing; @param moment [N m]; @param slope [N m/rad]
  /// @throws std::invalid_argument
  MomentCurve(std::vector<double> angle, std::vector<double> moment, std::vector<double> slope);

  struct At {
    double moment;  ///< [N m]
    double slope;   ///< [N m/rad]
    double energy;  ///< Integral of the moment from the rotation 0 [J].
  };
  At at(double rotation) const;
  /// Range of the table [rad].
  double range() const { return angle_.back() - angle_.front(); }

 private:
  /// The same with the integral from the first point.
  At from_first(double rotation) const;

  std::vector<double> angle_;
  std::vector<double> moment_;
  std::vector<double> slope_;
  std::vector<double> energy_;  ///< Integral up to every point [J].
  double at_zero_ = 0.0;        ///< Integral up to the rotation 0 [J].
};

}  // namespace statejump::truss
