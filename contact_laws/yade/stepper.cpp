// SPDX-License-Identifier: GPL-3.0-or-later
#include "stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "interpreter.hpp"
#include "ranges.hpp"
#include "statejump/stepper/partition.hpp"
#include "stepper_arrays.hpp"
#include "stepper_energies.hpp"
#include "stepper_engines.hpp"

namespace statejump::dem {
namespace {

// Number of steps that the stepper may make before the next step that YADE's own loop must make.
long steps_ahead(const yade::Scene& scene, long substeps) {
  if (scene.subStepping || !(scene.dt > 0)) return 0;
  const long beyond = scene.iter % substeps;
  long ahead = beyond == 0 ? 0 : substeps - beyond;
  if (scene.stopAtIter > scene.iter) ahead = std::min(ahead, scene.stopAtIter - scene.iter - 1);
  if (scene.stopAtTime > scene.time) {
    // YADE stops only if its time equals stopAtTime exactly. YADE itself therefore makes the last
    // steps before that time.
    const Real left = (scene.stopAtTime - scene.time) / scene.dt - 2;
    if (left < static_cast<Real>(ahead)) ahead = std::max(0L, static_cast<long>(left));
  }
  return ahead;
}

long run(stepper::Scene& arrays, long steps, const stepper::Scene::CreatePhysics& make,
         const stepper::Scene::Observe& observe) {
  // Energies are summed over all contacts in order, so the scene must not be split.
  if (arrays.tracks_energy) return arrays.run(steps, make, observe);
  stepper::Partition partition(arrays);
  if (partition.size() == 1) return arrays.run(steps, make, observe);
  const long apart = observe ? steps - 1 : steps;  // an observed step needs the whole scene
  const long done = partition.run(apart, make);
  if (done < apart) return done;
  partition.collect(arrays);
  return observe ? done + arrays.run(1, make, observe) : done;
}

class StepsAhead {
 public:
  StepsAhead(yade::Scene& scene, const JointEngines& engines, const stepper::Energies& before)
      : scene_(scene), engines_(engines), before_(before), exchange_(scene, engines) {}

  void make(long steps) {
    if (!exchange_.gather(arrays_)) return;
    arrays_.energies = before_;
    long done = 0;
    while (done < steps) {
      const long piece = std::min({steps - done, steps_to_a_sample(), steps_to_a_bound()});
      const long made = make_piece(piece);
      done += made;
      if (made < piece) break;
    }
    if (done == 0 && !sampled_) return;
    const Interpreter lock;
    exchange_.scatter(arrays_);
    if (scene_.trackEnergy) write_energies(arrays_.energies, before_, scene_);
  }

 private:
  // Number of steps until a recorder takes its next sample.
  long steps_to_a_sample() const {
    long steps = std::numeric_limits<long>::max();
    for (const StateRecorder* recorder : engines_.recorders) {
      const long beyond = arrays_.iteration % recorder->iterPeriod;
      steps = std::min(steps, beyond == 0 ? 1 : recorder->iterPeriod - beyond + 1);
    }
    return steps;
  }

  // Estimated number of steps until a body may leave its collider bound. If a body leaves it within
  // a piece of steps, the piece is repeated up to that step. With meshed bores this costs as much
  // as YADE's own loop, so a piece covers only most of the distance at current velocities.
  long steps_to_a_bound() const {
    constexpr Real most_of_the_way = 0.75;
    constexpr long shortest = 8;  // copying the arrays once costs about as much as one step
    if (arrays_.bores.empty()) return std::numeric_limits<long>::max();
    Real steps = static_cast<Real>(std::numeric_limits<int>::max());
    for (const stepper::Body& body : arrays_.bodies) {
      if (!body.moves || !body.bounded) continue;
      for (int k = 0; k < 3; ++k) {
        const Real left =
            body.bound_reach - std::abs(body.motion.position[k] - body.bound_position[k]);
        const Real way = std::abs(body.motion.velocity[k]) * scene_.dt;
        if (way * steps > left) steps = left / way;
      }
    }
    return std::max(shortest, static_cast<long>(most_of_the_way * steps));
  }

  // Makes steps, but stops before the first step that YADE's own loop must make.
  long make_piece(long steps) {
    start_ = arrays_;
    const long last = arrays_.iteration + steps - 1;
    std::vector<std::pair<StateRecorder*, std::size_t>> wanting;
    for (StateRecorder* recorder : engines_.recorders) {
      if (recorder->samples(last)) wanting.emplace_back(recorder, recorder->size());
    }
    const auto observe = [&] {
      sampled_ = true;
      const Interpreter lock;
      exchange_.scatter(arrays_);
      for (const auto& [recorder, size] : wanting) {
        recorder->sample(scene_, {arrays_.energies, arrays_.stored,
                                  [&](std::size_t id) { return arrays_.bodies[id].force; },
                                  [&](std::size_t id) { return arrays_.bodies[id].torque; }});
      }
    };
    const auto attempt = [&](long some, const stepper::Scene::Observe& observe_last) {
      return run(arrays_, some, make_, observe_last);
    };
    long done = attempt(steps, wanting.empty() ? stepper::Scene::Observe() : observe);
    if (done == steps && arrays_.has_finite_state()) return done;
    for (const auto& [recorder, size] : wanting) recorder->forget(size);
    if (done < steps) {
      arrays_ = start_;
      if (done > 0) attempt(done, {});
    }
    if (!arrays_.has_finite_state()) {
      // YADE's own loop reports the step with the invalid number. Repeat only the steps before it.
      arrays_ = start_;
      done = 0;
      while (arrays_.run(1, make_) == 1 && arrays_.has_finite_state()) ++done;
      arrays_ = start_;
      if (done > 0) attempt(done, {});
    }
    return done;
  }

  yade::Scene& scene_;
  const JointEngines& engines_;
  const stepper::Energies& before_;
  JointArrays exchange_;
  stepper::Scene arrays_, start_;
  const stepper::Scene::CreatePhysics make_ = [this](std::size_t contact) {
    return exchange_.physics(contact);
  };
  bool sampled_ = false;
};

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
  if (scene->isPeriodic) refuse({"periodic", "O.periodic"});
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
    if (ahead > 0) StepsAhead(*scene, engines, before).make(ahead);
  }
  last_iteration_ = scene->iter;
}

}  // namespace statejump::dem
