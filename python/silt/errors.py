# silt - BSD-3-Clause, see LICENSE
"""The one error of this package."""

from __future__ import annotations

import os


class Error(Exception):
    """One sentence for the user: what is wrong, where, and what to change."""


class NoFrame(Error, IndexError):
    """A series has no frame of that number. An IndexError too, as for lists."""


def cannot_read(path: str, error: OSError) -> Error:
    """Of a file that cannot be opened; says so if it is still being written."""
    if isinstance(error, FileNotFoundError) and os.path.exists(path + ".partial"):
        return Error(f"file '{path}' is not there yet: '{path}.partial' is still being written, or "
                     "was left by a run that was killed")
    return Error(f"file '{path}' cannot be read: {error.strerror or error}")
