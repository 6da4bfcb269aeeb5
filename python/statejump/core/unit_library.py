# SPDX-License-Identifier: GPL-3.0-or-later
"""Units in any spelling, by the library pint. Loaded only if the unit of a table differs from that of its key."""
from __future__ import annotations

import re
from functools import lru_cache
from tokenize import TokenError

import pint

from statejump.core.units import Conversion

REGISTRY = pint.UnitRegistry()
_SIGNS = str.maketrans({"²": "**2", "³": "**3", "⁴": "**4", "·": "*", "⋅": "*", "∙": "*", "•": "*", "×": "*", "−": "-",
                        "º": "°", "μ": "µ", "℃": "degC", "℉": "degF", "Δ": "delta_", "∆": "delta_"})
# Spellings as a whole, without case, blanks, underscores and points.
_WORDS = {"celsius": "degC", "°c": "degC", "degc": "degC", "degreec": "degC", "degreecelsius": "degC",
          "degreescelsius": "degC", "degcelsius": "degC", "grad": None, "grd": None,
          "fahrenheit": "degF", "°f": "degF", "degf": "degF", "degreefahrenheit": "degF", "degreesfahrenheit": "degF",
          "kelvin": "K", "kelvins": "K", "degk": "K", "°k": "K", "%": "percent", "percent": "percent",
          "secs": "s", "mins": "min", "hr": "h", "hrs": "h", "degs": "deg"}
LONGEST = 60  # largest number of characters of a unit
_POWER = re.compile(r"\*\*(?!\s*-?[1-4](?![\d*.]))")  # exponents that no unit has; pint would compute 9**9**9 forever
_NEWTON_METRE = re.compile(r"(?<![A-Za-z])([kMmµud]?N)(mm|cm|m)(?![A-Za-z])")


def conversion(unit: str, wanted: str, change: bool) -> Conversion | None:
    """Return the conversion from one unit to another; see :func:`statejump.core.column_units.conversion`."""
    text, into = spelled(unit), spelled(wanted if wanted != "-" else "1")
    if text is None or into is None:
        return None
    if text == "percent" or into == "1":
        return Conversion(divisor=100.0) if (text, into) == ("percent", "1") else None
    if change:
        text = re.sub(r"\bdeg([CF])\b", r"delta_deg\1", text)
    try:
        zero, one = (float(REGISTRY.Quantity(value, text).to(into).magnitude) for value in (0.0, 1.0))
        if not zero:
            back = float(REGISTRY.Quantity(1.0, into).to(text).magnitude)
            if one < 1 and abs(back - round(back)) < 1e-9 * back:
                return Conversion(divisor=float(round(back)))
            return Conversion(one)
    except (pint.errors.PintError, pint.errors.DimensionalityError, TokenError, AttributeError, TypeError, ValueError,
            KeyError, ZeroDivisionError, SyntaxError, AssertionError):
        return None
    if text == "degC":
        return Conversion(offset=zero)
    return Conversion(one - zero, offset=zero)


def is_unit(text: str) -> bool:
    """Whether a text is a unit."""
    found = spelled(text)
    if found is None:
        return False
    try:
        REGISTRY.parse_units(found if found != "percent" else "1")
    except (pint.errors.PintError, TokenError, AttributeError, TypeError, ValueError, KeyError, SyntaxError,
            AssertionError):
        return False
    return True


@lru_cache(maxsize=None)
def spelled(unit: str) -> str | None:
    """Return a unit in pint's spelling; None if the text is not an accepted unit."""
    plain = re.sub(r"[\s_.]+", "", unit.translate(_SIGNS)).lower()
    if plain in _WORDS:
        return _WORDS[plain]
    text = unit.translate(_SIGNS).strip()
    text = text.replace("_per_", "/").replace(" per ", "/")
    text = re.sub(r"(?<!delta)_(?!deg)", "*", text)
    text = text.replace("^", "**").replace("°", "deg")
    text = _NEWTON_METRE.sub(r"\1*\2", text)
    text = re.sub(r"([A-Za-zµ])([2346])(?![\d.])", r"\1**\2", text)
    text = re.sub(r"(?<=[A-Za-zµ\d])[-.](?=[A-Za-zµ])", "*", text)
    if re.search(r"[^A-Za-zµ0-9*/()+\-.\s_]", text) or _POWER.search(text) or not 0 < len(text) <= LONGEST:
        return None
    if re.fullmatch(r"[A-Za-z]{4,}", text) and text not in REGISTRY and text.lower() in REGISTRY:
        return text.lower()
    return text
