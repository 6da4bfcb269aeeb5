# SPDX-License-Identifier: GPL-3.0-or-later
"""Behaviour of the build for a YADE with unknown build identifiers."""
from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
FOLDER = os.environ["STATEJUMP_YADE_LIBRARY_DIR"]
VARIANT = os.environ["STATEJUMP_YADE_VARIANT"]


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A CMake project that uses this repository's detection of YADE, with a table that lacks the installed YADE."""
    shutil.copytree(REPOSITORY / "contact_laws" / "yade_abi", tmp_path / "contact_laws" / "yade_abi")
    shutil.copytree(REPOSITORY / "scripts", tmp_path / "scripts")
    shutil.copytree(REPOSITORY / "cmake", tmp_path / "cmake")
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.25)\nproject(recognise LANGUAGES CXX)\n"
        "include(${CMAKE_SOURCE_DIR}/cmake/YadeBinary.cmake)\n"
    )
    table = tmp_path / "contact_laws" / "yade_abi" / "known_binaries.csv"
    notes = subprocess.run(["readelf", "-n", f"{FOLDER}/libyade.so"], capture_output=True, text=True, check=True).stdout
    identifier = notes.split("Build ID: ")[1].split()[0]
    assert identifier in table.read_text()
    table.write_text(table.read_text().replace(identifier, "0" * 40))
    return tmp_path


def configure(project: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Run CMake."""
    return subprocess.run(["cmake", "-S", project, "-B", project / "build", f"-DYADE_LIBRARY_DIR={FOLDER}", *options],
                          capture_output=True, text=True, check=False)


def test_unknown_build_identifiers_stop_the_build_and_name_the_command(project: Path):
    done = configure(project)
    said = " ".join(done.stderr.split())
    assert done.returncode != 0
    assert f"scripts/measure_yade {FOLDER}" in said and "-DSTATEJUMP_MEASURE_YADE=ON" in said


def test_a_measured_interface_is_accepted_on_request(project: Path):
    done = configure(project, "-DSTATEJUMP_MEASURE_YADE=ON")
    assert done.returncode == 0, done.stderr
    assert f"interface variant {VARIANT}" in done.stdout
    table = (project / "build" / "yade_abi" / "statejump" / "yade_abi" / "known_binaries.inc").read_text()
    rows = [line for line in table.splitlines() if line.startswith("    {")]
    assert f"built_for_row = {len(rows) - 1};" in table
    assert "this machine" in rows[-1]


def test_another_interface_is_refused_on_request_too(project: Path):
    for path in (project / "contact_laws" / "yade_abi" / "variants").glob("*_members.csv"):
        assert "State,vel,144," in path.read_text()
        path.write_text(path.read_text().replace("State,vel,144,", "State,vel,152,"))
    done = configure(project, "-DSTATEJUMP_MEASURE_YADE=ON")
    assert done.returncode != 0
    said = " ".join(done.stderr.split())
    assert f"scripts/measure_yade {FOLDER}" in said and "-DSTATEJUMP_MEASURE_YADE" not in said


def test_missing_yade_is_one_sentence(project: Path):
    done = configure(project, f"-DYADE_LIBRARY_DIR={project}/nowhere")
    assert done.returncode != 0
    assert "YADE is missing" in done.stderr
