# SPDX-License-Identifier: GPL-3.0-or-later
"""Spatial shapes."""
from __future__ import annotations

from math import cos, pi, sin

import numpy as np

from sketch import Foot, Sketch

Random = np.random.Generator
DOWN = (0.0, 0.0, -1.0)
UP = (0.0, 0.0, 1.0)
X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def _mount(made: Sketch, names: list[str]) -> None:
    """Support a body in six directions; feet can slide away from the first foot."""
    first, second, third, *others = names
    made.fixed |= {first: "xyz", second: "yz", third: "z", **{name: "z" for name in others}}
    made.feet.append(Foot(second, X, "yz"))
    # A slider on ground requires supports in both directions across its axis.
    made.feet += [Foot(name, X, "yz") for name in (third, *others)]


def lattice(rng: Random, bays: int, sides: int, upright: bool) -> Sketch:
    """Lattice boom or tower of legs, battens and diagonals; with four sides also bracing across."""
    made = Sketch(3, down=DOWN)
    radius, bay = float(rng.uniform(0.1, 0.8)), float(rng.uniform(0.3, 1.5))
    taper = float(rng.uniform(0, 0.6)) / bays if upright else 0.0
    crossed = rng.random() < 0.3
    for k in range(bays + 1):
        for s in range(sides):
            angle = 2 * pi * (s + 0.5) / sides
            across = [radius * (1 - taper * k) * cos(angle), radius * (1 - taper * k) * sin(angle)]
            place = [*across, bay * k] if upright else [bay * k, *across]
            made.node(f"N{k}_{s}", *place)
        for s in range(sides):
            after = (s + 1) % sides
            made.bar(f"N{k}_{s}", f"N{k}_{after}", "batten")
            if k:
                made.bar(f"N{k - 1}_{s}", f"N{k}_{s}", "leg")
                made.bar(f"N{k - 1}_{s}", f"N{k}_{after}", "diagonal")
                if crossed:
                    made.bar(f"N{k - 1}_{after}", f"N{k}_{s}", "counter")
        if sides == 4:
            made.bar(f"N{k}_0", f"N{k}_2", "brace")
    if upright:
        _mount(made, [f"N0_{s}" for s in range(sides)])
    else:
        made.fixed |= {f"N0_{s}": "xyz" for s in range(sides)}
        made.feet += [Foot(f"N0_{sides - 1}", UP, "xy"), Foot("N0_1", X, "yz")]
    made.tips += [f"N{bays}_{s}" for s in range(sides)]
    return made


def boom(rng: Random, bays: int) -> Sketch:
    """Triangular or square boom."""
    return lattice(rng, bays, int(rng.integers(3, 5)), False)


def mast(rng: Random, bays: int) -> Sketch:
    """Upright tower of three or four legs."""
    return lattice(rng, min(bays, 12), int(rng.integers(3, 5)), True)


def tripod(rng: Random, bays: int) -> Sketch:
    """Three to six legs that meet at one node or at two nodes."""
    made, legs = Sketch(3, down=DOWN), int(rng.integers(3, 7))
    height, spread = float(rng.uniform(0.3, 2)), float(rng.uniform(0.3, 1))
    made.node("top", 0, 0, height)
    for k in range(legs):
        angle = 2 * pi * k / legs + float(rng.uniform(-0.1, 0.1))
        made.node(f"F{k}", spread * cos(angle), spread * sin(angle), 0, fixed="xyz")
        made.bar(f"F{k}", "top", "leg")
    made.feet += [Foot(f"F{k}", X, "yz") for k in range(legs)]
    made.tips += ["top"]
    return made


def grid(rng: Random, bays: int) -> Sketch:
    """Double-layer grid, square on square."""
    made, n = Sketch(3, down=DOWN), int(np.clip(bays, 2, 6))
    bay, depth = float(rng.uniform(0.4, 1.5)), float(rng.uniform(0.3, 1.0))
    for i in range(n + 1):
        for j in range(n + 1):
            made.node(f"B{i}_{j}", bay * i, bay * j, 0)
            if i:
                made.bar(f"B{i - 1}_{j}", f"B{i}_{j}", "bottom")
            if j:
                made.bar(f"B{i}_{j - 1}", f"B{i}_{j}", "bottom")
    for i in range(n):
        for j in range(n):
            made.node(f"T{i}_{j}", bay * (i + 0.5), bay * (j + 0.5), depth)
            for one in ((i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)):
                made.bar(f"B{one[0]}_{one[1]}", f"T{i}_{j}", "web")
            if i:
                made.bar(f"T{i - 1}_{j}", f"T{i}_{j}", "top")
            if j:
                made.bar(f"T{i}_{j - 1}", f"T{i}_{j}", "top")
    made.bar("B0_0", "B1_1", "brace")
    corners = ["B0_0", f"B{n}_0", f"B0_{n}", f"B{n}_{n}"]
    made.fixed |= {"B0_0": "xyz", corners[1]: "yz", corners[2]: "z", corners[3]: "z"}
    made.feet += [Foot(corners[1], X, "yz")]
    if rng.random() < 0.5:
        made.fixed |= {corners[2]: "xz", corners[3]: "yz"}
        made.feet += [Foot(corners[2], Y, "xz"), Foot(corners[3], X, "yz")]
    made.tips += [f"T{n // 2}_{n // 2}", "T0_0"]
    return made


def umbrella(rng: Random, bays: int) -> Sketch:
    """Ribs around an axis, each in its own plane, with cables from tip to tip."""
    made, ribs = Sketch(3, down=DOWN), int(np.clip(bays, 3, 16))
    reach, depth = float(rng.uniform(0.5, 3)), float(rng.uniform(0.1, 0.5))
    drop = float(rng.uniform(-0.3, 0.6))
    preload = float(rng.choice([0.0, 5.0, 50.0]))
    for k in range(ribs):
        angle = 2 * pi * k / ribs
        c, s = cos(angle), sin(angle)
        made.node(f"A{k}", 0.1 * c, 0.1 * s, 0, fixed="xyz")
        made.node(f"C{k}", 0.1 * c, 0.1 * s, depth, fixed="xyz")
        made.node(f"M{k}", 0.5 * reach * c, 0.5 * reach * s, drop / 2 + depth / 3)
        made.node(f"tip{k}", reach * c, reach * s, drop)
        for name in (f"M{k}", f"tip{k}"):
            made.guides[name] = np.array([-s, c, 0.0])
        made.bar(f"A{k}", f"M{k}", "rib")
        made.bar(f"C{k}", f"M{k}", "strut")
        made.bar(f"M{k}", f"tip{k}", "rib")
        made.bar(f"C{k}", f"tip{k}", "stay")
    if preload:
        for k in range(ribs):
            made.add("spring", f"cable{k}", nodes=[f"tip{k}", f"tip{(k + 1) % ribs}"], stiffness_N_per_m=1e4,
                     preload_N=preload, cable=True)
    made.tips += [f"tip{k}" for k in range(ribs)]
    return made


def ring_truss(rng: Random, bays: int) -> Sketch:
    """Hoop of two levels, as in a mesh antenna, on three mounts."""
    made, bays = Sketch(3, down=DOWN), int(np.clip(bays, 5, 24))
    radius, height = float(rng.uniform(0.8, 4)), float(rng.uniform(0.2, 0.8))
    inner = radius * float(rng.uniform(0.75, 0.9))
    for k in range(bays):
        angle = 2 * pi * k / bays
        c, s = cos(angle), sin(angle)
        made.node(f"L{k}", radius * c, radius * s, 0)
        made.node(f"U{k}", radius * c, radius * s, height)
        made.node(f"I{k}", inner * c, inner * s, height / 2)
    for k in range(bays):
        after = (k + 1) % bays
        for one in "LUI":
            made.bar(f"{one}{k}", f"{one}{after}", "hoop")
        for one, two in ("LU", "UI", "IL"):
            made.bar(f"{one}{k}", f"{two}{k}", "batten")
            made.bar(f"{one}{k}", f"{two}{after}", "diagonal")
    third, other = bays // 3, 2 * bays // 3
    made.fixed |= {"L0": "xyz", f"L{third}": "yz", f"L{other}": "z"}
    made.feet += [Foot(f"L{third}", X, "yz"), Foot(f"L{other}", X, "yz")]
    made.tips += [f"U{bays // 2}", f"I{bays // 2}"]
    return made


def tensegrity(rng: Random, bays: int) -> Sketch:
    """Prism of struts and cables that is stiff by self-stress."""
    made, sides = Sketch(3, down=DOWN), int(rng.integers(3, 6))
    radius, height = float(rng.uniform(0.3, 1)), float(rng.uniform(0.5, 1.5))
    twist = pi / 2 - pi / sides  # of the self-stressed prism
    for s in range(sides):
        angle = 2 * pi * s / sides
        made.node(f"B{s}", radius * cos(angle), radius * sin(angle), 0, fixed="xyz")
        top = angle + twist
        made.node(f"T{s}", radius * cos(top), radius * sin(top), height)
    names = [f"T{s}" for s in range(sides)]
    members = [("cable", f"T{s}", f"T{(s + 1) % sides}") for s in range(sides)]
    members += [("cable", f"B{s}", f"T{s}") for s in range(sides)]
    members += [("strut", f"B{(s - 1) % sides}", f"T{s}") for s in range(sides)]
    directions = np.zeros((3 * sides, len(members)))
    for number, (_, one, two) in enumerate(members):
        along = made.points[two] - made.points[one]
        along /= np.linalg.norm(along)
        for node, sign in ((one, 1.0), (two, -1.0)):
            if node in names:
                place = 3 * names.index(node)
                directions[place: place + 3, number] += sign * along
    tension = np.linalg.svd(directions)[2][-1]  # the state of self-stress
    tension *= float(rng.uniform(20, 500)) / tension[0]
    for number, (role, one, two) in enumerate(members):
        if role == "cable":
            made.add("spring", f"cable{number}", nodes=[one, two], stiffness_N_per_m=float(rng.uniform(1e5, 1e6)),
                     preload_N=float(tension[number]), cable=True)
        else:
            made.bar(one, two, "strut", preload=float(tension[number]))
    made.tips += names
    return made


SHAPES = {shape.__name__: shape for shape in (boom, mast, tripod, grid, umbrella, ring_truss, tensegrity)}
