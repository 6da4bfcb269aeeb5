# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies of a one-dimensional clearance joint."""
from __future__ import annotations

from yade import wrapper
from yade.minieigenHP import Quaternion, Vector3


def slot(
    center: Vector3,
    stopMinus: float | None,
    stopPlus: float | None,
    halfHeight: float,
    material: wrapper.Material,
    orientation: Quaternion = Quaternion((0, 0, 1), 0),
    ceiling: bool = False,
    halfSize: float | None = None,
) -> list[wrapper.Body]:
    """Return the fixed faces of a slot along the local x axis: floor, end stops, ceiling.

    A slider of radius R at the centre has the clearances ``stopMinus - R`` and ``stopPlus - R``
    to the stops and touches the floor when ``halfHeight == R``.

    :param center: centre of the slot [m]
    :param stopMinus: distance of the stop on the negative side from the centre [m]; None: no such stop
    :param stopPlus: distance of the stop on the positive side from the centre [m]; None: no such stop
    :param halfHeight: distance of the floor (and the ceiling) from the centre [m]
    :param material: a ThermalFrictMat, or the label or number of one in ``O.materials``
    :param orientation: orientation of the slot
    :param ceiling: whether there is a ceiling
    :param halfSize: extent of the faces from the centre, for the collider [m]; None: the distance of the most distant
        face
    :returns: bodies to append, in the order floor, minus stop, plus stop[, ceiling]; absent stops are omitted
    """
    if isinstance(material, (str, int)):
        material = wrapper.Omega().materials[material]
    faces = [((0, -1, 0), halfHeight)]
    faces += [
        ((side, 0, 0), stop) for side, stop in ((-1, stopMinus), (1, stopPlus)) if stop is not None
    ]
    if ceiling:
        faces.append(((0, 1, 0), halfHeight))
    half_size = max(distance for _, distance in faces) if halfSize is None else halfSize
    bodies = []
    for normal, distance in faces:
        body = wrapper.Body()
        body.shape = wrapper.SlotFace(normal=normal, distance=distance, halfSize=half_size)
        body.material = material
        body.state.pos = body.state.refPos = center
        body.state.ori = orientation
        body.state.blockedDOFs = "xyzXYZ"
        body.bound = wrapper.Aabb()
        bodies.append(body)
    return bodies
