# silt - BSD-3-Clause, see LICENSE
"""`silt draw`: particles, bodies, walls, contacts, bonds and slices of flows, in one picture or a movie."""

from __future__ import annotations

import argparse
import math
import os
import sys
import textwrap
from dataclasses import dataclass, field
from typing import Optional, Sequence

import numpy as np
from matplotlib.collections import LineCollection

from ..errors import Error
from ..frame import Frame
from ..series import Series
from ..series import open as open_series
from ..series import read
from ..sources import GRID, POINTS, SURFACE
from .bodies import Bed, in_cuts, pressing, tubes, values_of
from .canvas import Canvas
from .planes import Planes
from .style import (CHAINS, COLOUR_MAPS, COLOURS, DPI, LIQUID, PLAIN, ColourScale, Normalize, Sheet, add_bar, captions,
                    draw_scale_bar, parse_numbers, plt, save, to_rgb)
from .view import Cut, view_axes, wall_edges

PALE = 0.62  # how far bodies fade to white behind contacts
SAMPLE = 1001  # values that are kept of a panel
BALL = 0.5  # of their radius that spheres have where bonds are drawn between them
ROD = "#8A8F98"  # bonds without a field


@dataclass
class Layers:
    """What one panel shows; places in view coordinates [m]."""

    bed: Optional[Bed] = None
    others: list[Bed] = field(default_factory=list)  # of further series, --together
    edges: np.ndarray = field(default_factory=lambda: np.empty((0, 2, 3)))
    walls: np.ndarray = field(default_factory=lambda: np.empty((0, 3, 3)))
    contacts: np.ndarray = field(default_factory=lambda: np.empty((0, 2, 3)))
    forces: np.ndarray = field(default_factory=lambda: np.empty(0))
    bonds: np.ndarray = field(default_factory=lambda: np.empty((0, 2, 3)))
    load: np.ndarray = field(default_factory=lambda: np.empty(0))
    load_label: str = ""
    rod: float = 0  # [m] radius of bonds
    bonded: Optional[np.ndarray] = None  # ids of spheres that have bonds; None: not known
    cells: np.ndarray = field(default_factory=lambda: np.empty((0, 3, 3)))
    flow: np.ndarray = field(default_factory=lambda: np.empty(0))  # of each triangle of cells
    flow_label: str = ""

    def beds(self) -> list[Bed]:
        return ([] if self.bed is None else [self.bed]) + self.others

    def places(self) -> np.ndarray:
        """View coordinates (n, 3) that the picture must hold."""
        parts = [self.edges, self.contacts, self.bonds, self.cells]
        parts += [bed.corners() for bed in self.beds()]
        return np.concatenate([part.reshape(-1, 3) for part in parts])


@dataclass
class Extent:
    """What all panels together span: view coordinates, and values of each colour bar."""

    low: np.ndarray = field(default_factory=lambda: np.full(3, np.inf))
    high: np.ndarray = field(default_factory=lambda: np.full(3, -np.inf))
    values: list[np.ndarray] = field(default_factory=list)
    loads: list[np.ndarray] = field(default_factory=list)
    flows: list[np.ndarray] = field(default_factory=list)
    strong: float = 0  # [N] of the thickest contacts
    filled: bool = False  # there is more than walls
    flat: Optional[tuple[np.ndarray, np.ndarray]] = None  # [m] in perspective: what the picture must hold

    def fit(self, layers: Layers, camera: "Camera") -> None:
        """Takes what a panel spans in perspective."""
        seen = camera.flat(layers.places())
        if len(seen):
            low, high = self.flat or (np.full(2, np.inf), np.full(2, -np.inf))
            self.flat = np.minimum(low, seen.min(axis=0)), np.maximum(high, seen.max(axis=0))

    def take(self, layers: Layers) -> None:
        places = layers.places()
        if len(places):
            self.low = np.minimum(self.low, places.min(axis=0))
            self.high = np.maximum(self.high, places.max(axis=0))
        beds = layers.beds()
        self.filled |= any(len(part) for part in (layers.contacts, layers.bonds, layers.cells)) or any(
            len(bed.corners()) for bed in beds)
        coloured = [bed for bed in beds if bed.label] or beds
        self.values += [brief(bed.values) for bed in coloured]
        self.loads.append(brief(layers.load))
        self.flows.append(brief(layers.flow))
        if len(layers.forces):
            self.strong = max(self.strong, float(np.quantile(layers.forces, 0.995)))


def brief(values: np.ndarray) -> np.ndarray:
    """Of many values as many as a colour bar depends on: each of few whole numbers, else the extremes
    and what lies at equal portions between."""
    finite = values if values.dtype.kind in "iu" else values[np.isfinite(values)]
    some = finite[finite != np.round(finite)][:1]  # that keeps a sample from looking like whole numbers
    if len(some) == 0:
        some = np.unique(finite)[:len(COLOURS) + 1]
        if len(some) <= len(COLOURS):
            return some
    if len(finite) <= SAMPLE:
        return finite
    return np.r_[np.sort(finite)[np.linspace(0, len(finite) - 1, SAMPLE).round().astype(int)], some]


class Camera:
    """How the picture is seen: `bounds` (left, right, bottom, top) [m], `eye` in perspective."""

    def __init__(self, extent: Extent, options: argparse.Namespace) -> None:
        if not np.isfinite(extent.low).all():
            raise Error("there is nothing to draw: no bodies, contacts or cells are left, and there are no walls")
        if not extent.filled and (options.slab or options.cut):
            which = " and ".join(name for name in ("slab", "cut") if getattr(options, name))
            sys.stderr.write(f"silt: --{which} leaves nothing but walls to draw\n")
            extent.filled = True  # told
        low, high = extent.low, extent.high
        self.eye: Optional[np.ndarray] = None
        self.plane = float(high[2])
        if options.perspective is not None:
            if not 1 <= options.perspective <= 120:
                raise Error(f"--perspective {options.perspective:g} must be an angle from 1 to 120 degrees")
            half = 0.5 * max(high[0] - low[0], high[1] - low[1], 1e-30)
            reach = half / math.tan(math.radians(options.perspective) / 2)
            self.eye = np.array([*(low + high)[:2] / 2, self.plane + reach])
            low, high = (end if extent.flat is None else extent.flat[k] for k, end in enumerate((low, high)))
        margin = 0.02 * max(high[0] - low[0], high[1] - low[1])
        self.bounds = (parse_numbers("--bounds", options.bounds, 4) if options.bounds else
                       [low[0] - margin, high[0] + margin, low[1] - margin, high[1] + margin])
        if self.bounds[1] <= self.bounds[0] or self.bounds[3] <= self.bounds[2]:
            raise Error("there is nothing to draw: all that is left lies in one place")

    def canvas(self, width: int) -> Canvas:
        return Canvas(self.bounds, width, self.eye, self.plane)

    def flat(self, places: np.ndarray) -> np.ndarray:
        """Where places in view coordinates stand in the picture [m]."""
        if self.eye is None:
            return places[..., :2]
        shrink = (self.eye[2] - self.plane) / np.maximum(self.eye[2] - places[..., 2], 1e-30)
        return self.eye[:2] + (places[..., :2] - self.eye[:2]) * shrink[..., None]


class Scene:
    """Files and options of one picture. `shots` are its panels: a frame and the file it is of."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.options = options
        self.axes = view_axes(options.view)
        self.cuts = [Cut(words, self.axes) for words in options.cut or []]
        self.within = list(self.cuts)
        if options.slab:
            self.within += slab_cuts(options.slab, self.axes)
        self.series = [open_series(name) for name in options.files]
        self.beside: dict[str, Optional[Series]] = {}
        for layer in ("walls", "contacts", "bonds", "flow"):
            name = getattr(options, layer)
            self.beside[layer] = open_series(name) if name and name != "none" else None
        self.found = [self._walls_beside(s) for s in self.series] if options.walls is None else \
            [None] * len(self.series)
        self.planes = Planes()
        self.eye: Optional[np.ndarray] = None
        self.told = False  # that shapes are missing

    def _walls_beside(self, series: Series) -> Optional[Series]:
        """Of a .pvd list walls.pvd beside it, if that has walls."""
        folder, name = os.path.split(series.path)
        if not name.endswith(".pvd"):
            return None
        path = os.path.join(folder, "walls.pvd")
        walls = open_series(path) if name != "walls.pvd" and os.path.exists(path) else None
        return walls if walls is not None and len(walls) else None

    def shots(self) -> list[tuple[int, int]]:
        """Series and frame of each panel: those of --time or --frame, else the last of each."""
        chosen = []
        for k, series in enumerate(self.series):
            if self.options.time:
                numbers = [series.number_at(time) for time in self.options.time]
                for time in self.options.time:
                    if not series.times[0] - 1e-9 <= time <= series.times[-1] + 1e-9:
                        sys.stderr.write(f"silt: '{series.path}' has frames from {series.times[0]:g} to "
                                         f"{series.times[-1]:g} s: that nearest to {time:g} s is drawn\n")
            elif self.options.frame:
                for n in self.options.frame:
                    if not -len(series) <= n < len(series):
                        raise Error(f"series '{series.path}' has {len(series)} frames, no number {n}")
                numbers = [n % len(series) for n in self.options.frame]
            else:
                if len(series) == 0:
                    raise Error(f"series '{series.path}' has no frames yet")
                numbers = [len(series) - 1]
            chosen += [(k, n) for n in numbers]
            if self.options.together:
                break
        return chosen

    # ---------------------------------------------------------------------------- layers

    def layers(self, k: int, n: int) -> Layers:
        frame, out = self.series[k][n], Layers()
        frames = [frame]
        if self.options.together:
            frames += [self._companion(series, frame) for series in self.series[1:]]
            if self.options.colour and not any(self._has_colour(one) for one in frames):
                frames[0][self.options.colour]  # says which fields there are
        for one in frames:
            self._take(out, one)
        walls = self._walls_of(k, frame)
        if walls is not None:
            self._take_walls(out, walls)
        for layer, take in (("contacts", self._take_contacts), ("flow", self._take_flow)):
            series = self.beside[layer]
            if series is not None:
                take(out, self._companion(series, frame))
        if self.beside["bonds"] is not None:
            self._take_bonds(out, self._companion(self.beside["bonds"], frame), self.options.bond_colour)
        return out

    def _walls_of(self, k: int, frame: Frame) -> Optional[Frame]:
        """What is drawn as walls beside a frame of series k."""
        found = self.found if self.options.together else self.found[k:k + 1]
        walls = self.beside["walls"] or next((w for w in found if w is not None), None)
        return None if walls is None or self.options.walls == "none" else self._companion(walls, frame)

    def _take_planes(self, shots: Sequence[tuple[int, int]]) -> None:
        """Planes of walls are as large in all these panels as in any."""
        for k, n in shots:
            walls = self._walls_of(k, self.series[k][n])
            if walls is not None and walls.kind == SURFACE:
                self.planes.take(walls)

    def _has_colour(self, frame: Frame) -> bool:
        colour, more = self.options.colour, true_shape(frame)[1]
        bare = colour.strip("|") if colour[-2:-1] != "." else colour[:-2]
        return colour in ("x", "y", "z") or colour == "rank" and frame.ranks > 1 or any(name in one for name in (colour, bare)
                                                for one in (frame, more) if one is not None)

    def _take(self, out: Layers, frame: Frame) -> None:
        """Adds what a frame has. Of --together, files without the field of --colour are plain."""
        together, colour = self.options.together, self.options.colour
        if together and colour and not self._has_colour(frame):
            colour = None
        if self._is_walls(frame):
            self._take_walls(out, frame)
        elif frame.kind in (POINTS, SURFACE):
            body, more = true_shape(frame)
            self._tell_if_shapeless(body)
            bed = self._bed(body, more, colour)
            if out.bed is None:
                out.bed = bed
            else:
                out.others.append(bed)
        elif frame.kind == GRID:
            self._take_flow(out, frame, colour)
        elif "bending" in frame:
            self._take_bonds(out, frame, self.options.bond_colour or colour or "load")
        elif "normal_force" in frame:
            self._take_contacts(out, frame)
        else:
            raise Error(f"file '{frame.path}' has {frame.kind} with the fields {', '.join(frame.fields) or 'none'}, "
                        "which are neither particles, bodies, contacts, bonds nor cells of a grid")

    def _tell_if_shapeless(self, frame: Frame) -> None:
        """A line on stderr, once a picture, where bodies have to be drawn as their bounding spheres."""
        if frame.kind == POINTS and "orientation" in frame and "radius" in frame and len(frame) and not self.told:
            self.told = True
            sys.stderr.write(f"silt: the shapes of the bodies are not in '{frame.path}': drawn as their bounding "
                             "spheres; vtk_series writes surfaces.pvd or parts.pvd beside particles.pvd\n")

    def _is_walls(self, frame: Frame) -> bool:
        """Whether a file to be drawn is one of walls that are shown as such: by --walls-as, or as they have
        infinite planes, which would hide what is within. Other walls are solid bodies."""
        if frame.kind != SURFACE or "unbounded" not in frame or self.options.colour:
            return False
        return bool(self.options.walls_as) or bool(np.any(frame["unbounded"] != 0))

    def _bed(self, body: Frame, more: Optional[Frame], colour: Optional[str]) -> Bed:
        bonds = self.beside["bonds"]
        try:
            return Bed(body, colour, self.axes, self.within, more, self.eye, self.options.radius)
        except Error as error:
            if bonds is not None and len(bonds) and colour and colour in bonds[-1] and colour not in body:
                raise Error(f"file '{body.path}' has no field '{colour}', but the bonds have: say --bond-colour "
                            f"{colour}") from None
            raise error

    @staticmethod
    def _companion(series: Series, frame: Frame) -> Frame:
        """The frame of another series at the same time."""
        return series[-1] if len(series) == 1 or not math.isfinite(frame.time) else series.at(frame.time)

    def _take_walls(self, out: Layers, frame: Frame) -> None:
        if frame.kind != SURFACE:
            raise Error(f"file '{frame.path}' has no triangles; --walls takes a file of walls")
        points, triangles = self.planes.surface(frame)
        eye = None if self.eye is None else self.eye @ self.axes
        edges = wall_edges(points, triangles, self.axes[2], eye)
        walls = points[triangles]
        for cut in self.cuts:
            edges, walls = cut.clip(edges), cut.clip_triangles(walls)
        out.edges, out.walls = edges @ self.axes.T, walls @ self.axes.T

    def _take_contacts(self, out: Layers, frame: Frame) -> None:
        lines, out.forces = pressing(frame, self.within)
        out.contacts = lines @ self.axes.T

    def _take_bonds(self, out: Layers, frame: Frame, colour: Optional[str]) -> None:
        keep = in_cuts(frame.position, self.within)
        values, out.load_label = values_of(frame, colour)
        if "a" in frame and "b" in frame:
            out.bonded = np.unique(np.concatenate([frame["a"], frame["b"]]))
        out.bonds, out.load = frame.lines[keep] @ self.axes.T, values[keep]
        length = np.linalg.norm(out.bonds[:, 1] - out.bonds[:, 0], axis=1)
        out.rod = self.options.bond_radius or (0.12 * float(np.median(length)) if len(length) else 0)

    def _take_flow(self, out: Layers, frame: Frame, colour: Optional[str] = None) -> None:
        if frame.kind != GRID:
            raise Error(f"file '{frame.path}' has no grid of cells; slices are drawn of .vti files")
        colour = colour or self.options.flow_colour or next(
            (name for name in ("velocity", "mean_velocity") if name in frame), None) or \
            (frame.fields[0] if frame.fields else None)
        corners, values, out.flow_label = slice_of(frame, self.options.slice, colour, self.axes)
        out.cells, out.flow = corners @ self.axes.T, values

    # --------------------------------------------------------------------------- picture

    def draw_picture(self, out: str) -> None:
        shots = self.shots()
        panels, extent = self._load(shots)
        files = [self.series[k].files[n] for k, n in shots]
        if all(len(s) == 1 for s in self.series):
            files = [os.fspath(self.options.files[k]) for k, _ in shots]  # as the user knows them
        titles = captions(self.options.title, files, [self.series[k].times[n] for k, n in shots])
        figure = self.figure(panels, extent, titles)
        save(figure, out, self._dpi(figure.get_figwidth()))

    def _load(self, shots: Sequence[tuple[int, int]]) -> tuple[list[Layers], Extent]:
        self._take_planes(shots)
        panels, extent = [self.layers(k, n) for k, n in shots], Extent()
        for layers in panels:
            extent.take(layers)
        if self.options.perspective is not None:  # which faces and outlines are seen depends on it
            camera = Camera(extent, self.options)
            self.eye = camera.eye
            panels = [self.layers(k, n) for k, n in shots]
            for layers in panels:
                extent.fit(layers, camera)
        return panels, extent

    def _dpi(self, inches: float) -> float:
        """Pixels an inch of a picture as wide as that."""
        return self.options.width / inches if self.options.width else DPI

    def figure(self, panels: Sequence[Layers], extent: Extent, titles: Sequence[str]):
        """The sheet of all panels, with its colour bars."""
        options, camera = self.options, Camera(extent, self.options)
        limits = parse_numbers("--range", options.range, 2) if options.range else None
        colour_map = COLOUR_MAPS[options.map]
        names = options.names.split(",") if options.names else None
        beds = [bed for layers in panels for bed in layers.beds()]
        label = next((bed.label for bed in beds if bed.label), "")
        scales: dict[str, ColourScale] = {}

        def scale(key: str, parts: list[np.ndarray], words: str, own_limits, own_map, own_names=None) -> None:
            values = np.concatenate(parts) if parts else np.empty(0)
            scales[key] = ColourScale(values, words, own_limits, own_names, own_map)

        scale("bed", extent.values, label, limits if beds else None, colour_map, names)
        words = next((layers.flow_label for layers in panels if layers.flow_label), "")
        flow_limits = parse_numbers("--flow-range", options.flow_range, 2) if options.flow_range else \
            None if beds else limits
        scale("flow", extent.flows, words, flow_limits, COLOUR_MAPS["cividis"] if label else colour_map)
        words = next((layers.load_label for layers in panels if layers.load_label), "")
        scale("bonds", extent.loads, words, None if beds else limits, COLOUR_MAPS["magma"] if beds else colour_map)
        forces = Normalize(*(limits if limits and not beds else (0, extent.strong or 1)))

        bounds = camera.bounds
        bars = [s for s in scales.values() if s.label] + ([None] if extent.strong > 0 else [])
        sheet = Sheet(titles, (bounds[1] - bounds[0]) / (bounds[3] - bounds[2]), len(bars))
        dpi = self._dpi(sheet.width)
        pixels = np.round(np.array([sheet.width, sheet.height]) * dpi)  # of the sheet: whole ones, as of panels
        figure = plt.figure(figsize=pixels / dpi)
        for k, (layers, title) in enumerate(zip(panels, titles)):
            canvas = camera.canvas(max(1, round(sheet.panel_width * dpi)))
            paint(canvas, layers, scales, options)
            # Pixel on pixel: a panel half a pixel off would show a row twice, and a jog in slanting lines.
            corner = np.round(np.array(sheet.panel(k)[:2]) * pixels)
            panel = figure.add_axes([*corner / pixels, *np.array(canvas.size()) / pixels])
            panel.imshow(canvas.picture(), interpolation="none", aspect="auto", extent=bounds)
            if len(layers.contacts):
                share = np.clip(forces(layers.forces), 0, 1)
                panel.add_collection(LineCollection(camera.flat(layers.contacts), linewidths=0.15 + 2.6 * share,
                                                    colors=CHAINS(share), capstyle="round"))
            panel.set(xlim=bounds[:2], ylim=bounds[2:])
            panel.set_axis_off()
            letters = max(6, int(sheet.panel_width * 72 / (0.55 * 12)))  # that fit over a panel
            panel.set_title(textwrap.fill(title, letters), fontsize=12, pad=6)
        if camera.eye is None:
            draw_scale_bar(figure, sheet, bounds[1] - bounds[0])
        for k, bar in enumerate(bars):
            place = sheet.bar(k, len(bars), bar is not None and bar.kinds is not None)
            if bar is None:
                add_bar(figure, forces, CHAINS, "normal force [N]", place, "both" if forces.vmin > 0 else "max")
            else:
                bar.add_to(figure, place)
        return figure

    # ----------------------------------------------------------------------------- movie

    def draw_movie(self, out: str) -> None:
        """Every frame of the first series (each --every-th); panels of others at the same times."""
        from .movie import Movie

        numbers = range(0, len(self.series[0]), self.options.every)
        if len(numbers) == 0:
            raise Error(f"series '{self.series[0].path}' has no frames yet")
        times = self.series[0].times[list(numbers)]

        def shots(n: int) -> list[tuple[int, int]]:
            if self.options.together:
                return [(0, n)]
            return [(0, n)] + [(k, s.number_at(self.series[0].times[n])) for k, s in enumerate(self.series[1:], 1)]

        for n in numbers:
            self._take_planes(shots(n))
        extent = Extent()
        for n in numbers:
            for k, m in shots(n):
                extent.take(self.layers(k, m))
        if self.options.perspective is not None:
            camera = Camera(extent, self.options)
            self.eye = camera.eye
            for n in numbers:
                for k, m in shots(n):
                    extent.fit(self.layers(k, m), camera)
        words = captions(None, [self.series[0].files[n] for n in numbers], times)
        count = 1 if self.options.together else len(self.series)
        given = self.options.title or [""] * count
        if len(given) != count:
            raise Error(f"there are {len(given)} titles for {count} "
                        + ("picture" if self.options.together else "files; give one a file"))
        with Movie(out, self.options.fps) as movie:
            for n, time in zip(numbers, words):
                panels = [self.layers(k, m) for k, m in shots(n)]
                figure = self.figure(panels, extent, [f"{title}, {time}" if title else time for title in given])
                movie.add(figure)


def paint(canvas: Canvas, layers: Layers, scales: dict[str, ColourScale], options: argparse.Namespace) -> None:
    """Bodies, bonds, slices and walls onto a canvas; contacts come over it."""
    for bed in layers.beds():
        colours = scales["bed"].colours(bed.values) if bed.label else \
            np.tile(to_rgb(LIQUID if bed.is_liquid else PLAIN), (len(bed.values), 1))
        if len(layers.contacts):
            colours = colours + PALE * (1 - colours)
        if bed.has_surfaces:
            canvas.draw_triangles(bed.places, bed.triangles, bed.normals, colours)
        else:
            canvas.draw_spheres(bed.places, shown_radii(bed, layers), colours)
    if len(layers.bonds):
        balls, which = tubes(layers.bonds, layers.rod)
        colours = scales["bonds"].colours(layers.load) if scales["bonds"].label else \
            np.tile(to_rgb(ROD), (len(layers.bonds), 1))
        canvas.draw_spheres(balls, np.full(len(balls), layers.rod), colours[which])
    if len(layers.cells):
        canvas.draw_flat(layers.cells, scales["flow"].colours(layers.flow))
    full, lines = layers.beds() or len(layers.bonds), len(layers.contacts) or len(layers.cells)
    style = options.walls_as or ("behind" if full else "edges" if lines else "glass")
    if style == "solid":
        canvas.draw_solid_walls(layers.walls)
    elif style == "glass":
        canvas.draw_glass_walls(layers.walls)
    elif style == "behind":
        canvas.draw_walls(layers.walls)
    canvas.draw_lines(layers.edges)


def shown_radii(bed: Bed, layers: Layers) -> np.ndarray:
    """Radii [m] that spheres are drawn with: those of bonds are smaller, their rods would be hidden."""
    if len(layers.bonds) == 0:
        return bed.radii
    if layers.bonded is None:
        return BALL * bed.radii
    if bed.ids is None:
        return bed.radii
    return np.where(np.isin(bed.ids, layers.bonded), BALL, 1.0) * bed.radii


def true_shape(frame: Frame) -> tuple[Frame, Optional[Frame]]:
    """Of a file of bodies by their bounding spheres that of their surfaces or parts of the same step,
    where it stands beside it; and the file that has the fields of whole bodies, or None."""
    folder, name = os.path.split(frame.path)

    def beside(word: str, other: str) -> Optional[Frame]:
        path = os.path.join(folder, name.replace(word, other, 1))
        if not name.startswith(word) or not os.path.exists(path):
            return None
        found = read(path)
        found.time, found.step = frame.time, frame.step
        return found

    if frame.kind == POINTS and "orientation" in frame:
        for word in ("surfaces_", "parts_"):
            shape = beside("particles_", word)
            if shape is not None:
                return shape, frame
    for word in ("surfaces_", "parts_"):
        whole = beside(word, "particles_")
        if whole is not None:
            return frame, whole
    return frame, None


def slab_cuts(words: str, axes: np.ndarray) -> list[Cut]:
    """'y=0.04,0.06' as two half spaces."""
    axis, _, places = words.partition("=")
    if axis not in ("x", "y", "z"):
        raise Error(f"--slab '{words}' must be an axis and two places in metres, such as y=0.04,0.06")
    low, high = parse_numbers("--slab", places, 2)
    return [Cut(f"{axis}>{low!r}", axes), Cut(f"{axis}<{high!r}", axes)]


def slice_of(frame: Frame, words: Optional[str], colour: str, axes: np.ndarray):
    """The cells at a plane as triangles (n, 3, 3) [m], their values (n,), and what these are. `words`:
    'y=0.05'; without, the middle of the direction that is seen most end-on. Closed cells are left out."""
    grid = frame.grid
    if words is None:
        axis = int(np.argmax(np.abs(axes[2])))
        place = grid.origin[axis] + 0.5 * grid.cells[axis] * grid.spacing[axis]
    else:
        name, _, number = words.partition("=")
        try:
            axis, place = ("x", "y", "z").index(name), float(number)
        except ValueError:
            raise Error(f"--slice '{words}' must be an axis and a place in metres, such as y=0.05") from None
    layer = math.floor((place - grid.origin[axis]) / grid.spacing[axis])
    if place == grid.origin[axis] + grid.cells[axis] * grid.spacing[axis]:
        layer -= 1
    if not 0 <= layer < grid.cells[axis]:
        ends = grid.edges(axis)
        raise Error(f"--slice: the plane {'xyz'[axis]} = {place:g} m is not in the grid of '{frame.path}', which "
                    f"goes from {ends[0]:g} to {ends[-1]:g} m")
    values, label = values_of(frame, colour)
    values = np.take(values, layer, axis=axis)
    shown = np.isfinite(values)
    if "open" in frame:
        shown &= np.take(frame["open"], layer, axis=axis) > 0
    u, v = [a for a in range(3) if a != axis]
    corner = np.full((grid.cells[u] + 1, grid.cells[v] + 1, 3), place)
    corner[..., u], corner[..., v] = np.meshgrid(grid.edges(u), grid.edges(v), indexing="ij")
    p, q, r, s = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    halves = np.stack([np.stack([p, q, r], axis=2), np.stack([p, r, s], axis=2)], axis=2)
    return halves[shown].reshape(-1, 3, 3), np.repeat(values[shown], 2), label


def add_options(parser: argparse.ArgumentParser) -> None:
    """Arguments of `silt draw`."""
    parser.add_argument("files", nargs="+", metavar="FILE",
                        help="a series (.pvd), a folder that has one, or a file (.vtp, .pvtp, .vti): particles, bodies, "
                        "contacts, bonds or a flow; several side by side, or --together")
    parser.add_argument("-o", "--out", required=True, metavar="PNG",
                        help="the picture; .gif or .mp4, or frames as out_%%04d.png: a movie of the series")
    parser.add_argument("--colour", "--color", metavar="FIELD",
                        help="a field (of a vector its length), velocity.z, or x, y, z")
    parser.add_argument("--together", action="store_true",
                        help="all files in one panel, at the same times, as a liquid and bodies in it")
    parser.add_argument("--names", metavar="WORD,WORD", help="what the values 0, 1, ... of the field mean")
    parser.add_argument("--radius", type=float, metavar="R",
                        help="of points whose file has none, as a liquid [m] (half of the distance of neighbours)")
    parser.add_argument("--range", metavar="LOW,HIGH", help="values at the ends of the colour bar")
    parser.add_argument("--map", choices=sorted(COLOUR_MAPS), default="viridis",
                        help="colours; all are safe for the colour-blind (viridis)")
    parser.add_argument("--time", nargs="+", type=float, metavar="T", help="frames nearest to these times [s] (the last)")
    parser.add_argument("--frame", nargs="+", type=int, metavar="N", help="frames by number, from 0; -1 is the last")
    parser.add_argument("--view", default="front", metavar="VIEW",
                        help="front, back, side, left, top, bottom, iso, or two angles in degrees: -35,25")
    parser.add_argument("--perspective", nargs="?", type=float, const=30.0, metavar="DEGREES",
                        help="seen from nearby, under this angle (30), instead of parallel")
    parser.add_argument("--walls", metavar="FILE", help="a surface (of a series walls.pvd beside it), or none")
    parser.add_argument("--walls-as", choices=["behind", "solid", "glass", "edges"],
                        help="walls hide no bodies (behind), hide them (solid), veil them (glass), or are lines "
                        "(behind; of contacts alone edges)")
    parser.add_argument("--contacts", metavar="FILE", help="force chains over the bodies, as thick as their force")
    parser.add_argument("--bonds", metavar="FILE", help="bonds as rods")
    parser.add_argument("--bond-colour", metavar="FIELD", help="a field of the bonds, as load")
    parser.add_argument("--bond-radius", type=float, metavar="R", help="of the rods [m]")
    parser.add_argument("--flow", metavar="FILE", help="a slice of a flow (.vti, .pvd)")
    parser.add_argument("--flow-colour", metavar="FIELD", help="its field (velocity)")
    parser.add_argument("--flow-range", metavar="LOW,HIGH", help="values at the ends of its colour bar")
    parser.add_argument("--slice", metavar="y=0.05", help="where the slice is [m] (the middle, across the view)")
    parser.add_argument("--cut", action="append", metavar="y=0.05",
                        help="leave out the half in front of this place [m]; y>0.05 and y<0.05 keep that side; may be repeated")
    parser.add_argument("--slab", metavar="y=0.04,0.06", help="only bodies and contacts between these places [m]")
    parser.add_argument("--title", nargs="+", metavar="T", help="a caption for each panel (its time, if it is of a series)")
    parser.add_argument("--bounds", metavar="XMIN,XMAX,ZMIN,ZMAX", help="what the picture shows, across and upwards [m]")
    parser.add_argument("--width", type=int, metavar="PIXELS", help="of the picture (150 an inch, at most 1950)")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="of a movie, each N-th frame")
    parser.add_argument("--fps", type=float, default=10, metavar="N", help="of a movie, frames a second (10)")


def run(options: argparse.Namespace) -> None:
    """Draws what the arguments say."""
    from .movie import is_movie

    if options.every < 1 or not options.fps > 0:
        raise Error(f"--every {options.every} must be at least 1, and --fps {options.fps:g} above 0")
    if options.width is not None and not 100 <= options.width <= 20000:
        raise Error(f"--width {options.width} must be a number of pixels from 100 to 20000")
    scene = Scene(options)
    if is_movie(options.out):
        scene.draw_movie(options.out)
    else:
        scene.draw_picture(options.out)


def draw(*files: str, out: str, **options) -> None:
    """`silt draw` from Python: files and the options by name, with '_' for '-'.

        silt.drawing.draw("out/vtk/particles.pvd", out="bed.png", colour="velocity", cut=["y=0.05"])
    """
    parser = argparse.ArgumentParser()
    add_options(parser)
    known = parser.parse_args([*files, "--out", out])
    for name, value in options.items():
        if not hasattr(known, name):
            raise Error(f"silt.drawing.draw has no option '{name}'; see python3 -m silt draw --help")
        setattr(known, name, value)
    run(known)
