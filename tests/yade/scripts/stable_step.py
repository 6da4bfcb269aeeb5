# SPDX-License-Identifier: GPL-3.0-or-later
"""A spring-slider case at rest, after one step: contact stiffnesses, and the stable time step that the run reports."""
import json
import sys

import scene_spring_slider
import statejump_yade as sj

from parts import O, finish

O.reset()
built = scene_spring_slider.build(json.loads(sys.argv[-1]), [])
O.step()
floor = O.interactions[built.slider, built.floor].phys
finish({"kn": floor.kn, "ks": floor.ks, "force": floor.normalForce.norm(), "stable": sj.stable_time_step()})
