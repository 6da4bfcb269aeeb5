// SPDX-License-Identifier: GPL-3.0-or-later
#include "stepper.hpp"

#include <algorithm>
#include <utility>

#include "ranges.hpp"
#include "statejump/stepper/parts.hpp"
#include "stepper_arrays.hpp"
#include "stepper_engines.hpp"

namespace statejump::dem {
namespace {

// Steps until the ordinary loop has to make one.
long steps_ahead(const yade::Scene& scene, long substeps) {
  if (scene.subStepping || !(scene.dt > 0)) return 0;
  const long beyond = scene.iter % substeps;
  long ahead = beyond == 0 ? 0 : substeps - beyond;
  if (scene.stopAtIter > scene.iter) ahead = std::min(ahead, scene.stopAtIter - scene.iter - 1);
  if (scene.stopAtTime > scene.time) {
    // YADE stops where its time is just that, if it ever is: the last steps before are its own.
    const Real left = (scene.stopAtTime - scene.time) / scene.dt - 2;
    if (left < static_cast<Real>(ahead)) ahead = std::max(0L, static_cast<long>(left));
  }
  return ahead;
}

long run(stepper::Scene& arrays, long steps, const stepper::Scene::Make& make) {
  // Energies are sums over all contacts in their order, step by step.
  if (arrays.tracks_energy) return arrays.run(steps, make);
  stepper::Parts parts(arrays);
  if (parts.size() == 1) return arrays.run(steps, make);
  const long done = parts.run(steps, make);
  if (done == steps) parts.collect(arrays);
  return done;
}

void step_ahead(yade::Scene& scene, const JointEngines& engines, const stepper::Energies& before,
                long ahead) {
  JointArrays exchange(scene, engines);
  stepper::Scene arrays;
  const auto make = [&](std::size_t contact) { return exchange.physics(contact); };
  const auto attempt = [&](long steps) {
    if (!exchange.gather(arrays)) return 0L;
    arrays.energies = before;
    return run(arrays, steps, make);
  };
  long done = attempt(ahead);
  if (done > 0 && done < ahead) done = attempt(done);
  if (done > 0 && !arrays.is_sound()) {
    // The step that leaves a number that is none is for the ordinary loop to tell: those before.
    done = attempt(0);
    while (arrays.run(1, make) == 1 && arrays.is_sound()) ++done;
    if (done > 0) attempt(done);
  }
  if (done == 0) return;
  const Interpreter lock;
  exchange.scatter(arrays);
  if (scene.trackEnergy) write_energies(arrays.energies, before, scene);
}

}  // namespace

void JointStepper::check() const {
  if (substeps < 1) refuse(class_name, "substeps", substeps, "1 or above [-]");
}

bool JointStepper::follows_an_ordinary_step() {
  std::vector<const yade::Engine*> engines;
  for (const auto& engine : scene->engines) engines.push_back(engine.get());
  const bool follows = scene == last_scene_ && scene->iter == last_iteration_ + 1 &&
                       number_of_bodies(*scene) == last_bodies_ && engines == last_engines_;
  last_scene_ = scene;
  last_bodies_ = number_of_bodies(*scene);
  last_engines_ = std::move(engines);
  return follows;
}

void JointStepper::action() {
  begin(*scene);
  if (scene->isPeriodic) refuse_scene("the scene is periodic");
  const bool follows = follows_an_ordinary_step();
  const long ahead = follows ? steps_ahead(*scene, substeps) : 0;
  if (ahead > 0 || !follows) {
    JointEngines engines;
    stepper::Energies before;
    {
      const Interpreter lock;
      engines = joint_engines(*scene, *this);
      if (scene->trackEnergy) before = read_energies(*scene);
    }
    if (ahead > 0) step_ahead(*scene, engines, before, ahead);
  }
  last_iteration_ = scene->iter;
}

}  // namespace statejump::dem
