# SPDX-License-Identifier: GPL-3.0-or-later
"""Capabilities of kinds of cases: every named function has the arguments of its protocol, and a case is a single
object."""
from __future__ import annotations

import inspect
import pickle
from pathlib import Path

import pytest

from failures import failure
import statejump as sj
from statejump import kinds
from statejump.control import capabilities as design
from statejump.core.case import Case
from statejump.core.errors import NotAllowed
from statejump.core.later import Later
from statejump.kinds import protocol
from statejump.report import capabilities as present
from statejump.schema.fields import definition, section

PROTOCOLS = [value for module in (protocol, design, present) for value in vars(module).values()
             if isinstance(value, type) and value in protocol._COMMANDS]


@pytest.mark.parametrize("name", kinds.names())
def test_functions_take_what_their_protocol_says(name: str) -> None:
    kind, known = kinds.kind(name), set()
    for capability in PROTOCOLS:
        for method in protocol.methods_of(capability):
            known.add(method)
            function = getattr(type(kind), method, None)
            if not isinstance(function, Later):
                continue
            wanted = list(inspect.signature(getattr(capability, method)).parameters.values())[1:]
            given = [one for one in wanted if one.kind is not inspect.Parameter.VAR_KEYWORD]
            inspect.signature(function._function).bind(*given)  # TypeError: it takes others
    named = {key for key, value in vars(type(kind)).items() if isinstance(value, Later)}
    assert named and named <= known  # no function that nothing asks for


def test_a_kind_without_a_capability_is_refused_by_name(cases: Path) -> None:
    case = sj.load(cases / "statics_ball.toml")
    assert not kinds.has(case, protocol.ReducedModel) and kinds.has(case, design.JointStatics)
    with pytest.raises(NotAllowed) as refused:
        kinds.require(case, design.Creaking)
    assert refused.value.key == "case.kind" and refused.value.value == "statics"
    assert refused.value == failure("command_not_for_kind", command="truss creak")


def test_a_case_is_one_object(cases: Path) -> None:
    case = sj.load(cases / "table1.toml")
    assert isinstance(case, sj.Case) and case.definition is case and case.changed({}) == case
    assert {"joint", "thermal", "reduced", "dem", "dem_settings"} <= set(dir(case))
    assert case["dem.samples_per_cycle"] == case.dem_settings.samples_per_cycle == case.value_named("dem").samples_per_cycle
    assert "dem" in case.to_dict() and "dem_settings" not in case.to_dict()
    copied = pickle.loads(pickle.dumps(case))
    assert copied == case and hash(copied) == hash(case)
    assert repr(case) == "Case('table1', spring_slider)"


def test_a_truss_has_its_name(cases: Path) -> None:
    case = sj.load(cases / "trusses" / "chain_10.toml")
    assert repr(case) == "Case('chain_10', truss)" and hash(case) == hash(case.changed({}))


def test_a_section_may_not_hide_a_method() -> None:
    with pytest.raises(TypeError, match="dem_settings"):
        @definition
        class Hiding(Case):
            dem: Case = section(Case)
