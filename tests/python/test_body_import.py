# SPDX-License-Identifier: GPL-3.0-or-later
"""Import of condensed bodies: every form of DMIG, op4 and matrix files of Abaqus gives the same body."""
from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from failures import failing
from frames import POSITIONS_M, stiffness
from statejump.bodies.body import CondensedBody
from statejump.bodies.formats import bulk
from statejump.bodies.importing import import_body
from statejump.kinds.truss.importing.to_case import Units

NUMBERS = (3, 11, 20)
LABELS = [(node, k) for node in NUMBERS for k in range(1, 7)]
# CORD2R 5 is rotated about z; node 11 has its dofs there.
SYSTEM = "CORD2R*                5               0 0.000000000E+00 0.000000000E+00\n" \
    "*        0.000000000E+00 0.000000000E+00 0.000000000E+00 0.100000000E+01\n" \
    "*        0.600000000E+00 0.800000000E+00 0.000000000E+00\n"


def grids(system: int = 5) -> str:
    made = [SYSTEM]
    for number, (x, y, z) in zip(NUMBERS, POSITIONS_M):
        made.append(f"GRID*   {number:16d}{0:16d}{x:16.9E}{y:16.9E}\n*       {z:16.9E}{system if number == 11 else 0:16d}\n")
    return "".join(made)


def externals(modes: int = 0) -> str:
    words = [f"{number:8d}  123456" for number in NUMBERS] + [f"{1000 + k:8d}       0" for k in range(modes)]
    lines = ["".join(words[at:at + 4]) for at in range(0, len(words), 4)]
    return "EXTRN   " + "\n        ".join(lines) + "\n"


def in_system() -> np.ndarray:
    """Stiffness whose second node has its dofs in the system 5."""
    axes = np.eye(18)
    for at in (6, 9):
        axes[at:at + 3, at:at + 3] = [[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]]
    return np.asarray(axes @ stiffness() @ axes.T)


def agrees(body: CondensedBody, digits: float = 1e-13) -> None:
    assert body.node_names == tuple(map(str, NUMBERS))
    assert np.allclose(body.node_positions_m, POSITIONS_M, rtol=0, atol=1e-12)
    assert np.abs(body.stiffness[:18, :18] - stiffness()).max() < digits * np.abs(stiffness()).max()


def dmig(matrix: np.ndarray, form: int = 6, free: bool = False, lower: bool = True) -> str:
    made = [f"DMIG    KAAX    {0:8d}{form:8d}{2:8d}{0:8d}\n"]
    for j, (node, k) in enumerate(LABELS):
        rows = [i for i in range(18) if (form != 6 or (i >= j if lower else i <= j)) and matrix[i, j]]
        if free:
            made += [f"DMIG,KAAX,{node},{k},,{LABELS[i][0]},{LABELS[i][1]},{matrix[i, j]:.12E}\n" for i in rows]
            continue
        made.append(f"DMIG*   KAAX            {node:16d}{k:16d}\n")
        made += [f"*       {LABELS[i][0]:16d}{LABELS[i][1]:16d}{matrix[i, j]:16.9E}\n".replace("E", "D") for i in rows]
    return "".join(made)


@pytest.mark.parametrize(("form", "free", "lower", "digits"), [
    (6, False, True, 1e-9), (6, False, False, 1e-9), (1, False, True, 1e-9), (6, True, True, 1e-12)])
def test_dmig(tmp_path: Path, form: int, free: bool, lower: bool, digits: float) -> None:
    (tmp_path / "x.pch").write_text("$TITLE = a body\n" + dmig(in_system(), form, free, lower) + grids())
    agrees(import_body([tmp_path / "x.pch"]), digits)


def text_op4(matrix: np.ndarray, how: str) -> str:
    size = len(matrix)
    made = [f"{size:8d}{-size if how == 'big' else size:8d}{6:8d}{2:8d}{'KAA':8s}1P,3E23.16\n"]
    for j in range(size):
        words = 2 * size
        head = {"dense": (1, words), "strings": (0, words + 1), "big": (0, words + 2)}[how]
        made.append(f"{j + 1:8d}{head[0]:8d}{size if how == 'dense' else head[1]:8d}\n")
        if how == "strings":
            made.append(f"{1 + 65536 * (words + 1):11d}\n")
        elif how == "big":
            made.append(f"{words + 1:8d}{1:8d}\n")
        values = [f"{value:23.16E}" for value in matrix[:, j]]
        made += ["".join(values[at:at + 3]) + "\n" for at in range(0, size, 3)]
    return "".join(made) + f"{size + 1:8d}{1:8d}{1:8d}\n{1.0:23.16E}\n"


def binary_op4(matrix: np.ndarray, how: str, order: str, long: bool) -> bytes:
    whole = "q" if long else "i"

    def record(content: bytes) -> bytes:
        mark = struct.pack(f"{order}i", len(content))
        return mark + content + mark

    def wholes(*values: int) -> bytes:
        return struct.pack(f"{order}{len(values)}{whole}", *values)

    size, per = len(matrix), 1 if long else 2
    name = "KAA".ljust(16 if long else 8).encode()
    made = [record(wholes(size, -size if how == "big" else size, 6, 2) + name)]
    for j in range(size):
        values = matrix[:, j].astype(f"{order}f8").tobytes()
        words = per * size
        if how == "dense":
            made.append(record(wholes(j + 1, 1, words) + values))
        elif how == "big":
            made.append(record(wholes(j + 1, 0, words + 2, words + 1, 1) + values))
        else:
            made.append(record(wholes(j + 1, 0, words + 1, 1 + 65536 * (words + 1)) + values))
    return b"".join([*made, record(wholes(size + 1, 1, per) + struct.pack(f"{order}d", 1.0))])


def with_modes() -> np.ndarray:
    both = np.zeros((20, 20))
    both[:18, :18], both[18, 18], both[19, 19] = in_system(), 1e5, 4e5
    return both


@pytest.mark.parametrize("how", ["dense", "strings", "big"])
def test_op4_as_text(tmp_path: Path, how: str) -> None:
    (tmp_path / "x.op4").write_text(text_op4(with_modes(), how))
    (tmp_path / "x.pch").write_text("BEGIN SUPER 1\n" + externals(2) + grids())
    body = import_body([tmp_path / "x.op4", tmp_path / "x.pch"])
    agrees(body)
    assert body.modes == 2


@pytest.mark.parametrize("how", ["dense", "strings", "big"])
@pytest.mark.parametrize(("order", "long"), [("<", False), (">", False), ("<", True), (">", True)])
def test_op4_binary(tmp_path: Path, how: str, order: str, long: bool) -> None:
    (tmp_path / "x.op4").write_bytes(binary_op4(with_modes(), how, order, long))
    (tmp_path / "x.asm").write_text(grids() + f"SPOINT  {1000:8d}{'THRU':8s}{1001:8d}\n")
    body = import_body([tmp_path / "x.op4", tmp_path / "x.asm"])
    agrees(body)
    assert body.modes == 2


def op2(matrices: dict[str, np.ndarray], order: str = "<", external: bool = True) -> bytes:
    def record(content: bytes) -> bytes:
        mark = struct.pack(f"{order}i", len(content))
        return mark + content + mark

    def key(value: int) -> bytes:
        return record(struct.pack(f"{order}i", value))

    made = [key(3), record(struct.pack(f"{order}3i", 1, 2, 3)), key(7), record(b"NASTRAN FORT TAPE ID CODE - ")]
    for name, matrix in matrices.items():
        size = len(matrix)
        title = ("EXTDB" if external else name).ljust(8).encode()
        made += [key(2), record(title), key(-1), key(7), record(struct.pack(f"{order}7i", 101, size, size, 6, 2, 0, 0))]
        made += [key(-2), key(1), key(0), key(2), record(name.ljust(8).encode()), key(-3), key(1)]
        for j in range(size):
            made.append(key(1))
            filled = np.flatnonzero(matrix[:, j])
            if len(filled):  # two strings
                for rows in (filled[:1], np.arange(filled[0] + 1, size)):
                    if len(rows):
                        values = matrix[rows, j].astype(f"{order}f8").tobytes()
                        made += [key(1 + 2 * len(rows)), record(struct.pack(f"{order}i", rows[0] + 1) + values)]
            made += [key(-4 - j), key(1)]
        made += [key(0), key(0)]
    return b"".join([*made, key(0)])


@pytest.mark.parametrize("external", [True, False])
@pytest.mark.parametrize("order", "<>")
def test_op2(tmp_path: Path, order: str, external: bool) -> None:
    (tmp_path / "x.op2").write_bytes(op2({"MATK" if external else "KAA": with_modes()}, order, external))
    (tmp_path / "x.asm").write_text(grids() + f"SPOINT  {1000:8d}{'THRU':8s}{1001:8d}\n")
    body = import_body([tmp_path / "x.op2", tmp_path / "x.asm"])
    agrees(body)
    assert body.modes == 2


def test_op2_without_stiffness_is_refused(tmp_path: Path) -> None:
    (tmp_path / "x.asm").write_text(grids())
    (tmp_path / "x.op2").write_bytes(op2({"MUG1": np.eye(3)}))
    with failing("matrix_missing", known="MUG1"):
        import_body([tmp_path / "x.op2", tmp_path / "x.asm"])
    (tmp_path / "y.op2").write_bytes(op2({"KAA": stiffness()})[:2000])
    with failing("matrix_file_damaged", form="an op2 file"):
        import_body([tmp_path / "y.op2", tmp_path / "x.asm"])
    (tmp_path / "z.op2").write_bytes(struct.pack("<iqi", 8, 3, 8))
    with failing("matrix_op2_words"):
        import_body([tmp_path / "z.op2", tmp_path / "x.asm"])


def nodes_deck(directions: bool = True) -> str:
    lines = [f"{number},{x:.17g},{y:.17g},{z:.17g}" for number, (x, y, z) in zip(NUMBERS, POSITIONS_M)]
    turned = "*NSET,NSET=B\n11\n*TRANSFORM,NSET=B,TYPE=R\n0.6,0.8,0,-0.8,0.6,0\n" if directions else ""
    return "*NODE\n" + "\n".join(lines) + "\n" + turned


def entries(matrix: np.ndarray, separator: str) -> str:
    return "".join(separator.join(map(str, (*LABELS[i], *LABELS[j]))) + separator + f"{matrix[i, j]:.15e}\n"
                   for i in range(18) for j in range(i + 1))


@pytest.mark.parametrize("separator", [", ", " "])
def test_matrix_output_with_node_numbers(tmp_path: Path, separator: str) -> None:
    (tmp_path / "x_STIF2.mtx").write_text(entries(in_system(), separator))
    (tmp_path / "x.inp").write_text(nodes_deck())
    agrees(import_body([tmp_path / "x_STIF2.mtx", tmp_path / "x.inp"]))


def test_matrix_output_by_coordinates_needs_nodes(tmp_path: Path) -> None:
    text = "".join(f"{i + 1}, {j + 1}, {stiffness()[i, j]:.15e}\n" for i in range(18) for j in range(i + 1))
    (tmp_path / "x_STIF1.mtx").write_text(text)
    (tmp_path / "nodes.csv").write_text("name,x_m,y_m,z_m\n" + "".join(
        f"{number},{x:.17g},{y:.17g},{z:.17g}\n" for number, (x, y, z) in zip(NUMBERS, POSITIONS_M)))
    agrees(import_body([tmp_path / "x_STIF1.mtx", tmp_path / "nodes.csv"]))
    with failing("matrix_without_labels", rows=18, file="x_STIF1.mtx"):
        import_body([tmp_path / "x_STIF1.mtx"])


def user_element(matrix: np.ndarray, numbers: Sequence[int] = NUMBERS) -> str:
    made = ["** a comment\n*USER ELEMENT, NODES=     3, LINEAR\n** ELEMENT NODES\n** " + ", ".join(map(str, numbers)),
            "   1,   2,   3,   4,   5,   6", "*MATRIX,TYPE=STIFFNESS"]
    for i in range(len(matrix)):
        values = [f"{value:22.15E}" for value in matrix[i, :i + 1]]
        made += [",".join(values[at:at + 4]) for at in range(0, len(values), 4)]
    return "\n".join(made) + "\n*END\n"


def test_user_element(tmp_path: Path) -> None:
    (tmp_path / "x.mtx").write_text(user_element(stiffness()))
    (tmp_path / "x.inp").write_text(nodes_deck(directions=False))
    agrees(import_body([tmp_path / "x.mtx", tmp_path / "x.inp"]))


def test_units_of_files_are_converted(tmp_path: Path) -> None:
    scale = np.tile([1.0] * 3 + [1e3] * 3, 3)  # N, mm: N/mm, N and N mm
    (tmp_path / "x.mtx").write_text(user_element(stiffness() * np.outer(scale, scale) / 1e3))
    (tmp_path / "x.inp").write_text("*NODE\n" + "".join(
        f"{number},{x * 1e3:.17g},{y * 1e3:.17g},{z * 1e3:.17g}\n" for number, (x, y, z) in zip(NUMBERS, POSITIONS_M)))
    agrees(import_body([tmp_path / "x.mtx", tmp_path / "x.inp"], units=Units(1e-3)))


def test_loads_become_free_shapes(tmp_path: Path) -> None:
    shape = np.hstack([23e-6 * POSITIONS_M, np.zeros((3, 3))]).ravel()
    loads = stiffness() @ shape
    head = f"DMIG    PAX     {0:8d}{9:8d}{2:8d}{0:8d}{'':16s}{1:8d}\nDMIG*   PAX             {1:16d}{0:16d}\n"
    rows = "".join(f"*       {node:16d}{k:16d}{value:16.9E}\n" for (node, k), value in zip(LABELS, loads) if value)
    (tmp_path / "x.pch").write_text(dmig(stiffness()) + grids(0) + head + rows)
    body = import_body([tmp_path / "x.pch"], load="PAX", pattern_names=["warm"])
    assert body.measured.load_resultant is not None and body.measured.load_resultant < 1e-8
    rest = body.free_shapes[0] - shape
    motion = np.linalg.lstsq(body.rigid_motions, rest, rcond=None)[0]
    assert np.abs(rest - body.rigid_motions @ motion).max() < 1e-7 * np.abs(shape).max()
    with failing("matrix_load_columns", columns=1, names=2):
        import_body([tmp_path / "x.pch"], load="PAX", pattern_names=["warm", "cold"])
    with failing("matrix_unknown", key="load", value="PAY"):
        import_body([tmp_path / "x.pch"], load="PAY", pattern_names=["warm"])


def test_ignored_displacement_system_is_named(tmp_path: Path) -> None:
    (tmp_path / "x.pch").write_text(dmig(in_system(), free=True) + grids(0))
    with failing("body_axes", node="11", other="3", file="x.pch"):
        import_body([tmp_path / "x.pch"])
    agrees(import_body([tmp_path / "x.pch"], systems={11: 5}), 1e-12)


def test_what_no_free_body_has_is_refused(tmp_path: Path) -> None:
    held = in_system() + np.diag([1e36] + [0.0] * 17)
    (tmp_path / "x_STIF1.mtx").write_text(entries(held, ","))
    with failing("matrix_held", node=3):
        import_body([tmp_path / "x_STIF1.mtx"])
    (tmp_path / "y_STIF1.mtx").write_text(entries(in_system(), ",").replace("20,", "-20,"))
    with failing("matrix_inner_nodes", node=-20):
        import_body([tmp_path / "y_STIF1.mtx"])
    (tmp_path / "z_LOAD1.mtx").write_text("1,1,1.0\n")
    with failing("matrix_other_kind", kind="LOAD"):
        import_body([tmp_path / "z_LOAD1.mtx"])
    (tmp_path / "c.mtx").write_text("*USER ELEMENT,NODES=  2,LINEAR\n** 1,1,\n 1\n2, 2\n*MATRIX,TYPE=STIFFNESS\n0.1E1,\n0.,0.1E1\n")
    with failing("matrix_of_calculix"):
        import_body([tmp_path / "c.mtx"])


def test_incomplete_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "x.pch").write_text(dmig(stiffness()))
    with failing("matrix_node_missing", node=3):
        import_body([tmp_path / "x.pch"])
    (tmp_path / "y.pch").write_text(grids())
    with failing("matrix_missing", known="none"):
        import_body([tmp_path / "y.pch"])
    (tmp_path / "x.op4").write_text(text_op4(stiffness(), "dense"))
    (tmp_path / "z.pch").write_text(externals(1) + grids())
    with failing("matrix_labels_count", rows=18, labels=19):
        import_body([tmp_path / "x.op4", tmp_path / "z.pch"])
    (tmp_path / "t.op4").write_text(text_op4(stiffness(), "dense")[:5000])
    with failing("matrix_file_damaged", form="an op4 file"):
        import_body([tmp_path / "t.op4"])
    with failing("file_not_found"):
        import_body([tmp_path / "none.op4"])


def test_fields_of_dmig_are_cut_by_columns(tmp_path: Path) -> None:
    (tmp_path / "x.pch").write_text(
        "DMIG    KAAX           0       6       2       0                               1\n"
        "DMIG*   KAAX                           1               1                       2\n"
        "*                      1               1 1.000000000D+00                       3\n"
        "*                      3               5-2.500000000D+03                       4\n"
        "DMIG    KAAX    3       5               3       5       1.45+8\n"
        "                                        9       0       -2.5-3\n"
        "DMIG,KAAX,9,0,,9,0,7.5\n"
        "DMIG    CAAX           0       6       4       0\n"
        "DMIG    CAAX    1       1               1       1       1.0     2.0\n")
    content = bulk.read([tmp_path / "x.pch"])
    assert list(content.matrices) == ["KAAX"]
    found = content.matrices["KAAX"]
    assert found.rows == found.columns == ((1, 1), (3, 5), (9, 0))
    assert found.values.tolist() == [[1.0, -2500.0, 0.0], [-2500.0, 1.45e8, -2.5e-3], [0.0, -2.5e-3, 7.5]]


def test_contradicting_entries_are_refused(tmp_path: Path) -> None:
    (tmp_path / "x.pch").write_text("DMIG,KAAX,0,1,2,0\nDMIG,KAAX,1,1,,1,1,1.0\nDMIG,KAAX,1,1,,1,1,2.0\n")
    with failing("matrix_entry_twice", matrix="KAAX", row=[1, 1], column=[1, 1]):
        import_body([tmp_path / "x.pch"])
