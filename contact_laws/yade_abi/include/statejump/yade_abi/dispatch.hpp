// SPDX-License-Identifier: GPL-3.0-or-later
// Declared interface of YADE: functors of the multiple dispatch, and engines.
#pragma once

#include <boost/mpl/at.hpp>
#include <boost/mpl/vector.hpp>

#include "statejump/yade_abi/core.hpp"

namespace yade {

class Functor : public Serializable {
 public:
  shared_ptr<TimingDeltas> timingDeltas;
  Scene* scene = nullptr;
  std::string label;

  Functor() {}
  ~Functor() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  virtual std::vector<std::string> getFunctorTypes() const;
};

// Virtual overloads of go and goReverse for each number of arguments up to seven. boost::mpl
// determines the type of arguments beyond the end of the list.
template <class Result, class Arguments>
class FunctorWrapper {
  template <int i>
  using P = typename boost::mpl::at_c<Arguments, i>::type;
  [[noreturn]] static Result refuse() {
    throw std::logic_error("functor called with arguments that it does not take");
  }

 public:
  virtual ~FunctorWrapper() {}
  virtual std::string checkOrder() const { return ""; }
  virtual Result go(P<0>) { refuse(); }
  virtual Result go(P<0>, P<1>) { refuse(); }
  virtual Result go(P<0>, P<1>, P<2>) { refuse(); }
  virtual Result go(P<0>, P<1>, P<2>, P<3>) { refuse(); }
  virtual Result go(P<0>, P<1>, P<2>, P<3>, P<4>) { refuse(); }
  virtual Result go(P<0>, P<1>, P<2>, P<3>, P<4>, P<5>) { refuse(); }
  virtual Result go(P<0>, P<1>, P<2>, P<3>, P<4>, P<5>, P<6>) { refuse(); }
  virtual Result goReverse(P<0>) { refuse(); }
  virtual Result goReverse(P<0>, P<1>) { refuse(); }
  virtual Result goReverse(P<0>, P<1>, P<2>) { refuse(); }
  virtual Result goReverse(P<0>, P<1>, P<2>, P<3>) { refuse(); }
  virtual Result goReverse(P<0>, P<1>, P<2>, P<3>, P<4>) { refuse(); }
  virtual Result goReverse(P<0>, P<1>, P<2>, P<3>, P<4>, P<5>) { refuse(); }
  virtual Result goReverse(P<0>, P<1>, P<2>, P<3>, P<4>, P<5>, P<6>) { refuse(); }
};

template <class Dispatch1, class Result, class Arguments>
class Functor1D : public Functor, public FunctorWrapper<Result, Arguments> {
 public:
  std::vector<std::string> getFunctorTypes() const override { return {get1DFunctorType1()}; }
  virtual std::string get1DFunctorType1() const { throw std::logic_error("type not declared"); }
};

template <class Dispatch1, class Dispatch2, class Result, class Arguments>
class Functor2D : public Functor, public FunctorWrapper<Result, Arguments> {
 public:
  std::vector<std::string> getFunctorTypes() const override {
    return {get2DFunctorType1(), get2DFunctorType2()};
  }
  virtual std::string get2DFunctorType1() const { throw std::logic_error("type not declared"); }
  virtual std::string get2DFunctorType2() const { throw std::logic_error("type not declared"); }
};

class BoundFunctor
    : public Functor1D<Shape, void,
                       boost::mpl::vector<const shared_ptr<Shape>&, shared_ptr<Bound>&, const Se3r&,
                                          const Body*>> {
 public:
  BoundFunctor() {}
  ~BoundFunctor() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
};

class IGeomFunctor
    : public Functor2D<Shape, Shape, bool,
                       boost::mpl::vector<const shared_ptr<Shape>&, const shared_ptr<Shape>&,
                                          const State&, const State&, const Vector3r&, const bool&,
                                          const shared_ptr<Interaction>&>> {
 public:
  IGeomFunctor() {}
  ~IGeomFunctor() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  virtual void preStep();
};

class IPhysFunctor
    : public Functor2D<Material, Material, void,
                       boost::mpl::vector<const shared_ptr<Material>&, const shared_ptr<Material>&,
                                          const shared_ptr<Interaction>&>> {
 public:
  IPhysFunctor() {}
  ~IPhysFunctor() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
};

class LawFunctor
    : public Functor2D<IGeom, IPhys, bool,
                       boost::mpl::vector<shared_ptr<IGeom>&, shared_ptr<IPhys>&, Interaction*>> {
 public:
  LawFunctor() {}
  ~LawFunctor() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
};

// The renderer passes a GLViewInfo to the functors. The plugin does not use it.
class GLViewInfo;

// Base of functors that draw a shape in YADE's 3-D view, relative to the body's position.
class GlShapeFunctor
    : public Functor1D<Shape, void,
                       boost::mpl::vector<const shared_ptr<Shape>&, const shared_ptr<State>&, bool,
                                          const GLViewInfo&>> {
 public:
  GlShapeFunctor() {}
  ~GlShapeFunctor() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  virtual std::string renders() const;
  virtual void initgl();
};

// The 3-D view. When YADE's user interface starts, it searches once for drawing functors. If
// initDone is reset, it searches again before the next picture.
class OpenGLRenderer {
 public:
  static bool initDone;
};

class Engine : public Serializable {
 public:
  Scene* scene;
  Unused<16> timingInfo;
  shared_ptr<TimingDeltas> timingDeltas;
  bool dead;
  int ompThreads;
  std::string label;

  Engine();
  ~Engine() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  virtual bool isActivated();
  virtual void action();
};

class GlobalEngine : public Engine {
 public:
  GlobalEngine() {}
  ~GlobalEngine() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
};

}  // namespace yade
