// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/elements/condensed_body.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

#include "statejump/kernel/require.hpp"
#include "statejump/kernel/rotation.hpp"
#include "statejump/truss/model.hpp"
#include "truss/elements/writer.hpp"
#include "truss/thermal_step.hpp"

namespace statejump::truss {

using detail::index;
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using kernel::Quaternion;
using kernel::skew;
using Matrix3X = Eigen::Matrix3Xd;
using MatrixX3 = Eigen::MatrixX3d;

namespace {

std::string named(const CondensedBody& body) {
  return std::string(CondensedBody::kind) + " '" + body.name + "'";
}

int count_of(const CondensedBody::Frame& frame) {
  return static_cast<int>(frame.drawn.size());
}

/// Rotation vector of a unit quaternion [rad], of the shorter way.
Vector3d rotation_vector(const Quaternion& turned) {
  const double sine = turned.vec().norm();
  if (sine == 0.0) return Vector3d::Zero();
  const double sign = turned.w() < 0.0 ? -1.0 : 1.0;
  return sign * 2.0 * std::atan2(sine, sign * turned.w()) / sine * turned.vec();
}

/// Axial vector of the skew part of a matrix: that of skew(v) is v.
Vector3d axial(const Matrix3d& of) {
  return 0.5 * Vector3d(of(2, 1) - of(1, 2), of(0, 2) - of(2, 0), of(1, 0) - of(0, 1));
}

/// Displacements of the nodes of a body and their rotations.
struct Moved {
  std::vector<Vector3d> places;     ///< [m]
  std::vector<Vector3d> rotations;  ///< Rotation vectors [rad]; zero where a node has none.
};

/// @param moved_at displacement of a site [m]
template <class MovedAt>
Moved moved_of(const CondensedBody::Frame& frame, MovedAt&& moved_at) {
  Moved made;
  for (int i = 0; i < count_of(frame); ++i) {
    made.places.push_back(moved_at(frame.nodes[index(i)]));
    const int site = frame.turning[index(i)];
    made.rotations.push_back(site < 0 ? Vector3d::Zero()
                                      : Vector3d(moved_at(site) / frame.arms[index(i)]));
  }
  return made;
}

Moved moved_of(const CondensedBody::Frame& frame, const ElementState& state) {
  return moved_of(frame, [&](int site) -> Vector3d { return state.moved(site); });
}

/// The frame of a body and the deformations in it.
struct Deformed {
  Quaternion rotation;                ///< R.
  std::vector<Vector3d> apart;        ///< x_i − c [m].
  std::vector<Quaternion> rotations;  ///< R_i.
  VectorXd q;                         ///< Deformations [m, rad].

  Matrix3d axes() const { return rotation.toRotationMatrix(); }
};

/// Derivative of the sum that the frame maximises with respect to a spin of the frame, and minus
/// its second derivative. Written with the deformations, so that it has no rounding where they are
/// zero.
struct FrameBalance {
  Vector3d gradient = Vector3d::Zero();  ///< Σ R (X_i − C) × (x_i − c) + 2 l² Σ ax(R_i Rᵀ).
  Matrix3d matrix = Matrix3d::Zero();
};

Vector3d deformation(const Deformed& at, const CondensedBody::Frame& frame, const Moved& moved,
                     const Vector3d& mean, int i) {
  // Rᵀ (X + u) − X without the difference of two positions.
  const Quaternion back = at.rotation.conjugate();
  return back * (moved.places[index(i)] - mean) + kernel::moved_by(back, frame.drawn[index(i)]);
}

FrameBalance balance_of(const Deformed& at, const CondensedBody::Frame& frame) {
  FrameBalance sum;
  const Matrix3d axes = at.axes();
  for (int i = 0; i < count_of(frame); ++i) {
    const Vector3d arm = axes * frame.drawn[index(i)];
    const Vector3d& apart = at.apart[index(i)];
    sum.gradient += arm.cross(axes * at.q.segment<3>(frame.rows[index(i)]));
    sum.matrix += apart.dot(arm) * Matrix3d::Identity() - arm * apart.transpose();
    if (frame.turning[index(i)] == -1) continue;
    const Quaternion relative = at.rotations[index(i)] * at.rotation.conjugate();
    const Matrix3d turned = relative.toRotationMatrix();
    sum.gradient += 4.0 * frame.squared_radius * relative.w() * relative.vec();
    sum.matrix += frame.squared_radius *
                  (turned.trace() * Matrix3d::Identity() - Matrix3d(turned.transpose()));
  }
  return sum;
}

/// Solution of least norm: two nodes without rotations do not determine how the frame rolls about
/// their line, which has no effect.
template <class Right>
Right solved(const Matrix3d& matrix, const Right& right) {
  Eigen::CompleteOrthogonalDecomposition<Matrix3d> parts;
  parts.setThreshold(1e-9);
  parts.compute(matrix);
  return parts.solve(right);
}

/// First approximation of the frame's rotation: the polar factor by singular values.
Quaternion polar_rotation(const CondensedBody::Frame& frame, const Deformed& at) {
  Matrix3d sum = Matrix3d::Zero();
  for (int i = 0; i < count_of(frame); ++i) {
    sum += at.apart[index(i)] * frame.drawn[index(i)].transpose();
    if (frame.turning[index(i)] == -1) continue;
    sum += frame.squared_radius * at.rotations[index(i)].toRotationMatrix();
  }
  const Eigen::JacobiSVD<Matrix3d> parts(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d made = parts.matrixU() * parts.matrixV().transpose();
  if (made.determinant() < 0.0) {
    Matrix3d mirrored = parts.matrixU();
    mirrored.col(2) *= -1.0;
    made = mirrored * parts.matrixV().transpose();
  }
  return Quaternion(made).normalized();
}

Deformed deformed(const CondensedBody::Frame& frame, const Moved& moved) {
  Deformed made;
  const int count = count_of(frame);
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& one : moved.places) mean += one / count;
  for (int i = 0; i < count; ++i) {
    made.apart.push_back(frame.drawn[index(i)] + (moved.places[index(i)] - mean));
    made.rotations.push_back(kernel::rotation_of(moved.rotations[index(i)]));
  }
  made.q.resize(frame.rows.back());
  const auto measure = [&] {
    for (int i = 0; i < count; ++i) {
      const int row = frame.rows[index(i)];
      made.q.segment<3>(row) = deformation(made, frame, moved, mean, i);
      if (frame.turning[index(i)] == -1) continue;
      made.q.segment<3>(row + 3) =
          rotation_vector(made.rotation.conjugate() * made.rotations[index(i)]);
    }
  };
  made.rotation = polar_rotation(frame, made);
  measure();
  // Two Newton steps remove the rounding of the singular values, which is relative to 1 rad, not to
  // the deformations.
  for (int step = 0; step < 2; ++step) {
    const FrameBalance sum = balance_of(made, frame);
    made.rotation =
        (kernel::rotation_of(solved(sum.matrix, sum.gradient)) * made.rotation).normalized();
    measure();
  }
  return made;
}

/// q − q_th for temperature changes by program [m, rad].
template <class ChangeOf>
VectorXd strained(const CondensedBody& body, VectorXd q, ChangeOf&& change_of) {
  for (const ThermalPattern& pattern : body.patterns) {
    q -= pattern.fraction * change_of(pattern.program) * pattern.free_shape;
  }
  return q;
}

/// Derivatives of the energy by the places of the nodes, by spins of the nodes and of the frame,
/// while the others do not change; `multiplier` is that of the frame's balance.
class Forces {
 public:
  Forces(const CondensedBody::Frame& frame, const Deformed& at, const VectorXd& inner)
      : frame_(frame), at_(at), balance_(balance_of(at, frame)), axes_(at.axes()) {
    const int count = count_of(frame);
    Vector3d by_frame = Vector3d::Zero();
    for (int i = 0; i < count; ++i) {
      const int row = frame.rows[index(i)];
      push_.push_back(axes_ * inner.segment<3>(row));
      by_frame -= at.apart[index(i)].cross(push_.back());
      moment_.push_back(Vector3d::Zero());
      to_rotation_.push_back(Matrix3d::Zero());
      if (frame.turning[index(i)] == -1) continue;
      const Vector3d angle = at.q.segment<3>(row + 3);
      to_rotation_.back() = kernel::inverse_spin_map(angle) * axes_.transpose();
      moment_.back() = to_rotation_.back().transpose() * inner.segment<3>(row + 3);
      by_frame -= moment_.back();
    }
    // The derivative of the frame's balance by the spin of the frame is −matrix.
    multiplier_ = solved(balance_.matrix.transpose(), by_frame);
  }

  /// Force on a node [N].
  Vector3d force(int i) const { return push_[index(i)] + multiplier_.cross(arm(i)); }
  /// Moment on a node, conjugate to its spin [N m].
  Vector3d moment(int i) const {
    return moment_[index(i)] + frame_.squared_radius * (spin_factor(i).transpose() * multiplier_);
  }
  /// Second derivative of the energy by places and spins, in the order of the freedoms.
  MatrixXd tangent(const MatrixXd& stiffness, const VectorXd& inner) const;

 private:
  Vector3d arm(int i) const { return axes_ * frame_.drawn[index(i)]; }
  /// R_i Rᵀ.
  Matrix3d turned(int i) const {
    return at_.rotations[index(i)].toRotationMatrix() * axes_.transpose();
  }
  /// The frame's balance by the spin of a node, over l².
  Matrix3d spin_factor(int i) const {
    const Matrix3d by = turned(i);
    return by.trace() * Matrix3d::Identity() - by;
  }
  bool rotates(int i) const { return frame_.turning[index(i)] != -1; }
  /// Adds what the rotation of the frame and the curvature of log() change at constant `inner`.
  void add_geometry(int i, const VectorXd& inner, MatrixXd& nodes, MatrixX3& mixed,
                    Matrix3d& of_frame) const;

  const CondensedBody::Frame& frame_;
  const Deformed& at_;
  FrameBalance balance_;
  Matrix3d axes_;
  std::vector<Vector3d> push_;         ///< Rᵀ-free force of each node [N].
  std::vector<Vector3d> moment_;       ///< [N m]
  std::vector<Matrix3d> to_rotation_;  ///< From the spin of a node to the rate of its q.
  Vector3d multiplier_;
};

void Forces::add_geometry(int i, const VectorXd& inner, MatrixXd& nodes, MatrixX3& mixed,
                          Matrix3d& of_frame) const {
  const int row = frame_.rows[index(i)];
  const Vector3d& apart = at_.apart[index(i)];
  const Matrix3d pushed = skew(push_[index(i)]);
  const Vector3d lever = arm(i);
  mixed.middleRows<3>(row) -= pushed + skew(multiplier_) * skew(lever);
  of_frame += skew(apart) * pushed - multiplier_ * lever.cross(apart).transpose() +
              apart * lever.cross(multiplier_).transpose();
  if (!rotates(i)) return;
  const Matrix3d by = turned(i);
  const double scale = frame_.squared_radius;
  const Vector3d twice = 2.0 * axial(by);
  const Vector3d angle = at_.q.segment<3>(row + 3);
  const Matrix3d curved = axes_ *
                          kernel::inverse_spin_map_derivative(angle, inner.segment<3>(row + 3)) *
                          to_rotation_[index(i)];
  const Matrix3d moments = skew(moment_[index(i)]);
  nodes.block<3, 3>(row + 3, row + 3) +=
      curved - scale * (multiplier_ * twice.transpose() + by.transpose() * skew(multiplier_));
  mixed.middleRows<3>(row + 3) +=
      -moments - curved +
      scale * (multiplier_ * twice.transpose() + skew(by.transpose() * multiplier_));
  of_frame += moments + curved - scale * (multiplier_ * twice.transpose() - by * skew(multiplier_));
}

MatrixXd Forces::tangent(const MatrixXd& stiffness, const VectorXd& inner) const {
  const Index freedoms = stiffness.rows();
  const int count = count_of(frame_);
  // By columns of the freedoms: Jᵀ K J with the block diagonal matrix J of the nodes.
  MatrixXd nodes = stiffness;
  MatrixX3 by_frame(freedoms, 3);  // rate of q by the spin of the frame
  Matrix3X balance(3, freedoms);   // frame's balance by places and spins
  const auto each_block = [&](auto&& use) {
    for (int i = 0; i < count; ++i) {
      const int row = frame_.rows[index(i)];
      use(row, Matrix3d(axes_.transpose()));
      if (rotates(i)) use(row + 3, to_rotation_[index(i)]);
    }
  };
  for (int i = 0; i < count; ++i) {
    const int row = frame_.rows[index(i)];
    by_frame.middleRows<3>(row) = axes_.transpose() * skew(at_.apart[index(i)]);
    balance.middleCols<3>(row) = skew(arm(i));
    if (!rotates(i)) continue;
    by_frame.middleRows<3>(row + 3) = -to_rotation_[index(i)];
    balance.middleCols<3>(row + 3) = frame_.squared_radius * spin_factor(i);
  }
  MatrixX3 mixed = stiffness * by_frame;
  Matrix3d of_frame = by_frame.transpose() * mixed;
  each_block([&](int row, const Matrix3d& map) {
    nodes.middleRows<3>(row) = (map.transpose() * nodes.middleRows<3>(row)).eval();
    mixed.middleRows<3>(row) = (map.transpose() * mixed.middleRows<3>(row)).eval();
  });
  each_block([&](int row, const Matrix3d& map) {
    nodes.middleCols<3>(row) = (nodes.middleCols<3>(row) * map).eval();
  });
  for (int i = 0; i < count; ++i) add_geometry(i, inner, nodes, mixed, of_frame);
  of_frame = (0.5 * (of_frame + of_frame.transpose())).eval();
  // The frame follows the nodes: its spin is W times places and spins.
  const Matrix3X follows = solved(balance_.matrix, balance);
  const MatrixX3 half = mixed + 0.5 * follows.transpose() * of_frame;
  nodes.noalias() += half * follows;
  nodes.noalias() += follows.transpose() * half.transpose();
  return nodes;
}

/// Energy's derivatives at a state.
struct Evaluated {
  Moved moved;
  Deformed at;
  VectorXd inner;  ///< K (q − q_th).
};

Evaluated evaluated(const CondensedBody& body, const CondensedBody::Frame& frame,
                    const ElementState& state) {
  Evaluated made;
  made.moved = moved_of(frame, state);
  made.at = deformed(frame, made.moved);
  made.inner = body.stiffness * strained(body, made.at.q, [&](int program) {
                 return state.temperature_change(program);
               });
  return made;
}

/// Maps spins to the dofs of rotation [m].
Matrix3d spin_map(const CondensedBody::Frame& frame, const Moved& moved, int i) {
  return kernel::spin_map(moved.rotations[index(i)]) / frame.arms[index(i)];
}

void write_forces(const CondensedBody::Frame& frame, const Moved& moved, const Forces& forces,
                  ElementWriter& writer) {
  for (int i = 0; i < count_of(frame); ++i) {
    writer.force(frame.nodes[index(i)], forces.force(i));
    const int site = frame.turning[index(i)];
    if (site < 0) continue;
    writer.force(site, spin_map(frame, moved, i).transpose() * forces.moment(i));
  }
}

/// Calls `use(site, row, arm)` for every site of the body, its first freedom and, for a rotation,
/// Node::arm [m]; 0: a displacement.
template <class Use>
void each_site(const CondensedBody::Frame& frame, Use&& use) {
  for (int i = 0; i < count_of(frame); ++i) {
    use(frame.nodes[index(i)], frame.rows[index(i)], 0.0);
    const int site = frame.turning[index(i)];
    if (site >= 0) use(site, frame.rows[index(i)] + 3, frame.arms[index(i)]);
  }
}

/// Smallest over largest eigenvalue of the second derivative that determines the frame, in the
/// reference configuration.
double least_inertia(const CondensedBody::Frame& frame) {
  Matrix3d matrix = Matrix3d::Zero();
  for (int i = 0; i < count_of(frame); ++i) {
    const Vector3d& drawn = frame.drawn[index(i)];
    matrix += drawn.squaredNorm() * Matrix3d::Identity() - drawn * drawn.transpose();
    if (frame.turning[index(i)] != -1) matrix += 2.0 * frame.squared_radius * Matrix3d::Identity();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> parts(matrix);
  return parts.eigenvalues()[0] / parts.eigenvalues()[2];
}

}  // namespace

std::span<const Output> CondensedBody::outputs() {
  // The largest rotation of its nodes against the frame, and the largest force on a node.
  static const Output table[] = {{"body_bending_rad", 1}, {"body_force_N", 1}};
  return table;
}

void CondensedBody::validate(const Model& model, std::span<const TemperatureRange>) const {
  const auto demand = [&](bool holds, const char* what, double value, const char* range) {
    if (!holds) throw kernel::OutOfRange(named(*this), what, value, range);
  };
  const auto count = static_cast<int>(model.nodes.size());
  demand(nodes.size() >= 2, "count of interface nodes", static_cast<double>(nodes.size()),
         "at least 2");
  demand(rotating.size() == nodes.size(), "count of flags", static_cast<double>(rotating.size()),
         "that of its nodes");
  Index freedoms = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    demand(nodes[i] >= 0 && nodes[i] < count, "node", nodes[i], "0 <= node < count of nodes");
    freedoms += rotating[i] ? 6 : 3;
  }
  const auto is_matrix = [&](const MatrixXd& one) {
    return one.rows() == freedoms && one.cols() == freedoms;
  };
  demand(is_matrix(stiffness), "rows of its stiffness", static_cast<double>(stiffness.rows()),
         "the count of freedoms");
  demand(inertia.size() == 0 || is_matrix(inertia), "rows of its inertia",
         static_cast<double>(inertia.rows()), "the count of freedoms");
  for (const ThermalPattern& pattern : patterns) {
    demand(pattern.free_shape.size() == freedoms, "length of a free shape",
           static_cast<double>(pattern.free_shape.size()), "the count of freedoms");
    demand(pattern.program >= 0 && pattern.program < static_cast<int>(model.programs.size()),
           "program", pattern.program, "0 <= program < count of programs");
  }
  const bool is_bar = freedoms == 6 && nodes.size() == 2;
  const double least = is_bar ? 1.0 : least_inertia(frame(model));
  demand(least > 1e-6, "smallest relative moment of inertia of its nodes", least,
         "above 1e-6: nodes that are not in a line, or a node that rotates");
}

CondensedBody::Frame CondensedBody::frame(const Model& model) const {
  Frame made;
  const auto count = static_cast<double>(nodes.size());
  Vector3d centre = Vector3d::Zero();
  for (const int node : nodes) centre += model.nodes[index(node)].position / count;
  made.nodes = nodes;
  made.squared_radius = 0.0;
  double farthest = 0.0;  // from the origin of the structure
  int row = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node& node = model.nodes[index(nodes[i])];
    made.drawn.push_back(node.position - centre);
    made.squared_radius += made.drawn.back().squaredNorm() / count;
    farthest = std::max(farthest, node.position.norm());
    made.rows.push_back(row);
    made.arms.push_back(node.arm);
    const int site = rotation_site(model, nodes[i]);
    made.turning.push_back(rotating[i] ? site : -1);
    if (rotating[i]) made.nodes.push_back(site);
    row += rotating[i] ? 6 : 3;
  }
  made.rows.push_back(row);
  // Nodes at one place, up to rounding: only rotations determine the frame, with any weight.
  if (made.squared_radius <= std::pow(1e-12 * farthest, 2)) made.squared_radius = 1.0;
  return made;
}

ElementScale CondensedBody::scale(const Frame& frame, const std::vector<Vector3d>&) const {
  ElementScale made;
  const double size = std::sqrt(frame.squared_radius);
  each_site(frame, [&](int, int row, double arm) {
    const double largest = stiffness.diagonal().segment<3>(row).maxCoeff();
    if (arm > 0.0) {
      made.by_rotation = std::max(made.by_rotation, largest / size);
    } else {
      made.stiffness = std::max(made.stiffness, largest);
    }
  });
  for (const ThermalPattern& pattern : patterns) {
    double strain = 0.0;
    each_site(frame, [&](int, int row, double arm) {
      if (arm > 0.0) return;
      strain = std::max(strain, pattern.free_shape.segment<3>(row).norm() / size);
    });
    strain *= std::abs(pattern.fraction);
    if (strain <= made.strain_per_kelvin) continue;
    made.strain_per_kelvin = strain;
    made.program = pattern.program;
  }
  return made;
}

void CondensedBody::evaluate(const Frame& frame, const ElementState& state,
                             ElementWriter& writer) const {
  const Evaluated now = evaluated(*this, frame, state);
  const Forces forces(frame, now.at, now.inner);
  write_forces(frame, now.moved, forces, writer);
  for (int i = 0; i < count_of(frame); ++i) writer.carries(forces.force(i).norm());
  if (writer.residual_only()) return;
  MatrixXd hessian = forces.tangent(stiffness, now.inner);
  for (int i = 0; i < count_of(frame); ++i) {
    if (frame.turning[index(i)] < 0) continue;
    const int row = frame.rows[index(i)] + 3;
    const Matrix3d map = spin_map(frame, now.moved, i);
    hessian.middleCols<3>(row) = (hessian.middleCols<3>(row) * map).eval();
    hessian.middleRows<3>(row) = (map.transpose() * hessian.middleRows<3>(row)).eval();
    hessian.block<3, 3>(row, row) +=
        kernel::spin_map_derivative(now.moved.rotations[index(i)], forces.moment(i)) /
        (frame.arms[index(i)] * frame.arms[index(i)]);
  }
  hessian = (0.5 * (hessian + hessian.transpose())).eval();
  each_site(frame, [&](int site, int row, double) {
    each_site(frame, [&](int other, int column, double) {
      writer.matrix(site, other, hessian.block<3, 3>(row, column));
    });
  });
}

void CondensedBody::thermal_rate(const Frame& frame, const ElementState& state,
                                 const std::vector<double>& program_rates,
                                 ElementWriter& writer) const {
  VectorXd rate = VectorXd::Zero(stiffness.rows());
  for (const ThermalPattern& pattern : patterns) {
    rate -= pattern.fraction * program_rates[index(pattern.program)] * pattern.free_shape;
  }
  if (rate.isZero(0.0)) return;
  const Moved moved = moved_of(frame, state);
  const Deformed at = deformed(frame, moved);
  write_forces(frame, moved, Forces(frame, at, stiffness * rate), writer);
}

double CondensedBody::energy(const Frame& frame, const ElementState& state) const {
  const VectorXd q = strained(*this, deformed(frame, moved_of(frame, state)).q,
                              [&](int program) { return state.temperature_change(program); });
  return 0.5 * q.dot(stiffness * q);
}

void CondensedBody::describe(const Frame& frame, const ElementState& state, double* outputs) const {
  const Evaluated now = evaluated(*this, frame, state);
  const Forces forces(frame, now.at, now.inner);
  outputs[0] = outputs[1] = 0.0;
  for (int i = 0; i < count_of(frame); ++i) {
    outputs[1] = std::max(outputs[1], forces.force(i).norm());
    if (frame.turning[index(i)] == -1) continue;
    outputs[0] = std::max(outputs[0], now.at.q.segment<3>(frame.rows[index(i)] + 3).norm());
  }
}

void CondensedBody::check_state(const Frame& frame, const ElementState& state) const {
  const Deformed at = deformed(frame, moved_of(frame, state));
  for (int i = 0; i < count_of(frame); ++i) {
    if (frame.turning[index(i)] == -1) continue;
    const double bent = at.q.segment<3>(frame.rows[index(i)] + 3).norm();
    if (bent <= largest_rotation) continue;
    throw kernel::OutOfRange(named(*this), "rotation of a node relative to the body", bent,
                             "at most 1 rad; divide the body into more bodies");
  }
}

double CondensedBody::thermal_work(const Frame& frame, const detail::ThermalStep& step) const {
  if (patterns.empty()) return 0.0;
  double work = 0.0;
  const detail::Quadrature& first = step.quadratures[index(patterns.front().program)];
  for (std::size_t k = 0; k < first.count; ++k) {
    const Moved moved =
        moved_of(frame, [&](int site) { return step.displacement(site, first.points[k].share); });
    const VectorXd inner = stiffness * strained(*this, deformed(frame, moved).q, [&](int program) {
                             return step.quadratures[index(program)].points[k].temperature_change;
                           });
    for (const ThermalPattern& pattern : patterns) {
      const double warmed = step.quadratures[index(pattern.program)].points[k].warmed;
      work -= pattern.fraction * warmed * pattern.free_shape.dot(inner);
    }
  }
  return work;
}

void CondensedBody::mass(const Frame& frame, const Inertia&, std::size_t,
                         MatrixWriter& writer) const {
  if (inertia.size() == 0) return;
  const auto per = [](double arm) { return arm > 0.0 ? 1.0 / arm : 1.0; };
  each_site(frame, [&](int site, int row, double arm) {
    each_site(frame, [&](int other, int column, double other_arm) {
      writer.block(site, other, inertia.block<3, 3>(row, column) * (per(arm) * per(other_arm)));
    });
  });
}

}  // namespace statejump::truss
