# SPDX-License-Identifier: GPL-3.0-or-later
"""Latch hinges: closed forms of a lever, a torsion spring as one without play, what the case, drawing and commands say."""
from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import Outcome
from test_report import pytestmark as needs_page

from statejump.core.errors import StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import generate, solve
from statejump.kinds.truss.contact_problems import contact_problems
from statejump.kinds.truss.generate.document import document, finished, node, to_toml

L_M, H_M, RIGIDITY_N, EXPANSION = 0.5, 0.4, 7e5, 2e-5
PLAY_RAD, STIFFNESS, FRICTION_N_M = 5e-4, 200.0, 3.0


def lever(**hinge: Any) -> dict[str, Any]:
    """A lever AB on a latch hinge to the ground, which a strut CB lifts when it is heated by 100 K."""
    made = document("lever", "Lever on a latch hinge", "closed form", 2, 100.0, "triangle", 1, 1.0)
    made["node"] += [node("A", (0, 0), "xy"), node("B", (L_M, 0)), node("C", (L_M, -H_M), "xy")]
    bar = {"young_modulus_Pa": 70e9, "cross_section_area_m2": RIGIDITY_N / 70e9, "density_kg_per_m3": 2700.0}
    made["link"] += [{"name": "AB", "nodes": ["A", "B"], **bar, "thermal_expansion_per_K": 0.0},
                     {"name": "CB", "nodes": ["C", "B"], **bar, "thermal_expansion_per_K": EXPANSION}]
    made["latch_hinge"] = [{
        "name": "latch", "links": ["AB"], "deadband_rad": PLAY_RAD, "stiffness_N_m_per_rad": STIFFNESS,
        "friction_moment_N_m": FRICTION_N_M, **hinge,
    }]
    return finished(made)


def path(made: dict[str, Any], **options: Any) -> solve.TrussPath:
    return solve.path(parse_case(made).resolve(), **options)


# Rotations are 1e-3: a lever of L turns by its lift over L, and the strut stays upright, to a thousandth of that.
SMALL = 2e-3


def test_lever_slips_goes_through_its_play_and_jumps_as_the_closed_form() -> None:
    """The strut's free growth is the lift and what the moment over L compresses it by: eps H = L phi + c M, with
    c = H / (E A L)."""
    found = path(lever())
    states, compliance = found.states, H_M / (RIGIDITY_N * L_M)
    slip, turn, back = found.events[0], found.events[1], found.events[2]
    assert [event.after for event in (slip, turn, back)] == ["slip_plus", "stick", "slip_minus"]
    assert slip.temperature_change_K == pytest.approx(compliance * FRICTION_N_M / (EXPANSION * H_M), rel=SMALL)
    hot = int(np.argmax(states["temperature_change_K"]))
    growth = EXPANSION * 100.0 * H_M
    highest = (growth - compliance * (FRICTION_N_M - STIFFNESS * PLAY_RAD)) / (L_M + compliance * STIFFNESS)
    assert highest > 2 * PLAY_RAD
    rotation, moment = states["hinge_rotation_rad"][:, 0], states["hinge_moment_N_m"][:, 0]
    assert rotation[hot] == pytest.approx(highest, rel=SMALL)
    assert moment[hot] == pytest.approx(FRICTION_N_M + STIFFNESS * (highest - PLAY_RAD), rel=SMALL)
    # Cooling turns the friction's moment round before the lever moves.
    turned = 2 * compliance * FRICTION_N_M / (EXPANSION * H_M)
    assert 100.0 - back.temperature_change_K == pytest.approx(turned, rel=5 * SMALL)
    # At the end only friction is left, and keeps the lever up.
    assert moment[-1] == pytest.approx(-FRICTION_N_M, rel=1e-9)
    assert rotation[-1] == pytest.approx(compliance * FRICTION_N_M / L_M, rel=SMALL)
    # The moment is that of the strut: statics, exact at the turned place.
    place = found.truss.nodes.position_m[1] + states["displacement_m"][:, 1]
    strut = place - found.truss.nodes.position_m[2]
    along = strut / np.linalg.norm(strut, axis=1)[:, None]
    arm = place[:, 0] * along[:, 1] - place[:, 1] * along[:, 0]
    assert moment == pytest.approx(states["axial_force_N"][:, 1] * arm, rel=1e-9, abs=1e-9)
    # Heat: the friction's moment over all that the hinge turned, both ways.
    heat = FRICTION_N_M * (2 * rotation.max() - rotation[-1])
    assert states["latch_hinge_dissipation_J"][-1, 0] == pytest.approx(heat, rel=1e-6)
    # Thermal work by the trapezoidal rule between 50 points of a branch.
    assert abs(found.energy_residue_J) < 1e-3 * heat


def test_increments_do_not_matter() -> None:
    few, many = (path(lever(), increments_per_branch=k, locate_events=False) for k in (3, 200))
    ends = [found.cycle_ends["displacement_m"][-1] for found in (few, many)]
    assert ends[0] == pytest.approx(ends[1], rel=0, abs=1e-6 * np.abs(ends[1]).max())


def test_hinge_without_play_and_friction_is_a_torsion_spring() -> None:
    spring = generate.umbrella(1)
    latch = {**spring, "latch_hinge": [{
        "name": "latch", "links": ["AB", "CB"], "deadband_rad": 0.0, "stiffness_N_m_per_rad": 1.0,
        "preload_moment_N_m": -0.05,
    }]}
    del latch["torsion_spring"]
    one, other = path(spring), path(latch)
    changes = [[event.after for event in found.events if event.name == "joint"] for found in (one, other)]
    assert changes[0] == changes[1]
    assert one.cycle_ends["displacement_m"] == pytest.approx(other.cycle_ends["displacement_m"], rel=0, abs=1e-13)


def test_moment_that_only_the_latch_could_hold_leaves_a_mechanism() -> None:
    """Within its play, without friction, nothing holds the links of a rib."""
    made = generate.umbrella(1)
    del made["torsion_spring"]
    made["latch_hinge"] = [{"name": "latch", "links": ["AB", "CB"], "deadband_rad": 0.1,
                            "stiffness_N_m_per_rad": 1.0}]
    with pytest.raises(StatejumpError, match="statics does not determine its position in the play"):
        path(made)


def test_runs_have_its_columns_and_its_events() -> None:
    case = parse_case(lever())
    run = case.behaviour.reduced(case, lambda share: None)
    assert run.history["hinge_moment_N_m"].unit == "N m" and run.history["hinge_rotation_rad"].items == "latch_hinges"
    assert run["friction_dissipation_J"][-1] > 0
    assert [event.kind for event in run.events][:1] == ["first_slip"] and run.events[0].joint == "latch"
    problems = contact_problems(case, 6)
    assert max(one.merit.largest for one in problems) <= 1e-10


def test_commands(statejump: Callable[..., Outcome], tmp_path: Path) -> None:
    case = tmp_path / "lever.toml"
    case.write_text(to_toml(lever()))
    for words in (("reduced",), ("truss", "draw"), ("truss", "answers", "--no-sensitivity")):
        done = statejump(*words[:2] if words[0] == "truss" else words, case, *words[2:])
        assert done.status == 0, (words, done.errors)
    assert statejump("info", tmp_path / "results" / "lever" / "reduced.h5").status == 0
    done = statejump("compare", case)
    assert done.status == 2 and done.errors.count("\n") == 1
    assert "latch_hinge 'latch' is a joint of the quasi-static solver only, the DEM has none" in done.errors
    moving = statejump("reduced", "--dynamic", case)
    assert moving.status == 2 and "latch_hinge 'latch' is a joint of quasi-static paths only" in moving.errors


@needs_page
@pytest.mark.parametrize("command", [("reduced",), ("truss", "answers")])
def test_page(statejump: Callable[..., Outcome], tmp_path: Path, command: tuple[str, ...]) -> None:
    case = tmp_path / "lever.toml"
    case.write_text(to_toml(lever()))
    assert statejump(*command, case).status == 0
    report = statejump("report", tmp_path / "results" / "lever")
    assert report.status == 0, report.errors
    assert "1 latch hinge with a free play of ±" in (tmp_path / "results" / "lever" / "report.html").read_text()


@pytest.mark.parametrize("change, sentence", [
    ({"deadband_rad": -1e-3}, "latch_hinge 'latch': deadband_rad = -0.001 is not allowed: must be between 0 and"),
    ({"links": ["AX"]}, "there is no link 'AX'"),
    ({"links": ["AB", "AB"]}, "must be two different links"),
    ({"axis": [0.0, 0.0, 1.0]}, "in a planar truss it is z"),
])
def test_mistakes(change: dict[str, Any], sentence: str) -> None:
    with pytest.raises(StatejumpError) as refused:
        parse_case(lever(**change)).resolve()
    assert sentence in str(refused.value)
