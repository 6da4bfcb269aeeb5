// SPDX-License-Identifier: GPL-3.0-or-later
// Implements what YADE requires of every class besides its physics: a name, a documented attribute
// list, keyword construction, dict(), serialization and a dispatch index.
//
// A class derives from Registered<Itself, Base> (or RegisteredIndexable, for Shape, Material, IGeom
// and IPhys) and defines its name, documentation and attributes once:
//
//   struct Journal : RegisteredIndexable<Journal, ThermalShape> {
//     static constexpr const char* class_name = "Journal";
//     static constexpr const char* base_name = "ThermalShape";
//     static constexpr const char* doc = "...";
//     double radius = 0;
//     static auto attributes() {
//       return std::make_tuple(attribute("radius", &Journal::radius, "Radius at T0 [m]"));
//     }
//   };
//
// Python access, O.save/O.load and dict() all follow from that list. registration.hpp implements
// them with Boost.Python and Boost.Serialization. Only module.cpp includes it: including it in
// every source file would double the compile time of the plugin.
#pragma once

#include <string>
#include <tuple>
#include <utility>

#include "yade_api.hpp"

namespace statejump::dem {

using yade::Real;
using yade::Vector3r;

template <class Class, class Type>
struct Attribute {
  const char* name;
  Type Class::*member;
  const char* doc;
  bool read_only;
};

template <class Class, class Type>
constexpr Attribute<Class, Type> attribute(const char* name, Type Class::*member, const char* doc) {
  return {name, member, doc, false};
}

// Attribute that the simulation writes and that is read-only for scripts. It is saved.
template <class Class, class Type>
constexpr Attribute<Class, Type> read_only(const char* name, Type Class::*member, const char* doc) {
  return {name, member, doc, true};
}

template <class Derived, class Base>
class Registered : public Base {
 public:
  using RegisteredBase = Base;

  std::string getClassName() const override { return Derived::class_name; }
  int getBaseClassNumber() const override { return 1; }
  std::string getBaseClassName(unsigned int i = 0) const override {
    return i == 0 ? Derived::base_name : "";
  }

  boost::python::dict pyDict() const override;

  void pySetAttr(const std::string& key, const boost::python::object& value) override;

  // YADE calls this after construction from keywords, after loading, and at other times.
  void callPostLoad() override {
    Base::callPostLoad();
    static_cast<Derived&>(*this).check();
  }

  // Throws std::invalid_argument for values out of range. A derived class with ranges hides this
  // function.
  void check() const {}

  void pyRegisterClass(boost::python::object scope) override;

  template <class PythonClass>
  static void register_methods(PythonClass&) {}

  template <class Archive>
  void serialize(Archive& archive, unsigned int version);

 private:
  template <class Visitor>
  static void for_each_attribute(Visitor&& visit) {
    std::apply([&](const auto&... each) { (visit(each), ...); }, Derived::attributes());
  }
};

// Base of classes that take part in YADE's multiple dispatch. The constructor of Derived must call
// createIndex().
template <class Derived, class Base>
class RegisteredIndexable : public Registered<Derived, Base> {
 public:
  static int& class_index() {
    static int index = -1;
    return index;
  }
  int& modifyClassIndex() override { return class_index(); }
  const int& getClassIndex() const override { return class_index(); }
  const int& getBaseClassIndex(int depth) const override {
    static const Base base;
    return depth == 1 ? static_cast<const yade::Indexable&>(base).getClassIndex()
                      : static_cast<const yade::Indexable&>(base).getBaseClassIndex(depth - 1);
  }
};

}  // namespace statejump::dem
