// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/elastic_loop.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump {

using Eigen::Vector2d;
using kernel::require;

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double force_tolerance = 1e-12;
constexpr int iteration_limit = 40;
constexpr int halving_limit = 40;
/// Part of μ F_N by which F_t may miss the limit and count as at it: above the errors of Newton's
/// criterion and of roots, so that a path which only grazes the limit does not slip.
constexpr double limit_rounding = 1e-10;

/// Unknowns, in this order; the equations are in that of elastic_loop()'s documentation with the
/// axial ones first.
enum Unknown { e1, e2, th2, th4, dep, psi, ft };
enum Equation { axial1, axial2, across1, across2, closure_x, closure_y, friction };
using Vector = Eigen::Matrix<double, 7, 1>;
using Matrix = Eigen::Matrix<double, 7, 7>;

/// Refuses a law of the catalogue that the equations here do not have.
void require_law(bool holds, const char* field, const kernel::laws::LawInfo& info,
                 const char* allowed) {
  if (holds) return;
  throw std::invalid_argument(std::string(field) + " = '" + info.name + "', allowed is " + allowed);
}

void validate_laws(const Linkage& model) {
  const kernel::laws::NormalLaw& normal = model.law.normal;
  require_law(std::holds_alternative<kernel::laws::HertzInternal>(normal) ||
                  std::holds_alternative<kernel::laws::HertzPaper>(normal),
              "normal", law_info(normal), "hertz_internal or hertz_paper in the elastic loop");
  const kernel::laws::TangentialVelocityLaw& velocity = model.law.tangential_velocity;
  require_law(std::holds_alternative<kernel::laws::MaterialVelocity>(velocity),
              "tangential_velocity", law_info(velocity),
              "material in the elastic loop: friction's moments act on the links");
}

/// A quantity that depends on ΔT, and its derivative [per K].
struct Thermal {
  double value, rate;
};

Thermal thermal(double reference, double expansion, double temperature_change) {
  return {kernel::thermal_length(reference, expansion, temperature_change), reference * expansion};
}

/// The model at one temperature.
struct Parameters {
  double temperature_change;
  Thermal l1, l2, k1, k2, r1, r2;
  Thermal hertz;  ///< F_N/δ^1.5 [N/m^1.5]
  Thermal shear;  ///< k_t/sqrt(δ) [N/m^1.5]
  double clearance() const { return r2.value - r1.value; }
};

Parameters parameters(const Linkage& model, double temperature_change) {
  Parameters p;
  p.temperature_change = temperature_change;
  const auto axial = [](const ThermalLink& link, const Thermal& length) -> Thermal {
    const double k = link.young_modulus * link.cross_section_area / length.value;
    return {k, -k * length.rate / length.value};
  };
  const ThermalLink& ab = model.link_ab;
  const ThermalLink& bc = model.link_bc;
  p.l1 = thermal(ab.stress_free_length, ab.thermal_expansion, temperature_change);
  p.l2 = thermal(bc.stress_free_length, bc.thermal_expansion, temperature_change);
  p.k1 = axial(ab, p.l1);
  p.k2 = axial(bc, p.l2);
  p.r1 = thermal(model.journal_radius, model.journal_thermal_expansion, temperature_change);
  p.r2 = thermal(model.bearing_radius, model.bearing_thermal_expansion, temperature_change);
  const bool internal = std::holds_alternative<kernel::laws::HertzInternal>(model.law.normal);
  const double sign = internal ? -1.0 : 1.0;
  const double sum = p.r2.value + sign * p.r1.value;
  const double root = std::sqrt(p.r1.value * p.r2.value / sum);
  const double growth = 0.5 * (p.r1.rate / p.r1.value + p.r2.rate / p.r2.value -
                               (p.r2.rate + sign * p.r1.rate) / sum);  // of the root, relative
  const kernel::ElasticPair pair =
      kernel::elastic_pair(bc.young_modulus, bc.poisson_ratio, ab.young_modulus, ab.poisson_ratio);
  const double hertz = 4.0 / 3.0 * pair.effective_young_modulus * root;
  const double shear = 8.0 * pair.effective_shear_modulus * root;
  p.hertz = {hertz, hertz * growth};
  p.shear = {shear, shear * growth};
  return p;
}

Vector2d direction(double angle) {
  return {std::cos(angle), std::sin(angle)};
}
Vector2d across(const Vector2d& u) {
  return {-u.y(), u.x()};
}

/// Hertz's force. A negative depth gives the mirrored pull: it has no meaning but a root, which
/// shows that contact was lost on the way.
double normal_force(const Parameters& p, double depth) {
  return p.hertz.value * depth * std::sqrt(std::abs(depth));
}
double tangential_stiffness(const Parameters& p, double depth) {
  return p.shear.value * std::sqrt(std::abs(depth));
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

/// Slide of journal against bearing, ∫ (R2 − R1 + δ) dψ + (R1 − δ/2) dθ4 − (R2 + δ/2) dθ2, with its
/// derivatives at the end. The part with the radii at ΔT = 0 is a function of the state and taken
/// as one: no rounding piles up. The rest is small; trapezium's rule.
class Slide {
 public:
  explicit Slide(const Linkage& model) : r1_(model.journal_radius), r2_(model.bearing_radius) {}

  double arc(const Vector& z) const { return (r2_ - r1_) * z[psi] + r1_ * z[th4] - r2_ * z[th2]; }

  double rest(const Equilibrium& from, const Parameters& p, const Vector& z) const {
    const Weights w = mean(from, p, z);
    return w.psi * (z[psi] - from.z[psi]) + w.th4 * (z[th4] - from.z[th4]) -
           w.th2 * (z[th2] - from.z[th2]);
  }

  /// Derivative of arc + rest by z.
  void derivative(const Equilibrium& from, const Parameters& p, const Vector& z,
                  Matrix::RowXpr row) const {
    const Weights w = mean(from, p, z);
    row[psi] += r2_ - r1_ + w.psi;
    row[th4] += r1_ + w.th4;
    row[th2] -= r2_ + w.th2;
    row[dep] += 0.5 * (z[psi] - from.z[psi]) - 0.25 * (z[th4] - from.z[th4] + z[th2] - from.z[th2]);
  }

  /// Slide per change of the state, exact.
  double rate(const Equilibrium& at, const Vector& z_rate) const {
    const Weights w = weights(at.p, at.z);
    return (r2_ - r1_ + w.psi) * z_rate[psi] + (r1_ + w.th4) * z_rate[th4] -
           (r2_ + w.th2) * z_rate[th2];
  }

 private:
  struct Weights {
    double psi, th4, th2;
  };
  /// Beyond the radii at ΔT = 0.
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

/// The friction line: F_t = ratio F_N, or no slip since `from`.
struct FrictionLine {
  bool sticks = false;
  double ratio = 0.0;
  TangentialCompliance compliance = TangentialCompliance::rigid;
  const Equilibrium* from = nullptr;  ///< start of the step
  double arc = 0.0;                   ///< Slide::arc() that counts as no slide
  double past = 0.0;                  ///< Slide::rest() since then, up to `from` [m]
};

class Equations {
 public:
  explicit Equations(const Linkage& model)
      : a_(model.frame_length),
        torsion_(model.torsion_stiffness),
        free_angle_(model.free_angle()),
        slide_(model) {
    const double l1 = model.link_ab.stress_free_length;
    const double l2 = model.link_bc.stress_free_length;
    length_tolerance_ = 4.0 * epsilon * (a_ + l1 + l2);
    force_rounding_ = 16.0 * epsilon * torsion_ / std::min(l1, l2);
  }

  /// Whether the bodies press on each other, by more than rounding: with a hundred times the
  /// rounding of the spring's force its direction is known to a hundredth.
  bool touches(const Equilibrium& at) const { return at.normal() > 100.0 * force_rounding_; }

  const Slide& slide() const { return slide_; }
  double moment(const Vector& z) const { return torsion_ * (z[th4] - z[th2] - free_angle_); }

  /// Newton's method from at.z; true when converged.
  bool solve(const FrictionLine& line, Equilibrium& at) const {
    Vector residual;
    Matrix jacobian;
    bool converged = false;
    Equilibrium best = at;
    for (int i = 0; i <= iteration_limit; ++i) {
      evaluate(line, at.p, at.z, residual, jacobian);
      const bool good = judge(line, residual, at);
      at.iterations = i;
      if (converged) {  // this was the polishing step
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

  /// dz/dΔT while F_t = ratio F_N.
  Vector slipping_rate(double ratio, const Equilibrium& at) const {
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

 private:
  void evaluate(const FrictionLine& line, const Parameters& p, const Vector& z, Vector& residual,
                Matrix& jacobian) const {
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
    const double normal_slope = 1.5 * p.hertz.value * std::sqrt(std::abs(z[dep]));
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

    if (!line.sticks) {
      residual[friction] = z[ft] - line.ratio * normal;
      jacobian(friction, dep) = -line.ratio * normal_slope;
      jacobian(friction, ft) = 1.0;
      return;
    }
    const Equilibrium& from = *line.from;
    residual[friction] = slide_.arc(z) - line.arc + line.past + slide_.rest(from, p, z);
    slide_.derivative(from, p, z, jacobian.row(friction));
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

  bool judge(const FrictionLine& line, const Vector& residual, Equilibrium& at) const {
    const double joint_force = std::hypot(at.normal(), at.z[ft]);
    double force = residual.head<4>().cwiseAbs().maxCoeff();
    double length = residual.segment<2>(closure_x).cwiseAbs().maxCoeff();
    double& last = line.sticks ? length : force;
    last = std::max(last, std::abs(residual[friction]));
    at.force_residual = force / joint_force;
    at.closure_residual = length;
    return force <= force_tolerance * joint_force + force_rounding_ && length <= length_tolerance_;
  }

  double a_, torsion_, free_angle_;
  Slide slide_;
  double length_tolerance_, force_rounding_;
};

[[noreturn]] void fail(const Equilibrium& at) {
  char text[200];
  std::snprintf(text, sizeof text,
                "no equilibrium found at temperature_change = %.9g K: residual %g of the joint "
                "force, %g m in the "
                "closure",
                at.p.temperature_change, at.force_residual, at.closure_residual);
  throw std::runtime_error(text);
}

Equilibrium start(const Linkage& model, const Equations& equations, double contact_angle) {
  model.validate();
  validate_laws(model);
  const int side = loaded_side(model, contact_angle);
  // Rigid bodies first; then the force (f, 0) of moments about A, and what it does to each spring.
  const JointPoint rigid = joint_point(model, 0.0, side, contact_angle);
  Equilibrium at;
  at.p = parameters(model, 0.0);
  at.z[th2] = rigid.theta2;
  at.z[th4] = rigid.theta4;
  at.z[psi] = std::atan2(rigid.eccentricity.y(), rigid.eccentricity.x());
  const double f =
      rigid.spring_moment / (rigid.bearing_centre.y() + at.p.r2.value * std::sin(at.z[psi]));
  const double normal = std::abs(f) * std::cos(contact_angle);
  at.z[e1] = f * std::cos(at.z[th2]) / at.p.k1.value;
  at.z[e2] = -f * std::cos(at.z[th4]) / at.p.k2.value;
  at.z[dep] = std::cbrt(normal / at.p.hertz.value) * std::cbrt(normal / at.p.hertz.value);
  at.z[ft] = normal * std::tan(contact_angle);
  FrictionLine line;
  line.ratio = std::tan(contact_angle);
  if (!equations.solve(line, at) || !equations.touches(at)) fail(at);
  return at;
}

/// Root of a function that is < 0 at `before` and >= 0 at `after`: false position (Illinois).
/// `value(x, y)` says whether y could be had. Returns a point on the far side, or NaN.
template <class Value>
double root(double before, double value_before, double after, double value_after, Value&& value) {
  double low = std::min(value_before, 0.0);
  double high = std::max(value_after, 0.0);
  int same = 0;
  for (int i = 0; i < 100; ++i) {
    double x = i % 8 == 7 || !(high - low > 0.0) ? 0.5 * (before + after)
                                                 : before - low / (high - low) * (after - before);
    if (x == before || x == after) x = 0.5 * (before + after);
    if (x == before || x == after) break;
    if (std::abs(after - before) <= 4.0 * epsilon * std::abs(after)) break;
    double y;
    if (!value(x, y)) return std::numeric_limits<double>::quiet_NaN();
    if (y == 0.0) return x;
    if (y < 0.0) {
      before = x;
      low = y;
      if (same == -1) high *= 0.5;
      same = -1;
    } else {
      after = x;
      high = y;
      if (same == 1) low *= 0.5;
      same = 1;
    }
  }
  return after;
}

/// Walks along the path.
class Walk {
 public:
  Walk(const Linkage& model, const ElasticLoopOptions& options, double contact_angle,
       ElasticLoop& loop)
      : model_(model),
        equations_(model),
        compliance_(options.compliance),
        mu_(model.friction_coefficient()),
        loop_(loop),
        now_(start(model, equations_, contact_angle)) {
    slips_ = mu_ == 0.0 || std::abs(contact_angle) >= std::atan(mu_);
    sign_ = contact_angle < 0.0 ? -1.0 : 1.0;
    side_ = equations_.moment(now_.z) < 0.0 ? -1.0 : 1.0;
    stick_from_here();
    note(now_);
    loop_.points.push_back(point());
  }

  /// Settles which way the joint goes when ΔT starts to change towards `to`.
  void turn(double to) {
    heading_ = to > now_.p.temperature_change ? 1.0 : -1.0;
    if (slips_ && mu_ > 0.0 && !(slip_rate(now_) < 0.0)) slips_ = false;
    loop_.points.back() = point();
    event();
  }

  /// Goes to ΔT = `to`; false if contact is lost on the way.
  bool advance(double to) {
    double target = to;
    int failures = 0;
    while (now_.p.temperature_change != to) {
      const double from = now_.p.temperature_change;
      Equilibrium next;
      const Outcome outcome = attempt(target, next);
      if (outcome == Outcome::fails) {
        target = from + 0.5 * (target - from);
        if (++failures > halving_limit || target == from) fail(next);
        continue;
      }
      if (next.p.temperature_change != from) failures = 0;
      accept(next);
      target = to;
      if (outcome == Outcome::arrives) continue;
      if (outcome == Outcome::separates) loop_.separated = true;
      if (outcome == Outcome::turns) {
        if (++failures > halving_limit) fail(next);  // turns on the spot
        slips_ = !slips_;
      }
      if (next.p.temperature_change != from) {
        sample();
      } else {
        loop_.points.back() = point();
      }
      event();
      if (loop_.separated) return false;
    }
    return true;
  }

  void sample() { loop_.points.push_back(point()); }
  void event() { loop_.events.push_back(point()); }

 private:
  FrictionLine line() const {
    FrictionLine result;
    result.sticks = !slips_;
    result.ratio = sign_ * mu_;
    result.compliance = compliance_;
    result.from = &now_;
    result.arc = arc_;
    result.past = past_;
    return result;
  }

  enum class Outcome : unsigned char { arrives, turns, separates, fails };

  /// Step towards `to` in the present motion, up to the first event; sets sign_ where slip starts.
  Outcome attempt(double to, Equilibrium& next) {
    next = now_;
    if (!reach(to, next)) return Outcome::fails;
    Outcome outcome = Outcome::arrives;
    if (!equations_.touches(next)) {
      outcome = Outcome::separates;
      next = last_contact(to);
    }
    if (mu_ == 0.0) return outcome;
    if (slips_) {
      if (slip_rate(next) < 0.0) return outcome;
      if (!(slip_rate(now_) < 0.0)) {
        next = now_;
        return Outcome::turns;
      }
      return find(next, [this](const Equilibrium& at) { return slip_rate(at); });
    }
    // Of the limit that is exceeded: at the start the force may stand at the other one.
    const double sign = next.z[ft] < 0.0 ? -1.0 : 1.0;
    if (!(excess(sign, next) > limit_rounding * mu_ * next.normal())) return outcome;
    sign_ = sign;
    if (excess(sign, now_) > -limit_rounding * mu_ * now_.normal()) {
      // At the limit already: it slips from here, or first leaves the limit and comes back.
      if (!(slip_rate(now_) < 0.0)) return Outcome::fails;
      next = now_;
      return Outcome::turns;
    }
    return find(next, [&](const Equilibrium& at) { return excess(sign, at); });
  }

  /// Equilibrium at ΔT = `to` from the guess in `next`.
  bool reach(double to, Equilibrium& next) const {
    next.p = parameters(model_, to);
    return equations_.solve(line(), next);
  }

  /// Force along `sign` beyond Coulomb's limit [N].
  double excess(double sign, const Equilibrium& at) const {
    return sign * at.z[ft] - mu_ * at.normal();
  }

  /// Plastic slide along F_t per kelvin of travel [m/K]; friction resists, so it is < 0 in slip.
  double slip_rate(const Equilibrium& at) const {
    const double ratio = sign_ * mu_;
    const Vector rate = equations_.slipping_rate(ratio, at);
    double slide = equations_.slide().rate(at, rate);
    if (compliance_ == TangentialCompliance::mindlin) {
      const Parameters& p = at.p;
      const double stiffness = at.stiffness();
      const double grows = 0.5 * rate[dep] / at.z[dep] + p.shear.rate / p.shear.value;  // relative
      double spring = rate[ft];
      if (heading_ * grows < 0.0) spring -= at.z[ft] * grows;
      slide += spring / stiffness;
    }
    return sign_ * heading_ * slide;
  }

  /// Last point in contact on the way to `to`, by bisection. The force's direction loses its
  /// meaning with the force: no convergence counts as no contact.
  Equilibrium last_contact(double to) const {
    Equilibrium last = now_;
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (last.p.temperature_change + to);
      if (middle == last.p.temperature_change || middle == to) break;
      Equilibrium trial = last;
      if (reach(middle, trial) && equations_.touches(trial)) {
        last = trial;
      } else {
        to = middle;
      }
    }
    return last;
  }

  /// Replaces `next`, where `value` >= 0, by the point where it ceases to be < 0.
  template <class Value>
  Outcome find(Equilibrium& next, Value&& value) const {
    Equilibrium trial = now_;
    const double at = root(now_.p.temperature_change, value(now_), next.p.temperature_change,
                           value(next), [&](double x, double& y) {
                             if (!reach(x, trial)) return false;
                             y = value(trial);
                             return true;
                           });
    next = trial;
    const bool found = std::isfinite(at) && reach(at, next) && equations_.touches(next);
    return found ? Outcome::turns : Outcome::fails;
  }

  void accept(const Equilibrium& next) {
    const bool rigid = compliance_ == TangentialCompliance::rigid;
    if (!slips_ && rigid) past_ += equations_.slide().rest(now_, next.p, next.z);
    now_ = next;
    if (slips_ || !rigid) stick_from_here();
    note(now_);
  }

  void stick_from_here() {
    arc_ = equations_.slide().arc(now_.z);
    past_ = 0.0;
  }

  void note(const Equilibrium& at) {
    loop_.largest_force_residual = std::max(loop_.largest_force_residual, at.force_residual);
    loop_.largest_closure_residual = std::max(loop_.largest_closure_residual, at.closure_residual);
    loop_.most_iterations = std::max(loop_.most_iterations, at.iterations);
  }

  ElasticJointPoint point() const {
    const Vector& z = now_.z;
    ElasticJointPoint result;
    result.temperature_change = now_.p.temperature_change;
    result.theta2 = z[th2];
    result.theta4 = z[th4];
    result.bearing_centre = (now_.p.l1.value + z[e1]) * direction(z[th2]);
    result.journal_centre =
        Vector2d(model_.frame_length, 0.0) + (now_.p.l2.value + z[e2]) * direction(z[th4]);
    result.depth = z[dep];
    result.normal_force = now_.normal();
    result.tangential_force = z[ft];
    result.contact_angle = std::atan2(side_ * std::sin(z[psi]), side_ * std::cos(z[psi]));
    result.spring_moment = equations_.moment(z);
    result.motion = loop_.separated ? JointMotion::separated
                    : slips_        ? JointMotion::slip
                                    : JointMotion::roll;
    return result;
  }

  const Linkage& model_;
  Equations equations_;
  TangentialCompliance compliance_;
  double mu_;
  ElasticLoop& loop_;
  Equilibrium now_;
  bool slips_ = false;
  double sign_ = 1.0;     ///< of F_t in slip
  double side_ = 1.0;     ///< of the joint force along AC
  double heading_ = 1.0;  ///< of dΔT
  double arc_ = 0.0;      ///< see FrictionLine
  double past_ = 0.0;
};

}  // namespace

LinkageState loaded_state(const Linkage& model, double contact_angle) {
  const Equilibrium at = start(model, Equations(model), contact_angle);
  LinkageState state;
  state.bearing_centre = (at.p.l1.value + at.z[e1]) * direction(at.z[th2]);
  state.journal_centre =
      Vector2d(model.frame_length, 0.0) + (at.p.l2.value + at.z[e2]) * direction(at.z[th4]);
  state.contact.tangential_force.x() = at.z[ft];
  state.contact.tangential_stiffness = at.stiffness();
  state.impact_speed = model.law.smallest_impact_speed;
  return state;
}

ElasticLoop elastic_loop(const Linkage& model, const kernel::ThermalProgram& program,
                         const ElasticLoopOptions& options, double contact_angle) {
  model.validate();
  program.validate();
  require(options.samples >= 1, "samples", options.samples, ">= 1");
  const std::vector<kernel::ThermalBranch> branches = kernel::monotone_branches(program);
  for (const kernel::ThermalBranch& branch : branches) {
    const Parameters p = parameters(model, branch.end);
    require(p.r1.value > 0.0 && p.clearance() > 0.0, "radial clearance", p.clearance(),
            "> 0 m at every temperature of the program");
  }
  ElasticLoop loop;
  Walk walk(model, options, contact_angle, loop);
  for (const kernel::ThermalBranch& branch : branches) {
    if (branch.end == branch.start) continue;
    walk.turn(branch.end);
    for (int i = 1; i <= options.samples; ++i) {
      const double part = static_cast<double>(i) / options.samples;
      const double to =
          i == options.samples ? branch.end : branch.start + part * (branch.end - branch.start);
      if (!walk.advance(to)) return loop;
      walk.sample();
    }
  }
  walk.event();
  return loop;
}

}  // namespace statejump
