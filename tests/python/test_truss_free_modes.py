# SPDX-License-Identifier: GPL-3.0-or-later
"""Natural frequencies of trusses without supports, against closed forms."""
from __future__ import annotations

from math import pi, sqrt
from typing import Any

import numpy as np
import pytest
from failures import failing
from test_truss_modes import ALUMINIUM, AREA_m2, made

import statejump as sj
from statejump.kinds.truss import modes as module
from statejump.kinds.truss.generate.document import node
from statejump.kinds.truss.modes import modes

SIZE = 0.02  # side of a square section
BENDING = (4.730040745, 7.853204624, 10.99560784)  # roots of cos(x) cosh(x) = 1


def beam(count: int, direction: tuple[float, ...] = (1.0, 0.0, 0.0), dimension: int = 3, **truss: Any) -> Any:
    """A straight beam of 1 m in equal parts, without supports."""
    nodes = [node(f"N{at}", [part * at / count for part in direction[:dimension]]) for at in range(count + 1)]
    beams = [{"name": f"B{at}", "nodes": [f"N{at}", f"N{at + 1}"], "shape": "rectangle", "dimensions_m": [SIZE, SIZE],
              "shear_modulus_Pa": 26e9, **ALUMINIUM, **({"axis_y": [0.1, 0.2, 0.9]} if dimension == 3 else {})}
             for at in range(count)]
    return made(nodes, dimension, beam=beams, truss={"dimension": dimension, "free": True, **truss})


@pytest.mark.parametrize("dense", [0, 300])
@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (2 / 3, 2 / 3, 1 / 3)])
def test_a_free_beam_has_six_rigid_modes(direction: tuple[float, ...], dense: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bending in two planes, from 4.73² √(E I/(ρ A)) / (2 π L²) on, behind six modes of frequency 0."""
    monkeypatch.setattr(module, "DENSE", dense)
    found = modes(beam(16, direction), 10)
    assert list(found.frequency_Hz[:6]) == [0.0] * 6
    for at, root in enumerate(BENDING[:2]):
        wanted = root**2 * sqrt(70e9 * SIZE**2 / 12 / 2700.0) / (2 * pi)
        assert found.frequency_Hz[6 + 2 * at:8 + 2 * at] == pytest.approx([wanted] * 2, rel=5e-3 * (1 + 1.5 * at))
    assert found.effective_mass_kg[:6].sum(axis=0) == pytest.approx([2700.0 * SIZE**2] * 3, rel=1e-6)
    assert found.displacement.shape[1] == 17


def test_a_free_beam_in_a_plane_has_three_rigid_modes() -> None:
    found = modes(beam(16, dimension=2), 4)
    wanted = BENDING[0]**2 * sqrt(70e9 * SIZE**2 / 12 / 2700.0) / (2 * pi)
    assert list(found.frequency_Hz[:3]) == [0.0] * 3 and found.frequency_Hz[3] == pytest.approx(wanted, rel=6e-3)


def test_torsion_of_a_free_beam_is_free_at_both_ends() -> None:
    """The support against the spin of a beam must not act: f = √(G J/(ρ I_p)) / 2L, here with J/I_p = 0.8434."""
    found = modes(beam(32), 60).frequency_Hz
    wanted = sqrt(26e9 * 0.8434 / 2700.0) / 2
    assert np.abs(found / wanted - 1).min() < 3e-3


def test_a_free_rod_of_links_moves_along_its_line() -> None:
    """Three masses of a rod: guides leave one rigid motion. ω² = 3 k/m for equal masses, k = E A/L."""
    nodes = [node(f"N{at}", (at / 2, 0.0), "y") | {"mass_kg": 100.0} for at in range(3)]
    links = [{"name": f"L{at}", "nodes": [f"N{at}", f"N{at + 1}"], "cross_section_area_m2": AREA_m2,
              **ALUMINIUM, "density_kg_per_m3": 1e-6} for at in range(2)]
    case = made(nodes, link=links, truss={"dimension": 2, "free": True})
    stiffness = 70e9 * AREA_m2 / 0.5
    assert modes(case, 3).frequency_Hz == pytest.approx(
        [0.0, sqrt(stiffness / 100) / (2 * pi), sqrt(3 * stiffness / 100) / (2 * pi)], rel=1e-6)


def test_a_free_truss_has_no_quasi_static_path() -> None:
    with failing("free_truss"):
        beam(2).reduced()


def test_parts_of_a_free_truss_must_be_connected() -> None:
    document = beam(2)
    with pytest.raises(sj.StatejumpError):
        made([node("A", (0.0, 0.0)), node("B", (1.0, 0.0)), node("C", (0.0, 1.0)), node("D", (1.0, 1.0))],
             link=[{"name": name, "nodes": list(name), "cross_section_area_m2": AREA_m2, **ALUMINIUM} for name in ("AB", "CD")],
             truss={"dimension": 2, "free": True})
    assert document.truss.free
