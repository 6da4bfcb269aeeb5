# SPDX-License-Identifier: GPL-3.0-or-later
"""What YADE users expect of classes: constructors, dict(), documentation, ranges."""
import statejump_yade as sj
from yade import wrapper

from parts import allowed_of, finish, fault_of


def own_attributes(cls):
    # Properties of the class itself, which the view needs, are told of in its documentation.
    return {
        name: entry.__doc__ or ""
        for name, entry in vars(cls).items()
        if isinstance(entry, property) and type(entry).__name__ != "StaticProperty"
    }


classes = {}
for name in sj.__all__:
    cls = getattr(sj, name)
    if not isinstance(cls, type):
        continue
    made = cls()
    values = made.dict()
    classes[name] = {
        "doc": cls.__doc__,
        "attributes": own_attributes(cls),
        "kinds": {key: type(values.get(key)).__name__ for key in own_attributes(cls)},
        "dict": sorted(values),
        "base": cls.__mro__[1].__name__,
        "hierarchy": list(made.dispHierarchy()) if hasattr(made, "dispHierarchy") else None,
        "in_wrapper": getattr(wrapper, name) is cls,
    }

journal = sj.Journal(radius=0.005, halfLength=0.01, color=(1, 0, 0))
link = sj.ThermalLink(id1=3, youngModulus=70e9, stressFreeLength=0.5)
table = dict(
    shape="table", period=2.0, tableTimes=[0, 0.5, 2], tableTemperatureChanges=[0, 40, 0], cycles=3
)
program = sj.ThermalProgram(**table)
engine = sj.ThermalExpansionEngine(program=program, ids=[1, 2], label="heater")
law = sj.Law2_JointGeom_JointPhys_HertzMindlin(label="law")
links = sj.ThermalLinks(links=[link])
springs = sj.TorsionSprings(
    springs=[sj.TorsionSpring(link1=link, stiffness=0.5), sj.TorsionSpring()], label="springs"
)


def set_scale(value):
    sj.Gl1_Journal.clearanceScale = value


def set_radius(value):
    journal.radius = value


ranges = {
    "Journal.radius": lambda: sj.Journal(radius=-1.0),
    "Journal.halfLength": lambda: sj.Journal(halfLength=float("nan")),
    "Bearing.radius": lambda: sj.Bearing(radius=float("inf")),
    "Bearing.halfLength": lambda: sj.Bearing(halfLength=-1e-9),
    "Ball.radius": lambda: sj.Ball(radius=-1e-9),
    "Socket.radius": lambda: sj.Socket(radius=float("nan")),
    "Slider.radius": lambda: sj.Slider(radius=float("nan")),
    "SlotFace.distance": lambda: sj.SlotFace(distance=-1.0),
    "SlotFace.halfSize": lambda: sj.SlotFace(halfSize=-1.0),
    "SlotFace.normal": lambda: sj.SlotFace(normal=(1, 1, 0)),
    "normalDampingRatio": lambda: sj.Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys(
        normalDampingRatio=-0.1
    ),
    "tangentialDampingRatio": lambda: sj.Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys(
        tangentialDampingRatio=float("nan")
    ),
    "ThermalLink.youngModulus": lambda: sj.ThermalLink(youngModulus=-1.0),
    "ThermalLink.crossSectionArea": lambda: sj.ThermalLink(crossSectionArea=-1.0),
    "ThermalLink.stressFreeLength": lambda: sj.ThermalLink(stressFreeLength=float("nan")),
    "ThermalLink.dampingRatio": lambda: sj.ThermalLink(dampingRatio=-1.0),
    "ThermalLink.pinDamping": lambda: sj.ThermalLink(pinDamping=-1.0),
    "TorsionSpring.stiffness": lambda: sj.TorsionSpring(stiffness=float("inf")),
    "TorsionSpring.freeAngle": lambda: sj.TorsionSpring(freeAngle=-3.2),
    "Gl1_Journal.clearanceScale": lambda: set_scale(0.99),
    "period": lambda: sj.ThermalProgram(period=0.0),
    "cycles": lambda: sj.ThermalProgram(cycles=0),
    "shape": lambda: sj.ThermalProgram(shape="square"),
    "table_times": lambda: sj.ThermalProgram(**{**table, "tableTimes": [0, 0, 2]}),
    "table_temperature_changes": lambda: sj.ThermalProgram(
        **{**table, "tableTemperatureChanges": [0, 1]}
    ),
}
wrong_types = (
    lambda: sj.Journal(radius="large"),
    lambda: set_radius("large"),
    lambda: sj.ThermalProgram(cycles=1.5),
    lambda: sj.ThermalProgram(tableTimes=[0, "one"]),
    lambda: sj.ThermalProgram(shape=3),
    lambda: sj.SlotFace(normal=(0, 1)),
    lambda: sj.ThermalLinks(links=[journal]),
)
spring = sj.spring(4, 2, stiffness=300.0, length=0.25, dampingRatio=0.1)
finish(
    {
        "classes": classes,
        "journal": [journal.radius, journal.halfLength, list(journal.color)],
        "link": [link.id1, link.id2, link.youngModulus, link.stressFreeLength],
        "program": [program.shape, program.period, list(program.tableTimes), program.cycles],
        "engine": [engine.label, list(engine.ids), engine.program is not None, law.label],
        "springs": [
            len(springs.springs), springs.springs[0].stiffness, springs.springs[0].link1.id1,
            springs.springs[1].link1,
        ],
        "links": [len(links.links), links.links[0].id1],
        "unknown": {
            name: fault_of(lambda cls=getattr(sj, name): cls(noSuchAttribute=1))
            for name in classes
        },
        "positional": fault_of(lambda: sj.Journal(0.005)),
        "wrong_types": [fault_of(call) for call in wrong_types],
        "allowed_types": [allowed_of(call) for call in wrong_types],
        "ranges": {name: fault_of(call) for name, call in ranges.items()},
        "allowed_ranges": {name: allowed_of(call) for name, call in ranges.items()},
        "by_assignment": {str(v): fault_of(lambda v=v: set_radius(v)) for v in (-1.0, float("nan"))},
        "kept": journal.radius,
        "read_only": fault_of(lambda: setattr(link, "axialForce", 1.0)),
        "spring": [spring.id1, spring.id2, spring.youngModulus * spring.crossSectionArea / spring.stressFreeLength,
                   spring.stressFreeLength, spring.thermalExpansion, spring.dampingRatio],
        "slot": [b.shape.__class__.__name__ for b in sj.slot((0, 0, 0), 1, 1, 1, sj.ThermalFrictMat(), ceiling=True)],
    }
)
