# SPDX-License-Identifier: GPL-3.0-or-later
"""statejump report: the page needs no other files, has a bounded size, and explains what it shows."""
from __future__ import annotations

import base64
import json
import math
import os
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any, Callable

import h5py
import numpy as np
import pytest

from conftest import BUILT, COMMAND, REPOSITORY, Outcome, sealed
from failures import Failure, failing, failure, note

from statejump.core import units
from statejump.core.comparison import models
from statejump.core.run import CONTACT_STATES, Column, Event, Events, Run
from statejump.kinds import kind, names
from statejump.report import page, labels
from statejump.report.decimation import errors, kept_samples
from statejump.report.document import TOLERANCE, Document
from statejump.report.drawing import round_down
from statejump.results import layout, scene as drawing
from statejump.results.contents import Result
from statejump.results.read import read
from statejump.schema.fields import rule_of
from statejump.schema.paths import keys_of

MEGABYTE = 1_000_000

# A build that could not make the page shows in the test report_page, one that was told not to has none.
pytestmark = pytest.mark.skipif(
    not (BUILT / "statejump" / "report" / page.SCRIPT).is_file(), reason="this build has no report page"
)


class Page(HTMLParser):
    """What a browser would load or run."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.scripts: list[tuple[dict[str, str | None], str]] = []
        self.identifiers: list[str] = []
        self.policy = ""
        self.styles = ""
        self.words = ""
        self._inside = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        attributes = dict(attrs)
        self.addresses += [
            attributes[name] or "" for name in ("src", "href", "srcset", "action", "poster", "data") if name in attributes
        ]
        if "id" in attributes:
            self.identifiers.append(attributes["id"] or "")
        if attributes.get("http-equiv") == "Content-Security-Policy":
            self.policy = attributes["content"] or ""
        self._inside = tag
        if tag == "script":
            self.scripts.append((attributes, ""))

    def handle_endtag(self, tag: str) -> None:
        self._inside = ""

    def handle_data(self, data: str) -> None:
        if self._inside == "script":
            attributes, text = self.scripts[-1]
            self.scripts[-1] = (attributes, text + data)
        elif self._inside == "style":
            self.styles += data
        else:
            self.words += " " + data

    @property
    def data(self) -> dict[str, Any]:
        """What the page's script gets."""
        return json.loads(next(text for attributes, text in self.scripts if attributes.get("type") == "application/json"))


def decoded(column: Any, samples: int) -> np.ndarray:
    """Return a column of the page."""
    if isinstance(column, dict):
        (kind, text), = column.items()
        return np.frombuffer(base64.b64decode(text), dtype={"f": "<f4", "u": "u1"}[kind])
    return np.full(samples, column)


@pytest.fixture(scope="module")
def results(yade: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of both models of two cases."""
    folder = tmp_path_factory.mktemp("report")
    for case in ("table1", "umbrella_damped"):
        done = subprocess.run(
            [COMMAND, "compare", REPOSITORY / "cases" / f"{case}.toml", "--quiet"], cwd=folder, env=os.environ,
            capture_output=True, text=True, timeout=300, stdin=subprocess.DEVNULL,
        )
        assert done.returncode == 0, done.stderr
    return folder / "results"


def written(statejump: Callable[..., Outcome], *arguments: object) -> tuple[Page, int]:
    """Return the page that the command writes, and its size in bytes."""
    done = statejump("report", *arguments, "-o", "page.html")
    assert done.status == 0, done.errors
    path = Path(done.output.rsplit("page: ", 1)[1].split(" (")[0])
    path = next(candidate for candidate in (path, _folder(statejump) / path) if candidate.is_file())
    return Page(path.read_text(encoding="utf-8")), path.stat().st_size


def _folder(statejump: Callable[..., Outcome]) -> Path:
    # The fixture runs the command in the test's own folder.
    return next(cell.cell_contents for cell in statejump.__closure__ or () if isinstance(cell.cell_contents, Path))


@pytest.mark.parametrize(("case", "most"), [("table1", 2), ("umbrella_damped", 5)])
def test_page_is_small_and_needs_nothing(
    statejump: Callable[..., Outcome], results: Path, case: str, most: float
) -> None:
    found, size = written(statejump, results / case)
    assert size < most * MEGABYTE
    assert all(address.startswith(("#", "data:")) for address in found.addresses)
    assert "default-src 'none'" in found.policy and "connect-src" not in found.policy
    assert "@import" not in found.styles and "url(" not in found.styles
    assert len(found.scripts) == 2 and all("src" not in attributes for attributes, _ in found.scripts)


def test_page_says_what_was_found(statejump: Callable[..., Outcome], results: Path) -> None:
    found, _ = written(statejump, results / "table1")
    result = read(results / "table1" / "comparison.h5")
    assert result.rows
    for row in result.rows:
        assert all(units.text(value, row.unit) in found.words for value in row.values.values()), row.name
    assert "23.8095\u202fµm" in found.words  # f l0/(E A) = 30 N · 0.5 m / (70 GPa · 9 mm²)
    assert f"all {len(result.rows)} compared" in found.words
    assert "stop reached" in found.words and "Hertz" not in found.words
    for library in ("three 0.", "@observablehq/plot", "d3-scale"):
        assert library in found.words, "the licence of a bundled library is missing"


def test_curves_on_the_page_are_those_of_the_file(statejump: Callable[..., Outcome], results: Path) -> None:
    found, _ = written(statejump, results / "umbrella_damped")
    result = read(results / "umbrella_damped" / "comparison.h5")
    for model in found.data["runs"][0]["models"]:
        history = result.models[model["key"]].history
        time = decoded(model["columns"]["time_s"], 0).astype(float)
        for name in ("theta2_rad", "eccentricity_x_m", "normal_force_N"):
            full = history[name].values
            line = np.interp(history["time_s"].values, time, decoded(model["columns"][name], len(time)))
            # What decimation may cost, and single precision: of the values, and of the times, by the
            # steepest slope, which for an impact is the whole range within one sample.
            step = np.min(np.diff(history["time_s"].values))
            single = np.finfo(np.float32).eps * (np.max(np.abs(full)) + np.ptp(full) * time[-1] / step)
            assert np.max(np.abs(line - full)) <= TOLERANCE * np.ptp(full) + single, name


def test_clearance_is_relative_and_in_full(statejump: Callable[..., Outcome], results: Path) -> None:
    """The position of the journal is stored relative to its bearing; absolute positions would round the clearance."""
    found, _ = written(statejump, results / "umbrella_damped")
    run = found.data["runs"][0]
    part = {part["type"]: part for part in run["scene"]["parts"]}
    point = run["scene"]["points"][part["journal"]["points"][0]]
    assert point["of"] == part["bearing"]["points"][0]
    columns = run["models"][0]["columns"]
    samples = len(decoded(columns["time_s"], 0))
    way = np.hypot(*(decoded(columns[name], samples).astype(float) for name in point["at"][:2]))
    depth = 1e-7  # the largest overlap at these forces is far below 0.1 µm
    assert part["bearing"]["clearance"] == pytest.approx(1e-4) and 0.99e-4 < np.max(way) < 1e-4 + depth
    assert run["scene"]["magnification"] == 20  # 3 % of 0.13 m over 0.1 mm is 39


def test_title_cannot_break_out(statejump: Callable[..., Outcome], edited: Callable[..., Path]) -> None:
    title = "</script><script>alert(1)</script><!-- <b>&amp; \\u2028"
    case = edited(('title = "Table 1, stop reached"', f"title = '{title}'"))
    assert statejump("reduced", case).status == 0
    found, _ = written(statejump, "results")
    assert len(found.scripts) == 2
    # Nothing that a browser could take for the begin or end of an element or a comment.
    assert not set("<>&") & set(next(text for attributes, text in found.scripts if attributes))
    assert found.data["runs"][0]["title"] == title
    assert title in found.words


def test_one_model_alone(statejump: Callable[..., Outcome], cases: Path, tmp_path: Path) -> None:
    assert statejump("reduced", cases / "umbrella_damped.toml").status == 0
    found, _ = written(statejump, "results/umbrella_damped/reduced.h5")
    assert [model["key"] for model in found.data["runs"][0]["models"]] == ["reduced"]
    kind, sentence = Document(read(tmp_path / "results/umbrella_damped/reduced.h5"), "x.h5", "run1", 1e6).verdict
    assert kind == "none" and sentence in found.words


def test_several_runs(statejump: Callable[..., Outcome], results: Path) -> None:
    found, size = written(statejump, results)
    assert [run["id"] for run in found.data["runs"]] == ["run1", "run2"]
    assert len(set(found.identifiers)) == len(found.identifiers)
    assert {"#run1", "#run2"} <= set(found.addresses) and "2 runs" in found.words
    for case in ("table1", "umbrella_damped"):  # two runs of one title are told apart
        assert f"{case}/comparison.h5" in found.words and f"{case}," in found.words
    assert "statejump compare" in found.words
    assert size < 5 * MEGABYTE


def test_events_of_both_models_stand_in_one_row() -> None:
    result = _truss(3, 50)
    for model, late in (("reduced", 0.0), ("dem", 0.04)):
        events = [
            Event("slip", 0.1 + late, 1.0, "joint_0"), Event("stick", 0.3, 2.0, "joint_0"),
            Event("slip", 0.5 + late, 1.0, "joint_0", 2.5e-4), Event("slip", 0.5, 1.0, "joint_1"),
        ]
        if late:
            events.insert(1, Event("slip", 0.2, 1.0, "joint_0"))  # one that only the DEM has
        result.models[model] = replace(result.models[model], events=Events(events))
    rows, omitted = Document(result, "x.h5", "run1", 1e6).events()
    assert omitted == 0 and [len(row["at"]) for row in rows] == [2, 1, 2, 2, 2]
    assert [row["time_s"] for row in rows] == [0.1, 0.2, 0.3, 0.5, 0.5]
    assert rows[3]["at"]["dem"]["time"] == "540\u202fms" and rows[3]["at"]["dem"]["uncertainty"] == "250\u202fµs"


def test_an_event_has_the_error_of_its_samples_and_the_reason_why_one_model_has_it(results: Path) -> None:
    rows, _ = Document(read(results / "table1" / "comparison.h5"), "x.h5", "run1", 1e6).events()
    found = {row["kind"]: row for row in rows}
    first = found["first slip"]["at"]
    # Half a sample of half a sine of 100 K near its start: 0.25 ms · 100 K · π/s.
    assert first["dem"]["uncertainty_K"] == "0.079\u202fK" and not first["reduced"]["uncertainty_K"]
    for kind_of_event in ("stick", "slip"):
        assert set(found[kind_of_event]["at"]) == {"dem"} and found[kind_of_event]["reason"] == note("stop_carries")
    assert found[labels.EVENTS["force_sign_change"]]["reason"] == note("stage_of_reduced_model")
    assert all(row["reason"] == "" for row in rows if len(row["at"]) == 2)


@pytest.mark.parametrize(
    ("name", "content", "wanted"),
    [
        ("missing.h5", None, failure("result_file_not_found", file="missing.h5")),
        ("text.h5", b"time_s\n0\n", failure("no_result_format", file="text.h5")),
        ("empty", "folder", failure("result_file_missing", file="empty")),
    ],
)
def test_bad_runs(
    statejump: Callable[..., Outcome], tmp_path: Path, name: str, content: bytes | str | None, wanted: Failure
) -> None:
    if content == "folder":
        (tmp_path / name).mkdir()
    elif isinstance(content, bytes):
        (tmp_path / name).write_bytes(content)
    done = statejump("report", name)
    assert (done.status, done.failure) == (2, wanted)
    assert not list(tmp_path.rglob("*.html"))


def test_other_hdf5(statejump: Callable[..., Outcome], tmp_path: Path) -> None:
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1
    done = statejump("report", "other.h5")
    assert (done.status, done.failure) == (2, failure("result_without_checksum", file="other.h5"))


def test_case_that_this_version_does_not_know(statejump: Callable[..., Outcome], results: Path, tmp_path: Path) -> None:
    """The page shows what there is of it."""
    path = tmp_path / "other.h5"
    path.write_bytes((results / "table1" / "comparison.h5").read_bytes())
    with h5py.File(path, "r+") as file:
        del file["case/resolved"]
        file["case/resolved"] = '{"node": [{"x": 1}, [2]], "case": {"kind": "unheard"}, "more": 3}'
    done = statejump("report", sealed(path), "-o", "page.html")
    assert (done.status, done.errors) == (0, "") and "2 entries" in (tmp_path / "page.html").read_text()


def test_page_that_cannot_be_written(statejump: Callable[..., Outcome], results: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = statejump("report", results / "table1", "-o", "file/page.html")
    assert (done.status, done.failure) == (2, failure("write_failed", file="file/page.html"))
    assert "Traceback" not in done.errors


def test_script_that_was_not_built(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(page, "HERE", tmp_path)
    with failing("page_script_missing", script=tmp_path / page.SCRIPT):
        page.render([])


def test_code_that_would_end_its_element() -> None:
    with pytest.raises(ValueError):
        page.embedded_code("x = '</SCRIPT>'", "script")


def test_campaign(statejump: Callable[..., Outcome], cases: Path, tmp_path: Path) -> None:
    text = (cases / "campaigns" / "table1_tolerances.toml").read_text()
    text = text.replace('"../table1.toml"', f'"{cases}/table1.toml"').replace("samples = 10000", "samples = 300")
    title = "</script><script>alert(1)</script>"
    (tmp_path / "campaign.toml").write_text(text.replace('title = "Table 1 with tolerances"', f'title = "{title}"'))
    assert statejump("montecarlo", "campaign.toml").status == 0
    found, size = written(statejump, "results/campaign_table1_tolerances")
    assert size < 2 * MEGABYTE and len(found.scripts) == 2 and title in found.words
    campaign = found.data["campaigns"][0]
    with h5py.File(tmp_path / "results/campaign_table1_tolerances/samples.h5") as file:
        for histogram, outcome in zip(campaign["histograms"], ("state_jump_m", "first_slip_temperature_change_K")):
            values = file[f"outcomes/{outcome}"][()]
            assert sum(histogram["counts"]) == np.count_nonzero(np.isfinite(values)) == 300
            middle = histogram["quantiles"][1]
            assert middle == pytest.approx(np.median(values) * (1e6 if outcome.endswith("_m") else 1))
    # The jump is f l0/(E A): it follows friction above all.
    assert campaign["ranks"][0]["bars"][0]["parameter"] == labels.of_kind("spring_slider").parameter("joint.friction_coefficient")
    assert units.text(float(np.median(values)), "K", 4) in found.words


def test_sweep_beside_a_run(statejump: Callable[..., Outcome], cases: Path) -> None:
    assert statejump("sweep", cases / "campaigns" / "table1_friction.toml").status == 0
    assert statejump("reduced", cases / "table1.toml").status == 0
    found, _ = written(statejump, "results")
    assert [len(found.data[key]) for key in ("runs", "campaigns")] == [1, 1]
    curve = found.data["campaigns"][0]["curves"][0]
    assert len(curve["points"]) == 63 and curve["z"].startswith("Clearance plus")
    last = max(curve["points"], key=lambda point: point["x"])
    assert last["y"] == pytest.approx(1e6 * 100 * 0.5 / (70e9 * 9e-6))  # μ = 1: f = 100 N


def _truss(joints: int, samples: int) -> Result:
    """A chain of links with a clearance joint each; every journal moves differently."""
    time = np.linspace(0.0, 1.0, samples)
    change = 100 * np.sin(np.pi * time)
    names = [f"joint_{place}" for place in range(joints)]
    phase = np.arange(joints)
    clearance, radius, length = 1e-4, 5e-3, 0.1
    turn = 2 * np.pi * time[:, None] * (1 + phase % 5) + phase
    offset = clearance * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=2)
    state = ((turn / 2).astype(int) % 3).astype(np.uint8)
    parts: list[dict[str, Any]] = []
    for place, name in enumerate(names):
        bearing = [length * (place + 1) + 0.0, 0.0, 0.0]
        journal = drawing.ref("contacts/journal_m", name)
        parts += [
            {"name": f"bearing_{place}", "type": "bearing", "centre": bearing, "angle_rad": 0.0,
             "radius_m": radius + clearance},
            {"name": f"journal_{place}", "type": "journal", "centre": journal, "angle_rad": 0.0, "radius_m": radius},
            {"name": f"link_{place}", "type": "link", "ends": [[length * place, 0.0, 0.0], journal], "width_m": 3e-3},
        ]
    places = offset + np.stack([length * (phase + 1.0), 0 * phase, 0 * phase], axis=1)[None]
    force = 1e5 * offset * np.where(state > 0, 1.0, 0.0)[:, :, None]

    def run(model: str) -> Run:
        return Run(
            model,
            history={"time_s": Column(time, "s"), "temperature_change_K": Column(change, "K"),
                     "tip_displacement_m": Column(1e-3 * change, "m")},
            energy={"thermal_work_J": Column(change, "J"), "elastic_energy_J": Column(change, "J")},
            links={},
            contacts={
                "state": Column(state, items="contacts", labels=CONTACT_STATES),
                "gap_m": Column(np.where(state > 0, 0.0, clearance), "m", "contacts"),
                "journal_m": Column(places, "m", "contacts"),
                "point_m": Column(places * (1 + radius), "m", "contacts"),
                "normal_force_N": Column(-force, "N", "contacts"),
                "tangential_force_N": Column(0.3 * force[:, :, [1, 0, 2]], "N", "contacts"),
            },
            events=Events([Event("first_slip", 0.1 * place / joints, 1.0, name) for place, name in enumerate(names)]),
            summary={"state_jump_m": 1e-4},
        )

    contacts = [(name, f"journal_{place}", f"bearing_{place}") for place, name in enumerate(names)]
    return Result(
        "compare", True, "chain", "truss", "A hundred joints", "", "", "{}", {}, {"contacts": names},
        drawing.description(parts, contacts, clearance), {"reduced": run("reduced"), "dem": run("dem")},
        (models("state_jump", "m", 1e-4, 1e-4, 1e-6),),
    )


def test_a_hundred_joints(tmp_path: Path) -> None:
    # Ten revolutions in 2000 samples: more samples are wanted than the page may hold.
    document = Document(_truss(100, 2000), "chain.h5", "run1", 7e6)
    text = page.render([document])
    assert len(text.encode()) < 10 * MEGABYTE
    assert all(kept.kept < kept.samples and kept.error > 0 for kept in document.kept)
    assert f"{document.kept[0].kept} of 2\u202f000 samples" in " ".join(Page(text).words.split(" "))


def test_decimation_keeps_what_it_says() -> None:
    generator = np.random.default_rng(1)
    time = np.cumsum(generator.uniform(0.1, 1.0, 3000))
    columns = np.stack([np.sin(time / 50), np.where(time > 700, 1.0, 0.0), np.zeros(3000)], axis=1)
    columns[1234, 0] = 30.0  # an impact of one sample
    for most, tolerance in ((3000, 1e-3), (25, 1e-3)):
        chosen = kept_samples(time, columns, most, tolerance, always=(17,))
        error = errors(time, columns.T, chosen).max()
        lines = np.stack([np.interp(time, time[chosen], column[chosen]) for column in columns.T], axis=1)
        real = np.max(np.abs(lines - columns) / np.maximum(np.ptp(columns, axis=0), 1e-300))
        assert error == pytest.approx(real, rel=1e-9)
        assert {0, 17, 1234, 2999} <= set(chosen.tolist())
        assert error <= tolerance or len(chosen) == most
    assert len(kept_samples(time, columns[:, 2:], 10, 1e-3)) == 2


def test_decimation_finds_the_kinks() -> None:
    # Straight lines deviate most from straight pieces where the pieces meet.
    time, kinks = np.arange(2000.0), [0, 300, 301, 950, 1700, 1999]
    column = np.interp(time, kinks, [0.0, 1.0, -1.0, 0.5, 0.4, 0.0])
    assert kept_samples(time, column[:, None], 100, 1e-9).tolist() == kinks


@pytest.mark.parametrize(
    ("value", "unit", "expected"),
    [
        (2.380952380952381e-05, "m", "23.8095\u202fµm"), (-7.65e-11, "m", "−0.0765\u202fnm"), (0.0, "J", "0\u202fJ"),
        (9e-6, "m2", "9\u202fmm²"), (70e9, "Pa", "70\u202fGPa"), (87.5, "K", "87.5\u202fK"), (2e-4, "-", "0.0002"),
        (1e-22, "J", "1.00000·10⁻²²\u202fJ"), (0.5, "s", "500\u202fms"), (123456.0, "K", "123456\u202fK"), (math.nan, "m", "none"), (None, "m", "none"),
        (1.0, "N m/rad", "1\u202fN·m/rad"),
    ],
)
def test_numbers_with_units(value: float | None, unit: str, expected: str) -> None:
    assert units.text(value, unit) == expected


UNIT_WORDS = {word for ending in units.ENDINGS for word in ending.split("_") if word}


@pytest.mark.parametrize("name", names())
def test_no_unit_rests_in_a_label(name: str) -> None:
    """Labels of keys, columns and tables contain no unit: the unit at the end of a key is removed."""
    found, case = labels.of_kind(name), kind(name).Case
    keys = [path.rpartition(".")[2] for path in keys_of(case)]
    tables = [column for _, columns in layout.TABLES.values() for column in columns]
    for key in (*keys, *kind(name).COLUMNS, *tables, "friction_v1_m_per_s", "rolling_resistance_N_m_s_per_rad"):
        label = found.plain(key)
        assert label and label.split()[-1] not in UNIT_WORDS, (key, label)
    # The one table of endings knows all units that keys have.
    for path, attribute in keys_of(case).items():
        unit = getattr(rule_of(attribute), "unit", None)
        assert unit in (None, "-", units.unit_of(path)), path


def test_labels_of_keys() -> None:
    found = labels.Labels({"link_ab": "Link AB", "tip_jump": "Jump of the tip", "stage S1": "rest"})
    assert found.plain("friction_v1_m_per_s") == "Friction v1" and found.plain("tip_jump_m") == "Jump of the tip"
    assert found.parameter("link.young_modulus_Pa") == "Young's modulus of link"
    assert found.parameter("link_ab.density_kg_per_m3") == "Density of Link AB"
    assert found.parameter("revolute.*.radial_clearance_m") == "Radial clearance of all revolutes"
    assert found.parameter("torsion_spring.T1.stiffness_N_m_per_rad") == "Stiffness of torsion spring T1"
    assert found.parameter("first_slip_temperature_change_K") == "First slip ΔT"
    assert found.stage("S1") == ("S1", "rest") and found.stage("S9") == ("S9", "")


def test_numbers_for_terminals() -> None:
    assert units.plain(-2.38095e-05, "m") == "-23.8095 µm"


@pytest.mark.parametrize(("value", "expected"),
                         [(0.3, 1), (1, 1), (4.99, 2), (5, 5), (39, 20), (1999, 1000), (math.inf, math.inf)])
def test_default_magnification_is_round(value: float, expected: float) -> None:
    assert round_down(value) == expected
