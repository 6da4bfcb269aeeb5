# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the entries of the validation manual; writes their pages, or checks the kept verdicts.

    PYTHONPATH=build/python /usr/bin/python3 studies/validation/make_manual.py [--check] [NAME ...]

Without names, all entries run and the index is written. With --check nothing is written: the exit status is 1 if a
verdict differs from the one in docs/validation/manual/verdicts.json.
"""
from __future__ import annotations

import json
import sys
import textwrap
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402

import statejump as sj  # noqa: E402
from manual import MEASUREMENT, ORDER, PARTS, Entry, Row, rounded  # noqa: E402

HERE = Path(__file__).resolve().parent
PAGES = HERE.parents[1] / "docs" / "validation" / "manual"
VERDICTS = PAGES / "verdicts.json"
NOT_ENTRIES = {"manual", "make_manual", "bimaterial", "impact", "loops", "suspension", "walking"}
SLOW = {"bend_45", "cold_polymer_strip", "ssll06", "ssll08", "williams_toggle"}  # 2 to 12 s each: not tests
LARGEST_SKETCH = 40  # nodes


def names() -> list[str]:
    """Return the names of all entries."""
    return sorted(path.stem for path in HERE.glob("*.py") if path.stem not in NOT_ENTRIES)


def run(name: str) -> Entry:
    """Run an entry."""
    made = import_module(name).entry()
    assert isinstance(made, Entry) and made.name == name and made.part in PARTS, name
    return made


def verdict(entry: Entry) -> str:
    """Return the verdict that is kept and compared."""
    return "passes" if entry.passed else "FAILS"


def wrapped(text: str) -> str:
    """Return a paragraph in lines of at most 120 characters."""
    return textwrap.fill(text, 120, break_long_words=False, break_on_hyphens=False)


def number(value: float) -> str:
    """Return a number with the digits that every machine gives."""
    return f"{value:.6g}"


def table(entry: Entry) -> list[str]:
    """Return the table of differences."""
    lines = ["| quantity | unit | reference | ours | difference | model | discretisation | rest | |",
             "|---|---|---:|---:|---:|---:|---:|---:|---|"]
    for row in entry.rows:
        split = [rounded(part) for part in (row.total, row.model, row.discretisation, row.rest)]
        if row.low is not None:
            split[1:] = ["–", "–", "–"]
        passed = "passes" if row.passes(entry.tolerance) else "**FAILS**"
        lines.append(f"| {row.quantity} | {row.unit} | {reference(row)} | {number(row.ours)} | "
                     f"{' | '.join(split)} | {passed} |")
    return lines


def reference(row: Row) -> str:
    """Return the reference of a row, with the interval of a measurement."""
    if row.low is None or row.high is None:
        return number(row.reference)
    return f"{number(row.reference)} ({number(row.low)} to {number(row.high)})"


def page(entry: Entry, sketched: bool) -> str:
    """Return the page of an entry."""
    about = [f"# {entry.title}",
             f"After this page you know the problem, the reference and the difference of `{entry.name}`."]
    if entry.picture is not None:
        about.append(f"![Ours over theirs]({entry.name}.png)")
    command = f"```\nPYTHONPATH=build/python /usr/bin/python3 studies/validation/{entry.name}.py\n```"
    state = "passes" if entry.passed else "FAILS"
    lines = ["| | |", "|---|---|", f"| kind | {entry.kind} |", f"| source | {entry.source} |",
             f"| uncertainty of the reference | {entry.uncertainty} |",
             f"| tolerance | {number(entry.tolerance)}: {entry.reason} |"]
    parts = [*about, command, "\n".join(lines), "## Problem", wrapped(entry.statement)]
    if entry.sketch:
        parts.append(f"```text\n{entry.sketch.strip(chr(10))}\n```")
    if sketched:
        parts.append(f"![The case]({entry.name}_case.png)")
    if entry.case is not None:
        parts.append(f"[Case file]({entry.name}.toml), [script](../../../studies/validation/{entry.name}.py)")
    else:
        parts.append(f"[Script](../../../studies/validation/{entry.name}.py)")
    parts += ["## Differences", "\n".join(table(entry))]
    if entry.model:
        parts.append(wrapped(f"Model: {entry.model}"))
    parts += ["## Verdict", wrapped(f"**{state}.** {entry.verdict}")]
    return "\n\n".join(parts) + "\n"


def write(entry: Entry) -> None:
    """Write page, picture, sketch and case file of an entry."""
    PAGES.mkdir(parents=True, exist_ok=True)
    sketched = False
    if entry.case is not None:
        text = entry.case.to_toml()
        (PAGES / f"{entry.name}.toml").write_text(text, encoding="utf-8")
        sketched = entry.case.kind == "truss" and len(entry.case.to_dict()["node"]) <= LARGEST_SKETCH
        if sketched:
            save(sj.truss.draw(entry.case), f"{entry.name}_case.png")
    if entry.picture is not None:
        figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
        for curve in entry.picture.curves:
            style = {"color": "#0072B2", "linewidth": 1.6} if curve.ours else {
                "color": "#D55E00", "linestyle": "none", "marker": "o", "markersize": 4, "markerfacecolor": "none"}
            axes.plot(curve.x, curve.y, label=curve.label, **style)
        axes.set(xlabel=entry.picture.x, ylabel=entry.picture.y)
        axes.legend(frameon=False)
        save(figure, f"{entry.name}.png")
    (PAGES / f"{entry.name}.md").write_text(page(entry, sketched), encoding="utf-8")


def save(figure: plt.Figure, name: str) -> None:
    """Write a picture without the version of matplotlib in it."""
    figure.savefig(PAGES / name, dpi=72, metadata={"Software": None})
    plt.close(figure)


def index(entries: Sequence[Entry]) -> str:
    """Return the page that lists all entries."""
    failing = [entry for entry in entries if not entry.passed]
    kinds = [entry.kind for entry in entries]
    parts = [(HERE / "index_head.md").read_text(encoding="utf-8").strip()
             .replace("ENTRIES", str(len(entries))).replace("MEASURED", str(kinds.count(MEASUREMENT)))
             .replace("ORDERS", str(kinds.count(ORDER))).replace("FAILING", str(len(failing)))]
    head = ["| part | entries | fail | largest difference | entry |", "|---|---:|---:|---:|---|"]
    body = []
    for part in PARTS:
        own = [entry for entry in entries if entry.part == part]
        if not own:
            continue
        judged = [entry for entry in own if entry.kind not in (MEASUREMENT, ORDER)]
        worst = max(judged or own, key=lambda entry: entry.largest)
        head.append(f"| {part} | {len(own)} | {sum(not entry.passed for entry in own)} | {rounded(worst.largest)} | "
                    f"[{worst.name}]({worst.name}.md) |")
        body += [f"## {part}", "\n".join([
            "| entry | kind | difference | tolerance | verdict |", "|---|---|---:|---:|---|",
            *(f"| [{entry.title}]({entry.name}.md) | {entry.kind} | {rounded(entry.largest)} | "
              f"{'interval' if entry.by_interval else number(entry.worst.allowed(entry.tolerance))} | "
              f"{'passes' if entry.passed else '**FAILS**'} |" for entry in own)])]
    summary = ["## Largest difference of each part", "\n".join(head), wrapped(
        "Differences are relative and do not contain the named model difference. Each entry counts with the row that "
        "is nearest to its tolerance. Measurements count only in parts that have nothing else.")]
    tail = (HERE / "index_tail.md").read_text(encoding="utf-8").strip()
    return "\n\n".join([*parts, *summary, *body, tail]) + "\n"


def check(entries: Sequence[Entry]) -> int:
    """Compare verdicts with the kept ones; return the exit status."""
    kept = json.loads(VERDICTS.read_text(encoding="utf-8"))
    changed = [f"{entry.name}: {kept.get(entry.name, 'absent')} before, {verdict(entry)} now" for entry in entries
               if kept.get(entry.name) != verdict(entry)]
    print("\n".join(changed) or f"{len(entries)} verdicts are unchanged")
    return 1 if changed else 0


def main(arguments: Sequence[str]) -> int:
    """Run the entries that are named, or all."""
    chosen = [argument for argument in arguments if not argument.startswith("-")]
    entries = []
    for name in chosen or names():
        entries.append(run(name))
        print(f"{name}: {verdict(entries[-1])}", flush=True)
    if "--check" in arguments:
        return check(entries)
    for entry in entries:
        write(entry)
    if not chosen:
        kept = {entry.name: verdict(entry) for entry in entries}
        VERDICTS.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
        (PAGES / "index.md").write_text(index(entries), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
