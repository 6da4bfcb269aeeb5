# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugin's classes follow YADE's conventions."""
import re
import subprocess

import pytest

from conftest import PLUGIN_DIR

BASES = {
    "ThermalFrictMat": ["ThermalFrictMat", "FrictMat", "ElastMat", "Material"],
    "Journal": ["Journal", "ThermalShape", "Shape"],
    "Bearing": ["Bearing", "ThermalShape", "Shape"],
    "Ball": ["Ball", "ThermalShape", "Shape"],
    "Socket": ["Socket", "ThermalShape", "Shape"],
    "Slider": ["Slider", "ThermalShape", "Shape"],
    "SlotFace": ["SlotFace", "ThermalShape", "Shape"],
    "MeshBore": ["MeshBore", "ThermalShape", "Shape"],
    "BoreGeom": ["BoreGeom", "GenericSpheresContact", "IGeom"],
    "BorePhys": ["BorePhys", "JointPhys", "FrictPhys", "NormShearPhys", "NormPhys", "IPhys"],
    "JointGeom": ["JointGeom", "GenericSpheresContact", "IGeom"],
    "JointPhys": ["JointPhys", "FrictPhys", "NormShearPhys", "NormPhys", "IPhys"],
}


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("conventions.py")


def test_every_class_is_documented_and_in_yade(seen):
    assert len(seen["classes"]) >= 27
    for name, found in seen["classes"].items():
        assert found["in_wrapper"], name
        assert found["doc"] and len(found["doc"]) > 20, name


def test_every_attribute_has_a_documented_unit(seen):
    for name, found in seen["classes"].items():
        for attribute, doc in found["attributes"].items():
            if attribute in ("links", "program", "springs", "joints", "link1", "link2", "contacts",
                             "gradientProgram", "bonds", "beams"):  # objects
                continue
            assert re.search(r"\[[^\]]+\]", doc), f"{name}.{attribute}: {doc!r}"


def test_dict_holds_own_and_inherited_attributes(seen):
    for name, found in seen["classes"].items():
        assert set(found["attributes"]) <= set(found["dict"]), name
    assert {"young", "poisson", "density", "frictionAngle", "thermalExpansion", "label"} <= set(
        seen["classes"]["ThermalFrictMat"]["dict"]
    )
    assert {"kn", "ks", "normalForce", "shearForce", "tangensOfFrictionAngle"} <= set(
        seen["classes"]["JointPhys"]["dict"]
    )
    assert {"normal", "contactPoint", "refR1", "refR2"} <= set(seen["classes"]["JointGeom"]["dict"])
    assert {"dead", "label", "ompThreads"} <= set(seen["classes"]["ThermalLinks"]["dict"])


def test_dispatch_hierarchy_and_bases(seen):
    for name, hierarchy in BASES.items():
        assert seen["classes"][name]["hierarchy"] == hierarchy
        assert seen["classes"][name]["base"] == hierarchy[1]
    bases = {name: found["base"] for name, found in seen["classes"].items()}
    assert bases["ThermalExpansionEngine"] == bases["ThermalLinks"] == "GlobalEngine"
    assert bases["Bo1_Journal_Aabb"] == "BoundFunctor"
    assert bases["Law2_JointGeom_JointPhys_HertzMindlin"] == "LawFunctor"
    assert bases["Law2_JointGeom_JointPhys_JointLaw"] == "LawFunctor"
    assert bases["TorsionSprings"] == "GlobalEngine"
    assert bases["TorsionSpring"] == "Serializable"
    for shape in ("Journal", "Bearing", "Slider", "SlotFace"):
        assert bases[f"Gl1_{shape}"] == "GlShapeFunctor"
        assert "clearanceScale" in seen["classes"][f"Gl1_{shape}"]["doc"]


def test_keyword_constructors(seen):
    assert seen["journal"] == [0.005, 0.01, [1, 0, 0]]
    assert seen["link"] == [3, -1, 70e9, 0.5]
    assert seen["program"] == ["table", 2.0, [0, 0.5, 2], 3]
    assert seen["engine"] == ["heater", [1, 2], True, "law"]
    assert seen["links"] == [1, 3]
    assert seen["springs"] == [2, 0.5, 3, None]
    assert seen["slot"] == ["SlotFace"] * 4
    assert seen["spring"] == [4, 2, 300.0, 0.25, 0.0, 0.1]


def test_unknown_and_positional_arguments_are_refused(seen):
    for name, (kind, text) in seen["unknown"].items():
        assert kind == "AttributeError" and "noSuchAttribute" in text, name
    assert seen["positional"] == ["ValueError", "positional Journal"]
    assert seen["read_only"][0] == "AttributeError"


def test_values_of_another_type_give_a_sentence(seen):
    assert seen["wrong_types"][:-1] == [["TypeError", f"wrong_type {value}"] for value in (
        "Journal.radius = 'large'", "Journal.radius = 'large'", "ThermalProgram.cycles = 1.5",
        "ThermalProgram.tableTimes = [0, 'one']", "ThermalProgram.shape = 3", "SlotFace.normal = (0, 1)",
    )]
    assert seen["wrong_types"][-1][1].startswith("wrong_type ThermalLinks.links = [<")
    assert seen["allowed_types"][:-1] == [
        "a number", "a number", "a whole number", "a list of numbers", "a text", "three numbers"]


def test_values_out_of_range_give_a_sentence(seen):
    for name, (kind, text) in seen["ranges"].items():
        assert kind == "ValueError", name
        assert name in text.split(" = ")[0], text
        assert seen["allowed_ranges"][name] or re.search("allowed is", text), text


def test_assignment_is_checked_as_construction_is(seen):
    for value, (kind, text) in seen["by_assignment"].items():
        assert (kind, text) == ("ValueError", f"not_allowed Journal.radius = {float(value):g}"), value
    assert seen["kept"] == 0.005


def test_import_outside_yade_says_what_to_do():
    done = subprocess.run(
        ["/usr/bin/python3", "-c", "import statejump_yade"],
        env={"PYTHONPATH": PLUGIN_DIR, "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith("ImportError: ") and "yade -n -x" in last
