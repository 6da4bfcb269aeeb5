# SPDX-License-Identifier: GPL-3.0-or-later
"""Beams in case files: closed forms of bending, gradients, moments, friction; sections; refusals."""
from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import Outcome

import statejump as sj
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import motion, outcomes, solve
from statejump.kinds.truss.dem import check as check_dem
from statejump.kinds.truss.elements.beam_shapes import SHAPES, Shape, solid_torsion_m4
from statejump.kinds.truss.generate.document import document, finished, node

REPOSITORY = Path(__file__).parents[2]
STEEL: dict[str, Any] = {"young_modulus_Pa": 210e9, "thermal_expansion_per_K": 1.2e-5}
GRADIENT_PER_M = [2.5, 0.0]  # across 0.4 m, of the program's ΔT


def frame(*nodes: dict[str, Any], change_K: float = 20.0, dimension: int = 2, **sections: Any) -> dict[str, Any]:
    """A case of given nodes; beams have the default keys of this test where they do not give them."""
    made = document("frame", "Frame", "closed form", dimension, change_K, "triangle", 1, 1.0)
    made["node"] += nodes
    made["beam"] = [{"name": f"beam {number}", **STEEL, **beam} for number, beam in enumerate(sections.pop("beam"), 1)]
    made |= sections
    return finished(made)


def clamp(name: str, place: tuple[float, ...], **more: Any) -> dict[str, Any]:
    axes = "xyz"[: len(place)]
    return {**node(name, place, axes), "fixed_rotations": ["z"] if len(place) == 2 else list("xyz"), **more}


def states(made: dict[str, Any], **options: Any) -> dict[str, np.ndarray]:
    """The states of a case; the last key tells the hottest one."""
    found = solve.path(parse_case(made).resolve(), **options).states
    return {**found, "hot": np.array(int(np.argmax(found["temperature_change_K"])))}


def of_hottest(found: dict[str, np.ndarray], key: str) -> np.ndarray:
    return np.asarray(found[key][int(found["hot"])])


# E I = 6e7 N m², no shear deformation, mean temperature constant.
WARM: dict[str, Any] = {"cross_section_area_m2": 2e-2, "second_moments_of_area_m4": [6e7 / 210e9, 6e7 / 210e9],
                        "temperature_fraction": 0.0, "gradient_per_m": GRADIENT_PER_M}


def beam_of_6_m(*supports: dict[str, Any]) -> dict[str, Any]:
    left, right = supports
    return frame({"name": "A", "position_m": [0.0, 0.0], **left}, node("B", (3.0, 0.0)),
                 {"name": "C", "position_m": [6.0, 0.0], **right},
                 beam=[{"nodes": ["A", "B"], **WARM}, {"nodes": ["B", "C"], **WARM}])


PINNED = {"fixed": ["x", "y"]}
ROLLER = {"fixed": ["y"]}
CLAMPED = {"fixed": ["x", "y"], "fixed_rotations": ["z"]}
CURVATURE = 1.2e-5 * 20 * 2.5  # 1/m


def test_simply_supported_beam_bows_towards_its_warm_side() -> None:
    moved = of_hottest(states(beam_of_6_m(PINNED, ROLLER)), "displacement_m")
    # The arc of the curvature; its part of fourth order is 3e-7 of it.
    assert moved[1, 1] == pytest.approx((1 - np.cos(3 * CURVATURE)) / CURVATURE, rel=1e-9)
    assert moved[1, 1] == pytest.approx(2.7e-3, rel=1e-6)


def test_cantilever_bends_away_from_its_warm_side() -> None:
    found = states(beam_of_6_m(CLAMPED, {}))
    assert of_hottest(found, "displacement_m")[2, 1] == pytest.approx(-10.8e-3, rel=2e-6)
    assert of_hottest(found, "rotation_rad")[2] == pytest.approx([0, 0, -6 * CURVATURE], abs=1e-14)
    assert np.abs(found["displacement_m"][-1]).max() < 1e-13


def test_clamped_beam_carries_the_moment_of_the_gradient() -> None:
    found = states(beam_of_6_m(CLAMPED, CLAMPED))
    for end in ("first", "second"):
        assert of_hottest(found, f"beam_moment_{end}_N_m")[:, 2] == pytest.approx([36e3, 36e3], rel=1e-12)
        assert np.abs(of_hottest(found, f"beam_force_{end}_N")).max() < 1e-6


def test_propped_beam() -> None:
    found = states(beam_of_6_m(CLAMPED, ROLLER))
    # Linear theory; terms of the order (κ L)² = 1.3e-5 remain.
    assert abs(of_hottest(found, "beam_force_first_N")[0, 1]) == pytest.approx(9e3, rel=1.3e-5)
    assert abs(of_hottest(found, "beam_moment_first_N_m")[0, 2]) == pytest.approx(54e3, rel=1.3e-5)
    assert of_hottest(found, "beam_moment_second_N_m")[1, 2] == pytest.approx(0, abs=1e-6)


def portal(change_K: float) -> dict[str, Any]:
    cold = {"cross_section_area_m2": 5e-3, "second_moments_of_area_m4": [8e-5, 8e-5], "temperature_fraction": 0.0}
    return frame(clamp("A", (0.0, 0.0)), node("B", (0.0, 4.0)), node("C", (6.0, 4.0)), clamp("D", (6.0, 0.0)),
                 change_K=change_K,
                 beam=[{"nodes": ["A", "B"], **cold, "temperature_fraction": 1.0}, {"nodes": ["B", "C"], **cold},
                       {"nodes": ["C", "D"], **cold}])


def test_portal_with_a_heated_column() -> None:
    # One element per member. The numbers are of linear theory: at a thousandth of 60 K displacements are small.
    found = states(portal(0.06))
    assert 1e3 * abs(of_hottest(found, "beam_force_first_N")[1, 1]) == pytest.approx(536.8365, abs=2e-3)
    assert 1e3 * abs(of_hottest(found, "beam_moment_first_N_m")[0, 2]) == pytest.approx(1610.5095, abs=5e-3)
    assert 1e3 * abs(of_hottest(found, "beam_moment_second_N_m")[2, 2]) == pytest.approx(1610.5095, abs=5e-3)
    # At 60 K the change of shape matters by less than 1e-3.
    assert abs(of_hottest(states(portal(60.0)), "beam_force_first_N")[1, 1]) == pytest.approx(536.8365, rel=1e-3)


def arc(elements: int) -> float:
    """Error of the tip [m] of a cantilever of 1 m that a gradient bends by 1 rad."""
    made = frame(clamp("N0", (0.0, 0.0)), *(node(f"N{k}", (k / elements, 0.0)) for k in range(1, elements + 1)),
                 change_K=1 / (1.2e-5 * 250),
                 beam=[{"nodes": [f"N{k}", f"N{k + 1}"], **WARM, "gradient_per_m": [250.0, 0.0]} for k in range(elements)])
    tip = of_hottest(states(made), "displacement_m")[-1]
    return float(np.hypot(tip[0] + 1 - np.sin(1), tip[1] + 1 - np.cos(1)))


def test_free_thermal_arc_converges_with_fourth_order() -> None:
    assert arc(4) < 2e-6
    assert np.log2(arc(4) / arc(8)) == pytest.approx(4, abs=0.05)


SLENDER: dict[str, Any] = {"young_modulus_Pa": 1e9, "thermal_expansion_per_K": 0.0, "cross_section_area_m2": 1e-2,
                           "second_moments_of_area_m4": [1e-8, 1e-8]}
RIGIDITY_N_M2 = 10.0  # E I of SLENDER; P/(E A) is 1e-6 P L²/(E I) with L = 1 m


def slender(elements: int, **at_tip: Any) -> dict[str, Any]:
    """A cantilever of 1 m under a load at its tip."""
    nodes = [node(f"N{k}", (k / elements, 0.0)) for k in range(1, elements + 1)]
    return frame(clamp("N0", (0.0, 0.0)), *nodes[:-1], {**nodes[-1], **at_tip}, change_K=1e-6,
                 beam=[{"nodes": [f"N{k}", f"N{k + 1}"], **SLENDER} for k in range(elements)])


@pytest.mark.parametrize("load, x, w, error", [
    (1.0, 0.943566763717, 0.301720773800, 4e-7), (5.0, 0.612371639276, 0.713791523612, 1.2e-5),
    (10.0, 0.445004402246, 0.810609024880, 3.5e-5),
])
def test_elastica(load: float, x: float, w: float, error: float) -> None:
    # Eight beams; their error is of fourth order, see BeamFrame.ElasticaWithTipForce. The member extends by P/(E A).
    made = slender(8, force_N=[0.0, load * RIGIDITY_N_M2])
    tip = states(made, increments_per_branch=1)["displacement_m"][0, -1]
    assert tip[:2] + [1, 0] == pytest.approx([x, w], abs=error + 1e-6 * load)


def test_end_moment_bends_to_a_circle() -> None:
    found = states(slender(8, moment_N_m=[2 * np.pi * RIGIDITY_N_M2]), increments_per_branch=1)
    assert found["displacement_m"][0, -1] == pytest.approx([-1, 0, 0], abs=1e-13)
    assert found["rotation_rad"][0, -1, 2] == pytest.approx(2 * np.pi, abs=1e-12)


def test_bend_of_45_degrees() -> None:
    def tip(elements: int) -> np.ndarray:
        angle = np.pi / 4 * np.arange(elements + 1) / elements
        places = 100 * np.stack((1 - np.cos(angle), np.sin(angle), 0 * angle), axis=1)
        nodes = [clamp("N0", (0.0, 0.0, 0.0)), *(node(f"N{k}", place) for k, place in enumerate(places) if k)]
        nodes[-1]["force_N"] = [0.0, 0.0, 300.0]
        beam = {"young_modulus_Pa": 1e7, "shear_modulus_Pa": 5e6, "thermal_expansion_per_K": 0.0, "shape": "rectangle",
                "dimensions_m": [1.0, 1.0], "shear_factors": [1.0, 1.0], "axis_y": [0.0, 0.0, 1.0]}
        made = frame(*nodes, dimension=3, change_K=1e-6,
                     beam=[{"nodes": [f"N{k}", f"N{k + 1}"], **beam} for k in range(elements)])
        return np.asarray(places[-1] + states(made, increments_per_branch=1)["displacement_m"][0, -1])

    coarse, fine = tip(4), tip(8)
    # Straight beams on the curve: second order. Shear, which the reference does not have, moves the tip by 1e-3.
    assert fine + (fine - coarse) / 3 == pytest.approx([22.113118655, 58.537050522, 40.477781496], abs=5e-3)


def test_tip_force_in_space() -> None:
    """Small loads along both axes of a turned section, and a torque: the Timoshenko cantilever."""
    height, width, length, shear = 0.05, 0.02, 1.0, 70e9 / 2.66
    axis_y = np.array([0.0, 0.6, 0.8])
    beam = {"nodes": ["A", "B"], "young_modulus_Pa": 70e9, "poisson_ratio": 0.33, "shape": "rectangle",
            "dimensions_m": [height, width], "axis_y": axis_y.tolist()}
    free = {"name": "B", "position_m": [length, 0.0, 0.0], "moment_N_m": [1e-3, 0.0, 0.0], "force_N": [0.0, 0.0, 1e-2]}
    made = frame(clamp("A", (0.0, 0.0, 0.0)), free, dimension=3, change_K=1e-6, beam=[beam])
    found = states(made)
    about_z, about_y = width * height**3 / 12, height * width**3 / 12
    carried = 5 / 6 * shear * height * width
    along_y = 1e-2 * axis_y[2] * (length**3 / (3 * 70e9 * about_z) + length / carried)
    along_z = 1e-2 * axis_y[1] * (length**3 / (3 * 70e9 * about_y) + length / carried)
    expected = along_y * axis_y + along_z * np.array([0.0, -0.8, 0.6])
    assert found["displacement_m"][0, 1] == pytest.approx(expected, rel=1e-6, abs=1e-12)
    assert found["rotation_rad"][0, 1, 0] == pytest.approx(1e-3 / (shear * solid_torsion_m4(height, width)), rel=1e-6)


def test_weight_of_beams() -> None:
    beam = {"shape": "rod", "dimensions_m": [0.02], "density_kg_per_m3": 7850.0}
    made = frame(clamp("A", (0.0, 0.0)), node("B", (1.0, 0.0)), node("C", (2.0, 0.0)), change_K=1e-6,
                 beam=[{"nodes": ["A", "B"], **beam}, {"nodes": ["B", "C"], **beam}])
    made["truss"]["gravity_m_per_s2"] = [0.0, -9.81]
    found = states(made)
    mass = 7850 * np.pi / 4 * 0.02**2  # of each
    # The part beyond the section pulls downwards.
    assert found["beam_force_first_N"][0, 0, 1] == pytest.approx(-1.5 * mass * 9.81, rel=1e-3)


def test_moment_on_a_node() -> None:
    made = frame(clamp("A", (0.0, 0.0)), {**node("B", (1.0, 0.0)), "moment_N_m": [1000.0]}, change_K=1e-6,
                 beam=[{"nodes": ["A", "B"], **WARM}])
    found = states(made)
    assert found["rotation_rad"][0, 1, 2] == pytest.approx(1000 / 6e7, rel=1e-9)
    assert found["load_potential_J"][0] == pytest.approx(-(1000**2) / 6e7, rel=1e-9)


def test_boom_keeps_the_friction_of_its_cradle() -> None:
    run = sj.load(REPOSITORY / "cases" / "trusses" / "boom.toml").reduced()
    section = SHAPES["tube"].properties(0.06, 0.002)
    shear = 70e9 / 2.66 * section.shear_factors[0] * section.cross_section_area_m2
    bending = 70e9 * section.second_moments_of_area_m4[1]
    kept = 2.0 * (4.0**3 / (3 * bending) + 4.0 / shear)
    # Displacements of 1e-2 m of 4 m: terms of their square, 1e-5, remain.
    jump = np.linalg.norm(run.history["displacement_m"].values[-1, 4])
    assert jump == pytest.approx(kept, rel=1e-4)
    assert abs(run.summary["energy_residue_J"]) < 1e-6
    assert run.history["rotation_rad"].unit == "rad"
    assert run.history["beam_moment_first_N_m"].items == "beams"
    assert [event.kind for event in run.events][:1] == ["first_slip"] or len(run.events) > 0


def test_outcomes_of_a_campaign_include_beams() -> None:
    straight = {**WARM, "gradient_per_m": [0.0, 0.0], "temperature_fraction": 1.0}
    case = sj.load(frame(clamp("A", (0.0, 0.0)), clamp("B", (1.0, 0.0)), change_K=10.0,
                         beam=[{"nodes": ["A", "B"], **straight}]))
    found = outcomes.outcomes(case, outcomes.quick(case))
    assert found["largest_axial_force_N"] == pytest.approx(210e9 * 2e-2 * 1.2e-4, rel=1e-3)


def test_heated_beam_between_pins_buckles() -> None:
    straight = {**WARM, "gradient_per_m": [0.0, 0.0], "temperature_fraction": 1.0}
    # α ΔT = π² I/(A L²); strains of 0.4 % and four beams change it by less than 1 %.
    critical_K = np.pi**2 * (6e7 / 210e9) / (2e-2 * 36) / 1.2e-5
    places = [node(f"N{k}", (1.5 * k, 0.0), "xy" if k in (0, 4) else "") for k in range(5)]
    beams = [{"nodes": [f"N{k}", f"N{k + 1}"], **straight} for k in range(4)]
    states(frame(*places, change_K=0.98 * critical_K, beam=beams))
    with pytest.raises(StatejumpError) as refused:
        states(frame(*places, change_K=1.02 * critical_K, beam=beams))
    assert refused.value.code == "buckled"


def test_hinge_is_two_nodes_that_constraints_tie() -> None:
    """Two cantilevers with a hinge between their tips and a load on it: each carries half."""
    beam = {**WARM, "gradient_per_m": [0.0, 0.0]}
    made = frame(clamp("A", (0.0, 0.0)), {**node("B", (1.0, 0.0)), "force_N": [0.0, -1e3]}, node("C", (1.0, 0.0)),
                 clamp("D", (2.0, 0.0)), change_K=1e-6,
                 beam=[{"nodes": ["A", "B"], **beam}, {"nodes": ["C", "D"], **beam}])
    made["constraint"] = [{"name": f"hinge {axis}", "nodes": ["B", "C"], "directions": [axis, axis],
                           "coefficients": [1.0, -1.0]} for axis in "xy"]
    found = states(made)
    assert found["displacement_m"][0, 1:3, 1] == pytest.approx([-500 / (3 * 6e7)] * 2, rel=1e-6)
    turned = 500 / (2 * 6e7)
    assert found["rotation_rad"][0, 1:3, 2] == pytest.approx([-turned, turned], rel=1e-6)


def test_neglected_shear_centre_is_a_warning() -> None:
    made = spatial(shape="channel", dimensions_m=[0.1, 0.05, 0.004, 0.006], axis_y=[0.0, 1.0, 0.0])
    assert "beam 'beam 1': the shear centre" in parse_case(made).implausible[0]
    assert not parse_case(spatial(shape="tube", dimensions_m=[0.05, 0.002])).implausible


def test_beams_and_bars_together() -> None:
    """A stay that shortens: a bar pulls the tip of a beam."""
    made = frame(clamp("A", (0.0, 0.0)), node("B", (1.0, 0.0)), node("C", (1.0, 1.0), "xy"), change_K=-50.0,
                 beam=[{"nodes": ["A", "B"], **{**WARM, "gradient_per_m": [0.0, 0.0]}}])
    made["link"] = [{"name": "stay", "nodes": ["B", "C"], "young_modulus_Pa": 210e9, "cross_section_area_m2": 1e-6,
                     "thermal_expansion_per_K": 1.2e-5}]
    found = solve.path(parse_case(finished(made)).resolve()).states
    cold = int(np.argmin(found["temperature_change_K"]))
    bending, rigidity = 3 * 6e7, 210e9 * 1e-6
    expected = 6e-4 * rigidity / (rigidity + bending)
    assert found["displacement_m"][cold, 1, 1] == pytest.approx(expected, rel=1e-3)


# ---------------------------------------------------------------- sections

EXAMPLES = {"rod": (0.05,), "tube": (0.05, 0.004), "rectangle": (0.05, 0.02), "box": (0.05, 0.03, 0.004),
            "i": (0.1, 0.05, 0.008, 0.006), "channel": (0.1, 0.05, 0.008, 0.006), "t": (0.1, 0.05, 0.008, 0.006),
            "angle": (0.05, 0.006)}


def inside(shape: str, size: tuple[float, ...], y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Whether points are in the material of a section; its origin is at a corner or the centre."""
    if shape in ("rod", "tube"):
        radius, hole = size[0] / 2, size[0] / 2 - size[1] if shape == "tube" else 0.0
        return np.asarray((y**2 + z**2 <= radius**2) & (y**2 + z**2 >= hole**2))
    height, width = size[0], size[-1] if shape == "rectangle" else size[0] if shape == "angle" else size[1]
    within = (np.abs(y) <= height / 2) & (np.abs(z) <= width / 2)
    if shape == "rectangle":
        return np.asarray(within)
    if shape == "box":
        return np.asarray(within & ((np.abs(y) >= height / 2 - size[2]) | (np.abs(z) >= width / 2 - size[2])))
    if shape == "angle":
        return np.asarray(within & ((y <= -height / 2 + size[1]) | (z <= -width / 2 + size[1])))
    web, flange = size[2], size[3]
    flanges = y >= height / 2 - flange if shape == "t" else np.abs(y) >= height / 2 - flange
    middle = z <= -width / 2 + web if shape == "channel" else np.abs(z) <= web / 2
    return np.asarray(within & (flanges | middle))


@pytest.mark.parametrize("shape", EXAMPLES)
def test_sections_have_the_moments_of_their_area(shape: str) -> None:
    size, made = EXAMPLES[shape], SHAPES[shape].properties(*EXAMPLES[shape])
    cells, extent = 2000, max(EXAMPLES[shape][:2])
    middles = (np.arange(cells) + 0.5) / cells * extent - extent / 2
    y, z = np.meshgrid(middles, middles, indexing="ij")
    y, z = (part[inside(shape, size, y, z)] for part in (y, z))
    cell = (extent / cells) ** 2
    y, z = y - y.mean(), z - z.mean()
    # Cells that an edge cuts: 1e-3 of the area.
    assert len(y) * cell == pytest.approx(made.cross_section_area_m2, rel=2e-3)
    tensor = cell * np.array([[(z**2).sum(), -(y * z).sum()], [-(y * z).sum(), (y**2).sum()]])
    principal = np.linalg.eigvalsh(tensor)
    assert sorted(made.second_moments_of_area_m4) == pytest.approx(principal, rel=5e-3)
    if shape not in ("angle", "rod", "tube"):
        assert made.second_moments_of_area_m4 == pytest.approx(np.diag(tensor), rel=5e-3)


def test_torsion_of_sections() -> None:
    # The table of St. Venant: a square has 0.140577 of its side to the fourth; thin walls a third of length · wall³.
    assert solid_torsion_m4(1, 1) == pytest.approx(0.140577015, abs=1e-9)
    assert solid_torsion_m4(100, 1) == pytest.approx(100 / 3, rel=7e-3)
    closed = SHAPES["box"].properties(0.05, 0.05, 0.001)
    assert closed.torsion_constant_m4 == pytest.approx(0.049**3 * 0.001, rel=1e-12)
    opened = SHAPES["channel"].properties(0.05, 0.05, 0.001, 0.001)
    assert opened.torsion_constant_m4 == pytest.approx(0.148 * 1e-9 / 3, rel=1e-12)


@pytest.mark.parametrize("shape", SHAPES)
def test_every_shape_counts_its_dimensions(shape: str) -> None:
    known: Shape = SHAPES[shape]
    assert len(known.dimensions) == len(EXAMPLES[shape])
    assert known.fits(*EXAMPLES[shape])
    assert not known.rule or not known.fits(*(EXAMPLES[shape][0],) * len(known.dimensions))


# ---------------------------------------------------------------- refusals

def spatial(**beam: Any) -> dict[str, Any]:
    return frame(clamp("A", (0.0, 0.0, 0.0)), node("B", (1.0, 0.0, 0.0)), dimension=3, beam=[{"nodes": ["A", "B"], **beam}])


def planar(at_b: dict[str, Any] | None = None, **beam: Any) -> dict[str, Any]:
    return frame(clamp("A", (0.0, 0.0)), {**node("B", (1.0, 0.0)), **(at_b or {})}, beam=[{"nodes": ["A", "B"], **beam}])


TUBE = {"shape": "tube", "dimensions_m": [0.05, 0.002]}


@pytest.mark.parametrize("made, code, key", [
    (planar(), "beam_section_missing", "cross_section_area_m2"),
    (planar(dimensions_m=[0.1], cross_section_area_m2=1e-3), "beam_dimensions_without_shape", "dimensions_m"),
    (planar(shape="tube"), "beam_dimensions_missing", "dimensions_m"),
    (planar(shape="tube", dimensions_m=[0.05]), "beam_dimensions", "dimensions_m"),
    (planar(shape="tube", dimensions_m=[0.05, 0.0]), "beam_dimensions", "dimensions_m"),
    (planar(shape="tube", dimensions_m=[0.05, 0.03]), "beam_walls", "dimensions_m"),
    (planar(**TUBE, shear_factors=[0.5, 0.0]), "beam_not_positive", "shear_factors"),
    (planar(**TUBE, axis_y=[0.0, 1.0]), "planar_axis_y", "axis_y"),
    (planar(**TUBE, gradient_per_m=[0.0, 1.0]), "planar_gradient", "gradient_per_m"),
    (planar(**TUBE, program="none"), "reference_without_section", "program"),
    (planar(**TUBE, gradient_program="none"), "reference_without_section", "gradient_program"),
    (planar({"fixed_rotations": ["x"]}, **TUBE), "planar_rotations", "fixed_rotations"),
    (planar({"moment_N_m": [1.0, 0.0]}, **TUBE), "wrong_dimension_of_moment", "moment_N_m"),
    (spatial(shape="rectangle", dimensions_m=[0.05, 0.02]), "axis_missing", "axis_y"),
    (spatial(**TUBE, gradient_per_m=[1.0, 0.0]), "axis_missing", "axis_y"),
    (spatial(**TUBE, axis_y=[1.0, 0.0, 0.0]), "axis_along_beam", "axis_y"),
    (spatial(cross_section_area_m2=1e-3, second_moments_of_area_m4=[1e-6, 1e-6], axis_y=[0.0, 1.0, 0.0]),
     "beam_section_missing", "torsion_constant_m4"),
])
def test_refuses_wrong_keys(made: dict[str, Any], code: str, key: str) -> None:
    with pytest.raises(StatejumpError) as refused:
        parse_case(made)
    assert refused.value.code == code
    assert getattr(refused.value, "key", key) == key


def test_refuses_rotations_of_a_node_without_beam() -> None:
    made = planar(**TUBE)
    made["node"].append({**node("C", (1.0, 1.0), "xy"), "fixed_rotations": ["z"]})
    made["link"] = [{"name": "BC", "nodes": ["B", "C"], "young_modulus_Pa": 1e9, "cross_section_area_m2": 1e-4,
                     "thermal_expansion_per_K": 0.0}]
    with pytest.raises(StatejumpError) as refused:
        parse_case(finished(made))
    assert refused.value.code == "node_without_rotation"


def test_too_few_beams_are_refused() -> None:
    made = frame(clamp("A", (0.0, 0.0)), node("B", (1.0, 0.0)), change_K=3 / (1.2e-5 * 250),
                 beam=[{"nodes": ["A", "B"], **WARM, "gradient_per_m": [250.0, 0.0]}])
    with pytest.raises(Exception, match="divide the beam into more beams"):
        states(made)


def test_heated_beam_in_motion_follows_its_path() -> None:
    """The gradient bends a cantilever in 10 s, its lowest period is 0.024 s. The motion is near the quasi-static path and
    its energy is balanced: elastic and kinetic energy are the work of the temperature."""
    nodes = [clamp("N0", (0.0, 0.0)), *(node(f"N{i}", (i / 4, 0.0)) for i in range(1, 5))]
    beams = [{"nodes": [f"N{i}", f"N{i + 1}"], "shape": "rectangle", "dimensions_m": [0.05, 0.02],
              "density_kg_per_m3": 7800.0, "temperature_fraction": 0.0, "gradient_per_m": GRADIENT_PER_M}
             for i in range(4)]
    made = frame(*nodes, beam=beams)
    made["thermal"]["period_s"] = 10.0
    case = parse_case(made | {"motion": {"steps_per_cycle": 4000}})
    slow, moving = solve.path(case.resolve()).states, motion.simulate(case).states
    deepest = slow["displacement_m"][:, -1, 1].min()
    assert deepest == pytest.approx(-1.2e-5 * 50.0 / 2, rel=1e-6)
    assert moving["displacement_m"][:, -1, 1].min() == pytest.approx(deepest, rel=5e-3)
    energy = moving["elastic_energy_J"] + moving["kinetic_energy_J"]
    # The midpoint rule balances the energy but for the vibration within a step, (2π h/T)² of its energy.
    within = (2 * np.pi * 2.5e-3 / 0.024) ** 2 * moving["kinetic_energy_J"].max()
    assert energy - energy[0] == pytest.approx(moving["thermal_work_J"], abs=within)


def test_models_without_rotations_refuse_beams() -> None:
    case = sj.load(REPOSITORY / "cases" / "trusses" / "boom.toml")
    with pytest.raises(StatejumpError) as refused:
        motion.simulate(case.changed({"motion.scheme": "regularised", "motion.masses": "lumped", "reduced.sticking": "elastic"}))
    assert refused.value.code == "beams_not_supported"
    check_dem(case)
    with pytest.raises(StatejumpError) as refused:
        check_dem(sj.load(REPOSITORY / "cases" / "trusses" / "hinge_line.toml"))
    assert refused.value.code == "dem_joint"


def test_answers_of_beams_rank_no_hinges() -> None:
    answers = sj.truss.answers(sj.load(REPOSITORY / "cases" / "trusses" / "hinge_line.toml"), sensitivity=False)
    assert answers.jump > 0 and answers.shares is None
    assert "joint_turns_nodes" in [getattr(note, "code", None) for note in answers.notes]


def test_mechanism_names_the_rotation() -> None:
    made = frame(node("A", (0.0, 0.0), "xy"), node("B", (1.0, 0.0)), beam=[{"nodes": ["A", "B"], **TUBE}])
    with pytest.raises(StatejumpError) as refused:
        states(made)
    assert "node 'B' mostly along y" in str(refused.value)


def test_boom_has_a_page_and_tables(statejump: Callable[..., Outcome]) -> None:
    for command in (["reduced", "trusses/boom"], ["report", "results/boom", "-o", "page.html"],
                    ["export", "results/boom/reduced.h5", "--format", "vtu"]):
        done = statejump(*command)
        assert done.status == 0, done.errors


@pytest.mark.parametrize("command", [["dem"], ["compare"]])
def test_commands_refuse_what_they_lack(statejump: Callable[..., Outcome], command: list[str]) -> None:
    refused = statejump(*command, "trusses/hinge_line")
    assert refused.status == 2
    assert "hinge 'left'" in refused.errors


@pytest.mark.parametrize("load_N", [0.01, 100.0])
def test_without_temperatures_each_increment_is_one_solve(load_N: float) -> None:
    """Nothing moves after the start, and temperatures do no work: rounding does not shorten steps."""
    nodes = [clamp("N0", (0.0, 0.0, 0.0)), *(node(f"N{k}", (float(k), 0.3 * (k % 2), 0.0)) for k in range(1, 12))]
    made = frame(*nodes, change_K=0.0, dimension=3,
                 beam=[{"nodes": [f"N{k}", f"N{k + 1}"], "shape": "rectangle", "dimensions_m": [0.1, 0.2],
                        "axis_y": [0.0, 0.0, 1.0]} for k in range(11)])
    made["node"][-1]["force_N"] = [0.0, -load_N, 0.0]
    path = solve.path(parse_case(made).resolve())
    assert path.solves <= len(path.states["time_s"]) + 3  # the start, and one after each corner
