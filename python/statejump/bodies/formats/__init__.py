# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of files in which finite-element programs write reduced matrices."""
