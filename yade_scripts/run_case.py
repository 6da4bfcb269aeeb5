"""Runs one case in YADE and writes its history; started by ``statejump dem CASE``.

    STATEJUMP_CASE_JSON=case.json STATEJUMP_OUTPUT=history.csv yade -n -x yade_scripts/run_case.py

The resolved case comes as JSON. Samples go to ``<output>.partial`` as they are taken; at the end
the file is renamed. Lines on standard output: ``PROGRESS <fraction>`` and ``ERROR <sentence>``.
"""
import csv
import json
import os
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parent))
import scene
import statejump_yade as sj

COLUMNS = (
    "time_s", "temperature_change_K", "displacement_m", "axial_force_N", "friction_force_N",
    "stop_force_N", "elastic_energy_J", "friction_dissipation_J", "damping_dissipation_J",
    "kinetic_energy_J", "thermal_work_J", "external_work_J", "contact_energy_J",
    "preload_energy_J", "slipping", "stop_contact", "floor_normal_force_N",
)


def sample(case, built):
    """Return one row: the state of the current step. Forces on the block, axial force in
    compression positive; the contact's stored forces act on the face."""
    state = O.bodies[built.slider].state
    contacts = {}
    for face in (built.floor, built.stop_minus, built.stop_plus):
        if O.interactions.has(built.slider, face):
            contact = O.interactions[built.slider, face]
            if contact.isReal:
                contacts[face] = contact.phys
    floor = contacts.get(built.floor)
    if floor is None:
        raise RuntimeError(
            f"the slider has left the floor of its slot at {O.time:.6g} s, temperature change "
            f"{built.link.temperatureChange:.6g} K: the contact is lost"
        )
    stops = [contacts[face] for face in (built.stop_minus, built.stop_plus) if face in contacts]
    energy = {name: O.energy[name] for name in O.energy.keys()}
    bar, preload = built.link, built.preload_link
    stiffness = bar.youngModulus * bar.crossSectionArea / bar.previousStressFreeLength
    elastic = 0.5 * stiffness * bar.previousExtension**2
    preload_energy = 0.0
    if preload is not None:
        preload_energy = 0.5 * case["joint"]["preload_stiffness_N_per_m"] * preload.previousExtension**2
    return (
        O.time,
        bar.temperatureChange,
        state.pos[0],
        bar.axialForce,
        -floor.shearForce[0],
        -sum(stop.normalForce[0] for stop in stops),
        elastic,
        energy["jointFriction"],
        energy["jointDamping"] + energy["linkDamping"],
        0.5 * state.mass * (state.vel[0] ** 2 + state.vel[1] ** 2),
        energy.get("linkThermalWork", 0.0) + energy.get("jointThermalWork", 0.0),
        -case["joint"]["normal_force_N"] * (state.pos[1] - built.start_height_m),
        energy["jointElastic"],
        preload_energy,
        int(floor.slipping),
        int(bool(stops)),
        floor.normalForce.norm(),
    )


def run(case, output):
    """Build the scene, run it, write the history and its summary."""
    dem = case["dem"]
    steps = dem["number_of_steps"]
    # The caller makes the steps a multiple of the samples, so that the last one is the end.
    every, rest = divmod(steps, dem["samples_per_cycle"] * case["thermal"]["cycles"])
    if every == 0 or rest != 0:
        raise ValueError(f"dem.number_of_steps = {steps} is not a multiple of the samples")
    partial = output.with_name(output.name + ".partial")
    with partial.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(COLUMNS)
        recorder = PyRunner(
            command="record()", iterPeriod=every, initRun=True, label="recorder"
        )
        built = scene.spring_slider(case, [recorder])
        reported = [-1.0]

        def record():
            writer.writerow([repr(value) for value in sample(case, built)])
            fraction = O.iter / steps
            if fraction - reported[0] >= 0.01:
                reported[0] = fraction
                stream.flush()
                print(f"PROGRESS {fraction:.4f}", flush=True)

        globals()["record"] = record
        started = time.perf_counter()
        O.run(steps + 1, True)  # the recorder sees the end of the program one step later
        elapsed = time.perf_counter() - started
        if O.iter != steps + 1:  # an error in the first steps can end the run without a word
            raise RuntimeError(f"YADE stopped after {O.iter} of {steps + 1} steps")
    os.replace(partial, output)
    summary = {
        "steps": O.iter,
        "time_step_s": O.dt,
        "wall_time_s": elapsed,
        "yade_version": __import__("yade").config.version,
        "stable_time_step_s": sj.stable_time_step(),
    }
    side = output.with_name(output.name + ".json")
    side.with_name(side.name + ".partial").write_text(json.dumps(summary, indent=2) + "\n")
    os.replace(side.with_name(side.name + ".partial"), side)


try:
    run(
        json.loads(Path(os.environ["STATEJUMP_CASE_JSON"]).read_text()),
        Path(os.environ["STATEJUMP_OUTPUT"]),
    )
except Exception as error:  # one sentence for the caller, whatever went wrong
    print(f"ERROR {' '.join(str(error).split())}", flush=True)
    os._exit(2)
print("PROGRESS 1.0000", flush=True)
