# SPDX-License-Identifier: GPL-3.0-or-later
"""One HDF5 file per run: what was asked, what came out, what to draw. The layout is :mod:`.layout`, in words
docs/reference/result_file.md. :func:`statejump.read` reads a file."""
