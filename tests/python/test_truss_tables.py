# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes, links and joints of a truss in table files beside its case file, by columns."""
from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from failures import Failure, failing, failure
import statejump as sj
from statejump.core.errors import Range, StatejumpError
from statejump.kinds.loading import load_case, parse_case
from statejump.kinds.truss import arrays, generate, references
from statejump.kinds.truss.generate.document import write
from statejump.schema.item_tables import ItemTable

MADE: Mapping[str, Callable[[], dict[str, Any]]] = {
    "chain": lambda: generate.chain(3), "iwan": lambda: generate.iwan(3), "rib": lambda: generate.umbrella(1),
    "umbrella": lambda: generate.umbrella(4, cable_preload_N=1.0), "ring": lambda: generate.ring(4),
    "mast": lambda: generate.mast(2),
}


def same(one: Any, other: Any, where: str = "") -> None:
    """Check that the arrays of two trusses are equal in all bits."""
    if dataclasses.is_dataclass(one):
        for field in dataclasses.fields(one):
            same(getattr(one, field.name), getattr(other, field.name), f"{where}.{field.name}")
    elif isinstance(one, Mapping):
        assert one.keys() == other.keys(), where
        for key in one:
            same(one[key], other[key], f"{where}.{key}")
    elif isinstance(one, np.ndarray):
        assert (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes()), where
    else:
        assert one == other, where


def beside(document: dict[str, Any], folder: Path) -> Path:
    """Write a case whose lists all stand in CSV files."""
    lists = [section for section, part in document.items() if isinstance(part, list)]
    write(document, folder / "case.toml", [], lists)
    return folder / "case.toml"


def in_hdf5(items: list[dict[str, Any]], path: Path) -> None:
    """Write nodes, links or joints as data sets: texts, rows of texts padded with empty texts, numbers with NaN for
    missing values."""
    with h5py.File(path, "w") as file:
        for key in {key: None for item in items for key in item}:
            values = [item.get(key) for item in items]
            first = next(value for value in values if value is not None)
            if isinstance(first, list) and isinstance(first[0], str):
                width = max(len(value or ()) for value in values)
                file[key] = [[*(value or ()), *[""] * (width - len(value or ()))] for value in values]
            elif isinstance(first, list):
                file[key] = [[np.nan] * len(first) if value is None else value for value in values]
            elif isinstance(first, (str, bool)):
                file[key] = ["" if value is None else value for value in values]
            else:
                file[key] = [np.nan if value is None else value for value in values]


@pytest.mark.parametrize("made", MADE)
@pytest.mark.parametrize("form", ["csv", "h5"])
def test_the_same_truss(made: str, form: str, tmp_path: Path) -> None:
    document = MADE[made]()
    file = beside(document, tmp_path)
    if form == "h5":
        for table in tmp_path.glob("*.csv"):
            in_hdf5(document[table.stem.removeprefix("case_")], table.with_suffix(".h5"))
            table.unlink()
        file.write_text(file.read_text().replace(".csv", ".h5"))
    one, other = parse_case(document), load_case(file)
    same(one.resolve(), other.resolve())
    assert other.to_dict() == one.to_dict() and other.node == one.node
    changes = {"link.*.young_modulus_Pa": 1e9, "thermal.cycles": 2}
    assert other.changed(changes).to_dict() == one.changed(changes).to_dict()
    assert load_case(file).to_dict() == one.to_dict()  # reading changes nothing


# What a case of items one by one is refused for, it is refused for by columns.
SPOILED: Mapping[str, tuple[str, int, Mapping[str, Any]]] = {
    "ends that are one": ("link", 1, {"nodes": ["@0", "@0"]}),
    "an end that is not there": ("link", 2, {"nodes": ["@0", "nothing"]}),
    "an end that is misspelt": ("link", 2, {"nodes": ["@0", "Ä1"]}),
    "an end of no letters": ("link", 2, {"nodes": ["@0", "\x1b"]}),
    "one end": ("link", 2, {"nodes": ["@0"]}),
    "an end of a cable": ("spring", 1, {"nodes": ["nothing", "@0"]}),
    "a program of a link": ("link", 1, {"program": "nothing"}),
    "a program of a joint": ("revolute", 1, {"program": "nothing"}),
    "two expansions": ("link", 1, {"expansion": "nothing"}),
    "no expansion": ("link", 1, {"thermal_expansion_per_K": None}),
    "two masses": ("link", 1, {"mass_kg": 1.0, "density_kg_per_m3": 1.0}),
    "a centre without a mass": ("link", 1, {"centre_of_mass_m": [0.1, 0.0], "mass_kg": None}),
    "two lengths": ("spring", 1, {"preload_N": 1.0, "free_length_m": 1.0}),
    "a bearing that is not there": ("revolute", 1, {"bearing_node": "nothing"}),
    "a journal in its own place": ("revolute", 1, {"journal_node": "@bearing_node"}),
    "a link that is not there": ("revolute", 2, {"bearing_link": "nothing"}),
    "a link that ends elsewhere": ("revolute", 2, {"bearing_link": "@link 0"}),
    "one link": ("revolute", 2, {"journal_link": "@bearing_link"}),
    "no link": ("revolute", 2, {"journal_link": None, "journal_node": "@free"}),
    "an axis of no direction": ("revolute", 1, {"axis": [0.0, 0.0, 0.0]}),
    "a name twice": ("node", 3, {"name": "@1"}),
    "a name of control characters": ("node", 3, {"name": "a\x1bb"}),
    "a direction out of the plane": ("node", 2, {"fixed": ["z"]}),
    "a direction that is none": ("node", 2, {"fixed": ["w"]}),
    "a guide of no direction": ("node", 2, {"guide_normal": [0.0, 0.0, 0.0]}),
    "a choice that is none": ("revolute", 1, {"contact": "soft"}),
    "turned links that are one": ("torsion_spring", 1, {"links": ["@link 0", "@link 0"]}),
    "turned links that are not there": ("torsion_spring", 1, {"links": ["nothing"]}),
}


@pytest.mark.parametrize("what", SPOILED)
@pytest.mark.parametrize("form", ["csv", "h5"])
def test_the_same_refusal(form: str, what: str, tmp_path: Path) -> None:
    document = generate.chain(3) if "plane" in what else generate.umbrella(4, cable_preload_N=1.0)
    section, place, changes = SPOILED[what]
    item = document[section][place]
    names: dict[str, str] = {"@free": next(node["name"] for node in document["node"] if not node.get("fixed") or "plane" in what)}
    names |= {f"@{number}": node["name"] for number, node in enumerate(document["node"])}
    names |= {f"@link {number}": link["name"] for number, link in enumerate(document["link"])}
    names |= {f"@{key}": value for key, value in item.items() if isinstance(value, str)}
    for key, value in changes.items():
        item.pop(key, None)
        if value is not None:
            item[key] = ([names.get(word, word) for word in value] if isinstance(value, list)
                         else names.get(value, value))
    with pytest.raises(StatejumpError) as one:
        parse_case(document)
    file = beside(document, tmp_path)
    if form == "h5":
        for table in tmp_path.glob("*.csv"):
            in_hdf5(document[table.stem.removeprefix("case_")], table.with_suffix(".h5"))
        file.write_text(file.read_text().replace(".csv", ".h5"))
    with pytest.raises(StatejumpError) as other:
        load_case(file)
    assert str(other.value) == f"{file}: {one.value}"


def test_texts_that_call_themselves_ascii(tmp_path: Path, statejump: Callable[..., Any]) -> None:
    document = generate.chain(3)
    file = beside(document, tmp_path)
    file.write_text(file.read_text().replace("case_node.csv", "case_node.h5"))
    names = [node["name"] for node in document["node"]]
    in_hdf5(document["node"], tmp_path / "case_node.h5")
    for coded, refused in ("Träger".encode(), False), (b"\xff", True):
        texts = [name.encode() for name in names]
        texts[-1] = texts[-1] + coded
        with h5py.File(tmp_path / "case_node.h5", "a") as table:
            del table["name"]
            table.create_dataset("name", data=texts, dtype=h5py.string_dtype("ascii", max(map(len, texts))))
        outcome = statejump("reduced", file)
        assert outcome.errors.count("\n") == 1
        assert (outcome.failure == failure("data_set_not_utf8", file="case_node.h5", data_set="'name'")) == refused


def test_a_table_of_arrays_is_a_list_of_items() -> None:
    document = generate.chain(3)
    place = [node["position_m"] for node in document["node"]]
    fixed = [[*node.get("fixed", ()), "", ""][:2] for node in document["node"]]
    names = [node["name"] for node in document["node"]]
    table = ItemTable(name=names, position_m=np.array(place), fixed=np.array(fixed))
    same(parse_case({**document, "node": table}).resolve(), parse_case(document).resolve())


def test_commands(tmp_path: Path, statejump: Callable[..., Any]) -> None:
    assert statejump("truss", "ring", 4, "-o", "ring.toml", "--tables").status == 0
    text = (tmp_path / "ring.toml").read_text()
    assert 'node = "ring_node.csv"' in text and "[[" not in text and "truss ring 4 --tables -o ring.toml" in text
    assert statejump("truss", "ring", 4, "-o", "whole.toml").status == 0
    same_jump = [sj.load(tmp_path / f"{name}.toml").reduced().history["position_m"].values
                 for name in ("ring", "whole")]
    assert same_jump[0].tobytes() == same_jump[1].tobytes()
    assert statejump("reduced", "ring.toml").status == 0  # and the result file keeps the items themselves
    kept = sj.read(tmp_path / "results" / "ring" / "reduced.h5")
    assert kept.case.definition.to_dict() == load_case(tmp_path / "ring.toml").to_dict()
    refused = statejump("truss", "ring", 5, "-o", "ring.toml", "--tables")
    assert (refused.status, refused.failure) == (2, failure("exists_already", file="ring.toml"))
    (tmp_path / "ring.toml").unlink()
    refused = statejump("truss", "ring", 5, "-o", "ring.toml", "--tables")
    assert (refused.status, refused.failure) == (2, failure("exists_already", file="ring_node.csv"))


WRONG = {
    failure("row_of_other_length", file="node.csv", line=2, cells=2, width=3): ("name,position_m,fixed\nN0,0 0\n", "node"),
    failure("misspelt_key", file="node.csv", section="column 'positon_m'", meant="position_m"): ("name,positon_m\nN0,0 0\n", "node"),
    failure("columns_of_one_key", file="node.csv", other="name", column="name", key_of_both="name"): ("name,name\nN0,N0\n", "node"),
    failure("no_column", file="node.csv"): ("", "node"),
    failure("no_row", file="node.csv"): ("name,position_m\n", "node"),
    failure("bad_cell", file="node.csv", line=3, column="'position_m'", reason="no_finite_number", cell="x"): (
        "name,position_m\nN0,0 0\nN1,1 x\n", "node"),
    failure("cell_of_other_length", file="node.csv", line=3, column="'position_m'", width=2, numbers=1): (
        "name,position_m\nN0,0 0\nN1,1\n", "node"),
    failure("out_of_range", file="case.toml", item="node 'N1'", key="position_m", value=[1.0, 10000000.0], allowed=Range(-1000000.0, 1000000.0, "m")): (
        "name,position_m\nN0,0 0\nN1,1 1e7\n", "node"),
    failure("missing_key", file="case.toml", item="node 'N1'", key="position_m", allowed=Range(-1000000.0, 1000000.0, "m")): (
        "name,position_m\nN0,0 0\nN1,\n", "node"),
    failure("unknown_name", file="case.toml", item="node 'N0'", key="fixed", value=["w"], allowed=("x", "y", "z")): (
        "name,position_m,fixed\nN0,0 0,w\n", "node"),
    failure("duplicate_name", file="case.toml", item="node 2", key="name", value="N0", part="node"): (
        "name,position_m\nN0,0 0\nN0,1 0\n", "node"),
    failure("missing_key", file="case.toml", item="node 2", key="name"): ("name,position_m\nN0,0 0\n,1 0\n", "node"),
    failure("missing_key", file="case.toml", item="tables.node", key="position_m", allowed=Range(-1000000.0, 1000000.0, "m")): ("name\nN0\n", "node"),
    failure("cell_not_boolean", file="spring.csv", line=2, column="'cable'", cell="'yes'"): (
        "name,nodes,stiffness_N_per_m,cable\nS,N0 N1,1,yes\n", "spring"),
}


@pytest.mark.parametrize("expected", WRONG)
def test_wrong_tables(expected: Failure, tmp_path: Path) -> None:
    text, section = WRONG[expected]
    document = generate.chain(2)
    document.pop(section, None)
    write(document, tmp_path / "case.toml", [])
    with (tmp_path / "case.toml").open("a") as stream:
        stream.write(f'\n[tables]\n{section} = "{section}.csv"\n')
    (tmp_path / f"{section}.csv").write_text(text)
    with pytest.raises(StatejumpError) as refused:
        load_case(tmp_path / "case.toml")
    assert refused.value == expected


@pytest.mark.parametrize("given, expected", [
    ({"node": "no.csv"}, failure("table_file_not_found", file="no.csv")),
    ({"node": "a.xlsx"}, failure("suffix_unknown", file="case.toml", key="tables.node", value="a.xlsx", suffixes=".csv, .txt, .tsv, .dat, .lvm, .h5, .hdf5")),
    ({"nodes": "a.csv"}, failure("misspelt_key", file="case.toml", key="tables.nodes", meant="tables.node")),
    ({"link": "a.csv"}, failure("table_and_section", file="case.toml", key="tables.link", value="a.csv", table="link")),
    ({"node": 1}, failure("not_string", file="case.toml", key="tables.node", value=1)),
])
def test_wrong_names_of_tables(given: dict[str, Any], expected: Failure, tmp_path: Path) -> None:
    document = generate.chain(2)
    document.pop("node")
    write({**document, "tables": given}, tmp_path / "case.toml", [])
    with pytest.raises(StatejumpError) as refused:
        load_case(tmp_path / "case.toml")
    assert refused.value == expected


def test_a_dict_has_no_files_beside_it() -> None:
    with failing("tables_of_case_file"):
        parse_case({**generate.chain(2), "tables": {"slider": "a.csv"}})


def test_rows_behind_blank_lines_and_columns_of_nothing(tmp_path: Path) -> None:
    document = generate.chain(5000)
    file = beside(document, tmp_path)
    table = tmp_path / "case_node.csv"
    header, *rows = table.read_text().splitlines()
    rows = [f"{row}," for row in rows]
    table.write_text("\n".join([f"{header},guide_normal", *rows[:4000], *[""] * 5000, *rows[4000:]]))
    same(load_case(file).resolve(), parse_case(document).resolve())


def test_a_preload_that_no_length_gives_is_refused() -> None:
    document = generate.umbrella(3, cable_preload_N=1.0)
    document["spring"][1]["stiffness_N_per_m"] = 1e-310
    with failing("spring_without_length", item="spring 'cable2'", key="preload_N", value=1.0, stiffness=1e-310):
        parse_case(document)


def test_events_are_a_sequence() -> None:
    found = sj.truss.ring(4).reduced().native.events
    assert len(found) > 2 and [found[0], found[1]] == found[:2] == list(found)[:2]
    assert found[-1].time_s >= found[0].time_s and found[0].joint_kind == "revolute"
    assert {event.before for event in found} <= {"stick", "slip_plus", "slip_minus"}


@pytest.mark.parametrize("what, changes", [
    (failure("axis_along_link"), lambda document: {"axis": [
        second - first for first, second in zip(*(node["position_m"] for node in document["node"]
                                                  if node["name"] in document["link"][-1]["nodes"]))]}),
    (failure("links_not_adjacent", key="links"), lambda document: {"links": [document["link"][0]["name"], document["link"][-1]["name"]]}),
    (None, lambda document: {}),
])
def test_blocks_of_rows_are_checked_as_all_of_them(
    what: Failure | None, changes: Callable[[dict[str, Any]], dict[str, Any]], monkeypatch: pytest.MonkeyPatch,
) -> None:
    document = generate.umbrella(4, cable_preload_N=1.0)
    document["torsion_spring"][-1] |= changes(document)
    found = []
    for rows in (4096, 1, 3):
        monkeypatch.setattr(arrays, "BLOCK", rows)
        monkeypatch.setattr(references, "BLOCK", rows)
        try:
            found.append(parse_case(document).resolve())
        except StatejumpError as refused:
            assert refused == what and refused.item == f"torsion_spring {document['torsion_spring'][-1]['name']!r}"
            found.append(str(refused))
    same(found[0], found[1])
    same(found[0], found[2])


def test_items_in_other_units(tmp_path: Path) -> None:
    """Units are converted in lists as in single numbers; a case in other units is the same case."""
    document = generate.chain(2)
    path = beside(document, tmp_path)
    before = load_case(path)
    table = tmp_path / "case_node.csv"
    head, *rows = table.read_text().splitlines()
    place = head.split(",").index("position_m")
    cells = [row.split(",") for row in rows]
    for row in cells:
        row[place] = " ".join(f"{1000 * float(value):.10g}".replace(".", ",") for value in row[place].split())
    table.write_text("\n".join(";".join(row) for row in [head.replace("position_m", "position [mm]").split(","), *cells]))
    assert [node.position_m for node in load_case(path).node] == [node.position_m for node in before.node]


@pytest.mark.parametrize("file, name", [("my case.v2.toml", "my_case_v2"), ("Träger (1).toml", "Tr_ger_1"),
                                        ("ü.toml", "case")])
def test_any_file_name_gives_the_name_of_a_case(statejump: Callable[..., Any], tmp_path: Path, file: str, name: str
                                                ) -> None:
    done = statejump("truss", "chain", 2, "-o", file)
    assert done.status == 0, done.errors
    assert sj.load(tmp_path / file).definition.case.name == name
