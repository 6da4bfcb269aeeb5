# SPDX-License-Identifier: GPL-3.0-or-later
"""Sliders of a truss in YADE: a pad at a node, its floor and its stops, which do not move.

A pad is held at the depth at which its floor carries the normal force.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import statejump_yade as sj
from failures import Names, SceneFailure, pair
from scene import O
from truss_joints.parts import AT_STOP, SLIP, STICK, Joints, Row, contact, give, material
from yade import wrapper
from yade.minieigenHP import Matrix3, Quaternion, Vector3


class Sliders(Joints):
    """Sliders on ground."""

    section = "slider"
    columns = (("slide_m", False), ("slider_force_N", False), ("slider_state", False))

    def __init__(self, case: dict[str, Any]) -> None:
        super().__init__(case)
        self._slots: list[list[wrapper.Body]] = []
        self._numbers: list[list[int]] = []  # of floor and stops

    def furnish(self, bodies: list[wrapper.Body], turn: Callable[[int, int], None],
                expand: Callable[[int, Row], None]) -> None:
        for slider in self.rows:
            node, radius = slider["nodes"][0], slider["pad_radius_m"]
            made = material(slider)
            give(bodies[node], sj.Slider(radius=radius), made, slider["group"])
            axis, down = Vector3(slider["axis"]), Vector3(slider["floor_normal"])
            across = axis.cross(-down)
            # Columns: the slot's x, y and z in space.
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
        for slider, slot in zip(self.rows, self._slots):
            self._numbers.append(list(O.bodies.append(slot)))
            for face in self._numbers[-1]:
                yield ids[slider["nodes"][0]], face

    def radii(self) -> list[float]:
        return [slider["pad_radius_m"] for slider in self.rows]

    def states(self) -> list[tuple[Any, ...]]:
        return [self._state(slider, self.ids[slider["nodes"][0]], *numbers)
                for slider, numbers in zip(self.rows, self._numbers)]

    def _state(self, slider: Row, body: int, floor: int, *stops: int) -> tuple[Any, ...]:
        axis, origin = Vector3(slider["axis"]), Vector3(self.nodes[slider["nodes"][0]]["position_m"])
        touching = contact(body, floor)
        if touching is None:
            raise SceneFailure(f"slider {slider['names']!r} has left its floor: the contact is lost", slider["names"])
        # Forces of a contact act on the face: along the axis they are against the slider's.
        force = touching.phys.shearForce.dot(axis)
        at_stop = False
        for face in stops:
            stop = contact(body, face)
            if stop is not None and stop.phys.normalForce.squaredNorm() > 0:
                force += stop.phys.normalForce.dot(axis)
                at_stop = True
        state = AT_STOP if at_stop else SLIP if touching.phys.slipping else STICK
        return (O.bodies[body].state.pos - origin).dot(axis), force, state

    def faces(self) -> dict[int, tuple[str, str]]:
        found = {}
        for slider, (floor, *stops) in zip(self.rows, self._numbers):
            name = slider["names"]
            found[floor] = name, f"the floor of slider {name!r}"
            sides = [side for side in ("minus", "plus") if slider[f"clearance_{side}_m"] is not None]
            for side, stop in zip(sides, stops):
                found[stop] = name, f"stop_{side} of slider {name!r}"
        return found

    def name(self, found: Names) -> None:
        words = self.faces()
        for slider, numbers in zip(self.rows, self._numbers):
            for face in numbers:
                found.joints[pair(self.ids[slider["nodes"][0]], face)] = words[face]
