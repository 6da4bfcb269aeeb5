# SPDX-License-Identifier: GPL-3.0-or-later
"""Sliders: frictional prismatic joints on ground or between two nodes."""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any, ClassVar

import numpy as np

from statejump.core import physics
from statejump.core.errors import NotAllowed
from statejump.core.notes import Note
from statejump.core.start import FRICTIONLESS
from statejump.core.units import text
from statejump.kinds.truss.arrays import GROUND, References, columns
from statejump.kinds.truss.joints.along_axis import AlongAxis, Axes
from statejump.kinds.truss.joints.protocol import (
    ALUMINIUM, IMPACT, USER, ContactPart, Contacts, Drawn, ItemColumn, Sampled, Strokes, Symbol, count, scaled, spread,
)
from statejump.kinds.truss.resolved import Course, ResolvedTruss
from statejump.results import scene as drawing
from statejump.schema.fields import CHOICE, definition, numbers, parameter, texts
from statejump.schema.items import Item

BLOCK: Strokes = (
    ((-0.75, -0.45), (0.75, -0.45), (0.75, 0.45), (-0.75, 0.45), (-0.75, -0.45)), ((-1.0, -0.55), (1.0, -0.55)),
    *(((x, -0.55), (x - 0.2, -0.75)) for x in (-0.7, -0.3, 0.1, 0.5, 0.9)),
)
STOPS: Strokes = (((-1.0, -0.55), (-1.0, 0.45)), ((1.0, -0.55), (1.0, 0.45)))


@definition
class Slider(Item):
    """A prismatic joint with friction: the first node slides along an axis fixed in space, on ground or on the second
    node. Between two nodes the joint also constrains both across the axis; on ground the supports of the node do."""

    nodes: list[str] = texts(..., "one node, on ground, or two")
    axis: list[float] = numbers(..., "-", -1e9, 1e9, "of any length")
    friction_coefficient: float = parameter(..., "-", 0, 10, USER)
    normal_force_N: float = parameter(..., "N", 0, 1e9, USER)
    clearance_minus_m: float | None = parameter(None, "m", 0, 1e2, "against the axis; no stop", above=True)
    clearance_plus_m: float | None = parameter(None, "m", 0, 1e2, "along the axis; no stop", above=True)
    stop_stiffness_N_per_m: float | None = parameter(
        None, "N/m", 0, 1e15, "of a stop itself, as the bearing of a bolt; rigid, in the DEM as stiff as the pad",
        above=True)
    play_m: float = parameter(0.0, "m", 0, 1e2, "lost motion at each reversal, which moves with the slide; none")
    pad_radius_m: float = parameter(0.05, "m", 0, 1e2, CHOICE + "; if not rigid, and in the DEM", above=True)
    young_modulus_Pa: float = parameter(70e9, "Pa", 0, 1e13, ALUMINIUM + "; if not rigid, and in the DEM", above=True)
    poisson_ratio: float = parameter(0.3, "-", -0.99, 0.49, ALUMINIUM + "; if not rigid, and in the DEM")


@dataclass(frozen=True)
class Sliders:
    """Prismatic joints. The slide, axis · (displacement of the first node - displacement of the second node), lies
    between -clearance_minus_m and clearance_plus_m. The friction limit is friction_coefficient · normal_force_N."""

    names: Sequence[str]
    nodes: np.ndarray  # (s, 2) int; the second is GROUND, or a node that the joint couples to the first across the axis
    axis: np.ndarray  # (s, 3) unit
    friction_coefficient: np.ndarray
    normal_force_N: np.ndarray
    clearance_minus_m: np.ndarray  # inf: no stop
    clearance_plus_m: np.ndarray  # inf: no stop
    stop_stiffness_N_per_m: np.ndarray  # inf: rigid
    play_m: np.ndarray
    pad_radius_m: np.ndarray
    young_modulus_Pa: np.ndarray
    poisson_ratio: np.ndarray

    @property
    def friction_limit_N(self) -> np.ndarray:
        """Coulomb's limit."""
        return np.asarray(self.friction_coefficient * self.normal_force_N)

    @property
    def have_stops(self) -> np.ndarray:
        """Whether each slider has a stop on at least one side."""
        return np.isfinite(self.clearance_minus_m) | np.isfinite(self.clearance_plus_m)

    @property
    def have_springs(self) -> np.ndarray:
        """Whether each slider has soft stops or a play. If so, it is a prismatic joint in the DEM, even on ground."""
        return np.isfinite(self.stop_stiffness_N_per_m) | (self.play_m > 0)

    def soft_stop_N(self, slide_m: np.ndarray) -> np.ndarray:
        """Return the force of soft stops on the sliders [N], positive against their axes. It is 0 for rigid stops."""
        soft = np.isfinite(self.stop_stiffness_N_per_m)
        beyond = slide_m - np.clip(slide_m, -self.clearance_minus_m, self.clearance_plus_m)
        return np.asarray(np.where(soft, self.stop_stiffness_N_per_m, 0.0) * beyond)

    def beside_soft_stops_N(self, state: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return the force on the sliders [N] without that of soft stops."""
        return np.asarray(state["slider_force_N"] - self.soft_stop_N(state["slide_m"]))


@dataclass(frozen=True)
class Pad:
    """Contacts of sliders with their floors: a spherical pad on a plane."""

    depth_m: np.ndarray  # depth [m] at which the floor carries the normal force
    normal_N_per_m: np.ndarray  # tangent stiffnesses at that depth
    tangential_N_per_m: np.ndarray


def _effective_modulus(sliders: Sliders) -> np.ndarray:
    return physics.effective_young_modulus_Pa(sliders.young_modulus_Pa, sliders.poisson_ratio)


def pad_hertz_stiffness(sliders: Sliders) -> np.ndarray:
    """Return K of the Hertz law F = K δ^1.5 [N/m^1.5] of every slider's pad on a plane, its floor or a stop. Both have
    one material. The formulas are those of Hertz and Mindlin, independent of the DEM's contact law."""
    return physics.hertz_stiffness_N_per_m15(_effective_modulus(sliders), sliders.pad_radius_m)


def pads(sliders: Sliders) -> Pad:
    """Return the contacts of the sliders' pads with their floors."""
    depth = physics.hertz_depth_m(sliders.normal_force_N, pad_hertz_stiffness(sliders))
    normal = physics.hertz_tangent_at_depth_N_per_m(_effective_modulus(sliders), sliders.pad_radius_m, depth)
    return Pad(depth, normal, normal * physics.shear_over_normal_stiffness(sliders.poisson_ratio))


def pressing_directions(truss: ResolvedTruss, sliders: Sliders) -> np.ndarray:
    """Return for every slider the direction normal to its axis in which its pad presses on its floor (s, 3)."""
    if truss.dimension == 2:
        return np.tile([0.0, 0.0, -1.0], (len(sliders.names), 1))
    found = []
    for axis in sliders.axis:
        across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
        found.append(across / np.linalg.norm(across))
    return np.array(found).reshape(-1, 3)


AT_STOP = (3, 4)  # numbers of the engine's statuses "at a stop"


def with_sliders(truss: ResolvedTruss, joints: Axes) -> ResolvedTruss:
    """Return the truss with additional sliders along the axes of given joints, without friction and stops."""
    sliders, count = truss.sliders, len(joints.names)
    nothing, no_stop = np.zeros(count), np.full(count, np.inf)
    more = {**dict.fromkeys(vars(sliders), nothing), "nodes": joints.nodes, "axis": joints.axis,
            "clearance_minus_m": no_stop, "clearance_plus_m": no_stop, "stop_stiffness_N_per_m": no_stop,
            "pad_radius_m": np.ones(count),
            "young_modulus_Pa": np.ones(count)}
    both: dict[str, Any] = {key: np.concatenate([value, more[key]]) for key, value in vars(sliders).items()
                            if key != "names"}
    return truss.with_joints(slider=Sliders(names=(*sliders.names, *joints.names), **both))


def _across_N(path: Course, joints: Sliders, which: np.ndarray) -> np.ndarray:
    """Return the largest force [N] (k,) across the axis of each slider, from links, elements and dead loads on its
    first node."""
    truss, states = path.truss, path.states
    largest = []
    for node, axis in zip(joints.nodes[which, 0], joints.axis[which]):
        load = np.tile(truss.nodes.force_N[node], (len(states["time_s"]), 1))
        for ends, pull in zip(truss.ends(), truss.tensions_N(states)):
            for item in np.flatnonzero((ends == node).any(axis=1)):
                own, other = ends[item] if ends[item, 0] == node else ends[item, ::-1]
                place = truss.nodes.position_m[[own, other]] + states["displacement_m"][:, [own, other]]
                way = place[:, 1] - place[:, 0]
                load = load + pull[:, item, None] * way / np.linalg.norm(way, axis=1, keepdims=True)
        across = load - (load @ axis)[:, None] * axis
        largest.append(float(np.linalg.norm(across, axis=1).max()))
    return np.array(largest)


class SliderType(AlongAxis[Slider, Sliders]):
    """Sliders, which solver, motion and DEM support. In the DEM, a slider on ground is a pad on a floor; a slider
    between two nodes is an engine of YADE."""

    section = "slider"
    noun = "a slider"
    Item = Slider
    Arrays = Sliders
    columns: ClassVar[tuple[ItemColumn, ...]] = (
        ItemColumn("slide_m"),
        ItemColumn("slider_force_N", "friction and stop on the slider, against its axis"),
    )
    varied = ("friction_coefficient", "normal_force_N", "clearance_minus_m", "clearance_plus_m",
              "stop_stiffness_N_per_m", "play_m")
    has_contacts = True

    def derived(self, items: Sequence[Slider], known: References) -> dict[str, Any]:
        stops = columns(items, "clearance_minus_m", "clearance_plus_m", "stop_stiffness_N_per_m")
        return {key: np.where(np.isnan(values), inf, values) for key, values in stops.items()}

    def check_geometry(self, truss: ResolvedTruss, joints: Sliders, ranges_K: np.ndarray) -> None:
        super().check_geometry(truss, joints, ranges_K)
        soft, played = np.isfinite(joints.stop_stiffness_N_per_m), joints.play_m > 0
        for index in np.flatnonzero(soft & ~joints.have_stops)[:1]:
            raise NotAllowed("stop_stiffness_N_per_m", float(joints.stop_stiffness_N_per_m[index]), code="stop_missing",
                             **self.where(joints.names[index]))
        for index in np.flatnonzero(played & (joints.friction_limit_N == 0))[:1]:
            raise NotAllowed("play_m", float(joints.play_m[index]), code="play_without_friction",
                             needed_keys="friction_coefficient and normal_force_N", **self.where(joints.names[index]))
        for index in np.flatnonzero(played & (truss.sticking == "partial_slip"))[:1]:
            raise NotAllowed("play_m", float(joints.play_m[index]), code="play_with_partial_slip",
                             **self.where(joints.names[index]))

    def engine_arrays(self, truss: ResolvedTruss, joints: Sliders) -> dict[str, Any]:
        # A play closes elastically, even if sticking is rigid otherwise.
        loaded = ((truss.sticking != "rigid") | (joints.play_m > 0)) & (joints.normal_force_N > 0)
        return {
            **super().engine_arrays(truss, joints),
            "friction_force_N": joints.friction_limit_N,
            "tangential_stiffness_N_per_m": np.where(loaded, pads(joints).tangential_N_per_m, inf),
            "partial_slip": (truss.sticking == "partial_slip") & (joints.friction_limit_N > 0),
        }

    def contacts(self, run: Sampled, joints: Sliders) -> Contacts:
        slide = run.columns["slide_m"]
        stops = np.minimum(slide + joints.clearance_minus_m, joints.clearance_plus_m - slide)
        floor = pressing_directions(run.truss, joints)
        return Contacts(
            gap_m=np.where(np.isfinite(stops), stops, np.nan),
            point_m=run.position_m[:, joints.nodes[:, 0]] + joints.pad_radius_m[:, None] * floor,
            normal_force_N=np.tile(-joints.normal_force_N[:, None] * floor, (len(slide), 1, 1)),
            tangential_force_N=-run.columns["slider_force_N"][:, :, None] * joints.axis,
        )

    def drawn(self, truss: ResolvedTruss, joints: Sliders, labels: Sequence[str], taken: set[str]) -> Drawn:
        parts: list[dict[str, Any]] = []
        contacts = []
        for label, ends, axis, radius in zip(labels, joints.nodes, joints.axis, joints.pad_radius_m):
            block, floor, held = f"block {label}", f"floor {label}", truss.nodes.position_m[ends[0]]
            parts += [{
                "name": block, "type": "block", "centre": drawing.ref("history/position_m", truss.nodes.names[ends[0]]),
                "angle_rad": float(np.arctan2(axis[1], axis[0])), "half_width_m": float(radius),
                "half_height_m": float(radius), "pad_radius_m": float(radius),
            }, {"name": floor, "type": "frame", "points": [(held - radius * axis).tolist(),
                                                           (held + radius * axis).tolist()]}]
            contacts.append((label, block, floor))
        return Drawn(parts, contacts, np.concatenate((joints.clearance_minus_m, joints.clearance_plus_m)))

    def symbols(self, truss: ResolvedTruss, joints: Sliders) -> list[Symbol]:
        places, up = self.places(truss, joints)
        stopped = np.isfinite(np.minimum(joints.clearance_minus_m, joints.clearance_plus_m))
        return [Symbol(places, BLOCK, 1.4, 0.7, marker_in_space="s", up=up, line_in_space=joints.axis),
                Symbol(places[stopped], STOPS, 1.9, 0.0, up=up[stopped])]

    def legend(self, joints: Sliders) -> str:
        said = f"slider, friction {scaled(joints.friction_coefficient * joints.normal_force_N, 1.0, 'N')}"
        stops = np.concatenate((joints.clearance_minus_m, joints.clearance_plus_m))
        if np.isfinite(stops).any():
            said += f", stops at {scaled(stops[np.isfinite(stops)], 1e3, 'mm')}"
        soft = np.isfinite(joints.stop_stiffness_N_per_m)
        if soft.any():
            said += f" of {scaled(joints.stop_stiffness_N_per_m[soft], 1e-6, 'N/µm')}"
        if (joints.play_m > 0).any():
            said += f", play {scaled(joints.play_m[joints.play_m > 0], 1e3, 'mm')}"
        return said

    def describe(self, items: Sequence[Slider]) -> str:
        stops = sum(side is not None for joint in items for side in (joint.clearance_minus_m, joint.clearance_plus_m))
        limits = (joint.friction_coefficient * joint.normal_force_N for joint in items)
        said = f"with {stops} stops" if stops else "without stops"
        soft = [joint.stop_stiffness_N_per_m for joint in items if joint.stop_stiffness_N_per_m is not None]
        if soft:
            said += f" that give way by {spread(soft, 'N/m')}"
        plays = [joint.play_m for joint in items if joint.play_m]
        if plays:
            said += f", with a play of {spread(plays, 'm')}"
        return f"{count(items, 'sliding joint')} held by friction up to {spread(limits, 'N')}, {said}."

    def friction_N(self, joints: Sliders, state: Mapping[str, np.ndarray]) -> np.ndarray:
        return np.where(self._stopped(state), 0.0, joints.beside_soft_stops_N(state))

    def carried_friction(self, joints: Sliders, at: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        limit = joints.friction_limit_N
        return np.minimum(np.abs(joints.beside_soft_stops_N(at)), limit), limit

    def without_friction(self, truss: ResolvedTruss) -> ResolvedTruss:
        sliders = truss.sliders
        return truss.with_joints(slider=replace(sliders, friction_coefficient=0 * sliders.friction_coefficient,
                                                play_m=0 * sliders.play_m))

    def unknown_friction(self, joints: Sliders, state: Mapping[str, np.ndarray]) -> Iterable[int]:
        return map(int, np.flatnonzero(self._stopped(state)))

    @staticmethod
    def _stopped(state: Mapping[str, np.ndarray]) -> np.ndarray:
        return np.isin(state["slider_status"], AT_STOP)

    def regularised_refuses(self, joints: Sliders) -> tuple[str, str] | None:
        between = joints.nodes[:, 1] != GROUND
        rigid_stops = joints.have_stops & np.isinf(joints.stop_stiffness_N_per_m)
        for why, which in (("is between two nodes", between), ("has rigid stops", rigid_stops)):
            for index in np.flatnonzero(which)[:1]:
                return joints.names[index], why
        return None

    def dem_refuses(self, joints: Sliders) -> tuple[str, str] | None:
        loose = ~self.bodies_touch(joints) & (joints.normal_force_N == 0)
        for index in np.flatnonzero(loose)[:1]:
            of = "is between two nodes" if joints.nodes[index, 1] != GROUND else "has stops of their own stiffness"
            return joints.names[index], (f"{of} and has no normal_force_N, from which the DEM takes how stiffly it "
                                         "holds its parts together across its axis")
        return None

    def contact_parts(self, joints: Sliders) -> list[ContactPart]:
        roles = list(zip(joints.pad_radius_m, joints.friction_coefficient, joints.young_modulus_Pa))
        nodes = np.where(self.bodies_touch(joints), joints.nodes[:, 0], GROUND)
        return [ContactPart(nodes, [("pad", *role) for role in roles], shared=False)]

    def bodies_touch(self, joints: Sliders) -> np.ndarray:
        return np.asarray((joints.nodes[:, 1] == GROUND) & ~joints.have_springs)

    def contact_nodes(self, joints: Sliders) -> np.ndarray:
        return joints.nodes[:, :1]

    def pushed_nodes(self, joints: Sliders) -> np.ndarray:
        return joints.nodes

    def reach_m(self, path: Course, joints: Sliders) -> np.ndarray:
        # The floor extends to twice the largest slide of the quasi-static model, plus the radius of the pad.
        return joints.pad_radius_m + 2 * np.abs(path.states["slide_m"]).max(axis=0)

    def contact_stiffness(self, path: Course, joints: Sliders) -> tuple[np.ndarray, np.ndarray]:
        force = IMPACT**3 * np.abs(path.states["slider_force_N"]).max(axis=0)
        hertz = physics.hertz_tangent_N_per_m(force, pad_hertz_stiffness(joints))
        own = np.where(np.isfinite(joints.stop_stiffness_N_per_m), joints.stop_stiffness_N_per_m, hertz)
        stop = np.where(joints.have_stops, own, 0.0)
        pad = pads(joints)
        across = np.where(self.bodies_touch(joints), 0.0, pad.normal_N_per_m)
        return self.pushed_nodes(joints), np.maximum(pad.tangential_N_per_m + stop, across)

    def gives_in_dem(self, path: Course, joints: Sliders, told_m: float) -> list[str]:
        between = np.flatnonzero(joints.nodes[:, 1] != GROUND)
        if not len(between):
            return []
        give = _across_N(path, joints, between) / pads(joints).normal_N_per_m[between]
        most = int(np.argmax(give))
        if not give[most] > told_m:
            return []
        return [Note("pads_bend", joint=joints.names[between[most]], bent=text(float(give[most]), "m", 2),
                     bent_m=float(give[most]))]

    def _start_slip_m(self, truss: ResolvedTruss, joints: Sliders, slide_m: np.ndarray, friction_N: np.ndarray
                      ) -> np.ndarray:
        """Return the slide [m] of each slider without friction force; with a play, the middle of its range."""
        bend = np.divide(friction_N, pads(joints).tangential_N_per_m, out=np.zeros_like(slide_m), where=friction_N != 0)
        closed = slide_m - bend - np.sign(friction_N) * joints.play_m / 2
        if truss.start_friction == FRICTIONLESS:
            return closed
        # A slider with an open play starts at its position in the reference configuration.
        return np.where((joints.play_m > 0) & (friction_N == 0), 0.0, closed)

    def scene(self, path: Course, joints: Sliders) -> dict[str, Any]:
        def finite(values: np.ndarray) -> list[float | None]:
            return [float(value) if np.isfinite(value) else None for value in values]

        pad, limit, slide = pads(joints), joints.friction_limit_N, path.states["slide_m"][0]
        start = {key: path.states[key][0] for key in ("slide_m", "slider_force_N")}
        friction = np.clip(joints.beside_soft_stops_N(start), -limit, limit)
        if path.truss.start_friction == FRICTIONLESS:
            friction = 0 * limit  # the stop carries the whole force
        return {
            "friction_limit_N": limit, "friction_stiffness_N_per_m": pad.tangential_N_per_m,
            "stiffness_across_N_per_m": pad.normal_N_per_m, "stop_stiffness_N_per_m15": pad_hertz_stiffness(joints),
            "own_stop_stiffness_N_per_m": finite(joints.stop_stiffness_N_per_m), "play_m": joints.play_m,
            "touches": self.bodies_touch(joints),
            "start_slide_m": slide, "start_slip_m": self._start_slip_m(path.truss, joints, slide, friction),
            "start_friction_N": friction,
            "depth_m": pad.depth_m, "reach_m": self.reach_m(path, joints),
            "floor_normal": pressing_directions(path.truss, joints),
            "clearance_minus_m": finite(joints.clearance_minus_m), "clearance_plus_m": finite(joints.clearance_plus_m),
        }


SLIDER = SliderType()
