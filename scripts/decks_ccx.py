# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a CalculiX deck as a linear analysis and compares its displacements with this project's."""
from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

ROW = re.compile(r"\s*(\d+)\s+([-+.\dEe]+)\s+([-+.\dEe]+)\s+([-+.\dEe]+)\s*$")
OUTPUT = re.compile(r"\*((NODE|EL|ELEMENT|CONTACT|SECTION|MODAL|ENERGY)\s*(PRINT|FILE|OUTPUT)|OUTPUT|RESTART)\b",
                    re.IGNORECASE)
BEAMS = re.compile(r"TYPE\s*=\s*B\d", re.IGNORECASE)
LINEAR = re.compile(r"TYPE\s*=\s*B31R?\b", re.IGNORECASE)
FULL = re.compile(r"(TYPE\s*=\s*B32)\b", re.IGNORECASE)
GENERATED = re.compile(r"^\s*\*(NGEN|NFILL|NCOPY|ELGEN|ELCOPY|INCLUDE|PART|NODAL\s*THICKNESS|NORMAL)\b",
                       re.IGNORECASE | re.MULTILINE)
SECONDS = 120
ROUNDING = 1e-10  # of displacements in ccx where nodes only rotate, in the unit of the deck


def installed() -> bool:
    """Whether there is CalculiX."""
    return shutil.which("ccx") is not None


def difference(path: Path, step: int, ours: Mapping[str, np.ndarray], names: Mapping[str, str]) -> str:
    """Return the largest difference between displacements over the largest displacement, or why it is missing.

    :param step: number of the step that was imported
    :param ours: displacements of this project by node name in the case
    :param names: node names in the case by node number in the deck
    """
    if not step:
        return "no static step"
    text = path.read_text(encoding="latin-1")
    with tempfile.TemporaryDirectory() as folder:
        for beside in path.parent.iterdir():
            if beside.is_file() and beside.suffix.lower() in (".inc", ".msh", ".nam", ".dat", ".inp"):
                shutil.copy(beside, folder)
        text = quadratic(without_poisson(text)) if BEAMS.search(text) else text
        (Path(folder) / "given.inp").write_text(printing(text, step, [int(name) for name in names if name.isdecimal()]))
        try:
            subprocess.run(["ccx", "-i", "given"], cwd=folder, capture_output=True, timeout=SECONDS,
                           env={"OMP_NUM_THREADS": "1", "PATH": "/usr/local/bin:/usr/bin:/bin"})
        except subprocess.TimeoutExpired:
            return f"ccx: not done after {SECONDS} s"
        theirs = printed(Path(folder) / "given.dat")
    common = [(ours[names[node]], value) for node, value in theirs.items() if names.get(node) in ours]
    if not common:
        return "ccx printed no displacement"
    largest = max(float(np.abs(value).max()) for _, value in common)
    if largest == 0 or largest < ROUNDING and not any(one.any() for one, _ in common):
        return "ccx: nothing moves"
    found = max(float(np.abs(one - value).max()) for one, value in common) / largest
    return f"{found:.2g}" + (" (ccx makes solids of beams)" if BEAMS.search(text) and found > 1e-6 else "")


def without_poisson(text: str) -> str:
    """Return the deck with a Poisson's ratio of 0. CalculiX makes solids of beams. Supports and few elements hinder
    their strains across the beam, so they are up to 1/(1 - ν²) as stiff."""
    made: list[str] = []
    elastic = False
    for line in text.splitlines():
        if line.lstrip().startswith("*"):
            elastic = bool(re.match(r"\s*\*ELASTIC\b", line, re.IGNORECASE))
        elif elastic and line.strip():
            words = line.split(",")
            line = ",".join([words[0], " 0.", *words[2:]])
        made.append(line)
    return "\n".join(made) + "\n"


def quadratic(text: str) -> str:
    """Return the deck with B32R in place of B31, B31R and B32: bending of one element is then exact. Strains of B31 are
    constant along the beam. B32 locks in shear: four elements of ten times their height are 21 % too stiff. In decks
    that generate nodes or elements, or have data of nodes of beams, B31 stays."""
    text = FULL.sub(r"\1R", text)
    if GENERATED.search(text):
        return text
    places: dict[int, list[float]] = {}
    made: list[str] = []
    middles: list[int] = []
    keyword, beams = "", False
    for line in text.splitlines():
        if line.lstrip().startswith("*"):
            keyword = line.strip().upper()
            beams = keyword.startswith("*ELEMENT") and bool(LINEAR.search(keyword))
            line = LINEAR.sub("TYPE=B32R", line) if beams else line
        elif re.match(r"\*NODE\s*(,|$)", keyword) and line.strip():
            number, *position = line.split(",")[:4]
            places[int(number)] = [float(part) if part.strip() else 0.0 for part in position]
        elif beams and line.strip():
            element, first, second = (int(part) for part in line.split(",")[:3])
            middle = max(places) + 1
            middles.append(middle)
            places[middle] = [(a + b) / 2 for a, b in zip(places[first], places[second])]
            line = f"{element}, {first}, {middle}, {second}"
        made.append(line)
    given = re.compile(r"\s*\*NODE\s*(,|$)", re.IGNORECASE)
    at = next((number for number, line in enumerate(made) if given.match(line)), 0)
    new = [f"{number}, {', '.join(map(repr, places[number]))}" for number in middles]
    return "\n".join([*made[:at], *(["*NODE", *new] if new else []), *made[at:]]) + "\n"


def printing(text: str, step: int, nodes: list[int]) -> str:
    """Return the deck without NLGEOM, ended after a given step, with that step's displacements as output."""
    made: list[str] = []
    number, skips = 0, False
    for line in text.splitlines():
        keyword = line.strip().upper()
        if keyword.startswith("*") and not keyword.startswith("**"):
            skips = bool(OUTPUT.match(keyword))
            if re.match(r"\*STEP\b", keyword):
                number += 1
                if number == 1:
                    made += ["*NSET, NSET=SJPRINTED", *(f"{node}," for node in sorted(nodes))]
                line = re.sub(r",\s*NLGEOM(\s*=\s*YES)?", "", line, flags=re.IGNORECASE)
            if re.match(r"\*END\s*STEP\b", keyword) and number == step:
                return "\n".join([*made, "*NODE PRINT, NSET=SJPRINTED", "U", "*END STEP"]) + "\n"
        if not skips:
            made.append(line)
    return "\n".join(made) + "\n"


def printed(path: Path) -> dict[str, np.ndarray]:
    """Return the displacements of the last increment by node number."""
    found: dict[str, np.ndarray] = {}
    reads = False
    for line in path.read_text().splitlines() if path.is_file() else ():
        if "displacements" in line:
            found, reads = {}, True
        elif row := ROW.match(line):
            if reads:
                found[row[1]] = np.array([float(part) for part in row.groups()[1:]])
        elif line.strip():
            reads = False
    return found
