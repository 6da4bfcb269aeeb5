# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs that use the package without being part of it: studies of the paper, measurements, generators of pages."""
