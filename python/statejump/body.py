# SPDX-License-Identifier: GPL-3.0-or-later
"""Condensed bodies: linear structures of a finite-element model, reduced to their interface nodes.

::

    import statejump as sj

    body = sj.body.condense("panel.inp", ["HINGE_1", "HINGE_2", "TIP"], ["uniform", "thickness"], points="SURFACE")
    sj.body.write("panel.h5", body)
    body.measured, body.stiffness, body.free_shapes, body.plot()
    sj.body.check(body).frame()
    sj.body.import_body(["outboard.op4", "outboard.pch"])
    sj.body.from_arrays(["A", "B"], positions_m, stiffness)
"""
from __future__ import annotations

from statejump.bodies.body import CondensedBody, Measured, Mesh, Points, from_arrays
from statejump.bodies.condense.run import condense
from statejump.bodies.files import read_body as read, write_body as write
from statejump.bodies.importing import import_body
from statejump.bodies.quantities import BodyCheck, check

__all__ = ["BodyCheck", "CondensedBody", "Measured", "Mesh", "Points", "check", "condense", "from_arrays",
           "import_body", "read", "write"]


def __dir__() -> list[str]:
    return sorted(__all__)
