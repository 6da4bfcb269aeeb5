# SPDX-License-Identifier: GPL-3.0-or-later
"""Case files of kind umbrella, and how kinds are told apart."""
from __future__ import annotations

import tomllib
from math import atan, degrees, hypot, pi
from pathlib import Path

import pytest

from conftest import damaged
from failures import failing, failure
from statejump import _engine, kinds
from statejump.core.errors import Range, StatejumpError
from statejump.kinds.loading import load_case, parse_case
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.schema.fields import rule_of
from statejump.schema.paths import attribute_of

NORMAL = tuple(_engine.law_names("normal"))
HOT = ("temperature_change_max_K = 100", "temperature_change_max_K = 9000")
COLD = ("temperature_change_max_K = 100", "temperature_change_max_K = -9000")
LOADED = ('mode = "rest"', 'mode = "loaded"')
SPRING = ("[thermal]", "[torsion_spring]\nstiffness_N_m_per_rad = 1\nbias_rad = 0.05\n[thermal]")


def start(line: str, mode: str = "rest") -> tuple[str, str]:
    return ('mode = "rest"', f'mode = "{mode}"\n{line}')


def joint(line: str) -> tuple[str, str]:
    return ("[thermal]", f"{line}\n[thermal]")


def friction(name: str) -> tuple[str, str]:
    return ('friction_law = "ambrosio"', f'friction_law = "{name}"')


# what is replaced in cases/umbrella.toml, and what is wrong
MISTAKES = {
    "unknown kind": (
        [('kind = "umbrella"', 'kind = "umbrela"')],
        failure("misspelt_name", key="case.kind", value="umbrela", allowed=("spring_slider", "umbrella", "statics", "truss"), meant="umbrella")),
    "kind that is no text": (
        [('kind = "umbrella"', "kind = 3")], failure("not_string", key="case.kind", value=3)),
    "kind left out": (
        [('kind = "umbrella"\n', "")],
        failure("missing_key", key="case.kind")),
    "kind misspelt": (
        [('kind = "umbrella"', 'knid = "umbrella"')], failure("misspelt_key", key="case.knid", meant="case.kind")),
    "header misspelt": ([("[case]", "[caes]")], failure("misspelt_key", section="section [caes]", meant="[case]")),
    "no header": ([("[case]", "[rib]")], failure("missing_key", section="section [case]")),
    "header that is no section": (
        [("[case]", "case = 1\n[rib]")], failure("not_section", key="case", value=1, wanted="case")),
    "section of another kind": ([("[frame]", "[link]\n[frame]")], failure("misspelt_key", section="section [link]", meant="[link_bc]")),
    "section left out": ([("[frame]\nlength_m = 0.12 ", "")], failure("missing_key", section="section [frame]")),
    "unknown key": (
        [("radial_clearance_m", "clearance_m")], failure("misspelt_key", key="joint.clearance_m", meant="joint.radial_clearance_m")),
    "missing key": (
        [("radial_clearance_m = 1e-4\n", "")],
        failure("missing_key", key="joint.radial_clearance_m", allowed=Range(0, 100, "m", above=True))),
    "no clearance": (
        [("radial_clearance_m = 1e-4", "radial_clearance_m = 0")],
        failure("out_of_range", key="joint.radial_clearance_m", value=0, allowed=Range(0, 100, "m", above=True))),
    "wrong type": (
        [("mass_kg = 0.5", 'mass_kg = "0.5"')],
        failure("wrong_type", key="link_ab.mass_kg", value="0.5", type="a number", allowed=Range(0, 1000000.0, "kg", above=True))),
    "misspelt normal law": (
        [('"hertz_internal"', '"hertz_intrenal"')],
        failure("misspelt_name", key="joint.normal_law", value="hertz_intrenal", meant="hertz_internal", allowed=NORMAL)),
    "unlike any normal law": (
        [('"hertz_internal"', '"zzz"')], failure("unknown_name", key="joint.normal_law", value="zzz", allowed=NORMAL)),
    "law that is no text": (
        [('"hertz_internal"', "{a = 1}")],
        failure("not_string", key="joint.normal_law", value={'a': 1})),
    "dissipation law": (
        [('dissipation_law = "none"', 'dissipation_law = "hunt"')],
        failure("unknown_name", key="joint.dissipation_law", value="hunt", allowed=("none", "lankarani_nikravesh", "hunt_crossley", "flores", "exact_restitution"))),
    "friction law": (
        [friction("ambrosia")],
        failure("misspelt_name", key="joint.friction_law", value="ambrosia", allowed=("none", "ambrosio", "mindlin", "mindlin_deresiewicz"), meant="ambrosio")),
    "tangential velocity": (
        [('"material"', '"materials"')],
        failure("misspelt_name", key="joint.tangential_velocity", value="materials", allowed=("material", "paper"), meant="material")),
    "program": (
        [('"triangle"', '"triangel"')],
        failure("misspelt_name", key="thermal.shape", value="triangel", allowed=("triangle", "half_sine", "sine", "table"), meant="triangle")),
    "frame too long": (
        [("length_m = 0.12", "length_m = 0.16")],
        failure("links_cannot_meet", key="frame.length_m", value=0.16, most=0.15000000000000002, least=0.05, at_K=0.0)),
    "frame too short": (
        [("length_m = 0.12", "length_m = 0.05")],
        failure("links_cannot_meet", key="frame.length_m", value=0.05, most=0.15000000000000002, least=0.05, at_K=0.0)),
    "links that cannot meet in the cold": (
        [COLD, ("length_m = 0.12", "length_m = 0.149")],
        failure("links_cannot_meet", key="frame.length_m", value=0.149, most=0.1179375, least=0.0393125, at_K=-9000.0)),
    "links that cannot meet in the heat": (
        [HOT, ("length_m = 0.12", "length_m = 0.052")],
        failure("links_cannot_meet", key="frame.length_m", value=0.052, most=0.18206250000000002, least=0.060687500000000005, at_K=9000.0)),
    "link without length": (
        [COLD, ("[link_bc]                       # carries the journal [choice]\nmass_kg = 1.0\nyoung_modulus_Pa = 70e9\n"
                "stress_free_length_m = 0.1\ncross_section_area_m2 = 9e-6    # [choice] as Table 1\n"
                "thermal_expansion_per_K = 23.75e-6",
                "[link_bc]\nmass_kg = 1.0\nyoung_modulus_Pa = 70e9\nstress_free_length_m = 0.1\n"
                "cross_section_area_m2 = 9e-6\nthermal_expansion_per_K = 5e-4")],
        failure("link_without_length", key="link_bc.thermal_expansion_per_K", value=0.0005, at_K=-9000.0)),
    "radii that come out equal": (
        [("radial_clearance_m = 1e-4", "radial_clearance_m = 1e-25")],
        failure("clearance_below_precision", key="joint.radial_clearance_m", value=1e-25, radius_key="joint.journal_radius_m", radius_m=0.005)),
    "expansion closes the clearance": (
        [joint("journal_thermal_expansion_per_K = 5e-4")],
        failure("clearance_closes", key="joint.radial_clearance_m", value=0.0001, at_K=100.0)),
    "journal without radius": (
        [COLD, ("length_m = 0.12", "length_m = 0.1"), joint("journal_thermal_expansion_per_K = 5e-4")],
        failure("no_radius_left", key="joint.journal_thermal_expansion_per_K", value=0.0005, at_K=-9000.0, part="journal")),
    "bearing without radius": (
        [COLD, ("length_m = 0.12", "length_m = 0.1"), joint("bearing_thermal_expansion_per_K = 5e-4")],
        failure("no_radius_left", key="joint.bearing_thermal_expansion_per_K", value=0.0005, at_K=-9000.0, part="bearing")),
    "friction velocities in the wrong order": (
        [("friction_v0_m_per_s = 1e-5", "friction_v0_m_per_s = 1e-4")],
        failure("friction_velocities_unordered", key="joint.friction_v1_m_per_s", value=0.0001, friction_v0_m_per_s=0.0001)),
    "no restitution": (
        [joint("restitution = 0")],
        failure("restitution_zero", key="joint.restitution", value=0.0, law="none")),
    "partial slip of a line contact": (
        [friction("mindlin_deresiewicz"), ('normal_law = "hertz_internal"', 'normal_law = "johnson"')],
        failure("law_not_with_friction", key="joint.normal_law", value="johnson", law="mindlin_deresiewicz")),
    "restitution above one": (
        [joint("restitution = 1.1")], failure("out_of_range", key="joint.restitution", value=1.1, allowed=Range(0, 1, "-"))),
    "negative axial damping": (
        [("[thermal]", "[damping]\naxial_damping_ratio = -0.1\n[thermal]")],
        failure("out_of_range", key="damping.axial_damping_ratio", value=-0.1, allowed=Range(0, 10, "-"))),
    "negative pin damping": (
        [("[thermal]", "[damping]\npin_damping_N_m_s_per_rad = -1\n[thermal]")],
        failure("out_of_range", key="damping.pin_damping_N_m_s_per_rad", value=-1, allowed=Range(0, 1000000000.0, "N m s/rad"))),
    "free angle beyond a straight line": (
        [("[thermal]", "[torsion_spring]\nbias_rad = 1.5\n[thermal]")],
        failure("bias_out_of_range", key="torsion_spring.bias_rad", value=1.5, most=1.3796341802638374, least=-1.7619584733259557)),
    "free angle below zero": (
        [("[thermal]", "[torsion_spring]\nbias_rad = -2.0\n[thermal]")],
        failure("bias_out_of_range", key="torsion_spring.bias_rad", value=-2.0, most=1.3796341802638374, least=-1.7619584733259557)),
    "start in penetration": (
        [start("eccentricity_m = 1e-3")],
        failure("exceeds_clearance", key="start.eccentricity_m", value=0.001, clearance=0.0001)),
    "start mode": (
        [('mode = "rest"', 'mode = "resting"')],
        failure("misspelt_name", key="start.mode", value="resting", allowed=("rest", "matched", "loaded"), meant="rest")),
    "contact angle without contact": (
        [start("contact_angle_rad = 0.1", "matched")],
        failure("requires_loaded_start", key="start.contact_angle_rad", value=0.1)),
    "loaded without spring": (
        [LOADED],
        failure("spring_without_preload", key="start.mode", value="loaded", spring_key="stiffness_N_m_per_rad")),
    "loaded without bias": (
        [LOADED, ("[thermal]", "[torsion_spring]\nstiffness_N_m_per_rad = 1\n[thermal]")],
        failure("spring_without_preload", key="start.mode", value="loaded", spring_key="bias_rad")),
    "loaded and eccentric": (
        [SPRING, start("eccentricity_m = 1e-5", "loaded")],
        failure("set_by_equilibrium", key="start.eccentricity_m", value=1e-05)),
    "contact outside the friction cone": (
        [SPRING, friction("mindlin"), start("contact_angle_rad = -0.3", "loaded")],
        failure("angle_outside_friction_cone", key="start.contact_angle_rad", value=-0.3, least_rad=-0.2914567944778671, largest_rad=0.2914567944778671)),
    "contact angle held by no friction": (
        [SPRING, start("contact_angle_rad = 0.1", "loaded")],
        failure("friction_without_static_load", key="start.contact_angle_rad", value=0.1)),
    "adaptive steps with memory": (
        [friction("mindlin"), ('method = "rk4"', 'method = "adaptive"')],
        failure("adaptive_with_memory", key="reduced.method", value="adaptive", law="mindlin")),
    "steps between samples": (
        [("[dem]\nsteps_per_cycle = 1600000", "[dem]\nsteps_per_cycle = 100001")],
        failure("not_multiple_of_samples", key="dem.steps_per_cycle", value=100001, samples=2000)),
    "fewer steps than samples": (
        [('method = "rk4"\nsteps_per_cycle = 400000', 'method = "rk4"\nsteps_per_cycle = 1000')],
        failure("not_multiple_of_samples", key="reduced.steps_per_cycle", value=1000, samples=2000)),
    "spread beyond the clearance": (
        [("start_spread_m = 1e-6", "start_spread_m = 1e-3")],
        failure("not_above_zero_to_clearance", key="ensemble.start_spread_m", value=0.001, clearance=0.0001)),
    "a table that does not end": (
        [('shape = "triangle"', 'shape = "table"')],
        failure("conflicting_key", key="thermal.temperature_change_max_K", other="thermal.shape = 'table'")),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistake_is_one_sentence(edited, mistake: str) -> None:
    replacements, wrong = MISTAKES[mistake]
    path = edited(*replacements, case="umbrella")
    with pytest.raises(StatejumpError) as raised:
        load_case(path)
    assert raised.value == wrong.at(file=str(path)) and "\n" not in str(raised.value)


@pytest.mark.parametrize("name", ["umbrella", "umbrella_damped", "umbrella_bias"])
def test_geometry(cases: Path, name: str) -> None:
    case = load_case(cases / f"{name}.toml")
    assert isinstance(case, UmbrellaCase) and case.kind == "umbrella" and case.name == name
    x, y = case.ideal_position_m
    assert (x, y) == (pytest.approx(28.75e-3, rel=1e-14), pytest.approx(40.907670e-3, abs=1e-9))
    assert hypot(x, y) == pytest.approx(0.05, rel=1e-14)
    assert hypot(x - 0.12, y) == pytest.approx(0.1, rel=1e-14)
    assert degrees(case.theta2_rad) == pytest.approx(54.900368, abs=1e-6)
    assert degrees(case.theta4_rad) == pytest.approx(155.853152, abs=1e-6)
    assert case.flare_angle_rad == case.theta4_rad - case.theta2_rad
    assert case.bearing_radius_m == pytest.approx(5.1e-3, rel=1e-15)
    assert case.temperature_range_K == (0.0, 100.0)
    assert case.effective_young_modulus_Pa == pytest.approx(70e9 / (2 * (1 - 0.3**2)), rel=1e-15)


def test_flat_triangles_keep_their_height() -> None:
    """y = 1.73e-10 m beside lengths of 1 m; a difference of squares would lose this height to rounding."""
    flat = parse_case(minimal(frame=1.0 - 2.0**-53, ab=0.5, bc=0.5))
    assert flat.ideal_position_m[1] == pytest.approx(0.5 * 2.0**-26, rel=1e-6)


def minimal(frame: float = 0.12, ab: float = 0.05, bc: float = 0.1, **sections: dict) -> dict:
    """The required keys of a case file, as tomllib returns them."""

    def link(length: float) -> dict:
        return {"mass_kg": 1.0, "young_modulus_Pa": 70e9, "stress_free_length_m": length,
                "cross_section_area_m2": 9e-6, "thermal_expansion_per_K": 2e-5}

    return {
        "case": {"name": "small", "kind": "umbrella"}, "frame": {"length_m": frame},
        "link_ab": link(ab), "link_bc": link(bc),
        "joint": {"journal_radius_m": 5e-3, "radial_clearance_m": 1e-4, "friction_coefficient": 0.3},
        "thermal": {"shape": "triangle", "temperature_change_max_K": 100}, **sections,
    }


def test_defaults() -> None:
    case = parse_case(minimal())
    assert isinstance(case, UmbrellaCase)
    joint, thermal = case.joint, case.thermal
    assert (joint.normal_law, joint.dissipation_law, joint.friction_law, joint.tangential_velocity) == (
        "hertz_internal", "none", "mindlin", "material")
    assert (joint.restitution, joint.friction_v0_m_per_s, joint.friction_v1_m_per_s) == (1.0, 0.0, 1e-3)
    assert (thermal.period_s, thermal.cycles, case.start.mode, case.output.samples_per_cycle) == (1.0, 1, "rest", 2000)
    assert (case.reduced_settings.method, case.reduced_settings.steps_per_cycle, case.dem_settings.steps_per_cycle) == ("rk4", 100_000, 100_000)
    assert (case.ensemble.reduced_runs, case.ensemble.dem_runs, case.ensemble.seed) == (100, 30, 1)
    assert case.title == "small"


def test_defaults_are_laws_of_the_catalogue(edited) -> None:
    for key, kind in (("normal_law", "normal"), ("dissipation_law", "dissipation"), ("friction_law", "friction"),
                      ("tangential_velocity", "tangential_velocity")):
        names = _engine.law_names(kind)
        assert rule_of(attribute_of(UmbrellaCase, f"joint.{key}")).names == tuple(names)
        for name in names:
            data = minimal()
            data["joint"][key] = name
            assert getattr(parse_case(data).joint, key) == name


def test_clearance_with_expanding_radii() -> None:
    data = minimal()
    data["joint"].update(journal_thermal_expansion_per_K=2e-5, bearing_thermal_expansion_per_K=1e-5)
    case = parse_case(data)
    assert case.clearance_m(0.0) == 1e-4
    assert case.clearance_m(50.0) == pytest.approx(5.1e-3 * (1 + 5e-4) - 5e-3 * (1 + 1e-3), rel=1e-12)


def test_duration_and_program_of_a_table() -> None:
    """Times in a temperature table are used unchanged; a different period is refused."""
    data = minimal()
    data["thermal"] = {"shape": "table", "cycles": 3, "table_time_s": [0, 30, 90],
                       "table_temperature_change_K": [0, -40, 0]}
    case = parse_case(data)
    assert case.period_s == 90.0 and case.duration_s == 270.0 and case.temperature_range_K == (-40.0, 0.0)
    program = case.thermal_program()
    assert (program.duration_s, program.table_time_s) == (270.0, [0, 30, 90])
    data["thermal"]["period_s"] = 2.0
    with failing("period_beside_table", key="thermal.period_s", value=2.0, lasts=90.0):
        parse_case(data)


def test_limits_are_allowed() -> None:
    data = minimal(torsion_spring={"stiffness_N_m_per_rad": 1.0, "bias_rad": 0.05},
                   start={"mode": "loaded", "contact_angle_rad": atan(0.3)})
    loaded = parse_case(data)
    assert (loaded.torsion_spring.bias_rad, loaded.start.contact_angle_rad) == (0.05, atan(0.3))
    start = parse_case(minimal(start={"mode": "rest", "eccentricity_m": 1e-4, "eccentricity_angle_rad": pi})).start
    assert (start.eccentricity_m, start.eccentricity_angle_rad) == (1e-4, pi)
    for table, key, most in ((data["start"], "contact_angle_rad", atan(0.3)),
                             ({"mode": "rest"}, "eccentricity_m", 1e-4)):
        beyond = data | {"start": table | {key: most * (1 + 1e-9)}}
        with pytest.raises(StatejumpError) as refused:
            parse_case(beyond)
        assert (refused.value.key, refused.value.value) == (f"start.{key}", most * (1 + 1e-9))


@pytest.mark.parametrize("name, command, wanted", [("umbrella", "convergence", "spring_slider")])
def test_command_for_another_kind(statejump, cases: Path, tmp_path: Path, name: str, command: str, wanted: str) -> None:
    path = cases / f"{name}.toml"
    outcome = statejump(command, path)
    assert outcome.status == 2
    assert outcome.failure == (
        failure("command_not_for_kind", key="case.kind", value=name, command=command, kinds=repr(wanted)))
    assert list(tmp_path.iterdir()) == []


def test_kinds_are_registered(cases: Path) -> None:
    assert kinds.names() == ["spring_slider", "umbrella", "statics", "truss"]
    assert load_case(cases / "table1.toml").kind == "spring_slider"


def test_damaged_files_never_end_in_another_error(cases: Path) -> None:
    """A file with any damage either loads, or a StatejumpError explains in one sentence why not."""
    original = tomllib.loads((cases / "umbrella_bias.toml").read_text())
    values = [0, 1, -1, 1e-300, 1e300, -1e300, float("nan"), float("inf"), 10**400, True, "", "x", "rest", [], [1], {},
              {"a": 1}, 3.5, 1e-3, 1e3, ["0"], tomllib.loads("d = 2021-01-01")["d"]]
    sentences = 0
    for data in damaged(original, values, 4000):
        try:
            parse_case(data, Path("damaged.toml")).thermal_program()
        except StatejumpError as error:
            sentences += 1
            assert "\n" not in str(error)
    assert 2000 < sentences < 4000  # some damage is harmless
