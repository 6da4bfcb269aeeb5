# SPDX-License-Identifier: GPL-3.0-or-later
"""Features for spatial trusses: guide planes, and torsion springs in planes of any orientation."""
import pytest

EPS = 2.0**-52


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("truss.py")


def dot(one, other):
    return sum(a * b for a, b in zip(one, other))


def test_a_body_stays_in_its_plane_and_moves_freely_in_it(seen):
    run = seen["guide"]
    normal, time, dt = run["normal"], run["time"], run["dt"]
    moved = [a - b for a, b in zip(run["position"], (0.1, 0.2, 0.3))]
    # Roundings of positions below 1 m, one a step, all to one side.
    assert abs(dot(moved, normal)) < 1000 * EPS
    assert abs(dot(run["velocity"], normal)) < EPS
    for axis in range(3):
        force = run["force"][axis] - dot(run["force"], normal) * normal[axis]
        start = (1, 0, 0)[axis] - normal[0] * normal[axis]
        # Leapfrog from rest: the velocity belongs to half a step later.
        assert run["velocity"][axis] == pytest.approx(start + force / 0.5 * time, abs=1e-12)
        assert moved[axis] == pytest.approx(start * time + force / 0.5 * time * (time + dt) / 2, abs=1e-12)


def test_a_torsion_spring_turned_in_space_is_the_same(seen):
    flat, turned = seen["spring"]
    assert abs(flat["moment"]) > 0.1
    assert turned["angle"] == pytest.approx(flat["angle"], abs=20 * EPS)
    for one, other in zip(flat["forces"], turned["forces"]):
        # Forces up to 3 N, from places with some roundings over links of 0.3 m.
        assert other == pytest.approx(one, abs=200 * EPS)


@pytest.mark.parametrize(("case", "fault"), [
    ("length", "not_allowed GuidePlanes.normals = 2"), ("axis", "not_allowed TorsionSpring.axis = 0.5"),
    ("count", "other_number GuidePlanes = 1"), ("body", "no_body GuidePlanes.ids = 7"),
])
def test_wrong_use_is_said(seen, case, fault):
    kind, text = seen["wrong"][case]
    assert kind in ("ValueError", "RuntimeError") and text == fault
