# SPDX-License-Identifier: GPL-3.0-or-later
"""A run of a model: columns over its samples, events, summary. All kinds of case and both models use this class."""
from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from statejump.core import libraries
from statejump.core.errors import ABSENT, MissingPart, NotAllowed, StatejumpError, UnknownKey
from statejump.core.later import Later
from statejump.core.tables import write_columns
from statejump.core.units import unit_of
from statejump.schema.rules import suggestion

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from statejump.core.case import Case

# States of a contact at a sample; columns hold the index in this list.
CONTACT_STATES = ("separated", "stick", "slip", "at_stop")
SEPARATED, STICK, SLIP, AT_STOP = range(len(CONTACT_STATES))
MODELS = {"reduced": "reduced model", "dem": "DEM"}
GROUPS = ("history", "energy", "links", "contacts")
AXES = ("x", "y", "z")
Columns = Mapping[str, np.ndarray]
_COLUMNS, _SAVED = Later("statejump.kinds:columns_of"), Later("statejump.results.record:save_as")
_DRAWN, _HTML = Later("statejump.core.figures:drawn"), Later("statejump.core.html:run_html")


class Parts(dict[str, Any]):
    """Parts of a result file by name. A missing part raises an error with a one-sentence message.

    :param place: path of these parts in the file
    """

    def __init__(self, parts: Mapping[str, Any], place: str, file: object) -> None:
        super().__init__(parts)
        self.place, self.file = place, str(file)

    def __missing__(self, name: str) -> Any:
        raise MissingPart(code="result_part_missing", file=self.file, group=self.place, name=name)

    def like(self, parts: Mapping[str, Any]) -> Parts:
        """Return other parts with the same path."""
        return Parts(parts, self.place, self.file)


class Named(dict[str, Any]):
    """Columns or numbers of a run by name. An unknown name raises an error that suggests a known name.

    :param what: noun that messages use for a value, for example ``column``
    """

    def __init__(self, values: Mapping[str, Any], what: str) -> None:
        super().__init__(values)
        self.what = what

    def __missing__(self, name: Any) -> Any:
        raise MissingName(self.what, name, list(self))


class MissingName(UnknownKey, KeyError):
    """The name of a column or number of a run is unknown. The error is also a KeyError, as for a dict."""

    def __init__(self, what: str, name: Any, known: Sequence[str]) -> None:
        ends = [path for path in known if path.rpartition("/")[2] == name]
        super().__init__(f"{what} {name!r}", **(
            {"code": "misspelt_key", "meant": " or ".join(ends)} if ends else suggestion(name, known)))


@dataclass(frozen=True)
class Column:
    """Values over the samples of a run, with the shape (samples), (samples, items) or (samples, items, 3).

    ``items`` is the key in :attr:`Run.names` under which the names of the items are listed. If there are ``labels``,
    the values are indices into them. ``note`` gives the source of the values, if it is not obvious.
    """

    values: np.ndarray
    unit: str = "-"
    items: str = ""
    labels: tuple[str, ...] = ()
    note: str = ""

    @property
    def shown(self) -> np.ndarray:
        """The values, or the texts if the column has labels."""
        found: np.ndarray = np.array(self.labels)[self.values] if self.labels else self.values
        return found


@dataclass(frozen=True)
class Event:
    """An event of a run. ``joint`` is the name of the contact or joint, or "" if the event has none.

    ``time_uncertainty_s`` is 0 if the model locates the instant, else half the interval of samples that contains it.
    """

    kind: str
    time_s: float
    temperature_change_K: float
    joint: str = ""
    time_uncertainty_s: float = 0.0


class Events(Sequence[Event]):
    """Events of a run in order of time.

    :param events: the events, or a function that returns them when they are first accessed
    """

    def __init__(self, events: Sequence[Event] | Callable[[], Sequence[Event]]) -> None:
        self._given = events

    @cached_property
    def _events(self) -> tuple[Event, ...]:
        return tuple(self._given() if callable(self._given) else self._given)

    def __getitem__(self, place: Any) -> Any:
        return self._events[place]

    def __len__(self) -> int:
        return len(self._events)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Events) and self._events == other._events

    def first(self, kind: str, until_s: float = float("inf")) -> Event | None:
        """Return the first event of a kind, or None."""
        return next((event for event in self._events if event.kind == kind and event.time_s <= until_s), None)

    def frame(self) -> pandas.DataFrame:
        """Return one row per event, with units in the column names."""
        return libraries.frame([vars(event) for event in self._events], columns=list(Event.__dataclass_fields__))

    def __reduce__(self) -> tuple[Any, ...]:
        return Events, (self._events,)

    def __repr__(self) -> str:
        return f"Events({', '.join(event.kind for event in self._events)})"

    def _repr_html_(self) -> str:
        return str(self.frame().to_html(index=False))


def _same(value: Any) -> Any:
    return value


def _raised(error: StatejumpError) -> Any:
    raise error


@dataclass(frozen=True)
class Run:
    """A run of one model of a case. Every column has one value for each time in ``time_s``.

    A run can be pickled and copied. The copy has no ``native`` and interpolates linearly between samples.

    :param model: ``reduced`` or ``dem``
    :param history: columns over time
    :param energy: stored, dissipated and supplied energies [J]
    :param links: columns of links, (samples, links)
    :param contacts: columns of contacts, (samples, contacts) and (samples, contacts, 3)
    :param events: events in order of time
    :param summary: summary numbers; their names end in their units. NaN: the event did not happen
    :param names: names of the items on the second axis of columns
    :param case_of: function that returns the case; a case in a file is read at the first call
    :param warnings: limits of the model that the run met
    :param complete: False: the run was interrupted and has only its first samples
    :param about: data about a DEM run: version of YADE, number of steps, run time [s]
    :param native: the model's own result (the path of a solver); None: the run was read from a file
    :param kind: kind of the case, which avoids a call of ``case_of``
    :param sampler: function that returns the run at other times [s], if the model can compute it exactly
    """

    model: str
    history: Mapping[str, Column]
    energy: Mapping[str, Column]
    links: Mapping[str, Column]
    contacts: Mapping[str, Column]
    events: Events
    summary: Mapping[str, float]
    names: Mapping[str, list[str]] = field(default_factory=dict)
    case_of: Callable[[], Case] | None = field(default=None, repr=False, compare=False)
    warnings: tuple[str, ...] = ()
    complete: bool = True
    about: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)
    native: Any = field(default=None, repr=False, compare=False)
    kind: str = ""
    sampler: Callable[[np.ndarray], Run] | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        for name, what in (*((group, "column") for group in GROUPS), ("summary", "number")):
            if type(getattr(self, name)) is dict:
                object.__setattr__(self, name, Named(getattr(self, name), what))

    def __getstate__(self) -> dict[str, Any]:
        case_of: Callable[[], Case] | None = None
        if self.case_of is not None:
            try:
                case_of = partial(_same, self.definition)
            except StatejumpError as error:  # from a file; the access to the case raises the reason
                case_of = partial(_raised, error)
        state = {name: value for name, value in vars(self).items() if name != "definition"}
        return {**state, "case_of": case_of, "native": None, "sampler": None}

    @cached_property
    def definition(self) -> Case:
        """The case of the run. :raises StatejumpError: this version cannot read the case any more"""
        if self.case_of is None:
            raise ValueError("this run was made without a case")
        return self.case_of()

    @property
    def case(self) -> Case:
        """The case of the run. :raises StatejumpError: this version cannot read the case any more"""
        return self.definition

    @property
    def time_s(self) -> np.ndarray:
        """Times of the samples [s]."""
        return self.history["time_s"].values

    def __len__(self) -> int:
        return len(self.time_s)

    def _found(self, name: str) -> Column | None:
        return self.history.get(name) or self.energy.get(name)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and self._found(name) is not None

    def __getitem__(self, name: str) -> np.ndarray:
        """Return a column by its name in history or energy, or any column by its path. :raises KeyError: there is
        none"""
        found = self._found(name)
        return (self.column(name) if found is None else found).shown

    def column(self, path: str) -> Column:
        """Return a column by its path, for example ``history/time_s``. :raises KeyError: there is no such column"""
        group, _, name = path.partition("/")
        found: Column | None = getattr(self, group).get(name) if group in GROUPS else None
        if found is None:
            raise MissingName("column", path, [f"{group}/{name}" for group in GROUPS for name in getattr(self, group)])
        return found

    def at(self, times_s: float | Sequence[float] | np.ndarray) -> Run:
        """Return the run at one or several other times [s], exactly if the model can compute it. Otherwise numbers are
        interpolated linearly between samples, and labels are those of the earlier sample. :raises NotAllowed: a time is
        no number"""
        try:
            asked = np.atleast_1d(np.asarray(times_s, dtype=float))
        except (TypeError, ValueError):
            asked = np.array([np.nan])
        if asked.ndim != 1 or not np.isfinite(asked).all():
            raise NotAllowed("times_s", ABSENT, code="no_times")
        if np.array_equal(self.time_s, asked):
            return self
        return self._interpolated(asked) if self.sampler is None else self.sampler(asked)

    def _interpolated(self, times_s: np.ndarray) -> Run:
        before = np.clip(np.searchsorted(self.time_s, times_s, side="right") - 1, 0, len(self.time_s) - 1)
        after = np.minimum(before + 1, len(self.time_s) - 1)
        step = self.time_s[after] - self.time_s[before]
        weight = np.divide(times_s - self.time_s[before], step, out=np.zeros(len(times_s)), where=step > 0)

        def moved(column: Column) -> Column:
            if column.labels:
                return replace(column, values=column.values[before])
            shape = (-1,) + (1,) * (column.values.ndim - 1)
            here, there, way = column.values[before], column.values[after], np.clip(weight, 0, 1).reshape(shape)
            with np.errstate(invalid="ignore"):  # of two infinite values
                between = here + way * (there - here)
            # At the time of a sample, the sample keeps its value, even beside a NaN.
            return replace(column, values=np.where(way > 0, between, here))

        groups: dict[str, Any] = {}
        for group in GROUPS:
            columns = getattr(self, group)
            made = {name: moved(column) for name, column in columns.items()}
            groups[group] = columns.like(made) if isinstance(columns, Parts) else made
        return replace(self, **groups, native=None)

    def flat(self, groups: Sequence[str] = ("history", "energy")) -> dict[str, np.ndarray]:
        """Return columns with one value per sample, in the order of the CSV files. Their names are ``name``,
        ``name[item]`` or ``name[item].x``; those of links and contacts begin with ``links/`` and ``contacts/``."""
        for group in groups:
            if group not in GROUPS:
                raise UnknownKey(f"group {group!r}", **suggestion(group, GROUPS))
        plain = {
            name: column.shown for group in ("history", "energy") if group in groups
            for name, column in getattr(self, group).items() if column.values.ndim == 1
        }
        found = {name: plain[name] for name in self._ordered(plain)}
        for group in groups:
            head = "" if group in ("history", "energy") else f"{group}/"
            for name, column in getattr(self, group).items():
                if column.values.ndim > 1:
                    found.update(self._items(f"{head}{name}", column))
        return found

    def _ordered(self, names: Mapping[str, Any]) -> list[str]:
        """Return column names in the order that the kind of case defines; unknown names come last, sorted."""
        known = _COLUMNS(self.kind or self.definition.kind)
        return [name for name in known if name in names] + sorted(set(names).difference(known))

    def _items(self, name: str, column: Column) -> Iterator[tuple[str, np.ndarray]]:
        values = column.shown
        for place, item in enumerate(self.names[column.items]):
            if values.ndim == 2:
                yield f"{name}[{item}]", values[:, place]
            else:
                for axis, letter in enumerate(AXES):
                    yield f"{name}[{item}].{letter}", values[:, place, axis]

    def frame(self, groups: Sequence[str] = ("history", "energy")) -> pandas.DataFrame:
        """Return the samples as a table, with units in the column names.

        :param groups: any of ``history``, ``energy``, ``links``, ``contacts``; see :meth:`flat`
        """
        return libraries.frame(self.flat(groups))

    def write_csv(self, path: Path) -> None:
        """Write history and energies as CSV, in full precision."""
        write_columns(self.flat(), path)

    def save(self, path: str | Path) -> Path:
        """Write the run as a result file (HDF5), which :func:`statejump.read` reads; return its path.

        :raises NotWritten: the file cannot be written
        :raises NotAllowed: the file name does not end with ``.h5``
        """
        written: Path = _SAVED(Path(path), self.model, self.definition, {self.model: self})
        return written

    def plot(self, axes: Axes | Sequence[Axes] | None = None) -> Figure:
        """Draw the run.

        :param axes: one or several axes to draw into, for the panels of the figure in order; None: a new figure
        :return: the figure; matplotlib's backend does not change
        """
        return _DRAWN(self.definition, [self], axes)

    def __repr__(self) -> str:
        return f"Run({MODELS.get(self.model, self.model)}, {len(self)} samples, {len(self.events)} events)"

    def _repr_html_(self) -> str:
        html: str = _HTML(self)
        return html


def columns_of(columns: Columns) -> tuple[dict[str, Column], dict[str, Column]]:
    """Divide columns with one value per sample into history and energies, whose names end in ``_J``."""
    plain: dict[str, Column] = {}
    energy: dict[str, Column] = {}
    for name, values in columns.items():
        values = np.asarray(values)
        if values.dtype.kind == "U":
            labels, places = np.unique(values, return_inverse=True)
            plain[name] = Column(places.astype(np.uint8), labels=tuple(labels.tolist()))
            continue
        (energy if name.endswith("_J") else plain)[name] = Column(values.astype(float), unit_of(name))
    return plain, energy


# They differ between runs of the same case, so they are no results.
_OF_THE_DAY = ("wall_time_s", "cpu_time_s")


def numbers_of(values: Mapping[str, Any]) -> dict[str, float]:
    """Return the summary numbers of a run from the data of a model. None becomes NaN. Texts are omitted, and so are
    numbers that differ between repeated runs."""
    return {
        name: float("nan") if value is None else float(value) for name, value in values.items()
        if (value is None or isinstance(value, (int, float))) and name not in _OF_THE_DAY
    }


def change(columns: Mapping[str, Any], name: str) -> float:
    """Return the last value of a column minus its first; 0 if the column is missing."""
    if name not in columns:
        return 0.0
    values = columns[name]
    values = values.values if isinstance(values, Column) else values
    return float(values[-1] - values[0])


def energy_residue_J(
    columns: Mapping[str, Any], supplied: Sequence[str], stored: Sequence[str], dissipated: Sequence[str]
) -> float:
    """Return supplied minus stored minus dissipated energy [J], for the whole run.

    :param columns: energy columns by name; a missing column counts as 0
    :param supplied: names of the columns of supplied energy, such as ``thermal_work_J``; the other parameters likewise
    """
    total = [sum(change(columns, name) for name in names) for names in (supplied, stored, dissipated)]
    return total[0] - total[1] - total[2]


# Two models may find one limit at slightly different loads. This pattern matches a number and its unit.
_AMOUNT = re.compile(r"[-+]?\d\S*( \S+)?")


def warnings_of(runs: Iterable[Run]) -> list[str]:
    """Return the warnings of the runs of a case. Of sentences that differ only in numbers, the first is kept."""
    found: list[str] = []
    for run in runs:
        known = {_AMOUNT.sub("", warning) for warning in found}
        found += [warning for warning in dict.fromkeys(run.warnings) if _AMOUNT.sub("", warning) not in known]
    return found
