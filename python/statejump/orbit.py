# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperatures of members over an orbit with shadow, for examples and first estimates. Every member has one temperature
and does not affect the others, as it would in a thermal analysis.

For a member with radiating area A, in sunlight (s = 1) or shadow (s = 0)::

    c dT/dt = s absorptivity sun_view S - emissivity sigma (T^4 - T_sink^4)

c is the heat capacity per radiating area [J/(m2 K)], ``sun_view`` the ratio of the projected area towards the Sun to A
(1/pi for a round bar across the rays), S the solar constant. The orbit is repeated until its end equals its beginning;
this periodic state is returned.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.column_units import matched
from statejump.core.errors import NotAllowed, Range, StatejumpError, Unreadable, located
from statejump.core.reading import is_file
from statejump.core.table_files import numbers_of, open_table
from statejump.core.tables import write_columns
from statejump.core.thermal import Numbers
from statejump.schema.rules import NUMBER, Rule

STEFAN_BOLTZMANN_W_PER_M2_K4 = 5.670374419e-8  # CODATA 2018, exact
SOLAR_CONSTANT_W_PER_M2 = 1361.0  # Kopp and Lean, Geophys. Res. Lett. 38, L01706, 2011
MOST_MEMBERS, MOST_ORBITS = 10_000, 1000
MOST_HALVINGS = 100  # largest number of bisections of a temperature interval; 53 reach rounding
ROUNDING = 1e-14  # relative accuracy of temperatures
PERIODIC_K = 1e-6  # largest difference between end and start of a periodic orbit [K]
SECTION = {
    "absorptivity": Range(0, 1), "emissivity": Range(0, 1, above=True), "sun_view": Range(0, 1),
    "heat_capacity_J_per_m2_K": Range(0, 1e9, "J/(m2 K)", above=True),
}


@dataclass(frozen=True)
class Member:
    """A member with one temperature.

    :param absorptivity: absorbed fraction of sunlight, 0 to 1
    :param emissivity: emissivity relative to a black body, above 0, at most 1
    :param sun_view: projected area towards the Sun over radiating area, 0 to 1
    :param heat_capacity_J_per_m2_K: heat capacity per radiating area, above 0
    """

    name: str
    absorptivity: float
    emissivity: float
    sun_view: float
    heat_capacity_J_per_m2_K: float

    def __post_init__(self) -> None:
        for key, allowed in SECTION.items():
            try:
                Rule(NUMBER, allowed=allowed).check(key, getattr(self, key))
            except NotAllowed as refused:
                refused.item = f"member {self.name!r}"
                raise


@dataclass(frozen=True)
class Temperatures:
    """Result of :func:`temperatures`.

    :param time_s: n times [s], from 0
    :param temperature_K: temperatures of every member (n, members) [K]
    """

    names: tuple[str, ...]
    time_s: Numbers
    temperature_K: Numbers

    def write(self, path: str | Path) -> None:
        """Write a file for ``table_file`` and ``members_file``."""
        columns = {f"{name}_K": self.temperature_K[:, place] for place, name in enumerate(self.names)}
        write_columns({"time_s": self.time_s, **columns}, Path(path))


def temperatures(
    members: Sequence[Member], *, period_s: float, shadow_s: Sequence[tuple[float, float]] = (), orbits: int = 1,
    samples_per_orbit: int = 100, sink_K: float = 2.7, solar_constant_W_per_m2: float = SOLAR_CONSTANT_W_PER_M2,
    within_K: float | None = None,
) -> Temperatures:
    """Return the temperatures of members over a periodic orbit.

    :param period_s: duration of the orbit [s]
    :param shadow_s: begin and end of each shadow [s], within the orbit, in ascending order
    :param orbits: number of returned orbits
    :param samples_per_orbit: number of equal steps per orbit. Begin and end of every shadow are returned as further
        times
    :param sink_K: temperature of the surroundings except the Sun [K]
    :param solar_constant_W_per_m2: solar flux through an area normal to the rays [W/m2]
    :param within_K: allowed error of linear interpolation between the returned times [K]; None: all times are returned
    :raises StatejumpError: a number is out of its range, shadows overlap, or no periodic orbit is reached
    """
    for key, value, allowed in (
        ("period_s", period_s, Range(0, 1e9, "s", above=True)), ("sink_K", sink_K, Range(0, 1e4, "K")),
        ("solar_constant_W_per_m2", solar_constant_W_per_m2, Range(0, 1e6, "W/m2")),
        ("orbits", orbits, Range(1, MOST_ORBITS)), ("samples_per_orbit", samples_per_orbit, Range(2, 1_000_000)),
    ):
        Rule(NUMBER, allowed=allowed).check(key, value)
    if within_K is not None:
        Rule(NUMBER, allowed=Range(0, 1e4, "K", above=True)).check("within_K", within_K)
    names = [member.name for member in members]
    if not 0 < len(names) <= MOST_MEMBERS or len(set(names)) < len(names):
        raise NotAllowed("members", code="wrong_number_of_members", most=MOST_MEMBERS)
    ends = [0.0, *(time for pair in shadow_s for time in pair), period_s]
    if not all(len(pair) == 2 and pair[0] < pair[1] for pair in shadow_s) or sorted(ends) != ends:
        raise NotAllowed("shadow_s", list(shadow_s), code="shadow_times", period_s=period_s)
    times = np.unique([*np.linspace(0, period_s, samples_per_orbit + 1).tolist(), *ends])
    orbit = _Orbit(members, times, shadow_s, sink_K, solar_constant_W_per_m2)
    start = orbit.mean_K()
    for _ in range(MOST_ORBITS):
        found = orbit.run(start)
        if np.abs(found[-1] - start).max() <= PERIODIC_K:
            break
        # Each orbit reduces the difference from the periodic state by a nearly constant factor; Aitken's step
        # extrapolates to the limit.
        first, second = found[-1] - start, orbit.run(found[-1])[-1] - found[-1]
        left = np.divide(second, first, out=np.zeros_like(first), where=first != 0)
        start = found[-1] + np.where(np.abs(left) < 1, second / (1 - np.minimum(left, 1 - 1e-9)), second)
    else:
        raise StatejumpError(code="orbit_not_periodic", orbits=MOST_ORBITS)
    found[-1] = found[0]
    if within_K is not None:
        kept = _needed(times, found, within_K, np.searchsorted(times, ends))
        times, found = times[kept], found[kept]
    whole = np.concatenate([times[:-1] + number * period_s for number in range(orbits)] + [[orbits * period_s]])
    return Temperatures(tuple(names), whole, np.concatenate([found[:-1]] * orbits + [found[-1:]]))


def _needed(time_s: Numbers, values: Numbers, within: float, corners: np.ndarray) -> list[int]:
    """Return the rows (n) of values (n, m) that linear interpolation with the allowed error needs: after each row the
    farthest admissible one. Corners are kept."""
    kept, fixed = [0], set(corners.tolist())
    last = 1
    for row in range(2, len(time_s)):
        first = kept[-1]
        share = (time_s[first + 1:row] - time_s[first]) / (time_s[row] - time_s[first])
        straight = values[first] + share[:, None] * (values[row] - values[first])
        if last in fixed or np.abs(straight - values[first + 1:row]).max() > within:
            kept.append(last)
        last = row
    return [*kept, last]


class _Orbit:
    """One orbit of all members from given initial temperatures."""

    def __init__(
        self, members: Sequence[Member], times: Numbers, shadow_s: Sequence[tuple[float, float]], sink_K: float,
        solar: float,
    ) -> None:
        def of(key: str) -> Numbers:
            return np.array([getattr(member, key) for member in members])

        self._times, self._sink = times, sink_K
        capacity = of("heat_capacity_J_per_m2_K")
        self._loss = of("emissivity") * STEFAN_BOLTZMANN_W_PER_M2_K4 / capacity  # 1/(K3 s)
        self._gain = of("absorptivity") * of("sun_view") * solar / capacity  # K/s
        middle = (times[:-1] + times[1:]) / 2
        self._lit = np.array([not any(begin <= time <= end for begin, end in shadow_s) for time in middle])

    def mean_K(self) -> Numbers:
        """Return the equilibrium temperatures at the mean sunlight over the orbit."""
        share = float(np.diff(self._times) @ self._lit / self._times[-1])
        return np.asarray((self._sink**4 + share * self._gain / self._loss) ** 0.25)

    def run(self, start_K: Numbers) -> Numbers:
        """Return the temperatures (times, members) for given initial temperatures."""
        found = [start_K]
        for length, lit in zip(np.diff(self._times), self._lit):
            balance = (self._sink**4 + float(lit) * self._gain / self._loss) ** 0.25
            found.append(_stepped(found[-1], balance, self._loss * length))
        return np.array(found)


def _stepped(start_K: Numbers, balance_K: Numbers, loss_times_step: Numbers) -> Numbers:
    """Return T after a time step of dT/dt = k (B^4 - T^4), by solving the closed form of the time as a function of T.

    With u = T/B the time since the start is [artanh(u)/2 + arctan(u)/2]/(k B^3), with arcoth above the balance. If the
    balance temperature B is 0, the time is 1/(3 k T^3). T approaches B without reaching it, so a Newton step beyond B
    is replaced by half of the remaining distance.
    """
    low, high = np.minimum(start_K, balance_K), np.maximum(start_K, balance_K)
    settled = high - low <= 1e-13 * high
    warms, rising = balance_K > 0, balance_K >= start_K
    wanted = loss_times_step * np.where(warms, balance_K, 1.0) ** 3
    at = np.array((low + high) / 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in range(MOST_HALVINGS):
            u, u0 = at / balance_K, start_K / balance_K
            turned = (np.log(np.abs((1 + u) / (1 - u))) - np.log(np.abs((1 + u0) / (1 - u0)))) / 4
            passed = np.where(warms, turned + (np.arctan(u) - np.arctan(u0)) / 2, (at**-3.0 - start_K**-3.0) / 3)
            # If the time at which T has a value exceeds the step, the solution lies between this value and the start.
            below = (passed > wanted) == rising
            high, low = np.where(below, at, high), np.where(below, low, at)
            newton = at + (wanted - passed) * np.where(warms, balance_K * (1 - u**4), -at**4)
            near = settled | (np.abs(newton - at) <= ROUNDING * at) | (high - low <= ROUNDING * high)
            if near.all():
                break
            inside = near | ((newton > low) & (newton < high))
            at = np.where(inside, np.where(near, at, newton), (low + high) / 2)
    return np.where(settled, balance_K, at)


COLUMNS = ("name", *SECTION)


def read_members(path: str | Path) -> list[Member]:
    """Return the members of a CSV file with the columns ``name``, ``absorptivity``, ``emissivity``, ``sun_view``,
    ``heat_capacity_J_per_m2_K``.

    :raises StatejumpError: one sentence with file and line
    """
    path = Path(path)
    if not is_file(path):
        raise Unreadable(code="members_file_not_found", file=path)
    with open_table(path) as table:
        with located(file=path):
            columns = matched(table.header, COLUMNS)
        missing = [key for key in COLUMNS if key not in {column.key for column in columns}]
        if missing:
            raise Unreadable(code="missing_column", file=path, column=missing[0], needed=", ".join(COLUMNS))
        found: list[Member] = []
        for lines, rows in table.blocks():
            if len(found) + len(rows) > MOST_MEMBERS:
                raise Unreadable(code="too_many_members", file=path, most=MOST_MEMBERS)
            cells = {column.key: part if column.key == "name" else numbers_of(table, column, part, lines).tolist()
                     for column, part in zip(columns, zip(*rows))}
            found += [_member(path, line, dict(zip(cells, row))) for line, row in zip(lines, zip(*cells.values()))]
    return found


def _member(path: Path, line: int, row: dict[str, Any]) -> Member:
    name = str(row["name"]).strip()
    if not name or not name.isprintable():
        raise Unreadable(code="member_name", file=path, line=line)
    with located(file=path):
        return Member(name, **{key: row[key] for key in SECTION})
