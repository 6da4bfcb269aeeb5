# SPDX-License-Identifier: GPL-3.0-or-later
"""Thermal creak and snap: acceleration of a node of a truss in motion when joints slip."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import signal

from statejump.core import figures, libraries
from statejump.core.errors import NotAllowed
from statejump.core.progress import OnProgress
from statejump.core.run import Run
from statejump.core.tables import Shown, write_columns, write_rows
from statejump.kinds.truss import motion, result
from statejump.kinds.truss.case import TrussCase
from statejump.results.record import save

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SEGMENTS = 16  # segments of Welch's average; the relative error of the density is about 1/sqrt(2 · 16)
LEAST_PERIODS = 16  # smallest number of periods of the lowest frequency of a band within the record
ORDER = 4  # order of the Butterworth filters of the bands


@dataclass(frozen=True)
class Creak:
    """Slips of the joints of a truss in motion, and the acceleration of one node.

    ``slips`` has joint, start_s, duration_s, temperature_change_K and heat_J of every slip; a slip that continues at
    the end of the record is cut there. ``bands`` has low_Hz, high_Hz, rms_m_per_s2 and peak_m_per_s2 of octaves below
    half the sampling rate.
    """

    case: TrussCase
    run: Run
    node: str
    time_s: np.ndarray  # middle of every step
    acceleration_m_per_s2: np.ndarray  # (steps, 3)
    slips: Sequence[Mapping[str, Any]]
    bands: Sequence[Mapping[str, Any]]
    frequency_Hz: np.ndarray
    density_m2_per_s4_per_Hz: np.ndarray  # sum over all directions

    @property
    def peak_m_per_s2(self) -> float:
        """Largest acceleration of the node."""
        return float(np.linalg.norm(self.acceleration_m_per_s2, axis=1).max())

    @property
    def rms_m_per_s2(self) -> float:
        """Root mean square of the acceleration."""
        return float(np.sqrt((self.acceleration_m_per_s2**2).sum(axis=1).mean()))

    def frame(self, table: str) -> pandas.DataFrame:
        """Return ``slips`` or ``bands`` as a table, with units in the column names."""
        return libraries.frame(getattr(self, table))

    def plot(self) -> Figure:
        """Draw the slips of the joints over time, and the acceleration of the node with its spectrum."""
        with figures.style():
            figure, places = figures.panels(3, 1, (9.5, 9.0), height_ratios=(1.4, 1, 1))
            self._raster(places[0])
            places[1].plot(self.time_s, np.linalg.norm(self.acceleration_m_per_s2, axis=1), color="0", linewidth=0.6)
            places[1].set_xlabel("Time [s]")
            places[1].set_ylabel(f"Acceleration of node {self.node} [m/s²]")
            places[1].sharex(places[0])
            shown = self.frequency_Hz > 0
            draw = places[2].loglog if self.density_m2_per_s4_per_Hz[shown].any() else places[2].semilogx
            draw(self.frequency_Hz[shown], self.density_m2_per_s4_per_Hz[shown], color="0", linewidth=0.9)
            places[2].set_xlabel("Frequency [Hz]")
            places[2].set_ylabel("Density of acceleration [(m/s²)²/Hz]")
            figure.suptitle(f"{self.case.title}: creak at node {self.node}")
            return figure

    def _raster(self, axes: Axes) -> None:
        names = list(result.every_joint_name(self.case.resolve()).values())
        rows = {name: place for place, name in enumerate(names)}
        most = max((slip["heat_J"] for slip in self.slips), default=0.0)
        for slip in self.slips:
            row = rows[slip["joint"]]
            axes.plot([slip["start_s"], slip["start_s"] + slip["duration_s"]], [row, row], color="#0072B2", linewidth=3,
                      solid_capstyle="butt", zorder=2)
            size = 4 + 60 * max(slip["heat_J"], 0.0) / most if most > 0 else 4
            axes.scatter([slip["start_s"]], [row], s=size, color="0", zorder=3)
        some = np.unique(np.linspace(0, len(names) - 1, min(len(names), 12)).astype(int))
        axes.set_yticks(some, [names[place] for place in some])
        axes.set_ylabel("Joint slips; dot: its heat")
        axes.set_xlabel("Time [s]")
        warm = axes.twinx()
        warm.plot(self.run.time_s, self.run["temperature_change_K"], color="#D55E00", linewidth=1, linestyle="--")
        warm.set_ylabel("Temperature change, dashed [K]")
        warm.grid(False)

    def summary_lines(self) -> list[Shown | str]:
        """Return what a command prints."""
        rows = [[f"{band['low_Hz']:.4g}", f"{band['high_Hz']:.4g}", f"{band['rms_m_per_s2']:.4g}",
                 f"{band['peak_m_per_s2']:.4g}"] for band in self.bands]
        table = Shown(f"{self.case.title}: acceleration of node {self.node}",
                      ["from [Hz]", "to [Hz]", "RMS [m/s2]", "peak [m/s2]"], rows)
        heat = sum(slip["heat_J"] for slip in self.slips)
        largest = max((slip["heat_J"] for slip in self.slips), default=0.0)
        return [table, f"all: RMS {self.rms_m_per_s2:.4g} m/s2, peak {self.peak_m_per_s2:.4g} m/s2",
                f"{len(self.slips)} slips, heat {heat:.4g} J, the largest {largest:.4g} J"]

    def write(self, folder: Path) -> list[Path]:
        """Write the result file of the motion, tables, record and picture; return their paths."""
        written = [save("reduced", self.case, {"reduced": self.run}, folder)]
        for name, header in (("slips", SLIP), ("bands", BAND)):
            written.append(write_rows(folder / f"{name}.csv", getattr(self, name), header))
        write_columns({"frequency_Hz": self.frequency_Hz, "density_m2_per_s4_per_Hz": self.density_m2_per_s4_per_Hz},
                      folder / "spectrum.csv")
        return [*written, folder / "spectrum.csv", *figures.save(self.plot(), folder, "creak")]


SLIP = ("joint", "start_s", "duration_s", "temperature_change_K", "heat_J")
BAND = ("low_Hz", "high_Hz", "rms_m_per_s2", "peak_m_per_s2")


def creak(case: TrussCase, node: str, on_progress: OnProgress = lambda share: None) -> Creak:
    """Return the acceleration of a node of a truss that moves through its temperature program.

    :param node: name of the node
    :param on_progress: called with the finished fraction, 0 to 1
    :raises NotAllowed: the node does not exist, or the time steps are not equal
    :raises FailedRun: the motion could not be computed
    """
    names = case.resolve().nodes.names
    if node not in names:
        some = ", ".join(names[:8]) + (" …" if len(names) > 8 else "")
        raise NotAllowed("node", node, code="undefined_node", case=case.name, known=some)
    if case.motion.displacement_tolerance_m is not None:
        raise NotAllowed("motion.displacement_tolerance_m", case.motion.displacement_tolerance_m,
                         code="spectrum_of_unequal_steps", case=case.name)
    found = motion.simulate(case, on_progress, names.index(node))
    run = result.motion_run(case, found)
    step = found.time_step_s
    acceleration = np.diff(found.watched_velocity_m_per_s, axis=0) / step
    time = step * (np.arange(len(acceleration)) + 0.5)
    frequency, density = _density(acceleration, 1 / step)
    return Creak(case, run, node, time, acceleration, _slips(case, found, run), _bands(acceleration, 1 / step),
                 frequency, density)


def _density(acceleration: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies [Hz] and the one-sided power density of the acceleration, summed over its components."""
    length = max(2 * len(acceleration) // (SEGMENTS + 1), 8)  # halves overlap
    frequency, density = signal.welch(acceleration, rate, nperseg=min(length, len(acceleration)), axis=0)
    return frequency, density.sum(axis=1)


def _bands(acceleration: np.ndarray, rate: float) -> list[dict[str, float]]:
    """Return RMS and peak in octaves below half the sampling rate, highest first; the last band has all lower
    frequencies."""
    found: list[dict[str, float]] = []
    high, least = rate / 2, LEAST_PERIODS * rate / len(acceleration)
    while high > least:
        low = high / 2 if high / 2 > least else 0.0
        # The filter is causal and starts at rest, as the truss does.
        kind, edges = (("lowpass", high) if low == 0 else ("highpass", low) if high == rate / 2
                       else ("bandpass", (low, high)))
        filtered = acceleration if low == 0 and high == rate / 2 else signal.sosfilt(
            signal.butter(ORDER, edges, kind, fs=rate, output="sos"), acceleration, axis=0)
        size = np.linalg.norm(filtered, axis=1)
        found.append({"low_Hz": low, "high_Hz": high, "rms_m_per_s2": float(np.sqrt((size**2).mean())),
                      "peak_m_per_s2": float(size.max())})
        high = low
    return found


def _slips(case: TrussCase, found: motion.TrussMotion, run: Run) -> list[dict[str, Any]]:
    """Return the slips of all joints in order of their start."""
    joints = result.every_joint_name(found.truss)
    heats = {
        name: found.states[f"{kind}_dissipation_J"][:, found.truss.joints[kind].names.index(own)]
        for (kind, own), name in joints.items()
    }
    duration = float(run.time_s[-1])
    begun: dict[str, tuple[float, float]] = {}
    slips = []

    def ended(name: str, time: float) -> None:
        start, change = begun.pop(name)
        spent = float(np.diff(np.interp([start, time], run.time_s, heats[name]))[0])
        slips.append({"joint": name, "start_s": start, "duration_s": time - start, "temperature_change_K": change,
                      "heat_J": spent})

    for event in found.events:
        name = joints[event.joint_kind, event.name]
        if event.after.startswith("slip"):
            begun.setdefault(name, (event.time_s - event.interval_s, event.temperature_change_K))
        elif name in begun:
            ended(name, event.time_s)
    for name in list(begun):
        ended(name, duration)
    return sorted(slips, key=lambda slip: slip["start_s"])
