# SPDX-License-Identifier: GPL-3.0-or-later
"""Version of the package."""
__version__ = "1.0.0"
