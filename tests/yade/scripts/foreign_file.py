# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that YADE cannot load: one that names another version of Boost, and a truncated file of this YADE."""
import sys
from pathlib import Path

import statejump_yade  # noqa: F401
from statejump_yade.saved_files import SIGNATURE

from parts import *  # noqa: F403

folder = Path(sys.argv[1])
said = {}
for name in ("scene.xml", "scene.yade"):
    path = folder / name
    O.save(str(path), quiet=True)
    whole = path.read_bytes()
    place = whole.index(SIGNATURE) + len(SIGNATURE)
    text, rest = whole[:place], whole[place: 3 * len(whole) // 4]
    of_another = rest.replace(b'version="', b'version="9', 1) if name.endswith("xml") else b"\xff\xff" + rest[2:]
    for case, content in (("of another", text + of_another), ("cut off", text + rest)):
        path.write_bytes(content)
        try:
            O.load(str(path), quiet=True)
            said[f"{name} {case}"] = "loaded"
        except Exception as error:
            said[f"{name} {case}"] = f"{type(error).__name__}: {error}"
finish(said)
