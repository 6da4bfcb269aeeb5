// SPDX-License-Identifier: GPL-3.0-or-later
// Compares every law in random contacts with the formulas of docs/reference/laws.md in 50-digit
// arithmetic, written independently of the kernel: both sides of every branch, extreme ratios. Also
// tests invariance under changes of units, axes and order of the bodies.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <string>

#include "statejump/kernel/laws/joint_response.hpp"

namespace statejump::kernel::laws {
namespace {

using Big = boost::multiprecision::static_mpfr_float_50;
using BigVector = std::array<Big, 3>;

Big dot(const BigVector& a, const BigVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Big norm(const BigVector& a) {
  return sqrt(dot(a, a));
}
BigVector sum(const Big& p, const BigVector& a, const Big& q, const BigVector& b) {
  return {p * a[0] + q * b[0], p * a[1] + q * b[1], p * a[2] + q * b[2]};
}
BigVector big(const Vector3& a) {
  return {Big(a.x()), Big(a.y()), Big(a.z())};
}
const Big& pi() {
  static const Big value = 4 * atan(Big(1));
  return value;
}

/// One contact with its laws and its history.
struct Configuration {
  JointLawNames names;
  JointLaw law;
  ContactParameters parameters;
  JointKinematics at;
  ContactHistory history;
};

int configurations() {
  const char* wanted = std::getenv("STATEJUMP_CONFIGURATIONS");
  return wanted ? std::atoi(wanted) : 20000;
}

class Random {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(generator_() >> 11U) / 9007199254740992.0);
  }
  double log_uniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  int below(int count) { return static_cast<int>(generator_() % static_cast<unsigned>(count)); }
  std::size_t index(std::size_t count) { return static_cast<std::size_t>(generator_()) % count; }
  Vector3 direction() {
    for (;;) {
      const Vector3 v(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      if (v.norm() > 0.1 && v.norm() < 1) return v.normalized();
    }
  }

 private:
  std::mt19937_64 generator_{20210110};
};

constexpr std::array<const char*, 5> normals{"hertz_paper", "hertz_internal", "johnson",
                                             "esdu_78035", "persson"};
constexpr std::array<const char*, 4> dissipations{"none", "lankarani_nikravesh", "hunt_crossley",
                                                  "flores"};
constexpr std::array<const char*, 3> frictions{"none", "ambrosio", "mindlin"};

Configuration drawn(Random& random) {
  Configuration c{};
  c.names = {normals[random.index(5)], dissipations[random.index(4)], frictions[random.index(3)],
             random.below(2) ? "material" : "paper"};
  c.law = joint_law(c.names);
  c.law.restitution = random.below(10) ? random.uniform(0.01, 1) : 1.0;
  c.law.contact_length = random.log_uniform(1e-4, 1);
  c.law.friction_parameters.v0 = random.below(2) ? random.log_uniform(1e-6, 1e-2) : 0.0;
  c.law.friction_parameters.v1 = c.law.friction_parameters.v0 + random.log_uniform(1e-6, 1e-2);
  ContactParameters& p = c.parameters;
  p.elastic = {random.log_uniform(1e6, 1e12), 0};
  p.elastic.effective_shear_modulus = p.elastic.effective_young_modulus * random.uniform(0.1, 0.5);
  p.friction_coefficient = random.below(8) ? random.log_uniform(1e-4, 10) : 0.0;
  p.normal_damping_ratio = random.below(2) ? random.log_uniform(1e-4, 10) : 0.0;
  p.tangential_damping_ratio = random.below(2) ? random.log_uniform(1e-4, 10) : 0.0;
  p.effective_mass = random.log_uniform(1e-6, 1e3);

  JointKinematics& at = c.at;
  at.geometry.journal_radius = random.log_uniform(1e-5, 10);
  const double clearance = at.geometry.journal_radius * random.log_uniform(1e-6, 1e2);
  at.geometry.bearing_radius = at.geometry.journal_radius + clearance;
  at.geometry.length = c.law.contact_length;
  const double gap = at.geometry.clearance();  // as rounded
  // Random depth from far below the clearance to just below the limit of the law; sometimes
  // negative or zero.
  const double limit =
      std::visit([&](const auto& l) { return l.largest_depth(at.geometry); }, c.law.normal);
  const double deepest = std::min(limit, at.geometry.journal_radius);
  const int kind = random.below(20);
  double depth = random.log_uniform(1e-12, 0.999) * deepest;
  if (kind == 0) depth = 0.0;
  if (kind == 1) depth = -depth;
  if (kind == 2) depth = deepest * (1 - random.log_uniform(1e-9, 1e-1));
  JointContact& contact = at.contact;
  contact.penetration_depth = depth;
  contact.normal = random.direction();
  contact.effective_radius =
      internal_effective_radius(at.geometry.journal_radius, at.geometry.bearing_radius);
  contact.eccentricity = std::max(gap + depth, 0.0);
  contact.arm_1 = at.geometry.journal_radius * contact.normal;
  contact.arm_2 = at.geometry.bearing_radius * contact.normal;
  at.axis = contact.normal.cross(random.direction()).normalized();
  const double speed = random.log_uniform(1e-9, 10);
  at.motion_1 = {Vector3::Zero(), speed * random.direction(), speed * random.direction()};
  at.motion_2 = {Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  contact.relative_velocity = at.motion_1.velocity;
  at.impact_speed = random.log_uniform(1e-7, 10);
  at.clearance_rate = random.below(2) ? 0.1 * random.uniform(-speed, speed) : 0.0;
  at.time_step = random.log_uniform(1e-9, 1e-2);

  // Random history: empty, or a tangential force within, at or beyond the present limit, stored
  // with a smaller, equal or larger stiffness.
  if (random.below(3)) {
    const NormalState state = evaluate(c.law.normal, depth, at.geometry,
                                       NormalMaterial{p.elastic.effective_young_modulus});
    const double stiffness = tangential_stiffness(p.elastic, state.stiffness);
    const double factor = random.below(3) ? random.log_uniform(0.01, 100) : 1.0;
    c.history.tangential_stiffness = factor * stiffness;
    const Vector3 across = contact.normal.cross(random.direction()).normalized();
    c.history.tangential_force =
        random.log_uniform(1e-3, 3) * p.friction_coefficient * state.force * across;
    c.history.slipping = random.below(2) != 0;
  }
  return c;
}

struct BigNormal {
  Big force, stiffness, energy;
  /// condition number of the force: its relative change per relative change of the depth, at least
  /// 1
  Big condition{1};
};

/// Solves delta = f/(pi E*) (ln(4 pi E* dR/f) + s) on the branch of small loads by Newton's method.
BigNormal line_contact(const Big& depth, const Big& clearance, const Big& modulus,
                       const Big& length, int s) {
  const Big m = pi() * modulus;
  // unknown u = ln(4 m dR/f) + s > 1, from ln u - u = ln(delta e^-s/(4 dR))
  const Big right = log(depth / (4 * clearance)) - s;
  Big u = 1 + (right < -1 ? sqrt(-2 * (right + 1)) - (right + 1) : Big(0));
  for (int i = 0; i < 200; ++i) {
    const Big step = (log(u) - u - right) / (1 / u - 1);
    u -= step;
    if (abs(step) < Big(1e-40) * u) break;
  }
  const Big f = m * depth / u;
  BigNormal found;
  found.force = f * length;
  found.stiffness = m * length / (u - 1);
  // energy: integral of F d(delta) = F delta - integral of delta dF
  const Big l = u - s;
  found.energy = length * (f * depth - f * f / m * (l / 2 + Big(1) / 4 + Big(s) / 2));
  found.condition = u / (u - 1);
  return found;
}

/// Persson's contact: load in units of E* dR and depth in units of dR, as functions of t.
Big persson_load(const Big& t) {
  return 2 * pi() * t * (1 + t) / (2 - log(1 + t) - 2 * t * t);
}
Big persson_depth(const Big& t) {
  const Big l = log(1 + t);
  const Big x = 2 - l - 2 * t * t;
  const Big n = 2 + 5 * t + 2 * t * t - (1 + 2 * t) * l;
  const Big offset = (3 * t - 2 * t / (1 + t) - 2 * t * t + (1 + 2 * t) * l) / n;
  const Big c = log(4 * (1 + t) / t) - 2 - offset / 2 +
                t * (2 + 5 * t / 2 + (1 + 2 * t) * x / n) / ((1 + t) * (1 + t)) +
                (1 + 2 * t) * (1 + 2 * t) * l / ((1 + t) * n);
  return c * persson_load(t) / pi() + offset;
}

BigNormal persson(const Big& depth, const Big& clearance, const Big& modulus, const Big& length,
                  double guess) {
  const Big wanted = depth / clearance;
  const auto slope = [](const auto& function, const Big& t) {
    const Big h = t * Big(1e-16);
    return Big((function(t + h) - function(t - h)) / (2 * h));
  };
  Big t = guess;
  for (int i = 0; i < 60; ++i) {
    const Big step = (persson_depth(t) - wanted) / slope(persson_depth, t);
    t -= step;
    if (abs(step) < Big(1e-30) * t) break;
  }
  BigNormal found;
  const Big f = persson_load(t);
  const Big by_depth = slope(persson_load, t) / slope(persson_depth, t);
  found.force = modulus * clearance * f * length;
  found.stiffness = modulus * length * by_depth;
  found.energy = found.force / 2 * (depth - clearance * (log(1 + t) - t + t * t) / (t * (1 + t)));
  found.condition = std::max(Big(1), Big(by_depth * wanted / f));
  return found;
}

BigNormal normal_reference(const std::string& name, const Configuration& c,
                           const NormalState& kernel) {
  const NormalGeometry& g = c.at.geometry;
  const Big depth = c.at.contact.penetration_depth;
  const Big modulus = c.parameters.elastic.effective_young_modulus;
  if (depth <= 0) return {0, 0, 0};
  const Big r1 = g.journal_radius, r2 = g.bearing_radius, length = g.length;
  if (name == "johnson") return line_contact(depth, r2 - r1, modulus, length, -1);
  if (name == "esdu_78035") return line_contact(depth, r2 - r1, modulus, length, 1);
  if (name == "persson") {
    const double half = std::tan(0.5 * kernel.contact_width / g.journal_radius);
    return persson(depth, r2 - r1, modulus, length, half * half);
  }
  const Big radius = name == "hertz_paper" ? Big(r1 * r2 / (r1 + r2)) : Big(r1 * r2 / (r2 - r1));
  const Big force = Big(4) / 3 * modulus * sqrt(radius) * pow(depth, Big(1.5));
  return {force, Big(3) / 2 * force / depth, Big(2) / 5 * force * depth, Big(1.5)};
}

struct Reference {
  Big normal_force, normal_scale;  ///< a scale is the sum of the magnitudes of all terms
  BigVector tangential;
  Big tangential_scale;
  BigVector relative_velocity;
  BigNormal normal;
  bool is_at_a_step = false;  ///< the viscous force starts or ends within rounding of this state
};

/// The contact step as specified by docs/reference/laws.md and the class comments.
Reference reference(const Configuration& c, const NormalState& kernel) {
  Reference r;
  r.normal = normal_reference(c.names.normal, c, kernel);
  const ContactParameters& p = c.parameters;
  const JointContact& contact = c.at.contact;
  const BigVector n = big(contact.normal);
  const Big depth = contact.penetration_depth;
  // velocity used by friction
  BigVector v = big(contact.relative_velocity);
  // normal and tangential components are differences of terms as large as this speed
  const Big whole_speed = norm(v);
  if (c.names.tangential_velocity == "paper") {
    const BigVector axis = big(c.at.axis);
    const BigVector d = sum(1, v, -dot(v, axis), axis);
    const Big share = contact.eccentricity > 0 ? Big(depth / Big(contact.eccentricity)) : Big(0);
    v = sum(share, d, (1 - share) * dot(d, n), n);
  }
  r.relative_velocity = v;
  const Big approach = dot(v, n);
  // dissipation
  const Big e = c.law.restitution;
  const Big impact = std::max(c.at.impact_speed, c.law.smallest_impact_speed);
  Big ratio = 0;
  if (c.names.dissipation == "lankarani_nikravesh") ratio = Big(3) / 4 * (1 - e * e) / impact;
  if (c.names.dissipation == "hunt_crossley") ratio = Big(3) / 2 * (1 - e) / impact;
  if (c.names.dissipation == "flores") ratio = Big(8) / 5 * (1 - e) / (e * impact);
  const Big rate = approach - Big(c.at.clearance_rate);
  Big force = r.normal.force;
  r.normal_scale = force;
  if (depth > 0) {
    r.normal_scale += force * ratio * (whole_speed + abs(Big(c.at.clearance_rate)));
    force *= std::max(Big(0), Big(1 + ratio * rate));
    const Big damping =
        2 * Big(p.normal_damping_ratio) * sqrt(Big(p.effective_mass) * r.normal.stiffness);
    r.normal_scale += damping * whole_speed;
    force = std::max(Big(0), Big(force + damping * approach));
  }
  r.normal_force = force;
  // friction
  const Big limit = Big(p.friction_coefficient) * force;
  r.tangential_scale = Big(p.friction_coefficient) * r.normal_scale;
  const BigVector slide_rate = sum(1, v, -approach, n);
  r.tangential = {0, 0, 0};
  const Big dt = c.at.time_step;
  if (c.names.friction == "ambrosio") {
    const Big speed = norm(slide_rate);
    const Big v0 = c.law.friction_parameters.v0, v1 = c.law.friction_parameters.v1;
    if (speed > v0) {
      const Big share = std::min(Big(1), Big((speed - v0) / (v1 - v0)));
      r.tangential = sum(-limit * share / speed, slide_rate, 0, slide_rate);
      // near v0 the difference speed - v0 cancels digits; so did the subtraction of the normal
      // component from v
      r.tangential_scale *= 1 + speed / (v1 - v0) + whole_speed / speed;
    }
  } else if (c.names.friction == "mindlin") {
    const Big kt = 4 * Big(p.elastic.effective_shear_modulus) /
                   Big(p.elastic.effective_young_modulus) * r.normal.stiffness;
    const Big k0 = c.history.tangential_stiffness;
    if (kt > 0 && limit > 0) {
      // loading keeps the force, unloading keeps the slide
      const Big kept = k0 > 0 ? (kt >= k0 ? Big(1) : Big(kt / k0)) : Big(0);
      const BigVector before = big(c.history.tangential_force);
      const BigVector trial = sum(kept, before, -kt * dt, slide_rate);
      const Big size = norm(trial);
      r.is_at_a_step = abs(size / limit - 1) < Big(1e-10);
      const Big terms = kept * norm(before) + kt * dt * whole_speed;
      if (size > limit) {
        r.tangential = sum(limit / size, trial, 0, trial);
        r.tangential_scale *= 1 + terms / size;  // for the direction
      } else {
        const Big damping = 2 * Big(p.tangential_damping_ratio) * sqrt(Big(p.effective_mass) * kt);
        r.tangential = sum(1, trial, -damping, slide_rate);
        r.tangential_scale += terms + damping * whole_speed;
        const Big whole = norm(r.tangential);
        if (whole > limit) {
          r.tangential_scale = Big(p.friction_coefficient) * r.normal_scale *
                               (1 + (terms + damping * whole_speed) / whole);
          r.tangential = sum(limit / whole, r.tangential, 0, r.tangential);
        }
      }
    }
  }
  return r;
}

constexpr double rounding = 1.0 / 9007199254740992.0;  // 2^-53, of one operation

double units(const Big& error, const Big& scale) {
  if (error == 0) return 0;
  return static_cast<double>(abs(error) / (scale * rounding));
}

struct Worst {
  double units = 0;
  int number = 0;
};

TEST(Reference, EveryLawInFiftyDigits) {
  Random random;
  std::map<std::string, Worst> worst;
  int steps = 0;
  const int count = configurations();
  for (int i = 0; i < count; ++i) {
    const Configuration c = drawn(random);
    const NormalState state =
        evaluate(c.law.normal, c.at.contact.penetration_depth, c.at.geometry,
                 NormalMaterial{c.parameters.elastic.effective_young_modulus});
    const Reference r = reference(c, state);
    ContactHistory history = c.history;
    const JointResponse response = joint_response(c.law, c.parameters, c.at, history);
    const auto note = [&](const std::string& what, const Big& error, const Big& scale) {
      const double found = units(error, scale);
      ASSERT_TRUE(std::isfinite(found)) << what << " of configuration " << i;
      Worst& one = worst[what];
      if (found > one.units) one = {found, i};
    };
    const Big condition = r.normal.condition;
    note(c.names.normal + " force", state.force - r.normal.force, condition * r.normal.force);
    // At the turning point of F, k is infinite, so errors of k and damping grow as the square of
    // the condition number.
    note(c.names.normal + " stiffness", state.stiffness - r.normal.stiffness,
         condition * condition * r.normal.stiffness);
    note(c.names.normal + " energy", state.elastic_energy - r.normal.energy,
         condition * r.normal.energy);
    note(c.names.dissipation + " F_N", response.contact.normal_force - r.normal_force,
         condition * condition * r.normal_scale);
    if (r.is_at_a_step) {
      ++steps;
      continue;
    }
    const BigVector apart = sum(1, big(response.contact.tangential_force), -1, r.tangential);
    note(c.names.friction + " F_T", norm(apart), condition * condition * r.tangential_scale);
  }
  std::printf("%d configurations, %d of them within 1e-10 of a step of the force\n", count, steps);
  for (const auto& [what, one] : worst)
    std::printf("%-28s %8.2f units of rounding (configuration %d)\n", what.c_str(), one.units,
                one.number);
  EXPECT_LT(steps, count / 50);
  // The worst of a million configurations had 8.0 units.
  for (const auto& [what, one] : worst) EXPECT_LT(one.units, 16) << what;
}

Configuration turned(Configuration c, const Eigen::Matrix3d& rotation) {
  JointContact& contact = c.at.contact;
  for (Vector3* v :
       {&contact.normal, &contact.arm_1, &contact.arm_2, &contact.relative_velocity, &c.at.axis,
        &c.at.motion_1.velocity, &c.at.motion_1.angular_velocity, &c.history.tangential_force})
    *v = (rotation * *v).eval();
  return c;
}

TEST(Reference, AxesDoNotMatter) {
  // Quarter rotations about the axes of the frame, and reflections of two axes, only permute
  // components and change signs. Results may differ only by the order of sums of three terms.
  Random random;
  const int count = std::min(configurations(), 100000);
  for (int i = 0; i < count; ++i) {
    const Configuration c = drawn(random);
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();
    const int first = random.below(3);
    for (int k = 0; k < 3; ++k) rotation(k, (k + first) % 3) = 1;
    rotation.row(random.below(3)) *= -1;
    ContactHistory one = c.history, other = turned(c, rotation).history;
    const JointResponse a = joint_response(c.law, c.parameters, c.at, one);
    const Configuration d = turned(c, rotation);
    const JointResponse b = joint_response(d.law, d.parameters, d.at, other);
    if (one.slipping != other.slipping) continue;  // at the Coulomb limit within rounding
    const Reference r =
        reference(c, evaluate(c.law.normal, c.at.contact.penetration_depth, c.at.geometry,
                              NormalMaterial{c.parameters.elastic.effective_young_modulus}));
    const Big apart = norm(big(b.contact.force_on_1 - rotation * a.contact.force_on_1));
    EXPECT_LT(units(apart, r.normal_scale + r.tangential_scale), 64) << i;
  }
}

TEST(Reference, OrderOfTheBodiesDoesNotMatter) {
  // If bodies 1 and 2 are swapped, normal, velocity and stored force change sign. So must the
  // response, to the last bit.
  Random random;
  for (int i = 0; i < std::min(configurations(), 100000); ++i) {
    Configuration c = drawn(random);
    ContactHistory history = c.history;
    const JointResponse one = joint_response(c.law, c.parameters, c.at, history);
    const Vector3 stored = history.tangential_force;
    c.at.contact.normal = -c.at.contact.normal;
    c.at.contact.relative_velocity = -c.at.contact.relative_velocity;
    std::swap(c.at.motion_1.velocity, c.at.motion_2.velocity);
    history = c.history;
    history.tangential_force = -history.tangential_force;
    const JointResponse other = joint_response(c.law, c.parameters, c.at, history);
    EXPECT_EQ(other.contact.force_on_1, -one.contact.force_on_1) << i;
    EXPECT_EQ(other.contact.friction_dissipation, one.contact.friction_dissipation) << i;
    EXPECT_EQ(history.tangential_force, -stored) << i;
  }
}

TEST(Reference, UnitsDoNotMatter) {
  // In other units of length, mass and time the response must be the same to the last bit. Each
  // unit changes by a power of 4, which keeps the rounding of numbers and square roots.
  Random random;
  for (int i = 0; i < std::min(configurations(), 100000); ++i) {
    Configuration c = drawn(random);
    ContactHistory history = c.history;
    const JointResponse one = joint_response(c.law, c.parameters, c.at, history);
    const double length = std::ldexp(1.0, 2 * (random.below(9) - 4));
    const double mass = std::ldexp(1.0, 2 * (random.below(9) - 4));
    const double time = std::ldexp(1.0, 2 * (random.below(9) - 4));
    const double force = mass * length / (time * time), speed = length / time;
    c.law.contact_length *= length;
    c.law.smallest_impact_speed *= speed;
    c.law.friction_parameters.v0 *= speed;
    c.law.friction_parameters.v1 *= speed;
    c.parameters.elastic.effective_young_modulus *= force / (length * length);
    c.parameters.elastic.effective_shear_modulus *= force / (length * length);
    c.parameters.effective_mass *= mass;
    JointKinematics& at = c.at;
    at.geometry = {at.geometry.journal_radius * length, at.geometry.bearing_radius * length,
                   at.geometry.length * length};
    at.contact.penetration_depth *= length;
    at.contact.effective_radius *= length;
    at.contact.eccentricity *= length;
    at.contact.arm_1 *= length;
    at.contact.arm_2 *= length;
    at.contact.relative_velocity *= speed;
    at.motion_1.velocity *= speed;
    at.motion_1.angular_velocity /= time;
    at.impact_speed *= speed;
    at.clearance_rate *= speed;
    at.time_step *= time;
    ContactHistory other = c.history;
    other.tangential_force *= force;
    other.tangential_stiffness *= force / length;
    const JointResponse there = joint_response(c.law, c.parameters, at, other);
    EXPECT_EQ(there.contact.force_on_1, force * one.contact.force_on_1) << i;
    EXPECT_EQ(there.contact.normal_stiffness, force / length * one.contact.normal_stiffness) << i;
    EXPECT_EQ(there.contact.damping_dissipation, force * length * one.contact.damping_dissipation)
        << i;
  }
}

}  // namespace
}  // namespace statejump::kernel::laws
