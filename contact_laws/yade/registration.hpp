// SPDX-License-Identifier: GPL-3.0-or-later
// Implements registered.hpp: Python class and serialization of all classes. For module.cpp only.
#pragma once

#include <array>
#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/archive/xml_iarchive.hpp>
#include <boost/archive/xml_oarchive.hpp>
#include <boost/make_shared.hpp>
#include <boost/mpl/vector.hpp>
#include <boost/python/raw_function.hpp>
#include <boost/serialization/export.hpp>
#include <boost/serialization/nvp.hpp>
#include <boost/serialization/shared_ptr.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/vector.hpp>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <type_traits>

#include "refusal.hpp"
#include "registered.hpp"
#ifndef STATEJUMP_REAL_YADE_HEADERS
#include "statejump/yade_abi/serialization.hpp"
#endif

namespace statejump::dem {

namespace detail {

template <class Archive, class Type>
void archive_value(Archive& archive, const char* name, Type& value) {
  archive& boost::serialization::make_nvp(name, value);
}

// XML archives store numbers as text. They can write infinite numbers (radius of a flat face) and
// NaN (unset time), but cannot read them.
template <class Archive>
void archive_value(Archive& archive, const char* name, Real& value) {
  if constexpr (std::is_same_v<Archive, boost::archive::xml_oarchive>) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    const std::string words = text;
    archive& boost::serialization::make_nvp(name, words);
  } else if constexpr (std::is_same_v<Archive, boost::archive::xml_iarchive>) {
    std::string words;
    archive& boost::serialization::make_nvp(name, words);
    value = std::strtod(words.c_str(), nullptr);
  } else {
    archive& boost::serialization::make_nvp(name, value);
  }
}

// Archives a vector by component, because YADE's serialization of vectors is not part of its
// interface.
template <class Archive>
void archive_value(Archive& archive, const char* name, Vector3r& value) {
  static constexpr const char* components[3] = {"_x", "_y", "_z"};
  for (int i = 0; i < 3; ++i) {
    const std::string component = std::string(name) + components[i];
    archive& boost::serialization::make_nvp(component.c_str(), value[i]);
  }
}

// Archives a list of triples as one list of numbers, without YADE's serialization of vectors.
template <class Archive, class Triple, class Number>
void archive_triples(Archive& archive, const char* name, std::vector<Triple>& list,
                     std::vector<Number> flat) {
  if constexpr (!Archive::is_loading::value) {
    flat.reserve(3 * list.size());
    for (const Triple& triple : list) flat.insert(flat.end(), {triple[0], triple[1], triple[2]});
  }
  archive& boost::serialization::make_nvp(name, flat);
  if constexpr (Archive::is_loading::value) {
    list.resize(flat.size() / 3);
    for (std::size_t i = 0; i < list.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) list[i][k] = flat[3 * i + k];
    }
  }
}

template <class Archive>
void archive_value(Archive& archive, const char* name, std::vector<Vector3r>& value) {
  archive_triples(archive, name, value, std::vector<Real>());
}

template <class Archive>
void archive_value(Archive& archive, const char* name, std::vector<std::array<int, 3>>& value) {
  archive_triples(archive, name, value, std::vector<int>());
}

// Description of the Python type that an attribute accepts, for messages.
template <class Type>
constexpr const char* what_it_takes() {
  if constexpr (std::is_same_v<Type, bool>) return "True or False";
  if constexpr (std::is_integral_v<Type>) return "a whole number";
  if constexpr (std::is_floating_point_v<Type>) return "a number";
  if constexpr (std::is_same_v<Type, std::string>) return "a text";
  if constexpr (std::is_same_v<Type, Vector3r>) return "three numbers";
  if constexpr (std::is_same_v<Type, std::vector<Real>>) return "a list of numbers";
  if constexpr (std::is_same_v<Type, std::vector<Vector3r>>) return "a list of three numbers each";
  if constexpr (std::is_same_v<Type, std::vector<std::array<int, 3>>>) {
    return "a list of three whole numbers each";
  }
  return "of the type that the documentation names";
}

// @throws TypeError with Python's text and the name of the attribute
template <class Type>
Type value_of(const char* class_name, const char* attribute, const boost::python::object& value) {
  const boost::python::extract<Type> given(value);
  try {
    if (given.check()) return given();
  } catch (const boost::python::error_already_set&) {  // an item of a list has the wrong type
    PyErr_Clear();
  }
  const std::string text = boost::python::extract<std::string>(value.attr("__repr__")());
  const Refusal refusal{"wrong_type", std::string(class_name) + "." + attribute, text,
                        what_it_takes<Type>()};
  keep(refusal);
  const std::string said = sentence(refusal);
  PyErr_SetString(PyExc_TypeError, said.c_str());
  boost::python::throw_error_already_set();
  throw std::logic_error(said);  // not reached
}

template <class Class>
boost::shared_ptr<Class> construct(boost::python::tuple& arguments, boost::python::dict& keywords) {
  auto instance = boost::make_shared<Class>();
  instance->pyHandleCustomCtorArgs(arguments, keywords);
  if (boost::python::len(arguments) > 0) {
    refuse({"positional", Class::class_name});
  }
  if (boost::python::len(keywords) > 0) {
    instance->pyUpdateAttrs(keywords);
    instance->callPostLoad();
  }
  return instance;
}

template <class Class>
boost::python::object keyword_constructor(boost::python::tuple arguments,
                                          boost::python::dict keywords) {
  namespace py = boost::python;
  const py::object constructor = py::make_constructor(&construct<Class>);
  return constructor(py::object(arguments[0]), py::tuple(arguments.slice(1, py::_)), keywords);
}

}  // namespace detail

template <class Derived, class Base>
boost::python::dict Registered<Derived, Base>::pyDict() const {
  boost::python::dict result;
  const Derived& self = static_cast<const Derived&>(*this);
  for_each_attribute(
      [&](const auto& a) { result[a.name] = boost::python::object(self.*a.member); });
  result.update(Base::pyDict());
  return result;
}

template <class Derived, class Base>
void Registered<Derived, Base>::pySetAttr(const std::string& key,
                                          const boost::python::object& value) {
  Derived& self = static_cast<Derived&>(*this);
  bool known = false;
  for_each_attribute([&](const auto& a) {
    if (key != a.name) return;
    known = true;
    using Type = std::decay_t<decltype(self.*a.member)>;
    self.*a.member = detail::value_of<Type>(Derived::class_name, a.name, value);
  });
  if (!known) Base::pySetAttr(key, value);
}

template <class Derived, class Base>
void Registered<Derived, Base>::pyRegisterClass(boost::python::object scope) {
  namespace py = boost::python;
  this->checkPyClassRegistersItself(Derived::class_name);
  const py::scope inside(scope);
  const py::docstring_options docs(true, true, false);
  py::class_<Derived, boost::shared_ptr<Derived>, py::bases<Base>, boost::noncopyable> entry(
      Derived::class_name, Derived::doc, py::no_init);
  entry.def("__init__", py::raw_function(&detail::keyword_constructor<Derived>, 1));
  for_each_attribute([&](const auto& a) {
    using Type = std::decay_t<decltype(std::declval<Derived&>().*a.member)>;
    Type Derived::*const member = a.member;  // also valid for a member of a base unknown to Python
    const auto get = py::make_getter(member, py::return_value_policy<py::return_by_value>());
    if (a.read_only) {
      entry.add_property(a.name, get, a.doc);
    } else {
      // Checks the new value as the constructor does. If the value is rejected, the old one
      // remains.
      const auto set = [member, name = a.name](Derived& self, const py::object& value) {
        const Type old = self.*member;
        self.*member = detail::value_of<Type>(Derived::class_name, name, value);
        try {
          self.callPostLoad();
        } catch (...) {
          self.*member = old;
          throw;
        }
      };
      entry.add_property(a.name, get,
                         py::make_function(set, py::default_call_policies(),
                                           boost::mpl::vector<void, Derived&, const py::object&>()),
                         a.doc);
    }
  });
  Derived::register_methods(entry);
}

template <class Derived, class Base>
template <class Archive>
void Registered<Derived, Base>::serialize(Archive& archive, unsigned int) {
  Derived& self = static_cast<Derived&>(*this);
  archive& boost::serialization::make_nvp(Derived::base_name,
                                          boost::serialization::base_object<Base>(self));
  for_each_attribute(
      [&](const auto& a) { detail::archive_value(archive, a.name, self.*a.member); });
  if constexpr (Archive::is_loading::value) self.callPostLoad();
}

// Registers the class in YADE's factory; Omega::buildDynlibDatabase creates its Python class.
template <class Class>
void register_factory() {
  const bool is_new = yade::ClassFactory::instance().registerFactorable(
      Class::class_name, []() -> yade::Factorable* { return new Class; },
      []() -> boost::shared_ptr<yade::Factorable> { return boost::make_shared<Class>(); },
      []() -> void* { return new Class; });
  if (!is_new) {
    throw std::logic_error(std::string("YADE already has a class ") + Class::class_name);
  }
}

}  // namespace statejump::dem

// Exports a class to O.save under its name, and instantiates all code registered for this class.
#define STATEJUMP_EXPORT_AS(Class, Name) \
  BOOST_CLASS_EXPORT_GUID(Class, Name)   \
  template class statejump::dem::Registered<Class, Class::RegisteredBase>;
#define STATEJUMP_EXPORT(Class) STATEJUMP_EXPORT_AS(statejump::dem::Class, #Class)
