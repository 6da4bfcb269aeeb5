# SPDX-License-Identifier: GPL-3.0-or-later
"""Condensed bodies: arrays, files, what reading measures, and the cause that a refusal names."""
from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import BUILT
from failures import failing, note
from frames import EXPANSION, NAMES, POSITIONS_M, expanded, mass, stiffness
import statejump as sj
from statejump.bodies import CondensedBody, Mesh, Points

h5py = pytest.importorskip("h5py")


def turn(angle: float) -> np.ndarray:
    """A rotation about z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def made(given: np.ndarray | None = None, positions_m: np.ndarray = POSITIONS_M, **more: Any) -> CondensedBody:
    return sj.body.from_arrays(NAMES, positions_m, stiffness() if given is None else given, **more)


def test_rigid_motions_cause_no_force_after_projection() -> None:
    body = made()
    assert body.measured.rigid_error < 1e-13
    worst = np.abs(body.stiffness @ body.rigid_motions).max() / np.abs(body.stiffness).max()
    assert worst < 2e-16 * 18
    assert np.array_equal(body.stiffness, body.stiffness.T)
    assert body.interface_dofs == 18 and body.modes == 0 and body.node_starts.tolist() == [0, 6, 12]
    with pytest.raises(ValueError, match="read-only"):
        body.stiffness[0, 0] = 1.0


def test_file_keeps_every_array(tmp_path: Path) -> None:
    points = Points(("tip",), np.array([[0.1, 0.0, 0.0]]), np.arange(54.0).reshape(3, 18), np.array([[1.0, 2.0, 3.0]]))
    mesh = Mesh(POSITIONS_M, np.array([[0, 1, 2]]), np.ones((9, 18)), np.ones((1, 9)))
    body = made(pattern_names=["warm"], free_shapes=[expanded()], mass=mass(), points=points, mesh=mesh,
                reference_temperature_K=293.15, source="a test", patch="mean")
    sj.body.write(tmp_path / "one.h5", body)
    found = sj.body.read(tmp_path / "one.h5")
    assert (found.node_names, found.pattern_names, found.source, found.patch) == (NAMES, ("warm",), "a test", "mean")
    assert found.reference_temperature_K == 293.15
    assert found.points is not None and found.mesh is not None and found.mass is not None
    for name in ("node_positions_m", "node_freedoms", "free_shapes", "mass"):
        assert np.array_equal(getattr(found, name), getattr(body, name)), name
    assert np.allclose(found.stiffness, body.stiffness, rtol=0, atol=1e-14 * np.abs(body.stiffness).max())
    for name in ("names", "positions_m", "rows", "patterns"):
        assert np.array_equal(getattr(found.points, name), getattr(points, name)), name
    for name in ("points_m", "cells", "rows", "patterns"):
        assert np.array_equal(getattr(found.mesh, name), getattr(mesh, name)), name
    sj.body.write(tmp_path / "two.h5", body)
    assert (tmp_path / "one.h5").read_bytes() == (tmp_path / "two.h5").read_bytes()


def write_raw(path: Path, **changed: Any) -> Path:
    """Write a file with h5py only. None leaves an array out."""
    arrays = {"node/name": list(NAMES), "node/position_m": POSITIONS_M, "node/freedoms": [6, 6, 6],
              "stiffness": stiffness(), **changed}
    with h5py.File(path, "w") as file:
        file.attrs.update({"format": "statejump condensed body", "version": 1, "units": "SI"})
        for name, values in arrays.items():
            if name.startswith("@"):
                file.attrs[name[1:]] = values
            elif values is not None:
                file[name] = values
    return path


def test_file_of_another_program_is_read(tmp_path: Path) -> None:
    found = sj.body.read(write_raw(tmp_path / "other.h5"))
    assert found.node_names == NAMES and not found.pattern_names and found.mass is None
    assert found.free_shapes.shape == (0, 18)


@pytest.mark.parametrize(("changed", "code", "fields"), [
    ({"stiffness": None}, "body_data_missing", {"data_set": "stiffness"}),
    ({"node/name": [1, 2, 3]}, "body_data_type", {"data_set": "node/name"}),
    ({"node/position_m": ["a", "b", "c"]}, "body_data_type", {"data_set": "node/position_m"}),
    ({"@format": "other"}, "body_format", {}),
    ({"@version": 2}, "body_version", {"found": "2"}),
    ({"@units": "mm"}, "body_file_units", {"found": "mm"}),
    ({"node/name": ["A", "A", "B"]}, "body_names", {"key": "node/name", "value": "A"}),
    ({"node/freedoms": [6, 6, 5]}, "body_freedoms", {"nodes_": 3}),
    ({"node/freedoms": [6, 6]}, "body_freedoms", {"nodes_": 3}),
    ({"node/position_m": POSITIONS_M[:2]}, "body_shape", {"shape": [2, 3], "wanted": [3, 3]}),
    ({"stiffness": stiffness()[:, :17]}, "body_stiffness_shape", {"shape": [18, 17], "dofs": 18}),
    ({"stiffness": np.full((18, 18), np.nan)}, "body_not_finite", {"key": "stiffness"}),
    ({"pattern/name": ["warm"]}, "body_shapes_missing", {"patterns": 1}),
    ({"pattern/name": ["warm"], "pattern/free_shape": [expanded()], "pattern/load": [expanded()]},
     "body_loads_and_shapes", {}),
    ({"mass": mass() * 0 - np.eye(18)}, "body_mass_negative", {}),
    ({"mass": np.triu(np.ones((18, 18)))}, "body_mass_not_symmetric", {"error": 1.0}),
    ({"@patch": "soft"}, "body_patch", {"value": "soft"}),
    ({"mesh/cells": [[0, 1, 3]], "mesh/point_m": POSITIONS_M}, "body_mesh", {}),
])
def test_damaged_file_is_refused(tmp_path: Path, changed: dict[str, Any], code: str, fields: dict[str, Any]) -> None:
    with failing(code, file="x.h5", **fields):
        sj.body.read(write_raw(tmp_path / "x.h5", **changed))


def test_damaged_bytes_are_refused(tmp_path: Path) -> None:
    sj.body.write(tmp_path / "x.h5", made())
    raw = bytearray((tmp_path / "x.h5").read_bytes())
    raw[-100] ^= 1
    (tmp_path / "x.h5").write_bytes(raw)
    with failing("result_checksum", file="x.h5"):
        sj.body.read(tmp_path / "x.h5")
    with failing("file_not_found", file="y.h5"):
        sj.body.read(tmp_path / "y.h5")


def ordered(order: list[int]) -> np.ndarray:
    return stiffness()[np.ix_(order, order)]


def rotated(block: np.ndarray, node: int) -> np.ndarray:
    axes = np.eye(18)
    for first in (6 * node, 6 * node + 3):
        axes[first:first + 3, first:first + 3] = block
    return np.asarray(axes @ stiffness() @ axes.T)


def shifted(node: int, offset: np.ndarray) -> np.ndarray:
    """Stiffness whose dofs of one node are those of a point beside it."""
    x, y, z = -offset
    arm = np.eye(18)
    arm[6 * node:6 * node + 3, 6 * node + 3:6 * node + 6] = [[0, z, -y], [-z, 0, x], [y, -x, 0]]
    return np.asarray(arm.T @ stiffness() @ arm)


BY_NODE = [6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 4, 5, *range(12, 18)]
WRONG = {
    "axes of one node": (lambda: rotated(turn(0.5), 1), "body_axes", {"node": "B", "other": "A"}),
    "axes of the first": (lambda: rotated(turn(0.5), 0), "body_axes", {"node": "A", "other": "B"}),
    "left-handed": (lambda: rotated(np.diag([1.0, -1.0, 1.0]), 2), "body_sign", {"node": "C", "other": "A"}),
    "two nodes swapped": (lambda: ordered(BY_NODE), "body_row_order_named", {"node": "A", "other": "B"}),
    "by direction": (lambda: ordered([6 * n + k for k in range(6) for n in range(3)]), "body_dof_order",
                     {"order": "direction by direction"}),
    "translations first": (lambda: ordered([6 * n + k + d for d in (0, 3) for n in range(3) for k in range(3)]),
                           "body_dof_order", {"order": "all translations first"}),
    "rotations first": (lambda: ordered([6 * n + (k + 3) % 6 for n in range(3) for k in range(6)]), "body_dof_order",
                        {"order": "rotations before translations"}),
    "rotations elsewhere": (lambda: shifted(1, np.array([0.0, 0.01, 0.0])), "body_arm",
                            {"node": "B", "offset_m": [0.0, 0.01, 0.0]}),
    "support": (lambda: stiffness() + np.diag([1e7] * 3 + [1e4] * 3 + [0.0] * 12), "body_held", {}),
    "reversed": (lambda: -stiffness(), "body_negative", {}),
    "upper triangle": (lambda: np.triu(stiffness()), "body_triangle", {}),
    "columns swapped": (lambda: stiffness()[:, BY_NODE], "body_not_symmetric", {}),
    "signs of rows": (lambda: stiffness() - 1e7 * np.eye(18),
                      "body_indefinite_rows", {}),
}


@pytest.mark.parametrize("name", WRONG)
def test_refusal_names_the_probable_cause(name: str) -> None:
    given, code, fields = WRONG[name]
    with failing(code, **fields):
        made(given())


def test_other_units_of_positions_are_named() -> None:
    with failing("body_units", unit="millimetres", factor=1000.0) as caught:
        made(stiffness(1000 * POSITIONS_M))
    assert caught.value.exit_status == 2
    degrees = np.tile([1.0] * 3 + [np.pi / 180] * 3, 3)
    with failing("body_units", unit="degrees for rotations"):
        made(stiffness() * np.outer(degrees, degrees))


def test_swapped_nodes_of_three_dofs_are_named() -> None:
    """A solid tetrahedron: bars between four nodes, whose two first rows are swapped."""
    positions = np.array([[0.0, 0, 0], [1, 0.1, 0], [0.2, 1.3, 0], [0.3, 0.4, 0.9], [1.2, 1.1, 1.0]])
    found = np.zeros((15, 15))
    for first in range(5):
        for second in range(first):
            along = positions[first] - positions[second]
            bar = np.zeros(15)
            bar[3 * first:3 * first + 3], bar[3 * second:3 * second + 3] = along, -along
            found += np.outer(bar, bar)
    names = ["1", "2", "3", "4", "5"]
    assert sj.body.from_arrays(names, positions, found, node_freedoms=[3] * 5).measured.rigid_error < 1e-14
    with failing("body_row_order"):
        sj.body.from_arrays(names, positions[[1, 0, 2, 3, 4]], found, node_freedoms=[3] * 5)


def test_few_digits_are_noted_and_removed() -> None:
    random = np.random.default_rng(1)
    noise = random.normal(size=(18, 18))
    body = made(stiffness() * (1 + 1e-7 * (noise + noise.T)))
    assert note("body_digits") == body.notes[0]
    assert 1e-9 < body.measured.rigid_error < 1e-5 and 5 < body.measured.digits < 9
    assert np.abs(body.stiffness @ body.rigid_motions).max() < 1e-14 * np.abs(body.stiffness).max()


def test_bar_is_a_body_without_bending() -> None:
    along = np.array([-1.0, 0, 0, 1, 0, 0])
    body = sj.body.from_arrays(["1", "2"], [[0, 0, 0], [1, 0, 0]], 2.8e7 * np.outer(along, along), node_freedoms=[3, 3])
    assert body.measured.free_motions == 0 and body.measured.softest == pytest.approx(1.0)


def test_loads_become_free_shapes_of_the_same_forces() -> None:
    loads = stiffness() @ expanded()
    body = made(pattern_names=["warm"], loads=[loads])
    assert np.abs(body.stiffness @ body.free_shapes[0] - loads).max() < 1e-12 * np.abs(loads).max()
    rest = body.free_shapes[0] - expanded()
    motion = np.linalg.lstsq(body.rigid_motions, rest, rcond=None)[0]
    assert np.abs(rest - body.rigid_motions @ motion).max() < 1e-11 * EXPANSION
    with failing("body_load_resultant", pattern="warm"):
        made(pattern_names=["warm"], loads=[loads + np.eye(18)[0]])
    nearly = made(pattern_names=["warm"], loads=[loads + 1e-7 * np.abs(loads).max() * np.eye(18)[0]])
    assert note("body_load_digits") in list(nearly.notes)


def test_mass_of_rigid_motions_is_measured() -> None:
    body = made(mass=mass())
    assert body.measured.mass_kg == pytest.approx(3.0) and not body.notes
    uneven = made(mass=mass() + np.diag([1.0] + [0.0] * 17))
    assert note("body_mass_directions") in list(uneven.notes)


def test_modes_follow_the_nodes() -> None:
    both = np.zeros((20, 20))
    both[:18, :18], both[18, 18], both[19, 19] = stiffness(), 1e5, 4e5
    body = made(both)
    assert body.modes == 2 and body.measured.rigid_error < 1e-13
    assert not body.rigid_motions[18:].any()


def test_kinds_may_import_bodies() -> None:
    code = ("import sys; import statejump.bodies.body, statejump.bodies.files; "
            "print(sorted(name for name in sys.modules if name.startswith('statejump.kinds')))")
    done = subprocess.run([sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": str(BUILT)},
                          capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
