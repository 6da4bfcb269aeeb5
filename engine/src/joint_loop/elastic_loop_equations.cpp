// SPDX-License-Identifier: GPL-3.0-or-later
#include "elastic_loop_equations.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "statejump/kernel/elastic_pair.hpp"

namespace statejump::joint_loop::detail {

using Eigen::Vector2d;

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double force_tolerance = 1e-12;
constexpr int iteration_limit = 40;

Thermal thermal(double reference, double expansion, double temperature_change) {
  return {thermal::length(reference, expansion, temperature_change), reference * expansion};
}

}  // namespace

Parameters parameters(const linkage::Linkage& model, double temperature_change) {
  Parameters p;
  p.temperature_change = temperature_change;
  const auto axial = [](const linkage::ThermalLink& link, const Thermal& length) -> Thermal {
    const double k = link.young_modulus * link.cross_section_area / length.value;
    return {k, -k * length.rate / length.value};
  };
  const linkage::ThermalLink& ab = model.link_ab;
  const linkage::ThermalLink& bc = model.link_bc;
  p.l1 = thermal(ab.stress_free_length, ab.thermal_expansion, temperature_change);
  p.l2 = thermal(bc.stress_free_length, bc.thermal_expansion, temperature_change);
  p.k1 = axial(ab, p.l1);
  p.k2 = axial(bc, p.l2);
  p.r1 = thermal(model.journal_radius, model.journal_thermal_expansion, temperature_change);
  p.r2 = thermal(model.bearing_radius, model.bearing_thermal_expansion, temperature_change);
  // The curvature of the bearing has either its physical sign or the sign printed in the paper.
  const bool internal = has(model.law.normal, kernel::laws::Trait::accepts_bulging_wall);
  const double sign = internal ? -1.0 : 1.0;
  const double sum = p.r2.value + sign * p.r1.value;
  const double root = std::sqrt(p.r1.value * p.r2.value / sum);
  const double growth = 0.5 * (p.r1.rate / p.r1.value + p.r2.rate / p.r2.value -
                               (p.r2.rate + sign * p.r1.rate) / sum);  // of the root, relative
  const kernel::ElasticPair pair =
      kernel::elastic_pair(bc.young_modulus, bc.poisson_ratio, ab.young_modulus, ab.poisson_ratio);
  const double hertz = numerics::hertz_stiffness(pair.effective_young_modulus, root);
  const double shear = numerics::mindlin_stiffness_per_root(pair.effective_shear_modulus, root);
  p.hertz = {hertz, hertz * growth};
  p.shear = {shear, shear * growth};
  return p;
}

Equations::Equations(const linkage::Linkage& model)
    : a_(model.frame_length),
      torsion_(model.torsion_stiffness),
      free_angle_(model.free_angle()),
      slide_(model) {
  const double l1 = model.link_ab.stress_free_length;
  const double l2 = model.link_bc.stress_free_length;
  length_tolerance_ = 4.0 * epsilon * (a_ + l1 + l2);
  force_rounding_ = 16.0 * epsilon * torsion_ / std::min(l1, l2);
}

bool Equations::solve(const FrictionLine& line, Equilibrium& at) const {
  Vector residual;
  Matrix jacobian;
  bool converged = false;
  Equilibrium best = at;
  for (int i = 0; i <= iteration_limit; ++i) {
    evaluate(line, at.p, at.z, residual, jacobian);
    const bool good = judge(line, residual, at);
    at.iterations = i;
    if (converged) {  // this was the additional iteration
      if (!good) at = best;
      return true;
    }
    if (!residual.allFinite()) return false;
    if (good) {
      converged = true;
      best = at;
    }
    at.z -= jacobian.partialPivLu().solve(residual);
  }
  return false;
}

Vector Equations::slipping_rate(double ratio, const Equilibrium& at) const {
  FrictionLine line;
  line.ratio = ratio;
  Vector residual;
  Matrix jacobian;
  const Parameters& p = at.p;
  const Vector& z = at.z;
  evaluate(line, p, z, residual, jacobian);
  const Vector2d n = direction(z[psi]);
  const Vector2d u2 = direction(z[th2]);
  const Vector2d u4 = direction(z[th4]);
  const double force = at.normal() * p.hertz.rate / p.hertz.value;
  const double length1 = p.l1.value + z[e1];
  const double length2 = p.l2.value + z[e2];
  const double couple1 = moment(z) - (p.r2.value + 0.5 * z[dep]) * z[ft];
  const double couple2 = (p.r1.value - 0.5 * z[dep]) * z[ft] - moment(z);
  Vector rate;  // of the residual at fixed z
  rate[axial1] = force * n.dot(u2) - p.k1.rate * z[e1];
  rate[axial2] = -force * n.dot(u4) - p.k2.rate * z[e2];
  rate[across1] = force * n.dot(across(u2)) - p.r2.rate * z[ft] / length1 -
                  couple1 * p.l1.rate / (length1 * length1);
  rate[across2] = -force * n.dot(across(u4)) + p.r1.rate * z[ft] / length2 -
                  couple2 * p.l2.rate / (length2 * length2);
  rate.segment<2>(closure_x) = p.l2.rate * u4 - p.l1.rate * u2 - (p.r2.rate - p.r1.rate) * n;
  rate[friction] = -ratio * force;
  return -jacobian.partialPivLu().solve(rate);
}

void Equations::evaluate(const FrictionLine& line, const Parameters& p, const Vector& z,
                         Vector& residual, Matrix& jacobian) const {
  const Vector2d n = direction(z[psi]);
  const Vector2d t = across(n);
  const Vector2d u2 = direction(z[th2]);
  const Vector2d v2 = across(u2);
  const Vector2d u4 = direction(z[th4]);
  const Vector2d v4 = across(u4);
  const double length1 = p.l1.value + z[e1];
  const double length2 = p.l2.value + z[e2];
  const double arm1 = p.r1.value - 0.5 * z[dep];
  const double arm2 = p.r2.value + 0.5 * z[dep];
  const double distance = p.clearance() + z[dep];
  const double normal = normal_force(p, z[dep]);
  const double normal_slope = normal_force_slope(p, z[dep]);
  const Vector2d force = normal * n - z[ft] * t;
  const Vector2d force_psi = normal * t + z[ft] * n;
  const double couple1 = moment(z) - arm2 * z[ft];
  const double couple2 = arm1 * z[ft] - moment(z);

  residual[axial1] = force.dot(u2) - p.k1.value * z[e1];
  residual[axial2] = -force.dot(u4) - p.k2.value * z[e2];
  residual[across1] = couple1 / length1 + force.dot(v2);
  residual[across2] = couple2 / length2 - force.dot(v4);
  residual.segment<2>(closure_x) = Vector2d(a_, 0.0) + length2 * u4 - length1 * u2 - distance * n;

  jacobian.setZero();
  jacobian(axial1, e1) = -p.k1.value;
  jacobian(axial1, th2) = force.dot(v2);
  jacobian(axial1, dep) = normal_slope * n.dot(u2);
  jacobian(axial1, psi) = force_psi.dot(u2);
  jacobian(axial1, ft) = -t.dot(u2);
  jacobian(axial2, e2) = -p.k2.value;
  jacobian(axial2, th4) = -force.dot(v4);
  jacobian(axial2, dep) = -normal_slope * n.dot(u4);
  jacobian(axial2, psi) = -force_psi.dot(u4);
  jacobian(axial2, ft) = t.dot(u4);
  jacobian(across1, e1) = -couple1 / (length1 * length1);
  jacobian(across1, th2) = -torsion_ / length1 - force.dot(u2);
  jacobian(across1, th4) = torsion_ / length1;
  jacobian(across1, dep) = -0.5 * z[ft] / length1 + normal_slope * n.dot(v2);
  jacobian(across1, psi) = force_psi.dot(v2);
  jacobian(across1, ft) = -arm2 / length1 - t.dot(v2);
  jacobian(across2, e2) = -couple2 / (length2 * length2);
  jacobian(across2, th2) = torsion_ / length2;
  jacobian(across2, th4) = -torsion_ / length2 + force.dot(u4);
  jacobian(across2, dep) = -0.5 * z[ft] / length2 - normal_slope * n.dot(v4);
  jacobian(across2, psi) = -force_psi.dot(v4);
  jacobian(across2, ft) = arm1 / length2 + t.dot(v4);
  jacobian.block<2, 1>(closure_x, e1) = -u2;
  jacobian.block<2, 1>(closure_x, e2) = u4;
  jacobian.block<2, 1>(closure_x, th2) = -length1 * v2;
  jacobian.block<2, 1>(closure_x, th4) = length2 * v4;
  jacobian.block<2, 1>(closure_x, dep) = -n;
  jacobian.block<2, 1>(closure_x, psi) = -distance * t;

  evaluate_friction(line, p, z, residual, jacobian);
}

void Equations::evaluate_friction(const FrictionLine& line, const Parameters& p, const Vector& z,
                                  Vector& residual, Matrix& jacobian) const {
  if (!line.sticks) {
    residual[friction] = z[ft] - line.ratio * normal_force(p, z[dep]);
    jacobian(friction, dep) = -line.ratio * normal_force_slope(p, z[dep]);
    jacobian(friction, ft) = 1.0;
    return;
  }
  const Equilibrium& from = *line.from;
  residual[friction] = slide_.arc(z) - line.arc + line.past + slide_.rest(from, p, z);
  slide_.derivative(from, p, z, jacobian.row(friction));
  if (line.partial != nullptr) {
    evaluate_partial(line, p, z, residual[friction], residual, jacobian);
    return;
  }
  if (line.compliance == TangentialCompliance::rigid) return;
  const double stiffness = tangential_stiffness(p, z[dep]);
  const double slope = 0.5 * stiffness / z[dep];
  const double before = from.stiffness();
  if (stiffness < before) {
    residual[friction] += z[ft] / stiffness - from.z[ft] / before;
    jacobian(friction, ft) += 1.0 / stiffness;
    jacobian(friction, dep) -= z[ft] / (stiffness * stiffness) * slope;
  } else {
    const double mean = 0.5 * (stiffness + before);
    residual[friction] += (z[ft] - from.z[ft]) / mean;
    jacobian(friction, ft) += 1.0 / mean;
    jacobian(friction, dep) -= (z[ft] - from.z[ft]) / (mean * mean) * 0.5 * slope;
  }
}

/// Row of partial slip: F_t minus the force of the law, divided by the stiffness at the start of
/// the step [m]. The law is piecewise linear with many kinks. Difference quotients over a millionth
/// of its scales approximate its derivatives to a millionth, which is accurate enough for Newton's
/// method.
void Equations::evaluate_partial(const FrictionLine& line, const Parameters& p, const Vector& z,
                                 double slide, Vector& residual, Matrix& jacobian) {
  constexpr double share = 1e-6;
  const PartialSlip& partial = *line.partial;
  kernel::PartialSlipMemory after;
  const auto force = [&](double depth, double moved) {
    return partial.step(p, depth, moved, after).force.a;
  };
  const double unit = 1.0 / line.from->stiffness();
  const double small_slide = share * partial.friction_coefficient * normal_force(p, z[dep]) /
                             tangential_stiffness(p, z[dep]);
  const double small_depth = share * z[dep];
  const double by_slide =
      (force(z[dep], slide + small_slide) - force(z[dep], slide - small_slide)) /
      (2.0 * small_slide);
  const double by_depth =
      (force(z[dep] + small_depth, slide) - force(z[dep] - small_depth, slide)) /
      (2.0 * small_depth);
  residual[friction] = unit * (z[ft] + force(z[dep], slide));
  jacobian.row(friction) *= unit * by_slide;
  jacobian(friction, dep) += unit * by_depth;
  jacobian(friction, ft) += unit;
}

bool Equations::judge(const FrictionLine& line, const Vector& residual, Equilibrium& at) const {
  const double joint_force = std::hypot(at.normal(), at.z[ft]);
  double force = residual.head<4>().cwiseAbs().maxCoeff();
  double length = residual.segment<2>(closure_x).cwiseAbs().maxCoeff();
  double& last = line.sticks ? length : force;
  last = std::max(last, std::abs(residual[friction]));
  at.force_residual = force / joint_force;
  at.closure_residual = length;
  return force <= force_tolerance * joint_force + force_rounding_ && length <= length_tolerance_;
}

}  // namespace statejump::joint_loop::detail
