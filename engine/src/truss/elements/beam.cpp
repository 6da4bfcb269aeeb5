// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/elements/beam.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "statejump/kernel/beam.hpp"
#include "statejump/kernel/beam_section.hpp"
#include "statejump/kernel/require.hpp"
#include "statejump/truss/model.hpp"
#include "truss/elements/axial.hpp"
#include "truss/elements/writer.hpp"
#include "truss/thermal_step.hpp"

namespace statejump::truss {

using detail::index;
using Eigen::Vector3d;
using kernel::BeamStep;
using Matrix12 = BeamStep::Matrix12;
using Vector12 = BeamStep::Vector12;

namespace {

std::string named(const Beam& beam) {
  return std::string(Beam::kind) + " '" + beam.name + "'";
}

/// Displacements of both nodes [m] and their rotation vectors [rad].
struct Moved {
  std::array<Vector3d, 2> places;
  std::array<Vector3d, 2> rotations;
};

/// @param moved_at displacement of a site [m]
template <class MovedAt>
Moved moved_of(const Beam::Frame& frame, MovedAt&& moved_at) {
  const auto rotation = [&](std::size_t end) -> Vector3d {
    const int site = frame.nodes[2 + end];
    return site < 0 ? Vector3d::Zero() : Vector3d(moved_at(site) / frame.arms[end]);
  };
  return {{moved_at(frame.nodes[0]), moved_at(frame.nodes[1])}, {rotation(0), rotation(1)}};
}

Moved moved_of(const Beam::Frame& frame, const ElementState& state) {
  return moved_of(frame, [&](int site) -> Vector3d { return state.moved(site); });
}

/// ΔT of the programs of mean and gradient [K].
struct Temperatures {
  double mean;
  double gradient;
};

Temperatures temperatures(const Beam& beam, const ElementState& state) {
  return {state.temperature_change(beam.program), state.temperature_change(beam.gradient_program)};
}

/// Stress-free curvatures about axes 2 and 3 of the frame per ΔT of the gradients' program
/// [1/(m K)]. A fibre at y and z has the strain κ_y z − κ_z y.
std::array<double, 2> curvature_per_kelvin(const Beam& beam, const Beam::Frame& frame) {
  return kernel::about_frame(frame.swapped, beam.thermal_expansion * beam.gradient_z,
                             -beam.thermal_expansion * beam.gradient_y);
}

/// @param drawn from the first node to the second in the reference configuration [m]
BeamStep step_at(const Beam& beam, const Beam::Frame& frame, const Vector3d& drawn,
                 const Moved& moved, const Temperatures& at) {
  kernel::BeamState state;
  state.first = kernel::rotation_of(moved.rotations[0]);
  state.second = kernel::rotation_of(moved.rotations[1]);
  const Vector3d apart = moved.places[1] - moved.places[0] +
                         (kernel::moved_by(state.second, frame.offsets[1]) -
                          kernel::moved_by(state.first, frame.offsets[0]));
  const detail::Lengths length =
      detail::lengths(drawn + (frame.offsets[1] - frame.offsets[0]), apart);
  const double change = beam.temperature_fraction * at.mean;
  const double l0 = beam.stress_free_length;
  const std::array<double, 2> curvature = curvature_per_kelvin(beam, frame);
  state.along = length.along;
  state.stretch = detail::stretch(length.growth, length.drawn, l0, beam.thermal_expansion, change);
  state.free_length = thermal::length(l0, beam.thermal_expansion, change);
  state.curvature = {curvature[0] * at.gradient, curvature[1] * at.gradient};
  return {frame.beam, state};
}

BeamStep step_at(const Beam& beam, const Beam::Frame& frame, const ElementState& state) {
  return step_at(beam, frame, state.drawn_between(frame.nodes[0], frame.nodes[1]),
                 moved_of(frame, state), temperatures(beam, state));
}

/// Matrices that map the dofs of rotation of both nodes [m] to spins [rad].
std::array<kernel::Matrix3, 2> spin_maps(const Beam::Frame& frame, const Moved& moved) {
  return {kernel::spin_map(moved.rotations[0]) / frame.arms[0],
          kernel::spin_map(moved.rotations[1]) / frame.arms[1]};
}

/// The arms from the nodes to the ends of the beam [m].
std::array<Vector3d, 2> arms_at(const Beam::Frame& frame, const Moved& moved) {
  return {kernel::rotation_of(moved.rotations[0]) * frame.offsets[0],
          kernel::rotation_of(moved.rotations[1]) * frame.offsets[1]};
}

/// Forces and moments on the nodes for those on the ends of the beam.
Vector12 at_nodes(const std::array<Vector3d, 2>& arms, Vector12 force) {
  for (std::size_t end = 0; end < 2; ++end) {
    const auto row = 6 * static_cast<Eigen::Index>(end);
    const Vector3d pull = force.segment<3>(row);
    force.segment<3>(row + 3) += arms[end].cross(pull);
  }
  return force;
}

/// Derivative of at_nodes() by displacements and spins of the nodes.
/// @param tangent derivative of the forces on the ends by displacements and spins of the ends
void shift_to_nodes(const std::array<Vector3d, 2>& arms, const Vector12& force, Matrix12& tangent) {
  for (int end = 0; end < 2; ++end) {
    const Vector3d& arm = arms[index(end)];
    if (arm.isZero(0.0)) continue;
    const kernel::Matrix3 across = kernel::skew(arm);
    const int at = 6 * end;
    tangent.middleCols<3>(at + 3) -= (tangent.middleCols<3>(at) * across).eval();
    tangent.middleRows<3>(at + 3) += (across * tangent.middleRows<3>(at)).eval();
    tangent.block<3, 3>(at + 3, at + 3) += kernel::skew(force.segment<3>(at)) * across;
  }
}

void write_forces(const Beam::Frame& frame, const std::array<kernel::Matrix3, 2>& maps,
                  const Vector12& force, ElementWriter& writer) {
  for (std::size_t end = 0; end < 2; ++end) {
    const auto row = 6 * static_cast<Eigen::Index>(end);
    writer.force(frame.nodes[end], force.segment<3>(row));
    writer.force(frame.nodes[2 + end], maps[end].transpose() * force.segment<3>(row + 3));
  }
}

/// From the first to the second end in the reference configuration [m].
Vector3d drawn_vector(const Model& model, const Beam& beam) {
  return model.nodes[index(beam.second)].position - model.nodes[index(beam.first)].position +
         (beam.offset_second - beam.offset_first);
}

kernel::BeamSection section_of(const Beam& beam) {
  const auto moments = beam.released_moments();
  return {beam.axial_stiffness,
          beam.torsional_stiffness,
          beam.bending_stiffness_y,
          beam.bending_stiffness_z,
          beam.shear_stiffness_y,
          beam.shear_stiffness_z,
          {{{beam.released_first_axial, moments[0][0], moments[0][1], moments[0][2]},
            {beam.released_second_axial, moments[1][0], moments[1][1], moments[1][2]}}}};
}

/// Whether the rotation of a node acts on an end: by an offset, or by a moment that the end
/// transmits about an axis about which the node may rotate.
bool rotates(const Beam::Frame& frame, std::size_t end, const Node& node) {
  if (!frame.offsets[end].isZero(0.0)) return true;
  const auto& released = frame.beam.released;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto which = static_cast<std::size_t>(axis);
    // A torsion released at one end acts on neither.
    const bool is_released = axis == 0 ? released[0][0] || released[1][0] : released[end][which];
    if (is_released) continue;
    for (int i = 0; i < node.rotations; ++i) {
      const double part = frame.beam.triad.col(axis).dot(node.rotation_directions.col(i));
      if (std::abs(part) > 1e-9) return true;
    }
  }
  return false;
}

}  // namespace

std::span<const Parameter<Beam>> Beam::parameters() {
  static const Parameter<Beam> table[] = {
      {"nodes", "first node", "-", Allowed::node, "the case's nodes", &Beam::first, 0, 2},
      {"nodes", "second node", "-", Allowed::node, "the case's nodes", &Beam::second, 1, 2},
      {"axial_stiffness_N", "axial_stiffness", "N", Allowed::positive, "the case: E A",
       &Beam::axial_stiffness},
      {"torsional_stiffness_N_m2", "torsional_stiffness", "N m2", Allowed::positive,
       "the case: G J", &Beam::torsional_stiffness},
      {"bending_stiffness_N_m2", "bending_stiffness about y", "N m2", Allowed::positive,
       "the case: E I_y", &Beam::bending_stiffness_y, 0, 2},
      {"bending_stiffness_N_m2", "bending_stiffness about z", "N m2", Allowed::positive,
       "the case: E I_z", &Beam::bending_stiffness_z, 1, 2},
      {"shear_stiffness_N", "shear_stiffness along y", "N", Allowed::positive_or_infinite,
       "the case: k G A", &Beam::shear_stiffness_y, 0, 2},
      {"shear_stiffness_N", "shear_stiffness along z", "N", Allowed::positive_or_infinite,
       "the case: k G A", &Beam::shear_stiffness_z, 1, 2},
      {"stress_free_length_m", "stress_free_length", "m", Allowed::positive, "the case",
       &Beam::stress_free_length},
      {"thermal_expansion_per_K", "thermal_expansion", "1/K", Allowed::finite, "the case: α",
       &Beam::thermal_expansion},
      {"program", "program", "-", Allowed::program, "the case's programs", &Beam::program},
      {"temperature_fraction", "temperature_fraction", "-", Allowed::finite, "the case",
       &Beam::temperature_fraction},
      {"gradient_program", "gradient_program", "-", Allowed::program, "the case's programs",
       &Beam::gradient_program},
      {"gradient_per_m", "gradient along y", "1/m", Allowed::finite, "the case", &Beam::gradient_y,
       0, 2},
      {"gradient_per_m", "gradient along z", "1/m", Allowed::finite, "the case", &Beam::gradient_z,
       1, 2},
      {"axis_y", "axis_y", "-", Allowed::direction, "the case", &Beam::axis_y},
      {"offset_first_m", "offset of the first end", "m", Allowed::finite, "the case",
       &Beam::offset_first},
      {"offset_second_m", "offset of the second end", "m", Allowed::finite, "the case",
       &Beam::offset_second},
      {"released_first", "axial force", "-", Allowed::flag, "the case", &Beam::released_first_axial,
       0, 4},
      {"released_first", "moment about x", "-", Allowed::flag, "the case", &Beam::released_first_x,
       1, 4},
      {"released_first", "moment about y", "-", Allowed::flag, "the case", &Beam::released_first_y,
       2, 4},
      {"released_first", "moment about z", "-", Allowed::flag, "the case", &Beam::released_first_z,
       3, 4},
      {"released_second", "axial force", "-", Allowed::flag, "the case",
       &Beam::released_second_axial, 0, 4},
      {"released_second", "moment about x", "-", Allowed::flag, "the case",
       &Beam::released_second_x, 1, 4},
      {"released_second", "moment about y", "-", Allowed::flag, "the case",
       &Beam::released_second_y, 2, 4},
      {"released_second", "moment about z", "-", Allowed::flag, "the case",
       &Beam::released_second_z, 3, 4},
  };
  return table;
}

std::span<const Output> Beam::outputs() {
  // Of the ends in the axes x (along the beam), y and z of the deformed beam. Positive at the
  // second end: tension, forces along y and z, moments about x, y and z that it exerts on the beam;
  // at the first end all with the opposite sign, so that both are equal without bending.
  static const Output table[] = {{"beam_force_first_N", 3},
                                 {"beam_moment_first_N_m", 3},
                                 {"beam_force_second_N", 3},
                                 {"beam_moment_second_N_m", 3}};
  return table;
}

void Beam::validate(const Model& model, std::span<const TemperatureRange> ranges) const {
  const Vector3d along = drawn_vector(model, *this);
  if (!(along.norm() > 0.0)) {
    throw kernel::OutOfRange(named(*this), "distance of its ends", along.norm(), "> 0 m");
  }
  for (const auto& [at_first, at_second, what] :
       {std::tuple(released_first_axial, released_second_axial, "axial force"),
        std::tuple(released_first_x, released_second_x, "torsion")}) {
    if (at_first && at_second) {
      throw kernel::OutOfRange(named(*this), "ends that release its " + std::string(what), 2.0,
                               "at most 1");
    }
  }
  detail::check_expansion(kind, name, thermal_expansion, temperature_fraction,
                          ranges[index(program)]);
  const double skew = along.normalized().dot(axis_y);
  if (!(std::abs(skew) < 1e-9)) {
    throw kernel::OutOfRange(named(*this), "component of axis_y along the beam", skew, "0");
  }
}

Beam::Frame Beam::frame(const Model& model) const {
  const Node& one = model.nodes[index(first)];
  const Node& other = model.nodes[index(second)];
  Frame made{{first, second, rotation_site(model, first), rotation_site(model, second)},
             {one.arm, other.arm},
             {offset_first, offset_second},
             {},
             false};
  const kernel::PlacedBeam placed =
      kernel::placed(section_of(*this), drawn_vector(model, *this).normalized(), axis_y);
  made.beam = placed.beam;
  made.swapped = placed.swapped;
  for (std::size_t end = 0; end < 2; ++end) {
    const Node& node = end == 0 ? one : other;
    if (!rotates(made, end, node)) made.nodes[2 + end] = -1;
  }
  return made;
}

ElementScale Beam::scale(const Frame& frame, const std::vector<Vector3d>& drawn) const {
  const double l0 = stress_free_length;
  const double axial = axial_stiffness / l0;
  const double bending = 12.0 * std::max(bending_stiffness_y, bending_stiffness_z) / (l0 * l0 * l0);
  const double length = (drawn[index(frame.nodes[1])] - drawn[index(frame.nodes[0])] +
                         frame.offsets[1] - frame.offsets[0])
                            .norm();
  const double gradient = std::hypot(gradient_y, gradient_z) * l0;
  const bool by_gradient = gradient > std::abs(temperature_fraction);
  return {std::max(axial, bending), axial * std::abs(length - l0),
          std::abs(thermal_expansion) * std::max(gradient, std::abs(temperature_fraction)),
          by_gradient ? gradient_program : program, bending * l0};
}

void Beam::scale_misfit(const Model& model, double fraction) {
  const double drawn = drawn_vector(model, *this).norm();
  stress_free_length = drawn + fraction * (stress_free_length - drawn);
}

void Beam::evaluate(const Frame& frame, const ElementState& state, ElementWriter& writer) const {
  const BeamStep step = step_at(*this, frame, state);
  const Moved moved = moved_of(frame, state);
  const std::array<kernel::Matrix3, 2> maps = spin_maps(frame, moved);
  const std::array<Vector3d, 2> arms = arms_at(frame, moved);
  const Vector12 force_at_ends = step.gradient();
  const Vector12 force = at_nodes(arms, force_at_ends);
  write_forces(frame, maps, force, writer);
  for (Eigen::Index end = 0; end < 2; ++end) {
    writer.carries(force.segment<3>(6 * end).norm());
    writer.carries(force.segment<3>(6 * end + 3).norm() / frame.arms[index(int(end))]);
  }
  if (writer.residual_only()) return;
  // The Hessian of the energy in displacements and rotation vectors.
  Matrix12 hessian = step.tangent();
  shift_to_nodes(arms, force_at_ends, hessian);
  for (int end = 0; end < 2; ++end) {
    const int at = 6 * end + 3;
    const std::size_t which = index(end);
    hessian.middleCols<3>(at) = (hessian.middleCols<3>(at) * maps[which]).eval();
    hessian.middleRows<3>(at) = (maps[which].transpose() * hessian.middleRows<3>(at)).eval();
    hessian.block<3, 3>(at, at) +=
        kernel::spin_map_derivative(moved.rotations[which], force.segment<3>(at)) /
        (frame.arms[which] * frame.arms[which]);
  }
  hessian = (0.5 * (hessian + hessian.transpose())).eval();
  constexpr std::array<int, 4> rows{{0, 6, 3, 9}};
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = 0; b < 4; ++b) {
      writer.matrix(frame.nodes[a], frame.nodes[b], hessian.block<3, 3>(rows[a], rows[b]));
    }
  }
}

void Beam::thermal_rate(const Frame& frame, const ElementState& state,
                        const std::vector<double>& program_rates, ElementWriter& writer) const {
  const double growth =
      stress_free_length * thermal_expansion * temperature_fraction * program_rates[index(program)];
  std::array<double, 2> bend = curvature_per_kelvin(*this, frame);
  for (double& one : bend) one *= program_rates[index(gradient_program)];
  if (growth == 0.0 && bend[0] == 0.0 && bend[1] == 0.0) return;
  const BeamStep step = step_at(*this, frame, state);
  const Vector12 rate = growth * step.gradient_by_length() +
                        bend[0] * step.gradient_by_curvature(0) +
                        bend[1] * step.gradient_by_curvature(1);
  const Moved moved = moved_of(frame, state);
  write_forces(frame, spin_maps(frame, moved), at_nodes(arms_at(frame, moved), rate), writer);
}

double Beam::energy(const Frame& frame, const ElementState& state) const {
  return step_at(*this, frame, state).energy();
}

void Beam::describe(const Frame& frame, const ElementState& state, double* outputs) const {
  Eigen::Map<Vector12> found(outputs);
  found = kernel::section_forces(frame.swapped, step_at(*this, frame, state).gradient_in_frame());
}

void Beam::check_state(const Frame& frame, const ElementState& state) const {
  const BeamStep step = step_at(*this, frame, state);
  if (step.buckles()) {
    throw kernel::OutOfRange(
        named(*this), "axial force", step.tension(),
        "above the buckling load of a beam with released ends [N]; use a larger "
        "section or a shorter beam");
  }
  const double largest = step.largest_local_rotation();
  if (largest <= BeamStep::largest_rotation) return;
  const bool is_released = std::any_of(frame.beam.released.begin(), frame.beam.released.end(),
                                       [](const auto& end) { return end[1] || end[2]; });
  if (is_released) {
    throw kernel::OutOfRange(
        named(*this), "rotation of a node relative to the beam", largest,
        "at most 1 rad, if the end also transmits a moment about another axis; "
        "use a hinge");
  }
  throw kernel::OutOfRange(named(*this), "rotation of an end relative to the beam", largest,
                           "at most 1 rad; divide the beam into more beams");
}

double Beam::thermal_work(const Frame& frame, const detail::ThermalStep& step) const {
  const double expansion = stress_free_length * thermal_expansion * temperature_fraction;
  const std::array<double, 2> bend = curvature_per_kelvin(*this, frame);
  if (expansion == 0.0 && bend[0] == 0.0 && bend[1] == 0.0) return 0.0;
  const detail::Quadrature& mean = step.quadratures[index(program)];
  const detail::Quadrature& gradient = step.quadratures[index(gradient_program)];
  const Vector3d drawn = step.drawn[index(second)] - step.drawn[index(first)];
  double work = 0.0;
  for (std::size_t k = 0; k < mean.count; ++k) {
    const auto& point = mean.points[k];
    const auto& across = gradient.points[k];
    const Moved moved =
        moved_of(frame, [&](int site) { return step.displacement(site, point.share); });
    const BeamStep at =
        step_at(*this, frame, drawn, moved, {point.temperature_change, across.temperature_change});
    work += expansion * point.warmed * at.by_length();
    for (std::size_t axis = 0; axis < 2; ++axis) {
      work += bend[axis] * across.warmed * at.by_curvature(axis);
    }
  }
  return work;
}

}  // namespace statejump::truss
