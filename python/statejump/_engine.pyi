# SPDX-License-Identifier: GPL-3.0-or-later
# Types of the engine's module. Kept by hand; `stubtest` holds it against the module.
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Array = NDArray[np.float64]
_Columns = dict[str, _Array]
_Fields = dict[str, Any]

class _pybind11_type(type): ...

class EngineFailure(ValueError, RuntimeError):
    kind: str
    message: str
    item: str | None
    key: str | None
    value: float | str | None
    allowed: str | None
    joint: str | None
    joint_kind: Literal["slider", "revolute"] | None
    joints: tuple[str, ...]
    nodes: tuple[str, ...]
    time_s: float | None
    temperature_change_K: float | None
    cause: str | None
    remedy: str | None
    file: str | None
    reason: str | None
    numbers: dict[str, float]
    details: dict[str, Any]

class ThermalProgram(metaclass=_pybind11_type):
    def __init__(
        self,
        *,
        shape: str,
        temperature_change_max_K: float = ...,
        period_s: float = ...,
        cycles: int = ...,
        table_time_s: Sequence[float] = ...,
        table_temperature_change_K: Sequence[float] = ...,
    ) -> None: ...
    @property
    def shape(self) -> str: ...
    @property
    def temperature_change_max_K(self) -> float: ...
    @property
    def period_s(self) -> float: ...
    @property
    def cycles(self) -> int: ...
    @property
    def table_time_s(self) -> list[float]: ...
    @property
    def table_temperature_change_K(self) -> list[float]: ...
    @property
    def duration_s(self) -> float: ...
    def temperature_change(self, time_s: ArrayLike) -> Any: ...  # a number for a number, else an array
    def temperature_rate(self, time_s: ArrayLike) -> Any: ...

class SpringSlider(metaclass=_pybind11_type):
    def __init__(
        self,
        *,
        young_modulus_Pa: float,
        cross_section_area_m2: float,
        stress_free_length_m: float,
        thermal_expansion_per_K: float,
        friction_force_N: float,
        clearance_minus_m: float = ...,
        clearance_plus_m: float = ...,
        preload_stiffness_N_per_m: float = ...,
        preload_force_N: float = ...,
        start_friction: str = ...,
        stop_stiffness_N_per_m: float = ...,
        play_m: float = ...,
    ) -> None: ...
    @property
    def young_modulus_Pa(self) -> float: ...
    @property
    def cross_section_area_m2(self) -> float: ...
    @property
    def stress_free_length_m(self) -> float: ...
    @property
    def thermal_expansion_per_K(self) -> float: ...
    @property
    def friction_force_N(self) -> float: ...
    @property
    def clearance_minus_m(self) -> float: ...
    @property
    def clearance_plus_m(self) -> float: ...
    @property
    def preload_stiffness_N_per_m(self) -> float: ...
    @property
    def preload_force_N(self) -> float: ...
    @property
    def stop_stiffness_N_per_m(self) -> float: ...
    @property
    def play_m(self) -> float: ...
    @property
    def start_middle_m(self) -> float: ...
    @property
    def start_load_N(self) -> float: ...
    @property
    def start_displacement_m(self) -> float: ...
    @property
    def state_jump_m(self) -> float: ...
    def state_jump_after_slide_m(self, direction: int) -> float: ...
    def link_stiffness_N_per_m(self, temperature_change_K: float = ...) -> float: ...
    def euler_load_N(self, ends: str = ..., second_moment_of_area_m4: float = ...) -> float: ...

class SpringSliderEvent(metaclass=_pybind11_type):
    @property
    def kind(self) -> str: ...
    @property
    def stage_before(self) -> str: ...
    @property
    def stage_after(self) -> str: ...
    @property
    def time_s(self) -> float: ...
    @property
    def temperature_change_K(self) -> float: ...
    @property
    def displacement_m(self) -> float: ...
    @property
    def axial_force_N(self) -> float: ...

class SpringSliderSegment(metaclass=_pybind11_type):
    @property
    def stage(self) -> str: ...
    @property
    def motion(self) -> str: ...
    @property
    def direction(self) -> int: ...
    @property
    def cycle(self) -> int: ...
    @property
    def start_time_s(self) -> float: ...
    @property
    def end_time_s(self) -> float: ...
    @property
    def start_temperature_change_K(self) -> float: ...
    @property
    def end_temperature_change_K(self) -> float: ...
    @property
    def start_displacement_m(self) -> float: ...
    @property
    def end_displacement_m(self) -> float: ...

class SpringSliderPath(metaclass=_pybind11_type):
    @property
    def model(self) -> SpringSlider: ...
    @property
    def program(self) -> ThermalProgram: ...
    @property
    def events(self) -> list[SpringSliderEvent]: ...
    @property
    def segments(self) -> list[SpringSliderSegment]: ...
    @property
    def state_jump_m(self) -> float: ...
    @property
    def largest_axial_force_N(self) -> float: ...
    @property
    def exceeded_euler_load(self) -> dict[str, float] | None: ...
    def jump_after_cycle(self, cycle: int) -> float: ...
    def sample(self, time_s: ArrayLike) -> _Fields: ...

def solve_spring_slider(
    model: SpringSlider, program: ThermalProgram, time_s: ArrayLike | None = ..., told: ThermalProgram | None = ...
) -> SpringSliderPath: ...

class ThermalLink(metaclass=_pybind11_type):
    def __init__(
        self,
        *,
        stress_free_length_m: float,
        mass_kg: float,
        young_modulus_Pa: float,
        cross_section_area_m2: float,
        thermal_expansion_per_K: float,
        poisson_ratio: float = ...,
    ) -> None: ...

class Linkage(metaclass=_pybind11_type):
    def __init__(
        self,
        *,
        frame_length_m: float,
        link_ab: ThermalLink,
        link_bc: ThermalLink,
        journal_radius_m: float,
        bearing_radius_m: float,
        journal_thermal_expansion_per_K: float = ...,
        bearing_thermal_expansion_per_K: float = ...,
        normal_law: str = ...,
        dissipation_law: str = ...,
        friction_law: str = ...,
        tangential_velocity: str = ...,
        friction_coefficient: float = ...,
        friction_v0_m_per_s: float = ...,
        friction_v1_m_per_s: float = ...,
        restitution: float = ...,
        smallest_impact_speed_m_per_s: float = ...,
        contact_length_m: float = ...,
        axial_damping_ratio: float = ...,
        pin_damping_N_m_s_per_rad: float = ...,
        torsion_stiffness_N_m_per_rad: float = ...,
        torsion_free_angle_rad: float = ...,
    ) -> None: ...
    @property
    def radial_clearance_m(self) -> float: ...
    @property
    def friction_coefficient(self) -> float: ...
    @property
    def torsion_free_angle_rad(self) -> float: ...
    def first_contact_temperature_change(self) -> float: ...

class LinkageState(metaclass=_pybind11_type):
    @property
    def bearing_centre_m(self) -> _Array: ...
    @property
    def journal_centre_m(self) -> _Array: ...
    @property
    def bearing_velocity_m_per_s(self) -> _Array: ...
    @property
    def journal_velocity_m_per_s(self) -> _Array: ...
    @property
    def tangential_force_N(self) -> float: ...
    @property
    def tangential_stiffness_N_per_m(self) -> float: ...

class LinkageRun(metaclass=_pybind11_type):
    def columns(self) -> _Columns: ...
    @property
    def first_contact_time_s(self) -> float | None: ...
    @property
    def first_contact_temperature_change_K(self) -> float | None: ...
    @property
    def contacts(self) -> int: ...
    @property
    def steps(self) -> int: ...
    @property
    def energy_residue_J(self) -> float: ...

def initial_state(
    model: Linkage, mode: str, temperature_rate_K_per_s: float = ..., eccentricity_m: ArrayLike = ...
) -> LinkageState: ...
def simulate(
    model: Linkage, program: ThermalProgram, start: LinkageState, steps: int = ..., sample_every: int = ...
) -> LinkageRun: ...
def simulate_adaptive(
    model: Linkage, program: ThermalProgram, start: LinkageState, relative_tolerance: float = ..., samples: int = ...
) -> LinkageRun: ...

class JointLoop(metaclass=_pybind11_type):
    def columns(self) -> _Columns: ...
    @property
    def events(self) -> list[_Fields]: ...
    @property
    def separated(self) -> bool: ...
    @property
    def theta2_jump_rad(self) -> float: ...
    @property
    def theta4_jump_rad(self) -> float: ...
    @property
    def bearing_jump_m(self) -> _Array: ...
    @property
    def journal_jump_m(self) -> _Array: ...

class ElasticLoop(metaclass=_pybind11_type):
    def columns(self) -> _Columns: ...
    @property
    def events(self) -> list[_Fields]: ...
    @property
    def separated(self) -> bool: ...
    @property
    def theta2_jump_rad(self) -> float: ...
    @property
    def theta4_jump_rad(self) -> float: ...
    @property
    def bearing_jump_m(self) -> _Array: ...
    @property
    def journal_jump_m(self) -> _Array: ...
    @property
    def largest_force_residual(self) -> float: ...

def joint_point(model: Linkage, temperature_change_K: float, side: int, contact_angle_rad: float) -> _Fields: ...
def joint_loop(
    model: Linkage, program: ThermalProgram, contact_angle_rad: float = ..., samples: int = ...
) -> JointLoop: ...
def elastic_loop(
    model: Linkage,
    program: ThermalProgram,
    contact_angle_rad: float = ...,
    samples: int = ...,
    tangential_compliance: str = ...,
) -> ElasticLoop: ...
def loaded_state(model: Linkage, contact_angle_rad: float = ...) -> LinkageState: ...

class RestCurve(metaclass=_pybind11_type):
    @property
    def nodes_m(self) -> _Array: ...
    @property
    def normals(self) -> _Array: ...
    @property
    def closed(self) -> bool: ...

class RestMesh(metaclass=_pybind11_type):
    def __init__(self, vertices_m: ArrayLike, triangles: ArrayLike, normals: ArrayLike | None = ...) -> None: ...
    @property
    def vertices_m(self) -> _Array: ...
    @property
    def normals(self) -> _Array: ...
    @property
    def triangles(self) -> list[list[int]]: ...

def rest_in_slot(clearance_m: float, forces_N: ArrayLike, friction_coefficient: float) -> _Fields: ...
def rest_in_bearing(clearance_m: float, forces_N: ArrayLike, friction_coefficient: float) -> _Fields: ...
def rest_in_socket(clearance_m: float, forces_N: ArrayLike, friction_coefficient: float) -> _Fields: ...
def rest_in_bore(
    clearance_m: float, axial_play_m: float, forces_N: ArrayLike, friction_coefficient: float
) -> _Fields: ...
def implicit_curves(
    gamma: Callable[[_Array], float],
    gradient: Callable[[_Array], ArrayLike],
    low_m: ArrayLike,
    high_m: ArrayLike,
    cells: int = ...,
) -> list[RestCurve]: ...
def lobed_curve(clearance_m: float, amplitude: float, lobes: int, samples: int = ...) -> RestCurve: ...
def journal_in_profile(rho: Callable[[float], float], journal_radius_m: float, samples: int = ...) -> RestCurve: ...
def rest_on_curves(curves: Sequence[RestCurve], forces_N: ArrayLike, friction_coefficient: float) -> _Fields: ...
def welded(mesh: RestMesh, tolerance_m: float) -> RestMesh: ...
def implicit_surface(
    gamma: Callable[[_Array], float],
    gradient: Callable[[_Array], ArrayLike],
    low_m: ArrayLike,
    high_m: ArrayLike,
    cells: int = ...,
) -> RestMesh: ...
def clearance_sphere(clearance_m: float, level: int) -> RestMesh: ...
def rest_on_mesh(mesh: RestMesh, forces_N: ArrayLike, friction_coefficient: float) -> _Fields: ...

FRICTION_METHODS: tuple[str, ...]

class FrictionProblem(metaclass=_pybind11_type):
    def __init__(self, dimension: int, delassus: ArrayLike, q: ArrayLike, mu: ArrayLike) -> None: ...
    @staticmethod
    def of_columns(
        dimension: int,
        starts: Sequence[int],
        rows: Sequence[int],
        values: ArrayLike,
        q: ArrayLike,
        mu: ArrayLike,
    ) -> FrictionProblem: ...
    def velocities(self, reactions: ArrayLike) -> _Array: ...
    def merit(self, reactions: ArrayLike) -> dict[str, float]: ...
    def solve(
        self,
        tolerance: float = ...,
        method: str = ...,
        most_sweeps: int = ...,
        guess: ArrayLike | None = ...,
        progress: Callable[[float], None] | None = ...,
    ) -> _Fields: ...

_Items = Mapping[str, Any]

def truss_elements() -> dict[str, _Fields]: ...
def truss_joints() -> dict[str, _Fields]: ...
def iwan_slack_N(
    tangent_stiffness_N_per_m: float, slip_force_N: float, exponent: float, stiffness_ratio: float, elements: int,
    spacing: float,
) -> float: ...
def truss_path(
    nodes: _Items,
    elements: Mapping[str, _Items],
    joints: Mapping[str, _Items],
    programs: Sequence[ThermalProgram],
    *,
    constraints: _Items = ...,
    increments_per_branch: int = ...,
    locate_events: bool = ...,
    event_tolerance: float = ...,
    energy_tolerance: float = ...,
    cycle_ends_only: bool = ...,
    problem_times: Sequence[float] = ...,
    start_friction: str = ...,
    progress: Callable[[float], bool | None] | None = ...,
    trace: Callable[[tuple[Any, ...]], object] | None = ...,
) -> _Fields: ...
class TrussDerivative(metaclass=_pybind11_type):
    def summands(
        self,
        nodes: _Items,
        elements: Mapping[str, _Items],
        joints: Mapping[str, _Items],
        programs: Sequence[ThermalProgram],
        *,
        constraints: _Items = ...,
    ) -> _Fields: ...
    @property
    def solutions(self) -> int: ...
    @property
    def events(self) -> int: ...
    @property
    def kinks(self) -> int: ...

class TrussRecord(metaclass=_pybind11_type):
    @property
    def path(self) -> _Fields: ...
    def derivative(self, covectors: ArrayLike) -> TrussDerivative: ...

def truss_recorded_path(
    nodes: _Items,
    elements: Mapping[str, _Items],
    joints: Mapping[str, _Items],
    programs: Sequence[ThermalProgram],
    *,
    constraints: _Items = ...,
    increments_per_branch: int = ...,
    event_tolerance: float = ...,
    energy_tolerance: float = ...,
    start_friction: str = ...,
    progress: Callable[[float], bool | None] | None = ...,
) -> TrussRecord: ...
def truss_motion(
    nodes: _Items,
    elements: Mapping[str, _Items],
    joints: Mapping[str, _Items],
    programs: Sequence[ThermalProgram],
    inertia: _Items,
    *,
    constraints: _Items = ...,
    steps: int,
    sample_every: int,
    theta: float = ...,
    displacement_tolerance_m: float = ...,
    restitution: float = ...,
    watched_node: int = ...,
    drives: list[dict[str, Any]] = ...,
    start_drawn: bool = ...,
    start_friction: str = ...,
    friction_law: str = ...,
    progress: Callable[[float], bool | None] | None = ...,
) -> _Fields: ...

def truss_linearised(
    nodes: _Items,
    elements: Mapping[str, _Items],
    joints: Mapping[str, _Items],
    programs: Sequence[ThermalProgram],
    inertia: _Items,
    *,
    start_friction: str = ...,
    constraints: _Items = ...,
) -> dict[str, Any]: ...

def truss_friction_free(
    nodes: _Items,
    elements: Mapping[str, _Items],
    joints: Mapping[str, _Items],
    programs: Sequence[ThermalProgram],
    *,
    constraints: _Items = ...,
    start_friction: str = ...,
) -> dict[str, Any]: ...

class BoreMesh(metaclass=_pybind11_type):
    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        kind: str = ...,
        scale: float = ...,
        flip: bool = ...,
        smallest_radius_m: float = ...,
        largest_radius_m: float = ...,
        fit_degree: int = ...,
    ) -> None: ...
    @staticmethod
    def read(
        file: str,
        kind: str = ...,
        scale: float = ...,
        flip: bool = ...,
        smallest_radius_m: float = ...,
        largest_radius_m: float = ...,
        fit_degree: int = ...,
    ) -> BoreMesh: ...
    def closest_point(self, point_m: ArrayLike) -> _Fields: ...
    def contacts(
        self, journal_centre_m: ArrayLike, journal_axis: ArrayLike, journal_radius_m: float, maximum_gap_m: float = ...
    ) -> list[_Fields]: ...
    def ball_contacts(
        self, ball_centre_m: ArrayLike, ball_radius_m: float, maximum_gap_m: float = ...
    ) -> list[_Fields]: ...
    def section_radii_m(self, z_m: float, count: int) -> _Array: ...
    @property
    def vertices_m(self) -> _Array: ...
    @property
    def faces(self) -> NDArray[np.int32]: ...
    @property
    def vertex_count(self) -> int: ...
    @property
    def removed_face_count(self) -> int: ...
    @property
    def face_count(self) -> int: ...
    @property
    def wall_face_count(self) -> int: ...
    @property
    def closed(self) -> bool: ...
    @property
    def mean_radius_m(self) -> float: ...
    @property
    def centre_m(self) -> _Array: ...
    @property
    def axis(self) -> _Array: ...
    @property
    def axis_x(self) -> _Array: ...
    @property
    def axis_y(self) -> _Array: ...
    @property
    def length_m(self) -> float: ...
    @property
    def smallest_curvature_per_m(self) -> float: ...
    @property
    def largest_curvature_per_m(self) -> float: ...
    @property
    def reconstruction_error_m(self) -> float: ...
    @property
    def prominence_m(self) -> float: ...

def mesh_reasons() -> list[tuple[str, str, str, str]]: ...
def bore_triangles(
    radius_m: float,
    length_m: float,
    around: int,
    along: int,
    lobes: Sequence[tuple[int, float, float]] = ...,
    wear_depth_m: float = ...,
    wear_angle_rad: float = ...,
    wear_width_rad: float = ...,
    crown_m: float = ...,
    wall_thickness_m: float = ...,
) -> tuple[_Array, NDArray[np.int32]]: ...
def socket_triangles(
    radius_m: float, opening_rad: float, around: int, along: int
) -> tuple[_Array, NDArray[np.int32]]: ...
def laws(kind: str) -> list[_Fields]: ...
def law_names(kind: str) -> list[str]: ...
def normal_force(
    name: str,
    depth_m: ArrayLike,
    journal_radius_m: float,
    bearing_radius_m: float,
    length_m: float,
    effective_young_modulus_Pa: float,
) -> _Columns: ...
def largest_depth_m(name: str, journal_radius_m: float, bearing_radius_m: float) -> float: ...
def damping_ratio_s_per_m(name: str, restitution: float, impact_speed_m_per_s: float) -> float: ...
def drive_contact(
    *,
    kind: str,
    name: str,
    effective_young_modulus_Pa: float,
    effective_shear_modulus_Pa: float,
    effective_radius_m: float,
    radial_clearance_m: float,
    contact_length_m: float,
    friction_coefficient: float,
    v0_m_per_s: float,
    v1_m_per_s: float,
    restitution: float,
    smallest_impact_speed_m_per_s: float,
    normal: ArrayLike,
    normal_is_force: bool,
    along: ArrayLike,
    along_is_force: bool,
    across_m: ArrayLike | None = ...,
    time_s: ArrayLike | None = ...,
) -> dict[str, Any]: ...  # columns, and the text "problem"
def effective_young_modulus_Pa(
    young_modulus_1_Pa: float, poisson_ratio_1: float, young_modulus_2_Pa: float, poisson_ratio_2: float
) -> float: ...
def load_user_laws() -> None: ...
def user_law_folders() -> list[str]: ...
def user_law_problems() -> list[str]: ...
def law_problem(kind: str, name: str) -> str: ...
def inspect_user_law(file: str) -> dict[str, str]: ...
def kernel_hash() -> str: ...
def hertz_contact(
    force_N: float,
    effective_radius_m: float,
    young_modulus_1_Pa: float,
    poisson_ratio_1: float,
    young_modulus_2_Pa: float,
    poisson_ratio_2: float,
) -> dict[str, float]: ...
def critical_time_step_s(
    mass_kg: ArrayLike, stiffness_sum_N_per_m: ArrayLike, damping_sum_N_s_per_m: ArrayLike = ...
) -> Any: ...  # a number for numbers, else an array
