# SPDX-License-Identifier: GPL-3.0-or-later
"""Rare errors: unusual values, unusual installations of YADE, signals, both stops reached in one cycle."""
from __future__ import annotations

import os
import signal
import subprocess
import time
import tomllib
from pathlib import Path

import numpy as np
import pytest

from conftest import COMMAND, damaged
from failures import failing, failure
from statejump import _paths, load
from statejump.campaign.campaign_file import load_campaign
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import load_case, parse_case
from statejump.kinds.spring_slider import compare, reduced, result

HUGE = 10**400
FRICTION = "friction_coefficient = 0.3"
ODD_VALUES = {
    "a whole number beyond floating point": (
        (FRICTION, f"friction_coefficient = {HUGE}"),
        failure("out_of_range", key="joint.friction_coefficient", value=HUGE),
    ),
    "a list for a text": (
        ('shape = "half_sine"', "shape = [1]"),
        failure("not_string", key="thermal.shape", value=[1]),
    ),
    "a number outside of the sections": (
        ("[case]", "links = 3\n[case]"),
        failure("misspelt_key", key="links", meant="[link]"),
    ),
    "a name that leaves the results folder": (
        ('name = "table1"', 'name = "../table1"'),
        failure("no_folder_name", key="case.name", value="../table1"),
    ),
    "a table that does not rise": (
        ("temperature_change_max_K = 100", "table_time_s = [0, 2, 1]\ntable_temperature_change_K = [0, 1, 0]"),
        failure("table_times", key="thermal.table_time_s", value=[0.0, 2.0, 1.0]),
    ),
    "a bar that shrinks to nothing": (
        ("temperature_change_max_K = 100", "temperature_change_max_K = -9000"),
        failure("link_without_length", key="link.thermal_expansion_per_K", value=0.0005, at_K=-9000.0),
    ),
    "friction beyond the bar's rigidity": (
        ("normal_force_N = 100", "normal_force_N = 1e9"),
        failure("friction_above_rigidity", key="joint.friction_coefficient", value=0.3, friction_force_N=300000000.0, rigidity=630000.0),
    ),
}


@pytest.mark.parametrize("name", ODD_VALUES)
def test_odd_value_is_one_sentence(edited, name: str) -> None:
    replacement, sentence = ODD_VALUES[name]
    more = {
        "a bar that shrinks to nothing": [("23.4e-6", "5e-4")],
        "a table that does not rise": [('"half_sine"', '"table"')],
    }
    path = edited(replacement, *more.get(name, []))
    with pytest.raises(StatejumpError) as raised:
        load_case(path)
    assert raised.value == sentence.at(file=path)


@pytest.mark.parametrize("place", [(), ("joint",), ("case",)])
def test_key_of_a_dict_that_is_no_text(cases: Path, place: tuple[str, ...]) -> None:
    document = tomllib.loads((cases / "table1.toml").read_text())
    (document[place[0]] if place else document)[1] = 2
    with failing("no_such_key"):
        load_case(document)


def test_name_that_no_file_can_have(cases: Path, tmp_path: Path) -> None:
    """Of a case, and of the case of a campaign."""
    for name in ("x" * 5000, f"{cases}/{'x' * 300}.toml", f"{cases}/table1.toml/x"):
        with failing("read_failed"):
            load_case(name)
    campaign = tmp_path / "campaign.toml"
    campaign.write_text(f"[campaign]\nname = 'a'\ncase = '{'x' * 5000}'\n[[vary]]\nkey = 'joint.friction_coefficient'\n"
                        "values = [0.1]\n")
    with failing("read_failed"):
        load_campaign(campaign, "sweep")


@pytest.mark.parametrize("key", ["low", "high", "standard_deviation", "relative"])
def test_whole_number_beyond_floating_point_in_a_campaign(cases: Path, tmp_path: Path, key: str) -> None:
    campaign = tmp_path / "campaign.toml"
    campaign.write_text(f"[campaign]\nname = 'a'\ncase = '{cases}/table1.toml'\nsamples = 2\nseed = 1\n[[vary]]\n"
                        f"key = 'joint.friction_coefficient'\ndistribution = 'normal'\n{key} = {HUGE}\n")
    with failing("not_finite_above" if "v" in key else "not_finite", key=key, value=HUGE):
        load_campaign(campaign, "montecarlo")


def test_damaged_files_never_end_in_another_error(cases: Path) -> None:
    """A file with any damage either loads and solves, or a StatejumpError explains in one sentence why not."""
    text = (cases / "table1.toml").read_text()
    original = tomllib.loads(text)
    values = [0, 1, -1, 1e-300, 1e300, -1e300, float("nan"), float("inf"), HUGE, True, "", "x", [], [1], {},
              {"a": 1}, 3.5, 1e-3, 1e3, [0, 1], ["0"], tomllib.loads("d = 2021-01-01")["d"]]
    sentences = 0
    for data in damaged(original, values, 4000):
        try:
            reduced.solve(parse_case(data))
        except StatejumpError as error:
            sentences += 1
            assert "\n" not in str(error)
    assert 2000 < sentences < 4000  # some damage is harmless


DONE = "echo 'STATEJUMP {\"progress\": 1.0}'\n"
NAMES = """printf '["time_s", "displacement_m"]\\n'; head -c"""  # so many bytes of zeros behind it
ODD_YADES = {
    "no history": DONE,
    "an empty history": f'touch "$STATEJUMP_OUTPUT"\n{DONE}',
    "a row cut short": f'({NAMES} 24 /dev/zero) > "$STATEJUMP_OUTPUT"\n{DONE}',
    "text": f'echo "time_s,displacement_m" > "$STATEJUMP_OUTPUT"\n{DONE}',
    "numbers for names": f'echo "[1, 2]" > "$STATEJUMP_OUTPUT"\n{DONE}',
    "no summary": f'({NAMES} 16 /dev/zero) > "$STATEJUMP_OUTPUT"\n{DONE}',
    "progress without a number": "echo STATEJUMP soon\nexit 4\n",
}


@pytest.mark.parametrize("name", ODD_YADES)
def test_run_without_a_complete_result(statejump, cases: Path, fake_yade, tmp_path: Path, name: str) -> None:
    outcome = statejump("compare", cases / "table1.toml", STATEJUMP_YADE=fake_yade(ODD_YADES[name]))
    assert outcome.status == 2 and outcome.errors.startswith("error: "), outcome.errors
    assert outcome.errors.count("\n") == 1 and "Traceback" not in outcome.errors
    assert not any(entry.is_file() for entry in (tmp_path / "results").rglob("*"))


def test_yade_that_is_no_program(statejump, cases: Path, fake_yade) -> None:
    yade = Path(fake_yade(""))
    yade.write_bytes(b"\x00 neither a script nor a program")
    outcome = statejump("--json", "dem", cases / "table1.toml", STATEJUMP_YADE=str(yade))
    assert outcome.status == 2 and outcome.failure == failure("yade_not_started")


def _running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.parametrize("command, number, status, share", [
    ("dem", signal.SIGTERM, 143, "50 %"),
    # Half of the first of twelve runs.
    ("convergence", signal.SIGINT, 130, "4 %"), ("convergence", signal.SIGTERM, 143, "4 %"),
])
def test_signal_ends_yade_and_its_children(
    cases: Path, fake_yade, tmp_path: Path, command: str, number: int, status: int, share: str
) -> None:
    yade = fake_yade(
        f'({NAMES} 16 /dev/zero) > "$STATEJUMP_OUTPUT.partial"\n'
        f'sleep 60 &\necho "$$ $!" > {tmp_path}/pids\n' "echo 'STATEJUMP {\"progress\": 0.5}'\nwait\n"
    )
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    process = subprocess.Popen(
        [COMMAND, command, str(cases / "table1.toml")], cwd=tmp_path, text=True, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        env={**os.environ, "STATEJUMP_YADE": yade, "PYTHONUNBUFFERED": "1", "TMPDIR": str(scratch)},
    )
    assert process.stdout is not None and share in process.stdout.readline()
    process.send_signal(number)
    _, errors = process.communicate(timeout=20)
    assert process.returncode == status and "Traceback" not in errors
    pids = [int(word) for word in (tmp_path / "pids").read_text().split()]
    deadline = time.monotonic() + 5
    while any(map(_running, pids)) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not any(map(_running, pids))
    assert list(scratch.iterdir()) == []
    assert not any(entry.is_file() for entry in (tmp_path / "results").rglob("*"))


def test_wrong_python_has_status_2() -> None:
    changed = Path(COMMAND).read_text().replace("WANTED = (3, ", "WANTED = (2, ")
    done = subprocess.run([_paths.PYTHON, "-c", changed], capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and done.stderr.startswith("error: ")


def test_stop_left_is_the_one_reached_first(cases: Path) -> None:
    """A sine program reaches both stops in one cycle; both models must report the stop reached first."""
    case = load(cases / "table1.toml").changed({"thermal.shape": "sine"})
    run = case.reduced()
    columns = run.flat()
    assert columns["stop_force_N"].min() < -100 and columns["stop_force_N"].max() > 100
    stage = columns.pop("stage")
    columns["slipping"] = np.isin(stage, ("S2", "S5")).astype(float)
    # The stop is left where the block slides away from it, as in the DEM with its elastic stops.
    left = [event.temperature_change_K for event in run.events if event.kind == "stop_left"]
    contact = np.abs(columns["displacement_m"]) > 1e-3 - 1e-12
    columns["stop_contact"] = contact.astype(float)
    columns["stop_force_N"] = np.where(contact, -np.sign(columns["displacement_m"]), 0.0)
    for name in ("contact_energy_J", "kinetic_energy_J", "damping_dissipation_J", "external_work_J"):
        columns[name] = np.zeros(len(contact))
    dem = result.dem_run(case.definition, columns, {})
    found = compare.dem_event_temperatures(dem, case["dem.samples_per_cycle"])
    assert left[0] > 0 > left[1]
    assert found["stop_left"] == pytest.approx(left[0], abs=0.5)
