// SPDX-License-Identifier: GPL-3.0-or-later
#include "stepper_engines.hpp"

#include <array>
#include <boost/python.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "guide.hpp"
#include "prismatic.hpp"
#include "refusal.hpp"
#include "stepper.hpp"
#include "torsion.hpp"

namespace statejump::dem {
namespace {

namespace py = boost::python;

std::string type_of(const py::object& object) {
  return py::extract<std::string>(object.attr("__class__").attr("__name__"));
}

// YADE engines that the stepper supports.
enum class Known { resetter, collider, loop, newton, onlooker, time_stepper };

// Position of an engine in the loop, in the required order.
enum class Place { resetter, stepper, before, loop, behind, recorder, motion };

class Reader {
 public:
  Reader(const yade::Scene& scene, const yade::Engine& self) : scene_(scene), self_(self) {}

  JointEngines read() {
    for (const auto& engine : scene_.engines) {
      if (!engine->dead) read(engine);
    }
    if (!has_newton_) refuse({"no_newton", "NewtonIntegrator"});
    return engines_;
  }

 private:
  void read(const yade::shared_ptr<yade::Engine>& engine) {
    if (engine.get() == &self_) return stand(Place::stepper, JointStepper::class_name);
    if (dynamic_cast<const JointStepper*>(engine.get()))
      refuse({"two_steppers", JointStepper::class_name});
    if (auto* heater = dynamic_cast<ThermalExpansionEngine*>(engine.get())) {
      engines_.heaters.push_back(heater);
      return stand(Place::before, heater->class_name);
    }
    if (dynamic_cast<const ThermalLinks*>(engine.get()) ||
        dynamic_cast<const TorsionSprings*>(engine.get()) ||
        dynamic_cast<const PrismaticJoints*>(engine.get()) ||
        dynamic_cast<const GuidePlanes*>(engine.get())) {
      engines_.stages.push_back(engine.get());
      return stand(Place::behind, engine->getClassName());
    }
    if (auto* recorder = dynamic_cast<StateRecorder*>(engine.get())) {
      engines_.recorders.push_back(recorder);
      return stand(Place::recorder, recorder->class_name);
    }
    read_of_yade(py::object(engine), *engine);
  }

  void read_of_yade(const py::object& object, const yade::Engine& engine) {
    switch (known(object, engine.getClassName())) {
      case Known::resetter:
        return stand(Place::resetter, "ForceResetter");
      case Known::collider:
        engines_.has_collider = true;
        if (!(py::extract<Real>(object.attr("verletDist"))() > 0)) {
          refuse({"no_verlet_distance", "InsertionSortCollider.verletDist", "", "above 0 [m]"});
        }
        return stand(Place::before, "InsertionSortCollider");
      case Known::loop:
        if (has_loop_) refuse({"two_engines", "InteractionLoop"});
        has_loop_ = true;
        read_functors(object);
        return stand(Place::loop, "InteractionLoop");
      case Known::newton:
        if (has_newton_) refuse({"two_engines", "NewtonIntegrator"});
        has_newton_ = true;
        read_newton(object);
        return stand(Place::motion, "NewtonIntegrator");
      case Known::onlooker:
        return;
      case Known::time_stepper:
        if (PyObject_HasAttrString(object.ptr(), "densityScaling") &&
            py::extract<bool>(object.attr("densityScaling"))()) {
          refuse({"must_be_off", type_of(object) + ".densityScaling"});
        }
    }
  }

  // Throws for any other engine.
  static Known known(const py::object& object, const std::string& class_name) {
    static constexpr std::array<std::pair<const char*, Known>, 6> bases = {
        {{"ForceResetter", Known::resetter},
         {"InsertionSortCollider", Known::collider},
         {"InteractionLoop", Known::loop},
         {"NewtonIntegrator", Known::newton},
         {"PeriodicEngine", Known::onlooker},
         {"TimeStepper", Known::time_stepper}}};
    // Before every run of steps this function is called, so it compares names first, which is fast.
    if (class_name == "PyRunner") return Known::onlooker;
    for (const auto& [name, which] : bases) {
      if (class_name == name) return which;
    }
    const py::object wrapper = py::import("yade.wrapper");
    for (const auto& [name, which] : bases) {
      if (PyObject_IsInstance(object.ptr(), py::object(wrapper.attr(name)).ptr()) == 1) {
        return which;
      }
    }
    refuse({"unknown_engine", type_of(object)});
  }

  void stand(Place place, const std::string& name) {
    const bool right = any_ ? place >= last_ : place == Place::resetter;
    // Only the stepper may directly follow the ForceResetter.
    const bool behind_resetter = place != Place::stepper || last_ == Place::resetter;
    const bool stepper_is_there = place <= Place::stepper || seen_stepper_;
    if (!right || !behind_resetter || !stepper_is_there) {
      refuse({"misplaced_engine", name, "",
              "ForceResetter, JointStepper, ThermalExpansionEngine and InsertionSortCollider, "
              "InteractionLoop, ThermalLinks, TorsionSprings, PrismaticJoints and GuidePlanes, "
              "StateRecorder, NewtonIntegrator"});
    }
    last_ = place;
    any_ = true;
    seen_stepper_ = seen_stepper_ || place == Place::stepper;
  }

  template <class Functor>
  static bool take(const py::object& functor, Functor*& place) {
    const py::extract<Functor*> found(functor);
    if (!found.check()) return false;
    if (place) {
      refuse({"two_functors", Functor::class_name});
    }
    place = found();
    return true;
  }

  // Calls `take_one` for every functor of a dispatcher. `take_one` returns false for an unsupported
  // functor.
  template <class Take>
  static void read_functors(const py::object& loop, const char* dispatcher, Take&& take_one) {
    const py::object functors(loop.attr(dispatcher).attr("functors"));
    for (py::ssize_t i = 0; i < py::len(functors); ++i) {
      const py::object functor(functors[i]);
      if (take_one(functor)) continue;
      refuse({"unknown_functor", type_of(functor)});
    }
  }

  void read_functors(const py::object& loop) {
    read_functors(loop, "geomDispatcher", [&](const py::object& one) {
      return take(one, engines_.revolute) || take(one, engines_.ball) ||
             take(one, engines_.plane) || take(one, engines_.outer_balls) ||
             take(one, engines_.bore_journal) || take(one, engines_.bore_ball);
    });
    read_functors(loop, "physDispatcher",
                  [&](const py::object& one) { return take(one, engines_.physics); });
    read_functors(loop, "lawDispatcher", [&](const py::object& one) {
      return take(one, engines_.hertz_mindlin) || take(one, engines_.joint_law) ||
             take(one, engines_.bore_law);
    });
    if (engines_.hertz_mindlin && engines_.joint_law) {
      refuse({"two_laws", "InteractionLoop"});
    }
    if (py::len(loop.attr("callbacks")) > 0) refuse({"callbacks", "InteractionLoop.callbacks"});
    if (py::extract<bool>(loop.attr("loopOnSortedInteractions"))()) {
      refuse({"must_be_off", "InteractionLoop.loopOnSortedInteractions"});
    }
  }

  void read_newton(const py::object& integrator) {
    const auto flag = [&](const char* name) { return py::extract<bool>(integrator.attr(name))(); };
    stepper::Newton& newton = engines_.newton;
    newton.damping = py::extract<Real>(integrator.attr("damping"))();
    newton.gravity = py::extract<Vector3r>(integrator.attr("gravity"))();
    newton.dampGravity = flag("dampGravity");
    engines_.exact_rotation = flag("exactAsphericalRot");
    if (py::extract<int>(integrator.attr("mask"))() > 0) {
      refuse({"mask", "NewtonIntegrator.mask"});
    }
    // YADE versions differ in whether numerical damping acts on gravity, and thus in the energy of
    // gravity.
    if (scene_.trackEnergy && newton.damping != 0 && !newton.gravity.isZero(0)) {
      refuse({"damped_gravity", "NewtonIntegrator.damping"});
    }
  }

  const yade::Scene& scene_;
  const yade::Engine& self_;
  JointEngines engines_;
  bool has_loop_ = false, has_newton_ = false, seen_stepper_ = false;
  bool any_ = false;
  Place last_ = Place::resetter;
};

}  // namespace

JointEngines joint_engines(const yade::Scene& scene, const yade::Engine& stepper) {
  try {
    return Reader(scene, stepper).read();
  } catch (const py::error_already_set&) {
    PyErr_Clear();
    throw std::runtime_error("JointStepper: the engines of this YADE have other attributes");
  }
}

}  // namespace statejump::dem
