# SPDX-License-Identifier: GPL-3.0-or-later
"""Response of any law of the catalogue at one contact that is driven along a given path, for tests of laws."""
from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from statejump import _engine
from statejump.core.errors import FailedRun, MissingKey, NotAllowed, UnknownKey, located
from statejump.core.table_files import read_known
from statejump.core.tables import check_columns, write_columns
from statejump.laws.traits import Law, catalogue

# Kinds of laws that can be driven. If several kinds have a law of the name, the first kind counts.
DRIVEN = ("friction", "normal", "dissipation")
NORMAL = ("penetration_depth_m", "normal_force_N")
ALONG = ("slide_m", "slide_x_m", "tangential_force_N")
COLUMNS = ("time_s", *NORMAL, *ALONG, "slide_y_m")
# The whole refined path is kept in memory.
MOST_STEPS = 10_000_000


def drive(
    law: str,
    history: Mapping[str, Any] | str | Path,
    *,
    effective_young_modulus_Pa: float,
    effective_shear_modulus_Pa: float,
    effective_radius_m: float,
    friction_coefficient: float,
    steps_per_row: int = 1,
    radial_clearance_m: float = inf,
    contact_length_m: float | None = None,
    restitution: float | None = None,
    smallest_impact_speed_m_per_s: float | None = None,
    v0_m_per_s: float | None = None,
    v1_m_per_s: float | None = None,
) -> dict[str, np.ndarray]:
    """Drive one contact along a path, and return the response of a law of the catalogue.

    The contact begins at the first row, without slide. Between two rows the path is straight. A negative penetration
    depth is an open contact: it has no force, and friction loses its memory. When the depth is positive again, a new
    contact begins.

    Columns of the history: ``penetration_depth_m`` or ``normal_force_N``; ``slide_m``, or ``slide_x_m`` with
    ``slide_y_m``, or ``tangential_force_N``; ``time_s`` for a law that depends on velocity. A slide is that of body 1
    relative to body 2; a tangential force is positive along the slide that causes it.

    :param law: name of a friction law (with Hertz's pressure), a normal law (with Mindlin's friction), or a dissipation
        law (with both)
    :param history: the columns, or a CSV file with them
    :param effective_young_modulus_Pa: E* [Pa], 1/E* = (1 - ν1²)/E1 + (1 - ν2²)/E2
    :param effective_shear_modulus_Pa: G* [Pa], 1/G* = (2 - ν1)/G1 + (2 - ν2)/G2
    :param effective_radius_m: R [m]; for a journal in a bore R1 R2/(R2 - R1)
    :param friction_coefficient: μ [-]
    :param steps_per_row: number of equal steps between two rows
    :param radial_clearance_m: R2 - R1 [m]; default: that of a flat wall. Laws of line contacts need it
    :param contact_length_m: length of a line contact [m]; default: that of the catalogue
    :param restitution: coefficient of restitution, for a dissipation law [-]; default: that of the catalogue
    :param smallest_impact_speed_m_per_s: for a dissipation law; default: that of the catalogue
    :param v0_m_per_s: v0 of the friction law that reads it; default: that of the catalogue
    :param v1_m_per_s: v1 of the friction law that reads it; default: that of the catalogue
    :return: arrays by column, with one value per step: the columns of the history; ``row`` (counted from 1, with
        fractions between); those of ``penetration_depth_m``, slides, ``normal_force_N``, ``tangential_force_N`` that
        the history lacks (or ``tangential_force_x_N``, ``tangential_force_y_N``); energies ``normal_elastic_energy_J``
        and ``tangential_elastic_energy_J``; ``friction_dissipation_J`` and ``damping_dissipation_J`` since the first
        row; ``slipping``, 1 where friction is at its limit; ``memory_points`` and ``merged_force_N`` of a law with
        partial slip
    :raises StatejumpError: an unknown law, a missing or unsuitable column, a value that is not a number or out of
        range; :class:`~statejump.core.errors.FailedRun`, with the row: a depth outside the range of the normal law, or
        a force that friction cannot reach
    """
    kind, known = _driven(law)
    file, columns = _columns(history)
    with located(file=file):
        _check(columns, kind, known)
    if not (isinstance(steps_per_row, int) and steps_per_row >= 1):
        raise NotAllowed("steps_per_row", steps_per_row, code="not_positive_integer")
    rows = len(next(iter(columns.values())))
    if (rows - 1) * steps_per_row >= MOST_STEPS:
        raise NotAllowed("steps_per_row", steps_per_row, code="too_many_law_steps", rows=rows, most=MOST_STEPS)
    row, path = _refined(columns, steps_per_row)
    normal = next(name for name in NORMAL if name in path)
    along = next(name for name in ALONG if name in path)
    arguments = {
        "effective_young_modulus_Pa": effective_young_modulus_Pa,
        "effective_shear_modulus_Pa": effective_shear_modulus_Pa,
        "effective_radius_m": effective_radius_m,
        "friction_coefficient": friction_coefficient,
        "radial_clearance_m": radial_clearance_m,
        "contact_length_m": _or_default("contact_length", contact_length_m),
        "restitution": _or_default("restitution", restitution),
        "smallest_impact_speed_m_per_s": _or_default("smallest_impact_speed", smallest_impact_speed_m_per_s),
        "v0_m_per_s": _or_default("v0", v0_m_per_s),
        "v1_m_per_s": _or_default("v1", v1_m_per_s),
    }
    try:
        answer = _engine.drive_contact(
            **arguments, kind=kind, name=law, normal=path[normal], normal_is_force=normal == "normal_force_N",
            along=path[along], along_is_force=along == "tangential_force_N", across_m=path.get("slide_y_m"),
            time_s=path.get("time_s"),
        )
    except _engine.EngineFailure as failure:
        key = next(name for name in arguments if name.startswith(failure.key or ""))
        raise NotAllowed(key, arguments[key], failure.cause, code="law_argument_out_of_range",
                         needed=failure.allowed) from None
    problem = answer.pop("problem")
    if problem:
        reached = row[len(answer["slide_x_m"])]
        raise FailedRun(code="law_failed", file=file, item=f"row {reached:g}", law=law, why=problem)
    return _named({"row": row} | path, answer)


def drive_file(law: str, history: Path, written: Path, **options: Any) -> Path:
    """Do the same as :func:`drive`, from one CSV file to another. Return the path of the written file."""
    write_columns(drive(law, history, **options), written)
    return written


def _driven(name: str) -> tuple[str, Law]:
    """Return the kind of a law and its description."""
    names: list[str] = []
    for kind in DRIVEN:
        for law in catalogue(kind):
            if law.name == name:
                return kind, law
            names.append(law.name)
    for kind in DRIVEN:
        if problem := _engine.law_problem(kind, name):
            raise NotAllowed("law", name, problem, code="bad_law")
    raise NotAllowed("law", name, code="not_one_of", allowed=tuple(names), known=", ".join(dict.fromkeys(names)))


def _columns(history: Mapping[str, Any] | str | Path) -> tuple[Path | None, dict[str, np.ndarray]]:
    """Return the file of a history, and its columns as given."""
    if isinstance(history, Mapping):
        return None, {str(name): np.atleast_1d(np.asarray(values)) for name, values in history.items()}
    file = Path(history)
    return file, read_known(file, COLUMNS)


def _check(columns: Mapping[str, np.ndarray], kind: str, law: Law) -> None:
    """Raise an error if columns do not define a path for the law. :raises StatejumpError: the first fault"""
    for name in columns:
        if name not in COLUMNS:
            near = get_close_matches(name, COLUMNS, 1)
            raise UnknownKey(name, section=f"column {name}", **(
                {"code": "misspelt_key", "meant": near[0]} if near else
                {"code": "no_such_key", "known": ", ".join(COLUMNS)}))
    _one_of(columns, NORMAL, "penetration_depth_m or normal_force_N")
    _one_of(columns, ALONG, "slide_m, slide_x_m with slide_y_m, or tangential_force_N")
    if ("slide_x_m" in columns) != ("slide_y_m" in columns):
        there, missing = sorted(("slide_x_m", "slide_y_m"), key=lambda name: name not in columns)
        raise MissingKey(missing, code="column_partner_missing", section=f"column {missing}", partner=there)
    check_columns(columns)
    if "normal_force_N" in columns:
        below = np.flatnonzero(columns["normal_force_N"] < 0)
        if below.size:
            raise NotAllowed("normal_force_N", float(columns["normal_force_N"][below[0]]), code="tensile_force",
                             item=f"row {below[0] + 1}")
    if "tangential_force_N" in columns and columns["tangential_force_N"][0] != 0:
        raise NotAllowed("tangential_force_N", float(columns["tangential_force_N"][0]), code="first_row_not_zero",
                         item="row 1")
    timed = kind == "dissipation" and law.parameters or kind == "friction" and not (law.has_memory or law.frictionless)
    if timed and "time_s" not in columns:
        raise MissingKey("time_s", code="law_needs_time", section="column time_s", law=law.name)
    if "time_s" in columns:
        late = np.flatnonzero(np.diff(columns["time_s"]) <= 0)
        if late.size:
            raise NotAllowed("time_s", float(columns["time_s"][late[0] + 1]), code="history_times_not_increasing",
                             item=f"row {late[0] + 2}")
    if kind == "dissipation" and law.parameters and "normal_force_N" in columns:
        raise NotAllowed("normal_force_N", code="law_needs_penetration", law=law.name)


def _one_of(columns: Mapping[str, np.ndarray], names: tuple[str, ...], needs: str) -> None:
    there = [name for name in names if name in columns]
    if not there:
        raise MissingKey(names[0], code="history_column_missing", section=f"column {names[0]}", needs_=needs)
    if len(there) > 1:
        raise NotAllowed(there[1], code="history_columns_exclude", other=there[0], needs_=needs)


def _refined(columns: Mapping[str, np.ndarray], steps: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return row numbers and columns, with equal steps between rows."""
    rows = len(next(iter(columns.values())))
    row = np.arange((rows - 1) * steps + 1) / steps
    return row + 1, {name: np.interp(row, np.arange(rows), values) for name, values in columns.items()}


def _or_default(parameter: str, value: float | None) -> float:
    if value is not None:
        return value
    parameters = (each for kind in DRIVEN for law in catalogue(kind) for each in law.parameters)
    return next(each.default for each in parameters if each.name == parameter)


def _named(path: dict[str, np.ndarray], answer: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the columns of the path, and those columns of the response that the path lacks. If the path has only one
    direction, columns of the second direction are omitted."""
    if "slide_y_m" not in path:
        for name in ("slide_y_m", "tangential_force_y_N"):
            del answer[name]
        answer = {name.replace("_x_", "_"): values for name, values in answer.items()}
    return path | {name: values for name, values in answer.items() if name not in path}
