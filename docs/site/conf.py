# SPDX-License-Identifier: GPL-3.0-or-later
"""Sphinx: see make.py, which puts the pages beside this file."""
from __future__ import annotations

from typing import Any

import statejump

project, author = "statejump", "statejump maintainers"
copyright = "GPL-3.0-or-later"
version = release = statejump.__version__
extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc", "sphinx.ext.mathjax"]
root_doc = "docs/index"
breathe_default_project = "statejump"
autodoc_typehints = "description"
autodoc_member_order = "bysource"
# matplotlib writes a method "set" into every class of figures, with words in roles of its own.
autodoc_default_options = {"undoc-members": False, "exclude-members": "set"}
# Several kinds of cases have a Link, a Joint, ...: a type that is not unique stays text.
suppress_warnings = ["ref.python"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
# Debian's MathJax is the second edition; make.py puts what it needs of it beside the pages.
mathjax_path = "mathjax/MathJax.js?config=TeX-AMS_CHTML"
mathjax2_config = {"tex2jax": {"processClass": "math"}}
myst_update_mathjax = False  # it writes the configuration of the third edition
html_theme = "furo"
html_title = f"statejump {version}"
html_static_path = ["_static"]
html_css_files = ["statejump.css"]
html_show_sphinx = False
html_copy_source = False


def setup(app: Any) -> None:
    """Set up docstrings as plain text with a few roles: |x| is the magnitude of x, not a substitution of Sphinx."""

    def plain(app: Any, what: str, name: str, found: Any, options: Any, lines: list[str]) -> None:
        lines[:] = [line.replace("|", "\\|") for line in lines]

    app.connect("autodoc-process-docstring", plain)
