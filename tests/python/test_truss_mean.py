# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections [[mean]] of trusses, and constraints on rotations: closed forms, balance of forces, motion, modes, refusals."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from failures import Failure, failure, note

import statejump as sj

E_I = 700.0  # of beams, about both axes [N m2]; E A/L is 7e9 N/m, and they do not shear
BEAM: dict[str, Any] = {
    "young_modulus_Pa": 70e9, "cross_section_area_m2": 0.1, "second_moments_of_area_m4": [1e-8, 1e-8],
    "torsion_constant_m4": 1e-8, "thermal_expansion_per_K": 0.0, "density_kg_per_m3": 1.0, "axis_y": [0.0, 1.0, 0.0]}
STIFFNESS = 7e6  # of a leg of 1 m [N/m]
LEG = {"young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-4, "thermal_expansion_per_K": 0.0}
SMALL = 1e-3  # of loads [N]: rotations of 1e-6


def clamp(name: str, *position: float) -> dict[str, Any]:
    axes = "xyz"[: len(position)]
    return {"name": name, "position_m": list(position), "fixed": list(axes), "fixed_rotations": ["z"] if len(position) == 2 else list(axes)}


def case(nodes: list[dict[str, Any]], change_K: float = 0.0, **sections: Any) -> dict[str, Any]:
    return {"case": {"name": "mean", "kind": "truss"}, "truss": {"dimension": len(nodes[0]["position_m"])},
            "node": nodes, "thermal": {"shape": "triangle", "temperature_change_max_K": change_K, "period_s": 1.0},
            **sections}


def cantilevers(*constraints: dict[str, Any], **more: Any) -> dict[str, Any]:
    """Two cantilevers along x, of 1 m and 2 m, in one plane; a force along y at the tip B of the first one."""
    flat = {key: value for key, value in BEAM.items() if key != "axis_y"}
    nodes = [clamp("A", 0, 0), {"name": "B", "position_m": [1, 0], "force_N": [0, SMALL]}, clamp("C", 0, 3),
             {"name": "D", "position_m": [2, 3]}]
    return case(nodes, beam=[{"name": "AB", "nodes": ["A", "B"], **flat}, {"name": "CD", "nodes": ["C", "D"], **flat}],
                constraint=list(constraints), **more)


def tie(**changes: Any) -> dict[str, Any]:
    return {"name": "tie", "nodes": ["B", "D"], "directions": ["Rz", "Rz"], "coefficients": [1, -1], **changes}


def last(run: Any, key: str) -> np.ndarray:
    return np.asarray(run.history[key].values[-1])


# ---------------------------------------------------------------- constraints on rotations

def test_tied_rotations_share_the_bending() -> None:
    """The tie carries the moment M: P L²/2 - M L = M L' for the rotations of tips, L = 1 and L' = 2."""
    run = sj.load(cantilevers(tie())).reduced()
    moment = SMALL / 6
    turned, moved = last(run, "rotation_rad")[:, 2] * E_I, last(run, "displacement_m")[:, 1] * E_I
    assert turned[1] == turned[3] == pytest.approx(2 * moment, rel=1e-6)
    assert moved[1] == pytest.approx(SMALL / 3 - moment / 2, rel=1e-6)
    assert moved[3] == pytest.approx(2 * moment, rel=1e-6)


def test_a_lever_couples_a_displacement_with_a_rotation() -> None:
    """u_D = 2 m θ_B: virtual work gives P L²/2 = (E I/L + 4 · 3 E I/L'³) θ_B if the moment bends the first cantilever."""
    made = cantilevers(tie(nodes=["D", "B"], directions=["y", "Rz"], coefficients=[1, -2]))
    made["node"][1] |= {"force_N": [0, 0], "moment_N_m": [SMALL]}
    run = sj.load(made).reduced()
    turned = SMALL / (1 + 4 * 3 / 8)
    assert last(run, "rotation_rad")[1, 2] * E_I == pytest.approx(turned, rel=1e-6)
    assert last(run, "displacement_m")[3, 1] * E_I == pytest.approx(2 * turned, rel=1e-6)


def test_tied_rotations_in_motion_follow_the_path_when_slow() -> None:
    heated = {"thermal": {"shape": "sine", "temperature_change_max_K": 10.0, "period_s": 2.0},
              "motion": {"steps_per_cycle": 2000}}
    made = cantilevers(tie(), **heated)
    for beam in made["beam"]:
        beam |= {"thermal_expansion_per_K": 1e-5, "gradient_per_m": [0.1, 0.0]}
    path, motion = sj.load(made).reduced(), sj.load(made).reduced(dynamic=True)
    turned = motion.native.states["rotation_rad"][:, :, 2]
    assert turned.any() and np.array_equal(turned[:, 1], turned[:, 3])
    static, moved = (run.history["displacement_m"].values for run in (path, motion))
    # It starts at rest: its lowest oscillation, of 73/s, has the amplitude rate/frequency, up to 4 % of the path.
    assert np.abs(moved - static).max() < 1e-2 * np.abs(static).max()


def test_tied_rotations_in_modes() -> None:
    """Masses at both tips without inertia of rotation: the flexibility of the tied tips gives the frequencies."""
    made = cantilevers(tie(), motion={"masses": "lumped"})
    made["node"][1]["force_N"] = [0, 0]
    for at, mass in ((1, 2e3), (3, 3e3)):
        made["node"][at]["mass_kg"] = mass
    # Forces P and Q at the tips cause the rotation (P/2 + 2 Q)/3 of both, from M: P/2 - M = 2 Q + 2 M.
    flexibility = np.zeros((2, 2))
    for column, (first, second) in enumerate(((1, 0), (0, 1))):
        moment = (first / 2 - 2 * second) / 3
        flexibility[:, column] = first / 3 - moment / 2, 8 * second / 3 + 2 * moment
    wanted = np.sort(1 / np.sqrt(np.linalg.eigvals(flexibility / E_I * np.array([2e3, 3e3])))) / (2 * np.pi)
    assert sj.modes(sj.load(made), 2).frequency_Hz == pytest.approx(wanted, rel=1e-4)


# ---------------------------------------------------------------- means

PLACES = np.array([[0, 0, 0], [2, 0, 0], [0, 1, 0], [1.5, 1, 0.5]], dtype=float)
WEIGHTS = np.array([1.0, 2.0, 3.0, 0.5])
REFERENCE = np.array([0.7, 0.2, 1.3])
FORCE, MOMENT = SMALL * np.array([3.0, -2.0, 1.0]), SMALL * np.array([0.5, 1.0, -2.0])


def legs(change_K: float = 0.0, **mean: Any) -> dict[str, Any]:
    """Four nodes, each on three legs along x, y and z: a force on a node moves it by force/STIFFNESS."""
    nodes, links = [], []
    for number, place in enumerate(PLACES):
        nodes.append({"name": f"P{number}", "position_m": place.tolist()})
        for axis, along in zip("xyz", np.eye(3)):
            foot = f"P{number}{axis}"
            nodes.append({"name": foot, "position_m": (place + along).tolist(), "fixed": list("xyz")})
            links.append({"name": foot, "nodes": [f"P{number}", foot], **LEG, "mass_kg": 1e-3})
    nodes.append({"name": "R", "position_m": REFERENCE.tolist(), "force_N": FORCE.tolist(), "moment_N_m": MOMENT.tolist()})
    made = case(nodes, change_K, link=links)
    made["mean"] = [{"name": "plate", "reference": "R", "nodes": [f"P{number}" for number in range(4)],
                     "weights": WEIGHTS.tolist(), **mean}]
    return made


def distributed(force: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """Return the forces on the nodes, written independently of the program: w (F/W + (J⁻¹ M) x r)."""
    centre = WEIGHTS @ PLACES / WEIGHTS.sum()
    arms = PLACES - centre
    inertia = sum(w * (r @ r * np.eye(3) - np.outer(r, r)) for w, r in zip(WEIGHTS, arms))
    turned = np.linalg.solve(inertia, moment + np.cross(REFERENCE - centre, force))
    return np.array([w * (force / WEIGHTS.sum() + np.cross(turned, r)) for w, r in zip(WEIGHTS, arms)])


def test_loads_of_the_reference_are_distributed_as_by_rbe3() -> None:
    moved = last(sj.load(legs()).reduced(), "displacement_m")[:16:4]
    wanted = distributed(FORCE, MOMENT)
    assert wanted.sum(axis=0) == pytest.approx(FORCE, rel=1e-12)
    assert np.cross(PLACES - REFERENCE, wanted).sum(axis=0) == pytest.approx(MOMENT, rel=1e-12)
    # Rounding of displacements of 1e-9 m beside lengths of 1 m.
    assert moved * STIFFNESS == pytest.approx(wanted, abs=1e-7 * SMALL)


def test_the_reference_moves_with_its_nodes() -> None:
    """Displacement and rotation of the reference do the work of its loads: energies of legs and loads agree."""
    run = sj.load(legs()).reduced()
    forces = distributed(FORCE, MOMENT)
    work = FORCE @ last(run, "displacement_m")[-1] + MOMENT @ last(run, "rotation_rad")[-1]
    assert work == pytest.approx((forces**2).sum() / STIFFNESS, rel=1e-6)


def test_rotations_that_do_not_follow_are_held() -> None:
    made = legs(directions=["x", "y", "z"])
    del made["node"][-1]["moment_N_m"]
    run = sj.load(made).reduced()
    assert last(run, "displacement_m")[:16:4] * STIFFNESS == pytest.approx(distributed(FORCE, np.zeros(3)), abs=1e-7 * SMALL)
    made = legs(directions=["x", "y", "z", "Rz"])
    made["node"][-1]["moment_N_m"] = [0.0, 0.0, SMALL]
    turned = last(sj.load(made).reduced(), "rotation_rad")[-1]
    assert turned[2] and not turned[:2].any()


def test_free_expansion_of_the_nodes_causes_no_force() -> None:
    """Triangle of bars that expand; a beam from a clamp ends at the reference, which is their centre, and stays unloaded."""
    corners = np.array([[1, 0, 0], [-0.5, 0.75**0.5, 0], [-0.5, -(0.75**0.5), 0]])
    nodes = [{"name": f"P{k}", "position_m": place.tolist()} for k, place in enumerate(corners)]
    nodes += [{"name": "R", "position_m": [0, 0, 0]}, clamp("A", 0, 0, 1)]
    links = [{"name": f"L{k}", "nodes": [f"P{k}", f"P{(k + 1) % 3}"], **LEG, "thermal_expansion_per_K": 2e-5, "mass_kg": 1.0}
             for k in range(3)]
    # Bars to a node above it make the triangle rigid.
    nodes.append({"name": "T", "position_m": [0, 0, 0.5]})
    links += [{"name": f"T{k}", "nodes": [f"P{k}", "T"], **LEG, "thermal_expansion_per_K": 2e-5, "mass_kg": 1.0} for k in range(3)]
    made = case(nodes, 100.0, link=links, beam=[{"name": "AR", "nodes": ["A", "R"], **BEAM}],
                mean=[{"name": "plate", "reference": "R", "nodes": ["P0", "P1", "P2"]}])
    run = sj.load(made).reduced()
    hot = int(np.argmax(run.history["temperature_change_K"].values))
    moved = run.history["displacement_m"].values[hot]
    assert moved[:3] == pytest.approx(2e-3 * corners, abs=1e-12)
    assert np.abs(moved[3]).max() < 1e-14
    assert np.abs(run.links["axial_force_N"].values).max() < 1e-6 * STIFFNESS * 2e-3


def flat(**more: Any) -> dict[str, Any]:
    """Two nodes on two legs each, in a plane, with a mass at a reference between them."""
    nodes, links = [], []
    for name, place in (("P", 0.0), ("Q", 2.0)):
        nodes.append({"name": name, "position_m": [place, 0.0]})
        for axis, (x, y) in (("x", (1, 0)), ("y", (0, 1))):
            nodes.append({"name": name + axis, "position_m": [place + x, y], "fixed": ["x", "y"]})
            links.append({"name": name + axis, "nodes": [name, name + axis], **LEG, "mass_kg": 1e-6})
    nodes.append({"name": "R", "position_m": [0.5, 0.0], "mass_kg": 4.0})
    return case(nodes, link=links, mean=[{"name": "m", "reference": "R", "nodes": ["P", "Q"]}], **more)


def test_a_mass_at_the_reference_in_modes() -> None:
    """Along y the nodes carry 3/4 and 1/4 of its force: 1/k = (9 + 1)/16 of that of a leg; along x 1/2 and 1/2."""
    wanted = np.sqrt(STIFFNESS / 4 * np.array([16 / 10, 2])) / (2 * np.pi)
    assert sj.modes(sj.load(flat()), 2).frequency_Hz == pytest.approx(wanted, rel=1e-6)


def test_a_mean_in_motion() -> None:
    """A force on the mass, from rest as drawn: it oscillates about its equilibrium."""
    made = flat(motion={"start": "drawn", "steps_per_cycle": 16000})
    made["node"][-1]["force_N"] = [0.0, 1.0]
    made["thermal"]["period_s"] = 0.05
    made["dem"] = {"link_damping_ratio": 0.0}
    run = sj.load(made).reduced(dynamic=True)
    moved = run.history["displacement_m"].values
    stiffness = STIFFNESS * 1.6
    time = run.history["time_s"].values
    assert moved[:, -1, 1] == pytest.approx((1 - np.cos(np.sqrt(stiffness / 4) * time)) / stiffness, abs=2e-3 / stiffness)
    assert moved[:, -1, 1] == pytest.approx(0.75 * moved[:, 0, 1] + 0.25 * moved[:, 3, 1], abs=1e-15)


def test_a_large_rotation_is_noted() -> None:
    """A lever on two nodes that rotate by 0.1 rad about the first one: the error is about 0.1²/2 of the lever."""
    made = flat()
    made["node"][3] |= {"fixed": []}
    made["link"] = [one for one in made["link"] if one["name"] != "Qy"]
    made["link"] += [{"name": "PQ", "nodes": ["P", "Q"], **LEG, "mass_kg": 1e-6}]
    made["link"] = [one for one in made["link"] if one["name"] != "Qx"]
    made["node"] = [one for one in made["node"] if one["name"] not in ("Qx", "Qy")]
    made["node"].append({"name": "S", "position_m": [2.0, 1.0], "fixed": ["x", "y"]})
    made["link"].append({"name": "QS", "nodes": ["Q", "S"], **LEG, "mass_kg": 1e-6, "thermal_expansion_per_K": 1e-3})
    made["mean"][0]["reference"] = "R"
    made["thermal"]["temperature_change_max_K"] = 100.0
    warnings = sj.load(made).reduced().warnings
    found = next(one for one in warnings if one.code == "mean_rotates")
    assert found == note("mean_rotates", mean="m")
    assert found.details["angle_rad"] == pytest.approx(0.1 / 2, rel=0.02)
    assert found.details["error_m"] == pytest.approx(0.1**2 / 8 * 1.0, rel=0.05)
    made["thermal"]["temperature_change_max_K"] = 1.0
    assert not [one for one in sj.load(made).reduced().warnings if getattr(one, "code", "") == "mean_rotates"]


# ---------------------------------------------------------------- refusals

def refused(made: dict[str, Any], expected: Failure) -> None:
    with pytest.raises(sj.StatejumpError) as error:
        sj.load(made)
    assert error.value == expected


@pytest.mark.parametrize("name, expected", {
    "reference": failure("misspelt_reference", key="reference", meant="R"),
    "nodes": failure("no_nodes", key="nodes"),
    "unknown": failure("misspelt_reference", key="nodes", meant="P3"),
    "repeated": failure("mean_node_repeated", key="nodes"),
    "weights": failure("mean_weights", key="weights"),
    "weight": failure("mean_weights", key="weights"),
    "directions": failure("rigid_without_direction", key="directions"),
    "line": failure("mean_undetermined", key="directions", direction="Rx"),
    "beside the line": failure("mean_undetermined", key="directions", direction="y"),
    "moment": failure("mean_moment", key="directions", direction="Rx"),
    "no rotation": failure("node_without_rotation", key="moment_N_m"),
}.items())
def test_mistakes_are_named(name: str, expected: Failure) -> None:
    changes: dict[str, dict[str, Any]] = {
        "reference": {"reference": "RR"}, "nodes": {"nodes": []}, "unknown": {"nodes": ["P0", "P33"]},
        "repeated": {"nodes": ["P0", "R", "P1", "P2"]}, "weights": {"weights": [1, 2]}, "weight": {"weights": [1, 2, 0, 1]},
        "directions": {"directions": []}, "line": {"nodes": ["P0", "P1"], "weights": [1, 2], "directions": ["x", "Rx", "Ry", "Rz"]},
        "beside the line": {"nodes": ["P0", "P1"], "weights": [1, 2], "directions": ["x", "y", "Ry", "Rz"]},
        "moment": {"directions": ["x", "y", "z", "Rz"]}, "no rotation": {"directions": ["x", "y", "z"]}}
    made = legs(**changes[name])
    if name in ("reference", "directions", "line", "beside the line"):
        del made["node"][-1]["moment_N_m"]
    refused(made, expected)


def test_nodes_on_a_line_determine_the_other_directions() -> None:
    made = legs(nodes=["P0", "P1"], weights=[1, 2], directions=["x", "Ry", "Rz"])
    made["node"][-1] |= {"fixed": ["y", "z"], "moment_N_m": [0.0, SMALL, SMALL]}
    moved = last(sj.load(made).reduced(), "displacement_m")
    # Moments about y and z, with that of the force from the reference 1.3 m above the line, 0.2 m beside it.
    pair = (SMALL + 1.3 * FORCE[0]) / 2
    assert moved[4, 2] * STIFFNESS == pytest.approx(-pair, rel=1e-5)
    assert moved[4, 1] * STIFFNESS == pytest.approx((SMALL - 0.2 * FORCE[0]) / 2, rel=1e-5)


@pytest.mark.parametrize("changes, expected", [
    ({"directions": ["Rx", "Rz"]}, failure("planar_directions", key="directions")),
    ({"coefficients": [1, 1e-10]}, failure("constraint_coefficient", value=1e-10)),
    ({"nodes": ["B", "E"]}, failure("node_without_rotation", key="nodes", value="E"))])
def test_rotations_in_constraints_are_checked(changes: dict[str, Any], expected: Failure) -> None:
    made = cantilevers(tie(**changes))
    made["node"].append({"name": "E", "position_m": [2, 4], "fixed": ["x", "y"]})
    refused(made, expected)


def test_coefficients_of_rotations_have_a_unit_of_their_own() -> None:
    """A structure in a length unit of 1e-12 m would have this coefficient."""
    sj.load(cantilevers(tie(nodes=["D", "B"], directions=["y", "Rz"], coefficients=[1, -1e-12])))


def test_the_dem_has_no_means() -> None:
    with pytest.raises(sj.StatejumpError) as error:
        sj.load(flat()).dem()
    assert error.value == failure("dem_constraint")
