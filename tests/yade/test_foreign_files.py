# SPDX-License-Identifier: GPL-3.0-or-later
"""O.load of a file saved by another YADE ends with a clear message; YADE's own errors are unchanged."""
import pytest


@pytest.fixture(scope="module")
def said(run_script, tmp_path_factory):
    return run_script("foreign_file.py", str(tmp_path_factory.mktemp("files")))


@pytest.mark.parametrize("name", ["scene.xml", "scene.yade"])
def test_file_of_another_yade_is_named_as_such(said, name):
    sentence = said[f"{name} of another"]
    assert sentence.startswith("ForeignFile: ") and name in sentence and "\n" not in sentence


@pytest.mark.parametrize("name", ["scene.xml", "scene.yade"])
def test_broken_file_of_this_yade_is_not(said, name):
    sentence = said[f"{name} cut off"]
    assert sentence != "loaded" and not sentence.startswith("ForeignFile: ")
