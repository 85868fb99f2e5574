# silt - BSD-3-Clause, see LICENSE
"""Where this Python lacks numpy or matplotlib: one sentence that says how to get them.

Imports nothing but the standard library. Programs call `or_exit()` before they import the rest.
"""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec

DEBIAN = "/usr/bin/python3"


def missing(*names: str) -> list[str]:
    """Those that this Python does not have."""
    return [name for name in names if find_spec(name) is None]


def sentence(who: str, names: list[str]) -> str:
    """What is missing, and how to get it."""
    advice = (f"install {' and '.join(names)} (Debian: apt-get install "
              f"{' '.join('python3-' + name for name in names)})")
    if os.path.realpath(sys.executable) != os.path.realpath(DEBIAN):
        have = all(os.path.isdir(f"/usr/lib/python3/dist-packages/{name}") for name in names)
        advice = (f"start it with {DEBIAN}, which has them" if have and os.path.exists(DEBIAN) else
                  f"{advice} and start it with the Python that has them")
    return f"{who}: {sys.executable} has no {' and no '.join(names)}; {advice}"


def or_exit(*names: str) -> None:
    """Ends the program with the sentence on stderr and status 2 where one of `names` is missing
    (without names: numpy or matplotlib)."""
    absent = missing(*(names or ("numpy", "matplotlib")))
    if absent:
        who = os.path.basename(sys.argv[0])
        sys.stderr.write(sentence("silt" if who in ("silt", "__main__.py", "-m") else who, absent) + "\n")
        sys.exit(2)
