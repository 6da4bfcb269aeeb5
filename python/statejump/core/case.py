# SPDX-License-Identifier: GPL-3.0-or-later
"""A case: its methods, and the header and the temperature program that all kinds of cases share."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from statejump.core import thermal as programs
from statejump.core.errors import NotAllowed, StatejumpError
from statejump.core.later import Later
from statejump.core.thermal import CaseThermal, Ending, Numbers
from statejump.schema.fields import CHOICE, Section, definition, evolved, fields_of, section, text
from statejump.schema.item_tables import with_rows
from statejump.schema.paths import set_value, value_of
from statejump.schema.rules import FOLDER_NAME

if TYPE_CHECKING:
    from statejump import _engine
    from statejump.core.run import Run
    from statejump.core.temperature_files import Histories
    from statejump.core.thermal import MemberProgram, Thermal

__all__ = ["CHOICE", "Case", "CaseHeader", "Origin", "Progress"]

Progress = bool | Callable[[float], None]
# Names of sections of a kind that are methods of all cases; the attribute is called NAME_settings.
_METHODS = ("reduced", "dem")
_PARSED, _KIND = Later("statejump.kinds.loading:parse_case"), Later("statejump.kinds:of")
_TEXT, _SAVED = Later("statejump.core.case_files:text_of"), Later("statejump.core.case_files:save")
_HTML = Later("statejump.core.html:case_html")
_RUN, _PATHS, _CHECKED = (Later(f"statejump.kinds.running:{name}") for name in ("run", "quasi_static", "check_dem"))


@definition
class CaseHeader(Section):
    """Name, kind, title and source of a case."""

    name: str = text(..., "name of the results folder", pattern=FOLDER_NAME)
    kind: str = text(..., "which experiment")
    title: str = text("", "one line for figures")
    source: str = text("", "where the numbers come from")


@dataclass(frozen=True)
class Origin:
    """The data and the file from which a case was made.

    :param data: sections and keys as the user gave them, without defaults
    :param file: the case file; None: it was made in Python
    :param text: text of the file; "" without a file
    """

    data: Mapping[str, Any]
    file: Path | None = None
    text: str = ""

    @property
    def document(self) -> dict[str, Any]:
        """Sections and keys of a case file that contains all items itself, without tables in other files."""
        return with_rows(self.data)

    @property
    def folder(self) -> Path:
        """The folder to which paths in the case are relative."""
        return Path() if self.file is None else self.file.parent


@definition
class Case(Section):
    """A case in SI units, checked as a whole and immutable.

    :func:`statejump.load` makes it.

    Each kind has its own class with its own sections. They are attributes, ``case.joint.friction_coefficient``;
    ``case["dem.threads"]`` returns the value of any key. The sections ``[reduced]`` and ``[dem]`` are the attributes
    ``case.reduced_settings`` and ``case.dem_settings``, because ``case.reduced`` and ``case.dem`` run the models.
    """

    NAMED: ClassVar[bool] = True
    KIND: ClassVar[str]
    # Sections that a file of this kind may not have, and why.
    NOT_IN_FILE: ClassVar[Mapping[str, str]] = {}

    case: CaseHeader = section(CaseHeader, required=True)
    thermal: CaseThermal = section(CaseThermal, required=True)

    if TYPE_CHECKING:
        # Attributes are the sections of the kind. This declaration is for type checkers, because ``statejump.load``
        # returns a case of any kind.
        def __getattr__(self, name: str) -> Any: ...

    def __init_subclass__(cls) -> None:
        for name in _METHODS:
            if name in vars(cls).get("__annotations__", {}):
                raise TypeError(f"{cls.__name__}.{name}: a case has a method of that name; call the attribute "
                                f"{name}_settings and declare it with section(..., name={name!r})")

    def __attrs_post_init__(self) -> None:
        # The default of the period is filled in here, so that every reader finds a number.
        thermal = self.thermal
        ending = programs.ending(self._given_programs(), thermal.return_to_reference, thermal.period_s)
        return_s = ending.return_s if ending is not None else 0.0
        lasts = programs.period_of(thermal, thermal.period_s, "thermal.period_s", return_s=return_s)
        object.__setattr__(self, "thermal", evolved(thermal, period_s=lasts))
        object.__setattr__(self, "_ending", ending)

    def __getstate__(self) -> dict[str, Any]:
        fields = (attribute.name for attribute in fields_of(type(self)).values())
        kept = {*fields, "_ending", "_origin"}  # other attributes are derived, some of them by the engine
        return {name: value for name, value in vars(self).items() if name in kept}

    def _given_programs(self) -> Sequence[Thermal | MemberProgram]:
        """Return the temperature programs as given, the common one first."""
        return [self.thermal]

    @property
    def member_histories(self) -> Histories | None:
        """Temperature histories of members, for kinds that support them."""
        return None

    @property
    def ending(self) -> Ending | None:
        """The last row of a temperature program that ends at another than the reference temperature; otherwise None."""
        found: Ending | None = self.__dict__["_ending"]
        return found

    @property
    def has_jump(self) -> bool:
        """Whether the temperature program, including an added return, ends at the reference temperature."""
        return self.ending is None or self.ending.returns

    def check_cycles(self) -> None:
        """Raise NotAllowed for cycles that do not end where they begin."""
        if not self.has_jump and self.thermal.cycles > 1:
            raise NotAllowed("thermal.cycles", self.thermal.cycles, code="program_not_periodic",
                             why=self.thermal_notes[0])

    @property
    def thermal_notes(self) -> tuple[str, ...]:
        """A note if the temperature program does not end at the reference temperature; otherwise empty."""
        return () if self.ending is None else (self.ending.note,)

    @property
    def implausible(self) -> tuple[str, ...]:
        """Warnings about values that are allowed but implausible, one sentence each."""
        return ()

    def need_jump(self, what: str) -> None:
        """Raise StatejumpError if a function needs a state jump, but the program does not return to ΔT = 0."""
        if self.ending is not None and not self.ending.returns:
            raise StatejumpError(code="state_jump_undefined", case=self.name, remedy=self.ending.remedy, output=what,
                                 why=self.ending.where)

    @property
    def origin(self) -> Origin:
        """Where the case comes from."""
        found: Origin | None = self.__dict__.get("_origin")
        if found is not None:
            return found
        return Origin(self.to_dict())

    def with_defaults(self) -> dict[str, Any]:
        """Return all sections and keys with their defaults, including sections that files cannot contain."""
        return super().to_dict()

    def to_dict(self) -> dict[str, Any]:
        """Return sections and keys with all defaults, as a dict for :func:`statejump.load`. Absent sections and empty
        lists are omitted."""
        return {name: part for name, part in self.with_defaults().items()
                if name not in self.NOT_IN_FILE and part is not None and part != []}

    def to_toml(self) -> str:
        """Return the case as the text of a case file, with the keys that were given, without defaults.

        :raises NotAllowed: the case has temperature histories of members, which need a file of their own
        """
        text: str = _TEXT(self)
        return text

    def save(self, path: str | Path) -> Path:
        """Write the case as a case file, and temperature histories of members as a table beside it; return its path.

        :raises NotWritten: a file cannot be written
        :raises NotAllowed: the name of the file does not end with ``.toml``
        """
        written: Path = _SAVED(self, Path(path))
        return written

    def reduced(self, progress: Progress = False, *, dynamic: bool = False,
                trace: str | Path | Callable[[tuple[Any, ...]], object] | None = None) -> Run:
        """Run the reduced model.

        :param progress: True: show it on standard error; or a function that receives the finished fraction, 0 to 1
        :param dynamic: whether to include inertia, for a kind whose reduced model has none by default (trusses)
        :param trace: CSV file with a row for every Newton iteration of a truss, or a function that is called with each
            row as a tuple; :data:`statejump.kinds.truss.trace.COLUMNS` names its entries
        :raises StatejumpError: the kind does not have the requested reduced model, or the run could not be finished
        """
        run: Run = _RUN(self, "dynamic" if dynamic else "reduced", progress, trace=trace)
        return run

    def quasi_static(self) -> Any:
        """Return the paths under infinitely slow heating, for a kind whose reduced model has inertia: a loaded rib with
        rigid links and, if its contact laws permit it, with elastic links.

        :raises StatejumpError: the kind has no such paths, or nothing loads the joint at the start
        """
        return _PATHS(self)

    def dem(self, progress: Progress = False, *, keep_input: str | Path | None = None) -> Run:
        """Run the case in YADE, in a separate process.

        :param progress: True: show it on standard error; or a function that receives the finished fraction, 0 to 1
        :param keep_input: folder for the script and the data of the run, to repeat it by hand
        :raises StatejumpError: the kind has no DEM, or YADE is missing or failed
        :raises Interrupted: Ctrl-C was pressed; ``run`` of the error has the samples so far
        """
        self.check_dem()
        run: Run = _RUN(self, "dem", progress, keep_input=keep_input)
        return run

    def check_dem(self) -> None:
        """Check the requirements of :meth:`dem` before anything is solved.

        :raises StatejumpError: the kind has no DEM, the DEM cannot represent an item, or YADE is missing
        """
        _CHECKED(self)

    def with_origin(self, origin: Origin) -> Case:
        """Set the origin of the case, and return the case itself."""
        object.__setattr__(self, "_origin", origin)
        return self

    @property
    def name(self) -> str:
        """Name of the case and of its results folder."""
        return self.case.name

    @property
    def kind(self) -> str:
        """Which experiment, the key of :data:`statejump.kinds.KINDS`."""
        return self.KIND

    @property
    def title(self) -> str:
        """One line for figures and tables."""
        return self.case.title or self.case.name

    @property
    def period_s(self) -> float:
        """Length of one cycle [s]."""
        return self.thermal.period_s

    @property
    def samples_per_cycle(self) -> int:
        """Samples per cycle of both models."""
        raise NotImplementedError

    @property
    def duration_s(self) -> float:
        """Length of all cycles [s]."""
        return self.period_s * self.thermal.cycles

    @property
    def temperature_range_K(self) -> tuple[float, float]:
        """Smallest and largest ΔT [K] of the program."""
        return programs.range_K(self.thermal)

    def thermal_program(self) -> _engine.ThermalProgram:
        """Return the temperature program as the engine's."""
        return programs.program(self.thermal, self.period_s)

    def returns_s(self) -> Numbers:
        """Return the times [s] at which the temperatures of all items have their initial values again."""
        return programs.returns_s([self.thermal], self.period_s)

    def check(self) -> None:
        """Raise StatejumpError for a contradiction between several keys."""

    def changed(self, changes: Mapping[str, Any]) -> Case:
        """Return a copy of the case with other values, checked as a whole.

        :param changes: values by key: ``section.key`` as in the case file, ``section.item.key`` for an item of a list,
            ``section.*.key`` for all items, ``section.joint*.key`` for matching items. None restores the default
        :raises StatejumpError: a key does not exist, or the new case is not allowed
        """
        origin, data = self.origin, deepcopy(self.origin.document)
        for path, value in changes.items():
            set_value(type(self), data, path, value)
        made: Case = _PARSED(data, file=origin.file, text="", files_from=origin.folder)
        return made

    def __getitem__(self, path: str) -> Any:
        """Return the value of ``section.key``, or of ``section.item.key`` for an item of a list.

        :raises StatejumpError: the key or the item does not exist
        """
        return value_of(self, path)

    @property
    def behaviour(self) -> Any:
        """The object of its kind, see :class:`statejump.Kind`."""
        return _KIND(self)

    @property
    def definition(self) -> Case:
        """The case itself, for scripts of earlier versions."""
        return self

    def __dir__(self) -> list[str]:
        model = type(self)
        return sorted({*super().__dir__(), *fields_of(model)}.difference(model.NOT_IN_FILE))

    def __hash__(self) -> int:
        return hash((self.kind, self.name))

    def __repr__(self) -> str:
        return f"Case({self.name!r}, {self.kind})"

    def _repr_html_(self) -> str:
        html: str = _HTML(self)
        return html


def no_length_left(key: str, thermal_expansion_per_K: float, case: Case) -> None:
    """Raise NotAllowed if the temperature program reduces the length of a link to zero."""
    for change in case.temperature_range_K:
        if 1 + thermal_expansion_per_K * change <= 0:
            raise NotAllowed(key, thermal_expansion_per_K, code="link_without_length", at_K=change)


def check_radii(bearing_radius_m: float, journal_radius_m: float) -> bool:
    """Whether a journal fits into its bearing."""
    return bearing_radius_m > journal_radius_m
