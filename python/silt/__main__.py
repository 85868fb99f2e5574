# silt - BSD-3-Clause, see LICENSE
"""`python3 -m silt`, `silt` where it is installed, or `python3 path/to/python/silt`."""

from __future__ import annotations

import os
import sys

if not __package__:  # a folder that is run: its parent has the package
    sys.path[0] = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

from silt import needs  # noqa: E402


def main() -> int:
    """Status 0, 1 (files differ), or 2 with one sentence on stderr."""
    arguments = sys.argv[1:]
    needs.or_exit(*(("numpy",) if arguments[:1] in (["info"], ["compare"]) else ()))
    from silt.command import run

    try:
        status = run(arguments)
        sys.stdout.flush()
        return status
    except BrokenPipeError:  # `silt info FILE | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


if __name__ == "__main__":
    sys.exit(main())
