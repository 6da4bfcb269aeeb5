// SPDX-License-Identifier: GPL-3.0-or-later
// The engines of a scene that the JointStepper needs.
#pragma once

#include <vector>

#include "bore.hpp"
#include "joint.hpp"
#include "state_recorder.hpp"
#include "statejump/stepper/body.hpp"
#include "thermal.hpp"

namespace statejump::dem {

struct JointEngines {
  std::vector<ThermalExpansionEngine*> heaters;
  std::vector<yade::Engine*> stages;  // ThermalLinks, TorsionSprings etc., in their order
  std::vector<StateRecorder*> recorders;
  Ig2_Journal_Bearing_JointGeom* revolute = nullptr;
  Ig2_Ball_Socket_JointGeom* ball = nullptr;
  Ig2_Ball_Ball_JointGeom* outer_balls = nullptr;
  Ig2_Slider_SlotFace_JointGeom* plane = nullptr;
  Ig2_Journal_MeshBore_BoreGeom* bore_journal = nullptr;
  Ig2_Ball_MeshBore_BoreGeom* bore_ball = nullptr;
  Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys* physics = nullptr;
  Law2_JointGeom_JointPhys_HertzMindlin* hertz_mindlin = nullptr;
  Law2_JointGeom_JointPhys_JointLaw* joint_law = nullptr;
  Law2_BoreGeom_BorePhys_JointLaw* bore_law = nullptr;
  stepper::Newton newton;
  bool exact_rotation = true;  // NewtonIntegrator's exactAsphericalRot
  bool has_collider = false;
};

// Reads the engines of a scene; those of YADE through Python. Throws std::invalid_argument for an
// unknown engine or an unsupported order.
JointEngines joint_engines(const yade::Scene& scene, const yade::Engine& stepper);

}  // namespace statejump::dem
