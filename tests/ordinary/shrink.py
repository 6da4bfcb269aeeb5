#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Removes items from a failing structure as long as its failure and the verdict of theory stay the same.

PYTHONPATH=build/python tests/ordinary/shrink.py FAMILY SEED [--to FILE.toml] [--minutes 3]
"""
from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

import structures
from oracle import judge
from sketch import JOINTS, Document
from worker import run

LIMIT_S = 20


def apart(call: Callable[[], Any], limit_s: int = LIMIT_S) -> Any:
    """Return the result of a function that is called in a separate process, or the name of the signal that ended it."""
    reads, writes = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reads)
        signal.alarm(limit_s)
        os.write(writes, json.dumps(call()).encode())
        os._exit(0)
    os.close(writes)
    with os.fdopen(reads) as stream:
        said = stream.read()
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return signal.Signals(os.WTERMSIG(status)).name
    return json.loads(said)


def signature(document: Document) -> tuple[str, ...]:
    """Return what makes two failures alike."""
    def look() -> list[str]:
        try:
            verdict = judge(document)
        except Exception as unfit:  # a structure that fell apart
            return [type(unfit).__name__]
        found = run(document)
        if found["outcome"] == "finished" and found["start_share"] > 0.05:
            found["reason"] = "far start"
        return [verdict.kind, str(verdict.class_a), str(verdict.slack), found["outcome"], found["reason"]]

    found = apart(look)
    return (found,) if isinstance(found, str) else tuple(found)


def _merged(document: Document, kept: str, gone: str) -> None:
    """Replace a node by another one everywhere."""
    document["node"] = [node for node in document["node"] if node["name"] != gone]
    for section in ("link", "spring", *JOINTS):
        for item in document.get(section, ()):
            for key, value in item.items():
                if value == gone:
                    item[key] = kept
                elif isinstance(value, list) and gone in value:
                    item[key] = [kept if one == gone else one for one in value]


def _tidy(document: Document) -> Document:
    """Remove unused nodes and empty sections."""
    used = {name for section in ("link", "spring", *JOINTS) for item in document.get(section, ())
            for key, value in item.items() if "node" in key for name in (value if isinstance(value, list) else [value])}
    document["node"] = [node for node in document["node"] if node["name"] in used]
    for section in ("spring", "torsion_spring", "program", *JOINTS):
        if not document.get(section):
            document.pop(section, None)
    return document


def _without_joints(document: Document, gone: list[tuple[str, str]]) -> Document:
    """Hold joints, named by section and name."""
    made = deepcopy(document)
    for section, name in gone:
        item = next(item for item in made[section] if item["name"] == name)
        made[section].remove(item)
        names = [item[key] for key in item if key.endswith("_node")] or item.get("nodes", [])
        if len(names) == 2:
            _merged(made, *(names if "_of_" in names[1] else names[::-1]))
        elif len(names) == 1:
            node = next(node for node in made["node"] if node["name"] == names[0])
            node["fixed"] = list("xyz"[: made["truss"]["dimension"]])
    return _tidy(made)


def _parts(names: list[Any]) -> Iterator[list[Any]]:
    """Yield parts of a list to remove: halves, quarters, ..., single items."""
    length = len(names) // 2
    while length > 1:
        for start in range(0, len(names), length):
            yield names[start: start + length]
        length //= 2
    for name in names:
        yield [name]


def smaller(document: Document) -> Iterator[Document]:
    """Yield smaller structures, large steps first."""
    for gone in _parts([(section, item["name"]) for section in JOINTS for item in document.get(section, ())]):
        yield _without_joints(document, gone)
    for gone in _parts([node["name"] for node in document["node"]]):
        made = deepcopy(document)
        for section in ("link", "spring"):
            made[section] = [item for item in made.get(section, ()) if not set(gone) & set(item["nodes"])]
        kept = {link["name"] for link in made["link"]}
        for section in ("torsion_spring", "latch_hinge"):
            made[section] = [item for item in made.get(section, ()) if set(item["links"]) <= kept]
        if len(made["link"]) < len(document["link"]):
            yield _tidy(made)
    for section in ("link", "spring", "torsion_spring"):
        for number in range(len(document.get(section, ()))):
            made = deepcopy(document)
            del made[section][number]
            yield _tidy(made)
    for section, key in (("node", "force_N"), ("link", "program"), ("link", "temperature_fraction"),
                         ("slider", "clearance_minus_m"), ("slider", "clearance_plus_m"), ("truss", "gravity_m_per_s2"),
                         ("latch_hinge", "preload_moment_N_m")):
        items = document.get(section, [])
        for number in range(len(items)) if isinstance(items, list) else [None]:
            made = deepcopy(document)
            one = made[section] if number is None else made[section][number]
            if one.pop(key, None) is not None:
                yield made
    yield from _simpler(document)


def _simpler(document: Document) -> Iterator[Document]:
    thermal = document["thermal"]
    if thermal["shape"] != "triangle" and not document.get("program"):
        values = thermal.get("table_temperature_change_K")
        largest = max(values, key=abs) if values else thermal["temperature_change_max_K"]
        yield {**deepcopy(document), "thermal": {
            "shape": "triangle", "temperature_change_max_K": largest, "cycles": 1, "period_s": 1.0}}
    if thermal["cycles"] > 1 and not document.get("program"):
        yield {**deepcopy(document), "thermal": {**thermal, "cycles": 1}}
    for digits in (2, 3, 4):
        made = json.loads(json.dumps(document), parse_float=lambda text: float(f"{float(text):.{digits}g}"))
        if made != document:
            yield made


def shrunk(document: Document, minutes: float) -> tuple[Document, tuple[str, ...]]:
    """Return the smallest structure found and its failure."""
    wanted, until = signature(document), time.monotonic() + 60 * minutes
    going = True
    while going and time.monotonic() < until:
        going = False
        for candidate in smaller(document):
            if time.monotonic() > until:
                break
            if signature(candidate) == wanted:
                document, going = candidate, True
                break
    return document, wanted


def main() -> None:
    """Shrink a structure and write it."""
    from statejump.kinds.truss.generate.document import to_toml

    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("family", choices=list(structures.FAMILIES))
    given.add_argument("seed", type=int)
    given.add_argument("--to", type=Path)
    given.add_argument("--minutes", type=float, default=3.0)
    asked = given.parse_args()
    document, failure = shrunk(structures.make(asked.family, asked.seed).document, asked.minutes)
    said = run(document)["sentence"] if failure[0] not in signal.Signals.__members__ else failure[0]
    text = f"# {failure}\n# {said}\n{to_toml(document)}"
    if asked.to:
        asked.to.write_text(text)
    print(text if asked.to is None else f"{asked.to}: {len(document['node'])} nodes, {failure}, {said}")


if __name__ == "__main__":
    sys.exit(main())
