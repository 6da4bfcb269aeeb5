// SPDX-License-Identifier: GPL-3.0-or-later
#include "contacts.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/hertz.hpp"
#include "statejump/kernel/require.hpp"
#include "truss/joints/partial_slip.hpp"

namespace statejump::truss::detail {

namespace {

/// A contact slips from this fraction of Coulomb's limit. The contact problem is solved to 1e-10.
constexpr double at_bound = 1.0 - 1e-8;

/// Journal minus bearing centre across the joint's axis [m].
Vector3d eccentricity(const Trial& at) {
  const Vector3d apart = at.between(1, 0);
  const Vector3d axis = at.frame.axes.col(2);
  return apart - axis.dot(apart) * axis;
}

JointStatus sliding(double friction, double bound) {
  if (bound <= 0.0) return JointStatus::slip_plus;  // slips freely in both directions
  return friction >= at_bound * bound    ? JointStatus::slip_plus
         : friction <= -at_bound * bound ? JointStatus::slip_minus
                                         : JointStatus::stick;
}

/// Stick or slip of a contact with a friction limit [N].
JointStatus rubs(const Contact& contact, double bound) {
  if (!contact.slips_in_part) return sliding(contact.friction_force, bound);
  return !contact.annuli.slip_all        ? JointStatus::stick
         : contact.friction_force >= 0.0 ? JointStatus::slip_plus
                                         : JointStatus::slip_minus;
}

}  // namespace

double Contact::depth(double force) const {
  if (is_linear()) return std::max(force, 0.0) / normal_stiffness;
  return is_elastic() && force > 0.0 ? numerics::hertz_depth(hertz_stiffness, force) : 0.0;
}

double Contact::force_at(double depth) const {
  if (is_linear()) return normal_stiffness * std::max(depth, 0.0);
  return depth > 0.0 ? numerics::hertz_force(hertz_stiffness, depth) : 0.0;
}

double Contact::slope_at(double depth) const {
  return is_linear() ? normal_stiffness : numerics::hertz_slope(hertz_stiffness, depth);
}

double Contact::tangential_compliance(double normal) const {
  if (tangential_stiffness < infinite) return 1.0 / tangential_stiffness;
  if (mindlin_stiffness == infinite) return 0.0;
  return 1.0 / numerics::mindlin_stiffness(mindlin_stiffness, std::max(depth(normal), least_depth));
}

Contact::Across Contact::across(double depth, double speed, double h) const {
  // Linear below the least depth, so that iterates without contact converge.
  const double at = std::max(depth, least_depth);
  const double stiffness = slope_at(at);
  const double elastic = force_at(at) + stiffness * (depth - at);
  // The dashpot coefficient contains the fourth root of the depth, whose derivative is unbounded at
  // zero depth. So it is evaluated at the middle of the step.
  const double dashpot = damping == 0.0 ? 0.0 : damping * std::sqrt(slope_at(std::max(-gap, 0.0)));
  const double slope = h * stiffness + dashpot;
  return {elastic, elastic - dashpot * speed, slope, h * stiffness / slope};
}

Contact::Along Contact::along(double normal, double h) const {
  const double now = tangential_compliance(normal);
  if (now == 0.0) return {0.0, 0.0};
  const double kept = std::min(compliance, now) * elastic_friction + slid;
  if (damping == 0.0) return {now, kept};
  const double share = 1.0 / (1.0 + damping * std::sqrt(now) / h);
  return {share * now, share * kept};
}

double Contact::spring_friction(double normal, double slide, double limit) const {
  const double now = tangential_compliance(normal);
  return std::clamp((std::min(compliance, now) * elastic_friction + slide) / now, -limit, limit);
}

SlipAnnuli::Pressed Contact::pressed(double elastic, double normal, double share) const {
  const double stiffness = 1.0 / tangential_compliance(elastic);
  // k_t is proportional to the cube root of the force.
  const bool stiffens = is_elastic() && depth(elastic) > least_depth;
  return {stiffness, stiffens ? share * stiffness / (3.0 * elastic) : 0.0, friction_coefficient,
          normal, damping * std::sqrt(stiffness)};
}

bool Contact::sticks(double normal, double tangential) const {
  return tangential_column >= 0 && std::abs(tangential) < at_bound * friction_coefficient * normal;
}

Contacts::Contacts(const System& system, const VectorXd& damping) : system_(&system) {
  int column = system.displacements();
  const Model& model = system.model();
  for (int i = 0; i < static_cast<int>(model.joints.size()); ++i) {
    const JointFrame frame =
        std::visit([&](const auto& one) { return one.frame(model); }, model.joints[index(i)]);
    // Balls and pads have bilateral constraints only while the start replaces them by pins.
    const bool lifts = std::holds_alternative<BallJoint>(model.joints[index(i)]) ||
                       std::holds_alternative<Pad>(model.joints[index(i)]);
    const auto held =
        lifts ? 0 : static_cast<int>(std::count(frame.holds.begin(), frame.holds.end(), true));
    for (int k = frame.forces - held; k < frame.forces; ++k) holds_.push_back(column + k);
    std::visit([&](const auto& one) { add(i, column, one); }, model.joints[index(i)]);
    column += frame.forces;
  }
  slip_in_part_ = std::any_of(all_.begin(), all_.end(),
                              [](const Contact& contact) { return contact.slips_in_part; });
  // A ball's transverse contact sticks rigidly only if its first contact does.
  hold_rigidly_ = std::any_of(all_.begin(), all_.end(), [](const Contact& contact) {
    return contact.is_rigid() || (contact.sticks_rigidly() && !contact.beside);
  });
  if (damping.size() == 0) return;
  for (Contact& contact : all_) {
    if (contact.annuli.play > 0.0) continue;  // an open play has no dashpot
    contact.damping = damping[contact.joint];
    damped_ = damped_ || contact.damping > 0.0;
  }
}

Contact& Contacts::add_friction(int joint, int column, double bound, double stiffness) {
  Contact friction;
  friction.joint = joint;
  friction.tangential_column = column;
  friction.friction_coefficient = 1.0;
  friction.given_force = bound;
  friction.tangential_stiffness = stiffness;
  friction.active = true;
  all_.push_back(friction);
  return all_.back();
}

void Contacts::add(int joint, int first_column, const LatchHinge& hinge) {
  const Model& model = system_->model();
  const Bar& link = model.links[index(hinge.first_link)];
  add_hinge(
      joint, first_column, hinge,
      (model.nodes[index(link.second)].position - model.nodes[index(link.first)].position).norm());
}

template <class Type>
void Contacts::add_hinge(int joint, int first_column, const HingeLaw<Type>& hinge, double radius) {
  springs_ = springs_ || hinge.stiffness > 0.0 || hinge.preload_moment != 0.0;
  if (!(hinge.friction_moment > 0.0)) return;
  add_friction(joint, first_column, hinge.friction_moment / radius,
               hinge.friction_stiffness / (radius * radius));
}

void Contacts::add(int joint, int first_column, const Hinge& hinge) {
  const Model& model = system_->model();
  springs_ = springs_ || hinge.curve;
  add_hinge(joint, first_column, hinge, model.nodes[index(hinge.first)].arm);
  for (int k = 1; k < hinge.frame(model).forces; ++k) turning_holds_.push_back(first_column + k);
}

void Contacts::add(int, int first_column, const RigidArm& arm) {
  const int forces = arm.frame(system_->model()).forces;
  for (int k = 0; k < forces; ++k) turning_holds_.push_back(first_column + k);
}

void Contacts::add(int joint, int first_column, const IwanJoint& iwan) {
  for (const auto& [stiffness, reach] : iwan.jenkins()) {
    if (stiffness > 0.0) add_friction(joint, first_column, stiffness * reach, stiffness);
  }
}

void Contacts::add(int joint, int first_column, const Slider& slider) {
  Contact& friction =
      add_friction(joint, first_column, slider.friction_force, slider.tangential_stiffness);
  friction.slips_in_part = slider.partial_slip != 0 || slider.play > 0.0;
  friction.annuli.play = slider.play;
  springs_ = springs_ || slider.has_soft_stops();
  if (slider.has_soft_stops()) return;
  const auto stop = [&](JointStatus which, double sign, double clearance) {
    if (std::isinf(clearance)) return;
    Contact end;
    end.joint = joint;
    end.normal_column = first_column;
    end.normal_sign = sign;
    end.stop = which;
    end.clearance = end.clearance_after = clearance;
    all_.push_back(end);
  };
  stop(JointStatus::stop_plus, -1.0, slider.clearance_plus);
  stop(JointStatus::stop_minus, 1.0, slider.clearance_minus);
}

void Contacts::add(int joint, int first_column, const ClearanceRevolute& revolute) {
  Contact contact = made(joint, revolute);
  contact.normal_column = first_column;
  contact.tangential_column = first_column + 1;
  contact.friction_coefficient = revolute.friction_coefficient;
  contact.hertz_stiffness = revolute.hertz_stiffness;
  contact.mindlin_stiffness = revolute.mindlin_stiffness;
  contact.least_depth = 1e-6 * revolute.radial_clearance;
  all_.push_back(contact);
}

void Contacts::add(int joint, int first_column, const BallJoint& socketed) {
  Contact contact = made(joint, socketed);
  contact.first_column = contact.normal_column = first_column;
  contact.tangential_column = first_column + 1;
  contact.friction_coefficient = socketed.friction_coefficient;
  contact.hertz_stiffness = socketed.hertz_stiffness;
  contact.mindlin_stiffness = socketed.mindlin_stiffness;
  contact.least_depth = 1e-6 * socketed.radial_clearance;
  BallFriction friction;
  friction.joint = &socketed;
  friction.axes = socketed.frame(system_->model()).axes;
  add_surface(contact, first_column, friction);
}

void Contacts::add(int joint, int first_column, const Pad& pad) {
  Contact contact;
  contact.joint = joint;
  contact.first_column = contact.normal_column = first_column;
  contact.tangential_column = first_column + 1;
  contact.friction_coefficient = pad.friction_coefficient;
  contact.normal_stiffness = pad.normal_stiffness;
  contact.tangential_stiffness = pad.tangential_stiffness;
  contact.turns_normal = false;
  // The law is linear anyway; this is the rounding of its depth.
  contact.least_depth = 1e-12 * system_->size();
  BallFriction friction;
  friction.pad = &pad;
  friction.axes = pad.frame(system_->model()).axes;
  friction.begin(Vector3d::Zero());
  add_surface(contact, first_column, friction);
}

void Contacts::add_surface(Contact contact, int first_column, BallFriction friction) {
  contact.ball = static_cast<int>(balls_.size());
  friction.place = all_.size();
  friction.first_column = first_column;
  Contact beside;
  beside.joint = contact.joint;
  beside.slips_in_part = contact.slips_in_part;
  beside.first_column = first_column;
  beside.tangential_column = first_column + 2;
  beside.friction_coefficient = 1.0;
  beside.ball = contact.ball;
  beside.beside = true;
  balls_.push_back(friction);
  all_.push_back(contact);
  all_.push_back(beside);
}

Statuses Contacts::closed(const VectorXd& z, double time, const StepStart& start) const {
  Statuses statuses = system_->all_stick();
  for (const Contact& contact : all_) {
    if (contact.normal_column < 0 || contact.stop != JointStatus::open) continue;
    if (!contact.turns_normal) continue;
    const Trial at = system_->trial(contact.joint, z, time, start, JointModel::friction, 1.0);
    const Vector3d apart = contact.ball < 0 ? eccentricity(at) : ball_normal(at);
    if (apart.squaredNorm() == 0.0) statuses[index(contact.joint)] = JointStatus::open;
  }
  return statuses;
}

double Contacts::slide_at_rest(const Contact& contact, const State& state,
                               StartFriction start) const {
  const Model& model = system_->model();
  const Joint& joint = model.joints[index(contact.joint)];
  const bool slides =
      std::holds_alternative<Slider>(joint) || std::holds_alternative<IwanJoint>(joint);
  if (!slides || start == StartFriction::frictionless) return 0.0;
  const char* key = std::holds_alternative<Slider>(joint) ? "slide_m" : "iwan_slide_m";
  return output(model, state, contact.joint, key)[0];
}

template <class Type>
double Contacts::hinge_friction(const Contact& contact, const State& state,
                                const Type& hinge) const {
  const auto told = [&](std::size_t which) {
    return output(system_->model(), state, contact.joint, Type::outputs()[which].key)[0];
  };
  const double radius = hinge.friction_moment / contact.given_force;
  return (told(1) - hinge.elastic_moment(told(0))) / radius;
}

double Contacts::friction_at_rest(const Contact& contact, const State& state,
                                  StartFriction start) const {
  if (start == StartFriction::frictionless) return 0.0;
  const Model& model = system_->model();
  const Joint& joint = model.joints[index(contact.joint)];
  const auto told = [&](const char* key) { return output(model, state, contact.joint, key)[0]; };
  double force = 0.0;
  if (const auto* latch = std::get_if<LatchHinge>(&joint)) {
    force = hinge_friction(contact, state, *latch);
  } else if (const auto* hinge = std::get_if<Hinge>(&joint)) {
    force = hinge_friction(contact, state, *hinge);
  } else if (const auto* slider = std::get_if<Slider>(&joint);
             slider != nullptr && contact.sticks_rigidly()) {
    // A rigid stop supports the force beyond the limit.
    force = told("slider_force_N") - slider->soft_stop_force(told("slide_m"));
  } else {
    force = contact.tangential_stiffness * slide_at_rest(contact, state, start);
  }
  return std::clamp(force, -contact.given_force, contact.given_force);
}

void Contacts::begin(const State& state, StartFriction start) {
  for (Contact& contact : all_) {
    if (contact.beside || contact.normal_column >= 0) continue;
    contact.compliance = contact.tangential_compliance(contact.given_force);
    if (contact.slips_in_part) {
      const SlipAnnuli::Pressed by = contact.pressed(contact.given_force, contact.given_force, 1.0);
      // The normal force acts first, then friction, because partial slip depends on the order.
      contact.annuli.take(by, Eigen::Vector2d::Zero());
      contact.friction_force =
          contact.annuli.take(by, {slide_at_rest(contact, state, start), 0.0})[0];
    } else {
      contact.friction_force = friction_at_rest(contact, state, start);
    }
    contact.elastic_friction = contact.friction_force;
  }
  double friction = 0.0;  // of a slider; its stops follow
  for (Contact& contact : all_) {
    if (contact.normal_column < 0) friction = contact.friction_force;
    if (contact.beside || contact.normal_column < 0) continue;
    const auto told = [&](const char* key) {
      return output(system_->model(), state, contact.joint, key)[0];
    };
    if (contact.ball >= 0 && balls_[index(contact.ball)].pad != nullptr) {
      begin_pad(contact, state, start);
    } else if (contact.stop == JointStatus::open) {
      contact.normal_force = told(contact.ball < 0 ? "normal_force_N" : "ball_normal_force_N");
      contact.elastic_normal = contact.normal_force;
      if (!contact.slips_in_part) continue;
      const SlipAnnuli::Pressed by =
          contact.pressed(contact.normal_force, contact.normal_force, 1.0);
      contact.annuli.take(by, Eigen::Vector2d::Zero());
    } else if (state.joint_status[index(contact.joint)] == contact.stop) {
      contact.normal_force =
          std::max(contact.normal_sign * (friction - told("slider_force_N")), 0.0);
    }
  }
}

void Contacts::begin_pad(Contact& contact, const State& state, StartFriction start) {
  const auto told = [&](const char* key) {
    return output(system_->model(), state, contact.joint, key);
  };
  contact.normal_force = contact.elastic_normal = told("pad_normal_force_N")[0];
  if (start == StartFriction::frictionless || !(contact.normal_force > 0.0)) return;
  const Vector3d friction = -told("pad_friction_N");
  balls_[index(contact.ball)].begin(friction);
  contact.friction_force = contact.elastic_friction = friction.norm();
  contact.compliance = 1.0 / contact.tangential_stiffness;
  all_[balls_[index(contact.ball)].place + 1].compliance = contact.compliance;
}

VectorXd Contacts::held_at_rest(const State& state) const {
  const Model& model = system_->model();
  VectorXd all = VectorXd::Zero(system_->unknowns());
  int column = system_->displacements();
  for (int i = 0; i < static_cast<int>(model.joints.size()); ++i) {
    const Joint& joint = model.joints[index(i)];
    const JointFrame frame = std::visit([&](const auto& one) { return one.frame(model); }, joint);
    if (std::holds_alternative<RigidArm>(joint)) {
      const Vector3d force = output(model, state, i, "rigid_force_N");
      for (int k = 0; k < frame.forces; ++k) all[column + k] = -frame.axes.col(k).dot(force);
    }
    column += frame.forces;
  }
  return all(turning_holds_);
}

void Contacts::write_annuli(StepStart& to) const {
  for (const Contact& contact : all_) {
    if (!contact.slips_in_part || contact.beside || contact.annuli.play > 0.0) continue;
    double* const history = system_->history(contact.joint, to);
    const auto tell = [&](const auto& joint) {
      if constexpr (requires { joint.slip_memory_begin(); }) {
        write_partial_slip(contact.annuli.memory, history + joint.slip_memory_begin(),
                           contact.ball < 0 ? 1 : 2);
      }
    };
    std::visit(tell, system_->model().joints[index(contact.joint)]);
  }
}

void Contacts::measure(const VectorXd& z, double time, const StepStart& start,
                       const VectorXd& closures, double rounding) {
  for (Contact& contact : all_) {
    if (contact.normal_column < 0) continue;
    const Trial at = system_->trial(contact.joint, z, time, start, JointModel::friction, 1.0);
    if (contact.stop != JointStatus::open) {
      const double slide = at.frame.axes.col(0).dot(at.moved[0] - at.moved[1]);
      contact.gap = contact.clearance + contact.normal_sign * slide;
      contact.clearance_after = contact.clearance;
    } else if (contact.ball >= 0) {
      BallFriction& cone = balls_[index(contact.ball)];
      cone.measure(at);
      const bool has_normal = cone.pad != nullptr || cone.now.distance > 0.0;
      contact.gap = has_normal ? cone.now.clearance - cone.now.distance : Contact::infinite;
      if (has_normal) contact.clearance_after = cone.now.clearance;
    } else {
      const Vector3d apart = eccentricity(at);
      const bool has_normal = apart.squaredNorm() > 0.0;
      contact.gap = has_normal ? -closures[contact.normal_column] : Contact::infinite;
      if (has_normal) contact.clearance_after = contact.gap + apart.norm();
    }
    contact.active =
        contact.gap <= rounding || (contact.is_elastic() && contact.gap < Contact::infinite);
  }
  for (const BallFriction& cone : balls_) {
    all_[cone.place + 1].active = all_[cone.place].active;
    direct(cone);
  }
}

double Contacts::gap_at(const Contact& contact, const VectorXd& z, double time,
                        const StepStart& start) const {
  const Trial at = system_->trial(contact.joint, z, time, start, JointModel::friction, 1.0);
  if (contact.ball < 0) return contact.clearance_after - eccentricity(at).norm();
  BallFriction cone = balls_[index(contact.ball)];
  cone.measure(at);
  return contact.clearance_after - cone.now.distance;
}

void Contacts::remember_clearances() {
  for (Contact& contact : all_) contact.clearance = contact.clearance_after;
  for (BallFriction& cone : balls_) cone.remember(friction(cone, false));
}

void Contacts::write(VectorXd& z, Statuses& statuses) const {
  z.tail(z.size() - system_->displacements()).setZero();
  int last = -1;
  for (const BallFriction& cone : balls_) {
    const Contact& contact = all_[cone.place];
    write(cone, false, z);
    const bool sticks = contact.slips_in_part
                            ? !contact.annuli.slip_all
                            : contact.sticks(contact.normal_force, contact.friction_force);
    statuses[index(contact.joint)] = !(contact.normal_force > 0.0) ? JointStatus::open
                                     : sticks                      ? JointStatus::stick
                                                                   : JointStatus::slip_plus;
  }
  for (const Contact& contact : all_) {
    if (contact.ball >= 0) continue;
    JointStatus& status = statuses[index(contact.joint)];
    if (contact.normal_column < 0) {
      z[contact.tangential_column] += contact.elastic_friction;
      if (contact.annuli.play > 0.0) {
        // The unknown of a slider is its friction without the force of the play, see Slider.
        z[contact.tangential_column] += contact.tangential_stiffness * contact.annuli.played();
      }
      // The contacts of a joint are consecutive in the list. The joint slips if any of its contacts
      // slips.
      const JointStatus now = rubs(contact, contact.given_force);
      if (contact.joint != last || now != JointStatus::stick) status = now;
      last = contact.joint;
    } else if (contact.stop != JointStatus::open) {
      z[contact.normal_column] -= contact.normal_sign * contact.normal_force;
      if (contact.normal_force > 0.0) status = contact.stop;
    } else {
      z[contact.normal_column] = contact.elastic_normal;
      z[contact.tangential_column] = contact.elastic_friction;
      status = contact.normal_force > 0.0
                   ? rubs(contact, contact.friction_coefficient * contact.normal_force)
                   : JointStatus::open;
    }
  }
}

VectorXd Contacts::with_dashpots(VectorXd z) const {
  for (const BallFriction& cone : balls_) write(cone, true, z);
  for (const Contact& contact : all_) {
    if (contact.ball >= 0) continue;
    if (contact.tangential_column >= 0) {
      z[contact.tangential_column] += contact.friction_force - contact.elastic_friction;
    }
    if (contact.is_elastic()) z[contact.normal_column] = contact.normal_force;
  }
  return z;
}

}  // namespace statejump::truss::detail
