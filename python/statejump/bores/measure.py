# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurement of a bore from triangles: radius, roundness, lobes, clearance."""
from __future__ import annotations

from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.interpolate import CubicSpline

from statejump import _engine
from statejump.core import libraries
from statejump.core.errors import NotAllowed, StatejumpError, located
from statejump.core.later import Later
from statejump.core.tables import Shown, html_table, write_csv

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DRAWN, _SAVED = Later("statejump.bores.picture:drawn"), Later("statejump.core.figures:save")
ANGLES = 1024  # samples around a section
SECTIONS = 5  # along the bore
HARMONICS = range(2, 13)
HEADINGS = ("quantity", "value", "unit")
MARGIN = 0.05  # distance of the first and last section from the ends, as a fraction of the length


@dataclass(frozen=True)
class Section:
    """Roundness of the bore in one section, about the least-squares circle of that section."""

    z_m: float  # from the wall's middle
    mean_radius_m: float
    offset_m: tuple[float, float]  # centre of the circle from the axis
    deviation_m: np.ndarray  # radius minus that of the circle, at ANGLES equally spaced angles
    amplitude_m: np.ndarray  # of HARMONICS
    phase_rad: np.ndarray  # angle of the largest radius, for each of HARMONICS, in [0, 2 pi/harmonic)

    @property
    def roundness_error_m(self) -> float:
        """Roundness error [m]: range of the wall's distance from the centre of the least-squares circle (ISO 12181)."""
        return float(np.ptp(self.deviation_m))


def angles_rad() -> np.ndarray:
    """Angles of a section's samples."""
    return 2 * np.pi * np.arange(ANGLES) / ANGLES


def section(mesh: _engine.BoreMesh, z_m: float) -> Section:
    """Measure a section of a bore. :raises StatejumpError: the wall has gaps, or turns back about the centre"""
    radii = mesh.section_radii_m(z_m, ANGLES)
    if not np.all(np.isfinite(radii)):
        missing = float(np.degrees(angles_rad()[int(np.argmin(np.isfinite(radii)))]))
        raise StatejumpError(code="bore_without_wall", z_m=z_m, angle_deg=missing)
    angle = angles_rad()
    points = radii[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))
    centre = np.zeros(2)
    for _ in range(20):  # Gauss-Newton on the distances from the circle
        away = points - centre
        distance = np.linalg.norm(away, axis=1)
        rows = np.column_stack((away / distance[:, None], np.ones(ANGLES)))
        step = np.linalg.lstsq(rows, distance, rcond=None)[0]
        centre = centre + step[:2]
        if np.linalg.norm(step[:2]) < 1e-15 * distance[0]:
            break
    # About the centre of the circle the angles are uneven, so a smooth periodic curve resamples them.
    away = points - centre
    around = np.unwrap(np.arctan2(away[:, 1], away[:, 0]))
    if not (np.all(np.diff(around) > 0) and around[-1] < around[0] + 2 * np.pi):
        raise StatejumpError(code="bore_no_ring", z_m=z_m)
    distance = np.linalg.norm(away, axis=1)
    even = _resample(around, distance, angle)
    mean = float(np.mean(even))
    spectrum = np.fft.rfft(even - mean) / ANGLES * 2
    chosen = spectrum[list(HARMONICS)]
    orders = np.array(HARMONICS)
    phase = np.mod(-np.angle(chosen), 2 * np.pi) / orders
    return Section(z_m, mean, (float(centre[0]), float(centre[1])), even - mean, np.abs(chosen), phase)


def _resample(around: np.ndarray, values: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return values at other angles from a periodic cubic spline."""
    closed_angles = np.append(around, around[0] + 2 * np.pi)
    spline = CubicSpline(closed_angles, np.append(values, values[0]), bc_type="periodic")
    values_there: np.ndarray = spline(around[0] + np.mod(wanted - around[0], 2 * np.pi))
    return values_there


@dataclass(frozen=True)
class Bore:
    """Measurements of a bore.

    :param name: name in tables and figures: the name of the file
    :param mesh: the wall with fitted axis, mean radius and curvatures
    :param sections: roundness in SECTIONS sections along the axis
    :param journal_radius_m: radius of the journal in the bore [m]; None: the bore is measured without a journal
    """

    name: str
    mesh: _engine.BoreMesh
    sections: tuple[Section, ...]
    journal_radius_m: float | None

    @property
    def middle(self) -> Section:
        """The section half-way along the wall."""
        return self.sections[len(self.sections) // 2]

    @property
    def cylindricity_m(self) -> float:
        """Cylindricity [m]: range of the distance of the wall from the least-squares cylinder, over all sections."""
        radii = np.concatenate([self.mesh.section_radii_m(s.z_m, ANGLES) for s in self.sections])
        return float(np.ptp(radii))

    @property
    def smallest_radius_m(self) -> float:
        """Of all sections about the fitted axis."""
        return min(float(np.min(self.mesh.section_radii_m(s.z_m, ANGLES))) for s in self.sections)

    @property
    def dominating_harmonic(self) -> int | None:
        """Number of waves of the harmonic with the largest amplitude in the middle section; None if the amplitude is
        smaller than the error of the mesh."""
        largest = int(np.argmax(self.middle.amplitude_m))
        if self.middle.amplitude_m[largest] <= self.mesh.reconstruction_error_m:
            return None
        return HARMONICS[largest]

    @property
    def clearance_m(self) -> float | None:
        """Radial clearance [m]: least-squares radius of the bore minus journal radius; None without a journal."""
        return None if self.journal_radius_m is None else self.mesh.mean_radius_m - self.journal_radius_m

    @property
    def smallest_clearance_m(self) -> float | None:
        """Smallest radial clearance [m] of a journal centred on the axis of the bore; None without a journal."""
        return None if self.journal_radius_m is None else self.smallest_radius_m - self.journal_radius_m

    def frame(self) -> pandas.DataFrame:
        """Return one row per section, from one end of the bore to the other. Columns, with units in their names: axial
        position from the middle, radius and centre of the least-squares circle, roundness error, and the amplitude and
        the angle of the largest radius of every harmonic."""
        rows = []
        for each in self.sections:
            row = {"z_m": each.z_m, "mean_radius_m": each.mean_radius_m, "offset_x_m": each.offset_m[0],
                   "offset_y_m": each.offset_m[1], "roundness_error_m": each.roundness_error_m}
            for order, amplitude, phase in zip(HARMONICS, each.amplitude_m, each.phase_rad):
                row |= {f"harmonic_{order}_amplitude_m": float(amplitude), f"harmonic_{order}_phase_rad": float(phase)}
            rows.append(row)
        return libraries.frame(rows)

    def plot(self, axes: tuple[Axes, Axes] | None = None) -> Figure:
        """Draw sections with magnified deviations, and the harmonics of the middle section.

        :param axes: axes to draw into, for the sections and for the harmonics; None: a new figure
        :return: the figure; matplotlib's backend does not change
        """
        return _DRAWN(self, axes)

    def summary_lines(self) -> list[Shown | str]:
        """Return what a command prints of it."""
        return [Shown(f"bore {self.name}", HEADINGS, self._rows(), left=("quantity", "unit"))]

    def _rows(self) -> list[tuple[str, str, str]]:
        """Return quantity, value and unit of every measurement."""
        mesh, middle = self.mesh, self.middle
        axis = ", ".join(f"{round(value, 6) + 0.0:.6f}" for value in mesh.axis)
        centre = ", ".join(f"{value:.6g}" for value in mesh.centre_m)
        dominating = self.dominating_harmonic
        table = [
            ("faces", f"{mesh.face_count}", ""),
            ("faces of the wall", f"{mesh.wall_face_count}", ""),
            ("vertices", f"{mesh.vertex_count}", ""),
            ("body", "closed ring" if mesh.closed else "open tube", ""),
            ("mean radius (least squares)", f"{mesh.mean_radius_m:.9g}", "m"),
            ("length of the wall", f"{mesh.length_m:.6g}", "m"),
            ("axis", axis, ""),
            ("middle of the axis", centre, "m"),
            ("smallest curvature (concave negative)", f"{mesh.smallest_curvature_per_m:.6g}", "1/m"),
            ("largest curvature", f"{mesh.largest_curvature_per_m:.6g}", "1/m"),
            ("estimated error of the smooth wall", f"{mesh.reconstruction_error_m:.3g}", "m"),
            ("cylindricity, peak to valley", f"{self.cylindricity_m:.6g}", "m"),
            ("lobes that dominate", "none" if dominating is None else f"{dominating}", "per turn"),
        ]
        if mesh.removed_face_count:
            table.insert(1, ("faces left out, which have no area", f"{mesh.removed_face_count}", ""))
        for each in self.sections:
            table.append((f"roundness at z = {each.z_m:.4g} m, peak to valley", f"{each.roundness_error_m:.6g}", "m"))
        for order, amplitude, phase in zip(HARMONICS, middle.amplitude_m, middle.phase_rad):
            table.append((f"harmonic {order}, middle section: amplitude", f"{amplitude:.6g}", "m"))
            table.append((f"harmonic {order}, middle section: phase", f"{np.degrees(phase):.3f}", "deg"))
        if self.journal_radius_m is not None:
            table.append(("journal radius", f"{self.journal_radius_m:.9g}", "m"))
            table.append(("radial clearance, least squares", f"{self.clearance_m:.6g}", "m"))
            table.append(("radial clearance, smallest, journal on the axis", f"{self.smallest_clearance_m:.6g}", "m"))
        return table

    def write(self, folder: Path) -> list[Path]:
        """Write ``bore.csv`` and the picture into a folder; return the paths."""
        return [write_csv(folder / "bore.csv", HEADINGS, self._rows()), *_SAVED(_DRAWN(self), folder, "roundness")]

    def __repr__(self) -> str:
        return f"Bore({self.name!r}, mean radius {self.mesh.mean_radius_m:.6g} m, {self.mesh.face_count:,} faces)"

    def _repr_html_(self) -> str:
        return f"<h4>bore {escape(self.name)}</h4>{html_table(HEADINGS, self._rows())}"


# Remedy for each kind of failure: text at the end of the message, and the setting that it names.
CURES = {"inside_out": ("; {} turns it", "flip=True"), "too_large": (" Then use {}", "unit_m=0.001")}


class NoBore(StatejumpError):
    """A file or its mesh is not a bore that can be measured.

    :param what: the reason
    :param fault: the kind of failure
    """

    def __init__(self, what: str = "", *, fault: str = "", **more: Any) -> None:
        super().__init__(what, remedy=CURES[fault][1] if fault in CURES else None, **more)
        self.fault = fault

    def __str__(self) -> str:
        said = f"{self.file}: {self.what}" if self.file else self.what
        return said + CURES[self.fault][0].format(self.remedy) if self.remedy else said


def load(file: Path, unit_m: float = 1.0, flip: bool = False) -> _engine.BoreMesh:
    """Read the wall of a bore from a mesh file.

    :param unit_m: length of one unit of the file [m]
    :param flip: whether to reverse every face
    :raises NoBore: the file is not a bore
    """
    try:
        return _engine.BoreMesh.read(str(file), scale=unit_m, flip=flip)
    except _engine.EngineFailure as failure:
        what = str(failure)
        if failure.file:
            assert failure.cause is not None  # the engine always gives a cause for a fault of the file
            what = failure.cause
        reason = {} if failure.reason is None else {"reason": failure.reason, **failure.details}
        raise NoBore(
            what, code=f"bore_{failure.kind}", fault=failure.kind, file=failure.file or None, **reason
        ) from None


def check_journal(key: str, radius_m: float | None) -> None:
    """Raise NotAllowed if the radius of a journal is invalid; None (no journal) is valid."""
    if radius_m is not None and not 0 < radius_m < float("inf"):
        raise NotAllowed(key, radius_m, code="not_positive", unit="m")


def measure(mesh: _engine.BoreMesh, name: str, journal_radius_m: float | None = None) -> Bore:
    """Measure a bore in SECTIONS sections.

    :raises NotAllowed: the radius of the journal is invalid
    :raises NoBore: the wall has gaps, or its radius differs too much from that of the journal
    """
    check_journal("journal_radius_m", journal_radius_m)
    if journal_radius_m is not None:
        ratio = mesh.mean_radius_m / journal_radius_m
        if not 0.1 < ratio < 10:
            raise NoBore(code="bore_in_millimetres", fault="too_large", file=name, mean_radius_m=mesh.mean_radius_m,
                         ratio=ratio, journal_radius_m=journal_radius_m)
        if ratio <= 1:
            raise NotAllowed("journal_radius_m", journal_radius_m, code="journal_too_large", file=name,
                             mean_radius_m=mesh.mean_radius_m)
    half = (0.5 - MARGIN) * mesh.length_m
    sections = tuple(section(mesh, float(z)) for z in np.linspace(-half, half, SECTIONS))
    return Bore(name, mesh, sections, journal_radius_m)


def bore(
    path: str | Path, *, unit_m: float = 1.0, journal_radius_m: float | None = None, flip: bool = False
) -> Bore:
    """Measure the roundness and the lobes of a bore, and its clearance to a journal.

    :param path: OFF, STL, PLY or OBJ file of its wall
    :param unit_m: length of one unit of the file [m]: 0.001 for millimetres
    :param journal_radius_m: radius of the journal in the bore [m]
    :param flip: whether to reverse every face, for a file whose normals point into the material
    :raises StatejumpError: the file is not a bore; the message states reason and position
    """
    mesh = load(Path(path), unit_m, flip)
    with located(file=path):
        return measure(mesh, str(path), journal_radius_m)
