# SPDX-License-Identifier: GPL-3.0-or-later
"""Types of joints of a truss: the registry agrees with engine and case, and each type is defined in one file."""
from __future__ import annotations

from pathlib import Path

import pytest

from statejump import _engine
from statejump.kinds import truss
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.joints import JOINTS
from statejump.schema.fields import fields_of, tables_of

FOLDER = Path(truss.__file__).parent
# Sliders and revolutes touch: figures of contributions, VTK files and the page draw what their contacts do.
# Rigid bodies and hinges rotate nodes, so the checks of nodes know them; their names are ordinary words.
ROTATE_NODES = ("rigid", "hinge")
BY_ONE_FILE = [joint for joint in JOINTS if not joint.has_contacts and joint.section not in ROTATE_NODES]


def test_engine_case_and_registry_have_the_same_types() -> None:
    assert list(_engine.truss_joints()) == [joint.section for joint in JOINTS]
    assert {joint.section: joint.Item for joint in JOINTS} == {
        name: tables_of(field) for name, field in fields_of(TrussCase).items()
        if tables_of(field) in [joint.Item for joint in JOINTS]}


@pytest.mark.parametrize("joint", JOINTS, ids=lambda joint: joint.section)
def test_columns_are_outputs_of_the_engine(joint: object) -> None:
    kind = _engine.truss_joints()[joint.section]
    assert [column.name for column in joint.columns] == kind["outputs"]


@pytest.mark.parametrize("joint", BY_ONE_FILE, ids=lambda joint: joint.section)
def test_a_type_without_contacts_is_one_file(joint: object) -> None:
    names = f'"{joint.section}"', f"[[{joint.section}]]", f".{joint.section} import", f"'{joint.section}'"
    telling = {path.relative_to(FOLDER).as_posix() for path in FOLDER.rglob("*.py")
               if any(name in path.read_text(encoding="utf-8") for name in names)}
    if joint.section == "pad":  # also the part of a slider on the floor of the DEM
        telling -= {"joints/slider.py"}
    assert telling == {f"joints/{joint.section}.py", "joints/__init__.py"}
