# SPDX-License-Identifier: GPL-3.0-or-later
"""Ordinary structures, each determined by a family and a seed.

A structure is a case document with default settings, plus facts known from its generation: its load and its joints.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import atan
from typing import Any
from zlib import crc32

import numpy as np

import dress
import planar
import programs
import spatial
from sketch import CLEARANCE, Document, Sketch
from walking import Walker

Random = np.random.Generator
SHAPES = {**planar.SHAPES, **spatial.SHAPES}


@dataclass(frozen=True)
class Structure:
    """A case document and the facts known from its generation.

    :param walk_m: displacement of its middle per cycle [m], if theory predicts a walk
    """

    family: str
    seed: int
    document: Document
    plan: str
    loaded: str
    walk_m: float | None = None

    @property
    def name(self) -> str:
        """Family and seed."""
        return f"{self.family}_{self.seed}"

    @property
    def joints(self) -> int:
        """How many joints it has."""
        return sum(len(self.document.get(section, ())) for section in ("slider", "iwan_joint", "latch_hinge",
                                                                       *CLEARANCE))

    @property
    def clearance(self) -> bool:
        """Whether some joint has parts that play."""
        return any(self.document.get(section) for section in CLEARANCE)


def random_of(family: str, seed: int) -> Random:
    """Return the random generator of a structure; families with the same seed are independent."""
    return np.random.default_rng([seed, crc32(family.encode())])


def _finished(family: str, seed: int, made: Sketch, rng: Random, *, bare: bool) -> Structure:
    thermal = programs.program(rng)
    dress.materials(made, rng)
    truss: Document = {}
    plan, loaded = "none", "none"
    if not bare:
        loaded = dress.loads(made, rng, truss)
        plan = dress.joints(made, rng, dress.thermal_force_N(made, programs.largest_K(thermal)))
    others: list[Document] = []
    if not bare and rng.random() < 0.15:
        others.append(programs.of_others(rng, thermal))
        for name in rng.choice(list(made.bars), max(1, len(made.bars) // 4), replace=False):
            made.bars[str(name)].keys["program"] = "shade"
    title = f"{family}, {plan}, load {loaded}"
    document = made.document(f"{family}_{seed}", title, thermal, others)
    document["truss"] |= truss
    if any(ball["friction_coefficient"] for ball in document.get("ball_joint", ())):
        document["reduced"] = {"sticking": "elastic"}  # which balls with friction need
    return Structure(family, seed, document, plan, loaded)


def _bays(rng: Random, spatial_one: bool) -> int:
    """Return a number of bays: mostly few, some long."""
    largest = 16 if spatial_one else 40
    return int(np.clip(np.round(3 * 10 ** (rng.exponential(0.25))), 3, largest))


def shaped(family: str, seed: int) -> Structure:
    """Return a structure of a shape with joints and loads."""
    rng = random_of(family, seed)
    made = SHAPES[family](rng, _bays(rng, family in spatial.SHAPES))
    return _finished(family, seed, made, rng, bare=False)


def free(family: str, seed: int) -> Structure:
    """Return a structure of any shape without joints and loads."""
    rng = random_of(family, seed)
    shape = str(rng.choice([name for name in SHAPES if name not in ("tensegrity", "cable_stayed", "scissor")]))
    made = SHAPES[shape](rng, _bays(rng, shape in spatial.SHAPES))
    made.items.clear()  # springs with a preload
    if shape == "chain":
        first = next(iter(made.points))
        made.fixed[first] = "xy"
    return _finished(family, seed, made, rng, bare=True)


def walking(family: str, seed: int) -> Structure:
    """Return a sheet or pipe that walks down an incline."""
    rng = random_of(family, seed)
    blocks = int(np.round(10 ** rng.uniform(np.log10(4), np.log10(120))))
    friction = float(np.round(rng.uniform(0.2, 0.6), 3))
    slope = atan(friction * float(rng.uniform(0.1, 0.7)))
    length, area = float(rng.uniform(2, 100)), float(10 ** rng.uniform(-4, -2))
    material = dress.MATERIALS[str(rng.choice(["aluminium", "steel", "titanium"]))]
    largest = float(np.round(rng.uniform(10, 60), 1))
    one = Walker(f"{family}_{seed}", blocks, friction, slope, length, material.density * area * dress.GRAVITY,
                 material.young_Pa, area, material.expansion_per_K, largest, material.density)
    return Structure(family, seed, one.document(), "feet", "slope", one.walk_m)


FAMILIES: dict[str, Any] = {**dict.fromkeys(SHAPES, shaped), "free": free, "walking": walking}


def make(family: str, seed: int) -> Structure:
    """Return the structure of a family with a seed."""
    made: Structure = FAMILIES[family](family, seed)
    return made


def sample(count: int, seed: int, families: list[str] | None = None) -> list[tuple[str, int]]:
    """Return families and seeds of a campaign, with the families in turn."""
    chosen = families or list(FAMILIES)
    return [(chosen[number % len(chosen)], seed + number // len(chosen)) for number in range(count)]
