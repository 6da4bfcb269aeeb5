# SPDX-License-Identifier: GPL-3.0-or-later
"""Case files of kind umbrella, and how kinds are told apart."""
from __future__ import annotations

import tomllib
from math import atan, degrees, hypot, pi
from pathlib import Path

import pytest

from conftest import damaged
from statejump import _engine, kinds
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import load_case, parse_case
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.schema.fields import rule_of
from statejump.schema.paths import attribute_of

NORMAL = " or ".join(repr(name) for name in _engine.law_names("normal"))
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


# what is replaced in cases/umbrella.toml, and the sentence after the file's name
MISTAKES = {
    "unknown kind": (
        [('kind = "umbrella"', 'kind = "umbrela"')],
        "case.kind = 'umbrela' is not allowed: must be 'spring_slider' or 'umbrella' or 'statics' or 'truss'; did you mean 'umbrella'?"),
    "kind that is no text": (
        [('kind = "umbrella"', "kind = 3")], "case.kind = 3 is not allowed: must be a text in quotes"),
    "kind left out": (
        [('kind = "umbrella"\n', "")],
        "case.kind is missing: a text in quotes is needed"),
    "kind misspelt": (
        [('kind = "umbrella"', 'knid = "umbrella"')], "case.knid is unknown: did you mean case.kind?"),
    "header misspelt": ([("[case]", "[caes]")], "section [caes] is unknown: did you mean [case]?"),
    "no header": ([("[case]", "[rib]")], "section [case] is missing"),
    "header that is no section": (
        [("[case]", "case = 1\n[rib]")], "case = 1 is not allowed: must be a section [case]"),
    "section of another kind": ([("[frame]", "[link]\n[frame]")], "section [link] is unknown: did you mean [link_bc]?"),
    "section left out": ([("[frame]\nlength_m = 0.12 ", "")], "section [frame] is missing"),
    "unknown key": (
        [("radial_clearance_m", "clearance_m")], "joint.clearance_m is unknown: did you mean joint.radial_clearance_m?"),
    "missing key": (
        [("radial_clearance_m = 1e-4\n", "")],
        "joint.radial_clearance_m is missing: must be above 0 and at most 100 [m]"),
    "no clearance": (
        [("radial_clearance_m = 1e-4", "radial_clearance_m = 0")],
        "joint.radial_clearance_m = 0 is not allowed: must be above 0 and at most 100 [m]"),
    "wrong type": (
        [("mass_kg = 0.5", 'mass_kg = "0.5"')],
        "link_ab.mass_kg = '0.5' is not allowed: must be a number, above 0 and at most 1e+06 [kg]"),
    "misspelt normal law": (
        [('"hertz_internal"', '"hertz_intrenal"')],
        f"joint.normal_law = 'hertz_intrenal' is not allowed: must be {NORMAL}; did you mean 'hertz_internal'?"),
    "unlike any normal law": (
        [('"hertz_internal"', '"zzz"')], f"joint.normal_law = 'zzz' is not allowed: must be {NORMAL}"),
    "law that is no text": (
        [('"hertz_internal"', "{a = 1}")],
        "joint.normal_law = {'a': 1} is not allowed: must be a text in quotes"),
    "dissipation law": (
        [('dissipation_law = "none"', 'dissipation_law = "hunt"')],
        "joint.dissipation_law = 'hunt' is not allowed: must be 'none' or 'lankarani_nikravesh' or 'hunt_crossley' "
        "or 'flores' or 'exact_restitution'"),
    "friction law": (
        [friction("ambrosia")],
        "joint.friction_law = 'ambrosia' is not allowed: must be 'none' or 'ambrosio' or 'mindlin' or "
        "'mindlin_deresiewicz'; "
        "did you mean 'ambrosio'?"),
    "tangential velocity": (
        [('"material"', '"materials"')],
        "joint.tangential_velocity = 'materials' is not allowed: must be 'material' or 'paper'; "
        "did you mean 'material'?"),
    "program": (
        [('"triangle"', '"triangel"')],
        "thermal.shape = 'triangel' is not allowed: must be 'triangle' or 'half_sine' or 'sine' or 'table'; "
        "did you mean 'triangle'?"),
    "frame too long": (
        [("length_m = 0.12", "length_m = 0.16")],
        "frame.length_m = 0.16 is not allowed: must be above 0.05 and below 0.15 [m], or the links cannot meet at a "
        "temperature change of 0 K"),
    "frame too short": (
        [("length_m = 0.12", "length_m = 0.05")],
        "frame.length_m = 0.05 is not allowed: must be above 0.05 and below 0.15 [m], or the links cannot meet at a "
        "temperature change of 0 K"),
    "links that cannot meet in the cold": (
        [COLD, ("length_m = 0.12", "length_m = 0.149")],
        "frame.length_m = 0.149 is not allowed: must be above 0.0393125 and below 0.1179375 [m], or the links cannot "
        "meet at a temperature change of -9000 K"),
    "links that cannot meet in the heat": (
        [HOT, ("length_m = 0.12", "length_m = 0.052")],
        "frame.length_m = 0.052 is not allowed: must be above 0.0606875 and below 0.1820625 [m], or the links cannot "
        "meet at a temperature change of 9000 K"),
    "link without length": (
        [COLD, ("[link_bc]                       # carries the journal [choice]\nmass_kg = 1.0\nyoung_modulus_Pa = 70e9\n"
                "stress_free_length_m = 0.1\ncross_section_area_m2 = 9e-6    # [choice] as Table 1\n"
                "thermal_expansion_per_K = 23.75e-6",
                "[link_bc]\nmass_kg = 1.0\nyoung_modulus_Pa = 70e9\nstress_free_length_m = 0.1\n"
                "cross_section_area_m2 = 9e-6\nthermal_expansion_per_K = 5e-4")],
        "link_bc.thermal_expansion_per_K = 0.0005 is not allowed: the link has no length left at a temperature "
        "change of -9000 K"),
    "radii that come out equal": (
        [("radial_clearance_m = 1e-4", "radial_clearance_m = 1e-25")],
        "joint.radial_clearance_m = 1e-25 is not allowed: too small beside joint.journal_radius_m = 0.005 [m], the "
        "radii come out equal"),
    "expansion closes the clearance": (
        [joint("journal_thermal_expansion_per_K = 5e-4")],
        "joint.radial_clearance_m = 0.0001 is not allowed: the expansion of journal and bearing closes it at a "
        "temperature change of 100 K, it must stay above 0 [m] within the program"),
    "journal without radius": (
        [COLD, ("length_m = 0.12", "length_m = 0.1"), joint("journal_thermal_expansion_per_K = 5e-4")],
        "joint.journal_thermal_expansion_per_K = 0.0005 is not allowed: the journal has no radius left at a "
        "temperature change of -9000 K"),
    "bearing without radius": (
        [COLD, ("length_m = 0.12", "length_m = 0.1"), joint("bearing_thermal_expansion_per_K = 5e-4")],
        "joint.bearing_thermal_expansion_per_K = 0.0005 is not allowed: the bearing has no radius left at a "
        "temperature change of -9000 K"),
    "friction velocities in the wrong order": (
        [("friction_v0_m_per_s = 1e-5", "friction_v0_m_per_s = 1e-4")],
        "joint.friction_v1_m_per_s = 0.0001 is not allowed: must be above joint.friction_v0_m_per_s = 0.0001 [m/s]"),
    "no restitution": (
        [joint("restitution = 0")],
        "joint.restitution = 0.0 is not allowed with joint.dissipation_law = 'none': must be above 0 [-]"),
    "partial slip of a line contact": (
        [friction("mindlin_deresiewicz"), ('normal_law = "hertz_internal"', 'normal_law = "johnson"')],
        "joint.normal_law = 'johnson' is not allowed with joint.friction_law = 'mindlin_deresiewicz': must be one of "
        "hertz_paper, hertz_internal"),
    "restitution above one": (
        [joint("restitution = 1.1")], "joint.restitution = 1.1 is not allowed: must be between 0 and 1 [-]"),
    "negative axial damping": (
        [("[thermal]", "[damping]\naxial_damping_ratio = -0.1\n[thermal]")],
        "damping.axial_damping_ratio = -0.1 is not allowed: must be between 0 and 10 [-]"),
    "negative pin damping": (
        [("[thermal]", "[damping]\npin_damping_N_m_s_per_rad = -1\n[thermal]")],
        "damping.pin_damping_N_m_s_per_rad = -1 is not allowed: must be between 0 and 1e+09 [N m s/rad]"),
    "free angle beyond a straight line": (
        [("[thermal]", "[torsion_spring]\nbias_rad = 1.5\n[thermal]")],
        "torsion_spring.bias_rad = 1.5 is not allowed: must be above -1.76195847 and below 1.37963418 [rad], so that "
        "the free flare angle lies between 0 and pi"),
    "free angle below zero": (
        [("[thermal]", "[torsion_spring]\nbias_rad = -2.0\n[thermal]")],
        "torsion_spring.bias_rad = -2.0 is not allowed: must be above -1.76195847 and below 1.37963418 [rad], so that "
        "the free flare angle lies between 0 and pi"),
    "start in penetration": (
        [start("eccentricity_m = 1e-3")],
        "start.eccentricity_m = 0.001 is not allowed: must be between 0 and joint.radial_clearance_m = 0.0001 [m], "
        "beyond it the joint starts in deep penetration"),
    "start mode": (
        [('mode = "rest"', 'mode = "resting"')],
        "start.mode = 'resting' is not allowed: must be 'rest' or 'matched' or 'loaded'; did you mean 'rest'?"),
    "contact angle without contact": (
        [start("contact_angle_rad = 0.1", "matched")],
        "start.contact_angle_rad = 0.1 is not allowed: only with start.mode = 'loaded'"),
    "loaded without spring": (
        [LOADED],
        "start.mode = 'loaded' is not allowed: torsion_spring.stiffness_N_m_per_rad is 0, and only a biased torsion "
        "spring loads the joint"),
    "loaded without bias": (
        [LOADED, ("[thermal]", "[torsion_spring]\nstiffness_N_m_per_rad = 1\n[thermal]")],
        "start.mode = 'loaded' is not allowed: torsion_spring.bias_rad is 0, and only a biased torsion spring loads "
        "the joint"),
    "loaded and eccentric": (
        [SPRING, start("eccentricity_m = 1e-5", "loaded")],
        "start.eccentricity_m = 1e-05 is not allowed with start.mode = 'loaded': equilibrium decides"),
    "contact outside the friction cone": (
        [SPRING, friction("mindlin"), start("contact_angle_rad = -0.3", "loaded")],
        "start.contact_angle_rad = -0.3 is not allowed: must be between -0.291456794 and 0.291456794 [rad], atan of "
        "joint.friction_coefficient"),
    "contact angle held by no friction": (
        [SPRING, start("contact_angle_rad = 0.1", "loaded")],
        "start.contact_angle_rad = 0.1 is not allowed: must be 0 [rad]: this friction holds no static load"),
    "adaptive steps with memory": (
        [friction("mindlin"), ('method = "rk4"', 'method = "adaptive"')],
        "reduced.method = 'adaptive' is not allowed with joint.friction_law = 'mindlin': friction with memory is not "
        "smooth, use 'rk4'"),
    "steps between samples": (
        [("[dem]\nsteps_per_cycle = 1600000", "[dem]\nsteps_per_cycle = 100001")],
        "dem.steps_per_cycle = 100001 is not allowed: must be a multiple of output.samples_per_cycle = 2000"),
    "fewer steps than samples": (
        [('method = "rk4"\nsteps_per_cycle = 400000', 'method = "rk4"\nsteps_per_cycle = 1000')],
        "reduced.steps_per_cycle = 1000 is not allowed: must be a multiple of output.samples_per_cycle = 2000"),
    "spread beyond the clearance": (
        [("start_spread_m = 1e-6", "start_spread_m = 1e-3")],
        "ensemble.start_spread_m = 0.001 is not allowed: must be above 0 and at most joint.radial_clearance_m = "
        "0.0001 [m]"),
    "a table that does not end": (
        [('shape = "triangle"', 'shape = "table"')],
        "thermal.temperature_change_max_K is not allowed with thermal.shape = 'table'"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistake_is_one_sentence(edited, mistake: str) -> None:
    replacements, sentence = MISTAKES[mistake]
    path = edited(*replacements, case="umbrella")
    with pytest.raises(StatejumpError) as raised:
        load_case(path)
    assert str(raised.value) == f"{path}: {sentence}"


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
    """Differences of squares would lose it: y = 1.73e-10 m beside lengths of 1 m."""
    flat = parse_case(minimal(frame=1.0 - 2.0**-53, ab=0.5, bc=0.5))
    assert flat.ideal_position_m[1] == pytest.approx(0.5 * 2.0**-26, rel=1e-6)


def minimal(frame: float = 0.12, ab: float = 0.05, bc: float = 0.1, **sections: dict) -> dict:
    """The least that a case must say, as tomllib would return it."""

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
    """A table's own times are the times; a period that says otherwise is refused."""
    data = minimal()
    data["thermal"] = {"shape": "table", "cycles": 3, "table_time_s": [0, 30, 90],
                       "table_temperature_change_K": [0, -40, 0]}
    case = parse_case(data)
    assert case.period_s == 90.0 and case.duration_s == 270.0 and case.temperature_range_K == (-40.0, 0.0)
    program = case.thermal_program()
    assert (program.duration_s, program.table_time_s) == (270.0, [0, 30, 90])
    data["thermal"]["period_s"] = 2.0
    with pytest.raises(StatejumpError, match="thermal.period_s = 2.0 is not allowed: the table lasts 90 s"):
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
        with pytest.raises(StatejumpError, match=f"start.{key} = "):
            parse_case(beyond)


@pytest.mark.parametrize("name, command, wanted", [("umbrella", "convergence", "spring_slider")])
def test_command_for_another_kind(statejump, cases: Path, tmp_path: Path, name: str, command: str, wanted: str) -> None:
    path = cases / f"{name}.toml"
    outcome = statejump(command, path)
    assert outcome.status == 2
    assert outcome.errors == (
        f"error: {path}: case.kind = '{name}' is not allowed: 'statejump {command}' is for '{wanted}'\n")
    assert list(tmp_path.iterdir()) == []


def test_kinds_are_registered(cases: Path) -> None:
    assert kinds.names() == ["spring_slider", "umbrella", "statics", "truss"]
    assert load_case(cases / "table1.toml").kind == "spring_slider"


def test_damaged_files_never_end_in_another_error(cases: Path) -> None:
    """Whatever stands in a file: the case loads, or one StatejumpError says why not."""
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
