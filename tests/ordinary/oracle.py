# SPDX-License-Identifier: GPL-3.0-or-later
"""Decides without the engine, for small displacements, whether a structure has a quasi-static path.

Three checks decide; each is based on a theorem.

- *Stability*: with every joint held, the elastic plus the geometric stiffness is positive definite. Otherwise the
  structure is a mechanism, or it buckles.
- *Class A*: this stiffness is positive definite also if every slider and Iwan joint is free. With given friction limits
  each step is then a strictly convex minimisation: exactly one continuation exists, whatever slips.
- *Safe loads*: bar forces and friction within its limits can balance more than the loads. A quasi-static evolution with
  given friction limits then exists, as in perfect plasticity (safe-load condition). If they balance less, none exists.

The stiffness assumes closed pins. A bar with play has an energy with a dead zone; it is stable if the bar without play
is stable.
"""
from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import linprog, lsq_linear

from sketch import CLEARANCE, Document

# Smallest eigenvalue of the stiffness over its diagonal. Rounding of the assembly is 1e-16 · 1e3 unknowns; the softest
# long girder has 1e-7.
FREE = 1e-10
# Load factors this close to 1 are undetermined: displacements are finite, and the linear program has a tolerance of
# 1e-7.
MARGIN = 0.03
# Fraction of the elastic stiffness that remains under compression. Below it, loads are followed at large displacements.
# A flat arch at its snap-through load has 0.81 for small displacements.
SHALLOW = 0.85
# Fraction of the stiffness that remains at the shape to which small displacements deform a hot structure. The rise of a
# flat arch changes by c in small displacements if at large ones it changes to √(h² - 2 c h): the arch passes its chord,
# a limit point, at c = h/2, where small displacements leave a quarter of the stiffness.
FLATTENED = 0.5
FAR = 0.05  # of the size


@dataclass(frozen=True)
class Verdict:
    """What theory predicts for a structure.

    :param kind: ``path``, ``overloaded``, ``mechanism``, ``unstable`` or ``undetermined``
    :param class_a: whether the continuation is always unique
    :param load_factor: largest multiple of the loads that friction carries; inf: any
    :param start_share: estimated initial displacement over the structure's size; NaN: not estimated
    :param slack: whether some bar with play carries no force at the start
    """

    kind: str
    class_a: bool = False
    load_factor: float = float("inf")
    start_share: float = float("nan")
    slack: bool = False


class Frame:
    """The arrays of a case document; vectors have the dimension of the truss."""

    def __init__(self, document: Document) -> None:
        self.document, self.dimension = document, document["truss"]["dimension"]
        self.place = {node["name"]: number for number, node in enumerate(document["node"])}
        self.x = np.array([node["position_m"] for node in document["node"]], dtype=float)
        self.size = float(np.ptp(self.x, axis=0).max())
        self.links = {link["name"]: link for link in document["link"]}
        self._loads()
        self._bars()
        self.turns = [self._turn(item) for item in self._items("torsion_spring")]
        self.turn_stiffness = np.array([item["stiffness_N_m_per_rad"] for item in self._items("torsion_spring")])
        self.latches = [self._turn(item) for item in self._items("latch_hinge")]
        for item, row in zip(self._items("latch_hinge"), self.latches):
            self.force = self.force - item.get("preload_moment_N_m", 0.0) * row
        self.sliding = [(item, item["friction_coefficient"] * item["normal_force_N"]) for item in self._items("slider")]
        self.sliding += [(item, item["slip_force_N"]) for item in self._items("iwan_joint")]

    def _items(self, section: str) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = self.document.get(section, [])
        return found

    def _loads(self) -> None:
        force = np.zeros_like(self.x)
        for number, node in enumerate(self.document["node"]):
            force[number] = node.get("force_N", 0.0)
        gravity = np.array(self.document["truss"].get("gravity_m_per_s2", np.zeros(self.dimension)))
        for link in self.document["link"]:
            ends = [self.place[name] for name in link["nodes"]]
            length = np.linalg.norm(self.x[ends[1]] - self.x[ends[0]])
            mass = link.get("density_kg_per_m3", 0.0) * link["cross_section_area_m2"] * length
            force[ends] += mass / 2 * gravity
        self.force = force.ravel()

    def _bars(self) -> None:
        """Collect bars and springs: rows of elongation, stiffness, initial tension, cables."""
        rows, stiffness, tension, directions, lengths, cables = [], [], [], [], [], []
        for number, item in enumerate([*self.document["link"], *self._items("spring")]):
            ends = [self.place[name] for name in item["nodes"]]
            along = self.x[ends[1]] - self.x[ends[0]]
            length = float(np.linalg.norm(along))
            row = np.zeros_like(self.x)
            row[ends[0]], row[ends[1]] = -along / length, along / length
            if "young_modulus_Pa" in item:
                free = item.get("stress_free_length_m", length)
                rate = item["young_modulus_Pa"] * item["cross_section_area_m2"] / free
                tension.append(rate * (length - free))
            else:
                rate = item["stiffness_N_per_m"]
                tension.append(rate * (length - item["free_length_m"]) if "free_length_m" in item
                               else item.get("preload_N", 0.0))
            rows.append(row.ravel())
            stiffness.append(rate)
            directions.append((ends, along / length))
            lengths.append(length)
            cables.append(bool(item.get("cable", False)))
        self.rows, self.stiffness, self.tension = np.array(rows), np.array(stiffness), np.array(tension)
        self.directions, self.lengths, self.cables = directions, np.array(lengths), np.array(cables)

    def _turn(self, item: dict[str, Any]) -> np.ndarray:
        """Return the equilibrium matrix' row of the angle from the first link to the second."""
        row, names = np.zeros_like(self.x), item["links"]
        for name, sign in zip(names, (-1.0, 1.0) if len(names) > 1 else (1.0,)):
            ends = [self.place[node] for node in self.links[name]["nodes"]]
            along = self.x[ends[1]] - self.x[ends[0]]
            if self.dimension == 2:
                across = np.array([-along[1], along[0]]) / (along @ along)
            else:
                axis = np.array(item["axis"]) / np.linalg.norm(item["axis"])
                flat = along - axis * (axis @ along)
                across = np.cross(axis, flat) / (flat @ flat)
            row[ends[1]] += sign * across
            row[ends[0]] -= sign * across
        return row.ravel()

    def thermal_tensions(self) -> list[np.ndarray]:
        """Return the thermal forces of bars of fixed length, tension positive, at both extremes of the temperature
        programs."""
        programs = {None: self.document["thermal"], **{one["name"]: one for one in self.document.get("program", ())}}
        found = []
        for largest in (True, False):
            tension = np.zeros(len(self.stiffness))
            for number, link in enumerate(self.document["link"]):
                extremes = _extremes(programs[link.get("program")])
                change = (max if largest else min)(extremes) * link.get("temperature_fraction", 1.0)
                tension[number] = -self.stiffness[number] * self.lengths[number] * change * link[
                    "thermal_expansion_per_K"]
            found.append(tension)
        return found

    def deformed(self, moved: np.ndarray) -> Frame:
        """Return the structure with its bars at another shape, without new tensions."""
        made = copy(self)
        made.x = self.x + moved.reshape(self.x.shape)
        made._bars()
        made.stiffness, made.tension = self.stiffness, self.tension
        return made

    def motions(self, sliding: bool) -> np.ndarray:
        """Return a basis of the displacements that supports and joints permit; pins are held, sliders free or held."""
        n, d = len(self.x), self.dimension
        constraints = []
        for number, node in enumerate(self.document["node"]):
            for axis in node.get("fixed", ()):
                row = np.zeros((n, d))
                row[number, "xyz".index(axis)] = 1.0
                constraints.append(row)
            if "guide_normal" in node:
                row = np.zeros((n, d))
                row[number] = np.array(node["guide_normal"]) / np.linalg.norm(node["guide_normal"])
                constraints.append(row)
        for section in CLEARANCE:
            for item in self._items(section):
                outer, inner = ("bearing", "journal") if section == "revolute" else ("socket", "ball")
                constraints += self._together(item[f"{outer}_node"], item[f"{inner}_node"], np.eye(d))
        for item, _ in self.sliding:
            axis = np.array(item["axis"]) / np.linalg.norm(item["axis"])
            if len(item["nodes"]) == 1:
                if not sliding:
                    constraints += self._together(item["nodes"][0], None, axis[None, :])
                continue
            held = np.eye(d) - (np.outer(axis, axis) if sliding else 0.0)
            constraints += self._together(*item["nodes"], held)
        return _null_space(np.array([row.ravel() for row in constraints]).reshape(-1, n * d))

    def _together(self, one: str, two: str | None, directions: np.ndarray) -> list[np.ndarray]:
        rows = []
        for direction in directions:
            row = np.zeros_like(self.x)
            row[self.place[one]] += direction
            if two is not None:
                row[self.place[two]] -= direction
            rows.append(row)
        return rows

    def slides(self) -> np.ndarray:
        """Return the rows of the slides."""
        rows = [self._together(item["nodes"][0], item["nodes"][1] if len(item["nodes"]) > 1 else None,
                               np.array(item["axis"])[None, :] / np.linalg.norm(item["axis"]))[0].ravel()
                for item, _ in self.sliding]
        return np.array(rows).reshape(len(rows), self.x.size)

    def elastic(self, active: np.ndarray) -> np.ndarray:
        """Return the elastic stiffness without inactive cables."""
        weights = self.stiffness * active
        found = self.rows.T @ (weights[:, None] * self.rows)
        if self.turns:
            turns = np.array(self.turns)
            found = found + turns.T @ (self.turn_stiffness[:, None] * turns)
        return np.asarray(found)

    def geometric(self, tension: np.ndarray) -> np.ndarray:
        """Return the geometric stiffness of these tensions."""
        d = self.dimension
        found = np.zeros((self.x.size, self.x.size))
        for (ends, along), force, length in zip(self.directions, tension, self.lengths):
            block = force / length * (np.eye(d) - np.outer(along, along))
            for one, two, sign in ((0, 0, 1), (1, 1, 1), (0, 1, -1), (1, 0, -1)):
                rows, columns = (slice(d * ends[k], d * ends[k] + d) for k in (one, two))
                found[rows, columns] += sign * block
        return found


def _extremes(program: Document) -> tuple[float, ...]:
    if program["shape"] == "table":
        return 0.0, *program["table_temperature_change_K"]
    largest = program["temperature_change_max_K"]
    return (0.0, largest, -largest) if program["shape"] == "sine" else (0.0, largest)


def _null_space(rows: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the null space; rows with a single entry need no decomposition."""
    size = rows.shape[1]
    single = (rows != 0).sum(axis=1) <= 1
    kept = np.setdiff1d(np.arange(size), np.abs(rows[single]).argmax(axis=1) if single.any() else [])
    others = rows[~single][:, kept]
    basis = np.zeros((size, len(kept)))
    basis[kept, np.arange(len(kept))] = 1.0
    if not len(others):
        return basis
    _, singular, right = np.linalg.svd(others)
    rank = int((singular > 1e-10 * singular[0]).sum())
    return np.asarray(basis @ right[rank:].T)


def softest(stiffness: np.ndarray, basis: np.ndarray) -> float:
    """Return the smallest eigenvalue of a stiffness, divided by the mean of its diagonal."""
    if not basis.shape[1]:
        return 1.0
    found = basis.T @ stiffness @ basis
    diagonal = float(np.trace(found)) / len(found)
    if diagonal <= 0:
        return 0.0
    return float(eigh(found, eigvals_only=True, subset_by_index=[0, 0])[0]) / diagonal


def _has_play(document: Document) -> bool:
    return any(document.get(section) for section in CLEARANCE)


def _forces(frame: Frame, moved: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return nodal forces and stiffness of bars, springs and cables at large displacements."""
    d = frame.dimension
    place = frame.x + moved.reshape(frame.x.shape)
    force, stiffness = np.zeros_like(place), np.zeros((place.size, place.size))
    free = frame.lengths - frame.tension / frame.stiffness
    for number, (ends, _) in enumerate(frame.directions):
        along = place[ends[1]] - place[ends[0]]
        length = float(np.linalg.norm(along))
        along, tension = along / length, frame.stiffness[number] * (length - free[number])
        if frame.cables[number] and tension < 0:
            continue
        force[ends[0]] += tension * along
        force[ends[1]] -= tension * along
        outer = np.outer(along, along)
        block = frame.stiffness[number] * outer + tension / length * (np.eye(d) - outer)
        for one, two, sign in ((0, 0, 1), (1, 1, 1), (0, 1, -1), (1, 0, -1)):
            rows, columns = (slice(d * ends[k], d * ends[k] + d) for k in (one, two))
            stiffness[rows, columns] += sign * block
    return force.ravel(), stiffness


def _balanced(frame: Frame, basis: np.ndarray, moved: np.ndarray, load: np.ndarray) -> np.ndarray | None:
    """Return the displacement in equilibrium with a load. None: the load step is too large, because Newton steps do not
    halve the residual or pass an unstable shape.

    :param load: load by unknown, minus the imbalance of preloads
    """
    turns = np.array(frame.turns).reshape(-1, frame.x.size)
    bending = turns.T @ (frame.turn_stiffness[:, None] * turns)  # as drawn
    rounding = 1e-9 * float(max(np.abs(frame.tension).max(), np.abs(frame.force).max(), 1e-9))
    before = np.inf
    while True:
        inner, stiffness = _forces(frame, moved)
        left = basis.T @ (inner - bending @ moved) + load
        now = float(np.abs(left).max(initial=0.0))
        tangent = basis.T @ (stiffness + bending) @ basis
        if softest(tangent, np.eye(len(tangent))) < FREE or not now < max(0.5 * before, rounding):
            return None
        if now < rounding:
            return moved
        before, moved = now, moved + basis @ np.linalg.solve(tangent, left)


def follow(frame: Frame, basis: np.ndarray) -> np.ndarray | None:
    """Return the displacement of the loaded structure with held joints, followed from the reference configuration while
    loads and the imbalance of preloads increase in adaptive steps. None: the structure becomes unstable."""
    force, lacking = basis.T @ frame.force, basis.T @ _forces(frame, np.zeros(frame.x.size))[0]
    moved, reached, step = np.zeros(frame.x.size), 0.0, 0.25
    while reached < 1.0:
        share = min(1.0, reached + step)
        found = _balanced(frame, basis, moved, share * force - (1 - share) * lacking)
        if found is not None:
            moved, reached, step = found, share, 2 * step
            continue
        step /= 2
        if step < 1e-3:
            return None
    return moved


def _held_start(frame: Frame, basis: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return initial displacement, tensions and active cables of the loaded structure with held joints."""
    active = np.ones(len(frame.stiffness), dtype=bool)
    # A cable with a negative preload is slack in the reference configuration.
    active[frame.cables & (frame.tension < 0)] = False
    drawn = np.where(frame.cables, np.maximum(frame.tension, 0.0), frame.tension)
    moved, tension = np.zeros(frame.x.size), drawn
    for _ in range(20):
        now = frame.elastic(active) + frame.geometric(np.where(active, drawn, 0.0))
        force = basis.T @ (frame.force - frame.rows.T @ np.where(active, drawn, 0.0))
        moved = basis @ np.linalg.lstsq(basis.T @ now @ basis, force, rcond=1e-12)[0]
        tension = drawn + frame.stiffness * (frame.rows @ moved)
        next_active = ~frame.cables | (tension > 0)
        if (next_active == active).all():
            break
        active = next_active
    return moved, np.where(active, tension, 0.0), active


def load_factor(frame: Frame, basis: np.ndarray) -> float:
    """Return the largest multiple of the loads, up to 10, that bar forces and friction within its limits can balance.

    Loads are dead loads. Tensions of springs and bars are unlimited, those of cables are at least 0.

    :param basis: basis of the motions with free sliders
    """
    slides = frame.slides()
    rows = np.concatenate([frame.rows, *([np.array(frame.turns)] if frame.turns else []),
                           *([np.array(frame.latches)] if frame.latches else []), slides])
    bounds: list[tuple[float | None, float | None]] = [(0.0 if cable else None, None) for cable in frame.cables]
    bounds += [(None, None)] * (len(frame.turns) + len(frame.latches))
    for item, limit in frame.sliding:
        stopped = "clearance_minus_m" in item
        bounds.append((None, None) if stopped else (-limit, limit))
    force = basis.T @ frame.force
    if np.abs(force).max(initial=0.0) == 0:
        return float("inf")
    scale = float(np.abs(force).max())
    bounds = [tuple(None if side is None else side / scale for side in pair) for pair in bounds]  # type: ignore[misc]
    balance = np.hstack([(rows @ basis).T, -force[:, None] / scale])
    cost = np.zeros(balance.shape[1])
    cost[-1] = -1.0
    found = linprog(cost, A_eq=balance, b_eq=np.zeros(len(balance)), bounds=[*bounds, (0.0, 10.0)], method="highs")
    return float(found.x[-1]) if found.status == 0 else float("nan")


def _slid_start(frame: Frame, held: np.ndarray, free: np.ndarray, active: np.ndarray, class_a: bool) -> np.ndarray:
    """Return the initial displacement with slipping sliders. It minimises energy plus frictional heat: a least-squares
    problem with bounds on the friction forces."""
    basis, slides = (free, frame.slides()) if class_a else (held, np.zeros((0, frame.x.size)))
    drawn = np.where(active, frame.tension, 0.0)
    stiffness = basis.T @ (frame.elastic(active) + frame.geometric(drawn)) @ basis
    force = basis.T @ (frame.force - frame.rows.T @ drawn)
    if not len(slides):
        return np.asarray(basis @ np.linalg.solve(stiffness, force))
    factor = np.linalg.cholesky(stiffness)
    rows = np.linalg.solve(factor, (slides @ basis).T)
    limits = np.array([max(limit, 1e-12) for _, limit in frame.sliding])
    loads = np.linalg.solve(factor, force)
    found = lsq_linear(rows, loads, (-limits, limits), method="bvls").x
    return np.asarray(basis @ np.linalg.solve(factor.T, loads - rows @ found))


def _has_slack(frame: Frame, held: np.ndarray, active: np.ndarray) -> bool:
    """Return whether a bar with play carries no force at the start, from the minimum energy of bars with dead zones."""
    play = np.zeros(len(frame.stiffness))
    names = {link["name"]: number for number, link in enumerate(frame.document["link"])}
    for section, inner in (("revolute", "journal"), ("ball_joint", "ball")):
        for item in frame._items(section):
            play[names[item[f"{inner}_link"]]] += item["radial_clearance_m"]
    loose = np.flatnonzero(play > 0)
    if not len(loose):
        return False
    drawn = np.where(active, frame.tension, 0.0)
    stiffness = held.T @ (frame.elastic(active) + frame.geometric(drawn)) @ held
    force = held.T @ (frame.force - frame.rows.T @ drawn)
    factor = np.linalg.cholesky(stiffness)
    weights = np.sqrt(frame.stiffness[loose])
    rows = np.linalg.solve(factor, (weights[:, None] * (frame.rows[loose] @ held)).T)  # (unknowns, loose)
    loads = np.linalg.solve(factor, force)
    # Minimise ½ s·(1 - RᵀR)·s - s·Rᵀl over the dead zones s, in units of s times the root of the stiffness, with u =
    # K⁻¹(f + Bᵀ k s).
    matrix = np.eye(len(loose)) - rows.T @ rows
    values, vectors = np.linalg.eigh(matrix)
    root = np.sqrt(np.maximum(values, 1e-14))
    least = (vectors * root) @ vectors.T
    target = (vectors / root) @ vectors.T @ (rows.T @ loads)
    bound = weights * play[loose]
    found = lsq_linear(least, target, (-bound, bound), method="bvls").x
    return bool((np.abs(found) < (1 - 1e-6) * bound).any())


def _stands_heat(frame: Frame, held: np.ndarray, free: np.ndarray, active: np.ndarray, tension: np.ndarray) -> bool:
    """Return whether a structure is stable at the extremes of its temperature programs, without the cables slack there.
    Thermal displacements that make the structure much softer are not small: such a structure may snap through.

    :param free: basis of the displacements to examine
    """
    for heat in frame.thermal_tensions():
        # Yielding joints reduce bar forces, so held joints give the largest forces.
        moved, carried = basis_solution(frame, held, active, heat)
        carried = tension + carried
        if _flattens(frame, held, active, tension, moved):
            return False
        taut = active & (~frame.cables | (carried > 0))
        # The remaining tensions are not in equilibrium if other cables have become slack.
        if (taut != active).any() and softest(frame.elastic(taut), held) < FREE:
            return False
        if softest(frame.elastic(taut) + frame.geometric(np.where(taut, carried, 0.0)), free) < FREE:
            return False
    return True


def _flattens(frame: Frame, held: np.ndarray, active: np.ndarray, tension: np.ndarray, moved: np.ndarray) -> bool:
    """Return whether thermal displacements make a structure much softer on the way to an extreme temperature."""
    def least(there: Frame) -> float:
        return softest(there.elastic(active) + there.geometric(np.where(active, tension, 0.0)), held)

    drawn = least(frame)
    return any(least(frame.deformed(share * moved)) < FLATTENED * drawn for share in (0.25, 0.5, 0.75, 1.0))


def judge(document: Document) -> Verdict:
    """Return what theory says of a structure."""
    frame = Frame(document)
    held, free = frame.motions(False), frame.motions(True)
    moved, tension, active = _held_start(frame, held)
    stiffness = frame.elastic(active) + frame.geometric(tension)
    least, elastic = softest(stiffness, held), softest(frame.elastic(active), held)
    if elastic < FREE or least < SHALLOW * elastic:
        if frame.latches or frame.sliding or _has_play(document):
            return Verdict("undetermined")
        if elastic < FREE and abs(least) < FREE:
            return Verdict("mechanism")
        # If stability depends on tension, small displacements are not sufficient, and the loads are followed.
        followed = follow(frame, held)
        if followed is None:
            return Verdict("unstable")
        share = float(np.abs(followed).max()) / frame.size
        stands = share < FAR and _stands_heat(frame, held, held, active, tension)
        return Verdict("path" if stands else "undetermined", stands, start_share=share)
    factor = load_factor(frame, free) if frame.sliding else float("inf")
    class_a = softest(stiffness, free) > FREE
    if frame.sliding:  # directions held only by tension of bars are too soft compared with friction
        class_a = class_a and softest(frame.elastic(active), free) > FREE
    if class_a:
        factor = float("inf")
    if not factor >= 1 + MARGIN:
        return Verdict("overloaded" if factor < 1 - MARGIN else "undetermined", False, factor)
    try:
        start = float(np.abs(_slid_start(frame, held, free, active, class_a)).max()) / frame.size
        slack = _has_slack(frame, held, active)
    except np.linalg.LinAlgError:  # stable as loaded, not as drawn
        return Verdict("undetermined", class_a, factor)
    if not _stands_heat(frame, held, free if class_a else held, active, tension):
        return Verdict("undetermined", False, factor, start, slack)
    return Verdict("path" if start < FAR else "undetermined", class_a, factor, start, slack)


def basis_solution(frame: Frame, basis: np.ndarray, active: np.ndarray,
                   heat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the thermal displacement and forces (tensions) of a structure with held joints."""
    stiffness = basis.T @ frame.elastic(active) @ basis
    moved = basis @ np.linalg.lstsq(stiffness, -basis.T @ (frame.rows.T @ heat), rcond=1e-12)[0]
    return moved, np.asarray(heat + frame.stiffness * active * (frame.rows @ moved))
