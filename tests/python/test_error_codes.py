# SPDX-License-Identifier: GPL-3.0-or-later
"""Codes of errors: each code is declared once and used, and every error provides the fields that its message needs."""
from __future__ import annotations

import ast
import pickle
import string
from collections.abc import Iterator
from pathlib import Path

import pytest

from conftest import REPOSITORY
from failures import note
from statejump.core import errors
from statejump.core.error_codes import CODES, Code
from statejump.core.notes import NOTES, Note
from statejump.kinds.truss.importing.reasons import REASONS

PACKAGE = REPOSITORY / "python" / "statejump"
TREES = [(path, ast.parse(path.read_text(encoding="utf-8"))) for path in sorted(PACKAGE.rglob("*.py"))]
# Keywords of the classes of errors. All other arguments of an error are details.
OWN = {"what", "code", "file", "place", "case", "item", "key", "value", "allowed", "joint", "nodes", "time_s",
       "temperature_change_K", "cause", "remedy", "beside", "section", "needs", "run", "fault", "loose", "address"}


def names_in(declared: Code) -> set[str]:
    """Return the fields of a code: those in its message texts, and further fields."""
    return {*declared.further, *(
        name for text in (declared.what, declared.beside, declared.cause, declared.remedy)
        for _, name, _, _ in string.Formatter().parse(text) if name is not None)}


def called(node: ast.Call) -> str:
    """Return the name of the called function, without its module or object."""
    return str(getattr(node.func, "id", None) or getattr(node.func, "attr", ""))


def is_refusal_of_deck(node: ast.Call) -> bool:
    """Return whether a call is ``Deck.refuse``, whose argument is a reason."""
    return isinstance(node.func, ast.Attribute) and node.func.attr == "refuse"


def given() -> Iterator[tuple[str, str, set[str], bool]]:
    """Yield position, code and fields of every error in the package, and whether it may have further fields."""
    for path, tree in TREES:
        for node in ast.walk(tree):
            if isinstance(node, ast.Call):
                pairs = [(word.arg, word.value) for word in node.keywords]
            elif isinstance(node, ast.Dict):
                pairs = [(key.value if isinstance(key, ast.Constant) else None, value)
                         for key, value in zip(node.keys, node.values)]
            else:
                continue
            if isinstance(node, ast.Call) and called(node) in HELPERS and not is_refusal_of_deck(node):
                pairs += [("code", node.args[1])]
            for name, value in pairs:
                if name == "code":
                    found = [one.value for one in ast.walk(value) if isinstance(one, ast.Constant)]
                    for code in found if isinstance(value, (ast.Constant, ast.IfExp)) else []:
                        if code in CODES or isinstance(value, ast.Constant):
                            yield (f"{path.relative_to(PACKAGE)}:{node.lineno}", str(code),
                                   {str(name) for name, _ in pairs} - OWN - {"None"}, None in dict(pairs) or isinstance(node, ast.Dict))


CLASSES = {name for name, found in vars(errors).items()
           if isinstance(found, type) and issubclass(found, errors.StatejumpError)}
# Functions that make an error from the code in their second argument.
HELPERS = {"fail", "refuse", "_unusable"}
# Classes with a single code.
OF_ONE_CODE = {"MissingKey", "TolerancesMissed", "Interrupted"}
GIVEN = list(given())


def test_every_error_has_a_declared_code_and_its_details() -> None:
    assert len(GIVEN) > 400
    wrong = [
        f"{where}: {code} needs {names_in(CODES[code]) if code in CODES else 'a declaration'}, has {details}"
        for where, code, details, open_ended in GIVEN
        if code not in CODES or not (details <= names_in(CODES[code]) if open_ended else names_in(CODES[code]) == details)
    ]
    assert not wrong, "\n".join(wrong)


def test_every_error_is_raised_with_a_code() -> None:
    without = [
        f"{path.relative_to(PACKAGE)}:{node.lineno}" for path, tree in TREES for node in ast.walk(tree)
        if isinstance(node, ast.Call) and called(node) in CLASSES - OF_ONE_CODE
        and not {"code", None} & {word.arg for word in node.keywords}
    ]
    assert not without, without


def test_reasons_of_decks_are_declared_and_used() -> None:
    given_reasons = {
        one.value for path, tree in TREES if "importing" in path.parts for node in ast.walk(tree)
        if isinstance(node, ast.Call) and is_refusal_of_deck(node) and len(node.args) > 1
        for one in ast.walk(node.args[1]) if isinstance(one, ast.Constant) and isinstance(one.value, str)
        and one.value.isidentifier()
    }
    assert given_reasons - set(REASONS) == set() and set(REASONS) - given_reasons <= {"unknown_parameter"}


def test_only_errors_with_a_code_have_details() -> None:
    for path, tree in TREES:
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and getattr(node.func, "id", None) in CLASSES:
                words = {word.arg for word in node.keywords} - {None}
                open_ended = any(word.arg is None for word in node.keywords)
                assert "code" in words or open_ended or words <= OWN, f"{path.relative_to(PACKAGE)}:{node.lineno}: {words - OWN}"


def test_every_declared_code_is_used() -> None:
    texts = {node.value for path, tree in TREES if path.name != "error_codes.py"
             for node in ast.walk(tree) if isinstance(node, ast.Constant)}
    from_engine = {text for path in (REPOSITORY / "engine" / "src" / "failure.cpp",
                                     REPOSITORY / "geometry" / "include" / "statejump" / "geometry" / "mesh_failure.hpp")
                   for text in path.read_text(encoding="utf-8").split('"')} | {"not_in_build"}  # bindings/module.cpp
    from_studies = {text for path in (REPOSITORY / "studies").rglob("*.py")
                    for text in path.read_text(encoding="utf-8").split('"')}
    used = texts | from_engine | from_studies | {"out_of_range"}
    assert not [code for code in CODES if code not in used and code.removeprefix("bore_") not in used]


def test_every_note_is_used_with_the_details_of_its_sentence() -> None:
    texts = {node.value for path, tree in TREES if path.name != "notes.py" or path.parent.name != "core"
             for node in ast.walk(tree) if isinstance(node, ast.Constant)}
    assert [code for code in NOTES if code not in texts] == []
    for path, tree in TREES:
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and called(node) == "Note" and isinstance(node.args[0], ast.Constant):
                names = {name for _, name, _, _ in string.Formatter().parse(NOTES[node.args[0].value]) if name}
                words = {word.arg for word in node.keywords}
                assert names <= words or None in words, f"{path.relative_to(PACKAGE)}:{node.lineno}: {names - words}"


def test_a_note_is_a_sentence_with_code_and_details() -> None:
    for one in (Note("cycles_left_out", shown=10, cycles=20_000),
                pickle.loads(pickle.dumps(Note("cycles_left_out", shown=10, cycles=20_000)))):
        assert isinstance(one, str) and one == NOTES["cycles_left_out"].format(shown=10, cycles=20_000)
        assert one == note("cycles_left_out", cycles=20_000) and one.details == {"shown": 10, "cycles": 20_000}
        assert one != note("cycles_left_out", cycles=20_001) and one != note("clearances_kept")
    assert str(Note("clearances_kept", change_m=1.0)) != note("clearances_kept")  # a text without code
    with pytest.raises(KeyError):
        Note("no_such_code")


@pytest.mark.parametrize("code", CODES)
def test_sentences_follow_one_form(code: str) -> None:
    declared = CODES[code]
    parts = [part for part in (declared.what, declared.beside, declared.cause, declared.remedy) if part]
    assert bool(parts) != bool(declared.text), "a code has a sentence or, where each error gives its own, a text"
    assert all(part == part.strip() and not part.endswith(".") for part in parts)
    assert code == code.lower() and code.isidentifier()


def test_code_and_details_reach_programs(tmp_path: Path) -> None:
    error = errors.NotAllowed("joint.play_m", 0.1, code="no_radius_left", part="journal", at_K=-1000.0)
    for one in (error, pickle.loads(pickle.dumps(error))):
        assert (one.code, one.details) == ("no_radius_left", {"part": "journal", "at_K": -1000.0})
        cause = CODES["no_radius_left"].cause.format(part="journal", at_K=-1000.0)
        assert str(one) == f"joint.play_m = 0.1 is not allowed: {cause}"
        assert one.fields()["code"] == "no_radius_left" and one.fields()["details"] == {"part": "journal", "at_K": -1000.0}
    assert errors.NotAllowed("a", tmp_path).code == "not_allowed"
    assert errors.StatejumpError(code="several_values", path=tmp_path).fields()["details"] == {"path": str(tmp_path)}
    with pytest.raises(KeyError):
        errors.NotAllowed("a", 1, code="no_radius_left")
    with pytest.raises(KeyError):
        errors.NotAllowed("a", 1, code="no_such_code")
