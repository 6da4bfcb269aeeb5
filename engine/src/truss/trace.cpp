// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace.hpp"

#include <cmath>
#include <utility>

#include "path_follower.hpp"

namespace statejump::truss {

const char* to_string(Decision decision) {
  switch (decision) {
    case Decision::step:
      return "step";
    case Decision::halved_step:
      return "halved_step";
    case Decision::status_change:
      return "status_change";
    case Decision::restart:
      return "restart";
    case Decision::converged:
      return "converged";
    case Decision::event_ahead:
      return "event_ahead";
    case Decision::singular:
      return "singular";
    case Decision::not_converged:
      return "not_converged";
    case Decision::stopped:
      return "stopped";
  }
  return "unknown";
}

const char* to_string(JointModel joints) {
  switch (joints) {
    case JointModel::pins:
      return "pins";
    case JointModel::frictionless:
      return "frictionless";
    case JointModel::friction:
      return "friction";
  }
  return "unknown";
}

namespace detail {

namespace {

const char* name_of(StepEnd end) {
  switch (end) {
    case StepEnd::done:
      return "done";
    case StepEnd::event_inside:
      return "event_inside";
    case StepEnd::not_converged:
      return "not_converged";
    case StepEnd::imprecise:
      return "imprecise";
    case StepEnd::stopped:
      return "stopped";
  }
  return "unknown";
}

Decision decision_of(SolveEnd end) {
  switch (end) {
    case SolveEnd::converged:
      return Decision::converged;
    case SolveEnd::singular:
      return Decision::singular;
    case SolveEnd::stopped:
      return Decision::stopped;
    case SolveEnd::event_ahead:
      return Decision::event_ahead;
    case SolveEnd::not_converged:
      break;
  }
  return Decision::not_converged;
}

}  // namespace

Tracer::~Tracer() {
  if (!held_) return;
  held_->step_end = "failed";  // a step that ended normally has sent its record
  try {
    send();
  } catch (...) {  // the failure of the path is already propagating
  }
}

void Tracer::begin_step(int branch, int increment) {
  if (!sink_) return;
  send();
  place_.branch = branch;
  place_.increment = increment;
  ++place_.step;
}

void Tracer::end_step(StepEnd end) {
  if (!held_) return;
  held_->step_end = name_of(end);
  send();
}

void Tracer::send() {
  if (!held_) return;
  const TraceRecord record = *std::exchange(held_, std::nullopt);
  sink_(record);
}

void TracedSolve::begin() {
  ++tracer_->place_.solve;
  halvings_ = view_.halvings;
  factorizations_ = view_.factorizations;
}

void TracedSolve::open(double nodes, double closures, double joints) {
  close(false);
  tracer_->send();
  TraceRecord& record = tracer_->held_.emplace(tracer_->place_);
  record.joints = view_.joints;
  record.opening = view_.opening;
  record.time = view_.time;
  record.temperature_change = tracer_->model_->temperature_change(0, 1.0, view_.time);
  record.iteration = ++iteration_;
  record.node_residual = nodes;
  record.closure_residual = closures;
  record.joint_residual = joints;
  halvings_ = view_.halvings;
  factorizations_ = view_.factorizations;
  statuses_ = view_.statuses;
  stepped_ = false;
}

void TracedSolve::close(bool ends) {
  if (iteration_ == 0 || !tracer_->held_) return;
  TraceRecord& record = *tracer_->held_;
  for (std::size_t i = 0; i < statuses_.size(); ++i) {
    if (statuses_[i] == view_.statuses[i]) continue;
    if (record.status_changes++ == 0) record.changed_joint = static_cast<int>(i);
  }
  record.factorizations = view_.factorizations - factorizations_;
  const bool halved = !stepped_ && view_.halvings > halvings_;
  if (halved) record.step_length = std::ldexp(length_, -view_.halvings);
  if (stepped_) record.step_length = length_;
  if (ends) {
    record.decision = decision_of(view_.report.end);
  } else if (record.status_changes > 0) {
    record.decision = Decision::status_change;
  } else if (halved) {
    record.decision = Decision::halved_step;
  } else {
    // The step length was reset: the solve restarted.
    record.decision = stepped_ && !view_.lengths.empty() ? Decision::step : Decision::restart;
  }
}

}  // namespace detail

}  // namespace statejump::truss
