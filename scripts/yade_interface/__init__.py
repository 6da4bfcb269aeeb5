# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of scripts/measure_yade."""
