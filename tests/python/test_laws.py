# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue in Python: names, forces against independent formulas, figures."""
from __future__ import annotations

import json
from math import inf, log1p, pi
from pathlib import Path

import numpy as np
import pytest

from conftest import REPOSITORY
from failures import failing, failure
from statejump import _engine, laws
from statejump.laws import curves
from statejump.kinds.loading import load_case

R1, R2, LENGTH, MODULUS = 5e-3, 5.1e-3, 0.01, 70e9 / (2 * (1 - 0.3**2))
CLEARANCE = R2 - R1
LINE_CONTACTS = ("johnson", "esdu_78035", "persson")


def table(name: str, depth: np.ndarray) -> dict[str, np.ndarray]:
    return _engine.normal_force(name, depth, R1, R2, LENGTH, MODULUS)


def test_names() -> None:
    names = {kind: _engine.law_names(kind) for kind in laws.KINDS}
    assert names == {
        "normal": ["hertz_paper", "hertz_internal", "johnson", "esdu_78035", "persson"],
        "dissipation": ["none", "lankarani_nikravesh", "hunt_crossley", "flores", "exact_restitution"],
        "friction": ["none", "ambrosio", "mindlin", "mindlin_deresiewicz"],
        "tangential_velocity": ["material", "paper"],
    }
    for kind, listed in names.items():
        assert [law.name for law in laws.catalogue(kind)] == listed
    with failing("out_of_range", raised=_engine.EngineFailure, key="kind", value="rolling"):
        _engine.law_names("rolling")


TRAITS = ("holds_static_load", "frictionless", "has_memory", "needs_axis", "accepts_bulging_wall", "point_contact",
          "needs_point_contact")


@pytest.mark.parametrize("kind, name, traits, parameters", [
    ("normal", "hertz_paper", {"holds_static_load", "point_contact"}, ()),
    ("normal", "hertz_internal", {"holds_static_load", "point_contact", "accepts_bulging_wall"}, ()),
    *(("normal", name, {"holds_static_load", "needs_axis"}, ("contact_length",)) for name in LINE_CONTACTS),
    ("dissipation", "none", {"holds_static_load"}, ()),
    *(("dissipation", name, {"holds_static_load"}, ("restitution", "smallest_impact_speed"))
      for name in ("lankarani_nikravesh", "hunt_crossley", "flores", "exact_restitution")),
    ("friction", "none", {"frictionless"}, ()),
    ("friction", "ambrosio", set(), ("friction_coefficient", "v0", "v1")),
    ("friction", "mindlin", {"holds_static_load", "has_memory"}, ("friction_coefficient",)),
    ("friction", "mindlin_deresiewicz", {"holds_static_load", "has_memory", "needs_point_contact"},
     ("friction_coefficient",)),
    ("tangential_velocity", "material", {"holds_static_load"}, ()),
    ("tangential_velocity", "paper", {"holds_static_load", "needs_axis"}, ()),
])
def test_traits(kind: str, name: str, traits: set[str], parameters: tuple[str, ...]) -> None:
    law = laws.law(kind, name)
    assert {trait for trait in TRAITS if getattr(law, trait)} == traits
    assert tuple(parameter.name for parameter in law.parameters) == parameters


def test_parameters_are_those_of_the_cases() -> None:
    """Unit, lower limit and default of a case's keys equal those of the law; the upper limit of the case may be lower.
    """
    keys = {"restitution": "restitution", "smallest_impact_speed": "smallest_impact_speed_m_per_s",
            "v0": "friction_v0_m_per_s", "v1": "friction_v1_m_per_s", "contact_length": "contact_length_m",
            "friction_coefficient": "friction_coefficient"}
    schema = json.loads((REPOSITORY / "schema" / "umbrella.schema.json").read_text())
    joint = schema["properties"]["joint"]["properties"]
    seen = {parameter for kind in laws.KINDS for law in laws.catalogue(kind) for parameter in law.parameters}
    assert {parameter.name for parameter in seen} == set(keys)
    for parameter in seen:
        told = joint[keys[parameter.name]]
        # the restitution has two ranges, one without its lower end
        low = told.get("exclusiveMinimum", told.get("minimum"))
        assert (told["x-unit"], low) == (parameter.unit, parameter.low), parameter.name
        if parameter.name != "friction_coefficient":  # a property of the pair, which a case must give
            assert told["default"] == parameter.default, parameter.name
        assert parameter.allows(told["maximum"]) and not parameter.allows(float("nan"))
        assert parameter.allows(parameter.low) != parameter.low_excluded


def test_unstatic_law() -> None:
    with failing("unknown_name", raised=ValueError, key="friction_law", value="mindlyn", allowed=laws.names("friction")):
        laws.law("friction", "mindlyn")


@pytest.mark.parametrize("name, radius", [("hertz_paper", R1 * R2 / (R1 + R2)), ("hertz_internal", R1 * R2 / (R2 - R1))])
def test_hertz(name: str, radius: float) -> None:
    depth = np.geomspace(1e-9, 1e-4, 50)
    found = table(name, depth)
    stiffness = 4 / 3 * MODULUS * np.sqrt(radius)
    np.testing.assert_allclose(found["force_N"], stiffness * depth**1.5, rtol=1e-13)
    np.testing.assert_allclose(found["stiffness_N_per_m"], 1.5 * stiffness * depth**0.5, rtol=1e-13)
    np.testing.assert_allclose(found["contact_width_m"], np.sqrt(radius * depth), rtol=1e-13)
    np.testing.assert_allclose(found["elastic_energy_J"], 0.4 * stiffness * depth**2.5, rtol=1e-13)


@pytest.mark.parametrize("name, shift", [("johnson", -1.0), ("esdu_78035", 1.0)])
def test_logarithmic_line_contact(name: str, shift: float) -> None:
    """The laws compute force from depth; the formula of the literature gives depth from force."""
    limit = _engine.largest_depth_m(name, R1, R2)
    assert limit == pytest.approx(4 * CLEARANCE * np.exp(shift - 1), rel=1e-12)
    depth = np.geomspace(1e-9, limit * (1 - 1e-6), 50)
    found = table(name, depth)
    line = found["force_N"] / LENGTH
    printed = line / (pi * MODULUS) * (np.log(4 * pi * MODULUS * CLEARANCE / line) + shift)
    np.testing.assert_allclose(printed, depth, rtol=1e-12)
    width = np.sqrt(4 * line * R1 * R2 / CLEARANCE / (pi * MODULUS))
    np.testing.assert_allclose(found["contact_width_m"], width, rtol=1e-12)


def test_persson() -> None:
    depth = np.geomspace(1e-7, 0.99 * R1, 50)
    found = table("persson", depth)
    t = np.tan(found["contact_width_m"] / R1 / 2) ** 2
    line = 2 * pi * MODULUS * CLEARANCE * t * (1 + t) / (2 - np.log1p(t) - 2 * t**2)
    # near the largest arc the divisor approaches zero and loses digits
    np.testing.assert_allclose(found["force_N"], line * LENGTH, rtol=1e-6)
    light = np.array([1e-9])
    assert table("persson", light)["force_N"] == pytest.approx(table("johnson", light)["force_N"], rel=1e-3)


@pytest.mark.parametrize("name", _engine.law_names("normal"))
def test_stiffness_and_energy_belong_to_the_force(name: str) -> None:
    depth = np.linspace(1e-5, 5e-5, 4001)
    found = table(name, depth)
    force, step = found["force_N"], depth[1] - depth[0]
    inner = slice(1, -1)
    np.testing.assert_allclose(np.gradient(force, step)[inner], found["stiffness_N_per_m"][inner], rtol=1e-6)
    work = np.sum((force[1:] + force[:-1]) / 2) * step
    assert np.diff(found["elastic_energy_J"][[0, -1]])[0] == pytest.approx(work, rel=1e-6)
    apart = table(name, np.array([-1e-5, 0.0]))
    assert all(np.array_equal(column, [0.0, 0.0]) for column in apart.values())


@pytest.mark.parametrize("name", LINE_CONTACTS)
def test_depth_beyond_the_range(name: str) -> None:
    limit = _engine.largest_depth_m(name, R1, R2)
    with failing("law_left_range", raised=_engine.EngineFailure, item=name, value=limit, numbers={"limit_m": limit}):
        table(name, np.array([limit]))


def test_wrong_use() -> None:
    assert _engine.largest_depth_m("hertz_internal", R1, R2) == inf
    with failing("out_of_range", raised=_engine.EngineFailure, key="normal_law", value="herz"):
        table("herz", np.array([0.0]))
    with failing("out_of_range", raised=_engine.EngineFailure, key="bearing_radius"):
        _engine.normal_force("johnson", [0.0], R2, R1, LENGTH, MODULUS)
    with failing("out_of_range", raised=_engine.EngineFailure, key="restitution"):
        _engine.damping_ratio_s_per_m("flores", 0.0, 0.1)
    with failing("law_left_range", raised=_engine.EngineFailure, item="hertz_internal", value=float("nan")):
        table("hertz_internal", np.array([np.nan]))


@pytest.mark.parametrize("name, ratio", [
    ("none", 0.0), ("lankarani_nikravesh", 0.75 * (1 - 0.64)), ("hunt_crossley", 1.5 * 0.2),
    ("flores", 1.6 * 0.2 / 0.8),
])
def test_impact(name: str, ratio: float) -> None:
    """For any elastic law e' solves a - ln(1 + a) = -a e' - ln(1 - a e'), where a is chi/K times the speed."""
    joint = curves.paper_joint()
    assert _engine.damping_ratio_s_per_m(name, 0.8, 0.1) * 0.1 == pytest.approx(ratio, rel=1e-14)
    found = curves.impact(name, joint)
    if ratio == 0:
        assert found.restitution == pytest.approx(1.0, abs=1e-6)
        energy = 0.5 * joint.reduced_mass_kg * 0.1**2
        deepest = table("hertz_internal", np.array([found.depth_m.max()]))["elastic_energy_J"][0]
        assert deepest == pytest.approx(energy, rel=1e-5)
    else:
        low, high = 0.0, 1.0
        for _ in range(60):
            middle = (low + high) / 2
            rest = -ratio * middle - log1p(-ratio * middle)
            low, high = (middle, high) if rest < ratio - log1p(ratio) else (low, middle)
        assert found.restitution == pytest.approx(low, abs=1e-5)
    assert found.force_N.min() >= 0 and found.depth_m[-1] == 0


def test_paper_joint_is_that_of_the_case(cases: Path) -> None:
    umbrella = load_case(cases / "umbrella.toml")
    paper, case = curves.paper_joint(), umbrella.behaviour.laws(umbrella)
    for field in ("journal_radius_m", "bearing_radius_m", "contact_length_m", "effective_young_modulus_Pa",
                  "reduced_mass_kg"):
        assert getattr(paper, field) == pytest.approx(getattr(case, field), rel=1e-14)


def test_document_lists_every_law() -> None:
    text = (REPOSITORY / "docs" / "reference" / "laws.md").read_text()
    listed = text.split("| key | law |", 1)[1].split("\n\n", 1)[0].splitlines()[2:]
    names = [row.split("|")[2].strip(" `") for row in listed]
    assert names == [name for kind in laws.KINDS for name in _engine.law_names(kind)]


def test_figure_repeats_bit_for_bit(tmp_path: Path) -> None:
    png, svg = curves.figure(curves.paper_joint(), tmp_path, "laws")
    before = svg.read_text()
    for text in (*_engine.law_names("normal"), *_engine.law_names("dissipation"), "Penetration depth [mm]",
                 "Penetration depth [µm]", "Normal force [N]", "range ends: error beyond"):
        assert text in before, text
    assert png.stat().st_size > 20_000
    curves.figure(curves.paper_joint(), tmp_path, "laws")
    assert svg.read_text() == before


@pytest.mark.parametrize("radius, clearance", [(1e-3, 50.0), (50.0, 1e-6), (1e-9, 1e-12)])
def test_figure_of_odd_joints(tmp_path: Path, radius: float, clearance: float) -> None:
    written = curves.figure(curves.Joint("odd", radius, radius + clearance, 1.0, 1e3, 1e-6), tmp_path, "odd")
    assert written and all(path.stat().st_size > 0 for path in written)


def test_command(statejump, cases: Path, tmp_path: Path) -> None:
    outcome = statejump("laws")
    assert outcome.status == 0, outcome.errors
    for kind in laws.KINDS:
        assert f"{kind.replace('_', ' ').capitalize()} laws" in outcome.output
        for name in _engine.law_names(kind):
            assert f"│ {name} " in outcome.output
    outcome = statejump("laws", cases / "umbrella_bias.toml", "--quiet")
    assert (outcome.status, outcome.output, outcome.errors) == (0, "", "")
    assert sorted(entry.name for entry in (tmp_path / "results" / "laws").iterdir()) == [
        "laws.png", "laws.svg", "laws_umbrella_bias.png", "laws_umbrella_bias.svg"]


def test_command_with_a_case_without_laws(statejump, cases: Path, tmp_path: Path) -> None:
    path = cases / "table1.toml"
    outcome = statejump("laws", path)
    assert outcome.status == 2
    assert outcome.failure == failure("command_not_for_kind", key="case.kind", value="spring_slider", command="laws")
    assert list(tmp_path.iterdir()) == []
