#!/usr/bin/python3
"""Declares YADE's interface wrongly on purpose, one way at a time, and requires that it is refused.

Every mutation is an edit of a copy of the declared headers. It must be refused twice: by the
static_asserts of layout_checks.hpp when it moves a member (they cannot see the order of virtual
functions), and, compiled without them, by the guard inside a running YADE, which has to answer with
a sentence. A crash is not a refusal. An edit whose search text is gone is an error.
"""
import argparse
import concurrent.futures
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
HEADERS = "statejump/yade_abi/"
NO_ALIGNMENT = ["-DEIGEN_DONT_ALIGN", "-DEIGEN_DONT_VECTORIZE"]
SIZE, TABLE, PLACE = "size of", "the vtable of", "is not at the declared place"

# Name, header, class, edits inside of the class, whether static_asserts can see it, and what the
# sentence of the guard must contain.
MUTATIONS = [
    ("shape_16_short", "core", "Shape",
     [("  shared_ptr<InternalForceFunctor> internalforcefunctor;\n", "")], True, SIZE),
    ("shape_32_short_at_the_tail", "core", "Shape",
     [("  Vector3r color = Vector3r(1, 1, 1);", "  inline static Vector3r color;"),
      ("  bool wire = false;", "  inline static bool wire;"),
      ("  bool highlight = false;", "  inline static bool highlight;")], True, SIZE),
    ("ks_and_shear_force_swapped", "core", "NormShearPhys",
     [("  Real ks;\n  Vector3r shearForce;", "  Vector3r shearForce;\n  Real ks;")], True, PLACE),
    ("scene_dt_and_iter_shifted_by_8", "core", "Scene",
     [("  Real dt;", "  Real unused;\n  Real dt;"),
      ("  bool subStepping;\n  int subStep;",
       "  inline static bool subStepping;\n  inline static int subStep;")], True, PLACE),
    ("scene_one_member_less", "core", "Scene", [("  long prevTime;\n", "")], True, SIZE),
    ("scene_track_energy_shifted_by_1", "core", "Scene",
     [("  bool trackEnergy;\n  bool doSort;", "  bool doSort;\n  bool trackEnergy;")], True, PLACE),
    ("scene_bodies_and_interactions_swapped", "core", "Scene",
     [("  shared_ptr<BodyContainer> bodies;\n  shared_ptr<InteractionContainer> interactions;",
       "  shared_ptr<InteractionContainer> interactions;\n  shared_ptr<BodyContainer> bodies;")],
     True, PLACE),
    ("scene_engines_after_next_engines", "core", "Scene",
     [("  std::vector<shared_ptr<Engine>> engines;\n", ""),
      ("nextEngines;\n", "nextEngines;\n  std::vector<shared_ptr<Engine>> engines;\n")],
     True, PLACE),
    ("scene_forces_after_speeds", "core", "Scene",
     [("  ForceContainer forces;\n", ""),
      ("speedElements;\n", "speedElements;\n  ForceContainer forces;\n")], True, PLACE),
    ("scene_energy_before_bodies", "core", "Scene",
     [("  shared_ptr<EnergyTracker> energy;\n", ""),
      ("  shared_ptr<BodyContainer> bodies;",
       "  shared_ptr<EnergyTracker> energy;\n  shared_ptr<BodyContainer> bodies;")], True, PLACE),
    ("bodies_after_inserted_bodies", "core", "BodyContainer",
     [("  std::vector<shared_ptr<Body>> body;\n  bool dirty;\n  bool checkedByCollider;\n"
       "  std::vector<int> insertedBodies;\n",
       "  std::vector<int> insertedBodies;\n  bool dirty;\n  bool checkedByCollider;\n"
       "  std::vector<shared_ptr<Body>> body;\n")], True, PLACE),
    ("interaction_lists_swapped", "core", "InteractionContainer",
     [("  std::vector<shared_ptr<Interaction>> linIntrs;\n"
       "  std::vector<shared_ptr<Interaction>> sortedIntrs;\n",
       "  std::vector<shared_ptr<Interaction>> sortedIntrs;\n"
       "  std::vector<shared_ptr<Interaction>> linIntrs;\n")], True, PLACE),
    ("interaction_ids_swapped", "core", "Interaction",
     [("  int id1;\n  int id2;", "  int id2;\n  int id1;")], True, PLACE),
    ("interaction_geom_and_phys_swapped", "core", "Interaction",
     [("  shared_ptr<IGeom> geom;\n  shared_ptr<IPhys> phys;",
       "  shared_ptr<IPhys> phys;\n  shared_ptr<IGeom> geom;")], True, PLACE),
    ("elastic_material_members_swapped", "core", "ElastMat",
     [("  Real young;\n  Real poisson;", "  Real poisson;\n  Real young;")], True, PLACE),
    ("state_velocities_swapped", "core", "State",
     [("  Vector3r vel;\n  Real mass;\n  Vector3r angVel;",
       "  Vector3r angVel;\n  Real mass;\n  Vector3r vel;")], True, PLACE),
    ("body_state_and_shape_swapped", "core", "Body",
     [("  shared_ptr<State> state;\n  shared_ptr<Shape> shape;",
       "  shared_ptr<Shape> shape;\n  shared_ptr<State> state;")], True, PLACE),
    ("bound_corners_swapped", "core", "Bound",
     [("  Vector3r min;\n  Vector3r max;", "  Vector3r max;\n  Vector3r min;")], True, PLACE),
    ("contact_radius_missing", "core", "GenericSpheresContact",
     [("  Real refR1 = 0;", "  inline static Real refR1;")], True, SIZE),
    ("contact_radii_swapped", "core", "GenericSpheresContact",
     [("  Real refR1 = 0;\n  Real refR2 = 0;", "  Real refR2 = 0;\n  Real refR1 = 0;")],
     True, PLACE),
    ("functor_label_shifted", "dispatch", "Functor",
     [("  Scene* scene = nullptr;\n  std::string label;",
       "  std::string label;\n  Scene* scene = nullptr;")], True, PLACE),
    ("engine_flag_and_threads_swapped", "dispatch", "Engine",
     [("  bool dead;\n  int ompThreads;", "  int ompThreads;\n  bool dead;")], True, PLACE),
    ("engine_scene_after_timing", "dispatch", "Engine",
     [("  Scene* scene;\n  TimingInfo timingInfo;", "  TimingInfo timingInfo;\n  Scene* scene;")],
     True, PLACE),
    ("material_virtual_missing", "core", "Material",
     [("  virtual bool stateTypeOk(State* state) const;\n", "")], False, TABLE),
    ("serializable_virtuals_swapped", "base", "Serializable",
     [("  virtual boost::python::dict pyDict() const;\n"
       "  virtual boost::python::dict pyDictCustom() const;\n",
       "  virtual boost::python::dict pyDictCustom() const;\n"
       "  virtual boost::python::dict pyDict() const;\n")], False, TABLE),
    ("indexable_virtuals_swapped", "base", "Indexable",
     [("  virtual const int& getClassIndex() const { no_dispatch_index(); }\n"
       "  virtual const int& getBaseClassIndex(int) const { no_dispatch_index(); }\n",
       "  virtual const int& getBaseClassIndex(int) const { no_dispatch_index(); }\n"
       "  virtual const int& getClassIndex() const { no_dispatch_index(); }\n")], False, TABLE),
    ("geometry_functor_extra_virtual", "dispatch", "IGeomFunctor",
     [("  virtual void preStep();", "  virtual void preStep();\n  virtual void postStep() {}")],
     False, TABLE),
    ("functor_overload_missing", "dispatch", "FunctorWrapper",
     [("  virtual Result goReverse(P<0>, P<1>, P<2>, P<3>, P<4>, P<5>, P<6>) { refuse(); }\n", "")],
     False, TABLE),
    ("functor_argument_by_value", "dispatch", "IGeomFunctor",
     [("const bool&,", "bool,")], False, TABLE),
    ("view_functor_virtual_missing", "dispatch", "GlShapeFunctor",
     [("  virtual void initgl();\n", "")], False, TABLE),
    ("view_functor_virtuals_swapped", "dispatch", "GlShapeFunctor",
     [("  virtual std::string renders() const;\n  virtual void initgl();",
       "  virtual void initgl();\n  virtual std::string renders() const;")], False, TABLE),
    ("view_functor_argument_by_reference", "dispatch", "GlShapeFunctor",
     [("const shared_ptr<State>&, bool,", "const shared_ptr<State>&, bool&,")], False, TABLE),
    ("view_functor_member_more", "dispatch", "GlShapeFunctor",
     [("  virtual void initgl();", "  virtual void initgl();\n  Real unused;")], True, SIZE),
    ("view_flag_of_another_size", "dispatch", "OpenGLRenderer",
     [("  static bool initDone;", "  static int initDone;")], False, "initDone"),
    ("engine_virtuals_swapped", "dispatch", "Engine",
     [("  virtual bool isActivated();\n  virtual void action();",
       "  virtual void action();\n  virtual bool isActivated();")], False, TABLE),
    ("eigen_aligned", "base", None,
     [('#error "compile with -DEIGEN_DONT_ALIGN -DEIGEN_DONT_VECTORIZE, as YADE was"\n', "")],
     True, SIZE),
]


def edited(text, class_name, edits, name):
    """The text with each edit made once, inside of the class."""
    start, end = 0, len(text)
    if class_name:
        head = re.search(rf"^class {class_name}\b(?!;)", text, re.M)
        if not head:
            sys.exit(f"{name}: class {class_name} is gone")
        start = head.start()
        end = text.index("\n};\n", start) + 1
    part = text[start:end]
    for old, new in edits:
        if part.count(old) != 1:
            sys.exit(f"{name}: search text found {part.count(old)} times, not once: {old!r}")
        part = part.replace(old, new)
    return text[:start] + part + text[end:]


class Bench:
    """Compiles and runs probes in a temporary folder."""

    def __init__(self, options, folder):
        self.options = options
        self.folder = folder
        self.includes = [f"-isystem{path}" for path in options.include]
        self.pch = folder / "third_party.hpp"
        shutil.copy(HERE / "third_party.hpp", self.pch)
        self.run([*self.compile_command(NO_ALIGNMENT, None), "-x", "c++-header", str(self.pch),
                  "-o", f"{self.pch}.gch"])
        self.probe = folder / "probe.o"
        self.run([*self.compile_command(NO_ALIGNMENT, options.headers), "-c",
                  str(HERE / "probe.cpp"), "-o", str(self.probe)])

    @staticmethod
    def run(command):
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"failed: {' '.join(command)}\n{done.stderr}")

    def compile_command(self, alignment, headers):
        command = [self.options.compiler, "-std=c++17", "-O0", "-fPIC", "-fopenmp", "-w",
                   "-DEIGEN_DISABLE_UNALIGNED_ARRAY_ASSERT", "-DBOOST_ALLOW_DEPRECATED_HEADERS",
                   "-DBOOST_BIND_GLOBAL_PLACEHOLDERS", *alignment]
        if headers:
            command += ["-include", str(self.pch), f"-I{headers}"]
        return command + self.includes

    def static_asserts_refuse(self, headers, alignment):
        done = subprocess.run(
            [*self.compile_command(alignment, headers), "-fsyntax-only", "-x", "c++",
             str(headers / HEADERS / "layout_checks.hpp")], capture_output=True, text=True)
        if done.returncode == 0:
            return False
        if "static assertion failed" not in done.stderr:
            sys.exit(f"{headers}: does not compile, but not because of a static_assert:\n"
                     f"{done.stderr[:3000]}")
        return True

    def build(self, place, headers, alignment, guard, flags):
        place.mkdir(exist_ok=True)
        self.run([*self.compile_command(alignment, headers), *flags, "-c", str(guard),
                  "-o", str(place / "guard.o")])
        libraries = [f"{self.options.yade}/lib{name}.so" for name in
                     ("yade", "pkg_common", "pkg_dem")]
        self.run([self.options.compiler, "-shared", "-fopenmp", "-Wl,--allow-shlib-undefined",
                  str(self.probe), str(place / "guard.o"), *libraries,
                  f"-l{self.options.boost_python}", "-o", str(place / "_native.so")])

    def in_yade(self, place, task):
        """What the probe said, or None when YADE ended without a word (a crash)."""
        environment = dict(os.environ, STATEJUMP_PROBE=str(place), STATEJUMP_PROBE_TASK=task)
        done = subprocess.run(["yade", "-n", "-x", str(HERE / "in_yade.py")], env=environment,
                              capture_output=True, text=True, timeout=120, cwd=place,
                              stdin=subprocess.DEVNULL)
        for line in done.stdout.splitlines():
            if line.startswith("PROBE "):
                return json.loads(line[len("PROBE "):])
        return None


def examine(bench, mutation):
    """Name, what the guard said, and what is wrong with that (empty: refused as it should be)."""
    name, header, class_name, edits, static, expected = mutation
    place = bench.folder / name
    headers = place / "include"
    shutil.copytree(bench.options.headers, headers)
    path = headers / HEADERS / f"{header}.hpp"
    path.write_text(edited(path.read_text(), class_name, edits, name))
    alignment = [] if name == "eigen_aligned" else NO_ALIGNMENT
    wrong = []
    if bench.static_asserts_refuse(headers, alignment) != static:
        wrong.append("static_asserts accept it" if static else
                     "static_asserts refuse it: no longer a mutation of virtual functions only")
    bench.build(place, headers, alignment, bench.options.guard,
                ["-DSTATEJUMP_NO_LAYOUT_CHECKS"])
    said = bench.in_yade(place, "difference")
    sentence = said["sentence"] if said else "(no answer)"
    if not said:
        wrong.append("YADE crashed")
    elif not sentence:
        wrong.append("the guard accepts it")
    elif expected not in sentence:
        wrong.append(f"refused, but not by the check meant ('{expected}')")
    return name, static, sentence, wrong


def unmutated(bench):
    """The declarations as they are: accepted, and the user's scene untouched."""
    headers = Path(bench.options.headers)
    place = bench.folder / "unmutated"
    wrong = []
    if bench.static_asserts_refuse(headers, NO_ALIGNMENT):
        wrong.append("static_asserts refuse it")
    bench.build(place, headers, NO_ALIGNMENT, bench.options.guard, [])
    said = bench.in_yade(place, "scene")
    if not said:
        wrong.append("YADE crashed")
    elif said["sentence"]:
        wrong.append("the guard refuses it")
    elif not said["same"]:
        wrong.append("the guard changed the user's scene")
    return "unmutated", True, f"(accepted in {said['seconds']:.3f} s)" if said else "", wrong


def other_build(bench):
    """A library with another build identifier: the package refuses with one sentence."""
    place = bench.folder / "other_build"
    package = place / "statejump_yade"
    package.mkdir(parents=True)
    for file in Path(bench.options.package).glob("*.py"):
        shutil.copy(file, package)
    guard = place / "guard.cpp"
    text = bench.options.guard.read_text()
    found = re.search(r'"libpkg_dem\.so", "([0-9a-f]{40})"', text)
    if not found:
        sys.exit("other_build: the known build identifier of libpkg_dem.so is gone")
    guard.write_text(text.replace(found[1], "0" * 40))
    bench.build(package, bench.options.headers, NO_ALIGNMENT, guard, [])
    said = bench.in_yade(place, "package")
    wrong = []
    if not said:
        wrong.append("YADE crashed")
    elif not said["error"].startswith("statejump_yade refuses to load: libpkg_dem.so has build "
                                      "identifier " + found[1]):
        wrong.append("the import does not name the library and its build identifier")
    elif "\n" in said["error"] or said["cause"]:
        wrong.append("more than one sentence")
    return "other_build", False, said["error"] if said else "(no answer)", wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--compiler", required=True)
    parser.add_argument("--headers", required=True, type=Path, help="declared interface")
    parser.add_argument("--guard", required=True, type=Path, help="guard.cpp")
    parser.add_argument("--package", required=True, help="Python part of the plugin")
    parser.add_argument("--include", action="append", default=[], help="Eigen, Python")
    parser.add_argument("--boost-python", required=True, help="library name without lib")
    parser.add_argument("--yade", required=True, help="folder of libyade.so")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", help="regular expression: just these mutations")
    options = parser.parse_args()
    start = time.monotonic()
    failures = 0
    with tempfile.TemporaryDirectory(prefix="statejump-abi-") as folder:
        bench = Bench(options, Path(folder))
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            tasks = [pool.submit(unmutated, bench), pool.submit(other_build, bench)]
            tasks += [pool.submit(examine, bench, mutation) for mutation in MUTATIONS
                      if not options.only or re.search(options.only, mutation[0])]
            for task in tasks:
                name, static, sentence, wrong = task.result()
                failures += bool(wrong)
                seen = "static_assert and guard" if static else "guard alone"
                if name in ("unmutated", "other_build"):
                    seen = ""
                print(f"{'FAILED' if wrong else 'ok':6} {name:38} {seen:23} {sentence}"
                      + "".join(f"  <-- {text}" for text in wrong), flush=True)
    print(f"{len(tasks) - failures} of {len(tasks)} as they should be, "
          f"{time.monotonic() - start:.0f} s")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
