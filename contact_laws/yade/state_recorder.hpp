// SPDX-License-Identifier: GPL-3.0-or-later
// Records the state of a scene of joints, one row of numbers per sample.
#pragma once

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "beam.hpp"
#include "prismatic.hpp"
#include "registered.hpp"
#include "statejump/stepper/arrays.hpp"
#include "thermal.hpp"
#include "torsion.hpp"

namespace statejump::dem {

struct StateRecorder : Registered<StateRecorder, yade::GlobalEngine> {
  static constexpr const char* class_name = "StateRecorder";
  static constexpr const char* base_name = "GlobalEngine";
  static constexpr const char* doc =
      "Keeps the state of chosen bodies, contacts, links, springs and joints in every step of "
      "which "
      "O.iter is a multiple of iterPeriod, one row of numbers each, until take() hands the rows "
      "over. Place it right before the NewtonIntegrator: a row is of one time, but for velocities, "
      "which are half a step old. The JointStepper fills the same rows without leaving its arrays. "
      "A row has the numbers that scalars() names; of each body position [m], velocity [m/s] and "
      "force [N] in the directions in which it is free; of each contact whether it is there (1 or "
      "0), penetrationDepth [m], slipping (1 or 0), normal, normalForce [N] and shearForce [N] of "
      "YADE, zeros where it is not there; of each link axialForce [N], temperatureChange [K], "
      "previousExtension [m] and previousStressFreeLength [m]; of each torsion spring angle [rad], "
      "moment [N m] and frictionMoment [N m]; of each prismatic joint slide [m], frictionForce [N] "
      "and stopForce [N]; of each beam force1 [N], moment1 [N m], force2 [N] and moment2 [N m]; of "
      "each body among rotations its rotation vector since the orientation 1 [rad], angular "
      "velocity [rad/s] and torque [N m] about the axes about which it is free. Rows that nobody "
      "has taken are not saved.";
  int iterPeriod = 1;
  std::vector<int> bodies, contacts;
  std::vector<yade::shared_ptr<ThermalLink>> links;
  std::vector<yade::shared_ptr<TorsionSpring>> springs;
  std::vector<yade::shared_ptr<PrismaticJoint>> joints;
  std::vector<yade::shared_ptr<BeamBond>> beams;
  std::vector<int> rotations;

  // Quantities that a scene does not store in its objects. The caller must hold the GIL.
  struct Sums {
    const stepper::Energies& energies;
    const stepper::StoredEnergies& stored;
    std::function<Vector3r(std::size_t)> force;   // force on a body [N]
    std::function<Vector3r(std::size_t)> torque;  // torque on a body [N m]
  };
  void sample(const yade::Scene& of, const Sums& sums);
  bool samples(long iteration) const { return iteration % iterPeriod == 0; }
  std::size_t size() const { return rows_.size(); }
  void forget(std::size_t from) { rows_.resize(from); }

  void action() override;
  void check();
  static auto attributes() {
    return std::make_tuple(
        attribute("iterPeriod", &StateRecorder::iterPeriod,
                  "Every how many steps a row is kept, 1 or above [-]"),
        attribute("bodies", &StateRecorder::bodies, "Bodies by their ids [-]"),
        attribute("contacts", &StateRecorder::contacts,
                  "Contacts by the ids of their two bodies, one contact after the other [-]"),
        attribute("links", &StateRecorder::links, "List of ThermalLink objects"),
        attribute("springs", &StateRecorder::springs, "List of TorsionSpring objects"),
        attribute("joints", &StateRecorder::joints, "List of PrismaticJoint objects"),
        attribute("beams", &StateRecorder::beams, "List of BeamBond objects"),
        attribute("rotations", &StateRecorder::rotations,
                  "Bodies whose rotation is kept, by their ids [-]"));
  }
  template <class PythonClass>
  static void register_methods(PythonClass& entry) {
    entry.def("take", &StateRecorder::take,
              "Rows since the last call, and forget them: bytes of numbers in the machine's double "
              "precision, width() of them a row.");
    entry.def("width", &StateRecorder::width, "Numbers of a row [-]");
    entry.def("rows", &StateRecorder::rows, "Rows since the last call of take() [-]");
    entry.def("scalars", &StateRecorder::scalars,
              "Names of the first numbers of a row: time [s], energies [J] as in O.energy, number "
              "of contacts of the scene [-], ids of the two bodies of the first of them that is "
              "not among the contacts, -1 where there is none [-].");
  }

 private:
  boost::python::object take();
  std::size_t width() const;
  std::size_t rows() const { return rows_.size() / width(); }
  boost::python::list scalars() const;
  void add_contacts(const yade::Scene& of, std::size_t strangers);
  std::unordered_map<std::uint64_t, std::size_t> columns_;  // of contacts, by pair of bodies
  std::vector<Real> rows_;
};

}  // namespace statejump::dem
