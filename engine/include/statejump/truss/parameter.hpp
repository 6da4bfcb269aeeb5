// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <variant>

namespace statejump::truss {

/// Allowed values of a parameter.
enum class Allowed : unsigned char {
  finite,
  positive,              ///< Finite, > 0.
  not_negative,          ///< Finite, >= 0.
  positive_or_infinite,  ///< > 0; infinity: rigid.
  distance_or_infinite,  ///< >= 0; infinity: none.
  direction,             ///< Unit vector.
  node,                  ///< Index of a node.
  node_or_ground,        ///< Index of a node, −1: the ground.
  link_or_none,          ///< Index of a link, −1: none.
  link,                  ///< Index of a link.
  program,               ///< Index of a temperature program.
  flag,                  ///< 0: no, 1: yes.
  count                  ///< Whole number >= 1.
};

/// One parameter of a type of element or joint. Tables, range checks, bindings and messages use
/// this description.
template <class Type>
struct Parameter {
  const char* key;    ///< Column of tables, with its unit.
  const char* words;  ///< In messages.
  const char* unit;
  Allowed allowed;
  const char* source;  ///< Origin of the value, for example a data sheet.
  std::variant<double Type::*, int Type::*, bool Type::*, Eigen::Vector3d Type::*> member;
  int part = 0;   ///< First index within the column.
  int width = 1;  ///< Number of values per item.
};

/// An output that an element or a joint has at every state: a number, or a vector of three
/// components.
struct Output {
  const char* key;  ///< With its unit.
  int width;
};

}  // namespace statejump::truss
