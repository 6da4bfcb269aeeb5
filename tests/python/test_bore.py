# SPDX-License-Identifier: GPL-3.0-or-later
"""Bores given by triangles: results of `statejump bore`."""
from __future__ import annotations

import csv
import os
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from failures import Failure, failing, failure
import statejump as sj
from statejump import _engine
from statejump.bores import measure as bore
from statejump.bores.measure import NoBore
from statejump.cli.bore import bore_command
from statejump.core.errors import StatejumpError

RADIUS = 5.1e-3
JOURNAL = 5e-3


def write_off(path: Path, vertices: np.ndarray, faces: np.ndarray) -> Path:
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(f"{x:.17g}" for x in v) for v in vertices]
    lines += ["3 " + " ".join(map(str, f)) for f in faces]
    path.write_text("\n".join(lines) + "\n")
    return path


def lobed(**more) -> tuple[np.ndarray, np.ndarray]:
    return _engine.bore_triangles(
        RADIUS, 10e-3, 240, 12, lobes=[(3, 10e-6, 0.3), (2, 1e-6, 1.1), (7, 2e-7, 0.05)], **more
    )


def test_harmonics_are_recovered():
    mesh = _engine.BoreMesh(*lobed())
    report = bore.measure(mesh, "lobed", JOURNAL)
    assert report.dominating_harmonic == 3
    for each in report.sections:
        found = dict(zip(bore.HARMONICS, zip(each.amplitude_m, each.phase_rad)))
        for order, amplitude, phase in ((3, 10e-6, 0.3), (2, 1e-6, 1.1), (7, 2e-7, 0.05)):
            assert found[order][0] == pytest.approx(amplitude, abs=1e-10)
            assert np.angle(np.exp(1j * order * (found[order][1] - phase))) == pytest.approx(0, abs=1e-4)
        for order in (4, 5, 6, 8, 9, 10, 11, 12):
            assert found[order][0] < 1e-9
    assert mesh.mean_radius_m == pytest.approx(RADIUS, abs=2e-8)  # least squares of a wave: a^2/R
    exact = RADIUS + sum(a * np.cos(k * (bore.angles_rad() - p))
                         for k, a, p in ((3, 10e-6, 0.3), (2, 1e-6, 1.1), (7, 2e-7, 0.05)))
    assert report.middle.roundness_error_m == pytest.approx(np.ptp(exact), abs=1e-9)
    # The least-squares axis is off by the product of neighbouring lobes: 10 µm · 1 µm / R = 2e-9.
    assert report.smallest_radius_m == pytest.approx(exact.min(), abs=3e-9)


def test_round_bore_has_no_lobes():
    mesh = _engine.BoreMesh(*_engine.bore_triangles(RADIUS, 10e-3, 200, 8))
    report = bore.measure(mesh, "round")
    assert report.middle.roundness_error_m < 1e-12
    assert report.cylindricity_m < 1e-12


def test_contacts_from_python():
    mesh = _engine.BoreMesh(*_engine.bore_triangles(RADIUS, 10e-3, 200, 8))
    (contact,) = mesh.contacts([1.01e-4, 0, 0], [0, 0, 1], JOURNAL)
    assert contact["depth_m"] == pytest.approx(1e-6, abs=1e-12)
    assert contact["normal"] == pytest.approx([1, 0, 0], abs=1e-6)
    assert mesh.closest_point([4e-3, 0, 0])["distance_m"] == pytest.approx(1.1e-3, abs=1e-12)
    cup = _engine.BoreMesh(*_engine.socket_triangles(8e-3, 1.4, 100, 40), kind="socket")
    (contact,) = cup.ball_contacts([0, 0, -1.01e-4], 7.9e-3)
    assert contact["depth_m"] == pytest.approx(1e-6, abs=1e-9)


def run(tmp_path: Path, *arguments: object):
    return CliRunner().invoke(
        bore_command, [*map(str, arguments), "--results", str(tmp_path / "results")]
    )


def test_command_writes_table_and_picture(tmp_path: Path):
    vertices, faces = lobed(wall_thickness_m=2e-3)
    file = write_off(tmp_path / "worn.off", vertices * 1e3, faces)
    done = run(tmp_path, file, "--scale", "0.001", "--journal-radius", JOURNAL)
    assert done.exit_code == 0, done.output
    folder = tmp_path / "results" / "bore_worn"
    assert sorted(p.name for p in folder.iterdir()) == ["bore.csv", "roundness.png", "roundness.svg"]
    with (folder / "bore.csv").open() as stream:
        values = {row["quantity"]: row["value"] for row in csv.DictReader(stream)}

    def value(*parts: str) -> str:
        found, = [value for quantity, value in values.items() if all(part in quantity for part in parts)]
        return found

    assert values["body"] == "closed ring" and value("lobes") == "3"
    assert float(value("harmonic 3", "amplitude")) == pytest.approx(1e-5, abs=1e-9)
    assert float(value("clearance", "least squares")) == pytest.approx(1e-4, abs=2e-8)
    assert float(value("clearance", "smallest")) < 9e-5
    first = (folder / "roundness.svg").read_bytes()
    assert run(tmp_path, file, "--scale", "0.001", "--journal-radius", JOURNAL).exit_code == 0
    assert (folder / "roundness.svg").read_bytes() == first


def refusal(tmp_path: Path, *arguments: object) -> StatejumpError:
    done = run(tmp_path, *arguments)
    assert isinstance(done.exception, StatejumpError), done.output
    assert done.exception.exit_status == 2
    assert not (tmp_path / "results").exists()
    return done.exception


def test_refusals(tmp_path: Path):
    vertices, faces = _engine.bore_triangles(RADIUS, 10e-3, 12, 2)
    file = write_off(tmp_path / "mm.off", vertices * 1e3, faces)
    assert refusal(tmp_path, file) == (
        failure("bore_too_large")
    )
    file = write_off(tmp_path / "inside_out.off", vertices, faces[:, ::-1])
    assert refusal(tmp_path, file) == failure("bore_inside_out", remedy="--flip")
    assert run(tmp_path, file, "--flip").exit_code == 0
    missing = tmp_path / "none.stl"
    with failing("bore_unreadable"):
        bore.load(missing)


@pytest.mark.parametrize(("name", "content", "cause"), [
    ("bore.ply", "ply\nformat ascii 1.0\nelemen vertex 3\nproperty float x\nend_header\n",
     failure("bore_unreadable", reason="no_header_line", line=3)),
    ("bore.ply", "ply\nformat ascii 1.0\nproperty float x\nelement vertex 3\nend_header\n",
     failure("bore_unreadable", reason="property_before_element", line=3)),
    ("bore.off", "OFF\n100000000 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0",
     failure("bore_unreadable", reason="counts_beyond_file", vertices=100_000_000, faces=1)),
])
def test_hostile_files(tmp_path: Path, name: str, content: str, cause: Failure):
    file = tmp_path / name
    file.write_text(content)
    assert refusal(tmp_path, file) == cause.at(file=file)


def test_pipe_is_not_opened(tmp_path: Path):
    file = tmp_path / "bore.stl"
    os.mkfifo(file)
    with failing("bore_unreadable", reason="not_a_file"):
        bore.load(file)


def test_too_coarse(tmp_path: Path):
    file = write_off(tmp_path / "three.off", *_engine.bore_triangles(RADIUS, 10e-3, 3, 2))
    assert refusal(tmp_path, file) == failure("bore_too_coarse", file=file)


def test_section_that_is_no_ring():
    """The centre of the section's circle lies outside of the section, so the angle along it reverses."""
    angle = bore.angles_rad()

    class Corner:
        """Mesh with a section of two arms at right angles."""

        def section_radii_m(self, z_m: float, count: int) -> np.ndarray:
            return RADIUS * np.where((angle < 0.2) | (abs(angle - np.pi / 2) < 0.2), 1.0, 0.1)

    with failing("bore_no_ring", z_m=0.001):
        bore.section(Corner(), 1e-3)  # type: ignore[arg-type]


def test_journal_of_another_unit(tmp_path: Path):
    vertices, faces = _engine.bore_triangles(0.051, 0.1, 24, 2)
    file = write_off(tmp_path / "large.off", vertices, faces)
    assert refusal(tmp_path, file, "--journal-radius", "0.005") == (
        failure("bore_in_millimetres", journal_radius_m=0.005)
    )
    assert refusal(tmp_path, file, "--journal-radius", "0.06") == (
        failure("journal_too_large", key="--journal-radius", value=0.06)
    )
    assert refusal(tmp_path, file, "--journal-radius", "-1") == (
        failure("not_positive", key="--journal-radius", value=-1.0, unit="m")
    )


def test_in_python(tmp_path: Path):
    vertices, faces = lobed()
    file = write_off(tmp_path / "worn.off", vertices * 1e3, faces)
    worn = sj.bore(file, unit_m=1e-3, journal_radius_m=JOURNAL)
    frame = worn.frame()
    assert len(frame) == bore.SECTIONS == len(worn.sections)
    assert frame["harmonic_3_amplitude_m"].tolist() == pytest.approx([1e-5] * 5, abs=1e-10)
    assert frame["harmonic_3_phase_rad"].tolist() == pytest.approx([0.3] * 5, abs=1e-4)
    assert worn.clearance_m == pytest.approx(1e-4, abs=2e-8) and worn.smallest_clearance_m < worn.clearance_m
    assert sj.bore(file, unit_m=1e-3).clearance_m is None
    figure = worn.plot()
    assert [len(axes.patches) for axes in figure.axes] == [0, len(bore.HARMONICS)]
    assert worn.plot(tuple(figure.axes)) is figure
    assert "dominate" in worn._repr_html_() and "0.00510001 m" in repr(worn)
    with failing("not_positive", key="journal_radius_m", value=0, unit="m"):
        sj.bore(file, unit_m=1e-3, journal_radius_m=0)
    # The remedy names the argument of the function, not the option of the command.
    with pytest.raises(NoBore) as caught:
        sj.bore(file)
    assert caught.value.fields()["remedy"] == "unit_m=0.001" and caught.value.fields()["file"] == str(file)
    with failing("bore_inside_out", raised=NoBore, remedy="flip=True"):
        sj.bore(write_off(tmp_path / "inside_out.off", vertices, faces[:, ::-1]))
