# SPDX-License-Identifier: GPL-3.0-or-later
"""State jump of deployable structures: case files, reduced model, DEM runs and their comparison.

The command line is :mod:`statejump.cli`; everything that it does can be called from Python::

    from statejump.kinds.registry import load_case
    from statejump.kinds.spring_slider import reduced
    path = reduced.solve(load_case("cases/table1.toml"))
    print(path.state_jump_m)
"""

__version__ = "0.1.0"
