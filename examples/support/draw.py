#!/usr/bin/python3
# silt - BSD-3-Clause, see LICENSE
"""Pictures of silt's results: grains from VTK files (.vtp) and curves from tables (.csv).

  draw.py spheres early.vtp late.vtp --out flow.png --colour velocity --view front --cut y=0.05
  draw.py spheres surfaces.vtp --out shapes.png --colour form
  draw.py curves energy.csv --x time --y kinetic,potential --out energy.png
  draw.py curves loose/energy.csv dense/energy.csv --x time --y kinetic --out both.png
  draw.py cells early.csv late.csv --value voidage --out voidage.png
  draw.py chains contacts.vtp --slab y=0.04,0.06 --out chains.png

Needs numpy and matplotlib (Debian: apt-get install python3-numpy python3-matplotlib).
A wrong argument or file ends in one sentence on stderr and exit status 2.
"""

import argparse
import glob
import itertools
import math
import os
import re
import sys
import textwrap
import xml.etree.ElementTree as ElementTree

import needs  # noqa: F401  (its sentence where numpy or matplotlib is missing)
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from canvas import Canvas  # noqa: E402
from matplotlib.cm import ScalarMappable  # noqa: E402
from matplotlib.collections import LineCollection  # noqa: E402
from matplotlib.colors import ListedColormap, Normalize, to_rgb  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.ticker import (FuncFormatter, LogLocator, MaxNLocator, NullLocator,  # noqa: E402
                               ScalarFormatter)

# Okabe and Ito's colours, which the colour-blind can tell apart.
COLOURS = ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#555555"]
PLAIN = "#C9A66B"  # spheres without a field
# Without viridis's darkest end, which would hide the shading.
COLOUR_MAP = ListedColormap(plt.get_cmap("viridis")(np.linspace(0.14, 1, 256)), "viridis from 14 %")
DPI = 150
# Of fields by silt.
UNITS = {"velocity": "m/s", "angular_velocity": "rad/s", "radius": "m", "worn depth": "m",
         "worn volume": "m3"}
VTK_TYPES = {"Float64": "<f8", "Float32": "<f4", "Int32": "<i4", "UInt32": "<u4", "UInt64": "<u8"}


class Refusal(Exception):
    """One sentence for the user: what, where, what to change."""


# ------------------------------------------------------------------------------------ files


def read_arrays(path, sections):
    """The arrays of a PolyData file with appended raw data, by section and name."""
    try:
        with open(path, "rb") as file:
            content = file.read()
    except OSError as error:
        raise Refusal(f"file '{path}' cannot be read: {error.strerror}")
    foreign = Refusal(f"file '{path}' is not a .vtp file as silt writes them (appended raw data)")
    head, _, rest = content.partition(b'<AppendedData encoding="raw">')
    data = rest.partition(b"_")[2]
    try:
        root = ElementTree.fromstring(head + b"</VTKFile>")
    except ElementTree.ParseError:
        raise foreign
    if root.get("type") != "PolyData" or root.get("header_type") != "UInt64":
        raise foreign

    def array(element):
        try:
            start = int(element.get("offset")) + 8
            components = int(element.get("NumberOfComponents"))
            number = np.dtype(VTK_TYPES[element.get("type")])
        except (TypeError, ValueError, KeyError):
            raise foreign
        size = int.from_bytes(data[start - 8:start], "little")
        if start + size > len(data):
            raise Refusal(f"file '{path}' is truncated in its array '{element.get('Name')}'")
        values = np.frombuffer(data, number, size // number.itemsize, start)
        return values.reshape(-1, components) if components > 1 else values

    arrays = {section: {a.get("Name"): array(a) for a in root.iterfind(f".//{section}/DataArray")}
              for section in sections}
    if "Points" not in arrays["Points"]:
        raise foreign
    return arrays


def read_vtp(path):
    """Points, fields by name, and triangles of a file of silt's."""
    arrays = read_arrays(path, ("Points", "PointData", "Polys"))
    corners = arrays["Polys"].get("connectivity", np.empty(0, int))
    return arrays["Points"]["Points"], arrays["PointData"], corners.reshape(-1, 3)


def read_lines(path):
    """Lines (n, 2, 3) and their fields by name."""
    arrays = read_arrays(path, ("Points", "CellData", "Lines"))
    ends = arrays["Lines"].get("connectivity", np.empty(0, int)).reshape(-1, 2)
    return arrays["Points"]["Points"][ends].astype(float).reshape(-1, 2, 3), arrays["CellData"]


def read_csv(path):
    """Column names and rows of a table; a last row that a kill left incomplete is left out."""
    try:
        with open(path, encoding="utf-8") as file:
            lines = file.read().split("\n")[:-1]
        names = lines[0].split(",")
        rows = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
        return names, rows.reshape(len(lines) - 1, len(names))
    except OSError as error:
        raise Refusal(f"file '{path}' cannot be read: {error.strerror}")
    except (ValueError, IndexError):
        raise Refusal(f"file '{path}' is not a table of numbers with one line of column names")


def split_unit(name):
    """'time [s]' -> ('time', 's')."""
    word, bracket, unit = name.partition(" [")
    return (word, unit[:-1]) if bracket and unit.endswith("]") else (name, "")


def find_name(wanted, names, what, path):
    """The full name that `wanted` means, with or without its unit."""
    for name in names:
        if wanted == name or wanted == split_unit(name)[0]:
            return name
    raise Refusal(f"file '{path}' has no {what} '{wanted}'; it has: {', '.join(names) or 'none'}")


def round_long(words):
    """Words in which numbers of many digits have four: '0.10000000000000009 s' -> '0.1 s'."""
    return re.sub(r"\d+\.\d{5,}(?:[eE][-+]?\d+)?", lambda n: f"{float(n[0]):.4g}", words)


def spell_times(times):
    """Times [s] in words, with as few digits as tell them apart and are right to 0.5 %."""
    largest = max(map(abs, times), default=0)
    unit, scale = next(((u, s) for u, s, least in (("s", 1, 0.1), ("ms", 1e3, 1e-4))
                        if largest >= least), ("\u00b5s", 1e6))
    if largest == 0:
        unit, scale = "s", 1
    for decimals in range(10):
        rounded = [round(t * scale, decimals) for t in times]
        if (len(set(rounded)) == len(set(times)) and
                all(abs(r - t * scale) <= 0.005 * abs(t * scale) for r, t in zip(rounded, times))
                and (decimals >= 1 or largest * scale >= 10)):
            break
    return [f"{r:.{decimals}f} {unit}" for r in rounded]


def time_in_series(path):
    """The time [s] of a file of a series, as the .pvd file beside it says, or None."""
    folder, name = os.path.split(path)
    for series in sorted(glob.glob(os.path.join(glob.escape(folder), "*.pvd"))):
        try:
            entries = ElementTree.parse(series).iterfind(".//DataSet")
            return next(float(e.get("timestep")) for e in entries if e.get("file") == name)
        except (OSError, ElementTree.ParseError, StopIteration, TypeError, ValueError):
            continue
    return None


def captions(titles, files):
    """The titles, or: the times of files of a series; else the steps in their names; else, of several
    files, their names in words."""
    if titles:
        if len(titles) != len(files):
            raise Refusal(f"there are {len(titles)} titles for {len(files)} files; give one a file")
        return [round_long(title) for title in titles]
    times = [time_in_series(path) for path in files]
    if None not in times:
        return spell_times(times)
    names = [os.path.splitext(os.path.basename(path))[0] for path in files]
    steps = [re.search(r"_(\d+)$", name) for name in names]
    if all(steps):
        return [f"step {int(step[1])}" for step in steps]
    return [name.replace("_", " ") for name in names] if len(files) > 1 else [""]


def save(figure, path):
    partial = path + ".partial"
    try:
        figure.savefig(partial, format="png", dpi=DPI, facecolor="white")
        os.replace(partial, path)
    except OSError as error:
        if os.path.exists(partial):
            os.remove(partial)
        raise Refusal(f"file '{path}' cannot be written: {error.strerror}")


# ------------------------------------------------------------------------------- projection


def view_axes(view):
    """Rows: right, up, towards the viewer."""
    if view == "iso":
        turn, tilt = math.radians(-35), math.radians(25)
        right = np.array([math.cos(turn), math.sin(turn), 0])
        flat = np.array([math.sin(turn), -math.cos(turn), 0])
        viewer = math.cos(tilt) * flat + math.sin(tilt) * np.array([0, 0, 1])
        return np.array([right, np.cross(viewer, right), viewer])
    return np.array({
        "front": [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
        "side": [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
        "top": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    }[view], float)


class Cut:
    """Keeps the half space that is farther from the viewer; the greater one if seen edge-on."""

    def __init__(self, words, axes):
        axis, _, value = words.partition("=")
        try:
            self.value = float(value)
            self.axis = "xyz".index(axis) if len(axis) == 1 else None
        except ValueError:
            self.axis = None
        if self.axis is None:
            raise Refusal(f"--cut '{words}' must be an axis and a place in metres, such as y=0.05")
        self.sign = -1 if axes[2][self.axis] > 1e-9 else 1

    def beyond(self, points):
        return self.sign * (points[..., self.axis] - self.value)

    def clip(self, segments):
        """The parts of the segments (n, 2, 3) in the half that is kept."""
        d = self.beyond(segments)
        segments = segments[(d >= 0).any(axis=1)].copy()
        d = self.beyond(segments)
        for end in (0, 1):
            out = d[:, end] < 0
            part = (d[out, 1 - end] / (d[out, 1 - end] - d[out, end]))[:, None]
            inner = segments[out, 1 - end]
            segments[out, end] = inner + part * (segments[out, end] - inner)
        return segments

    def clip_triangles(self, corners):
        """The parts of triangles (n, 3, 3) in the half that is kept, as triangles."""
        d = self.beyond(corners)
        inside = (d >= 0).sum(axis=1)
        parts = [corners[inside == 3]]
        for count in (1, 2):  # the corner that is alone on its side first
            some, e = corners[inside == count], d[inside == count]
            lone = np.argmax((e >= 0) if count == 1 else (e < 0), axis=1)
            turned = (lone[:, None] + np.arange(3)) % 3
            some = np.take_along_axis(some, turned[:, :, None], axis=1)
            e = np.take_along_axis(e, turned, axis=1)
            p, q = (some[:, 0] + (e[:, 0] / (e[:, 0] - e[:, k]))[:, None] * (some[:, k] - some[:, 0])
                    for k in (1, 2))
            if count == 1:
                parts.append(np.stack([some[:, 0], p, q], axis=1))
            else:
                parts.append(np.stack([p, some[:, 1], some[:, 2]], axis=1))
                parts.append(np.stack([p, some[:, 2], q], axis=1))
        return np.concatenate(parts)


def wall_edges(points, triangles, viewer):
    """Segments (n, 2, 3): borders, edges where facets differ by over 20 degrees, and outlines."""
    if len(triangles) == 0:
        return np.empty((0, 2, 3))
    # Facets from STL files share places but not points: weld them.
    grain = 1e-7 * max(np.ptp(points, axis=0).max(), 1e-30)
    _, first, welded = np.unique(np.round(points / grain).astype(np.int64), axis=0,
                                 return_index=True, return_inverse=True)
    corners, triangles = points[first], welded.reshape(-1)[triangles]
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1)
    normals, triangles = normals[length > 0] / length[length > 0, None], triangles[length > 0]

    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]],
                                    triangles[:, [2, 0]]]), axis=1)
    facet = np.tile(np.arange(len(triangles)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, facet = edges[order], facet[order]
    starts = np.flatnonzero(np.r_[True, (edges[1:] != edges[:-1]).any(axis=1)])
    counts = np.diff(np.r_[starts, len(edges)])
    shown = counts != 2
    pair = starts[~shown]
    n0, n1 = normals[facet[pair]], normals[facet[pair + 1]]
    # Facets may be listed with either orientation: compare the planes, not the sides.
    bent = np.abs((n0 * n1).sum(axis=1)) < math.cos(math.radians(20))
    facing0, facing1 = n0 @ viewer, n1 @ viewer
    outline = (facing0 * facing1 < 0) & (np.minimum(abs(facing0), abs(facing1)) > 1e-6) & \
        ((n0 * n1).sum(axis=1) > 0)
    shown[~shown] = bent | outline
    return corners[edges[starts[shown]]]


# ---------------------------------------------------------------------------------- spheres


class Bed:
    """The spheres of one file, or its surfaces, in view coordinates."""

    def __init__(self, path, colour, axes, cut):
        points, fields, self.triangles = read_vtp(path)
        self.has_surfaces = len(self.triangles) > 0
        radii = (np.ones(len(points)) if self.has_surfaces else
                 fields[find_name("radius", fields, "field", path)])
        self.values, self.label = np.zeros(len(points)), ""
        if colour is not None and colour in ("x", "y", "z"):
            self.values, self.label = points[:, "xyz".index(colour)], f"{colour} [m]"
        elif colour is not None:
            name = find_name(colour, fields, "field", path)
            self.values, self.label = fields[name], name
            if self.values.ndim == 2:
                word, unit = split_unit(name)
                self.values = np.linalg.norm(self.values, axis=1)
                unit = unit or UNITS.get(word, "")
                self.label = f"|{word.replace('_', ' ')}|" + (f" [{unit}]" if unit else "")
            elif name in UNITS:
                self.label = f"{name} [{UNITS[name]}]"
        kept = np.isfinite(points).all(axis=1) & (radii > 0)
        if self.has_surfaces:
            self.take_surfaces(points, fields, axes, cut)
            return
        if cut:
            kept &= cut.beyond(points) >= 0
        self.places, self.radii = points[kept] @ axes.T, radii[kept].astype(float)
        self.values = self.values[kept]

    def take_surfaces(self, points, fields, axes, cut):
        """Whole bodies: those whose middle is beyond the cut."""
        if cut:
            body = np.unique(fields["id"], return_inverse=True)[1].reshape(-1)
            count = np.bincount(body)
            middle = np.stack([np.bincount(body, points[:, k]) / count for k in range(3)], axis=1)
            self.triangles = self.triangles[(cut.beyond(middle) >= 0)[body[self.triangles[:, 0]]]]
        places = points @ axes.T
        a, b, c = (places[self.triangles[:, k]] for k in range(3))
        flat = np.cross(b - a, c - a)
        around = np.stack([sum(np.bincount(self.triangles[:, k], flat[:, axis], len(points))
                               for k in range(3)) for axis in range(3)], axis=1)
        front = flat[:, 2] > 0  # the rest is behind these
        self.triangles, flat = self.triangles[front], flat[front]
        smooth = around[self.triangles]
        length = [np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-300)
                  for v in (flat, smooth)]
        flat, smooth = flat / length[0], smooth / length[1]
        # A corner where facets meet at an edge has each facet's own normal.
        edge = (smooth * flat[:, None, :]).sum(axis=2) < math.cos(math.radians(25))
        self.normals = np.where(edge[:, :, None], flat[:, None, :], smooth)
        self.places, self.radii = places, np.zeros(len(points))

    def corners(self):
        """Picture coordinates that its bounds must hold."""
        if self.has_surfaces:
            return self.places[np.unique(self.triangles), :2]
        r = self.radii[:, None]
        return np.concatenate([self.places[:, :2] - r, self.places[:, :2] + r])


class ColourScale:
    """Colours of values: one for each of a few whole numbers, else a continuous map."""

    def __init__(self, beds, limits, names=None):
        values = np.concatenate([bed.values for bed in beds])
        self.label = beds[0].label
        self.kinds = None
        if self.label and np.issubdtype(values.dtype, np.integer) and limits is None:
            kinds = np.unique(values)
            self.kinds = kinds if 0 < len(kinds) <= len(COLOURS) else None
        self.names = names
        if names is not None and len(values) > 0 and (
                self.kinds is None or self.kinds.max() >= len(names)):
            raise Refusal("--names gives words for the whole numbers 0, 1, ... of the field of "
                          f"--colour, at most {len(COLOURS)}: there are {len(names)} words, and "
                          + ("no such field" if self.kinds is None else
                             f"the values {', '.join(map(str, self.kinds))}"))
        finite = values[np.isfinite(values)] if len(values) else np.zeros(1)
        low, high = limits or ((finite.min(), finite.max()) if len(finite) else (0, 1))
        self.norm = Normalize(low, high if high > low else low + (abs(low) or 1))
        self.whole = len(finite) > 0 and bool((finite == np.round(finite)).all())
        below, above = bool((finite < low).any()), bool((finite > high).any())
        self.extend = {(0, 0): "neither", (1, 0): "min", (0, 1): "max",
                       (1, 1): "both"}[below, above]

    def colours(self, values):
        if not self.label:
            return np.tile(to_rgb(PLAIN), (len(values), 1))
        if self.kinds is not None:
            table = np.array([to_rgb(c) for c in COLOURS])
            return table[np.searchsorted(self.kinds, values)]
        return COLOUR_MAP(self.norm(values))[:, :3]

    def add_to(self, figure, box):
        """Puts the legend or the colour bar into `box` (left, bottom, width, height)."""
        axes = figure.add_axes(box)
        if self.kinds is not None:
            axes.set_axis_off()
            word = split_unit(self.label)[0]
            words = self.names or {kind: f"{kind:g}" for kind in self.kinds}
            marks = [Line2D([], [], ls="", marker="o", ms=9, color=COLOURS[k], label=words[kind])
                     for k, kind in enumerate(self.kinds)]
            for columns in range(len(marks), 0, -1):  # as many side by side as there is room for
                legend = axes.legend(handles=marks, title=word if self.names is None else None,
                                     loc="center", ncol=columns, frameon=False, fontsize=11,
                                     title_fontsize=11, handletextpad=0.2, columnspacing=1.2)
                figure.canvas.draw()
                half = min(figure.bbox.x1 - axes.bbox.x0 - axes.bbox.width / 2,
                           axes.bbox.width / 2 + 0.1 * figure.dpi)
                if legend.get_window_extent().width <= 2 * half:
                    break
        else:
            axes.remove()
            add_bar(figure, self.norm, COLOUR_MAP, self.label, box, self.extend, self.whole)


def add_bar(figure, norm, colours, label, box, extend="neither", whole=False):
    """A horizontal colour bar in `box`, or to the right of it and shorter where what stands there
    already (the scale bar) would run into its numbers. With `whole` numbers at whole values alone."""
    bar = figure.colorbar(ScalarMappable(norm, colours), cax=figure.add_axes(box),
                          orientation="horizontal", extend=extend)
    bar.formatter = ScalarFormatter(useOffset=False)
    bar.set_label(label, fontsize=11)
    bar.ax.tick_params(labelsize=10)
    bar.outline.set_linewidth(0.5)
    others = [axes for axes in figure.axes if axes is not bar.ax]
    for _ in range(20):
        tick_apart(bar, figure, whole)
        # A common factor stands at the label, not under the last number where the label may be.
        factor = bar.ax.xaxis.get_offset_text()
        if factor.get_text():
            word, unit = split_unit(label)
            bar.set_label(f"{word} [{factor.get_text()} {unit}]".replace(" ]", "]"), fontsize=11)
            factor.set_visible(False)
            figure.canvas.draw()
        mine = bar.ax.get_tightbbox(figure.canvas.get_renderer())
        beside = [axes.get_tightbbox(figure.canvas.get_renderer()) for axes in others]
        beyond = max([b.x1 - mine.x0 for b in beside if b is not None and b.overlaps(mine)], default=0)
        over = mine.x1 - figure.bbox.x1
        left, bottom, width, height = bar.ax.get_position().bounds
        if beyond <= 0 and over <= 0 or width < 0.1:
            return bar
        shift = (beyond + 4) / figure.bbox.width if beyond > 0 else 0
        cut = shift + ((over + 4) / figure.bbox.width if over > 0 else 0)
        bar.ax.set_position([left + shift, bottom, max(width - cut, 0.09), height])
    return bar


def tick_apart(bar, figure, whole=False):
    """As many numbers at a horizontal colour bar as leave a gap between each other; whole ones."""
    for most in (8, 6, 5, 4, 3, 2):
        bar.locator = MaxNLocator(most, integer=whole)
        bar.update_ticks()
        figure.canvas.draw()
        boxes = [label.get_window_extent() for label in bar.ax.get_xticklabels() if label.get_text()]
        gap = 0.5 * max((box.height for box in boxes), default=0)
        if all(a.x1 + gap < b.x0 for a, b in zip(boxes, boxes[1:])):
            return


def parse_numbers(option, words, count):
    try:
        numbers = [float(word) for word in words.split(",")]
    except ValueError:
        numbers = []
    rising = all(a < b for a, b in zip(numbers[::2], numbers[1::2]))
    if len(numbers) != count or not rising or not all(map(math.isfinite, numbers)):
        raise Refusal(f"{option} '{words}' must be {count} numbers with commas between, the lower "
                      "one of each pair first")
    return numbers


def picture_bounds(beds, edges, axes):
    corners = [bed.corners() for bed in beds] + [(edges.reshape(-1, 3) @ axes.T)[:, :2]]
    corners = np.concatenate(corners)
    if len(corners) == 0:
        raise Refusal("there is nothing to draw: no spheres are left, and there are no walls")
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = 0.02 * (high - low).max()
    return [low[0] - margin, high[0] + margin, low[1] - margin, high[1] + margin]


class Sheet:
    """Where panels, captions, colour bar and scale bar stand, in inches."""

    SIDE, BELOW, GAP = 0.25, 0.80, 0.25

    def __init__(self, titles, aspect):
        panels, best = len(titles), None
        self.caption = 0.56 if any(titles) else 0.15  # a caption has up to two lines
        for columns in range(1, panels + 1):  # the arrangement with the largest panels
            rows = math.ceil(panels / columns)
            width = min((13 - 2 * self.SIDE + self.GAP) / columns - self.GAP,
                        ((8.5 - self.BELOW) / rows - self.caption) * aspect, 7)
            if best is None or width > best[0] * 1.001:
                best = (width, columns, rows)
        self.panel_width, self.columns, self.rows = best
        self.panel_height = self.panel_width / aspect
        used = self.columns * (self.panel_width + self.GAP) - self.GAP
        self.width = max(used, 4.5) + 2 * self.SIDE
        self.left = (self.width - used) / 2
        self.height = self.rows * (self.panel_height + self.caption) + self.BELOW

    def panel(self, k):
        row, column = divmod(k, self.columns)
        x = self.left + column * (self.panel_width + self.GAP)
        y = self.height - (row + 1) * (self.panel_height + self.caption)
        return self.box(x, y, self.panel_width, self.panel_height)

    def box(self, x, y, width, height):
        return [x / self.width, y / self.height, width / self.width, height / self.height]


def draw_scale_bar(figure, sheet, span):
    """A bar of 1, 2 or 5 times a power of ten in mm, about a quarter of a panel."""
    most = 1e3 * span * min(1, 1.6 / sheet.panel_width)  # [mm]
    power = 10 ** math.floor(math.log10(most))
    length = max(n * power for n in (1, 2, 5) if n * power <= most)
    inches = length * 1e-3 / span * sheet.panel_width
    axes = figure.add_axes(sheet.box(sheet.SIDE + 0.1, 0.30, inches, 0.10))
    axes.set_axis_off()
    axes.set(xlim=(0, 1), ylim=(-1, 1))
    axes.plot([0, 0, 0, 1, 1, 1], [-1, 1, 0, 0, -1, 1], color="black", lw=1.4, clip_on=False)
    axes.annotate(f"{length:g} mm", (0.5, 1), (0, 3), textcoords="offset points", ha="center",
                  fontsize=11)


def draw_spheres(options):
    axes = view_axes(options.view)
    cut = Cut(options.cut, axes) if options.cut else None
    titles = captions(options.title, options.files)
    beds = [Bed(path, options.colour, axes, cut) for path in options.files]
    edges, walls = np.empty((0, 2, 3)), np.empty((0, 3, 3))
    if options.walls:
        points, _, triangles = read_vtp(options.walls)
        edges, walls = wall_edges(points, triangles, axes[2]), points[triangles]
        if cut:
            edges, walls = cut.clip(edges), cut.clip_triangles(walls)
    bounds = (parse_numbers("--bounds", options.bounds, 4) if options.bounds
              else picture_bounds(beds, edges, axes))
    limits = parse_numbers("--range", options.range, 2) if options.range else None
    scale = ColourScale(beds, limits, options.names.split(",") if options.names else None)

    sheet = Sheet(titles, (bounds[1] - bounds[0]) / (bounds[3] - bounds[2]))
    figure = plt.figure(figsize=(sheet.width, sheet.height))
    for k, (bed, title) in enumerate(zip(beds, titles)):
        canvas = Canvas(bounds, max(1, round(sheet.panel_width * DPI)))
        colours = scale.colours(bed.values)
        if bed.has_surfaces:
            canvas.draw_triangles(bed.places, bed.triangles, bed.normals, colours)
        else:
            canvas.draw_spheres(bed.places, bed.radii, colours)
        canvas.draw_walls(walls @ axes.T)
        canvas.draw_lines(edges @ axes.T)
        panel = figure.add_axes(sheet.panel(k))
        panel.imshow(canvas.picture(), interpolation="none", aspect="auto")
        panel.set_axis_off()
        letters = max(6, int(sheet.panel_width * 72 / (0.55 * 12)))  # that fit over a panel
        panel.set_title(textwrap.fill(title, letters), fontsize=12, pad=6)
    draw_scale_bar(figure, sheet, bounds[1] - bounds[0])
    if scale.label:
        width = min(4.0, sheet.width - 2.6)
        left = max((sheet.width - width) / 2, 2.2)
        tall = 0.70 if scale.kinds is not None else 0.14
        figure_box = sheet.box(left, 0.05 if scale.kinds is not None else 0.50, width, tall)
        scale.add_to(figure, figure_box)
    save(figure, options.out)


# ----------------------------------------------------------------------------------- curves


def label_few_decades(axis, limits):
    """Over few decades: ticks at 1, 2, 5, written as plain numbers."""
    if limits[1] < 300 * limits[0]:
        axis.set_major_locator(LogLocator(10, subs=(1, 2, 5), numticks=9))
        axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axis.set_minor_locator(NullLocator())


def file_words(files):
    """What files are called in a legend: their names, and where these are equal, their folders'."""
    names = [os.path.splitext(os.path.basename(path))[0].replace("_", " ") for path in files]
    if len(set(names)) == len(names):
        return names
    folders = [os.path.dirname(os.path.abspath(path)).split(os.sep) for path in files]
    while all(folder and folder[-1] == folders[0][-1] for folder in folders):
        folders = [folder[:-1] for folder in folders]
    named = [f"{folder[-1] if folder else ''}/{name}" for folder, name in zip(folders, names)]
    if len(set(names)) == 1:
        named = [folder[-1] if folder else "" for folder in folders]
    return named if len(set(named)) == len(files) else list(files)


class Table:
    """The columns of one file that are drawn."""

    def __init__(self, path, options, label):
        names, rows = read_csv(path)
        self.path, self.label, self.columns = path, label, dict(zip(names, rows.T))

        def find(words):
            return [find_name(w, names, "column", path) for w in words.split(",")] if words else []

        self.x_name, self.y_names, self.marks = find(options.x)[0], find(options.y), find(options.marks)
        self.x = self.columns[self.x_name]

    def compare(self, first):
        for mine, of_first in zip([self.x_name, *self.y_names, *self.marks],
                                  [first.x_name, *first.y_names, *first.marks]):
            if mine != of_first:
                raise Refusal(f"file '{self.path}' has '{mine}' where file '{first.path}' has "
                              f"'{of_first}'; curves of one picture must have the same units")


def read_tables(options):
    labels = options.labels or file_words(options.files)
    if len(labels) != len(options.files):
        raise Refusal(f"there are {len(labels)} labels for {len(options.files)} files; give one a file")
    tables = [Table(path, options, label) for path, label in zip(options.files, labels)]
    for table in tables[1:]:
        table.compare(tables[0])
    return tables


def draw_lines(panel, tables, names, colours, options):
    """The columns `names` of all tables. Returns the colours: one a column of a lone table; of several
    tables one a table, whose columns have styles of their own."""
    used = []
    for table in tables:
        for style, name in zip(itertools.cycle(("-", "--", ":", "-.")), names):
            if len(tables) == 1 or style == "-" and name == names[0]:
                used.append(next(colours))
            word = split_unit(name)[0]
            label = (word if len(tables) == 1 else
                     table.label if len(names) == 1 else f"{table.label}: {word}")
            panel.plot(table.x, table.columns[name], lw=1.8, color=used[-1], label=label, ms=4,
                       ls=style if len(tables) > 1 else "-",
                       marker="o" if len(table.x) <= 25 and not options.marks else None)
    return used


def draw_marks(panel, tables, unit, used, options):
    same_unit = [name for name in tables[0].marks if split_unit(name)[1] == unit]
    for k, table in enumerate(tables):
        for name, colour in zip(same_unit, itertools.cycle(used if len(tables) == 1 else [used[k]])):
            panel.plot(table.x, table.columns[name], "o", color=colour, mfc="white", ms=6)
    if same_unit:
        panel.plot([], [], "o", color="black", mfc="white", ms=6, label=options.marks_label)


def draw_references(panel, x, options):
    for style, words in zip(("--", ":", "-."), options.reference or []):
        label, _, numbers = words.rpartition(":")
        try:
            slope, offset = (float(n) for n in numbers.split(","))
        except ValueError:
            raise Refusal(f"--reference '{words}' must be label:slope,offset")
        limits = panel.get_ylim()
        panel.plot(x, slope * x + offset, style, color="black", lw=1.3, label=label)
        if slope != 0:  # such a line may leave the picture, the data and levels may not
            panel.set_ylim(limits)


def add_legend(panel, figure):
    """Inside, where it covers no curve; else above."""
    legend = panel.legend(fontsize=11, frameon=True, framealpha=0.9, edgecolor="none")
    figure.canvas.draw()
    box = legend.get_window_extent()
    for line in panel.lines:
        points = panel.transData.transform(line.get_xydata().astype(float))
        steps = np.linspace(0, 1, 20)[:, None, None]
        along = (points[None, :-1] + steps * (points[None, 1:] - points[None, :-1])).reshape(-1, 2)
        if len(along) and box.count_contains(along[np.isfinite(along).all(axis=1)]) > 0:
            panel.legend(fontsize=11, frameon=False, loc="lower left", bbox_to_anchor=(0, 1),
                         ncol=2, borderaxespad=0.2)
            return


def draw_curves(options):
    tables = read_tables(options)
    x_name, y_names = tables[0].x_name, tables[0].y_names
    units = list(dict.fromkeys(split_unit(name)[1] for name in y_names))
    figure, panels = plt.subplots(len(units), 1, sharex=True, squeeze=False,
                                  figsize=(7.5, 1.4 + 3.2 * len(units)), constrained_layout=True)
    colours = itertools.cycle(COLOURS)
    for panel, unit in zip(panels[:, 0], units):
        mine = [name for name in y_names if split_unit(name)[1] == unit]
        if "x" in options.log:
            panel.set_xscale("log")
        if "y" in options.log:
            panel.set_yscale("log")
        if len(tables) > 1:
            colours = itertools.cycle(COLOURS)  # of a file in all panels
        used = draw_lines(panel, tables, mine, colours, options)
        draw_marks(panel, tables, unit, used, options)
        if panel is panels[0, 0]:
            draw_references(panel, np.sort(np.concatenate([table.x for table in tables])), options)
        for axis, low_high in ((panel.xaxis, panel.get_xlim()), (panel.yaxis, panel.get_ylim())):
            if axis.get_scale() == "log":
                label_few_decades(axis, low_high)
        in_brackets = f"[{unit}]" if unit else ""
        panel.set_ylabel(options.y_label or (mine[0] if len(mine) == 1 else in_brackets),
                         fontsize=12)
        panel.grid(True, color="0.88", lw=0.8)
        panel.set_axisbelow(True)
        panel.spines[["top", "right"]].set_visible(False)
        panel.tick_params(labelsize=11)
        panel.margins(x=0.01)
        if len(panel.lines) > 1:
            add_legend(panel, figure)
    panels[-1, 0].set_xlabel(x_name, fontsize=12)
    if options.title:
        figure.suptitle(round_long(options.title), fontsize=13)
    save(figure, options.out)


# ------------------------------------------------------------------------------------ cells


def read_cells(path, wanted, least=None):
    """Name and values of a field on the cells of a plane, upwards and across, and its bounds."""
    names, rows = read_csv(path)
    name = find_name(wanted, names, "column", path)
    if [split_unit(n)[0] for n in names[:3]] == ["x", "y", "z"]:  # a layer of a grid in space
        thin = [c for c in range(3) if len(np.unique(rows[:, c])) == 1]
        keep = [c for c in range(len(names)) if c not in thin[:1]]
        names, rows = [names[c] for c in keep], rows[:, keep]
    x, y = np.unique(rows[:, 0]), np.unique(rows[:, 1])
    if len(x) < 2 or len(y) < 2 or len(x) * len(y) != len(rows):
        raise Refusal(f"file '{path}' has {len(rows)} rows for {len(x)} x {len(y)} places in its "
                      "first two columns; it must have one for each cell of a rectangle")
    values = np.empty((len(y), len(x)))
    wanted_values = rows[:, names.index(name)].copy()
    if least:
        column, _, number = least.rpartition("=")
        try:
            low = float(number)
        except ValueError:
            raise Refusal(f"--least '{least}' must be a column and a number, such as "
                          "'solid fraction=0.1'")
        wanted_values[rows[:, names.index(find_name(column, names, "column", path))] < low] = np.nan
        if np.isnan(wanted_values).all():
            raise Refusal(f"file '{path}': --least '{least}' leaves no cell to draw")
    values[np.searchsorted(y, rows[:, 1]), np.searchsorted(x, rows[:, 0])] = wanted_values
    dx, dy = (x[1] - x[0]) / 2, (y[1] - y[0]) / 2
    return name, values, (x[0] - dx, x[-1] + dx, y[0] - dy, y[-1] + dy)


def draw_cells(options):
    titles = captions(options.title, options.files)
    fields = [read_cells(path, options.value, options.least) for path in options.files]
    bounds = fields[0][2]
    low, high = (parse_numbers("--range", options.range, 2) if options.range else
                 (min(np.nanmin(f[1]) for f in fields), max(np.nanmax(f[1]) for f in fields)))
    norm = Normalize(low, high if high > low else low + (abs(low) or 1))
    sheet = Sheet(titles, (bounds[1] - bounds[0]) / (bounds[3] - bounds[2]))
    figure = plt.figure(figsize=(sheet.width, sheet.height))
    for k, ((_, values, extent), title) in enumerate(zip(fields, titles)):
        panel = figure.add_axes(sheet.panel(k))
        panel.imshow(values, origin="lower", extent=extent, norm=norm, cmap=COLOUR_MAP,
                     interpolation="nearest", aspect="auto")
        panel.set(xticks=[], yticks=[])
        letters = max(6, int(sheet.panel_width * 72 / (0.55 * 12)))  # that fit over a panel
        panel.set_title(textwrap.fill(title, letters), fontsize=12, pad=6)
    draw_scale_bar(figure, sheet, bounds[1] - bounds[0])
    width = min(4.0, sheet.width - 2.6)
    add_bar(figure, norm, COLOUR_MAP, fields[0][0],
            sheet.box(max((sheet.width - width) / 2, 2.2), 0.50, width, 0.14))
    save(figure, options.out)


# ----------------------------------------------------------------------------------- chains


def pressing_lines(path, slab):
    """The lines (n, 2, 3) of contacts that press, in the slab if there is one, weakest first; and
    their normal forces."""
    lines, fields = read_lines(path)
    force = fields[find_name("normal_force", list(fields), "field", path)].astype(float)
    keep = force > 0
    if slab:
        axis, _, words = slab.partition("=")
        if axis not in ("x", "y", "z"):
            raise Refusal(f"--slab '{slab}' must be an axis and two places in metres, such as "
                          "y=0.04,0.06")
        low, high = parse_numbers("--slab", words, 2)
        middle = lines[:, :, "xyz".index(axis)].mean(axis=1)
        keep &= (middle >= low) & (middle <= high)
    if not keep.any():
        raise Refusal(f"file '{path}' has no contacts that press, where they are looked for")
    order = np.argsort(force[keep])
    return lines[keep][order], force[keep][order]


def draw_chains(options):
    """Contacts as lines, as thick and as dark as their normal force, the strongest on top."""
    axes = view_axes(options.view)
    titles = captions(options.title, options.files)
    edges = np.empty((0, 2, 3))
    if options.walls:
        points, _, triangles = read_vtp(options.walls)
        edges = wall_edges(points, triangles, axes[2])
    beds = []
    for path in options.files:
        lines, force = pressing_lines(path, options.slab)
        beds.append(((lines @ axes.T)[:, :, :2], force))
    corners = np.concatenate([bed[0].reshape(-1, 2) for bed in beds] +
                             [(edges.reshape(-1, 3) @ axes.T)[:, :2]])
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = 0.02 * (high - low).max()
    bounds = [low[0] - margin, high[0] + margin, low[1] - margin, high[1] + margin]
    strong = max(np.quantile(bed[1], 0.995) for bed in beds)  # [N] of the thickest lines
    norm = Normalize(0, strong)
    colours = ListedColormap(plt.get_cmap("magma_r")(np.linspace(0.12, 0.9, 256)))
    sheet = Sheet(titles, (bounds[1] - bounds[0]) / (bounds[3] - bounds[2]))
    figure = plt.figure(figsize=(sheet.width, sheet.height))
    for k, ((lines, force), title) in enumerate(zip(beds, titles)):
        panel = figure.add_axes(sheet.panel(k))
        share = np.minimum(force / strong, 1)
        panel.add_collection(LineCollection(lines, linewidths=0.15 + 2.6 * share,
                                            colors=colours(share), capstyle="round"))
        panel.add_collection(LineCollection((edges @ axes.T)[:, :, :2], linewidths=0.8,
                                            colors="0.3"))
        panel.set(xlim=bounds[:2], ylim=bounds[2:])
        panel.set_axis_off()
        letters = max(6, int(sheet.panel_width * 72 / (0.55 * 12)))
        panel.set_title(textwrap.fill(title, letters), fontsize=12, pad=6)
    draw_scale_bar(figure, sheet, bounds[1] - bounds[0])
    width = min(4.0, sheet.width - 2.6)
    add_bar(figure, norm, colours, "normal force [N]",
            sheet.box(max((sheet.width - width) / 2, 2.2), 0.50, width, 0.14), "max")
    save(figure, options.out)


# --------------------------------------------------------------------------------- commands


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Refusal(message + "; see --help")


def parse(arguments):
    parser = Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True, metavar="spheres|curves|cells")
    spheres = commands.add_parser("spheres", help="shaded spheres, or bodies by their surfaces, several files side by side")
    spheres.add_argument("files", nargs="+", metavar="FILE.vtp", help="points with a field 'radius', or triangles")
    spheres.add_argument("--out", required=True, metavar="PNG")
    spheres.add_argument("--colour", metavar="FIELD", help="a field (of a vector its length), x, y or z")
    spheres.add_argument("--names", metavar="WORD,WORD",
                         help="what the values 0, 1, ... of the field mean")
    spheres.add_argument("--range", metavar="LOW,HIGH", help="values at the ends of the colour bar")
    spheres.add_argument("--view", choices=["front", "side", "top", "iso"], default="front")
    spheres.add_argument("--walls", metavar="FILE.vtp", help="a surface, drawn behind the grains")
    spheres.add_argument("--cut", metavar="y=0.05", help="leave out the half in front of this place [m]")
    spheres.add_argument("--title", nargs="+", metavar="T", help="a caption for each file (its time, if it is of a series)")
    spheres.add_argument("--bounds", metavar="XMIN,XMAX,ZMIN,ZMAX",
                         help="what the picture shows, across and upwards [m]")
    spheres.set_defaults(draw=draw_spheres)
    curves = commands.add_parser("curves", help="columns of tables over another column")
    curves.add_argument("files", nargs="+", metavar="FILE.csv", help="several: in one picture, a colour a file")
    curves.add_argument("--labels", nargs="+", metavar="T", help="what the files are called (their names)")
    curves.add_argument("--x", required=True, metavar="COLUMN", help="with or without its unit")
    curves.add_argument("--y", required=True, metavar="COLUMN[,COLUMN]")
    curves.add_argument("--marks", metavar="COLUMN[,COLUMN]",
                        help="points without a line, in the colours of the columns of --y in turn")
    curves.add_argument("--marks-label", metavar="T", default="measured",
                        help="what the points are called")
    curves.add_argument("--y-label", metavar="T", help="what all columns are")
    curves.add_argument("--log", choices=["x", "y", "xy"], default="", help="logarithmic axes")
    curves.add_argument("--reference", action="append", metavar="LABEL:SLOPE,OFFSET",
                        help="a straight line to compare with; may be repeated")
    curves.add_argument("--out", required=True, metavar="PNG")
    curves.add_argument("--title")
    curves.set_defaults(draw=draw_curves)
    cells = commands.add_parser("cells", help="a field on the cells of a plane, several tables side by side")
    cells.add_argument("files", nargs="+", metavar="FILE.csv",
                       help="a row a cell: its middle across and upwards [m], then fields")
    cells.add_argument("--value", required=True, metavar="COLUMN", help="with or without its unit")
    cells.add_argument("--range", metavar="LOW,HIGH", help="values at the ends of the colour bar")
    cells.add_argument("--title", nargs="+", metavar="T", help="a caption for each file")
    cells.add_argument("--out", required=True, metavar="PNG")
    cells.add_argument("--least", metavar="COLUMN=VALUE", help="cells with less of it stay white")
    cells.set_defaults(draw=draw_cells)

    chains = commands.add_parser("chains", help="contacts as lines, as thick as their force")
    chains.add_argument("files", nargs="+", metavar="FILE.vtp", help="by silt::contact_series")
    chains.add_argument("--view", choices=["front", "side", "top", "iso"], default="front")
    chains.add_argument("--slab", metavar="y=0.04,0.06", help="only contacts between these places [m]")
    chains.add_argument("--walls", metavar="FILE.vtp", help="a surface, drawn by its edges")
    chains.add_argument("--title", nargs="+", metavar="T", help="a caption for each file")
    chains.add_argument("--out", required=True, metavar="PNG")
    chains.set_defaults(draw=draw_chains)
    # Values such as -0.1,0.1,0,1 begin like an option: join them to theirs.
    joined = []
    for argument in arguments:
        if joined and joined[-1] in ("--bounds", "--range") and argument.startswith("-"):
            joined[-1] += "=" + argument
        else:
            joined.append(argument)
    return parser.parse_args(joined)


def main():
    try:
        options = parse(sys.argv[1:])
        options.draw(options)
    except Refusal as refusal:
        sys.stderr.write(f"draw.py: {refusal}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
