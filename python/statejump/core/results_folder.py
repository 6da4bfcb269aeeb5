# SPDX-License-Identifier: GPL-3.0-or-later
"""Results folder of a run. One run at a time uses it, and gets all of its files into it or none.

A run locks the folder and writes into its subfolder ``.ID.partial``. When all files are complete and on disk, the run
renames the subfolder to ``.ID.ready``, and moves the files to their final paths. After a kill, the next run in the
folder moves the remaining files of ``.ID.ready`` and removes ``.ID.partial``.
"""
from __future__ import annotations

import fcntl
import hashlib
import json
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from statejump.core.errors import NotWritten, size
from statejump.core.output import PARTIAL, check_target, not_written, synced, unique
from statejump.core.tables import write_json
from statejump.schema.fields import attached_to_json

if TYPE_CHECKING:
    from statejump.core.case import Case

READY = ".ready"
SYNCED_AT_ONCE = 32
SIDE_BY_SIDE = 8  # number of files from which threads save time
OTHER = "choose another with --results"
OWNER = ".case.json"


@dataclass(frozen=True)
class Results:
    """Root of the results, and options for the folders in it.

    :param root: folder that contains one folder per case
    :param wait: whether to wait for another run in the same folder, instead of being refused
    :param force: whether to replace results of another case
    """

    root: Path
    wait: bool = False
    force: bool = False

    @contextmanager
    def folder(self, name: str, case: Case | None = None) -> Iterator[ResultsFolder]:
        """Create (if needed), lock and yield ``root/name``. At the end, remove unpublished files and empty new folders.

        :param case: the case of the results; None: the folder has the name of a file
        :raises NotWritten: the folder is not writable, another run uses it, or it contains results of another case
        """
        path = self.root / name
        missing = [folder for folder in (path, *path.parents) if not os.path.exists(folder)]
        try:
            with self._held(path, case, path in missing) as found:
                yield found
        finally:
            for folder in missing[1:]:
                with suppress(OSError):  # not empty, or another run removed it
                    os.rmdir(folder)

    @contextmanager
    def _held(self, path: Path, case: Case | None, made: bool) -> Iterator[ResultsFolder]:
        """Lock and yield a folder; the implementation of :meth:`folder`.

        :param made: whether the folder is new; a new folder is removed if it stays empty
        """
        try:
            descriptor = self._locked(path)
        except OSError as error:
            raise _unusable(path, "write_failed", OTHER, error.strerror or str(error)) from None
        try:
            if case is not None and not self.force:
                for folder in (path, *path.parents)[:len(path.relative_to(self.root).parts)]:
                    _check_owner(folder, case)
            try:
                _recover(path)
                own = path / f".{unique()}{PARTIAL}"
                own.mkdir()
            except OSError as error:
                raise _unusable(path, "write_failed", OTHER, error.strerror or str(error)) from None
            found = ResultsFolder(path, own, case)
            try:
                yield found
            finally:
                _remove(found.staged, ignore_errors=True)
        finally:
            if made:  # while the lock is held, because another run may be about to write into it
                with suppress(OSError):
                    os.rmdir(path)
            os.close(descriptor)

    def _locked(self, path: Path) -> int:
        """Return an open descriptor of the folder that holds its lock, which ends with the process."""
        while True:
            path.mkdir(parents=True, exist_ok=True)
            try:
                descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
            except FileNotFoundError:  # another run, which wrote nothing, removed it
                continue
            try:
                try:
                    fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if self.wait else fcntl.LOCK_NB))
                except BlockingIOError:
                    raise _unusable(path, "folder_in_use", f"wait for it with --wait, or {OTHER}") from None
                with suppress(FileNotFoundError):
                    if os.path.samestat(os.fstat(descriptor), os.stat(path)):
                        return descriptor
            except BaseException:
                os.close(descriptor)
                raise
            os.close(descriptor)  # the folder was deleted while this run waited


@dataclass
class ResultsFolder:
    """A locked results folder.

    :param path: the folder that users read
    :param staged: folder of files that are not published yet
    :param case: case of the results; None: the results belong to no case
    """

    path: Path
    staged: Path
    case: Case | None = None

    def check_space(self, needed_bytes: float) -> None:
        """Raise NotWritten if the file system lacks the needed bytes."""
        room = os.statvfs(self.path)
        free = room.f_bavail * room.f_frsize
        if needed_bytes > free:
            raise _unusable(self.path, "no_space_left", OTHER, needed=size(needed_bytes), free=size(free))

    def publish(self, written: Sequence[Path] = ()) -> list[Path]:
        """Publish all staged files at once; return the paths to which they move.

        Further files can be staged and published afterwards.

        :raises NotWritten: the files could not be synced to disk, and none is published; or a file could not be moved
        """
        ready = self.path / f"{self.staged.name.removesuffix(PARTIAL)}{READY}"
        if self.case is not None:
            _write_owner(self.staged, self.path, self.case)
        try:
            folders = [(Path(folder), files) for folder, _, files in os.walk(self.staged)]
            staged = [folder / name for folder, files in folders for name in files]
            for file in staged:
                check_target(self.path / file.relative_to(self.staged))
            _sync([*staged, *(folder for folder, _ in folders)])
            os.rename(self.staged, ready)
        except OSError as error:
            raise not_written(self.path, error) from None
        before, self.staged = self.staged, self.path / f".{unique()}{PARTIAL}"
        try:
            synced(self.path)
            _move(ready, self.path)
            self.staged.mkdir()
        except OSError as error:
            cause = error.strerror or str(error)
            if ready.exists():
                cause += f"; {ready.name} in it is complete, the next run in this folder moves what is left of it"
            raise _unusable(self.path, "write_failed", OTHER, cause) from None
        return [self.path / file.relative_to(before) if file.is_relative_to(before) else file for file in written]


def _sync(paths: Sequence[Path]) -> None:
    """Sync files and folders to disk, many of them in parallel, because file systems combine simultaneous calls."""
    if len(paths) < SIDE_BY_SIDE:  # the threads cost more than they save
        for path in paths:
            synced(path)
        return
    from concurrent.futures import ThreadPoolExecutor  # for sets of many files

    with ThreadPoolExecutor(SYNCED_AT_ONCE) as pool:
        list(pool.map(synced, paths))


def _move(ready: Path, path: Path) -> None:
    """Move complete files to their final paths and replace earlier ones."""
    for folder, _, files in os.walk(ready, topdown=False):
        place = path / Path(folder).relative_to(ready)
        place.mkdir(parents=True, exist_ok=True)
        for name in sorted(files):
            os.replace(Path(folder) / name, place / name)
        synced(place)
        os.rmdir(folder)


def _remove(folder: Path, ignore_errors: bool = False) -> None:
    """Remove a folder with its contents."""
    with suppress(OSError):
        return os.rmdir(folder)  # the folder is usually empty
    from shutil import rmtree  # loads what packs archives

    rmtree(folder, ignore_errors=ignore_errors)


def _recover(path: Path) -> None:
    """Move the published files of a killed run to their final paths, and remove its unpublished files."""
    for ready in sorted(path.glob(f".*{READY}")):
        _move(ready, path)
    for left in path.glob(f".*{PARTIAL}"):
        if left.is_dir():
            _remove(left)


def _unusable(path: Path, code: str, remedy: str, cause: str | None = None, **details: Any) -> NotWritten:
    return NotWritten(code=code, file=path, place=f"results folder {path}", cause=cause, remedy=remedy, **details)


def _known(folder: Path) -> dict[str, str]:
    """Return the record of which case owns a results folder; an empty dict if there is no readable record."""
    try:
        found = json.loads((folder / OWNER).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _file(folder: Path, case: Case) -> str:
    """Return the path of the case file relative to the results folder; "" if the case was made in Python."""
    file = case.origin.file
    return "" if file is None else os.path.relpath(file.resolve(), folder.resolve())


def _checksum(case: Case) -> str:
    text = json.dumps(case.with_defaults(), sort_keys=True, default=attached_to_json)
    return hashlib.sha256(text.encode()).hexdigest()


def _check_owner(folder: Path, case: Case) -> None:
    """Raise NotWritten if the folder contains results of another case that comes from another file."""
    known = _known(folder)
    if not known or (known.get("file") and known.get("file") == _file(folder, case)):
        return
    if known.get("sha256") == _checksum(case):
        return
    other = os.path.relpath(folder / str(known.get("file"))) if known.get("file") else "a case made in Python"
    raise NotWritten(code="results_of_other_case", place=f"results folder {folder}", file=folder, other=other)


def _write_owner(staged: Path, folder: Path, case: Case) -> None:
    """Write the owner's file of a folder among its staged files."""
    write_json(staged / OWNER, {"file": _file(folder, case), "sha256": _checksum(case)})
