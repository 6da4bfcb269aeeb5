// SPDX-License-Identifier: GPL-3.0-or-later
#include "stepper_arrays.hpp"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <limits>
#include <string>
#include <utility>

#include "blocked_motion.hpp"
#include "bore.hpp"
#include "contact_parts.hpp"
#include "faults.hpp"
#include "guide.hpp"
#include "joint_exchange.hpp"
#include "known_cast.hpp"
#include "prismatic.hpp"
#include "refusal.hpp"
#include "shapes.hpp"
#include "torsion.hpp"

namespace statejump::dem {
namespace {

constexpr int aspherical = 2;  // bit of Body::flags

// Calls act with the engine cast to its actual class.
template <class Act>
void as_stage(yade::Engine& engine, Act&& act) {
  if (auto* links = known_cast<ThermalLinks>(&engine)) {
    act(*links);
  } else if (auto* springs = known_cast<TorsionSprings>(&engine)) {
    act(*springs);
  } else if (auto* joints = known_cast<PrismaticJoints>(&engine)) {
    act(*joints);
  } else if (auto* guides = known_cast<GuidePlanes>(&engine)) {
    act(*guides);
  }
}

void scatter_stage(const ThermalLinks& to, const stepper::Stage& from) {
  const auto& places = std::get<stepper::Links>(from).links;
  for (std::size_t i = 0; i < places.size(); ++i) {
    static_cast<stepper::Link&>(*to.links[i]) = places[i].link;
  }
}

void scatter_stage(const TorsionSprings& to, const stepper::Stage& from) {
  const auto& places = std::get<std::vector<stepper::TorsionEntry>>(from);
  for (std::size_t i = 0; i < places.size(); ++i) {
    static_cast<stepper::Torsion&>(*to.springs[i]) = places[i].spring;
  }
}

void scatter_stage(const PrismaticJoints& to, const stepper::Stage& from) {
  const auto& joints = std::get<std::vector<stepper::Prismatic>>(from);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    static_cast<stepper::Prismatic&>(*to.joints[i]) = joints[i];
  }
}

void scatter_stage(const GuidePlanes&, const stepper::Stage&) {}  // no state

// Copies the geometry fields that YADE itself reads, for any contact of two round bodies.
template <class From, class To>
void copy_place(const From& from, To& to) {
  to.normal = from.normal;
  to.contactPoint = from.contactPoint;
  to.refR1 = from.refR1;
  to.refR2 = from.refR2;
}

template <class Entry>
void resize(std::vector<Entry>& contacts, std::size_t count) {
  contacts.resize(std::min(count, contacts.size()));
  while (contacts.size() < count) contacts.push_back(stepper::new_contact<Entry>());
}

// Copies geometry of all contacts with a bore, in either direction.
template <class From, class To>
void copy_bore_geometry(const From& from, To& to) {
  copy_place(from, to);
  to.previous = from.previous;
  to.known = from.known;
  to.strain_change = from.strain_change;
  resize(to.contacts, from.contacts.size());
  for (std::size_t i = 0; i < from.contacts.size(); ++i) {
    copy_geometry(stepper::contact_of(from.contacts[i]), stepper::contact_of(to.contacts[i]));
    copy_place(stepper::contact_of(from.contacts[i]), stepper::contact_of(to.contacts[i]));
  }
}

template <class From, class To>
void copy_bore_physics(const From& from, To& to) {
  copy_physics(from, to);
  resize(to.contacts, from.contacts.size());
  for (std::size_t i = 0; i < from.contacts.size(); ++i) {
    copy_physics(stepper::contact_of(from.contacts[i]), stepper::contact_of(to.contacts[i]));
  }
}

// Returns false if only YADE's own loop can handle the state of this pair.
bool gather_bore(const yade::Interaction& from, stepper::Bore& to) {
  const auto* geometry = known_cast<const BoreGeom>(from.geom.get());
  const auto* physics = known_cast<const BorePhys>(from.phys.get());
  if ((from.geom && !geometry) || (from.phys && !physics) || (physics && !geometry)) return false;
  const auto whole = [](const auto& list) {
    return std::all_of(list.begin(), list.end(),
                       [](const auto& one) { return static_cast<bool>(one); });
  };
  if (geometry) {
    if (!whole(geometry->contacts)) return false;
    copy_bore_geometry(*geometry, to.geometry);
    to.has_geometry = true;
  }
  if (physics) {
    if (!whole(physics->contacts)) return false;
    copy_bore_physics(*physics, to.physics);
  }
  return true;
}

void scatter_bore(const stepper::Contact& contact, const stepper::Bore& from,
                  yade::Interaction& to) {
  if (!from.has_geometry) {
    to.geom.reset();
  } else {
    if (from.renewed || !to.geom) to.geom = boost::make_shared<BoreGeom>();
    copy_bore_geometry(from.geometry, static_cast<BoreGeom&>(*to.geom));
  }
  if (!contact.real) {
    to.phys.reset();
    to.iterMadeReal = -1;
    return;
  }
  if (contact.renewed || !to.phys) {
    to.phys = boost::make_shared<BorePhys>();
    to.iterMadeReal = contact.made;
  }
  copy_bore_physics(from.physics, static_cast<BorePhys&>(*to.phys));
}

}  // namespace

bool JointArrays::gather(stepper::Scene& arrays) {
  arrays = {};
  if (fault_of_scene(scene_)) return false;  // YADE's own loop reports the fault
  interactions_.clear();
  heated_.clear();
  strains_.clear();
  common_strains_.clear();
  programs_.clear();
  arrays.time = scene_.time;
  arrays.time_step = scene_.dt;
  arrays.iteration = scene_.iter;
  arrays.tracks_energy = scene_.trackEnergy;
  arrays.newton = engines_.newton;
  if (engines_.revolute) arrays.largest_tilt = engines_.revolute->maxTilt;
  if (engines_.joint_law) {
    arrays.law = engines_.joint_law->named_law();
    arrays.begun = {engines_.joint_law->firstContactTime, engines_.joint_law->contacts};
  }
  if (engines_.bore_law) {
    arrays.bore_law = engines_.bore_law->named_law();
    arrays.begun_in_bores = {engines_.bore_law->firstContactTime, engines_.bore_law->contacts};
  }
  scene_.forces.sync();  // cheap: all forces except permanent ones have just been reset
  arrays.bodies.reserve(number_of_bodies(scene_));
  for (std::size_t id = 0; id < number_of_bodies(scene_); ++id) {
    if (!gather_body(id, arrays)) return false;
  }
  gather_heaters(arrays);
  arrays.contacts.reserve(number_of_interactions(scene_));
  for (std::size_t i = 0; i < number_of_interactions(scene_); ++i) {
    if (!gather_contact(i, arrays)) return false;
  }
  bool whole = true;
  for (yade::Engine* engine : engines_.stages) {
    as_stage(*engine, [&](const auto& stage) { whole = whole && gather_stage(stage, arrays); });
  }
  if (whole) arrays.prepare();
  return whole;
}

bool JointArrays::gather_body(std::size_t id, stepper::Scene& arrays) {
  stepper::Body& one = arrays.bodies.emplace_back();
  const auto& pointer = body_at(scene_, id);
  if (!pointer) return true;  // erased body: at rest
  const yade::Body& body = *pointer;
  const yade::State& state = *body.state;
  const auto which = [id] { return "body " + std::to_string(id); };
  if (body.clumpId >= 0) refuse({"clump", which()});
  if (body.shape && !known_cast<const ThermalShape>(body.shape.get())) {
    refuse({"unknown_shape", which(), body.shape->getClassName()});
  }
  if ((body.flags & aspherical) != 0 && engines_.exact_rotation &&
      (state.blockedDOFs & stepper::all_rotations) == 0) {
    refuse({"aspherical", which()});
  }
  one.motion = motion(state);
  one.orientation = state.se3.orientation;
  one.inertia = state.inertia;
  one.mass = state.mass;
  one.inverse_mass = inverse_mass(state);
  one.blocked = state.blockedDOFs;
  one.damped = state.isDamped;
  one.permanent_force = scene_.forces.getForce(static_cast<int>(id));
  one.permanent_torque = scene_.forces.getTorque(static_cast<int>(id));
  one.bounded = engines_.has_collider && body.bound;
  if (!one.bounded) return true;
  one.bound_position = body.bound->refPos;
  one.bound_reach = body.bound->sweepLength;
  return !stepper::left_bound(one);  // otherwise the collider must run
}

std::size_t JointArrays::program_of(const ThermalProgram& program, stepper::Scene& arrays) {
  const auto [found, is_new] = programs_.emplace(&program, arrays.programs.size());
  if (is_new) arrays.programs.push_back(program.program());
  return found->second;
}

void JointArrays::gather_heaters(stepper::Scene& arrays) {
  for (std::size_t i = 0; i < engines_.heaters.size(); ++i) {
    ThermalExpansionEngine& engine = *engines_.heaters[i];
    stepper::Heater heater{program_of(*engine.program, arrays), {}};
    for (const ThermalExpansionEngine::Target& target : engine.targets()) {
      if (target.is_shared) continue;
      ThermalShape& shape = *target.shape;
      const Real expansion = target.material->thermalExpansion;
      const auto [common, is_new] = common_strains_.emplace(
          std::make_tuple(i, expansion, shape.thermalStrain, shape.thermalStrainRate),
          arrays.strains.size());
      if (is_new) {
        arrays.strains.push_back({shape.thermalStrain, shape.thermalStrainRate});
        heater.targets.push_back({common->second, expansion});
      }
      if (!strains_.emplace(&shape, common->second).second) {
        refuse({"shape_heated_twice", "body " + std::to_string(target.id)});
      }
      heated_.emplace_back(&shape, common->second);
    }
    arrays.heaters.push_back(std::move(heater));
  }
}

std::size_t JointArrays::strain_of(const yade::Body& body, stepper::Scene& arrays) {
  const auto& shape = static_cast<const ThermalShape&>(*body.shape);
  const auto found = strains_.find(&shape);
  if (found != strains_.end()) return found->second;
  constexpr std::size_t no_engine = std::numeric_limits<std::size_t>::max();
  const auto [common, is_new] = common_strains_.emplace(
      std::make_tuple(no_engine, Real(0), shape.thermalStrain, shape.thermalStrainRate),
      arrays.strains.size());
  if (is_new) arrays.strains.push_back({shape.thermalStrain, shape.thermalStrainRate});
  return common->second;
}

// Finds dimensions and joint type of a pair. Returns false if no functor of the scene accepts the
// pair.
bool JointArrays::find_parts(const yade::Body& one, const yade::Body& two,
                             stepper::Contact& contact) const {
  const yade::Shape* const first = one.shape.get();
  const yade::Shape* const second = two.shape.get();
  if (engines_.revolute) {
    const auto* journal = known_cast<const Journal>(first);
    const auto* bearing = journal ? known_cast<const Bearing>(second) : nullptr;
    if (bearing) {
      contact.joint = stepper::Joint::revolute;
      contact.length_1 = journal->radius;
      contact.length_2 = bearing->radius;
      return true;
    }
  }
  if (engines_.ball) {
    const auto* ball = known_cast<const Ball>(first);
    const auto* socket = ball ? known_cast<const Socket>(second) : nullptr;
    if (socket) {
      contact.joint = stepper::Joint::ball;
      contact.length_1 = ball->radius;
      contact.length_2 = socket->radius;
      return true;
    }
  }
  if (engines_.outer_balls) {
    const auto* ball = known_cast<const Ball>(first);
    const auto* other = ball ? known_cast<const Ball>(second) : nullptr;
    if (other) {
      contact.joint = stepper::Joint::outer_balls;
      contact.length_1 = ball->radius;
      contact.length_2 = other->radius;
      return true;
    }
  }
  if (engines_.plane) {
    const auto* slider = known_cast<const Slider>(first);
    const auto* face = slider ? known_cast<const SlotFace>(second) : nullptr;
    if (face) {
      contact.joint = stepper::Joint::plane;
      contact.length_1 = slider->radius;
      contact.length_2 = face->distance;
      contact.face_normal = face->normal;
      return true;
    }
  }
  return false;
}

// Returns the bore if a functor of the scene accepts the pair as a contact with a meshed bore,
// otherwise nothing.
std::optional<stepper::Bore> JointArrays::find_bore(const yade::Body& one, const yade::Body& two,
                                                    stepper::Contact& contact) const {
  const auto* hole = known_cast<const MeshBore>(two.shape.get());
  if (!hole) return std::nullopt;
  stepper::Bore bore;
  bore.mesh = hole->mesh() ? &*hole->mesh() : nullptr;
  contact.joint = stepper::Joint::bore;
  if (const auto* journal = known_cast<const Journal>(one.shape.get());
      journal && engines_.bore_journal) {
    contact.length_1 = journal->radius;
    bore.patch_angle = engines_.bore_journal->patchAngle;
    bore.largest_tilt = engines_.bore_journal->maxTilt;
    return bore;
  }
  const auto* ball = known_cast<const Ball>(one.shape.get());
  if (!ball || !engines_.bore_ball) return std::nullopt;
  contact.length_1 = ball->radius;
  bore.is_ball = true;
  bore.patch_angle = engines_.bore_ball->patchAngle;
  return bore;
}

bool JointArrays::gather_contact(std::size_t place, stepper::Scene& arrays) {
  const yade::Interaction& interaction = interaction_at(scene_, place);
  if (!exists(interaction.id1) || !exists(interaction.id2)) return false;
  const yade::Body& one = body(interaction.id1);
  const yade::Body& two = body(interaction.id2);
  stepper::Contact contact{};
  std::optional<stepper::Bore> bore = find_bore(one, two, contact);
  if (!bore && !find_parts(one, two, contact)) return !interaction.isReal();
  const bool has_law = bore ? engines_.bore_law != nullptr && bore->mesh != nullptr
                            : engines_.hertz_mindlin || engines_.joint_law;
  if (!interaction.isActive || !has_law) return false;
  contact.body_1 = interaction.id1;
  contact.body_2 = interaction.id2;
  contact.strain_1 = strain_of(one, arrays);
  contact.strain_2 = strain_of(two, arrays);
  contact.real = interaction.isReal();
  contact.made = interaction.iterMadeReal;
  if (bore) {
    if (!gather_bore(interaction, *bore)) return false;
    contact.bore = arrays.bores.size();
    arrays.bores.push_back(*std::move(bore));
  } else if (contact.real) {
    const auto* geometry = known_cast<const JointGeom>(interaction.geom.get());
    const auto* kept = known_cast<const JointPhys>(interaction.phys.get());
    if (!geometry || !kept) return false;
    copy_geometry(*geometry, contact.geometry);
    copy_physics(*kept, contact.physics);
  } else if (interaction.geom || interaction.phys) {
    return false;
  }
  interactions_.push_back(place);
  arrays.contacts.push_back(contact);
  return true;
}

bool JointArrays::gather_stage(const ThermalLinks& group, stepper::Scene& arrays) {
  stepper::Links links;
  links.links.reserve(group.links.size());
  for (const auto& link : group.links) {
    if (!link || !link->program || !exists(link->id1) || !exists(link->id2)) return false;
    links.links.push_back({*link, program_of(*link->program, arrays)});
    links.needs_moments = links.needs_moments || link->tipTurnsWithLink;
  }
  arrays.stages.emplace_back(std::move(links));
  return true;
}

bool JointArrays::gather_stage(const TorsionSprings& group, stepper::Scene& arrays) {
  std::vector<stepper::TorsionEntry> places;
  places.reserve(group.springs.size());
  for (const auto& spring : group.springs) {
    if (!spring || !spring->link1 || !spring->link2) return false;
    const ThermalLink& first = *spring->link1;
    const ThermalLink& second = *spring->link2;
    for (const int id : {first.id1, first.id2, second.id1, second.id2}) {
      if (!exists(id)) return false;
    }
    places.push_back({*spring, {first.id1, first.id2}, {second.id1, second.id2}});
  }
  arrays.stages.emplace_back(std::move(places));
  return true;
}

bool JointArrays::gather_stage(const PrismaticJoints& group, stepper::Scene& arrays) {
  std::vector<stepper::Prismatic> joints;
  joints.reserve(group.joints.size());
  for (const auto& joint : group.joints) {
    if (!joint || joint->id1 == joint->id2 || !exists(joint->id1) || !exists(joint->id2)) {
      return false;
    }
    joints.push_back(*joint);
  }
  arrays.stages.emplace_back(std::move(joints));
  return true;
}

bool JointArrays::gather_stage(const GuidePlanes& group, stepper::Scene& arrays) {
  if (group.ids.size() != group.normals.size()) return false;
  std::vector<stepper::Guide> guides;
  guides.reserve(group.ids.size());
  for (std::size_t i = 0; i < group.ids.size(); ++i) {
    if (!exists(group.ids[i])) return false;
    guides.push_back({group.ids[i], group.normals[i]});
  }
  arrays.stages.emplace_back(std::move(guides));
  return true;
}

std::optional<stepper::ContactPhysics> JointArrays::physics(std::size_t contact) const {
  const yade::Interaction& interaction = interaction_at(scene_, interactions_[contact]);
  const yade::Body& one = body(interaction.id1);
  const yade::Body& two = body(interaction.id2);
  const auto* first = known_cast<const ThermalFrictMat>(one.material.get());
  const auto* second = known_cast<const ThermalFrictMat>(two.material.get());
  if (!engines_.physics || !first || !second) return std::nullopt;
  stepper::ContactPhysics made;
  bool good = true;
  fill_physics(*engines_.physics, *first, *second,
               inverse_mass(*one.state) + inverse_mass(*two.state), made,
               [&](const std::string&) { good = false; });
  return good ? std::optional<stepper::ContactPhysics>(made) : std::nullopt;
}

void JointArrays::scatter_contact(const stepper::Contact& from, const stepper::Scene& arrays,
                                  yade::Interaction& to) {
  if (from.joint == stepper::Joint::bore) return scatter_bore(from, arrays.bores[from.bore], to);
  if (!from.real) {
    if (!to.isReal()) return;
    to.geom.reset();
    to.phys.reset();
    to.iterMadeReal = -1;
    return;
  }
  if (from.renewed || !to.isReal()) {
    to.geom = boost::make_shared<JointGeom>();
    to.phys = boost::make_shared<JointPhys>();
    to.iterMadeReal = from.made;
  }
  copy_geometry(from.geometry, static_cast<JointGeom&>(*to.geom));
  copy_physics(from.physics, static_cast<JointPhys&>(*to.phys));
}

void JointArrays::scatter(const stepper::Scene& arrays) {
  scene_.time = arrays.time;
  scene_.iter = arrays.iteration;
  scene_.forces.lastReset = arrays.iteration;
  for (std::size_t id = 0; id < arrays.bodies.size(); ++id) {
    const stepper::Body& from = arrays.bodies[id];
    if (!from.moves) continue;
    yade::State& state = *body_at(scene_, id)->state;
    state.se3.position = from.motion.position;
    state.se3.orientation = from.orientation;
    state.vel = from.motion.velocity;
    state.angVel = from.motion.angular_velocity;
  }
  for (const auto& [shape, place] : heated_) {
    shape->thermalStrain = arrays.strains[place].strain;
    shape->thermalStrainRate = arrays.strains[place].rate;
  }
  for (std::size_t i = 0; i < arrays.contacts.size(); ++i) {
    scatter_contact(arrays.contacts[i], arrays, interaction_to_change(scene_, interactions_[i]));
  }
  for (std::size_t i = 0; i < engines_.stages.size(); ++i) {
    as_stage(*engines_.stages[i],
             [&](const auto& stage) { scatter_stage(stage, arrays.stages[i]); });
  }
  if (engines_.joint_law) {
    engines_.joint_law->firstContactTime = arrays.begun.first;
    engines_.joint_law->contacts = arrays.begun.count;
  }
  if (engines_.bore_law) {
    engines_.bore_law->firstContactTime = arrays.begun_in_bores.first;
    engines_.bore_law->contacts = arrays.begun_in_bores.count;
  }
  if (!arrays.tracks_energy || !arrays.any_contact) return;
  if (engines_.joint_law) engines_.joint_law->name_energies(scene_);
  if (engines_.hertz_mindlin) engines_.hertz_mindlin->name_energies(scene_);
  if (engines_.bore_law) engines_.bore_law->name_energies(scene_);
}

}  // namespace statejump::dem
