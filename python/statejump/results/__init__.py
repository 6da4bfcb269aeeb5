# SPDX-License-Identifier: GPL-3.0-or-later
"""One HDF5 file per run: case, results, scene. :mod:`.layout` has its layout, which docs/reference/result_file.md
describes. :func:`statejump.read` reads a file."""
