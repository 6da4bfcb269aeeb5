# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's studies without the installed command: ``python3 -m studies.paper figures``."""
import sys

from statejump.cli.main import run

sys.exit(run(sys.argv[1:]))
