// SPDX-License-Identifier: GPL-3.0-or-later
#include "shapes.hpp"

#include <algorithm>
#include <cmath>

#include "ranges.hpp"
#include "statejump/stepper/checks.hpp"

namespace statejump::dem {
namespace {

// Half extents of the bounding box of a cylinder [m].
Vector3r cylinder_half_extents(const yade::Quaternionr& orientation, Real radius,
                               Real half_length) {
  const Vector3r axis = orientation * Vector3r::UnitZ();
  const Real half = half_length > 0 ? half_length : radius;
  Vector3r extents;
  for (int i = 0; i < 3; ++i) {
    const Real across = std::sqrt(std::max(Real(0), 1 - axis[i] * axis[i]));
    extents[i] = radius * across + half * std::abs(axis[i]);
  }
  return extents;
}

}  // namespace

void ThermalFrictMat::check() const {
  require(stepper::ValueRange::finite, class_name, "thermalExpansion", thermalExpansion, "[1/K]");
}

void ThermalShape::check() const {
  if (!stepper::is_strain(thermalStrain)) {
    refuse(class_name, "thermalStrain", thermalStrain, "above -1 [-]");
  }
}

void Journal::check() const {
  require_not_negative(class_name, "radius", radius, "[m]");
  require_not_negative(class_name, "halfLength", halfLength, "[m]");
}

void Bearing::check() const {
  require_not_negative(class_name, "radius", radius, "[m]");
  require_not_negative(class_name, "halfLength", halfLength, "[m]");
}

void Ball::check() const {
  require_not_negative(class_name, "radius", radius, "[m]");
}

void Socket::check() const {
  require_not_negative(class_name, "radius", radius, "[m]");
}

void Slider::check() const {
  require_not_negative(class_name, "radius", radius, "[m]");
}

void SlotFace::check() const {
  require_not_negative(class_name, "distance", distance, "[m]");
  require_not_negative(class_name, "halfSize", halfSize, "[m]");
  if (!(std::abs(normal.norm() - 1) < 1e-9)) {
    refuse(class_name, "normal (its length)", normal.norm(), "1 [-]");
  }
}

Vector3r Journal::half_extents(const yade::Quaternionr& orientation) const {
  return cylinder_half_extents(orientation, expanded(radius), expanded(halfLength));
}

Vector3r Bearing::half_extents(const yade::Quaternionr& orientation) const {
  return cylinder_half_extents(orientation, expanded(radius), expanded(halfLength));
}

Vector3r Ball::half_extents(const yade::Quaternionr&) const {
  return Vector3r::Constant(expanded(radius));
}

Vector3r Socket::half_extents(const yade::Quaternionr&) const {
  return Vector3r::Constant(expanded(radius));
}

Vector3r Slider::half_extents(const yade::Quaternionr&) const {
  return Vector3r::Constant(expanded(radius));
}

Vector3r SlotFace::half_extents(const yade::Quaternionr&) const {
  return Vector3r::Constant(std::max(expanded(distance), halfSize));
}

}  // namespace statejump::dem
