// Contact of a clearance joint in YADE: geometry, physics and law. The physics itself is the
// kernel's (statejump/kernel); these classes move numbers between YADE's objects and it.
#pragma once

#include <array>
#include <atomic>
#include <mutex>

#include "registered.hpp"
#include "statejump/kernel/frame.hpp"
#include "statejump/kernel/joint_kinematics.hpp"

namespace statejump::dem {

struct JointGeom : RegisteredIndexable<JointGeom, yade::GenericSpheresContact> {
  static constexpr const char* class_name = "JointGeom";
  static constexpr const char* base_name = "GenericSpheresContact";
  static constexpr const char* doc =
      "Geometry of one contact of a clearance joint. normal points from the journal (slider), "
      "id1, into the bearing (slot face), id2: the direction in which 1 pushes 2.";
  Real penetrationDepth = 0;
  Real effectiveRadius = 0;
  Real eccentricity = 0;
  Vector3r relativeVelocity = Vector3r::Zero();
  // Recomputed in every step before it is used, so not saved.
  Vector3r arm1 = Vector3r::Zero();
  Vector3r arm2 = Vector3r::Zero();
  Vector3r previousNormal = Vector3r::Zero();
  Real twistAngle = 0;

  JointGeom() { createIndex(); }
  void update(const kernel::JointContact& contact, const yade::State& state1,
              const yade::State& state2, Real time_step);
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
                  "[m/s]"));
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
  // Last step's values, for the trapezoidal rule of the thermal work; kept only while
  // O.trackEnergy is on.
  Real previousElasticForce = 0;
  Real previousElasticEnergy = 0;
  Real previousClearance = 0;
  Real previousRadius = 0;

  JointPhys() { createIndex(); }
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
        read_only("previousElasticForce", &JointPhys::previousElasticForce,
                  "Elastic normal force of the last step [N], kept for the energy account"),
        read_only("previousElasticEnergy", &JointPhys::previousElasticEnergy,
                  "Elastic normal energy of the last step [J], kept for the energy account"),
        read_only("previousClearance", &JointPhys::previousClearance,
                  "Clearance of the last step [m], kept for the energy account"),
        read_only("previousRadius", &JointPhys::previousRadius,
                  "Effective radius of the last step [m], kept for the energy account"));
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
  static auto attributes() {
    return std::make_tuple(attribute("maxTilt", &Ig2_Journal_Bearing_JointGeom::maxTilt,
                                     "Largest angle between the axes [rad]"));
  }
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
      "from the radii at the current temperature.";
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
  static auto attributes() { return std::make_tuple(); }

 private:
  void account(const kernel::ContactResponse& response, const JointGeom& geometry,
               JointPhys& physics);
  void name_energies();
  std::array<int, 4> energy_ids_ = {-1, -1, -1, -1};
  std::atomic<bool> energies_named_{false};
  std::mutex naming_;
};

}  // namespace statejump::dem
