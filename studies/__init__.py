# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs that use the package and are no part of it: studies of the paper, measurements, makers of documents."""
