// SPDX-License-Identifier: GPL-3.0-or-later
// Errors inside YADE's interaction loop.
//
// The loop runs the functors in an OpenMP parallel region. An exception that leaves this region
// would end the process. So a functor records the first failure here. The next engine of the plugin
// that runs outside the region (one that RaisesFailures) throws it, within the same or the next
// step. This is the only shared state of the plugin, because functors know no engine.
#pragma once

#include <limits>
#include <string>

#include "yade_api.hpp"

namespace statejump::dem {

// Base of engines whose action() starts with begin(). Deriving from it tells record_failure() that
// an engine will raise the failure.
class RaisesFailures {
 public:
  RaisesFailures() = default;
  RaisesFailures(const RaisesFailures&) = delete;
  RaisesFailures& operator=(const RaisesFailures&) = delete;

 protected:
  virtual ~RaisesFailures() = default;
  // Throws the failure that contacts have recorded. Also checks O.dt in every step. In the first
  // step of a run, because a script may have changed anything, checks all numbers of the scene.
  static void begin(const yade::Scene& scene);
};

// What went wrong, for programs. Codes are public and do not change.
struct FailureDetail {
  const char* code = "failed";
  std::string quantity = {};  // name as in the sentence, without an article
  std::string value = {};
  std::string allowed = {};
};

std::string text_of(yade::Real value, int digits = 9);
std::string text_of(const yade::Vector3r& value);  // "(1, 2, 3)"

// A failure as fields. Scripts use the fields, with the part's name in their model, and do not
// parse the sentence.
struct Failure {
  // Type of the part: it has two bodies or one; the scene has none.
  enum class Part : unsigned char { contact, link, torsion_spring, prismatic_joint, body, scene };
  Part part = Part::contact;
  int id1 = -1;
  int id2 = -1;  // of a torsion spring: the tips of its two links
  // The sentence around the name of a link, spring, prismatic joint or body. For a contact, which
  // is named at the end, and for the scene the whole sentence is in `before`.
  std::string before = {};
  std::string after = {};
  yade::Real time = 0;  // [s]
  // If the time step is too long: the largest that this part allows [s].
  yade::Real stable_time_step = std::numeric_limits<yade::Real>::quiet_NaN();
  std::string when = {};  // text with time and temperature changes
  FailureDetail detail = {};
  std::string sentence() const;
};

// For functors: records the first failure of a step; an engine throws it.
void record_failure(Failure failure);
// For functors: a failure of a contact. If one of its numbers is NaN, the failure reports that
// number.
void record_failure(FailureDetail detail, const std::string& sentence, const yade::Scene& scene,
                    const yade::Interaction& contact);
// For engines: throws std::runtime_error with the sentence.
[[noreturn]] void throw_failure(Failure failure);
// The last thrown failure that was not yet taken, as a dict: part, bodies (two ids, one or none),
// before, after, time, stable_time_step (None if the step is not the cause), code, quantity, value,
// allowed, sentence. None if there is no failure.
boost::python::object take_failure();

}  // namespace statejump::dem
