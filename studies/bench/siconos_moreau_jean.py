#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the Moreau–Jean schemes of this project and of Siconos; writes results/motion/siconos.md and siconos.csv.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/siconos_moreau_jean.py

A bearing hangs on an elastic link; a journal bounces in it, and a second journal bounces in a bore of the first. The
model has rigid contact, Coulomb friction, Newton's restitution and five degrees of freedom. Both schemes use the same
theta and time steps. This program needs Siconos (Debian: python3-siconos).
"""
from __future__ import annotations

import argparse
from importlib.util import find_spec
from pathlib import Path
from subprocess import run
from time import process_time
from typing import Any

import numpy as np
import statejump as sj
from run import REPOSITORY, BenchError, publish, start
from statejump.core.errors import StatejumpError
from statejump.kinds.truss import motion

PERIOD_S, CLEARANCE_M, FRICTION, RESTITUTION = 0.05, 1e-3, 0.2, 0.6
MASS_KG = {"B": 0.5, "J": 0.2, "K": 0.1}  # of the bearing besides its link
LINK_KG, STIFFNESS_N_PER_M = 0.3, 70e9 * 1e-6 / 1.0
FORCE_N = {"B": (0.0, 0.0), "J": (1.0, -2.0), "K": (-0.4, -0.9)}
STEPS = (1_000, 2_000, 4_000, 8_000)
APART_M = 1e-9  # a millionth of the clearance
COLUMNS = ("steps", "friction_coefficient", "first_impact_s", "after_first_impact_m", "together_s", "impacts_together",
           "impacts", "us_per_step", "siconos_us_per_step")


def case(friction: float) -> Any:
    """Return the mechanism as a case."""
    nodes: list[dict[str, Any]] = [{"name": "A", "position_m": [-1.0, 0.0, 0.0], "fixed": ["x", "y", "z"]}]
    for name in MASS_KG:
        held: dict[str, Any] = {"fixed": ["y", "z"]} if name == "B" else {"guide_normal": [0.0, 0.0, 1.0]}
        nodes.append({"name": name, "position_m": [0.0, 0.0, 0.0], "force_N": [*FORCE_N[name], 0.0],
                      "mass_kg": MASS_KG[name], **held})
    pin = {"axis": [0.0, 0.0, 1.0], "journal_radius_m": 5e-3, "radial_clearance_m": CLEARANCE_M,
           "friction_coefficient": friction, "contact": "rigid"}
    return sj.load({
        "case": {"name": "two_bores", "kind": "truss", "title": "Two journals in bores"},
        "truss": {"dimension": 3}, "node": nodes,
        "link": [{"name": "AB", "nodes": ["A", "B"], "young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-6,
                  "thermal_expansion_per_K": 0.0, "mass_kg": LINK_KG}],
        "revolute": [{"name": "first", "bearing_node": "B", "journal_node": "J", **pin},
                     {"name": "second", "bearing_node": "J", "journal_node": "K", **pin}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 1.0, "cycles": 1, "period_s": PERIOD_S},
        "dem": {"link_damping_ratio": 0.0, "contact_damping_ratio": 0.0},
        "motion": {"start": "drawn", "restitution": RESTITUTION},
    })


def here(steps: int, friction: float) -> tuple[np.ndarray, float, list[float]]:
    """Return this project's positions (steps + 1, 5) [m], CPU time of the steps [s] and times of impacts [s]."""
    definition = case(friction).changed({"motion.steps_per_cycle": steps, "output.samples_per_cycle": steps}).definition
    definition.resolve()
    begun = process_time()
    found = motion.simulate(definition)
    seconds = process_time() - begun
    moved = found.states["displacement_m"]
    impacts = [event.time_s for event in found.events if event.before == "open"]
    return np.column_stack([moved[:, 1, 0], moved[:, 2, :2], moved[:, 3, :2]]), seconds, impacts


def there(steps: int, friction: float) -> tuple[np.ndarray, float]:
    """Return Siconos' positions (steps + 1, 5) [m] and CPU time of the steps [s]."""
    import siconos.kernel as kernel
    import siconos.numerics as numerics

    mass = np.diag([MASS_KG["B"] + LINK_KG / 3, MASS_KG["J"], MASS_KG["J"], MASS_KG["K"], MASS_KG["K"]])
    stiffness = np.zeros((5, 5))
    stiffness[0, 0] = STIFFNESS_N_PER_M
    at, speed, dashpots = np.zeros(5), np.zeros(5), np.zeros((5, 5))
    body = kernel.LagrangianLinearTIDS(at, speed, mass, stiffness, dashpots)
    forces = np.array([FORCE_N["B"][0], *FORCE_N["J"], *FORCE_N["K"]])
    body.setFExtPtr(forces)
    model = kernel.NonSmoothDynamicalSystem(0.0, PERIOD_S)
    model.insertDynamicalSystem(body)
    place = {"B": np.eye(5)[[0, 0]] * [[1], [0]], "J": np.eye(5)[1:3], "K": np.eye(5)[3:5]}
    kept: list[Any] = []  # Siconos borrows
    bores = []
    for bearing, journal in (("B", "J"), ("J", "K")):
        law = kernel.NewtonImpactFrictionNSL(RESTITUTION, 0.0, friction, 2)
        directions, gaps = np.zeros((2, 5)), np.array([CLEARANCE_M, 0.0])
        relation = kernel.LagrangianLinearTIR(directions, gaps)
        interaction = kernel.Interaction(law, relation)
        kept += [law, directions, gaps, interaction]
        bores.append((relation, interaction, place[journal] - place[bearing]))
        model.link(interaction, body)
    solver = kernel.FrictionContact(2, numerics.SICONOS_FRICTION_2D_NSGS)
    solver.numericsSolverOptions().dparam[numerics.SICONOS_DPARAM_TOL] = 1e-12
    solver.numericsSolverOptions().iparam[numerics.SICONOS_IPARAM_MAX_ITER] = 10_000
    step = PERIOD_S / steps
    scheme, times = kernel.MoreauJeanOSI(0.5), kernel.TimeDiscretisation(0.0, step)
    stepping = kernel.TimeStepping(model, times, scheme, solver)
    stepping.setNewtonTolerance(1e-12)
    stepping.setNewtonMaxIteration(20)
    places, seconds = np.zeros((steps + 1, 5)), 0.0
    for k in range(1, steps + 1):
        # Gaps and directions are those at the middle of the step, as in this project.
        middle = body.q() + 0.5 * step * body.velocity()
        borrowed = []
        for relation, interaction, apart in bores:
            between = apart @ middle
            size = np.linalg.norm(between)
            if size > 0:
                normal = between / size
                directions = np.array([-normal @ apart, np.array([-normal[1], normal[0]]) @ apart])
                gaps = np.array([CLEARANCE_M - size, 0.0]) - directions @ middle
                relation.setJachqPtr(directions)
                relation.setEPtr(gaps)
                for derivative in (0, 1):  # velocities before the step along its own directions
                    interaction.computeOutput(0.0, derivative)
                interaction.swapInMemory()
                borrowed += [directions, gaps]
        begun = process_time()
        stepping.computeOneStep()
        seconds += process_time() - begun
        places[k] = body.q()
        begun = process_time()
        stepping.nextStep()
        seconds += process_time() - begun
        kept.append(borrowed)
    return places, seconds


def compare(steps: int, friction: float) -> dict[str, Any]:
    """Return how far both go together."""
    ours, seconds, impacts = here(steps, friction)
    theirs, their_seconds = there(steps, friction)
    apart = np.abs(ours - theirs).max(axis=1)
    time = np.linspace(0, PERIOD_S, steps + 1)
    parted = np.flatnonzero(apart > APART_M)
    together = time[parted[0]] if len(parted) else PERIOD_S
    second = impacts[1] if len(impacts) > 1 else PERIOD_S
    return {
        "steps": steps, "friction_coefficient": friction, "first_impact_s": impacts[0],
        "after_first_impact_m": float(apart[time < second].max()), "together_s": float(together),
        "impacts_together": sum(time_s < together for time_s in impacts),
        "impacts": len(impacts),
        "us_per_step": round(1e6 * seconds / steps, 2), "siconos_us_per_step": round(1e6 * their_seconds / steps, 2),
    }


def report(rows: list[dict[str, Any]]) -> str:
    """Return the table as Markdown."""
    lines = "\n".join(
        f"| {one['friction_coefficient']:g} | {one['steps']:,} | {one['after_first_impact_m']:.1e} m | "
        f"{one['impacts_together']} of {one['impacts']} | {1e3 * one['together_s']:.2f} ms | "
        f"{one['us_per_step']:.3g} µs | {one['siconos_us_per_step']:.3g} µs |" for one in rows)
    return f"""# The Moreau–Jean scheme of this project and of Siconos

A bearing on an elastic link, a journal in it, and a second journal in a bore of the first, under constant forces from
the middle of their clearances: {1e3 * CLEARANCE_M:g} mm each, rigid contacts, restitution {RESTITUTION:g}, θ = 1/2,
{1e3 * PERIOD_S:g} ms. Siconos {version()} receives gaps and directions at the middle of each step as a linear relation,
as this project uses them. It solves its contact problems to 1e-12.

- difference: largest difference of the five displacements before the second impact
- together: time and impacts until the displacements differ by more than {1e9 * APART_M:g} nm
- per step: CPU time; that of Siconos is for its steps alone, through its Python interface

| friction | steps | difference | impacts together | together | here, per step | Siconos, per step |
|--:|--:|--:|--:|--:|--:|--:|
{lines}

Explanation: [Motion beside the DEM](../../docs/validation/motion.md#beside-siconos).

## Again

```
PYTHONPATH=build/python /usr/bin/python3 studies/bench/siconos_moreau_jean.py
```
"""


def version() -> str:
    """Return the version of Siconos in Debian's package."""
    found = run(["dpkg-query", "-W", "-f=${Version}", "python3-siconos"], capture_output=True, text=True, check=False)
    return found.stdout or "of unknown version"


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, default=REPOSITORY / "results" / "motion")
    arguments = parser.parse_args()
    if find_spec("siconos") is None:
        raise BenchError("Siconos is not installed (Debian: python3-siconos); nothing was compared")
    rows = [compare(steps, friction) for friction in (0.0, FRICTION) for steps in STEPS]
    publish(arguments.output, "siconos", COLUMNS, rows, report(rows))


if __name__ == "__main__":
    start(main, StatejumpError)
