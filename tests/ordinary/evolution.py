# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacements at the ends of cycles, computed without the engine, for structures of class A (see oracle.py) whose
only joints are sliders without stops. Displacements are small; each step minimises energy plus frictional heat."""
from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import lsq_linear

from oracle import Frame
from sketch import CLEARANCE, Document

STEPS = 24  # of a monotone piece of the program
MOST_SLIDERS = 40
# Allowed difference for slides that reverse within a step, over the largest displacement.
TOLERANCE = 0.05


def applies(document: Document) -> bool:
    """Return whether this theory applies to a structure; it excludes structures with cables, which may become slack."""
    others = any(document.get(section) for section in (*CLEARANCE, "iwan_joint", "latch_hinge"))
    cables = any(spring.get("cable") for spring in document.get("spring", ()))
    sliders = document.get("slider", [])
    stopped = any("clearance_minus_m" in slider for slider in sliders)
    return not others and not cables and not stopped and 0 < len(sliders) <= MOST_SLIDERS


# Keys of loads, preloads and temperatures, in which small displacements are linear.
LOADS = ("force_N", "gravity_m_per_s2", "preload_N", "normal_force_N", "temperature_change_max_K",
         "table_temperature_change_K")
# Factor on them: second-order effects of large displacements, relative to the displacements, shrink by it. A structure
# that differs by more than the tolerance is compared at this scale.
SMALL = 0.01


def scaled(document: Document, share: float) -> Document:
    """Return a document with loads, preloads and temperatures multiplied by ``share``."""
    places = {node["name"]: np.array(node["position_m"]) for node in document["node"]}

    def moved(key: str, value: Any) -> Any:
        if key in LOADS:
            return (np.asarray(value) * share).tolist()
        if isinstance(value, list):
            return [moved(key, part) for part in value]
        if not isinstance(value, dict):
            return value
        made = {name: moved(name, part) for name, part in value.items()}
        if "stress_free_length_m" in value:
            length = float(np.linalg.norm(np.subtract(*(places[name] for name in value["nodes"]))))
            made["stress_free_length_m"] = length + share * (value["stress_free_length_m"] - length)
        return made

    return {key: moved(key, value) for key, value in document.items()}


def changes_K(program: Document, times: np.ndarray, period_s: float) -> np.ndarray:
    """Return the temperature changes of a temperature program at given times within a cycle."""
    if program["shape"] == "table":
        return np.interp(times, program["table_time_s"], program["table_temperature_change_K"])
    share, largest = times / period_s, program["temperature_change_max_K"]
    if program["shape"] == "triangle":
        return np.asarray(largest * (1 - np.abs(2 * share - 1)))
    return np.asarray(largest * np.sin(np.pi * share * (2 if program["shape"] == "sine" else 1)))


def ends(document: Document) -> np.ndarray:
    """Return the displacements (1 + cycles, dofs) at the start and at the ends of the cycles."""
    frame = Frame(document)
    common = document["thermal"]
    period = common["table_time_s"][-1] if common["shape"] == "table" else common["period_s"]
    programs = {None: common, **{one["name"]: one for one in document.get("program", ())}}
    corners = {0.0, 0.25 * period, 0.5 * period, 0.75 * period, period}
    for one in programs.values():
        corners |= set(one.get("table_time_s", ()))
    marks = sorted(corners)
    times = np.concatenate([np.linspace(a, b, STEPS + 1)[1:] for a, b in zip(marks, marks[1:])])
    heat = np.zeros((len(times), len(frame.stiffness)))
    for number, link in enumerate(document["link"]):
        change = changes_K(programs[link.get("program")], times, period) * link.get("temperature_fraction", 1.0)
        heat[:, number] = -frame.stiffness[number] * frame.lengths[number] * change * link["thermal_expansion_per_K"]
    basis, slides = frame.motions(True), frame.slides()
    active = np.ones(len(frame.stiffness), dtype=bool)
    factor = np.linalg.cholesky(basis.T @ (frame.elastic(active) + frame.geometric(frame.tension)) @ basis)
    rows = np.linalg.solve(factor, (slides @ basis).T)  # rows of the slides, in unknowns of unit stiffness
    limits = np.array([limit for _, limit in frame.sliding])
    gram = rows.T @ rows
    dead = np.linalg.solve(factor, basis.T @ (frame.force - frame.rows.T @ frame.tension))
    heated = np.linalg.solve(factor, basis.T @ (frame.rows.T @ heat.T)).T
    back = np.linalg.solve(factor, basis.T)
    values, vectors = np.linalg.eigh(gram)
    # If one motion moves several sliders, the distribution of their friction is arbitrary.
    kept = values > 1e-12 * values[-1]
    root, vectors = np.sqrt(values[kept]), vectors[:, kept]
    least, target = root[:, None] * vectors.T, vectors.T / root[:, None]
    friction, slid, found = np.zeros(len(limits)), np.zeros(len(limits)), []

    def step(expanding: np.ndarray) -> np.ndarray:
        nonlocal friction, slid
        load = dead - expanding
        wanted = rows.T @ load - slid
        friction = target.T @ target @ wanted
        if (np.abs(friction) > limits).any():
            friction = lsq_linear(least, target @ wanted, (-limits, limits), method="bvls").x
        moved = load - rows @ friction
        slid = rows.T @ moved
        return np.asarray(back.T @ moved)

    found.append(step(0 * heated[0]))
    for _ in range(common["cycles"]):
        for expanding in heated:
            last = step(expanding)
        found.append(last)
    return np.array(found)
