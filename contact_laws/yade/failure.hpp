// SPDX-License-Identifier: GPL-3.0-or-later
// Errors inside YADE's interaction loop.
//
// The loop runs the functors in an OpenMP parallel region, which an exception may not leave: it
// would end the process. A functor therefore records the first failure here, and the next engine of
// ours that runs outside of the region (one that RaisesFailures) throws it, within the same or the
// next step. It is the one piece of shared state of the plugin,
// because functors know no engine.
#pragma once

#include <limits>
#include <string>

#include "yade_api.hpp"

namespace statejump::dem {

// An engine of ours whose action() begins with begin(). It derives from this beside its
// registration, so that record_failure() knows whether anybody will raise what it records.
class RaisesFailures {
 public:
  RaisesFailures() = default;
  RaisesFailures(const RaisesFailures&) = delete;
  RaisesFailures& operator=(const RaisesFailures&) = delete;

 protected:
  virtual ~RaisesFailures() = default;
  // Throws the failure that contacts have recorded. In the first step of a run, before which a
  // script may have changed anything, it looks at all numbers of the scene, and in every step at
  // O.dt; it throws where one is none.
  static void begin(const yade::Scene& scene);
};

// What went wrong, as fields: scripts name the part by what their model calls it, and read no
// sentence.
struct Failure {
  // What the bodies stand for: two, one or, of the scene, none.
  enum class Part : unsigned char { contact, link, torsion_spring, prismatic_joint, body, scene };
  Part part = Part::contact;
  int id1 = -1;
  int id2 = -1;  // of a torsion spring: the tips of its two links
  // The sentence around the name of a link, spring, prismatic joint or body; of a contact, which is
  // named at the end, and of the scene all of it stands in `before`.
  std::string before = {};
  std::string after = {};
  yade::Real time = 0;  // [s]
  // Where the step is too long: the longest that this part allows [s].
  yade::Real stable_time_step = std::numeric_limits<yade::Real>::quiet_NaN();
  std::string when = {};  // time and temperature changes in words
  std::string sentence() const;
};

// For functors: keeps the first failure of a step, for an engine to throw.
void record_failure(Failure failure);
// For functors: a failure of a contact. Where one of its numbers is none, that is what is said.
void record_failure(const std::string& sentence, const yade::Scene& scene,
                    const yade::Interaction& contact);
// For engines: throws std::runtime_error with the sentence.
[[noreturn]] void throw_failure(Failure failure);
// The failure that was thrown last and not taken yet, as a dict: part, bodies (two ids, one or
// none), before, after, time, stable_time_step (None where the step is not the fault), sentence;
// None: there is none.
boost::python::object take_failure();

}  // namespace statejump::dem
