# SPDX-License-Identifier: GPL-3.0-or-later
"""Entries of the validation manual: each gives the verdict that its page states."""
from __future__ import annotations

import json
import sys

import pytest

from conftest import REPOSITORY

sys.path.insert(0, str(REPOSITORY / "studies" / "validation"))

import make_manual  # noqa: E402
from manual import Entry, Row  # noqa: E402

KEPT: dict[str, str] = json.loads(make_manual.VERDICTS.read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", [name for name in make_manual.names() if name not in make_manual.SLOW])
def test_an_entry_gives_its_kept_verdict(name: str) -> None:
    entry = make_manual.run(name)
    assert make_manual.verdict(entry) == KEPT[name], [row.quantity for row in entry.rows if not row.passes(entry.tolerance)]
    page = (make_manual.PAGES / f"{name}.md").read_text(encoding="utf-8")
    assert f"# {entry.title}\n" in page and f"**{make_manual.verdict(entry)}.**" in page


def test_each_script_has_a_verdict_a_page_and_a_line_in_the_index() -> None:
    names = set(make_manual.names())
    pages = {path.stem for path in make_manual.PAGES.glob("*.md")} - {"index"}
    index = (make_manual.PAGES / "index.md").read_text(encoding="utf-8")
    assert names == set(KEPT) == pages
    assert sorted(name for name in names if f"]({name}.md)" not in index) == []
    assert index.count("| **FAILS** |") == sum(verdict == "FAILS" for verdict in KEPT.values())


def made(*rows: Row) -> Entry:
    return Entry(name="x", part=make_manual.PARTS[0], title="x", kind="closed form", source="x", uncertainty="x",
                 statement="x", rows=rows, tolerance=1e-3, reason="x", verdict="x")


def test_a_named_model_difference_does_not_count_against_the_tolerance() -> None:
    row = Row("u", "m", 1.0, 1.0201, theory=1.02, refined=1.02005)
    assert (row.total, row.model, row.discretisation, row.rest) == pytest.approx((0.0201, 0.02, 5e-5, 5e-5))
    assert made(row).passed
    assert not made(Row("u", "m", 1.0, 1.0201)).passed
    assert not made(Row("u", "m", 1.0, float("nan"))).passed


def test_an_interval_replaces_the_tolerance() -> None:
    assert made(Row("u", "m", 1.0, 1.3, low=0.5, high=2.0)).passed
    assert not made(Row("u", "m", 1.0, 0.4, low=0.5, high=2.0)).passed


def test_the_index_shows_the_row_that_is_nearest_to_its_tolerance() -> None:
    entry = made(Row("u", "m", 1.0, 1.02, tolerance=0.1), Row("v", "m", 1.0, 1.0009))
    assert entry.worst.quantity == "v" and entry.largest == pytest.approx(9e-4)


def test_a_changed_verdict_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    entry = make_manual.run("vm3")
    assert make_manual.check([entry]) == 0
    spoiled = made(Row("u", "m", 1.0, 2.0))
    assert make_manual.check([entry, spoiled]) == 1
    assert capsys.readouterr().out.endswith("x: absent before, FAILS now\n")
