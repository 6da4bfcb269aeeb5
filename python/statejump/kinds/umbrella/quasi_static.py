# SPDX-License-Identifier: GPL-3.0-or-later
"""The quasi-static path of a loaded rib, which its motion approaches under infinitely slow heating."""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from statejump import _engine, laws
from statejump.core import libraries
from statejump.core.engine_failures import engine
from statejump.core.errors import NotAllowed
from statejump.core.tables import Shown, write_columns, write_rows
from statejump.core.units import plain, unit_of
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.kinds.umbrella.reduced import linkage

if TYPE_CHECKING:
    import pandas

RIGID, ELASTIC = "rigid", "elastic"
SAMPLES = 400  # of a branch of the temperature
JUMPS = ("theta2_jump_rad", "theta4_jump_rad")


@dataclass(frozen=True)
class QuasiStatic:
    """Quasi-static paths of a loaded rib.

    :param case: name of the case
    :param notes: notes on the temperature program
    :param has_jump: whether the program returns to the reference temperature
    :param paths: paths by type of links. The path ``rigid`` has rigid links, rigid contact and Coulomb friction. The
        path ``elastic`` has Hertz contact and the compliance of the friction law; it exists if the laws of the case
        permit it
    """

    case: str
    paths: dict[str, Any]
    notes: tuple[str, ...] = ()
    has_jump: bool = True

    def _path(self, links: str) -> Any:
        if links not in self.paths:
            raise NotAllowed("links", links, code="unknown_name", allowed=tuple(self.paths),
                             known=" or ".join(map(repr, self.paths)))
        return self.paths[links]

    def frame(self, links: str = RIGID) -> pandas.DataFrame:
        """Return the samples of the path with the given type of links, with units in the column names.

        :raises NotAllowed: there is no such path
        """
        return libraries.frame(self._path(links).columns())

    def events(self, links: str = RIGID) -> pandas.DataFrame:
        """Return one row per transition to rolling or to slip. :raises NotAllowed: there is no such path"""
        return libraries.frame(self._path(links).events)

    @property
    def summary(self) -> dict[str, float]:
        """Jumps of both angles on every path. A jump is NaN if the program does not return to ΔT = 0, or if the contact
        opens on the path, because then the position of the journal is undetermined."""
        return {f"{key.removesuffix('_rad')}_{links}_rad":
                float(getattr(path, key)) if self.has_jump and not path.separated else float("nan")
                for links, path in self.paths.items() for key in JUMPS}

    @property
    def warnings(self) -> list[str]:
        """Warnings about the paths, one sentence each."""
        lost = [f"the contact is lost on the path with {links} links: the place in the play is undetermined from there"
                for links, path in self.paths.items() if path.separated]
        lost = [*self.notes, *lost]
        return lost if ELASTIC in self.paths else [*lost, "the laws of the case have no path with elastic links"]

    def summary_lines(self) -> list[Shown | str]:
        """Return what the command prints."""
        jumps = [(name, plain(value, unit_of(name))) for name, value in self.summary.items()]
        events = [(links, str(event["motion"]), f"{event['temperature_change_K']:.6g}", f"{event['theta2_rad']:.9g}",
                   f"{event['contact_angle_rad']:.6g}")
                  for links, path in self.paths.items() for event in path.events]
        return [Shown("jumps over all cycles", ("quantity", "value"), jumps, left=("quantity",)),
                Shown("where the joint begins to roll or to slip",
                      ("links", "motion", "temperature change [K]", "theta2 [rad]", "contact angle [rad]"), events,
                      left=("links", "motion"))]

    def write(self, folder: Path) -> list[Path]:
        """Write the samples and events of every path into a folder; return the paths of the files."""
        written = []
        for links, path in self.paths.items():
            target = folder / f"quasi_static_{links}.csv"
            write_columns(path.columns(), target)
            written += [target, write_rows(folder / f"quasi_static_{links}_events.csv", path.events)]
        return written


def has_elastic_loop(case: UmbrellaCase) -> bool:
    """Return whether the contact laws of a case permit the path with elastic links."""
    velocity = laws.law("tangential_velocity", case.joint.tangential_velocity)
    return laws.law("normal", case.joint.normal_law).point_contact and not velocity.needs_axis


def quasi_static(case: UmbrellaCase) -> QuasiStatic:
    """Return the quasi-static paths of a rib whose torsion spring loads the joint.

    :raises FailedRun: the joint is unloaded at the start, or a contact law was used outside its range
    """
    angle, program = case.start.contact_angle_rad, case.thermal_program()
    with engine("the quasi-static path failed", case=case.name):
        model = linkage(case)
        paths: dict[str, Any] = {RIGID: _engine.joint_loop(model, program, angle, SAMPLES)}
        if has_elastic_loop(case):
            compliance = "mindlin" if laws.law("friction", case.joint.friction_law).has_memory else "rigid"
            paths[ELASTIC] = _engine.elastic_loop(model, program, angle, SAMPLES, compliance)
    return QuasiStatic(case.name, paths, case.thermal_notes, case.has_jump)
