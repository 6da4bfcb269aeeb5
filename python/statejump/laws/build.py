# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of the user: a header, compiled with the kernel into a shared object, which programs find by the law's name."""
from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from statejump import _engine
from statejump._paths import EIGEN_INCLUDE, KERNEL_INCLUDE
from statejump.core.errors import NotWritten, StatejumpError, Unreadable
from statejump.core.output import write_bytes
from statejump.core.reading import is_file

COMPILERS = ("c++", "g++", "clang++")
# The compiler flags of the project, so that results are bitwise equal. Hidden symbols do not replace functions of the
# program.
FLAGS = ("-std=c++17", "-O2", "-fPIC", "-shared", "-ffp-contract=off", "-fvisibility=hidden")
SOURCE = """\
#include {header}

#include "statejump/kernel/laws/user_law.hpp"

extern "C" __attribute__((visibility("default"))) const statejump::kernel::laws::UserLawTable*
statejump_user_law() {{
  return statejump::kernel::laws::user_law_table<::UserLaw>("{kernel}");
}}
"""


def default_folder() -> Path:
    """Return the user's folder of laws, which programs search last: ``~/.local/share/statejump/laws``."""
    return Path(_engine.user_law_folders()[-1])


def build(header: Path, folder: Path | None = None) -> Path:
    """Compile the law in a header, and write the shared object to a folder that programs search.

    The header defines a type like those of the catalogue, and declares it as ``using UserLaw = ...;``. Its own includes
    are searched beside it and in the kernel.

    :param header: file of the law
    :param folder: folder of the shared object; None: :func:`default_folder`. Another folder is searched if
        ``$STATEJUMP_LAWS`` lists it.
    :return: path of the shared object, ``<kind>_<name>.so``; it replaces an older one of that name
    :raises StatejumpError: the header does not exist, there is no compiler, the kernel headers differ from those of
        this build, the header does not compile (with the compiler's first error), or the law is unusable
    """
    header = Path(header)
    if not is_file(header):
        raise Unreadable(code="header_file_missing", file=header)
    compiler = find_compiler()
    kernel = kernel_hash(KERNEL_INCLUDE)
    if kernel != _engine.kernel_hash():
        raise StatejumpError(code="other_headers", file=KERNEL_INCLUDE)
    folder = default_folder() if folder is None else Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix="statejump-law-") as scratch:
            made = compile_law(compiler, header.resolve(), kernel, Path(scratch))
            found = _engine.inspect_user_law(str(made))
            if found["problem"]:
                raise StatejumpError(found["problem"].replace(str(made), str(header)), code="bad_law", file=header)
            target = folder / f"{found['kind']}_{found['name']}.so"
            write_bytes(target, made.read_bytes())
    except OSError as error:
        raise NotWritten(code="write_failed", cause=error.strerror, file=folder) from None
    _engine.load_user_laws()
    return target


def find_compiler() -> str:
    """Return the C++ compiler, preferably ``$CXX``. :raises StatejumpError: there is none"""
    wanted = os.environ.get("CXX")
    for name in (wanted,) if wanted else COMPILERS:
        found = shutil.which(name)
        if found:
            return found
    if wanted:
        raise StatejumpError(code="compiler_not_run", key="CXX", value=wanted, compiler=wanted)
    raise StatejumpError(code="no_compiler", compilers=", ".join(COMPILERS))


def compile_law(compiler: str, header: Path, kernel: str, folder: Path) -> Path:
    """Compile a header; return the path of the shared object. :raises StatejumpError: the header does not compile"""
    source, made = folder / "law.cpp", folder / "law.so"
    name = str(header).replace("\\", "\\\\").replace('"', '\\"')
    source.write_text(SOURCE.format(header=f'"{name}"', kernel=kernel), encoding="utf-8")
    done = subprocess.run(
        [compiler, *FLAGS, f"-I{header.parent}", f"-I{KERNEL_INCLUDE}", "-isystem", str(EIGEN_INCLUDE), str(source),
         "-o", str(made)],
        stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, env={**os.environ, "LC_ALL": "C"},
    )
    if done.returncode != 0:
        lines = done.stderr.splitlines() or [f"{compiler} ended with status {done.returncode}"]
        first = next((line for line in lines if "error" in line), lines[0])
        for known in (header.parent, folder, KERNEL_INCLUDE):
            first = first.replace(f"{known}{os.sep}", "")
        raise StatejumpError(code="law_does_not_compile", cause=first, header=header.name)
    return made


def kernel_hash(include: Path) -> str:
    """Return the hash of the kernel headers in a folder, as cmake/KernelHash.cmake computes it."""
    lines = ""
    for path in sorted(path.relative_to(include).as_posix() for path in include.glob("statejump/kernel/**/*.hpp")):
        lines += f"{path} {hashlib.sha256((include / path).read_bytes()).hexdigest()}\n"
    return hashlib.sha256(lines.encode()).hexdigest()
