#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares bounds of many ordinary structures with the rest states after random temperature histories.

    PYTHONPATH=build/python tests/ordinary/bounds_campaign.py [--count 100] [--seed 1] [--histories 7] [--families ...]
        [--classes A B C] [--limit 60] [--attain] [--out rows.csv]

Family and seed determine a structure and its histories. ``--count`` structures of each class are compared. For class B,
sliders get stops within their reach. A state outside of a bound plus its margin, or outside of the bound within the
range of its temperatures, is printed, and the exit status is 1. The table has, by class, the structures, their
histories, the states outside, and the medians of reached/bound, attained/bound (``--attain``) and simulated/bound.
"""
from __future__ import annotations

import argparse
import csv
import os
import signal
import sys
from collections import Counter
from collections.abc import Iterator
from copy import deepcopy
from typing import Any

import numpy as np

import statejump as sj
import structures
from statejump.core.errors import StatejumpError
from statejump.kinds.truss.bounds.result import Bounds
from statejump.kinds.truss.bounds.sliding import sliding
from statejump.kinds.truss.bounds.study import bounds
from statejump.kinds.truss.solve import solve

FIELDS = ("family", "seed", "class", "quality", "output", "spread_m", "margin_m", "reached_m", "attained_m",
          "simulated_m", "range_m", "in_range_m", "verdict", "states", "outside")
LEGS = 5  # temperatures of each member in a history
ROUNDING = 1e-6  # of the spread
LEAST_m = 1e-13
Row = dict[str, Any]


def history(document: dict[str, Any], rng: np.random.Generator, most_K: float) -> dict[str, Any]:
    """Return a case in which every member has a random temperature history of its own that returns to zero."""
    made, time = deepcopy(document), np.linspace(0, 1, LEGS + 2).tolist()
    made["thermal"] = {"shape": "table", "table_time_s": time, "table_temperature_change_K": [0.0] * len(time)}
    made["program"] = []
    for section in ("link", "beam"):
        for number, member in enumerate(made.get(section, [])):
            member["program"] = f"{section}{number}"
            changes = [0.0, *rng.uniform(-most_K, most_K, LEGS), 0.0]
            made["program"].append({"name": member["program"], "shape": "table", "table_time_s": time,
                                    "table_temperature_change_K": changes})
    return made


def with_stops(document: dict[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """Return a structure whose sliders have stops that are within the reach of friction."""
    reach = {joint: half for joint, half in _reach_m(sj.load(document))}
    made = deepcopy(document)
    for slider in made["slider"]:
        half = reach.get(slider["name"], 0.0)
        if half > 0:
            slider[f"clearance_{rng.choice(['plus', 'minus'])}_m"] = float(10 ** rng.uniform(-1.2, 0.2)) * half
    return made


def _reach_m(case: Any) -> Iterator[tuple[str, float]]:
    of = sliding(case)
    half = np.abs(of.compliance) @ of.limit_N
    for joint, slide, one in zip(of.joints, of.slide_m, half):
        if joint.section == "slider":
            yield joint.name, float(abs(slide) + one)


def structure(family: str, seed: int, letter: str) -> dict[str, Any]:
    """Return the document of a structure."""
    document: dict[str, Any] = structures.make(family, seed).document
    if letter == "B" and document.get("slider") and not any("clearance_plus_m" in one or "clearance_minus_m" in one
                                                            for one in document["slider"]):
        return with_stops(document, np.random.default_rng([seed, 11]))
    return document


def rest_states(document: dict[str, Any], rng: np.random.Generator, histories: int) -> np.ndarray:
    """Return displacements (states, nodes, 3) at the start and at the ends of histories that have a path."""
    found = []
    for _ in range(histories):
        case = sj.load(history(document, rng, float(10 ** rng.uniform(0.5, 2.5))))
        try:
            found.append(solve(case).states["displacement_m"][[0, -1]])
        except StatejumpError:
            continue
    return np.concatenate(found) if found else np.zeros((0, 0, 3))


def within_range(document: dict[str, Any], rng: np.random.Generator, name: str) -> tuple[float, float, str]:
    """Return the range bound of an output, what a random history within the range changes it by, and the verdict."""
    most_K = float(10 ** rng.uniform(0.3, 1.8))
    found = bounds(sj.load(document), [name], (-most_K, most_K), simulate=False)
    bound = found.bounds[0]
    try:
        states = solve(sj.load(history(document, rng, most_K))).states["displacement_m"][[0, -1]]
    except StatejumpError:
        return bound.range_spread, 0.0, found.verdict.kind
    return bound.range_spread, bound.output.change(*states), found.verdict.kind


def rows_of(family: str, seed: int, found: Bounds, states: np.ndarray, attained: float = np.nan,
            ranged: tuple[float, float, str] = (np.nan, 0.0, "")) -> Iterator[Row]:
    """Yield a row for each output.

    :param attained: spread of the history that attains the first bound; ``ranged``: see :func:`within_range`
    """
    for number, bound in enumerate(found.bounds):
        values = bound.output.vector(states)
        changes = np.linalg.norm(values[:, None] - values[None], axis=-1) if len(states) else np.zeros((1, 1))
        margin = 0.0 if np.isnan(bound.margin) else bound.margin
        most = bound.spread * (1 + ROUNDING) + margin + LEAST_m
        yield {"family": family, "seed": seed, "class": found.letter, "quality": found.quality,
               "output": bound.output.name, "spread_m": bound.spread, "margin_m": margin, "reached_m": bound.reached,
               "attained_m": np.nan if number else attained, "simulated_m": float(changes.max()),
               "range_m": np.nan if number else ranged[0], "in_range_m": 0.0 if number else ranged[1],
               "verdict": "" if number else ranged[2], "states": len(states),
               "outside": int((changes > most).any() and np.isfinite(most))
               + int(not number and (attained > most or ranged[1] > ranged[0] * (1 + ROUNDING) + margin + LEAST_m))}


class Expired(Exception):
    """A structure takes too long."""


def _expire(*_: object) -> None:
    raise Expired


def compared(arguments: argparse.Namespace, reasons: Counter[str]) -> Iterator[Row]:
    """Yield rows until every class has its number of structures."""
    signal.signal(signal.SIGALRM, _expire)
    missing = dict.fromkeys(arguments.classes, arguments.count)
    tried = ((seed, family, letter) for seed in range(arguments.seed, arguments.seed + arguments.most)
             for family in arguments.families for letter in arguments.classes)
    for seed, family, letter in tried:
        if not any(missing.values()):
            return
        if not missing[letter]:
            continue
        signal.alarm(arguments.limit)
        try:
            document = structure(family, seed, letter)
            found = bounds(sj.load(document), simulate=False)
            if found.letter != letter or not found.bounds or not any(one.spread > LEAST_m for one in found.bounds):
                continue
            rng = np.random.default_rng([seed, 7])
            states = rest_states(document, rng, arguments.histories)
            attained, ranged = np.nan, (np.nan, 0.0, "")
            if arguments.attain:
                name = found.bounds[0].output.name
                attained = bounds(sj.load(document), [name], attain=True, simulate=False).bounds[0].attained
                ranged = within_range(document, rng, name)
        except StatejumpError as refused:
            reasons[getattr(refused, "code", "") or str(refused)] += 1
            continue
        except Expired:
            reasons["limit of time"] += 1
            continue
        finally:
            signal.alarm(0)
        missing[letter] -= 1
        yield from rows_of(family, seed, found, states, attained, ranged)


def table(rows: list[Row]) -> str:
    """Return the results by class."""
    lines = ["| class | quality | structures | states | outside | reached/bound, median | attained/bound, median | "
             "simulated/bound, median |", "|---|---|---|---|---|---|---|---|"]
    for letter, quality in sorted({(row["class"], row["quality"]) for row in rows}):
        ours = [row for row in rows
                if (row["class"], row["quality"]) == (letter, quality) and LEAST_m < row["spread_m"] < np.inf]
        if not ours:
            continue
        structures_ = {(row["family"], row["seed"]): row["states"] for row in ours}
        ratios = [_median([row[key] / row["spread_m"] for row in ours])
                  for key in ("reached_m", "attained_m", "simulated_m")]
        lines.append(f"| {letter} | {quality} | {len(structures_)} | {sum(structures_.values())} | "
                     f"{sum(row['outside'] for row in ours)} | " + " | ".join(ratios) + " |")
    return "\n".join(lines)


def _median(ratios: list[float]) -> str:
    known = [ratio for ratio in ratios if not np.isnan(ratio)]
    return f"{np.median(known):.4f}" if known else ""


def main() -> int:
    """Compare the structures of the arguments."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--most", type=int, default=1000, help="seeds of each family that are tried")
    parser.add_argument("--histories", type=int, default=7)
    parser.add_argument("--families", nargs="+", default=list(structures.SHAPES))
    parser.add_argument("--classes", nargs="+", default=["A", "B", "C"])
    parser.add_argument("--limit", type=int, default=60, help="of a structure [s]")
    parser.add_argument("--attain", action="store_true", help="also attain the first bound, and check a range")
    parser.add_argument("--out", default="")
    arguments = parser.parse_args()
    rows, reasons = [], Counter[str]()
    with open(arguments.out or os.devnull, "w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, FIELDS)
        writer.writeheader()
        for row in compared(arguments, reasons):
            rows.append(row)
            writer.writerow(row)
            stream.flush()
            if row["outside"]:
                print("outside:", row, flush=True)
    print(table(rows))
    print("not compared:", ", ".join(f"{number} × {reason}" for reason, number in reasons.most_common(12)))
    return int(any(row["outside"] and row["quality"] != "estimate" for row in rows))


if __name__ == "__main__":
    sys.exit(main())
