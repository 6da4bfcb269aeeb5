# SPDX-License-Identifier: GPL-3.0-or-later
"""A temperature program that does not end at the reference temperature has no state jump at its end. Either a return is
added and reported, or the displacement at the end is reported under another name."""
from __future__ import annotations

import html
from math import isnan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import failing, failure, note
import statejump as sj
from statejump.campaign.outputs import values
from statejump.campaign.work import outcome
from statejump.core.errors import NotAllowed
from statejump.kinds.truss import dem, generate
from statejump.kinds.truss.generate.document import write
from statejump.kinds.truss.solve import engine_program
from statejump.results.read import read

# Ends 26 K below the reference temperature, as many tables of satellites do.
ROWS = [0.0, 3.0, 4.0, 8.0], [0.0, 70.0, 50.0, -26.0]
TABLE = {"thermal.shape": "table", "thermal.temperature_change_max_K": None, "thermal.period_s": None,
         "thermal.table_time_s": ROWS[0], "thermal.table_temperature_change_K": ROWS[1]}
# 26 K at the mean rate of the table, 166 K in 8 s.
RETURN_S = 26 * 8 / 166
BACK = {**TABLE, "thermal.table_time_s": [*ROWS[0], 8 + RETURN_S],
        "thermal.table_temperature_change_K": [*ROWS[1], 0.0]}
KEPT = {**TABLE, "thermal.return_to_reference": False}
NOTE = note("return_added", temperature_change_K=-26.0, return_s=RETURN_S)
WITHOUT = note("no_return", temperature_change_K=-26.0, setting="return_to_reference")


def chain(**thermal: Any) -> dict[str, Any]:
    made = generate.chain(3, friction_force_N=100.0)
    made["thermal"] = {"shape": "table", "table_time_s": ROWS[0], "table_temperature_change_K": ROWS[1], **thermal}
    return made


def chain_file(folder: Path, **thermal: Any) -> Path:
    write(chain(**thermal), folder / "chain.toml", [])
    return folder / "chain.toml"


@pytest.mark.parametrize(("name", "jump", "there"), [
    ("table1", "state_jump_m", "displacement_at_program_end_m"),
    ("umbrella_damped", "theta2_jump_rad", "theta2_change_at_program_end_rad"),
    ("trusses/umbrella_rib", "largest_jump_m", "largest_displacement_at_program_end_m"),
])
def test_return_is_added_and_reported(name: str, jump: str, there: str) -> None:
    case = sj.load(name).changed(TABLE)
    assert case.period_s == pytest.approx(8 + RETURN_S, rel=1e-12)
    run, by_hand, kept = case.reduced(), sj.load(name).changed(BACK).reduced(), sj.load(name).changed(KEPT).reduced()
    assert NOTE in run.warnings and not any("return" in said for said in by_hand.warnings)
    assert run["temperature_change_K"][-1] == pytest.approx(0, abs=1e-12)
    assert run.summary[jump] == by_hand.summary[jump] and there not in by_hand.summary
    # Without it there is no jump, and the same displacement.
    assert isnan(kept.summary[jump]) and WITHOUT in kept.warnings
    assert kept["temperature_change_K"][-1] == -26.0
    # Of samples between which the umbrella is interpolated.
    assert run.summary[there] == pytest.approx(kept.summary[there], rel=1e-3)
    assert abs(run.summary[there] - run.summary[jump]) > 0.05 * abs(run.summary[there])


def test_displacement_at_the_end_is_that_of_the_closed_form() -> None:
    """The bar of the paper's Table 1 slides back and forth: x = α ΔT l - f l/(E A) while it slides and the temperature
    falls."""
    case = sj.load("table1").changed(TABLE)
    link = case.definition.link
    expands = link.thermal_expansion_per_K * link.stress_free_length_m
    slack = held = 30.0 * link.stress_free_length_m / (link.young_modulus_Pa * link.cross_section_area_m2)
    found = case.reduced().summary
    # The link is shorter there, and as much less is its compression by friction.
    held *= 1 - 26 * link.thermal_expansion_per_K
    assert found["displacement_at_program_end_m"] == pytest.approx(-26 * expands + held, rel=1e-12)
    # The return slides as well, 26 K beyond twice the 2.035 K that friction holds: the block lags on the cold side.
    assert found["state_jump_m"] == pytest.approx(-slack, rel=1e-12)


def test_return_lasts_until_the_period_or_is_refused() -> None:
    case = sj.load("table1")
    assert case.changed({**TABLE, "thermal.period_s": 20.0}).definition.ending.return_s == 12.0
    # Rate does not matter to a quasi-static path.
    jumps = [case.changed({**TABLE, "thermal.period_s": period}).reduced().summary["state_jump_m"] for period in (8.5, 900)]
    assert jumps[0] == pytest.approx(jumps[1], rel=1e-12)
    with failing("return_too_late", key="thermal.period_s", value=7.0, lasts=8.0, key_to_leave_out="thermal.period_s", raised=NotAllowed):
        case.changed({**TABLE, "thermal.period_s": 7.0})
    # What a resolved case says is understood again.
    again = sj.load(case.changed(TABLE).to_dict())
    assert again.period_s == case.changed(TABLE).period_s and again.definition.ending.returns


def test_cycles_return_each() -> None:
    case = sj.load("table1").changed({**TABLE, "thermal.cycles": 3})
    by_hand = sj.load("table1").changed({**BACK, "thermal.cycles": 3})
    assert case.reduced().summary["state_jump_m"] == by_hand.reduced().summary["state_jump_m"]
    assert case.definition.ending.time_s == pytest.approx(2 * case.period_s + 8)
    assert np.allclose(case.definition.returns_s()[-3:], case.period_s * np.arange(1, 4))
    with failing("program_not_periodic", key="thermal.cycles", value=3, raised=NotAllowed):
        sj.load("table1").changed({**KEPT, "thermal.cycles": 3})


def test_programs_of_a_truss_return_together() -> None:
    """The common program ends at 0 K, a second program does not; the return is added to both."""
    made = chain(table_temperature_change_K=[0.0, 70.0, 50.0, 0.0])
    made["program"] = [{"name": "shade", "shape": "table", "table_time_s": ROWS[0], "table_temperature_change_K": ROWS[1]}]
    made["link"][0]["program"] = "shade"
    case = sj.load(made)
    assert case.definition.ending.temperature_change_K == -26.0
    ends = [program.temperature_change(np.array([8.0, case.period_s])).tolist() for program in (
        case.definition.thermal_program(), *(engine_program(one) for one in case.definition.programs[1:]))]
    assert ends == [[0.0, 0.0], [-26.0, 0.0]]
    assert case.reduced().summary["largest_jump_m"] > 0
    # A sine cannot be lengthened.
    made["thermal"] = {"shape": "sine", "temperature_change_max_K": 50.0, "period_s": 8.0}
    run = sj.load(made).reduced()
    assert isnan(run.summary["largest_jump_m"])
    assert note("no_return", setting="tables_of_equal_cycles") in run.warnings


def test_members_return(tmp_path: Path) -> None:
    names = [link["name"] for link in chain()["link"]]
    rows = [f"time_s,{','.join(f'{name}_K' for name in names)}"]
    rows += [f"{time},{','.join(str(change * (1 + place)) for place in range(len(names)))}" for time, change in zip(*ROWS)]
    (tmp_path / "members.csv").write_text("\n".join(rows) + "\n")
    made = chain()
    made["thermal"] = {"shape": "table", "members_file": "members.csv"}
    write(made, tmp_path / "chain.toml", [])
    case = sj.load(tmp_path / "chain.toml")
    assert case.definition.ending.temperature_change_K == -26.0 * len(names)
    assert case.definition.ending.return_s == pytest.approx(RETURN_S)
    run = case.reduced()
    assert np.abs(run.links["thermal_strain"].values[-1]).max() < 1e-15
    assert np.abs(run.links["thermal_strain"].values).max() > 1e-4


def test_command_says_so(statejump, edited, tmp_path: Path) -> None:
    program = ('shape = "half_sine"', 'shape = "table"\ntable_time_s = [0, 1, 2]\ntable_temperature_change_K = [0, 90, 55]')
    text = edited(program).read_text().splitlines()
    lines = [line for line in text if not line.startswith(("temperature_change_max_K", "period_s"))]
    (tmp_path / "bad.toml").write_text("\n".join(lines))
    done = statejump("reduced", "bad.toml")
    assert done.status == 0, done.errors
    ending, = sj.load(tmp_path / "bad.toml").definition.thermal_notes
    assert ending == note("return_added", temperature_change_K=55.0, time_s=2.0)
    assert "program's end, 55 K: " in done.output and ending in " ".join(done.output.split())
    report = statejump("report", "results/table1/reduced.h5")
    assert report.status == 0, report.errors
    page = (tmp_path / "results" / "table1" / "report.html").read_text()
    assert "the program" in page and html.escape(ending, quote=False) in page

    kept = "\n".join(lines).replace("[thermal]", "[thermal]\nreturn_to_reference = false")
    (tmp_path / "bad.toml").write_text(kept)
    done = statejump("reduced", "bad.toml")
    assert done.status == 0 and "state jump:" not in done.output, done.output + done.errors
    ending, = sj.load(tmp_path / "bad.toml").definition.thermal_notes
    assert ending == note("no_return", temperature_change_K=55.0) and f"warning: {ending}" in done.output
    assert statejump("report", "results/table1/reduced.h5").status == 0
    assert "State jump" not in (tmp_path / "results" / "table1" / "report.html").read_text()
    for command in ("control", "convergence"):
        refused = statejump(command, "bad.toml")
        assert refused.status == 2, command
        assert refused.failure == failure("state_jump_undefined")


def test_answers_follow(statejump, tmp_path: Path) -> None:
    done = statejump("truss", "answers", chain_file(tmp_path), "--no-sensitivity")
    assert done.status == 0, done.errors
    assert sj.load(tmp_path / "chain.toml").definition.thermal_notes[0] in " ".join(done.output.split())
    result = read(tmp_path / "results" / "chain_3" / "answers.h5")
    by_hand = sj.load(chain(table_time_s=[*ROWS[0], 9.0], table_temperature_change_K=[*ROWS[1], 0.0])).reduced()
    assert abs(result.answers.summary["jump"].value) == pytest.approx(by_hand.summary["largest_jump_m"], rel=1e-9)
    refused = statejump("truss", "answers", chain_file(tmp_path, return_to_reference=False))
    assert refused.status == 2 and refused.failure == failure("state_jump_undefined", output=repr("statejump truss answers"))
    reduced = statejump("reduced", "chain.toml")
    assert reduced.status == 0 and "-26 K, no state" in " ".join(reduced.output.split())


def test_campaign_follows() -> None:
    case = sj.load("table1").changed(TABLE)
    vary = {"joint.friction_coefficient": {"distribution": "uniform", "low": 0.2, "high": 0.4}}
    campaign = sj.montecarlo(case, vary, samples=3)
    frame = campaign.frame()
    assert (frame["state_jump_m"] < 0).all() and (frame["displacement_at_program_end_m"] < -2e-4).all()
    (added,) = campaign.summary()["notes"]
    assert added == NOTE and f"note: {added}" in campaign.summary_lines()
    kept = sj.load("table1").changed(KEPT)
    found = outcome(kept.definition, "reduced")
    assert isnan(found["state_jump_m"])
    assert found["displacement_at_program_end_m"] == kept.reduced().summary["displacement_at_program_end_m"]
    with failing("state_jump_undefined", output="an output 'jump:...'"):
        values(["jump:displacement_m"], kept.reduced())
    # The quick run of a truss has samples at its ends only.
    truss = sj.load(chain())
    quick, run = outcome(truss.definition, "reduced"), truss.reduced()
    for name, other in (("largest_displacement_at_program_end_m",) * 2, ("largest_node_jump_m", "largest_jump_m")):
        assert quick[name] == pytest.approx(run.summary[other], rel=1e-9)


def test_yade_gets_the_return() -> None:
    table, trusses = sj.load("table1").changed(TABLE).definition, sj.load(chain()).definition
    values_of = table.behaviour.dem_values(table)
    for program, case in ((values_of["thermal"], table), (values_of["bar_program"], table),
                          (dem.dem_input(trusses)["programs"][0], trusses)):
        assert program["table_temperature_change_K"][-2:] == [-26.0, 0.0]
        assert program["table_time_s"][-1] == case.period_s


def test_table_of_zeros(statejump, edited, tmp_path: Path) -> None:
    """With zero temperature change both models report zero and pass the comparison; 'fe' refuses the case."""
    program = ('shape = "half_sine"', 'shape = "table"\ntable_time_s = [0, 0.1, 0.2]\ntable_temperature_change_K = [0, 0, 0]')
    lines = [line for line in edited(program).read_text().splitlines()
             if not line.startswith(("temperature_change_max_K", "period_s"))]
    (tmp_path / "bad.toml").write_text("\n".join(lines))
    done = statejump("compare", "bad.toml")
    assert done.status == 0, done.output + done.errors
    refused = statejump("fe", "bad.toml")
    assert refused.status == 2 and refused.failure == failure("fe_no_branch", key="thermal")
    assert statejump("control", "bad.toml").status == 0
