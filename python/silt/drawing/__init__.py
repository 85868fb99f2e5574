# silt - BSD-3-Clause, see LICENSE
"""Pictures of silt's results, by numpy and matplotlib; `python3 -m silt draw` on the command line.

    silt.drawing.draw("out/vtk/particles.pvd", out="bed.png", colour="velocity")

For pictures of your own: Canvas (a picture of spheres, triangles, walls, lines), Bed (the bodies of a
file in a view), view_axes, Cut, wall_edges, and the colours and colour bars of silt's pictures.
"""

from __future__ import annotations

from .. import needs

if needs.missing("numpy", "matplotlib"):
    raise ImportError(needs.sentence("silt.drawing", needs.missing("numpy", "matplotlib")))

from ..errors import Error  # noqa: E402
from .bodies import Bed, pressing  # noqa: E402
from .canvas import LIGHT, Canvas  # noqa: E402
from .scene import draw  # noqa: E402
from .style import (COLOUR_MAP, COLOURS, DPI, captions, label_few_decades, plt, save,  # noqa: E402
                    tick_apart)
from .view import Cut, view_axes, wall_edges  # noqa: E402

__all__ = ["Bed", "Canvas", "COLOUR_MAP", "COLOURS", "Cut", "DPI", "Error", "LIGHT", "captions", "draw",
           "label_few_decades", "plt", "pressing", "save", "tick_apart", "view_axes", "wall_edges"]  # fmt: skip
