# SPDX-License-Identifier: GPL-3.0-or-later
"""Console output of commands: if writing to the console fails, the run and its files are still complete, and the exit
status is that of the run. Status 1 means only that a tolerance is missed."""
from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from conftest import COMMAND, results_in
from failures import failure
from statejump import load
from statejump.cli import streams
from statejump.core import errors
from statejump.core.errors import StatejumpError, printable
from statejump.core.pace import WARNING, show_pace, shown_by
from statejump.core.progress import console
from statejump.core.tables import write_markdown

FILES = ["reduced.h5", "reduced_history.csv"]


def shell(line: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a line of the shell in which ``statejump`` is the command under test."""
    return subprocess.run(
        ["bash", "-c", f'statejump() {{ "{COMMAND}" "$@"; }}\n{line}'], cwd=folder, text=True, timeout=200,
        env={**os.environ, **environment}, capture_output=True, stdin=subprocess.DEVNULL, errors="replace",
    )


def written(folder: Path) -> list[str]:
    return results_in(folder / "results" / "table1")


@pytest.mark.parametrize("output, status, said", [
    ("| head -c 1 > /dev/null; exit ${PIPESTATUS[0]}", 0, ""),
    ("| true; exit ${PIPESTATUS[0]}", 0, ""),
    (">&-", 0, ""), ("2>&-", 0, ""), (">&- 2>&- <&-", 0, ""), ("2>/dev/full", 0, ""),
    (">/dev/full", 2, f"error: {StatejumpError(code='standard_output_not_written', cause=os.strerror(errno.ENOSPC))}\n"),
])
def test_run_survives_what_becomes_of_its_output(cases: Path, tmp_path: Path, output: str, status: int, said: str) -> None:
    done = shell(f"statejump reduced {cases}/table1.toml {output}", tmp_path)
    assert (done.returncode, done.stderr) == (status, said)
    assert written(tmp_path) == FILES


@pytest.mark.parametrize("where", ["2>&-", "2>/dev/full", "2> >(true)"])
def test_failure_keeps_its_status_where_nobody_hears_it(tmp_path: Path, where: str) -> None:
    for words in ("reduced nowhere.toml", "--json reduced nowhere.toml", "frobnicate"):
        assert shell(f"statejump {words} {where}", tmp_path).returncode == 2, words


@pytest.mark.parametrize("environment", [
    {"PYTHONIOENCODING": "ascii"}, {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    {"MPLBACKEND": "nonsense"}, {"TERM": "nonsense"}, {"COLUMNS": "x"},
], ids=lambda given: "-".join(given))
def test_run_survives_its_environment(cases: Path, tmp_path: Path, environment: dict[str, str]) -> None:
    (tmp_path / "time 1-2 s.toml").write_text((cases / "table1.toml").read_text())
    done = shell("statejump reduced 'time 1-2 s.toml'; statejump laws --quiet", tmp_path, **environment)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    assert "state jump: 2.38095" in done.stdout and written(tmp_path) == FILES
    refused = shell("statejump --json reduced 'time 1-2 s ΔT.toml'", tmp_path, **environment)
    assert refused.returncode == 2 and refused.stderr.count("\n") == 1
    assert failure("case_file_not_found") == refused.stderr


def test_folder_that_was_deleted(cases: Path, tmp_path: Path) -> None:
    done = shell(f"mkdir gone && cd gone && rmdir ../gone && statejump --json dem {cases}/table1.toml --results {tmp_path}", tmp_path)
    assert done.returncode == 2
    assert failure("working_folder_gone") == done.stderr


def test_home_that_is_not_set(cases: Path, tmp_path: Path, fake_yade) -> None:
    """YADE does not start without; it gets its own temporary folder."""
    yade = fake_yade('test -d "$HOME" || exit 7\ntest "$HOME" = "$TMPDIR" || exit 8\nexit 9\n')
    done = shell(f"unset HOME; statejump --json dem {cases}/table1.toml", tmp_path, STATEJUMP_YADE=yade)
    assert failure("yade_ended", status=9) == done.stderr


@pytest.mark.parametrize("number, status", [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)])
@pytest.mark.parametrize("delay_s", [0.0, 0.1, 0.4])
def test_signal_while_it_starts(cases: Path, tmp_path: Path, number: int, status: int, delay_s: float) -> None:
    # A first byte of standard input is waited for, so that the command cannot be over before it is signalled.
    os.mkfifo(tmp_path / "pipe.toml")
    run = subprocess.Popen([COMMAND, "reduced", "/dev/stdin"], cwd=tmp_path, text=True, stdin=subprocess.PIPE,
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    with pytest.raises(subprocess.TimeoutExpired):
        run.wait(timeout=0.05 + delay_s)
    run.send_signal(number)
    _, said = run.communicate(timeout=60)
    assert run.returncode in (status, -number) and "Traceback" not in said
    assert run.returncode == status or number != signal.SIGINT
    # click begins a line after the ^C of a terminal, if it is there already when the signal comes.
    assert said.removeprefix("\n") == ("interrupted\n" if number == signal.SIGINT else "")


@pytest.mark.parametrize("number, status", [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize("phase", ["path", "contributions", "sensitivities"])
def test_signal_while_the_engine_is_at_work(
    cases: Path, tmp_path: Path, number: int, status: int, phase: str
) -> None:
    """The engine passes a signal on to Python; a path interrupted by a signal gives no result."""
    run = subprocess.Popen(
        [COMMAND, "--json", "truss", "answers", str(cases / "trusses/ring_12.toml")], cwd=tmp_path, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    assert run.stdout is not None
    for line in run.stdout:
        if phase in line:
            break
    run.send_signal(number)
    _, said = run.communicate(timeout=200)
    assert run.returncode == status, said
    assert failure("interrupted") == said if number == signal.SIGINT else said == ""
    assert not (tmp_path / "results").exists()


def test_internal_fault_has_a_status_of_its_own(tmp_path: Path) -> None:
    """An internal error has its own exit status, also during the report of a failure or before reporting is set up."""
    launcher = Path(COMMAND).read_text()
    for broken in ("import statejump.cli.main as cli; cli._report_failure = None; cli.cli = None", "raise MemoryError"):
        script = tmp_path / "broken.py"
        script.write_text(launcher.replace("from statejump.cli.main import main", f"{broken}\nfrom statejump.cli.main import main"))
        done = subprocess.run([sys.executable, str(script), "reduced", "x"], capture_output=True, text=True)
        assert done.returncode == errors.INTERNAL_STATUS and "Traceback" in done.stderr


ODD = "a\x1b[31mred\x9b1m\x07\x00"


@pytest.mark.parametrize("key", ["title", "source"])
def test_control_characters_are_refused_in_texts(cases: Path, key: str) -> None:
    with pytest.raises(errors.NotAllowed) as refused:
        load(cases / "table1.toml").changed({f"case.{key}": ODD})
    assert refused.value == failure("control_characters", key=f"case.{key}", value=ODD)
    assert printable(str(refused.value)) == str(refused.value)


def test_control_characters_do_not_reach_the_terminal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from statejump.cli.terminal import print_table
    from statejump.core.tables import Shown

    shown = console(force_terminal=True, width=100, color_system=None)
    shown.print(ODD)
    print_table(Shown(ODD, (ODD, "b"), [(ODD, "1")]), shown)
    said = capsys.readouterr().out
    assert "\x1b[31m" not in said and "\x9b" not in said and "\x07" not in said and "\x00" not in said
    assert said.count("\\x1b[31mred") == 4
    done = subprocess.run([COMMAND, "reduced", "a\x1b[31m.toml"], capture_output=True, text=True, cwd=tmp_path)
    assert done.stderr.startswith("error: a\\x1b[31m.toml: ") and done.stderr.count("\n") == 1
    done = subprocess.run([COMMAND, "--json", "reduced", "a\x9b\x1b[31m.toml"], capture_output=True, text=True, cwd=tmp_path)
    assert "\x9b" not in done.stderr and json.loads(done.stderr)["file"] == "a\x9b\x1b[31m.toml"


def test_markdown_holds_no_html(tmp_path: Path) -> None:
    lines = ["# <script>alert(1)</script>", "a < 1, b <c>, <!-- -->, 1<2"]
    text = write_markdown(tmp_path / "a.md", lines).read_text()
    assert text == "# &lt;script>alert(1)&lt;/script>\na < 1, b &lt;c>, &lt;!-- -->, 1<2\n"


def test_stream_that_is_lost_is_lost_once(monkeypatch: pytest.MonkeyPatch) -> None:
    class Broken:
        encoding = "utf-8"

        def write(self, text: str) -> int:
            raise OSError(5, "Input/output error")

        def fileno(self) -> int:
            return 1000

    def none(*arguments: Any) -> None:
        pass

    monkeypatch.setattr(streams.os, "dup2", none)
    stream = streams.Stream(Broken())  # type: ignore[arg-type]
    assert stream.write("abc") == 3 and stream.lost is not None and stream.lost.errno == 5
    assert streams.Stream(None).write("abc") == 3


@pytest.mark.parametrize(("steps", "rate", "done", "lines"), [
    (1_000_000, 200_000.0, 0.0, []),  # 5 s need no line
    (1_107_200, 16_100.0, 0.11, ["1 110 000 steps, 16 100 steps/s, 61 s left"]),
    (60_000_000, 50_000.0, 0.5, ["60 000 000 steps, 50 000 steps/s, 10 min left"]),
    (26_000_000_000, 100_000.0, 0.0, ["2.6e+10 steps, 100 000 steps/s, 3 d left", WARNING]),
])
def test_pace_of_a_run(steps: int, rate: float, done: float, lines: list[str]) -> None:
    shown: list[str] = []
    show_pace(steps, rate, done)  # nobody looks
    with shown_by(shown.append):
        show_pace(steps, rate, done)
    assert shown == lines
