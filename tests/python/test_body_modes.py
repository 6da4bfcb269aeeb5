# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixed-interface modes of condensed bodies: frequencies of a structure converge to those of the mesh."""
from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest
from scipy.linalg import eigh, null_space

import statejump as sj
from statejump.bodies.body import CondensedBody
from statejump.bodies.condense import deck as decks
from statejump.bodies.condense import run
from statejump.kinds.truss.importing.to_case import Units
from studies.calculix.bracket_decks import bracket

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
ABC = ["A", "B", "C"]
TURN = np.array([[0.0, -0.6, 0.8], [1.0, 0.0, 0.0], [0.0, 0.8, 0.6]])  # from the axes of the body
MOST = 12


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("deck") / "bracket.inp"
    made.write_text(bracket(fine=False))
    return made


@pytest.fixture(scope="module")
def body(path: Path) -> CondensedBody:
    return sj.body.condense(path, ABC, modes=MOST)


def first(body: CondensedBody, modes: int) -> CondensedBody:
    """Return the body with its first modes only."""
    kept = slice(0, body.interface_dofs + modes)
    assert body.mass is not None
    return attrs.evolve(body, stiffness=body.stiffness[kept, kept], mass=body.mass[kept, kept], mesh=None,
                        free_shapes=body.free_shapes[:, kept])


def case(body: CondensedBody, **more: Any) -> Any:
    """Return the bracket on its foot, rotated in space."""
    foot = {"fixed": ["x", "y", "z"], "fixed_rotations": ["x", "y", "z"]}
    return sj.load({
        "case": {"name": "bracket", "kind": "truss"}, "truss": {"dimension": 3},
        "node": [{"name": name, "position_m": (TURN @ place).tolist(), **(foot if name == "C" else {})}
                 for name, place in zip(ABC, body.node_positions_m)],
        "body": [{"name": "bracket", "nodes": ABC, "content": body, "axis_x": TURN[:, 0].tolist(),
                  "axis_y": TURN[:, 1].tolist()}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 1.0, "period_s": 1e-3}, **more})


def of_mesh_Hz(path: Path, tmp_path: Path) -> np.ndarray:
    """Return frequencies of the whole mesh, the mean motion of its foot held."""
    deck = decks.read(path)
    mesh = run._stored(deck, Units(), tmp_path)
    foot = run._interface(deck, "C", {}, deck.faces())
    free = null_space(np.asarray(foot.rows @ mesh.picks(foot.nodes)))
    # With reduced integration, the mass is singular; the stiffness is not.
    inverse = eigh(free.T @ (mesh.mass @ free), free.T @ (mesh.stiffness @ free), eigvals_only=True)[::-1][:6]
    return np.asarray(1 / np.sqrt(inverse) / (2 * np.pi))


def test_frequencies_converge_with_modes(body: CondensedBody, path: Path, tmp_path: Path) -> None:
    expected = of_mesh_Hz(path, tmp_path)
    errors = np.array([sj.modes(case(first(body, modes)), 6).frequency_Hz / expected - 1 for modes in (0, 6, 12)])
    assert (errors > -1e-9).all()  # a reduced model is stiffer
    assert (errors[1:] < errors[:-1]).all(), errors
    assert errors[0].max() > 0.05 and errors[1].max() < 1.5e-2 and errors[2].max() < 2e-3, errors


def test_free_body_has_the_frequencies_of_its_check(body: CondensedBody) -> None:
    made = case(body).origin.document
    nodes = [{key: value for key, value in node.items() if not key.startswith("fixed")} for node in made["node"]]
    found = sj.modes(sj.load({**made, "node": nodes, "truss": {"dimension": 3, "free": True}}), 12)
    assert found.frequency_Hz[:6] == pytest.approx(np.zeros(6), abs=1e-3)
    assert found.frequency_Hz[6:] == pytest.approx(sj.body.check(body).free_Hz[6:12], rel=1e-6)
    assert found.mass_kg == pytest.approx([body.measured.mass_kg] * 3, rel=1e-6)


def test_motion_notes_modes_that_it_does_not_use(body: CondensedBody) -> None:
    moved = case(first(body, 6), motion={"steps_per_cycle": 40}).reduced(dynamic=True)
    assert [note.code for note in moved.warnings] == ["body_without_modes"]
