# SPDX-License-Identifier: GPL-3.0-or-later
"""Capabilities of kinds for design questions; see :mod:`statejump.kinds.protocol`."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from statejump.control.study import Study
from statejump.core.progress import OnProgress
from statejump.core.tables import Shown
from statejump.kinds.protocol import capability

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@capability("control")
class ControlStudy(Protocol):
    """A study of how to reduce the state jump. Each kind of case defines its settings."""

    def control(self, case: Any, **settings: Any) -> Study: ...


class RestSets(Protocol):
    """Rest positions of a joint; each kind has its own class."""

    def frame(self) -> pandas.DataFrame:
        """Return the rest sets as a table, with units in the column names."""

    def plot(self, axes: Axes | None = None) -> Figure:
        """Draw the rest sets into the given axes, or into a new figure."""

    def summary_lines(self) -> list[Shown | str]:
        """Return the tables and lines that a command prints."""

    def write(self, folder: Path) -> list[Path]:
        """Write the rest sets and their picture into a folder; return the paths of the files."""


@capability("statics")
class JointStatics(Protocol):
    """Where friction holds the joint."""

    def statics(self, case: Any, friction_coefficient: float | None = None) -> RestSets: ...


@capability("truss answers")
class DesignAnswers(Protocol):
    """Design questions of a truss; see :func:`statejump.truss.answers`."""

    def answers(self, case: Any, **settings: Any) -> Any: ...


@capability("modes")
class VibrationModes(Protocol):
    """Natural frequencies and mode shapes; see :class:`statejump.kinds.truss.modes.Modes`."""

    def modes(self, case: Any, count: int = 6) -> Any: ...


@capability("bounds")
class RestBounds(Protocol):
    """Bounds of the state jump over any temperature history; see :func:`statejump.kinds.truss.bounds.study.bounds`."""

    def bounds(self, case: Any, output: Sequence[str] = (), range_K: str | tuple[float, float] | None = None,
               attain: bool = False, simulate: bool | None = None) -> Any: ...


@capability("worst")
class WorstCases(Protocol):
    """Search for worst temperature histories; see :func:`statejump.kinds.truss.worst.study.worst`."""

    def worst(self, case: Any, range_K: str | tuple[float, float], **settings: Any) -> Any: ...


@capability("design")
class TrussDesign(Protocol):
    """Design of least cost under requirements; see :func:`statejump.design.study.design`."""

    def design(self, case: Any, wanted: str | Path | Mapping[str, Any], on_progress: OnProgress) -> Any: ...


@capability("truss creak")
class Creaking(Protocol):
    """Slips of the joints of a truss in motion, and the acceleration of a node; see :func:`statejump.truss.creak`."""

    def creak(self, case: Any, node: str, on_progress: OnProgress) -> Any: ...
