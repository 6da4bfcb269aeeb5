# SPDX-License-Identifier: GPL-3.0-or-later
"""Sliders of a truss in YADE. A slider on ground is a pad at a node, with a fixed floor and fixed stops. A slider
between two nodes, with soft stops or with play is a prismatic joint of the plugin; on ground, its second body is fixed.

A pad is held at the depth at which its floor carries the normal force.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator
from math import copysign, inf
from typing import Any

import numpy as np
import statejump_yade as sj
from failures import Names, SceneFailure, pair
from scene import O, fixed_point
from states import States, dot
from truss_joints.parts import AT_STOP, GROUND, SLIP, STICK, Joints, Row, give, material
from yade import wrapper
from yade.minieigenHP import Matrix3, Quaternion, Vector3


class Sliders(Joints):
    """Sliders, in the order of the case."""

    section = "slider"
    columns = (("slide_m", False), ("slider_force_N", False), ("slider_state", False))

    def __init__(self, case: dict[str, Any]) -> None:
        super().__init__(case)
        self._damping_ratio: float = case["dem"]["contact_damping_ratio"]
        self._slips_in_part: bool = case["dem"]["friction_law"] == "mindlin_deresiewicz"
        self._slots: list[list[wrapper.Body]] = []  # none of prismatic joints
        self._numbers: list[list[int]] = []  # of floor and stops
        self._between: dict[int, sj.PrismaticJoint] = {}  # by index

    def furnish(self, bodies: list[wrapper.Body], turn: Callable[[int, int], None],
                expand: Callable[[int, Row], None]) -> None:
        for slider in self.rows:
            if not slider["touches"]:
                self._slots.append([])
                continue
            node, radius = slider["nodes"][0], slider["pad_radius_m"]
            made = material(slider)
            give(bodies[node], sj.Slider(radius=radius), made, slider["group"])
            axis, down = Vector3(slider["axis"]), Vector3(slider["floor_normal"])
            across = axis.cross(-down)
            # Columns: axes x, y and z of the slot in space.
            turned = Matrix3(*(value for k in range(3) for value in (axis[k], -down[k], across[k])))
            stops = [
                None if slider[f"clearance_{side}_m"] is None else radius + slider[f"clearance_{side}_m"]
                for side in ("minus", "plus")
            ]
            slot = sj.slot(
                Vector3(self.nodes[node]["position_m"]), stopMinus=stops[0], stopPlus=stops[1],
                halfHeight=radius - slider["depth_m"], material=made, orientation=Quaternion(turned),
                halfSize=slider["reach_m"],
            )
            for face in slot:
                face.mask = 1 << slider["group"]
            self._slots.append(slot)

    def append(self, ids: list[int]) -> Iterator[tuple[int, int]]:
        self.ids = ids
        for place, (slider, slot) in enumerate(zip(self.rows, self._slots)):
            if not slot:
                self._numbers.append([])
                self._between[place] = self._joint(slider)
                continue
            self._numbers.append(list(O.bodies.append(slot)))
            for face in self._numbers[-1]:
                yield ids[slider["nodes"][0]], face

    def _joint(self, slider: Row) -> sj.PrismaticJoint:
        one, other = slider["nodes"]
        minus, plus = (inf if slider[key] is None else slider[key] for key in ("clearance_minus_m", "clearance_plus_m"))
        own = slider["own_stop_stiffness_N_per_m"]
        place = Vector3(self.nodes[one]["position_m"])
        second, offset = ((fixed_point(place), Vector3.Zero) if other == GROUND else
                          (self.ids[other], place - Vector3(self.nodes[other]["position_m"])))
        return sj.PrismaticJoint(
            id1=self.ids[one], id2=second, axis=Vector3(slider["axis"]), offset=offset,
            stiffnessAcross=slider["stiffness_across_N_per_m"], frictionLimit=slider["friction_limit_N"],
            frictionStiffness=slider["friction_stiffness_N_per_m"], clearanceMinus=minus, clearancePlus=plus,
            stopStiffness=slider["stop_stiffness_N_per_m15"] if own is None else 0.0, stopSpring=own or 0.0,
            play=slider["play_m"], dampingRatio=self._damping_ratio, frictionForce=slider["start_friction_N"],
            slipPosition=slider["start_slip_m"],
        )

    def start_slides(self) -> dict[int, tuple[float, float, float]]:
        return {
            self._pad(place): tuple(self._give_m(slider) * along for along in slider["axis"])
            for place, slider in enumerate(self.rows) if self._numbers[place] and slider["start_friction_N"]
        }

    def _give_m(self, slider: Row) -> float:
        """Return the tangential displacement [m] of a pad's contact along the axis under the initial friction."""
        friction, limit, sticks = (
            slider[key] for key in ("start_friction_N", "friction_limit_N", "friction_stiffness_N_per_m"))
        if not self._slips_in_part:
            return friction / sticks
        # Cattaneo's contact under a constant normal force.
        return copysign(1.5 * limit / sticks * (1 - (1 - abs(friction) / limit) ** (2 / 3)), friction)

    def prismatic_joints(self) -> list[sj.PrismaticJoint]:
        return list(self._between.values())

    def radii(self) -> list[float]:
        return [slider["pad_radius_m"] for slider in self.rows if slider["touches"]]

    def states(self, states: States) -> list[np.ndarray]:
        slide, force = np.empty((2, len(states), len(self.rows)))
        state = np.empty((len(states), len(self.rows)), dtype=int)
        between, ground = list(self._between), [place for place, faces in enumerate(self._numbers) if faces]
        joints = states.joints(self._between.values())
        slide[:, between], force[:, between] = joints["slide"], joints["frictionForce"] + joints["stopForce"]
        limits = np.array([joint.frictionLimit for joint in self._between.values()])
        slips = np.abs(joints["frictionForce"]) >= limits
        # With soft stops, the friction force determines the status, as in the reduced model.
        rigid = np.array([self.rows[place]["own_stop_stiffness_N_per_m"] is None for place in between], dtype=bool)
        state[:, between] = np.where((joints["stopForce"] != 0) & rigid, AT_STOP, np.where(slips, SLIP, STICK))

        axes, origins = np.empty((2, len(self.rows), 3))
        for place, slider in enumerate(self.rows):
            axes[place], origins[place] = slider["axis"], self.nodes[slider["nodes"][0]]["position_m"]
        positions = states.bodies([self._pad(place) for place in ground])["position"]
        slide[:, ground] = dot(positions - origins[ground], axes[ground])
        floors = self._contacts(states, ground, 0)
        # YADE stores contact forces on the face; along the axis they are opposite to those on the slider.
        force[:, ground] = dot(floors["shearForce"], axes[ground])
        state[:, ground] = np.where(floors["slipping"] > 0, SLIP, STICK)
        for stop in (1, 2):
            stopped = [place for place in ground if len(self._numbers[place]) > stop]
            forces = self._contacts(states, stopped, stop)["normalForce"]
            touches = dot(forces, forces) > 0
            force[:, stopped] = np.where(touches, force[:, stopped] + dot(forces, axes[stopped]), force[:, stopped])
            state[:, stopped] = np.where(touches, AT_STOP, state[:, stopped])
        return [slide, force, state]

    def _pad(self, place: int) -> int:
        return self.ids[self.rows[place]["nodes"][0]]

    def _contacts(self, states: States, places: list[int], face: int) -> np.ndarray:
        """Return the contacts of the given sliders with their floors (face 0) or with one of their stops."""
        return states.contacts((self._pad(place), self._numbers[place][face]) for place in places)

    def faults(self, states: States) -> Iterator[SceneFailure]:
        ground = [place for place, faces in enumerate(self._numbers) if faces]
        lost = self._contacts(states, ground, 0)["real"] == 0
        if not lost.any():
            return
        sample, which = np.unravel_index(lost.argmax(), lost.shape)
        name = self.rows[ground[which]]["names"]
        yield SceneFailure(f"slider {name!r} has left its floor: the contact is lost", name,
                           time_s=states.times[sample], code="contact_lost")

    def faces(self) -> dict[int, tuple[str, str]]:
        found = {}
        for slider, numbers in zip(self.rows, self._numbers):
            if not numbers:
                continue
            (floor, *stops), name = numbers, slider["names"]
            found[floor] = name, f"the floor of slider {name!r}"
            sides = [side for side in ("minus", "plus") if slider[f"clearance_{side}_m"] is not None]
            for side, stop in zip(sides, stops):
                found[stop] = name, f"stop_{side} of slider {name!r}"
        return found

    def name(self, found: Names) -> None:
        words = self.faces()
        for place, joint in self._between.items():
            name = self.rows[place]["names"]
            found.add_prismatic_joint(joint, f"slider {name!r}", name)
        for slider, numbers in zip(self.rows, self._numbers):
            for face in numbers:
                found.joints[pair(self.ids[slider["nodes"][0]], face)] = words[face]
