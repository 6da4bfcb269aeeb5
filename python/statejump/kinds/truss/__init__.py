# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses of many joints: what is made of ``truss`` cases."""
