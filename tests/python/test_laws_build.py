# SPDX-License-Identifier: GPL-3.0-or-later
"""User laws: one header, compiled separately, known by name in cases, listings and YADE scripts."""
from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import BUILT, REPOSITORY
from failures import failure
from statejump import _engine
from statejump.laws import build

TOYS = Path(__file__).resolve().parent / "toy_laws"
BY_LAW = """
import json, sys
import statejump as sj
try:
    run = sj.load(sys.argv[1]).changed(json.loads(sys.argv[2])).reduced()
except sj.StatejumpError as failure:
    sys.exit(str(failure))
print(json.dumps({"contacts": run.summary["contacts"], "residue": run.summary["energy_residue_J"],
                  "columns": {name: list(values) for name, values in run.flat().items()}}))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the toy laws, compiled once."""
    made = tmp_path_factory.mktemp("laws")
    for toy in sorted(TOYS.glob("*.hpp")):
        build.build(toy, made)
    return made


def ended(arguments: list[object], **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a program with the built package."""
    return subprocess.run(
        [str(each) for each in arguments], capture_output=True, text=True, timeout=300, stdin=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": str(BUILT), "XDG_DATA_HOME": "/nonexistent", **environment}, check=False,
    )


def rib(folder: Path, case: str, changes: dict[str, object]) -> subprocess.CompletedProcess[str]:
    """Run the reduced model of a rib with the laws of a folder."""
    quick = {"thermal.cycles": 1, "reduced.steps_per_cycle": 20000, "output.samples_per_cycle": 200}
    return ended([sys.executable, "-c", BY_LAW, REPOSITORY / "cases" / case, json.dumps({**quick, **changes})],
                 STATEJUMP_LAWS=str(folder))


def told(done: subprocess.CompletedProcess[str]) -> dict:
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_compiles_in_seconds(folder: Path, tmp_path: Path) -> None:
    start = os.times()
    written = build.build(TOYS / "twin.hpp", tmp_path)
    spent = os.times()
    assert written == tmp_path / "dissipation_twin.so" and written.is_file()
    assert list(tmp_path.iterdir()) == [written]
    # CPU time [s], independent of other load; a change of the catalogue takes 167 s.
    assert spent.children_user + spent.children_system - start.children_user - start.children_system < 20
    assert sorted(path.name for path in folder.iterdir()) == [
        "dissipation_twin.so", "friction_smooth.so", "normal_cubic.so"]


def test_same_text_same_bits(folder: Path) -> None:
    """A user's copy of the law hunt_crossley moves the rib exactly as the original, bit for bit."""
    base = {"joint.restitution": 0.7}
    own, twin = (told(rib(folder, "umbrella_damped.toml", {**base, "joint.dissipation_law": name}))
                 for name in ("hunt_crossley", "twin"))
    assert own["contacts"] > 0
    assert own == twin
    other = told(rib(folder, "umbrella_damped.toml", {**base, "joint.dissipation_law": "flores"}))
    assert other["columns"] != own["columns"]


def test_new_laws_in_a_case(folder: Path) -> None:
    """The case has a user's normal and friction laws: contact occurs, and the energy account closes."""
    found = told(rib(folder, "umbrella_damped.toml", {"joint.friction_law": "smooth", "joint.normal_law": "hertz_internal"}))
    lost = np.array(found["columns"]["friction_dissipation_J"])[-1]
    assert found["contacts"] > 0 and lost > 0
    plain = told(rib(folder, "umbrella_damped.toml", {"joint.friction_law": "none"}))
    assert plain["columns"]["theta2_rad"] != found["columns"]["theta2_rad"]


def test_traits_decide_what_a_case_may_ask(folder: Path, tmp_path: Path) -> None:
    """The adaptive method accepts laws without memory. A law that creeps under load cannot hold a loaded start."""
    assert told(rib(folder, "umbrella_damped.toml", {
        "joint.friction_law": "smooth", "reduced.method": "adaptive"}))["contacts"] > 0
    text = (REPOSITORY / "cases" / "umbrella_hold.toml").read_text()
    path = tmp_path / "creeping.toml"
    path.write_text(text.replace('friction_law = "mindlin"', 'friction_law = "smooth"'))
    done = ended([BUILT.parent / "bin" / "statejump", "--json", "reduced", path], STATEJUMP_LAWS=str(folder))
    assert done.returncode == 2
    assert failure("friction_without_static_load") == done.stderr


def test_listed(folder: Path, tmp_path: Path) -> None:
    done = ended([BUILT.parent / "bin" / "statejump", "laws", "--results", tmp_path], STATEJUMP_LAWS=str(folder))
    assert done.returncode == 0, done.stderr
    for name in ("cubic", "smooth", "twin"):
        assert f"│ {name} " in done.stdout
    assert ">cubic<" in (tmp_path / "laws" / "laws.svg").read_text() or "cubic" in (
        tmp_path / "laws" / "laws.svg").read_text()


def test_same_number_in_yade(yade: str, folder: Path) -> None:
    """Force of a user's cubic law: by the kernel in the engine, by the kernel in the plugin, and by hand."""
    script = Path(__file__).resolve().parents[1] / "yade" / "scripts" / "user_law.py"
    done = ended([yade, "-n", "-x", script], STATEJUMP_LAWS=str(folder),
                 PYTHONPATH=os.pathsep.join([str(BUILT), str(script.parent)]))
    match = re.search(r"RESULT (\{.*)", done.stdout)
    assert match, done.stdout + done.stderr
    seen = json.loads(match[1])
    listed = ended([sys.executable, "-c", (
        "import sys, json, numpy as np\nfrom statejump import _engine\n"
        "d, r1, r2, length, modulus = json.loads(sys.argv[1])\n"
        "found = _engine.normal_force('cubic', np.array([d]), r1, r2, length, modulus)\n"
        "print(json.dumps([found[key][0] for key in ('force_N', 'stiffness_N_per_m')]))"),
        json.dumps([seen["depth"], *seen["radii"], seen["length"], seen["modulus"]])], STATEJUMP_LAWS=str(folder))
    assert json.loads(listed.stdout) == [seen["force"], seen["kn"]], listed.stderr
    assert seen["force"] == pytest.approx(seen["modulus"] / seen["radii"][0] * seen["depth"] ** 3, rel=1e-14)
    # The copy also equals the original through an impact, bit for bit.
    assert seen["impact"]["twin"] == seen["impact"]["hunt_crossley"] != seen["impact"]["flores"]
    assert "cubic" in seen["doc"] and "F = E*/R1 delta^3" in seen["doc"]


# An environment variable selects the wrong answer at run time, so that the law is compiled once.
WRONG = '''#include <cmath>
#include <cstdlib>
#include <string>
#include "statejump/kernel/laws/normal.hpp"
using namespace statejump::kernel::laws;
struct UserLaw {
  static constexpr LawInfo info{"wrong", "F", "the tests", "any", Trait::holds_static_load, {}};
  static double largest_depth(const NormalGeometry&) { return 1.0; }
  NormalState operator()(double depth, const NormalGeometry&, const NormalMaterial&) const {
    if (depth <= 0.0) return {0.0, 0.0, 0.0, 0.0};
    const char* const asked = std::getenv("WRONG_ANSWER");
    const std::string answer = asked ? asked : "";
    if (answer == "throws") throw std::runtime_error("no idea");
    if (answer == "throws_a_number") throw 42;
    return {answer == "pulls" ? -1.0 : std::nan(""), 1.0, 0.0, 0.0};
  }
};
'''


@pytest.fixture(scope="module")
def wrong_law(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A compiled law with wrong answers, in a separate folder."""
    made = tmp_path_factory.mktemp("wrong")
    header = made / "wrong.hpp"
    header.write_text(WRONG)
    return build.build(header, made)


@pytest.mark.parametrize("answer, complaint", [
    ("no_number", "returned force = nan"),
    ("pulls", "returned force = -1"),
    ("throws", "no idea"),
    ("throws_a_number", "an exception that is no std::exception"),
])
def test_wrong_answers_name_law_joint_and_time(yade: str, monkeypatch: pytest.MonkeyPatch, wrong_law: Path, answer: str,
                                               complaint: str) -> None:
    monkeypatch.setenv("WRONG_ANSWER", answer)
    done = rib(wrong_law.parent, "umbrella_damped.toml", {"joint.normal_law": "wrong"})
    last = done.stderr.strip().splitlines()[-1]
    assert done.returncode == 1 and f"wrong ({wrong_law}): {complaint}" in last
    assert re.search(r"t = [\d.e-]+ s", last), last
    script = Path(__file__).resolve().parents[1] / "yade" / "scripts" / "user_law.py"
    done = ended([yade, "-n", "-x", script, "wrong"], STATEJUMP_LAWS=str(wrong_law.parent),
                 PYTHONPATH=os.pathsep.join([str(BUILT), str(script.parent)]))
    assert f"wrong ({wrong_law}): {complaint} (" in done.stdout, done.stderr


def mistake(statejump, *arguments: object, **environment: str) -> dict[str, Any]:
    outcome = statejump("--json", "laws", "build", *arguments, XDG_DATA_HOME="/nonexistent", **environment)
    assert outcome.status == 2 and outcome.output == "" and outcome.errors.count("\n") == 1, outcome.errors
    return outcome.failure


def test_mistakes_of_a_header(statejump, tmp_path: Path) -> None:
    missing, wrong, none, kind = (tmp_path / f"{name}.hpp" for name in ("missing", "wrong", "none", "kind"))
    assert mistake(statejump, missing) == failure("header_file_missing", file="missing.hpp")
    text = (TOYS / "twin.hpp").read_text()
    wrong.write_text(text.replace("return 1.5", "return one_and_a_half"))
    found = mistake(statejump, wrong, "--folder", tmp_path / "laws")
    assert found == failure("law_does_not_compile", header="wrong.hpp")
    assert re.match(r"wrong\.hpp:16:\d+: error: 'one_and_a_half'", found["cause"]), found
    none.write_text(text.replace("using UserLaw = Twin;", ""))
    assert mistake(statejump, none, "--folder", tmp_path / "laws") == failure("law_does_not_compile", header="none.hpp")
    kind.write_text(text.replace("double operator()", "double other"))
    found = mistake(statejump, kind, "--folder", tmp_path / "laws")
    assert found == failure("law_does_not_compile", header="kind.hpp") and "no kind" in found["cause"]
    taken = tmp_path / "taken.hpp"
    taken.write_text(text.replace('"twin"', '"flores"'))
    found = mistake(statejump, taken, "--folder", tmp_path / "laws")
    assert found == failure("bad_law", file="taken.hpp") and found["message"].endswith(f" {taken}")
    assert list((tmp_path / "laws").iterdir()) == []


def test_no_compiler(statejump, tmp_path: Path) -> None:
    found = mistake(statejump, TOYS / "twin.hpp", "--folder", tmp_path, CXX="no-such-compiler")
    assert found == failure("compiler_not_run", compiler="no-such-compiler")


def test_hash_is_that_of_the_build(tmp_path: Path) -> None:
    include = REPOSITORY / "contact_laws" / "kernel" / "include"
    assert build.kernel_hash(include) == _engine.kernel_hash()
    copy = tmp_path / "include"
    shutil.copytree(include, copy)
    with (copy / "statejump" / "kernel" / "hertz.hpp").open("a") as stream:
        stream.write("\n")
    assert build.kernel_hash(copy) != _engine.kernel_hash()


def test_other_kernel_and_two_of_one_name(folder: Path, tmp_path: Path, statejump, cases: Path) -> None:
    """A case that uses an unusable law is refused with the reason. Cases with other laws run."""
    old = tmp_path / "old"
    old.mkdir()
    made = build.compile_law(build.find_compiler(), TOYS / "smooth.hpp", "0" * 64, old)
    stale = made.replace(old / "friction_smooth.so")
    twice = f"{folder}{os.pathsep}{old}"
    case = tmp_path / "case.toml"
    text = (cases / "umbrella_damped.toml").read_text()
    assert 'friction_law = "mindlin"' in text
    case.write_text(text.replace('friction_law = "mindlin"', 'friction_law = "smooth"'))
    environment = {"XDG_DATA_HOME": "/nonexistent"}
    for laws, named in ((str(old), [stale]), (twice, [folder / "friction_smooth.so", stale])):
        outcome = statejump("--json", "reduced", case, STATEJUMP_LAWS=laws, **environment)
        assert (outcome.status, outcome.failure) == (2, failure("bad_law", key="joint.friction_law", value="smooth"))
        reason = outcome.failure["cause"]
        assert re.findall(r"\S+\.so", reason) == [str(one) for one in named] and "\n" not in reason
        assert ("'statejump laws build'" in reason) == (laws != twice)
        outcome = statejump("laws", STATEJUMP_LAWS=laws, **environment)
        assert outcome.status == 2 and outcome.errors.startswith("error: ") and outcome.errors.endswith(f"{reason}\n")
        outcome = statejump("reduced", cases / "umbrella_damped.toml", STATEJUMP_LAWS=laws, **environment)
        assert outcome.status == 0, outcome.errors


def test_object_that_is_no_law(statejump, tmp_path: Path) -> None:
    (tmp_path / "other.so").write_text("no object")
    outcome = statejump("--json", "laws", STATEJUMP_LAWS=str(tmp_path), XDG_DATA_HOME="/nonexistent")
    assert (outcome.status, outcome.failure) == (2, failure("bad_law"))
    assert outcome.failure["message"].startswith(f"{tmp_path / 'other.so'} ")


def test_own_folder(statejump, tmp_path: Path) -> None:
    """Without --folder the law is written to the folder that every program searches by default."""
    environment = {"XDG_DATA_HOME": str(tmp_path / "data"), "STATEJUMP_LAWS": ""}
    outcome = statejump("laws", "build", TOYS / "twin.hpp", **environment)
    target = tmp_path / "data" / "statejump" / "laws" / "dissipation_twin.so"
    assert (outcome.status, outcome.errors) == (0, "") and target.is_file()
    assert "│ twin " in statejump("laws", **environment).output
