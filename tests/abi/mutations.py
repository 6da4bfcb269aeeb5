# SPDX-License-Identifier: GPL-3.0-or-later
"""Wrong declarations of YADE's interface: a list of likely mistakes, and any number of random ones."""
from __future__ import annotations

import random
import re
from dataclasses import dataclass
from pathlib import Path

from bench import HEADERS, class_range, edited


@dataclass
class Mutation:
    """One wrong declaration: header (without .hpp), old and new text."""

    name: str
    kind: str
    header: str
    changed: str
    check: str = ""  # check of the guard that must detect it; empty: any
    aligned: bool = False  # with Eigen's own alignment
    listed: bool = False  # whether the list edits the same part (members or table) of the same class


# Name, header, class, edits inside of the class, and the check that must detect them.
NAMED: list[tuple[str, str, str | None, list[tuple[str, str]], str]] = [
    ("shape_16_short", "core", "Shape", [("  Unused<32> functors;", "  Unused<16> functors;")], "size"),
    ("shape_32_short_at_the_head", "core", "Shape", [("  Unused<32> functors;", "  Unused<0> functors;")], "size"),
    ("ks_and_shear_force_swapped", "core", "NormShearPhys",
     [("  Real ks;\n  Vector3r shearForce;", "  Vector3r shearForce;\n  Real ks;")], "getter"),
    ("scene_dt_and_iter_shifted_by_8", "core", "Scene",
     [("  Unused<104> speedAndRenderer;", "  Unused<112> speedAndRenderer;"),
      ("  Unused<104> materialsCellAndMore;", "  Unused<96> materialsCellAndMore;")], "getter"),
    ("scene_one_member_less", "core", "Scene",
     [("  Unused<104> speedAndRenderer;", "  Unused<96> speedAndRenderer;")], "size"),
    ("scene_track_energy_shifted_by_1", "core", "Scene",
     [("  bool trackEnergy;\n  bool doSort;", "  bool doSort;\n  bool trackEnergy;")], "getter"),
    ("scene_bodies_and_interactions_swapped", "core", "Scene",
     [("  shared_ptr<BodyContainer> bodies;\n  shared_ptr<InteractionContainer> interactions;",
       "  shared_ptr<InteractionContainer> interactions;\n  shared_ptr<BodyContainer> bodies;")], "value"),
    ("scene_engines_after_next_engines", "core", "Scene",
     [("  std::vector<shared_ptr<Engine>> engines;\n", ""),
      ("nextEngines;\n", "nextEngines;\n  std::vector<shared_ptr<Engine>> engines;\n")], "value"),
    ("scene_forces_after_speeds", "core", "Scene",
     [("  ForceContainer forces;\n", ""),
      ("speedAndRenderer;\n", "speedAndRenderer;\n  ForceContainer forces;\n")], "value"),
    ("scene_energy_before_bodies", "core", "Scene",
     [("  shared_ptr<EnergyTracker> energy;\n", ""),
      ("  shared_ptr<BodyContainer> bodies;",
       "  shared_ptr<EnergyTracker> energy;\n  shared_ptr<BodyContainer> bodies;")], "value"),
    ("bodies_after_the_rest", "core", "BodyContainer",
     [("  std::vector<shared_ptr<Body>> body;\n  Unused<152> listsAndMutex;\n",
       "  Unused<152> listsAndMutex;\n  std::vector<shared_ptr<Body>> body;\n")], "value"),
    ("interaction_list_moved", "core", "InteractionContainer",
     [("  std::vector<shared_ptr<Interaction>> linIntrs;\n  Unused<32> sortedAndBodies;\n",
       "  Unused<32> sortedAndBodies;\n  std::vector<shared_ptr<Interaction>> linIntrs;\n")], "value"),
    ("interaction_number_moved", "core", "InteractionContainer",
     [("  Unused<32> sortedAndBodies;\n  std::size_t currSize;\n",
       "  std::size_t currSize;\n  Unused<32> sortedAndBodies;\n")], "value"),
    ("interaction_ids_swapped", "core", "Interaction",
     [("  int id1;\n  int id2;", "  int id2;\n  int id1;")], "getter"),
    ("interaction_geom_and_phys_swapped", "core", "Interaction",
     [("  shared_ptr<IGeom> geom;\n  shared_ptr<IPhys> phys;",
       "  shared_ptr<IPhys> phys;\n  shared_ptr<IGeom> geom;")], "getter"),
    ("elastic_material_members_swapped", "core", "ElastMat",
     [("  Real young;\n  Real poisson;", "  Real poisson;\n  Real young;")], "getter"),
    ("state_velocities_swapped", "core", "State",
     [("  Vector3r vel;\n  Real mass;\n  Vector3r angVel;",
       "  Vector3r angVel;\n  Real mass;\n  Vector3r vel;")], "getter"),
    ("state_blocked_directions_moved", "core", "State",
     [("  unsigned int blockedDOFs;\n  bool isDamped;", "  bool isDamped;\n  unsigned int blockedDOFs;")], "getter"),
    ("body_state_and_shape_swapped", "core", "Body",
     [("  shared_ptr<State> state;\n  shared_ptr<Shape> shape;",
       "  shared_ptr<Shape> shape;\n  shared_ptr<State> state;")], "getter"),
    ("bound_corners_swapped", "core", "Bound",
     [("  Vector3r min;\n  Vector3r max;", "  Vector3r max;\n  Vector3r min;")], "getter"),
    ("contact_radii_swapped", "core", "GenericSpheresContact",
     [("  Real refR1 = 0;\n  Real refR2 = 0;", "  Real refR2 = 0;\n  Real refR1 = 0;")], "getter"),
    ("functor_label_shifted", "dispatch", "Functor",
     [("  Scene* scene = nullptr;\n  std::string label;",
       "  std::string label;\n  Scene* scene = nullptr;")], "getter"),
    ("functor_scene_and_timing_swapped", "dispatch", "Functor",
     [("  shared_ptr<TimingDeltas> timingDeltas;\n  Scene* scene = nullptr;",
       "  Scene* scene = nullptr;\n  shared_ptr<TimingDeltas> timingDeltas;")], "getter"),
    ("functor_scene_of_another_type", "dispatch", "Functor",
     [("  Scene* scene = nullptr;", "  Body* scene = nullptr;")], "coverage"),
    ("engine_flag_and_threads_swapped", "dispatch", "Engine",
     [("  bool dead;\n  int ompThreads;", "  int ompThreads;\n  bool dead;")], "getter"),
    ("engine_scene_after_timing", "dispatch", "Engine",
     [("  Scene* scene;\n  Unused<16> timingInfo;", "  Unused<16> timingInfo;\n  Scene* scene;")], "value"),
    ("material_virtual_missing", "core", "Material",
     [("  virtual bool stateTypeOk(State* state) const;\n", "")], "table"),
    ("serializable_virtuals_swapped", "base", "Serializable",
     [("  virtual boost::python::dict pyDict() const;\n  virtual boost::python::dict pyDictCustom() const;\n",
       "  virtual boost::python::dict pyDictCustom() const;\n  virtual boost::python::dict pyDict() const;\n")],
     "table"),
    ("indexable_virtuals_swapped", "base", "Indexable",
     [("  virtual const int& getClassIndex() const { no_dispatch_index(); }\n"
       "  virtual const int& getBaseClassIndex(int) const { no_dispatch_index(); }\n",
       "  virtual const int& getBaseClassIndex(int) const { no_dispatch_index(); }\n"
       "  virtual const int& getClassIndex() const { no_dispatch_index(); }\n")], "table"),
    ("geometry_functor_extra_virtual", "dispatch", "IGeomFunctor",
     [("  virtual void preStep();", "  virtual void preStep();\n  virtual void postStep() {}")], "table"),
    ("functor_overload_missing", "dispatch", "FunctorWrapper",
     [("  virtual Result goReverse(P<0>, P<1>, P<2>, P<3>, P<4>, P<5>, P<6>) { refuse(); }\n", "")], "table"),
    ("functor_argument_by_value", "dispatch", "IGeomFunctor", [("const bool&,", "bool,")], "table"),
    ("view_functor_virtual_missing", "dispatch", "GlShapeFunctor", [("  virtual void initgl();\n", "")], "table"),
    ("view_functor_virtuals_swapped", "dispatch", "GlShapeFunctor",
     [("  virtual std::string renders() const;\n  virtual void initgl();",
       "  virtual void initgl();\n  virtual std::string renders() const;")], "table"),
    ("view_functor_argument_by_reference", "dispatch", "GlShapeFunctor",
     [("const shared_ptr<State>&, bool,", "const shared_ptr<State>&, bool&,")], "table"),
    ("view_functor_member_more", "dispatch", "GlShapeFunctor",
     [("  virtual void initgl();", "  virtual void initgl();\n  Real unused;")], "size"),
    ("view_flag_of_another_size", "dispatch", "OpenGLRenderer",
     [("  static bool initDone;", "  static int initDone;")], "table"),
    ("engine_virtuals_swapped", "dispatch", "Engine",
     [("  virtual bool isActivated();\n  virtual void action();",
       "  virtual void action();\n  virtual bool isActivated();")], "table"),
]


def named(headers: Path) -> list[Mutation]:
    """Return the listed mutations. It is an error if the search text of an edit is not in the headers."""
    texts = {name: (headers / HEADERS / f"{name}.hpp").read_text() for name in ("base", "core", "dispatch")}
    result = [Mutation(name, "listed", header, edited(texts[header], class_name, edits, name), check)
              for name, header, class_name, edits, check in NAMED]
    error = '#error "compile with -DEIGEN_DONT_ALIGN -DEIGEN_DONT_VECTORIZE, as YADE was"\n'
    result.append(Mutation("eigen_aligned", "listed", "base",
                           edited(texts["base"], None, [(error, "")], "eigen_aligned"), "size", aligned=True))
    return result


# A data member: two blanks, type, name, optional value, optional comment; no '(' before the name.
MEMBER = re.compile(r"^  (?!virtual |static |using |return |throw |template|enum )"
                    r"([A-Za-z][\w:<>, ]*?[&*]?) (\w+)( = [^;]+)?;(?: *//.*)?\n", re.M)
# A virtual function that begins or overrides an entry of the table; destructors are compared by their role.
NEW_VIRTUAL = re.compile(r"^  virtual (?!~)[^;{]*\([^;{]*(?:;|\{[^}]*\})\n", re.M)
OVERRIDE = re.compile(r"^  (?!virtual)[^~\n;]*\([^;]*\) (?:const )?override;\n", re.M)
ADDED = ["bool", "int", "long", "Real", "Vector3r", "Quaternionr", "std::string", "shared_ptr<Body>", "void*"]
# Types of the same size first, because these mistakes are the hardest to detect.
RETYPED = {
    "bool": ["char", "signed char", "int"], "int": ["unsigned int", "float", "long"],
    "unsigned int": ["int", "float", "Real"], "long": ["unsigned long", "Real", "int"],
    "std::size_t": ["long", "Real", "int"], "Real": ["long", "float", "Real*"],
    "Vector3r": ["std::array<Real, 3>", "Eigen::Matrix<long, 3, 1>", "Quaternionr"],
    "Vector3i": ["std::array<int, 3>", "Eigen::Matrix<float, 3, 1>", "Vector3r"],
    "Quaternionr": ["std::array<Real, 4>", "Eigen::Matrix<Real, 4, 1>", "Vector3r"],
    "Se3r": ["std::array<Real, 7>", "Eigen::Matrix<Real, 7, 1>", "Vector3r"],
    "std::string": ["std::array<char, 32>", "Quaternionr", "std::vector<char>"],
    "Scene*": ["Body*", "void*", "shared_ptr<Scene>"], "ForceContainer": ["Unused<304>", "Unused<296>"],
}
# Members or table of a class, as far as the list edits them. Random mutations elsewhere are of new kinds.
LISTED_PARTS = {(class_name, check == "table") for _, _, class_name, _, check in NAMED}
HEADERS_OF_CLASSES = {
    "base": ["Serializable", "Indexable"],
    "core": ["Shape", "Bound", "Aabb", "State", "Material", "ElastMat", "FrictMat", "IGeom", "GenericSpheresContact",
             "IPhys", "NormPhys", "NormShearPhys", "FrictPhys", "Interaction", "Body", "ForceContainer",
             "BodyContainer", "InteractionContainer", "EnergyTracker", "Scene"],
    "dispatch": ["Functor", "FunctorWrapper", "BoundFunctor", "IGeomFunctor", "IPhysFunctor", "LawFunctor",
                 "GlShapeFunctor", "Engine", "GlobalEngine"],
}


def _retyped(declared: str, choose: random.Random) -> str:
    if declared in RETYPED:
        return choose.choice(RETYPED[declared])
    if declared.startswith("Unused<"):
        size = int(re.search(r"\d+", declared)[0])
        return declared.replace(str(size), str(max(1, size + choose.choice([-16, -8, -4, 4, 8, 16]))), 1)
    if declared.startswith("shared_ptr<"):
        return choose.choice(["shared_ptr<Aabb>", "std::array<void*, 2>", "void*"])
    return choose.choice(["std::array<void*, 3>", "std::vector<shared_ptr<Aabb>>", "std::vector<char>", "void*"])


class Random:
    """Generates random wrong declarations, reproducible by the seed."""

    def __init__(self, headers: Path, seed: int) -> None:
        self.choose = random.Random(seed)
        self.texts = {name: (headers / HEADERS / f"{name}.hpp").read_text() for name in HEADERS_OF_CLASSES}
        self.places = [(header, one) for header, classes in HEADERS_OF_CLASSES.items() for one in classes]
        self.made: set[str] = set()

    def mutation(self, number: int, listed: bool) -> Mutation:
        """Return a new random mutation, in a part of the headers that the list edits or in another part."""
        kinds = {"member moved": self._moved, "member added": self._added, "member removed": self._removed,
                 "member retyped": self._typed, "entry exchanged": self._exchanged, "entry added": self._entry_added,
                 "entry removed": self._entry_removed, "size changed": self._size}
        while True:
            kind = self.choose.choice(list(kinds))
            header, class_name = self.choose.choice(self.places)
            if ((class_name, kind.startswith("entry")) in LISTED_PARTS) != listed:
                continue
            text = self.texts[header]
            start, end = class_range(text, class_name)
            changed = kinds[kind](text[start:end])
            if changed is None:
                continue
            whole = text[:start] + changed + text[end:]
            if whole in self.made:
                continue
            self.made.add(whole)
            return Mutation(f"{number:04d} {class_name}", kind, header, whole, listed=listed)

    def _members(self, part: str) -> list[re.Match[str]]:
        return list(MEMBER.finditer(part))

    def _place_for_member(self, part: str) -> int:
        members = self._members(part)
        if members:
            return self.choose.choice([one.start() for one in members] + [members[-1].end()])
        return part.index("  ~") if "  ~" in part else len(part)

    def _moved(self, part: str) -> str | None:
        members = self._members(part)
        if len(members) < 2:
            return None
        one = self.choose.choice(members)
        rest = part[: one.start()] + part[one.end():]
        place = self._place_for_member(rest)
        changed = rest[:place] + one[0] + rest[place:]
        return None if changed == part else changed

    def _added(self, part: str) -> str:
        place = self._place_for_member(part)
        return part[:place] + f"  {self.choose.choice(ADDED)} added;\n" + part[place:]

    def _removed(self, part: str) -> str | None:
        members = self._members(part)
        if not members:
            return None
        one = self.choose.choice(members)
        return part[: one.start()] + part[one.end():]

    def _typed(self, part: str) -> str | None:
        members = self._members(part)
        if not members:
            return None
        one = self.choose.choice(members)
        return part[: one.start(1)] + _retyped(one[1], self.choose) + f" {one[2]};\n" + part[one.end():]

    def _size(self, part: str) -> str:
        return part + f"  Unused<{self.choose.choice([1, 2, 4, 8, 16, 24, 32, 64])}, 1> more;\n"

    def _exchanged(self, part: str) -> str | None:
        entries = list(NEW_VIRTUAL.finditer(part))
        if len(entries) < 2:
            return None
        first, second = sorted(self.choose.sample(entries, 2), key=lambda one: one.start())
        return (part[: first.start()] + second[0] + part[first.end(): second.start()] + first[0] + part[second.end():])

    def _entry_added(self, part: str) -> str | None:
        entries = list(NEW_VIRTUAL.finditer(part)) + list(OVERRIDE.finditer(part))
        if not entries:
            return None
        one = self.choose.choice(entries)
        kind = self.choose.choice(["void added() {}", "int added() const { return 0; }", "void added(int) {}"])
        return part[: one.start()] + f"  virtual {kind}\n" + part[one.start():]

    def _entry_removed(self, part: str) -> str | None:
        entries = list(NEW_VIRTUAL.finditer(part)) + list(OVERRIDE.finditer(part))
        if not entries:
            return None
        one = self.choose.choice(entries)
        return part[: one.start()] + part[one.end():]
