# SPDX-License-Identifier: GPL-3.0-or-later
"""Picture of a bore: sections with magnified deviations, harmonics of the middle section."""
from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from statejump.bores.measure import HARMONICS, Bore, angles_rad
from statejump.core.figures import panels, style


def magnification(bore: Bore) -> float:
    """Return the magnification of deviations in the figure, a round number."""
    largest = max(float(np.max(np.abs(each.deviation_m))) for each in bore.sections)
    largest = max(largest, bore.mesh.reconstruction_error_m, 1e-12)
    wanted = 0.25 * bore.mesh.mean_radius_m / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(1.0, power * max(step for step in (1, 2, 5) if step * power <= wanted)))


def drawn(bore: Bore, axes: tuple[Axes, Axes] | None = None) -> Figure:
    """Draw sections and harmonics of a bore into two given axes or, without axes, into a new figure; return it."""
    if axes is not None:
        _sections(axes[0], bore)
        _harmonics(axes[1], bore)
        figure = axes[0].figure
        assert isinstance(figure, Figure)
        return figure
    with style():
        figure, (around, bars) = panels(1, 2, (9.5, 4.8))
        _sections(around, bore)
        _harmonics(bars, bore)
        figure.suptitle(bore.name, fontsize=11)
    return figure


def _sections(panel: Axes, bore: Bore) -> None:
    # Plain axes, because files of matplotlib's polar axes are not reproducible.
    times = magnification(bore)
    angle = np.append(angles_rad(), 2 * np.pi)
    direction = np.array((np.cos(angle), np.sin(angle)))
    radius = bore.mesh.mean_radius_m * 1e3
    panel.set_aspect("equal")
    panel.axis("off")
    for degrees in range(0, 360, 30):
        way = np.array((np.cos(np.radians(degrees)), np.sin(np.radians(degrees))))
        panel.plot(*np.outer(way, (0.6 * radius, 1.3 * radius)), color="0.88", linewidth=0.8)
        panel.annotate(f"{degrees}°", 1.42 * radius * way, ha="center", va="center", fontsize=8)
    panel.plot(*(radius * direction), color="0.5", linewidth=1, linestyle=":", label="least squares")
    shown = (bore.sections[0], bore.middle, bore.sections[-1])
    styles = (("#0072B2", (0, (6, 2)), 1.5), ("#000000", "-", 1.6), ("#D55E00", (0, (1.5, 1.5)), 1.8))
    for each, (colour, line, width) in zip(shown, styles):
        wave = radius + times * 1e3 * np.append(each.deviation_m, each.deviation_m[0])
        panel.plot(*(wave * direction), color=colour, linestyle=line, linewidth=width,
                   label=f"z = {each.z_m * 1e3:.3g} mm")
    panel.set_title(f"Radius {radius:.6g} mm, deviations × {times:g}", fontsize=9)
    panel.legend(loc="center", fontsize=8, framealpha=1)


def _harmonics(panel: Axes, bore: Bore) -> None:
    panel.bar(list(HARMONICS), bore.middle.amplitude_m * 1e6, color="#0072B2")
    panel.set_xticks(list(HARMONICS))
    panel.set_xlabel("Harmonic (waves per turn)")
    panel.set_ylabel("Amplitude, middle section [µm]")
