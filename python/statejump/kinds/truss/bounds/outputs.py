# SPDX-License-Identifier: GPL-3.0-or-later
"""Outputs of a truss that are bounded: linear functions of the displacements of nodes, scalars or vectors."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from statejump.core.errors import NotAllowed, StatejumpError
from statejump.kinds.truss.bounds.sliding import AXES, Sliding
from statejump.kinds.truss.references import known_name
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.surface.design import DEFINITIONS, Design
from statejump.surface.motion import rotation_rad
from statejump.surface.zernike import MOST, fitted

SHOWN = 3  # nodes, if no output is chosen
DENSE = 2e7  # entries of the compliance of all dofs for which the most moved nodes are found
BEST_FIT = "rigid_focal"  # definition of rms and tilt, as in ``statejump truss answers``
NORMAL = "normal"  # measure of the surface


@dataclass(frozen=True)
class Output:
    """A linear function e of the displacements of nodes. A vector output is the Euclidean norm of changes of e.

    :param unit: "m" or "rad"
    :param nodes: their numbers (n,)
    :param weight: (m, n, 3); m = 1: a scalar
    """

    name: str
    unit: str
    nodes: np.ndarray
    weight: np.ndarray

    @property
    def scalar(self) -> bool:
        """Whether the output is one number."""
        return len(self.weight) == 1

    def rows(self, of: Linear) -> np.ndarray:
        """Return E (m, dofs) of e = E q."""
        places = (3 * self.nodes[:, None] + np.arange(3)).ravel()
        return np.asarray(of.of_nodes[places].T @ self.weight.reshape(len(self.weight), -1).T).T

    def vector(self, displacement_m: np.ndarray) -> np.ndarray:
        """Return e (..., m) at displacements (..., nodes, 3)."""
        moved = np.asarray(displacement_m)[..., self.nodes, :]
        return np.asarray(np.einsum("...ni,mni->...m", moved, self.weight))

    def value(self, displacement_m: np.ndarray) -> np.ndarray:
        """Return a scalar output at displacements (..., nodes, 3)."""
        return self.vector(displacement_m)[..., 0]

    def change(self, first_m: np.ndarray, second_m: np.ndarray) -> float:
        """Return the size of the change of e between two displacements (nodes, 3)."""
        return float(np.linalg.norm(self.vector(second_m) - self.vector(first_m)))

    def along(self, direction: np.ndarray) -> Output:
        """Return the scalar output d · e."""
        return Output(self.name, self.unit, self.nodes, np.tensordot(direction, self.weight, axes=1)[None])


class Linear(Protocol):
    """A truss whose dofs give the displacements of nodes."""

    @property
    def truss(self) -> ResolvedTruss:
        """The truss."""

    @property
    def of_nodes(self) -> Any:
        """Displacements of the nodes by the dofs (3 nodes, dofs)."""


def chosen(of: Linear, names: Sequence[str], spread_m: Callable[[], np.ndarray]) -> list[Output]:
    """Return the outputs of given names, or those of the nodes with the largest spread.

    :param spread_m: returns the spreads (nodes, 3)
    :raises NotAllowed: a name is none of the outputs
    :raises StatejumpError: the truss has no such surface
    """
    if not names:
        return _largest(of.truss.nodes.names, spread_m())
    numbers = {name: number for number, name in enumerate(list(of.truss.nodes.names))}
    return [output for name in names for output in _named(of, name, numbers)]


def _named(of: Linear, name: str, numbers: Mapping[str, int]) -> list[Output]:
    """Return the outputs of a name. ``numbers``: of all nodes by name."""
    what, _, rest = name.partition(":")
    if what == "node":
        return _of_node(of, name, rest, numbers)
    if what not in ("rms", "tilt", "zernike", "point"):
        raise NotAllowed("output", name, code="bounds_bad_output")
    design, nodes = _surface(of)
    unit = "m" if what in ("rms", "zernike") else "rad"
    return [Output(name, unit, nodes, _of_surface(design, name, what, rest))]


def _of_node(of: Linear, name: str, rest: str, numbers: Mapping[str, int]) -> list[Output]:
    node, axes, joined = rest, AXES[:of.truss.dimension], False
    head, _, tail = rest.rpartition(".")
    if rest not in numbers and head and tail and set(tail) <= set(AXES) and len(set(tail)) == len(tail):
        node, axes, joined = head, tail, len(tail) > 1
    known_name("output", name, node, numbers, "node", case=of.truss.name)
    index = numbers[node]
    free = [axis for axis in axes if abs(of.of_nodes[3 * index + AXES.index(axis)]).sum() > 0]
    if not free:
        raise NotAllowed("output", name, code="bounds_bad_output")
    parts = [_axis(f"node:{node}.{axis}", index, axis) for axis in free]
    if not joined:
        return parts
    return [Output(name, "m", parts[0].nodes, np.concatenate([part.weight for part in parts]))]


def _axis(name: str, node: int, axis: str) -> Output:
    return Output(name, "m", np.array([node]), np.eye(3)[None, AXES.index(axis)][:, None])


def _surface(of: Linear) -> tuple[Design, np.ndarray]:
    reflector = of.truss.reflector
    if reflector is None:
        raise StatejumpError(code="reflector_missing", case=of.truss.name)
    nodes = np.asarray(reflector.nodes, dtype=int)
    return Design.of(of.truss.nodes.position_m[nodes], reflector.axis, reflector.focal_length_m), nodes


def _of_surface(design: Design, name: str, what: str, rest: str) -> np.ndarray:
    """Return the weights (m, nodes, 3) of an output of the surface: its values at unit displacements of the nodes."""
    count = len(design.position_m)
    units = np.eye(3 * count).reshape(3 * count, count, 3)
    if what == "rms" and (rest or BEST_FIT) in DEFINITIONS:
        residual, _ = design.best_fits(units, NORMAL)
        return np.asarray(residual[rest or BEST_FIT].T).reshape(count, count, 3) / np.sqrt(count)
    if what == "tilt" and not rest:
        _, moves = design.best_fits(units, NORMAL)
        return np.array([moves[BEST_FIT][f"tilt{place}"].reshape(count, 3) for place in range(len(design.frame) - 1)])
    if what == "zernike" and rest.isdecimal() and 1 <= int(rest) <= MOST:
        return _zernike(design, int(rest))
    if what == "point":
        return _pointing(design, units, name, rest)
    raise NotAllowed("output", name, code="bounds_bad_output")


def _zernike(design: Design, term: int) -> np.ndarray:
    """Return the weights of a term, fitted with as many whole orders as the nodes determine, at least up to it."""
    if design.profile:
        raise StatejumpError(code="profile_without_zernike")
    middle, radius = design.aperture_m
    points, units = (design.local_m[:, :-1] - middle) / radius, np.eye(len(design.position_m))
    found = fitted(points, units)
    if len(found) < term:
        found = fitted(points, units, term)
    normals = design.normals
    return np.asarray(found[term - 1][:, None] * (normals @ design.frame) / normals[:, -1:])[None]


def _pointing(design: Design, units: np.ndarray, name: str, rest: str) -> np.ndarray:
    """Return the weights of the rotation of a direction, the axis or ``X,Y,Z``, with the best rigid motion."""
    try:
        way = np.array([float(part) for part in rest.split(",")]) if rest else np.asarray(design.frame[-1])
    except ValueError:
        raise NotAllowed("output", name, code="bounds_bad_output") from None
    if way.shape != (3,) or not np.isfinite(way).all() or not np.linalg.norm(way) > 0:
        raise NotAllowed("output", name, code="bounds_bad_output")
    turned = np.cross(rotation_rad(design.position_m, units), way / np.linalg.norm(way))
    return np.asarray(turned.T).reshape(3, len(design.position_m), 3)


def _largest(nodes: Sequence[str], spread_m: np.ndarray) -> list[Output]:
    axes = spread_m.argmax(axis=1)
    most = np.argsort(-spread_m.max(axis=1), kind="stable")[:SHOWN]
    return [_axis(f"node:{nodes[node]}.{AXES[axes[node]]}", int(node), AXES[axes[node]])
            for node in most if spread_m[node, axes[node]] > 0]


def spreads_m(of: Sliding) -> np.ndarray:
    """Return half of the spreads of all nodes (nodes, 3).

    :raises NotAllowed: the truss is too large
    """
    if of.slides.shape[0] * of.slides.shape[1] > DENSE:
        raise NotAllowed("output", code="bounds_output_missing")
    found = np.abs(of.of_nodes[:3 * len(of.truss.nodes.names)] @ of.by_friction) @ of.limit_N
    return np.asarray(found).reshape(-1, 3)
