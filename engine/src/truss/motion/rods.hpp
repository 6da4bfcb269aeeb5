// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "statejump/truss/motion.hpp"
#include "truss/system.hpp"

namespace statejump::truss::detail {

/// Forces of links and of their dashpots in free displacements, both in one go: as System and
/// Bodies have them, at a fraction of the time.
class Rods {
 public:
  /// The system and its model must outlive it.
  Rods(const System& system, const Inertia& inertia);

  /// What programs are at a time: changes [K] and rates [K/s].
  struct Heat {
    std::vector<double> change;
    std::vector<double> rate;
  };
  /// Power of the dashpots' heat and of the temperature [W].
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
  struct Rod {
    /// Free displacements of its ends, and what they move its second end from its first.
    std::array<int, 6> rows{};
    std::array<Vector3d, 6> moves;
    int count = 0;
    Vector3d drawn;
    double drawn_length;
    double stress_free_length;
    double axial_stiffness;
    double expansion;  ///< α times the link's share of the program [1/K].
    std::size_t program;
    double axial_damping;    ///< [N s/m]
    double turning_damping;  ///< [N m s/rad]
  };
  /// A rod as it is.
  struct State;
  static inline State state(const Rod& rod, const double* q, const double* v, const Heat& heat);

  std::vector<Rod> rods_;
};

}  // namespace statejump::truss::detail
