# SPDX-License-Identifier: GPL-3.0-or-later
"""Planar shapes."""
from __future__ import annotations

from math import cos, hypot, pi, sin

import numpy as np

from sketch import Foot, Sketch

X = (1.0, 0.0)
Random = np.random.Generator


def _girder(rng: Random, bays: int) -> tuple[Sketch, float, float]:
    """Return the chords of a girder, the length of a bay, and the depth of the girder."""
    made = Sketch(2)
    bay = float(rng.choice([0.3, 0.5, 1.0, 1.5, 2.0]))
    depth = bay * float(rng.uniform(0.6, 1.6))
    return made, bay, depth


def _supported(made: Sketch, first: str, last: str, rng: Random, upper: str) -> None:
    """Support a girder: as a bridge whose second end slides along it, or as a cantilever."""
    if rng.random() < 0.6:
        made.fixed[first] = "xy"
        made.fixed[last] = "y"
        made.feet.append(Foot(last, X, "y"))
    else:
        made.fixed[first] = "xy"
        made.fixed[upper] = "x"
        made.feet.append(Foot(upper, (0.0, 1.0), "x"))


def warren(rng: Random, bays: int) -> Sketch:
    """Warren truss, with or without verticals."""
    made, bay, depth = _girder(rng, bays)
    for k in range(bays + 1):
        made.node(f"B{k}", bay * k, 0)
    for k in range(bays):
        made.node(f"T{k}", bay * (k + 0.5), depth)
        made.bar(f"B{k}", f"B{k + 1}", "bottom")
        made.bar(f"B{k}", f"T{k}", "web")
        made.bar(f"T{k}", f"B{k + 1}", "web")
        if k:
            made.bar(f"T{k - 1}", f"T{k}", "top")
    _supported(made, "B0", f"B{bays}", rng, "T0")
    made.tips += [f"B{bays // 2}", f"T{bays - 1}"]
    return made


def pratt(rng: Random, bays: int) -> Sketch:
    """Pratt truss; some have crossed diagonals."""
    made, bay, depth = _girder(rng, bays)
    crossed = rng.random() < 0.4
    for k in range(bays + 1):
        made.node(f"B{k}", bay * k, 0)
        made.node(f"T{k}", bay * k, depth)
        made.bar(f"B{k}", f"T{k}", "post")
    for k in range(bays):
        made.bar(f"B{k}", f"B{k + 1}", "bottom")
        made.bar(f"T{k}", f"T{k + 1}", "top")
        inward = k < bays / 2
        made.bar(*((f"T{k}", f"B{k + 1}") if inward else (f"B{k}", f"T{k + 1}")), "diagonal")
        if crossed:
            made.bar(*((f"B{k}", f"T{k + 1}") if inward else (f"T{k}", f"B{k + 1}")), "counter")
    _supported(made, "B0", f"B{bays}", rng, "T0")
    made.tips += [f"T{bays}", f"B{bays // 2}"]
    return made


def k_truss(rng: Random, bays: int) -> Sketch:
    """K truss."""
    made, bay, depth = _girder(rng, bays)
    for k in range(bays + 1):
        made.node(f"B{k}", bay * k, 0)
        made.node(f"T{k}", bay * k, depth)
        if k == 0:
            made.bar("B0", "T0", "post")
            continue
        made.node(f"M{k}", bay * k, depth / 2)
        made.bar(f"B{k}", f"M{k}", "post")
        made.bar(f"M{k}", f"T{k}", "post")
        made.bar(f"B{k - 1}", f"B{k}", "bottom")
        made.bar(f"T{k - 1}", f"T{k}", "top")
        made.bar(f"B{k - 1}", f"M{k}", "diagonal")
        made.bar(f"T{k - 1}", f"M{k}", "diagonal")
    _supported(made, "B0", f"B{bays}", rng, "T0")
    made.tips += [f"T{bays}", f"M{bays}"]
    return made


def tower(rng: Random, bays: int) -> Sketch:
    """Tower that gets narrower, on two feet."""
    made = Sketch(2)
    width, height = float(rng.uniform(0.5, 2)), float(rng.uniform(0.5, 1.5))
    taper = float(rng.uniform(0.0, 0.7)) / bays
    for k in range(bays + 1):
        half = width / 2 * (1 - taper * k)
        made.node(f"L{k}", -half, height * k)
        made.node(f"R{k}", half, height * k)
        if k == 0:
            continue
        made.bar(f"L{k}", f"R{k}", "strut")
        for side, other in ("LR", "RL"):
            made.bar(f"{side}{k - 1}", f"{side}{k}", "leg")
            if side == "L" or rng.random() < 0.5:
                made.bar(f"{side}{k - 1}", f"{other}{k}", "diagonal")
    made.fixed |= {"L0": "xy", "R0": "y"}
    made.bar("L0", "R0", "strut")
    made.feet.append(Foot("R0", X, "y"))
    made.tips += [f"L{bays}", f"R{bays}"]
    return made


def ring(rng: Random, bays: int) -> Sketch:
    """Ring of two hoops on three mounts."""
    made, bays = Sketch(2), max(bays, 5)
    outer = float(rng.uniform(0.5, 4))
    inner = outer * float(rng.uniform(0.6, 0.9))
    for k in range(bays):
        angle = 2 * pi * k / bays
        made.node(f"I{k}", inner * cos(angle), inner * sin(angle))
        made.node(f"O{k}", outer * cos(angle), outer * sin(angle))
        made.bar(f"I{k}", f"O{k}", "post")
    for k in range(bays):
        after = (k + 1) % bays
        made.bar(f"I{k}", f"I{after}", "inner")
        made.bar(f"O{k}", f"O{after}", "outer")
        made.bar(f"I{k}", f"O{after}", "diagonal")
    half = bays // 2
    made.fixed |= {"I0": "xy", f"I{half}": "y"}
    made.feet.append(Foot(f"I{half}", X, "y"))
    made.tips += [f"O{bays // 4}", f"O{half}"]
    made.down = (0.0, -1.0)
    return made


def rib(rng: Random, bays: int) -> Sketch:
    """Rib of an umbrella: a cantilever of two chords that meet at its tip, mounted on a hub."""
    made = Sketch(2)
    reach, depth = float(rng.uniform(0.5, 3)), float(rng.uniform(0.05, 0.4))
    rise = float(rng.uniform(-0.2, 0.4)) * reach
    made.node("B0", 0, 0, fixed="xy")
    made.node("T0", 0, depth * reach, fixed="xy")
    for k in range(1, bays + 1):
        along = k / (bays + 1)
        made.node(f"B{k}", reach * along, rise * along**2)
        made.node(f"T{k}", reach * along, rise * along**2 + depth * reach * (1 - along))
    made.node("tip", reach, rise)
    for k in range(bays + 1):
        after = (f"B{k + 1}", f"T{k + 1}") if k < bays else ("tip", "tip")
        made.bar(f"B{k}", after[0], "chord")
        made.bar(f"T{k}", after[1], "chord")
        if k:
            made.bar(f"B{k}", f"T{k}", "post")
            made.bar(f"T{k - 1}", f"B{k}", "diagonal")
    made.feet.append(Foot("T0", (0.0, 1.0), "x"))
    made.tips += ["tip"]
    return made


def scissor(rng: Random, bays: int) -> Sketch:
    """Scissor mast: crossed bars with bending stiffness at their middle hinges, and cables across the levels."""
    made = Sketch(2)
    bay = float(rng.uniform(0.3, 1.0))
    bending = float(rng.uniform(2e3, 5e4))
    preload = float(rng.choice([0.0, 20.0, 100.0]))
    for k in range(bays + 1):
        made.node(f"L{k}", 0, bay * k)
        made.node(f"R{k}", bay, bay * k)
        if k and preload:
            made.add("spring", f"cable{k}", nodes=[f"L{k}", f"R{k}"], stiffness_N_per_m=1e5, preload_N=preload,
                     cable=True)
    for k in range(bays):
        made.node(f"M{k}", bay / 2, bay * (k + 0.5))
        for side, other in ("LR", "RL"):
            below = made.bar(f"{side}{k}", f"M{k}", "lower")
            above = made.bar(f"M{k}", f"{other}{k + 1}", "upper")
            made.add("torsion_spring", f"bend{side}{k}", links=[below, above], stiffness_N_m_per_rad=bending)
    made.bar(f"L{bays}", f"R{bays}", "top")
    made.fixed |= {"L0": "xy", "R0": "xy"}
    made.feet.append(Foot("R0", X, "y"))
    made.tips += [f"L{bays}", f"R{bays}"]
    return made


def cable_stayed(rng: Random, bays: int) -> Sketch:
    """A girder that hangs on cables from a mast."""
    made, bay, depth = _girder(rng, bays)
    made = pratt(rng, bays)
    made.fixed = {"B0": "xy", "T0": "x"}
    made.feet = [Foot("T0", (0.0, 1.0), "x")]
    span = float(made.points[f"B{bays}"][0])
    made.node("mast", 0, span * float(rng.uniform(0.4, 0.8)) + depth, fixed="xy")
    for k in range(2, bays + 1, 2):
        made.add("spring", f"stay{k}", nodes=["mast", f"T{k}"], stiffness_N_per_m=float(rng.uniform(2e4, 5e5)),
                 preload_N=float(rng.uniform(5, 200)), cable=True)
    return made


def bracket(rng: Random, bays: int) -> Sketch:
    """A few bars from a wall to one point."""
    made, legs = Sketch(2), int(rng.integers(2, 6))
    made.node("tip", float(rng.uniform(0.3, 2)), float(rng.uniform(-0.2, 0.2)))
    heights = np.linspace(-0.5, 0.7, legs) + rng.uniform(-0.05, 0.05, legs)
    for k, height in enumerate(heights):
        made.node(f"W{k}", 0, height, fixed="xy")
        made.bar(f"W{k}", "tip", "leg")
    made.feet += [Foot(f"W{k}", (0.0, 1.0), "x") for k in range(legs)]
    made.tips += ["tip"]
    return made


def chain(rng: Random, bays: int) -> Sketch:
    """A rail on a row of feet, held at one end or only by friction."""
    made = Sketch(2)
    bay = float(rng.uniform(0.2, 2))
    held = rng.random() < 0.85
    for k in range(bays + 1):
        made.node(f"N{k}", bay * k, 0, fixed="xy" if held and k == 0 else "y")
        if k:
            made.bar(f"N{k - 1}", f"N{k}", "rail")
    made.feet += [Foot(f"N{k}", X, "y") for k in range(1 if held else 0, bays + 1)]
    made.tips += [f"N{bays}"]
    made.down = (0.0, -1.0) if rng.random() < 0.6 else (float(hypot(1, 0) * 0.2), -0.98)
    return made


SHAPES = {shape.__name__: shape for shape in (
    warren, pratt, k_truss, tower, ring, rib, scissor, cable_stayed, bracket, chain)}
