# SPDX-License-Identifier: GPL-3.0-or-later
"""Notes on results: warnings, remarks and recommendations as sentences with a code and fields.

A new note needs one entry in ``NOTES``: a code and a template. ``Note("CODE", NAME=VALUE, ...)`` fills the names in
braces; further values are fields only. Codes are part of the public interface and do not change; sentences may change.
studies/docs/make_mistakes.py lists the codes in docs/reference/mistakes.md.
"""
from __future__ import annotations

from typing import Any

NOTES: dict[str, str] = {
    # Case files
    "key_moved": "{where}{path} is {now} now; the old place is still understood",
    # Temperature programs
    "return_added": (
        "{where}: a return to the reference temperature of {return_s:.6g} s is added, and the state jump is that "
        "after it (thermal.return_to_reference)"
    ),
    "no_return": "{where}, not at the reference temperature: it has no state jump; {remedy}",
    "reference_in_kelvin": (
        "{key} = {given:g} is taken as kelvin, {celsius:g} °C; for {given:g} °C write {kelvin:g}"
    ),
    # Implausible values
    "clearance_above_radius": (
        "{what} {name!r}{others}: the radial clearance of {clearance_m:.4g} m is above the radius of {radius_m:.4g} "
        "m; check the units"
    ),
    "modulus_implausible": (
        "{what} {name!r}{others}: Young's modulus of {young_modulus_Pa:.4g} Pa is below 1 MPa; check the units"
    ),
    "strain_implausible": (
        "{what} {name!r}{others}: {cause} strain of {strain:.3g} is above 10 %; the models are for small strains, "
        "check the units"
    ),
    # Spring and slider
    "starts_at_stop": (
        "the preload force holds the block at a stop at the start; the stop is rigid in the reduced model, in the DEM "
        "it gives, so that the block slips as its load changes"
    ),
    "euler_load_exceeded": (
        "axial force {axial_force_N:.4g} N at a temperature change of {temperature_change_K:.4g} K exceeds the {ends} "
        "Euler load of an unguided link of square section ({clamped_N:.4g} N clamped-clamped, {pinned_N:.4g} N "
        "pinned-pinned): the model assumes a guided link"
    ),
    "clearances_kept": (
        "the reduced model keeps the clearances of the reference temperature; expansion of pad and slot changes them "
        "by up to {change_m:.3g} m in the DEM"
    ),
    "cycles_left_out": (
        "history and events are those of the first and the last {shown:,} of {cycles:,} cycles; all others were "
        "computed and left out"
    ),
    # Quasi-static paths of trusses
    "large_start": (
        "the loads move the structure by {value:.3g} m at the start, {share:.1%} of its size: the path belongs to "
        "that configuration, not to the drawn one"
    ),
    "redundant_constraint": "{named}: follows from supports and the constraints before it; it changes nothing",
    "slack": (
        "{named}: no contact {at}; the element carries no force and keeps its position in the play until the "
        "clearance closes"
    ),
    "snap": (
        "{named}: slip runs away within the play {at}; dashpots in the joints carry the structure on to a stable "
        "position, {value:.3g} m away"
    ),
    "not_located": (
        "many elements are slack {at}: from there the times at which their joints make and lose contact are resolved "
        "to one increment, and the jump may depend on it; compare with more reduced.increments_per_branch"
    ),
    "changes_passed": (
        "{named}: status changes again and again {at}: from there such changes are resolved to one increment, and slip "
        "that turns round between two of them is not seen; compare with more reduced.increments_per_branch"
    ),
    "free_spin": (
        "{named}: free to spin about its own axis, which moves no node and carries no moment; held by a soft spring"
    ),
    "mean_rotates": (
        "mean {mean!r} rotates by {angle_rad:.2g} rad; its equations are linear, the neglected displacement is up to "
        "{error_m:.2g} m (angle squared over 2, times its size), {share:.2g} times the largest of its nodes; a "
        "[[rigid]] is exact for large rotations, but stiffens its nodes"
    ),
    "body_bends": (
        "body {body!r} bends by {angle_rad:.2g} rad against its frame; a linear body neglects the shortening of "
        "{strain:.2g} (angle squared over 24), {share:.2g} times its largest thermal strain: divide the body"
    ),
    "body_without_modes": (
        "body {body!r}: motion does not use the {modes} modes of its file; frequencies with them: statejump modes"
    ),
    "joint_turns_nodes": "no contributions of joints: the friction of {joint} is a moment on nodes that rotate",
    "several_reactions": (
        "{named}: constrain a displacement more than once {at}; the reactions are one solution of many, the "
        "displacements are unique"
    ),
    "link_buckles": (
        "link {link!r} is compressed by {load} {at} beyond its Euler load of {limit} ({ends}, I = "
        "{second_moment_of_area_m4:.4g} m4){others}: the models keep links straight"
    ),
    "link_yields": (
        "link {link!r} is stressed by {load} {at} beyond its yield strength of {limit}{others}: the models keep links "
        "elastic"
    ),
    "changes_together": (
        "in {increments} several joints changed their status: slip that turned round between two of these changes is "
        "not seen; reduced.locate_events = true locates them"
    ),
    # Trusses in motion
    "contacts_too_stiff": (
        "in {inexact} of {steps} steps a contact was stiffer than explicit steps of {time_step_s:.4g} s are stable "
        "with: set motion.steps_per_cycle to more"
    ),
    "steps_damped": (
        "{inexact} of {steps} steps had no solution as they were: they were damped and taken in parts down to "
        "{time_step_s:.4g} s; set motion.steps_per_cycle to more to follow what swings"
    ),
    "steps_inexact": (
        "in {inexact} of {steps} steps, as short as steps can be, displacements are off by more than "
        "motion.displacement_tolerance_m"
    ),
    "joint_jammed": (
        "at {time_s:.6g} s joint {joint!r} could not slide on: no normal force keeps it closed with the friction that "
        "comes with it, or several do; velocities jump, to one of several motions (Painlevé's paradox)"
    ),
    "reactions_not_unique": (
        "from {time_s:.6g} s on rigid contacts of joints {named} hold each other: their forces are one of several "
        "solutions, the motion is the same for all"
    ),
    # Comparisons
    "slack_not_compared": (
        "{named}: hanging slack in the play of joints, where no model determines a position; compared only where "
        "forces act on them"
    ),
    "friction_without_period": (
        "a motion that only friction holds has no natural period; the reduced model has no inertia: 'statejump "
        "compare --dynamic' gives it one"
    ),
    "heated_too_fast": (
        "the slowest natural period, {natural_period}, is {share:.2g} of the thermal one; undamped, corners of the "
        "temperature leave oscillations of {swing}, and the tolerance allows {allowed}: {remedy}"
    ),
    "still_moving": (
        "the DEM still moves at the end, with {energy} of kinetic energy: raise the damping ratios in [dem]{longer}"
    ),
    "stage_of_reduced_model": "a stage of the reduced model; no contact of the DEM changes its state",
    "stop_carries": (
        "the stop carries: a rigid one holds the block still, that of the DEM gives and lets it creep on the floor"
    ),
    "pads_bend": (
        "the reduced model holds slider {joint!r} rigidly across its axis, in the DEM its pad bends there by up to "
        "{bent}: raise pad_radius_m or young_modulus_Pa of the sliders between two nodes"
    ),
    # Answers of trusses
    "others_move": "{output} settles, other nodes still move: node {node} by {moved} in cycle {cycle}",
    "jump_not_resolved": (
        "the jump is not resolved: with twice the increments it changes by {change:.2g} {unit}; more "
        "reduced.increments_per_branch are needed, or there is none"
    ),
    "nothing_ranked": "the output does not jump: no joints are ranked, no sensitivities are computed",
    "jump_has_kink": (
        "the jump has a kink here in some parameters, its slopes on both sides differ: see the verdicts of the "
        "sensitivities"
    ),
    # Control
    "nothing_to_control": "{what}: there is nothing to control.",
    "no_preload": (
        "No preload spring up to {largest_N_per_m:g} N/m, the largest that a case may have, keeps the jump at or "
        "below {wanted}."
    ),
    "no_preload_needed": "No preload spring is needed: without one the jump is {jump}, not above {wanted}.",
    "smallest_preload": (
        "The smallest preload spring that keeps the jump at or below {wanted} has {stiffness_N_per_m:.6g} N/m "
        "({how}); solved with it, the jump is {jump}."
    ),
    "no_value_found": "{subject}: no scanned value from {low} to {high} keeps the jump at or below {wanted}{least}.",
    "nothing_needed": "{subject}: nothing is needed, the jump is {jump} without.",
    "smallest_change": (
        "{subject}: {value} is the smallest change that keeps the jump at or below {wanted} ({found_by}); solved with "
        "it, the jump is {jump}. There {derivative}."
    ),
    "best_of_several": "Best of {asked}, {reaching} of which reach the bound, is the {what}: {parameter} with {value}.",
    "no_key_free": (
        "No key is named best, for not all of them are free to a designer: --free KEY (in Python scale=[KEY]) names "
        "those that are."
    ),
    "jump_not_monotone": (
        "{parameter}: the jump is not monotone, it turns near {at}; a range that is narrower than the scan may be "
        "missed"
    ),
    "values_without_path": (
        "{parameter}: with {failed} scanned value(s) the truss has no path, see the notes in control.csv"
    ),
    "jump_leaps": "{parameter}: the jump leaps across the bound at the value found, or a truss has no path there",
    "joints_differ": (
        "{parameter}: with it joints stick, slip or touch otherwise than in the case, whose own sensitivities do not "
        "apply to it"
    ),
    "increments_too_few": (
        "{parameter}: with twice the increments a branch the jump is {jump}: more reduced.increments_per_branch are "
        "needed"
    ),
    # Identification
    "other_joint_fits_better": "{better} fits better: its BIC is {less:.1f} less",
    "joints_alike": "the loop does not distinguish {best} from {other}: BIC differs by {difference:.1f}",
    "not_identifiable": "{parameter} is not identifiable from this loop{why}: {bound}",
    "play_carries_no_force": "the play of a case carries no force: play_m is play (1 - play_ratio)",
    "parameter_without_key": "{parameter} has no key in {section}: the section leaves it out",
    "clearance_not_crossed": "clearance is not identifiable from this loop: no gap is crossed",
    "friction_extrapolated": (
        "friction is extrapolated by the law of partial slip: the loop goes to {percent:.0f} % of it"
    ),
    "residuals_correlated": (
        "residuals of neighbouring rows are correlated ({correlation:.2f}): intervals and choice count {rows} rows as "
        "{independent:.0f}; the noise is not independent or the joint is another one"
    ),
    # Condensed bodies
    "body_digits": (
        "stiffness: relative asymmetry {asymmetry:.2g}, relative force of rigid motions {rigid_error:.2g}; both are "
        "removed"
    ),
    "body_large": "the nodes are {radius_m:.4g} m from their centre; check the units",
    "body_load_digits": "pattern/load: relative resultant {error:.2g}; it is removed",
    "body_mass_directions": (
        "mass: it differs between directions, relative difference {error:.2g}; check units and order of rows"
    ),
    # Campaigns
    "sample_failed": "the run failed: {error}: {text}",
    "worker_ended": "the run ended its worker process, time and again",
    "journal_torn": "{path}: the last line was torn and is cut off; its samples are run again",
}


class Note(str):
    """A sentence on a result with a code.

    :ivar code: key of ``NOTES``
    :ivar details: values of the names in braces, and further values
    """

    code: str
    details: dict[str, Any]

    def __new__(cls, code: str, **details: Any) -> Note:
        made = super().__new__(cls, NOTES[code].format_map(details))
        made.code, made.details = code, details
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        # Results of a campaign go from process to process with their notes.
        return _again, (self.code, self.details)


def _again(code: str, details: dict[str, Any]) -> Note:
    return Note(code, **details)
