# silt - BSD-3-Clause, see LICENSE
"""Reads, draws and compares what silt writes.

    import silt
    bed = silt.open("out/hopper/vtk/particles.pvd")   # a Series; nothing but the list is read yet
    bed.times                                         # [s], one a frame
    last = bed[-1]                                    # a Frame; its arrays are read when asked for
    last["position"], last["velocity"], last.ids      # numpy arrays; last.unit("velocity") is "m/s"
    times, speed = bed.track(17, "|velocity|")
    energy = silt.table("out/energy.csv")             # energy["time"], energy.unit("time")

Readers need numpy alone; pictures (silt.drawing, `python3 -m silt draw`) need matplotlib too. What
is wrong with a file or a name is a silt.Error: one sentence that says what, where, what to change.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from . import needs

__version__ = "0.1.0"

# Names are loaded when they are asked for: `python3 -m silt` must be able to say that numpy is
# missing.
_HOMES = {
    "Error": "errors",
    "Frame": "frame",
    "Grid": "frame",
    "Series": "series",
    "Track": "series",
    "open": "series",
    "read": "series",
    "npz_series": "npz",
    "Table": "tables",
    "table": "tables",
    "Summary": "summaries",
    "summary": "summaries",
    "Difference": "comparison",
    "compare": "comparison",
}
__all__ = [*_HOMES, "__version__"]

if TYPE_CHECKING:
    from .comparison import Difference, compare
    from .errors import Error
    from .frame import Frame, Grid
    from .npz import npz_series
    from .series import Series, Track, open, read
    from .summaries import Summary, summary
    from .tables import Table, table


def __getattr__(name: str) -> Any:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'silt' has no '{name}'; it has: {', '.join(sorted(_HOMES))}")
    if name != "Error" and needs.missing("numpy"):
        raise ImportError(needs.sentence("silt", ["numpy"]))
    value = getattr(importlib.import_module("." + home, __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
