# SPDX-License-Identifier: GPL-3.0-or-later
"""yade_scripts/examples/umbrella.py by itself, and what it records for ParaView."""
import json
import re

from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from conftest import REPOSITORY, yade

TUTORIAL = REPOSITORY / "yade_scripts" / "examples" / "umbrella.py"


def read(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def test_tutorial_and_its_recording(tmp_path):
    done = yade(TUTORIAL, environment={"PARAVIEW": str(tmp_path / "rib-")})
    found = re.search(r"first contact at ([0-9.]+) K; .* ([0-9.]+) K", done.stdout)
    assert found, done.stdout + done.stderr
    assert abs(float(found[1]) - 35.0877) <= 1e-3 and float(found[2]) == 35.0877
    # The reduced model gives 1.97503 mrad; at this step friction leaves 1e-6 rad.
    jump = float(re.search(r"jump of AB: ([-0-9.]+) mrad", done.stdout)[1])
    assert abs(jump - 1.97503) < 2e-3

    assert not list(tmp_path.glob(".*"))  # nothing half-written
    for name in ("joints", "links", "contacts"):
        entries = json.loads((tmp_path / f"rib-{name}.vtp.series").read_text())["files"]
        assert len(entries) == 101
        assert abs(entries[-1]["time"] - 1.0) < 1e-9
        assert {entry["name"] for entry in entries} == {p.name for p in tmp_path.glob(f"rib-{name}.*.vtp")}
    # In the middle of the program both links are at 100 K, and longer by 2.375e-3 of themselves.
    links = read(tmp_path / "rib-links.100000.vtp")
    assert links.GetNumberOfCells() == 2
    assert abs(links.GetCellData().GetArray("temperature_change_K").GetTuple1(0) - 100) < 1e-6
    x, y, z = links.GetPoint(1)
    assert abs((x * x + y * y) ** 0.5 / 0.05 - 1.002375) < 1e-5 and z == 0
    joints = read(tmp_path / "rib-joints.100000.vtp")
    assert sorted(joints.GetCellData().GetArray("kind").GetTuple1(i) for i in (0, 1)) == [1, 2]
    # Somewhere there is contact, and the force on the journal points away from the bearing.
    for entry in json.loads((tmp_path / "rib-contacts.vtp.series").read_text())["files"]:
        contacts = read(tmp_path / entry["name"])
        if contacts.GetNumberOfCells():
            break
    force = contacts.GetCellData().GetArray("normal_force_N").GetTuple(0)
    # Heated links part the centres along AC, journal towards A: pushed back towards C.
    assert force[0] > 0
