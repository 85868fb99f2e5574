# silt - BSD-3-Clause, see LICENSE
"""Imported first by every script that draws: where this Python lacks numpy or matplotlib, one
sentence on stderr that says how to get them, and exit status 2."""

import os
import sys

DEBIAN = "/usr/bin/python3"


def missing(names):
    """Those that cannot be imported here."""
    out = []
    for name in names:
        try:
            __import__(name)
        except ModuleNotFoundError:
            out.append(name)
    return out


def sentence(script, names):
    advice = (f"install {' and '.join(names)} (Debian: apt-get install "
              f"{' '.join('python3-' + name for name in names)})")
    if os.path.realpath(sys.executable) != os.path.realpath(DEBIAN):
        have = all(os.path.isdir(f"/usr/lib/python3/dist-packages/{name}") for name in names)
        advice = (f"start it with {DEBIAN}, which has them" if have and os.path.exists(DEBIAN) else
                  f"{advice} and start it with the Python that has them")
    return f"{script}: {sys.executable} has no {' and no '.join(names)}; {advice}\n"


absent = missing(("numpy", "matplotlib"))
if absent:
    sys.stderr.write(sentence(os.path.basename(sys.argv[0]), absent))
    sys.exit(2)
