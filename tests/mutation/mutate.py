#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutation test of the contact kernel: its tests must detect every listed mutation.

The program copies the kernel headers to a temporary folder, applies one textual mutation at a time, and compiles and
runs the test file of tests/cpp/kernel that the mutation names. The unmutated copy must pass, every mutant must fail at
least one test. It is an error if a mutant does not compile, or if the search text of a mutation does not occur exactly
once.

Exit status: 0 all mutants detected, 1 a mutant survived or the unmutated copy fails, 2 the set-up is wrong.
"""

import argparse
import concurrent.futures
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
from typing import NamedTuple

HEADERS = pathlib.PurePath("statejump/kernel")


class Mutation(NamedTuple):
    name: str
    header: str
    search: str
    replacement: str
    test: str  # the file of tests/cpp/kernel that must notice


MUTATIONS = [
    Mutation("friction_sign", "mindlin.hpp", "- slide * stiffness", "+ slide * stiffness",
             "mindlin_test"),
    Mutation("no_rescale_on_unloading", "mindlin.hpp", "loading ? 1.0 : stiffness * before.compliance;",
             "before.stiffness > 0.0 ? 1.0 : 0.0;", "mindlin_test"),
    Mutation("coulomb_cap_dropped", "mindlin.hpp", "force_squared > limit * limit", "false",
             "mindlin_test"),
    Mutation("slip_loss_not_booked", "mindlin.hpp",
             "slipping ? dissipation + loss : dissipation;", "dissipation;",
             "mindlin_test"),
    Mutation("slip_loss_at_the_limit", "mindlin.hpp",
             "0.5 * (kept * A::dot(old_force, direction) + limit) * slip", "limit * slip",
             "mindlin_test"),
    Mutation("microslip_of_loading_not_booked", "mindlin.hpp",
             "0.5 * before.squared * (before.compliance - compliance)", "0.0", "mindlin_test"),
    Mutation("spring_survives_the_gap", "mindlin.hpp",
             "detail::keep(Vector3::Zero(), std::max(stiffness, 0.0), stiffness > 0.0, history);", "",
             "mindlin_test"),
    Mutation("factor_8_of_mindlin_missing", "mindlin.hpp",
             "return 8.0 * effective_shear_modulus", "return effective_shear_modulus",
             "hertz_test"),
    Mutation("factor_4_3_of_force_missing", "hertz.hpp", "2.0 / 3.0 * stiffness",
             "0.5 * stiffness", "hertz_test"),
    Mutation("factor_4_3_of_K_missing", "hertz.hpp", "return 4.0 / 3.0 * effective",
             "return effective", "hertz_test"),
    Mutation("external_instead_of_internal_radius", "hertz.hpp",
             "(bearing_radius - journal_radius))", "(bearing_radius + journal_radius))",
             "hertz_test"),
    Mutation("energy_of_a_linear_spring", "hertz.hpp", "0.4 * force", "0.5 * force", "hertz_test"),
    Mutation("shear_compliance_as_for_normal", "elastic_pair.hpp", "(2.0 - nu) * 2.0",
             "(1.0 - nu) * 2.0", "hertz_test"),
    Mutation("normal_force_pulls", "contact_law.hpp", "tangential_force - normal_force * n",
             "tangential_force + normal_force * n", "contact_law_test"),
    Mutation("adhesion", "contact_law.hpp",
             "A::larger(typename A::Number{}, force + damping * approach_speed)",
             "force + damping * approach_speed", "contact_law_test"),
    Mutation("normal_damping_drives", "contact_law.hpp", "force + damping * approach_speed",
             "force - damping * approach_speed", "contact_law_test"),
    Mutation("limit_from_the_elastic_force", "contact_law.hpp",
             "parameters.friction_coefficient * normal_force;",
             "parameters.friction_coefficient * normal_state.force;", "contact_law_test"),
    Mutation("normal_velocity_in_the_slide", "contact_law.hpp",
             "velocity - approach_speed * n", "velocity",
             "contact_law_test"),
    Mutation("viscous_force_beyond_the_limit", "contact_law.hpp",
             "force = A::select(over, force * (limit / A::root(squared)), force);", "", "contact_law_test"),
    Mutation("moment_on_body_1_forgotten", "contact_law.hpp", "cross(arm_1, force_on_1)",
             "Vector3::Zero()", "contact_law_test"),
    Mutation("moment_on_body_2_forgotten", "contact_law.hpp", "cross(force_on_1, arm_2)",
             "Vector3::Zero()", "contact_law_test"),
    Mutation("stable_step_without_damping", "stable_step.hpp",
             "damping_sum + std::sqrt(damping_sum * damping_sum + 4.0 * mass * stiffness_sum)",
             "std::sqrt(4.0 * mass * stiffness_sum) + 0.0 * damping_sum", "contact_law_test"),
    Mutation("history_not_rotated", "frame.hpp",
             "  Vector3 turned = transport_untwisted<Single>(",
             "  if (n_old.x() + n_new.x() + twist_angle < 1e9) return tangential;\n"
             "  Vector3 turned = transport_untwisted<Single>(", "joint_test"),
    Mutation("history_only_projected", "frame.hpp", "A::negate(have_rotation<A>(n_old, n_new))",
             "true", "joint_test"),
    Mutation("twist_left_handed", "frame.hpp", "cross(n_new, turned)", "cross(turned, n_new)",
             "joint_test"),
    Mutation("spin_left_out_of_the_velocity", "joint_kinematics.hpp",
             "velocity + A::cross(spin, arm)", "velocity + 0.0 * arm",
             "joint_test"),
    Mutation("two_contact_points", "joint_kinematics.hpp",
             "contact.arm_1 = arm_of_first(inner_radius, contact.penetration_depth, contact.normal);\n"
             "  contact.arm_2 = centres + contact.arm_1;",
             "contact.arm_1 = inner_radius * contact.normal;\n"
             "  contact.arm_2 = outer_radius * contact.normal;", "joint_test"),
    Mutation("tilted_offset", "joint_kinematics.hpp",
             "perpendicular_part(centres, axis), across_the_axis);", "centres, across_the_axis);",
             "joint_test"),
    Mutation("wall_on_the_wrong_side", "joint_kinematics.hpp",
             "pad_radius - (face_distance - eccentricity)",
             "pad_radius - (face_distance + eccentricity)", "joint_test"),
]


def fail(message):
    print(f"mutate.py: {message}", file=sys.stderr)
    sys.exit(2)


class Bench:
    """Compiles and runs one test file against a folder of headers."""

    def __init__(self, options, folder):
        self.compiler = options.compiler
        self.sources = pathlib.Path(options.tests)
        self.libraries = options.libraries
        self.folder = folder
        # No optimisation and no warnings, because a mutant may leave a variable unused. The slow headers (Eigen,
        # GoogleTest) are common to all and precompiled once.
        self.flags = ["-std=c++17", "-O0", "-w", "-ffp-contract=off"]
        for include in options.include:
            self.flags += ["-isystem", include]
        prefix = folder / "prefix.hpp"
        prefix.write_text("#include <gtest/gtest.h>\n#include <Eigen/Core>\n"
                          "#include <Eigen/Geometry>\n#include <random>\n")
        command = [self.compiler, *self.flags, "-x", "c++-header", str(prefix),
                   "-o", str(prefix) + ".gch"]
        built = subprocess.run(command, capture_output=True, text=True)
        if built.returncode != 0:
            fail("the precompiled header does not compile:\n" + built.stderr)
        self.prefix = prefix

    def run(self, headers, test, name):
        """Returns (compiled, passed, output)."""
        binary = self.folder / f"{name}.{test}"
        built = subprocess.run(
            [self.compiler, "-I", str(headers), *self.flags, "-include", str(self.prefix),
             str(self.sources / f"{test}.cpp"), "-o", str(binary), *self.libraries, "-pthread"],
            capture_output=True, text=True)
        if built.returncode != 0:
            return False, False, built.stderr
        try:
            ran = subprocess.run([str(binary), "--gtest_brief=1"], capture_output=True, text=True,
                                 timeout=60)
        except subprocess.TimeoutExpired:
            return True, False, "timeout"
        finally:
            binary.unlink()
        return True, ran.returncode == 0, ran.stdout


def mutate(mutation, original, folder):
    """Copy the headers with one mutation; return the new include folder."""
    headers = folder / mutation.name
    shutil.copytree(original, headers / HEADERS)
    path = headers / HEADERS / mutation.header
    text = path.read_text()
    found = text.count(mutation.search)
    if found != 1:
        fail(f"mutation {mutation.name}: its text is found {found} times in {mutation.header}, "
             f"needed is once:\n{mutation.search}")
    path.write_text(text.replace(mutation.search, mutation.replacement))
    return headers


def killers(output):
    """Return the names of the failed tests in GoogleTest's output."""
    names = {line.split("]")[1].split("(")[0].strip() for line in output.splitlines()
             if line.startswith("[  FAILED  ]") and "." in line}
    return sorted(names)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--compiler", default="c++")
    parser.add_argument("--headers", required=True, help="include folder of the kernel")
    parser.add_argument("--tests", required=True, help="folder of the kernel's test sources")
    parser.add_argument("--include", action="append", default=[], help="Eigen, GoogleTest")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)),
                        help="compilers at once (default: the processors at hand)")
    parser.add_argument("libraries", nargs="+", help="GoogleTest's main and library, in link order")
    options = parser.parse_args()

    original = pathlib.Path(options.headers) / HEADERS
    if not original.is_dir():
        fail(f"--headers: no folder {original}")
    with tempfile.TemporaryDirectory(prefix="statejump-mutation-") as name:
        folder = pathlib.Path(name)
        mutants = [(m.name, mutate(m, original, folder), m.test) for m in MUTATIONS]
        control = folder / "unmutated"
        shutil.copytree(original, control / HEADERS)
        controls = [("unmutated", control, test) for test in sorted({m.test for m in MUTATIONS})]
        bench = Bench(options, folder)

        bad = 0
        with concurrent.futures.ThreadPoolExecutor(max(1, options.jobs)) as pool:
            jobs = [(item, pool.submit(bench.run, item[1], item[2], item[0]))
                    for item in controls + mutants]
            for (label, _, test), job in jobs:
                compiled, passed, output = job.result()
                wanted = label == "unmutated"
                if not compiled:
                    verdict = "DOES NOT COMPILE\n" + output
                elif passed != wanted:
                    verdict = "FAILS\n" + output if wanted else "SURVIVES"
                else:
                    verdict = "passes" if wanted else "killed by " + (
                        ", ".join(killers(output)) or "a crash or timeout")
                bad += not compiled or passed != wanted
                print(f"{label} ({test}): {verdict}", flush=True)
    print(f"{len(MUTATIONS)} mutations, {bad} problem(s)")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
