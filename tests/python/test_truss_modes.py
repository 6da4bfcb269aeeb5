# SPDX-License-Identifier: GPL-3.0-or-later
"""Natural frequencies and mode shapes of trusses against closed forms."""
from __future__ import annotations

from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import statejump as sj
from conftest import Outcome
from statejump.core.errors import StatejumpError
from statejump.kinds.truss import modes as module
from statejump.kinds.truss.generate.document import document, finished, node
from statejump.kinds.truss.modes import modes

ALUMINIUM: dict[str, Any] = {"young_modulus_Pa": 70e9, "thermal_expansion_per_K": 0.0, "density_kg_per_m3": 2700.0}
AREA_m2 = 1e-3
# Timoshenko's beam: E 70 GPa, ν 0.33, ρ 2700 kg/m³, 20 × 50 mm, 1 m long, shear factor 5/6.
CANTILEVER_Hz = (41.042921971, 254.164745330, 698.626607530)


def made(nodes: list[dict[str, Any]], dimension: int = 2, **sections: Any) -> Any:
    case = document("modes", "Modes", "closed form", dimension, 1.0, "triangle", 1, 1.0)
    case["node"] += nodes
    return sj.load(finished(case | sections))


def rod(count: int) -> Any:
    """A rod of 1 m, clamped at one end, in equal links that move along it only."""
    nodes = [node(f"N{i}", (i / count, 0.0), "xy" if i == 0 else "y") for i in range(count + 1)]
    links = [{"name": f"L{i}", "nodes": [f"N{i}", f"N{i + 1}"], "cross_section_area_m2": AREA_m2, **ALUMINIUM}
             for i in range(count)]
    return made(nodes, link=links)


def rod_Hz(count: int, mode: int) -> float:
    """Frequency of a clamped rod of linear elements with consistent masses: the eigenvalue of their recurrence."""
    h, wave = 1 / count, (mode - 0.5) * pi / count
    square = 6 * 70e9 / (2700.0 * h**2) * (1 - np.cos(wave)) / (2 + np.cos(wave))
    return sqrt(square) / (2 * pi)


@pytest.mark.parametrize("dense", [0, 300])
def test_rod(monkeypatch: pytest.MonkeyPatch, dense: int) -> None:
    monkeypatch.setattr(module, "DENSE", dense)
    found = modes(rod(40), 4)
    assert found.frequency_Hz == pytest.approx([rod_Hz(40, mode) for mode in range(1, 5)], rel=1e-9)
    assert found.mass_kg[0] == pytest.approx(2700.0 * AREA_m2 * (1 - 1 / 60), rel=1e-9)  # a third of the first link moves
    assert found.effective_mass_kg[0, 0] / found.mass_kg[0] == pytest.approx(8 / pi**2, rel=2e-2)


@pytest.mark.parametrize("dimension", [2, 3])
def test_cantilever(dimension: int) -> None:
    """The errors of both meshes fall as the square of the length of a beam, so their extrapolation is better."""
    def frequencies(count: int) -> np.ndarray:
        nodes = [node(f"N{i}", (i / count, *(0.0,) * (dimension - 1)), "xyz"[:dimension] if i == 0 else "")
                 for i in range(count + 1)]
        nodes[0]["fixed_rotations"] = ["z"] if dimension == 2 else ["x", "y", "z"]
        beams = [{"name": f"B{i}", "nodes": [f"N{i}", f"N{i + 1}"], "shape": "rectangle", "poisson_ratio": 0.33,
                  "dimensions_m": [0.05, 0.02], "shear_factors": [5 / 6, 5 / 6], **ALUMINIUM,
                  **({"axis_y": [0.0, 1.0, 0.0]} if dimension == 3 else {})} for i in range(count)]
        return np.asarray(modes(made(nodes, dimension, beam=beams), 8).frequency_Hz)

    coarse, fine = frequencies(16), frequencies(32)
    for wanted in CANTILEVER_Hz:
        rough, good = (found[np.argmin(np.abs(found - wanted))] for found in (coarse, fine))
        assert good == pytest.approx(wanted, rel=2e-2)
        assert (4 * good - rough) / 3 == pytest.approx(wanted, rel=1e-3)
    if dimension == 3:  # bending across the other axis, nearly by the ratio of the sides
        assert fine[0] == pytest.approx(CANTILEVER_Hz[0] * 0.4, rel=2e-3)


def test_slender_cantilever() -> None:
    """Its lowest frequency is 1e-6 of that of a rod of one of its beams, and yet not zero."""
    nodes = [node(f"N{i}", (i / 90, 0.0), "xy" if i == 0 else "") for i in range(91)]
    nodes[0]["fixed_rotations"] = ["z"]
    beams = [{"name": f"B{i}", "nodes": [f"N{i}", f"N{i + 1}"], "shape": "rectangle", "dimensions_m": [3e-4, 3e-4],
              **ALUMINIUM} for i in range(90)]
    found = modes(made(nodes, beam=beams), 1).frequency_Hz
    assert found[0] == pytest.approx(3.5160152685 / (2 * pi) * sqrt(70e9 * 9e-8 / 12 / 2700), rel=1e-3)


def test_joints_hold() -> None:
    """A mass on two springs in line, with a slider: the slider holds it; a free node has only the springs."""
    def case(**sections: Any) -> Any:
        nodes = [node("A", (0.0, 0.0), "xy"), {**node("M", (1.0, 0.0), "y"), "mass_kg": 2.0}, node("B", (2.0, 0.0), "xy"),
                 {**node("F", (3.0, 0.0), "y"), "mass_kg": 1.0}]
        springs = [{"name": name, "nodes": ends, "stiffness_N_per_m": k}
                   for name, ends, k in (("S1", ["A", "M"], 300.0), ("S2", ["M", "B"], 500.0), ("S3", ["B", "F"], 100.0))]
        return made(nodes, spring=springs, **sections)

    free = sorted([sqrt(800.0 / 2.0) / (2 * pi), sqrt(100.0) / (2 * pi)])
    assert modes(case()).frequency_Hz == pytest.approx(free, rel=1e-9)
    slider = {"name": "pad", "nodes": ["M"], "axis": [1.0, 0.0], "friction_coefficient": 0.2, "normal_force_N": 10.0}
    held = modes(case(slider=[slider]))
    assert held.frequency_Hz == pytest.approx([free[0]], rel=1e-9)
    assert held.displacement[0, :, 0] == pytest.approx([0.0, 0.0, 0.0, 1.0], abs=1e-9)


def test_rigid_motion_has_frequency_zero() -> None:
    nodes = [{**node(name, (x, 0.0), "y"), "mass_kg": 1.0} for name, x in (("A", 0.0), ("B", 1.0))]
    with pytest.raises(StatejumpError):  # the quasi-static start needs supports
        modes(made(nodes, spring=[{"name": "S", "nodes": ["A", "B"], "stiffness_N_per_m": 1.0}]))


def test_structures_without_mass_are_refused() -> None:
    nodes = [node("A", (0.0, 0.0), "xy"), node("B", (1.0, 0.0), "y")]
    with pytest.raises(StatejumpError) as caught:
        modes(made(nodes, spring=[{"name": "S", "nodes": ["A", "B"], "stiffness_N_per_m": 1.0}]))
    assert caught.value.code == "no_moving_mass"


def test_command(statejump: Any, tmp_path: Path) -> None:
    done: Outcome = statejump("modes", "cases/trusses/mast_6.toml", "--count", "3")
    assert done.status == 0, done
    folder = tmp_path / "results" / "mast_6_modes"
    assert (folder / "modes.csv").read_text().splitlines()[0] == "mode,frequency_Hz,effective_mass_x_kg,effective_mass_y_kg"
    assert len((folder / "mode_shapes.csv").read_text().splitlines()) == 1 + 3 * 30
    assert (folder / "modes.png").stat().st_size > 1000
