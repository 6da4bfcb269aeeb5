// SPDX-License-Identifier: GPL-3.0-or-later
// Declared interface of YADE: bodies, interactions, scene and containers.
#pragma once

#include "statejump/yade_abi/base.hpp"

namespace yade {

class TimingDeltas;
class Engine;
class Body;

class Shape : public Serializable, public Indexable {
 public:
  Unused<32> functors;  // two shared pointers that only YADE sets
  Vector3r color = Vector3r(1, 1, 1);
  bool wire = false;
  bool highlight = false;

  Shape() {}
  ~Shape() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
#if STATEJUMP_YADE_VARIANT >= 202601
  virtual Real getVolume();
#endif
  int& modifyClassIndex() override;
  const int& getClassIndex() const override;
  const int& getBaseClassIndex(int depth) const override;
  const int& getMaxCurrentlyUsedClassIndexOfKin() const override;
  void incrementMaxCurrentlyUsedClassIndexOfKin() override;
};

class Bound : public Serializable, public Indexable {
 public:
  int lastUpdateIter;
  Vector3r refPos;
  Real sweepLength;
  Vector3r color;
  Vector3r min;
  Vector3r max;

  ~Bound() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  int& modifyClassIndex() override;
  const int& getClassIndex() const override;
  const int& getBaseClassIndex(int depth) const override;
  const int& getMaxCurrentlyUsedClassIndexOfKin() const override;
  void incrementMaxCurrentlyUsedClassIndexOfKin() override;
};

// Objects are only constructed by Aabb's exported constructor, because YADE exports no function of
// Bound.
class Aabb : public Bound {
 public:
  Aabb();
  ~Aabb() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  int& modifyClassIndex() override;
  const int& getClassIndex() const override;
  const int& getBaseClassIndex(int depth) const override;
};

class State : public Serializable, public Indexable {
 public:
  Unused<56> referencesAndMutex;  // pos and ori, which refer to se3, and a mutex
  Se3r se3;
  Vector3r vel;
  Real mass;
  Vector3r angVel;
  Vector3r angMom;
  Vector3r inertia;
  Vector3r refPos;
  Quaternionr refOri;
  unsigned int blockedDOFs;
  bool isDamped;
  Real densityScaling;

  State();
  ~State() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  int& modifyClassIndex() override;
  const int& getClassIndex() const override;
  const int& getBaseClassIndex(int depth) const override;
  const int& getMaxCurrentlyUsedClassIndexOfKin() const override;
  void incrementMaxCurrentlyUsedClassIndexOfKin() override;
};

class Material : public Serializable, public Indexable {
 public:
  int id = -1;
  std::string label;
  Real density = 1000;

  Material() {}
  ~Material() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  virtual shared_ptr<State> newAssocState() const;
  virtual bool stateTypeOk(State* state) const;
  int& modifyClassIndex() override;
  const int& getClassIndex() const override;
  const int& getBaseClassIndex(int depth) const override;
  const int& getMaxCurrentlyUsedClassIndexOfKin() const override;
  void incrementMaxCurrentlyUsedClassIndexOfKin() override;
};

class ElastMat : public Material {
 public:
  Real young;
  Real poisson;

 protected:
  // Only FrictMat's exported constructor constructs this base.
  ElastMat();
  ~ElastMat() override;
};

class FrictMat : public ElastMat {
 public:
  Real frictionAngle;

  FrictMat();
  ~FrictMat() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  int& modifyClassIndex() override;
  const int& getClassIndex() const override;
  const int& getBaseClassIndex(int depth) const override;
};

class IGeom : public Serializable, public Indexable {
 public:
  IGeom() {}
  ~IGeom() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  int& modifyClassIndex() override;
  const int& getClassIndex() const override;
  const int& getBaseClassIndex(int depth) const override;
  const int& getMaxCurrentlyUsedClassIndexOfKin() const override;
  void incrementMaxCurrentlyUsedClassIndexOfKin() override;
};

// YADE's time stepper and recorders cast every interaction geometry to this type without a check.
// The plugin's geometries therefore derive from it.
class GenericSpheresContact : public IGeom {
 public:
  Vector3r normal = Vector3r::Zero();
  Vector3r contactPoint = Vector3r::Zero();
  Real refR1 = 0;
  Real refR2 = 0;

  GenericSpheresContact() { createIndex(); }
  ~GenericSpheresContact() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  int& modifyClassIndex() override;
  const int& getClassIndex() const override;
  const int& getBaseClassIndex(int depth) const override;
};

class IPhys : public Serializable, public Indexable {
 public:
  ~IPhys() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  int& modifyClassIndex() override;
  const int& getClassIndex() const override;
  const int& getBaseClassIndex(int depth) const override;
  const int& getMaxCurrentlyUsedClassIndexOfKin() const override;
  void incrementMaxCurrentlyUsedClassIndexOfKin() override;

 protected:
  IPhys() {}
};

class NormPhys : public IPhys {
 public:
  Real kn;
  Vector3r normalForce;

 protected:
  // Only FrictPhys's exported constructor constructs this base and NormShearPhys.
  NormPhys();
  ~NormPhys() override;
};

class NormShearPhys : public NormPhys {
 public:
  Real ks;
  Vector3r shearForce;

 protected:
  NormShearPhys();
  ~NormShearPhys() override;
};

class FrictPhys : public NormShearPhys {
 public:
  Real tangensOfFrictionAngle;
#if STATEJUMP_YADE_VARIANT >= 202601
  Real frictDissip;
#endif

  FrictPhys();
  ~FrictPhys() override;
  std::string getBaseClassName(unsigned int i = 0) const override;
  int getBaseClassNumber() const override;
  std::string getClassName() const override;
  void pySetAttr(const std::string& key, const boost::python::object& value) override;
  boost::python::dict pyDict() const override;
  void callPostLoad() override;
  void pyRegisterClass(boost::python::object scope) override;
  int& modifyClassIndex() override;
  const int& getClassIndex() const override;
  const int& getBaseClassIndex(int depth) const override;
};

class Interaction : public Serializable {
 public:
  bool isActive;
  Unused<56> functorCache;
  int id1;
  int id2;
  long iterMadeReal;
  Unused<8> iterLastSeen;
  shared_ptr<IGeom> geom;
  shared_ptr<IPhys> phys;
  Vector3i cellDist;
  Unused<4, 4> linIx;
  long iterBorn;

  bool isReal() const { return static_cast<bool>(geom) && static_cast<bool>(phys); }
  Interaction(const Interaction&) = delete;
  ~Interaction() override;
};

class Body : public Serializable {
 public:
  int id;
  int groupMask;
  int flags;
  int subdomain;
  shared_ptr<Material> material;
  shared_ptr<State> state;
  shared_ptr<Shape> shape;
  shared_ptr<Bound> bound;
  Unused<48> intrs;
  int clumpId;
  long iterBorn;
  Real timeBorn;

  Body(const Body&) = delete;
  ~Body() override;
};

class ForceContainer {
 public:
  void addForce(int id, const Vector3r& force);
  void addTorque(int id, const Vector3r& torque);
  const Vector3r& getForce(int id);
  const Vector3r& getTorque(int id);
  const Vector3r& getPermForce(int id);
  const Vector3r& getPermTorque(int id);
  bool getPermForceUsed() const;
  void sync();
  ForceContainer(const ForceContainer&) = delete;

  Unused<296> forcesAndTorques;
  long lastReset;  // step for which the forces were last set to zero
};

class BodyContainer : public Serializable {
 public:
  std::vector<shared_ptr<Body>> body;
  Unused<152> listsAndMutex;

  // A null pointer marks an erased body.
  std::size_t size() const { return body.size(); }
  const shared_ptr<Body>& operator[](unsigned int id) const { return body[id]; }
  bool exists(int id) const {
    return id >= 0 && static_cast<std::size_t>(id) < body.size() &&
           static_cast<bool>(body[static_cast<std::size_t>(id)]);
  }
  BodyContainer(const BodyContainer&) = delete;
  ~BodyContainer() override;
};

class InteractionContainer : public Serializable {
 public:
  std::vector<shared_ptr<Interaction>> linIntrs;
  Unused<32> sortedAndBodies;
  std::size_t currSize;
  Unused<104> listsAndMutex;

  std::size_t size() const { return currSize; }
  const shared_ptr<Interaction>& operator[](std::size_t i) const { return linIntrs[i]; }
  InteractionContainer(const InteractionContainer&) = delete;
  ~InteractionContainer() override;
};

class EnergyTracker : public Serializable {
 public:
  // `id` is -1 before the first call. With `reset`, YADE sets the entry to zero at the start of
  // every step.
  void add(const Real& value, const std::string& name, int& id, bool reset);
  EnergyTracker(const EnergyTracker&) = delete;
  ~EnergyTracker() override;

  Unused<152> energies;
};

class Scene : public Serializable {
 public:
  Unused<8> hostNameMax;
  ForceContainer forces;
  Unused<104> speedAndRenderer;
  Real dt;
  long iter;
  bool subStepping;
  int subStep;
  Real time;
  Real speed;
  long stopAtIter;
  Real stopAtTime;
  bool isPeriodic;
  bool trackEnergy;
  bool doSort;
  Unused<1, 1> runInternalConsistencyChecks;
  int selectedBody;
  int subdomain;
  shared_ptr<Shape> subD;
  std::vector<std::string> tags;
  std::vector<shared_ptr<Engine>> engines;
  Unused<24> nextEngines;
  shared_ptr<BodyContainer> bodies;
  shared_ptr<InteractionContainer> interactions;
  shared_ptr<EnergyTracker> energy;
  Unused<104> materialsCellAndMore;

  Scene(const Scene&) = delete;
  ~Scene() override;
};

class Omega : public Singleton<Omega> {
 public:
  const shared_ptr<Scene>& getScene() const;
  void buildDynlibDatabase(const std::vector<std::string>& class_names);
};

}  // namespace yade
