# SPDX-License-Identifier: GPL-3.0-or-later
"""Beams in the DEM: at rest it agrees with the solver to rounding; energy, moving supports of a frame, refusals."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import statejump as sj
from failures import failing
from statejump.core.run import Run
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import dem
from statejump.kinds.truss.generate.document import document, finished, node

STEEL: dict[str, Any] = {"young_modulus_Pa": 210e9, "thermal_expansion_per_K": 1.2e-5, "density_kg_per_m3": 7850.0}
COLD: dict[str, Any] = {"cross_section_area_m2": 5e-3, "second_moments_of_area_m4": [8e-5, 8e-5],
                        "temperature_fraction": 0.0}
EPS = 2.0**-52
REST = 19  # the last sample of the hot state; the second half of a run returns to the reference temperature


def clamp(name: str, place: tuple[float, ...]) -> dict[str, Any]:
    axes = "xyz"[: len(place)]
    return {**node(name, place, axes), "fixed_rotations": ["z"] if len(place) == 2 else list("xyz")}


def held(*nodes: dict[str, Any], change_K: float, beam: list[dict[str, Any]], dimension: int = 2, **more: Any
         ) -> sj.Case:
    """A case that is heated for a tenth of a second and then kept hot until it rests."""
    duration_s, ratio = more.pop("duration_s", 2.0), more.pop("ratio", 0.5)
    made = document("frame", "Frame", "closed form", dimension, change_K, "triangle", 1, duration_s)
    made["thermal"] = {"shape": "table", "cycles": 1, "period_s": duration_s,
                       "table_time_s": [0.0, 0.1, duration_s], "table_temperature_change_K": [0.0, change_K, change_K]}
    made["node"] += nodes
    made["beam"] = [{"name": f"beam {number}", **STEEL, **one} for number, one in enumerate(beam, 1)]
    made["dem"] = {"link_damping_ratio": ratio, "time_step_fraction": 0.8}
    return parse_case(finished(made | {"output": {"samples_per_cycle": 40}} | more))


def agree(case: sj.Case, tolerance_m: float, tolerance_rad: float = 1e-12) -> tuple[Run, Run]:
    """Compare the last states, which are at rest, and return both runs."""
    moving = case.dem()
    slow = case.reduced().at(moving.time_s)
    apart = np.abs(slow["displacement_m"][REST] - moving["displacement_m"][REST]).max()
    turned = np.abs(slow["rotation_rad"][REST] - moving["rotation_rad"][REST]).max()
    assert apart <= tolerance_m and turned <= tolerance_rad, (apart, turned)
    for end in ("first", "second"):
        for key in (f"beam_force_{end}_N", f"beam_moment_{end}_N_m"):
            # Rounding of coordinates of order 1 m in the stiffest spring of order 1 GN/m.
            assert moving[key][REST] == pytest.approx(slow[key][REST], abs=1e-5, rel=1e-9), key
    supplied = moving["thermal_work_J"] + moving["external_work_J"]
    kept = moving["elastic_energy_J"] - moving["elastic_energy_J"][0] + moving["kinetic_energy_J"]
    spent = moving["damping_dissipation_J"]
    # Of first order in the step: dashpots use velocities that are half a step old.
    assert np.abs(supplied - kept - spent).max() < 1e-1 * max(np.abs(kept).max(), spent.max())
    assert spent[-1] > 0
    return slow, moving


def gradient(elements: int, length_m: float, per_m: float, change_K: float, **more: Any) -> sj.Case:
    """A cantilever whose temperature changes across its section."""
    each = length_m / elements
    warm = {"cross_section_area_m2": 2e-2, "second_moments_of_area_m4": [3e-4, 3e-4], "temperature_fraction": 0.0,
            "gradient_per_m": [per_m, 0.0]}
    return held(clamp("N0", (0.0, 0.0)), *(node(f"N{k}", (k * each, 0.0)) for k in range(1, elements + 1)),
                change_K=change_K, beam=[{"nodes": [f"N{k}", f"N{k + 1}"], **warm} for k in range(elements)], **more)


def test_cantilever_bends_by_its_gradient() -> None:
    slow, moving = agree(gradient(2, 6.0, 2.5, 20.0, ratio=2.0), 1e-13)
    curvature = 1.2e-5 * 20 * 2.5
    assert moving["displacement_m"][REST, 2, 1] == pytest.approx(-10.8e-3, rel=2e-6)
    assert moving["rotation_rad"][REST, 2] == pytest.approx([0, 0, -6 * curvature], abs=1e-13)


def test_free_arc_of_one_radian() -> None:
    slow, moving = agree(gradient(4, 1.0, 250.0, 1 / (1.2e-5 * 250), duration_s=0.6), 1e-13)
    assert moving["rotation_rad"][REST, 4, 2] == pytest.approx(-1.0, abs=1e-12)


def test_portal_with_a_heated_column() -> None:
    case = held(clamp("A", (0.0, 0.0)), node("B", (0.0, 4.0)), node("C", (6.0, 4.0)), clamp("D", (6.0, 0.0)),
                change_K=0.06, ratio=2.0,
                beam=[{"nodes": ["A", "B"], **COLD, "temperature_fraction": 1.0}, {"nodes": ["B", "C"], **COLD},
                      {"nodes": ["C", "D"], **COLD}])
    slow, moving = agree(case, 1e-13)
    assert 1e3 * abs(moving["beam_force_first_N"][REST, 1, 1]) == pytest.approx(536.8365, abs=2e-3)
    assert 1e3 * abs(moving["beam_moment_first_N_m"][REST, 0, 2]) == pytest.approx(1610.5095, abs=5e-3)


def test_moment_at_an_end() -> None:
    """A moment of 0.4 E I/L, from the start, and a gradient: cantilever of four beams that a support lets slide."""
    made = gradient(4, 2.0, 25.0, 40.0).to_dict()
    made["node"][-1] |= {"moment_N_m": [0.4 * 210e9 * 3e-4 / 2.0]}
    case = parse_case(made)
    slow, moving = agree(case, 1e-13)
    assert slow["rotation_rad"][0, 4, 2] == pytest.approx(0.4, rel=1e-12)
    assert moving["external_work_J"][REST] == pytest.approx(slow["external_work_J"][REST], rel=1e-9)


def spatial() -> sj.Case:
    """A bent frame in space: offsets, released moments, shear, torsion, a gradient and a force."""
    tube = {"shape": "tube", "dimensions_m": [0.1, 0.01]}
    box = {"shape": "rectangle", "dimensions_m": [0.08, 0.05], "axis_y": [0.0, 0.0, 1.0]}
    return held(
        clamp("A", (0.0, 0.0, 0.0)), node("B", (1.0, 0.0, 0.0)), {**node("C", (1.0, 1.2, 0.2)),
                                                                   "force_N": [200.0, -300.0, -2e4]},
        clamp("D", (1.0, 1.2, -0.8)), change_K=80.0, dimension=3, ratio=3.0, duration_s=3.0,
        beam=[{"nodes": ["A", "B"], **box, "gradient_per_m": [2.0, -3.0]},
              {"nodes": ["B", "C"], **box, "offset_first_m": [0.0, 0.03, 0.01]},
              {"nodes": ["C", "D"], **tube, "axis_y": [1.0, 0.0, 0.0], "released_first": ["Rz"],
               "released_second": ["Rx", "Ry", "Rz"], "temperature_fraction": -0.5}])


def test_frame_in_space() -> None:
    slow, moving = agree(spatial(), 1e-13)
    assert np.linalg.norm(moving["rotation_rad"][REST], axis=1).max() > 5e-3


def test_no_density() -> None:
    made = spatial().to_dict()
    del made["beam"][0]["density_kg_per_m3"]
    with failing("mass_of_moving_beam_missing", item="beam 'beam 1'"):
        dem.check(parse_case(made))


@pytest.mark.parametrize("fixed", [["x"], ["y"], ["z"]])
def test_two_free_rotations_are_refused(fixed: list[str]) -> None:
    made = spatial().to_dict()
    made["node"][1]["fixed_rotations"] = fixed
    with failing("dem_rotation", nodes=("B",)):
        dem.check(parse_case(made))


def test_moment_across_the_rotation_is_refused() -> None:
    made = spatial().to_dict()
    made["node"][1]["moment_N_m"] = [0.0, 10.0, 0.0]
    case = parse_case(made)
    dem.check(case)
    with failing("dem_rotation", nodes=("B",)):
        dem.dem_input(case)
