# silt - BSD-3-Clause, see LICENSE
"""Imported first by every script that draws: where this Python lacks numpy or matplotlib, one
sentence on stderr that says how to get them, and exit status 2."""

import os
import sys

DEBIAN = "/usr/bin/python3"


def missing(modules=("numpy", "matplotlib")):
    """Those that cannot be imported here."""
    out = []
    for name in modules:
        try:
            __import__(name)
        except ModuleNotFoundError:
            out.append(name)
    return out


def sentence(script, names):
    advice = "install " + " and ".join(f"python3-{name}" for name in names) + " (Debian: apt-get " \
        "install " + " ".join(f"python3-{name}" for name in names) + ")"
    if os.path.realpath(sys.executable) != os.path.realpath(DEBIAN):
        there = all(os.path.isdir(f"/usr/lib/python3/dist-packages/{name}") for name in names)
        advice = (f"start it with {DEBIAN}, which has them" if there and os.path.exists(DEBIAN) else
                  advice + f" and start it with {DEBIAN}, or use pip")
    return f"{script}: {sys.executable} has no {' and no '.join(names)}; {advice}\n"


_names = missing()
if _names:
    sys.stderr.write(sentence(os.path.basename(sys.argv[0]), _names))
    sys.exit(2)
