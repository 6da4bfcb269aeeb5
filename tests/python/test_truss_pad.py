# SPDX-License-Identifier: GPL-3.0-or-later
"""Pads against closed forms: friction of a heated bar, lift-off, invariance under rotations."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import statejump as sj
from statejump.core.errors import StatejumpError

AXIAL_N, LENGTH_M, EXPANSION_PER_K, SPRING_N_PER_M, WEIGHT_N, FRICTION = 7e5, 1.0, 2e-5, 2e5, 400.0, 0.25
STIFF_N_PER_M = 1e12  # of a pad that deflects by 1e-9 of the slides of 1e-3 m


def turn(angle: float) -> np.ndarray:
    """Return a rotation about an axis without symmetry."""
    x, y, z = np.array([0.3, -0.5, 0.8]) / np.linalg.norm([0.3, -0.5, 0.8])
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def pad_case(axes: np.ndarray | None = None, dimension: int = 3, *, load_N: float = -WEIGHT_N, way: float = 0.0,
             **pad: Any) -> Any:
    """Return a bar along x that pushes a block on a plane against a spring; the load presses the block on the plane.

    :param way: angle of the bar against x in the plane
    """
    turned = np.eye(3) if axes is None else axes
    along, normal = np.array([np.cos(way), np.sin(way), 0.0]), np.array([0.0, 0.0, 1.0])
    if dimension == 2:
        normal = np.array([0.0, 1.0, 0.0])

    def vector(given: np.ndarray) -> list[float]:
        return [float(value) for value in (turned @ given)[:dimension]]

    every = ["x", "y", "z"][:dimension]
    bar = {"young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-5, "density_kg_per_m3": 2700.0}
    post = {**bar, "thermal_expansion_per_K": 0.0}
    nodes = [{"name": "A", "position_m": vector(0 * along), "fixed": every},
             {"name": "B", "position_m": vector(along), "force_N": vector(load_N * normal)},
             {"name": "C", "position_m": vector(2 * along), "fixed": every}]
    more = []
    if dimension == 3:  # a strut across the bar in the plane, so that the block has one path
        across = np.array([-np.sin(way), np.cos(way), 0.0])
        nodes.append({"name": "D", "position_m": vector(along + across), "fixed": every})
        more = [{"name": "strut", "nodes": ["B", "D"], **post}]
    return sj.load({
        "case": {"name": "pad", "kind": "truss"}, "truss": {"dimension": dimension}, "node": nodes,
        "link": [{"name": "bar", "nodes": ["A", "B"], "thermal_expansion_per_K": EXPANSION_PER_K, **bar}, *more],
        "spring": [{"name": "K", "nodes": ["B", "C"], "stiffness_N_per_m": SPRING_N_PER_M}],
        "pad": [{"name": "P", "nodes": ["B"], "normal": vector(normal), "friction_coefficient": FRICTION,
                 "normal_stiffness_N_per_m": STIFF_N_PER_M, **pad}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 100.0, "cycles": 2, "period_s": 1.0}})


def displacement_m(case: Any, name: str = "B") -> np.ndarray:
    """Return the displacements (times, 3) of a node."""
    place = [node.name for node in case.node].index(name)
    return np.asarray(case.reduced().history["displacement_m"].values[:, place])


@pytest.mark.parametrize("dimension", (2, 3))
def test_residual_slide_is_that_of_friction(dimension: int) -> None:
    """After a cycle that slips both ways, friction holds the block at F/(k + K) from its first place."""
    moved = displacement_m(pad_case(dimension=dimension))[-1, 0]
    expected = FRICTION * WEIGHT_N / (AXIAL_N / LENGTH_M + SPRING_N_PER_M)
    # The solver's bar takes strains relative to the heated length: αΔT changes stiffness by 2e-3 at most; cold, none.
    # The vertical deflection of the pad and slide squared over the length rotate the bar by 1e-3.
    assert abs(abs(moved) - expected) <= 2e-6 * expected


def test_rotated_and_in_any_direction() -> None:
    here = displacement_m(pad_case(way=0.4, normal_stiffness_N_per_m=1e8))
    there = displacement_m(pad_case(turn(1.3), way=0.4, normal_stiffness_N_per_m=1e8))
    assert np.abs(here @ turn(1.3).T - there).max() <= 1e-9 * np.abs(here).max()
    along = displacement_m(pad_case(normal_stiffness_N_per_m=1e8))
    assert np.abs(np.linalg.norm(here, axis=1) - np.linalg.norm(along, axis=1)).max() <= 1e-9 * np.abs(along).max()


def test_force_of_the_spring_and_clearance() -> None:
    """The block sinks by the clearance and W/k_n; the friction of the slipping pad is at its limit."""
    run = pad_case(normal_stiffness_N_per_m=1e6, clearance_m=1e-4).reduced()
    sunk = run.history["displacement_m"].values[0, 1, 2]
    # The links that hold the block sideways carry some of the load as they turn, by the sinking over their length.
    assert abs(sunk + 1e-4 + WEIGHT_N / 1e6) <= 5e-3 * abs(sunk)
    friction = np.linalg.norm(run.history["pad_friction_N"].values[:, 0], axis=1)
    pressed = run.history["pad_normal_force_N"].values[:, 0]
    assert (friction <= FRICTION * pressed * (1 + 1e-9)).all()
    assert friction.max() >= FRICTION * pressed.min() * (1 - 1e-9)


def test_lifted_pad_is_open() -> None:
    """A spring lifts the block as the bar cools: the pad opens and closes again."""
    case = pad_case()
    data = case.origin.document
    lifted = {"name": "lift", "nodes": ["B", "E"], "stiffness_N_per_m": 1e4, "free_length_m": 0.9}
    node = {"name": "E", "position_m": [1.0, 0.0, 1.0], "fixed": ["x", "y", "z"]}
    run = sj.load({**data, "node": [*data["node"], node], "spring": [*data["spring"], lifted]}).reduced()
    assert (run.history["pad_normal_force_N"].values == 0).all()
    assert np.all(run.history["pad_friction_N"].values == 0)


def test_energy_balances_while_the_direction_of_slip_turns() -> None:
    """Two bars at right angles follow programs out of phase, so the slide of the block turns."""
    data = pad_case(friction_coefficient=0.1, normal_stiffness_N_per_m=1e7).origin.document
    links = [data["link"][0], {**data["link"][1], "thermal_expansion_per_K": EXPANSION_PER_K, "program": "late"}]
    late = {"name": "late", "shape": "table", "table_time_s": [0.0, 0.5, 1.0],
            "table_temperature_change_K": [0.0, 50.0, 0.0]}
    thermal = {"shape": "table", "table_time_s": [0.0, 0.25, 0.75, 1.0],
               "table_temperature_change_K": [0.0, 50.0, -50.0, 0.0], "cycles": 2}
    run = sj.load({**data, "link": links, "program": [late], "thermal": thermal}).reduced()
    heat = run.energy["friction_dissipation_J"].values
    assert heat[-1] > 0 and (np.diff(heat) >= -1e-12 * heat[-1]).all()
    # The balance closes to second order in the 50 increments of a branch.
    assert abs(run.summary["energy_residue_J"]) <= 50**-2 * heat[-1]


@pytest.mark.parametrize(("keys", "code"), [
    ({"normal": [0.0, 0.0, 0.0]}, "zero_vector"),
    ({"normal": [0.0, 1.0]}, "wrong_dimension"),
    ({"nodes": ["B", "B"]}, "equal_nodes"),
    ({"nodes": ["X"]}, "undefined_reference"),
    ({"friction_coefficient": -0.1}, "out_of_range"),
])
def test_wrong_keys_are_refused(keys: dict[str, Any], code: str) -> None:
    with pytest.raises(StatejumpError) as refused:
        pad_case(**keys)
    assert refused.value.code == code


def test_models_without_pads_say_so() -> None:
    keys = {"motion.scheme": "regularised", "motion.masses": "lumped", "reduced.sticking": "elastic"}
    with pytest.raises(StatejumpError) as refused:
        pad_case().changed(keys).reduced(dynamic=True)
    assert refused.value.code == "regularised_not_supported"
