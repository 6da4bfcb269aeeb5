# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump report``: result files as one self-contained HTML page with a 3-D replay."""
from .command import report_command

__all__ = ["report_command"]
