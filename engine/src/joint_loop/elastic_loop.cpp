// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/joint_loop/elastic_loop.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "elastic_loop_equations.hpp"
#include "numerics/change_between.hpp"
#include "statejump/failure.hpp"
#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::joint_loop {

using Eigen::Vector2d;
using kernel::require;
using namespace detail;

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr int halving_limit = 40;
/// F_t counts as at its limit if its relative distance from μ F_N is below this value. It exceeds
/// numerical errors, so that a path that only touches the limit does not slip.
constexpr double limit_rounding = 1e-10;

/// Rejects laws that these equations do not contain.
void validate_laws(const linkage::Linkage& model) {
  using namespace kernel::laws;
  const NormalLaw& normal = model.law.normal;
  if (!has(normal, Trait::point_contact)) {
    throw kernel::OutOfRange("normal", law_info(normal).name,
                             names_with<NormalLaw>(Trait::point_contact) + " in the elastic loop");
  }
  const TangentialVelocityLaw& velocity = model.law.tangential_velocity;
  if (has(velocity, Trait::needs_axis)) {
    throw kernel::OutOfRange("tangential_velocity", law_info(velocity).name,
                             names_with<TangentialVelocityLaw>(Trait::needs_axis, false) +
                                 " in the elastic loop: friction's moments act on the links");
  }
}

bool slips_at_the_rim(const linkage::Linkage& model) {
  return std::holds_alternative<kernel::laws::MindlinDeresiewiczFriction>(model.law.friction);
}

/// The equations assume Hertz's force. This function checks that a normal law with the trait
/// point_contact has it.
/// @param p parameters at ΔT = 0
void require_hertz(const linkage::Linkage& model, const Parameters& p) {
  const double depth = 1e-3 * model.radial_clearance();
  const double expected = normal_force(p, depth);
  const kernel::ElasticPair pair =
      kernel::elastic_pair(model.link_bc.young_modulus, model.link_bc.poisson_ratio,
                           model.link_ab.young_modulus, model.link_ab.poisson_ratio);
  const double found =
      evaluate(model.law.normal, depth,
               {model.journal_radius, model.bearing_radius, model.law.contact_length},
               {pair.effective_young_modulus})
          .force;
  // Rounding of R2 - R1 leaves about 1e-14.
  if (std::abs(found - expected) <= 1e-9 * expected) return;
  char text[120];
  std::snprintf(text, sizeof text,
                "a law that is Hertz's point contact as it says, %.9g N, not %.9g N", expected,
                found);
  throw kernel::OutOfRange("normal", law_info(model.law.normal).name, text);
}

[[noreturn]] void fail(const Equilibrium& at) {
  FailureFields fields{FailureKind::not_converged};
  fields.sought = "no equilibrium found";
  fields.temperature_change = at.p.temperature_change;
  fields.numbers = {{"force_residual", at.force_residual},
                    {"closure_residual_m", at.closure_residual}};
  throw Failure(std::move(fields));
}

Equilibrium start(const linkage::Linkage& model, const Equations& equations, double contact_angle) {
  model.validate();
  validate_laws(model);
  const int side = loaded_side(model, contact_angle);
  // The position of rigid bodies comes first; moments about A then give the force (f, 0), which
  // deflects each spring.
  const JointPoint rigid = joint_point(model, 0.0, side, contact_angle);
  Equilibrium at;
  at.p = parameters(model, 0.0);
  require_hertz(model, at.p);
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

/// Finds the root of a function that is < 0 at `before` and >= 0 at `after` by false position
/// (Illinois method). `value(x, y)` returns whether it could compute y. The result has value >= 0,
/// or is NaN.
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

/// Follows the path.
class PathFollower {
 public:
  PathFollower(const linkage::Linkage& model, const ElasticLoopOptions& options,
               double contact_angle, ElasticLoop& loop)
      : model_(model),
        equations_(model),
        compliance_(options.compliance),
        mu_(model.friction_coefficient()),
        loop_(loop),
        now_(start(model, equations_, contact_angle)) {
    slips_ = mu_ == 0.0 || std::abs(contact_angle) >= std::atan(mu_);
    sign_ = contact_angle < 0.0 ? -1.0 : 1.0;
    side_ = equations_.moment(now_.z) < 0.0 ? -1.0 : 1.0;
    if (compliance_ == TangentialCompliance::mindlin && slips_at_the_rim(model)) {
      // Both forces have grown at a constant ratio, as in loaded_state(), so no annulus has
      // slipped.
      partial_.friction_coefficient = mu_;
      partial_.step(now_.p, now_.z[dep], -1.5 * now_.z[ft] / now_.stiffness(), partial_.memory);
      is_partial_ = true;
    }
    stick_from_here();
    note(now_);
    loop_.points.push_back(point());
  }

  /// Decides whether the contact sticks or slips when ΔT starts to change towards `to`.
  void turn(double to) {
    heading_ = to > now_.p.temperature_change ? 1.0 : -1.0;
    if (is_partial_) {
      slips_ = false;
    } else if (slips_ && mu_ > 0.0 && !(slip_rate(now_) < 0.0)) {
      slips_ = false;
    }
    loop_.points.back() = point();
    event();
  }

  /// Continues to ΔT = `to`; false if contact is lost before.
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
      const bool slipped = slips_;
      accept(next);
      target = to;
      if (outcome == Outcome::arrives) {
        if (slips_ != slipped) event();  // for partial slip; other changes have their own event
        continue;
      }
      if (outcome == Outcome::separates) loop_.separated = true;
      if (outcome == Outcome::turns) {
        if (++failures > halving_limit) fail(next);  // the status alternates without progress
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
    result.sticks = is_partial_ || !slips_;
    result.partial = is_partial_ ? &partial_ : nullptr;
    result.ratio = sign_ * mu_;
    result.compliance = compliance_;
    result.from = &now_;
    result.arc = arc_;
    result.past = past_;
    return result;
  }

  enum class Outcome : unsigned char { arrives, turns, separates, fails };

  /// Attempts one step towards `to` in the current motion. It ends at the first event; sets sign_
  /// if slip starts.
  Outcome attempt(double to, Equilibrium& next) {
    next = now_;
    if (!reach(to, next)) return Outcome::fails;
    Outcome outcome = Outcome::arrives;
    if (!equations_.touches(next)) {
      outcome = Outcome::separates;
      next = last_contact(to);
    }
    if (mu_ == 0.0 || is_partial_) return outcome;
    if (slips_) {
      if (slip_rate(next) < 0.0) return outcome;
      if (!(slip_rate(now_) < 0.0)) {
        next = now_;
        return Outcome::turns;
      }
      return find(next, [this](const Equilibrium& at) { return slip_rate(at); });
    }
    // Sign of the friction limit that F_t exceeds. At the start of the step, F_t may be at the
    // opposite limit.
    const double sign = next.z[ft] < 0.0 ? -1.0 : 1.0;
    if (!(excess(sign, next) > limit_rounding * mu_ * next.normal())) return outcome;
    sign_ = sign;
    if (excess(sign, now_) > -limit_rounding * mu_ * now_.normal()) {
      // F_t is already at the limit. Either slip starts here, or F_t leaves the limit and returns
      // later.
      if (!(slip_rate(now_) < 0.0)) return Outcome::fails;
      next = now_;
      return Outcome::turns;
    }
    return find(next, [&](const Equilibrium& at) { return excess(sign, at); });
  }

  /// Equilibrium at ΔT = `to`, with `next` as initial guess.
  bool reach(double to, Equilibrium& next) const {
    next.p = parameters(model_, to);
    return equations_.solve(line(), next);
  }

  /// Force along `sign` beyond Coulomb's limit [N].
  double excess(double sign, const Equilibrium& at) const {
    return sign * at.z[ft] - mu_ * at.normal();
  }

  /// Plastic slide along F_t per kelvin of temperature change [m/K]. It is negative in slip,
  /// because friction opposes the slide.
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

  /// Finds the last point in contact before `to` by bisection. Without force the contact direction
  /// is undefined. Points without convergence therefore count as points without contact.
  Equilibrium last_contact(double to) const {
    Equilibrium last = now_;
    const auto parts = [&](double change) {
      Equilibrium trial = last;
      const bool touches = reach(change, trial) && equations_.touches(trial);
      if (touches) last = trial;
      return !touches;
    };
    numerics::change_between(last.p.temperature_change, to, parts);
    return last;
  }

  /// Replaces `next`, where `value` >= 0, by the first such point.
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
    if (is_partial_) {
      const Slide& slide = equations_.slide();
      const double moved = slide.arc(next.z) - arc_ + slide.rest(now_, next.p, next.z);
      kernel::PartialSlipMemory after;
      slips_ = partial_.step(next.p, next.z[dep], moved, after).slipping;
      partial_.memory = after;
    }
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

  const linkage::Linkage& model_;
  Equations equations_;
  TangentialCompliance compliance_;
  double mu_;
  ElasticLoop& loop_;
  Equilibrium now_;
  bool slips_ = false;
  bool is_partial_ = false;
  PartialSlip partial_;
  double sign_ = 1.0;     ///< of F_t in slip
  double side_ = 1.0;     ///< of the joint force along AC
  double heading_ = 1.0;  ///< of dΔT
  double arc_ = 0.0;      ///< see FrictionLine
  double past_ = 0.0;
};

}  // namespace

linkage::State loaded_state(const linkage::Linkage& model, double contact_angle) {
  const Equilibrium at = start(model, Equations(model), contact_angle);
  linkage::State state;
  state.bearing_centre = (at.p.l1.value + at.z[e1]) * direction(at.z[th2]);
  state.journal_centre =
      Vector2d(model.frame_length, 0.0) + (at.p.l2.value + at.z[e2]) * direction(at.z[th4]);
  const kernel::Vector3 friction(at.z[ft], 0.0, 0.0);
  state.contact = kernel::laws::preloaded_history(
      model.law.friction, model.law.friction_parameters, friction,
      {at.normal(), at.stiffness(), kernel::Vector3::Zero(), 1.0, kernel::Vector3::UnitY()});
  state.impact_speed = model.law.smallest_impact_speed;
  return state;
}

ElasticLoop elastic_loop(const linkage::Linkage& model, const thermal::Program& program,
                         const ElasticLoopOptions& options, double contact_angle) {
  model.validate();
  program.validate();
  require(options.samples >= 1, "samples", options.samples, ">= 1");
  const std::vector<thermal::Branch> branches = thermal::monotone_branches(program);
  for (const thermal::Branch& branch : branches) {
    const Parameters p = parameters(model, branch.end);
    require(p.r1.value > 0.0 && p.clearance() > 0.0, "radial clearance", p.clearance(),
            "> 0 m at every temperature of the program");
  }
  ElasticLoop loop;
  PathFollower follower(model, options, contact_angle, loop);
  for (const thermal::Branch& branch : branches) {
    if (branch.end == branch.start) continue;
    follower.turn(branch.end);
    for (int i = 1; i <= options.samples; ++i) {
      const double part = static_cast<double>(i) / options.samples;
      const double to =
          i == options.samples ? branch.end : branch.start + part * (branch.end - branch.start);
      if (!follower.advance(to)) return loop;
      follower.sample();
    }
  }
  follower.event();
  return loop;
}

}  // namespace statejump::joint_loop
