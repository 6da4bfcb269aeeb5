// Errors inside YADE's interaction loop.
//
// The loop runs the functors in an OpenMP parallel region, which an exception may not leave: it
// would end the process. A functor therefore records the first failure here, and the next engine of
// ours that runs outside of the region (one that RaisesFailures) throws it, within the same or the
// next step. It is the one piece of shared state of the plugin,
// because functors know no engine.
#pragma once

#include <string>

namespace statejump::dem {

// An engine of ours whose action() begins with throw_recorded_failure(). It derives from this
// beside its registration, so that record_failure() knows whether anybody will raise what it
// records.
class RaisesFailures {
 public:
  RaisesFailures() = default;
  RaisesFailures(const RaisesFailures&) = delete;
  RaisesFailures& operator=(const RaisesFailures&) = delete;

 protected:
  virtual ~RaisesFailures() = default;
};

void record_failure(const std::string& message);
// Throws std::runtime_error and forgets the failure, if one was recorded.
void throw_recorded_failure();

}  // namespace statejump::dem
