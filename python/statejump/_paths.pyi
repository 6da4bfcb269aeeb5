# SPDX-License-Identifier: GPL-3.0-or-later
from pathlib import Path

SHARE: Path
_SHARE: str
YADE_SCRIPTS: Path
SCHEMA: Path
PYTHON: str
GIT_COMMIT: str
YADE: str
KERNEL_INCLUDE: Path
EIGEN_INCLUDE: Path
PYTHON_VERSION: tuple[int, int]
