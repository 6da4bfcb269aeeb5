// SPDX-License-Identifier: GPL-3.0-or-later
#include "adjoint.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "differences.hpp"
#include "elements/writer.hpp"
#include "newton.hpp"
#include "path_follower.hpp"
#include "start_choice.hpp"
#include "statejump/failure.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::truss::detail {

namespace {

/// First steps of differences, as fractions of the largest value of their kind. The larger one is
/// accurate for smooth functions, the smaller one does not cross the kinks near the state.
constexpr double first_step = 1e-3;
constexpr double smaller_step = 1e-6;
/// A memory that changes along the path as the sticking row does counts as constant if their
/// gradients differ by less than this fraction.
constexpr double same_gradient = 1e-7;
/// Rates below this fraction of the largest rate of their kind are rounding.
constexpr double no_rate = 1e-9;
/// An event lies between the end of the step before it and the end of its short step; predictions
/// miss it by up to this many lengths of the short step.
constexpr double most_missed = 3.0;
/// Refinement of solutions with regularised factors.
constexpr int most_refinements = 30;

double largest(const Eigen::Ref<const VectorXd>& of) {
  return of.size() == 0 ? 0.0 : of.lpNorm<Eigen::Infinity>();
}

int memory_size(const Joint& joint) {
  return std::visit([](const auto& one) { return one.history(); }, joint);
}

/// Linear system of a step, possibly with dependent sticking rows.
class StepMatrix {
 public:
  StepMatrix(const System& system, const RecordedStep& step) : at_(system.assembly()) {
    system.evaluate(step.z, step.time, step.start, step.statuses, step.joints, step.opening, at_);
    matrix_ = at_.jacobian();
    regular_ = [&system, this] { return with_compliant_closures(system, at_); };
  }
  /// Solution of the transposed system; empty: singular.
  std::optional<VectorXd> transposed(const VectorXd& right) const {
    const Eigen::SparseMatrix<double> matrix = matrix_.transpose();
    return solved(matrix, right, true);
  }
  std::optional<VectorXd> solved(const VectorXd& right) const {
    return solved(matrix_, right, false);
  }

 private:
  std::optional<VectorXd> solved(const Eigen::SparseMatrix<double>& matrix, const VectorXd& right,
                                 bool transposes) const {
    linear::SparseFactor factor;
    if (!factor.factorize(matrix)) {
      Eigen::SparseMatrix<double> regular = regular_();
      if (transposes) regular = Eigen::SparseMatrix<double>(regular.transpose());
      if (!factor.factorize(regular)) return std::nullopt;
    }
    VectorXd found = factor.solve(right);
    double last = std::numeric_limits<double>::infinity();
    for (int k = 0; k < most_refinements; ++k) {
      const VectorXd step = factor.solve(right - matrix * found);
      const double length = largest(step);
      if (!(length < 0.5 * last)) break;
      found += step;
      last = length;
    }
    return found;
  }

  Assembly at_;
  Eigen::SparseMatrix<double> matrix_;
  std::function<Eigen::SparseMatrix<double>()> regular_;
};

/// The start of a step whose memory is empty.
StepStart empty_start(const RecordedStep& step) {
  StepStart made;
  made.statuses = step.written_with;
  made.history = VectorXd::Zero(step.start.history.size());
  return made;
}

/// A joint where a step wrote or writes the memory of the next one.
struct Written {
  StepStart start;  ///< Empty memory, for the start of a path.
  std::optional<LocalJoint> joint;
  JointStatus status = JointStatus::stick;
  MemoryWriter writer = MemoryWriter::none;

  VectorXd memory(const Trial& at) const {
    switch (writer) {
      case MemoryWriter::commit:
        return joint->commit(at, status);
      case MemoryWriter::begin:
        return joint->begin(at, status);
      case MemoryWriter::zero_force: {
        VectorXd made = joint->begin(at, status);
        begin_at_zero_force(joint->joint(), at, status, made.data());
        return made;
      }
      default:
        return VectorXd::Zero(joint->memory_size());
    }
  }
};

/// The joint at the state from which the memory of step `next` was written.
void write(const System& before, const System& after, const RecordedStep& last,
           const RecordedStep& next, int joint, double last_time, Written& made) {
  made.writer = next.writer;
  if (next.writer == MemoryWriter::commit) {
    made.status = last.statuses[index(joint)];
    made.joint.emplace(before, joint, last.z, last_time, last.start, JointModel::friction, 1.0);
    return;
  }
  if (next.writer == MemoryWriter::none) return;
  made.start = empty_start(next);
  made.status = next.written_with[index(joint)];
  const bool loose = next.writer == MemoryWriter::zero_force;
  made.joint.emplace(after, joint, next.written_at, 0.0, made.start,
                     loose ? JointModel::frictionless : JointModel::friction, next.written_opening);
}

/// Times of one truss between the corners of its programs, mapped to those of another.
double mapped(double time, const std::vector<double>& from, const std::vector<double>& to) {
  const auto after = std::lower_bound(from.begin(), from.end(), time);
  if (after == from.begin()) return to.front();
  if (after == from.end()) return to.back();
  const auto i = static_cast<std::size_t>(after - from.begin());
  if (*after == time) return to[i];
  const double share = (time - from[i - 1]) / (from[i] - from[i - 1]);
  return to[i - 1] + share * (to[i] - to[i - 1]);
}

}  // namespace

const System& Variants::of(const RecordedStep& step) {
  Variant& variant = made_[{step.load_fraction, step.without_friction}];
  if (variant.system == nullptr) {
    Model model = step.without_friction ? without_friction(*model_) : *model_;
    if (step.load_fraction != 1.0) model = loaded(std::move(model), step.load_fraction);
    variant.model = std::make_unique<const Model>(std::move(model));
    variant.system = std::make_unique<const System>(*variant.model);
  }
  return *variant.system;
}

/// Goes from the last step to the first and collects the multipliers.
class AdjointPath::Sweep {
 public:
  Sweep(AdjointPath& to, const std::vector<Eigen::Matrix3Xd>& covectors)
      : to_(to), record_(*to.record_), variants_(*to.recorded_) {
    for (std::size_t c = 0; c < covectors.size(); ++c) {
      if (!covectors[c].isZero(0.0)) {
        to_.outputs_.push_back({record_.cycle_ends.at(c), scaled(covectors[c])});
      }
    }
  }

  void run() {
    const std::vector<RecordedStep>& steps = record_.steps;
    if (to_.outputs_.empty()) return;
    VectorXd after = VectorXd::Zero(steps.back().start.history.size());
    for (std::size_t k = steps.size(); k-- > 0;) {
      const System& system = variants_.of(steps[k]);
      VectorXd right = VectorXd::Zero(system.unknowns());
      for (const Output& one : to_.outputs_) {
        if (one.step != k) continue;
        for (Eigen::Index site = 0; site < one.covector.cols(); ++site) {
          system.dofs().add_force(static_cast<int>(site), one.covector.col(site), right);
        }
      }
      VectorXd before = VectorXd::Zero(after.size());
      if (k + 1 < steps.size()) carry_back(k, after, right, before);
      if (!right.isZero(0.0)) balance(k, right, before);
      after = std::move(before);
    }
  }

 private:
  /// Covectors of rotations [1/rad] act on displacements at the distance Node::arm [1/m].
  Eigen::Matrix3Xd scaled(Eigen::Matrix3Xd covector) const {
    const auto nodes = static_cast<Eigen::Index>(record_.model.nodes.size());
    for (Eigen::Index site = nodes; site < covector.cols(); ++site) {
      covector.col(site) /= record_.model.nodes[static_cast<std::size_t>(site - nodes)].arm;
    }
    return covector;
  }

  /// Carries the multipliers of the memory after step k back to its unknowns and to the memory
  /// before it.
  void carry_back(std::size_t k, const VectorXd& after, VectorXd& right, VectorXd& before) {
    const RecordedStep& step = record_.steps[k];
    const RecordedStep& next = record_.steps[k + 1];
    if (next.writer == MemoryWriter::none) return;
    const System& system = variants_.of(step);
    const System& later = variants_.of(next);
    std::vector<int> living;
    for (int i = 0; i < static_cast<int>(record_.model.joints.size()); ++i) {
      const int size = memory_size(record_.model.joints[index(i)]);
      const Eigen::Index first = later.history(i, next.start) - next.start.history.data();
      if (size == 0 || after.segment(first, size).isZero(0.0)) continue;
      const VectorXd multiplier = after.segment(first, size);
      Written at;
      write(system, later, step, next, i, step.time, at);
      if (next.writer == MemoryWriter::commit && is_kept(at, step, multiplier)) {
        before.segment(first, size) += multiplier;
        continue;
      }
      living.push_back(i);
      to_.memories_.push_back({k + 1, i, multiplier});
      at.joint->add(by_unknowns(at, step, system, multiplier), right);
      if (next.writer != MemoryWriter::commit) continue;
      before.segment(first, size) += by_memory(at, multiplier, [&](const Trial& trial) {
        return VectorXd::Constant(1, multiplier.dot(at.memory(trial)));
      });
    }
    if (!living.empty()) add_event(k, living, after, right, before);
  }

  /// Whether a sticking joint keeps its memory: the row of sticking is the change of the memory.
  bool is_kept(const Written& at, const RecordedStep& step, const VectorXd& multiplier) {
    if (is_slip(at.status) || at.status == JointStatus::open) return false;
    if (step.joints != JointModel::friction) return false;
    const LocalJoint& joint = *at.joint;
    const int row = LocalJoint::forces_from + joint.slide_row();
    const auto both = [&](const Trial& trial) {
      VectorXd made(joint.memory_size() + 1);
      made << at.memory(trial), joint.residual(trial, at.status)[row];
      return made;
    };
    const Eigen::MatrixXd by_z = gradients(joint, both);
    VectorXd row_by_memory(joint.memory_size());
    Eigen::MatrixXd memory_by_memory(joint.memory_size(), joint.memory_size());
    for (int m = 0; m < joint.memory_size(); ++m) {
      const VectorXd found = along_memory(joint, m, both);
      memory_by_memory.col(m) = found.head(joint.memory_size());
      row_by_memory[m] = found[joint.memory_size()];
    }
    for (int m = 0; m < joint.memory_size(); ++m) {
      if (multiplier[m] == 0.0) continue;
      const double factor = row_by_memory[m];
      VectorXd others = row_by_memory;
      others[m] = 0.0;
      const Eigen::RowVectorXd row_by_z = by_z.row(joint.memory_size());
      const Eigen::RowVectorXd rest = row_by_z + factor * by_z.row(m);
      const bool is_row =
          factor != 0.0 && largest(others) <= same_gradient * std::abs(factor) &&
          largest(rest.transpose()) <= same_gradient * largest(row_by_z.transpose());
      const bool is_copied =
          by_z.row(m).isZero(0.0) &&
          (memory_by_memory.row(m) - Eigen::RowVectorXd::Unit(joint.memory_size(), m)).isZero(1e-9);
      if (!is_row && !is_copied) return false;
    }
    return true;
  }

  /// Derivatives of a function of a joint by its own unknowns, a column for each.
  template <class Function>
  Eigen::MatrixXd gradients(const LocalJoint& joint, Function&& function) const {
    Eigen::MatrixXd found = Eigen::MatrixXd::Zero(function(joint.trial()).size(), LocalJoint::size);
    joint.each_unknown(length_, force_, [&](int k, double own, double common) {
      const auto along = [&](double by) {
        return VectorXd(function(joint.moved(VectorXd::Unit(LocalJoint::size, k) * by)));
      };
      found.col(k) = derivative(along, {first_step * own, smaller_step * own, first_step * common});
    });
    return found;
  }

  /// Derivative of a function of a joint by a number of its memory at the start of the step.
  template <class Function>
  VectorXd along_memory(const LocalJoint& joint, int m, Function&& function) const {
    const VectorXd own = joint.memory();
    const auto along = [&](double by) {
      VectorXd memory = own;
      memory[m] += by;
      Trial trial = joint.trial();
      trial.history = memory.data();
      return VectorXd(function(trial));
    };
    const double size = std::abs(own[m]);
    return derivative(along, {first_step * size, smaller_step * size, first_step * length_,
                              size == 0.0 ? first_step * largest(own) : 0.0});
  }

  VectorXd by_unknowns(const Written& at, const RecordedStep& step, const System& system,
                       const VectorXd& multiplier) {
    set_scales(system, step);
    return gradients(*at.joint,
                     [&](const Trial& trial) {
                       return VectorXd::Constant(1, multiplier.dot(at.memory(trial)));
                     })
        .row(0)
        .transpose();
  }

  template <class Function>
  VectorXd by_memory(const Written& at, const VectorXd& multiplier, Function&& function) const {
    VectorXd found(multiplier.size());
    for (int m = 0; m < multiplier.size(); ++m) {
      found[m] = along_memory(*at.joint, m, function)[0];
    }
    return found;
  }

  void set_scales(const System& system, const RecordedStep& step) {
    length_ = system.reach(step.z);
    force_ = largest(step.z.tail(system.unknowns() - system.displacements()));
  }

  /// Solves the transposed equations of step k, and carries their solution to the memory before it.
  void balance(std::size_t k, const VectorXd& right, VectorXd& before) {
    const RecordedStep& step = record_.steps[k];
    const System& system = variants_.of(step);
    const std::optional<VectorXd> w = StepMatrix(system, step).transposed(right);
    if (!w) {
      throw Failure(failure_at(FailureKind::singular, record_.model, step.time));
    }
    set_scales(system, step);
    for (int i = 0; i < static_cast<int>(record_.model.joints.size()); ++i) {
      if (memory_size(record_.model.joints[index(i)]) == 0) continue;
      const LocalJoint joint(system, step, i, step.time);
      const VectorXd along = joint.local(*w);
      if (along.isZero(0.0)) continue;
      const Eigen::Index first = system.history(i, step.start) - step.start.history.data();
      for (int m = 0; m < joint.memory_size(); ++m) {
        before[first + m] -= along_memory(joint, m, [&](const Trial& trial) {
          return VectorXd::Constant(1, joint.work(along, trial, step.statuses[index(i)]));
        })[0];
      }
    }
    to_.balances_.push_back({k, *w});
  }

  /// Whether the time of a step does not depend on any parameter.
  bool has_fixed_time(const RecordedStep& step) const {
    const auto& corners = record_.corners;
    return std::binary_search(corners.begin(), corners.end(), step.time);
  }

  /// A joint whose change of status ended a step, and the condition of this change.
  struct Fired {
    int joint = -1;
    int row = 0;
    double rate = 0.0;                                       ///< Of the condition before the event.
    double until = std::numeric_limits<double>::infinity();  ///< Predicted time until it holds [s].
  };

  /// Adds the term of the event after step k, at which living memory was written.
  void add_event(std::size_t k, const std::vector<int>& living, const VectorXd& after,
                 VectorXd& right, VectorXd& before) {
    const RecordedStep& step = record_.steps[k];
    const RecordedStep& next = record_.steps[k + 1];
    if (next.writer != MemoryWriter::commit || !next.is_short || has_fixed_time(step)) return;
    if (step.statuses == next.statuses) return;
    const System& system = variants_.of(step);
    const std::vector<double> heats = program_rates(step);
    const std::optional<VectorXd> rate =
        StepMatrix(system, step)
            .solved(-system.heating(step.z, step.time, step.start, step.statuses, heats));
    if (!rate) return;
    set_scales(system, step);
    const Fired fired = first_fired(step, next, system, *rate);
    if (fired.joint < 0) return;
    double memory_rate = 0.0;
    for (const int i : living) {
      Written at;
      write(system, system, step, next, i, step.time, at);
      const Eigen::Index first = system.history(i, next.start) - next.start.history.data();
      const VectorXd multiplier = after.segment(first, at.joint->memory_size());
      memory_rate += along_path(step, system, i, *rate, [&](const LocalJoint& joint) {
        return VectorXd::Constant(1, multiplier.dot(joint.commit(joint.trial(), at.status)));
      })[0];
    }
    const Guard guard{k, fired.joint, next.statuses[index(fired.joint)], fired.row,
                      -memory_rate / fired.rate};
    if (guard.weight == 0.0) return;
    const LocalJoint joint(system, step, guard.joint, step.time);
    const auto condition = [&](const Trial& trial) {
      return VectorXd::Constant(1, guard.weight * joint.residual(trial, guard.after)[guard.row]);
    };
    joint.add(gradients(joint, condition).row(0).transpose(), right);
    const Eigen::Index first = system.history(guard.joint, step.start) - step.start.history.data();
    for (int m = 0; m < joint.memory_size(); ++m) {
      before[first + m] += along_memory(joint, m, condition)[0];
    }
    to_.guards_.push_back(guard);
  }

  std::vector<double> program_rates(const RecordedStep& step) const {
    std::vector<double> found;
    for (const thermal::Program& program : record_.model.programs) {
      found.push_back(program.temperature_rate(step.time));
    }
    return found;
  }

  /// Derivative of a function of a joint along the path before the event, by time.
  template <class Function>
  VectorXd along_path(const RecordedStep& step, const System& system, int joint,
                      const VectorXd& rate, Function&& function) const {
    const auto& corners = record_.corners;
    const auto later = std::upper_bound(corners.begin(), corners.end(), step.time);
    const double until = later == corners.end() ? 0.0 : *later - step.time;
    const double since = step.time - (later == corners.begin() ? 0.0 : *std::prev(later));
    const double own = first_step * std::min(until, since);
    return derivative(
        [&](double by) {
          const VectorXd z = step.z + by * rate;
          return VectorXd(function(
              LocalJoint(system, joint, z, step.time + by, step.start, JointModel::friction, 1.0)));
        },
        {own});
  }

  /// The joint whose condition holds first after step k.
  Fired first_fired(const RecordedStep& step, const RecordedStep& next, const System& system,
                    const VectorXd& rate) {
    const double length_rate = largest(rate.head(system.displacements()));
    const double force_rate = largest(rate.tail(rate.size() - system.displacements()));
    const double width = most_missed * (next.time - step.time);
    Fired first;
    int fired = 0;
    for (int i = 0; i < static_cast<int>(step.statuses.size()); ++i) {
      const JointStatus status = next.statuses[index(i)];
      if (step.statuses[index(i)] == status) continue;
      Fired own;
      std::vector<RowUnit> units;
      const LocalJoint joint(system, step, i, step.time);
      const VectorXd now = joint.residual(joint.trial(), status, &units);
      const VectorXd rates = along_path(step, system, i, rate, [&](const LocalJoint& there) {
        return there.residual(there.trial(), status);
      });
      for (int row = LocalJoint::forces_from; row < LocalJoint::forces_from + joint.forces();
           ++row) {
        // The row of sticking is no condition.
        if (status == JointStatus::stick && row == LocalJoint::forces_from + joint.slide_row()) {
          continue;
        }
        const double scale = units[index(row)] == RowUnit::closure ? length_rate : force_rate;
        if (!(std::abs(rates[row]) > no_rate * scale)) continue;
        const double until = -now[row] / rates[row];
        if (std::abs(until) > width || until >= own.until) continue;
        own = {i, row, rates[row], until};
      }
      if (own.joint < 0) continue;
      ++fired;
      if (own.until < first.until) first = own;
    }
    if (fired > 1) ++to_.kinks_;
    return first;
  }

  AdjointPath& to_;
  const PathRecord& record_;
  Variants& variants_;
  double length_ = 0.0;  ///< Scale of displacements at the present step [m].
  double force_ = 0.0;   ///< Scale of forces at the present step [N].
};

AdjointPath::AdjointPath(std::shared_ptr<const PathRecord> record,
                         const std::vector<Eigen::Matrix3Xd>& covectors)
    : record_(std::move(record)), recorded_(std::make_unique<Variants>(record_->model)) {
  Sweep(*this, covectors).run();
}

namespace {

/// Adds to the summands of nodes and elements the work of their forces on w.
void add_forces(const System& system, const RecordedStep& step, double time, const VectorXd& w,
                VectorXd& summands) {
  const Model& model = system.model();
  for (std::size_t site = 0; site < system.dofs().sites(); ++site) {
    const Vector3d load = system.load_on(static_cast<int>(site));
    if (load.isZero(0.0)) continue;
    const auto node = static_cast<Eigen::Index>(site % model.nodes.size());
    summands[node] += load.dot(system.displacement(static_cast<int>(site), w));
  }
  std::vector<Vector3d> drawn;
  for (const Node& node : model.nodes) drawn.push_back(node.position);
  std::vector<double> changes;
  for (const auto& program : model.programs) changes.push_back(program.temperature_change(time));
  const Eigen::Matrix3Xd moved = system.displacements(step.z);
  const ElementState state(drawn, moved, changes);
  Assembly to = Assembly::without_jacobian(system.unknowns());
  to.residual.setZero();
  AssemblyStrand strand(to, 0);
  ElementWriter writer(system.dofs(), strand);
  auto item = static_cast<Eigen::Index>(model.nodes.size());
  system.each_element_type([&](const auto& elements, const auto& frames, std::size_t) {
    for (std::size_t i = 0; i < elements.size(); ++i, ++item) {
      elements[i].evaluate(frames[i], state, writer);
      for (const int site : frames[i].nodes) {
        const NodeDofs& place = system.dofs().at(site);
        for (int k = 0; k < place.freedoms; ++k) {
          place.each_term(k, [&](int row, double) {
            summands[item] -= w[row] * to.residual[row];
            to.residual[row] = 0.0;
          });
        }
      }
    }
  });
}

}  // namespace

VectorXd AdjointPath::summands(const Model& changed) const {
  Model model = changed;
  model.spin_springs = record_->model.spin_springs;
  Variants variants(model);
  const std::vector<double> corners_of_changed = corners(model);
  if (corners_of_changed.size() != record_->corners.size()) {
    throw kernel::OutOfRange("programs", "number of corners",
                             static_cast<double>(corners_of_changed.size()),
                             std::to_string(record_->corners.size()) + ", as the recorded path");
  }
  const auto time_of = [&](const RecordedStep& step) {
    return mapped(step.time, record_->corners, corners_of_changed);
  };
  const auto joints = static_cast<Eigen::Index>(model.joints.size());
  const Eigen::Index first_joint =
      static_cast<Eigen::Index>(model.nodes.size() + element_count(model));
  VectorXd made = VectorXd::Zero(first_joint + joints);
  for (const Output& one : outputs_) {
    const RecordedStep& step = record_->steps[one.step];
    const Eigen::Matrix3Xd moved = variants.of(step).displacements(step.z);
    for (Eigen::Index site = 0; site < one.covector.cols(); ++site) {
      const auto node = site % static_cast<Eigen::Index>(model.nodes.size());
      made[node] += one.covector.col(site).dot(moved.col(site));
    }
  }
  for (const Balance& one : balances_) {
    const RecordedStep& step = record_->steps[one.step];
    const System& system = variants.of(step);
    const double time = time_of(step);
    add_forces(system, step, time, one.w, made);
    for (int i = 0; i < static_cast<int>(joints); ++i) {
      const LocalJoint joint(system, step, i, time, &recorded_->of(step));
      made[first_joint + i] -=
          joint.work(joint.local(one.w), joint.trial(), step.statuses[index(i)]);
    }
  }
  for (const Memory& one : memories_) {
    const RecordedStep& next = record_->steps[one.step];
    const RecordedStep& last = record_->steps[one.step - 1];
    Written at;
    write(variants.of(last), variants.of(next), last, next, one.joint, time_of(last), at);
    made[first_joint + one.joint] += one.multiplier.dot(at.memory(at.joint->trial()));
  }
  for (const Guard& one : guards_) {
    const RecordedStep& step = record_->steps[one.step];
    const LocalJoint joint(variants.of(step), step, one.joint, time_of(step), &recorded_->of(step));
    made[first_joint + one.joint] += one.weight * joint.residual(joint.trial(), one.after)[one.row];
  }
  return made;
}

}  // namespace statejump::truss::detail

namespace statejump::truss {

OutputDerivative::OutputDerivative(const RecordedPath& recorded,
                                   const std::vector<Eigen::Matrix3Xd>& covectors)
    : adjoint_(std::make_shared<const detail::AdjointPath>(recorded.record, covectors)) {}

Eigen::VectorXd OutputDerivative::summands(const Model& changed) const {
  return adjoint_->summands(changed);
}

int OutputDerivative::solutions() const {
  return adjoint_->solutions();
}

int OutputDerivative::events() const {
  return adjoint_->events();
}

int OutputDerivative::kinks() const {
  return adjoint_->kinks();
}

}  // namespace statejump::truss
