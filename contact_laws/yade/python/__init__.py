# SPDX-License-Identifier: GPL-3.0-or-later
"""State jump contact laws for YADE: clearance joints with dry friction under thermal expansion.

Import this package in an ordinary script run by ``yade``::

    from statejump_yade import *

The import registers the classes with the running YADE and makes them available in the script.
"""
import sys as _sys

if "yade.wrapper" not in _sys.modules:
    raise ImportError(
        "statejump_yade needs a running YADE: run the script as 'yade -n -x script.py' "
        "instead of with python3"
    )

from yade import wrapper as _wrapper  # noqa: E402

try:
    from . import _native
except ImportError as _error:
    raise ImportError(
        f"statejump_yade could not be loaded into this YADE ({_error}): it was built for another "
        "one; build it again on this machine"
    ) from None

_difference = _native.setup(_wrapper)
if _difference:
    raise ImportError(
        f"statejump_yade refuses to load: {_difference}; it is built for {_native.built_for()}; build "
        "it again on this machine, and if the build does not know this YADE, run scripts/measure_yade"
    )

from .saved_files import explained as _explained  # noqa: E402

_wrapper.Omega.load = _explained(_wrapper.Omega.load, _native.archive_version(), _native.built_for())

stable_time_step, hertz_depth = _native.stable_time_step, _native.hertz_depth
take_failure, take_refusal = _native.take_failure, _native.take_refusal
bore_triangles, socket_triangles, law_names = _native.bore_triangles, _native.socket_triangles, _native.law_names
__all__ = [
    "slot", "spring", "stable_time_step", "hertz_depth", "take_failure", "take_refusal", "bore_triangles",
    "socket_triangles", "law_names",
    *_native.class_names(),
]
for _name in _native.class_names():
    globals()[_name] = getattr(_wrapper, _name)

from .slot import slot  # noqa: E402
from .spring import spring  # noqa: E402
