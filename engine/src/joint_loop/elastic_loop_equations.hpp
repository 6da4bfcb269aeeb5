// SPDX-License-Identifier: GPL-3.0-or-later
// Equilibrium of the elastic loop at one temperature: unknowns, equations, Newton's method. For
// elastic_loop() only; not installed.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "numerics/hertz.hpp"
#include "statejump/joint_loop/elastic_loop.hpp"
#include "statejump/kernel/partial_slip.hpp"

namespace statejump::joint_loop::detail {

/// Unknowns, in this order. The equations follow the order in the documentation of elastic_loop(),
/// beginning with the axial equations.
enum Unknown { e1, e2, th2, th4, dep, psi, ft };
enum Equation { axial1, axial2, across1, across2, closure_x, closure_y, friction };
using Vector = Eigen::Matrix<double, 7, 1>;
using Matrix = Eigen::Matrix<double, 7, 7>;

/// A quantity that depends on ΔT, and its derivative [per K].
struct Thermal {
  double value, rate;
};

/// The model at one temperature.
struct Parameters {
  double temperature_change;
  Thermal l1, l2, k1, k2, r1, r2;
  Thermal hertz;  ///< F_N/δ^1.5 [N/m^1.5]
  Thermal shear;  ///< k_t/sqrt(δ) [N/m^1.5]
  double clearance() const { return r2.value - r1.value; }
};

Parameters parameters(const linkage::Linkage& model, double temperature_change);

inline Eigen::Vector2d direction(double angle) {
  return {std::cos(angle), std::sin(angle)};
}
inline Eigen::Vector2d across(const Eigen::Vector2d& u) {
  return {-u.y(), u.x()};
}

/// Hertz's normal force. For a negative depth it is the mirrored tension, which only serves root
/// finding and indicates loss of contact.
inline double normal_force(const Parameters& p, double depth) {
  return numerics::hertz_force(p.hertz.value, depth);
}
/// dF_N/dδ [N/m].
inline double normal_force_slope(const Parameters& p, double depth) {
  return numerics::hertz_slope(p.hertz.value, depth);
}
inline double tangential_stiffness(const Parameters& p, double depth) {
  return numerics::mindlin_stiffness(p.shear.value, depth);
}

/// Solution at one temperature.
struct Equilibrium {
  Parameters p;
  Vector z;
  double force_residual = 0.0;    ///< largest, over the joint force
  double closure_residual = 0.0;  ///< largest [m]
  int iterations = 0;
  double normal() const { return normal_force(p, z[dep]); }
  double stiffness() const { return tangential_stiffness(p, z[dep]); }
};

/// Slide of journal relative to bearing, ∫ (R2 − R1 + δ) dψ + (R1 − δ/2) dθ4 − (R2 + δ/2) dθ2, with
/// its derivatives at the end. The part with the radii at ΔT = 0 is a function of the state and
/// accumulates no rounding. The small remainder uses the trapezoidal rule.
class Slide {
 public:
  explicit Slide(const linkage::Linkage& model)
      : r1_(model.journal_radius), r2_(model.bearing_radius) {}

  double arc(const Vector& z) const { return (r2_ - r1_) * z[psi] + r1_ * z[th4] - r2_ * z[th2]; }

  double rest(const Equilibrium& from, const Parameters& p, const Vector& z) const {
    const Weights w = mean(from, p, z);
    return w.psi * (z[psi] - from.z[psi]) + w.th4 * (z[th4] - from.z[th4]) -
           w.th2 * (z[th2] - from.z[th2]);
  }

  /// Derivative of arc + rest with respect to z.
  void derivative(const Equilibrium& from, const Parameters& p, const Vector& z,
                  Matrix::RowXpr row) const {
    const Weights w = mean(from, p, z);
    row[psi] += r2_ - r1_ + w.psi;
    row[th4] += r1_ + w.th4;
    row[th2] -= r2_ + w.th2;
    row[dep] += 0.5 * (z[psi] - from.z[psi]) - 0.25 * (z[th4] - from.z[th4] + z[th2] - from.z[th2]);
  }

  /// Rate of the slide, exact.
  double rate(const Equilibrium& at, const Vector& z_rate) const {
    const Weights w = weights(at.p, at.z);
    return (r2_ - r1_ + w.psi) * z_rate[psi] + (r1_ + w.th4) * z_rate[th4] -
           (r2_ + w.th2) * z_rate[th2];
  }

 private:
  struct Weights {
    double psi, th4, th2;
  };
  /// Contribution beyond the radii at ΔT = 0.
  Weights weights(const Parameters& p, const Vector& z) const {
    const double grow1 = p.r1.value - r1_;
    const double grow2 = p.r2.value - r2_;
    return {grow2 - grow1 + z[dep], grow1 - 0.5 * z[dep], grow2 + 0.5 * z[dep]};
  }
  Weights mean(const Equilibrium& from, const Parameters& p, const Vector& z) const {
    const Weights a = weights(from.p, from.z);
    const Weights b = weights(p, z);
    return {0.5 * (a.psi + b.psi), 0.5 * (a.th4 + b.th4), 0.5 * (a.th2 + b.th2)};
  }
  double r1_, r2_;
};

/// Partial slip in one step: the tangential force as a function of slide and depth.
struct PartialSlip {
  double friction_coefficient = 0.0;
  kernel::PartialSlipMemory memory;  ///< at the start of the step

  kernel::PartialSlipResponse step(const Parameters& p, double depth, double slide,
                                   kernel::PartialSlipMemory& after) const {
    after = memory;
    return kernel::partial_slip_step(tangential_stiffness(p, depth),
                                     friction_coefficient * normal_force(p, depth), {slide, 0.0},
                                     after);
  }
};

/// Equation of friction: either F_t = ratio F_N, or no slip since the state `from`, or partial slip
/// since that state.
struct FrictionLine {
  bool sticks = false;
  double ratio = 0.0;
  TangentialCompliance compliance = TangentialCompliance::rigid;
  const Equilibrium* from = nullptr;  ///< start of the step
  double arc = 0.0;                   ///< Slide::arc() at zero slide
  double past = 0.0;                  ///< Slide::rest() from that state to `from` [m]
  const PartialSlip* partial = nullptr;
};

class Equations {
 public:
  explicit Equations(const linkage::Linkage& model);

  /// Whether the contact force exceeds rounding. At a hundred times that rounding, its direction
  /// has an error of one percent.
  bool touches(const Equilibrium& at) const { return at.normal() > 100.0 * force_rounding_; }

  const Slide& slide() const { return slide_; }
  double moment(const Vector& z) const { return torsion_ * (z[th4] - z[th2] - free_angle_); }

  /// Newton's method from at.z; true when converged.
  bool solve(const FrictionLine& line, Equilibrium& at) const;

  /// dz/dΔT while F_t = ratio F_N.
  Vector slipping_rate(double ratio, const Equilibrium& at) const;

 private:
  void evaluate(const FrictionLine& line, const Parameters& p, const Vector& z, Vector& residual,
                Matrix& jacobian) const;
  /// Writes the equation of friction only. Other entries of its row must be 0.
  void evaluate_friction(const FrictionLine& line, const Parameters& p, const Vector& z,
                         Vector& residual, Matrix& jacobian) const;
  static void evaluate_partial(const FrictionLine& line, const Parameters& p, const Vector& z,
                               double slide, Vector& residual, Matrix& jacobian);
  bool judge(const FrictionLine& line, const Vector& residual, Equilibrium& at) const;

  double a_, torsion_, free_angle_;
  Slide slide_;
  double length_tolerance_, force_rounding_;
};

}  // namespace statejump::joint_loop::detail
