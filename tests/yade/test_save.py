"""O.save and O.load: a resumed run is the same run, bit for bit."""
import pytest

FILES = ["scene.yade", "scene.yade.gz", "scene.yade.bz2", "scene.xml", "scene.xml.gz"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("saved")


@pytest.fixture(scope="module")
def written(run_script, folder):
    return run_script("save.py", "write", str(folder))


def test_saved_state_is_worth_saving(written):
    # Mid-contact, sticking and slipping, with history and energy.
    saved, straight = written["saved"], written["straight"]
    contacts = [c for c in saved["contacts"] if len(c) == 9]
    assert len(contacts) >= 3
    assert all(c[4] > 0 for c in contacts)
    assert any(any(abs(f) > 1e-3 for f in c[3]) for c in contacts)
    assert {c[6] for c in contacts} == {True, False}
    assert straight["bodies"] != saved["bodies"]
    assert straight["energy"]["jointFriction"] > saved["energy"]["jointFriction"] > 0
    assert straight["energy"]["jointThermalWork"] != saved["energy"]["jointThermalWork"]


@pytest.mark.parametrize("name", [*FILES, "saveTmp"])
def test_resume_in_the_same_process(written, name):
    assert written["resumed"][name] == written["straight"]


@pytest.mark.parametrize("name", ["scene.yade.gz", "scene.yade", "scene.xml"])
def test_resume_in_a_new_process(run_script, written, folder, name):
    found = run_script("save.py", "read", str(folder / name))
    assert found["state"] == written["straight"]
    assert found["loaded"]["material"] == 2.3e-5
    assert found["loaded"]["shape"] == "Journal"
    assert found["loaded"]["engines"].count("ThermalExpansionEngine") == 2
