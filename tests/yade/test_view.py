# SPDX-License-Identifier: GPL-3.0-or-later
"""YADE's own 3-D view draws all shapes of the plugin. Needs an X server without a screen."""
import os
import shutil
import subprocess

import numpy as np
import pytest
from PIL import Image

from conftest import HERE, PLUGIN_DIR, result_of

pytestmark = pytest.mark.skipif(not shutil.which("xvfb-run"), reason="xvfb is not installed")


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("view")
    done = subprocess.run(
        ["xvfb-run", "-a", "-s", "-screen 0 1024x768x24", "yade", str(HERE / "scripts" / "view.py"),
         str(folder)],
        stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120, check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([PLUGIN_DIR, str(HERE / "scripts")]),
             "PYTHONDONTWRITEBYTECODE": "1", "XDG_RUNTIME_DIR": str(folder)},
    )
    # A view that meets a shape that it cannot draw ends YADE with a failed assertion.
    found = result_of(done)
    assert found["scale"] == 10
    return {name: np.asarray(Image.open(folder / f"{name}.jpg").convert("RGB")) / 255 for name in found["pictures"]}


def pixels(picture, channel, other, least=0.2):
    """Pixels in which one colour exceeds another, outside of YADE's coloured axes and text."""
    picture = picture[110:500, 120:]
    return picture[:, :, channel] - picture[:, :, other] > least


def test_journal_and_bearing_are_seen(pictures):
    journal = pixels(pictures["plain"], 0, 2)
    bearing = pixels(pictures["plain"], 2, 0, 0.05)
    assert journal.sum() > 5000
    assert bearing.sum() > 500
    # Round: as many pixels as an ellipse of its height and width, less the mark from its centre
    # to its edge.
    height, width = journal.any(axis=1).sum(), journal.any(axis=0).sum()
    assert journal.sum() == pytest.approx(3.14159 / 4 * height * width, rel=0.03)
    assert height == pytest.approx(width, abs=3)


def test_clearance_is_drawn_larger(pictures):
    plain, magnified = (pixels(pictures[name], 0, 2) for name in ("plain", "magnified"))
    # The same end face, of radius R2 - 10 (R2 - R1) instead of R1.
    expected = ((5.1 - 10 * 0.1) / 5.0) ** 2
    assert magnified.sum() / plain.sum() == pytest.approx(expected, rel=0.03)
    # It keeps touching on the right: the gap has opened on the left.
    columns = [mask.any(axis=0).nonzero()[0] for mask in (plain, magnified)]
    assert columns[1].max() == pytest.approx(columns[0].max(), abs=2)
    assert columns[1].min() > columns[0].min() + 10


def test_ball_in_its_socket_is_seen(pictures):
    ball, socket = pixels(pictures["ball"], 0, 2), pixels(pictures["ball"], 2, 0, 0.05)
    # Both round and about one middle, 0.9 R1 to R2 in size. The socket's own great circles cross the ball.
    sizes = [(mask.any(axis=1).nonzero()[0], mask.any(axis=0).nonzero()[0]) for mask in (ball, socket)]
    extent = [[1 + where.max() - where.min() for where in pair] for pair in sizes]
    for across, up in extent:
        assert across == pytest.approx(up, abs=4)
    assert extent[0][0] / extent[1][0] == pytest.approx(0.9 * 5.0 / 5.1, rel=0.04)
    assert ball.sum() > 0.8 * 3.14159 / 4 * extent[0][0] ** 2


def test_bore_of_triangles_is_seen(pictures):
    mesh = pixels(pictures["mesh"], 2, 0, 0.05)
    assert mesh.sum() > 2000
    # Seen aslant, 10 mm of length and 10.2 mm of width, more up than across.
    rows, columns = (1 + where.max() - where.min() for where in (
        mesh.any(axis=1).nonzero()[0], mesh.any(axis=0).nonzero()[0]))
    assert 1.1 < rows / columns < 1.7
    # Its two rims are drawn in its full colour, the wall between is translucent.
    assert pixels(pictures["mesh"], 2, 0, 0.2).sum() > 400


def test_slider_in_its_slot_is_seen(pictures):
    slider = pixels(pictures["slider"], 1, 0)
    rows, columns = slider.any(axis=1).sum(), slider.any(axis=0).sum()
    assert slider.sum() > 5000 and rows == pytest.approx(columns, abs=4)
    faces = (pictures["slider"][110:500, 120:].min(axis=2) > 0.5).any(axis=0).nonzero()[0]
    # White lines of the stops, twice as far from the centre as the block's sides.
    sides = slider.any(axis=0).nonzero()[0]
    assert faces.min() < sides.min() and faces.max() > sides.max()
