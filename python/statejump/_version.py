# SPDX-License-Identifier: GPL-3.0-or-later
"""Version of the package."""
__version__ = "0.1.0"
