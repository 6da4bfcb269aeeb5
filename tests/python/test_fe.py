# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of CalculiX and the reduced model. CalculiX shares no code with this project."""
from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest
from conftest import Outcome
from failures import Failure, failure

import statejump as sj
from statejump.core.errors import StatejumpError
from statejump.kinds.truss.generate.document import to_toml
from studies import calculix
from studies.calculix import cases, frame as frames
from studies.calculix.spring_slider import kinks

BAR = {"young_modulus_Pa": 7e10, "cross_section_area_m2": 1e-4, "thermal_expansion_per_K": 2.3e-5,
       "density_kg_per_m3": 2700.0}


def truss(dimension: int = 2, **more: Any) -> dict[str, Any]:
    """Return a square of bars with both diagonals, or a tetrahedron on three supports; ΔT differs between bars."""
    if dimension == 2:
        points = {"A": [0.0, 0.0], "B": [1.0, 0.0], "C": [1.0, 1.1], "D": [0.1, 0.9]}
        pairs = ["AD", "BC", "DC", "AC", "BD"]
    else:
        points = {"A": [0.0, 0.0, 0.0], "B": [1.0, 0.0, 0.0], "C": [0.3, 1.1, 0.0], "E": [0.9, 0.9, 0.1],
                  "D": [0.4, 0.4, 0.8]}
        pairs = ["AD", "BD", "CD", "ED"]
    links = [{"name": pair, "nodes": list(pair), "temperature_fraction": round(1 - 0.3 * place, 3), **BAR}
             for place, pair in enumerate(pairs)]
    held = "AB" if dimension == 2 else "ABCE"
    nodes = [{"name": name, "position_m": where, **({"fixed": list("xyz"[:dimension])} if name in held else {})}
             for name, where in points.items()]
    nodes[-1]["force_N"] = [300.0, -500.0, 200.0][:dimension]
    return {"case": {"name": "held", "kind": "truss"}, "truss": {"dimension": dimension}, "node": nodes, "link": links,
            "thermal": {"shape": "triangle", "temperature_change_max_K": 100.0}, **more}


def free() -> dict[str, Any]:
    """Return a triangle on a pin and a roller, which expands without force."""
    data = truss()
    data["node"] = [{"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
                    {"name": "B", "position_m": [1.0, 0.0], "fixed": ["y"]}, {"name": "C", "position_m": [0.0, 1.0]}]
    data["link"] = [{"name": pair, "nodes": list(pair), **BAR} for pair in ("AB", "AC", "BC")]
    return data


def with_slider() -> dict[str, Any]:
    """Return the square with a locked slider on a tilted axis."""
    data = truss()
    data["node"][2]["guide_normal"] = [-0.6, 0.8]
    data["slider"] = [{"name": "S", "nodes": ["C"], "axis": [0.8, 0.6], "friction_coefficient": 0.3,
                       "normal_force_N": 10.0}]
    return data


def with_iwan_joint() -> dict[str, Any]:
    """Return the square with a locked bolted joint within a diagonal."""
    data = truss()
    data["node"].append({"name": "J", "position_m": data["node"][2]["position_m"]})
    data["link"][3]["nodes"] = ["A", "J"]
    data["iwan_joint"] = [{"name": "I", "nodes": ["J", "C"], "axis": [1.0, 1.1], "tangent_stiffness_N_per_m": 1e7,
                           "slip_force_N": 100.0, "exponent": -0.5, "stiffness_ratio": 1.0}]
    return data


def between_walls() -> dict[str, Any]:
    """Return a bar held at both ends, so that nothing moves."""
    data = truss()
    data["node"] = [{"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
                    {"name": "M", "position_m": [0.5, 0.0], "fixed": ["y"]},
                    {"name": "B", "position_m": [1.0, 0.0], "fixed": ["x", "y"]}]
    data["link"] = [{"name": pair, "nodes": list(pair), **BAR} for pair in ("AM", "MB")]
    return data


def with_revolute() -> dict[str, Any]:
    """Return the square with a locked clearance joint at the end of a diagonal."""
    data = truss()
    data["node"].append({"name": "J", "position_m": data["node"][2]["position_m"]})
    data["link"][3]["nodes"] = ["A", "J"]
    data["revolute"] = [{"name": "R", "bearing_node": "C", "journal_node": "J", "bearing_link": "BC",
                         "journal_link": "AC", "journal_radius_m": 5e-3, "radial_clearance_m": 1e-5,
                         "friction_coefficient": 0.2}]
    return data


TRUSSES = {"free expansion": free, "statically indeterminate": truss, "in space": lambda: truss(3),
           "between walls": between_walls, "locked slider": with_slider, "locked revolute": with_revolute,
           "locked Iwan joint": with_iwan_joint}


with_calculix = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not here: not every Debian has it")


@with_calculix
@pytest.mark.parametrize("what", TRUSSES)
def test_a_truss_with_locked_joints_agrees_to_1e_8(what: str) -> None:
    found = calculix.answer(sj.load(TRUSSES[what]()).definition)
    moved, force, *_ = found.rows
    assert moved.passed and force.passed and (what == "between walls" or moved.values["reduced"] > 1e-4)
    assert what == "free expansion" or force.values["reduced"] > 100


@with_calculix
@pytest.mark.parametrize("what", ["free expansion", "statically indeterminate", "in space"])
def test_the_deck_of_a_truss_is_imported_again(what: str, statejump: Callable[..., Outcome], tmp_path: Path) -> None:
    case = sj.load(TRUSSES[what]())
    (tmp_path / "first.toml").write_text(to_toml(TRUSSES[what]()))
    for words in ("fe", "first.toml", "--results", "out"), ("truss", "import", f"out/{case.name}/fe.inp", "-o", "again.toml"):
        told = statejump(*words)
        assert told.status == 0, told.errors
    runs = case.reduced(), sj.load(tmp_path / "again.toml").reduced()
    for own, other in zip(*((run["displacement_m"], run.links["axial_force_N"].values) for run in runs)):
        # The deck has sixteen digits; forces of a free triangle are only rounding of the solver.
        assert np.abs(own - other).max() <= 1e-9 * max(np.abs(own).max(), 1e-3)


def with_play() -> dict[str, Any]:
    """Return the square with a slider between two stops in one diagonal. It is heated, returns, and is then cooled."""
    data = truss()
    data["node"].append({"name": "J", "position_m": data["node"][2]["position_m"]})
    data["link"][3]["nodes"] = ["A", "J"]
    data["slider"] = [{"name": "S", "nodes": ["J", "C"], "axis": [1.0, 1.1], "friction_coefficient": 0.2,
                       "normal_force_N": 500.0, "clearance_minus_m": 2e-4, "clearance_plus_m": 1e-4}]
    data["thermal"] = {"shape": "table", "table_time_s": [0, 1, 2, 3, 4], "table_temperature_change_K": [0, 100, 0, -80, 0]}
    return data


@with_calculix
@pytest.mark.parametrize("what", ["chain", "stops"])
def test_sliders_slip_in_both_alike(what: str) -> None:
    """Slipping sliders agree to some millionths, because of elastic sticking and strains of CalculiX's bricks."""
    case = sj.load("cases/trusses/chain_10.toml" if what == "chain" else with_play())
    rows = {row.name: row for row in calculix.answer(case.definition).rows}
    moved = rows["largest_displacement_sliding"]
    assert moved.values["reduced"] > 1e-4 and moved.difference < 1e-5 and moved.passed
    if what == "chain":  # a closed form: every block is held by f l/(E A) ahead of the one before
        jump = rows["largest_jump_sliding"]
        assert jump.values["fe"] == pytest.approx(jump.values["reduced"], rel=1e-6) and jump.passed
        return
    assert [event.kind for event in case.reduced().events].count("stop_reached") == 2


BENDING = {"portal": (2.978385e-3, 1610.5095, 0.0), "boom": (1.162559e-2, 8.0, 3.974977e-3),
           "hinge_line": (1.133898e-2, 2.814237, 2.542373e-3), "umbrella_rib_bending": (2.903396e-4, 1.347858e-2, 1.195087e-5),
           "mast_6_bending": (1.079531e-2, 11.72639, 1.231462e-3)}


def test_the_cases_are_those_of_their_maker() -> None:
    found = dict(cases.texts())
    assert len(found) == 3
    assert found == {name: (cases.FOLDER / name).read_text() for name in found}


@with_calculix
@pytest.mark.parametrize("name", BENDING)
def test_beams_hinges_and_sliders_agree_to_2e_5(name: str) -> None:
    """Sticking friction of CalculiX gives way by 1e-5; its displacements have seven digits."""
    rows = calculix.answer(sj.load(f"cases/trusses/{name}.toml").definition).rows
    assert [row.name for row in rows] == ["largest_displacement", "largest_bending_moment", "largest_jump"]
    for row, wanted in zip(rows, BENDING[name]):
        assert row.passed and row.difference < 2e-5, row
        assert row.values["reduced"] == pytest.approx(wanted, rel=1e-5, abs=1e-9)


def test_the_rectangle_of_a_beam_has_its_stiffness() -> None:
    """A shape that is not a rectangle: a channel, whose area and moments give a rectangle of another modulus."""
    made = frame(beam={"shape": "channel", "dimensions_m": [0.06, 0.03, 0.002, 0.002], "axis_y": None})
    truss = sj.load(made).definition.resolve()
    items = truss.elements["beam"]
    deck = frames.Frame(truss)
    frames.beams(deck)
    height, width = deck.sides[0]
    at = next(place for place, line in enumerate(deck.sections) if line.startswith("*ELASTIC"))
    young = float(deck.sections[at + 1].split(",")[0])
    assert young * height * width == pytest.approx(items.axial_stiffness_N[0])
    assert young * height**3 * width / 12 == pytest.approx(items.bending_stiffness_N_m2[0, 1])
    assert young * height * width**3 / 12 == pytest.approx(items.bending_stiffness_N_m2[0, 0])


def frame(dimension: int = 2, beam: dict[str, Any] | None = None, **more: Any) -> dict[str, Any]:
    """Return a bent cantilever of two beams with a load and a moment at its tip; axes of sections are tilted."""
    points = {"A": [0.0, 0.0, 0.0], "B": [0.8, 0.6, 0.0], "C": [1.2, 0.5, 0.7 if dimension == 3 else 0.0]}
    keys = {"shape": "rectangle", "dimensions_m": [0.03, 0.02], "young_modulus_Pa": 7e10,
            "thermal_expansion_per_K": 2e-5, "gradient_per_m": [10.0, 20.0 if dimension == 3 else 0.0],
            **({"axis_y": [-0.3, 0.5, 0.4]} if dimension == 3 else {}), **(beam or {})}
    nodes: list[dict[str, Any]] = [{"name": name, "position_m": where[:dimension]} for name, where in points.items()]
    nodes[0] |= {"fixed": list("xyz"[:dimension]), "fixed_rotations": list("xyz" if dimension == 3 else "z")}
    nodes[2] |= {"force_N": [20.0, -30.0, 25.0][:dimension]}
    keys = {key: value for key, value in keys.items() if value is not None}
    return {"case": {"name": "frame", "kind": "truss"}, "truss": {"dimension": dimension}, "node": nodes,
            "beam": [{"name": "".join(ends), "nodes": list(ends), **keys} for ends in ("AB", "BC")],
            "thermal": {"shape": "triangle", "temperature_change_max_K": 50.0}, **more}


def propped(dimension: int = 2, **ends: Any) -> dict[str, Any]:
    """Return the frame with its tip held, and keys of its second beam."""
    made = frame(dimension)
    made["node"][2] = {"name": "C", "position_m": made["node"][2]["position_m"], "fixed": list("xyz"[:dimension]),
                       "fixed_rotations": list("xyz" if dimension == 3 else "z")}
    made["node"][1]["force_N"] = [400.0, -300.0, 200.0][:dimension]
    made["beam"][1] |= ends
    return made


def carried() -> dict[str, Any]:
    """Return the frame whose second beam begins at another node, which a rigid body carries."""
    made = propped()
    made["node"].append({"name": "D", "position_m": [0.85, 0.7]})
    made["beam"][1]["nodes"] = ["D", "C"]
    made["rigid"] = [{"name": "R", "master": "B", "nodes": ["D"], "rotations": ["x", "y", "z"]}]
    return made


def jointed(**hinge: Any) -> dict[str, Any]:
    """Return the frame with a hinge between its beams."""
    made = propped()
    made["node"].append({"name": "D", "position_m": [0.8, 0.6]})
    made["beam"][1]["nodes"] = ["D", "C"]
    made["hinge"] = [{"name": "H", "nodes": ["B", "D"], **hinge}]
    return made


FRAMES: dict[str, Callable[[], dict[str, Any]]] = {
    "moment": lambda: {**frame(), "node": [*frame()["node"][:2], {**frame()["node"][2], "moment_N_m": [7.0]}]},
    "released moment": lambda: propped(released_first=["Rz"]),
    "released force": lambda: propped(released_second=["Fx"]),
    "offset": lambda: propped(offset_first_m=[0.05, 0.1]),
    "in space, both moments released": lambda: propped(3, released_first=["Ry", "Rz"]),
    "in space, offset": lambda: propped(3, offset_first_m=[0.05, 0.1, -0.05]),
    "spring": lambda: frame(spring=[{"name": "S", "nodes": ["A", "C"], "stiffness_N_per_m": 1e5, "preload_N": 50.0}]),
    "rigid body": carried,
    "hinge": jointed,
    "stiff hinge": lambda: jointed(stiffness_N_m_per_rad=3e3),
    "hinge with play": lambda: jointed(stiffness_N_m_per_rad=3e3, deadband_rad=2e-4),
    "hinge with friction and preload": lambda: jointed(stiffness_N_m_per_rad=3e3, friction_moment_N_m=2.0,
                                                       preload_moment_N_m=3.0),
}


@with_calculix
@pytest.mark.parametrize("what", FRAMES)
def test_ends_of_beams_and_hinges_agree(what: str) -> None:
    """In space, torsion of the bricks differs from that of the beam, so the limit is wider."""
    rows = calculix.answer(sj.load(FRAMES[what]()).definition).rows
    limit = 2e-2 if "space" in what else 1e-4
    assert rows[0].values["reduced"] > 1e-4 and rows[1].values["reduced"] > 1.0
    assert all(row.difference < limit for row in rows), rows


def test_beams_beside_cables_are_refused() -> None:
    cable = {"name": "S", "nodes": ["A", "C"], "stiffness_N_per_m": 1e3, "cable": True}
    with pytest.raises(StatejumpError) as refused:
        calculix.answer(sj.load(frame(spring=[cable])).definition)
    assert refused.value == failure("fe_cable", key="cable")


@with_calculix
def test_events_and_jump_of_table_1_agree_within_a_thousandth(statejump: Callable[..., Outcome]) -> None:
    told = statejump("fe", "cases/table1.toml")
    assert told.status == 0, told.errors
    rows = {row.name: row for row in calculix.answer(sj.load("table1").definition).rows}
    assert list(rows) == ["slide_1_temperature_change", "rest_2_temperature_change", "slide_3_temperature_change",
                          "state_jump"]
    # Compliance of sticking (1/STICK) and of stops (1/PUSH) relative to the bar.
    assert all(row.difference < 1e-4 for row in rows.values())
    assert rows["state_jump"].values["fe"] == pytest.approx(30.0 * 0.5 / (70e9 * 9e-6), rel=1e-6)


@with_calculix
def test_finite_elements_are_a_third_column(statejump: Callable[..., Outcome], tmp_path: Path) -> None:
    told = statejump("compare", "--fe", "cases/table1.toml")
    assert told.status == 0, told.errors
    assert "CalculiX" in told.output
    rows = {row.name: row for row in sj.read(tmp_path / "results/table1/comparison.h5").rows}
    jump = rows["state_jump, finite elements"]
    assert list(jump.values) == ["reduced", "fe"] and jump.passed
    assert jump.values["reduced"] == rows["state_jump"].values["reduced"]
    assert jump.difference == pytest.approx(abs(jump.values["fe"] - jump.values["reduced"]), rel=1e-6)
    page = statejump("report", "results/table1")
    assert page.status == 0 and "CalculiX" in (tmp_path / "results/table1/report.html").read_text()


def test_kinks_are_where_straight_pieces_meet() -> None:
    change = np.linspace(0, 100, 51)
    moved = np.interp(change, [0, 13.3, 71.7, 100], [0, 0, 58.4, 58.4])
    assert kinks(change, moved, 1.0) == [("slide", pytest.approx(13.3)), ("rest", pytest.approx(71.7))]


def test_without_calculix_one_sentence_says_so(statejump: Callable[..., Outcome], monkeypatch: Any) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    told = statejump("fe", "cases/table1.toml")
    assert told.status == 2
    assert told.failure == failure("calculix_missing", program="ccx")


@pytest.mark.parametrize(("case", "wanted"), [
    ("trusses/umbrella_rib", failure("fe_other_parts", key="torsion_spring")),
    ("trusses/latch_lever", failure("fe_other_parts", key="latch_hinge")),
    ("umbrella", failure("command_not_for_kind", key="case.kind", value="umbrella", command="fe")),
    ("table1_frictionless", failure("fe_needs_friction", key="joint.friction_coefficient", value=0.0)),
])
def test_what_the_deck_does_not_have_is_refused(case: str, wanted: Failure, statejump: Callable[..., Outcome]) -> None:
    told = statejump("fe", f"cases/{case}.toml")
    assert told.status == 2 and told.errors.count("\n") == 1 and told.failure == wanted
