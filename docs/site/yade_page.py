# SPDX-License-Identifier: GPL-3.0-or-later
"""YADE script: writes the page of the plugin's classes, from their docstrings, to $STATEJUMP_PAGE."""
import os
import re
import textwrap

import statejump_yade as plugin


def plain(text):
    """The documentation is plain text: nothing in it is markup."""
    return re.sub(r"([*|`\\]|_(?=\W|$))", r"\\\1", " ".join((text or "").split()))


def entry(kind, name, text, indent):
    body = f".. py:{kind}:: {name}\n\n" + textwrap.indent(plain(text) or "Undocumented.", "   ") + "\n"
    return textwrap.indent(body, " " * indent)


lines = ["YADE classes", "============", "", "``from statejump_yade import *``; run by ``yade -n -x script.py``.", "",
         ".. py:module:: statejump_yade", ""]
for name in sorted(plugin.__all__, key=str.lower):
    found = getattr(plugin, name)
    if isinstance(found, type):
        bases = ", ".join(base.__name__ for base in found.__bases__)
        lines.append(entry("class", name, f"({bases}) {found.__doc__ or ''}", 0))
        for member, value in vars(found).items():
            if isinstance(value, property):
                lines.append(entry("attribute", member, value.__doc__, 3))
    else:
        lines.append(entry("function", f"{name}()", (found.__doc__ or "").strip(), 0))
with open(os.environ["STATEJUMP_PAGE"], "w", encoding="utf-8") as page:
    page.write("\n".join(lines) + "\n")
