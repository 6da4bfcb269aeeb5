# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene of the paper's Table 1 (1-D clearance joint) in a short orbit, compared with the closed forms."""
import pytest

K = 70e9 * 9e-6 / 0.5
JUMP = 30.0 / K  # f l0 / (E A), 23.80952 um


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("slider.py")


def first(rows, condition):
    return next(row for row in rows if condition(row))


def test_state_jump(seen):
    rows = seen["friction"]["rows"]
    # 100 000 roundings of a time up to 0.5 s, 1e-11 s, at 628 K/s.
    assert abs(rows[-1][0]) < 1e-8
    # It ends sliding, where the jump does not depend on k_t: 0.5 % for inertia and damping.
    assert rows[-1][1] - rows[0][1] == pytest.approx(JUMP, rel=5e-3)
    assert rows[-1][2] == pytest.approx(-30.0, rel=5e-3)


def test_event_temperatures(seen):
    rows = seen["friction"]["rows"]
    top = max(range(len(rows)), key=lambda i: rows[i][0])
    heating, cooling = rows[:top], rows[top:]
    # Half a kelvin is the sampling at the start, 250 of 100 000 steps.
    slip = first(heating, lambda row: row[3])
    # The contact creeps f/k_t before it slips, so first slip is that much later.
    creep = 30.0 / seen["friction"]["friction_stiffness"] / (0.5 * 23.4e-6)
    assert slip[0] == pytest.approx(2.035099 + creep, abs=0.85)
    assert first(heating, lambda row: row[4])[0] == pytest.approx(87.509255, abs=0.5)
    assert first(cooling, lambda row: not row[4])[0] == pytest.approx(83.431111, abs=0.5)


def test_force_while_sliding_is_the_friction_limit(seen):
    sliding = [row for row in seen["friction"]["rows"] if 10 < row[0] < 80]
    assert len(sliding) > 100
    for row in sliding:
        # Inertia: m x'' of the orbit is below 1e-3 N; the rest is ringing of the link.
        assert abs(row[2]) == pytest.approx(30.0, rel=5e-3)


def test_without_friction_there_is_no_jump(seen):
    rows = seen["frictionless"]["rows"]
    assert any(row[4] for row in rows)
    assert abs(rows[-1][1] - rows[0][1]) < 1e-9
    assert seen["frictionless"]["energy"]["jointFriction"] == 0


def test_friction_work(seen):
    # f times the path: out to the stop and back, less the jump.
    energy = seen["friction"]["energy"]["jointFriction"]
    assert energy == pytest.approx(30.0 * (2 * 1e-3 - JUMP), rel=0.02)
    assert seen["friction"]["dt"] < seen["friction"]["stable"]
