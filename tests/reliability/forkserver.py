# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a command many times without starting Python each time. A server, which has loaded the modules of the command,
forks for every run. The fork executes the command's own launcher, in a separate process group, and exits like the
command.

    forkserver.py LAUNCHER        requests and answers are lines of JSON on standard input and output
"""
from __future__ import annotations

import importlib
import json
import os
import runpy
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

LOADED = "FORKSERVER_LOADED"  # file that gets what a run has loaded, and from where


@dataclass(frozen=True)
class Ended:
    """End of a run: its status as in ``subprocess``, and its standard error."""

    returncode: int
    stderr: str


class Forkserver:
    """Context manager that starts the server and sends requests to it.

    :param launcher: the command, a Python program
    :param environment: variables of the server and of all runs
    :param folder: receives the output of runs
    """

    def __init__(self, launcher: Path, environment: Mapping[str, str], folder: Path) -> None:
        self._said = folder / "said"
        self._server = subprocess.Popen(
            [sys.executable, str(Path(__file__).resolve()), str(launcher)], env=dict(environment), text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )

    def __enter__(self) -> Forkserver:
        return self

    def __exit__(self, *ignored: Any) -> None:
        assert self._server.stdin is not None
        self._server.stdin.close()
        self._server.wait(timeout=60)

    def _ask(self, request: dict[str, Any]) -> int:
        assert self._server.stdin is not None
        self._server.stdin.write(json.dumps(request) + "\n")
        self._server.stdin.flush()
        return self._answer()

    def _answer(self) -> int:
        assert self._server.stdout is not None
        return int(json.loads(self._server.stdout.readline()))

    def load(self, folder: Path, words: Sequence[str]) -> None:
        """Run the command once in the server, which thereby loads its modules."""
        names = folder / "loaded"
        self.run(folder, words, {LOADED: str(names)})
        self._ask({"load": json.loads(names.read_text(encoding="utf-8"))})
        names.unlink()

    def run(
        self, folder: Path, words: Sequence[str], more: Mapping[str, str], kill_after_s: float | None = None
    ) -> Ended:
        """Run the command.

        :param folder: working folder
        :param more: environment variables besides those of the server
        :param kill_after_s: time until its process group is killed [s]
        """
        pid = self._ask({"folder": str(folder), "words": list(words), "more": dict(more), "said": str(self._said)})
        if kill_after_s is not None:
            time.sleep(kill_after_s)
            with suppress(ProcessLookupError):  # it may have ended
                os.killpg(pid, signal.SIGKILL)
        return Ended(self._answer(), self._said.read_text(encoding="utf-8", errors="replace"))


def _becomes(launcher: str, request: dict[str, Any]) -> None:
    """Be the command; ends with SystemExit."""
    os.environ.update(request["more"])
    os.chdir(request["folder"])
    for number, file, flags in ((0, os.devnull, os.O_RDONLY), (1, os.devnull, os.O_WRONLY),
                                (2, request["said"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC)):
        descriptor = os.open(file, flags, 0o666)
        os.dup2(descriptor, number)
        os.close(descriptor)
    # As `env --block-signal` of the launcher's first line.
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM, signal.SIGHUP})
    sys.argv = [launcher, *request["words"]]
    try:
        runpy.run_path(launcher, run_name="__main__")
    finally:
        if LOADED in os.environ:
            Path(os.environ[LOADED]).write_text(json.dumps([sys.path, sorted(sys.modules)]), encoding="utf-8")


def _serve(launcher: str) -> None:
    with open(os.dup(1), "w", encoding="utf-8") as answers:
        for line in sys.stdin:
            request = json.loads(line)
            if "load" in request:
                sys.path[:], names = request["load"]
                for name in names:
                    with suppress(Exception):  # names that cannot be loaded by themselves
                        importlib.import_module(name)
                if threading.active_count() > 1:
                    raise RuntimeError(f"a fork would lose threads: {threading.enumerate()}")
                print(0, file=answers, flush=True)
                continue
            pid = os.fork()
            if pid == 0:
                _becomes(launcher, request)
            with suppress(OSError):
                os.setpgid(pid, pid)  # before anybody is told of it
            print(pid, file=answers, flush=True)
            print(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), file=answers, flush=True)


if __name__ == "__main__":
    _serve(sys.argv[1])
