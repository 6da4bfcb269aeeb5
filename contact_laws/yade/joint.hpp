// SPDX-License-Identifier: GPL-3.0-or-later
// Contact of a clearance joint in YADE: geometry, physics and law. The physics is in
// statejump/kernel; these classes transfer numbers between YADE's objects and the kernel.
#pragma once

#include <limits>
#include <mutex>
#include <type_traits>
#include <vector>

#include "joint_energies.hpp"
#include "registered.hpp"
#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/kernel/laws/joint_response.hpp"
#include "statejump/stepper/contact.hpp"

namespace statejump::dem {

struct JointGeom : RegisteredIndexable<JointGeom, yade::GenericSpheresContact> {
  static constexpr const char* class_name = "JointGeom";
  static constexpr const char* base_name = "GenericSpheresContact";
  static constexpr const char* doc =
      "Geometry of one contact of a clearance joint. normal points from the journal (ball, "
      "slider), "
      "id1, into the bearing (socket, slot face), id2: the direction in which 1 pushes 2.";
  Real penetrationDepth = 0;
  Real effectiveRadius = 0;
  Real eccentricity = 0;
  Vector3r relativeVelocity = Vector3r::Zero();
  Real journalRadius = 0;
  Real bearingRadius = std::numeric_limits<Real>::infinity();
  // Recomputed in every step before use, so not saved in O.save.
  Vector3r arm1 = Vector3r::Zero();
  Vector3r arm2 = Vector3r::Zero();
  Vector3r previousNormal = Vector3r::Zero();
  Real twistAngle = 0;
  Vector3r axis = Vector3r::Zero();
  Real clearanceRate = 0;

  JointGeom() { createIndex(); }
  static auto attributes() {
    return std::make_tuple(
        read_only("penetrationDepth", &JointGeom::penetrationDepth,
                  "Penetration depth delta [m]; negative: gap"),
        read_only("effectiveRadius", &JointGeom::effectiveRadius,
                  "Effective radius of the Hertz contact at the current temperature [m]"),
        read_only("eccentricity", &JointGeom::eccentricity,
                  "Offset of body 1 from body 2 along the normal [m]; eccentricity - "
                  "penetrationDepth is the clearance at the current temperature"),
        read_only("relativeVelocity", &JointGeom::relativeVelocity,
                  "Velocity of body 1 relative to body 2, of the material at the contact point "
                  "[m/s]"),
        read_only("journalRadius", &JointGeom::journalRadius,
                  "Radius of the journal (ball, slider's pads) at the current temperature [m]"),
        read_only("bearingRadius", &JointGeom::bearingRadius,
                  "Radius of the bearing (socket) at the current temperature [m]; infinite: a flat "
                  "SlotFace; negative: a MeshBore that bulges there, or another Ball"));
  }
};

struct JointPhys : RegisteredIndexable<JointPhys, yade::FrictPhys> {
  static constexpr const char* class_name = "JointPhys";
  static constexpr const char* base_name = "FrictPhys";
  static constexpr const char* doc =
      "Physics of one contact of a clearance joint. kn and ks are the tangent stiffnesses of the "
      "current state [N/m], as GlobalStiffnessTimeStepper wants them; normalForce and shearForce "
      "act on body 2 [N], as everywhere in YADE; shearForce is the history spring, without its "
      "viscous part.";
  Real effectiveYoungModulus = 0;
  Real effectiveShearModulus = 0;
  Real effectiveMass = 0;
  Real normalDampingRatio = 0;
  Real tangentialDampingRatio = 0;
  bool slipping = false;
  Vector3r slipAxis = Vector3r::Zero();
  std::vector<Vector3r> slipMemory;
  Real slipSlope = 0;
  Real slipMerged = 0;
  int slipHeld = 0;
  Vector3r slipShift = Vector3r::Zero();
  Vector3r slipSums = Vector3r::Zero();
  Vector3r slipLine = Vector3r::Zero();
  bool begun = false;
  Real impactSpeed = 0;
  Real dissipationSlope = 0;
  Real frictionSlope = 0;
  // Values of the last step, which the trapezoidal rule of the thermal work needs. They are updated
  // only if O.trackEnergy is on.
  Real previousElasticForce = 0;
  Real previousElasticEnergy = 0;
  Real previousClearance = 0;
  Real previousRadius = 0;
  Real previousBearingRadius = 0;
  Real previousDepth = 0;

  JointPhys() { createIndex(); }
  void check() const;
  static auto attributes() {
    return std::make_tuple(
        attribute("effectiveYoungModulus", &JointPhys::effectiveYoungModulus, "E* [Pa]"),
        attribute("effectiveShearModulus", &JointPhys::effectiveShearModulus, "G* [Pa]"),
        attribute("effectiveMass", &JointPhys::effectiveMass,
                  "m1 m2 / (m1 + m2), fixed bodies counting as infinitely heavy [kg]; 0 when both "
                  "are fixed"),
        attribute("normalDampingRatio", &JointPhys::normalDampingRatio,
                  "Ratio of the viscous normal damping to the critical one [-]"),
        attribute(
            "tangentialDampingRatio", &JointPhys::tangentialDampingRatio,
            "Ratio of the viscous tangential damping to the critical one, while sticking [-]"),
        read_only("slipping", &JointPhys::slipping, "Whether friction was at its limit [-]"),
        read_only("slipAxis", &JointPhys::slipAxis,
                  "First axis of slipMemory in the tangent plane, the second is across it and the "
                  "normal; zero for a law without partial slip [-]"),
        read_only("slipMemory", &JointPhys::slipMemory,
                  "What friction with partial slip remembers: for rings from the centre to the rim "
                  "8 G* r [N/m] and their elastic displacement along both axes [m], body 1 against "
                  "2; of the first slipHeld of them before they moved by slipShift"),
        read_only("slipHeld", &JointPhys::slipHeld,
                  "How many points of slipMemory only moved, all alike, since they were written "
                  "[-]"),
        read_only("slipShift", &JointPhys::slipShift,
                  "By how much they moved since, along both axes, and 0 [m]"),
        read_only("slipSums", &JointPhys::slipSums,
                  "Tangential force of their rings along both axes [N] and twice their energy [J], "
                  "as they were written"),
        read_only("slipLine", &JointPhys::slipLine,
                  "Largest displacement that they are known not to exceed, as they were written, "
                  "at the centre and at the last of them, straight over the square of 8 G* r "
                  "between, and 0 [m]"),
        read_only("slipSlope", &JointPhys::slipSlope,
                  "Bound on that displacement at the last step, over the difference of squares of "
                  "8 G* a and 8 G* r [m^3/N^2]"),
        read_only("slipMerged", &JointPhys::slipMerged,
                  "Bound on the error of the tangential force by points of slipMemory that were "
                  "merged since the contact began [N]"),
        read_only("begun", &JointPhys::begun,
                  "Whether the bodies have touched: impactSpeed is that of this contact [-]. Kept "
                  "by Law2_JointGeom_JointPhys_JointLaw"),
        read_only("impactSpeed", &JointPhys::impactSpeed,
                  "Approach speed of the bodies when this contact began [m/s], negative when it "
                  "began while they parted (the clearance closed on them). Kept by "
                  "Law2_JointGeom_JointPhys_JointLaw"),
        read_only("dissipationSlope", &JointPhys::dissipationSlope,
                  "Slope of the dissipation law against the approach speed at the last step "
                  "[N s/m], for stable_time_step()"),
        read_only("frictionSlope", &JointPhys::frictionSlope,
                  "Largest slope of friction against sliding speed at the last step, of a law "
                  "that does not remember [N s/m], for stable_time_step()"),
        read_only("previousElasticForce", &JointPhys::previousElasticForce,
                  "Elastic normal force of the last step [N], kept for the energy account"),
        read_only("previousElasticEnergy", &JointPhys::previousElasticEnergy,
                  "Elastic normal energy of the last step [J], kept for the energy account"),
        read_only("previousClearance", &JointPhys::previousClearance,
                  "Clearance of the last step [m], kept for the energy account"),
        read_only("previousRadius", &JointPhys::previousRadius,
                  "Effective radius (with JointLaw: of the journal) of the last step [m], kept for "
                  "the energy account"),
        read_only("previousBearingRadius", &JointPhys::previousBearingRadius,
                  "Radius of the bearing of the last step [m], kept for the energy account"),
        read_only("previousDepth", &JointPhys::previousDepth,
                  "Penetration depth of the last step [m], kept for the energy account"));
  }
};

struct Ig2_Journal_Bearing_JointGeom
    : Registered<Ig2_Journal_Bearing_JointGeom, yade::IGeomFunctor> {
  static constexpr const char* class_name = "Ig2_Journal_Bearing_JointGeom";
  static constexpr const char* base_name = "IGeomFunctor";
  static constexpr const char* doc =
      "Internal contact of a Journal in a Bearing, in the plane across the bearing's axis "
      "(equations 11-13 of Chen et al. 2021). The axes must be parallel within maxTilt: contact "
      "at the edges is not covered and stops the run.";
  Real maxTilt = 1e-3;
  using yade::IGeomFunctor::go;
  bool go(const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
          const yade::State& state1, const yade::State& state2, const Vector3r& shift2,
          const bool& force, const yade::shared_ptr<yade::Interaction>& contact) override;
  std::string checkOrder() const override { return "Journal Bearing"; }
  std::string get2DFunctorType1() const override { return "Journal"; }
  std::string get2DFunctorType2() const override { return "Bearing"; }
  void check() const;
  static auto attributes() {
    return std::make_tuple(attribute("maxTilt", &Ig2_Journal_Bearing_JointGeom::maxTilt,
                                     "Largest angle between the axes [rad]"));
  }
};

struct Ig2_Ball_Socket_JointGeom : Registered<Ig2_Ball_Socket_JointGeom, yade::IGeomFunctor> {
  static constexpr const char* class_name = "Ig2_Ball_Socket_JointGeom";
  static constexpr const char* base_name = "IGeomFunctor";
  static constexpr const char* doc =
      "Internal contact of a Ball in a Socket: as Ig2_Journal_Bearing_JointGeom, with the offset "
      "of the centres in all three directions";
  using yade::IGeomFunctor::go;
  bool go(const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
          const yade::State& state1, const yade::State& state2, const Vector3r& shift2,
          const bool& force, const yade::shared_ptr<yade::Interaction>& contact) override;
  std::string checkOrder() const override { return "Ball Socket"; }
  std::string get2DFunctorType1() const override { return "Ball"; }
  std::string get2DFunctorType2() const override { return "Socket"; }
  static auto attributes() { return std::make_tuple(); }
};

struct Ig2_Ball_Ball_JointGeom : Registered<Ig2_Ball_Ball_JointGeom, yade::IGeomFunctor> {
  static constexpr const char* class_name = "Ig2_Ball_Ball_JointGeom";
  static constexpr const char* base_name = "IGeomFunctor";
  static constexpr const char* doc =
      "External contact of two Balls, both of which may move: effective radius R1 R2/(R1 + R2). "
      "Hertz needs a contact small against both; the centre of one inside the other stops the "
      "run.";
  using yade::IGeomFunctor::go;
  bool go(const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
          const yade::State& state1, const yade::State& state2, const Vector3r& shift2,
          const bool& force, const yade::shared_ptr<yade::Interaction>& contact) override;
  std::string checkOrder() const override { return "Ball Ball"; }
  std::string get2DFunctorType1() const override { return "Ball"; }
  std::string get2DFunctorType2() const override { return "Ball"; }
  static auto attributes() { return std::make_tuple(); }
};

struct Ig2_Slider_SlotFace_JointGeom
    : Registered<Ig2_Slider_SlotFace_JointGeom, yade::IGeomFunctor> {
  static constexpr const char* class_name = "Ig2_Slider_SlotFace_JointGeom";
  static constexpr const char* base_name = "IGeomFunctor";
  static constexpr const char* doc = "Contact of a Slider's pad with a SlotFace";
  using yade::IGeomFunctor::go;
  bool go(const yade::shared_ptr<yade::Shape>& shape1, const yade::shared_ptr<yade::Shape>& shape2,
          const yade::State& state1, const yade::State& state2, const Vector3r& shift2,
          const bool& force, const yade::shared_ptr<yade::Interaction>& contact) override;
  std::string checkOrder() const override { return "Slider SlotFace"; }
  std::string get2DFunctorType1() const override { return "Slider"; }
  std::string get2DFunctorType2() const override { return "SlotFace"; }
  static auto attributes() { return std::make_tuple(); }
};

struct Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys
    : Registered<Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys, yade::IPhysFunctor> {
  static constexpr const char* class_name = "Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys";
  static constexpr const char* base_name = "IPhysFunctor";
  static constexpr const char* doc =
      "Elastic moduli, friction (the smaller of the two friction angles, as elsewhere in YADE) and "
      "damping of a joint contact. Stiffness is not fixed here: the law computes it in each step "
      "from the radii at the current temperature. A pair with a MeshBore gets a BorePhys.";
  Real normalDampingRatio = 0;
  Real tangentialDampingRatio = 0;
  using yade::IPhysFunctor::go;
  void go(const yade::shared_ptr<yade::Material>& material1,
          const yade::shared_ptr<yade::Material>& material2,
          const yade::shared_ptr<yade::Interaction>& contact) override;
  std::string get2DFunctorType1() const override { return "ThermalFrictMat"; }
  std::string get2DFunctorType2() const override { return "ThermalFrictMat"; }
  void check() const;
  static auto attributes() {
    using Self = Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys;
    return std::make_tuple(
        attribute("normalDampingRatio", &Self::normalDampingRatio,
                  "Ratio of the viscous normal damping to the critical one [-]"),
        attribute("tangentialDampingRatio", &Self::tangentialDampingRatio,
                  "Ratio of the viscous tangential damping to the critical one, while sticking "
                  "[-]"));
  }
};

struct Law2_JointGeom_JointPhys_HertzMindlin
    : Registered<Law2_JointGeom_JointPhys_HertzMindlin, yade::LawFunctor> {
  static constexpr const char* class_name = "Law2_JointGeom_JointPhys_HertzMindlin";
  static constexpr const char* base_name = "LawFunctor";
  static constexpr const char* doc =
      "Hertz contact of conforming (internal) curvature with Mindlin friction that remembers: "
      "F_N = 4/3 E* sqrt(R) delta^1.5 with R = R1 R2 / (R2 - R1), tangential history spring "
      "k_t = 8 G* sqrt(R delta), Coulomb limit mu F_N, rescaled when the normal load falls. Holds "
      "static loads. Force and reaction act at one contact point, so moments balance. Limits: "
      "Hertz needs a contact small against the radii (for conforming contact, a << R2 - R1 "
      "relative to R); torsion and rolling resistance are not covered. Entries in O.energy: "
      "jointElastic, jointFriction, jointDamping, jointThermalWork.";
  using yade::LawFunctor::go;
  bool go(yade::shared_ptr<yade::IGeom>& geometry, yade::shared_ptr<yade::IPhys>& physics,
          yade::Interaction* contact) override;
  std::string get2DFunctorType1() const override { return "JointGeom"; }
  std::string get2DFunctorType2() const override { return "JointPhys"; }
  void name_energies(const yade::Scene& of) { energies_.name(of); }
  static auto attributes() { return std::make_tuple(); }

 private:
  JointEnergies energies_;
};

// Documentation of an attribute, generated from the catalogue. For a law attribute it lists the
// laws of that kind with descriptions; for a parameter, its meaning and the laws that read it.
template <class Law>
const char* law_docs();
const char* parameter_docs(const kernel::laws::LawParameter& parameter);

// Base of all law functors with named laws: attributes, checks and the step of one contact. A
// derived functor adds law_attributes() to its own attributes.
class NamedJointLaw {
 public:
  std::string normalLaw = kernel::laws::HertzInternal::info.name;
  std::string dissipationLaw = kernel::laws::NoDissipation::info.name;
  std::string frictionLaw = kernel::laws::MindlinFriction::info.name;
  std::string tangentialVelocity = kernel::laws::MaterialVelocity::info.name;
  Real restitution = kernel::laws::parameter::restitution.default_value;
  Real smallestImpactSpeed = kernel::laws::parameter::smallest_impact_speed.default_value;
  Real contactLength = kernel::laws::parameter::contact_length.default_value;
  Real v0 = kernel::laws::parameter::v0.default_value;
  Real v1 = kernel::laws::parameter::v1.default_value;
  Real firstContactTime = std::numeric_limits<Real>::quiet_NaN();
  int contacts = 0;

  const stepper::NamedLaw& named_law() const { return named_; }
  void name_energies(const yade::Scene& of) { energies_.name(of); }

 protected:
  template <class Law>
  static auto law_attributes() {
    const auto member = [](auto pointer) {
      using Type = std::decay_t<decltype(std::declval<NamedJointLaw&>().*pointer)>;
      return static_cast<Type Law::*>(pointer);
    };
    return std::make_tuple(
        attribute("normalLaw", member(&NamedJointLaw::normalLaw),
                  law_docs<kernel::laws::NormalLaw>()),
        attribute("dissipationLaw", member(&NamedJointLaw::dissipationLaw),
                  law_docs<kernel::laws::DissipationLaw>()),
        attribute("frictionLaw", member(&NamedJointLaw::frictionLaw),
                  law_docs<kernel::laws::FrictionLaw>()),
        attribute("tangentialVelocity", member(&NamedJointLaw::tangentialVelocity),
                  law_docs<kernel::laws::TangentialVelocityLaw>()),
        attribute("restitution", member(&NamedJointLaw::restitution),
                  parameter_docs(kernel::laws::parameter::restitution)),
        attribute("smallestImpactSpeed", member(&NamedJointLaw::smallestImpactSpeed),
                  parameter_docs(kernel::laws::parameter::smallest_impact_speed)),
        attribute("contactLength", member(&NamedJointLaw::contactLength),
                  parameter_docs(kernel::laws::parameter::contact_length)),
        attribute("v0", member(&NamedJointLaw::v0), parameter_docs(kernel::laws::parameter::v0)),
        attribute("v1", member(&NamedJointLaw::v1), parameter_docs(kernel::laws::parameter::v1)),
        read_only("firstContactTime", member(&NamedJointLaw::firstContactTime),
                  "Time of the first touching [s], located linearly within its step (second order "
                  "in O.dt); NaN while contacts is 0. Bodies that already touch in the very first "
                  "step count "
                  "from its time"),
        read_only("contacts", member(&NamedJointLaw::contacts),
                  "Number of contacts that have begun [-]"));
  }

  // Builds the law from the attributes. Throws std::invalid_argument that names the class and the
  // attribute.
  void build(const char* class_name);
  // The law of the last build().
  const kernel::laws::JointLaw& law() const { return named_.law; }
  // Steps one contact: applies its forces to both bodies and adds its energies to O.energy. Returns
  // false if the contact is open.
  bool step(const JointGeom& geometry, JointPhys& physics, const yade::Interaction& contact,
            yade::Scene& scene);

 private:
  stepper::NamedLaw named_;  // made by build()
  std::mutex beginning_;     // guards firstContactTime and contacts
  JointEnergies energies_;
};

struct Law2_JointGeom_JointPhys_JointLaw
    : Registered<Law2_JointGeom_JointPhys_JointLaw, yade::LawFunctor>,
      NamedJointLaw {
  static constexpr const char* class_name = "Law2_JointGeom_JointPhys_JointLaw";
  static constexpr const char* base_name = "LawFunctor";
  static constexpr const char* doc =
      "Joint contact by laws chosen by name: normal force, impact dissipation, friction and the "
      "velocity that friction sees. The defaults are Law2_JointGeom_JointPhys_HertzMindlin. The "
      "damping ratios of JointPhys act beside the dissipation law; the tangential one belongs to "
      "the spring of a friction law that remembers. A Slider on a SlotFace (with the radius of its "
      "pads) and a Ball in "
      "a "
      "Socket have no axis: a law that needs one (see the attributes) stops the run there, and so "
      "does a depth outside the range of the normal law. Entries in O.energy: jointElastic, "
      "jointFriction, jointDamping, "
      "jointThermalWork.";
  Law2_JointGeom_JointPhys_JointLaw() { check(); }
  using yade::LawFunctor::go;
  bool go(yade::shared_ptr<yade::IGeom>& geometry, yade::shared_ptr<yade::IPhys>& physics,
          yade::Interaction* contact) override;
  std::string get2DFunctorType1() const override { return "JointGeom"; }
  std::string get2DFunctorType2() const override { return "JointPhys"; }
  void check() { build(class_name); }
  static auto attributes() { return law_attributes<Law2_JointGeom_JointPhys_JointLaw>(); }
};

}  // namespace statejump::dem
