// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/joints/revolute.hpp"

#include <algorithm>
#include <cmath>

#include "statejump/kernel/require.hpp"
#include "statejump/truss/model.hpp"
#include "truss/joints/hertz_contact.hpp"
#include "truss/joints/partial_slip.hpp"
#include "truss/joints/relative_rotation.hpp"
#include "truss/joints/writer.hpp"
#include "truss/parts.hpp"

namespace statejump::truss {

using detail::angle_derivatives;
using detail::ByNormal;
using detail::HertzContact;
using detail::index;
using detail::Matrix32;
using detail::planar_angle;
using detail::PlanarAngle;
using detail::turn_by;
using detail::turned_left;
using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

/// Largest angle [rad] by which a contact may move around its bearing in one step. A larger angle
/// in a step of the shortest length is a jump.
constexpr double most_turned = 0.5;

// Local sites: journal, bearing, and what rotates them, the far ends of links or the rotations of
// their own nodes.
constexpr std::size_t journal = 0;
constexpr std::size_t bearing = 1;
constexpr std::size_t journal_far = 2;
constexpr std::size_t bearing_far = 3;

/// Memory of a revolute in history(). With partial slip, the contact's memory follows. In-plane
/// vectors are components along its two plane directions.
struct Memory {
  Vector2d eccentricity;  ///< [m]
  /// Direction that rotates with the journal: journal minus far node of its link [m], or a unit
  /// vector at the angle of its node; zero if it does not rotate.
  Vector2d journal_direction;
  Vector2d bearing_direction;  ///< Likewise.
  double journal_radius;       ///< At the contact [m].
  double bearing_radius;       ///< Likewise.
  double normal;               ///< λ_n [N].
  double friction;             ///< On the journal against the slide [N].
  double compliance;           ///< 1/k_t [m/N]; 0: rigid or open.

  static constexpr int size = 11;
  static Memory of(const double* numbers) {
    return {{numbers[0], numbers[1]},
            {numbers[2], numbers[3]},
            {numbers[4], numbers[5]},
            numbers[6],
            numbers[7],
            numbers[8],
            numbers[9],
            numbers[10]};
  }
  void to(double* numbers) const {
    const double all[size] = {eccentricity.x(),
                              eccentricity.y(),
                              journal_direction.x(),
                              journal_direction.y(),
                              bearing_direction.x(),
                              bearing_direction.y(),
                              journal_radius,
                              bearing_radius,
                              normal,
                              friction,
                              compliance};
    std::copy(all, all + size, numbers);
  }
};

Matrix32 plane_of(const Trial& trial) {
  return trial.frame.axes.leftCols<2>();
}

HertzContact contact_of(const ClearanceRevolute& joint) {
  return {joint.hertz_stiffness, joint.mindlin_stiffness, joint.radial_clearance};
}

/// 1/k_t of a sticking contact [m/N]; 0: rigid.
double tangential_compliance(const ClearanceRevolute& joint, double normal_force) {
  return contact_of(joint).tangential_compliance(normal_force).value;
}

/// Angle from one direction to another [rad].
double turn_from(const Vector2d& before, const Vector2d& now) {
  return turn_by(before, now - before);
}

/// A revolute at one state.
struct Geometry {
  Vector2d eccentricity;
  Vector2d journal_direction;
  Vector2d bearing_direction;
  double clearance;
  double depth;  ///< Penetration of the journal into the bearing [m], >= 0.
  double journal_radius;
  double bearing_radius;
};

Geometry geometry_of(const ClearanceRevolute& joint, const Trial& trial) {
  const Matrix32 plane = plane_of(trial);
  Geometry g{};
  g.eccentricity = plane.transpose() * trial.between(bearing, journal);
  const auto direction = [&](std::size_t at, std::size_t far) -> Vector2d {
    if (trial.frame.rotates[far]) {
      const double angle = detail::node_angle(trial, far, joint.axis);
      return {std::cos(angle), std::sin(angle)};
    }
    if (trial.frame.nodes[far] < 0) return Vector2d::Zero();
    return plane.transpose() * trial.between(far, at);
  };
  g.journal_direction = direction(journal, journal_far);
  g.bearing_direction = direction(bearing, bearing_far);
  const double change = trial.temperature_change;
  const double bore = joint.journal_radius + joint.radial_clearance;
  g.clearance = trial.opening * (joint.radial_clearance + change * joint.clearance_growth());
  // Both surfaces meet half-way between them.
  g.depth = std::max(0.0, g.eccentricity.norm() - g.clearance);
  g.journal_radius =
      joint.journal_radius * (1.0 + joint.journal_thermal_expansion * change) - 0.5 * g.depth;
  g.bearing_radius = bore * (1.0 + joint.bearing_thermal_expansion * change) + 0.5 * g.depth;
  return g;
}

/// Slide of the surfaces since the start of the step, and the rotations that cause it.
struct Motion {
  double contact_turned = 0.0;  ///< Δφ [rad].
  double journal_turned = 0.0;  ///< [rad]
  double bearing_turned = 0.0;  ///< [rad]
  double slide = 0.0;           ///< Δσ [m].
};

double contact_turned(const Geometry& g, const Memory& start) {
  const bool known = start.eccentricity.squaredNorm() > 0.0 && g.eccentricity.squaredNorm() > 0.0;
  return known ? turn_from(start.eccentricity, g.eccentricity) : 0.0;
}

Motion motion_of(const Geometry& g, const Memory& start) {
  Motion motion;
  motion.contact_turned = contact_turned(g, start);
  motion.journal_turned = turn_from(start.journal_direction, g.journal_direction);
  motion.bearing_turned = turn_from(start.bearing_direction, g.bearing_direction);
  motion.slide = 0.5 * (start.eccentricity.norm() + g.eccentricity.norm()) * motion.contact_turned +
                 0.5 * (start.journal_radius + g.journal_radius) * motion.journal_turned -
                 0.5 * (start.bearing_radius + g.bearing_radius) * motion.bearing_turned;
  return motion;
}

/// Elastic part of the surface slide in a step, and its derivatives.
struct ElasticSlide {
  double slide;        ///< [m]
  double by_normal;    ///< By the normal force [m/N].
  double by_friction;  ///< By friction [m/N].
};

/// Mindlin's contact: an increase of the normal load keeps the friction force, a decrease keeps the
/// deflection.
ElasticSlide elastic_slide(const ClearanceRevolute& joint, const Trial& trial,
                           const Memory& start) {
  if (std::isinf(joint.mindlin_stiffness)) return {0.0, 0.0, 0.0};
  const auto [normal, friction, axial] = trial.force;
  const auto [compliance, slope] = contact_of(joint).tangential_compliance(normal);
  const double before = start.compliance;
  if (before == 0.0) return {compliance * friction, slope * friction, compliance};
  if (trial.softens.value_or(compliance > before)) {
    return {compliance * friction - before * start.friction, slope * friction, compliance};
  }
  // ∫ dF/k_t by the trapezoidal rule.
  const double mean = 0.5 * (before + compliance);
  const double more = friction - start.friction;
  return {mean * more, 0.5 * slope * more, mean};
}

/// Friction force with partial slip after a slide, and its derivative with respect to the normal
/// force.
struct Rubbing {
  kernel::PartialSlipLine line;
  double by_normal;
};

Rubbing rubbing(const ClearanceRevolute& joint, const Trial& trial, double slide) {
  const double normal = trial.force[0];
  const double mu = joint.friction_coefficient;
  const auto [compliance, softens] = contact_of(joint).tangential_compliance(normal);
  const double stiffness = 1.0 / compliance;
  const kernel::PartialSlipLine line = kernel::partial_slip_line(
      stiffness, mu * normal, slide, detail::read_partial_slip(trial.history + Memory::size));
  const double stiffens = -softens * stiffness * stiffness;
  return {line, line.by_limit * mu + line.by_stiffness * stiffens};
}

/// Applies the partial-slip law to the step.
/// @param memory on input at the start of the step, on output at its end
kernel::PartialSlipResponse rub(const ClearanceRevolute& joint, const Trial& trial, bool open,
                                kernel::PartialSlipMemory& memory) {
  const double slide = motion_of(geometry_of(joint, trial), Memory::of(trial.history)).slide;
  const double normal = trial.force[0];
  const double stiffness = open ? 0.0 : 1.0 / tangential_compliance(joint, normal);
  return kernel::partial_slip_step(stiffness, joint.friction_coefficient * normal, {slide, 0.0},
                                   memory);
}

/// Derivatives with respect to in-plane displacements: gradients of the slide and of the virtual
/// work of both forces, and second derivatives of this work.
struct Gradients {
  std::array<Vector2d, 4> normal;
  std::array<Vector2d, 4> friction;  ///< Virtual work of friction.
  std::array<Vector2d, 4> slide;     ///< Derivative of Δσ.
  std::array<std::array<Matrix2d, 4>, 4> hessian;
  std::array<std::array<bool, 4>, 4> bent{};  ///< Whether a block of `hessian` is set.
  Gradients() {
    normal.fill(Vector2d::Zero());
    friction.fill(Vector2d::Zero());
    slide.fill(Vector2d::Zero());
  }
  void bend(std::size_t by, std::size_t of, const Matrix2d& value) {
    if (bent[by][of]) {
      hessian[by][of] += value;
    } else {
      // Adding to +0 avoids entries −0.
      hessian[by][of] = Matrix2d::Zero() + value;
      bent[by][of] = true;
    }
  }
};

void pinned(Gradients& of) {
  for (const auto& [at, sign] : {std::pair{journal, 1.0}, std::pair{bearing, -1.0}}) {
    of.normal[at] = sign * Vector2d::UnitX();
    of.friction[at] = sign * Vector2d::UnitY();
    of.slide[at] = of.friction[at];
  }
}

/// Adds a force that damps the relative motion of journal and bearing, see
/// System::slack_stiffness().
/// @param stiffness force divided by the motion since the start of the step [N/m]
/// @returns the force on the journal [N]
Vector2d hold_slack(const Trial& trial, double stiffness, const Vector2d& eccentricity,
                    Gradients& of) {
  if (stiffness == 0.0) return Vector2d::Zero();
  for (const std::size_t at : {journal, bearing}) {
    for (const std::size_t by : {journal, bearing}) {
      of.bend(at, by, (at == by ? 1.0 : -1.0) * stiffness * Matrix2d::Identity());
    }
  }
  return stiffness * (eccentricity - Memory::of(trial.history).eccentricity);
}

/// @param motion slide and rotations in the step; zero if the derivative of the slide is not needed
/// @param bends true if second derivatives are needed
void in_contact(const Trial& trial, const Geometry& g, const Memory& start, const Motion& motion,
                bool bends, Gradients& of) {
  const double distance = g.eccentricity.norm();
  const Vector2d along = g.eccentricity / distance;
  const Vector2d left = turned_left(along);
  // Plain variables instead of a structured binding, because a lambda captures one of them.
  const double normal = trial.force[0];
  const double friction = trial.force[1];
  const double lever = 0.5 * (start.eccentricity.norm() / distance + 1.0);
  const double deeper = g.depth > 0.0 ? 0.5 : 0.0;  // −dr1/d|d| = dr2/d|d|
  // The radii also depend on the distance of the centres.
  const double slide_by_distance =
      0.5 * motion.contact_turned - 0.5 * deeper * (motion.journal_turned + motion.bearing_turned);
  for (const auto& [at, sign] : {std::pair{journal, 1.0}, std::pair{bearing, -1.0}}) {
    of.normal[at] = sign * along;
    of.friction[at] = sign * left;
    of.slide[at] = sign * (lever * left + slide_by_distance * along);
  }
  if (bends) {
    const Matrix2d bend = (normal * left - friction * along) * left.transpose() / distance;
    of.bend(journal, journal, bend);
    of.bend(bearing, bearing, bend);
    of.bend(journal, bearing, -bend);
    of.bend(bearing, journal, -bend);
  }
  // If a part rotates, its radius times the angle is added to the slide.
  const auto turn_with_node = [&](std::size_t site, double radius, double mean_radius) {
    // The first component is along the gradient of the angle, see PlanarWriter::along().
    of.friction[site] = radius * Vector2d::UnitX();
    of.slide[site] = mean_radius * Vector2d::UnitX();
    if (!bends) return;
    const Matrix2d by_distance = -friction * deeper * Vector2d::UnitX() * along.transpose();
    of.bend(site, journal, by_distance);
    of.bend(site, bearing, -by_distance);
  };
  const auto turn = [&](std::size_t at, std::size_t far, const Vector2d& direction, double radius,
                        double mean_radius) {
    if (trial.frame.rotates[far]) return turn_with_node(far, radius, mean_radius);
    const PlanarAngle angle = planar_angle(direction);
    for (const auto& [node, sign] : {std::pair{at, 1.0}, std::pair{far, -1.0}}) {
      of.friction[node] += sign * radius * angle.gradient;
      of.slide[node] += sign * mean_radius * angle.gradient;
    }
    if (!bends) return;
    const Matrix2d own = friction * radius * angle.hessian;
    const Matrix2d by_distance = -friction * deeper * angle.gradient * along.transpose();
    for (const auto& [node, sign] : {std::pair{at, 1.0}, std::pair{far, -1.0}}) {
      of.bend(node, at, sign * own);
      of.bend(node, far, -sign * own);
      of.bend(node, journal, sign * by_distance);
      of.bend(node, bearing, -sign * by_distance);
    }
  };
  if (trial.frame.nodes[journal_far] >= 0) {
    turn(journal, journal_far, g.journal_direction, g.journal_radius,
         0.5 * (start.journal_radius + g.journal_radius));
  }
  if (trial.frame.nodes[bearing_far] >= 0) {
    turn(bearing, bearing_far, g.bearing_direction, -g.bearing_radius,
         -0.5 * (start.bearing_radius + g.bearing_radius));
  }
}

}  // namespace

std::span<const Parameter<ClearanceRevolute>> ClearanceRevolute::parameters() {
  using R = ClearanceRevolute;
  static const Parameter<R> table[] = {
      {"journal_node", "journal node", "-", Allowed::node, "the case's nodes", &R::journal_node},
      {"bearing_node", "bearing node", "-", Allowed::node, "the case's nodes", &R::bearing_node},
      {"journal_link", "journal link", "-", Allowed::link_or_none, "the case's links",
       &R::journal_link},
      {"bearing_link", "bearing link", "-", Allowed::link_or_none, "the case's links",
       &R::bearing_link},
      {"journal_turns", "journal turns with its node", "-", Allowed::flag, "the case",
       &R::journal_turns},
      {"bearing_turns", "bearing turns with its node", "-", Allowed::flag, "the case",
       &R::bearing_turns},
      {"program", "program", "-", Allowed::program, "the case", &R::program},
      {"temperature_fraction", "temperature_fraction", "-", Allowed::finite, "the case",
       &R::temperature_fraction},
      {"journal_radius_m", "journal_radius", "m", Allowed::positive, "the case",
       &R::journal_radius},
      {"radial_clearance_m", "radial_clearance", "m", Allowed::positive, "the case",
       &R::radial_clearance},
      {"journal_thermal_expansion_per_K", "journal_thermal_expansion", "1/K", Allowed::finite,
       "the case", &R::journal_thermal_expansion},
      {"bearing_thermal_expansion_per_K", "bearing_thermal_expansion", "1/K", Allowed::finite,
       "the case", &R::bearing_thermal_expansion},
      {"friction_coefficient", "friction_coefficient", "-", Allowed::not_negative, "the case",
       &R::friction_coefficient},
      {"hertz_stiffness_N_per_m15", "hertz_stiffness", "N/m^1.5", Allowed::positive_or_infinite,
       "Hertz: 4/3 E* sqrt(R)", &R::hertz_stiffness},
      {"mindlin_stiffness_N_per_m15", "mindlin_stiffness", "N/m^1.5", Allowed::positive_or_infinite,
       "Mindlin: 8 G* sqrt(R)", &R::mindlin_stiffness},
      {"partial_slip", "partial_slip", "-", Allowed::flag, "the case", &R::partial_slip},
      {"axis", "axis", "-", Allowed::direction, "the case", &R::axis},
  };
  return table;
}

std::span<const Output> ClearanceRevolute::outputs() {
  // Outputs: vector from bearing centre to journal centre; normal force; friction on the journal,
  // against the slide.
  static const Output table[] = {
      {"eccentricity_m", 3}, {"normal_force_N", 1}, {"friction_force_N", 1}};
  return table;
}

void ClearanceRevolute::validate(const Model& model) const {
  const auto check = [this](bool holds, const char* field, double value, const char* range) {
    if (!holds) throw kernel::OutOfRange("revolute '" + name + "'", field, value, range);
  };
  check(journal_node != bearing_node, "bearing node", bearing_node, "another than the journal's");
  const auto check_link = [&](int link, int node, const char* field) {
    if (link == -1) return;
    const Bar& part = model.links[index(link)];
    check(part.first == node || part.second == node, field, link,
          "a link that ends at the joint's node");
  };
  check_link(journal_link, journal_node, "journal link");
  check_link(bearing_link, bearing_node, "bearing link");
  check(!journal_turns || journal_link < 0, "journal_turns", journal_turns, "0 with a link");
  check(!bearing_turns || bearing_link < 0, "bearing_turns", bearing_turns, "0 with a link");
  check(std::isinf(mindlin_stiffness) || std::isfinite(hertz_stiffness), "mindlin_stiffness",
        mindlin_stiffness, "infinite, because hertz_stiffness is");
  check(!partial_slip || (friction_coefficient > 0.0 && std::isfinite(mindlin_stiffness)),
        "partial_slip", partial_slip, "0 without friction or with a rigid contact");
  const double least =
      radial_clearance + model.lowest_strain(program, clearance_growth() * temperature_fraction);
  check(least > 0, "clearance at the program's worst temperature", least, "> 0 m");
}

int ClearanceRevolute::slip_memory_begin() const {
  return Memory::size;
}

int ClearanceRevolute::history() const {
  return slip_memory_begin() + (partial_slip ? detail::partial_slip_history(1) : 0);
}

JointFrame ClearanceRevolute::frame(const Model& model) const {
  JointFrame frame;
  frame.nodes = {journal_node, bearing_node, -1, -1};
  detail::turn_part(model, journal_far, journal_link, journal_turns, journal_node, frame);
  detail::turn_part(model, bearing_far, bearing_link, bearing_turns, bearing_node, frame);
  frame.node_count = 4;
  frame.forces = 2;
  frame.program = program;
  frame.temperature_fraction = temperature_fraction;
  frame.axes << detail::plane_of(axis), axis;
  frame.holds[2] = detail::moves_along(model.nodes[index(journal_node)], axis) ||
                   detail::moves_along(model.nodes[index(bearing_node)], axis);
  if (frame.holds[2]) ++frame.forces;
  return frame;
}

void ClearanceRevolute::evaluate(const Trial& trial, JointStatus status,
                                 JointWriter& writer) const {
  const Geometry g = geometry_of(*this, trial);
  const auto [normal, friction, axial] = trial.force;
  writer.carries(normal);
  writer.carries(friction);
  double corner[2][2] = {{0.0, 0.0}, {0.0, 0.0}};  // by λ_n and λ_t
  bool holds_normal = false;
  double slides = 0.0;  // derivative of the second row by the slide
  const bool bends = !writer.residual_only();
  Gradients of;
  Vector2d slack = Vector2d::Zero(), slack_by_normal = Vector2d::Zero();
  if (status == JointStatus::open) {
    // An open joint has no contact forces. The normal is not used: a journal exactly in the middle
    // has none.
    slack = hold_slack(trial, trial.slack_stiffness, g.eccentricity, of);
    writer.balance(0, normal);
    writer.balance(1, friction);
    corner[0][0] = corner[1][1] = 1.0;
  } else if (trial.model == JointModel::pins) {
    pinned(of);
    writer.closure(0, g.eccentricity.x());
    writer.closure(1, g.eccentricity.y());
    holds_normal = true;
    slides = 1.0;
  } else {
    const Memory start = Memory::of(trial.history);
    // The slide is not needed if the joint slips without friction, or with friction at its limit.
    const bool measures =
        trial.model == JointModel::friction && (partial_slip || status == JointStatus::stick);
    const Motion motion = measures ? motion_of(g, start) : Motion{};
    in_contact(trial, g, start, motion, bends, of);
    holds_normal = true;
    const ByNormal depth = contact_of(*this).depth(normal);
    // The opened fraction of the clearance also scales the depth, so that the start proceeds from
    // pins to contacts in small steps.
    writer.closure(0, g.eccentricity.norm() - g.clearance - trial.opening * depth.value);
    corner[0][0] = -trial.opening * depth.slope;
    const double mu = trial.model == JointModel::friction ? friction_coefficient : 0.0;
    if (partial_slip && trial.model == JointModel::friction) {
      // In metres: force difference times the compliance of a sticking contact.
      const Rubbing law = rubbing(*this, trial, motion.slide);
      const auto [compliance, softens] = contact_of(*this).tangential_compliance(normal);
      slides = trial.unslipped ? 1.0 : compliance * law.line.by_slide;
      writer.piece(detail::piece_of(law.line));
      writer.closure(1, compliance * (law.line.force - friction));
      corner[1][0] = trial.unslipped
                         ? 0.0
                         : compliance * law.by_normal + softens * (law.line.force - friction);
      corner[1][1] = -compliance;
    } else if (status == JointStatus::stick && trial.model == JointModel::friction) {
      slides = 1.0;
      const ElasticSlide elastic = elastic_slide(*this, trial, start);
      writer.closure(1, motion.slide - elastic.slide + trial.owed.x());
      corner[1][0] = -elastic.by_normal;
      corner[1][1] = -elastic.by_friction;
    } else {
      const double sense = status == JointStatus::slip_minus ? -1.0 : 1.0;
      writer.balance(1, friction - sense * mu * normal);
      corner[1][0] = -sense * mu;
      corner[1][1] = 1.0;
    }
    // Dashpots act where contact forces do not constrain the tangential direction.
    const double holds = trial.slack_held(normal, g.clearance);
    slack = hold_slack(trial, holds, g.eccentricity, of);
    if (holds > 0.0 && holds < trial.slack_stiffness) {
      slack_by_normal = -(g.eccentricity - start.eccentricity) / g.clearance;
    }
  }
  PlanarWriter planar(writer, plane_of(trial));
  for (const auto& [site, radius] :
       {std::pair{journal_far, g.journal_radius}, std::pair{bearing_far, -g.bearing_radius}}) {
    if (!trial.frame.rotates[site]) continue;
    const detail::NodeTurn turn = detail::node_turn(trial, site, axis);
    planar.along(site, turn.gradient);
    // The friction forces of statuses without contact are zero.
    const double moment = of.friction[site].isZero(0.0) ? 0.0 : friction * radius;
    if (bends) writer.block(site, site, moment * turn.hessian);
  }
  for (std::size_t a = 0; a < 4; ++a) {
    planar.force(a, normal * of.normal[a] + friction * of.friction[a]);
  }
  planar.force(journal, slack);
  planar.force(bearing, -slack);
  for (std::size_t a = 0; a < 4 && bends; ++a) {
    const double sense = a == journal ? 1.0 : a == bearing ? -1.0 : 0.0;
    planar.column(a, 0, of.normal[a] + sense * slack_by_normal);
    planar.column(a, 1, of.friction[a]);
    planar.row(0, a, (holds_normal ? 1.0 : 0.0) * of.normal[a]);
    planar.row(1, a, slides * of.slide[a]);
    for (std::size_t b = 0; b < 4; ++b) {
      if (a == b && trial.frame.rotates[a]) continue;
      if (of.bent[a][b]) {
        planar.block(a, b, of.hessian[a][b]);
      } else {
        planar.no_block(a, b);
      }
    }
  }
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) writer.corner(i, j, corner[i][j]);
  }
  if (trial.frame.holds[2]) writer.hold(2, axis, axial, axis.dot(trial.between(bearing, journal)));
}

void ClearanceRevolute::warm(const Trial& trial, JointStatus status, double temperature_rate,
                             JointWriter& writer) const {
  if (trial.model == JointModel::pins || status == JointStatus::open) return;
  const Geometry g = geometry_of(*this, trial);
  const Motion motion = motion_of(g, Memory::of(trial.history));
  // Growth rates of the radii [m/s].
  const double of_journal = temperature_rate * journal_thermal_expansion * journal_radius;
  const double of_bore =
      temperature_rate * bearing_thermal_expansion * (journal_radius + radial_clearance);
  const double clearance = trial.opening * (of_bore - of_journal);
  const double depth = g.depth > 0.0 ? -clearance : 0.0;
  const double by_journal = of_journal - 0.5 * depth;
  const double by_bearing = of_bore + 0.5 * depth;
  writer.closure(0, -clearance);
  const double slide =
      0.5 * by_journal * motion.journal_turned - 0.5 * by_bearing * motion.bearing_turned;
  if (trial.model == JointModel::friction) {
    if (partial_slip) {
      const double gives = trial.unslipped ? 1.0
                                           : tangential_compliance(*this, trial.force[0]) *
                                                 rubbing(*this, trial, motion.slide).line.by_slide;
      writer.closure(1, gives * slide);
    } else if (status == JointStatus::stick) {
      writer.closure(1, slide + trial.owed_rate.x());
    }
  }
  const double friction = trial.force[1];
  const auto turn = [&](std::size_t at, std::size_t far, const Vector2d& direction,
                        double by_radius) {
    if (trial.frame.rotates[far]) {
      const Vector3d gradient = detail::node_turn(trial, far, axis).gradient;
      return writer.force(far, friction * by_radius * gradient);
    }
    const Vector3d force =
        friction * by_radius * angle_derivatives(direction, plane_of(trial)).gradient;
    writer.force(at, force);
    writer.force(far, -force);
  };
  if (trial.frame.nodes[journal_far] >= 0) {
    turn(journal, journal_far, g.journal_direction, by_journal);
  }
  if (trial.frame.nodes[bearing_far] >= 0) {
    turn(bearing, bearing_far, g.bearing_direction, -by_bearing);
  }
}

namespace {

/// The slide of a step minus the elastic deflection, including the correction of the slip error
/// [m].
double lag_at(const ClearanceRevolute& joint, const Trial& trial, const Geometry& g) {
  const Memory start = Memory::of(trial.history);
  return motion_of(g, start).slide - elastic_slide(joint, trial, start).slide + trial.owed.x();
}

}  // namespace

Eigen::Vector3d ClearanceRevolute::slack_motion(const Trial& trial) const {
  return plane_of(trial) *
         (geometry_of(*this, trial).eccentricity - Memory::of(trial.history).eccentricity);
}

JointStatus ClearanceRevolute::decide(const Trial& trial, JointStatus status) const {
  if (trial.model == JointModel::pins) return status;
  const double mu = trial.model == JointModel::friction ? friction_coefficient : 0.0;
  const auto [normal, friction, axial] = trial.force;
  if (status == JointStatus::open) {
    const Geometry g = geometry_of(*this, trial);
    if (g.eccentricity.norm() <= g.clearance + trial.length_rounding) return status;
    return mu > 0.0 ? JointStatus::stick : JointStatus::slip_plus;
  }
  // A normal force counts as zero if it moves a slack element by at most a thousandth of the play
  // in a step, see System::slack_stiffness().
  const double slack = 1e-3 * trial.slack_stiffness * radial_clearance;
  if (normal < -trial.force_rounding - slack) return JointStatus::open;
  if (mu == 0.0 || partial_slip) return status;  // slips freely, or one row for stick and slip
  if (status == JointStatus::stick) {
    const double carried = normal < slack ? slack : normal;
    const double bound = mu * carried + trial.force_rounding;
    return friction > bound    ? JointStatus::slip_plus
           : friction < -bound ? JointStatus::slip_minus
                               : status;
  }
  const double sense = status == JointStatus::slip_plus ? 1.0 : -1.0;
  const double rounding = slide_rounding(trial, trial.length_rounding, trial.force_rounding);
  return sense * lag_at(*this, trial, geometry_of(*this, trial)) < -rounding ? JointStatus::stick
                                                                             : status;
}

void ClearanceRevolute::begin(const Trial& trial, JointStatus status, double* now) const {
  const Geometry g = geometry_of(*this, trial);
  const bool open = status == JointStatus::open;
  const auto [normal, friction, axial] = trial.force;
  if (partial_slip) {
    const double stiffness = open ? 0.0 : 1.0 / tangential_compliance(*this, normal);
    detail::write_partial_slip(detail::pressed(stiffness, friction_coefficient * normal),
                               now + Memory::size);
  }
  Memory{g.eccentricity,        g.journal_direction,
         g.bearing_direction,   g.journal_radius,
         g.bearing_radius,      normal,
         open ? 0.0 : friction, open ? 0.0 : tangential_compliance(*this, normal)}
      .to(now);
}

void ClearanceRevolute::commit(const Trial& trial, JointStatus status, double* after) const {
  begin(trial, status, after);
  if (!partial_slip) return;
  kernel::PartialSlipMemory memory = detail::read_partial_slip(trial.history + Memory::size);
  rub(*this, trial, status == JointStatus::open, memory);
  detail::write_partial_slip(memory, after + Memory::size);
}

bool ClearanceRevolute::softens(const Trial& trial) const {
  return tangential_compliance(*this, trial.force[0]) > Memory::of(trial.history).compliance;
}

Eigen::Vector3d ClearanceRevolute::lag(const Trial& trial) const {
  return {lag_at(*this, trial, geometry_of(*this, trial)), 0.0, 0.0};
}

double ClearanceRevolute::slip(const Trial& trial, const double* after_) const {
  if (partial_slip) {
    const Memory start = Memory::of(trial.history);
    const Memory after = Memory::of(after_);
    return motion_of(geometry_of(*this, trial), start).slide -
           (after.compliance * after.friction - start.compliance * start.friction);
  }
  return lag(trial).x();
}

double ClearanceRevolute::dissipation(const Trial& trial, const double* after_, double slip) const {
  const Memory start = Memory::of(trial.history);
  const Memory after = Memory::of(after_);
  if (partial_slip) {
    kernel::PartialSlipMemory memory = detail::read_partial_slip(trial.history + Memory::size);
    return rub(*this, trial, after.compliance == 0.0, memory).dissipation;
  }
  return friction_coefficient * 0.5 * (start.normal + after.normal) * std::abs(slip) +
         detail::rim_slip(start.friction * start.friction, start.compliance,
                          start.friction * after.friction, after.friction * after.friction,
                          after.compliance);
}

double ClearanceRevolute::elastic_energy(const Trial& trial, const double* now_) const {
  const Memory now = Memory::of(now_);
  const double bent = partial_slip
                          ? kernel::elastic_energy(detail::read_partial_slip(now_ + Memory::size))
                          : 0.5 * now.compliance * now.friction * now.friction;
  return contact_of(*this).energy(trial.force[0]) + bent;
}

void ClearanceRevolute::describe(const Trial& trial, double* outputs) const {
  Eigen::Map<Vector3d>(outputs, 3) = trial.between(bearing, journal);
  outputs[3] = trial.force[0];
  outputs[4] = trial.force[1];
}

double ClearanceRevolute::slide_rounding(const Trial& trial, double length, double force) const {
  return length + tangential_compliance(*this, trial.force[0]) * force;
}

bool ClearanceRevolute::remembers_when(JointStatus before, JointStatus after) const {
  if (friction_coefficient == 0.0) return false;
  if (before == JointStatus::open) return true;
  return !partial_slip && is_slip(before) && (after == JointStatus::stick || is_slip(after));
}

JointStatus ClearanceRevolute::settled(const Trial& trial, JointStatus status) const {
  if (!partial_slip || status == JointStatus::open) return status;
  const double slide = motion_of(geometry_of(*this, trial), Memory::of(trial.history)).slide;
  return detail::sliding(rubbing(*this, trial, slide).line, trial.before, trial.length_rounding);
}

std::optional<LocalContact> ClearanceRevolute::contact(const Trial& trial, JointStatus) const {
  if (partial_slip) return {};  // partial slip has no friction cone; the joint keeps its status
  // Concentric parts have no normal.
  if (trial.between(bearing, journal).isZero(0.0)) return {};
  return LocalContact{1, 0, friction_coefficient, 0.0};
}

Seat ClearanceRevolute::seat(const Trial& trial, double opened, double next,
                             double rounding) const {
  Seat seat;
  seat.force = trial.force;
  const Vector2d pin(trial.force[0], trial.force[1]);
  Vector2d normal;
  if (opened == 0.0) {
    // The journal makes contact in the direction of its pin force.
    seat.touches = pin.norm() > rounding;
    if (!seat.touches) return seat;
    normal = pin / pin.norm();
    seat.force[0] = pin.norm();
    seat.force[1] = 0.0;
  } else {
    const Vector2d eccentricity = plane_of(trial).transpose() * trial.between(bearing, journal);
    normal = eccentricity / eccentricity.norm();
  }
  seat.moved = (next - opened) * radial_clearance * (plane_of(trial) * normal);
  return seat;
}

bool ClearanceRevolute::jumps(const Trial& trial, JointStatus status) const {
  if (trial.before == JointStatus::open || status == JointStatus::open) return false;
  return std::abs(contact_turned(geometry_of(*this, trial), Memory::of(trial.history))) >
         most_turned;
}

}  // namespace statejump::truss
