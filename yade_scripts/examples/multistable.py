# SPDX-License-Identifier: GPL-3.0-or-later
"""Rest positions of a loaded joint with friction: a set of positions, not a single one.

    yade -n -x yade_scripts/examples/multistable.py             # table; CSV and figure in results/multistable
    FOLDER=out CASES=circle,sphere yade -n -x yade_scripts/examples/multistable.py

A journal in a bearing under a constant force F touches the wall. It rests there if the reaction -F is inside Coulomb's
cone, within atan(mu) of the wall's normal N, which points to the journal. Every such position is a stable state.

The script releases many joints at once, far from each other. Each joint starts at rest at another position of its wall,
at the depth that carries the normal part of F. Journals inside the cone stay; all others leave. The journals cannot
rotate, like pins fixed to a link; a free journal would roll.

A convex wall has each normal once, so its stable states are connected (docs/theory/rest_sets.md). The wall
of the case three_hollows is not convex, but less curved than the journal, and the force points to a bump.
Its stable states have three components: on top of the bump and in the two hollows beside it.
"""
import csv
import os
import sys
from dataclasses import dataclass, field
from math import acos, atan, atan2, cos, degrees, pi, radians, sin, sqrt
from pathlib import Path

# Finds the build tree of a clone that is not installed.
here = Path(sys.argv[0]).resolve().parent
sys.path += [str(here), str(here.parents[1] / "build" / "python")]
from statejump_yade import *

young, poisson, friction = 70e9, 0.3, 0.3  # Table 2 of Chen et al. (2021): Pa, -, -
R1, R2 = 5e-3, 5.1e-3  # m, journal (ball) and bearing (socket)
load, mass = 1.0, 1e-3  # N, kg
spacing = 0.02  # m, between joints that do not interact
cone = atan(friction)
shear_modulus = young / (4 * (2 - poisson) * (1 + poisson))  # G*


def effective_radius(inner_radius, wall_radius):
    """Return the effective radius of journal (ball) and wall [m]; a convex wall has a negative radius."""
    return inner_radius * wall_radius / (wall_radius - inner_radius)


def depth_under(force, effective):
    """Return the depth [m] at which a Hertz contact carries a force."""
    return hertz_depth(max(force, 0), effective, young, poisson)


def creep(effective):
    """Return the tangential displacement [m] of the contact when it reaches the friction limit: mu F / k_t."""
    contact_radius = sqrt(effective * depth_under(load, effective))
    return friction * load / (8 * shear_modulus * contact_radius)


@dataclass
class Case:
    """A wall: positions on it (unit normal into the wall, local radius, centre of the journal that just touches there),
    the force on the journal, and functions that make both bodies."""

    name: str
    force: Vector3
    places: list
    inner: object
    outer: object
    blocked: str
    not_admissible: int = 0
    inner_radius: float = R1
    rows: list = field(default_factory=list)


def circle():
    """Journal in a round bearing, with a position every half degree."""
    angles = [radians(0.5 * i + 0.25) for i in range(720)]
    normals = [Vector3(cos(a), sin(a), 0) for a in angles]
    return Case(
        "circle", load * Vector3(0.6, -0.8, 0), [(n, R2, n * (R2 - R1)) for n in normals],
        lambda: Journal(radius=R1), lambda: Bearing(radius=R2), "zXYZ",
    )


def sphere():
    """Ball in a socket, with positions evenly spread within 45 degrees of the force."""
    force = load * Vector3(0.36, 0.48, -0.8)
    frame = Quaternion.Identity
    frame.setFromTwoVectors(Vector3(0, 0, 1), force)
    count, places = 900, []
    for i in range(count):
        height = 1 - (1 - cos(radians(45))) * (i + 0.5) / count
        turn = i * pi * (3 - sqrt(5))
        across = sqrt(1 - height**2)
        normal = frame * Vector3(across * cos(turn), across * sin(turn), height)
        places.append((normal, R2, normal * (R2 - R1)))
    return Case("sphere", force, places, lambda: Ball(radius=R1), lambda: Socket(radius=R2), "XYZ")


def lobed(name, waves, amplitude, towards, journal=R1, count=600):
    """Journal in a bore of triangles with the radius R2 + amplitude cos(waves angle), under a force towards an angle
    [rad]. Positions are at equal angles of the wall; normals and curvatures are those of the formula, not of the mesh.
    """

    def wall(angle):
        r = R2 + amplitude * cos(waves * angle)
        slope = -waves * amplitude * sin(waves * angle)
        bend = -(waves**2) * amplitude * cos(waves * angle)
        out, across = Vector3(cos(angle), sin(angle), 0), Vector3(-sin(angle), cos(angle), 0)
        length = sqrt(r**2 + slope**2)
        return r * out, (r * out - slope * across) / length, length**3 / (length**2 + slope**2 - r * bend)

    places, skipped = [], 0
    others = [wall(2 * pi * i / 1440)[0] for i in range(1440)]
    for i in range(count):
        point, normal, radius = wall(2 * pi * (i + 0.5) / count)
        touching = point - journal * normal
        # The journal must not intersect the wall elsewhere; otherwise it cannot reach this position.
        flatter = radius > journal or radius < 0
        if flatter and min((other - touching).norm() for other in others) > journal - 1e-10:
            places.append((normal, radius, touching))
        else:
            skipped += 1
    shape = bore_triangles(R2, 2 * R1, 300, 10, lobes=[(waves, amplitude, 0)])
    return Case(
        name, load * Vector3(cos(towards), sin(towards), 0), places, lambda: Journal(radius=journal),
        lambda: MeshBore(**shape), "zXYZ", skipped, journal,
    )


def release(case):
    """Release one journal per position; report which ones are still there after 8 ms."""
    O.reset()
    metal = O.materials[O.materials.append(
        ThermalFrictMat(young=young, poisson=poisson, frictionAngle=cone)
    )]
    wall = case.outer()  # one shape for all walls, because they are equal
    along = case.force.normalized()
    pairs = []
    for i, (normal, radius, touching) in enumerate(case.places):
        origin = spacing * Vector3(i % 30, i // 30, 0)
        effective = effective_radius(case.inner_radius, radius)
        start = origin + touching + depth_under(load * along.dot(normal), effective) * normal
        for shape, position, blocked in ((wall, origin, "xyzXYZ"), (case.inner(), start, case.blocked)):
            body = Body()
            body.shape, body.material, body.bound = shape, metal, Aabb()
            body.state.pos, body.state.mass, body.state.blockedDOFs = position, mass, blocked
            number = O.bodies.append(body)
        O.forces.setPermF(number, case.force)
        pairs.append((number, start))
    O.engines = [
        ForceResetter(),
        InsertionSortCollider(
            [Bo1_Journal_Aabb(), Bo1_Bearing_Aabb(), Bo1_Ball_Aabb(), Bo1_Socket_Aabb(),
             Bo1_MeshBore_Aabb()],
            verletDist=1e-3,
        ),
        InteractionLoop(
            [Ig2_Journal_Bearing_JointGeom(), Ig2_Ball_Socket_JointGeom(), Ig2_Journal_MeshBore_BoreGeom()],
            [Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys(
                normalDampingRatio=0.5, tangentialDampingRatio=0.5
            )],
            [Law2_JointGeom_JointPhys_JointLaw(), Law2_BoreGeom_BorePhys_JointLaw()],
        ),
        NewtonIntegrator(damping=0),
    ]
    O.dt = 1e-6
    O.run(8000, True)
    # A journal that leaves at an angle outside the cone swings equally far to the other side. So 0.2 degrees become 0.4
    # degrees of the clearance circle.
    for (number, start), (normal, radius, _) in zip(pairs, case.places):
        state = O.bodies[number].state
        moved = (state.pos - start).norm()
        angle = acos(max(-1, min(1, along.dot(normal))))
        threshold = 20 * creep(effective_radius(case.inner_radius, radius))
        case.rows.append({
            "normal_x": normal[0], "normal_y": normal[1], "normal_z": normal[2],
            "wall_radius_m": radius, "angle_to_force_deg": degrees(angle),
            "predicted": "stays" if angle <= cone else "leaves",
            "seen": "left" if moved > threshold else "stayed",
            "moved_m": moved, "speed_m_per_s": state.vel.norm(),
        })
    return case


def wrong(case, beyond):
    """Return the number of joints that differ from the prediction, more (``beyond``) or less than 1 degree from the
    cone's edge."""
    return sum(
        (row["predicted"] == "stays") != (row["seen"] == "stayed")
        and (abs(row["angle_to_force_deg"] - degrees(cone)) > 1) == beyond
        for row in case.rows
    )


def parts(case, key, value):
    """Return runs of consecutive positions around the wall whose rows have the given value, as lists of indices."""
    chosen = [row[key] == value for row in case.rows]
    runs = []
    for first in (i for i, here in enumerate(chosen) if here and not chosen[i - 1]):
        length = next(n for n in range(1, len(chosen)) if not chosen[(first + n) % len(chosen)])
        runs.append([(first + n) % len(chosen) for n in range(length)])
    return runs


def table(cases):
    """The table of the results, as text."""
    lines = [
        "| case | released | not admissible | predicted to stay | stayed | predicted to leave | left |"
        " wrong within 1° of the boundary | wrong beyond | parts predicted | seen |",
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for case in cases:
        counts = [
            sum(row[key] == value for row in case.rows)
            for key, value in (("predicted", "stays"), ("seen", "stayed"), ("predicted", "leaves"),
                               ("seen", "left"))
        ]
        numbers = [len(case.rows), case.not_admissible, *counts, wrong(case, False), wrong(case, True)]
        # The sphere's positions lie on a surface, without an order.
        numbers += ["–"] * 2 if case.name == "sphere" else [
            len(parts(case, "predicted", "stays")), len(parts(case, "seen", "stayed"))
        ]
        lines.append(f"| {case.name} | " + " | ".join(map(str, numbers)) + " |")
    return "\n".join(lines)


def draw(cases, folder):
    """Plot the positions, coloured by result, over the predicted set."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    plt.rcParams.update({"font.size": 8, "svg.hashsalt": "multistable"})
    colours = {"stayed": "#0b6e4f", "left": "#c8553d"}
    columns = min(3, len(cases))
    lines = -(-len(cases) // columns)
    figure, axes = plt.subplots(
        lines, columns, figsize=(3.2 * columns, 3.4 * lines + 0.4), squeeze=False
    )
    for axis in axes.flat[len(cases):]:
        axis.set_axis_off()
    for axis, case in zip(axes.flat, cases):
        if case.name == "sphere":
            # View along the force: the distance from the centre is the angle to the force.
            frame = Quaternion.Identity
            frame.setFromTwoVectors(case.force, Vector3(0, 0, 1))
            local = [frame * Vector3(r["normal_x"], r["normal_y"], r["normal_z"]) for r in case.rows]
            turns = [atan2(n[1], n[0]) for n in local]
            points = [
                (r["angle_to_force_deg"] * cos(t), r["angle_to_force_deg"] * sin(t))
                for r, t in zip(case.rows, turns)
            ]
            rim = [(degrees(cone) * cos(t), degrees(cone) * sin(t)) for t in (pi * k / 90 for k in range(181))]
            axis.fill(*zip(*rim), color="#bfe3d0", zorder=0)
            axis.set_xlabel("angle to the force [°]")
            size = 3
        else:
            points = [(1e6 * touching[0], 1e6 * touching[1]) for _, _, touching in case.places]
            along = case.force.normalized()
            for run in parts(case, "predicted", "stays"):
                axis.fill(*zip((0, 0), *(points[i] for i in run)), color="#bfe3d0", zorder=0, linewidth=0)
            reach = max(max(abs(x), abs(y)) for x, y in points)
            axis.annotate(
                "", 0.4 * reach * Vector2(along[0], along[1]), (0, 0), arrowprops={"arrowstyle": "->"}
            )
            axis.text(0, 0, "F", ha="right", va="bottom")
            axis.set_xlabel("centre of the journal [µm]")
            size = 2
        for seen, colour in colours.items():
            chosen = [p for p, r in zip(points, case.rows) if r["seen"] == seen]
            axis.scatter([p[0] for p in chosen], [p[1] for p in chosen], s=size, color=colour, label=seen, linewidths=0)
        axis.set_aspect("equal")
        axis.set_title(", ".join([case.name] + [
            f"{sum(r['seen'] == seen for r in case.rows)} {seen}" for seen in colours
        ]), fontsize=9)
        axis.spines[["top", "right"]].set_visible(False)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(
        [*handles, plt.Rectangle((0, 0), 1, 1, color="#bfe3d0")], [*labels, "predicted to stay"],
        loc="lower center", ncol=3, frameon=False, markerscale=3,
    )
    figure.tight_layout(rect=(0, 0.25 / figure.get_figheight(), 1, 1))
    figure.savefig(folder / "multistable.png", dpi=150)
    figure.savefig(folder / "multistable.svg", metadata={"Date": None})


known = {
    "circle": circle, "sphere": sphere,
    "three_lobes": lambda: lobed("three_lobes", 3, 10e-6, atan2(-0.6, 0.8)),
    "ellipse": lambda: lobed("ellipse", 2, 25e-6, atan2(-0.6, 0.8)),
    "three_hollows": lambda: lobed("three_hollows", 3, 1.5e-3, pi / 3, 1e-3, 1200),
}
chosen = os.environ.get("CASES", ",".join(known)).split(",")
cases = [release(known[name]()) for name in chosen]
folder = Path(os.environ.get("FOLDER", here.parents[1] / "results" / "multistable"))
folder.mkdir(parents=True, exist_ok=True)
for case in cases:
    with open(folder / f"{case.name}.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, case.rows[0])
        writer.writeheader()
        writer.writerows(
            {k: f"{v:.9g}" if isinstance(v, float) else v for k, v in row.items()} for row in case.rows
        )
draw(cases, folder)
print(table(cases))
failed = sum(wrong(case, True) for case in cases)
if failed:
    print(f"{failed} joints more than 1 degree from the boundary did not do what was predicted")
