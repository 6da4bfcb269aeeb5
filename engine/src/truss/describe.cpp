// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "hermite.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

namespace {

/// Integrating the work of as many links, or describing as many parts, takes some ten times as long
/// as starting a thread.
constexpr std::size_t parts_at_once = 5000;

/// Abscissae and weights on (0, 1) of the quadrature of order 8.
constexpr std::array<std::pair<double, double>, 4> gauss_legendre{
    {{0.069431844202973712, 0.17392742256872693},
     {0.33000947820757187, 0.32607257743127307},
     {0.66999052179242813, 0.32607257743127307},
     {0.93056815579702629, 0.17392742256872693}}};

/// Angle between two links from the drawn shape, or of one from the ground [rad].
double torsion_angle(const Model& model, const TorsionSpring& spring, const Matrix32& plane,
                     const Eigen::Matrix3Xd& displacement) {
  const auto turned = [&](int i) {
    const Link& link = model.links[index(i)];
    const Vector2d drawn = plane.transpose() * (model.nodes[index(link.second)].position -
                                                model.nodes[index(link.first)].position);
    const Vector2d moved =
        plane.transpose() * (displacement.col(link.second) - displacement.col(link.first));
    return turn_by(drawn, moved);
  };
  const double first = turned(spring.first_link);
  return spring.second_link < 0 ? first : turned(spring.second_link) - first;
}

/// Where in a step the work of a program's temperature is asked: what the program says there.
struct Quadrature {
  struct Point {
    double share;
    double temperature_change;  ///< [K]
    double warmed;              ///< Weight, a change of the temperature [K].
  };
  std::array<Point, gauss_legendre.size()> points{};
  std::size_t count = 0;
};

/// By the trapezoidal rule of a straight way, else of fourth order.
std::vector<Quadrature> quadratures(const Way& way, const Model& model) {
  std::vector<Quadrature> made;
  for (const thermal::Program& program : model.programs) {
    Quadrature of;
    const auto add = [&](double share, double when, double warmed) {
      of.points[of.count++] = {share, program.temperature_change(when), warmed};
    };
    if (way.is_straight()) {
      const double warmed =
          program.temperature_change(way.to_time) - program.temperature_change(way.from_time);
      add(0.0, way.from_time, 0.5 * warmed);
      add(1.0, way.to_time, 0.5 * warmed);
    } else {
      for (const auto& [share, weight] : gauss_legendre) {
        const double when = way.from_time + share * way.step();
        add(share, when, weight * way.step() * program.temperature_rate(when));
      }
    }
    made.push_back(of);
  }
  return made;
}

/// Integral of a function of share and temperature of a step by the temperature of a program [K].
template <class Function>
double along(const Quadrature& of, Function&& function) {
  double sum = 0.0;
  for (std::size_t k = 0; k < of.count; ++k) {
    sum += of.points[k].warmed * function(of.points[k].share, of.points[k].temperature_change);
  }
  return sum;
}

}  // namespace

void System::describe(const VectorXd& z, double time, const StepStart& now, State& state) const {
  const Model& model = *model_;
  const auto size = [](const auto& list) { return static_cast<Eigen::Index>(list.size()); };
  state.time = time;
  state.temperature_change = model.temperature_change(0, 1.0, time);
  state.axial_force.resize(size(model.links));
  state.tension.resize(size(model.springs));
  state.joint_output.resize(outputs_);
  state.joint_status = now.statuses;
  displacements(z, state.displacement);
  const Eigen::Matrix3Xd& moved = state.displacement;
  state.load_potential = 0.0;
  for (int i = 0; i < size(model.nodes); ++i) {
    state.load_potential -= model.nodes[index(i)].load.dot(moved.col(i));
  }
  state.elastic_energy = 0.0;
  // Energies are added up in the order of the parts, whatever threads there are.
  const auto add_energies = [&](const auto& parts, std::size_t at_once, auto&& energy_of) {
    VectorXd energies(size(parts));
    each_in_parallel(parts.size(), at_once, [&](std::size_t i) {
      energies[static_cast<Eigen::Index>(i)] = energy_of(i, parts[i]);
    });
    state.elastic_energy = std::accumulate(energies.begin(), energies.end(), state.elastic_energy);
  };
  const auto axial_energy = [](const Axial& force) {
    return force.stiffness > 0.0 ? 0.5 * force.tension * force.tension / force.stiffness : 0.0;
  };
  const std::vector<double> changes = temperature_changes(time);
  add_energies(model.links, parts_at_once, [&](std::size_t i, const Link& link) {
    const Lengths length = lengths_between(link.first, link.second, moved);
    const double change = link.temperature_fraction * changes[index(link.program)];
    const Axial force = link_axial(link, length.growth, length.drawn, change);
    state.axial_force[static_cast<Eigen::Index>(i)] = -force.tension;
    return axial_energy(force);
  });
  add_energies(model.springs, parts_at_once, [&](std::size_t i, const AxialSpring& spring) {
    const Axial force = spring_axial(spring, lengths_between(spring.first, spring.second, moved));
    state.tension[static_cast<Eigen::Index>(i)] = force.tension;
    return axial_energy(force);
  });
  add_energies(model.torsion_springs, parts_at_once,
               [&](std::size_t i, const TorsionSpring& spring) {
                 const double wound =
                     torsion_angle(model, spring, torsion_plane_[i], moved) - spring.free_angle;
                 return 0.5 * spring.stiffness * wound * wound;
               });
  add_energies(model.joints, joints_at_once, [&](std::size_t i, const Joint& joint) {
    const int which = static_cast<int>(i);
    const Trial at = trial(which, z, moved, time, now, JointModel::friction, 1.0);
    double* outputs = state.joint_output.data() + output_begin_[i];
    return std::visit(
        [&](const auto& one) {
          one.describe(at, outputs);
          return one.elastic_energy(at, history(which, now));
        },
        joint);
  });
}

VectorXd System::beyond_edges(const VectorXd& z, double time, const StepStart& now) const {
  std::vector<double> found;
  for (const AxialSpring& spring : model_->springs) {
    if (!spring.cable) continue;
    found.push_back(spring_stretch(spring, lengths_between(spring.first, spring.second, z)));
  }
  for (int i = 0; i < static_cast<int>(model_->joints.size()); ++i) {
    std::visit(
        [&](const auto& one) {
          if constexpr (requires(const Trial& at) { one.beyond_edges(at); }) {
            const Trial at = trial(i, z, time, now, JointModel::friction, 1.0);
            for (const double beyond : one.beyond_edges(at)) found.push_back(beyond);
          }
        },
        model_->joints[index(i)]);
  }
  return Eigen::Map<const VectorXd>(found.data(), static_cast<Eigen::Index>(found.size()));
}

VectorXd System::heat(const VectorXd& z, double time, const StepStart& start,
                      const StepStart& after, const VectorXd& slips) const {
  VectorXd found(slips.size());
  const Eigen::Matrix3Xd moved = displacements(z);
  each_joint([&](int i) {
    const Trial at = trial(i, z, moved, time, start, JointModel::friction, 1.0);
    // What a joint that sticks is off by is no slip.
    const double slip = after.statuses[index(i)] == JointStatus::stick ? 0.0 : slips[i];
    found[i] =
        std::visit([&](const auto& one) { return one.dissipation(at, history(i, after), slip); },
                   model_->joints[index(i)]);
  });
  return found;
}

std::optional<System::Halves> System::halves_of(const Way& way, const StepStart& start,
                                                const Statuses& statuses) const {
  const bool asked = !rolling_.empty() || slips_smoothly_ ||
                     std::any_of(statuses.begin(), statuses.end(), is_slip);
  if (way.is_straight() || !asked) return std::nullopt;
  Halves made;
  made.middle = 0.5 * (way.from + way.to) + 0.125 * way.step() * (*way.from_rate - *way.to_rate);
  made.time = way.from_time + 0.5 * way.step();
  made.half = commit(made.middle, made.time, statuses, start);
  made.whole = commit(way.to, way.to_time, statuses, made.half);
  return made;
}

void System::note_slides(const Way& way, const std::optional<Halves>& halves,
                         const StepStart& start, StepStart& after) const {
  if (rolling_.empty()) return;
  const auto joints = static_cast<Eigen::Index>(model_->joints.size());
  after.owed = after.lost = Eigen::Matrix3Xd::Zero(3, joints);
  if (halves) after.last_step = way.step();
  each_in_parallel(rolling_.size(), joints_at_once, [&](std::size_t which) {
    const int i = rolling_[which];
    if (after.statuses[index(i)] != JointStatus::stick) return;
    const Vector3d foreseen = start.foreseen(i, way.to_time);
    if (halves) {
      // Both halves together are off by a quarter of what the whole step is.
      after.lost.col(i) =
          4.0 / 3.0 *
          (lag(i, halves->middle, halves->time, start) + lag(i, way.to, way.to_time, halves->half) -
           lag(i, way.to, way.to_time, start));
    }
    after.owed.col(i) = after.lost.col(i) - foreseen;
  });
}

void System::account(const Way& way, const std::optional<Halves>& halves, const StepStart& start,
                     const StepStart& after, const VectorXd& slips, State& state) const {
  VectorXd dissipated = heat(way.to, way.to_time, start, after, slips);
  if (halves && (dissipated.array() > 0.0).any()) {
    // What both halves and the whole say of no steps at all.
    const auto& [middle, then, half, whole] = *halves;
    const VectorXd by_halves =
        heat(middle, then, start, half, this->slips(middle, then, start, half)) +
        heat(way.to, way.to_time, half, whole, this->slips(way.to, way.to_time, half, whole));
    dissipated = by_halves + (by_halves - dissipated) / 3.0;
  }
  state.joint_dissipation += dissipated;
  state.thermal_work += work_on_links(way) + work_on_joints(way, start);
}

double System::work_on_links(const Way& way) const {
  const Model& model = *model_;
  const std::vector<Quadrature> asked = quadratures(way, model);
  const auto growth_rate = [&](const Link& link, const Lengths& length, const VectorXd& moving) {
    return way.step() *
           length.along.dot(displacement(link.second, moving) - displacement(link.first, moving)) /
           length.now;
  };
  VectorXd work = VectorXd::Zero(static_cast<Eigen::Index>(model.links.size()));
  each_in_parallel(model.links.size(), parts_at_once, [&](std::size_t i) {
    const Link& link = model.links[i];
    const double expansion =
        link.stress_free_length * link.thermal_expansion * link.temperature_fraction;
    if (expansion == 0.0) return;
    const Lengths first = lengths_between(link.first, link.second, way.from);
    const Lengths last = lengths_between(link.first, link.second, way.to);
    // ∂V/∂l_T = −N − N²/(2 E A)
    const auto by_length = [&](double growth, double warmer) {
      const double tension =
          link_axial(link, growth, last.drawn, link.temperature_fraction * warmer).tension;
      return -tension * (1.0 + 0.5 * tension / link.axial_stiffness);
    };
    Cubic growth{first.growth, last.growth, 0.0, 0.0};
    if (!way.is_straight()) {
      growth.first_rate = growth_rate(link, first, *way.from_rate);
      growth.last_rate = growth_rate(link, last, *way.to_rate);
    }
    work[static_cast<Eigen::Index>(i)] =
        expansion * along(asked[index(link.program)], [&](double share, double warmer) {
          return by_length(growth.at(share), warmer);
        });
  });
  return std::accumulate(work.begin(), work.end(), 0.0);
}

double System::work_on_joints(const Way& way, const StepStart& start) const {
  const std::vector<Quadrature> asked = quadratures(way, *model_);
  VectorXd work = VectorXd::Zero(static_cast<Eigen::Index>(model_->joints.size()));
  each_joint([&](int i) {
    std::visit(
        [&](const auto& one) {
          if constexpr (requires { one.clearance_growth(); }) {
            const JointFrame& frame = frames_[index(i)];
            const double growth = one.clearance_growth() * frame.temperature_fraction;
            if (growth == 0.0) return;
            const auto at = [&](const VectorXd& z) {
              return trial(i, z, way.to_time, start, JointModel::friction, 1.0);
            };
            // A contact whose clearance grows gives way: ∂V/∂c = −N.
            const auto add = [&](auto&& joint_at) {
              work[i] = -growth * along(asked[index(frame.program)], [&](double share, double) {
                return one.contact_force(joint_at(share));
              });
            };
            if (way.is_straight()) {
              add([&](double share) { return at(share == 0.0 ? way.from : way.to); });
            } else {
              const JointWay on{at(way.from), at(way.to), at(*way.from_rate), at(*way.to_rate),
                                way.step()};
              add([&](double share) { return on.at(share); });
            }
          }
        },
        model_->joints[index(i)]);
  });
  return std::accumulate(work.begin(), work.end(), 0.0);
}

}  // namespace statejump::truss::detail
