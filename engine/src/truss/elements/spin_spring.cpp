// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/elements/spin_spring.hpp"

#include "statejump/truss/model.hpp"
#include "truss/elements/writer.hpp"

namespace statejump::truss {

/// None, because it is no item of a case.
std::span<const Parameter<SpinSpring>> SpinSpring::parameters() {
  return {};
}

SpinSpring::Frame SpinSpring::frame(const Model& model) const {
  return {{rotation_site(model, node)}};
}

void SpinSpring::evaluate(const Frame& frame, const ElementState& state,
                          ElementWriter& writer) const {
  const int site = frame.nodes[0];
  writer.force(site, stiffness * axis.dot(state.moved(site)) * axis);
  writer.matrix(site, site, stiffness * axis * axis.transpose());
}

double SpinSpring::energy(const Frame& frame, const ElementState& state) const {
  const double spun = axis.dot(state.moved(frame.nodes[0]));
  return 0.5 * stiffness * spun * spun;
}

}  // namespace statejump::truss
