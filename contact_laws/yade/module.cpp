// SPDX-License-Identifier: GPL-3.0-or-later
// The extension module: checks YADE's interface and registers the classes with the running YADE.
// To add a class, add one entry to the list of classes.
#include <boost/archive/basic_archive.hpp>
#include <boost/make_shared.hpp>
#include <string>
#include <vector>

#include "beam.hpp"
#include "bore.hpp"
#include "failure.hpp"
#include "guide.hpp"
#include "joint.hpp"
#include "object_list.hpp"
#include "prismatic.hpp"
#include "refusal.hpp"
#include "registration.hpp"
#include "shapes.hpp"
#include "stable_step.hpp"
#include "state_recorder.hpp"
#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/hertz.hpp"
#include "statejump/kernel/laws/joint_law.hpp"
#include "statejump/law_loader/load.hpp"
#include "statejump/yade_abi/guard.hpp"
#include "stepper.hpp"
#include "thermal.hpp"
#include "torsion.hpp"
#include "view.hpp"

namespace statejump::dem {
namespace {

template <class... Classes>
struct ClassList {
  static void register_all() {
    (register_factory<Classes>(), ...);
    // Also calls pyRegisterClass() of each class, base classes first.
    register_python_classes({Classes::class_name...});
  }
  static boost::python::list names() {
    boost::python::list result;
    (result.append(Classes::class_name), ...);
    return result;
  }
};

using OurClasses = ClassList<
    ThermalFrictMat, ThermalShape, Journal, Bearing, Ball, Socket, Slider, SlotFace, MeshBore,
    Bo1<MeshBore>, Bo1<Journal>, Bo1<Bearing>, Bo1<Ball>, Bo1<Socket>, Bo1<Slider>, Bo1<SlotFace>,
    JointGeom, JointPhys, BoreGeom, BorePhys, Ig2_Journal_MeshBore_BoreGeom,
    Ig2_Ball_MeshBore_BoreGeom, Law2_BoreGeom_BorePhys_JointLaw, Ig2_Journal_Bearing_JointGeom,
    Ig2_Ball_Socket_JointGeom, Ig2_Ball_Ball_JointGeom, Ig2_Slider_SlotFace_JointGeom,
    Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys, Law2_JointGeom_JointPhys_HertzMindlin,
    Law2_JointGeom_JointPhys_JointLaw, ThermalProgram, ThermalExpansionEngine, ThermalLink,
    ThermalLinks, TorsionSpring, TorsionSprings, PrismaticJoint, PrismaticJoints, BeamBond,
    BeamBonds, GuidePlanes, StateRecorder, JointStepper
#ifdef STATEJUMP_HAS_VIEW
    ,
    Gl1<Journal>, Gl1<Bearing>, Gl1<Ball>, Gl1<Socket>, Gl1<Slider>, Gl1<SlotFace>, Gl1<MeshBore>
#endif
    >;

// Returns an empty string on success, otherwise the sentence of the error that the Python wrapper
// raises.
std::string setup(const boost::python::object& wrapper) {
  if (auto difference = yade_abi::difference_from_running_yade(wrapper);
      !difference.sentence.empty()) {
    return difference.sentence;
  }
  law_loader::load_user_laws();
  register_list_converter<ThermalLink>();
  register_list_converter<TorsionSpring>();
  register_list_converter<PrismaticJoint>();
  register_list_converter<BeamBond>();
  register_list_converter<JointGeom>();
  register_list_converter<JointPhys>();
  register_triangles_converter();
  OurClasses::register_all();
#ifdef STATEJUMP_HAS_VIEW
  refresh_view();
#endif
  return "";
}

// Penetration depth [m] at which two bodies of the same material carry a force [N].
double hertz_depth(double force, double effectiveRadius, double young, double poisson) {
  kernel::require(force >= 0, "force", force, "[0, inf) N");
  kernel::require(effectiveRadius > 0, "effectiveRadius", effectiveRadius, "(0, inf) m");
  return kernel::hertz_depth(
      kernel::elastic_pair(young, poisson, young, poisson).effective_young_modulus, effectiveRadius,
      force);
}

// Names of all laws. Each key is the name of the attribute that accepts these laws.
boost::python::dict law_names() {
  namespace laws = kernel::laws;
  boost::python::dict names;
  const auto add = [&](const char* attribute, const std::vector<std::string>& known) {
    boost::python::list list;
    for (const std::string& name : known) list.append(name);
    names[attribute] = list;
  };
  add("normalLaw", laws::law_names<laws::NormalLaw>());
  add("dissipationLaw", laws::law_names<laws::DissipationLaw>());
  add("frictionLaw", laws::law_names<laws::FrictionLaw>());
  add("tangentialVelocity", laws::law_names<laws::TangentialVelocityLaw>());
  return names;
}

// Version of the archives that O.save of this YADE writes. It changes with the version of Boost.
unsigned archive_version() {
  const auto version = boost::archive::BOOST_ARCHIVE_VERSION();
  return version;
}

double stable_time_step_of_scene() {
  return stable_time_step(*yade::Omega::instance().getScene());
}

}  // namespace
}  // namespace statejump::dem

STATEJUMP_EXPORT(ThermalFrictMat)
STATEJUMP_EXPORT(ThermalShape)
STATEJUMP_EXPORT(Journal)
STATEJUMP_EXPORT(Bearing)
STATEJUMP_EXPORT(Ball)
STATEJUMP_EXPORT(Socket)
STATEJUMP_EXPORT(Slider)
STATEJUMP_EXPORT(SlotFace)
STATEJUMP_EXPORT_AS(statejump::dem::Bo1<statejump::dem::Journal>, "Bo1_Journal_Aabb")
STATEJUMP_EXPORT_AS(statejump::dem::Bo1<statejump::dem::Bearing>, "Bo1_Bearing_Aabb")
STATEJUMP_EXPORT_AS(statejump::dem::Bo1<statejump::dem::Ball>, "Bo1_Ball_Aabb")
STATEJUMP_EXPORT_AS(statejump::dem::Bo1<statejump::dem::Socket>, "Bo1_Socket_Aabb")
STATEJUMP_EXPORT_AS(statejump::dem::Bo1<statejump::dem::MeshBore>, "Bo1_MeshBore_Aabb")
STATEJUMP_EXPORT_AS(statejump::dem::Bo1<statejump::dem::Slider>, "Bo1_Slider_Aabb")
STATEJUMP_EXPORT_AS(statejump::dem::Bo1<statejump::dem::SlotFace>, "Bo1_SlotFace_Aabb")
#ifdef STATEJUMP_HAS_VIEW
STATEJUMP_EXPORT_AS(statejump::dem::Gl1<statejump::dem::Journal>, "Gl1_Journal")
STATEJUMP_EXPORT_AS(statejump::dem::Gl1<statejump::dem::Bearing>, "Gl1_Bearing")
STATEJUMP_EXPORT_AS(statejump::dem::Gl1<statejump::dem::Ball>, "Gl1_Ball")
STATEJUMP_EXPORT_AS(statejump::dem::Gl1<statejump::dem::Socket>, "Gl1_Socket")
STATEJUMP_EXPORT_AS(statejump::dem::Gl1<statejump::dem::MeshBore>, "Gl1_MeshBore")
STATEJUMP_EXPORT_AS(statejump::dem::Gl1<statejump::dem::Slider>, "Gl1_Slider")
STATEJUMP_EXPORT_AS(statejump::dem::Gl1<statejump::dem::SlotFace>, "Gl1_SlotFace")
#endif
STATEJUMP_EXPORT(JointGeom)
STATEJUMP_EXPORT(MeshBore)
STATEJUMP_EXPORT(BoreGeom)
STATEJUMP_EXPORT(BorePhys)
STATEJUMP_EXPORT(Ig2_Journal_MeshBore_BoreGeom)
STATEJUMP_EXPORT(Ig2_Ball_MeshBore_BoreGeom)
STATEJUMP_EXPORT(Law2_BoreGeom_BorePhys_JointLaw)
STATEJUMP_EXPORT(JointPhys)
STATEJUMP_EXPORT(Ig2_Journal_Bearing_JointGeom)
STATEJUMP_EXPORT(Ig2_Ball_Socket_JointGeom)
STATEJUMP_EXPORT(Ig2_Ball_Ball_JointGeom)
STATEJUMP_EXPORT(Ig2_Slider_SlotFace_JointGeom)
STATEJUMP_EXPORT(Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys)
STATEJUMP_EXPORT(Law2_JointGeom_JointPhys_HertzMindlin)
STATEJUMP_EXPORT(Law2_JointGeom_JointPhys_JointLaw)
STATEJUMP_EXPORT(ThermalProgram)
STATEJUMP_EXPORT(ThermalExpansionEngine)
STATEJUMP_EXPORT(ThermalLink)
STATEJUMP_EXPORT(ThermalLinks)
STATEJUMP_EXPORT(TorsionSpring)
STATEJUMP_EXPORT(TorsionSprings)
STATEJUMP_EXPORT(PrismaticJoint)
STATEJUMP_EXPORT(PrismaticJoints)
STATEJUMP_EXPORT(BeamBond)
STATEJUMP_EXPORT(BeamBonds)
STATEJUMP_EXPORT(GuidePlanes)
STATEJUMP_EXPORT(StateRecorder)
STATEJUMP_EXPORT(JointStepper)

BOOST_PYTHON_MODULE(_native) {
  namespace py = boost::python;
  py::def("setup", &statejump::dem::setup, py::arg("wrapper"));
  py::def("built_for", &statejump::yade_abi::built_for);
  py::def("archive_version", &statejump::dem::archive_version);
  py::def("class_names", &statejump::dem::OurClasses::names);
  py::def(
      "law_names", &statejump::dem::law_names,
      "Names of laws by the attribute of Law2_JointGeom_JointPhys_JointLaw that takes them, those "
      "of one's own last: {'normalLaw': [...], 'dissipationLaw': [...], 'frictionLaw': [...], "
      "'tangentialVelocity': [...]}.");
  py::def(
      "bore_triangles", &statejump::dem::bore_triangles,
      (py::arg("radius"), py::arg("length"), py::arg("around"), py::arg("along"),
       py::arg("lobes") = py::list(), py::arg("wearDepth") = 0.0, py::arg("wearAngle") = 0.0,
       py::arg("wearWidth") = 0.5, py::arg("crown") = 0.0, py::arg("wallThickness") = 0.0),
      "Triangles of a bore along z as keywords for MeshBore. radius R, length [m]; facets "
      "around (>= 3) and along (>= 1); lobes: list of (waves per turn, amplitude [m], angle of "
      "the largest radius [rad]), r = R + amplitude cos(waves (angle - phase)); wearDepth [m] "
      "of a trough at wearAngle [rad], wearWidth [rad] wide; crown [m]: growth of the radius at "
      "both ends; wallThickness [m]: above 0 a closed ring, else a tube.");
  py::def("socket_triangles", &statejump::dem::socket_triangles,
          (py::arg("radius"), py::arg("opening"), py::arg("around"), py::arg("along")),
          "Triangles of a cup as keywords for MeshBore: the part of a sphere of the radius [m] "
          "below the polar angle opening [rad] from z, facets around (>= 3) and rings (>= 2).");
  py::def("hertz_depth", &statejump::dem::hertz_depth,
          (py::arg("force"), py::arg("effectiveRadius"), py::arg("young"), py::arg("poisson")),
          "Depth [m] at which Hertz's point contact of two bodies of one material carries a force "
          "[N]: start there, and nothing rings. effectiveRadius is that of the pads on a SlotFace, "
          "R1 R2 / (R2 - R1) in a bearing [m].");
  py::def(
      "take_failure", &statejump::dem::take_failure,
      "What ended the last run, as fields, and forget it: a dict with part ('contact', 'link', "
      "'torsion_spring', 'prismatic_joint', 'beam', 'body' or 'scene'), bodies (two ids, one or "
      "none), "
      "before and after (the "
      "sentence around the name of a link, spring or body), time [s], stable_time_step [s] (None "
      "unless the step was too long) "
      "code, quantity, value, allowed (texts) and sentence. None: nothing of this plugin failed.");
  py::def("take_refusal", &statejump::dem::take_refusal,
          "The argument or scene that was rejected last, and forget it: a dict with code, key, "
          "value, allowed and sentence, all texts. None: nothing was rejected.");
  py::def("stable_time_step", &statejump::dem::stable_time_step_of_scene,
          "Stable time step of the current scene [s], on the safe side: smallest of "
          "4 / (c + sqrt(c^2 + 4 k)) over the bodies, k and c twice the sums of stiffness and "
          "damping times 1/m (plus arm^2/I where the body may turn) of what touches it (joint "
          "contacts at their current stiffness, thermal links, torsion springs, prismatic joints, "
          "beams). "
          "Contacts that do "
          "not touch yet "
          "count nothing. Infinity when nothing acts on a free body.");
}
