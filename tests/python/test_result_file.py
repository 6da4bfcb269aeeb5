# SPDX-License-Identifier: GPL-3.0-or-later
"""The result file: layout, content, reproducibility, conversions, and messages for invalid files."""
from __future__ import annotations

import csv
import json
import math
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any, Callable

import h5py
import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

from conftest import COMMAND, REPOSITORY, sealed
from failures import failing, failure
import statejump as sj
from statejump.core.errors import StatejumpError
from statejump.core.run import AT_STOP, GROUPS, SEPARATED, SLIP, STICK, Column, Event, Events, Run
from statejump.core.table_files import read_columns
from statejump.core.tables import write_columns
from statejump.kinds.spring_slider import compare as slider_compare, result as slider_result
from statejump.results import layout, scene
from statejump.results.contents import Mesh, Result
from statejump.results.difference import case_differences, difference
from statejump.results.events import from_states
from statejump.results.export_csv import write_histories
from statejump.results.export_vtk import write_all as write_vtk
from statejump.results.paraview_script import NAME, write_script
from statejump.results.read import read
from statejump.results.record import save
from statejump.results.scene_check import problems
from statejump.results.vtk_data import frames_of
from statejump.results.write import write

# Short runs of every kind: what is compared is the file, not the models.
SHORT = {
    "table1": [("period_s = 1.0", "period_s = 0.1")],
    "umbrella_damped": [("period_s = 1.0 ", "period_s = 0.2 "), ("steps_per_cycle = 400000", "steps_per_cycle = 50000"),
                        ("steps_per_cycle = 100000", "steps_per_cycle = 50000")],
}


def short_case(name: str, folder: Path, *more: tuple[str, str]) -> Path:
    text = (REPOSITORY / "cases" / f"{name}.toml").read_text()
    for old, new in (*SHORT[name], *more):
        assert old in text, old
        text = text.replace(old, new, 1)
    path = folder / f"{name}.toml"
    path.write_text(text)
    return path


def run(folder: Path, *arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run([COMMAND, *map(str, arguments)], cwd=folder, capture_output=True, text=True,
                          timeout=300, stdin=subprocess.DEVNULL)


@pytest.fixture(scope="module")
def compared(yade: str, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Results folder of ``compare`` of a short case, made once."""
    made: dict[str, Path] = {}

    def folder(name: str) -> Path:
        if name not in made:
            root = tmp_path_factory.mktemp(name)
            done = run(root, "compare", short_case(name, root))
            assert done.returncode in (0, 1), done.stderr  # a coarse step may miss a tolerance
            made[name] = root / "results" / name
        return made[name]

    return folder


KINDS = pytest.mark.parametrize("name", SHORT)


def places(file: h5py.File) -> dict[str, Any]:
    """Every group, data set and group attribute, by its path in the file."""
    found: dict[str, Any] = {f"/@{key}": value for key, value in file.attrs.items()}

    def add(name: str, item: Any) -> None:
        found[f"/{name}"] = item
        if isinstance(item, h5py.Group):
            found.update({f"/{name}@{key}": value for key, value in item.attrs.items()})

    file.visititems(add)
    return found


def type_of(value: Any) -> str:
    """The type of a place as the layout writes it."""
    if isinstance(value, h5py.Group):
        return "group"
    if isinstance(value, str):
        return "text"
    kind = value.dtype
    return "text" if h5py.check_string_dtype(kind) else str(kind)


def check_layout(path: Path) -> None:
    with h5py.File(path) as file:
        found = places(file)
        for place, value in found.items():
            entry = layout.entry_of(place)
            assert entry is not None, f"{place} is not in the layout"
            assert type_of(value) in entry.form.types, f"{place} is {type_of(value)}, the layout says {entry.form}"
            if isinstance(value, h5py.Dataset):
                assert value.ndim in map(len, entry.form.shapes), f"{place} has {value.ndim} axes"
                assert set(value.attrs) <= set(layout.ATTRIBUTES), place
                numeric = type_of(value) != "text" and not place.startswith("/comparison")
                assert ("unit" in value.attrs) == numeric, f"{place}: unit"
        for entry in layout.ENTRIES:
            models = list(file["models"]) if "{model}" in entry.path else [""]
            for model in models if entry.required else ():
                assert entry.path.replace("{model}", model) in found, entry.path


@KINDS
def test_every_place_is_in_the_layout_and_the_other_way_round(compared, name: str) -> None:
    check_layout(compared(name) / "comparison.h5")


def test_documentation_has_the_layout() -> None:
    text = (REPOSITORY / "docs" / "reference" / "result_file.md").read_text()
    assert layout.markdown() in text, "make the tables again: statejump.results.layout.markdown()"
    assert f"Version {layout.VERSION}." in text
    for kind in (*scene.PART_TYPES, *scene.FORCE_KINDS):
        assert f"`{kind}`" in text, kind


@KINDS
def test_the_same_case_gives_the_same_bytes(compared, tmp_path: Path, name: str) -> None:
    first = compared(name) / "comparison.h5"
    run(tmp_path, "compare", short_case(name, tmp_path))
    again = tmp_path / "results" / name / "comparison.h5"
    assert again.read_bytes() == first.read_bytes()
    # and reading loses nothing
    write(read(first), tmp_path / "copy.h5")
    assert (tmp_path / "copy.h5").read_bytes() == first.read_bytes()


@KINDS
def test_nothing_of_the_machine_and_of_the_day(compared, name: str) -> None:
    result = read(compared(name) / "comparison.h5")
    summary = json.loads((compared(name) / "dem_run.json").read_text())
    assert "wall_time_s" in summary and "wall_time_s" not in result.models["dem"].summary
    texts = [*map(str, result.provenance.values()), result.case_json, json.dumps(result.scene), *result.warnings]
    assert not any("/tmp" in text or str(REPOSITORY) in text for text in texts)


@KINDS
def test_case_and_provenance(compared, name: str) -> None:
    folder = compared(name)
    result = read(folder / "comparison.h5")
    case = sj.load(folder.parents[1] / f"{name}.toml")
    assert result.case_text == (folder.parents[1] / f"{name}.toml").read_text()
    assert result.case == case and json.loads(result.case_json)["thermal"]["cycles"] == 1
    assert result.complete and result.command == "compare" and result.kind == case.kind
    assert result.provenance["threads"] == 1 and result.provenance["yade_version"]
    assert result.provenance["numpy_version"] == np.__version__
    assert ("seed" in result.provenance) == (name == "umbrella_damped")


@KINDS
def test_csv_comes_from_the_file_and_is_what_it_was(compared, tmp_path: Path, name: str) -> None:
    folder = compared(name)
    assert run(tmp_path, "export", folder / "comparison.h5", "--format", "csv", "--to", "out").returncode == 0
    for file in ("reduced_history.csv", "dem_history.csv", "comparison.csv"):
        assert (tmp_path / "out" / file).read_bytes() == (folder / file).read_bytes(), file
    result = read(folder / "comparison.h5")
    for model in result.models:
        # Nothing is lost on the way through the table.
        write_columns(read_columns(folder / f"{model}_history.csv"), tmp_path / "own.csv")
        assert (tmp_path / "own.csv").read_bytes() == (folder / f"{model}_history.csv").read_bytes()
    with (tmp_path / "out" / "dem_events.csv").open() as stream:
        assert [row["kind"] for row in csv.DictReader(stream)] == [event.kind for event in result.models["dem"].events]


def test_reduced_history_is_that_of_the_model(compared, tmp_path: Path) -> None:
    result = read(compared("table1") / "comparison.h5")
    expected = result.case.reduced().at(result.models["dem"].time_s)
    found = result.models["reduced"].flat()
    assert set(found) == set(expected.flat())
    for name, values in expected.flat().items():
        assert np.array_equal(found[name], values), name


def test_comparison_rows_come_back(compared) -> None:
    for name in SHORT:
        folder = compared(name)
        result = read(folder / "comparison.h5")
        document = json.loads((folder / "comparison.json").read_text())
        assert result.passed == document["pass"]
        assert result.comparison is not None and result.comparison.passed == result.passed
        assert [row.to_dict() for row in result.rows or []] == document["quantities"]


def test_contacts_of_the_slider(compared) -> None:
    result = read(compared("table1") / "comparison.h5")
    assert result.names["contacts"] == ["floor", "stop_minus", "stop_plus"]
    for model, found in result.models.items():
        state = found.contacts["state"].values
        assert set(np.unique(state[:, 0])) == {STICK, SLIP}
        assert set(np.unique(state[:, 1])) == {SEPARATED} and set(np.unique(state[:, 2])) == {SEPARATED, AT_STOP}
        force = found.contacts["normal_force_N"].values
        pushed = force[:, 2, 0] < 0
        assert pushed.any() and np.all(state[pushed, 2] == AT_STOP)
        # Forces on the block in x and the bar's add up: exactly in the quasi-static model, to the inertia
        # in the DEM, which is small but for the samples after an impact (0.014 N at nine in ten of them).
        total = found.history["axial_force_N"].values + force[:, :, 0].sum(axis=1) + (
            found.contacts["tangential_force_N"].values[:, :, 0].sum(axis=1))
        limit = 1e-9 if model == "reduced" else 0.1
        assert np.quantile(np.abs(total), 1.0 if model == "reduced" else 0.9) < limit, model
    kinds = [event.kind for event in result.models["reduced"].events]
    assert kinds == ["first_slip", "stop_reached", "stop_unloaded", "force_sign_change", "stop_left", "cycle_end"]
    # Read off the states of the DEM: the same as the comparison finds.
    expected = slider_compare.dem_event_temperatures(result.models["dem"], result.case.samples_per_cycle)
    for kind, change in expected.items():
        event = next(event for event in result.models["dem"].events if event.kind == kind)
        assert event.temperature_change_K == change and event.joint == ("floor" if kind == "first_slip" else "stop_plus")
        assert event.time_uncertainty_s == pytest.approx(0.1 / 2000 / 2, rel=1e-6)


def test_both_stops_of_the_slider(cases: Path) -> None:
    case = sj.load(cases / "table1.toml").changed({"thermal.shape": "sine"})
    ours = case.reduced()
    history = ours.flat()
    # The same as a DEM would give it: flags instead of stages.
    columns = dict(history)
    stage = columns.pop("stage")
    columns["slipping"] = np.isin(stage, ("S2", "S5")).astype(float)
    columns["stop_contact"] = (columns["stop_force_N"] != 0).astype(float)
    columns["floor_normal_force_N"] = np.full(len(stage), 100.0)
    other = slider_result.dem_run(case.definition, columns, {})
    for place, side in ((1, -1), (2, 1)):
        pushed = side * history["stop_force_N"] < 0
        assert pushed.any()
        for found in (ours, other):
            state, force = found.contacts["state"].values, found.contacts["normal_force_N"].values
            assert np.all(state[pushed, place] == AT_STOP) and np.all(state[pushed, 3 - place] == SEPARATED)
            assert np.array_equal(force[:, place, 0], np.where(pushed, history["stop_force_N"], 0))
        # The rigid stop is touched until the block slides away, an elastic one while it carries force.
        at_stop = ours.contacts["state"].values[:, place] == AT_STOP
        assert np.array_equal(at_stop, side * history["displacement_m"] >= 1e-3 * (1 - 1e-9))
        assert np.array_equal(other.contacts["state"].values[:, place] == AT_STOP, pushed)
    reached = [event.joint for event in ours.events if event.kind == "stop_reached"]
    assert reached[:2] == ["stop_plus", "stop_minus"]


def test_contacts_of_the_rib(compared) -> None:
    result = read(compared("umbrella_damped") / "comparison.h5")
    case = result.case
    for model, history in result.models.items():
        found, contacts = history, history.contacts
        normal, friction = (contacts[f"{kind}_force_N"].values[:, 0] for kind in ("normal", "tangential"))
        touching = history["normal_force_N"] > 0
        assert touching.any() and not touching.all()
        assert np.allclose(np.linalg.norm(normal, axis=1), history["normal_force_N"], rtol=1e-12)
        offset = np.stack([history["eccentricity_x_m"], history["eccentricity_y_m"]], axis=1)
        # The bearing pushes the journal back to its centre.
        assert np.all(np.sum(normal[touching, :2] * offset[touching], axis=1) < 0)
        assert np.max(np.abs(np.sum(normal * friction, axis=1))) < 1e-9 * np.max(history["normal_force_N"]) ** 2
        assert np.all((contacts["state"].values[:, 0] == SEPARATED) == (history["penetration_depth_m"] < 0))
        centre = np.stack([history["bearing_x_m"], history["bearing_y_m"]], axis=1)
        reach = np.linalg.norm(contacts["point_m"].values[:, 0, :2] - centre, axis=1)
        moved = np.linalg.norm(offset, axis=1) > 0  # concentric at the start: no direction
        assert np.allclose(reach[moved], case.bearing_radius_m, rtol=1e-12)
        # Axial forces against the models' own energy: F^2 l_T / (2 E A), both from the same lengths.
        energy = np.zeros(len(history))
        for place, link in enumerate((case.link_ab, case.link_bc)):
            free = link.stress_free_length_m * (1 + found.links["thermal_strain"].values[:, place])
            force = found.links["axial_force_N"].values[:, place]
            energy += force**2 * free / (2 * link.young_modulus_Pa * link.cross_section_area_m2)
        # Rounding of a length, 1e-17 m, in an extension of 1e-9 m and more where the energy is largest.
        largest = np.max(history["axial_energy_J"])
        assert np.max(np.abs(energy - history["axial_energy_J"])) < 1e-6 * largest, model
        first = [event for event in found.events if event.kind == "first_contact"]
        assert len(first) == 1 and first[0] is found.events[0] and first[0].time_uncertainty_s == 0
        assert first[0].temperature_change_K == found.summary["first_contact_temperature_change_K"]


def test_events_between_samples() -> None:
    states = np.array([[SEPARATED, STICK], [STICK, STICK], [SLIP, SLIP], [SEPARATED, STICK], [AT_STOP, SLIP],
                       [SEPARATED, SLIP]], dtype=np.uint8)
    time = np.arange(6.0)
    events = from_states(time, 10 * time, states, ["a", "b"])
    assert [(event.kind, event.joint, event.time_s) for event in events] == [
        ("contact", "a", 0.5), ("first_slip", "a", 1.5), ("first_slip", "b", 1.5), ("separation", "a", 2.5),
        ("stick", "b", 2.5), ("stop_reached", "a", 3.5), ("slip", "b", 3.5), ("stop_left", "a", 4.5)]
    assert events[0].temperature_change_K == 5.0 and events[0].time_uncertainty_s == 0.5


@KINDS
def test_interrupted_run_keeps_both_models_and_says_so(compared, tmp_path: Path, name: str) -> None:
    whole = read(compared(name) / "comparison.h5")
    case, samples = whole.case.definition, read_columns(compared(name) / "dem_history.csv")
    cut = case.behaviour.dem_run(case, {key: values[:500] for key, values in samples.items()}, {})
    path = save("compare", case, {"reduced": whole.models["reduced"], "dem": replace(cut, complete=False)}, tmp_path)
    assert path.name == "comparison.interrupted.h5"
    check_layout(path)
    kept = read(path)
    assert not kept.complete and kept.passed is None and len(kept.models["dem"].time_s) == 500
    assert len(kept.models["reduced"].time_s) == len(whole.models["reduced"].time_s)
    shown = run(tmp_path, "info", path)
    assert shown.returncode == 0 and "not complete" in shown.stdout
    # Against the whole run: equal as far as it goes, not judged.
    done = run(tmp_path, "compare", compared(name) / "comparison.h5", path)
    assert done.returncode == 0 and "not judged" in done.stdout, done.stderr
    assert all(column.largest == 0 for runs in difference(whole, kept) for column in runs.columns)


def damage(path: Path, change: Callable[[h5py.File], None]) -> None:
    with h5py.File(path, "r+") as file:
        change(file)
    sealed(path)


def instead(file: h5py.File, place: str, **dataset: Any) -> None:
    """Put another data set into a place; the attributes stay."""
    kept = dict(file[place].attrs)
    del file[place]
    file.create_dataset(place, **dataset).attrs.update(kept)


def not_hdf5(path: Path) -> None:
    path.write_text("time_s,displacement_m\n0,0\n")


def foreign(path: Path) -> None:
    path.unlink()
    with h5py.File(path, "w") as file:
        file["samples"] = [1, 2]
    sealed(path)


def without_checksum(path: Path) -> None:
    path.write_bytes(path.read_bytes()[512:])


def newer_head(path: Path) -> None:
    path.write_bytes(path.read_bytes().replace(b"statejump HDF5 1", b"statejump HDF5 2", 1))


def altered(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file["models/dem/summary/state_jump_m"][()] *= 2


def shorter(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:20000])


MISTAKES = {
    "no file": (Path.unlink, failure("result_file_not_found")),
    "not HDF5": (not_hdf5, failure("no_result_format", begin="statejump HDF5")),
    "another program's": (foreign, failure("result_other_format")),
    "newer": (lambda path: damage(path, lambda file: file.attrs.__setitem__("layout_version", layout.VERSION + 1)),
              failure("layout_newer", found=2, newest=1)),
    "newer as a whole": (newer_head, failure("result_newer")),
    "without checksum": (without_checksum, failure("result_without_checksum")),
    "cut off": (shorter, failure("result_checksum")),
    "altered": (altered, failure("result_checksum")),
    "missing group": (lambda path: damage(path, lambda file: file.__delitem__("models/dem/events")),
                      failure("object_missing", object="/models/dem/events")),
    "missing column": (lambda path: damage(path, lambda file: file.__delitem__("models/dem/history/time_s")),
                       failure("object_missing", object="/models/dem/history/time_s")),
    "missing attribute": (lambda path: damage(path, lambda file: file["case"].attrs.__delitem__("kind")),
                          failure("object_missing", object="/case")),
    "group for a data set": (
        lambda path: damage(path, lambda file: (file.__delitem__("scene"), file.create_group("scene"))),
        failure("damaged")),
    "column too short": (
        lambda path: damage(path, lambda file: (file.__delitem__("models/dem/energy/elastic_energy_J"),
                                                file.create_dataset("models/dem/energy/elastic_energy_J", data=[1.0]))),
        failure("damaged", object="/models/dem/energy/elastic_energy_J")),
    "numbers that are not in the file": (
        lambda path: damage(path, lambda file: instead(
            file, "models/dem/energy/elastic_energy_J", shape=(10**12,), dtype="f8", chunks=(1000,))),
        failure("result_claims_too_much", object="/models/dem/energy/elastic_energy_J")),
    "numbers of another file": (
        lambda path: damage(path, lambda file: instead(
            file, "models/dem/energy/elastic_energy_J", shape=(64,), dtype="u1", external=[("/dev/zero", 0, 64)])),
        failure("result_external", object="/models/dem/energy/elastic_energy_J")),
    "link": (
        lambda path: damage(path, lambda file: (
            file.__delitem__("provenance"), file.__setitem__("provenance", h5py.ExternalLink("other.h5", "/x")))),
        failure("result_link", object="/provenance")),
    "circle": (
        lambda path: damage(path, lambda file: (file.__delitem__("models/dem/links"),
                                                file["models/dem"].__setitem__("links", file["models"]))),
        failure("result_no_object", object="/models/dem/links")),
    "texts for numbers": (
        lambda path: damage(path, lambda file: instead(file, "models/dem/summary/state_jump_m", data=b"x")),
        failure("damaged", object="/models/dem/summary/state_jump_m")),
    "list for a text": (
        lambda path: damage(path, lambda file: file["case"].attrs.__setitem__("title", ["a", "b"])),
        failure("damaged")),
    "items without names": (
        lambda path: damage(path, lambda file: file["models/dem/contacts/gap_m"].attrs.__setitem__("items", "x")),
        failure("damaged")),
    "no label": (
        lambda path: damage(path, lambda file: file["models/dem/contacts/state"].__setitem__((0, 0), 9)),
        failure("damaged")),
    "scene of something else": (
        lambda path: damage(path, lambda file: instead(
            file, "scene", data=file["scene"].asstr()[()].replace("links/axial_force_N", "links/force"))),
        failure("scene_damaged")),
    "case that is no object": (
        lambda path: damage(path, lambda file: instead(file, "case/resolved", data="[]")),
        failure("damaged")),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_bad_file_is_one_sentence(compared, tmp_path: Path, name: str) -> None:
    path = tmp_path / "bad.h5"
    path.write_bytes((compared("table1") / "comparison.h5").read_bytes())
    spoil, sentence = MISTAKES[name]
    spoil(path)
    with pytest.raises(StatejumpError) as raised:
        read(path)
    assert raised.value == sentence.at(file=path)
    assert raised.value.exit_status == 2


@pytest.mark.parametrize("command", ["info", "export", "compare"])
def test_commands_refuse_bad_files(compared, tmp_path: Path, command: str) -> None:
    (tmp_path / "bad.h5").write_text("no")
    more = [compared("table1") / "comparison.h5"] if command == "compare" else []
    done = run(tmp_path, "--json", command, "bad.h5", *more)
    assert done.returncode == 2
    assert failure("no_result_format", file="bad.h5") == done.stderr
    assert [entry.name for entry in tmp_path.iterdir()] == ["bad.h5"]


def test_file_cut_anywhere_is_refused(compared, tmp_path: Path) -> None:
    whole = (compared("table1") / "comparison.h5").read_bytes()
    path = tmp_path / "cut.h5"
    for length in np.linspace(0, len(whole) - 1, 60).astype(int):
        path.write_bytes(whole[:length])
        with pytest.raises(StatejumpError) as raised:
            read(path)
        assert "\n" not in str(raised.value)


def test_random_bytes_never_reach_the_library(compared, tmp_path: Path) -> None:
    """A file with any changed bytes is refused before HDF5 uses the bytes as lengths and addresses."""
    whole = (compared("table1") / "comparison.h5").read_bytes()
    rng, path = np.random.default_rng(1), tmp_path / "random.h5"
    for count in (1, 1, 1, 3, 10, 100) * 20:
        content = bytearray(whole)
        for place in rng.integers(0, len(whole), count):
            content[place] ^= int(rng.integers(1, 256))
        path.write_bytes(content)
        with failing("result_checksum"):
            read(path)
    for command in (["info"], ["export", "--to", "out"], ["report"]):
        done = run(tmp_path, *command, path)
        assert done.returncode == 2 and done.stderr.count("\n") == 1, done.stderr
    assert [entry.name for entry in tmp_path.iterdir()] == ["random.h5"]


def test_other_programs_read_the_file(compared) -> None:
    """h5py opens the file: its checksum is in the user block, which HDF5 reserves for applications."""
    with h5py.File(compared("table1") / "comparison.h5") as file:
        assert file.userblock_size == 512 and file.attrs["format"] == layout.FORMAT


def test_info_shows_what_is_in_it(compared, tmp_path: Path) -> None:
    done = run(tmp_path, "info", compared("table1") / "comparison.h5")
    assert done.returncode == 0, done.stderr
    for text in ("table1, kind spring_slider", "yade version", "state_jump_m", "stop_reached", "history/displacement_m",
                 "2,001 samples × 3 contacts × 3", "separated, stick, slip, at_stop", "block (block)"):
        assert text in done.stdout, text


# ---------------------------------------------------------------- compare FILE FILE


def edited_case(result: Result, section: str, key: str, value: Any) -> Result:
    values = json.loads(result.case_json)
    values[section][key] = value
    return replace(result, case_json=json.dumps(values))


def test_compare_of_two_files(compared, tmp_path: Path) -> None:
    folder = compared("table1")
    case = folder.parents[1] / "table1.toml"
    for command in ("reduced", "dem"):
        assert run(tmp_path, command, case).returncode == 0
        check_layout(tmp_path / "results" / "table1" / f"{command}.h5")
    done = run(tmp_path, "compare", *(f"results/table1/{name}.h5" for name in ("reduced", "dem")))
    # One cycle in 0.1 s: the file's verdict is that of compare CASE.
    expected = {row.name: row.passed for row in read(folder / "comparison.h5").rows or []}
    rows = difference(*(read(tmp_path / f"results/table1/{name}.h5") for name in ("reduced", "dem")))[0].rows or []
    assert {row.name: row.passed for row in rows}.items() <= expected.items() and len(rows) == 5
    assert done.returncode == (0 if all(row.passed for row in rows) else 1), done.stderr
    # The heads of the table of tolerances as well: the files are what is compared.
    assert done.stdout.count("first, reduced") == 2 and done.stdout.count("second, DEM") == 2
    assert "links/axial_force_N" in done.stdout


@KINDS
def test_a_file_does_not_differ_from_itself(compared, name: str) -> None:
    result = read(compared(name) / "comparison.h5")
    found = difference(result, result)
    assert [runs.names for runs in found] == [("reduced", "reduced"), ("dem", "dem")]
    for runs in found:
        assert all(column.largest == 0 for column in runs.columns) and len(runs.columns) > 8
        assert all(event.counts[0] == event.counts[1] for event in runs.events)
        assert all(row.passed for row in runs.rows or []) and runs.rows


def test_largest_difference_and_its_place(compared) -> None:
    result = read(compared("table1") / "comparison.h5")
    dem = result.models["dem"]
    values = dem.history["displacement_m"].values.copy()
    values[700] += 2e-4
    other = replace(result, models={"dem": replace(dem, history={
        **dem.history, "displacement_m": Column(values, "m")})})
    runs = difference(result, other)[0]
    worst = next(column for column in runs.columns if column.name == "history/displacement_m")
    assert worst.largest == pytest.approx(2e-4, rel=1e-9) and worst.time_s == dem.time_s[700] and worst.unit == "m"


def test_other_sampling_is_interpolated(compared) -> None:
    result = read(compared("table1") / "comparison.h5")
    dem = result.models["dem"]
    fewer = {group: {name: replace(column, values=column.values[::2]) for name, column in getattr(dem, group).items()}
             for group in GROUPS}
    runs = difference(replace(result, models={"dem": replace(dem, **fewer)}), result)[0]
    assert all(column.largest == 0 for column in runs.columns)
    back = difference(result, replace(result, models={"dem": replace(dem, **fewer)}))[0]
    change = next(column for column in back.columns if column.name == "history/temperature_change_K")
    # Half a sine of 100 K: second derivative times the step of 1e-4 s squared over 8.
    assert 0 < change.largest < 100 * (math.pi / 0.1) ** 2 * 1e-8 / 8 * 1.01


def test_tolerance_decides_the_exit_status(compared, tmp_path: Path) -> None:
    result = read(compared("table1") / "comparison.h5")
    first = edited_case(result, "tolerance", "event_temperature_K", 1e-6)
    write(replace(first, models={"reduced": result.models["reduced"]}), tmp_path / "a.h5")
    write(replace(result, models={"dem": result.models["dem"]}), tmp_path / "b.h5")
    done = run(tmp_path, "--json", "compare", "a.h5", "b.h5")
    assert done.returncode == 1
    assert failure("tolerance_missed", file="a.h5, b.h5") == done.stderr
    assert "first_slip_temperature_change" in json.loads(done.stderr)["cause"].split(", ")
    assert "tolerance.event_temperature_K = 1e-06 and 0.5" in done.stdout


def test_other_cases_are_not_comparable(compared, tmp_path: Path) -> None:
    result = read(compared("table1") / "comparison.h5")
    write(edited_case(result, "joint", "clearance_plus_m", 2e-3), tmp_path / "wide.h5")
    done = run(tmp_path, "--json", "compare", compared("table1") / "comparison.h5", "wide.h5")
    assert done.returncode == 2
    assert failure("cases_differ", key_that_differs="joint.clearance_plus_m = 0.001 and 0.002", more="") == done.stderr
    done = run(tmp_path, "--json", "compare", compared("table1") / "comparison.h5",
               compared("umbrella_damped") / "comparison.h5")
    assert done.returncode == 2
    assert failure("kinds_differ", first="spring_slider", second="umbrella") == done.stderr
    half = {name: replace(column, values=column.values / 2 if name == "time_s" else column.values)
            for name, column in result.models["dem"].history.items()}
    end = float(result.models["dem"].time_s[-1])
    with failing("durations_differ", first_s=end, second_s=end / 2):
        difference(result, replace(result, models={"dem": replace(result.models["dem"], history=half)}))
    for arguments in (["a.h5"], ["a.h5", "b.h5", "c.h5"]):
        done = run(tmp_path, "--json", "compare", *arguments)
        assert done.returncode == 2 and failure("wrong_number_of_files", files=len(arguments)) == done.stderr
    assert case_differences(result, result) == ([], [])


# ---------------------------------------------------------------- scene, VTK, ParaView


def truss_like() -> Result:
    """A synthetic result with many items that no kind of case produces: nodes, links, a mesh, an external force."""
    time = np.linspace(0, 2, 5)
    nodes = np.zeros((5, 3, 3))
    nodes[:, :, 0] = [0, 1, 2]
    nodes[:, 2, 1] = 0.1 * time
    links = [{"name": f"link_{i}", "type": "link", "width_m": 0.01, "thermal_expansion_per_K": 2e-5,
              "ends": [scene.ref("history/node_m", node) for node in pair],
              "values": {"axial_force_N": scene.ref("links/axial_force_N", f"link_{i}")}}
             for i, pair in enumerate((("A", "B"), ("B", "C")))]
    parts = [*links, {
        "name": "pad", "type": "mesh", "mesh": "tetrahedron", "centre": scene.ref("history/node_m", "C"),
        "angle_rad": math.pi / 2, "thermal_expansion_per_K": 1e-3}]
    load = {"name": "load at C", "kind": "external", "on": "pad", "at": scene.ref("history/node_m", "C"),
            "vector_N": [0.0, scene.ref("history/time_s", scale=-10.0, offset=1.0), 0.0]}
    names = {"nodes": ["A", "B", "C"], "links": ["link_0", "link_1"]}
    model = Run(
        "dem",
        history={"time_s": Column(time, "s"), "temperature_change_K": Column(50 * time, "K"),
                 "node_m": Column(nodes, "m", "nodes"), "label": Column(np.zeros(5, np.uint8), labels=("S1", "S2"))},
        energy={"elastic_energy_J": Column(time**2, "J")},
        links={"axial_force_N": Column(np.stack([time, -time], axis=1), "N", "links")},
        contacts={}, events=Events([Event("buckling", 1.0, 50.0, "link_1")]), summary={"jump_m": math.nan}, names=names,
    )
    mesh = Mesh(np.array([[0.0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]),
                np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]))
    return Result(
        command="dem", complete=True, name="truss", kind="truss", title='A "quoted" truss', source="", case_text="",
        case_json="{}", provenance={}, names=names,
        scene=scene.description(parts, [], 1e-4, [load]), models={"dem": model}, meshes={"tetrahedron": mesh},
    )


@KINDS
def test_scene_refers_to_what_is_there(compared, name: str) -> None:
    result = read(compared(name) / "comparison.h5")
    assert problems(result) == []
    kinds = {part["type"] for part in result.scene["parts"]}
    assert kinds == ({"frame", "slot", "block", "link"} if name == "table1" else
                     {"frame", "link", "bearing", "journal"})
    broken = replace(result, scene=json.loads(json.dumps(result.scene).replace("links/axial_force_N", "links/force")))
    assert problems(broken) and "links/force" in problems(broken)[0]


def test_columns_of_many_items(tmp_path: Path) -> None:
    result = truss_like()
    assert problems(result) == []
    for key in ("statejump_version", "git_commit", "python_version", "numpy_version", "h5py_version", "hdf5_version"):
        result.provenance[key] = "1"
    write(result, tmp_path / "truss.h5")
    check_layout(tmp_path / "truss.h5")
    again = read(tmp_path / "truss.h5")
    assert np.array_equal(again.meshes["tetrahedron"].triangles, result.meshes["tetrahedron"].triangles)
    assert np.array_equal(again.models["dem"].history["node_m"].values, result.models["dem"].history["node_m"].values)
    assert again.models["dem"].history["label"].labels == ("S1", "S2")
    assert math.isnan(again.models["dem"].summary["jump_m"])
    (path,) = write_histories(again, tmp_path)
    with path.open() as stream:
        rows = list(csv.reader(stream))
    assert rows[0] == ["time_s", "temperature_change_K", "elastic_energy_J", "label", "node_m[A].x", "node_m[A].y",
                       "node_m[A].z", "node_m[B].x", "node_m[B].y", "node_m[B].z", "node_m[C].x", "node_m[C].y",
                       "node_m[C].z"]
    assert rows[-1][:4] == ["2.0", "100.0", "4.0", "S1"] and rows[-1][-3:] == ["2.0", "0.2", "0.0"]


def vtk_file(path: Path) -> Any:
    reader = vtkXMLUnstructuredGridReader() if path.suffix == ".vtu" else vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def series(path: Path) -> list[tuple[float, Any]]:
    document = json.loads(path.read_text())
    assert document["file-series-version"] == "1.0"
    return [(entry["time"], vtk_file(path.parent / entry["name"])) for entry in document["files"]]


def array(data: Any, name: str) -> np.ndarray:
    found = data.GetArray(name)
    assert found is not None, name
    return vtk_to_numpy(found)


def texts(data: Any, name: str) -> list[str]:
    found = data.GetAbstractArray(name)
    return [found.GetValue(place) for place in range(found.GetNumberOfValues())]


@KINDS
def test_vtk_series_hold_what_the_file_holds(compared, tmp_path: Path, name: str) -> None:
    result = read(compared(name) / "comparison.h5")
    written = write_vtk(result, tmp_path, 21)
    assert len(written) == 6
    for model, found in result.models.items():
        samples = frames_of(len(found.time_s), 21)
        assert len(samples) == 21 and samples[0] == 0 and samples[-1] == len(found.time_s) - 1
        for number, (time, data) in enumerate(series(tmp_path / f"{model}_links.vtu.series")):
            sample = samples[number]
            # nine digits: what is beyond is the rounding of a sum of steps
            assert time == pytest.approx(found.time_s[sample], rel=1e-8)
            assert array(data.GetFieldData(), "time_s") == time
            cells = data.GetCellData()
            assert texts(cells, "part") == result.names["links"]
            assert np.array_equal(array(cells, "axial_force_N"), found.links["axial_force_N"].values[sample])
            assert np.array_equal(array(cells, "thermal_strain"), found.links["thermal_strain"].values[sample])
            assert np.all(array(cells, "temperature_change_K") == found.history["temperature_change_K"].values[sample])
        for number, (_, data) in enumerate(series(tmp_path / f"{model}_contacts.vtp.series")):
            sample, points = samples[number], data.GetPointData()
            assert texts(points, "name") == result.names["contacts"]
            assert np.array_equal(array(points, "contact_state"), found.contacts["state"].values[sample])
            for key in ("normal_force_N", "tangential_force_N"):
                assert np.array_equal(array(points, key), found.contacts[key].values[sample])
            place = vtk_to_numpy(data.GetPoints().GetData())
            assert np.array_equal(place, found.contacts["point_m"].values[sample])
        _, last = series(tmp_path / f"{model}_parts.vtp.series")[-1]
        drawn = dict.fromkeys(texts(last.GetCellData(), "part"))
        assert list(drawn) == [part["name"] for part in result.scene["parts"] if part["type"] not in ("link", "spring")]


def test_bodies_are_drawn_where_they_are(compared, tmp_path: Path) -> None:
    result = read(compared("umbrella_damped") / "comparison.h5")
    result.scene["parts"][3]["thermal_expansion_per_K"] = 1e-3  # of the bearing, to see it
    write_vtk(result, tmp_path, 3)
    dem = result.models["dem"]
    middle = frames_of(len(dem), 3)[1]
    _, data = series(tmp_path / "dem_parts.vtp.series")[1]
    points = vtk_to_numpy(data.GetPoints().GetData())
    names = texts(data.GetCellData(), "part")
    centre = np.array([dem["bearing_x_m"][middle], dem["bearing_y_m"][middle], 0])
    grown = 0.0051 * (1 + 1e-3 * dem["temperature_change_K"][middle])
    ids = data.GetCell(names.index("bearing")).GetPointIds()
    circle = points[[ids.GetId(i) for i in range(ids.GetNumberOfIds())]]
    assert np.allclose(np.linalg.norm(circle - centre, axis=1), grown, rtol=1e-12)
    ids = data.GetCell(names.index("journal") + 1).GetPointIds()  # the spoke
    start, end = (points[ids.GetId(i)] for i in range(2))
    assert math.atan2(*(end - start)[1::-1]) == pytest.approx(dem["theta4_rad"][middle], abs=1e-12)


def test_bodies_in_space_are_drawn_across_their_axis(compared, tmp_path: Path) -> None:
    result = read(compared("umbrella_damped") / "comparison.h5")
    axis = np.array([0.0, -0.6, 0.8])
    for part in result.scene["parts"]:
        if part["type"] == "bearing":
            part["axis"], part["angle_rad"] = axis.tolist(), 0.0
    write_vtk(result, tmp_path, 3)
    _, data = series(tmp_path / "dem_parts.vtp.series")[0]
    points = vtk_to_numpy(data.GetPoints().GetData())
    ids = data.GetCell(texts(data.GetCellData(), "part").index("bearing")).GetPointIds()
    circle = points[[ids.GetId(i) for i in range(ids.GetNumberOfIds() - 1)]]
    about = circle - circle.mean(axis=0)
    # Rounding of the radius and of the place.
    assert np.abs(about @ axis).max() < 1e-15
    assert np.linalg.norm(about, axis=1) == pytest.approx(0.0051, rel=1e-12)


def test_meshes_and_further_forces(tmp_path: Path) -> None:
    result = truss_like()
    written = [path.name for path in write_vtk(result, tmp_path, 0)]
    assert written == ["dem_links.vtu.series", "dem_parts.vtp.series", "dem_forces.vtp.series"]
    time, data = series(tmp_path / "dem_parts.vtp.series")[-1]
    assert time == 2.0 and data.GetNumberOfPolys() == 4
    points = vtk_to_numpy(data.GetPoints().GetData())
    # The corner at (0.1, 0, 0), grown by 1e-3 x 100 K, turned a quarter, at C = (2, 0.2, 0).
    assert points[1] == pytest.approx([2.0, 0.2 + 0.11, 0.0], abs=1e-12)
    _, forces = series(tmp_path / "dem_forces.vtp.series")[-1]
    assert array(forces.GetPointData(), "force_N").tolist() == [[0.0, -19.0, 0.0]]


def test_script_for_paraview(compared, tmp_path: Path) -> None:
    for name in SHORT:
        result = read(compared(name) / "comparison.h5")
        folder = tmp_path / name
        folder.mkdir()
        written = [path.name for path in write_vtk(result, folder, 2)]
        text = write_script(result, folder).read_text()
        code = compile(text, NAME, "exec")
        assert "paraview.simple" in code.co_names or "paraview.simple" in str(code.co_names)
        assert all(f'"{file}"' in text for file in written) and "@" not in text
    # a title cannot break the script
    compile(write_script(truss_like(), tmp_path).read_text(), NAME, "exec")


def test_export_all(compared, tmp_path: Path) -> None:
    (tmp_path / "rib.h5").write_bytes((compared("umbrella_damped") / "comparison.h5").read_bytes())
    done = run(tmp_path, "export", "rib.h5", "--frames", 2, "--quiet")
    assert done.returncode == 0, done.stderr
    names = {path.name for path in (tmp_path / "rib").iterdir()}
    assert {NAME, "dem_history.csv", "reduced_links.vtu.series", "dem_contacts.1.vtp"} <= names
    assert not any(name.startswith(".") for name in names)
    done = run(tmp_path, "export", "rib.h5", "--frames", -1)
    assert done.returncode == 2 and done.stderr.count("\n") == 1
