# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes tables and pictures of docs/validation/identification.md: joints identified from noisy loops of known joints.

    PYTHONPATH=build/python /usr/bin/python3 studies/docs/make_identification.py [--repetitions N] [--choices N]
    PYTHONPATH=build/python /usr/bin/python3 studies/docs/make_identification.py --random N

Another model (contact kernel, closed form, truss solver or YADE) computes each loop once; every repetition adds new
noise to the force. ``--random`` instead draws random joints with play and soft stops, and displacement paths with
constant, growing or shrinking cycles. 500 repetitions take about half an hour on one core, 300 random loops fifteen
minutes.
"""
from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

import statejump as sj
from statejump.core.figures import style
from statejump.core.tables import markdown
from statejump.identification.fit import Fits, intervals
from statejump.identification.loop import read_loop
from statejump.identification.models import MODELS

PICTURES = Path(__file__).resolve().parents[2] / "docs" / "identification"
NOISE = 0.01  # of half of the loop's force
CONFIDENCE = 0.95
# Triangles between both signs: a first loading and two cycles.
CORNERS_K = [0.0, 100.0, -100.0, 100.0, -100.0, 0.0]
TABLE = {"thermal.shape": "table", "thermal.table_time_s": list(np.arange(6.0)),
         "thermal.table_temperature_change_K": CORNERS_K, "thermal.temperature_change_max_K": None}
BAR_N_per_m = 70e9 * 9e-6 / 0.5  # Table 1
EXPANSION_m_per_K = 23.4e-6 * 0.5


@dataclass(frozen=True)
class Known:
    """A loop of a joint with known parameters.

    :param name: origin of the loop
    :param model: the joint model to fit
    :param true: true parameters
    """

    name: str
    model: str
    true: dict[str, float]
    displacement: np.ndarray
    force: np.ndarray

    @property
    def noise(self) -> float:
        """Standard deviation of the added noise."""
        return NOISE * float(np.ptp(self.force)) / 2

    def measured(self, repetition: int) -> dict[str, np.ndarray]:
        """Return the loop with the noise of one repetition."""
        drawn = np.random.default_rng(repetition).normal(0, self.noise, len(self.force))
        return {"displacement_m": self.displacement, "force_N": self.force + drawn}


def kernel(law: str, model: str) -> Known:
    """Return the loop of a contact kernel under 10 N, slid cyclically with the amplitude 2.5 μN/k."""
    young, shear, radius, mu, load = 38.5e9, 7.9e9, 0.01, 0.3, 10.0
    stiffness = 8 * shear * (3 * load * radius / (4 * young)) ** (1 / 3)
    reach = 2.5 * mu * load / stiffness
    slide = reach * np.interp(np.linspace(0, 5, 501), np.arange(6), [0, 1, -1, 1, -1, 0])
    answer = sj.laws.drive(law, {"slide_m": slide, "normal_force_N": np.full(len(slide), load)},
                           effective_young_modulus_Pa=young, effective_shear_modulus_Pa=shear,
                           effective_radius_m=radius, friction_coefficient=mu)
    return Known(f"kernel, {law}", model, {"stiffness": stiffness, "friction": mu * load, "preload": 0.0}, slide,
                 answer["tangential_force_N"])


def bar_on_a_slider() -> Known:
    """Return the closed-form loop of Table 1 with nearer stops and a spring at its block; the displacement is the
    thermal expansion of the bar. The bar is a hundred times longer and thicker, so that its expansion reduces its
    stiffness by only 2e-5."""
    case = sj.load("table1").changed({
        **TABLE, "link.stress_free_length_m": 50.0, "link.cross_section_area_m2": 9e-4,
        "link.thermal_expansion_per_K": 23.4e-8, "joint.clearance_minus_m": 5e-4, "joint.clearance_plus_m": 8e-4,
        "dem.samples_per_cycle": 500,
        "joint.preload_stiffness_N_per_m": 5e4, "thermal.period_s": 5.0})
    run = case.reduced().frame()
    return Known("closed form, bar on a slider", "coulomb_clearance_spring",
                 {"stiffness": BAR_N_per_m, "friction": 30.0, "clearance_minus": 5e-4, "clearance_plus": 8e-4,
                  "preload": 0.0, "preload_stiffness": 5e4},
                 EXPANSION_m_per_K * run["temperature_change_K"].to_numpy(), run["axial_force_N"].to_numpy())


def sliders_of_a_truss() -> Known:
    """Return the loop of a hundred parallel sliders behind springs, by the truss solver. Half of them slip at forces of
    an Iwan joint's density, at midpoints of equal stiffness; the others slip at its end."""
    exponent, ratio, last, count = -0.5, 1.0, 3e-4, 100
    share = (np.arange(count // 2) + 0.5) / (count // 2)
    slides = last * np.concatenate((share ** (1 / (exponent + 1)), np.ones(count - count // 2)))
    case = sj.truss.iwan(count)
    friction = case["slider.S1.friction_coefficient"]
    case = case.changed({**TABLE, "thermal.period_s": 5.0, "output.samples_per_cycle": 500,
                         **{f"slider.S{i}.normal_force_N": float(BAR_N_per_m / count * slide / friction)
                            for i, slide in enumerate(slides, start=1)}})
    frame = case.reduced().frame()
    force = sum(frame[f"slider_force_N[S{i}]"].to_numpy() for i in range(1, count + 1))
    return Known(f"truss solver, {count} sliders", "iwan",
                 {"stiffness": BAR_N_per_m, "friction": float(BAR_N_per_m / count * slides.sum()),
                  "iwan_exponent": exponent, "iwan_ratio": ratio, "preload": 0.0},
                 frame["displacement_m[P].x"].to_numpy(), force)


def slider_in_yade() -> Known:
    """Return the loop of the paper's Table 1 without stops in the DEM: pad (Mindlin stiffness) and bar are in series.
    """
    case = sj.load("table1").changed({**TABLE, "joint.clearance_minus_m": 1e-2, "joint.clearance_plus_m": 1e-2,
                                      "dem.samples_per_cycle": 500, "thermal.period_s": 5.0})
    run = case.dem(progress=sys.stderr.isatty()).frame()
    young, shear = 70e9 / (2 * (1 - 0.3**2)), 70e9 / 2.6 / (2 * 1.7)
    pad = 8 * shear * (3 * 100 * 0.05 / (4 * young)) ** (1 / 3)
    return Known("DEM in YADE, bar on a slider", "coulomb",
                 {"stiffness": 1 / (1 / BAR_N_per_m + 1 / pad), "friction": 30.0, "preload": 0.0},
                 EXPANSION_m_per_K * run["temperature_change_K"].to_numpy(), run["axial_force_N"].to_numpy())


LOOPS: dict[str, Callable[[], Known]] = {
    "kernel_mindlin": lambda: kernel("mindlin", "coulomb"),
    "kernel_partial_slip": lambda: kernel("mindlin_deresiewicz", "mindlin"),
    "bar_on_a_slider": bar_on_a_slider,
    "truss_sliders": sliders_of_a_truss,
    "dem": slider_in_yade,
}


def repeated(known: Known, repetitions: int) -> dict[str, int]:
    """Return, for each parameter, the number of repetitions in which its interval contains the true value."""
    inside = dict.fromkeys(known.true, 0)
    for repetition in range(repetitions):
        count(inside, known.true, known.measured(repetition), known.model)
    return inside


def count(inside: dict[str, int], true: dict[str, float], columns: dict[str, np.ndarray], model: str) -> None:
    """Count the intervals of a loop that contain the true values."""
    found = intervals(Fits(read_loop(columns)), model, CONFIDENCE, list(true))[1].of
    for name, value in true.items():
        inside[name] = inside.get(name, 0) + (found[name].low <= value <= found[name].high)


def random_loop(model: str, correlation: float, rng: np.random.Generator) -> tuple[dict[str, float], dict[
    str, np.ndarray
]]:
    """Return a random joint and its loop from rest: 600 rows, 2 to 5 cycles, noise of 2 % of half the force range."""
    stiffness, friction = 10 ** rng.uniform(5.5, 6.5), rng.uniform(50, 300)
    true = {"stiffness": stiffness, "friction": friction, "preload": rng.uniform(-20, 20)}
    amplitude = rng.uniform(4, 8) * friction / stiffness
    if model in ("coulomb_play", "coulomb_soft_play"):
        true["play"] = rng.uniform(0.3, 1.5) * friction / stiffness
        amplitude += true["play"]
        if model == "coulomb_soft_play":
            true["play_ratio"] = rng.uniform(0.05, 0.3)
    else:
        true["clearance_minus"], true["clearance_plus"] = (amplitude * rng.uniform(0.3, 0.6) for _ in range(2))
        true["stop_stiffness"] = stiffness * rng.uniform(0.3, 3)
    time = np.linspace(0, 1, 600)
    cycles = int(rng.integers(2, 6))
    envelope = (np.ones(600), 0.1 + 0.9 * time, 1 - 0.9 * time)[int(rng.integers(3))]
    path = amplitude * envelope * np.sin(2 * np.pi * cycles * time)
    force = MODELS[model].answer(true, path, read_loop({"displacement_m": path, "force_N": path}, "fresh").memory)
    noise = lfilter([sqrt(1 - correlation**2)], [1, -correlation], rng.normal(size=1100))[500:]
    return true, {"displacement_m": path, "force_N": force + 0.01 * np.ptp(force) * noise}


def random_joints(loops: int) -> None:
    """Print how often intervals cover the true value for random loops, one ninth for each combination of joint and
    noise."""
    rows = []
    for model in ("coulomb_play", "coulomb_soft_play", "coulomb_soft_stops"):
        for correlation in (0.0, 0.5, 0.9):
            inside: dict[str, int] = {}
            rng = np.random.default_rng(5)
            for _ in range(loops // 9):
                true, columns = random_loop(model, correlation, rng)
                count(inside, true, columns, model)
            share = 100 * sum(inside.values()) / (len(inside) * (loops // 9))
            each = ", ".join(f"{name} {100 * number / (loops // 9):.0f}" for name, number in inside.items())
            rows.append((model, f"{correlation:g}", f"{loops // 9}", f"{share:.1f}", each))
            print(*rows[-1], sep=" | ", file=sys.stderr, flush=True)
    print(*markdown(("joint", "correlation of rows", "loops", "coverage [%]", "by parameter [%]"), rows, (1, 2, 3)),
          sep="\n")


def chosen(known: Known, choices: int) -> str:
    """Return the joints chosen by BIC, and how often."""
    count = Counter(sj.identify(known.measured(repetition)).model for repetition in range(choices))
    return ", ".join(f"{name} {times}" for name, times in count.most_common())


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asked.add_argument("--repetitions", type=int, default=500)
    asked.add_argument("--choices", type=int, default=20, help="how often BIC chooses among all joints")
    asked.add_argument("--loops", nargs="*", default=list(LOOPS), choices=list(LOOPS))
    asked.add_argument("--random", type=int, metavar="N", help="coverage of N random loops instead")
    given = asked.parse_args()
    if given.random:
        random_joints(given.random)
        return
    PICTURES.mkdir(exist_ok=True)
    rows, choices = [], []
    for name in given.loops:
        known = LOOPS[name]()
        first = sj.identify(known.measured(0), model=known.model, confidence=CONFIDENCE)
        with style():
            first.plot().savefig(PICTURES / f"{name}.png", dpi=80, metadata={"Software": None})
        inside = repeated(known, given.repetitions)
        for parameter, value in known.true.items():
            interval = first.intervals[parameter]
            rows.append((known.name, known.model, parameter, f"{value:.6g}", f"{first.values[parameter]:.6g}",
                         f"{interval.low:.6g} to {interval.high:.6g}",
                         f"{100 * inside[parameter] / given.repetitions:.1f}"))
            print(*rows[-1], sep=" | ", file=sys.stderr, flush=True)
        choices.append((known.name, chosen(known, given.choices)))
    error = 100 * sqrt(CONFIDENCE * (1 - CONFIDENCE) / given.repetitions)
    print(*markdown(("loop", "joint", "parameter", "true", "estimate", "95 % interval", "coverage [%]"), rows,
                    (3, 4, 6)), sep="\n")
    print(f"\n{given.repetitions} repetitions; chance alone gives 95 ± {error:.1f} % (one standard deviation).\n")
    print(*markdown(("loop", f"chosen by BIC, of {given.choices}"), choices), sep="\n")


if __name__ == "__main__":
    main()
