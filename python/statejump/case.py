# SPDX-License-Identifier: GPL-3.0-or-later
"""A case as one holds it in Python: the same class for every kind."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from statejump.core.case import Case as Definition
from statejump.schema.fields import fields_of

if TYPE_CHECKING:
    from statejump.core.run import Run
    from statejump.kinds.umbrella.quasi_static import QuasiStatic

Progress = bool | Callable[[float], None]


class Case:
    """A case, checked as a whole and immutable, and what one can do with it. :func:`statejump.load` makes it.

    Its sections are attributes, ``case.joint.friction_coefficient``; ``case["dem.threads"]`` reaches every key, also
    those of the sections ``[reduced]`` and ``[dem]``, whose names are those of the models here.

    :param definition: what the case file says, with all defaults
    """

    def __init__(self, definition: Definition) -> None:
        self.definition = definition

    @property
    def name(self) -> str:
        """Name of the case and of its results folder."""
        return self.definition.name

    @property
    def kind(self) -> str:
        """Which experiment, one of :func:`statejump.kinds.names`."""
        return self.definition.kind

    @property
    def title(self) -> str:
        """One line for figures and tables."""
        return self.definition.title

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "definition":
            raise AttributeError(name)
        return getattr(self.definition, name)

    def __dir__(self) -> list[str]:
        model = type(self.definition)
        return sorted({*super().__dir__(), *fields_of(model)}.difference(model.NOT_IN_FILE))

    def __getitem__(self, path: str) -> Any:
        """Return the value of ``section.key``, or of ``section.item.key`` of an item of a list.

        :raises StatejumpError: there is no such key or item
        """
        return self.definition[path]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and self.definition == other.definition

    def __hash__(self) -> int:
        return hash((self.kind, self.name))

    def to_dict(self) -> dict[str, Any]:
        """Return sections and keys with all defaults, as a dict that :func:`statejump.load` takes."""
        return self.definition.as_file()

    def to_toml(self) -> str:
        """Return the case as the text of a case file, with the keys that were given and without defaults.

        :raises NotAllowed: it holds the histories of members, which stand in a file of their own
        """
        from statejump.core.case_files import text_of

        return text_of(self.definition)

    def save(self, path: str | Path) -> Path:
        """Write the case as a case file, histories of members as a table beside it; return its path.

        :raises NotWritten: it cannot be written
        :raises NotAllowed: the name does not end with ``.toml``
        """
        from statejump.core.case_files import save

        return save(self.definition, Path(path))

    def changed(self, changes: Mapping[str, Any]) -> Case:
        """Return the case with other values, checked as a whole.

        :param changes: value by key: ``section.key`` as in the case file, ``section.item.key`` of an item of a
            list, ``section.*.key`` of all of them, ``section.joint*.key`` of those that fit; None takes a key away, so
            that its default holds
        :raises StatejumpError: there is no such key, or the case is not allowed with these values
        """
        return Case(self.definition.changed(changes))

    def reduced(self, progress: Progress = False, *, dynamic: bool = False) -> Run:
        """Run the reduced model.

        :param progress: True: show it on standard error; or what is called with the finished share, 0 to 1
        :param dynamic: with inertia, where the reduced model has none without being asked: the motion of a truss
        :raises StatejumpError: the kind has no such reduced model, or the run could not be finished
        """
        return self._run("dynamic" if dynamic else "reduced", "reduced model", progress)

    def quasi_static(self) -> QuasiStatic:
        """Return the paths of infinitely slow heating, of a case whose reduced model has inertia: a loaded rib, with
        rigid and, where its laws allow, elastic links.

        :raises StatejumpError: the kind has no such paths, or nothing loads the joint at the start
        """
        found: QuasiStatic = self.definition.behaviour.ability("quasi_static", self.definition)(self.definition)
        return found

    def dem(self, progress: Progress = False) -> Run:
        """Run the case in YADE, in a process of its own.

        :param progress: True: show it on standard error; or what is called with the finished share, 0 to 1
        :raises StatejumpError: the kind has no DEM, YADE is missing or failed
        :raises Interrupted: Ctrl-C; its ``run`` has the samples so far
        """
        self.check_dem()
        return self._run("dem", "DEM", progress)

    def check_dem(self) -> None:
        """Check what :meth:`dem` needs, as far as it is known before anything is solved.

        :raises StatejumpError: the kind has no DEM, the DEM cannot represent a part, or YADE is missing
        """
        self.definition.behaviour.ability("dem_input", self.definition)
        self.definition.behaviour.check_dem(self.definition)

    def _run(self, ability: str, label: str, progress: Progress) -> Run:
        from statejump.core.limits import check_memory
        from statejump.core.progress import shown

        model = self.definition.behaviour.ability(ability, self.definition)
        check_memory(self.definition, "dem" if ability == "dem" else "reduced")
        with shown(progress, label) as tell:
            run: Run = model(self.definition, tell)
        return run

    def __repr__(self) -> str:
        return f"Case({self.name!r}, {self.kind})"

    def _repr_html_(self) -> str:
        from statejump.core.html import case_html

        return case_html(self.definition)
