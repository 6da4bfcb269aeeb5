// SPDX-License-Identifier: GPL-3.0-or-later
// Converts the compiled declarations into data. Only this file of the guard includes them.
#include <cxxabi.h>

#include <cstdlib>
#include <memory>
#include <typeinfo>

#include "statejump/yade_abi/interface.hpp"

#ifdef STATEJUMP_REAL_YADE_HEADERS
#include "yade_api.hpp"
#else
#ifndef STATEJUMP_NO_LAYOUT_CHECKS  // only defined by a test of the guard
#include "statejump/yade_abi/layout_checks.hpp"
#endif
#include "statejump/yade_abi/dispatch.hpp"
#define STATEJUMP_HAS_VIEW
#endif

#define STATEJUMP_TABLES(X)                                                                   \
  X(Serializable)                                                                             \
  X(Shape)                                                                                    \
  X(IGeom)                                                                                    \
  X(IPhys) X(Material) X(Functor) X(Engine) X(GenericSpheresContact) X(FrictMat) X(FrictPhys) \
      X(Aabb) X(State) X(BoundFunctor) X(IGeomFunctor) X(IPhysFunctor) X(LawFunctor)          \
          X(GlobalEngine)
#ifdef STATEJUMP_HAS_VIEW
#define STATEJUMP_VIEW_TABLES(X) X(GlShapeFunctor)
#else
#define STATEJUMP_VIEW_TABLES(X)
#endif

namespace statejump::yade_abi {

// This class is outside the unnamed namespace, so that its vtable has a dynamic symbol with a size.
// It is never constructed; the explicit instantiation alone creates the vtable.
template <class Base>
struct DoNothing : Base {};

#define STATEJUMP_CHILD(Class) template struct DoNothing<yade::Class>;
STATEJUMP_TABLES(STATEJUMP_CHILD)
STATEJUMP_VIEW_TABLES(STATEJUMP_CHILD)
#undef STATEJUMP_CHILD

#pragma GCC diagnostic push
// The classes have virtual functions. GCC lays out single inheritance as offsetof assumes.
#pragma GCC diagnostic ignored "-Winvalid-offsetof"

DeclaredInterface declared_interface() {
  DeclaredInterface result;
// The build generates this list of classes and members from the measurements.
#define STATEJUMP_CLASS(Class, bytes, allocated) \
  result.classes.push_back({#Class, sizeof(yade::Class), allocated});
#define STATEJUMP_MEMBER(Class, member, place, bytes, getter)               \
  result.members.push_back({#Class, #member, offsetof(yade::Class, member), \
                            sizeof(yade::Class::member),                    \
                            demangled(typeid(decltype(yade::Class::member)).name()), getter});
#ifdef STATEJUMP_REAL_YADE_HEADERS
#define STATEJUMP_PRIVATE_MEMBER(Class, member, place, bytes, getter)
#else
#define STATEJUMP_PRIVATE_MEMBER STATEJUMP_MEMBER
#endif
#include "statejump/yade_abi/measured_layout.inc"
#undef STATEJUMP_CLASS
#undef STATEJUMP_MEMBER
#undef STATEJUMP_PRIVATE_MEMBER

#define STATEJUMP_TABLE(Class) \
  result.tables.push_back({#Class, typeid(DoNothing<yade::Class>).name()});
  STATEJUMP_TABLES(STATEJUMP_TABLE)
  STATEJUMP_VIEW_TABLES(STATEJUMP_TABLE)
#undef STATEJUMP_TABLE
#ifdef STATEJUMP_REAL_YADE_HEADERS
  result.view_flag_size = 0;  // private in YADE's own headers and not used with them
#else
  result.view_flag_size = sizeof(yade::OpenGLRenderer::initDone);
#endif
  return result;
}

#pragma GCC diagnostic pop

const DeclaredClass* DeclaredInterface::find_class(const std::string& name) const {
  for (const auto& one : classes) {
    if (one.name == name) return &one;
  }
  return nullptr;
}

const DeclaredMember* DeclaredInterface::find_member(const std::string& class_name,
                                                     const std::string& name) const {
  for (const auto& one : members) {
    if (one.class_name == class_name && one.name == name) return &one;
  }
  return nullptr;
}

std::string demangled(const char* mangled) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(
      abi::__cxa_demangle(mangled, nullptr, nullptr, &status), &std::free);
  return text ? text.get() : mangled;
}

}  // namespace statejump::yade_abi
