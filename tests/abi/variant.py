#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compiles the interface declarations of one YADE variant with their static assertions. Compares virtual function
tables of derived classes with the measured tables; YADE is not needed. Also compiles the plugin sources whose base
classes differ between variants."""
from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))

from yade_interface import binary, variants  # noqa: E402

# They inherit from Shape and from FrictPhys.
INHERITING = ["contact_parts.cpp", "shapes.cpp"]


def main() -> int:
    """Compile and compare; return 0 if everything equals the measurements."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("variant")
    parser.add_argument("--compiler", required=True)
    parser.add_argument("--repository", required=True, type=Path)
    parser.add_argument("--generated", required=True, type=Path, help="folder of measured_layout.inc")
    parser.add_argument("--include", action="append", default=[], help="Eigen, Python")
    options = parser.parse_args()
    laws = options.repository / "contact_laws"
    command = [options.compiler, "-std=c++17", "-O0", "-fPIC", "-w", "-DEIGEN_DONT_ALIGN", "-DEIGEN_DONT_VECTORIZE",
               "-DEIGEN_DISABLE_UNALIGNED_ARRAY_ASSERT", f"-DSTATEJUMP_YADE_VARIANT={options.variant}",
               f"-I{options.generated}", f"-I{laws / 'yade_abi' / 'include'}", f"-I{laws / 'yade'}",
               f"-I{laws / 'kernel' / 'include'}", f"-I{laws / 'stepper' / 'include'}",
               f"-I{options.repository / 'geometry' / 'include'}", f"-I{options.repository / 'thermal' / 'include'}",
               *(f"-isystem{path}" for path in options.include)]
    for name in INHERITING:
        subprocess.run([*command, "-fsyntax-only", str(laws / "yade" / name)], check=True)
    with tempfile.TemporaryDirectory(prefix="statejump-variant-") as folder:
        path = Path(folder) / "declared.so"
        subprocess.run([*command, "-shared", str(laws / "yade_abi" / "src" / "declared.cpp"), "-o", str(path)],
                       check=True)
        library = binary.Library(path)
    wrong = 0
    measured, = (one for one in variants.known() if one.name == options.variant)
    for name, expected in measured.tables.items():
        theirs = f"4yade{len(name)}{name}"
        child = f"9statejump8yade_abi9DoNothingIN{theirs}EE"
        found = [entry.replace(child, theirs)
                 for entry in binary.Libraries.entries(library, library.by_name[f"_ZTVN{child}E"])]
        for i in range(max(len(found), len(expected))):
            pair = [one[i] if i < len(one) else "nothing" for one in (found, expected)]
            if pair[0] != pair[1]:
                print(f"entry {i} of the table of {name}: declared {pair[0]}, measured {pair[1]}")
                wrong += 1
    print(f"variant {options.variant} compiles with its static assertions; {len(measured.tables)} tables, "
          f"{sum(map(len, measured.tables.values()))} entries compared, {wrong} differ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
