// SPDX-License-Identifier: GPL-3.0-or-later
// Errors inside YADE's interaction loop.
//
// The loop runs the functors in an OpenMP parallel region; an exception that leaves this region
// ends the process. So a functor records the first failure here. The next engine of the plugin that
// runs outside the region (derived from RaisesFailures) throws it, in the same or the next step.
// This is the only shared state of the plugin; it is needed because functors know no engine.
#pragma once

#include <limits>
#include <string>

#include "yade_api.hpp"

namespace statejump::dem {

// Base of engines whose action() starts with begin(). From this class record_failure() recognises
// whether an engine of the scene will throw the failure.
class RaisesFailures {
 public:
  RaisesFailures() = default;
  RaisesFailures(const RaisesFailures&) = delete;
  RaisesFailures& operator=(const RaisesFailures&) = delete;

 protected:
  virtual ~RaisesFailures() = default;
  // Throws the failure that contacts have recorded. Checks O.dt in every step. In the first step of
  // a run it checks all numbers of the scene, because a script may have changed any of them.
  static void begin(const yade::Scene& scene);
};

// Cause of a failure, for programs. Codes are public and do not change.
struct FailureDetail {
  const char* code = "failed";
  std::string quantity = {};  // without an article
  std::string value = {};
  std::string allowed = {};
};

std::string text_of(yade::Real value, int digits = 9);
std::string text_of(const yade::Vector3r& value);  // "(1, 2, 3)"

// A failure as fields. Scripts insert the part's name in their model and use these fields instead
// of parsing the sentence.
struct Failure {
  // Type of the failed part. A part has one or two bodies; the scene has none.
  enum class Part : unsigned char {
    contact,
    link,
    torsion_spring,
    prismatic_joint,
    beam,
    body,
    scene
  };
  Part part = Part::contact;
  int id1 = -1;
  int id2 = -1;  // for a torsion spring, id1 and id2 are the tips of its two links
  // Text before and after the name of a link, spring, prismatic joint, beam or body. For a contact
  // (named at the end) and for the scene, `before` contains the whole sentence.
  std::string before = {};
  std::string after = {};
  yade::Real time = 0;  // [s]
  // Largest stable step of this part [s], set only if the time step is too long.
  yade::Real stable_time_step = std::numeric_limits<yade::Real>::quiet_NaN();
  std::string when = {};  // time and temperature changes as text
  FailureDetail detail = {};
  std::string sentence() const;
};

// A failure of a part at the scene's time and temperatures. `stable_time_step` [s]: see Failure.
Failure failure(const yade::Scene& scene, Failure::Part part, int id1, int id2, std::string before,
                std::string after, FailureDetail detail,
                yade::Real stable_time_step = std::numeric_limits<yade::Real>::quiet_NaN());
// The failure that O.dt is above the stable time step [s] of a part.
Failure unstable_time_step(const yade::Scene& scene, Failure::Part part, int id1, int id2,
                           yade::Real stable);

// Functors call this to record the first failure of a step, which an engine then throws.
void record_failure(Failure failure);
// Functors call this to record a failure of a contact. If one of the contact's numbers is invalid,
// the failure reports that number instead of the sentence.
void record_failure(FailureDetail detail, const std::string& sentence, const yade::Scene& scene,
                    const yade::Interaction& contact);
// For engines: throws std::runtime_error with the sentence.
[[noreturn]] void throw_failure(Failure failure);
// Returns the last thrown failure once, as a dict: part, bodies (one or two ids, or none), before,
// after, time, stable_time_step (None if the step is not the cause), code, quantity, value,
// allowed, sentence. Returns None if there is no new failure.
boost::python::object take_failure();

}  // namespace statejump::dem
