# SPDX-License-Identifier: GPL-3.0-or-later
"""Sphinx: see make.py, which puts the other pages beside this file."""
import statejump

project, author = "statejump", "statejump maintainers"
copyright = "GPL-3.0-or-later"
version = release = statejump.__version__
extensions = ["breathe", "sphinx.ext.autodoc"]
breathe_default_project = "statejump"
autodoc_typehints = "description"
autodoc_member_order = "bysource"
autodoc_default_options = {"undoc-members": False}
# Several kinds of cases have a Link, a Joint, ...: a type that is not unique stays text.
suppress_warnings = ["ref.python"]
html_theme = "furo"
html_title = f"statejump {version}"
html_show_sphinx = False


def setup(app):
    """Docstrings are plain text with a few roles: |x| in them is a magnitude, not a substitution."""

    def plain(app, what, name, found, options, lines):
        lines[:] = [line.replace("|", "\\|") for line in lines]

    app.connect("autodoc-process-docstring", plain)
