// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <optional>
#include <utility>

#include "newton.hpp"
#include "statejump/truss/model.hpp"
#include "statejump/truss/trace.hpp"

namespace statejump::truss::detail {

enum class StepEnd : unsigned char;

/// Sends the iterations of a path to the trace sink of its options. A record also reports whether
/// the solve and the step ended. It is therefore sent only when the next record begins.
class Tracer {
 public:
  Tracer(const Model& model, TraceSink sink) : model_(&model), sink_(std::move(sink)) {}
  /// Sends the last record of a path that has failed.
  ~Tracer();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  explicit operator bool() const { return static_cast<bool>(sink_); }
  void begin_step(int branch, int increment);
  void end_step(StepEnd end);

 private:
  friend class TracedSolve;
  void send();

  const Model* model_;
  TraceSink sink_;
  TraceRecord place_;  ///< Branch, increment, step and solve of the next record.
  std::optional<TraceRecord> held_;
};

/// Variables of the traced Newton solve.
struct SolveView {
  double time;
  JointModel joints;
  double opening;
  const SolveReport& report;
  const Statuses& statuses;
  const std::deque<double>& lengths;  ///< Of the full steps on the present set of statuses [m].
  const int& halvings;                ///< Of the last step.
  const long& factorizations;         ///< Since the start of the path.
};

/// Traces one solve. It compares the solver's variables at the beginning of successive iterations,
/// so the solver needs to pass only two numbers. Without a tracer it does nothing.
class TracedSolve {
 public:
  TracedSolve(Tracer* tracer, const SolveView& view) : tracer_(tracer), view_(view) {
    if (tracer_ != nullptr) begin();
  }
  ~TracedSolve() {
    if (tracer_ != nullptr) close(true);
  }
  TracedSolve(const TracedSolve&) = delete;
  TracedSolve& operator=(const TracedSolve&) = delete;

  /// Begins an iteration with these residuals [N], [m], [N].
  void iteration(double nodes, double closures, double joints) {
    if (tracer_ != nullptr) open(nodes, closures, joints);
  }
  /// Records a full step of this length [m].
  void step(double length) {
    length_ = length;
    stepped_ = true;
  }

 private:
  void begin();
  void open(double nodes, double closures, double joints);
  void close(bool ends);

  Tracer* tracer_;
  SolveView view_;
  double length_ = 0.0;
  bool stepped_ = false;
  // At the beginning of the iteration:
  int iteration_ = 0;
  int halvings_ = 0;
  long factorizations_ = 0;
  Statuses statuses_;
};

}  // namespace statejump::truss::detail
