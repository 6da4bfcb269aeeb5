# SPDX-License-Identifier: GPL-3.0-or-later
"""Access to the programs in ``studies/``, which exist in the repository but not in an installation."""
from __future__ import annotations

import os
import sys
from importlib import import_module
from types import ModuleType

from statejump import _paths
from statejump.core.errors import StatejumpError

FOLDER = "studies"
_SHARE = os.path.join(os.path.dirname(_paths.__file__), _paths._SHARE)
PRESENT = os.path.isfile(os.path.join(_SHARE, FOLDER, "__init__.py"))
if PRESENT and _SHARE not in sys.path:  # also for users' kinds of studies, which STATEJUMP_KINDS names
    sys.path.append(_SHARE)


def module(name: str) -> ModuleType:
    """Import a module of the studies. :raises StatejumpError: this installation does not contain the studies"""
    if not PRESENT:
        raise StatejumpError(code="studies_missing", module=name)
    return import_module(name)
