# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bore given by triangles is: radius, roundness, lobes, clearance; its picture."""
from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

import click
import numpy as np
from rich.table import Table
from scipy.interpolate import CubicSpline

from statejump import _engine
from statejump.kinds.spring_slider import figure as plot
from statejump.core.errors import StatejumpError
from statejump.core.output import results_folder, write_atomically
from statejump.kinds.spring_slider.figure import plt
from statejump.cli.terminal import QUIET, RESULTS, make_console

ANGLES = 1024  # samples around a section
SECTIONS = 5  # along the bore
HARMONICS = range(2, 13)
MARGIN = 0.05  # of the length that the end sections stay away from the ends


@dataclass(frozen=True)
class Section:
    """Roundness of the bore at one place along its axis, about its own circle of least squares."""

    z_m: float  # from the wall's middle
    mean_radius_m: float
    offset_m: tuple[float, float]  # centre of the circle from the axis
    deviation_m: np.ndarray  # of the radius from the circle, at ANGLES equal angles
    amplitude_m: np.ndarray  # of HARMONICS
    phase_rad: np.ndarray  # of HARMONICS: the angle of largest radius, in [0, 2 pi/harmonic)

    @property
    def roundness_error_m(self) -> float:
        """Peak to valley of the radius about the circle of least squares (ISO 12181)."""
        return float(np.ptp(self.deviation_m))


def angles_rad() -> np.ndarray:
    """Angles of a section's samples."""
    return 2 * np.pi * np.arange(ANGLES) / ANGLES


def section(mesh: _engine.BoreMesh, z_m: float) -> Section:
    """Measure a section; StatejumpError where the wall has gaps."""
    radii = mesh.section_radii_m(z_m, ANGLES)
    if not np.all(np.isfinite(radii)):
        missing = float(np.degrees(angles_rad()[int(np.argmin(np.isfinite(radii)))]))
        raise StatejumpError(
            f"the bore's section at {z_m:.6g} m from its middle has no wall at {missing:.1f} degrees"
        )
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
    # About the circle's centre the same samples lie at uneven angles: resampled along the wave,
    # which is smooth and periodic.
    away = points - centre
    around = np.unwrap(np.arctan2(away[:, 1], away[:, 0]))
    distance = np.linalg.norm(away, axis=1)
    even = _resample(around, distance, angle)
    mean = float(np.mean(even))
    spectrum = np.fft.rfft(even - mean) / ANGLES * 2
    chosen = spectrum[list(HARMONICS)]
    orders = np.array(HARMONICS)
    phase = np.mod(-np.angle(chosen), 2 * np.pi) / orders
    return Section(z_m, mean, (float(centre[0]), float(centre[1])), even - mean, np.abs(chosen), phase)


def _resample(around: np.ndarray, values: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Values at other angles, by a periodic cubic spline."""
    closed_angles = np.append(around, around[0] + 2 * np.pi)
    spline = CubicSpline(closed_angles, np.append(values, values[0]), bc_type="periodic")
    return spline(around[0] + np.mod(wanted - around[0], 2 * np.pi))


@dataclass(frozen=True)
class Report:
    """What is known of a bore."""

    name: str
    mesh: _engine.BoreMesh
    sections: tuple[Section, ...]
    journal_radius_m: Optional[float]

    @property
    def middle(self) -> Section:
        return self.sections[len(self.sections) // 2]

    @property
    def cylindricity_m(self) -> float:
        """Peak to valley of the radius about the cylinder of least squares, over all sections."""
        radii = np.concatenate([self.mesh.section_radii_m(s.z_m, ANGLES) for s in self.sections])
        return float(np.ptp(radii))

    @property
    def smallest_radius_m(self) -> float:
        """Of all sections about the fitted axis."""
        return min(float(np.min(self.mesh.section_radii_m(s.z_m, ANGLES))) for s in self.sections)

    @property
    def dominating_harmonic(self) -> Optional[int]:
        """Waves per turn of the largest lobes of the middle section; None below the mesh's error."""
        largest = int(np.argmax(self.middle.amplitude_m))
        if self.middle.amplitude_m[largest] <= self.mesh.reconstruction_error_m:
            return None
        return HARMONICS[largest]


def measure(mesh: _engine.BoreMesh, name: str, journal_radius_m: Optional[float] = None) -> Report:
    """Measure a bore at SECTIONS places."""
    if journal_radius_m is not None and not 0 < journal_radius_m < float("inf"):
        raise StatejumpError(f"journal radius = {journal_radius_m:.9g}, allowed is (0, inf) m")
    half = (0.5 - MARGIN) * mesh.length_m
    sections = tuple(section(mesh, float(z)) for z in np.linspace(-half, half, SECTIONS))
    report = Report(name, mesh, sections, journal_radius_m)
    if journal_radius_m is not None:
        ratio = mesh.mean_radius_m / journal_radius_m
        if not 0.1 < ratio < 10:
            raise StatejumpError(
                f"{name}: the bore's mean radius {mesh.mean_radius_m:.6g} m is {ratio:.3g} times the journal's "
                f"{journal_radius_m:.6g} m: are the coordinates in millimetres? Then use --scale 0.001"
            )
    return report


def rows(report: Report) -> list[tuple[str, str, str]]:
    """Table of a report: quantity, value, unit."""
    mesh, middle = report.mesh, report.middle
    axis = ", ".join(f"{round(value, 6) + 0.0:.6f}" for value in mesh.axis)
    centre = ", ".join(f"{value:.6g}" for value in mesh.centre_m)
    dominating = report.dominating_harmonic
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
        ("cylindricity, peak to valley", f"{report.cylindricity_m:.6g}", "m"),
        ("lobes that dominate", "none" if dominating is None else f"{dominating}", "per turn"),
    ]
    for each in report.sections:
        table.append((f"roundness at z = {each.z_m:.4g} m, peak to valley", f"{each.roundness_error_m:.6g}", "m"))
    for order, amplitude, phase in zip(HARMONICS, middle.amplitude_m, middle.phase_rad):
        table.append((f"harmonic {order}, middle section: amplitude", f"{amplitude:.6g}", "m"))
        table.append((f"harmonic {order}, middle section: phase", f"{np.degrees(phase):.3f}", "deg"))
    if report.journal_radius_m is not None:
        table.append(("journal radius", f"{report.journal_radius_m:.9g}", "m"))
        table.append(("radial clearance, least squares",
                      f"{mesh.mean_radius_m - report.journal_radius_m:.6g}", "m"))
        table.append(("radial clearance, smallest, journal on the axis",
                      f"{report.smallest_radius_m - report.journal_radius_m:.6g}", "m"))
    return table


def magnification(report: Report) -> float:
    """How much larger than life the figure shows deviations: a round number."""
    largest = max(float(np.max(np.abs(each.deviation_m))) for each in report.sections)
    largest = max(largest, report.mesh.reconstruction_error_m, 1e-12)
    wanted = 0.25 * report.mesh.mean_radius_m / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(1.0, power * max(step for step in (1, 2, 5) if step * power <= wanted)))


def figure(report: Report, folder: Path) -> list[Path]:
    """Write ``roundness.png`` and ``roundness.svg``: sections magnified, harmonics as bars."""
    times = magnification(report)
    angle = np.append(angles_rad(), 2 * np.pi)
    direction = np.array((np.cos(angle), np.sin(angle)))
    radius = report.mesh.mean_radius_m * 1e3
    with plt.rc_context(plot.STYLE):
        # Plain axes: matplotlib's polar ones do not write the same bytes twice.
        drawing, (polar, bars) = plt.subplots(1, 2, figsize=(9.5, 4.8), constrained_layout=True)
        polar.set_aspect("equal")
        polar.axis("off")
        for degrees in range(0, 360, 30):
            way = np.array((np.cos(np.radians(degrees)), np.sin(np.radians(degrees))))
            polar.plot(*np.outer(way, (0.6 * radius, 1.3 * radius)), color="0.88", linewidth=0.8)
            polar.annotate(f"{degrees}°", 1.42 * radius * way, ha="center", va="center", fontsize=8)
        polar.plot(*(radius * direction), color="0.5", linewidth=1, linestyle=":", label="least squares")
        shown = (report.sections[0], report.middle, report.sections[-1])
        styles = (("#0072B2", (0, (6, 2)), 1.5), ("#000000", "-", 1.6), ("#D55E00", (0, (1.5, 1.5)), 1.8))
        for each, (colour, line, width) in zip(shown, styles):
            wave = radius + times * 1e3 * np.append(each.deviation_m, each.deviation_m[0])
            polar.plot(*(wave * direction), color=colour, linestyle=line, linewidth=width,
                       label=f"z = {each.z_m * 1e3:.3g} mm")
        polar.set_title(f"radius {radius:.6g} mm, deviations × {times:g}", fontsize=9)
        polar.legend(loc="center", fontsize=8, framealpha=1)
        bars.bar(list(HARMONICS), report.middle.amplitude_m * 1e6, color="#0072B2")
        bars.set_xticks(list(HARMONICS))
        bars.set_xlabel("Harmonic (waves per turn)")
        bars.set_ylabel("Amplitude, middle section [µm]")
        drawing.suptitle(report.name, fontsize=11)
        return plot.save(drawing, folder, "roundness")


def write(report: Report, folder: Path) -> Path:
    """Write ``bore.csv``: quantity, value, unit."""
    path = folder / "bore.csv"
    with write_atomically(path) as stream:
        writer = csv.writer(stream)
        writer.writerow(("quantity", "value", "unit"))
        writer.writerows(rows(report))
    return path


# What the library's remedies are on the command line, by the kind of failure.
REMEDIES = {"inside_out": "; --flip turns it", "too_large": " Then use --scale 0.001"}


def load(file: Path, scale: float = 1.0, flip: bool = False) -> _engine.BoreMesh:
    """Read a bore; StatejumpError with one sentence when it is none."""
    try:
        return _engine.BoreMesh.read(str(file), scale=scale, flip=flip)
    except _engine.EngineFailure as failure:
        sentence = f"{failure.file}: {failure.cause}" if failure.file else str(failure)
        raise StatejumpError(sentence + REMEDIES.get(failure.kind, "")) from None


@click.command("bore")
@click.argument("file", metavar="FILE", type=click.Path(path_type=Path))
@click.option("--journal-radius", "journal_radius", type=float, default=None, metavar="M",
              help="Radius of the journal [m]: adds the clearance.")
@click.option("--scale", type=float, default=1.0, show_default=True, metavar="S",
              help="Unit of the file [m], 0.001 for millimetres.")
@click.option("--flip", is_flag=True, help="Turn every face over.")
@RESULTS
@QUIET
def bore_command(
    file: Path, journal_radius: Optional[float], scale: float, flip: bool, results: Path, quiet: bool
) -> None:
    """What the bore in FILE (OFF, STL, PLY, OBJ) is: radius, roundness, lobes, clearance.

    \b
    Example:
      statejump bore bearing.stl --scale 0.001 --journal-radius 5e-3
    """
    console = make_console(quiet)
    report = measure(load(file, scale, flip), str(file), journal_radius)
    folder = results_folder(results, f"bore_{file.stem}")
    table = Table(title=f"bore {file}")
    table.add_column("quantity")
    table.add_column("value", justify="right")
    table.add_column("unit")
    for row in rows(report):
        table.add_row(*row)
    console.print(table)
    written = [write(report, folder), *figure(report, folder)]
    console.print(f"results: {', '.join(str(name) for name in written)}")
