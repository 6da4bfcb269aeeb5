# SPDX-License-Identifier: GPL-3.0-or-later
"""O.save and O.load: a resumed run equals the uninterrupted run bit for bit. Only energies differ by rounding, because
they are sums over contacts in the order of YADE's container."""
import pytest
from conftest import EPS

FILES = ["scene.yade", "scene.yade.gz", "scene.yade.bz2", "scene.xml", "scene.xml.gz"]


LAWS = ["hertz_mindlin", "by_name", "partial_slip"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return {law: tmp_path_factory.mktemp(law) for law in LAWS}


@pytest.fixture(scope="module")
def written(run_script, folder):
    return {law: run_script("save.py", "write", str(folder[law]), law) for law in LAWS}


@pytest.mark.parametrize("law", LAWS)
def test_saved_state_is_worth_saving(written, law):
    # Mid-contact, sticking and slipping, with history and energy.
    saved, straight = written[law]["saved"], written[law]["straight"]
    contacts = [c for c in saved["contacts"] if len(c) == 9]
    assert len(contacts) >= 3
    assert all(c[4] > 0 for c in contacts)
    assert any(any(abs(f) > 1e-3 for f in c[3]) for c in contacts)
    assert {c[6] for c in contacts} == {True, False}
    assert straight["bodies"] != saved["bodies"]
    assert straight["energy"]["jointFriction"] > saved["energy"]["jointFriction"] > 0
    assert straight["energy"]["jointThermalWork"] != saved["energy"]["jointThermalWork"]


def test_saved_memory_of_partial_slip(written):
    saved = written["partial_slip"]["saved"]["memory"]
    assert max(len(points) for points in saved) >= 3  # a ring that sticks, one that slips, the rim
    assert written["partial_slip"]["straight"]["memory"] != saved


def test_saved_state_of_the_new_classes(written):
    saved, straight = written["by_name"]["saved"], written["by_name"]["straight"]
    assert "hertz_paper" in saved["law"] and "hunt_crossley" in saved["law"]
    for name in ("pinDamping", "torsionElastic", "torsionFriction", "jointDamping"):
        assert straight["energy"][name] > 0, name
    assert straight["energy"]["pinDamping"] > saved["energy"]["pinDamping"]
    assert straight["law"] != saved["law"]  # contacts have begun meanwhile


def assert_same(found, expected):
    """Loading may change the order of contacts, and with it the rounding of sums of 5 contacts in 700 steps."""
    rounding = 5 * 700 * EPS
    assert found["energy"].keys() == expected["energy"].keys()
    for name, energy in expected["energy"].items():
        assert found["energy"][name] == pytest.approx(energy, rel=rounding, abs=0), name
    assert {**found, "energy": None} == {**expected, "energy": None}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", [*FILES, "saveTmp"])
def test_resume_in_the_same_process(written, law, name):
    assert_same(written[law]["resumed"][name], written[law]["straight"])


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", ["scene.yade.gz", "scene.yade", "scene.xml"])
def test_resume_in_a_new_process(run_script, written, folder, law, name):
    found = run_script("save.py", "read", str(folder[law] / name))
    assert_same(found["state"], written[law]["straight"])
    assert found["loaded"]["material"] == 2.3e-5
    assert found["loaded"]["shape"] == "Journal"
    assert found["loaded"]["engines"].count("ThermalExpansionEngine") == 2
