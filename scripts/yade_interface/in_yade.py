# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside YADE: offsets and types of data members, printed as one line of JSON.

Offsets of plain attributes come from the member pointers in Boost.Python's getters. Offsets of members without Python
access come from a search of live objects for words with known values. YADE's objects are modified only through Python.
"""
from __future__ import annotations

import ctypes
import json
import os
import re
import time
from typing import Any, Callable

from yade import config, utils, wrapper

WORD = 8
CLASSES = ["Shape", "Bound", "Aabb", "State", "Material", "ElastMat", "FrictMat", "Body", "IGeom", "IPhys",
           "GenericSpheresContact", "NormPhys", "NormShearPhys", "FrictPhys", "Interaction", "Functor", "Engine",
           "Scene", "BodyContainer", "InteractionContainer", "EnergyTracker"]
_pipe = os.pipe()
_libc = ctypes.CDLL(None, use_errno=True)


def read(address: int, size: int) -> bytes | None:
    """Return bytes of this process at an address; None if the kernel refuses to read them. It never crashes."""
    if address <= 0 or _libc.write(_pipe[1], ctypes.c_void_p(address), ctypes.c_size_t(size)) <= 0:
        return None
    data = os.read(_pipe[0], size)
    return data if len(data) == size else None


def word(address: int) -> int:
    """Return the memory word at an address; 0 if it cannot be read."""
    data = read(address, WORD)
    return int.from_bytes(data, "little") if data else 0


def text(address: int) -> str:
    """Return the text at an address, up to its terminator."""
    result = b""
    while b"\0" not in result and len(result) < 8192:
        part = read(address + len(result), 64 - (address + len(result)) % 64)
        if not part:
            return ""
        result += part
    return result.split(b"\0")[0].decode("latin1")


def type_name(thing: int) -> str:
    """Return the mangled class name of the object at an address; empty if it has no virtual functions."""
    table = word(thing) if thing % WORD == 0 else 0
    information = word(table - WORD) if table else 0
    return text(word(information + WORD)) if information else ""


def is_a(thing: int, class_name: str) -> bool:
    """Return whether the object at an address is exactly of this class of YADE, not of a derived class."""
    return type_name(thing) == f"N4yade{len(class_name)}{class_name}E"


def demangled(names: list[str]) -> list[str]:
    """Return names of types in the notation of C++."""
    runtime = ctypes.CDLL("libstdc++.so.6")
    runtime.__cxa_demangle.restype = ctypes.c_void_p
    runtime.__cxa_demangle.argtypes = [ctypes.c_char_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    result = []
    for name in names:
        place = runtime.__cxa_demangle(name.encode(), None, None, None)
        result.append(ctypes.string_at(place).decode() if place else name)
    return result


def getters() -> tuple[list[list[Any]], int]:
    """Return class, name, offset and type of plain attributes of the examined classes; also the number in all classes.
    """
    found, count = [], 0
    for class_name, python_class in sorted(vars(wrapper).items()):
        if not isinstance(python_class, type):
            continue
        for name, attribute in sorted(vars(python_class).items()):
            if not isinstance(attribute, property) or type(attribute.fget).__name__ != "function":
                continue
            implementation = word(id(attribute.fget) + object.__basicsize__)
            mangled = type_name(implementation)
            count += bool(mangled)
            if class_name in CLASSES:
                found.append([class_name, name, word(implementation + WORD), mangled])
    member = re.compile(r"boost::python::objects::caller_py_function_impl<boost::python::detail::caller<"
                        r"boost::python::detail::member<(.*), yade::(\w+)>, boost::python::")
    result = []
    for row, written in zip(found, demangled([row[3] for row in found])):
        match = member.match(written)
        if match and match[2] == row[0]:
            result.append([row[0], row[1], row[2], match[1]])
    return result, count


def place_of(thing: Any) -> int:
    """Return the address of the YADE object behind a Python object (held by a shared pointer)."""
    holder = word(id(thing) + 40)
    return word(holder + 2 * WORD)


def size_of(class_name: str) -> int:
    """Return the size that Create<Class> passes to operator new [bytes]."""
    function = getattr(ctypes.CDLL(None), f"_ZN4yade{len(class_name) + 6}Create{class_name}Ev")
    code = ctypes.string_at(ctypes.cast(function, ctypes.c_void_p).value, 64)
    place = code.index(b"\xbf")
    return int.from_bytes(code[place + 1: place + 5], "little")


def places(start: int, class_name: str, holds: Callable[[int], bool], step: int = WORD) -> list[int]:
    """Return the offsets in an object at which a memory word (or a part of a word) satisfies ``holds``."""
    size = size_of(class_name)
    data = read(start, size) or b""
    return [i for i in range(0, size - step + 1, step) if holds(int.from_bytes(data[i: i + step], "little"))]


def values() -> list[list[Any]]:
    """Return class, name, offset and type of members found by a search for their values, if found exactly once."""
    functors = {"bound": Bo1_Sphere_Aabb(), "geometry": Ig2_Sphere_Sphere_ScGeom(),
                "physics": Ip2_FrictMat_FrictMat_FrictPhys(), "law": Law2_ScGeom_FrictPhys_CundallStrack()}
    O.engines = [ForceResetter(), InsertionSortCollider([functors["bound"]]),
                 InteractionLoop([functors["geometry"]], [functors["physics"]], [functors["law"]]), NewtonIntegrator()]
    O.bodies.append([utils.sphere((0, 0, 0), 1), utils.sphere((0, 0, 1.9), 1)])
    O.dt = 1e-6
    O.trackEnergy = True
    O.run(3, True)
    scene = place_of(O._sceneObj)
    if not is_a(scene, "Scene"):
        return []
    result: list[list[Any]] = []

    def only(class_name: str, name: str, found: list[int], kind: str) -> int | None:
        if len(found) != 1:
            return None
        result.append([class_name, name, found[0], kind])
        return found[0]

    def list_of(pointee: str) -> str:
        pointer = f"boost::shared_ptr<yade::{pointee}>"
        return f"std::vector<{pointer}, std::allocator<{pointer} > >"

    def is_list(start: int, things: list[int]) -> bool:
        return bool(things) and all(word(start + 2 * WORD * i) == one for i, one in enumerate(things))

    state = State()
    state.blockedDOFs = "xZ"
    only("State", "blockedDOFs", places(place_of(state), "State", lambda one: one == 1 + 32, 4), "unsigned int")
    engines = [place_of(one) for one in O.engines]
    found = [places(one, "Engine", lambda value: value == scene) for one in engines]
    if all(one == found[0] for one in found):
        only("Engine", "scene", found[0], "yade::Scene*")
    found = [places(place_of(one), "Functor", lambda value: value == scene) for one in functors.values()]
    if all(one == found[0] for one in found):
        only("Functor", "scene", found[0], "yade::Scene*")
    only("Scene", "engines", places(scene, "Scene", lambda one: is_list(one, engines)), list_of("Engine"))
    parts = {}
    for name, pointee in (("bodies", "BodyContainer"), ("interactions", "InteractionContainer"),
                          ("energy", "EnergyTracker")):
        at = only("Scene", name, places(scene, "Scene", lambda one, pointee=pointee: is_a(one, pointee)),
                  f"boost::shared_ptr<yade::{pointee}>")
        parts[name] = word(scene + at) if at is not None else 0
    bodies = [place_of(one) for one in O.bodies]
    only("BodyContainer", "body", places(parts["bodies"], "BodyContainer", lambda one: is_list(one, bodies)),
         list_of("Body"))
    interaction = place_of(O.interactions[0, 1])
    container = parts["interactions"]
    only("InteractionContainer", "linIntrs",
         places(container, "InteractionContainer", lambda one: is_list(one, [interaction])), list_of("Interaction"))
    # Number of interactions: 1 here, 0 after they are cleared.
    ones = places(container, "InteractionContainer", lambda one: one == 1)
    O.interactions.clear()
    zeros = places(container, "InteractionContainer", lambda one: one == 0)
    only("InteractionContainer", "currSize", [one for one in ones if one in zeros], "unsigned long")
    if os.environ.get("STATEJUMP_FORCES_AT"):
        forces = int(os.environ["STATEJUMP_FORCES_AT"])
        result.append(["Scene", "forces", forces, "yade::ForceContainer"])
        # Number of the step for which forces were reset, the only other counter that equals O.iter.
        counted = None
        for _ in range(3):
            now = O.iter
            O.run(5, True)
            here = set(places(scene, "Scene", lambda one, now=now: one == now + 4))
            counted = here if counted is None else counted & here
        if counted and len(counted) == 1:
            result.append(["ForceContainer", "lastReset", counted.pop() - forces, "long"])
    return result


start = time.perf_counter()
plain, number = getters()
hidden = values()
with open("/proc/self/maps") as file:
    library = next(row.split(maxsplit=5)[5].strip() for row in file if row.rstrip().endswith("/libyade.so"))
result = {"version": config.version, "library": library, "getters": plain, "values": hidden, "read": number,
          "seconds": time.perf_counter() - start}
print("MEASURED " + json.dumps(result), flush=True)
os._exit(0)
