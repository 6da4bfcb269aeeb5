# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs that use the package but do not belong to it: studies of the paper, benchmarks, generators of pages."""
