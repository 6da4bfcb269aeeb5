# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions of higher layers, imported on demand: ``run.plot()`` returns a figure, but a run imports no figures.

The module of such a function is imported at its first call. ``tests/lint/layers.py`` checks that the function exists.
"""
from __future__ import annotations

from functools import cached_property
from importlib import import_module
from typing import Any


class Later:
    """A function that is imported when it is first called.

    :param place: name of the function as ``module:function``
    """

    def __init__(self, place: str) -> None:
        self.place = place

    @cached_property
    def _function(self) -> Any:
        module, _, name = self.place.partition(":")
        return getattr(import_module(module), name)

    def __call__(self, *arguments: Any, **settings: Any) -> Any:
        return self._function(*arguments, **settings)

    def __repr__(self) -> str:
        return f"Later({self.place!r})"
