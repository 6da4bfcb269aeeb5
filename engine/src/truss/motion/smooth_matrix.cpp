// SPDX-License-Identifier: GPL-3.0-or-later
// The iteration matrices of smooth steps. Positions of entries are determined once.
#include "entries.hpp"
#include "smooth_stepper.hpp"

namespace statejump::truss::detail {

void SmoothStepper::make_pattern(const Eigen::SparseMatrix<double>& damping) {
  const Eigen::Index n = q_.size();
  system_->evaluate_elements(z_, time_, bars_);
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](Eigen::Index row, Eigen::Index column, double) {
    entries.emplace_back(row, column, 0.0);
  };
  each_entry(bodies_->mass(), n, add);
  each_entry(damping, n, add);
  each_entry(bars_.jacobian(), n, add);
  for (const FrictionElement& one : friction_elements_) {
    for (std::size_t i = 0; i < one.count; ++i) {
      for (std::size_t j = 0; j < one.count; ++j) add(one.rows[i], one.rows[j], 0.0);
    }
  }
  stiffness_.resize(n, n);
  stiffness_.setFromTriplets(entries.begin(), entries.end());
  stiffness_.makeCompressed();
  mass_entries_ = damping_entries_ = stiffness_entries_ = VectorXd::Zero(stiffness_.nonZeros());
  each_entry(bodies_->mass(), n, [&](Eigen::Index row, Eigen::Index column, double value) {
    mass_entries_[place(stiffness_, row, column)] += value;
  });
  const auto places = [&](const auto& of) {
    std::vector<Eigen::Index> found;
    each_entry(of, n, [&](Eigen::Index row, Eigen::Index column, double) {
      found.push_back(place(stiffness_, row, column));
    });
    return found;
  };
  damping_places_ = places(damping);
  stiffness_places_ = places(bars_.jacobian());
  contact_places_.clear();
  for (const FrictionElement& one : friction_elements_) {
    for (std::size_t i = 0; i < one.count; ++i) {
      for (std::size_t j = 0; j < one.count; ++j) {
        contact_places_.push_back(place(stiffness_, one.rows[i], one.rows[j]));
      }
    }
  }
  for (auto& factor : pair_factors_) factor.analyze(stiffness_);
  renew_tangents();
}

void SmoothStepper::renew_tangents() {
  const Eigen::Index n = q_.size();
  z_.head(n) = q_;
  system_->evaluate_elements(z_, time_, bars_);
  stiffness_entries_.setZero();
  auto to = stiffness_places_.begin();
  each_entry(bars_.jacobian(), n,
             [&](Eigen::Index, Eigen::Index, double value) { stiffness_entries_[*to++] += value; });
  damping_entries_.setZero();
  if (bodies_->damped()) {
    to = damping_places_.begin();
    each_entry(bodies_->damping(q_), n,
               [&](Eigen::Index, Eigen::Index, double value) { damping_entries_[*to++] += value; });
  }
  tangents_are_new_ = true;
  trusted_ = 0;
  factor_h_ = 0.0;
  add_contacts();
}

void SmoothStepper::add_contacts() {
  Eigen::Map<VectorXd> stiffness(stiffness_.valuePtr(), stiffness_.nonZeros());
  stiffness = stiffness_entries_;
  sticking_damping_ = damping_entries_;
  auto to = contact_places_.begin();
  for (const FrictionElement& one : friction_elements_) {
    const bool sticks = one.status == FrictionElement::Status::stick;
    for (std::size_t i = 0; i < one.count; ++i) {
      for (std::size_t j = 0; j < one.count; ++j) {
        const double both = sticks ? one.along[i] * one.along[j] : 0.0;
        stiffness[*to] += one.stiffness * both;
        sticking_damping_[*to++] += one.damping * both;
      }
    }
  }
}

bool SmoothStepper::factorize(double h) {
  const Eigen::Map<const VectorXd> stiffness(stiffness_.valuePtr(), stiffness_.nonZeros());
  ++factorizations_;
  factor_h_ = 0.0;
  const double g = h / radau_.eigenvalue;
  const VectorXd real = mass_entries_ + g * sticking_damping_ + (g * g) * stiffness;
  const linear::SparseView by_real(stiffness_.rows(), stiffness_.cols(), real.size(),
                                   stiffness_.outerIndexPtr(), stiffness_.innerIndexPtr(),
                                   real.data());
  if (!factor_.factorize(by_real)) return false;
  for (std::size_t k = 0; k < radau_.pairs.size(); ++k) {
    const Complex of_pair = h / radau_.pairs[k].eigenvalue;
    const Eigen::VectorXcd values =
        mass_entries_ + of_pair * sticking_damping_ + (of_pair * of_pair) * stiffness;
    if (!pair_factors_[k].factorize(values.data())) return false;
  }
  factor_h_ = h;
  return true;
}

}  // namespace statejump::truss::detail
