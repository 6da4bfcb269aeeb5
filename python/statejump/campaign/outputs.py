# SPDX-License-Identifier: GPL-3.0-or-later
"""Outputs that a campaign records besides the outcomes of its kind of case: any column of a run, at named items.

An output is ``HOW:COLUMN[ITEM].AXIS``, for example ``jump:displacement_m[P].x`` or ``max:links.axial_force_N[L3]``.
Columns are those of the CSV files. Columns of links and contacts begin with ``links.`` or ``contacts.``. If the output
of a vector names no axis, its length is recorded. Columns of a reflecting surface, for example
``max:surface.pointing_error_rad``, are those of :func:`statejump.surface.history`. ``repeat`` is the largest difference
of a value between a later return and the first one. At a return the temperature has its initial value again.
``bound:spread_m[node:C.y]`` is the bound of an output over any temperature history, as in ``statejump bounds``.
"""
from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from difflib import get_close_matches
from typing import Any, Protocol, runtime_checkable

import numpy as np

from statejump.core.errors import NotAllowed, StatejumpError
from statejump.core.later import Later
from statejump.core.run import AXES, GROUPS, Column, Run
from statejump.core.units import split_unit, unit_of

_HISTORY = Later("statejump.surface:history")
FORM = re.compile(r"(?P<how>\w+):(?:(?P<group>links|contacts|surface)\.)?(?P<column>\w+)(?:\[(?P<item>.*)\])?"
                  r"(?:\.(?P<axis>\w+))?")
# Functions of a column over time. Those in ENDS need only start and end of a run, the others every sample.
ENDS: dict[str, Callable[[np.ndarray], np.ndarray]] = {"end": lambda values: values[-1],
                                                       "jump": lambda values: values[-1] - values[0]}
ALL: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "max": lambda values: values.max(axis=0), "min": lambda values: values.min(axis=0),
    "range": lambda values: np.ptp(values, axis=0)}
JUMP = "jump"
REPEAT = "repeat"  # of the times of Case.returns_s
BOUND = "bound"  # of the rest states of a case; its columns are those of bounds.csv
HOW: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    **ENDS, **ALL, REPEAT: lambda values: np.linalg.norm((values - values[0]).reshape(len(values), -1), axis=1).max()}
WORDS = {"end": "{} at the end", "jump": "jump of {}", "max": "largest {}", "min": "smallest {}",
         "range": "range of {}", BOUND: "bound, {}", REPEAT: "repeatability of {} from cycle to cycle"}
SURFACE = "surface"
# The pattern for editors, which do not support names of groups.
PATTERN = re.sub(r"\?P<\w+>", "", FORM.pattern)
LIKE = "must be HOW:COLUMN[ITEM].AXIS, as 'jump:displacement_m[P].x'"


@runtime_checkable
class Bounded(Protocol):
    """A case whose rest states have bounds."""

    def bounds(self, **settings: Any) -> Any:
        """Return the bounds, see docs/howto/bounds.md."""


def parts(name: str) -> re.Match[str]:
    found = FORM.fullmatch(name) if isinstance(name, str) else None
    if found is None:
        raise NotAllowed("outputs", name, code="bad_output_name")
    if found["how"] not in (*HOW, BOUND):
        raise NotAllowed("outputs", name, code="output_how_unknown", hows=", ".join((*HOW, BOUND)))
    return found


def needs_all_samples(name: str) -> bool:
    """Whether an output needs every sample of a run."""
    return parts(name)["how"] not in (*ENDS, BOUND)


def unit(name: str) -> str:
    """Return the unit of an output, or of an outcome, from its name."""
    found = FORM.fullmatch(name)
    return unit_of(found["column"] if found else name)


def in_words(name: str) -> str | None:
    """Describe an output in words, without its unit; return None if the name is that of an outcome of the kind."""
    found = FORM.fullmatch(name)
    if found is None:
        return None
    what = split_unit(found["column"])[0].replace("_", " ")
    of = {"links": "link", "contacts": "contact", SURFACE: "surface"}.get(found["group"] or "", "")
    of = " ".join(part for part in (of, found["item"], found["axis"] and f"along {found['axis']}") if part)
    return WORDS[found["how"]].format(what + (f" of {of}" if of else ""))


def values(names: Sequence[str], run: Run) -> dict[str, float]:
    """Compute the requested outputs of a run.

    :raises NotAllowed: the run has no such column, item or axis; the message suggests a similar name
    """
    columns: dict[tuple[str | None, bool], dict[str, Column]] = {}
    found: dict[str, float] = {}
    returned: Run | None = None
    if any(parts(name)["how"] == JUMP for name in names):
        run.definition.need_jump("an output 'jump:...'")
    bounded = [name for name in names if parts(name)["how"] == BOUND]
    found.update(_bounds(run, bounded) if bounded else {})
    for name in names:
        if name in found:
            continue
        asked = parts(name)
        group, repeats = asked["group"], asked["how"] == REPEAT
        if repeats and returned is None:
            returned = _returned(run, name)
        seen = returned if repeats and returned is not None else run
        if (group, repeats) not in columns:
            columns[group, repeats] = _surface(seen, name) if group == SURFACE else _columns(seen, group)
        found[name] = _value(name, run, columns[group, repeats])
    return found


def _returned(run: Run, name: str) -> Run:
    """Return the samples of a run at the times at which the temperature has its initial value again."""
    times = run.definition.returns_s()
    if len(times) < 2:
        raise NotAllowed("outputs", name, code="output_without_jump", times=len(times))
    return run.at(times)


def _value(name: str, run: Run, columns: dict[str, Column]) -> float:
    asked = parts(name)
    if asked["column"] not in columns:
        where = next((f"{group}." for group in GROUPS[2:] if asked["column"] in getattr(run, group)), "")
        raise NotAllowed("outputs", name, **(
            {"code": "output_misspelt", "meant": f"{where}{asked['column']}"} if where else
            _near("column", asked["column"], list(columns))))
    column = columns[asked["column"]]
    values = np.asarray(column.values, dtype=float)
    if column.items:
        names = list(run.names[column.items])
        if asked["item"] is None:
            raise NotAllowed("outputs", name, code="output_item_not_chosen", column=asked["column"], items=column.items)
        if asked["item"] not in names:
            raise NotAllowed("outputs", name, **_near(column.items, asked["item"], names))
        values = values[:, names.index(asked["item"])]
    elif asked["item"] is not None:
        raise NotAllowed("outputs", name, code="output_without_items", column=asked["column"])
    if asked["axis"] is not None:
        if values.ndim == 1:
            raise NotAllowed("outputs", name, code="output_not_vector", column=asked["column"])
        if asked["axis"] not in AXES:
            raise NotAllowed("outputs", name, code="output_axis", known=", ".join(AXES))
        values = values[:, AXES.index(asked["axis"])]
    elif values.ndim > 1 and asked["how"] in ALL:
        values = np.linalg.norm(values, axis=1)
    found = HOW[asked["how"]](values)
    return float(np.linalg.norm(found) if values.ndim > 1 else found)


def _columns(run: Run, group: str | None) -> dict[str, Column]:
    groups = (group,) if group else ("history", "energy")
    return {key: column for group in groups for key, column in getattr(run, group).items()
            if not column.labels and np.issubdtype(column.values.dtype, np.number)}


def _surface(run: Run, name: str) -> dict[str, Column]:
    try:
        return {key: Column(values) for key, values in _HISTORY(run).items()}
    except StatejumpError as refused:
        raise NotAllowed("outputs", name, refused.phrase(), code="output_without_surface",
                         remedy=refused.remedy) from None


def _bounds(run: Run, names: Sequence[str]) -> dict[str, float]:
    """Return bounds over any temperature history; they need the case of a run, not its samples."""
    case = run.definition
    if not isinstance(case, Bounded):
        raise NotAllowed("outputs", names[0], code="output_without_bounds")
    found: dict[str, float] = {}
    for name in names:
        asked = parts(name)
        if asked["item"] is None:
            raise NotAllowed("outputs", name, code="output_bound_not_chosen")
        try:
            bound = case.bounds(output=[asked["item"]], simulate=False).record()["bounds"][0]
        except NotAllowed:
            raise NotAllowed("outputs", name, code="output_item_undefined", what_it_is="output of bounds",
                             known="node:NAME.x, rms, tilt, zernike:K, point") from None
        if asked["column"] == "output" or asked["column"] not in bound or isinstance(bound[asked["column"]], list):
            known = [key for key, value in bound.items() if isinstance(value, float)]
            raise NotAllowed("outputs", name, **_near("column", asked["column"], known))
        value = bound[asked["column"]]
        found[name] = float("nan") if value is None else float(value)
    return found


def _near(what: str, given: str, known: Sequence[str]) -> dict[str, str]:
    near = get_close_matches(given, known, n=1)
    if near:
        return {"code": "output_misspelt", "meant": near[0]}
    listed = ", ".join(known[:12]) + (", ..." if len(known) > 12 else "")
    if known:
        return {"code": "output_item_undefined", "what_it_is": what.removesuffix("s"), "known": listed}
    return {"code": "output_without_item", "items": what}
