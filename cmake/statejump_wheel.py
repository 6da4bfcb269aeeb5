# SPDX-License-Identifier: GPL-3.0-or-later
"""Build backend (PEP 517) of ``pip install .``: makes a wheel of the reduced models, without YADE.

CMake compiles and installs into a folder; this file packs the folder. CMake's own variables choose generator, compiler
and flags: CMAKE_GENERATOR, CXX, CXXFLAGS, CMAKE_PREFIX_PATH, CMAKE_BUILD_PARALLEL_LEVEL.
"""
from __future__ import annotations

import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import zipfile
from collections.abc import Mapping
from pathlib import Path
from shutil import which
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
Settings = Mapping[str, Any] | None
# The first pybind11 that knows each Python.
PYBIND11 = {11: (2, 10), 12: (2, 11), 13: (2, 13), 14: (3, 0)}


def project() -> dict[str, Any]:
    """Return the table ``[project]`` of pyproject.toml with the version of CMakeLists.txt."""
    found: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    version = re.search(r"project\(statejump VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))
    assert version is not None
    return {**found, "version": version[1]}


def _has_pybind11() -> bool:
    """Return whether CMake finds a new enough pybind11 without pip: in this Python's prefix, or in the system."""
    needed = PYBIND11.get(sys.version_info[1], PYBIND11[max(PYBIND11)])
    for header in (Path(prefix, "include/pybind11/detail/common.h") for prefix in (sys.prefix, "/usr/local", "/usr")):
        if header.is_file():
            text = header.read_text(encoding="utf-8")
            found = dict(re.findall(r"define PYBIND11_VERSION_(MAJOR|MINOR) +([0-9]+)", text))
            return (int(found["MAJOR"]), int(found["MINOR"])) >= needed
    return False


def get_requires_for_build_wheel(config_settings: Settings = None) -> list[str]:
    """Return the build tools that pip has to fetch, because they are not installed on this machine."""
    tools = {"cmake>=3.25": which("cmake"), "ninja": which("ninja"), "pybind11>=2.13": _has_pybind11()}
    return [name for name, there in tools.items() if not there]


def configure(build: Path) -> None:
    """Configure a build tree for the Python that runs this."""
    options = {"STATEJUMP_WHEEL": "ON", "STATEJUMP_BUILD_TESTS": "OFF", "STATEJUMP_PYTHON": sys.executable,
               "CMAKE_INSTALL_DATADIR": "statejump/share", "CMAKE_INSTALL_INCLUDEDIR": "statejump/share/include"}
    given = [f"-D{key}={value}" for key, value in options.items()]
    subprocess.run(["cmake", "--preset", "reduced", "-B", build, *given], cwd=ROOT, check=True)


def _tag() -> str:
    version = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    return f"{version}-{version}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _about() -> dict[str, str]:
    """Return the files of the folder dist-info but RECORD."""
    about = project()
    metadata = ["Metadata-Version: 2.1", f"Name: {about['name']}", f"Version: {about['version']}",
                f"Summary: {about['description']}", f"Requires-Python: {about['requires-python']}",
                *(f"Requires-Dist: {name}" for name in about["dependencies"])]
    wheel = ["Wheel-Version: 1.0", "Generator: statejump", "Root-Is-Purelib: false", f"Tag: {_tag()}"]
    scripts = ["[console_scripts]", *(f"{name} = {place}" for name, place in about["scripts"].items())]
    texts = {"METADATA": metadata, "WHEEL": wheel, "entry_points.txt": scripts}
    return {name: "\n".join(lines) + "\n" for name, lines in texts.items()} | {
        "LICENSE": (ROOT / "LICENSE").read_text(encoding="utf-8")}


def pack(build: Path, folder: Path) -> str:
    """Pack a compiled tree as a wheel into the folder; return the file name of the wheel."""
    about = project()
    stem = f"{about['name']}-{about['version']}"
    name = f"{stem}-{_tag()}.whl"
    with tempfile.TemporaryDirectory() as staged, zipfile.ZipFile(folder / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        subprocess.run(["cmake", "--install", build, "--prefix", staged, "--strip"],
                       stdout=subprocess.DEVNULL, check=True)
        information = Path(staged, f"{stem}.dist-info")
        information.mkdir()
        for title, text in _about().items():
            (information / title).write_text(text, encoding="utf-8")
        record = []
        for path in sorted(path for path in Path(staged).rglob("*") if path.is_file()):
            content, place = path.read_bytes(), path.relative_to(staged).as_posix()
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{place},sha256={digest},{len(content)}\n")
            wheel.write(path, place)
        record.append(f"{stem}.dist-info/RECORD,,\n")
        wheel.writestr(f"{stem}.dist-info/RECORD", "".join(record))
    return name


def build_wheel(wheel_directory: str, config_settings: Settings = None, metadata_directory: str | None = None) -> str:
    """Compile what has changed since the last time, and pack it."""
    build = ROOT / f"build-wheel-{_tag()}"
    configure(build)
    jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL") or str(os.cpu_count() or 1)
    subprocess.run(["cmake", "--build", build, "--target", "statejump_engine_python",
                    "statejump_engine_more", "--parallel", jobs], check=True)
    return pack(build, Path(wheel_directory))


class UnsupportedOperation(Exception):
    """Exception that PEP 517 prescribes for a backend that makes no source distribution."""


def build_sdist(sdist_directory: str, config_settings: Settings = None) -> str:
    """Refuse: the sources are the repository."""
    raise UnsupportedOperation("statejump: no source distribution; install from a clone of the repository")
