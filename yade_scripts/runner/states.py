# SPDX-License-Identifier: GPL-3.0-or-later
"""States of a scene in many steps, as arrays: the samples of a StateRecorder."""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import statejump_yade as sj
from scene import O
from yade import wrapper

Pair = tuple[int, int]

# Numbers per row, see StateRecorder.
VECTOR, NUMBER = "3f8", "f8"
BODY = [("position", VECTOR), ("velocity", VECTOR), ("force", VECTOR)]
CONTACT = [("real", NUMBER), ("penetrationDepth", NUMBER), ("slipping", NUMBER), ("normal", VECTOR),
           ("normalForce", VECTOR), ("shearForce", VECTOR)]
LINK = [("axialForce", NUMBER), ("temperatureChange", NUMBER), ("extension", NUMBER), ("stressFreeLength", NUMBER)]
SPRING = [("angle", NUMBER), ("moment", NUMBER), ("frictionMoment", NUMBER)]
JOINT = [("slide", NUMBER), ("frictionForce", NUMBER), ("stopForce", NUMBER)]
BEAM = [("force1", VECTOR), ("moment1", VECTOR), ("force2", VECTOR), ("moment2", VECTOR)]
ROTATION = [("rotation", VECTOR), ("angularVelocity", VECTOR), ("torque", VECTOR)]


class Watched:
    """Parts of a scene to record; samples have the order of these lists."""

    def __init__(self, bodies: Iterable[int] = (), contacts: Iterable[Pair] = (),
                 links: Iterable[sj.ThermalLink] = (), springs: Iterable[sj.TorsionSpring] = (),
                 joints: Iterable[sj.PrismaticJoint] = (), beams: Iterable[sj.BeamBond] = (),
                 rotations: Iterable[int] = ()) -> None:
        self.bodies, self.contacts = list(bodies), list(contacts)
        self.links, self.springs, self.joints = list(links), list(springs), list(joints)
        self.beams, self.rotations = list(beams), list(rotations)


class States:
    """Samples. The axes of every array are sample, part and, for vectors, component."""

    def __init__(self, rows: np.ndarray, places: dict[Any, int]) -> None:
        self._rows, self._places = rows, places

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def times(self) -> np.ndarray:
        """Times [s]."""
        return self._rows["time"]

    def energy(self, *names: str) -> np.ndarray:
        """Return the sum of energies by their names in O.energy [J]."""
        return sum(self._rows[name] for name in names)

    def strangers(self) -> np.ndarray:
        """Return two bodies in contact whose contact is not recorded; -1 if there are none."""
        return np.stack([self._rows["stranger1"], self._rows["stranger2"]], axis=1).astype(int)

    def _of(self, sort: str, keys: Iterable[Any]) -> np.ndarray:
        return self._rows[sort][:, [self._places[sort, key] for key in keys]]

    def bodies(self, ids: Sequence[int]) -> np.ndarray:
        """Return ``position`` [m], ``velocity`` [m/s] half a step before the position, and ``force`` along free
        directions [N]."""
        return self._of("bodies", ids)

    def kinetic_energies(self, ids: Sequence[int]) -> np.ndarray:
        """Return the kinetic energies of bodies without rotation [J], at the time of the positions: YADE stores
        velocities half a step earlier."""
        bodies, masses = self.bodies(ids), np.array([O.bodies[body].state.mass for body in ids])
        velocities = bodies["velocity"] + (0.5 * O.dt / masses)[:, None] * bodies["force"]
        return 0.5 * masses * dot(velocities, velocities)

    def contacts(self, pairs: Iterable[Pair]) -> np.ndarray:
        """Return ``real`` and ``slipping`` (1 or 0), ``penetrationDepth`` [m] and, with YADE's signs, ``normal``,
        ``normalForce`` and ``shearForce`` [N]; zeros if the bodies do not touch."""
        return self._of("contacts", pairs)

    def links(self, links: Iterable[sj.ThermalLink]) -> np.ndarray:
        """Return ``axialForce`` [N], ``temperatureChange`` [K], ``extension`` and ``stressFreeLength`` [m]."""
        return self._of("links", map(id, links))

    def springs(self, springs: Iterable[sj.TorsionSpring]) -> np.ndarray:
        """Return ``angle`` [rad], ``moment`` and ``frictionMoment`` [N m]."""
        return self._of("springs", map(id, springs))

    def joints(self, joints: Iterable[sj.PrismaticJoint]) -> np.ndarray:
        """Return ``slide`` [m], ``frictionForce`` and ``stopForce`` [N]."""
        return self._of("joints", map(id, joints))

    def beams(self, beams: Iterable[sj.BeamBond]) -> np.ndarray:
        """Return ``force1``, ``moment1``, ``force2`` and ``moment2`` in the axes of the section [N, N m]."""
        return self._of("beams", map(id, beams))

    def rotations(self, ids: Iterable[int]) -> np.ndarray:
        """Return ``rotation`` (vector) [rad], ``angularVelocity`` [rad/s] half a step before it, and ``torque`` about
        free axes [N m]."""
        return self._of("rotations", ids)

    def rotary_energies(self, ids: Sequence[int]) -> np.ndarray:
        """Return the kinetic energies of rotation [J] of bodies with equal moments of inertia about all axes."""
        bodies, inertia = self.rotations(ids), np.array([O.bodies[body].state.inertia[0] for body in ids])
        spin = bodies["angularVelocity"] + (0.5 * O.dt / inertia)[:, None] * bodies["torque"]
        return 0.5 * inertia * dot(spin, spin)


class Recorder:
    """A StateRecorder, and the order of the values in its rows. Place ``engine`` right before the NewtonIntegrator.

    :param every: number of steps between samples
    """

    def __init__(self, every: int) -> None:
        self.engine: wrapper.Engine = sj.StateRecorder(iterPeriod=every)

    def watch(self, watched: Watched) -> None:
        """Set the objects to record from the next step on."""
        engine = self.engine
        engine.bodies, engine.contacts = watched.bodies, [body for pair in watched.contacts for body in pair]
        engine.links, engine.springs, engine.joints = watched.links, watched.springs, watched.joints
        engine.beams, engine.rotations = watched.beams, watched.rotations
        keys = {"bodies": watched.bodies, "contacts": watched.contacts, "links": map(id, watched.links),
                "springs": map(id, watched.springs), "joints": map(id, watched.joints),
                "beams": map(id, watched.beams), "rotations": watched.rotations}
        self._watched = watched  # keeps the objects alive, so that their ids stay unique
        self._places = {(sort, key): place for sort, all_keys in keys.items() for place, key in enumerate(all_keys)}
        self._row = np.dtype([(name, NUMBER) for name in engine.scalars()] + [
            (sort, part, (len(getattr(watched, sort)),))
            for sort, part in (("bodies", BODY), ("contacts", CONTACT), ("links", LINK), ("springs", SPRING),
                               ("joints", JOINT), ("beams", BEAM), ("rotations", ROTATION))
        ])
        assert self._row.itemsize == 8 * engine.width()

    @property
    def bytes_of_a_sample(self) -> int:
        """Memory of one sample [B]."""
        return self._row.itemsize

    @property
    def bytes_kept(self) -> int:
        """Memory of the samples since the last call of :meth:`take` [bytes]."""
        return self._row.itemsize * self.engine.rows()

    def take(self) -> States:
        """Return the samples since the last call."""
        return States(np.frombuffer(self.engine.take(), self._row), self._places)


def dot(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return scalar products along the last axis, summed in the same order as in Eigen."""
    return one[..., 0] * other[..., 0] + (one[..., 1] * other[..., 1] + one[..., 2] * other[..., 2])


def norm(vectors: np.ndarray) -> np.ndarray:
    """Return lengths along the last axis."""
    return np.sqrt(dot(vectors, vectors))


def in_order(values: np.ndarray) -> np.ndarray:
    """Return sums over the second axis, with terms added from the first to the last."""
    return 0.0 + np.cumsum(values, axis=1)[:, -1] if values.shape[1] else np.zeros(len(values))


def each(function: Any, *values: np.ndarray) -> np.ndarray:
    """Return a function of Python's ``math`` that works on arrays; results of NumPy differ between processors."""
    return np.array(list(map(function, *(some.tolist() for some in values))))
