"""YADE's own 3-D view draws journal, bearing, slider and slot. Needs an X server without a screen."""
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
    """Pixels in which one colour exceeds another, away from YADE's coloured axes and text."""
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


def test_slider_in_its_slot_is_seen(pictures):
    slider = pixels(pictures["slider"], 1, 0)
    rows, columns = slider.any(axis=1).sum(), slider.any(axis=0).sum()
    assert slider.sum() > 5000 and rows == pytest.approx(columns, abs=4)
    faces = (pictures["slider"][110:500, 120:].min(axis=2) > 0.5).any(axis=0).nonzero()[0]
    # White lines of the stops, twice as far from the centre as the block's sides.
    sides = slider.any(axis=0).nonzero()[0]
    assert faces.min() < sides.min() and faces.max() > sides.max()
