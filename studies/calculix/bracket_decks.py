# SPDX-License-Identifier: GPL-3.0-or-later
"""Decks for condensation: an L-shaped bracket of 20-node bricks, and a panel of 8-node shells."""
from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

EXPANSION = 23e-6
MASS_KG = 2700 * (0.2 * 0.04 * 0.01 + 0.04 * 0.01 * 0.11)
CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
BRICK = np.vstack([CORNERS, [[0, -1, -1], [1, 0, -1], [0, 1, -1], [-1, 0, -1],
                             [0, -1, 1], [1, 0, 1], [0, 1, 1], [-1, 0, 1],
                             [-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]])
PLATE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]])


class Nodes:
    """Numbers nodes by their positions."""

    def __init__(self) -> None:
        self.numbers: dict[tuple[int, ...], int] = {}
        self.places: list[np.ndarray] = []

    def number(self, place: np.ndarray) -> int:
        key = tuple(np.round(place * 1e7).astype(int).tolist())
        if key not in self.numbers:
            self.numbers[key] = len(self.places) + 1
            self.places.append(place)
        return self.numbers[key]

    def find(self, inside: Callable[[np.ndarray], bool]) -> list[int]:
        return [number for number, place in enumerate(self.places, start=1) if inside(place)]


def _sets(nodes: Nodes, sets: dict[str, Callable[[np.ndarray], bool]]) -> str:
    return "".join(f"*NSET,NSET={name}\n" + "".join(f"{node},\n" for node in nodes.find(inside))
                   for name, inside in sets.items())


def _written(nodes: Nodes, kind: str, elements: Iterable[list[int]], scale: float) -> str:
    lines = ["*NODE,NSET=NALL"]
    lines += [f"{number},{','.join(f'{scale * value:.12g}' for value in place)}"
              for number, place in enumerate(nodes.places, start=1)]
    lines.append(f"*ELEMENT,TYPE={kind},ELSET=EALL")
    for number, element in enumerate(elements, start=1):
        words = [str(number), *map(str, element)]
        lines += [",".join(words[:12]) + ",", ",".join(words[12:])] if len(words) > 12 else [",".join(words)]
    return "\n".join(lines) + "\n"


def bracket(scale: float = 1.0, fine: bool = True, material: str = "70e9", density: str = "2700.") -> str:
    """An L of aluminium, 0.2 x 0.12 m, 40 x 10 mm, with patches A (arm end), B (top) and C (foot) and points P."""
    along_x = np.array([0, 0.005, 0.01, 0.02, 0.08, 0.14, 0.2])
    along_z = np.array([0, 0.005, 0.01, 0.05, 0.12])
    if fine:
        along_x, along_z = (np.concatenate([[0, 0.005], np.arange(0.01, end, 0.01)]) for end in (0.2001, 0.1201))
    along_y = np.linspace(0, 0.04, 5 if fine else 3)
    nodes, elements = Nodes(), []
    for z, top in zip(along_z, along_z[1:]):
        for y, back in zip(along_y, along_y[1:]):
            for x, end in zip(along_x, along_x[1:]):
                low, high = np.array([x, y, z]), np.array([end, back, top])
                if low[0] < 0.0099 or low[2] < 0.0099:
                    elements.append([nodes.number(low + (high - low) * (place + 1) / 2) for place in BRICK])
    return (_written(nodes, "C3D20R", elements, scale) + _sets(nodes, {
        "A": lambda p: abs(p[0] - 0.2) < 1e-9, "B": lambda p: abs(p[2] - 0.12) < 1e-9,
        "C": lambda p: abs(p[2]) < 1e-9 and p[0] < 0.0201,
        "P": lambda p: abs(p[1] - 0.04) < 1e-9 and 0.08 < p[0] < 0.15, "ONE": lambda p: not p.any()})
        + f"*MATERIAL,NAME=AL\n*ELASTIC\n{material},0.3\n*EXPANSION,ZERO=0.\n{EXPANSION}\n*DENSITY\n{density}\n"
        + "*SOLID SECTION,ELSET=EALL,MATERIAL=AL\n*BOUNDARY\nC,1,3\n"
        + "*STEP\n*STATIC\n*TEMPERATURE\nNALL,2.5\n*END STEP\n")


SANDWICH = ("*SHELL SECTION,ELSET=EALL,COMPOSITE\n0.0003,,AL\n0.01,,CORE\n0.0003,,AL\n*MATERIAL,NAME=CORE\n"
            "*ELASTIC,TYPE=ENGINEERING CONSTANTS\n1e6,1e6,1e9,.1,.01,.01,1e5,2e8,\n2e8\n"
            f"*EXPANSION\n{EXPANSION}\n*DENSITY\n50.\n")


def panel(stiffened: bool = False, section: str = "*SHELL SECTION,ELSET=EALL,MATERIAL=AL\n0.002\n") -> str:
    """A panel of aluminium, 1 x 0.5 m, 2 mm, with two hinge patches and two tip patches of 50 mm.

    :param stiffened: whether a beam of 20 x 10 mm stiffens the line y = 0.25 m
    """
    nodes, elements = Nodes(), []
    for j in range(10):
        for i in range(20):
            corner = np.array([i, j])
            elements.append([nodes.number(np.array([*(0.05 * (corner + (place + 1) / 2)), 0.0])) for place in PLATE])

    def square(x: float, y: float) -> Callable[[np.ndarray], bool]:
        return lambda p: abs(p[0] - x) < 0.0251 and abs(p[1] - y) < 0.0251

    return (_written(nodes, "S8R", elements, 1.0) + _sets(nodes, {
        "H1": square(0.025, 0.075), "H2": square(0.025, 0.425), "T1": square(0.975, 0.025), "T2": square(0.975, 0.475)})
        + f"*MATERIAL,NAME=AL\n*ELASTIC\n70e9,0.3\n*EXPANSION,ZERO=0.\n{EXPANSION}\n*DENSITY\n2700.\n"
        + section + (_stiffener(nodes) if stiffened else ""))


def _stiffener(nodes: Nodes) -> str:
    along = sorted(nodes.find(lambda p: abs(p[1] - 0.25) < 1e-9), key=lambda node: float(nodes.places[node - 1][0]))
    return "*ELEMENT,TYPE=B32R,ELSET=STIFFENER\n" + "".join(
        f"{1001 + k},{along[2 * k]},{along[2 * k + 1]},{along[2 * k + 2]}\n" for k in range(20)
    ) + "*BEAM SECTION,ELSET=STIFFENER,MATERIAL=AL,SECTION=RECT\n0.02,0.01\n0,1,0\n"


def closed_form(place: np.ndarray, constant: float, gradient: np.ndarray) -> np.ndarray:
    """Return the displacement of a free body at a linear temperature T0 + g.x: no stress arises."""
    return np.asarray(EXPANSION * (constant * place + (gradient @ place) * place - gradient * (place @ place) / 2))
