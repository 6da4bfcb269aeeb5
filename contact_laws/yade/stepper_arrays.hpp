// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion of a YADE scene to the arrays of statejump/stepper, and back.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "statejump/stepper/scene.hpp"
#include "stepper_engines.hpp"

namespace statejump::dem {

struct GuidePlanes;
struct PrismaticJoints;
struct TorsionSprings;

class JointArrays {
 public:
  JointArrays(yade::Scene& scene, const JointEngines& engines) : scene_(scene), engines_(engines) {}

  // Fills the arrays. Returns false if YADE's own loop must make the next step. Throws
  // std::invalid_argument for a body that the stepper does not support.
  bool gather(stepper::Scene& arrays);
  // Writes the new state back to YADE. The caller must hold the GIL.
  void scatter(const stepper::Scene& arrays);
  // Physics of a contact that begins; empty for invalid materials.
  std::optional<stepper::ContactPhysics> physics(std::size_t contact) const;

 private:
  bool gather_body(std::size_t id, stepper::Scene& arrays);
  void gather_heaters(stepper::Scene& arrays);
  bool gather_contact(std::size_t place, stepper::Scene& arrays);
  bool find_parts(const yade::Body& one, const yade::Body& two, stepper::Contact& contact) const;
  std::optional<stepper::Bore> find_bore(const yade::Body& one, const yade::Body& two,
                                         stepper::Contact& contact) const;
  bool gather_stage(const ThermalLinks& group, stepper::Scene& arrays);
  bool gather_stage(const TorsionSprings& group, stepper::Scene& arrays);
  bool gather_stage(const PrismaticJoints& group, stepper::Scene& arrays);
  bool gather_stage(const GuidePlanes& group, stepper::Scene& arrays);
  static void scatter_contact(const stepper::Contact& from, const stepper::Scene& arrays,
                              yade::Interaction& to);
  std::size_t program_of(const ThermalProgram& program, stepper::Scene& arrays);
  std::size_t strain_of(const yade::Body& body, stepper::Scene& arrays);
  bool exists(int id) const { return scene_.bodies->exists(id); }
  const yade::Body& body(int id) const { return *body_at(scene_, static_cast<std::size_t>(id)); }

  yade::Scene& scene_;
  const JointEngines& engines_;
  std::vector<std::size_t> interactions_;  // index of each contact in YADE's container
  std::vector<std::pair<ThermalShape*, std::size_t>> heated_;  // shapes and index of their strain
  std::unordered_map<const ThermalShape*, std::size_t> strains_;  // index of each shape's strain
  // Indices of strains that bodies share, by heater, expansion coefficient, strain and rate.
  std::map<std::tuple<std::size_t, Real, Real, Real>, std::size_t> common_strains_;
  std::map<const ThermalProgram*, std::size_t> programs_;
};

}  // namespace statejump::dem
