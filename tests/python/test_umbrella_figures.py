# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 13 to 16: rules of the verdicts, drawn geometry and statics, files of the command."""
from __future__ import annotations

import csv
import json
from collections.abc import Callable
from dataclasses import replace
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from conftest import results_in
from failures import failure
from statejump import _engine
from studies.paper.commands import figures_command
from statejump.core.errors import Interrupted, StatejumpError
from statejump.core.yade_process import Samples
from statejump.kinds.loading import load_case
from statejump.kinds.umbrella import dem, reduced as model
from studies.paper.claims import measures, verdicts
from studies.paper.claims.findings import Amplification, Envelope, Findings, FirstContact
from studies.paper.claims.page import page
from studies.paper.claims.reasons import Reasons
from studies.paper.claims.statistics import (
    FAILS, HOLDS, IN_PART, IN_THE_MEAN, UNTESTED, Groups, trend, two_sample_test,
)
from studies.paper.claims.verdicts import Claim
from studies.paper.figures import closed_forms, study
from studies.paper.figures.runs import Study
from statejump.schema.paths import with_values

RANDOM = np.random.default_rng(7)
NOISE = RANDOM.normal(size=(8, 200))


def groups(means: list[float], spread: float, values: tuple[float, ...] = (0.0, 0.1, 0.3, 0.5)) -> Groups:
    """Runs with given mean values; their noise is always the same and has zero mean."""
    noise = NOISE - NOISE.mean(axis=1, keepdims=True)
    return Groups(values, tuple(mean + spread * row for mean, row in zip(means, noise)))


@pytest.mark.parametrize(
    ("means", "spread", "rising", "verdict"),
    [
        ([1, 2, 3, 4], 0.1, True, HOLDS),
        ([1, 2, 3, 4], 0.1, False, FAILS),
        ([1.0, 1.3, 1.6, 1.9], 1.0, True, IN_THE_MEAN),
        ([1.9, 1.6, 1.3, 1.0], 1.0, False, IN_THE_MEAN),
        ([1, 1, 1, 1], 1.0, True, FAILS),  # no effect
        ([1, 2, 3, 2], 0.1, True, FAILS),  # rises on the whole, but its last step falls
        ([1, 1, 1, 1], 0.0, True, FAILS),
    ],
)
def test_trend(means: list[float], spread: float, rising: bool, verdict: str) -> None:
    found = trend(groups(means, spread), rising)
    assert found.verdict == verdict
    assert len(found.against) == (1 if means == [1, 2, 3, 2] else 3 if verdict == FAILS and spread == 0.1 else 0)


@pytest.mark.parametrize(
    ("means", "without", "larger", "verdict"),
    [
        ([3, 2, 1, 0.5], 0.0, True, HOLDS),
        ([3, 3, 1, 2], 0.0, True, IN_PART),
        ([3, 4, 1, 2], 0.0, True, FAILS),  # larger at one value
        ([3, 3, 3, 3], 0.0, True, FAILS),
        ([1, 2, 3, 9], 0.3, False, HOLDS),  # values on the other side do not count
        ([1, 2, 3, 0], 0.5, True, UNTESTED),
    ],
)
def test_measure(means: list[float], without: float, larger: bool, verdict: str) -> None:
    assert measures.measure(groups(means, 0.3), without, larger) == verdict


def test_two_samples() -> None:
    first, second = NOISE[0], NOISE[1]
    assert two_sample_test("same", first, second).agree
    shifted = two_sample_test("shifted", first, second + 1)
    assert shifted.p_mean < 1e-6 and shifted.p_spread > 0.01 and not shifted.agree
    wider = two_sample_test("wider", first, 3 * (second - second.mean()) + first.mean())
    assert wider.p_spread < 1e-6 and wider.p_mean > 0.01 and not wider.agree
    assert two_sample_test("one run", first, first[:1]).p_mean == 1


def all_true() -> Findings:
    """Findings under which every statement holds."""
    limit = 2.85e-4
    clearances = (5e-5, 1e-4, 3e-4)
    springs = (0.0, 1.0, 100.0)
    contacts = tuple(
        FirstContact(c, *(3 * [c / 2.85e-6] if c < limit else 3 * [None])) for c in clearances
    )
    return Findings(
        start_spread_m=1e-6,
        end_shift_reduced_m=np.full(5, 5e-5),
        end_shift_dem_m=np.full(5, 5e-5),
        first_contacts=contacts,
        tolerance_reduced_K=1e-6,
        tolerance_dem_K=1e-3,
        onset_K=Groups(clearances, tuple(np.array(3 * [17.6 if c < 9e-5 else 35.2 if c < limit else inf])
                                                for c in clearances)),
        onset_dem_K=(17.6, 35.2, inf),
        clearance_limit_m=limit,
        range_by_friction=groups([1, 2, 3, 4], 0.1),
        jump_by_friction=groups([0, 1, 3, 4], 0.01),
        friction_coefficient=0.3,
        largest_by_spring=groups([6e-3, 5e-3, 3.5e-3], 1e-5, springs),
        jump_by_spring=groups([3, 2, 1], 0.1, springs),
        static_rigid_rad=3.43e-3,
        static_elastic_rad=(None, 3.42e-3, 3.4e-3),
        jump_by_stiffness=groups([3, 2, 1], 0.1, (0.25, 1.0, 4.0)),
        free_turn_rad=8.3e-4,
        spring_bias_rad=0.0,
        tests=(two_sample_test("range of θ2", NOISE[0], NOISE[1]),),
        envelopes=(Envelope("fig14, reduced, single", 5, -1e-6, 1e-6, 0),),
        amplification=Amplification(1e-12, 1e-8, 1e-3),
        spring_stiffness_N_m_per_rad=0.0,
        damped=False,
        rings=True,
    )


def test_true_claims_hold() -> None:
    verdicts = [claim.verdict for claim in measures.all_claims(all_true())]
    assert verdicts == [HOLDS] * 10 + [UNTESTED]


@pytest.mark.parametrize(
    ("claim", "change", "verdict"),
    [
        (verdicts.state_jump_occurs, {"end_shift_dem_m": np.array([5e-5, 1e-7])}, IN_THE_MEAN),
        (verdicts.state_jump_occurs, {"end_shift_reduced_m": np.full(9, 1e-8)}, FAILS),
        (verdicts.smaller_clearance_earlier, {"onset_dem_K": (35.2, 17.6, inf)}, FAILS),
        (verdicts.smaller_clearance_earlier, {"tolerance_reduced_K": -1.0}, IN_THE_MEAN),  # off the closed form
        (verdicts.large_clearance_never_touches, {"clearance_limit_m": 2e-5}, FAILS),
        (verdicts.large_clearance_never_touches, {"onset_dem_K": (17.6, 35.2, 90.0)}, FAILS),
        (verdicts.large_clearance_never_touches, {"clearance_limit_m": 1.0}, UNTESTED),
        (verdicts.large_clearance_never_touches, {"clearance_limit_m": nan}, UNTESTED),
        (verdicts.more_friction_larger_range, {"range_by_friction": groups([4, 3, 2, 1], 0.1)}, FAILS),
        (verdicts.friction_is_the_reason, {"jump_by_friction": groups([2, 2, 3, 3], 0.1)}, IN_THE_MEAN),
        (verdicts.friction_is_the_reason, {"jump_by_friction": groups([4, 3, 3, 3], 0.1)}, FAILS),
        (verdicts.spring_reduces_deflection, {"largest_by_spring": groups([1, 2, 3], 0.1, (0.0, 1.0, 9.0))}, FAILS),
        (verdicts.spring_ends_at_static, {"static_rigid_rad": 3.0e-3}, FAILS),
        (verdicts.spring_ends_at_static, {"static_rigid_rad": None}, UNTESTED),
    ],
)
def test_false_claims_come_out_false(
    claim: Callable[[Findings], Claim], change: dict[str, Any], verdict: str
) -> None:
    assert claim(replace(all_true(), **change)).verdict == verdict


def text_of(f: Findings) -> str:
    return "\n".join(page("A case", "statejump figures a.toml", f))


def test_text_follows_the_verdicts() -> None:
    text = text_of(all_true())
    assert text.count("**holds**") == 10 and "Chaotic" in text
    calm = replace(
        all_true(), amplification=Amplification(1e-12, 1e-12, 1e-12), range_by_friction=groups([1] * 4, 1.0)
    )
    text = text_of(calm)
    assert text.count("**holds**") == 9 and f"**{FAILS}**" in text and "Chaotic" not in text


NO_LIMIT = {"clearance_limit_m": nan}


def gives(why: Reasons, wanted: str) -> bool:
    """Return whether reasons have a code, or a number with its unit."""
    return wanted in why.codes if wanted.isidentifier() else wanted in why


@pytest.mark.parametrize(
    ("claim", "change", "said", "not_said"),
    [
        (verdicts.state_jump_occurs, {}, "position_undetermined", "rotation_in_play"),
        (verdicts.state_jump_occurs, {"spring_stiffness_N_m_per_rad": 2.0}, "c/|AC| = 0.83 mrad", "position_undetermined"),
        (verdicts.state_jump_occurs, {"damped": True}, "chaotic", "undamped"),
        (verdicts.state_jump_occurs, {"amplification": Amplification(1e-12, 1e-12, 1e-12)}, "undamped", "chaotic"),
        (verdicts.state_jump_occurs, {"end_shift_reduced_m": np.full(9, 1e-8)}, "9 of 14", "position_undetermined"),
        (verdicts.smaller_clearance_earlier, {}, "meets_closed_form", "overlapping"),
        (verdicts.smaller_clearance_earlier, {"tolerance_dem_K": -1.0}, "off_closed_form", "meets_closed_form"),
        (verdicts.smaller_clearance_earlier, {"onset_dem_K": (35.2, 17.6, inf)}, "not_always", "overlapping"),
        (verdicts.smaller_clearance_earlier, NO_LIMIT, "no_closed_form", "off_closed_form"),
        (verdicts.large_clearance_never_touches, {}, "ends_at_limit", "against_limit"),
        (verdicts.large_clearance_never_touches, {"onset_dem_K": (17.6, 35.2, 90.0)}, "c = 0.3 mm", "ends_at_limit"),
        (verdicts.large_clearance_never_touches, {"clearance_limit_m": 1.0}, "no_clearance_above", "ends_at_limit"),
        (verdicts.large_clearance_never_touches, NO_LIMIT, "no_closed_form", "ends_at_limit"),
        (verdicts.more_friction_larger_range, {}, "friction_carries", "scatter"),
        (verdicts.more_friction_larger_range, {"range_by_friction": groups([1.0, 1.3, 1.6, 1.9], 1.0)},
         "scatter", "not_shown"),
        (verdicts.more_friction_larger_range, {"range_by_friction": groups([4, 3, 2, 1], 0.1)}, "other_way",
         "friction_carries"),
        (verdicts.friction_is_the_reason, {}, "closed", "undamped"),
        (verdicts.friction_is_the_reason, {"jump_by_friction": groups([4, 3, 3, 3], 0.1)}, "undamped", "closed"),
        (verdicts.friction_is_the_reason, {"jump_by_friction": groups([4, 3, 3, 3], 0.1), "damped": True},
         "open", "undamped"),
        (verdicts.friction_is_the_reason, {"jump_by_friction": groups([2, 2, 3, 3], 0.1)}, "of 0.67", "open"),
        (verdicts.friction_is_the_reason, {"friction_coefficient": 0.0}, "no_friction", "open"),
        (verdicts.spring_ends_at_static, {}, "undamped_swing", "below"),
        (verdicts.spring_ends_at_static, {"damped": True}, "swing", "undamped_swing"),
        (verdicts.spring_ends_at_static, {"static_rigid_rad": 4e-3}, "12.5 %", "undamped_swing"),
        (verdicts.spring_ends_at_static, {"spring_bias_rad": 0.1}, "not_free", "no_static_deflection"),
    ],
)
def test_reasons_follow_from_numbers_and_verdict(
    claim: Callable[[Findings], Claim], change: dict[str, Any], said: str, not_said: str
) -> None:
    why = claim(replace(all_true(), **change)).why
    assert gives(why, said) and not gives(why, not_said)


def test_reasons_of_measures_follow_their_verdicts() -> None:
    def whys(**change: Any) -> list[Reasons]:
        return [claim.why for claim in measures.control(replace(all_true(), **change))]

    friction, stiffness, spring, stressed = whys()
    assert (friction.codes, stiffness.codes) == (("less_force",), ("stiffer",))
    assert (spring.codes, stressed.codes) == (("angle_held",), ("no_bias",))
    worse = groups([5, 4, 3, 3], 0.1)
    assert whys(jump_by_friction=worse)[0].codes == ("speed_stays",)
    assert whys(jump_by_friction=worse, damped=True)[0].codes == ("not_always",)
    same = groups([1e-3] * 3, 1e-4, (0.25, 1.0, 4.0))
    assert "1.2 times c/|AC|" in whys(jump_by_stiffness=same)[1]
    assert whys(jump_by_spring=groups([3, 2, 3], 0.1, (0.0, 1.0, 100.0)))[2].codes == ("some_values", "rotation_in_play")
    biased = measures.control(replace(all_true(), spring_bias_rad=0.1))
    assert len(biased) == 3 and "pre-stressed" in biased[2].statement


def test_former_rules_are_told_with_the_numbers_of_the_case() -> None:
    """The verdicts by the former rules are computed from the runs of the case, not stored."""
    assert f"would be *{HOLDS}*, as" in text_of(all_true())
    near = replace(all_true(), end_shift_dem_m=np.array([5e-5, 5e-6]))  # beyond the spread, not beyond ten times of it
    assert f"would be *{IN_THE_MEAN}* instead of *{HOLDS}*" in text_of(near)
    up_again = groups([3, 1, 2], 0.1, (0.0, 1.0, 100.0))
    assert f"would be *{FAILS}* instead of *{HOLDS}*" in text_of(replace(all_true(), jump_by_spring=up_again))


def test_calm_start_is_not_said_to_ring() -> None:
    assert "rest ring." in text_of(all_true())
    assert "rest ring." not in text_of(replace(all_true(), rings=False))


def test_envelope(cases: Path) -> None:
    case = load_case(cases / "umbrella.toml")
    rigid = model.linkage(case)
    for change in (0.0, 37.0, 100.0):
        low, high = (side[0] for side in closed_forms.envelope(case, np.array([change])))
        rim = [_engine.joint_point(rigid, change, 1, phi)["theta2_rad"] for phi in np.linspace(0, 2 * np.pi, 1000)]
        assert low == pytest.approx(min(rim), abs=1e-7) and high == pytest.approx(max(rim), abs=1e-7)
        wider = closed_forms.envelope(case, np.array([change]), 1e-6)
        assert wider[0] < low - 1e-5 and wider[1] > high + 1e-5


def test_static_deflection(cases: Path) -> None:
    """Slow damped runs without friction end in static equilibrium; rigid links are the limit of a soft spring."""
    case = with_values(load_case(cases / "umbrella.toml"), {
        "joint.friction_coefficient": 0.0, "start.mode": "matched", "damping.axial_damping_ratio": 0.1,
        "damping.pin_damping_N_m_s_per_rad": 0.05, "reduced.steps_per_cycle": 100_000, "thermal.period_s": 2.0,
    })
    assert closed_forms.static_deflection(case, 35.0) is None
    rigid = closed_forms.static_deflection(case, 100.0)
    for stiffness in (1.0, 100.0):
        sprung = with_values(case, {"torsion_spring.stiffness_N_m_per_rad": stiffness})
        elastic = closed_forms.static_deflection_elastic(sprung, 100.0)
        assert 0 < rigid - elastic < 1e-6 * stiffness
        history = model.run(sprung)
        warmest = int(np.argmax(history["temperature_change_K"]))
        deflection = history["theta2_rad"][warmest] - history["theta2_rad"][0]
        assert deflection == pytest.approx(elastic, abs=0.3 * (rigid - elastic) if stiffness > 1 else 2e-5)


@pytest.fixture
def tiny(edited: Callable[..., Path], monkeypatch: pytest.MonkeyPatch) -> Path:
    """A case with few runs and steps; the reduced model with other time steps replaces YADE."""

    def execute(case: Any, offset_m: np.ndarray | None = None) -> Samples:
        done = model.integrate(with_values(case, {"reduced.steps_per_cycle": case.dem_settings.steps_per_cycle}), offset_m)
        keys = ("first_contact_time_s", "first_contact_temperature_change_K")
        return Samples(done.columns(), {key: getattr(done, key) for key in keys})

    monkeypatch.setattr(dem, "execute", execute)
    return edited(
        ("reduced_steps_per_cycle = 100000", "reduced_steps_per_cycle = 20000"),
        ("dem_steps_per_cycle = 400000", "dem_steps_per_cycle = 24000"),
        ("reduced_runs = 100", "reduced_runs = 4"),
        ("dem_runs = 100", "dem_runs = 3"),
        ("[start]", "[output]\nsamples_per_cycle = 200\n\n[start]"),
        case="umbrella",
    )


def invoke(case_file: Path, results: Path) -> Any:
    return CliRunner().invoke(figures_command, [str(case_file), "--results", str(results)])


def test_command(tiny: Path, tmp_path: Path) -> None:
    outcome = invoke(tiny, tmp_path / "out")
    assert outcome.exception is None, outcome.exception
    folder = tmp_path / "out" / "umbrella"
    drawn = {f"fig{number}.{suffix}" for number in (13, 14, 15, 16) for suffix in ("png", "svg")}
    tables = {"README.md", "ensembles.csv", "ensembles.json", "curves.csv"}
    assert set(results_in(folder)) == drawn | tables
    assert "fig14, reduced: 20 runs" in outcome.output  # the case itself is not run again

    with (folder / "ensembles.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    for figure, values in (("fig14", 5), ("fig15", 4), ("fig16", 6)):
        kinds = [row["model"] for row in rows if row["figure"] == figure]
        assert kinds.count("reduced ensemble") == 4 * values
        assert kinds.count("reduced single") == kinds.count("dem single") == values
    assert [row["model"] for row in rows if row["figure"] == "fig13"].count("dem ensemble") == 3

    with (folder / "curves.csv").open() as stream:
        curves = list(csv.DictReader(stream))
    base = [row for row in curves if row["figure"] == "fig14" and float(row["value"]) == 1e-4]
    heated = [row for row in base if float(row["time_s"]) <= 0.25]
    for name in ("reduced_deflection_rad", "dem_deflection_rad", "ensemble_mean_deflection_rad"):
        assert max(abs(float(row[name])) for row in base) > 1e-3  # each model moves
    assert all(
        float(row["reduced_deflection_rad"]) == pytest.approx(float(row["dem_deflection_rad"]), abs=1e-4)
        for row in heated
    )
    warmest = [row for row in curves if row["figure"] == "fig16" and float(row["temperature_change_K"]) > 99.9]
    assert [row["quasi_static_deflection_rad"] != "" for row in warmest] == [False] + [True] * 5

    content = json.loads((folder / "ensembles.json").read_text())
    assert len(content["claims"]) == 11
    assert [test["quantity"] for test in content["two_sample_tests"]] == ["range of θ2", "jump of θ2"]
    assert all(row["beyond_margin"] == 0 for row in content["findings"]["envelopes"])
    svg = (folder / "fig14.svg").read_text()
    assert svg.count("single run") == 2


def test_interruption_leaves_what_is_finished(
    tiny: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = study.figure_of

    def figure_of(what: Study, *rest: Any) -> list[Path]:
        if what.figure == "fig15":
            raise KeyboardInterrupt
        return drawn(what, *rest)

    monkeypatch.setattr(study, "figure_of", figure_of)
    outcome = invoke(tiny, tmp_path / "out")
    folder = tmp_path / "out" / "umbrella"
    assert isinstance(outcome.exception, Interrupted)
    assert str(outcome.exception).endswith(f"{folder}: fig13.png, fig14.png")
    assert set(results_in(folder)) == {
        "fig13.png", "fig13.svg", "fig14.png", "fig14.svg", "curves.csv", "ensembles.csv"
    }


def test_failures_are_one_sentence(
    tiny: Path, tmp_path: Path, cases: Path, edited: Callable[..., Path]
) -> None:
    outcome = invoke(cases / "table1.toml", tmp_path)
    assert isinstance(outcome.exception, StatejumpError)
    assert outcome.exception == failure(
        "command_not_for_kind", file="table1.toml", key="case.kind", value="spring_slider", command="figures")
    tiny.write_text(tiny.read_text().replace("start_spread_m = 1e-6", "start_spread_m = 8e-5"))
    outcome = invoke(tiny, tmp_path)
    assert isinstance(outcome.exception, StatejumpError)
    assert outcome.exception == failure(
        "cannot_vary", varied="joint.radial_clearance_m", key="ensemble.start_spread_m", value=8e-5)
