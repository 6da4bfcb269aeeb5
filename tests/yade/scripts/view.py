# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a joint and a slot in the 3-D view, under an X server without a screen. Usage: `view.py FOLDER`.

YADE's user interface is loaded before this script imports the plugin.
"""
import os
import sys

import statejump_yade as sj
from PyQt5.QtCore import QTimer
from PyQt5.QtWidgets import QApplication
from yade import qt

from yade.minieigenHP import Quaternion

from parts import *  # noqa: F403

ORANGE, BLUE, GREEN = (0.9, 0.6, 0.2), (0.3, 0.5, 0.9), (0.2, 0.8, 0.3)
reset()
metal = material(expansion=1e-5)
pin = body(
    (1.005e-4, 0, 0), sj.Journal(radius=R1, halfLength=7e-3, color=ORANGE), metal, mass=0.02,
    blocked="zXYZ",
)
body((0, 0, 0), sj.Bearing(radius=R2, color=BLUE), metal)
engines()
O.dt = 1e-7
# What the scene shows in turn; the slot is wider than the joint.
pictures = ["plain", "magnified", "slider", "ball", "mesh"]
view = qt.View()
view.axes, view.grid = False, (False, False, False)
view.screenSize = (600, 600)


def look(distance):
    # A wide scene keeps the near plane away from the joint.
    view.sceneRadius = 0.05
    view.upVector = (0, 1, 0)
    view.viewDir = (0, 0, -1)
    view.eyePosition = (0, 0, distance)


def picture(index):
    global magnified
    name = pictures[index]
    if name == "magnified":
        sj.Gl1_Journal.clearanceScale = 10
        magnified = sj.Gl1_Journal.clearanceScale
    if name == "slider":
        # Face on to the block; the floor and both stops are seen from their edges.
        O.bodies.erase(pin)
        O.bodies.erase(pin + 1)
        body((0, 0, 0), sj.Slider(radius=R1, color=GREEN), metal)
        O.bodies.append(sj.slot((0, 0, 0), 2 * R1, 2 * R1, R1, metal))
    if name in ("ball", "mesh"):
        for old in list(O.bodies):
            O.bodies.erase(old.id)
        inner, outer, turned = {
            "ball": (sj.Ball(radius=0.9 * R1, color=ORANGE), sj.Socket(radius=R2, color=BLUE), 0.0),
            # Half a millimetre deep lobes, seen aslant into the bore.
            "mesh": (sj.Journal(radius=0.8 * R1, halfLength=3e-3, color=ORANGE),
                     sj.MeshBore(**sj.bore_triangles(R2, 10e-3, 120, 12, lobes=[(3, 4e-4, 0)]), color=BLUE), 0.5),
        }[name]
        sj.Gl1_Journal.clearanceScale = 1
        tilt = Quaternion((1, 0, 0), turned)
        for shape in (inner, outer):
            body((0, 0, 0), shape, metal, orientation=tilt)
    look(0.06)
    O.step()
    QTimer.singleShot(700, lambda: save(index))


def save(index):
    view.saveSnapshot(os.path.join(sys.argv[1], pictures[index] + ".jpg"))  # of the next frame
    QTimer.singleShot(700, lambda: go_on(index + 1))


def go_on(index):
    if index < len(pictures):
        picture(index)
    else:
        O.run(50, True)
        finish({"pictures": pictures, "iteration": O.iter, "scale": magnified})
        os._exit(0)


QTimer.singleShot(1500, lambda: picture(0))
QApplication.instance().exec_()
