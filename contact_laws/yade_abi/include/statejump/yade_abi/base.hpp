// SPDX-License-Identifier: GPL-3.0-or-later
// Declared interface of YADE (Debian's packages, amd64, double): roots of its class hierarchy.
//
// Debian ships YADE's libraries without headers. This folder declares the part of the binary
// interface that the plugin uses: names, order of virtual functions, order of members. Nothing here
// was copied from YADE; the layouts were measured. The measured sizes, offsets and tables are in
// ../variants, one set for each variant of the interface. layout_checks.hpp compares the
// declarations with them at compile time; the guard compares them with the running libraries before
// it touches any object. Only this folder knows offsets.
//
// STATEJUMP_YADE_VARIANT selects the declared variant. Its value is the first version of YADE with
// that interface: 202302 (2023.02a, 2025.2) or 202601 (2026.1). known_binaries.csv lists the
// variant of each binary.
//
// Members that the plugin does not use are declared as bytes of their measured size (Unused), so
// that every other declared member is covered by a check.
//
// Virtual functions that YADE exports are declared and not defined: their definitions, the vtables
// and the type information come from YADE's libraries. Constructors that YADE does not export are
// defined here and set every member to the default that a fresh object shows in Python.
// defined here and give every member the default that a fresh object shows in Python.
#pragma once

#include <array>
#include <boost/enable_shared_from_this.hpp>
#include <boost/python.hpp>
#include <boost/shared_ptr.hpp>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

// YADE's Eigen settings, which determine the size and alignment of every vector member.
#ifndef EIGEN_DONT_ALIGN
#error "compile with -DEIGEN_DONT_ALIGN -DEIGEN_DONT_VECTORIZE, as YADE was"
#endif
#include <Eigen/Core>
#include <Eigen/Geometry>

#ifndef STATEJUMP_YADE_VARIANT
#error "STATEJUMP_YADE_VARIANT is set by the build: the interface variant of the YADE that it found"
#endif

// A class template of YADE in the global namespace. Its function instance() is exported.
template <class T>
class Singleton {
 public:
  static T& instance();
};

namespace yade {

using Real = double;
using boost::shared_ptr;
using Vector3r = Eigen::Matrix<Real, 3, 1>;
using Vector3i = Eigen::Matrix<int, 3, 1>;
using Quaternionr = Eigen::Quaternion<Real>;

template <class R>
struct Se3 {
  Eigen::Matrix<R, 3, 1> position;
  Eigen::Quaternion<R> orientation;
};
using Se3r = Se3<Real>;

class Scene;

// Bytes of members that the plugin does not use. In objects of the plugin, zeros equal YADE's
// defaults (null pointers); YADE fills those of its own objects.
template <std::size_t size, std::size_t alignment = alignof(void*)>
struct alignas(alignment) Unused {
  std::array<char, size> bytes{};
};

class Factorable : public boost::enable_shared_from_this<Factorable> {
 public:
  Factorable() {}
  virtual ~Factorable();
  virtual std::string getBaseClassName(unsigned int i = 0) const;
  virtual int getBaseClassNumber() const;
  virtual std::string getClassName() const;
};

class Serializable : public Factorable {
 public:
  Serializable() {}
  ~Serializable() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  virtual void pySetAttr(const std::string& key, const boost::python::object& value);
  virtual boost::python::dict pyDict() const;
  virtual boost::python::dict pyDictCustom() const;
  virtual void callPostLoad();
  virtual void checkPyClassRegistersItself(const std::string& class_name) const;
  virtual void pyRegisterClass(boost::python::object scope);
  virtual void pyHandleCustomCtorArgs(boost::python::tuple& args, boost::python::dict& kwargs);
  void pyUpdateAttrs(const boost::python::dict& attributes);
  template <class Archive>
  void serialize(Archive& archive, unsigned int version);
};

// Base for multiple dispatch. Each derived class has a static index, assigned once in its
// constructor. YADE does not export the vtable of this class, so its functions are defined here.
// Every derived class overrides them.
class Indexable {
  [[noreturn]] static void no_dispatch_index() {
    throw std::logic_error("class without a dispatch index");
  }

 public:
  virtual void incrementMaxCurrentlyUsedClassIndexOfKin() { no_dispatch_index(); }
  virtual int& modifyClassIndex() { no_dispatch_index(); }
  virtual ~Indexable() {}
  virtual const int& getClassIndex() const { no_dispatch_index(); }
  virtual const int& getBaseClassIndex(int) const { no_dispatch_index(); }
  virtual const int& getMaxCurrentlyUsedClassIndexOfKin() const { no_dispatch_index(); }

 protected:
  Indexable() {}
  void createIndex();
};

class ClassFactory : public Singleton<ClassFactory> {
 public:
  bool registerFactorable(std::string name, Factorable* (*create)(),
                          shared_ptr<Factorable> (*create_shared)(), void* (*create_pure)());
};

}  // namespace yade
