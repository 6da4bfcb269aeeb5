# SPDX-License-Identifier: GPL-3.0-or-later
"""A build without YADE: the commands that it refuses, and the wheel that pip makes of it."""
from __future__ import annotations

import base64
import csv
import hashlib
import importlib.metadata
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

import statejump as sj
from conftest import BUILT, REPOSITORY, Outcome
from failures import failing, failure
from statejump import _paths

sys.path.insert(0, str(REPOSITORY / "cmake"))
import statejump_wheel  # noqa: E402


@pytest.fixture(autouse=True)
def skipped_without_yade(monkeypatch: pytest.MonkeyPatch) -> None:
    """Override the fixture that skips tests without YADE; these tests need no YADE."""
    monkeypatch.setattr(_paths, "YADE", "")


@pytest.mark.parametrize("command", ["dem", "compare"])
@pytest.mark.parametrize("case", ["table1", "umbrella_damped", "ring_12"])
def test_models_with_yade_are_refused(
    statejump: Callable[..., Outcome], monkeypatch: pytest.MonkeyPatch, command: str, case: str
) -> None:
    # Not even the reduced model of compare runs before.
    monkeypatch.setattr("statejump.kinds.running.run", lambda *given, **options: pytest.fail("a model ran"))
    done = statejump(command, case)
    assert (done.status, done.failure) == (2, failure("built_without_yade"))


def test_the_dem_of_a_case_in_python_is_refused() -> None:
    with failing("built_without_yade"):
        sj.load("ring_12").dem()


def test_the_reduced_model_needs_no_yade(statejump: Callable[..., Outcome]) -> None:
    assert statejump("reduced", "table1").status == 0


def test_pip_brings_what_debian_brings() -> None:
    """The dependencies of the wheel are the packages of the Debian group "run", except YADE."""
    debian = {name.removeprefix("python3-") for name in (REPOSITORY / "scripts/packages/run.txt").read_text().split()}
    pip = {re.split("[<>=~! ]", entry)[0] for entry in statejump_wheel.project()["dependencies"]}
    names = {"attrs": "attr", "vtk": "vtk9"}
    assert {names.get(name, name) for name in pip} == debian - {"yade"}


def test_tools_that_are_there_are_not_fetched(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(statejump_wheel, "which", lambda name: "/usr/bin/" + name)
    monkeypatch.setattr(statejump_wheel, "PYBIND11", {0: (0, 0)})
    monkeypatch.setattr(statejump_wheel.sys, "prefix", str(tmp_path))
    header = tmp_path / "include" / "pybind11" / "detail" / "common.h"
    header.parent.mkdir(parents=True)
    header.write_text("#define PYBIND11_VERSION_MAJOR 2\n#define PYBIND11_VERSION_MINOR 10\n")
    assert statejump_wheel.get_requires_for_build_wheel() == []
    monkeypatch.setattr(statejump_wheel, "which", lambda name: None)
    assert statejump_wheel.get_requires_for_build_wheel() == ["cmake>=3.25", "ninja"]
    monkeypatch.setattr(statejump_wheel, "PYBIND11", {0: (2, 11)})  # this one does not know this Python
    assert statejump_wheel.get_requires_for_build_wheel() == ["cmake>=3.25", "ninja", "pybind11>=2.13"]


@pytest.mark.parametrize("python, sentence", [
    ("/nowhere/python3", "STATEJUMP_PYTHON=/nowhere/python3 "),
    ("{folder}/old", "{folder}/old is Python 3.10.9, ")])
def test_an_unfit_python_is_refused_by_name(tmp_path: Path, python: str, sentence: str) -> None:
    """The build's check of the version, in a separate CMake project with a Python that reports an old version."""
    old = tmp_path / "old"
    old.write_text("#!/bin/sh\n")
    old.chmod(0o755)
    (tmp_path / "FindPython3.cmake").write_text("set(Python3_VERSION 3.10.9)\n")
    (tmp_path / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.25)\nproject(check LANGUAGES NONE)\nset(CMAKE_MODULE_PATH {tmp_path})\n"
        f"include({REPOSITORY}/cmake/Interpreter.cmake)\n")
    done = subprocess.run(["cmake", "-S", tmp_path, "-B", tmp_path / "build",
                           f"-DSTATEJUMP_PYTHON={python.format(folder=tmp_path)}"], capture_output=True, text=True)
    assert done.returncode != 0 and sentence.format(folder=tmp_path) in " ".join(done.stderr.split()), done.stderr


def test_the_back_end_is_that_of_the_project() -> None:
    system = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())["build-system"]
    assert system == {"requires": [], "build-backend": statejump_wheel.__name__, "backend-path": ["cmake"]}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of this build's engine, configured as by pip but without a new compilation."""
    build, folder = tmp_path_factory.mktemp("build"), tmp_path_factory.mktemp("wheel")
    statejump_wheel.configure(build)
    for module in (BUILT / "statejump").glob("_engine*.so"):
        shutil.copy(module, build / "python" / "statejump")
    return folder / statejump_wheel.pack(build, folder)


def test_wheel_lists_what_it_holds(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        about = "statejump-1.0.0.dist-info"
        rows = list(csv.reader(archive.read(f"{about}/RECORD").decode().splitlines()))
        assert [row[0] for row in rows] == archive.namelist()
        for name, digest, length in rows[:-1]:
            content = archive.read(name)
            encoded = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
            assert (digest, int(length)) == (f"sha256={encoded}", len(content)), name
        assert {name.split("/")[0] for name in archive.namelist()} == {"statejump", about}
    found = importlib.metadata.PathDistribution(zipfile.Path(wheel) / about)  # type: ignore[arg-type]
    assert (found.metadata["Name"], found.version) == ("statejump", "1.0.0")
    assert found.requires and [entry.value for entry in found.entry_points] == ["statejump.cli.main:main"]


def test_wheel_runs_anywhere(wheel: Path, tmp_path: Path) -> None:
    """Without the repository: cases, schemas and kernel headers are inside."""
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "site")
    program = ("import json, statejump as sj\nfrom statejump import _paths, __file__ as place\n"
               "jump = sj.load('cases/table1.toml').reduced().summary['state_jump_m']\n"
               "assert (_paths.KERNEL_INCLUDE / 'statejump/kernel/contact_law.hpp').is_file()\n"
               "assert (_paths.SCHEMA / 'case.schema.json').is_file()\n"
               "print(json.dumps([place, jump, _paths.YADE]))\n")
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=False,
                          env={**os.environ, "PYTHONPATH": str(tmp_path / "site")})
    assert done.returncode == 0, done.stderr
    place, jump, yade = json.loads(done.stdout)
    assert Path(place).parent == tmp_path / "site" / "statejump" and not yade
    assert jump == sj.load("table1").reduced().summary["state_jump_m"]
