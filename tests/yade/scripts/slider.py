# SPDX-License-Identifier: GPL-3.0-or-later
"""Table 1 through scene.py: a short version of the orbit."""
import scene_spring_slider
import statejump_yade as sj
from yade import wrapper

from parts import O, finish


def case(friction, period, steps):
    return {
        "thermal": {"shape": "half_sine", "temperature_change_max_K": 100.0, "cycles": 1},
        "link": {
            "stress_free_length_m": 0.5, "young_modulus_Pa": 70e9, "cross_section_area_m2": 9e-6,
            "thermal_expansion_per_K": 23.4e-6,
        },
        "joint": {
            "pad_radius_m": 0.05, "pad_thermal_expansion_per_K": 0.0,
            "slot_thermal_expansion_per_K": 0.0, "young_modulus_Pa": 70e9, "poisson_ratio": 0.3,
            "friction_coefficient": friction, "normal_force_N": 100.0, "clearance_minus_m": 1e-3,
            "clearance_plus_m": 1e-3, "stop_stiffness_N_per_m": None, "play_m": 0.0,
            "preload_stiffness_N_per_m": 0.0, "preload_force_N": 0.0,
        },
        "period_s": period,
        "dem": {
            "tip_mass_kg": 0.004, "link_damping_ratio": 0.2,
            "contact_damping_ratio": 0.2, "time_step_s": period / steps, "start_displacement_m": 0.0,
            "start_slide_m": 0.0,
        },
    }


def orbit(friction, period, steps):
    O.reset()
    resolved = case(friction, period, steps)
    resolved["bar_program"] = resolved["thermal"]
    recorder = wrapper.PyRunner(command="read()", iterPeriod=250, initRun=True)
    built = scene_spring_slider.build(resolved, [recorder])
    rows = []

    def read():
        if not O.interactions.has(built.slider, built.floor):
            return
        floor = O.interactions[built.slider, built.floor]
        stop = O.interactions.has(built.slider, built.stop_plus) and O.interactions[
            built.slider, built.stop_plus
        ].isReal
        rows.append(
            [
                built.link.temperatureChange,
                O.bodies[built.slider].state.pos[0],
                built.link.axialForce,
                int(floor.phys.slipping),
                int(bool(stop)),
            ]
        )
    __import__("__main__").read = read
    O.run(steps + 1, True)  # the recorder sees the end one step later
    energy = {name: O.energy[name] for name in O.energy.keys()}
    floor = O.interactions[built.slider, built.floor].phys
    return {"rows": rows, "energy": energy, "stable": sj.stable_time_step(), "dt": O.dt,
            "friction_stiffness": floor.ks}


finish({"friction": orbit(0.3, 0.5, 100000), "frictionless": orbit(0.0, 0.5, 100000)})
