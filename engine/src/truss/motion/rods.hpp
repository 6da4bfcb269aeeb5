// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "statejump/truss/motion.hpp"
#include "truss/system.hpp"

namespace statejump::truss::detail {

/// Computes in one pass the forces of links and their dashpots on the independent displacements. It
/// is faster than System and Bodies, which compute the same forces.
class Rods {
 public:
  /// @pre The system and its model outlive this object.
  Rods(const System& system, const Inertia& inertia);

  /// Temperature changes [K] of all programs at a time, and their rates [K/s].
  struct Heat {
    std::vector<double> change;
    std::vector<double> rate;
  };
  /// Heat of the dashpots, and work of the temperature, per unit of time [W].
  struct Power {
    double heat = 0.0;
    double thermal = 0.0;
  };
  using ConstColumn = Eigen::Ref<const Eigen::VectorXd>;
  /// Adds the forces on the free displacements [N].
  void add_force(const ConstColumn& q, const ConstColumn& v, const Heat& heat,
                 Eigen::VectorXd& to) const;
  Power power(const ConstColumn& q, const ConstColumn& v, const Heat& heat) const;

 private:
  /// An independent displacement, and the relative motion of a rod's ends (second minus first) that
  /// a unit of it causes.
  struct Move {
    int row;
    Vector3d by;
  };
  struct Rod {
    std::size_t first_move;
    std::size_t last_move;  ///< After the last one.
    Vector3d drawn;
    double drawn_length;
    double stress_free_length;
    double axial_stiffness;
    double expansion;  ///< α times the link's fraction of the program [1/K].
    std::size_t program;
    double axial_damping;    ///< [N s/m]
    double turning_damping;  ///< [N m s/rad]
  };
  /// State of a rod.
  struct State;
  inline State state(const Rod& rod, const double* q, const double* v, const Heat& heat) const;

  std::vector<Rod> rods_;
  std::vector<Move> moves_;  // of all rods, one rod after the other
};

}  // namespace statejump::truss::detail
