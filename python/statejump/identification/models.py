# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints that can be identified: parameters, force, and start points of a search. Force and displacement also mean
moment and rotation. The force depends on the displacement path, not on its rate."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import inf

import numpy as np

from statejump.identification.hysteresis import Memory

LINEAR, POSITIVE = "linear", "positive"


@dataclass(frozen=True)
class Parameter:
    """A parameter of a joint that can be identified.

    :param name: name of the parameter, without unit
    :param dimension: ``force``, ``displacement``, ``stiffness``, or ``-``
    :param scale: ``positive`` if the search uses the logarithm of the parameter
    :param low: lower bound of the search, in units of the loop's size (half of its force range, half of its
        displacement range); signed parameters are relative to its middle
    :param high: upper bound of the search
    :param starts: start values, in the same units
    :param meaning: meaning in words
    """

    name: str
    dimension: str
    scale: str
    low: float
    high: float
    starts: tuple[float, ...]
    meaning: str


# A joint a million times stiffer than a loop cannot be distinguished from a rigid one.
FAR = 1e6
# Friction in the first row as a fraction of its limit, a parameter if the initial state is unknown.
START = "initial_friction"
PARAMETERS = {each.name: each for each in (
    Parameter("stiffness", "stiffness", POSITIVE, 1 / FAR, FAR, (1.0, 2.0, 5.0, 20.0),
              "between the place of measurement and the slide; of partial slip that of sticking"),
    Parameter("friction", "force", POSITIVE, 1 / FAR, FAR, (0.1, 0.3, 0.6, 0.9), "limit of friction"),
    Parameter("clearance_minus", "displacement", LINEAR, -1.0, 2.0, (0.1, 0.4, 0.7), "play below displacement 0"),
    Parameter("clearance_plus", "displacement", LINEAR, -1.0, 2.0, (0.1, 0.4, 0.7), "play above displacement 0"),
    Parameter("stop_stiffness", "stiffness", POSITIVE, 1 / FAR, FAR, (1.0, 10.0), "of a stop itself"),
    Parameter("play", "displacement", POSITIVE, 1 / FAR, 2.0, (0.1, 0.5, 1.0),
              "lost motion at each reversal, which moves with the slide"),
    Parameter("play_ratio", "-", LINEAR, 0.0, 0.5, (0.05, 0.2), "stiffness within the play, over that beyond it"),
    Parameter("preload", "force", LINEAR, -FAR, FAR, (0.0,), "force at displacement 0, without friction"),
    Parameter("preload_stiffness", "stiffness", POSITIVE, 1 / FAR, FAR, (0.03, 0.3), "spring beside the slide"),
    Parameter("iwan_exponent", "-", LINEAR, -0.999, 0.0, (-0.7, -0.3), "χ of the distribution of sliders"),
    Parameter("iwan_ratio", "-", POSITIVE, 1e-4, 1e12, (0.3, 3.0), "β, stiffness of the last sliders over the others"),
    Parameter(START, "-", LINEAR, -1.0, 1.0, (0.0,), "carried in the first row, as a fraction of the limit"),
)}
Values = Mapping[str, float]
Answer = Callable[[Values, np.ndarray, Memory], np.ndarray]


@dataclass(frozen=True)
class Model:
    """A type of joint that can be identified.

    :param name: name of the joint type for users
    :param parameters: names of its parameters in PARAMETERS
    :param answer: function that returns the force for parameters, displacements and the memory of friction
    :param formula: formula for tables
    :param parts: simpler joints that this joint equals if the parameters that they lack have no effect
    """

    name: str
    parameters: tuple[str, ...]
    answer: Answer
    formula: str
    parts: tuple[str, ...] = ()

    def starts(self, names: Sequence[str]) -> list[dict[str, float]]:
        """Return start values of a search for some parameters, in units of the size of the loop."""
        lists = [PARAMETERS[name].starts for name in names]
        return [dict(zip(names, values)) for values in product(*lists)]


def _coulomb(values: Values, displacement: np.ndarray, memory: Memory) -> np.ndarray:
    """Return the force of a slide: a block with friction f between stops k_s, with preload P and spring k_p, driven
    through a spring k with play p.

    The block rests at x while |k (u - x) - g(x)| <= f. g is the force of preload, spring k_p and stops; it increases
    with x. k x + g(x) therefore follows k u with a play of half width f. The play p widens this play in u. Within p the
    spring k is slack, or has the fraction r of its stiffness.
    """
    stiffness, friction = values["stiffness"], values.get("friction", 0.0)
    preload, spring = values.get("preload", 0.0), values.get("preload_stiffness", 0.0)
    gap, ratio = values.get("play", 0.0) / 2, values.get("play_ratio", 0.0)
    pulled: np.ndarray = stiffness * displacement
    if friction > 0 or gap > 0:
        width = friction / stiffness + (1 - ratio) * gap
        if friction < ratio * stiffness * gap:  # it slides before the play closes
            width = friction / (ratio * stiffness)
        stretch = memory.stretch(width, values.get(START, 0.0))
        if gap > 0:
            stretch = stretch - (1 - ratio) * np.clip(stretch, -gap, gap)
        pulled = stiffness * (displacement - stretch)
    block = (pulled - preload) / (stiffness + spring)
    if "clearance_plus" in values:
        inside = np.clip(block, -values["clearance_minus"], values["clearance_plus"])
        stop = values.get("stop_stiffness", inf)
        block = inside + (block - inside) * (stiffness + spring) / (stiffness + spring + stop)
    return np.asarray(stiffness * (displacement - block))


def _spring(values: Values, displacement: np.ndarray, memory: Memory) -> np.ndarray:
    return values["preload"] + values["stiffness"] * displacement


def _beside(values: Values, displacement: np.ndarray) -> np.ndarray:
    found: np.ndarray = values["preload"] + values.get("preload_stiffness", 0.0) * displacement
    return found


def mindlin_backbone(friction: float, stiffness: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return the force of a first loading under a constant normal force (Cattaneo 1938, Mindlin 1949).

    T = f (1 - (1 - u/u_s)^{3/2}), u_s = 3 f/(2 k), with friction limit f, stiffness k.
    """
    gross = 1.5 * friction / stiffness

    def force(displacement: np.ndarray) -> np.ndarray:
        left = np.maximum(1 - displacement / gross, 0.0)
        found: np.ndarray = friction * (1 - left * np.sqrt(left))
        return found
    return force


def _mindlin(values: Values, displacement: np.ndarray, memory: Memory) -> np.ndarray:
    return _beside(values, displacement) + memory.force(
        mindlin_backbone(values["friction"], values["stiffness"]), values.get(START, 0.0))


def iwan_backbone(friction: float, stiffness: float, exponent: float, ratio: float) -> Callable[
    [np.ndarray], np.ndarray
]:
    """Return the force of a first loading of the four-parameter Iwan joint (Segalman, J. Appl. Mech. 72, 2005).

    F = K φ (s - s^{χ+2}/((1 + β)(χ + 2))) with s = u/φ, up to u = φ = F_S (1 + β)/(K (β + (χ + 1)/(χ + 2))); then F_S.
    """
    last = friction * (1 + ratio) / (stiffness * (ratio + (exponent + 1) / (exponent + 2)))

    def force(displacement: np.ndarray) -> np.ndarray:
        share = np.minimum(displacement / last, 1.0)
        found: np.ndarray = stiffness * last * (share - share ** (exponent + 2) / ((1 + ratio) * (exponent + 2)))
        return found
    return force


def _iwan(values: Values, displacement: np.ndarray, memory: Memory) -> np.ndarray:
    return _beside(values, displacement) + memory.force(iwan_backbone(
        values["friction"], values["stiffness"], values["iwan_exponent"], values["iwan_ratio"]),
        values.get(START, 0.0))


_SLIDE = ("stiffness", "friction", "preload")
_STOPS = ("clearance_minus", "clearance_plus")
_IWAN = ("stiffness", "friction", "iwan_exponent", "iwan_ratio", "preload")
_SPRING = ("preload_stiffness",)
_PLAY, _SOFT = ("play",), ("stop_stiffness",)
MODELS = {model.name: model for model in (
    Model("linear", ("stiffness", "preload"), _spring, "F = P + k u"),
    Model("clearance", ("stiffness", *_STOPS), _coulomb, "F = k (u − x), x within the clearances"),
    Model("coulomb", _SLIDE, _coulomb, "F = k (u − x), x slides while |F − P| = f", ("linear",)),
    Model("coulomb_spring", _SLIDE + _SPRING, _coulomb, "F = k (u − x), x slides while |F − P − kp x| = f",
          ("coulomb",)),
    Model("coulomb_clearance", _SLIDE + _STOPS, _coulomb, "as coulomb, x within the clearances",
          ("clearance", "coulomb")),
    Model("coulomb_clearance_spring", _SLIDE + _STOPS + _SPRING, _coulomb,
          "as coulomb_spring, x within the clearances", ("coulomb_clearance", "coulomb_spring")),
    Model("coulomb_soft_stops", _SLIDE + _STOPS + _SOFT, _coulomb,
          "as coulomb_clearance, stops of stiffness ks", ("coulomb_clearance",)),
    Model("coulomb_soft_stops_spring", _SLIDE + _STOPS + _SOFT + _SPRING, _coulomb,
          "as coulomb_clearance_spring, stops of stiffness ks", ("coulomb_soft_stops", "coulomb_clearance_spring")),
    Model("coulomb_play", _SLIDE + _PLAY, _coulomb, "as coulomb, the spring k is slack over a play p that moves with x",
          ("coulomb",)),
    Model("coulomb_soft_play", _SLIDE + _PLAY + ("play_ratio",), _coulomb,
          "as coulomb_play, within the play the spring has the stiffness r k", ("coulomb_play",)),
    Model("coulomb_play_spring", _SLIDE + _PLAY + _SPRING, _coulomb, "as coulomb_spring, with the play p",
          ("coulomb_play", "coulomb_spring")),
    Model("mindlin", _SLIDE, _mindlin, "F = P + f (1 − (1 − 2 k u/(3 f))^1.5) and Masing's rule", ("linear",)),
    Model("mindlin_spring", _SLIDE + _SPRING, _mindlin, "as mindlin, with kp u", ("mindlin",)),
    Model("iwan", _IWAN, _iwan, "four-parameter Iwan joint", ("coulomb",)),
    Model("iwan_spring", _IWAN + _SPRING, _iwan, "as iwan, with kp u", ("iwan", "coulomb_spring")),
)}


def containing(name: str) -> list[str]:
    """Return the joints that contain a joint, smaller ones first."""
    return [model.name for model in MODELS.values() if name in parts_of(model.name)]


def parts_of(name: str) -> set[str]:
    """Return all joints that a joint contains."""
    return set(MODELS[name].parts).union(*(parts_of(part) for part in MODELS[name].parts))


def with_part(model: Model, part: Model, values: Values, memory: Memory, displacement: np.ndarray) -> dict[str, float]:
    """Return the parameters with which a joint has the same force as a simpler joint that it contains.

    :param values: parameters of the simpler joint
    """
    limits = {"friction": 0.0, "preload": 0.0, "preload_stiffness": 0.0, "play": 0.0, "stop_stiffness": inf,
              "clearance_minus": inf, "clearance_plus": inf, "iwan_exponent": -0.5, "iwan_ratio": inf, START: 0.0}
    found = {**{name: limits.get(name, 0.0) for name in (*model.parameters, START)}, **values}
    if part.name == "linear":  # a slide that never slips: its spring is measured from the position without force
        rest = float(np.mean(displacement - memory.stretch(inf)))
        found.update(friction=inf, preload=values["preload"] + values["stiffness"] * rest)
    if model.answer is _iwan and part.answer is _coulomb and values.get("preload_stiffness"):
        # The preload spring of a slide is in series with k, that of an Iwan joint in parallel.
        stiffness, spring = values["stiffness"], values["preload_stiffness"]
        share = stiffness / (stiffness + spring)
        found.update(stiffness=share * stiffness, friction=share * values["friction"],
                     preload=share * values["preload"], preload_stiffness=share * spring)
    return {name: found[name] for name in (*model.parameters, START)}
