# SPDX-License-Identifier: GPL-3.0-or-later
"""The registries of joints and elements of a truss: one declaration per type determines everything else."""
from __future__ import annotations

import dataclasses
from typing import Any, cast

import pytest

import statejump as sj
from statejump import _engine
from statejump.kinds.truss import dem
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.checks import SECTIONS
from statejump.kinds.truss.elements import ELEMENTS, ElementLists
from statejump.kinds.truss.elements.protocol import ElementType
from statejump.kinds.truss.joints import JOINTS, JointLists
from statejump.kinds.truss.joints.protocol import JointType
from statejump.kinds.truss.sections import sections_in_files
from statejump.kinds.truss.solve import engine_items
from statejump.schema.fields import fields_of, rule_of, tables_of
from statejump.schema.rules import NUMBER

AnyType = ElementType[Any, Any] | JointType[Any, Any]
TYPES: tuple[AnyType, ...] = (*ELEMENTS, *JOINTS)
each_type = pytest.mark.parametrize("kind", TYPES, ids=lambda kind: str(kind.section))


def engine_type(kind: AnyType) -> dict[str, Any]:
    """Return what the engine lists for a type."""
    if isinstance(kind, JointType):
        return _engine.truss_joints()[kind.section]
    return _engine.truss_elements()[kind.items]


def test_engine_has_the_same_types() -> None:
    assert set(_engine.truss_joints()) == {joint.section for joint in JOINTS}
    assert set(_engine.truss_elements()) == {"links", *(element.items for element in ELEMENTS)}


def test_lists_of_a_case_are_those_of_the_registries() -> None:
    assert list(fields_of(JointLists)) == [joint.section for joint in JOINTS]
    assert list(fields_of(ElementLists)) == [element.section for element in ELEMENTS]
    assert {kind.section for kind in TYPES} <= set(sections_in_files())
    assert {kind.section for kind in TYPES} <= set(SECTIONS)


@each_type
def test_list_of_a_type_has_its_items(kind: AnyType) -> None:
    assert tables_of(fields_of(TrussCase)[kind.section]) is kind.Item


@each_type
def test_columns_are_those_of_the_engine(kind: AnyType) -> None:
    outputs = engine_type(kind)["outputs"]
    declared = [column.name for column in kind.columns]
    # Both models have a column; the engine may have further ones.
    assert [name for name in outputs if name in declared] == declared


@each_type
def test_numbers_have_the_units_of_the_engine(kind: AnyType) -> None:
    keys = fields_of(kind.Item)
    for parameter in engine_type(kind)["parameters"]:
        key = parameter["key"]
        if key in keys and rule_of(keys[key]).form == NUMBER:
            allowed = rule_of(keys[key]).allowed
            assert allowed is not None and allowed.unit == parameter["unit"], key


@each_type
def test_arrays_are_those_of_the_engine(kind: AnyType) -> None:
    """Arrays have the names of the keys in case files, except for derived arrays; all arrays of the engine are
    declared."""
    truss = sj.truss.chain(3).resolve()
    tables = engine_items(truss)["joints" if isinstance(kind, JointType) else "elements"]
    given = tables[kind.section if isinstance(kind, JointType) else kind.items]
    assert {parameter["key"] for parameter in engine_type(kind)["parameters"]} <= set(given)
    fields = {field.name for field in dataclasses.fields(kind.Arrays)} - {"names"}
    # Each node of a [[rigid]] is a joint of its own, with its master and with the rotations that its own one holds.
    # A [[body]] has the matrices of its content at its place.
    derived = {"rigid": {"master", "node", "holds"}, "body": {"contents", "placed"}}.get(kind.section, {"rigid"})
    assert fields - set(fields_of(kind.Item)) <= derived, "a key of its items has another name"


def test_names_of_types_and_columns_are_unique() -> None:
    names = [name for kind in TYPES for name in (kind.section, *(column.name for column in kind.columns))]
    assert len(set(names)) == len(names)


def test_dem_refuses_elements_by_name() -> None:
    case = sj.truss.umbrella(1)
    (spring,) = case.torsion_spring
    with pytest.raises(sj.StatejumpError) as refused:
        dem.check(case.changed({f"torsion_spring.{spring.name}.bias_rad": 1.6}))
    assert refused.value.code == "dem_large_rotation"
    assert repr(spring.name) in refused.value.cause
    dem.check(case.changed({f"torsion_spring.{spring.name}.bias_rad": -1.57}))


def test_type_without_preselection_has_every_item_checked() -> None:
    """Tables are checked by item only where a type selects items; a type that selects none must not skip its checks."""
    class Unselective(JointType[Any, Any]):
        def check_vectors(self, item: Any, dimension: int) -> None:
            raise AssertionError

    items: Any = [None, None]
    assert Unselective().may_be_wrong_vectors(items, 3).all()
    assert Unselective().may_be_wrong_references(items, cast(Any, None)).all()
    assert not JointType[Any, Any]().may_be_wrong_vectors(items, 3).any()
