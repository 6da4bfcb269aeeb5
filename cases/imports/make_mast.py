#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the example input files of the tutorial "From a deck to pointing error", as an engineer would bring them.

        /usr/bin/python3 cases/imports/make_mast.py       writes the files beside this program

mast.bdf           Nastran bulk data of a mast of 100 bars and 33 nodes, ten bays with a triangle as cross-section. The
                   face of longerons 1 and 2 carries a flat array antenna. It alone has crossed diagonals, in seven
                   bays: each of them holds one bar more than it needs.
mast_members.csv   what ``statejump orbit`` takes of every bar
longeron_loop.csv  loop of force over displacement of a longeron with its latch, pulled and pushed end to end on a rig:
                   two and a half cycles, noise of the load cell. The latch is known: it is LATCH below.
"""
from __future__ import annotations

import csv
from itertools import product
from math import cos, pi, sin, sqrt
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
BAYS, CROSSED, BAY_M, RADIUS_M = 10, 7, 0.6, 0.4
HARNESS_N = 2.0  # pulls the tip of longeron 1 towards the root
# Tube of carbon fibre, 20 x 1 mm; its expansion is that with metal ends.
AREA_M2, MODULUS_PA, POISSON, DENSITY = 5.97e-5, 1.2e11, 0.3, 1600.0
EXPANSION_PER_K, FREE_OF_STRESS_K = 5.0e-6, 293.15
# Black; heat capacity of wall and ends, some 1500 kg/m3 times 1 kJ/(kg K) times 1.6 mm.
ABSORPTIVITY, EMISSIVITY, HEAT_CAPACITY = 0.8, 0.8, 2430.0
SUN = np.array([0.48, -0.8, 0.36])  # of length 1, fixed to the mast
STIFFNESS_N_per_m = MODULUS_PA * AREA_M2 / BAY_M
LATCH = {"stiffness": STIFFNESS_N_per_m, "friction": 8.0, "clearance_minus": 2.0e-5, "clearance_plus": 2.5e-5}
NOISE_N, SEED = 1.0, 7


def corner(longeron: int, level: int) -> np.ndarray:
    """Return a node of longeron 1, 2 or 3 [m]."""
    angle = 2 * pi / 3 * (longeron - 1) - 5 * pi / 6  # 1 and 2 at one y
    return np.round([RADIUS_M * cos(angle), RADIUS_M * sin(angle), BAY_M * level], 9)


def name(longeron: int, level: int) -> int:
    """Return the number of a node on a longeron: 203 is longeron 2, level 3."""
    return 100 * longeron + level


def bars() -> dict[int, tuple[int, int]]:
    """Return the end nodes by element number: 1xx to 3xx longerons, 4xx battens, 5xx diagonals, 6xx crossing diagonals.
    """
    found = {}
    for level, longeron in product(range(BAYS + 1), (1, 2, 3)):
        following = longeron % 3 + 1
        found[400 + 3 * level + longeron] = (name(longeron, level), name(following, level))
        if level == BAYS:
            continue
        found[100 * longeron + level] = (name(longeron, level), name(longeron, level + 1))
        found[500 + 3 * level + longeron] = (name(longeron, level), name(following, level + 1))
        if longeron == 1 and level < CROSSED:
            found[600 + level] = (name(following, level), name(longeron, level + 1))
    return dict(sorted(found.items()))


def deck() -> str:
    """Return the deck, in free fields and SI units."""
    lines = ["$ mast of a flat array antenna, SI units", "SOL 101", "CEND", "SPC = 1", "LOAD = 2", "BEGIN BULK"]
    for longeron, level in product((1, 2, 3), range(BAYS + 1)):
        lines.append(f"GRID,{name(longeron, level)},," + ",".join(f"{value:.9g}" for value in corner(longeron, level)))
    lines += [f"CROD,{number},1,{first},{second}" for number, (first, second) in bars().items()]
    lines += [f"PROD,1,1,{AREA_M2:g}",
              f"MAT1,1,{MODULUS_PA:g},,{POISSON:g},{DENSITY:g},{EXPANSION_PER_K:g},{FREE_OF_STRESS_K:g}",
              "SPC1,1,123,100", "SPC1,1,23,200", "SPC1,1,3,300", f"FORCE,2,{name(1, BAYS)},0,{HARNESS_N},0.,0.,-1.",
              "PARAM,POST,-1", "ENDDATA"]
    return "\n".join(lines) + "\n"


def members() -> list[list[str | float]]:
    """Return the rows of mast_members.csv. The sunlit fraction of a round bar is sin(angle between bar and Sun)/pi."""
    rows: list[list[str | float]] = []
    for number, ends in bars().items():
        way = np.subtract(*(corner(*divmod(end, 100)) for end in ends))
        along = float(way @ SUN) / float(np.linalg.norm(way))
        rows.append([f"L{number}", ABSORPTIVITY, EMISSIVITY, round(sqrt(1 - along**2) / pi, 6), HEAT_CAPACITY])
    return rows


def loop() -> tuple[np.ndarray, np.ndarray]:
    """Return displacement [m] and force [N] of the latch: a spring k in series with a dry-friction slider between
    stops."""
    corners = np.array([0, 1, -1, 1, -1, 1]) * 3e-5
    path = np.interp(np.linspace(0, len(corners) - 1, 501), np.arange(len(corners)), corners)
    k, friction, slide, force = LATCH["stiffness"], LATCH["friction"], 0.0, []
    for place in path:
        # It sticks while the force is within friction.
        slide = min(max(slide, place - friction / k), place + friction / k)
        slide = min(max(slide, -LATCH["clearance_minus"]), LATCH["clearance_plus"])
        force.append(k * (place - slide))
    return path, np.array(force) + np.random.default_rng(SEED).normal(0, NOISE_N, len(path))


def table(file: str, header: list[str], rows: list[list[str | float]]) -> None:
    """Write a CSV file beside this one."""
    with (HERE / file).open("w", newline="", encoding="utf-8") as stream:
        csv.writer(stream, lineterminator="\n").writerows([header, *rows])


def main() -> None:
    """Write all files."""
    (HERE / "mast.bdf").write_text(deck(), encoding="utf-8")
    table("mast_members.csv", ["name", "absorptivity", "emissivity", "sun_view", "heat_capacity_J_per_m2_K"], members())
    table("longeron_loop.csv", ["displacement_m", "force_N"],
          [[f"{place:.7g}", f"{force:.5g}"] for place, force in zip(*loop())])


if __name__ == "__main__":
    main()
