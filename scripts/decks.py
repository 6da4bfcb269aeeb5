#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Imports and runs all decks of a folder and writes one table.

    PYTHONPATH=build/python scripts/decks.py FOLDER [-o TABLE.md] [--beams-as-bars] [--ignore CARD ...] [--circ radius]

The table has a row for each deck of Nastran, CalculiX or Abaqus: units, whether it was imported and run, cause of a
failure, largest displacement [m]. A deck of modes, or with neither supports nor loads, runs as modes: its row has
frequencies. If ``ccx`` is installed, rows of CalculiX decks also have the largest difference of displacements between
both programs, over the largest displacement. This comparison is linear: loads are multiplied by a small factor, and
*STEP, NLGEOM is removed for CalculiX. Decks with beams are compared with a Poisson's ratio of 0, and
B31 and B32 as B32R.
``--temperature-change`` sets ΔT for decks without temperatures. Every deck runs in a separate process. Exit status 1:
an import or a run ended with neither a result nor a message.
"""
from __future__ import annotations

import argparse
import contextlib
import json
import os
import subprocess
import sys
import traceback
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import decks_ccx
import numpy as np

if TYPE_CHECKING:
    from statejump.kinds.truss.importing.model import Deck

SUFFIXES = (".inp", ".bdf", ".nas", ".dat")
HEADER = ("deck", "units", "imported", "ran", "why not", "largest displacement [m]", "difference to ccx")
# Factor on loads. Strains are below 1e-2, so nonlinear parts are below 1e-7 of the displacement, the precision of ccx.
SMALL = 1e-5
# The first factor with which the solver converges is used: small loads vanish in rounding of rotations.
SMALL_OF_BEAMS = (1e-3, 1e-2, 1e-1, 1.0)
FAULT = "fault"


@dataclass
class Row:
    """Result of a deck; a cause is a sentence."""

    deck: str
    units: str = ""
    imported: bool = False
    ran: bool = False
    cause: str = ""
    largest_m: float | None = None
    difference: str = ""
    fault: bool = False

    def cells(self) -> tuple[str, ...]:
        """Return the cells of the table."""
        largest = "" if self.largest_m is None else f"{self.largest_m:.6g}"
        return (self.deck, self.units, *("yes" if one else "no" for one in (self.imported, self.ran)),
                self.cause.replace("|", "\\|"), largest, self.difference)


def one(path: Path, name: str, options: argparse.Namespace) -> Row:
    """Import and run a deck in this process."""
    import statejump as sj
    from statejump.core.errors import StatejumpError
    from statejump.kinds.truss.importing import SYSTEMS, Options, case_document, read
    from statejump.kinds.truss.importing.reading import form_of

    row = Row(name)
    try:
        deck = read(path, None, None, Options(frozenset(word.upper().lstrip("*") for word in options.ignore),
                                              options.beams_as_bars, options.step, options.circ))
        documents = {units: case_document(deck, "deck", units=SYSTEMS[units], check_ignored=False,
                                          temperature_change_K=options.temperature_change)
                     for units in ([options.units] if options.units else SYSTEMS)}
        row.units, made, case, without_support = _plausible(documents)
        row.imported = True
        if without_support:
            row.cause = str(without_support)
            return row
        if deck.modal or case.truss.free:  # type: ignore[attr-defined]
            frequencies = sj.modes(case, 8).frequency_Hz  # type: ignore[arg-type]
            row.cause = "modes [Hz]: " + ", ".join(f"{one:.6g}" for one in frequencies)
            row.ran = True
            return row
        row.largest_m = float(np.abs(_displacements(case.reduced())).max())  # type: ignore[attr-defined]
        row.ran = True
        if path.suffix == ".inp" and form_of(path) == "abaqus" and decks_ccx.installed():
            row.difference = _difference(path, deck, made, SYSTEMS[row.units].length_m)
    except StatejumpError as refused:
        row.cause = str(refused).replace(str(path), path.name)
    except Exception as fault:  # what the table is made to find
        row.fault = True
        row.cause = f"{FAULT}: {type(fault).__name__}: {fault}; {traceback.extract_tb(fault.__traceback__)[-1]}"
    return row


def _plausible(documents: dict[str, dict]) -> tuple[str, dict, object, object]:
    """Return units, document, case and failure of a deck. A deck does not state its units: of the unit systems that
    give a case, the one with the fewest implausible numbers is chosen."""
    import statejump as sj
    from statejump.core.errors import StatejumpError
    from statejump.kinds.truss.importing import checked, hints

    first: StatejumpError | None = None
    for units in sorted(documents, key=lambda units: len(hints(documents[units]))):
        try:
            case, without_support = checked(documents[units], sj.load)
        except StatejumpError as refused:
            first = first or refused
            continue
        return units, documents[units], case, without_support
    assert first is not None
    raise first


def _difference(path: Path, deck: Deck, made: dict, length_m: float) -> str:
    """Return the relative difference to CalculiX's displacements, or the reason why they cannot be compared."""
    from statejump.core.errors import StatejumpError

    # Temperature-dependent coefficients are not linear.
    factors = (1.0,) if "expansion" in made else SMALL_OF_BEAMS if "beam" in made else (SMALL,)
    small = None
    for factor in factors:
        with contextlib.suppress(StatejumpError):  # the run has the stiffness of stressed bars
            small = _small(made, factor)
            break
    if small is None:
        return "no linear solution: only stress makes it stiff"
    names = {node: f"N{node}" if node.isdecimal() else node for node in deck.nodes}
    return decks_ccx.difference(path, deck.step, {node: moved / length_m for node, moved in small.items()}, names)


def _displacements(run: object) -> np.ndarray:
    """Return the displacements (nodes, axes) at the largest temperature change."""
    history = run.history  # type: ignore[attr-defined]
    at = int(np.argmax(np.abs(history["temperature_change_K"].values)))
    return np.asarray(history["displacement_m"].values[at])


def _small(made: dict, factor: float) -> dict[str, np.ndarray]:
    """Return the displacements by node for loads times a factor, divided by this factor."""
    import statejump as sj

    small = json.loads(json.dumps(made))
    for beam in small.get("beam", ()):  # as decks_ccx.without_poisson
        beam["shear_modulus_Pa"] = beam["young_modulus_Pa"] / 2
    for node in small["node"]:
        for key in {"force_N", "moment_N_m"} & node.keys():
            node[key] = [part * factor for part in node[key]]
    if "gravity_m_per_s2" in small["truss"]:
        small["truss"]["gravity_m_per_s2"] = [part * factor for part in small["truss"]["gravity_m_per_s2"]]
    small["thermal"]["temperature_change_max_K"] *= factor
    run = sj.load(small).reduced()
    found = _displacements(run) / factor
    return {node["name"]: np.append(found[at], [0.0] * (3 - found.shape[1])) for at, node in enumerate(small["node"])}


def in_process(path: Path, folder: Path, arguments: Sequence[str], seconds: float) -> Row:
    """Import and run a deck in a separate process, because the run may crash."""
    name = str(path.relative_to(folder))
    command = [sys.executable, __file__, str(folder), "--one", str(path), *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=seconds,
                              env={**os.environ, "OMP_NUM_THREADS": "1"})
    except subprocess.TimeoutExpired:
        return Row(name, cause=f"{FAULT}: not done after {seconds:g} s", fault=True)
    lines = done.stdout.splitlines()
    if done.returncode or not lines:
        return Row(name, cause=f"{FAULT}: exit status {done.returncode}: {done.stderr.strip()[-200:]}", fault=True)
    return Row(**json.loads(lines[-1]))


def arguments_of(options: argparse.Namespace) -> list[str]:
    """Return the options for a deck as command-line arguments."""
    words = ["--temperature-change", str(options.temperature_change)]
    words += ["--beams-as-bars"] if options.beams_as_bars else []
    words += ["--step", str(options.step)] if options.step else []
    words += ["--circ", options.circ] if options.circ else []
    words += ["--units", options.units] if options.units else []
    return words + [word for name in options.ignore for word in ("--ignore", name)]


def main() -> int:
    """Run the command."""
    from statejump.kinds.truss.importing import SYSTEMS

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("-o", "--output", type=Path, help="Markdown table; none: standard output")
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--seconds", type=float, default=300.0, help="of a deck, at most")
    parser.add_argument("--beams-as-bars", action="store_true")
    parser.add_argument("--temperature-change", type=float, default=0.0)
    parser.add_argument("--circ", choices=("radius", "diameter"))
    parser.add_argument("--step", type=int)
    parser.add_argument("--units", choices=tuple(SYSTEMS), help="none: the most plausible ones")
    parser.add_argument("--ignore", action="append", default=[])
    parser.add_argument("--one", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        print(json.dumps(asdict(one(options.one, str(options.one.relative_to(options.folder)), options))))
        return 0
    found = sorted(path for path in options.folder.rglob("*") if path.suffix.lower() in SUFFIXES)
    words = arguments_of(options)
    with ThreadPoolExecutor(options.jobs) as pool:
        rows = list(pool.map(lambda path: in_process(path, options.folder, words, options.seconds), found))
    lines = [f"| {' | '.join(cells)} |" for cells in (HEADER, ["---"] * len(HEADER), *(row.cells() for row in rows))]
    lines += ["", f"{len(rows)} decks, {sum(row.imported for row in rows)} imported, "
              f"{sum(row.ran for row in rows)} ran, {sum(row.fault for row in rows)} faults"]
    text = "\n".join(lines) + "\n"
    if options.output:
        options.output.write_text(text, encoding="utf-8")
        print(lines[-1])
    else:
        print(text, end="")
    return int(any(row.fault for row in rows))


if __name__ == "__main__":
    sys.exit(main())
