// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "statejump/kernel/frame.hpp"
#include "statejump/kernel/hertz.hpp"
#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::truss::detail {

namespace laws = kernel::laws;

namespace {

/// Laws of one contact for kernel::contact_step(). A friction law with memory receives the mean
/// velocity since the last step, from the integrated slide. Dashpots receive the present velocity.
struct StageLaws {
  const laws::JointLaw& law;
  const laws::FrictionParameters friction_parameters;
  laws::NormalState normal_state;
  double stiffness;  ///< k_t [N/m]
  Vector3d speed;    ///< First part relative to the second [m/s].
  Vector3d slide;    ///< Integrated since the last step [m].
  bool remembers;
  double since;
  Vector3d across;
  Vector3d force = Vector3d::Zero();

  static constexpr bool dissipates = false;
  static constexpr bool always_spring = false;

  const laws::NormalState& normal() const { return normal_state; }
  const Vector3d& velocity() const { return speed; }
  double tangential_stiffness(const laws::NormalState&) const { return stiffness; }
  kernel::MindlinEnergy friction(double k, double, double pressed, const Vector3d& instant,
                                 kernel::ContactHistory& history) {
    const Vector3d rubs = remembers ? Vector3d(slide / since) : instant;
    const laws::FrictionResponse found = laws::evaluate(law.friction, friction_parameters,
                                                        {pressed, k, rubs, since, across}, history);
    force = found.force_on_1;
    return {found.elastic_energy, found.dissipation};
  }
  const Vector3d& friction_force(const kernel::ContactHistory&) const { return force; }
};

}  // namespace

/// Geometry of a contact in a stage.
struct KernelContacts::Place {
  Vector3d normal;
  double clearance = 0.0;
  double radius = 0.0;
};

KernelContacts::KernelContacts(const System& system, const VectorXd& damping,
                               const std::string& friction_law)
    : system_(&system) {
  law_.friction = laws::friction_law(friction_law);
  remembers_ = laws::has(law_.friction, laws::Trait::has_memory);
  const Model& model = system.model();
  int column = system.displacements();
  for (int i = 0; i < static_cast<int>(model.joints.size()); ++i) {
    const Joint& joint = model.joints[index(i)];
    const JointFrame frame = std::visit([&](const auto& one) { return one.frame(model); }, joint);
    std::visit(
        [&](const auto& one) { add(i, column, one, damping.size() == 0 ? 0.0 : damping[i]); },
        joint);
    column += frame.forces;
  }
}

void KernelContacts::refuse(const char* kind, const std::string& name, const char* why) {
  throw std::invalid_argument(std::string(kind) + " '" + name + "' " + why +
                              ": it cannot move by the scheme 'regularised'");
}

void KernelContacts::add(int joint, int first_column, const Slider& slider, double damping) {
  if (slider.second >= 0) refuse(Slider::kind, slider.name, "is between two nodes");
  if (slider.has_soft_stops()) {
    soft_stops_.push_back(&slider);
  } else if (std::isfinite(slider.clearance_minus) || std::isfinite(slider.clearance_plus)) {
    refuse(Slider::kind, slider.name, "has rigid stops");
  }
  if (slider.friction_force == 0.0) return;
  if (std::isinf(slider.tangential_stiffness)) {
    refuse(Slider::kind, slider.name, "sticks rigidly");
  }
  KernelContact made;
  made.joint = joint;
  made.first_column = first_column;
  made.first = slider.first;
  made.axis = slider.axis;
  made.normal = slider.axis.unitOrthogonal();
  made.parameters.friction_coefficient = 1.0;
  made.parameters.tangential_damping_ratio = 0.5 * damping;  // of a mass of 1 kg
  made.parameters.effective_mass = 1.0;
  made.pressed = slider.friction_force;
  made.held = slider.tangential_stiffness;
  made.annuli.play = slider.play;
  all_.push_back(made);
}

KernelContact KernelContacts::round(const KernelContact& parts, double hertz, double mindlin,
                                    double friction_coefficient, double damping,
                                    const JointFrame& frame) {
  KernelContact made = parts;
  made.first = frame.nodes[0];
  made.second = frame.nodes[1];
  made.first_far = frame.nodes[2];
  made.second_far = frame.nodes[3];
  made.program = frame.program;
  made.temperature_fraction = frame.temperature_fraction;
  // Moduli that give the joint's stiffnesses K = 4/3 E* √R and 8 G* √R.
  const double root =
      std::sqrt(kernel::internal_effective_radius(made.first_radius, made.second_radius));
  made.parameters.elastic = {0.75 * hertz / root, 0.125 * mindlin / root};
  made.parameters.friction_coefficient = friction_coefficient;
  made.parameters.normal_damping_ratio = 0.5 * damping;  // of a mass of 1 kg
  made.parameters.tangential_damping_ratio = 0.5 * damping;
  made.parameters.effective_mass = 1.0;
  return made;
}

void KernelContacts::add(int joint, int first_column, const ClearanceRevolute& revolute,
                         double damping) {
  const JointFrame frame = revolute.frame(system_->model());
  if (frame.holds[2]) refuse(ClearanceRevolute::kind, revolute.name, "holds its nodes together");
  if (std::isinf(revolute.mindlin_stiffness)) {
    refuse(ClearanceRevolute::kind, revolute.name, "has a rigid contact, or sticks rigidly");
  }
  KernelContact made;
  made.joint = joint;
  made.first_column = first_column;
  made.axis = frame.axes.col(2);
  made.normal = frame.axes.col(0);
  made.first_radius = revolute.journal_radius;
  made.second_radius = revolute.journal_radius + revolute.radial_clearance;
  made.first_expansion = revolute.journal_thermal_expansion;
  made.second_expansion = revolute.bearing_thermal_expansion;
  all_.push_back(round(made, revolute.hertz_stiffness, revolute.mindlin_stiffness,
                       revolute.friction_coefficient, damping, frame));
}

void KernelContacts::add(int joint, int first_column, const BallJoint& socketed, double damping) {
  if (std::isinf(socketed.mindlin_stiffness)) {
    refuse(BallJoint::kind, socketed.name, "has a rigid contact, or sticks rigidly");
  }
  const JointFrame frame = socketed.frame(system_->model());
  KernelContact made;
  made.joint = joint;
  made.first_column = first_column;
  made.is_ball = true;
  made.axis.setZero();
  made.first_radius = socketed.ball_radius;
  made.second_radius = socketed.ball_radius + socketed.radial_clearance;
  made.first_expansion = socketed.ball_thermal_expansion;
  made.second_expansion = socketed.socket_thermal_expansion;
  all_.push_back(round(made, socketed.hertz_stiffness, socketed.mindlin_stiffness,
                       socketed.friction_coefficient, damping, frame));
}

Vector3d KernelContacts::at(int node, const VectorXd& free) const {
  return node < 0 ? Vector3d::Zero() : system_->displacement(node, free);
}

void KernelContacts::push(int node, const Vector3d& by, VectorXd& force) const {
  if (node < 0) return;
  system_->dofs().add_force(node, by, force);
}

void KernelContacts::push(int node, int far, const Vector3d& by, const Vector3d& torque,
                          const VectorXd& q, VectorXd& force) const {
  push(node, by, force);
  if (far < 0) return;
  const Model& model = system_->model();
  const Vector3d along = model.nodes[index(node)].position - model.nodes[index(far)].position +
                         at(node, q) - at(far, q);
  const Vector3d couple = torque.cross(along) / along.squaredNorm();
  push(node, couple, force);
  push(far, -couple, force);
}

kernel::BodyMotion KernelContacts::motion(int node, int far, const Stage& stage) const {
  const Model& model = system_->model();
  kernel::BodyMotion found{model.nodes[index(node)].position + at(node, stage.q), at(node, stage.v),
                           Vector3d::Zero()};
  if (far >= 0) {
    const Vector3d along = found.position - model.nodes[index(far)].position - at(far, stage.q);
    found.angular_velocity = along.cross(found.velocity - at(far, stage.v)) / along.squaredNorm();
  }
  return found;
}

void KernelContacts::push_soft_stops(const VectorXd& q, VectorXd& force) const {
  for (const Slider* slider : soft_stops_) {
    const double slide = slider->axis.dot(at(slider->first, q));
    push(slider->first, -slider->soft_stop_force(slide) * slider->axis, force);
  }
}

kernel::ContactResponse KernelContacts::answer_with_play(const KernelContact& contact,
                                                         const Stage& stage, double slide,
                                                         VectorXd& force, double* rates) const {
  rates[0] = contact.axis.dot(at(contact.first, stage.v));
  rates[1] = rates[2] = 0.0;
  const Vector2d none = Vector2d::Zero();
  const SlipAnnuli::Law law =
      contact.annuli.law(contact.loads_annuli(), {slide, 0.0}, none, stage.since);
  const double friction = law.friction[0];
  kernel::ContactResponse found{};
  found.normal_force = contact.pressed;
  found.tangential_stiffness = law.by_slide(0, 0);
  found.tangential_force = found.force_on_1 = -friction * contact.axis;
  found.tangential_elastic_energy = 0.5 * friction * friction / contact.held;
  push(contact.first, found.tangential_force, force);
  return found;
}

double KernelContacts::take_play(KernelContact& contact, double slide) {
  const double before = contact.annuli.bend;
  contact.annuli.take(contact.loads_annuli(), {slide, 0.0});
  contact.history.slipping = contact.annuli.slip_all;
  return contact.pressed * std::abs(slide - (contact.annuli.bend - before));
}

kernel::ContactResponse KernelContacts::answer(const KernelContact& contact, const Stage& stage,
                                               const double* way, kernel::ContactHistory& history,
                                               VectorXd& force, double* rates, Place& place) const {
  if (contact.has_play()) return answer_with_play(contact, stage, way[0], force, rates);
  const Model& model = system_->model();
  StageLaws response{law_,
                     {contact.parameters.friction_coefficient, 0.0, 1e-3},
                     {},
                     0.0,
                     {},
                     {},
                     remembers_,
                     stage.since,
                     Vector3d::Zero()};
  if (contact.is_pad()) {
    place.normal = contact.normal;
    const double speed = contact.axis.dot(at(contact.first, stage.v));
    response.normal_state = {contact.pressed, 0.0, 0.0, 0.0};
    response.stiffness = contact.held;
    response.speed = speed * contact.axis;
    response.slide = way[0] * contact.axis;
    response.across = place.normal;
    rates[0] = speed;
    rates[1] = rates[2] = 0.0;
    kernel::ContactResponse found =
        kernel::contact_step(response, contact.parameters, place.normal, 1.0, stage.since, history);
    push(contact.first, contact.axis * contact.axis.dot(found.tangential_force), force);
    return found;
  }
  const double change =
      model.temperature_change(contact.program, contact.temperature_fraction, stage.time);
  const double inner = contact.first_radius * (1.0 + contact.first_expansion * change);
  const double outer = contact.second_radius * (1.0 + contact.second_expansion * change);
  const kernel::BodyMotion first = motion(contact.first, contact.first_far, stage);
  const kernel::BodyMotion second = motion(contact.second, contact.second_far, stage);
  const kernel::JointContact touch =
      contact.is_ball ? kernel::ball_contact(first, inner, second, outer)
                      : kernel::revolute_contact(first, inner, second, outer, contact.axis);
  const Vector3d& n = touch.normal;
  place = {n, outer - inner, touch.effective_radius};
  const Vector3d before = contact.normal.unitOrthogonal();
  const Vector3d along = kernel::transport(before, contact.normal, n, way[2]);
  const Vector3d beside = n.cross(along);
  const Vector3d& speed = touch.relative_velocity;
  rates[0] = speed.dot(along);
  rates[1] = speed.dot(beside);
  rates[2] = 0.5 * (first.angular_velocity + second.angular_velocity).dot(n);
  history.tangential_force = kernel::transport(history.tangential_force, contact.normal, n, way[2]);
  if (!history.tangential_axis.isZero(0.0)) {
    history.tangential_axis = kernel::transport(history.tangential_axis, contact.normal, n, way[2]);
  }
  response.normal_state =
      laws::evaluate(law_.normal, touch.penetration_depth, {inner, outer, law_.contact_length},
                     {contact.parameters.elastic.effective_young_modulus});
  response.stiffness =
      laws::tangential_stiffness(contact.parameters.elastic, response.normal_state.stiffness);
  response.speed = speed;
  response.slide = way[0] * along + way[1] * beside;
  response.across = n;
  kernel::ContactResponse found = kernel::contact_step(
      response, contact.parameters, n, touch.penetration_depth, stage.since, history);
  const kernel::Wrench on = kernel::contact_wrench(found.force_on_1, touch.arm_1, touch.arm_2);
  push(contact.first, contact.first_far, on.force_1, on.torque_1, stage.q, force);
  push(contact.second, contact.second_far, on.force_2, on.torque_2, stage.q, force);
  return found;
}

VectorXd KernelContacts::start_way(const State& start, StartFriction friction) const {
  VectorXd way = VectorXd::Zero(numbers());
  if (friction == StartFriction::frictionless) return way;
  const bool rim_slips = laws::has(law_.friction, laws::Trait::needs_point_contact);
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const KernelContact& contact = all_[i];
    if (!contact.is_pad() || (!remembers_ && !contact.has_play())) continue;
    double& slide = way[static_cast<Eigen::Index>(3 * i)];
    const Model& model = system_->model();
    const double there = output(model, start, contact.joint, "slide_m")[0];
    if (contact.has_play()) {
      slide = there;  // from the reference configuration, with zero slip
      continue;
    }
    const double rubs = output(model, start, contact.joint, "slider_force_N")[0] -
                        std::get<Slider>(model.joints[index(contact.joint)]).soft_stop_force(there);
    const double share = std::min(std::abs(rubs) / contact.pressed, 1.0);
    // Slide times stiffness, divided by the friction limit: of Cattaneo's contact under a constant
    // normal force, or of a spring.
    const double gives = rim_slips ? 1.5 * (1.0 - std::cbrt((1.0 - share) * (1.0 - share))) : share;
    slide = std::copysign(gives * contact.pressed / contact.held, rubs);
  }
  return way;
}

void KernelContacts::respond(const Stage& stage, VectorXd& force, VectorXd& rates) const {
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const auto first = static_cast<Eigen::Index>(3 * i);
    kernel::ContactHistory history = all_[i].history;
    Place place;
    answer(all_[i], stage, stage.way.data() + first, history, force, rates.data() + first, place);
  }
  push_soft_stops(stage.q, force);
}

void KernelContacts::commit(const Stage& stage, VectorXd& force, VectorXd& rates,
                            KernelHeat& heat) {
  push_soft_stops(stage.q, force);
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const auto first = static_cast<Eigen::Index>(3 * i);
    KernelContact& contact = all_[i];
    Place place;
    kernel::ContactResponse found = answer(contact, stage, stage.way.data() + first,
                                           contact.history, force, rates.data() + first, place);
    if (contact.has_play()) found.friction_dissipation = take_play(contact, stage.way[first]);
    heat.friction[contact.joint] += found.friction_dissipation;
    heat.damping += found.damping_dissipation;
    if (!contact.is_pad() && contact.radius > 0.0) {
      // If parts expand, the clearance works against the force, and the effective radius changes
      // the energy at a given depth.
      const double pressed =
          0.5 * (found.elastic_normal_force + contact.response.elastic_normal_force);
      const double stored =
          0.5 * (found.normal_elastic_energy + contact.response.normal_elastic_energy);
      heat.thermal_work -= pressed * (place.clearance - contact.clearance);
      heat.thermal_work +=
          stored / (place.radius + contact.radius) * (place.radius - contact.radius);
    }
    contact.response = found;
    contact.normal = place.normal;
    contact.clearance = place.clearance;
    contact.radius = place.radius;
  }
}

void KernelContacts::write(VectorXd& z, Statuses& statuses) const {
  for (const KernelContact& contact : all_) {
    const kernel::ContactResponse& found = contact.response;
    JointStatus& status = statuses[index(contact.joint)];
    const Vector3d rubs = contact.history.tangential_force;  // on the first part
    const bool slips = contact.history.slipping || (!remembers_ && !rubs.isZero(0.0));
    if (contact.is_pad()) {
      const double against = -contact.axis.dot(found.tangential_force);
      // The unknown of a slider is its friction without the force of the play, see Slider.
      z[contact.first_column] =
          contact.has_play() ? against + contact.held * contact.annuli.played() : against;
      status = !slips          ? JointStatus::stick
               : against > 0.0 ? JointStatus::slip_plus
                               : JointStatus::slip_minus;
      continue;
    }
    const Vector3d friction = found.tangential_force;
    const bool open = !(found.normal_force > 0.0);
    if (contact.is_ball) {
      const JointFrame frame = std::get<BallJoint>(system_->model().joints[index(contact.joint)])
                                   .frame(system_->model());
      z.segment<3>(contact.first_column) =
          frame.axes.transpose() * (found.normal_force * contact.normal - friction);
      status = open ? JointStatus::open : slips ? JointStatus::slip_plus : JointStatus::stick;
      continue;
    }
    const double against = -contact.axis.cross(contact.normal).dot(friction);
    z[contact.first_column] = found.normal_force;
    z[contact.first_column + 1] = against;
    status = open            ? JointStatus::open
             : !slips        ? JointStatus::stick
             : against > 0.0 ? JointStatus::slip_plus
                             : JointStatus::slip_minus;
  }
}

double KernelContacts::stored() const {
  double sum = 0.0;
  for (const KernelContact& contact : all_) {
    sum += contact.response.tangential_elastic_energy + contact.response.normal_elastic_energy;
  }
  return sum;
}

/// Largest inverse mass of a node along its free directions [1/kg].
double KernelContacts::mobility(int node, const VectorXd& inverse_mass) const {
  const NodeDofs& at = system_->dofs().at(node);
  double largest = 0.0;
  for (int i = 0; i < at.freedoms; ++i) {
    double along = 0.0;
    at.each_term(i, [&](int row, double factor) { along += factor * factor * inverse_mass[row]; });
    largest = std::max(largest, along);
  }
  return largest;
}

double KernelContacts::stiffest(const VectorXd& q, const VectorXd& inverse_mass) const {
  double found = 0.0;
  for (const Slider* slider : soft_stops_) {
    const double slide = slider->axis.dot(at(slider->first, q));
    if (slider->soft_stop_force(slide) == 0.0) continue;
    found = std::max(found, slider->stop_stiffness * mobility(slider->first, inverse_mass));
  }
  for (const KernelContact& contact : all_) {
    double inverse = 0.0;
    for (const int node : {contact.first, contact.second}) {
      inverse += mobility(node, inverse_mass);
    }
    const double stiffness =
        std::max(contact.response.normal_stiffness, contact.response.tangential_stiffness);
    found = std::max(found, stiffness * inverse);
  }
  return found;
}

}  // namespace statejump::truss::detail
