# silt - BSD-3-Clause, see LICENSE
"""`silt cells`: a field on the cells of a plane, from tables."""

from __future__ import annotations

import textwrap
from typing import Optional

import numpy as np
from matplotlib.collections import LineCollection

from ..errors import Error
from ..names import find_start, split_unit
from ..series import read as read_frame
from ..sources import SURFACE
from ..tables import table
from .style import COLOUR_MAPS, Normalize, Sheet, add_bar, captions, draw_scale_bar, parse_numbers, plt, save


def read_cells(path: str, wanted: str, least: Optional[str] = None):
    """Name and values of a field on the cells of a plane, upwards and across, and its bounds."""
    read = table(path)
    names, rows = list(read.names), read.rows
    name = find_start(wanted, names, "column", path)
    if [split_unit(n)[0] for n in names[:3]] == ["x", "y", "z"]:  # a layer of a grid in space
        thin = [c for c in range(3) if len(np.unique(rows[:, c])) == 1]
        keep = [c for c in range(len(names)) if c not in thin[:1]]
        names, rows = [names[c] for c in keep], rows[:, keep]
    x, y = np.unique(rows[:, 0]), np.unique(rows[:, 1])
    if len(x) < 2 or len(y) < 2 or len(x) * len(y) != len(rows):
        raise Error(f"file '{path}' has {len(rows)} rows for {len(x)} x {len(y)} places in its "
                      "first two columns; it must have one for each cell of a rectangle")
    values = np.empty((len(y), len(x)))
    wanted_values = rows[:, names.index(name)].copy()
    if least:
        column, _, number = least.rpartition("=")
        try:
            low = float(number)
        except ValueError:
            raise Error(f"--least '{least}' must be a column and a number, such as "
                          "'solid fraction=0.1'")
        wanted_values[rows[:, names.index(find_start(column, names, "column", path))] < low] = np.nan
        if np.isnan(wanted_values).all():
            raise Error(f"file '{path}': --least '{least}' leaves no cell to draw")
    values[np.searchsorted(y, rows[:, 1]), np.searchsorted(x, rows[:, 0])] = wanted_values
    if least:
        values[sticks_out(np.isfinite(values))] = np.nan
    dx, dy = (x[1] - x[0]) / 2, (y[1] - y[0]) / 2
    return name, values, (x[0] - dx, x[-1] + dx, y[0] - dy, y[-1] + dy)


def sticks_out(shown: np.ndarray) -> np.ndarray:
    """Which of the cells that are shown have at most one neighbour of four that is shown, too."""
    wide = np.pad(shown.astype(int), 1)
    neighbours = wide[1:-1, :-2] + wide[1:-1, 2:] + wide[:-2, 1:-1] + wide[2:, 1:-1]
    lone = shown & (neighbours < 2)
    return lone & (lone != shown).any()  # where all are lone they stay


def section(path: str, walls: str) -> np.ndarray:
    """Where the plane of a table's cells cuts walls: segments (n, 2, 2) [m], across and upwards."""
    read = table(path)
    axes = [split_unit(n)[0] for n in read.names[:3]] == ["x", "y", "z"]
    thin = [c for c in range(3) if axes and len(np.unique(read.rows[:, c])) == 1]
    if not thin:
        raise Error(f"file '{path}' does not say where its plane lies: --walls needs a table with x, y and z, one of "
                    "them the same in all rows")
    frame = read_frame(walls)
    if frame.kind != SURFACE:
        raise Error(f"file '{walls}' has no triangles; --walls takes a file of walls")
    corners = frame.corners.astype(float)
    size = float(np.ptp(corners.reshape(-1, 3), axis=0).max()) if len(corners) else 0.0
    away = corners[:, :, thin[0]] - float(read.rows[0, thin[0]]) + 1e-9 * size  # no corner lies in the plane
    cut = (away > 0).any(axis=1) & (away < 0).any(axis=1)
    corners, away = corners[cut], away[cut]
    after, next_away = np.roll(corners, -1, axis=1), np.roll(away, -1, axis=1)
    crossed = (away > 0) != (next_away > 0)  # two edges of each triangle
    part = away[crossed] / (away[crossed] - next_away[crossed])
    ends = corners[crossed] + part[:, None] * (after[crossed] - corners[crossed])
    return np.delete(ends, thin[0], axis=1).reshape(-1, 2, 2)


def draw_cells(options):
    titles = captions(options.title, options.files)
    colours = COLOUR_MAPS[options.map]
    fields = [read_cells(path, options.value, options.least) for path in options.files]
    bounds = fields[0][2]
    low, high = (parse_numbers("--range", options.range, 2) if options.range else
                 (min(np.nanmin(f[1]) for f in fields), max(np.nanmax(f[1]) for f in fields)))
    norm = Normalize(low, high if high > low else low + (abs(low) or 1))
    sheet = Sheet(titles, (bounds[1] - bounds[0]) / (bounds[3] - bounds[2]))
    figure = plt.figure(figsize=(sheet.width, sheet.height))
    for k, ((_, values, extent), title) in enumerate(zip(fields, titles)):
        panel = figure.add_axes(sheet.panel(k))
        panel.imshow(values, origin="lower", extent=extent, norm=norm, cmap=colours,
                     interpolation="nearest", aspect="auto")
        if options.walls:
            lines = section(options.files[k], options.walls)
            for colour, thickness in (("white", 3.2), ("0.15", 1.5)):  # seen on cells of any colour
                panel.add_collection(LineCollection(lines, colors=colour, linewidths=thickness), autolim=False)
        panel.set(xticks=[], yticks=[], xlim=extent[:2], ylim=extent[2:])
        letters = max(6, int(sheet.panel_width * 72 / (0.55 * 12)))  # that fit over a panel
        panel.set_title(textwrap.fill(title, letters), fontsize=12, pad=6)
    draw_scale_bar(figure, sheet, bounds[1] - bounds[0])
    width = min(4.0, sheet.width - 2.6)
    add_bar(figure, norm, colours, fields[0][0],
            sheet.box(max((sheet.width - width) / 2, 2.2), 0.50, width, 0.14))
    save(figure, options.out)
