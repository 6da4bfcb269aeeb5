// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "statejump/truss/elements/bar.hpp"
#include "statejump/truss/elements/beam.hpp"
#include "statejump/truss/elements/condensed_body.hpp"
#include "statejump/truss/elements/spin_spring.hpp"
#include "statejump/truss/elements/spring.hpp"
#include "statejump/truss/elements/torsion_spring.hpp"

namespace statejump::truss {

/// The registry of elements: it has one list for each type. To add a type, change this struct only.
/// elements/interface.hpp documents the members that a type needs.
struct Elements {
  std::vector<Bar> links;
  std::vector<Spring> springs;
  std::vector<TorsionSpring> torsion_springs;
  std::vector<Beam> beams;
  std::vector<CondensedBody> bodies;
  std::vector<SpinSpring> spin_springs;

  /// References to the lists, as a tuple.
  template <class Self>
  static auto lists_of(Self& self) {
    return std::tie(self.links, self.springs, self.torsion_springs, self.beams, self.bodies,
                    self.spin_springs);
  }
  auto lists() { return lists_of(*this); }
  auto lists() const { return lists_of(*this); }
};

using ElementLists = decltype(std::declval<const Elements&>().lists());
/// How many types of elements there are.
constexpr std::size_t element_types = std::tuple_size_v<ElementLists>;
template <std::size_t which>
using ElementType = typename std::decay_t<std::tuple_element_t<which, ElementLists>>::value_type;

inline std::size_t element_count(const Elements& elements) {
  return std::apply([](const auto&... lists) { return (lists.size() + ...); }, elements.lists());
}

/// Calls `use(std::integral_constant<std::size_t, k>())` for every type k of element.
template <class Use>
constexpr void for_each_element_type(Use&& use) {
  [&]<std::size_t... k>(std::index_sequence<k...>) {
    (use(std::integral_constant<std::size_t, k>()), ...);
  }
  (std::make_index_sequence<element_types>());
}

/// Type of the tuple with one list of frames for each type of element. Only declared, for decltype.
template <class... Lists>
std::tuple<std::vector<typename std::decay_t<Lists>::value_type::Frame>...> frames_of(
    const std::tuple<Lists...>& lists);

/// The frames of all elements, one list for each type.
using ElementFrames = decltype(frames_of(std::declval<ElementLists>()));

/// Number of outputs of an element of a type.
template <Element Type>
std::size_t output_width() {
  std::size_t width = 0;
  for (const Output& output : Type::outputs()) width += static_cast<std::size_t>(output.width);
  return width;
}

/// Index of a type of element in the registry.
template <Element Type>
constexpr std::size_t element_type_index() {
  std::size_t found = element_types;
  for_each_element_type([&]<std::size_t k>(std::integral_constant<std::size_t, k>) {
    if constexpr (std::is_same_v<ElementType<k>, Type>) found = k;
  });
  return found;
}

}  // namespace statejump::truss
