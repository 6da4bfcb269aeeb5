# SPDX-License-Identifier: GPL-3.0-or-later
"""Rest sets through Python: closed forms, curves and meshes from callables, case files, and written files."""
from __future__ import annotations

import errno
import json
import os
from math import atan, cos, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from conftest import REPOSITORY, results_in
from failures import Failure, failing, failure
import statejump as sj
from statejump import _engine
from statejump.cli.statics import statics_command
from statejump.core.errors import NotAllowed, Range, StatejumpError
from statejump.kinds.loading import load_case
from statejump.kinds.statics.mesh import can_mesh
from statejump.kinds.statics.solve import cone_angles

C = 1e-4
CASES = REPOSITORY / "cases"


def planar(direction: float, size: float = 3.0) -> tuple[float, float]:
    return size * cos(direction), size * sin(direction)


def run(case_file: Path, results: Path) -> tuple[str, Path]:
    """Run the command as the statejump command would."""
    done = CliRunner().invoke(statics_command, [str(case_file), "--results", str(results)], catch_exceptions=False)
    assert done.exit_code == 0
    return done.output, results / load_case(case_file).name


@pytest.mark.parametrize("mu", [0.01, 0.3, 2.0])
def test_half_angle_is_atan_mu(mu: float) -> None:
    arc = _engine.rest_in_bearing(C, [planar(1.0)], mu)["any"]["parts"][0]
    assert arc["angle_rad"] == pytest.approx(2 * atan(mu), abs=1e-12)
    assert arc["diameter_m"] == pytest.approx(2 * C * sin(atan(mu)), rel=1e-12)
    cap = _engine.rest_in_socket(C, [(1, 2, 3)], mu)["any"]["parts"][0]
    assert cap["angle_rad"] == pytest.approx(2 * atan(mu), abs=1e-12)
    assert cap["area_m2"] == pytest.approx(2 * pi * C**2 * (1 - cos(atan(mu))), rel=1e-11)


@pytest.mark.parametrize("beta", [0.0, 0.2, 0.58, 0.59, 3.0])
def test_two_forces_at_beta(beta: float) -> None:
    mu = 0.3
    found = _engine.rest_in_bearing(C, [planar(3.0), planar(3.0 + beta)], mu)
    common = max(0.0, 2 * atan(mu) - beta)
    assert found["all"]["length_m"] == pytest.approx(C * common, abs=1e-18)
    assert found["any"]["length_m"] == pytest.approx(C * (4 * atan(mu) - common), abs=1e-18)


def test_curve_and_surface_from_callables() -> None:
    curves = _engine.implicit_curves(
        lambda p: p @ p - C**2, lambda p: 2 * p, (-1.3e-4, -1.3e-4), (1.31e-4, 1.32e-4), 40
    )
    arc = _engine.rest_on_curves(curves, [planar(1.0)], 0.3)["any"]["parts"][0]
    ends = np.arctan2(arc["points_m"][[0, -1], 1], arc["points_m"][[0, -1], 0])
    assert sorted(ends - 1.0) == pytest.approx([-atan(0.3), atan(0.3)], abs=1e-12)
    mesh = _engine.implicit_surface(
        lambda p: p @ p - C**2, lambda p: 2 * p, (-1.3e-4,) * 3, (1.31e-4, 1.32e-4, 1.33e-4), 16
    )
    cap = _engine.rest_on_mesh(mesh, [(1, 2, 3)], 0.5)["any"]
    exact = _engine.rest_in_socket(C, [(1, 2, 3)], 0.5)["any"]
    assert cap["area_m2"] == pytest.approx(exact["area_m2"], rel=0.01)
    assert cap["diameter_m"] == pytest.approx(exact["diameter_m"], rel=1e-6)


def test_an_error_in_a_callable_comes_through() -> None:
    def broken(p: np.ndarray) -> float:
        raise KeyError("broken")

    with pytest.raises(KeyError, match="broken"):
        _engine.implicit_curves(broken, lambda p: p, (-1, -1), (1, 1), 10)


def test_profile_of_a_bore() -> None:
    curve = _engine.journal_in_profile(lambda theta: 5.1e-3 + 1e-5 * cos(3 * theta), 5e-3, 360)
    radius = np.linalg.norm(curve.nodes_m, axis=1)
    # Lobes that the journal bridges are cut: never beyond the wall's own, at least where it dips.
    assert radius.min() == pytest.approx(0.9e-4, abs=1e-9)
    assert radius.max() < 1.1e-4 + 1e-9
    assert _engine.rest_on_curves([curve], [(-1, 0)], 0.02)["any"]["parts"]


def test_can_of_a_cylinder() -> None:
    """The rest set on the mesh of a closed cylinder equals the closed form; it excludes the rims, which are corners."""
    mesh = can_mesh(C, 2e-4)
    exact = _engine.rest_in_bore(C, 2e-4, [(3, 4, 1)], 0.4)["any"]
    found = _engine.rest_on_mesh(mesh, [(3, 4, 1)], 0.4)["any"]
    assert found["area_m2"] == pytest.approx(exact["area_m2"], rel=2e-3)
    shoulder = _engine.rest_on_mesh(mesh, [(0.1, 0, 1)], 0.4)["any"]
    assert shoulder["area_m2"] == pytest.approx(pi * C**2, rel=2e-3)


MISTAKES = {
    "zero force": (
        "journal", [("force_N = [60, -80, 0]", "force_N = [0, 0, 0]")],
        failure("no_nonzero_force", key="force 'cold'", value=[0, 0, 0])),
    "negative friction": (
        "journal", [("friction_coefficient = 0.3", "friction_coefficient = -0.3")],
        failure("out_of_range", key="joint.friction_coefficient", value=-0.3, allowed=Range(0, 100, "-"))),
    "axial force on a journal": (
        "journal", [("force_N = [60, -80, 0]", "force_N = [60, -80, 1]")],
        failure("force_out_of_plane", key="force 'cold'", value=[60.0, -80.0, 1.0], type="journal")),
    "no clearance": (
        "journal", [("clearance_m = 1e-4\n", "")], failure("missing_for_joint_type", key="joint.clearance_m", type="journal")),
    "key of another type": (
        "journal", [("clearance_m = 1e-4", "clearance_m = 1e-4\nlobes = 3")],
        failure("wrong_joint_type", key="joint.lobes", value=3, types="'lobed'")),
    "unknown type": (
        "journal", [('type = "journal"', 'type = "jurnal"')],
        failure("misspelt_name", key="joint.type", value="jurnal", allowed=("slot", "journal", "ball", "cylinder", "lobed", "mesh"), meant="journal")),
    "lobes that reach the middle": (
        "lobed", [("lobe_amplitude_m = 2e-5", "lobe_amplitude_m = 1e-4")],
        failure("lobe_amplitude", key="joint.lobe_amplitude_m", value=0.0001, clearance_m=0.0001)),
    "two components": (
        "journal", [("force_N = [60, -80, 0]", "force_N = [60, -80]")],
        failure("force_components", item="force 1", key="force_N", value=[60, -80], largest_N=1000000000000.0)),
    "no number": (
        "journal", [("force_N = [60, -80, 0]", "force_N = [60, nan, 0]")],
        failure("force_components", item="force 1", key="force_N", value=[60, float("nan"), 0], largest_N=1000000000000.0, allowed=Range(-1000000000000.0, 1000000000000.0, "N"))),
    "force without a force": (
        "journal", [("force_N = [60, -80, 0]", "")],
        failure("force_components", item="force 1", key="force_N", largest_N=1000000000000.0, allowed=Range(-1000000000000.0, 1000000000000.0, "N"))),
    "unknown key of a force": (
        "journal", [("force_N = [60, -80, 0]", "forces = 1")],
        failure("misspelt_key", item="force 1", key="forces", meant="force_N")),
    "rate without temperatures": (
        "ball", [("temperature_change_K = [0, 50, 100]", "")],
        failure("force_temperatures", item="force 1", key="temperature_change_K", value=None, least_K=-10000.0, largest_K=10000.0)),
    "temperatures without a rate": (
        "ball", [("force_rate_N_per_K = [0.5, 0, 0]", "")],
        failure("force_rate", item="force 1", key="force_rate_N_per_K", value=None)),
    "force as a number": (
        "slot", [("[[force]]\nforce_N = [20, -100, 0]", "[forces]\nforce = 1")],
        failure("misspelt_key", section="section [forces]", meant="[force]")),
    "thermal section": (
        "slot", [("[picture]", '[thermal]\nshape = "sine"\ntemperature_change_max_K = 1\n[picture]')],
        failure("not_from_file", key="section [thermal]")),
    "panels in space": (
        "ball", [("[[force]]", "[picture]\nfriction_coefficients = [0.1]\n[[force]]")],
        failure("only_below_three_dimensions", key="picture.friction_coefficients")),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_in_a_case(edited: object, name: str) -> None:
    kind, replacements, sentence = MISTAKES[name]
    path = edited(*replacements, case=f"statics_{kind}")  # type: ignore[operator]
    with pytest.raises(StatejumpError) as caught:
        load_case(path)
    assert caught.value == sentence.at(file=str(path))


def test_other_kinds_are_refused() -> None:
    done = CliRunner().invoke(statics_command, [str(CASES / "umbrella.toml")])
    assert isinstance(done.exception, StatejumpError)
    assert done.exception == failure("command_not_for_kind", kinds="'spring_slider' and 'statics'", command="statics")


def test_forces_over_temperature() -> None:
    case = sj.load(CASES / "statics_ball.toml")
    assert [load.force_N for load in case.load_cases] == [(0, 30, -100), (25, 30, -100), (50, 30, -100)]
    assert case.load_cases[1].name == "preload, ΔT = 50 K"


@pytest.mark.parametrize("kind", ["slot", "journal", "lobed", "ball", "cylinder"])
def test_command(kind: str, tmp_path: Path) -> None:
    output, folder = run(CASES / f"statics_{kind}.toml", tmp_path / "out")
    document = json.loads((folder / "statics.json").read_text(encoding="utf-8"))
    assert len(document["each"]) == len(document["forces"])
    names = {"statics.json", f"statics_{kind}.png", f"statics_{kind}.svg"}
    if kind in ("ball", "cylinder"):
        names.add(f"statics_{kind}.vtp")
    assert set(results_in(folder)) == names
    assert "largest jump [m]" in output
    first = {path.name: path.read_bytes() for path in folder.iterdir()}
    run(CASES / f"statics_{kind}.toml", tmp_path / "again")
    for name, content in first.items():
        assert (tmp_path / "again" / folder.name / name).read_bytes() == content, name


def test_numbers_of_the_journal(tmp_path: Path) -> None:
    _, folder = run(CASES / "statics_journal.toml", tmp_path)
    document = json.loads((folder / "statics.json").read_text(encoding="utf-8"))
    beta = np.arctan2(-50, 85) - np.arctan2(-80, 60)
    assert document["all"]["parts"][0]["angle_rad"] == pytest.approx(2 * atan(0.3) - beta, abs=1e-12)
    assert document["any"]["parts"][0]["angle_rad"] == pytest.approx(2 * atan(0.3) + beta, abs=1e-12)
    assert document["any"]["diameter_m"] == pytest.approx(2 * C * sin(atan(0.3) + beta / 2), rel=1e-12)


def test_quiet(tmp_path: Path) -> None:
    done = CliRunner().invoke(
        statics_command, [str(CASES / "statics_slot.toml"), "--results", str(tmp_path), "--quiet"]
    )
    assert (done.exit_code, done.output) == (0, "")


def test_paraview_file(tmp_path: Path) -> None:
    vtk = pytest.importorskip("vtkmodules.vtkIOXML")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    _, folder = run(CASES / "statics_ball.toml", tmp_path)
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(folder / "statics_ball.vtp"))
    reader.Update()
    data = reader.GetOutput()
    stable = vtk_to_numpy(data.GetCellData().GetArray("stable"))
    forces = vtk_to_numpy(data.GetCellData().GetArray("forces"))
    angle = vtk_to_numpy(data.GetPointData().GetArray("cone_angle_rad"))
    points = vtk_to_numpy(data.GetPoints().GetData())
    assert set(stable) == {0, 1} and set(forces) == {0, 1, 2, 3}
    assert ((forces > 0) == (stable > 0)).all()
    # The array against the angle at the point itself, and the cells against the array.
    loads = np.array([(0, 30, -100), (25, 30, -100), (50, 30, -100)], float)
    loads /= np.linalg.norm(loads, axis=1)[:, None]
    unit = points / np.linalg.norm(points, axis=1)[:, None]
    exact = np.arccos(np.clip(unit @ loads.T, -1, 1)).min(axis=1)
    assert angle == pytest.approx(exact, abs=2e-3)
    for index in range(0, data.GetNumberOfCells(), 7):
        cell = data.GetCell(index)
        corners = [cell.GetPointId(i) for i in range(cell.GetNumberOfPoints())]
        if stable[index]:
            assert angle[corners].max() <= atan(0.5) + 1e-9
        else:
            assert angle[corners].max() >= atan(0.5) - 1e-9


def write_sphere(path: Path, level: int = 3, every: int = 0) -> None:
    """A clearance sphere as ASCII STL in millimetres: unconnected triangles with inward right-hand normals.

    :param every: every n-th coordinate differs by a unit in the last place of a float, as in exported files; 0: none
    """
    mesh = _engine.clearance_sphere(C, level)
    lines = ["solid socket"]
    for triangle in mesh.triangles:
        lines += ["facet normal 0 0 0", "outer loop"]
        corners = (1e3 * mesh.vertices_m[list(triangle)]).astype(np.float32)
        if every:
            off = (len(lines) + np.arange(9).reshape(3, 3)) % every == 0
            corners = np.where(off, np.nextafter(corners, np.float32(9e9)), corners)
        lines += ["vertex {:.9g} {:.9g} {:.9g}".format(*corner) for corner in corners]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid socket", ""]))


def mesh_case(folder: Path, file: str = "socket.stl", side: str = "right_hand") -> Path:
    path = folder / "measured.toml"
    path.write_text(
        '[case]\nname = "measured"\nkind = "statics"\n[joint]\ntype = "mesh"\nfriction_coefficient = 0.5\n'
        f'mesh_file = "{file}"\nmesh_unit_m = 1e-3\nmesh_free_side = "{side}"\n[[force]]\nforce_N = [1, 2, 3]\n'
    )
    return path


@pytest.mark.parametrize("side, sign", [("right_hand", 1.0), ("left_hand", -1.0)])
def test_mesh_from_a_file(tmp_path: Path, side: str, sign: float) -> None:
    pytest.importorskip("vtkmodules.vtkIOGeometry")
    write_sphere(tmp_path / "socket.stl")
    path = mesh_case(tmp_path, side=side)
    statics = sj.statics(sj.load(path))
    exact = _engine.rest_in_socket(C, [(1, 2, 3)], 0.5)["any"]
    assert len(statics.mesh.vertices_m) == 642  # welded
    assert statics.any["area_m2"] == pytest.approx(exact["area_m2"], rel=0.01)
    assert statics.any["diameter_m"] == pytest.approx(exact["diameter_m"], rel=0.01)
    place = statics.any["parts"][0]["representative_m"] / C
    assert place == pytest.approx(sign * np.array([1, 2, 3]) / sqrt(14), abs=0.02)
    assert cone_angles(statics).max() <= pi
    run(path, tmp_path / "out")


def test_vertices_within_the_rounding_of_floats_are_one(tmp_path: Path) -> None:
    pytest.importorskip("vtkmodules.vtkIOGeometry")
    write_sphere(tmp_path / "socket.stl", every=50)
    statics = sj.statics(sj.load(mesh_case(tmp_path)))
    assert len(statics.mesh.vertices_m) == 642


@pytest.mark.parametrize("file, content, sentence", [
    ("none.stl", None, failure("mesh_not_read", cause=os.strerror(errno.ENOENT))),
    ("none.step", "x", failure("suffix_unknown", suffixes=".stl, .obj, .ply, .vtp")),
    ("empty.stl", "solid x\nendsolid x\n", failure("mesh_without_triangles")),
    ("random.ply", "no mesh at all", failure("mesh_without_triangles")),
])
def test_bad_mesh_files(tmp_path: Path, file: str, content: str | None, sentence: Failure) -> None:
    pytest.importorskip("vtkmodules.vtkIOGeometry")
    if content is not None:
        (tmp_path / file).write_text(content)
    path = mesh_case(tmp_path, file)
    with pytest.raises(StatejumpError) as caught:
        sj.statics(sj.load(path))
    assert caught.value == sentence
    told = caught.value.fields()
    assert (told["key"], told["value"], told["file"]) == ("joint.mesh_file", file, str(path))


def test_library(tmp_path: Path) -> None:
    """Without files: the case is a dict; its rest sets are a table, a picture, notebook output."""
    import matplotlib

    backend = matplotlib.get_backend()
    case = sj.load({
        "case": {"name": "two", "kind": "statics"},
        "joint": {"type": "journal", "clearance_m": C, "friction_coefficient": 0.3},
        "force": [{"force_N": [1, 0, 0]}, {"force_N": [0, 1, 0], "name": "up"}],
    })
    statics = sj.statics(case)
    frame = statics.frame()
    # Right angle between the forces, wider than both cones: two arcs apart, none in common.
    assert [name.partition(":")[0] for name in frame["set"]] == ["F1", "up", "union", "union", "intersection"]
    assert frame["angle_rad"][:2].tolist() == pytest.approx([2 * atan(0.3)] * 2, abs=1e-12)
    assert frame["parts"].tolist() == [1, 1, 2, 2, 0] and np.isnan(frame["angle_rad"].iloc[-1])
    assert frame["x_m"][0] == pytest.approx(C) and frame["y_m"][1] == pytest.approx(C)
    figure = statics.plot()
    figure.savefig(tmp_path / "two.png")
    axes = figure.axes[0]
    assert statics.plot(axes) is figure
    assert matplotlib.get_backend() == backend
    shown = statics._repr_html_()
    assert "union: " in shown and "no position" in shown
    assert "journal" in case._repr_html_()
    other = sj.statics(case, friction_coefficient=0.1)
    assert other.frame()["angle_rad"][0] == pytest.approx(2 * atan(0.1), abs=1e-12)
    assert sj.statics(case.changed({"joint.friction_coefficient": 0.1})).any["length_m"] == other.any["length_m"]
    for wrong in (-1.0, float("nan"), 101.0):
        with failing("out_of_range" if wrong == wrong else "number_not_finite", key="joint.friction_coefficient", value=wrong):
            sj.statics(case, friction_coefficient=wrong)
    with failing("command_not_for_kind", key="case.kind", value="statics", command="reduced", raised=NotAllowed):
        case.reduced()


def test_refusals_of_the_engine() -> None:
    with failing("out_of_range", raised=ValueError, key="size of forces[0]", value=0.0):
        _engine.rest_in_socket(C, [(0, 0, 0)], 0.1)
    with failing("out_of_range", raised=ValueError, key="mu", value=-1.0):
        _engine.rest_in_bearing(C, [(1, 0)], -1)
