# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the built package is."""
from __future__ import annotations

import os
import sys

sys.path.insert(0, os.environ["STATEJUMP_PYTHON_DIR"])
