// SPDX-License-Identifier: GPL-3.0-or-later
#include "ball_friction.hpp"

#include "contacts.hpp"
#include "truss/joints/ball_rubbing.hpp"

namespace statejump::truss::detail {

namespace {

/// State of a ball without forces.
BallState<double> state_of(const BallJoint& joint, const Trial& at) {
  return ball_state_at(joint, Vector3d::Zero(), at);
}

}  // namespace

Vector3d ball_normal(const Trial& at) {
  const Vector3d apart = at.between(socket, ball);
  const double distance = apart.norm();
  return distance > 0.0 ? Vector3d(apart / distance) : Vector3d::Zero();
}

void BallFriction::begin(const Vector3d& friction) {
  now.normal = -pad->normal;
  memory.friction = friction;
  along = now.normal.unitOrthogonal();
  point(friction);
}

void BallFriction::measure(const Trial& at) {
  if (pad != nullptr) {
    now.normal = -pad->normal;
    now.clearance = pad->clearance;
    now.distance = now.normal.dot(at.moved[0] - at.moved[1]);
    kept = memory.friction;
    const Vector3d before = along;
    along = now.normal.unitOrthogonal();
    point(before);
    point(kept);
    return;
  }
  now = state_of(*joint, at);
  const BallSlide<double> moved = ball_slide(now, memory);
  kept = moved.kept;
  if (slips_in_part()) {
    along = any_across(now.normal);
    point(moved.axis);
    return;
  }
  // The friction direction is still unknown: start with that of the last step, or an arbitrary one.
  const Vector3d before = along;
  along = now.normal.isZero(0.0) ? Vector3d::Zero() : now.normal.unitOrthogonal();
  point(before);
  point(kept);
}

void BallFriction::point(const Vector3d& to) {
  const Vector3d in_plane = to - now.normal * now.normal.dot(to);
  const double size = in_plane.norm();
  if (size > 0.0 && !now.normal.isZero(0.0)) along = in_plane / size;
}

void BallFriction::remember(const Vector3d& friction) {
  memory.offset = now.offset;
  memory.ball_direction = now.ball_direction;
  memory.socket_direction = now.socket_direction;
  memory.friction = friction;
  if (slips_in_part()) memory.axis = along;
}

void Contacts::direct(const BallFriction& cone) {
  Contact& contact = all_[cone.place];
  Contact& beside = all_[cone.place + 1];
  contact.normal_shares = cone.axes.transpose() * cone.now.normal;
  contact.tangential_shares = cone.axes.transpose() * cone.along;
  beside.tangential_shares = cone.axes.transpose() * cone.across();
  contact.elastic_friction = cone.along.dot(cone.kept);
  beside.elastic_friction = cone.across().dot(cone.kept);
}

Vector3d Contacts::friction(const BallFriction& cone, bool with_dashpots) const {
  const Contact& contact = all_[cone.place];
  const Contact& beside = all_[cone.place + 1];
  return with_dashpots
             ? cone.along * contact.friction_force + cone.across() * beside.friction_force
             : cone.along * contact.elastic_friction + cone.across() * beside.elastic_friction;
}

void Contacts::write(const BallFriction& cone, bool with_dashpots, VectorXd& z) const {
  const Contact& contact = all_[cone.place];
  const double pressed = with_dashpots ? contact.normal_force : contact.elastic_normal;
  if (cone.pad != nullptr) {
    z.segment<3>(cone.first_column) =
        cone.axes.transpose() * (pressed * cone.now.normal + friction(cone, with_dashpots));
    return;
  }
  const Model& model = system_->model();
  const BallJoint& joint = *cone.joint;
  const Vector3d drawn =
      model.nodes[index(joint.ball_node)].position - model.nodes[index(joint.socket_node)].position;
  const Vector3d apart = drawn + system_->displacement(joint.ball_node, z) -
                         system_->displacement(joint.socket_node, z);
  Vector3d force = Vector3d::Zero();
  if (!apart.isZero(0.0)) {
    // Rotated from the middle of the step to its end.
    const Vector3d normal = apart.normalized();
    force = pressed * normal;
    if (!cone.now.normal.isZero(0.0)) {
      force += carried<double>(friction(cone, with_dashpots), cone.now.normal, normal);
    }
  }
  z.segment<3>(cone.first_column) = cone.axes.transpose() * force;
}

}  // namespace statejump::truss::detail
