# SPDX-License-Identifier: GPL-3.0-or-later
"""One HDF5 file per run, with case, results and scene. :mod:`.layout` defines its layout, which
docs/reference/result_file.md describes. :func:`statejump.read` reads such a file."""
