# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump orbit``: compute temperatures of members over an orbit, and write them to a file for cases."""
from __future__ import annotations

from pathlib import Path

import click

from statejump import orbit
from statejump.cli.terminal import QUIET, make_console
from statejump.core.errors import NotAllowed
from statejump.core.output import check_suffix, check_target


def _interval(text: str) -> tuple[float, float]:
    begin, colon, end = text.partition(":")
    try:
        return float(begin), float(end)
    except ValueError:
        raise NotAllowed("--shadow", text, code="bad_shadow_option") from None


@click.command("orbit")
@click.argument("file", metavar="MEMBERS", type=click.Path(path_type=Path))
@click.option("-o", "--output", required=True, metavar="FILE", type=click.Path(path_type=Path),
              help="CSV file to write: time_s and NAME_K of every member.")
@click.option("--period", required=True, type=float, metavar="SECONDS", help="Length of the orbit.")
@click.option("--shadow", multiple=True, metavar="BEGIN:END", help="In shadow from BEGIN to END [s]; may be repeated.")
@click.option("--orbits", type=int, default=1, show_default=True, help="How many orbits are written.")
@click.option("--samples", type=int, default=100, show_default=True, metavar="N", help="Equal steps of an orbit.")
@click.option("--within", type=float, metavar="KELVIN",
              help="Write only as many times as straight lines between them need to be that near.")
@click.option("--sink", type=float, default=2.7, show_default=True, metavar="KELVIN",
              help="Temperature of what members see but the Sun.")
@click.option("--solar-constant", type=float, default=1361.0, show_default=True, metavar="W/M2",
              help="Sunlight across the rays.")
@QUIET
def orbit_command(file: Path, output: Path, period: float, shadow: tuple[str, ...], orbits: int, samples: int,
                  within: float | None, sink: float, solar_constant: float, quiet: bool) -> None:
    """Temperatures of members over an orbit with shadow, each member by itself, as a file that cases take.

    MEMBERS is a CSV file with the columns name, absorptivity, emissivity, sun_view (area that the Sun sees over
    radiating area) and heat_capacity_J_per_m2_K (by radiating area).

    \b
    Example:
      statejump orbit members.csv --period 5400 --shadow 1800:3900 -o orbit.csv
    """
    console = make_console(quiet)
    check_suffix("--output", output, ".csv")
    check_target(output)
    found = orbit.temperatures(
        orbit.read_members(file), period_s=period, shadow_s=[_interval(text) for text in shadow], orbits=orbits,
        samples_per_orbit=samples, sink_K=sink, solar_constant_W_per_m2=solar_constant,
        within_K=within,
    )
    found.write(output)
    coldest, hottest = found.temperature_K.min(), found.temperature_K.max()
    console.print(f"{output}: {len(found.names)} members, {len(found.time_s)} times, {coldest:.1f} to {hottest:.1f} K")
