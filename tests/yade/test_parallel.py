# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenMP: two threads compute what one computes."""
import re

import pytest

from conftest import EPS


def test_two_threads_give_the_same_motion(run_script):
    one, two = (run_script("parallel.py", threads=n) for n in (1, 2))
    assert one["threads"] == 1 and two["threads"] == 2
    assert one["many"][0]["touching"] > 10
    assert one["many"][0]["energies"]["jointFriction"] > 0
    # Every body has one contact and one link: the sum 0 + a + b does not depend on which thread
    # added what, so the motion is the same bit for bit, in each repetition.
    for run in (one, two):
        for repetition in run["many"]:
            assert repetition["states"] == one["many"][0]["states"]


def test_two_threads_give_the_same_energies(run_script):
    one, two = (run_script("parallel.py", threads=n)["many"] for n in (1, 2))
    for repetition in (*one, *two):
        for name, value in one[0]["energies"].items():
            # Sums of 200 joints and 400 steps in another order.
            scale = max(abs(v) for v in one[0]["energies"].values())
            assert repetition["energies"][name] == pytest.approx(value, abs=80000 * EPS * scale)


@pytest.mark.parametrize("threads", [1, 2])
def test_failures_in_threads_become_one_sentence(run_script, threads):
    kind, text = run_script("parallel.py", threads=threads)["failing"]
    assert kind == "RuntimeError" and re.fullmatch(r"clearance_closed journal = 0.0051 \(contact \d+ \d+\)", text)
