# SPDX-License-Identifier: GPL-3.0-or-later
"""Journals and balls in bores given by triangles."""
from math import atan2, hypot

import pytest

from conftest import EPS


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("bore.py", "checks")


@pytest.mark.parametrize("case", ["journal 0", "journal 80", "ball 0", "ball 80"])
def test_perfect_mesh_is_the_analytic_part(seen, case):
    plain, mesh = seen["curves"][case]
    assert plain["gone"] and mesh["gone"]
    # 200 facets around: the smooth wall is off by 1e-12 m, 1e-5 of the smallest depth, 3e-7 m; the
    # facets themselves would be off by 6e-7 m.
    for p, m in zip(plain["rows"], mesh["rows"]):
        size = max(abs(f) for f in p[:3])
        assert m[:3] == pytest.approx(p[:3], abs=3e-5 * size)
        assert m[3:6] == pytest.approx(p[3:6], abs=3e-5 * size * 5.1e-3)
        assert m[6:] == pytest.approx(p[6:], rel=3e-5)


def test_motion_and_energies_are_those_in_a_bearing(seen):
    bearing, mesh, searching = (seen["swing"][name] for name in ("bearing", "mesh", "searching"))
    for plain, one, other in zip(bearing, mesh, searching):
        # 1e-5 of depths of 1e-6 m, thrice in the position after sliding over 5e-5 m.
        assert one["pos"] == pytest.approx(plain["pos"], abs=1e-10)
        # Patches of one curvature beside a search in every step.
        assert one["pos"] == pytest.approx(other["pos"], abs=1e-12)
        for name, value in plain["energies"].items():
            assert one["energies"][name] == pytest.approx(value, rel=1e-3, abs=1e-8), name
    assert bearing[-1]["energies"]["jointThermalWork"] > 1e-4


def test_two_contacts_carry_a_load(seen):
    rest = seen["two"]["rest"]
    assert rest["number"] == 2 and rest["contacts"] == 2
    assert rest["speed"] < 1e-12
    assert rest["sum"] == pytest.approx([50, 3, 0], abs=1e-9)
    assert rest["on_bore"] == pytest.approx([50, 3, 0], abs=1e-9)
    assert rest["moment"] < 8 * EPS * 55 * 5e-3
    # Both sides of the lobe, mirrored to the small turn of the journal's place.
    angles = [atan2(p[1], p[0]) for p in rest["points"]]
    assert angles[0] == pytest.approx(-angles[1], abs=2e-3) and 0.5 < angles[0] < 1.05
    assert len(rest["forces"]) == len(rest["depths"]) == 2
    for force, shear in zip(rest["forces"], rest["shears"]):
        assert 30 < hypot(*force) < 45 and shear <= 0.3 * hypot(*force)
    assert {"numberOfContacts", "penetrationDepths", "contactPoints", "normalForces"} <= set(rest["keys"])
    # Two springs and their friction on 0.02 kg: below that of the stiffer alone.
    assert 0 < rest["stable"] < 2 * (0.02 / max(rest["kn"])) ** 0.5


def test_history_follows_its_contact_when_the_order_changes(seen):
    rows = seen["two"]["rows"]
    upper_first = [row[0][0] > 0 for row in rows]
    assert upper_first[0] and not upper_first[-1]
    speeds = {side: None for side in (True, False)}
    for before, after in zip(rows, rows[1:]):
        old = {row[0] > 0: row for row in before}
        for row in after:
            side = row[0] > 0
            # The impact speed belongs to one contact for its life; its friction moves on smoothly
            # where it would jump to the other side's, which points the other way.
            assert row[4] == old[side][4]
            assert row[1] * old[side][1] > 0 or abs(row[1] - old[side][1]) < 2
            speeds[side] = row[4]
    assert speeds[True] != speeds[False]


def test_a_wall_that_bulges_is_touched_as_a_ball(seen):
    found = seen["bulge"]
    # r = R2 + a cos 3t at its smallest: curvature (r - 9 a)/r^2.
    radius = -3.6e-3**2 / (9 * 1.5e-3 - 3.6e-3)
    assert found["number"] == 1
    # The mesh's facets of 0.1 mm on 1.3 mm: 1e-4 of the curvature, half of that in the force; the
    # distance errs by 1e-10 m of 1e-6 m.
    assert found["radius"] == pytest.approx(radius, rel=2e-3)
    effective = 1e-3 * -radius / (1e-3 - radius)
    assert found["force"] == pytest.approx(4 / 3 * found["modulus"] * effective**0.5 * 1e-9, rel=2e-3)
    assert found["johnson"][1] == "law_for_flat_walls normalLaw = johnson (contact 0 1)"


def test_paraview_gets_the_triangles(seen):
    found = seen["recorded"]
    lines, triangles, given = found["cells"]
    assert (lines, triangles) == (1, given) and given == 720
    assert found["kinds"] == [1, 7, 1 + given]
    # The bore, 10 mm long and 6.1 by 4.1 mm from its axis, lies along x and has grown by 1 %.
    x, y, z = found["bounds"][1], found["bounds"][3], found["bounds"][5]
    assert [x, z] == pytest.approx([0.02 + 1.01 * 5e-3, 1.01 * 6.1e-3], rel=1e-9)
    assert y == pytest.approx(1.01 * 5e-3, rel=1e-3)  # the journal is wider there


def test_mistakes_are_one_sentence(seen):
    kind, text = seen["too_close"]
    assert kind == "RuntimeError"
    assert text.startswith("wall_conforms radius of curvature = 0.00499") and text.endswith(" (contact 0 1)")
    refused = seen["refused"]
    assert refused["file"] == ["RuntimeError", "not_opened MeshBore = /nowhere/bore.stl"]
    assert refused["hole"][1] == "holes MeshBore = MeshBore"
    assert refused["unit"][1] == "radius_too_large MeshBore = MeshBore"
    assert refused["flip"][1] == "wall_inside_out MeshBore = MeshBore"
    for name, cls in (("scale", "MeshBore.scale"), ("paper", "Law2_BoreGeom_BorePhys_JointLaw.tangentialVelocity"),
                      ("angle", "Ig2_Journal_MeshBore_BoreGeom.patchAngle")):
        assert refused[name][0] == "ValueError" and refused[name][1].startswith(f"not_allowed {cls} = ")
    assert refused["set"][0] == "AttributeError"
    assert seen["radii"] == pytest.approx([5.1e-3] * 8, abs=1e-11)


def test_saved_and_loaded_without_a_file_bit_for_bit(run_script, tmp_path_factory):
    found = run_script("bore.py", "save", str(tmp_path_factory.mktemp("bore")))
    assert found["saved"] != found["straight"] and found["straight"]["contacts"]
    for resumed in found["resumed"]:
        assert resumed["bodies"] == found["straight"]["bodies"]
        assert resumed["contacts"] == found["straight"]["contacts"]
        for name, value in found["straight"]["energies"].items():
            assert resumed["energies"][name] == pytest.approx(value, rel=12 * 3000 * EPS, abs=1e-18)


def test_two_threads_are_equal(run_script):
    one, two = (run_script("bore.py", "many", threads=n) for n in (1, 2))
    assert one["real"] >= 10
    for key in ("bodies", "contacts"):
        assert one["state"][key] == two["state"][key]
