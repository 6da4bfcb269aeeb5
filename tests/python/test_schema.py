# SPDX-License-Identifier: GPL-3.0-or-later
"""Published JSON Schemas: they are up to date, accept every case file, and reject each kind of mistake."""
from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from conftest import REPOSITORY
from statejump import _paths, kinds
from statejump.campaign.campaign_file import load_campaign
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import load_case, parse_case
from statejump.schema import json_schema as schema
from statejump.schema.fields import fields_of, rule_of, section_of, tables_of
from statejump.schema.rules import ATTACHED
from test_bad_input import MISTAKES as SPRING_SLIDER_MISTAKES

PUBLISHED = REPOSITORY / "schema"
FILES = sorted((REPOSITORY / "cases").rglob("*.toml"))
CAMPAIGNS = ("montecarlo", "sweep", "design")  # files that are no cases


def published(name: str) -> dict[str, Any]:
    return json.loads((PUBLISHED / schema.file_name(name)).read_text(encoding="utf-8"))


def name_of(data: dict[str, Any]) -> str:
    if "variable" in data:
        return "design"
    if "campaign" in data:
        return "montecarlo" if "samples" in data["campaign"] else "sweep"
    return data["case"]["kind"]


def validator(name: str) -> jsonschema.Draft7Validator:
    """A validator of a published schema file, which resolves references to the other schema files."""
    found = published(name)
    beside = {(PUBLISHED / schema.file_name(other)).as_uri(): published(other) for other in schema.names()}
    resolver = jsonschema.RefResolver((PUBLISHED / schema.file_name(name)).as_uri(), found, store=beside)
    return jsonschema.Draft7Validator(found, resolver=resolver)


def is_valid(data: dict[str, Any], name: str) -> bool:
    return validator(name).is_valid(data)


@pytest.mark.parametrize("name", schema.names())
def test_published_schema_is_the_generated_one(name: str) -> None:
    committed = (PUBLISHED / schema.file_name(name)).read_text(encoding="utf-8")
    assert committed == schema.to_json(schema.schema(name, alone=False)), "run: statejump schema --all schema"
    jsonschema.Draft7Validator.check_schema(json.loads(committed))


def test_nothing_else_is_published() -> None:
    assert {path.name for path in PUBLISHED.iterdir()} == {schema.file_name(name) for name in schema.names()}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_case_files_fit_their_schema(path: Path) -> None:
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    name = name_of(data)
    for each in (name,) if name in CAMPAIGNS else (name, "case"):
        assert [error.message for error in validator(each).iter_errors(data)] == []
        assert not is_valid(data | {"no_such_section": {}}, each)


def test_schema_of_all_cases_refers_to_those_of_the_kinds() -> None:
    references = [branch["then"] for branch in published("case")["allOf"]]
    assert references == [{"$ref": schema.file_name(kind)} for kind in kinds.names()]
    assert "definitions" not in published("case")


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_editors_find_the_schema_of_every_case_file(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    wanted = schema.file_name(name_of(tomllib.loads(text)))
    first = text.splitlines()[0]
    assert first.startswith("#:schema ")
    assert (path.parent / first.removeprefix("#:schema ")).resolve() == (PUBLISHED / wanted).resolve()


@pytest.mark.parametrize("kind", kinds.names())
def test_every_key_has_its_unit_and_range(kind: str) -> None:
    """Every bound in a definition of the package is in the published schema."""
    sections, bounds_seen = published(kind)["properties"], 0
    for name, attribute in fields_of(kinds.kind(kind).Case).items():
        model = section_of(attribute) or tables_of(attribute)
        if name not in sections:
            assert name in kinds.kind(kind).Case.NOT_IN_FILE
            continue
        found = sections[name].get("items", sections[name])["properties"]
        assert list(found) == [key for key, inner in fields_of(model).items() if rule_of(inner).form != ATTACHED]
        for key, inner in fields_of(model).items():
            if rule_of(inner).form == ATTACHED:
                continue
            rule = rule_of(inner)
            if rule.allowed is not None:
                bounds_seen += 1
                bounds = found[key].get("items", found[key])
                lowest = bounds["exclusiveMinimum" if rule.allowed.above else "minimum"]
                assert (lowest, bounds["maximum"], found[key]["x-unit"]) == (
                    rule.allowed.low, rule.allowed.high, rule.unit)
    assert bounds_seen > 8


# What only reading the file finds: several keys together, numbers as TOML sees them, syntax.
BEYOND_A_SCHEMA = {"NaN", "step above the stable one", "expansion closes the clearance", "not TOML"}


@pytest.mark.parametrize("mistake", sorted(SPRING_SLIDER_MISTAKES.keys() - BEYOND_A_SCHEMA))
def test_mistakes_of_a_spring_slider(mistake: str) -> None:
    (old, new), _ = SPRING_SLIDER_MISTAKES[mistake]
    text = (REPOSITORY / "cases" / "table1.toml").read_text(encoding="utf-8")
    data = tomllib.loads(text.replace(old, new, 1))
    assert not is_valid(data, "spring_slider") and not is_valid(data, "case")


# file, what is replaced in it: right for the schema before, wrong for schema and program after
MISTAKES = {
    "umbrella: law": ("umbrella.toml", 'normal_law = "hertz_internal"', 'normal_law = "hertz"'),
    "umbrella: section of another kind": ("umbrella.toml", "[frame]", "[link]\n[frame]"),
    "umbrella: radius": ("umbrella.toml", "journal_radius_m = 5e-3", "journal_radius_m = 0"),
    "umbrella: missing section": ("umbrella.toml", "[frame]\nlength_m = 0.12", ""),
    "statics: type": ("statics_lobed.toml", 'type = "lobed"', 'type = "lobe"'),
    "statics: key of another type": ("statics_slot.toml", 'type = "slot"', 'type = "slot"\nlobes = 3'),
    "statics: missing key of the type": ("statics_lobed.toml", "lobes = 3\n", ""),
    "statics: force of two numbers": ("statics_lobed.toml", "[-100, 0, 0]", "[-100, 0]"),
    "statics: key of a force": ("statics_lobed.toml", "force_N", "force_n"),
    "statics: thermal": ("statics_lobed.toml", "[picture]",
                         '[thermal]\nshape = "triangle"\ntemperature_change_max_K = 1\n[picture]'),
    "truss: dimension": ("trusses/ring_12.toml", "dimension = 2", "dimension = 4"),
    "truss: direction": ("trusses/ring_12.toml", 'fixed = ["y"]', 'fixed = ["w"]'),
    "truss: key of a node": ("trusses/ring_12.toml", "position_m", "positon_m"),
    "truss: name": ("trusses/ring_12.toml", 'name = "hub"', "name = 1"),
    "truss: empty name": ("trusses/ring_12.toml", 'name = "hub"', 'name = ""'),
    "truss: boolean": ("trusses/umbrella_8.toml", "cable = true", "cable = 1"),
    "truss: one table": ("trusses/chain_10.toml", "[truss]", "[program]\n[truss]"),
    "truss: modulus": ("trusses/ring_12.toml", "young_modulus_Pa = 70000000000.0", "young_modulus_Pa = -1.0"),
    "Monte Carlo: key": ("campaigns/table1_tolerances.toml", "joint.friction", "joint.frictoin"),
    "Monte Carlo: distribution": ("campaigns/table1_tolerances.toml", '"lognormal"', '"log"'),
    "Monte Carlo: key of a sweep": ("campaigns/table1_tolerances.toml", "relative = 0.2 ", "values = [0.2] "),
    "Monte Carlo: deviation": ("campaigns/table1_tolerances.toml", "relative = 0.2", "relative = 0"),
    "sweep: count": ("campaigns/table1_friction.toml", "count = 21", "count = 1"),
    "sweep: model": ("campaigns/table1_friction.toml", '"reduced"', '"fem"'),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistakes_of_the_other_files(mistake: str, tmp_path: Path) -> None:
    file, old, new = MISTAKES[mistake]
    text = (REPOSITORY / "cases" / file).read_text(encoding="utf-8")
    assert old in text
    name = name_of(tomllib.loads(text))
    wrong = text.replace(old, new, 1)
    assert not is_valid(tomllib.loads(wrong), name)
    if name not in CAMPAIGNS:
        assert not is_valid(tomllib.loads(wrong), "case")
    (tmp_path / "wrong.toml").write_text(
        wrong.replace('case = "../', f'case = "{REPOSITORY}/cases/'), encoding="utf-8"
    )
    with pytest.raises(StatejumpError):
        if name in CAMPAIGNS:
            load_campaign(tmp_path / "wrong.toml", name)
        else:
            load_case(tmp_path / "wrong.toml")


def test_a_title_may_hold_what_is_no_control_character() -> None:
    """A title may contain a no-break space, which is no control character, though not printable to Python."""
    document = tomllib.loads((REPOSITORY / "cases" / "table1.toml").read_text(encoding="utf-8"))
    document["case"]["title"] = "0.1\N{NO-BREAK SPACE}mm of play"
    assert parse_case(document).case.title == document["case"]["title"]


def test_unknown_kind_is_wrong() -> None:
    assert not is_valid({"case": {"name": "a", "kind": "trus"}}, "case")
    assert not is_valid({}, "case")


def test_command(statejump, tmp_path: Path) -> None:
    printed = statejump("schema", "truss")
    assert (printed.status, json.loads(printed.output)) == (0, published("truss"))
    assert statejump("schema", "-o", "a.json").status == 0
    alone = json.loads((tmp_path / "a.json").read_text())  # nothing beside it: it holds the kinds
    for name in kinds.names():
        without = {key: part for key, part in published(name).items() if key != "$schema"}
        assert alone["definitions"][name] == without
    data = tomllib.loads((REPOSITORY / "cases" / "table1.toml").read_text(encoding="utf-8"))
    jsonschema.validate(data, alone)
    data["joint"]["friction_coefficient"] = -1
    assert not jsonschema.Draft7Validator(alone).is_valid(data)
    wrong = statejump("schema", "trus")
    assert (wrong.status, wrong.failure.details.get("meant")) == (2, "truss"), wrong.errors


def test_generated_trusses_name_their_schema(statejump, tmp_path: Path) -> None:
    assert statejump("truss", "chain", 2, "-o", "a.toml").status == 0
    first = (tmp_path / "a.toml").read_text().splitlines()[0]
    assert first == "#:schema " + (_paths.SCHEMA / "truss.schema.json").resolve().as_uri()
