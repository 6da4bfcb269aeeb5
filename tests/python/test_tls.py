# SPDX-License-Identifier: GPL-3.0-or-later
"""Clusters under TLS, set up as in docs/security.md. Scheduler, worker and command run on this machine, each with its
own certificate. A process without a certificate, or with one of another authority, is refused."""
from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from conftest import BUILT, COMMAND, REPOSITORY
from failures import failure

pytest.importorskip("distributed")
pytestmark = pytest.mark.skipif(shutil.which("openssl") is None, reason="makes the certificates")

PARTS = ("scheduler", "worker", "client")


def certificates(folder: Path) -> Path:
    """Make a certificate authority and a certificate for each process; return Dask's configuration of docs/security.md.
    """
    folder.mkdir()

    def openssl(*words: str) -> None:
        subprocess.run(["openssl", *words], cwd=folder, check=True, capture_output=True)

    new = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes")
    openssl("req", "-x509", *new, "-keyout", "ca-key.pem", "-out", "ca.pem", "-subj", "/CN=authority", "-days", "1")
    for part in PARTS:
        openssl("req", *new, "-keyout", f"{part}-key.pem", "-out", f"{part}.csr", "-subj", f"/CN={part}")
        openssl("x509", "-req", "-in", f"{part}.csr", "-CA", "ca.pem", "-CAkey", "ca-key.pem", "-CAcreateserial", "-out",
                f"{part}.pem", "-days", "1")
    page = (REPOSITORY / "docs" / "security.md").read_text(encoding="utf-8")
    found = re.search(r"```yaml\n(.*?)```", page, re.DOTALL)
    assert found is not None
    (folder / "tls.yaml").write_text(found[1].replace("/etc/statejump", str(folder)))
    return folder


def environment(configuration: Path | None, folder: Path) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(BUILT), "TMPDIR": str(folder),
            "DASK_CONFIG": str(configuration or folder / "none")}


@pytest.fixture
def scheduler(tmp_path: Path) -> Iterator[tuple[str, Path]]:
    """Start scheduler and worker; yield the address and the configuration."""
    configuration, told = certificates(tmp_path / "tls"), tmp_path / "scheduler.json"
    around = environment(configuration, tmp_path)
    started = []
    with (tmp_path / "log").open("wb") as log:
        def start(module: str, *words: str) -> None:
            started.append(subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.{module}", *words], cwd=tmp_path, env=around, stdout=log,
                stderr=log))

        start("dask_scheduler", "--protocol", "tls", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
              "--scheduler-file", str(told))
        try:
            end = time.monotonic() + 120
            while not told.exists() or not told.read_text():
                assert time.monotonic() < end and started[0].poll() is None, (tmp_path / "log").read_text()
                time.sleep(0.1)
            address = json.loads(told.read_text())["address"]
            start("dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1")
            yield address, configuration
        finally:
            for process in started:  # killed: a worker of newer releases goes on asking for a scheduler that has ended
                process.kill()
                process.wait(timeout=60)


def sweep(cases: Path, folder: Path, configuration: Path | None, *words: str,
          command: tuple[str, ...] = ("sweep",)) -> subprocess.CompletedProcess[str]:
    campaign = (cases / "campaigns/table1_friction.toml").read_text().replace("../table1.toml", f"{cases}/table1.toml")
    (folder / "campaign.toml").write_text(campaign)
    return subprocess.run([COMMAND, *command, "campaign.toml", "--quiet", *words], cwd=folder, text=True, timeout=200,
                          env=environment(configuration, folder), capture_output=True, stdin=subprocess.DEVNULL)


def test_campaign_over_tls(cases: Path, tmp_path: Path, scheduler: tuple[str, Path]) -> None:
    address, configuration = scheduler
    assert address.startswith("tls://127.0.0.1:")
    for name, words in (("over", ("--scheduler", address)), ("here", ())):
        (tmp_path / name).mkdir()
        done = sweep(cases, tmp_path / name, configuration, *words)
        assert (done.returncode, done.stderr) == (0, ""), done.stderr
    table = "results/campaign_table1_friction/samples.csv"
    assert (tmp_path / "over" / table).read_bytes() == (tmp_path / "here" / table).read_bytes()
    # Neither without a certificate, nor with one that is not there or that another authority signed, nor without TLS.
    others, gone = certificates(tmp_path / "others"), certificates(tmp_path / "gone")
    (gone / "client-key.pem").unlink()
    plain = address.replace("tls", "tcp")
    for place, (its, asked, code) in enumerate((
        (None, address, "scheduler_without_certificates"), (gone, address, "scheduler_without_certificates"),
        (others, address, "scheduler_not_reached"), (None, plain, "scheduler_not_reached"),
        (configuration, plain, "scheduler_not_encrypted"),
    )):
        (tmp_path / str(place)).mkdir()
        done = sweep(cases, tmp_path / str(place), its, "--scheduler", asked, command=("--json", "sweep"))
        assert failure(code, key="--scheduler", value=asked) == done.stderr
        assert ("distributed.comm.tls" in done.stderr) == (place == 0), done.stderr
        assert done.returncode == 2 and done.stderr.count("\n") == 1, done.stderr
