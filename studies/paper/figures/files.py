# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables and text beside Figures 13 to 16."""
from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.tables import write_csv, write_json, write_markdown
from statejump.kinds.umbrella.case import UmbrellaCase
from studies.paper import ensembles
from studies.paper.claims.findings import Findings
from studies.paper.claims.measures import all_claims
from studies.paper.claims.page import page
from studies.paper.figures.closed_forms import envelope, quasi_static
from studies.paper.figures.runs import Study, Variant, single_deflection

TABLE_POINTS = 201  # largest number of points of a curve in curves.csv, and of a band in a figure


def thin(length: int, points: int) -> np.ndarray:
    """Return the indices of at most ``points`` samples, including the first and the last."""
    return np.unique(np.linspace(0, length - 1, min(points, length)).round().astype(int))


def write_ensembles(
    done: Sequence[tuple[Study, Sequence[Variant]]], dem_ensemble: ensembles.EnsembleOfRuns, base: Variant, folder: Path
) -> None:
    """Write ``ensembles.csv``: one row per run."""

    def of(figure: str, key: str, value: float, name: str, runs: ensembles.EnsembleOfRuns) -> Iterator[Sequence[Any]]:
        largest = np.abs(runs.deflection_rad).max(axis=1)
        for i, end in enumerate(runs.end_eccentricity_m):
            yield (figure, key, float(value), name, i, float(largest[i]), float(runs.range_rad[i]),
                   float(runs.jump_rad[i]), float(end[0]), float(end[1]))

    def rows() -> Iterator[Sequence[Any]]:
        yield from of("fig13", "", 0.0, "reduced ensemble", base.ensemble)
        yield from of("fig13", "", 0.0, "dem ensemble", dem_ensemble)
        for study, variants in done:
            for v in variants:
                yield from of(study.figure, study.key, v.value, "reduced ensemble", v.ensemble)
                for name in ("reduced", "dem"):
                    single = ensembles.gather([getattr(v, name)])
                    yield from of(study.figure, study.key, v.value, f"{name} single", single)

    _write_table(
        folder / "ensembles.csv",
        ("figure", "parameter", "value", "model", "run", "largest_deflection_rad", "range_rad", "jump_rad",
         "end_eccentricity_x_m", "end_eccentricity_y_m"),
        rows(),
    )


def write_curves(done: Sequence[tuple[Study, Sequence[Variant]]], folder: Path) -> None:
    """Write ``curves.csv``: the curves of Figures 14 to 16, at fewer times."""

    def rows() -> Iterator[Sequence[Any]]:
        for study, variants in done:
            for v in variants:
                runs = v.ensemble
                take = thin(len(runs.time_s), TABLE_POINTS)
                change = runs.temperature_change_K[take]
                deflection = runs.deflection_rad[:, take]
                low, high = envelope(v.case, change)
                path = quasi_static(v.case, change)
                columns = (
                    runs.time_s[take], change, deflection.mean(axis=0), deflection.std(axis=0),
                    single_deflection(v.reduced)[take], single_deflection(v.dem)[take],
                    low - v.case.theta2_rad, high - v.case.theta2_rad,
                )
                for i, row in enumerate(np.array(columns).T):
                    static = "" if path is None or np.isnan(path[i]) else float(path[i])
                    yield (study.figure, study.key, float(v.value), *(float(cell) for cell in row), static)

    _write_table(
        folder / "curves.csv",
        ("figure", "parameter", "value", "time_s", "temperature_change_K", "ensemble_mean_deflection_rad",
         "ensemble_sd_deflection_rad", "reduced_deflection_rad", "dem_deflection_rad", "envelope_low_rad",
         "envelope_high_rad", "quasi_static_deflection_rad"),
        rows(),
    )


def write_claims(case: UmbrellaCase, command: str, findings: Findings, folder: Path) -> None:
    """Write ``ensembles.json`` and ``README.md``.

    :param command: command that writes these files
    """
    content = {
        "case": case.name,
        "claims": [asdict(claim) for claim in all_claims(findings)],
        "two_sample_tests": [{**asdict(test), "agree": test.agree} for test in findings.tests],
        "findings": {key: value for key, value in asdict(findings).items() if key != "tests"},
    }
    write_json(folder / "ensembles.json", _plain(content), indent=1)
    write_markdown(folder / "README.md", page(case.title, command, findings))


def _write_table(path: Path, header: Sequence[str], rows: Iterator[Sequence[Any]]) -> None:
    write_csv(path, header, ([f"{cell:.9g}" if isinstance(cell, float) else cell for cell in row] for row in rows))


def _plain(value: Any) -> Any:
    """Convert values to JSON with significant digits only: arrays become lists, NaN and infinity become None."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, (float, np.floating)):
        return float(f"{value:.9g}") if np.isfinite(value) else None
    return value
