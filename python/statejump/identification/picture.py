# SPDX-License-Identifier: GPL-3.0-or-later
"""Picture of an identified joint: the loop, the fit, and the residual."""
from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from statejump.core.figures import panels, style
from statejump.core.units import scale_of

if TYPE_CHECKING:
    from statejump.identification.result import Identification


def drawn(found: Identification, axes: tuple[Axes, Axes] | None = None) -> Figure:
    """Return the picture as a new figure, or draw loop and residual into two given axes."""
    if axes is not None:
        _loop(axes[0], found)
        _residual(axes[1], found)
        figure = axes[0].figure
        assert isinstance(figure, Figure)
        return figure
    with style():
        figure, (above, below) = panels(2, 1, (7.0, 6.2), sharex=True, height_ratios=(3, 1))
        _loop(above, found)
        _residual(below, found)
        above.set_xlabel("")
        figure.suptitle(f"{found.loop.name}: {found.fit.model.name}, σ = {found.fit.noise:.3g} "
                        f"{found.loop.unit('force')}", fontsize=11)
    return figure


def _scaled(found: Identification) -> tuple[float, str, float, str]:
    loop = found.loop
    along, along_unit = scale_of(loop.unit("displacement"), float(abs(loop.displacement).max()))
    across, across_unit = scale_of(loop.unit("force"), float(abs(loop.force).max()))
    return along, along_unit, across, across_unit


def _loop(panel: Axes, found: Identification) -> None:
    loop = found.loop
    along, along_unit, across, across_unit = _scaled(found)
    panel.plot(along * loop.displacement, across * loop.force, ".", color="#E69F00", markersize=5, label="measured")
    panel.plot(along * loop.displacement, across * found.answer(), color="#000000", linewidth=1.2, label="fit")
    stops = [sign * along * found.fit.values[name] for name, sign in (("clearance_minus", -1), ("clearance_plus", 1))
             if name in found.fit.values and found.intervals[name].bounded]
    for stop in stops:
        panel.axvline(stop, color="0.45", linewidth=1, linestyle=":", label="stop" if stop is stops[0] else None)
    what = ("Rotation", "Moment") if loop.angular else ("Displacement", "Force")
    panel.set_xlabel(f"{what[0]} [{along_unit}]")
    panel.set_ylabel(f"{what[1]} [{across_unit}]")
    panel.legend(loc="upper left", fontsize=8, framealpha=1)


def _residual(panel: Axes, found: Identification) -> None:
    loop = found.loop
    along, along_unit, _, _ = _scaled(found)
    left = loop.force - found.answer()
    scale, unit = scale_of(loop.unit("force"), float(abs(left).max()))
    panel.axhspan(-2 * found.fit.noise * scale, 2 * found.fit.noise * scale, color="0.9", label="±2 σ")
    panel.plot(along * loop.displacement, scale * left, ".", color="#0072B2", markersize=3)
    panel.set_xlabel(f"{'Rotation' if loop.angular else 'Displacement'} [{along_unit}]")
    panel.set_ylabel(f"Measured − fit [{unit}]")
    panel.legend(loc="upper left", fontsize=8, framealpha=1)
