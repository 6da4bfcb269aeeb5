// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the declarations with the measured sizes and offsets of their variant, at compile time.
// The guard makes the same comparison with the running libraries.
#pragma once

#include <cstddef>

#include "statejump/yade_abi/dispatch.hpp"

namespace statejump::yade_abi {

#pragma GCC diagnostic push
// The classes have virtual functions. GCC lays out single inheritance as offsetof assumes.
#pragma GCC diagnostic ignored "-Winvalid-offsetof"

static_assert(sizeof(yade::Vector3r) == 24 && alignof(yade::Vector3r) == 8);
static_assert(sizeof(yade::Quaternionr) == 32 && alignof(yade::Quaternionr) == 8);
static_assert(sizeof(yade::Se3r) == 56);
static_assert(sizeof(yade::Factorable) == 24);
static_assert(sizeof(yade::Serializable) == 24);
static_assert(sizeof(yade::Indexable) == 8);

// The build generates measured_layout.inc from variants/<variant>_members.csv. It uses macros,
// because offsetof needs the names of class and member.
#define STATEJUMP_CLASS(Class, bytes, allocated) static_assert(sizeof(yade::Class) == (bytes));
#define STATEJUMP_MEMBER(Class, member, place, bytes, getter) \
  static_assert(offsetof(yade::Class, member) == (place));    \
  static_assert(sizeof(yade::Class::member) == (bytes));
#define STATEJUMP_PRIVATE_MEMBER STATEJUMP_MEMBER
#include "statejump/yade_abi/measured_layout.inc"
#undef STATEJUMP_CLASS
#undef STATEJUMP_MEMBER
#undef STATEJUMP_PRIVATE_MEMBER

// Functor has two bases; multiple dispatch calls it through the second.
static_assert(sizeof(yade::Functor) == 80 && sizeof(yade::BoundFunctor) == 80 + sizeof(void*));

#pragma GCC diagnostic pop

}  // namespace statejump::yade_abi
